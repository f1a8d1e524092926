"""Tests that untrusted checkpoints, weights and folders run no code and give clear errors."""

from __future__ import annotations

import io
import json
import os
import pickle
import shutil
import struct
import time
import zipfile
from pathlib import Path
from types import SimpleNamespace

import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.torch import save_file
from torch import nn

from mitigate.agents import adapters
from mitigate.agents import loading as agents
from mitigate.core import checkpoint, folders
from mitigate.encoders import folder as encoder_folder
from mitigate.encoders import loading, plain_adapters
from mitigate.guards.text.language_models import adapter_folder
from mitigate.training import states
from tests.bad_input.named import refused

ROOT = Path(__file__).parents[2]
FAST = settings(
    max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


class Code:
    """An object that creates the file ``ran`` when it is unpickled."""

    def __init__(self, ran: Path) -> None:
        self.ran = ran

    def __reduce__(self):
        return os.mknod, (str(self.ran),)


class Builds:
    """Like ``Code``, but inside the items that an unpickler adds to a dict."""

    def __reduce__(self):
        return dict, (), None, None, iter([("a", Code(Path("ran")))])


def saved(value, **options) -> bytes:
    with io.BytesIO() as file:
        torch.save(value, file, **options)
        return file.getvalue()


def repacked(raw: bytes, compression=zipfile.ZIP_DEFLATED, extra: dict[str, bytes] | None = None):
    with io.BytesIO() as file, zipfile.ZipFile(io.BytesIO(raw)) as old:
        with zipfile.ZipFile(file, "w", compression) as new:
            for part in old.namelist():
                new.writestr(part, old.read(part))
            for name, data in (extra or {}).items():
                new.writestr(name, data)
        return file.getvalue()


STATE = dict.fromkeys(states.REQUIRED, {}) | {"format": 1, "step": 3}
SOUND = saved(STATE | {"model": {"w": torch.arange(100.0)}})
NETWORK = nn.Linear(3, 2)


def trapped(ran: Path) -> dict[str, bytes]:
    """Return the content of files that would run code if an unsafe reader opened them."""
    code = Code(ran)
    return {
        "a pickle": pickle.dumps(code),
        "a pickle of the newest protocol": pickle.dumps({"w": code}, 5),
        "in a torch file": saved({"w": code}),
        "in an old torch file": saved({"w": code}, _use_new_zipfile_serialization=False),
        "beside tensors": saved({"w": torch.zeros(2), "note": code}),
        "as a key": saved({1: [{"deep": (code,)}]}),
        "a whole module": saved(NETWORK),
        "a global": pickle.dumps({"w": os.system}),
        "an item that is set": pickle.dumps(Builds()),
    }


DAMAGED = {
    "nothing": b"",
    "a text": b"weights",
    "zeros": bytes(4096),
    "cut": SOUND[: len(SOUND) // 2],
    "cut at the end": SOUND[:-10],
    "compressed": repacked(SOUND),
    "a bomb": repacked(SOUND, extra={"archive/data/9": bytes(1 << 26)}),
    "an empty zip": repacked(SOUND)[-22:],
    "a list": saved([1, 2, 3]),
    "a number": saved(7),
    "an empty mapping": saved({}),
    "another format": saved(STATE | {"format": 99}),
    "deep": pickle.dumps("x") * 1000,
    "an unknown opcode": b"\x80\x02\xff.",
    "a stack that is empty": b"\x80\x02.",
    "a huge text": b"\x80\x02X\xff\xff\xff\x7f",
    "a memo that is not there": b"\x80\x02h\xff.",
    "a HTML page": b"<!doctype html><html>404</html>",
    "a shell script": b"#!/bin/sh\nid\n",
    "a safetensors file": struct.pack("<Q", 2) + b"{}",
}


@pytest.mark.parametrize("raw", DAMAGED.values(), ids=DAMAGED)
def test_load_rejects_invalid_checkpoints_and_foreign_weights(tmp_path, raw):
    path = tmp_path / "step-00000003.pt"
    path.write_bytes(raw)
    assert str(path) in refused(lambda: states.load(path))
    refused(lambda: loading.load_weights(NETWORK, str(path)), str(path))
    refused(lambda: loading.load_model(str(path)))
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_load_runs_no_code_from_weights(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, raw in trapped(tmp_path / "ran").items():
        path = tmp_path / "step-00000003.pt"
        path.write_bytes(raw)
        refused(lambda path=path: states.load(path), "step-00000003.pt")
        refused(lambda path=path: loading.load_weights(NETWORK, str(path)))
        refused(lambda path=path: loading.load_model(str(path)))
        assert not (tmp_path / "ran").exists(), name


def tensors(header: object, body: bytes = b"", length: int | None = None) -> bytes:
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return struct.pack("<Q", len(text) if length is None else length) + text + body


def entry(shape, begin=0, end=4, dtype="F32"):
    return {"weight": {"dtype": dtype, "shape": shape, "data_offsets": [begin, end]}}


SAFETENSORS = {
    "nothing": b"",
    "a length alone": struct.pack("<Q", 100),
    "an endless header": tensors({}, length=1 << 62),
    "a header of text": tensors(b"hello"),
    "a header of a list": tensors([]),
    "deep": tensors(b"[" * 100_000),
    "no entries": tensors({"weight": {}}),
    "outside": tensors(entry([1], 0, 4)),
    "far outside": tensors(entry([10**15], 0, 4 * 10**15), bytes(8)),
    "negative": tensors(entry([-1], 0, 4), bytes(4)),
    "another shape": tensors(entry([7], 0, 4), bytes(4)),
    "overlapping": tensors(entry([1]) | {"bias": entry([1])["weight"]}, bytes(4)),
    "an unknown type": tensors(entry([1], dtype="PYOBJ"), bytes(4)),
    "a hole": tensors(entry([1], 4, 8), bytes(8)),
    "twice the end": tensors(entry([1], 4, 0), bytes(8)),
    "offsets of text": tensors(entry([1], "0", "4"), bytes(4)),
    "a pickle": pickle.dumps({"weight": [1.0]}),
    "not a number": tensors(entry([1]), struct.pack("<f", float("nan"))),
}


@pytest.mark.parametrize("raw", SAFETENSORS.values(), ids=SAFETENSORS)
def test_load_rejects_invalid_safetensors(tmp_path, raw):
    path = tmp_path / checkpoint.WEIGHTS
    path.write_bytes(raw)
    for read in (
        lambda: checkpoint.load_weights(NETWORK, tmp_path),
        lambda: loading.load_weights(NETWORK, str(path)),
        lambda: checkpoint.load_part(NETWORK, "weight", tmp_path),
    ):
        assert str(path) in refused(read)


def card(**changes) -> dict:
    output = {"format": 2, "adapters_only": False, "base": None, "vocabulary": None}
    return output | {"commit": "0", "agent": "0", **changes}


OTHER = "../../../etc/passwd"
CARDS = {
    "nothing": b"",
    "a list": b"[]",
    "null": b"null",
    "deep": b"[" * 100_000,
    "not a number": b'{"format": NaN}',
    "many digits": b'{"format": ' + b"1" * 10_000 + b"}",
    "bytes": bytes(range(256)),
    "large": b" " * (1 << 24) + b"{}",
    "no entries": {"format": 2},
    "another format": card(format=1),
    "format as text": card(format="2"),
    "no files": card(),
    "a base of text": card(adapters_only=True, base="checkpoints/base"),
    "a base without a path": card(adapters_only=True, base={"sha256": "0"}),
    "a base of numbers": card(adapters_only=True, base={"weights": 1, "sha256": 2}),
    "no base": card(adapters_only=True),
}


@pytest.mark.parametrize("output", CARDS.values(), ids=CARDS)
def test_load_hardened_rejects_invalid_card(tmp_path, output):
    raw = output if isinstance(output, bytes) else json.dumps(output).encode()
    (tmp_path / agents.CARD).write_bytes(raw)
    refused(lambda: agents.load_hardened(tmp_path), str(tmp_path))
    folders.seal(tmp_path, "hardened")
    refused(lambda: agents.load_hardened(tmp_path), str(tmp_path))


@pytest.mark.parametrize("folder", [None, 3, True])
def test_load_hardened_rejects_values_that_are_no_path(folder):
    with pytest.raises(TypeError, match="PathLike"):
        agents.load_hardened(folder)


@pytest.mark.parametrize("name", [OTHER, "/etc/passwd", "..", "", ".", "a/b", "./x", "a\\..\\/b"])
def test_manifest_reads_no_file_outside_its_folder(tmp_path, name):
    for each in (*agents.FILES, checkpoint.WEIGHTS):
        (tmp_path / each).write_text("x")
    (tmp_path / agents.CARD).write_text(json.dumps(card()))
    folders.seal(tmp_path, "hardened")
    file = tmp_path / folders.MANIFEST
    manifest = json.loads(file.read_text())
    manifest["files"][name] = manifest["files"][agents.CONFIG]
    file.write_text(json.dumps(manifest))
    refused(lambda: agents.load_hardened(tmp_path), "not a plain file name")


SHAPE = {"channels": 3, "reduction": 1, "kernel": 3}
ADAPTERS = {
    "nothing": b"",
    "a list": b"[]",
    "deep": b"[" * 100_000,
    "no adapters": {"adapters": {}},
    "adapters of text": {"adapters": "all", "backbone_sha256": "0"},
    "adapters in a list": {"adapters": [SHAPE], "backbone_sha256": "0"},
    "a shape of text": {"adapters": {"0": "wide"}},
    "a shape of null": {"adapters": {"0": None}},
    "an unknown module": {"adapters": {"../x": SHAPE}},
    "a module of dunders": {"adapters": {"__class__": SHAPE}},
    "no numbers": {"adapters": {"0": {}}},
    "an unknown setting": {"adapters": {"0": SHAPE | {"_target_": "os.system"}}},
    "no reduction": {"adapters": {"0": SHAPE | {"reduction": 0}}},
    "endless channels": {"adapters": {"0": SHAPE | {"channels": 10**30}}},
    "many channels": {"adapters": {"0": SHAPE | {"channels": 10**9}}},
    "channels of text": {"adapters": {"0": SHAPE | {"channels": "3"}}},
    "an endless kernel": {"adapters": {"0": SHAPE | {"kernel": 10**9}}},
    "an even kernel": {"adapters": {"0": SHAPE | {"kernel": 2}}},
    "endless views": {"adapters": {"0": SHAPE | {"views": 10**9}}},
    "tokens of nothing": {"adapters": {"0": {"kind": "tokens"}}},
}


@pytest.mark.parametrize("output", ADAPTERS.values(), ids=ADAPTERS)
def test_adapters_that_do_not_fit_are_rejected(tmp_path, output):
    network = nn.Sequential(nn.Conv2d(3, 3, 3))
    if isinstance(output, dict):
        output = {"backbone_sha256": adapters.backbone_sha(network), **output}
    (tmp_path / adapters.SETTINGS).write_bytes(
        output if isinstance(output, bytes) else json.dumps(output).encode()
    )
    checkpoint.write_tensors(nn.Linear(1, 1), tmp_path / adapters.WEIGHTS)
    refused(lambda: adapters.load_adapters(network, tmp_path))
    refused(lambda: plain_adapters.attach(network, tmp_path))
    assert not adapters.adapted(network)


PEFT = {"r": 4, "lora_alpha": 8, "lora_dropout": 0.0, "target_modules": ["q_proj"]}
PEFT_CARD = {"base": "smollm2-135m", "base_sha256": "0", "prompt": "tuned"}
PEFT_BAD = {
    "nothing": (adapter_folder.CONFIG, b""),
    "a list": (adapter_folder.CONFIG, []),
    "deep": (adapter_folder.CONFIG, b'{"r":' * 100_000),
    "rank of text": (adapter_folder.CONFIG, PEFT | {"r": "4"}),
    "rank of truth": (adapter_folder.CONFIG, PEFT | {"r": True}),
    "no rank": (adapter_folder.CONFIG, PEFT | {"r": 0}),
    "an endless rank": (adapter_folder.CONFIG, PEFT | {"r": 10**12}),
    "not a number": (adapter_folder.CONFIG, PEFT | {"lora_alpha": float("nan")}),
    "an endless dropout": (adapter_folder.CONFIG, PEFT | {"lora_dropout": float("inf")}),
    "a pattern": (adapter_folder.CONFIG, PEFT | {"target_modules": "(.*)*x"}),
    "targets of numbers": (adapter_folder.CONFIG, PEFT | {"target_modules": [1]}),
    "a base of a list": (adapter_folder.CARD, PEFT_CARD | {"base": ["x"]}),
    "no prompt": (adapter_folder.CARD, {"base": "x", "base_sha256": "0"}),
    "a card of null": (adapter_folder.CARD, None),
}


@pytest.mark.parametrize(("name", "output"), PEFT_BAD.values(), ids=PEFT_BAD)
def test_lora_rejects_invalid_folder(tmp_path, name, output):
    (tmp_path / adapter_folder.ADAPTER).write_bytes(b"")
    for file, good in ((adapter_folder.CARD, PEFT_CARD), (adapter_folder.CONFIG, PEFT)):
        (tmp_path / file).write_text(json.dumps(good))
    (tmp_path / name).write_bytes(
        output if isinstance(output, bytes) else json.dumps(output).encode()
    )
    assert str(tmp_path / name) in refused(lambda: adapter_folder.read_adapter(tmp_path))


ENCODER = {"format": 1, "sensor": "rgb", "transform": {}, "output": None, "pool": "mean"}
ENCODER_BAD = {
    "nothing": b"",
    "a list": [],
    "another format": ENCODER | {"format": 2, "tune": "all"},
    "no tune": ENCODER,
    "a sensor of a list": ENCODER | {"sensor": ["rgb"], "tune": "all"},
    "a transform of text": ENCODER | {"transform": "none", "tune": "all"},
    "deep": b"[" * 100_000,
}


@pytest.mark.parametrize("output", ENCODER_BAD.values(), ids=ENCODER_BAD)
def test_encoder_rejects_invalid_folder(tmp_path, output):
    raw = output if isinstance(output, bytes) else json.dumps(output).encode()
    (tmp_path / encoder_folder.CARD).write_bytes(raw)
    encoder = SimpleNamespace(**ENCODER, tune="all")
    encoder.transform = SimpleNamespace(settings=dict)
    refused(lambda: encoder_folder.fill(encoder, tmp_path), encoder_folder.CARD)


@FAST
@given(st.data())
def test_flipped_and_cut_bytes_are_noticed(tmp_path, data):
    """If a file has no checksum file, the checksums inside the file are checked."""
    at = data.draw(st.integers(0, len(SOUND) - 1))
    raw = SOUND[:at] + data.draw(st.binary(max_size=4)) + SOUND[at + data.draw(st.integers(0, 9)) :]
    path = tmp_path / "step-00000003.pt"
    path.write_bytes(raw)
    try:
        loaded = states.load(path)
    except ValueError as error:
        assert str(path) in str(error) and "\n" not in str(error)
    else:
        assert torch.equal(loaded["model"]["w"], torch.arange(100.0))


@FAST
@given(st.dictionaries(st.text(max_size=9), st.none() | st.integers() | st.text(max_size=9)))
def test_safetensors_header_is_rejected_or_fits(tmp_path, header):
    path = tmp_path / checkpoint.WEIGHTS
    path.write_bytes(tensors(header, bytes(16)))
    refused(lambda: checkpoint.load_weights(NETWORK, path))


def test_sound_files_of_before_are_still_read(tmp_path):
    save_file({k: v.clone() for k, v in NETWORK.state_dict().items()}, tmp_path / "w.safetensors")
    checkpoint.load_weights(NETWORK, tmp_path / "w.safetensors")
    torch.save({"state_dict": NETWORK.state_dict(), "note": {"epoch": 3}}, tmp_path / "w.pth")
    loading.load_weights(NETWORK, str(tmp_path / "w.pth"))


def test_loading_a_hardened_folder_does_not_open_its_program(tmp_path, monkeypatch):
    """A malicious manifest can contain matching checksums, so they must not make loading run
    code."""
    shutil.copytree(ROOT / "checkpoints/hardened/ts_distill", tmp_path / "mine")
    program = tmp_path / "mine" / agents.PROGRAM
    program.write_bytes(pickle.dumps(Code(tmp_path / "ran")))
    folders.seal(tmp_path / "mine", "hardened")
    monkeypatch.chdir(ROOT)
    assert not agents.load_hardened(tmp_path / "mine").training
    assert not (tmp_path / "ran").exists()


def test_load_rejects_a_huge_sparse_file_without_reading_it(tmp_path):
    """Issue T2, item 8."""
    file = checkpoint.save_weights(nn.Linear(2, 2), tmp_path)
    os.truncate(file, 1 << 40)
    began = time.monotonic()
    with pytest.raises(ValueError, match="are truncated or damaged"):
        checkpoint.load_weights(nn.Linear(2, 2), file)
    assert time.monotonic() - began < 5
