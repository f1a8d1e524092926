"""The restorer of one sensor: judge, correct, fill what is lost.

    low, high = least and greatest of what the other views of the panorama show
    lost, gain, bias = U-Net(x, low - x, high - x) zero-initialised: at first nothing changes
    trust = sigmoid(-lost - alone * how far x lies outside of low and high), of each colour
    y = x gain + bias                              light, blur, noise
    out = y where trusted, else what other views of the panorama show, else what is around

At sizes above the working size all but ``x`` and what other views show is computed small and
enlarged, so detail stays.
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
TOLERANCE = 0.02  # of the range: a pixel that is off by less is right (ours)
# Of the range: by less than this the other views contradict about 99 % of clean pixels (measured on
# 20 panoramas of val_seen: 98.6 and 99.2 %).
MARGIN = {RGB: 0.2, DEPTH: 0.02}
ALONE = 2.0  # logit that a pixel loses for each further margin, before anything is learned (ours)
LOST = -3.0  # logit of "lost" before anything is learned: 5 % (ours)
SUREST = 6.0  # the greatest logit, either way: a pixel is never given up for good (ours)
# Of the readings of depth (ours). Frames of the apartments are far from both: at most 1.3 % of a
# view lies beyond their 10 m (600 panoramas), and restoring moves half of the readings of a
# corrupted instant by at most 0.4 m (400 views alone and 200 panoramas, all corruptions of depth),
# but of single views in which all read exactly 10 m.
BEYOND = 0.1  # share farther than ``far``: what the network never learned from
MOVED = 0.1  # of the range: by more than this no more than half of them may be wrong
GAINS = (-2.0, 3.6)  # limits of the logarithm of the gain: 0.14 to 37 (ours; low light leaves 0.03)


class SensorRestorer(nn.Module):
    """Restores the frames of one sensor.

    Args: sensor: "rgb" or "depth". width: of the U-Net's finest maps. size: pixels of the shorter
    side that it works at; larger frames are reduced to it. far: metres that depth is divided by.
    ``threshold``: logit of the gate above which a frame is restored (a buffer; training sets it).
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
        """Levels of RGB, or metres of depth, that count as 1."""
        return 255.0 if self.sensor == RGB else self.far

    def scaled(self, frames: Tensor) -> tuple[Tensor, Tensor]:
        """Frames [n, H, W, c] as they come to values [n, c, H, W] in [0, 1], and which pixels
        [n, 1, H, W] are a reading (of depth: finite and above 0)."""
        x = frames.permute(0, 3, 1, 2).float()
        if self.sensor == RGB:
            return x / self.range, torch.ones_like(x[:, :1])
        valid = torch.isfinite(x) & (x > 0)
        return torch.where(valid, x, 0.0).div(self.range).clamp(max=1), valid.float()

    def working(self, height: int, width: int) -> tuple[int, int]:
        """The size that frames of a size are worked on at: multiples of 8."""
        scale = min(1.0, self.size / min(height, width))
        return tuple(max(1, round(n * scale / FACTOR)) * FACTOR for n in (height, width))  # type: ignore[return-value]

    def small(self, x: Tensor, valid: Tensor) -> tuple[Tensor, Tensor]:
        """Values and readings at the working size; a hole does not darken what is beside it."""
        size = self.working(*x.shape[-2:])
        if size == tuple(x.shape[-2:]):
            return x, valid
        weight = _resized(valid, size)
        return _resized(x * valid, size) / weight.clamp(min=1e-3), (weight > 0.5).float()

    def forward(self, frames: Tensor, views: int) -> Tensor:
        """Frames [n, H, W, c] as they come, every ``views`` of them one instant, all restored: as
        values [n, c, H, W] in [0, 1]."""
        x, valid = self.scaled(frames)
        maps, outside, _ = self.judge(*self.small(x, valid), views)
        return self._composed(x, valid, self._corrections(maps, outside), views)

    def judge(self, x: Tensor, valid: Tensor, views: int) -> tuple[Encoded, Tensor, Tensor]:
        """Of frames at the working size: the U-Net's maps, how far each pixel is contradicted
        [n, c, h, w], in margins, and the gate's logits [instants]."""
        shown, outside = self.seen(x, valid, views)
        maps = self.net.encode(shown, views)
        return maps, outside, self.gate(maps.stats, texture(x, valid), views)

    def seen(self, x: Tensor, valid: Tensor, views: int) -> tuple[Tensor, Tensor]:
        """What goes into the U-Net: the frame, of depth where it reads something, and how far
        below and above it the other views of its panorama are; and how far it lies outside."""
        own = [x * 2 - 1, valid] if self.sensor == DEPTH else [x * 2 - 1]
        if not ring.is_ring(views, *x.shape[-2:]):
            none = torch.zeros_like(x)
            return torch.cat([*own, none, none, none[:, :1]], 1), none
        low, high, seen = ring.compared(x, valid, self.sensor == DEPTH)
        off = torch.maximum(low - x, x - high).clamp(min=0)
        outside = (off / MARGIN[self.sensor] - 1).clamp(min=0)
        return torch.cat([*own, (low - x) * 2, (high - x) * 2, seen], 1), outside

    def _corrections(self, maps: Encoded, outside: Tensor) -> Tensor:
        """Gain, bias and how surely lost each pixel is, at the working size."""
        gain_bias, lost = self.net.decode(maps).tensor_split([2 * CHANNELS[self.sensor]], 1)
        return torch.cat([gain_bias, lost + self.alone * outside], 1)

    def _composed(self, x: Tensor, valid: Tensor, maps: Tensor, views: int) -> Tensor:
        """Frames [n, c, H, W] with the U-Net's ``maps`` at the working size."""
        channels, full, small = x.shape[1], x.shape[-2:], maps.shape[-2:]
        maps = maps if full == small else _resized(maps, full)
        gain, bias, lost = maps.split(channels, 1)
        trust = (-SUREST * ((lost + LOST) / SUREST).tanh()).sigmoid() * valid
        y = (x * gain.clamp(*GAINS).exp() + bias).clamp(0, 1)
        known, values = trust, y
        if ring.is_ring(views, *full):
            other, sure = ring.from_neighbours(y, trust, self.sensor == DEPTH)
            values = y + (1 - trust) * sure * (other - y)
            known = trust + (1 - trust) * sure
        around = ring.from_around(values, known)
        return values + (1 - known) * (around - values)

    # one instant, as an agent sees it ----------------------------------------------------------

    @torch.inference_mode()
    def judged(self, frames: Tensor) -> tuple[bool, Tensor]:
        """Whether frames [V, H, W, c] are restored, and the frames restored if so, else as they
        are: what the gate takes for clean, and what the network does not know."""
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
        """How far the gate's logit for frames [V, H, W, c] of an instant lies above its threshold;
        -inf for what the network does not know."""
        x, valid = self.scaled(frames)
        if not self.knows(frames, valid):
            return -math.inf
        return float(self.judge(*self.small(x, valid), len(frames))[2] - self.threshold)

    def knows(self, frames: Tensor, valid: Tensor) -> bool:
        """Whether frames [V, H, W, c] read anything, and most of it within ``far``; warns of what
        reads too far."""
        if self.sensor == RGB or not bool(valid.any()):
            return self.sensor == RGB
        near = _share(frames.permute(0, 3, 1, 2) > self.range, valid) <= BEYOND
        if not near:
            warnings.warn(
                f"More than {BEYOND:.0%} of the depth of a frame reads farther than {self.far:g} m,"
                " the farthest that this restorer knows: such frames are left as they are. Train "
                "one on your frames (docs/restoration.md).",
                stacklevel=3,
            )
        return near

    def unscaled(self, out: Tensor) -> Tensor:
        """Values [n, c, H, W] as the sensor gives them: uint8, or metres above 0."""
        out = out.clamp(0, 1).permute(0, 2, 3, 1)
        if self.sensor == RGB:
            return (out * self.range).round().to(torch.uint8)
        return (out * self.range).clamp(min=1e-3)


def _share(found: Tensor, valid: Tensor) -> float:
    """Of the readings [n, 1, H, W], how many are ``found`` [n, c, H, W]."""
    return float((found * valid).sum() / (valid.sum() * found.shape[1]))


def _resized(x: Tensor, size: tuple[int, int] | torch.Size) -> Tensor:
    mode = "area" if size[0] * size[1] < x.shape[-2] * x.shape[-1] else "bilinear"
    align = None if mode == "area" else False
    return F.interpolate(x, tuple(size), mode=mode, align_corners=align)
