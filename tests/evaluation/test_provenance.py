"""Tests that rows of one world are not used for a different world."""

from __future__ import annotations

import importlib
import linecache
import re
import sys
from dataclasses import dataclass
from enum import Enum
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from omegaconf import OmegaConf

from mitigate.core.build import maker
from mitigate.core.observation import Sensor
from mitigate.evaluation import provenance
from mitigate.worlds.episodes import Episode, Goal, Instruction

EPISODES = [
    Episode("0", "0", "maze", (0, 0, 0), (0, 0, 0, 1), (Goal((0, 0, 0)),), Instruction("go"), ())
]


class Maze:
    """A world of ``cells``."""

    def __init__(self, cells: int = 9, rule: str = "there", size: int = 8) -> None:
        self.cells, self.rule = cells, rule
        self.sensors = {"rgb": Sensor("rgb", (size, size, 3), "uint8")}


class Other(Maze):
    """Another class."""


def keep(folder: Path, make, source: str | None = None) -> None:
    provenance.keep(folder, *provenance.first_world(make), "val", EPISODES, source)


def around(name: str | None = None, **kwargs) -> SimpleNamespace:
    env = SimpleNamespace(spec=SimpleNamespace(id=name, kwargs=kwargs)) if name else None
    return SimpleNamespace(rule="there", sensors={}, env=env)


def of_config(**options):
    target = f"{__name__}.Maze"
    return maker(OmegaConf.create({"_target_": target, "_partial_": True, **options}))


def in_two_layers(env) -> SimpleNamespace:
    return SimpleNamespace(rule="there", sensors={}, env=SimpleNamespace(env=env))


def with_cells(cells: int):
    return lambda: Maze(cells)


def by_default(value: int, kind: str = ""):
    def positional(cells=value):
        return Maze(cells)

    def keyword(*, cells=value):
        return Maze(cells)

    return keyword if kind else positional


@dataclass
class Size:
    cells: int


class Kind(Enum):
    DARK, LIT = range(2)


class Builder:
    def __init__(self, cells: int) -> None:
        self.cells = cells

    def build(self) -> Maze:
        return Maze(self.cells)

    __call__ = build


@pytest.mark.parametrize(
    ("first", "second", "reported"),
    [
        (partial(Maze, 9), partial(Maze, 3), "argument.0 was '9' and is '3'"),
        (partial(Maze, cells=9), partial(Maze, cells=3), "argument.cells was '9' and is '3'"),
        (of_config(cells=9), of_config(cells=3), "env.world.cells was '9' and is '3'"),
        (of_config(), of_config(cells=3), "env.world.cells was not set and is '3'"),
        (with_cells(9), with_cells(3), "value.cells was '9' and is '3'"),
        (partial(Maze, Path("a")), partial(Maze, Path("b")), """argument.0 was '"a"'"""),
        (partial(Maze, np.int64(9)), partial(Maze, np.int64(3)), "argument.0 was '9' and is '3'"),
        (partial(Maze, 1), partial(Maze, 2), "argument.0 was '1' and is '2'"),  # no open files
        (partial(Maze, np.zeros(2)), partial(Maze, np.ones(2)), "argument.0 was '\"array float64"),
        (partial(Maze, Size(9)), partial(Maze, Size(3)), """Size", [9]]'"""),
        (partial(Maze, Kind.DARK), partial(Maze, Kind.LIT), "Kind.DARK"),
        (partial(Maze, [0] * 99), partial(Maze, [0] * 98 + [1]), "argument.0 was '[0, 0"),
        (by_default(9), by_default(3), "default.0 was '9' and is '3'"),
        (by_default(9, "keyword"), by_default(3, "keyword"), "default.cells was '9' and is '3'"),
        (Builder(9), Builder(3), "attribute.cells was '9' and is '3'"),
        (Builder(9).build, Builder(3).build, "attribute.cells was '9' and is '3'"),
        (Maze, lambda: Maze(3), "what makes it was not set"),
        (lambda: Maze(9), lambda: Maze(3), """what makes it was '[["Maze"], [9]]'"""),
        (lambda: around(), lambda: around("Maze-v0"), "what makes it was"),
        (lambda: around("Maze-v0", size=5), lambda: around("Maze-v0", size=6), "its env was"),
        (lambda: Maze(), lambda: Other(), "its class was"),
    ],
)
def test_keep_rejects_rows_of_another_world(tmp_path, first, second, reported):
    for _ in range(2):
        keep(tmp_path, first)
    with pytest.raises(ValueError, match=re.escape(reported)) as refused:
        keep(tmp_path, second)
    assert "rows of another world" in str(refused.value) and "out=" in str(refused.value)


class Odd:
    """Looking at it raises."""

    def __getattr__(self, name):
        raise RuntimeError(name)


def test_first_world_accepts_values_that_change(tmp_path):
    output, circle, numbers, odd = {}, {}, [*range(100_000)], Odd()
    circle["itself"] = circle

    def make() -> Maze:
        output[len(output)] = (numbers, circle, {(0, 1): 2}, odd)
        return Maze()

    for _ in range(3):
        keep(tmp_path, make)
        make()  # running an episode also makes a world
    keep(tmp_path / "other", lambda: [Maze(), numbers, circle, odd][0])
    assert (tmp_path / provenance.NOTE).stat().st_size < 3000


def test_keep_accepts_two_paths_of_one_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("scene.json", "other.json"):
        Path(name).write_text("{}")
    keep(tmp_path, of_config(cells="scene.json"))
    keep(tmp_path, of_config(cells=str(tmp_path / "scene.json")))
    with pytest.raises(ValueError, match=r"env\.world\.cells"):
        keep(tmp_path, of_config(cells="other.json"))


def test_keep_accepts_worlds_with_other_sensors_or_rules(tmp_path):
    """Every row states its sensors and its success rule. One folder may therefore contain rows of
    agents with one camera and rows of agents with twelve cameras."""
    for kind in ({}, {"size": 16}, {"rule": "near"}, {}):
        keep(tmp_path, of_config(**kind))
    with pytest.raises(ValueError, match=r"env\.world\.cells"):
        keep(tmp_path, of_config(size=16, cells=3))


@pytest.mark.parametrize("wrapped", [False, True])
def test_keep_rejects_an_edited_world(tmp_path, monkeypatch, wrapped):
    """The edit is also detected if the world is inside wrappers."""
    monkeypatch.syspath_prepend(tmp_path)
    source = "class Edited:\n    rule, sensors = 'there', {}\n    won = True\n"
    for text in (source, source, source.replace("True", "False")):
        (tmp_path / "edited_world.py").write_text(text)
        sys.modules.pop("edited_world", None)
        importlib.invalidate_caches()
        linecache.clearcache()
        edited = importlib.import_module("edited_world").Edited
        make = partial(in_two_layers, edited()) if wrapped else edited
        if text == source:
            keep(tmp_path, make)
            continue
        with pytest.raises(ValueError, match=r"the code of .* was changed"):
            keep(tmp_path, make)
    sys.modules.pop("edited_world")


GLOBAL = {"cells": 9}


def cells() -> int:
    return GLOBAL["cells"] * FACTOR


FACTOR = 1


class Counted(Maze):
    """A world whose class changes during episodes, and whose code reads a global variable."""

    count = 0
    depth = 3
    found: dict = {}

    def step(self) -> int:
        Counted.count += 1
        self.found[self.count] = self.depth
        return cells()


@pytest.mark.parametrize(
    ("place", "name", "value"),
    [(Counted, "depth", 4), (Counted, "cells", 3), (Counted, "step", len), ("", "FACTOR", 2)],
)
@pytest.mark.parametrize("wrapped", [False, True])
def test_keep_rejects_a_world_whose_class_attribute_changed(
    tmp_path, monkeypatch, place, name, value, wrapped
):
    make = partial(in_two_layers, Counted()) if wrapped else Counted
    for _ in range(2):
        keep(tmp_path, make)
    monkeypatch.setattr(place or sys.modules[__name__], name, value, raising=False)
    with pytest.raises(ValueError, match="the class attributes of .* were changed"):
        keep(tmp_path, make)
    keep(tmp_path / "other", make)


def test_keep_accepts_a_world_whose_class_only_episodes_changed(tmp_path):
    for _ in range(2):
        world, made_by = provenance.first_world(Counted)
        provenance.keep(tmp_path, world, made_by, "val", EPISODES)
        with provenance.Known(SimpleNamespace(), world, "none"):
            Counted().step()
    Counted.count += 1
    with pytest.raises(ValueError, match="the class attributes of"):
        keep(tmp_path, Counted)


def test_keep_requires_a_version_for_unreadable_worlds(tmp_path, capsys):
    class Unreadable(Maze):
        lines = (number for number in range(3))

    keep(tmp_path, Unreadable)
    assert "no later call can reuse these rows" in capsys.readouterr().out
    with pytest.raises(ValueError, match=r'lines .* cannot be read\. Give version="'):
        keep(tmp_path, Unreadable)
    for _ in range(2):
        named = provenance.first_world(Unreadable, "1")
        provenance.keep(tmp_path / "named", *named, "val", EPISODES)
    with pytest.raises(ValueError, match="the class attributes of"):
        provenance.keep(
            tmp_path / "named", *provenance.first_world(Unreadable, "2"), "val", EPISODES
        )


def test_keep_rejects_another_list(tmp_path):
    listed = tmp_path / "val.json"
    listed.write_text("{}")
    keep(tmp_path, Maze)  # as in folders of earlier versions, which have no hash of the list
    keep(tmp_path, Maze, str(listed))
    keep(tmp_path, Maze)
    listed.write_text("[]")
    with pytest.raises(ValueError, match="another list of val"):
        keep(tmp_path, Maze, str(listed))


def test_name_of_returns_the_class_of_the_environment():
    from mitigate.worlds.seeded import SeededWorld

    ours = SeededWorld.__new__(SeededWorld)
    assert provenance.name_of(Maze()) == "Maze" and provenance.name_of(ours) == "SeededWorld"
    ours.env = SimpleNamespace(unwrapped=Maze())
    assert provenance.name_of(ours) == "Maze"
