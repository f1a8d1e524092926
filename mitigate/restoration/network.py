"""The network of a restorer: a small U-Net that also judges whether a frame needs it.

No normalisation layers: how dark a frame is must not be lost. All sizes are multiples of 8 pixels.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

FACTOR = 8  # pixels that height and width of the input are a multiple of


class Encoded(NamedTuple):
    """Maps of the three levels, and ``stats`` [n, 14 width]: means and maxima of each."""

    fine: Tensor
    middle: Tensor
    coarse: Tensor
    stats: Tensor


class Block(nn.Module):
    """Residual block of two 3x3 convolutions."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(channels, channels, 3, padding=1)
        self.second = nn.Conv2d(channels, channels, 3, padding=1)
        with torch.no_grad():
            self.second.weight.mul_(0.1)  # close to the identity at the start

    def forward(self, x: Tensor) -> Tensor:
        return F.relu(x + self.second(F.relu(self.first(x))))


class UNet(nn.Module):
    """float ``[n, inputs, h, w]`` to ``[n, outputs, h, w]``, zero before it has learned.

    It works on blocks of 2 x 2 pixels (pixel unshuffle), so the finest maps are half the size. The
    coarsest maps are told the mean over the view and over all views of the instant.

    Args: inputs, outputs: channels. width: of the finest maps; the next are 2 and 4 times as wide.
    """

    def __init__(self, inputs: int, outputs: int, width: int) -> None:
        super().__init__()
        w = width
        self.stem = nn.Conv2d(4 * inputs, w, 3, padding=1)
        self.fine, self.middle = Block(w), Block(2 * w)
        self.down1 = nn.Conv2d(w, 2 * w, 3, 2, 1)
        self.down2 = nn.Conv2d(2 * w, 4 * w, 3, 2, 1)
        self.coarse = nn.ModuleList([Block(4 * w), Block(4 * w)])
        self.context = nn.Linear(8 * w, 4 * w)
        self.up2, self.up1 = nn.Conv2d(4 * w, 2 * w, 1), nn.Conv2d(2 * w, w, 1)
        self.middle_out, self.fine_out = Block(2 * w), Block(w)
        self.head = nn.Conv2d(w, 4 * outputs, 3, padding=1)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)  # type: ignore[arg-type]

    def encode(self, x: Tensor, views: int) -> Encoded:
        """Maps of ``x`` [n, inputs, h, w]; every ``views`` of the n are one instant."""
        x = F.pixel_unshuffle(x, 2).contiguous(memory_format=torch.channels_last)
        fine = self.fine(F.relu(self.stem(x)))
        middle = self.middle(F.relu(self.down1(fine)))
        coarse = self.coarse[0](F.relu(self.down2(middle)))
        own = coarse.mean((2, 3))
        instant = own.unflatten(0, (-1, views)).mean(1, keepdim=True).expand(-1, views, -1)
        told = self.context(torch.cat([own, instant.flatten(0, 1)], 1))
        coarse = self.coarse[1](coarse + told[..., None, None])
        levels = (fine, middle, coarse)
        stats = [part for level in levels for part in (level.mean((2, 3)), level.amax((2, 3)))]
        return Encoded(*levels, torch.cat(stats, 1).float())

    def decode(self, maps: Encoded) -> Tensor:
        """The output for what :meth:`encode` gave, float32."""
        x = F.interpolate(self.up2(maps.coarse), scale_factor=2.0) + maps.middle
        x = F.interpolate(self.up1(self.middle_out(x)), scale_factor=2.0) + maps.fine
        return F.pixel_shuffle(self.head(self.fine_out(x)).float(), 2)

    def forward(self, x: Tensor, views: int) -> Tensor:
        return self.decode(self.encode(x, views))


class Gate(nn.Module):
    """Logit [instants] of "this frame is corrupted", from the maps of all its views."""

    def __init__(self, width: int, hidden: int = 64) -> None:
        super().__init__()
        self.hidden, self.out = nn.Linear(28 * width, hidden), nn.Linear(hidden, 1)

    def forward(self, stats: Tensor, views: int) -> Tensor:
        """``stats``: of :class:`Encoded`; every ``views`` rows are one instant."""
        ring = stats.unflatten(0, (-1, views))
        both = torch.cat([ring.mean(1), ring.amax(1)], 1)
        return self.out(F.relu(self.hidden(both)))[:, 0]
