"""Define the network of a restorer: a small U-Net, and a gate that detects corrupted frames.

The U-Net has no normalisation layers, because they would hide how dark a frame is. The height and
the width of inputs must be multiples of 8 pixels.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

SLOPE = 0.1  # slope of the activations for negative inputs (heuristic)
# thresholds of the second difference below which a pixel counts as flat (heuristic)
FLAT = (1e-4, 1e-3, 1e-2)
TEXTURES = 6 + 4 * (3 + len(FLAT))  # number of statistics that :func:`texture` returns per frame
HIDDEN = 64  # number of hidden units of the gate (heuristic)
FACTOR = 8  # height and width of the input must be multiples of this many pixels


class Encoded(NamedTuple):
    """Feature maps of three levels, and their statistics.

    ``stats`` [n, 14 * width] contains the mean magnitude and the maximum of each map.
    """

    fine: Tensor
    middle: Tensor
    coarse: Tensor
    stats: Tensor


def active(x: Tensor) -> Tensor:
    """Apply a leaky ReLU.

    A plain ReLU is not used, because channels die without normalisation. In 700 training steps, 83
    % of the channels of the coarsest level died.
    """
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
    """Map float ``[n, inputs, h, w]`` to ``[n, outputs, h, w]``; before training, the output is 0.

    A pixel unshuffle merges blocks of 2 x 2 pixels, so the finest maps have half the height and
    width of the input. The mean of the coarsest maps is computed over each view and over all views
    of the time step. A linear projection of both means is added to these maps.

    Args:
        inputs: number of input channels.
        outputs: number of output channels.
        width: number of channels of the finest maps. The next two levels have 2 and 4 times as many
            channels.
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
                # each block starts close to the identity
                nn.init.normal_(module.second.weight, std=0.01)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)  # type: ignore[arg-type]

    def encode(self, x: Tensor, views: int) -> Encoded:
        """Encode ``x`` [n, inputs, h, w]; each group of ``views`` rows is one time step."""
        x = F.pixel_unshuffle(x, 2).contiguous(memory_format=torch.channels_last)
        fine = self.fine(active(self.stem(x)))
        middle = self.middle(active(self.down1(fine)))
        coarse = self.coarse[0](active(self.down2(middle)))
        view_mean = coarse.mean((2, 3))
        ring_mean = view_mean.unflatten(0, (-1, views)).mean(1).repeat_interleave(views, 0)
        context = self.context(torch.cat([view_mean, ring_mean], 1))
        coarse = self.coarse[1](coarse + context[..., None, None])
        levels = (fine, middle, coarse)
        stats = [part for x in levels for part in (x.abs().mean((2, 3)), x.amax((2, 3)))]
        return Encoded(*levels, torch.cat(stats, 1).float())

    def decode(self, maps: Encoded) -> Tensor:
        """Compute the output (float32) from the maps that :meth:`encode` returned."""
        x = F.interpolate(self.up2(maps.coarse), scale_factor=2.0) + maps.middle
        x = F.interpolate(self.up1(self.middle_out(x)), scale_factor=2.0) + maps.fine
        return F.pixel_shuffle(self.head(self.fine_out(x)).float(), 2)


class Gate(nn.Module):
    """Predict one logit per time step; a high logit means that the frames are corrupted.

    The gate reads statistics of the feature maps of all views, and the statistics of
    :func:`texture`. The gate's gradients do not reach the feature maps, which are trained only to
    restore frames.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        inputs = 14 * width + TEXTURES
        self.norm = nn.LayerNorm(14 * width)
        self.hidden, self.out = nn.Linear(3 * inputs, HIDDEN), nn.Linear(HIDDEN, 1)

    def forward(self, stats: Tensor, texture: Tensor, views: int) -> Tensor:
        """Return the logits [time steps].

        Args:
            stats: the field ``stats`` of :class:`Encoded`.
            texture: float [n, TEXTURES].
            views: number of rows per time step.
        """
        each = torch.cat([self.norm(stats.detach()), texture], 1).float()
        ring = each.unflatten(0, (-1, views))
        all_views = torch.cat([ring.mean(1), ring.amax(1), ring.amin(1)], 1)
        return self.out(active(self.hidden(all_views)))[:, 0]


def texture(x: Tensor, valid: Tensor) -> Tensor:
    """Return statistics [n, TEXTURES] that reveal noise, blur, quantisation, darkness and holes.

    The statistics are mean magnitudes and fractions of pixels, on a logarithmic scale.

    Args:
        x: float [n, c, h, w] in [0, 1].
        valid: mask [n, 1, h, w] with 1 for valid pixels.
    """
    grey = x.float().mean(1, keepdim=True)
    statistics = [grey.mean((1, 2, 3)), grey.std((1, 2, 3)), 1 - valid.float().mean((1, 2, 3))]
    statistics += [(grey < 0.01).float().mean((1, 2, 3)), (grey > 0.99).float().mean((1, 2, 3))]
    for scale in (1, 2):
        level = grey if scale == 1 else F.avg_pool2d(grey, 2)
        for axis in (2, 3):
            step = level.diff(dim=axis).abs()
            bend = level.diff(n=2, dim=axis).abs()
            statistics += [part.mean((1, 2, 3)) for part in (step, bend, bend.square())]
            flat = bend.flatten(1)
            statistics += [(flat < t).float().mean(1) for t in FLAT]
    # mean difference between the colours and grey; 0 for depth, which has one channel
    statistics.append((x - grey).abs().mean((1, 2, 3)) * (x.shape[1] == 3))
    return (torch.stack(statistics, 1) + 1e-4).log() / 3 + 1
