"""Tests that folders of earlier versions can be read, and that every change to them is detected."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import torch
from torch import nn

import mitigate
from mitigate.agents.adapters import insert_adapters, load_adapters, save_adapters
from mitigate.core import checkpoint, folders, older_folders
from mitigate.core.files import sha256
from mitigate.guards.frames.restorer import Restorer, load_restorer
from mitigate.guards.text.language_models.adapter_folder import adapter_tensors, read_adapter

ROOT = Path(__file__).parents[2]
SHIPPED = {
    "base": "mitigate.load",
    "recurrent/base": "mitigate.load",
    "frontier/base": "mitigate.load",
    "hardened/stacked": "mitigate.load",
    "hardened/conv_adapter": "mitigate.load",
    "restorer": "load_restorer",
    "safeguard": "adapter_tensors",
}
READERS = {
    "mitigate.load": mitigate.load,
    "load_restorer": load_restorer,
    "adapter_tensors": lambda folder: adapter_tensors(folder, read_adapter(folder)[1]),
}


def as_before(folder: Path) -> Path:
    """Convert a folder to the format without a manifest, in which each weight file has a
    sidecar."""
    (folder / folders.MANIFEST).unlink()
    for file in folder.glob("*.safetensors"):
        file.with_name(f"{file.name}.sha256").write_text(f"{sha256(file)}  {file.name}\n")
    return folder


def flip(file: Path) -> None:
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 1
    file.write_bytes(data)


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_folder_loads_and_detects_flipped_bits(name, tmp_path, monkeypatch):
    # the settings of adapters name the folder of their base agent relative to ROOT
    monkeypatch.chdir(ROOT)
    folder = Path(shutil.copytree(ROOT / "checkpoints" / name, tmp_path / "mine"))
    assert not (folder / folders.MANIFEST).exists()
    assert READERS[SHIPPED[name]](folder) is not None
    flip(next(folder.glob("*.safetensors")))
    with pytest.raises(ValueError, match="sha256"):
        READERS[SHIPPED[name]](folder)


def test_adapters_of_before_are_read(tmp_path):
    model = nn.Sequential(nn.Conv2d(3, 3, 3)).eval()
    again = nn.Sequential(nn.Conv2d(3, 3, 3)).eval()
    again.load_state_dict(model.state_dict())
    insert_adapters(model, ["0"])
    as_before(save_adapters(model, tmp_path))
    load_adapters(again, tmp_path)
    assert checkpoint.weights_sha(again) == checkpoint.weights_sha(model)
    save_adapters(model, tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {
        "adapters.json",
        "adapters.safetensors",
        folders.MANIFEST,
    }


def test_older_restorer_loads_and_needs_its_checksum(tmp_path):
    restorer = Restorer(width=4, depth_width=4, size=32)
    restorer.save(tmp_path)
    as_before(tmp_path)
    assert load_restorer(tmp_path).hash == restorer.hash
    (tmp_path / "model.safetensors.sha256").unlink()
    with pytest.raises(ValueError, match=r"not listed in the manifest\.json"):
        load_restorer(tmp_path)


def test_older_run_loads(tmp_path):
    agent = mitigate.load(ROOT / "checkpoints/frontier/base")
    text = (ROOT / "checkpoints/frontier/base/config.yaml").read_text()
    checkpoint.save_agent(agent, tmp_path, text)
    as_before(tmp_path)
    loaded = mitigate.load(tmp_path)
    assert checkpoint.weights_sha(loaded) == checkpoint.weights_sha(agent)
    (tmp_path / "model.safetensors.sha256").unlink()  # the first versions wrote no checksum
    assert torch.equal(next(mitigate.load(tmp_path).parameters()), next(iter(agent.parameters())))


def test_changed_config_is_detected_since_the_manifest(tmp_path):
    agent = mitigate.load(ROOT / "checkpoints/frontier/base")
    text = (ROOT / "checkpoints/frontier/base/config.yaml").read_text()
    checkpoint.save_agent(agent, tmp_path, text)
    assert mitigate.load(tmp_path)
    (tmp_path / "config.yaml").write_text(text + "\n")
    with pytest.raises(ValueError, match=r"config\.yaml does not have the sha256"):
        mitigate.load(tmp_path)


def test_older_hardened_folder_is_upgraded(tmp_path):
    folder = Path(shutil.copytree(ROOT / "checkpoints/hardened/stacked", tmp_path / "mine"))
    card = json.loads((folder / "card.json").read_text())
    assert older_folders.card_files(folder, "").keys() == card["files"].keys()
    remaining = older_folders.without_sums(card)
    assert card.keys() - remaining.keys() == {"files", "sha256"}
    (folder / "card.json").write_text(json.dumps(card | {"seed": 99}))
    with pytest.raises(ValueError, match="does not have the sha256 that it states"):
        folders.check(folder)
