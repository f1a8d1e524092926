"""Tests of loading encoders and weights, and of the error messages."""

from __future__ import annotations

import os
import pickle
import sys
import types
from collections import defaultdict
from dataclasses import make_dataclass

import numpy as np
import pytest
import torch
from omegaconf import OmegaConf
from safetensors.torch import save_file

from mitigate.encoders import loading
from mitigate.encoders.loading import load_model, load_weights
from mitigate.encoders.model import Encoder, Transform
from tests.encoders.shapes import TinyNet, tiny

TINY = "tests.encoders.shapes:tiny"
FRAMES = torch.randint(0, 256, (3, 32, 32, 3), dtype=torch.uint8)


def encoder(**options) -> Encoder:
    options = {"model": TINY, "transform": {"size": 32}, "output": "pool", **options}
    return Encoder(**options).eval()


def numbered() -> torch.nn.Module:
    """Return an encoder whose modules have the names 0, 1 and 2."""
    return torch.nn.Sequential(torch.nn.Conv2d(3, 4, 3, 2, 1), torch.nn.ReLU(), torch.nn.Flatten())


def test_load_model_calls_an_import_path():
    assert load_model(TINY, {"width": 12}).fc.in_features == 12


@pytest.mark.parametrize(
    ("model", "kwargs", "says"),
    [
        ("no.such.package:make", None, "cannot be imported"),
        ("tests.encoders.shapes:tinyy", None, "Did you mean tiny"),
        (TINY, {"depth": 3}, "failed when it was called with .*unexpected keyword"),
        ("os.path:join", {"a": "b"}, "must return a torch nn.Module"),
        ("weights.pth", None, "set agent.weights to this file"),
        ("model.onnx", None, "must be an exported program"),
        ("efficientnet_lite_pytorch:EfficientNet.from_name", None, "extra 'encoders'"),
    ],
)
def test_load_model_explains_an_invalid_model(model, kwargs, says, monkeypatch):
    monkeypatch.setitem(sys.modules, "efficientnet_lite_pytorch", None)
    with pytest.raises((ValueError, FileNotFoundError), match=says):
        load_model(model, kwargs)


def drawn(width: int = 8) -> torch.nn.Module:
    """Return an encoder with random weights. Only the weights of its classifier are zero."""
    result = TinyNet(width=width)
    torch.nn.init.zeros_(result.fc.weight)
    return result


def test_encoder_rejects_random_weights_with_adapters(tmp_path):
    """Adapters fit only the weights they were trained with, and random weights are lost when the
    process ends."""
    path, state = f"{__name__}:drawn", torch.random.get_rng_state()
    with pytest.raises(
        ValueError, match=r"initialises 11 .* at random \(stem.weight.*agent.weights to"
    ):
        encoder(model=path)
    file = tmp_path / "weights.safetensors"
    save_file(drawn().state_dict(), file)
    assert encoder(model=path, weights=str(file))
    assert encoder(model=path, tune="all")  # allowed, because the folder then contains all weights
    torch.random.set_rng_state(state)
    encoder()
    after = torch.random.get_rng_state()
    torch.random.set_rng_state(state)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mitigate.encoders.model._check_fixed", lambda *_: None)
        encoder()
    assert after.equal(torch.random.get_rng_state())


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("size", [32.5, 0, None, "32", True, 10**6, float("nan")]),
        ("resize", ["bilinaer", None, 3]),
        ("crop", ["yes", 1]),
        ("bgr", [None]),
        ("scale", [0, float("nan"), float("inf"), "255"]),
        ("mean", [[], [float("nan")] * 3, 0.5, ["a"], None]),
        ("std", [[], [float("nan"), 1, 1], [0, 1, 1], [float("inf")] * 3, 1.0]),
        ("near", [-1, float("nan"), None]),
        ("far", [float("inf"), float("nan"), 0, -1, "10"]),
        ("sise", [32]),
    ],
)
def test_transform_rejects_invalid_options(name, values):
    for value in values:
        with pytest.raises(ValueError, match=rf"agent\.transform.*{name}"):
            encoder(transform={"size": 32, name: value})


class Spoiled(TinyNet):
    """An encoder whose features are NaN."""

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return super().forward(x) * float("nan")


class Centred(TinyNet):
    """An encoder that divides a frame by its standard deviation, which is 0 for constant frames."""

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return super().forward(x / x.std((1, 2, 3), keepdim=True))


def test_encoder_requires_finite_features(monkeypatch):
    monkeypatch.setattr("mitigate.encoders.model._check_fixed", lambda *_: None)
    assert encoder(model=f"{__name__}:Centred")
    with pytest.raises(ValueError, match=r"float32 \(2, 5\) with NaN or infinity"):
        encoder(model=f"{__name__}:Spoiled", output=None)


BROKEN = {
    "at_import": "1 / 0",
    "no_python": "def make(:",
    "no_name": "import no_such_package",
    "inside": "def make():\n    return 1 + 'a'",
    "key": "def make():\n    return {}['x']",
}


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("at_import", r"importing at_import failed \(ZeroDivisionError: .*at_import.py, line 1\)"),
        ("no_python", r"importing no_python failed \(SyntaxError: .*no_python.py, line 1\)\)"),
        ("no_name", "cannot be imported: No module named 'no_such_package'"),
        ("inside", r"failed when it was called with {} \(TypeError: .*inside.py, line 2\)"),
        ("key", r"failed when it was called with {} \(KeyError: 'x', in .*key.py, line 2\)"),
    ],
)
def test_load_model_locates_errors_of_user_code(tmp_path, monkeypatch, name, says):
    (tmp_path / f"{name}.py").write_text(BROKEN[name])
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match=says):
        load_model(f"{name}:make")


class Gives(TinyNet):
    """An encoder that returns an output of the type ``kind``."""

    def __init__(self, kind: str) -> None:
        super().__init__()
        self.kind = kind

    def forward(self, x):
        y = super().forward(x)
        result = {"number": y.sum(), "counts": y.long(), "nothing": None, "deep": {"a": {"b": y}}}
        return result[self.kind]


@pytest.mark.parametrize(
    ("kind", "output", "says"),
    [
        ("number", None, r"got float32 \(\) for two frames"),
        ("counts", None, r"must select finite floats .* got int64 \(2, 5\) for two"),
        ("nothing", None, "encoder returns a NoneType"),
        ("nothing", 0, "encoder returns a NoneType"),
        ("deep", None, "encoder returns a dict"),
        ("deep", "a", "encoder returns a dict"),
        ("missing", None, r"failed for rgb frames .*\(KeyError: 'missing', in .*, line [0-9]+\)"),
    ],
)
def test_encoder_explains_an_invalid_output(kind, output, says):
    with pytest.raises(ValueError, match=says):
        encoder(model=f"{__name__}:Gives", kwargs={"kind": kind}, output=output)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda v: (100 * v).int(), r"stem.weight is int32 \(8, 3, 3, 3\), not float32"),
        (lambda v: v.to_sparse(), r"stem.weight is float32 \(8, 3, 3, 3\) sparse_coo, not float32"),
    ],
)
def test_load_weights_names_differences(tmp_path, change, says):
    state = {k: change(v) if v.is_floating_point() else v for k, v in tiny().state_dict().items()}
    torch.save(state, tmp_path / "w.pth")
    with pytest.raises(ValueError, match=says):
        load_weights(tiny(), str(tmp_path / "w.pth"))


def test_load_weights_reads_half_precision(tmp_path):
    torch.save({k: v.half() for k, v in tiny().state_dict().items()}, tmp_path / "w.pth")
    result = tiny()
    load_weights(result, str(tmp_path / "w.pth"))
    assert result.stem.weight.dtype == torch.float32


@pytest.mark.parametrize("name", ["net.ts", "net.pt"])
def test_load_model_rejects_torchscript(tmp_path, name):
    torch.jit.trace(tiny().eval(), torch.randn(2, 3, 32, 32)).save(str(tmp_path / name))
    with pytest.raises(ValueError, match=r"must be an exported program .*torch\.export\.save"):
        load_model(str(tmp_path / name))


def test_exported_program_gets_inner_adapters(tmp_path):
    size = {0: torch.export.Dim("n")}
    program = torch.export.export(
        tiny().eval(), (torch.randn(2, 3, 32, 32),), dynamic_shapes=(size,)
    )
    torch.export.save(program, tmp_path / "net.pt2")
    result = encoder(model=str(tmp_path / "net.pt2"), adapters={"targets": [r"blocks\.\d"]})
    expected = encoder()(FRAMES)
    torch.testing.assert_close(result(FRAMES), expected)
    assert {"blocks.0", "blocks.3"} <= set(loading_adapted(result))


def loading_adapted(result: Encoder) -> list[str]:
    from mitigate.agents.adapters import adapted

    return [*adapted(result.model)]


@pytest.mark.parametrize("kind", ["plain", "nested", "safetensors"])
def test_load_weights_uses_the_prefix(tmp_path, kind):
    expected = TinyNet()
    state = {f"net.rgb_encoder.model.{k}": v for k, v in expected.state_dict().items()}
    state["net.other.weight"] = torch.zeros(2)
    path = tmp_path / ("w.safetensors" if kind == "safetensors" else "w.pth")
    if kind == "safetensors":
        save_file(state, path)
    else:
        torch.save({"state_dict": state, "iteration": 7} if kind == "nested" else state, path)
    result = tiny()
    load_weights(result, str(path), "net.rgb_encoder.model.")
    assert torch.equal(result.stem.weight, expected.stem.weight)
    with pytest.raises(
        ValueError, match=r"names in the file begin with net, and agent.prefix is ''"
    ):
        load_weights(result, str(path))


class Config(dict):
    """A config like a yacs config, which many navigation agents pickle with their weights."""


def test_load_weights_ignores_a_pickled_config(tmp_path, monkeypatch):
    module = types.ModuleType("somebodys_config")
    Config.__module__, Config.__qualname__ = "somebodys_config", "Config"
    module.Config = Config
    monkeypatch.setitem(sys.modules, "somebodys_config", module)
    config = Config(depth=3)
    config.frozen = True
    torch.save({"state_dict": tiny().state_dict(), "config": config}, tmp_path / "w.pth")
    monkeypatch.delitem(sys.modules, "somebodys_config")
    load_weights(tiny(), str(tmp_path / "w.pth"))
    assert "somebodys_config" not in sys.modules


def test_load_weights_ignores_a_habitat_config(tmp_path):
    kinds = [make_dataclass(f"Kind{n}", [("value", int, n)]) for n in range(40)]
    schema = {kind.__name__: OmegaConf.structured(kind) for kind in kinds}
    for kind in kinds:
        globals()[kind.__name__] = kind
        kind.__module__ = __name__
    content = {"state_dict": tiny().state_dict(), "config": OmegaConf.create(schema)}
    content["extra_state"] = {"step": defaultdict(list, a=[1])}
    torch.save(content, tmp_path / "w.pth")
    load_weights(tiny(), str(tmp_path / "w.pth"))
    torch.save(content, tmp_path / "old.pth", _use_new_zipfile_serialization=False)
    with pytest.raises(ValueError, match=r"torch.save\(model.state_dict\(\), path\)"):
        load_weights(tiny(), str(tmp_path / "old.pth"))


class Runs:
    """A class whose pickle runs a command when it is loaded."""

    def __reduce__(self):
        return (print, ("this ran",))


def test_load_weights_unpickles_nothing(tmp_path, capsys):
    (tmp_path / "w.pth").write_bytes(pickle.dumps({"a": Runs()}))
    with pytest.raises(
        ValueError, match="cannot be read without running code|must contain named tensors"
    ):
        load_weights(tiny(), str(tmp_path / "w.pth"))
    torch.save({"a": Runs()}, tmp_path / "w.pth")
    with pytest.raises(
        ValueError, match="cannot be read without running code|must contain named tensors"
    ):
        load_weights(tiny(), str(tmp_path / "w.pth"))
    assert "this ran" not in capsys.readouterr().out


class Commands:
    """A class whose pickle calls ``os.system``, which torch never allows."""

    def __reduce__(self):
        return (os.system, ("exit",))


def test_load_weights_never_suggests_unsafe_loading(tmp_path):
    torch.save({**tiny().state_dict(), "a": Commands()}, tmp_path / "w.pth")
    with pytest.raises(ValueError, match=r"\(.*\.system .*\)\. If you trust the file") as caught:
        load_weights(tiny(), str(tmp_path / "w.pth"))
    assert "weights_only" not in str(caught.value)


def test_find_weights_names_the_missing_extra():
    with pytest.raises(FileNotFoundError, match="is not installed|cannot be imported"):
        loading.find_weights("pkg://no_such_package/w.pth")


def test_encoder_output_names_an_item_or_module():
    assert encoder().output == "pool" and encoder()(FRAMES).shape == (3, 8, 1, 1)
    assert encoder(output=None)(FRAMES).shape == (3, 5)
    with pytest.raises(
        ValueError, match=r"agent.output must name an item .* got pol\. .* pool, fc"
    ):
        encoder(output="pol")


def test_encoder_output_accepts_a_numbered_module():
    numbered = {"model": f"{__name__}:numbered", "tune": "all"}
    assert encoder(**numbered, output=1)(FRAMES).shape == (3, 4, 16, 16)
    with pytest.raises(ValueError, match="agent.output must name an item .* got 7"):
        encoder(**numbered, output=7)


def test_encoder_output_explains_an_unknown_item():
    clip = {"hidden_size": 24, "intermediate_size": 48, "num_hidden_layers": 4}
    clip |= {"num_attention_heads": 4, "image_size": 32, "patch_size": 8}
    model = {"model": "tests.encoders.shapes:clip_vit_b32", "kwargs": clip}
    assert encoder(**model, output="pooler_output")(FRAMES).shape == (3, 24)
    tokens = encoder(**model, output=None, pool="first")
    assert tokens(FRAMES).shape == (3, 17, 24)
    assert torch.equal(tokens.pooled(tokens(FRAMES)), tokens(FRAMES)[:, 0])


def test_encoder_rejects_unsupported_frames():
    with pytest.raises(ValueError, match=r"failed for depth frames \[2, 1, 32, 32\]"):
        encoder(sensor="depth")
    with pytest.raises(ValueError, match="have 3 values, but depth has 1 channels"):
        encoder(sensor="depth", transform={"size": 32, "mean": [0, 0, 0], "std": [1, 1, 1]})
    with pytest.raises(ValueError, match="agent.model is not set"):
        encoder(model=None)
    with pytest.raises(ValueError, match="Did you mean adapters"):
        encoder(tune="adapter")


def test_encoder_stays_in_eval_mode():
    result = encoder(tune="all").train()
    before = {k: v.clone() for k, v in result.model.named_buffers()}
    result(FRAMES)
    assert all(torch.equal(v, before[k]) for k, v in result.model.named_buffers())


def test_transform_normalises_crops_and_clips():
    shape = (1, 20, 40, 3)
    frames = torch.full(shape, 255, dtype=torch.uint8)
    x = Transform(10, mean=[0.5] * 3, std=[0.5] * 3, crop=True)(frames)
    assert x.shape == (1, 3, 10, 10) and torch.allclose(x, torch.ones(()))
    metres = torch.tensor([0.0, 5.0, 10.0, 20.0]).reshape(1, 2, 2, 1)
    assert Transform(2, far=10.0)(metres).flatten().tolist() == [0.0, 0.5, 1.0, 1.0]
    assert Transform(2)(metres).flatten().tolist() == [0.0, 5.0, 10.0, 20.0]
    half = Transform(10, crop=True)
    left, right = torch.zeros(1, 20, 20, 3), torch.ones(1, 20, 20, 3)
    middle = half(torch.cat([left, right], 2))
    assert float(middle[..., :4].max()) < 0.01 and float(middle[..., 6:].min()) > 0.99
    with pytest.raises(ValueError, match="near"):
        Transform(2, near=3, far=2)


def test_transform_accepts_numpy_numbers():
    result = Transform(
        size=np.int64(8), scale=np.float32(255), mean=np.array([0.5] * 3), std=[np.float32(0.5)] * 3
    )
    frames = torch.full((1, 16, 16, 3), 255, dtype=torch.uint8)
    assert torch.allclose(result(frames), torch.ones(1, 3, 8, 8))
    with pytest.raises(
        ValueError, match=r"agent.transform.size must be a whole number .* got True"
    ):
        Transform(size=True)
