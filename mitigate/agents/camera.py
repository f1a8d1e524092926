"""Encoders of one camera's view, which say what shows in each of its four columns.

They are those of the panorama (``encoders.py``) but for their ends: an agent with one camera steers
by where in the view a thing is. Agents that have them call :func:`see` in theirs.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.agent import Output
from mitigate.agents.concepts import CONCEPTS, THINGS
from mitigate.agents.encoders import GRID, SIZE, Encoder, depth_channels
from mitigate.agents.losses import agreement, f1, free_loss, presence_loss
from mitigate.core.observation import DEPTH

DIRECTIONS, DISTANCES, STEP = 30, 12, 0.25  # of the free space ahead: over 90 degrees, of metres
ENCODERS = {"rgb": ("rgb_encoder",), "depth": ("depth_encoder",)}
LABELS = {"rgb": "concepts", "depth": "free"}


class CameraRGB(Encoder):
    """uint8 ``[n, H, W, 3]`` to features ``[n, 4, width]`` of the columns of each view, and logits
    ``[n, 4, C]`` of what shows in them."""

    def __init__(
        self,
        stem: int = 32,
        widths: tuple[int, ...] = (48, 96, 160),
        width: int = 96,
        size: int = SIZE,
    ) -> None:
        super().__init__(3, stem, tuple(widths), size, "area")
        last = widths[-1]
        self.gather = nn.Conv2d(last, 2 * last, (GRID, 1), groups=last)
        self.embed = nn.Linear(2 * last, width)
        self.concepts = nn.Linear(width, len(CONCEPTS))

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        x = F.gelu(self.gather(self.maps(self.sized(rgb) / 127.5 - 1)))
        features = F.gelu(self.embed(x.squeeze(2).transpose(1, 2)))
        return features, self.concepts(features)


class CameraDepth(Encoder):
    """float32 metres ``[n, H, W, 1]`` to features ``[n, 4, width]`` of the columns of each view,
    and logits ``[n, 30, 12]`` of where the agent can go straight: by angle, from 45 degrees left to
    45 right, and by distance, 0.25 to 3 m."""

    def __init__(
        self,
        stem: int = 24,
        widths: tuple[int, ...] = (32, 64, 96),
        width: int = 64,
        size: int = SIZE,
    ) -> None:
        super().__init__(2, stem, tuple(widths), size, "nearest-exact")
        self.rows = nn.Conv2d(widths[-1], widths[-1], (GRID, 1))
        self.embed = nn.Linear(widths[-1], width)
        self.free = nn.Sequential(
            nn.Linear(GRID * width, 160), nn.GELU(), nn.Linear(160, DIRECTIONS * DISTANCES)
        )

    def forward(self, depth: Tensor) -> tuple[Tensor, Tensor]:
        x = F.relu(self.rows(self.maps(depth_channels(self.sized(depth)))))
        features = F.gelu(self.embed(x.squeeze(2).transpose(1, 2)))
        return features, self.free(features.flatten(1)).unflatten(1, (DIRECTIONS, DISTANCES))


def free_metres(logits: Tensor) -> Tensor:
    """Metres ``[n, 30]`` that the way is expected to be free, of logits ``[n, 30, 12]``."""
    return STEP * logits.sigmoid().cumprod(-1).sum(-1)


def see(
    encoder: CameraRGB | CameraDepth, sensor: str, frames: Tensor, truth: Tensor | None
) -> Output:
    """As ``agents/agent.py`` says of ``see``; the features are those of all columns with what the
    encoder says shows there (RGB) or is free (depth, metres)."""
    features, logits = (x.unflatten(0, frames.shape[:2]) for x in encoder(frames.flatten(0, 1)))
    said = free_metres(logits) if sensor == DEPTH else logits.sigmoid().flatten(-2)
    out = Output(features={"views": torch.cat([features.flatten(-2), said], -1)})
    if truth is None:
        return out
    if sensor == DEPTH:
        out.losses = {"labels": free_loss(logits, truth)}
        out.figures = {"iou": agreement(logits, truth)}
    else:
        out.losses = {"labels": presence_loss(logits, truth)}
        out.figures = {
            "f1": f1(logits[..., THINGS], truth[..., THINGS]),
            "f1_all": f1(logits, truth),
        }
    return out
