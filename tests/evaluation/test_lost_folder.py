"""Tests that an evaluation ends with an error if its files are links or are removed."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from mitigate.core import conf
from mitigate.core.output import FolderLostError, UnsafePathError
from mitigate.evaluation import evaluate, evaluator, rows
from mitigate.evaluation.rows import ROWS
from tests.evaluation.straight import Straight

# the output folder; a global, because agents that are built from a config need it
OUT: list[Path] = []
EPISODES = 3


class Breaking(Straight):
    """An agent that damages the output folder at the start of the last episode."""

    resets = 0

    def reset(self, instruction):
        super().reset(instruction)
        Breaking.resets += 1
        if Breaking.resets == EPISODES:
            BREAK[self.how](OUT[0])


class Removes(Breaking):
    how = "folder"


class RemovesAndMakes(Breaking):
    how = "folder made again"


class RemovesLock(Breaking):
    how = "lock"


class RemovesRows(Breaking):
    how = "rows"


class RemovesNotes(Breaking):
    how = "notes"


def make_again(out):
    shutil.rmtree(out)
    out.mkdir()


BREAK = {
    "folder": shutil.rmtree,
    "folder made again": make_again,
    "lock": lambda out: (out / ".lock").unlink(),
    "rows": lambda out: (out / ROWS).unlink(),
    "notes": lambda out: (out / "walked.json").unlink(),
}


@pytest.fixture
def config(tmp_path, monkeypatch):
    """Return a function that composes the config for evaluating one of the classes above. Rows are
    written one at a time."""
    monkeypatch.setattr(evaluator, "_PAUSE", 0.0)

    def compose(agent, *options):
        mine = tmp_path / "mine" / "agent"
        mine.mkdir(parents=True, exist_ok=True)
        node = f"agent: {{_target_: {__name__}.{agent}, steps: 2}}"
        (mine / "own.yaml").write_text(f"# @package _global_\n{node}\n")
        OUT[:] = [tmp_path / "out"]
        Breaking.resets = 0
        arguments = [f"--config-dir={mine.parent}", "agent=own", f"out={OUT[0]}", "env.size=16"]
        arguments += [f"episodes={EPISODES}", "conditions=[clean]", "workers=1", *options]
        return conf.load_config("evaluate", arguments)

    return compose


@pytest.mark.slow
@pytest.mark.parametrize(
    "agent", ["Removes", "RemovesAndMakes", "RemovesLock", "RemovesRows", "RemovesNotes"]
)
def test_evaluate_notices_lost_files(config, agent):
    with pytest.raises(FolderLostError, match=r"out.* removed or replaced .*same command again"):
        evaluate.run(config(agent))
    assert agent not in ("Removes", "RemovesAndMakes") or not (OUT[0] / ROWS).exists()
    evaluate.run(config("Straight", "name=again"))  # the same folder can be used again
    assert len({row["episode_id"] for row in rows.read(OUT[0] / ROWS)}) == EPISODES


@pytest.mark.parametrize("name", [".lock", ROWS, "safeguard.jsonl"])
def test_evaluate_rejects_a_link_in_its_folder(config, tmp_path, name):
    (tmp_path / "out").mkdir()
    (tmp_path / "thesis.txt").write_text("mine")
    (tmp_path / "out" / name).symlink_to("../thesis.txt")
    with pytest.raises(ValueError, match=f"{name}"):
        evaluate.run(config("Straight", "safeguard=rules"))
    assert (tmp_path / "thesis.txt").read_text() == "mine"


def test_evaluate_writes_to_a_linked_folder(config, tmp_path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "out").symlink_to("disk")
    evaluate.run(config("Straight"))
    assert len(rows.read(tmp_path / "disk" / ROWS)) == EPISODES
    assert not (tmp_path / "disk" / ".lock").exists()


def test_unsafe_path_is_an_error_that_commands_print():
    assert issubclass(UnsafePathError, ValueError) and issubclass(FolderLostError, OSError)
