"""Tests of encoder gates: the features of frames classified as clean stay bit-identical."""

from __future__ import annotations

import copy

import pytest
import torch
from torch import nn

from mitigate.agents import adapters
from mitigate.agents.adapter_layers import ConvAdapter, FrameGate, textures
from mitigate.agents.adapters import insert_adapters, load_adapters, remove_adapters, save_adapters
from mitigate.agents.encoders import RGBEncoder

PLACES = {"target_modules": ["stages.0"], "ring": ["stages.[12]"], "gates": ["stem"]}


@pytest.fixture
def encoder():
    torch.manual_seed(0)
    return RGBEncoder(16, size=16).eval()


@pytest.fixture
def frames():
    return torch.randint(0, 256, (24, 16, 16, 3), dtype=torch.uint8)


def trained(model: nn.Module) -> nn.Module:
    """Set the weights of adapters and gate to large random values."""
    for parameter in adapters.adapter_parameters(model):
        nn.init.normal_(parameter, std=0.3)
    return model.eval()


def gate_of(model: nn.Module) -> FrameGate:
    return next(module for module in model.modules() if isinstance(module, FrameGate))


def centred(model: nn.Module, frames: torch.Tensor) -> torch.Tensor:
    """Open the gate for half of the ``frames``, and return a mask of these frames."""
    model(frames)
    gate = gate_of(model)
    with torch.no_grad():
        gate.judge.bias -= gate.judged.logits.median()
    model(frames)
    return gate.judged.logits > 0


def test_closed_gate_keeps_features_without_adapters(encoder, frames):
    plain = encoder(frames)[0]
    insert_adapters(encoder, **PLACES)
    opened = centred(trained(encoder), frames)
    model = encoder(frames)[0]
    same = (model == plain).all(1)
    assert 0 < opened.sum() < len(frames)
    assert torch.equal(same, ~opened)


def test_gate_insertion_and_removal_keep_outputs(encoder, frames):
    plain = encoder(frames)[0]
    names = insert_adapters(encoder, **PLACES)
    assert names == ["stem", "stages.0", "stages.1", "stages.2"]
    assert torch.equal(encoder(frames)[0], plain)
    trained(encoder)
    remove_adapters(encoder)
    assert torch.equal(encoder(frames)[0], plain)


class Patches(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.stem, self.block = nn.Conv2d(3, 8, 4, 4), nn.Linear(8, 8)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.block(self.stem(x).flatten(2).mT)


def test_insert_rejects_a_gate_without_adapters():
    model, frames = Patches(), torch.randn(3, 3, 8, 8)
    with pytest.raises(ValueError, match="gate at stem controls no adapter"):
        insert_adapters(model, ["block"], gates=["stem"], run=lambda n: model(frames[:n]))
    assert not adapters.adapted(model)


def test_single_camera_gets_plain_adapters(encoder):
    insert_adapters(encoder, [], ring=["stages.[12]"], views=1, gate=True, middle=2)
    assert all(m.gate is not None for m in encoder.modules() if isinstance(m, ConvAdapter))


def test_gate_trains_with_the_adapters(encoder, frames):
    insert_adapters(encoder, **PLACES)
    trained(encoder).train()
    loss = encoder(frames)[0].sum()
    (loss + gate_of(encoder).judged.logits.sum()).backward()
    assert all(p.grad is not None for p in adapters.adapter_parameters(encoder))
    assert all(p.grad is None for p in encoder.stages[0].first.parameters())


def test_training_adapters_correct_every_frame(encoder, frames):
    insert_adapters(encoder, ["stages.[012]"], gates=["stem"])  # no neighbours
    opened = centred(trained(encoder), frames)
    in_use = encoder(frames)[0]
    training = encoder.train()(frames)[0]
    assert torch.equal(training[opened], in_use[opened])
    assert not torch.equal(training[~opened], in_use[~opened])


def test_calibrate_opens_for_a_share_of_frames(encoder, frames):
    insert_adapters(encoder, **PLACES)
    gate = gate_of(trained(encoder))
    for _ in range(2):  # removing the gate a second time has no effect
        encoder(frames)
        gate.calibrate(gate.judged.logits, 0.25)
        encoder(frames)
        assert int((gate.judged.logits > 0).sum()) == 6


def test_textures_change_with_corruptions():
    torch.manual_seed(0)
    ramp = torch.linspace(-1, 1, 32).expand(1, 1, 32, 32)
    clean = torch.where(torch.arange(32) % 8 < 4, ramp, -ramp)
    changed = {
        "noise": clean + 0.05 * torch.randn_like(clean),
        "blur": torch.nn.functional.avg_pool2d(clean, 3, 1, 1),
        "steps": (clean * 4).round() / 4,
        "dark": clean * 0.3 - 0.7,
    }
    for name, frame in changed.items():
        assert (textures(frame) - textures(clean)).abs().max() > 0.1, name


def test_folder_and_copy_keep_the_gate(encoder, frames, tmp_path):
    insert_adapters(encoder, **PLACES)
    centred(trained(encoder), frames)
    expected = encoder(frames)[0]
    copied = copy.deepcopy(encoder)
    save_adapters(encoder, tmp_path)
    remove_adapters(encoder)
    assert load_adapters(encoder, tmp_path) == ["stem", "stages.0", "stages.1", "stages.2"]
    assert torch.equal(encoder.eval()(frames)[0], expected)
    with torch.no_grad():
        gate_of(encoder).judge.bias += 100  # the copy has a separate gate
    assert torch.equal(copied(frames)[0], expected)


def test_each_encoder_has_a_separate_gate(frames):
    torch.manual_seed(0)
    both = nn.ModuleDict({n: RGBEncoder(16, size=16) for n in ("one", "two")})
    insert_adapters(both, ["stages.[012]"], gates=["stem"])
    followed = {
        name: module.adapter.gates
        for name, module in both.named_modules()
        if name.endswith(("stages.0", "stages.2"))
    }
    for name, gates in followed.items():
        assert gates == [both[name.split(".")[0]].stem.adapter]


def test_gate_rejects_invalid_arguments(encoder):
    with pytest.raises(ValueError, match="target_modules names no module"):
        insert_adapters(encoder, [], gates=["stem"])
    with pytest.raises(ValueError, match="of a gate must be >= 1"):
        FrameGate(0)
