"""Tests that fingerprints change with behaviour.

If an agent has state that cannot be hashed, ``version`` must be required.
"""

from __future__ import annotations

import array
import collections
import enum
import functools
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
from gymnasium import spaces
from torch import nn

from mitigate.agents.fingerprint import contents, fingerprint
from mitigate.core.spaces import Composite, Discrete
from mitigate.worlds.seeded import NativeFormat


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


def _less(x):
    return x < 1


def _more(x):
    return x > 1


def _even(number):
    return number == 0 or _odd(number - 1)


def _odd(number):
    return number != 0 and _even(number - 1)


def _handle(message):
    return HANDLERS[message]


HANDLERS = {str(number): [_handle] for number in range(20)}


def _doubled(function):
    @functools.wraps(function)
    def doubled(x):
        return 2 * function(x)

    return doubled


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
    "a dtype": lambda n: np.dtype(("uint8", "float32")[n]),
    "a function": lambda n: [_less, _more][n],
    "a function that calls itself": lambda n: [_even, _odd][n],
    "a decorated function": lambda n: _doubled([_less, _more][n]),
    "functions of one line": lambda n: [lambda x: x[..., 0], lambda x: x[..., 1]][n],
    "operators of functions": lambda n: [lambda x: x < 1, lambda x: x > 1][n],
    "a default of a function": lambda n: lambda x, level=n: level,
    "a closure": lambda n: lambda x: n,
    "an inner function": lambda n: [lambda x: [x for _ in x], lambda x: [1 for _ in x]][n],
    "a set in a function": lambda n: [lambda x: x in {"a", "b"}, lambda x: x in {"a", "c"}][n],
    "an attribute of a function": _function,
    "our action space": lambda n: Composite({"move": Discrete(n + 1)}),
    "a format of frames": lambda n: NativeFormat({"rgb": "ab"[n]}, {"rgb": "uint8"}),
    "bounds of a Box": lambda n: spaces.Box(np.float32([0, -n]), np.float32([1, 1])),
    "the dtype of a Box": lambda n: spaces.Box(0, 1, dtype=(np.float32, np.float64)[n]),
    "a Discrete": lambda n: spaces.Discrete(n + 1),
    "a MultiDiscrete": lambda n: spaces.MultiDiscrete([2, n + 1]),
    "a MultiBinary": lambda n: spaces.MultiBinary(n + 1),
    "a Dict": lambda n: spaces.Dict({"a": spaces.Discrete(2), "b": spaces.Discrete(n + 1)}),
    "a Tuple": lambda n: spaces.Tuple([spaces.Discrete(n + 1)]),
    "a Text": lambda n: spaces.Text(3, charset="ab"[: n + 1]),
    "a Sequence": lambda n: spaces.Sequence(spaces.Discrete(n + 1)),
    "a Graph": lambda n: spaces.Graph(spaces.Discrete(n + 1), None),
}


@pytest.mark.parametrize("what", READ)
def test_contents_reads_plain_data_and_arrays(what):
    first, again, other = (Holder(READ[what](n)) for n in (0, 0, 1))
    assert not contents(first).unreadable
    assert fingerprint(first, {}) == fingerprint(again, {}) != fingerprint(other, {})


def test_fingerprint_ignores_the_random_generator_of_a_space():
    agent = Holder(spaces.Dict({"a": spaces.Discrete(9)}))
    before = fingerprint(agent, {})
    agent.value.seed(1)
    agent.value.sample()
    assert fingerprint(agent, {}) == before


def test_contents_reports_cycles():
    agent = Holder([])
    agent.value.append(agent.value)
    assert "nested too deeply" in contents(agent).explain()
    assert "nested too deeply" in contents(Holder(_handle)).explain()


def test_contents_names_the_unreadable_value_of_a_function():
    numbers = iter([1])
    assert "value().numbers" in contents(Holder(lambda x: next(numbers))).explain()


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
