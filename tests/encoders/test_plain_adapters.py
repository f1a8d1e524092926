"""Tests that ``plain_adapters.py`` gives the same results as ``load_adapters``.

It must run no code from the folder of adapters, and must work if users copy the file.
"""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import torch
from safetensors.torch import save_file
from torch import nn

from mitigate.agents.adapters import insert_adapters, load_adapters, save_adapters
from mitigate.agents.fingerprint import contents, fingerprint
from mitigate.core import folders
from mitigate.encoders import plain_adapters
from tests.encoders.test_token_adapters import ENCODERS, answer, shaken

FILE = Path(plain_adapters.__file__)


@pytest.mark.parametrize("gate", [False, True])
@pytest.mark.parametrize("name", sorted(ENCODERS))
def test_attach_equals_load_adapters(name, gate, tmp_path):
    make, shape, target, *_ = ENCODERS[name]
    torch.manual_seed(0)
    model, frames = make().eval(), torch.randn(5, *shape)
    state = {k: v.clone() for k, v in model.state_dict().items()}
    insert_adapters(model, [target], run=lambda n: model(frames[:n]), gate=gate)
    save_adapters(shaken(model), tmp_path)
    torch.manual_seed(1)
    other = make().eval()
    other.load_state_dict(state)
    assert plain_adapters.attach(other, tmp_path) is other
    with torch.no_grad():
        assert torch.equal(answer(other, frames), answer(model, frames))
    assert list(other.state_dict()) == list(state)


def saved(folder: Path, gate: bool = False) -> nn.Module:
    make, shape, target, *_ = ENCODERS["cnn"]
    torch.manual_seed(0)
    model, frames = make().eval(), torch.randn(3, *shape)
    insert_adapters(model, [target], run=lambda n: model(frames[:n]), gate=gate)
    save_adapters(shaken(model), folder)
    torch.manual_seed(0)
    return make().eval()


def test_attach_rejects_a_changed_file(tmp_path):
    model, file = saved(tmp_path), tmp_path / plain_adapters.WEIGHTS
    data = bytearray(file.read_bytes())
    data[-1] ^= 1
    file.write_bytes(data)
    with pytest.raises(ValueError, match="does not have the sha256 of the manifest"):
        plain_adapters.attach(model, tmp_path)


def wrong(folder: Path, name: str, value: torch.Tensor) -> None:
    """Add an unknown tensor to the adapters in ``folder``, with valid checksums."""
    file = folder / plain_adapters.WEIGHTS
    tensors = plain_adapters.parse(file.read_bytes())
    save_file({**tensors, name: value}, file)
    folders.seal(folder, "adapters")


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("blocks/0.up.bias", lambda v: v.fill_(float("nan"))),
        ("blocks/0.up.bias", lambda v: v.fill_(float("inf"))),
        ("blocks/0.up.bias", lambda v: v.long()),
        ("blocks/9.up.bias", lambda v: v),
        ("blocks/0.up.more", lambda v: v),
        ("extra", lambda v: v),
    ],
)
def test_both_readers_reject_surplus_tensors(tmp_path, name, change):
    model = saved(tmp_path)
    tensors = plain_adapters.parse((tmp_path / plain_adapters.WEIGHTS).read_bytes())
    wrong(tmp_path, name, change(tensors["blocks/0.up.bias"].clone()))
    for read in (plain_adapters.attach, load_adapters):
        with pytest.raises(ValueError, match=re.escape(str(tmp_path))):
            read(model, tmp_path)
    assert not any(m._forward_hooks for m in model.modules())


def test_attach_rejects_another_encoder(tmp_path):
    model = saved(tmp_path)
    nn.init.zeros_(model.stem.weight)
    with pytest.raises(ValueError, match="Load weights with the first hash"):
        plain_adapters.attach(model, tmp_path)
    plain_adapters.attach(model, tmp_path, check=False)
    with pytest.raises(ValueError, match=r"no module called blocks\.0"):
        plain_adapters.attach(nn.Linear(2, 2), tmp_path)


@pytest.mark.parametrize(
    "shape",
    [
        {"channels": 8, "reduction": 8, "kernel": 3, "views": 12, "hfov": 90},
        {"channels": 1 << 40, "reduction": 1, "kernel": 3},
        {"channels": 8, "reduction": 0, "kernel": 3},
        {"channels": 8, "reduction": 8, "kernel": 2},
        {"channels": 8, "reduction": 8, "kernel": 3, "_target_": "os.system"},
        "conv",
    ],
)
def test_attach_rejects_invalid_settings(tmp_path, shape):
    model, file = saved(tmp_path), tmp_path / plain_adapters.SETTINGS
    settings = json.loads(file.read_text())
    settings["adapters"]["blocks.0"] = shape
    file.write_text(json.dumps(settings))
    with pytest.raises(
        ValueError, match="damaged, or has adapters that this module does not support"
    ):
        plain_adapters.attach(model, tmp_path)


def test_attach_rejects_a_second_call(tmp_path):
    model = plain_adapters.attach(saved(tmp_path), tmp_path)
    with pytest.raises(ValueError, match="has adapters already"):
        plain_adapters.attach(model, tmp_path)


@pytest.mark.parametrize(("name", "value"), [("kind", "x"), ("gate", 1)])
def test_load_adapters_rejects_the_same_settings(tmp_path, name, value):
    model, file = saved(tmp_path, gate=True), tmp_path / plain_adapters.SETTINGS
    settings = json.loads(file.read_text())
    settings["adapters"]["blocks.0"][name] = value
    file.write_text(json.dumps(settings))
    for load in (plain_adapters.attach, load_adapters):
        with pytest.raises(ValueError, match="damaged"):
            load(model, tmp_path)


@pytest.mark.parametrize("cut", [4, 40, -8])
def test_parse_rejects_a_cut_file(tmp_path, cut):
    saved(tmp_path)
    with pytest.raises(ValueError, match="damaged"):
        plain_adapters.parse((tmp_path / plain_adapters.WEIGHTS).read_bytes()[:cut])


def test_module_imports_only_numpy_and_torch():
    tree = ast.parse(FILE.read_text(encoding="utf-8"), feature_version=(3, 6))
    names = {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    assert names <= {"hashlib", "json", "os", "re", "numpy", "torch", "torch.nn.functional"}
    assert not [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)]


@pytest.mark.slow
def test_module_works_as_a_copy(tmp_path):
    """The copy runs in a separate process that cannot import this project."""
    saved(tmp_path)
    (tmp_path / "plain_adapters.py").write_text(FILE.read_text(encoding="utf-8"))
    code = (
        "import sys; sys.modules['mitigate'] = None; import plain_adapters as p; "
        "print(len(p.read('.')[0]['adapters']), len(p.read('.')[1]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["4", "16"]


class Policy:
    """An agent with an encoder."""

    settings = {"kind": "policy"}

    def __init__(self, encoder: nn.Module) -> None:
        self.encoder = encoder


def test_attach_changes_the_fingerprint(tmp_path):
    def encoder() -> nn.Module:
        torch.manual_seed(0)
        return nn.Sequential(nn.Conv2d(3, 8, 3), nn.Conv2d(8, 8, 3)).eval()

    hashes = [fingerprint(Policy(encoder()), {})]
    for number, target in enumerate(("0", "1", "1")):
        model = encoder()
        insert_adapters(model, [target])
        torch.manual_seed(number)
        save_adapters(shaken(model), tmp_path / str(number))
        agents = [Policy(plain_adapters.attach(encoder(), tmp_path / str(number))) for _ in "ab"]
        assert fingerprint(agents[0], {}) == fingerprint(agents[1], {})
        assert not contents(agents[0]).unreadable
        hashes.append(fingerprint(agents[0], {}))
    assert len(set(hashes)) == 4
