"""Encoders with the same module structure as the encoders of navigation agents, but fewer
channels."""

from __future__ import annotations

from collections.abc import Callable

import torch
from torch import Tensor, nn


class TinyNet(nn.Module):
    """An encoder with four blocks in a list, a module ``pool`` for features, and a classifier."""

    def __init__(self, channels: int = 3, width: int = 8) -> None:
        super().__init__()
        self.stem = nn.Conv2d(channels, width, 3, 2, 1)
        self.blocks = nn.ModuleList(
            nn.Sequential(nn.Conv2d(width, width, 3, 1, 1), nn.BatchNorm2d(width), nn.ReLU())
            for _ in range(4)
        )
        self.pool, self.fc = nn.AdaptiveAvgPool2d(1), nn.Linear(width, 5)

    def forward(self, x: Tensor) -> Tensor:
        x = self.stem(x)
        for block in self.blocks:
            x = block(x)
        return self.fc(self.pool(x).flatten(1))


def tiny(channels: int = 3, width: int = 8) -> nn.Module:
    """Return an encoder with seeded weights, which stand for weights from a file."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        return TinyNet(channels, width)


class Bottleneck(nn.Module):
    """The block of habitat-baselines' ResNet-50 with GroupNorm."""

    def __init__(self, inputs: int, planes: int, groups: int, stride: int) -> None:
        super().__init__()
        out = 4 * planes
        self.convs = nn.Sequential(
            nn.Conv2d(inputs, planes, 1, bias=False),
            nn.GroupNorm(groups, planes),
            nn.ReLU(True),
            nn.Conv2d(planes, planes, 3, stride, 1, bias=False),
            nn.GroupNorm(groups, planes),
            nn.ReLU(True),
            nn.Conv2d(planes, out, 1, bias=False),
            nn.GroupNorm(groups, out),
        )
        self.relu, self.downsample = nn.ReLU(True), None
        if stride > 1 or inputs != out:
            self.downsample = nn.Sequential(
                nn.Conv2d(inputs, out, 1, stride, bias=False), nn.GroupNorm(groups, out)
            )

    def forward(self, x: Tensor) -> Tensor:
        remaining = x if self.downsample is None else self.downsample(x)
        return self.relu(self.convs(x) + remaining)


class DdppoDepth(nn.Module):
    """DDPPO's depth encoder: a ResNet-50 with GroupNorm and 32 base channels, which maps 1x256x256
    to 128x4x4."""

    def __init__(self, base: int = 32, blocks: tuple[int, ...] = (3, 4, 6, 3)) -> None:
        super().__init__()
        groups = base // 2
        self.backbone = nn.Module()
        self.backbone.conv1 = nn.Sequential(
            nn.Conv2d(1, base, 7, 2, 3, bias=False), nn.GroupNorm(groups, base), nn.ReLU(True)
        )
        self.backbone.maxpool = nn.MaxPool2d(3, 2, 1)
        inputs = base
        for i, count in enumerate(blocks):
            planes, items = base << i, []
            for block in range(count):
                items.append(Bottleneck(inputs, planes, groups, 2 if block == 0 and i else 1))
                inputs = 4 * planes
            self.backbone.add_module(f"layer{i + 1}", nn.Sequential(*items))
        self.compression = nn.Sequential(
            nn.Conv2d(inputs, 4 * base, 3, padding=1, bias=False),
            nn.GroupNorm(1, 4 * base),
            nn.ReLU(True),
        )

    def forward(self, x: Tensor) -> Tensor:
        x = nn.functional.avg_pool2d(x, 2)
        x = self.backbone.maxpool(self.backbone.conv1(x))
        for i in range(1, 5):
            x = getattr(self.backbone, f"layer{i}")(x)
        return self.compression(x)


class ResidualAttentionBlock(nn.Module):
    """The residual block of OpenAI's CLIP, which processes tokens ``[T, n, C]``."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.attn = nn.MultiheadAttention(width, heads)
        self.ln_1, self.ln_2 = nn.LayerNorm(width), nn.LayerNorm(width)
        self.mlp = nn.Sequential(
            nn.Linear(width, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )

    def forward(self, x: Tensor) -> Tensor:
        y = self.ln_1(x)
        x = x + self.attn(y, y, y, need_weights=False)[0]
        return x + self.mlp(self.ln_2(x))


class OpenAIClip(nn.Module):
    """OpenAI's VisionTransformer: it has ``transformer.resblocks``, its class token comes first,
    and its output is projected."""

    def __init__(self, width: int = 24, layers: int = 4, patch: int = 8, size: int = 32) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(3, width, patch, patch, bias=False)
        self.class_embedding = nn.Parameter(torch.randn(width))
        self.positional_embedding = nn.Parameter(torch.randn((size // patch) ** 2 + 1, width))
        self.transformer = nn.Module()
        self.transformer.resblocks = nn.Sequential(
            *(ResidualAttentionBlock(width, 4) for _ in range(layers))
        )
        self.ln_post, self.proj = nn.LayerNorm(width), nn.Parameter(torch.randn(width, 16))

    def forward(self, x: Tensor) -> Tensor:
        x = self.conv1(x).flatten(2).transpose(1, 2)
        first = self.class_embedding.expand(len(x), 1, -1)
        x = torch.cat([first, x], 1) + self.positional_embedding
        x = self.transformer.resblocks(x.transpose(0, 1)).transpose(0, 1)
        return self.ln_post(x[:, 0]) @ self.proj


class ListBlock(nn.Module):
    """A block that returns a list; its first item contains tokens ``[n, T, C]``."""

    def __init__(self) -> None:
        super().__init__()
        self.inner = nn.Linear(6, 6)

    def forward(self, x: Tensor) -> list:
        return [x + self.inner(x), None]


class ListNet(nn.Module):
    """An encoder with four :class:`ListBlock` modules. Each row of pixels is one token."""

    def __init__(self) -> None:
        super().__init__()
        self.layers = nn.ModuleList(ListBlock() for _ in range(4))

    def forward(self, x: Tensor) -> Tensor:
        x = x.mean(1)[..., :6]
        for layer in self.layers:
            x = layer(x)[0]
        return x


def _seeded(make: Callable[[], nn.Module]) -> nn.Module:
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        return make()


BRANCH = 0.2  # scale of the last normalisation layer in each residual branch (heuristic)


def ddppo() -> nn.Module:
    """Return DDPPO's depth encoder at full size with random weights.

    Residual branches are scaled down, as in trained networks. Without this, such a deep random
    network would turn any change of its input into noise.
    """
    model = _seeded(DdppoDepth)
    for block in model.modules():
        if isinstance(block, Bottleneck):
            nn.init.constant_(block.convs[-1].weight, BRANCH)
    return model


def resnet50() -> nn.Module:
    """Return the ResNet-50 of transformers with random weights; residual branches are scaled as in
    :func:`ddppo`. Its BatchNorm statistics are computed on noise, so that features of all layers
    have similar sizes."""
    from transformers import ResNetConfig, ResNetModel

    def make() -> nn.Module:
        model = ResNetModel(ResNetConfig()).train()
        for block in model.modules():
            if type(block).__name__ == "ResNetBottleNeckLayer":
                nn.init.constant_(block.layer[-1].normalization.weight, BRANCH)
        norms = [m for m in model.modules() if isinstance(m, nn.BatchNorm2d)]
        for norm in norms:
            norm.momentum = None  # the plain mean
        with torch.no_grad():
            model(torch.rand(16, 3, 96, 96))
        return model

    return _seeded(make)


def clip_vit_b32(**settings: int) -> nn.Module:
    """Return the vision part of CLIP in transformers (default ViT-B/32) with random weights."""
    from transformers import CLIPVisionConfig, CLIPVisionModel

    return _seeded(lambda: CLIPVisionModel(CLIPVisionConfig(**settings)))
