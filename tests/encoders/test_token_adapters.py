"""Tests of adapters for blocks that return feature maps, tokens ([n, T, C] or [T, n, C]), tuples or
vectors."""

from __future__ import annotations

import copy

import pytest
import torch
from torch import nn
from transformers import CLIPVisionConfig, CLIPVisionModel, ResNetConfig, ResNetModel

from mitigate.agents import adapters
from mitigate.agents.adapter_layers import TokenAdapter
from mitigate.agents.adapters import ConvAdapter, insert_adapters, load_adapters, save_adapters
from mitigate.agents.sites import choose, find_sites
from tests.encoders import shapes
from tests.encoders.shapes import DdppoDepth, ListNet, OpenAIClip, TinyNet

CLIP = {"hidden_size": 24, "intermediate_size": 48, "num_hidden_layers": 4}
CLIP |= {"num_attention_heads": 4, "image_size": 32, "patch_size": 8}
RESNET = {"embedding_size": 8, "hidden_sizes": [8, 16, 24, 32], "depths": [1, 1, 2, 1]}

# constructor, shape of a frame, names of adapted modules, class of adapter, and axis of the frames
ENCODERS = {
    "cnn": (TinyNet, (3, 32, 32), r"blocks\.\d", ConvAdapter, None),
    "ddppo": (lambda: DdppoDepth(8, (1, 1, 1, 1)), (1, 64, 64), r"layer\d", ConvAdapter, None),
    "hf-resnet": (
        lambda: ResNetModel(ResNetConfig(**RESNET)),
        (3, 32, 32),
        r"stages\.\d",
        ConvAdapter,
        None,
    ),
    "hf-clip": (
        lambda: CLIPVisionModel(CLIPVisionConfig(**CLIP)),
        (3, 32, 32),
        r"layers\.\d",
        TokenAdapter,
        0,
    ),
    "openai-clip": (OpenAIClip, (3, 32, 32), r"resblocks\.\d", TokenAdapter, 1),
    "lists": (ListNet, (3, 8, 8), r"layers\.\d", TokenAdapter, 0),
    "vector": (TinyNet, (3, 32, 32), "fc", TokenAdapter, 0),
}


@pytest.fixture(params=sorted(ENCODERS))
def encoder(request):
    make, shape, target, kind, batch = ENCODERS[request.param]
    torch.manual_seed(0)
    frames = torch.randn(5, *shape)
    return make().eval(), frames, target, kind, batch


def answer(model: nn.Module, frames: torch.Tensor) -> torch.Tensor:
    out = model(frames)
    return out if isinstance(out, torch.Tensor) else out[0]


def shaken(model: nn.Module) -> nn.Module:
    for parameter in adapters.adapter_parameters(model):
        nn.init.normal_(parameter, std=0.1)
    return model


@pytest.mark.parametrize("gate", [False, True])
def test_new_adapter_changes_nothing(encoder, gate):
    model, frames, target, kind, batch = encoder
    expected = answer(model, frames)
    names = insert_adapters(model, [target], run=lambda n: model(frames[:n]), gate=gate)
    for name in names:
        adapter = model.get_submodule(name).adapter
        assert type(adapter) is kind and (batch is None or adapter.batch == batch)
    assert torch.equal(answer(model, frames), expected)
    assert not torch.equal(answer(shaken(model), frames), expected)


@pytest.mark.parametrize("gate", [False, True])
def test_adapter_corrects_each_frame_separately(encoder, gate):
    """Frames do not influence each other, even if the batch axis is not the first axis."""
    model, frames, target, _, _ = encoder
    insert_adapters(model, [target], run=lambda n: model(frames[:n]), gate=gate)
    shaken(model)
    whole, alone = answer(model, frames), answer(model, frames[3:4])
    torch.testing.assert_close(whole[3:4], alone, rtol=1e-3, atol=1e-4)


def test_load_adapters_restores_token_adapters(encoder, tmp_path):
    model, frames, target, _, _ = encoder
    other = copy.deepcopy(model)
    insert_adapters(model, [target], run=lambda n: model(frames[:n]), gate=True)
    save_adapters(shaken(model), tmp_path)
    load_adapters(other, tmp_path)
    assert torch.equal(answer(other, frames), answer(model, frames))


def test_closed_gate_changes_nothing():
    model, frames = TinyNet().eval(), torch.randn(3, 3, 16, 16)
    expected = model(frames)
    insert_adapters(model, [r"blocks\.1"], run=lambda n: model(frames[:n]), gate=True)
    gate = model.get_submodule("blocks.1").adapter.gate
    nn.init.normal_(model.get_submodule("blocks.1").adapter.up.weight)
    nn.init.zeros_(gate.read.weight)
    nn.init.constant_(gate.read.bias, -1e4)
    assert torch.equal(model(frames), expected)


@pytest.mark.parametrize("name", ["cnn", "hf-resnet", "hf-clip", "openai-clip"])
def test_choose_spreads_blocks_evenly(name):
    make, shape, *_ = ENCODERS[name]
    model, frames = make().eval(), torch.randn(3, *shape)
    results = choose(find_sites(model, lambda n: model(frames[:n])), model, 3)
    assert len(results) == 3 and results[0].endswith(".0") and results[-1].endswith(".3")


def test_insert_adapters_names_an_unsupported_target():
    model, frames = TinyNet().eval(), torch.randn(3, 3, 16, 16)
    model.spare = nn.Conv2d(1, 1, 1)
    with pytest.raises(ValueError, match="spare: the encoder does not call it"):
        insert_adapters(model, ["spare"], run=lambda n: model(frames[:n]))
    assert not adapters.adapted(model)


def test_full_size_shapes_match_the_agents():
    """A ResNet-50 with GroupNorm and 32 base channels maps depth of 1x256x256 to features of
    128x4x4."""
    model = shapes.ddppo().eval()
    with torch.no_grad():
        assert model(torch.rand(1, 1, 256, 256)).shape == (1, 128, 4, 4)


@pytest.mark.parametrize("kind", [ConvAdapter, TokenAdapter])
@pytest.mark.parametrize("middle", [0, -1])
def test_bottleneck_has_at_least_one_channel(kind, middle):
    with pytest.raises(ValueError, match=f"middle of a .* must be >= 1, got {middle}"):
        kind(8, middle=middle)
