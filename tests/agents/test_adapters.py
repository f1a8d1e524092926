"""Tests that inserting adapters keeps the outputs, training keeps the backbone, and removal
restores the model."""

from __future__ import annotations

import copy
import json
import re
from collections import OrderedDict
from pathlib import Path

import pytest
import torch
from torch import Tensor, nn

from mitigate.agents import adapters
from mitigate.agents.adapters import (
    insert_adapters,
    load_adapters,
    remove_adapters,
    save_adapters,
    scale_adapters,
)
from mitigate.agents.building import build_agent
from mitigate.core import conf
from mitigate.core.checkpoint import weights_sha
from mitigate.core.observation import VIEWS
from mitigate.encoders import plain_adapters


class Bottleneck(nn.Module):
    """The block of ResNet-50: 1x1, 3x3 and 1x1 convolutions with BatchNorm."""

    def __init__(self, inputs: int, middle: int, stride: int) -> None:
        super().__init__()
        self.conv1, self.bn1 = nn.Conv2d(inputs, middle, 1, bias=False), nn.BatchNorm2d(middle)
        self.conv2 = nn.Conv2d(middle, middle, 3, stride, 1, bias=False)
        self.bn2 = nn.BatchNorm2d(middle)
        self.conv3 = nn.Conv2d(middle, 4 * middle, 1, bias=False)
        self.bn3 = nn.BatchNorm2d(4 * middle)
        self.downsample = nn.Sequential(
            nn.Conv2d(inputs, 4 * middle, 1, stride, bias=False), nn.BatchNorm2d(4 * middle)
        )

    def forward(self, x: Tensor) -> Tensor:
        y = torch.relu(self.bn1(self.conv1(x)))
        y = self.bn3(self.conv3(torch.relu(self.bn2(self.conv2(y)))))
        return torch.relu(y + self.downsample(x))


class ResNet(nn.Module):
    """A narrow network with the structure of torchvision's ResNet-50: a stem and layer1 to
    layer4."""

    def __init__(self) -> None:
        super().__init__()
        self.conv1, self.bn1 = nn.Conv2d(3, 8, 7, 2, 3, bias=False), nn.BatchNorm2d(8)
        for i, (inputs, middle) in enumerate(((8, 4), (16, 8), (32, 16), (64, 32)), 1):
            block = Bottleneck(inputs, middle, 1 if i == 1 else 2)
            self.add_module(f"layer{i}", nn.Sequential(block, Bottleneck(4 * middle, middle, 1)))
        self.fc = nn.Linear(128, 10)

    def forward(self, x: Tensor) -> Tensor:
        x = torch.relu(self.bn1(self.conv1(x)))
        for i in range(1, 5):
            x = self.get_submodule(f"layer{i}")(x)
        return self.fc(x.mean((2, 3)))


def ddppo() -> nn.Module:
    """A narrow network with the structure of DDPPO's depth encoder: GroupNorm, ``backbone`` and
    ``compression``."""

    def stage(a: int, b: int) -> nn.Module:
        return nn.Sequential(nn.Conv2d(a, b, 3, 2, 1, bias=False), nn.GroupNorm(4, b), nn.ReLU())

    backbone = nn.Sequential()
    for i, (a, b) in enumerate(((1, 8), (8, 16), (16, 32)), 1):
        backbone.add_module(f"layer{i}", stage(a, b))
    compression = nn.Sequential(nn.Conv2d(32, 16, 3, padding=1), nn.GroupNorm(1, 16), nn.ReLU())
    return nn.Sequential(OrderedDict(backbone=backbone, compression=compression))


ENCODERS = {
    "resnet": (ResNet, [r"layer[1-4]"], (2, 3, 32, 32), 4),
    "ddppo": (ddppo, [r"backbone\.layer\d", "compression"], (2, 1, 32, 32), 4),
}


@pytest.fixture(params=sorted(ENCODERS))
def encoder(request):
    make, targets, shape, count = ENCODERS[request.param]
    torch.manual_seed(0)
    return make().eval(), targets, torch.randn(shape), count


def shaken(model: nn.Module) -> nn.Module:
    for parameter in adapters.adapter_parameters(model):
        nn.init.normal_(parameter, std=0.1)
    return model


def test_insert_keeps_outputs_bit_identical(encoder):
    model, targets, x, count = encoder
    expected, before = model(x), weights_sha(model)
    assert len(insert_adapters(model, targets)) == count
    assert torch.equal(model(x), expected) and adapters.backbone_sha(model) == before


def test_training_changes_only_adapters(encoder):
    model, targets, x, _ = encoder
    insert_adapters(model, targets)
    before = adapters.backbone_sha(model)
    model.eval()  # the running statistics of BatchNorm have not changed either
    optimizer = torch.optim.SGD([p for p in model.parameters() if p.requires_grad], lr=0.1)
    first = model(x)
    for _ in range(3):
        optimizer.zero_grad()
        model(x).square().mean().backward()
        optimizer.step()
    assert adapters.backbone_sha(model) == before
    assert not torch.equal(model(x), first)


def test_remove_and_load_restore_the_outputs(encoder, tmp_path):
    model, targets, x, count = encoder
    clean, before = model(x), weights_sha(model)
    insert_adapters(model, targets)
    damaged = shaken(model)(x)
    save_adapters(model, tmp_path)
    remove_adapters(model)
    assert torch.equal(model(x), clean) and weights_sha(model) == before
    assert len(load_adapters(model, tmp_path)) == count
    assert torch.equal(model(x), damaged) and not torch.equal(damaged, clean)


def test_scale_multiplies_the_correction(encoder, tmp_path):
    model, targets, x, _ = encoder
    clean = model(x)
    insert_adapters(model, targets)
    full, before = shaken(model)(x), weights_sha(model)
    scale_adapters(model, 1.0)
    assert weights_sha(model) == before
    scale_adapters(model, 0.5)
    half = (model(x) - clean).norm()
    assert 0 < half < (full - clean).norm()
    scaled = model(x)
    save_adapters(model, tmp_path)
    remove_adapters(model)
    load_adapters(model, tmp_path)
    assert torch.equal(model(x), scaled)
    scale_adapters(model, 0.0)
    assert torch.equal(model(x), clean)


@pytest.mark.parametrize("kind", ["map", "tokens", "ring"])
def test_scale_covers_every_kind(kind):
    layer = nn.Linear(8, 8) if kind == "tokens" else nn.Conv2d(8, 8, 1)
    model = nn.Sequential(layer)
    x = torch.randn((3, 5, 8) if kind == "tokens" else (3, 8, 4, 4))
    clean = model(x)
    run = (lambda n: model(x[:n])) if kind == "tokens" else None
    ring = ["0"] if kind == "ring" else []
    insert_adapters(model, [] if ring else ["0"], ring=ring, views=3, run=run)
    full = (shaken(model)(x) - clean).norm()
    scale_adapters(model, 0.5)
    assert 0.2 * full < (model(x) - clean).norm() < 0.8 * full
    scale_adapters(model, 0.0)
    assert torch.equal(model(x), clean)


def test_find_sites_restores_modes():
    model = nn.Sequential(nn.Conv2d(3, 8, 3), nn.BatchNorm2d(8)).train()
    model[1].eval()  # users who train layers around a frozen encoder do this
    insert_adapters(model, ["0"], run=lambda n: model(torch.zeros(n, 3, 8, 8)))
    assert model.training and model[0].training and not model[1].training


def test_scale_rejects_invalid_arguments():
    model = nn.Sequential(nn.Conv2d(8, 8, 1))
    with pytest.raises(ValueError, match="no adapters to scale"):
        scale_adapters(model, 0.5)
    insert_adapters(model, ["0"])
    for strength in (-0.1, 1.5, float("nan")):
        with pytest.raises(ValueError, match="strength must be from 0 to 1"):
            scale_adapters(model, strength)


def test_load_matches_dtype_and_rejects_adapted_models(tmp_path):
    model = ResNet().double()
    insert_adapters(model, ["layer1"])
    save_adapters(model, tmp_path)
    with pytest.raises(ValueError, match="has adapters already"):
        load_adapters(model, tmp_path)
    remove_adapters(model)
    load_adapters(model, tmp_path)
    assert {p.dtype for p in adapters.adapter_parameters(model)} == {torch.float64}


def test_adapter_is_called_once(encoder):
    model, targets, x, _ = encoder
    insert_adapters(model, targets)
    calls = []
    for name in adapters.adapted(model):
        adapter = getattr(model.get_submodule(name), adapters.NAME)
        adapter.register_forward_hook(lambda *_, name=name: calls.append(name))
    model(x)
    assert calls == [*adapters.adapted(model)]


def test_documented_example_loads_without_this_package(tmp_path, monkeypatch):
    page = (Path(__file__).parents[2] / "docs/encoder.md").read_text(encoding="utf-8")
    train, load = (b for b in re.findall(r"```python\n(.*?)```", page, re.S) if "my-adapters" in b)
    monkeypatch.chdir(tmp_path)
    torch.manual_seed(0)
    model, x = ResNet().eval(), torch.randn(2, 3, 32, 32)
    twin = copy.deepcopy(model)
    exec(train.replace("save_adapters(encoder", "shake(encoder); save_adapters(encoder"),
         {"encoder": model, "torch": torch, "shake": shaken})  # fmt: skip
    assert "mitigate" not in load
    monkeypatch.syspath_prepend(Path(plain_adapters.__file__).parent)  # simulates a copied module
    exec(load, {"encoder": twin})
    assert torch.equal(twin(x), model(x)) and adapters.adapted(model) and not adapters.adapted(twin)


def test_copy_has_separate_adapters(encoder):
    model, targets, x, _ = encoder
    clean = model(x)
    insert_adapters(model, targets)
    twin = shaken(copy.deepcopy(model))
    assert torch.equal(model(x), clean) and not torch.equal(twin(x), clean)
    remove_adapters(twin)
    assert torch.equal(twin(x), clean) and adapters.adapted(model)


def test_share_on_the_reference_agent_is_small():
    cfg = conf.load_config("train", ["recipe=conv_adapter"])
    agent = build_agent(cfg.agent, weights=cfg.init, seed=0)
    assert 0.01 <= adapters.trainable_share(agent) <= 0.04


def test_failed_insertion_keeps_the_model():
    model = nn.Sequential(nn.Conv2d(3, 8, 3), nn.Flatten(), nn.Linear(8, 4))
    for options in (
        {"target_modules": ["0", "2"]},  # the output of a Linear module is not a feature map
        {"target_modules": ["0"], "ring": ["0"], "kernel": 2},
    ):
        with pytest.raises(ValueError, match="channels of 2|kernel"):
            insert_adapters(model, **options)
        assert not adapters.adapted(model)
        assert all(p.requires_grad for p in model.parameters())
    assert insert_adapters(model, ["0"]) == ["0"]


def test_insert_rejects_an_existing_child_adapter():
    model = nn.Sequential(nn.Conv2d(3, 8, 3))
    model[0].add_module("adapter", nn.Conv2d(8, 8, 1))
    own_value = model[0].adapter
    with pytest.raises(ValueError, match="already has an attribute 'adapter'"):
        insert_adapters(model, ["0"])
    assert model[0].adapter is own_value and all(p.requires_grad for p in model.parameters())


def test_ring_reads_only_neighbours():
    torch.manual_seed(0)
    model = nn.Sequential(nn.Conv2d(3, 8, 3, padding=1)).eval()
    insert_adapters(model, [], ring=["0"])
    shaken(model)
    x = torch.randn(VIEWS, 3, 4, 4)
    changed = x.clone()
    changed[5] += 1.0
    moved = (model(changed) - model(x)).abs().amax((1, 2, 3)) > 1e-6
    assert moved.nonzero().flatten().tolist() == [4, 5, 6]


def test_ring_wraps_around_within_each_panorama():
    torch.manual_seed(0)
    model = nn.Sequential(nn.Conv2d(3, 8, 3, padding=1)).eval()
    insert_adapters(model, [], ring=["0"])
    shaken(model)
    x = torch.randn(2 * VIEWS, 3, 4, 4)
    changed = x.clone()
    changed[0] += 1.0
    moved = (model(changed) - model(x)).abs().amax((1, 2, 3)) > 1e-6
    assert moved.nonzero().flatten().tolist() == [0, 1, VIEWS - 1]


def test_insert_lists_modules_for_unknown_targets():
    with pytest.raises(ValueError, match=r"'layer9' matches none.*layer1"):
        insert_adapters(ResNet(), ["layer9"])


@pytest.mark.parametrize(
    ("targets", "kind", "text"),
    [
        ("layer1", TypeError, r"must be a list.*\['layer1'\]"),
        ([], ValueError, "names no module"),
        (["layer[1"], ValueError, "must be a regular expression"),
    ],
)
def test_invalid_targets_keep_the_model(targets, kind, text):
    model = ResNet()
    with pytest.raises(kind, match=text):
        insert_adapters(model, targets)
    assert all(p.requires_grad for p in model.parameters())


def test_save_warns_of_changed_statistics(tmp_path, recwarn):
    """In train mode, BatchNorm updates its statistics although its weights are frozen."""
    model = ResNet()
    insert_adapters(model, ["layer[1-4]"])
    model.eval()(torch.randn(2, 3, 32, 32))
    save_adapters(model, tmp_path / "kept")
    assert not recwarn.list
    model.train()(torch.randn(2, 3, 32, 32))
    with pytest.warns(UserWarning, match=r"fit only this backbone.*model\.eval\(\)"):
        save_adapters(model.eval(), tmp_path / "moved")


def test_insert_rejects_modules_without_channels():
    with pytest.raises(ValueError, match="output channels of fc are unknown"):
        insert_adapters(ResNet(), ["fc"])


def test_insert_rejects_adapted_models(encoder):
    model, targets, _, _ = encoder
    insert_adapters(model, targets)
    with pytest.raises(ValueError, match="has adapters already"):
        insert_adapters(model, targets)


@pytest.mark.parametrize(
    "spoil", ["missing", "cut", "bit", "settings", "levels", "shapes", "memory", "backbone"]
)
def test_load_rejects_invalid_folders(tmp_path, spoil):
    torch.manual_seed(0)
    model = ResNet()
    insert_adapters(model, ["layer1"])
    save_adapters(model, tmp_path)
    remove_adapters(model)
    weights, settings = tmp_path / adapters.WEIGHTS, tmp_path / adapters.SETTINGS
    if spoil == "missing":
        weights.unlink()
    elif spoil == "cut":
        weights.write_bytes(weights.read_bytes()[:100])
    elif spoil == "bit":
        whole = weights.read_bytes()
        weights.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    elif spoil == "settings":
        settings.write_text(json.dumps({"adapters": 3}), encoding="utf-8")
    elif spoil == "levels":
        settings.write_text("[" * 100_000, encoding="utf-8")
    elif spoil == "memory":  # a kernel of this size would need 100 GB
        text = settings.read_text(encoding="utf-8")
        settings.write_text(text.replace('"kernel": 3', '"kernel": 30001'), encoding="utf-8")
    elif spoil == "shapes":
        text = settings.read_text(encoding="utf-8")
        settings.write_text(text.replace('"channels": 16', '"channels": 8'), encoding="utf-8")
    else:
        with torch.no_grad():
            model.fc.bias.add_(1)
    error = FileNotFoundError if spoil == "missing" else ValueError
    with pytest.raises(error, match="is missing|truncated|are damaged|trained on a backbone"):
        load_adapters(model, tmp_path)
    assert not adapters.adapted(model)


def test_adapters_fit_a_model_without_values():
    """Loading counts the weights of an agent on the device "meta" before it allocates memory."""
    with torch.device("meta"):
        model = nn.Sequential(nn.Conv2d(3, 8, 3), nn.BatchNorm2d(8))
        assert insert_adapters(model, ["0"]) == ["0"]
