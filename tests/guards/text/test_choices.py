"""Tests of the names, folders, labels and content hashes of safeguards."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

from mitigate.core.files import find
from mitigate.guards.text import choices
from mitigate.guards.text.choices import identity, label
from mitigate.guards.text.guard import open_safeguard


def adapter(folder, weights: bytes) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / choices.ADAPTER_WEIGHTS).write_bytes(weights)
    return str(folder)


def test_label_tells_folders_and_endpoints_apart(tmp_path):
    first, second = (adapter(tmp_path / run / "agent", b"a") for run in ("first", "second"))
    assert label(first).startswith("first-") and label(second).startswith("second-")
    before = label(first)
    adapter(tmp_path / "first" / "agent", b"c")
    assert label(first) != before
    assert label("http://one:80/v1@m") == label("HTTP://one:80/v1@m") == "one-80-v1@m"
    assert [label(choice) for choice in ("classifier", "lora")] == ["classifier", "lora"]


def test_identity_depends_on_weights_and_versions(tmp_path, monkeypatch):
    names = ["classifier", "lora", adapter(tmp_path / "mine", b"a"), "http://one:80/v1@m"]
    before = [identity(name) for name in names]
    assert len(set(before)) == len(names) and identity("none") == "none"
    assert [identity(name) for name in names] == before
    adapter(tmp_path / "mine", b"b")
    assert identity(names[2]) != before[2]
    monkeypatch.setattr(choices, "ANSWERS", "another")
    assert identity("classifier") == before[0] and identity("lora") != before[1]
    assert open_safeguard("classifier").identity == before[0]


def test_open_safeguard_reads_the_earlier_name():
    assert open_safeguard("rules").identity == identity("classifier") == identity("rules")
    assert label("rules") == "classifier"


@pytest.mark.parametrize("choice", ["", None, 5, "tagger", "reader+none", "clasifier"])
def test_open_safeguard_lists_the_choices_for_unknown_names(choice):
    with pytest.raises(
        ValueError,
        match=r"(?:no|the name of an existing) safeguard.* one of: none, classifier, .*folder",
    ):
        open_safeguard(choice)


def test_open_safeguard_opens_a_classifier_folder(tmp_path):
    shutil.copytree(find(choices.CLASSIFIER), tmp_path / "mine")
    mine = open_safeguard(str(tmp_path / "mine"))
    assert mine.identity.startswith("mine-")
    file = tmp_path / "mine" / "classifier.safetensors"
    file.write_bytes(file.read_bytes()[:-9])
    choices_error = pytest.raises(ValueError, match="classifier.safetensors does not have the sha")
    from mitigate.guards.text import classifier

    classifier.load.cache_clear()
    with choices_error:
        open_safeguard(str(tmp_path / "mine"))


def test_open_safeguard_explains_folders_without_a_safeguard(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no safeguard in .* holds classifier\.json"):
        open_safeguard(str(tmp_path))
    (tmp_path / choices.ADAPTER_CONFIG).write_text("{}")
    with pytest.raises(FileNotFoundError, match="adapter_model.safetensors missing"):
        open_safeguard(str(tmp_path))
    (tmp_path / choices.CONFIG).write_text("{}")
    with pytest.raises(ValueError, match="holds two safeguards"):
        open_safeguard(str(tmp_path))


@pytest.mark.slow
def test_open_safeguard_needs_no_torch_by_default():
    code = (
        "import sys; from mitigate.guards.text.guard import open_safeguard; "
        "open_safeguard('classifier').canonicalise('Turn LEFT at the SOFA. Ignore the route.'); "
        "sys.exit('torch' in sys.modules or 'sklearn' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
