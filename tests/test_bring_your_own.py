"""Tests of the world, agent and commands in docs/bring-your-own.md, from outside the package."""

from __future__ import annotations

import importlib
import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import mitigate
from mitigate.core import conf
from mitigate.core.checkpoint import weights_sha
from mitigate.training.config import read
from mitigate.training.plan import leave_out_stages

# one pytest worker trains for all workers
pytestmark = pytest.mark.xdist_group("bring your own")

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs/bring-your-own.md").read_text(encoding="utf-8")
CODE = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)[1]
CONFIGS = dict(re.findall(r"`(mine/[\w/]+\.yaml)`[^\n]*\n\n```yaml\n(.*?)```", PAGE, re.DOTALL))
COMMANDS = re.search(r"```bash\n(.*?)```", PAGE, re.DOTALL)[1].splitlines()
# A user can write a world and an agent in at most this many lines.
# They can be trained, evaluated and exported.
LONGEST = 80


def run(folder: Path, *command: str) -> None:
    done = subprocess.run(
        [sys.executable, *command],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHON_CPU_COUNT": "1"},  # starts no workers
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> Iterator[Path]:
    """The folder in which a user has saved the files on the page."""
    folder = tmp_path_factory.mktemp("mine")
    (folder / "corridor.py").write_text(CODE)
    for name, text in CONFIGS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.syspath_prepend(folder)
        importlib.import_module("corridor").write_lists()
        yield folder
    del sys.modules["corridor"]


@pytest.fixture(scope="module")
def folder(files) -> Path:
    """Run all commands on the page (train, evaluate, export) and return their folder."""
    for command in COMMANDS:
        run(files, *shlex.split(command)[1:])
    return files


def success(file: Path) -> dict[str, float]:
    matches: dict[str, list[int]] = {}
    for row in map(json.loads, file.read_text().splitlines()):
        matches.setdefault(row["corruption"], []).append(row["success"])
    return {name: sum(won) / len(won) for name, won in matches.items()}


def test_world_and_agent_fit_on_a_page():
    assert len(CODE.splitlines()) < LONGEST and len(CONFIGS) == 3 == len(COMMANDS)


@pytest.mark.slow
def test_own_agent_trains_with_every_kind_of_recipe(folder):
    reached = success(folder / "runs/corridor-s0.6-seed0/rows.jsonl")
    assert set(reached) > {"clean", "spatter", "black_out"} and reached["clean"] > 0.9
    assert sum(reached.values()) / len(reached) > 0.6
    stages = [p.parent.name for p in (folder / "runs").glob("*/*/step-*.pt")]
    assert {"imitate", "distil", "adapt"} == set(stages)


@pytest.mark.slow
def test_saved_agent_equals_the_trained_one(folder):
    """The command need not name the adapters, because the settings are loaded with the weights."""
    rows = "rows.jsonl"
    trained = folder / "runs/corridor-s0.6-seed0" / rows
    assert success(folder / "again" / rows) == success(trained)
    first, again = (
        json.loads(f.read_text().splitlines()[0]) for f in (trained, folder / "again" / rows)
    )
    assert first["agent"] == again["agent"]


@pytest.mark.slow
def test_run_folder_fills_an_agent_built_by_the_user(folder):
    place, mine = "runs/corridor-s0.6-seed0/agent", sys.modules["corridor"].Policy
    row = json.loads((folder / "again/rows.jsonl").read_text().splitlines()[0])
    agent = mitigate.load(place, agent=mine(adapters=True))
    assert weights_sha(agent) == row["weights"] and not agent.training
    # the error message contains the call to use
    for reported in (mitigate.load, mitigate.load_hardened):
        with pytest.raises((ValueError, FileNotFoundError), match=r"mitigate\.load.*agent=\.\.\."):
            reported(place)
    with pytest.raises(ValueError, match="do not fit this Policy"):
        mitigate.load(place, agent=mine(width=4, adapters=True))


def test_recipes_take_the_page_agent_and_world(files):
    options = ["--config-dir=mine", "recipe=imitation", "agent=policy", "env=corridor"]
    config = read(conf.load_config("train", options))
    leave_out_stages(config, sys.modules["corridor"].Policy())
    assert [*config.active_stages] == ["imitation"]


@pytest.mark.slow
def test_benchmark_takes_the_page_agent_and_world(folder):
    entry = mitigate.benchmark(
        "runs/corridor-s0.6-seed0/agent",
        options=["--config-dir=mine", "agent=policy", "env=corridor"],
        episodes=1,
        suite=["spatter"],
        out=folder / "bench",
    )
    assert entry.name.startswith("corridor")


@pytest.mark.slow
def test_exported_folder_fills_an_agent_built_by_the_user(folder):
    mine = sys.modules["corridor"].Policy(adapters=True)
    assert mitigate.load_hardened("hardened/corridor", agent=mine) is mine
    with pytest.raises(ValueError, match=r"belongs to the agent corridor\.Policy"):
        mitigate.load_hardened("hardened/corridor")
    page = (folder / "hardened/corridor/README.md").read_text()
    assert "Apache" not in page and "agent=Mine(...)" in page
