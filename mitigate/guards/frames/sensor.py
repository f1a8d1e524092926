"""Restore the frames of one sensor: detect corruption, correct pixels and fill lost pixels.

    low, high = smallest and largest value in the other views of the panorama
    lost, gain, bias = U-Net(x, low - x, high - x) zero-initialised: at first nothing changes
    trust = sigmoid(-lost - alone * distance of x outside [low, high]), per colour
    y = x gain + bias                              corrects light, blur, noise
    out = y where trusted, else from other views of the panorama, else from pixels around

For frames above the working size, the maps of the U-Net are computed at the working size and
enlarged. ``x`` and the other views keep their full size, so that detail is preserved.
"""

from __future__ import annotations

import math
import warnings

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.core.observation import DEPTH, RGB, Z_MAX
from mitigate.guards.frames import ring
from mitigate.guards.frames.network import FACTOR, Encoded, Gate, UNet, texture

CHANNELS = {RGB: 3, DEPTH: 1}
TOLERANCE = 0.02  # error below which a pixel is correct, as a fraction of the range (heuristic)
# Margin as a fraction of the range. About 99 % of clean pixels differ by less from the other views
# (measured on 20 panoramas of val_seen: 98.6 and 99.2 %).
MARGIN = {RGB: 0.2, DEPTH: 0.02}
ALONE = 2.0  # a value one margin outside the range first lowers the logit by this (heuristic)
LOST = -3.0  # initial logit of "lost", for a probability of 5 % (heuristic)
SUREST = 6.0  # bound of the logit, so that its gradient never vanishes (heuristic)
# Heuristic limits for depth. Frames of the apartments are far from both limits.
# At most 1.3 % of a view lies beyond their 10 m (600 panoramas). Restoring moves half of the
# pixels of a corrupted time step by at most 0.4 m (400 single views and 200 panoramas, all depth
# corruptions). The only exception are single views in which all pixels have exactly 10 m.
BEYOND = 0.1  # maximum fraction of pixels beyond ``far``, which did not occur in training
# a frame is not changed if over half of its pixels would move more than this fraction of the range
MOVED = 0.1
# limits of the log gain, for gains of 0.14 to 37 (heuristic; low light leaves 0.03)
GAINS = (-2.0, 3.6)


class SensorRestorer(nn.Module):
    """Restores the frames of one sensor.

    Args:
        sensor: "rgb" or "depth".
        width: channels of the U-Net's finest maps.
        size: shorter side in pixels at which the network works; larger frames are reduced to it.
        far: depth in metres that is scaled to 1.

    Attributes:
        threshold: logit of the gate above which a frame is restored (a buffer that training sets).
    """

    threshold: Tensor

    def __init__(self, sensor: str, width: int, size: int, far: float = Z_MAX) -> None:
        super().__init__()
        self.sensor, self.size, self.far = sensor, size, far
        channels = CHANNELS[sensor]
        inputs = 3 * channels + 1 + (sensor == DEPTH)
        self.net = UNet(inputs, 3 * channels, width)
        self.gate = Gate(width)
        self.alone = nn.Parameter(torch.tensor(ALONE))
        self.register_buffer("threshold", torch.zeros(()))

    @property
    def range(self) -> float:
        """The RGB level, or the depth in metres, that is scaled to 1."""
        return 255.0 if self.sensor == RGB else self.far

    def scaled(self, frames: Tensor) -> tuple[Tensor, Tensor]:
        """Scale frames [n, H, W, c] of the sensor to values [n, c, H, W] in [0, 1].

        Returns:
            The values, and a mask [n, 1, H, W] of valid pixels (for depth: finite and above 0).
        """
        x = frames.permute(0, 3, 1, 2).float()
        if self.sensor == RGB:
            return x / self.range, torch.ones_like(x[:, :1])
        valid = torch.isfinite(x) & (x > 0)
        return torch.where(valid, x, 0.0).div(self.range).clamp(max=1), valid.float()

    def working(self, height: int, width: int) -> tuple[int, int]:
        """Return the working size for frames of this size; both sides are multiples of 8."""
        scale = min(1.0, self.size / min(height, width))
        return tuple(max(1, round(n * scale / FACTOR)) * FACTOR for n in (height, width))  # type: ignore[return-value]

    def small(self, x: Tensor, valid: Tensor) -> tuple[Tensor, Tensor]:
        """Resize values and mask to the working size, so that holes do not darken their
        neighbours.
        """
        size = self.working(*x.shape[-2:])
        if size == tuple(x.shape[-2:]):
            return x, valid
        weight = _resized(valid, size)
        return _resized(x * valid, size) / weight.clamp(min=1e-3), (weight > 0.5).float()

    def forward(self, frames: Tensor, views: int) -> Tensor:
        """Restore all frames [n, H, W, c]; return values [n, c, H, W] in [0, 1].

        Each group of ``views`` frames is one time step. The gate is not applied.
        """
        x, valid = self.scaled(frames)
        maps, outside, _ = self.judge(*self.small(x, valid), views)
        return self._composed(x, valid, self._corrections(maps, outside), views)

    def judge(self, x: Tensor, valid: Tensor, views: int) -> tuple[Encoded, Tensor, Tensor]:
        """Encode frames at the working size.

        Returns:
            The maps of the U-Net; how far each pixel contradicts the other views [n, c, h, w], in
            margins; and the gate's logits, one per time step.
        """
        inputs, outside = self.seen(x, valid, views)
        maps = self.net.encode(inputs, views)
        return maps, outside, self.gate(maps.stats, texture(x, valid), views)

    def seen(self, x: Tensor, valid: Tensor, views: int) -> tuple[Tensor, Tensor]:
        """Return the U-Net's input, and how far each pixel contradicts the other views.

        The input contains the frame, the mask of valid pixels (for depth), the differences from the
        smallest and largest value in the other views, and whether another view has a valid pixel.
        """
        inputs = [x * 2 - 1, valid] if self.sensor == DEPTH else [x * 2 - 1]
        if not ring.is_ring(views, *x.shape[-2:]):
            zeros = torch.zeros_like(x)
            return torch.cat([*inputs, zeros, zeros, zeros[:, :1]], 1), zeros
        low, high, has_other = ring.compared(x, valid, self.sensor == DEPTH)
        distance = torch.maximum(low - x, x - high).clamp(min=0)
        outside = (distance / MARGIN[self.sensor] - 1).clamp(min=0)
        return torch.cat([*inputs, (low - x) * 2, (high - x) * 2, has_other], 1), outside

    def _corrections(self, maps: Encoded, outside: Tensor) -> Tensor:
        """Return log gain, bias and logit of "lost" per pixel, at the working size."""
        gain_bias, lost = self.net.decode(maps).tensor_split([2 * CHANNELS[self.sensor]], 1)
        return torch.cat([gain_bias, lost + self.alone * outside], 1)

    def _composed(self, x: Tensor, valid: Tensor, maps: Tensor, views: int) -> Tensor:
        """Return frames [n, c, H, W] restored with the ``maps`` from :meth:`_corrections`."""
        channels, full, small = x.shape[1], x.shape[-2:], maps.shape[-2:]
        maps = maps if full == small else _resized(maps, full)
        gain, bias, lost = maps.split(channels, 1)
        trust = (-SUREST * ((lost + LOST) / SUREST).tanh()).sigmoid() * valid
        y = (x * gain.clamp(*GAINS).exp() + bias).clamp(0, 1)
        known, values = trust, y
        if ring.is_ring(views, *full):
            other, confidence = ring.from_neighbours(y, trust, self.sensor == DEPTH)
            values = y + (1 - trust) * confidence * (other - y)
            known = trust + (1 - trust) * confidence
        around = ring.from_around(values, known)
        return values + (1 - known) * (around - values)

    # one instant -------------------------------------------------------------------------------

    @torch.inference_mode()
    def judged(self, frames: Tensor) -> tuple[bool, Tensor]:
        """Restore frames [V, H, W, c] if the gate classifies them as corrupted.

        Returns:
            Whether they were restored, and the frames. The frames are unchanged if they are
            classified as clean, are out of the training range, or would change too much.
        """
        x, valid = self.scaled(frames)
        if not self.knows(frames, valid):
            return False, frames
        maps, outside, gate = self.judge(*self.small(x, valid), len(frames))
        if not bool(gate > self.threshold):
            return False, frames
        y = self._composed(x, valid, self._corrections(maps, outside), len(frames))
        if self.sensor == DEPTH and _share((y - x).abs() > MOVED, valid) > 0.5:
            return False, frames
        return True, self.unscaled(y)

    @torch.inference_mode()
    def doubt(self, frames: Tensor) -> float:
        """Return the gate's logit minus its threshold, for frames [V, H, W, c] of one time step.

        The value is -inf for frames out of the training range.
        """
        x, valid = self.scaled(frames)
        if not self.knows(frames, valid):
            return -math.inf
        return float(self.judge(*self.small(x, valid), len(frames))[2] - self.threshold)

    def knows(self, frames: Tensor, valid: Tensor) -> bool:
        """Return whether frames [V, H, W, c] have valid pixels, and most of them are within
        ``far``.

        For RGB frames, the result is always true. Warns if too much depth is beyond ``far``.
        """
        if self.sensor == RGB or not bool(valid.any()):
            return self.sensor == RGB
        near = _share(frames.permute(0, 3, 1, 2) > self.range, valid) <= BEYOND
        if not near:
            warnings.warn(
                f"More than {BEYOND:.0%} of the depth of a frame reads farther than {self.far:g} m,"
                " the farthest that this restorer knows: such frames are not changed. Train "
                "one on your frames (docs/restoration.md).",
                stacklevel=3,
            )
        return near

    def unscaled(self, out: Tensor) -> Tensor:
        """Convert values [n, c, H, W] to frames [n, H, W, c]: uint8, or metres above 0."""
        out = out.clamp(0, 1).permute(0, 2, 3, 1)
        if self.sensor == RGB:
            return (out * self.range).round().to(torch.uint8)
        return (out * self.range).clamp(min=1e-3)


def _share(mask: Tensor, valid: Tensor) -> float:
    """Return the fraction of valid pixels (``valid`` [n, 1, H, W]) for which ``mask`` is true."""
    return float((mask * valid).sum() / (valid.sum() * mask.shape[1]))


def _resized(x: Tensor, size: tuple[int, int] | torch.Size) -> Tensor:
    mode = "area" if size[0] * size[1] < x.shape[-2] * x.shape[-1] else "bilinear"
    align = None if mode == "area" else False
    return F.interpolate(x, tuple(size), mode=mode, align_corners=align)
