"""The network of a restorer: a small U-Net that also judges whether a frame needs it.

No normalisation layers: how dark a frame is must not be lost. All sizes are multiples of 8 pixels.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

SLOPE = 0.1  # of the activations below 0 (ours)
FLAT = (1e-4, 1e-3, 1e-2)  # second differences that count as none (ours)
TEXTURES = 6 + 4 * (3 + len(FLAT))  # numbers of :func:`texture`
FACTOR = 8  # pixels that height and width of the input are a multiple of


class Encoded(NamedTuple):
    """Maps of the three levels, and ``stats`` [n, 14 width]: mean sizes and maxima of each."""

    fine: Tensor
    middle: Tensor
    coarse: Tensor
    stats: Tensor


def active(x: Tensor) -> Tensor:
    """Leaky: without normalisation, channels of plain ReLUs die (measured: 83 % of the coarsest in
    700 steps)."""
    return F.leaky_relu(x, SLOPE)


class Block(nn.Module):
    """Residual block of two 3x3 convolutions."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(channels, channels, 3, padding=1)
        self.second = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(self, x: Tensor) -> Tensor:
        return x + self.second(active(self.first(x)))


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
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, SLOPE)
            if isinstance(module, Block):
                nn.init.normal_(module.second.weight, std=0.01)  # close to the identity
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)  # type: ignore[arg-type]

    def encode(self, x: Tensor, views: int) -> Encoded:
        """Maps of ``x`` [n, inputs, h, w]; every ``views`` of the n are one instant."""
        x = F.pixel_unshuffle(x, 2).contiguous(memory_format=torch.channels_last)
        fine = self.fine(active(self.stem(x)))
        middle = self.middle(active(self.down1(fine)))
        coarse = self.coarse[0](active(self.down2(middle)))
        own = coarse.mean((2, 3))
        instant = own.unflatten(0, (-1, views)).mean(1, keepdim=True).expand(-1, views, -1)
        told = self.context(torch.cat([own, instant.flatten(0, 1)], 1))
        coarse = self.coarse[1](coarse + told[..., None, None])
        levels = (fine, middle, coarse)
        stats = [
            part for level in levels for part in (level.abs().mean((2, 3)), level.amax((2, 3)))
        ]
        return Encoded(*levels, torch.cat(stats, 1).float())

    def decode(self, maps: Encoded) -> Tensor:
        """The output for what :meth:`encode` gave, float32."""
        x = F.interpolate(self.up2(maps.coarse), scale_factor=2.0) + maps.middle
        x = F.interpolate(self.up1(self.middle_out(x)), scale_factor=2.0) + maps.fine
        return F.pixel_shuffle(self.head(self.fine_out(x)).float(), 2)


class Gate(nn.Module):
    """Logit [instants] of "this frame is corrupted", from the maps of all its views and from
    :func:`texture`. Gradients do not go back into the maps: they are for restoring."""

    def __init__(self, width: int, hidden: int = 64) -> None:
        super().__init__()
        inputs = 14 * width + TEXTURES
        self.norm = nn.LayerNorm(14 * width)
        self.hidden, self.out = nn.Linear(3 * inputs, hidden), nn.Linear(hidden, 1)

    def forward(self, stats: Tensor, texture: Tensor, views: int) -> Tensor:
        """``stats``: of :class:`Encoded`; ``texture`` [n, TEXTURES]; every ``views`` rows are one
        instant."""
        each = torch.cat([self.norm(stats.detach()), texture], 1).float()
        ring = each.unflatten(0, (-1, views))
        all_views = torch.cat([ring.mean(1), ring.amax(1), ring.amin(1)], 1)
        return self.out(active(self.hidden(all_views)))[:, 0]


def texture(x: Tensor, valid: Tensor) -> Tensor:
    """What tells noise, blur, steps, dark and holes from a clean view, float32 [n, TEXTURES]: sizes
    and shares, as logarithms over their usual range.

    Args: x [n, c, h, w] in [0, 1]; valid [n, 1, h, w], which pixels are a reading.
    """
    grey = x.float().mean(1, keepdim=True)
    found = [grey.mean((1, 2, 3)), grey.std((1, 2, 3)), 1 - valid.float().mean((1, 2, 3))]
    found += [(grey < 0.01).float().mean((1, 2, 3)), (grey > 0.99).float().mean((1, 2, 3))]
    for scale in (1, 2):
        level = grey if scale == 1 else F.avg_pool2d(grey, 2)
        for axis in (2, 3):
            step = level.diff(dim=axis).abs()
            bend = level.diff(n=2, dim=axis).abs()
            found += [step.mean((1, 2, 3)), bend.mean((1, 2, 3)), bend.square().mean((1, 2, 3))]
            flat = bend.flatten(1)
            found += [(flat < t).float().mean(1) for t in FLAT]
    if x.shape[1] == 3:
        found.append((x - grey).abs().mean((1, 2, 3)))
    else:
        found.append(torch.zeros_like(found[0]))
    return (torch.stack(found, 1) + 1e-4).log() / 3 + 1
