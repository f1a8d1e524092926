"""Tests that fingerprints change with behaviour.

If an agent has state that cannot be hashed, ``version`` must be required.
"""

from __future__ import annotations

import array
import collections
import enum
import io
import operator
import re
import sqlite3
import types
import weakref
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from mitigate.agents.fingerprint import contents, fingerprint


class Level(enum.Enum):
    LOW = 0
    HIGH = 1


class Table(dict):
    """A user's dict class whose keys can be read as attributes."""

    __getattr__ = dict.get


class Steps(list):
    """A user's list class."""


class Slotted:
    __slots__ = ("level",)

    def __init__(self, level: int) -> None:
        self.level = level


class Pickled:
    """An object whose pickle does not contain the value that its behaviour depends on."""

    def __init__(self, level: int) -> None:
        self.level = level

    def __getstate__(self):
        return {}


class Numbers(np.ndarray):
    """A user's array class."""


class Target:
    level = 0


class Holder:
    """An agent without settings()."""

    def __init__(self, value) -> None:
        self.value = value

    def act(self, observation) -> int:
        return 0


def _module(level: int) -> types.ModuleType:
    module = types.ModuleType("config")
    module.level = [level, [level]]
    return module


def _connection(level: int) -> sqlite3.Connection:
    connection = sqlite3.connect(":memory:")
    connection.execute("create table levels (level)")
    connection.execute("insert into levels values (?)", (level,))
    return connection


def _function(level: int):
    def decide(observation):
        return decide.level

    decide.level = level
    return decide


def _counter(level: int) -> collections.Counter:
    counter = collections.Counter()
    counter.level = level
    return counter


TARGETS = [Target(), Target()]
LONG = "a" * 300
VALUES = {
    "the factory of a defaultdict": lambda n: collections.defaultdict((int, list)[n]),
    "a default of a factory": lambda n: collections.defaultdict(lambda level=n: level),
    "an item of a defaultdict": lambda n: collections.defaultdict(int, level=[n]),
    "an item of a dict's subclass": lambda n: Table(level=n),
    "an item of a list's subclass": lambda n: Steps([n]),
    "an attribute of a counter": _counter,
    "an ordered dict": lambda n: collections.OrderedDict([("ab"[n], 0), ("ba"[n], 0)]),
    "the length of a deque": lambda n: collections.deque([1], maxlen=n + 1),
    "the type of a key": lambda n: {(1, "1")[n]: []},
    "the order of keys": lambda n: {"ab"[n]: [], "ba"[n]: []},
    "an array of Python": lambda n: array.array("i", [n]),
    "a memoryview": lambda n: memoryview(bytes([n])),
    "a mask": lambda n: np.ma.array([1, 2], mask=[0, n]),
    "an array's subclass": lambda n: np.full(2, n).view(Numbers),
    "an array of objects": lambda n: np.array([[n], None], dtype=object),
    "a long pattern": lambda n: re.compile(LONG + "ab"[n]),
    "text in memory": lambda n: io.StringIO(f"{n}"),
    "the place in text in memory": lambda n: _sought(n),
    "a member of an Enum": lambda n: list(Level)[n],
    "a connection": _connection,
    "a weak reference": lambda n: weakref.ref(TARGETS[n]),
    "a module": _module,
    "an object with slots": Slotted,
    "an object that pickles less": Pickled,
    "an attribute of a function": _function,
    "functions of one line": lambda n: [lambda x: 0, lambda x: 1][n],
    "an item of a set": lambda n: {frozenset([n])},
    "an object of a set": lambda n: {Slotted(n)},
    "a getter": lambda n: operator.itemgetter(n),
    "a method of a value": lambda n: {"level": n}.get,
    "a generator": lambda n: (level for level in [n]),
    "a random generator": np.random.default_rng,
    "a view of values": lambda n: {"level": n}.values(),
    "a tensor's attribute": lambda n: _tagged(n),
    "a type": lambda n: (int, float)[n],
}


def _sought(place: int) -> io.StringIO:
    text = io.StringIO("ab")
    text.seek(place)
    return text


def _tagged(level: int) -> torch.Tensor:
    tensor = torch.zeros(1)
    tensor.level = level
    return tensor


@pytest.mark.parametrize("what", VALUES)
def test_fingerprint_changes_with_a_value_or_asks_for_a_version(what):
    first, other = Holder(VALUES[what](0)), Holder(VALUES[what](1))
    unreadable = contents(first).unreadable and contents(other).unreadable
    assert unreadable or fingerprint(first, {}) != fingerprint(other, {})
    assert fingerprint(first, {}, version="1") and not contents(first, "1").unreadable


READ = {
    "plain data": lambda n: {"stop": [n, (0.2, None)], 3: "x"},
    "an array": lambda n: np.full(2, n),
    "a tensor": lambda n: [torch.full((2,), n)],
    "a type": lambda n: (int, float)[n],
    "a function of torch": lambda n: (torch.relu, torch.sigmoid)[n],
    "a path": lambda n: Path("ab"[n]),
}


@pytest.mark.parametrize("what", READ)
def test_contents_reads_plain_data_and_arrays(what):
    first, again, other = (Holder(READ[what](n)) for n in (0, 0, 1))
    assert not contents(first).unreadable
    assert fingerprint(first, {}) == fingerprint(again, {}) != fingerprint(other, {})


def test_contents_reports_cycles():
    agent = Holder([])
    agent.value.append(agent.value)
    assert "nested too deeply" in contents(agent).explain()


CONFIG: dict = {}


class Described(nn.Module):
    """An agent with settings() whose method reads a global variable."""

    def settings(self):
        return {}

    def act(self, observation) -> int:
        return [CONFIG["level"] for _ in observation]


def test_fingerprint_changes_with_global_variables_or_asks_for_a_version(monkeypatch):
    hashes = []
    for level in (0, 0, 1):
        monkeypatch.setitem(CONFIG, "level", level)
        hashes.append(fingerprint(Described(), {}))
    assert hashes[0] == hashes[1] != hashes[2]
    monkeypatch.setitem(CONFIG, "level", iter([1]))
    assert "CONFIG.level (a builtins.list_iterator)" in contents(Described()).explain()
