"""Encoders of views: small residual CNNs with GroupNorm for RGB and for depth, and their losses.

Adapters are added after the modules in their ``stages``. All encoders take raw sensor data: square
views of any size, as uint8 RGB or as depth in float32 metres. They resize and normalise the data
themselves. ``RGBEncoder`` and ``DepthEncoder`` read the views of a panorama. ``CameraRGB`` and
``CameraDepth`` read one camera and return features for four vertical strips ("columns") of the
view, because an agent with one camera steers by the horizontal position of an object.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.agent import Output
from mitigate.agents.text import CONCEPTS, THINGS
from mitigate.core.observation import DEPTH, RGB

SIZE = 64  # side in pixels of the views that the shipped agents were trained on
# depth is clipped at this many metres, because free space is predicted only up to 3 m
DEPTH_RANGE = 5.0
GRID = 4  # number of rows and columns of the last feature map for views of 64 pixels
# free space: number of direction bins over 90 degrees, number of distance bins, metres per bin
DIRECTIONS, DISTANCES, STEP = 30, 12, 0.25
LABELS = {RGB: "concepts", DEPTH: "free"}
# weight of positive labels, which are rare because most concepts do not appear in a view
POSITIVE = 2.0


class Block(nn.Module):
    """Residual block of two 3x3 convolutions, which halves the size of the map."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(inputs, outputs, 3, 2, 1, bias=False)
        self.norm1 = nn.GroupNorm(8, outputs)
        self.second = nn.Conv2d(outputs, outputs, 3, 1, 1, bias=False)
        self.norm2 = nn.GroupNorm(8, outputs)
        self.skip = nn.Conv2d(inputs, outputs, 1, bias=False)

    def forward(self, x: Tensor) -> Tensor:
        y = self.norm2(self.second(F.relu(self.norm1(self.first(x)))))
        return F.relu(y + self.skip(halved(x)))


def halved(x: Tensor) -> Tensor:
    """Return the same result as ``F.avg_pool2d(x, 2)``, bit for bit.

    Without gradients, the result is computed as a sum of four slices. On a CPU, this is three times
    as fast as ``F.avg_pool2d``, which computes one value at a time (torch 2.13).
    """
    if torch.is_grad_enabled() or x.shape[-1] % 2 or x.shape[-2] % 2:
        return F.avg_pool2d(x, 2)
    top, bottom = x[..., ::2, :], x[..., 1::2, :]
    return (top[..., ::2] + top[..., 1::2] + bottom[..., ::2] + bottom[..., 1::2]) / 4


class Encoder(nn.Module):
    """Base class of encoders: a stem and residual stages turn a view into a 4x4 feature map.

    Views are first resized to ``size`` x ``size`` pixels.
    """

    channels: int  # channels of the input
    widths: tuple[int, ...]  # channels of the stem and of each stage
    resize: str  # mode of ``F.interpolate`` with which views are resized
    stride = 16  # ``size`` must be a multiple of this number of pixels

    def __init__(self, size: int) -> None:
        super().__init__()
        if size < self.stride or size % self.stride:
            raise ValueError(f"size must be a multiple of {self.stride} pixels, got {size}.")
        self.size = size
        self.stem, self.stages = self.backbone()

    def backbone(self) -> tuple[nn.Sequential, nn.ModuleList]:
        """Return the stem and the stages."""
        stem = nn.Conv2d(self.channels, self.widths[0], 3, 2, 1, bias=False)
        stages = [Block(a, b) for a, b in pairwise(self.widths)]
        norm = nn.GroupNorm(8, self.widths[0])
        return nn.Sequential(stem, norm, nn.ReLU()), nn.ModuleList(stages)

    def sized(self, frames: Tensor) -> Tensor:
        """Resize frames ``[n, H, W, c]`` to float ``[n, c, size, size]``."""
        x = frames.permute(0, 3, 1, 2).float()
        if x.shape[-2:] == (self.size, self.size):
            return x
        antialias = self.resize == "bilinear"
        return F.interpolate(x, (self.size, self.size), mode=self.resize, antialias=antialias)

    def maps(self, x: Tensor) -> Tensor:
        """Return features ``[n, widths[-1], 4, 4]`` for normalised input ``[n, c, H, W]``."""
        x = self.stem(x)
        for stage in self.stages:
            x = stage(x)
        return x if x.shape[-1] == GRID else F.adaptive_avg_pool2d(x, GRID)


def depth_channels(z: Tensor) -> Tensor:
    """Return the input ``[n, 2, H, W]`` of a depth encoder for depth ``[n, 1, H, W]`` in metres.

    Invalid depth (0, NaN or infinite) becomes 0 and is marked in the second channel.
    """
    valid = torch.isfinite(z) & (z > 0)
    z = torch.where(valid, z.clamp(max=DEPTH_RANGE) / DEPTH_RANGE, torch.zeros_like(z))
    return torch.cat([z * 2 - valid.float(), 1 - valid.float()], 1)


class RGBEncoder(Encoder):
    """Encode uint8 ``[n, H, W, 3]`` as features ``[n, width]`` and concept logits ``[n, C]``."""

    channels, resize = 3, "area"
    widths: tuple[int, ...] = (32, 48, 96, 160)
    kernel = (GRID, GRID)  # kernel size of the convolution that reduces the last map

    def __init__(self, width: int, size: int = SIZE) -> None:
        super().__init__(size)
        last = self.widths[-1]
        self.gather = nn.Conv2d(last, 2 * last, self.kernel, groups=last)
        self.embed = nn.Linear(2 * last, width)
        self.concepts = nn.Linear(width, len(CONCEPTS))

    def normalised(self, rgb: Tensor) -> Tensor:
        """Return frames ``[n, H, W, 3]`` as input of the stem."""
        return self.sized(rgb) / 127.5 - 1

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        x = F.gelu(self.gather(self.maps(self.normalised(rgb))).flatten(1))
        features = F.gelu(self.embed(x))
        return features, self.concepts(features)


class DepthEncoder(Encoder):
    """Encode depth (float32 metres ``[n, H, W, 1]``) as features ``[n, width]`` of each view.

    Frames are resized by taking the nearest pixel, because a mean across an edge or a hole would
    create a surface that does not exist.
    """

    channels, widths, resize = 2, (24, 32, 64, 96), "nearest-exact"
    joined = GRID  # number of columns that are embedded together

    def __init__(self, width: int, size: int = SIZE) -> None:
        super().__init__(size)
        last = self.widths[-1]
        self.rows = nn.Conv2d(last, last, (GRID, 1))
        self.embed = nn.Linear(self.joined * last, width)

    def columns(self, depth: Tensor) -> Tensor:
        """Return one feature vector per image column, ``[n, widths[-1], 1, 4]``."""
        return F.relu(self.rows(self.maps(depth_channels(self.sized(depth)))))

    def forward(self, depth: Tensor) -> Any:
        return F.gelu(self.embed(self.columns(depth).flatten(1)))


def presence_loss(logits: Tensor, truth: Tensor) -> Tensor:
    """Return the mean binary cross-entropy of logits and labels in {0, 1} of the same shape."""
    return F.binary_cross_entropy_with_logits(
        logits.float(), truth, pos_weight=torch.tensor(POSITIVE, device=logits.device)
    )


def f1(logits: Tensor, targets: Tensor) -> Tensor:
    """Return the micro-averaged F1 score at a probability threshold of 0.5."""
    predicted, true = logits > 0, targets > 0.5
    return 2 * (predicted & true).sum() / torch.clamp(predicted.sum() + true.sum(), min=1)


def free_loss(logits: Tensor, target: Tensor) -> Tensor:
    """Return the mean binary cross-entropy of free-space logits [..., directions, distances]."""
    return F.binary_cross_entropy_with_logits(logits.float(), target)


LABEL_LOSSES = {RGB: presence_loss, DEPTH: free_loss}  # loss function of each sensor's labels


def agreement(logits: Tensor, target: Tensor) -> Tensor:
    """Return the intersection over union of predicted and true free cells."""
    predicted, true = logits > 0, target > 0.5
    return (predicted & true).sum() / torch.clamp((predicted | true).sum(), min=1)


def label_output(views: Tensor, logits: Tensor, sensor: str, truth: Tensor | None) -> Output:
    """Return the output of ``see``, which contains the features "views".

    If ``truth`` is given, the output also contains the loss "labels" and metrics (``figures``).
    """
    out = Output(features={"views": views})
    if truth is None:
        return out
    out.losses = {"labels": LABEL_LOSSES[sensor](logits, truth)}
    if sensor == DEPTH:
        out.figures = {"iou": agreement(logits, truth)}
    else:
        things = f1(logits[..., THINGS], truth[..., THINGS])
        out.figures = {"f1": things, "f1_all": f1(logits, truth)}
    return out


class CameraRGB(RGBEncoder):
    """Encode four columns of RGB frames (uint8 ``[n, H, W, 3]``) as features and concept logits.

    Features have the shape ``[n, 4, width]``, and logits have the shape ``[n, 4, C]``.
    """

    kernel = (GRID, 1)

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        x = F.gelu(self.gather(self.maps(self.normalised(rgb))))
        features = F.gelu(self.embed(x.squeeze(2).transpose(1, 2)))
        return features, self.concepts(features)


class CameraDepth(DepthEncoder):
    """Encode depth (metres ``[n, H, W, 1]``) as free-space logits and features per image column.

    Features have the shape ``[n, 4, width]``. The logits ``[n, 30, 12]`` predict free space for
    each angle (from 45 degrees left to 45 degrees right) and distance (0.25 to 3 m).
    """

    joined = 1

    def __init__(self, width: int, size: int = SIZE) -> None:
        super().__init__(width, size)
        hidden = nn.Linear(GRID * width, 160)
        self.free = nn.Sequential(hidden, nn.GELU(), nn.Linear(160, DIRECTIONS * DISTANCES))

    def forward(self, depth: Tensor) -> tuple[Tensor, Tensor]:
        features = F.gelu(self.embed(self.columns(depth).squeeze(2).transpose(1, 2)))
        return features, self.free(features.flatten(1)).unflatten(1, (DIRECTIONS, DISTANCES))


def encode_camera(encoder: nn.Module, sensor: str, frames: Tensor) -> tuple[Tensor, Tensor]:
    """Return features [n, F] and logits for frames [n, H, W, c] of one camera.

    The features consist of the features of all columns and the encoder's predictions. For RGB,
    these are probabilities of concepts; for depth, these are free distances in metres.
    """
    features, logits = encoder(frames)
    chances = logits.sigmoid()
    predicted = STEP * chances.cumprod(-1).sum(-1) if sensor == DEPTH else chances.flatten(-2)
    return torch.cat([features.flatten(-2), predicted], -1), logits


def see_camera(encoder: nn.Module, sensor: str, frames: Tensor, truth: Tensor | None) -> Output:
    """Return the output of ``see`` (``agents/agent.py``) for the encoder of a single camera."""
    encoded = encode_camera(encoder, sensor, frames.flatten(0, 1))
    views, logits = (x.unflatten(0, frames.shape[:2]) for x in encoded)
    return label_output(views, logits, sensor, truth)
