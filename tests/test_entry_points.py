"""Tests that every example in docs/corruption-entry-points.md runs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mitigate.corruptions import Corruption, Schedule
from mitigate.worlds.habitat_baselines import CorruptObservationConfig

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs/corruption-entry-points.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL))
LONGEST = 15  # maximum number of non-empty lines in an example


def blocks(language: str) -> list:
    return [
        pytest.param(code, id=f"{title} {number}")
        for title, text in SECTIONS.items()
        for number, code in enumerate(re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL))
    ]


def test_every_entry_point_has_a_short_example():
    assert len(SECTIONS) == 8
    for title, text in SECTIONS.items():
        examples = re.findall(r"```(?:python|bash)\n(.*?)```", text, re.DOTALL)
        assert examples, title
        lengths = [sum(bool(line) for line in code.splitlines()) for code in examples]
        assert max(lengths) <= LONGEST, title


@pytest.mark.parametrize("code", blocks("python"))
def test_python_examples_run(code, tmp_path, monkeypatch):
    if "gymnasium" in code:
        pytest.importorskip("gymnasium")
    monkeypatch.chdir(tmp_path)
    assert "assert " in code  # an example must check its result
    exec(compile(code, "example", "exec"), {"__name__": "example"})


@pytest.mark.slow
@pytest.mark.parametrize("code", blocks("bash"))
def test_commands_run(code, tmp_path):
    rng = np.random.default_rng(0)
    (tmp_path / "recorded/depth").mkdir(parents=True)
    for number in range(3):
        rgb = rng.integers(0, 255, (32, 48, 3), dtype=np.uint8)
        Image.fromarray(rgb).save(tmp_path / f"recorded/{number}.png")
        depth = rng.integers(500, 9000, (32, 48), dtype=np.uint16)
        Image.fromarray(depth).save(tmp_path / f"recorded/depth/{number}.png")
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-euc", code],
        cwd=tmp_path,
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "corrupted/2.png").is_file() and (tmp_path / "holes/depth/2.png").is_file()
    assert "motion_blur" in done.stdout


def test_named_options_match_the_code():
    listed = re.search(r"options \(`CorruptObservationConfig`\) are (.*?)\. An", PAGE, re.DOTALL)
    assert listed is not None
    names = re.findall(r"`(\w+)`", listed[1])
    assert names == [n for n in CorruptObservationConfig.__dataclass_fields__ if n != "type"]


def test_evaluation_schedule_of_the_page_is_valid():
    assert Schedule.always("spatter", 0.6).draw(0, "x", 9)[0] == Corruption("spatter", 0.6)
