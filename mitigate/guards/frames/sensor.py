"""Restore the frames of one sensor: detect corruption, correct pixels and fill lost pixels.

The value x of a pixel is restored as follows, separately for each colour:

    low, high = smallest and largest value in the other views of the panorama
    lost, gain, bias = U-Net(x, low - x, high - x)
    trust = sigmoid(-lost - alone * distance of x from [low, high])
    y = gain * x + bias
    out = y where trusted, else the other views of the panorama, else the surrounding pixels

``y`` corrects light, blur and noise. The U-Net is zero-initialised, so ``y`` equals ``x`` at the
start of training.

If frames are larger than the working size, the U-Net processes reduced frames and its output maps
are enlarged. ``x`` and the other views keep their full size, so that detail is preserved.
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
TOLERANCE = 0.02  # a pixel is correct if its error is below this fraction of the range (heuristic)
# Clean pixels rarely differ from the other views by more than this fraction of the range.
# On 20 panoramas of val_seen, 98.6 % (RGB) and 99.2 % (depth) differed by less.
MARGIN = {RGB: 0.2, DEPTH: 0.02}
# A pixel is trusted less if it lies outside the range of values in the other views.
# This is the initial weight of its distance from that range in the trust logit (heuristic).
ALONE = 2.0
LOST = -3.0  # initial logit of "lost", which gives a probability of 5 % (heuristic)
# bound on the magnitude of the trust logit, so that its gradient never vanishes (heuristic)
SUREST = 6.0
# The limits for depth are heuristic, and depth frames of the apartments stay far below both.
# The maximum depth of the apartments is 10 m.
# In 600 panoramas, at most 1.3 % of a view was farther away.
# In each corrupted time step, restoration changed half of the pixels by at most 0.4 m.
# This was measured on 400 single views and 200 panoramas with all depth corruptions.
# The only exceptions were single views in which every pixel had a depth of exactly 10 m.
BEYOND = 0.1  # maximum fraction of pixels beyond ``far``; training contained no such pixels
# Depth is not changed if over half of the pixels would change by more than this.
# The value is a fraction of the range.
MOVED = 0.1
# limits of the logarithm of the gain, so the gain is 0.14 to 37 (heuristic)
# Low light reduces brightness to 0.03, and a gain of 33 reverses this.
GAINS = (-2.0, 3.6)


class SensorRestorer(nn.Module):
    """Restores the frames of one sensor.

    Args:
        sensor: "rgb" or "depth".
        width: number of channels of the U-Net's finest feature maps.
        size: shorter side in pixels of the frames that the network processes. Larger frames are
            reduced to this size.
        far: depth in metres that is scaled to 1.

    Attributes:
        threshold: a frame is restored if the gate's logit is above this value. Training sets it.
    """

    threshold: Tensor

    def __init__(self, sensor: str, width: int, size: int, far: float = Z_MAX) -> None:
        super().__init__()
        self.sensor, self.size, self.far = sensor, size, far
        channels = 3 * CHANNELS[sensor]
        self.net = UNet(channels + 1 + (sensor == DEPTH), channels, width)
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
            The values, and a mask [n, 1, H, W] of valid pixels. Depth is valid if it is finite and
            above 0.
        """
        x = frames.permute(0, 3, 1, 2).float()
        if self.sensor == RGB:
            return x / self.range, torch.ones_like(x[:, :1])
        valid = torch.isfinite(x) & (x > 0)
        return torch.where(valid, x, 0.0).div(self.range).clamp(max=1), valid.float()

    def working(self, height: int, width: int) -> tuple[int, int]:
        """Return the size at which frames are processed; both sides are multiples of 8 pixels."""
        scale = min(1.0, self.size / min(height, width))
        return tuple(max(1, round(n * scale / FACTOR)) * FACTOR for n in (height, width))  # type: ignore[return-value]

    def small(self, x: Tensor, valid: Tensor) -> tuple[Tensor, Tensor]:
        """Resize values and mask to the working size."""
        size = self.working(*x.shape[-2:])
        if size == tuple(x.shape[-2:]):
            return x, valid
        # invalid pixels have no weight, so that they do not darken their neighbours
        weight = _resized(valid, size)
        return _resized(x * valid, size) / weight.clamp(min=1e-3), (weight > 0.5).float()

    def forward(self, frames: Tensor, views: int) -> Tensor:
        """Restore all frames [n, H, W, c]; return values [n, c, H, W] in [0, 1].

        Each group of ``views`` frames is one time step. The gate is not applied.
        """
        x, valid = self.scaled(frames)
        maps, outside, _ = self.judge(*self.small(x, valid), views)
        return self._composed(x, valid, maps, outside, views)

    def judge(self, x: Tensor, valid: Tensor, views: int) -> tuple[Encoded, Tensor, Tensor]:
        """Encode frames at the working size, and detect corruption.

        Returns:
            Three values. The first one contains the feature maps of the U-Net. The second one is
            how far each pixel is outside the range of the other views, float [n, c, h, w]. It is 0
            for distances up to ``MARGIN``, and grows by 1 for each further ``MARGIN``. The third
            one is the logit of the gate for each time step.
        """
        inputs, outside = self.seen(x, valid, views)
        maps = self.net.encode(inputs, views)
        return maps, outside, self.gate(maps.stats, texture(x, valid), views)

    def seen(self, x: Tensor, valid: Tensor, views: int) -> tuple[Tensor, Tensor]:
        """Return the input of the U-Net, and how far pixels are outside the other views' range.

        The input consists of the following channels:

        - the frame;
        - the mask of valid pixels (only for depth);
        - the differences from the smallest and the largest value in the other views;
        - the mask of the pixels for which another view has a valid pixel.
        """
        inputs = [x * 2 - 1, valid] if self.sensor == DEPTH else [x * 2 - 1]
        if not ring.is_ring(views, *x.shape[-2:]):
            zeros = torch.zeros_like(x)
            return torch.cat([*inputs, zeros, zeros, zeros[:, :1]], 1), zeros
        low, high, has_other = ring.compared(x, valid, self.sensor == DEPTH)
        distance = torch.maximum(low - x, x - high).clamp(min=0)
        outside = (distance / MARGIN[self.sensor] - 1).clamp(min=0)
        return torch.cat([*inputs, (low - x) * 2, (high - x) * 2, has_other], 1), outside

    def _composed(
        self, x: Tensor, valid: Tensor, encoded: Encoded, outside: Tensor, views: int
    ) -> Tensor:
        """Restore frames [n, c, H, W] with the results of :meth:`judge`."""
        channels, full = x.shape[1], x.shape[-2:]
        gain_bias, lost = self.net.decode(encoded).tensor_split([2 * channels], 1)
        maps = torch.cat([gain_bias, lost + self.alone * outside], 1)
        maps = maps if full == maps.shape[-2:] else _resized(maps, full)
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

    @torch.inference_mode()
    def judged(self, frames: Tensor) -> tuple[bool, Tensor]:
        """Return whether frames [V, H, W, c] of a time step were restored, and the result.

        Frames stay unchanged if the gate classifies them as clean, if they are outside the training
        range, or if they would change too much.
        """
        x, valid = self.scaled(frames)
        if not self.knows(frames, valid):
            return False, frames
        maps, outside, gate = self.judge(*self.small(x, valid), len(frames))
        if not bool(gate > self.threshold):
            return False, frames
        y = self._composed(x, valid, maps, outside, len(frames))
        if self.sensor == DEPTH and _share((y - x).abs() > MOVED, valid) > 0.5:
            warnings.warn(
                "Restoring a depth frame would change most readings by more than "
                f"{MOVED * self.far:g} m: such frames are not changed (docs/restoration.md).",
                stacklevel=3,
            )
            return False, frames
        return True, self.unscaled(y)

    @torch.inference_mode()
    def doubt(self, frames: Tensor) -> float:
        """Return the gate's logit for the frames [V, H, W, c] of a time step, minus the threshold.

        The value is -inf for frames outside the training range.
        """
        x, valid = self.scaled(frames)
        if not self.knows(frames, valid):
            return -math.inf
        return float(self.judge(*self.small(x, valid), len(frames))[2] - self.threshold)

    def knows(self, frames: Tensor, valid: Tensor) -> bool:
        """Return whether frames [V, H, W, c] are within the range of the training data.

        RGB frames are always within the range. Depth frames must have valid pixels, and no
        more than a fraction :data:`BEYOND` of them may be beyond ``far``. If a larger fraction is
        beyond ``far``, a warning is shown.
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
        """Convert values [n, c, H, W] to frames [n, H, W, c]: uint8 RGB, or depth above 0 m."""
        out = out.clamp(0, 1).permute(0, 2, 3, 1)
        if self.sensor == RGB:
            return (out * self.range).round().to(torch.uint8)
        return (out * self.range).clamp(min=1e-3)


def _share(mask: Tensor, valid: Tensor) -> float:
    """Return the fraction of the pixels in ``valid`` [n, 1, H, W] for which ``mask`` is true."""
    return float((mask * valid).sum() / (valid.sum() * mask.shape[1]))


def _resized(x: Tensor, size: tuple[int, int] | torch.Size) -> Tensor:
    mode = "area" if size[0] * size[1] < x.shape[-2] * x.shape[-1] else "bilinear"
    align = None if mode == "area" else False
    return F.interpolate(x, tuple(size), mode=mode, align_corners=align)
