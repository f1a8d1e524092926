"""Per-view encoders: small residual CNNs with GroupNorm, one for RGB and one for depth.

Their ``stages`` are the places where adapters go. Both take what the sensor gives (uint8 RGB,
float32 metres, square views of any size), and resize and normalise inside, so no caller can do
either wrongly.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.concepts import CONCEPTS

SIZE = 64  # pixels of a view that the shipped agents are trained on
DEPTH_RANGE = 5.0  # metres; beyond it nothing matters for steps of at most 3 m
GRID = 4  # rows and columns of the last feature map at 64 pixels


class Block(nn.Module):
    """Residual block of two 3x3 convolutions; ``stride`` 2 halves the map."""

    def __init__(self, inputs: int, outputs: int, stride: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False)
        self.norm1 = nn.GroupNorm(8, outputs)
        self.second = nn.Conv2d(outputs, outputs, 3, 1, 1, bias=False)
        self.norm2 = nn.GroupNorm(8, outputs)
        self.skip = nn.Conv2d(inputs, outputs, 1, bias=False)
        self.stride = stride

    def forward(self, x: Tensor) -> Tensor:
        y = self.norm2(self.second(F.relu(self.norm1(self.first(x)))))
        x = halved(x) if self.stride > 1 else x
        return F.relu(y + self.skip(x))


def halved(x: Tensor) -> Tensor:
    """``F.avg_pool2d(x, 2)``, bit for bit. Without gradients as a sum of four slices, which takes a
    third of the time on a CPU (torch 2.13 pools one value at a time)."""
    if torch.is_grad_enabled() or x.shape[-1] % 2 or x.shape[-2] % 2:
        return F.avg_pool2d(x, 2)
    top, bottom = x[..., ::2, :], x[..., 1::2, :]
    return (top[..., ::2] + top[..., 1::2] + bottom[..., ::2] + bottom[..., 1::2]) / 4


class Encoder(nn.Module):
    """Stem and residual stages; views of ``size`` pixels in, a 4x4 map out.

    Frames of another size are resized by ``resize``, a mode of ``F.interpolate``.
    """

    def __init__(
        self, channels: int, stem: int, widths: tuple[int, ...], size: int, resize: str
    ) -> None:
        super().__init__()
        if size < 16 or size % 16:
            raise ValueError(f"size={size} must be a multiple of 16 pixels, such as {SIZE}.")
        self.size, self.resize = size, resize
        self.stem = nn.Sequential(
            nn.Conv2d(channels, stem, 3, 2, 1, bias=False), nn.GroupNorm(8, stem), nn.ReLU()
        )
        blocks = [Block(a, b, 2) for a, b in zip((stem, *widths[:-1]), widths, strict=True)]
        self.stages = nn.ModuleList(blocks)

    def sized(self, frames: Tensor) -> Tensor:
        """Frames ``[n, H, W, c]`` to float ``[n, c, size, size]``."""
        x = frames.permute(0, 3, 1, 2).float()
        if x.shape[-2:] == (self.size, self.size):
            return x
        return F.interpolate(x, (self.size, self.size), mode=self.resize)

    def maps(self, x: Tensor) -> Tensor:
        """Normalised input ``[n, c, H, W]`` to features ``[n, widths[-1], 4, 4]``."""
        x = self.stem(x)
        for stage in self.stages:
            x = stage(x)
        return x if x.shape[-1] == GRID else F.adaptive_avg_pool2d(x, GRID)


def depth_channels(z: Tensor) -> Tensor:
    """Metres ``[n, 1, H, W]`` to the input ``[n, 2, H, W]`` of a depth encoder: invalid depth (0,
    NaN, infinite) enters as 0 with its own mask channel."""
    valid = torch.isfinite(z) & (z > 0)
    z = torch.where(valid, z.clamp(max=DEPTH_RANGE) / DEPTH_RANGE, torch.zeros_like(z))
    return torch.cat([z * 2 - valid.float(), 1 - valid.float()], 1)


class RGBEncoder(Encoder):
    """uint8 ``[n, H, W, 3]`` to features ``[n, width]`` and concept logits ``[n, C]``."""

    def __init__(
        self,
        stem: int = 32,
        widths: tuple[int, ...] = (48, 96, 160),
        width: int = 128,
        size: int = SIZE,
    ) -> None:
        super().__init__(3, stem, tuple(widths), size, "area")
        self.gather = nn.Conv2d(widths[-1], 2 * widths[-1], GRID, groups=widths[-1])
        self.embed = nn.Linear(2 * widths[-1], width)
        self.concepts = nn.Linear(width, len(CONCEPTS))

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        x = self.sized(rgb) / 127.5 - 1
        x = F.gelu(self.gather(self.maps(x)).flatten(1))
        features = F.gelu(self.embed(x))
        return features, self.concepts(features)


class DepthEncoder(Encoder):
    """float32 metres ``[n, H, W, 1]`` to features ``[n, width]`` of each view.

    Resizing takes the nearest pixel: a mean across an edge or a hole would be a surface that is not
    there.
    """

    def __init__(
        self,
        stem: int = 24,
        widths: tuple[int, ...] = (32, 64, 96),
        width: int = 128,
        size: int = SIZE,
    ) -> None:
        super().__init__(2, stem, tuple(widths), size, "nearest-exact")
        self.rows = nn.Conv2d(widths[-1], widths[-1], (GRID, 1))
        self.embed = nn.Linear(GRID * widths[-1], width)

    def forward(self, depth: Tensor) -> Tensor:
        x = self.maps(depth_channels(self.sized(depth)))
        return F.gelu(self.embed(F.relu(self.rows(x)).flatten(1)))
