"""Tests that each corruption has one record, and that a suite can contain a corruption from another
package."""

from __future__ import annotations

import importlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mitigate.core import conf
from mitigate.corruptions import INSTRUCTION, NAMES, Record, Schedule, corrupt, registry
from mitigate.evaluation import evaluate
from mitigate.worlds.apartments import simulator
from tools.pages.descriptions import DESCRIPTIONS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/bring-your-own.md").read_text(encoding="utf-8")
MINE = re.search(r"`rain.py`:\n\n```python\n(.*?)```", PAGE, re.DOTALL)[1]
POINT = re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)[1]


def suite(name: str) -> list[str]:
    return list(conf.load_config("evaluate", [f"suite={name}"]).suite.conditions)


@pytest.mark.slow
def test_suites_match_the_records():
    assert suite("full") == ["clean", *NAMES]
    assert suite("rgb") == ["clean", *registry.names("rgb")]
    assert suite("depth") == ["clean", *registry.names("depth")]
    assert suite("instructions") == ["clean", *INSTRUCTION]


@pytest.mark.parametrize("name", NAMES)
def test_record_is_described_in_the_docs(name):
    record = registry.record(name)
    assert record.severity and all(DESCRIPTIONS[name])
    assert record.name == name and name in registry.table()


def test_wrong_record_is_rejected():
    def same(views, *_):
        return views

    for wrong, message in (
        ({"modality": "sonar"}, "rgb, depth, instruction"),
        ({"name": "Heavy Rain"}, "lower case letters"),
        ({"apply": None}, "must be a function"),
    ):
        with pytest.raises(ValueError, match=message):
            Record(**{"name": "rain", "modality": "rgb", "apply": same, "severity": "s", **wrong})


@pytest.fixture
def package(tmp_path) -> Path:
    """A folder in which the package from the documentation page is installed."""
    (tmp_path / "rain.py").write_text(MINE)
    group, line = POINT.strip().splitlines()
    folder = tmp_path / "rain-1.0.dist-info"
    folder.mkdir()
    name, _, value = line.partition(" = ")
    assert group == '[project.entry-points."mitigate.corruptions"]'
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: rain\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        f"[mitigate.corruptions]\n{name} = {value.strip(chr(34))}\n"
    )
    return tmp_path


@pytest.fixture
def installed(package) -> dict[str, str]:
    """Return the environment of a process that can import the package."""
    return {**os.environ, "PYTHONPATH": f"{package}{os.pathsep}{ROOT}"}


@pytest.fixture
def add_to_path(package, monkeypatch):
    """Return a function that makes this process import the package again after a change."""

    def forget():
        registry.plugin_records.cache_clear()
        sys.modules.pop("rain", None)
        importlib.invalidate_caches()

    monkeypatch.syspath_prepend(package)
    # without bytecode files, Python also notices a change within the same second
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    forget()
    yield forget
    forget()


def run(installed: dict[str, str], folder: Path, *command: str) -> str:
    done = subprocess.run(
        [sys.executable, *command], cwd=folder, env=installed, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_external_corruption_joins_a_suite_and_a_schedule(
    add_to_path, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)
    options = ["episodes=1", "conditions=[clean,rain,flare]", "env.size=32", "workers=1"]
    monkeypatch.setattr(sys, "argv", ["mitigate evaluate", *options, f"out={tmp_path}/out"])
    evaluate.main()
    printed = capsys.readouterr().out
    assert "| Rain |" in printed and "PRS-SR (Other)" in printed
    rows = [json.loads(x) for x in (tmp_path / "out/rows.jsonl").read_text().splitlines()]
    assert {row["corruption"] for row in rows} == {"clean", "rain", "flare"}
    assert {row.get("version") for row in rows if row["corruption"] == "rain"} == {"1"}
    changed = (tmp_path / "rain.py").read_text().replace('version="1"', 'version="2"')
    (tmp_path / "rain.py").write_text(changed)
    add_to_path()
    evaluate.main()
    assert len((tmp_path / "out/rows.jsonl").read_text().splitlines()) == 4
    drawn, _ = Schedule.always("rain", 0.5).draw(0, "e", 1)
    assert (drawn.name, drawn.modality) == ("rain", "rgb") and "rain" not in NAMES


def test_external_corruption_must_repeat_its_pixels(add_to_path, tmp_path):
    frame = np.zeros((16, 16, 3), np.uint8)
    assert corrupt(frame, "rain", 0.9, key=1).any()
    code = (tmp_path / "rain.py").read_text()
    impure = code.replace('generator(key.seed, "rain", key.episode, key.frame)', "np.random")
    assert impure != code
    (tmp_path / "rain.py").write_text(impure.replace("rng.random(", "rng.random_sample("))
    add_to_path()
    with pytest.raises(ValueError, match="'rain' must give the same pixels for the same key"):
        corrupt(frame, "rain", 0.9, key=1)


def test_external_corruption_is_listed_in_another_process(installed, tmp_path):
    assert "rain" in run(installed, tmp_path, "-m", "mitigate.corrupt", "--list")


def test_external_corruption_depends_on_key_and_severity(installed, tmp_path):
    code = (
        "import numpy as np\nfrom mitigate.corruptions import corrupt\n"
        "frame = np.full((32, 32, 3), 90, np.uint8)\n"
        "a, b, c = (corrupt(frame, 'rain', 0.8, key=k) for k in (1, 1, 2))\n"
        "assert (a == b).all() and (a != c).any() and (a != frame).any()\n"
        "assert (corrupt(frame, 'rain', 0, key=1) == frame).all()"
    )
    run(installed, tmp_path, "-c", code)


def test_uninstalled_name_is_unknown():
    with pytest.raises(KeyError):
        registry.record("rain")
    assert registry.title("rain_drops") == "Rain drops"


def test_broken_package_is_skipped_with_a_warning(installed, tmp_path):
    (tmp_path / "rain.py").write_text("raise ImportError('no cloud')")
    code = (
        "import warnings\nfrom mitigate.corruptions import registry\n"
        "with warnings.catch_warnings(record=True) as said:\n    known = registry.known('rgb')\n"
        "ours = {*registry.names('rgb'), *registry.unseen_names('rgb'), 'broad_rgb'}\n"
        "assert {*known} == ours, known\n"
        "print(said[0].message)"
    )
    message = run(installed, tmp_path, "-c", code)
    assert "rain = rain:RAIN of rain is left out" in message and "no cloud" in message
