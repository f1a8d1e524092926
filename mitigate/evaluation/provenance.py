"""Record which agent, world and episodes the rows in a folder come from.

A row contains the world's success rule, the agent's hash (which includes the sensors) and the
episode id. A row contains no other description of the world or the episode. Therefore, rows of a
different world with the same rule and ids would be treated as finished. The notes that this module
writes next to the rows prevent this.
"""

from __future__ import annotations

import hashlib
import json
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, fields, is_dataclass
from enum import Enum
from functools import partial
from os.path import samefile
from pathlib import Path, PurePath
from types import FunctionType, MethodType
from typing import Any

import numpy as np

from mitigate.agents.fingerprint import (
    array_sha,
    attributes_of,
    code_of,
    contents,
    hash_of,
    says_all,
)
from mitigate.agents.source import is_users, named_values
from mitigate.core import output
from mitigate.core.build import Maker
from mitigate.core.files import find, sha256, write_json
from mitigate.core.json_files import read_object
from mitigate.core.names import short
from mitigate.evaluation.rows import read
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

NOTE = "walked.json"  # name of the note in a folder of rows
# These are keys and texts of stored notes, which must not change.
CLASS, CODE, ENV = "its class", "its code", "its env"
READ = "what its code reads"
UNREADABLE = "what cannot be read of it"
MADE = "what makes it"
CHANGES = "changes while worlds are made"
_OTHER = (
    "Choose another folder (out=... for an evaluation, folder=... for a training run), or delete "
    "this one."
)
MOST_LAYERS = 20  # maximum number of wrappers around an environment (heuristic)
# maximum length of a stored value in characters (heuristic); longer values are cut and hashed
SHOWN = 100

# Data from which the hashes of agents without settings() are computed, by the id() of the agent.
# Each value is a tuple: a function that returns the agent, its newest data and its oldest data.
# The newest data describe the agent as it was after its last evaluation.
# The oldest data describe it as it was before its first evaluation since a user last changed it.
_last: dict[int, tuple[Callable[[], Any], Any, Any]] = {}
# Hashes of the attributes of classes, and of the global names that their code uses.
# Each key is a pair (classes of the world and its environments, version that the user passed).
# Each value is a pair (hash before the first episode, hash after the last episode).
_read_by: dict[tuple[tuple[type, ...], str | None], tuple[str, str]] = {}


class Known:
    """Hashes of an agent and of classes, computed before episodes can change them.

    ``hash`` is the fingerprint of ``agent`` in ``world``, with ``guards``, the fingerprint of the
    guards. ``classes`` is a hash of the attributes of the agent's and the world's classes, and of
    the global variables and functions that their code refers to. The object is used as a context
    manager around all episodes.

    If an agent has no ``settings()``, its attributes are hashed instead, although they can change
    during episodes. An agent that has not changed since the end of its last evaluation keeps the
    hash that was computed before that evaluation. The attributes of the world's classes are treated
    in the same way.
    """

    def __init__(self, agent: Any, world: World, guards: str, version: str | None = None) -> None:
        _check_version(version)
        self.agent = agent
        self.layers = tuple(type(layer) for layer in _layers(world))
        self.version = version
        read = _read_by.get((self.layers, None))
        of_world = read[0] if read else _names_read(self.layers, None)[0]
        self.classes = _hash_of_classes(agent, of_world)
        self.without_settings = not says_all(agent)
        current = contents(agent, version)
        find_agent, newest, oldest = _last.get(id(agent), (lambda: None, None, None))
        # ``id`` alone is not enough, because Python reuses the id of a deleted agent
        unchanged = find_agent() is agent and newest == current.parts
        self.parts = oldest if unchanged else current.parts
        self.unreadable = current.explain() if current.unreadable else ""
        self.hash = hash_of(self.parts, world.sensors, guards)

    def __enter__(self) -> Known:
        return self

    def __exit__(self, *_: object) -> None:
        place = self.layers, self.version
        if place in _read_by:
            _read_by[place] = _read_by[place][0], _names_read(*place)[0]
        if not self.without_settings:
            return
        agent, key = self.agent, id(self.agent)
        try:
            find_agent: Callable[[], Any] = weakref.ref(agent, lambda _: _last.pop(key, None))
        # the class allows no weak references, so this reference keeps the agent alive
        except TypeError:

            def find_agent() -> Any:
                return agent

        _last[key] = find_agent, contents(agent, self.version).parts, self.parts

    def check(self, file: Path, name: str) -> Known:
        """Print a message if all rows of ``name`` in ``file`` belong to a different agent.

        Return ``self``.

        Raises:
            ValueError: If ``file`` already holds rows of this agent, but the agent's state cannot
                be read completely.
        """
        rows = read(file) if file.exists() else []
        known = any(row["agent"] == self.hash for row in rows)
        kind = type(self.agent).__name__
        if self.unreadable:
            _report_unreadable(file, name, "agent", f"this {kind}", self.unreadable, known)
        if known or not any(row["name"] == name for row in rows):
            return self
        counts = "attributes" if self.without_settings else "settings()"
        text = (
            f"{name}: the rows of this name in {file} are of another agent, with another class, "
            f"code, weights, {counts}, hooks or version: all episodes run again."
        )
        if self.without_settings:
            text += (
                f"\nAll attributes of a {kind} count, including those that change over time, such "
                "as a clock. Give it settings() if only some of them should count."
            )
        print(text, flush=True)
        return self


def _check_version(version: Any) -> None:
    """Raise ValueError unless ``version`` is None or a string that is not empty."""
    if version is not None and not (isinstance(version, str) and version):
        raise ValueError(
            f"version must be a non-empty string, got {version!r:.80}. Choose one such as "
            '"2026-11 weights", and change it whenever the behaviour of the agent or the world '
            "changes."
        )


def keep(
    folder: Path,
    world: World,
    made_by: Mapping[str, str],
    split: str,
    episodes: Sequence[Episode],
    source: str | None = None,
) -> Path:
    """Store in ``folder`` a description of the world and hashes of the episodes and of their file.

    If the folder already has a description, the new one must match it. Worlds with different
    sensors or success rules can share a folder, because each row names its sensors and its rule.

    Args:
        folder: folder of the rows.
        world: the world.
        made_by: description of how the world was constructed (:func:`first_world`).
        split: name of the episode list.
        episodes: the episodes.
        source: file of the episodes, or None if there is no file.

    Returns:
        The file that was written.

    Raises:
        ValueError: If the folder contains rows of a different world or different episodes; the
            message names the difference.
    """
    note = folder / NOTE
    known = _read(note) if output.is_regular(note) else {}
    described = {**_described(world), **made_by}
    sums = {episode.episode_id: _episode_hash(episode) for episode in episodes}
    entry = known.get(split, {})
    listed = entry.get("list", "") if source is None else sha256(find(source))
    if entry.get("list", listed) != listed:
        raise ValueError(
            f"{folder} holds rows of another list of {split} than the current {source}. {_OTHER}"
        )
    sensors = {name: asdict(one) for name, one in sorted(world.sensors.items())}
    # A row identifies the success rule directly, and the sensors through the agent's hash.
    kind = json_hash([world.rule, sensors])
    worlds, sums_before = entry.get("worlds", {}), entry.get("sums", {})
    if unreadable := described.pop(UNREADABLE, ""):
        owner = "the classes of this world"
        _report_unreadable(folder, name_of(world), "world", owner, unreadable, kind in worlds)
    before = worlds.get(kind, described)
    keys = {**before, **described}
    different = [k for k in keys if not _is_same(before.get(k), described.get(k))]
    changed = [name for name, digest in sums_before.items() if sums.get(name, digest) != digest]
    if different or changed:
        what = f"episode {changed[0]} of another list" if changed else "another world"
        detail = "" if changed else f": {_difference(different[0], before, described)}"
        raise ValueError(f"{folder} holds rows of {what}{detail}. {_OTHER}")
    known[split] = {"worlds": worlds | {kind: described}, "sums": sums_before | sums}
    if listed:
        known[split]["list"] = listed
    write_json(note, known)
    return note


def _report_unreadable(
    place: Path, name: str, kind: str, owner: str, unreadable: str, earlier: bool
) -> None:
    """Print that rows cannot be reused; raise ValueError if ``place`` already holds such rows."""
    if earlier:
        # A version changes the hash in the rows of an agent. All rows of a folder are of one world.
        folder = " and another folder (out=...)" if kind == "world" else ""
        raise ValueError(
            f"{place} holds rows of {name}, which may come from another {kind}: in {owner}, "
            f'{unreadable} cannot be read. Give version="..."{folder}: later calls with the same '
            f"version reuse the rows. Change it whenever the {kind}'s behaviour changes."
        )
    print(
        f"{name}: in {owner}, {unreadable} cannot be read, so no later call can reuse these rows. "
        'Give version="..." to allow it.',
        flush=True,
    )


def _read(note: Path) -> dict[str, dict[str, Any]]:
    """Read the entries of a folder's ``note``, by split."""
    again = f"Copy the file back, or move {note.parent} aside and evaluate again."
    known = read_object(note, again)
    for split, entry in known.items():
        parts = entry if isinstance(entry, dict) else {"worlds": None}
        worlds, sums = parts.get("worlds", {}), parts.get("sums", {})
        objects = [worlds, sums, *(worlds.values() if isinstance(worlds, dict) else ())]
        whole = all(isinstance(part, dict) for part in objects)
        if not whole or not isinstance(parts.get("list", ""), str):
            raise ValueError(f"{note}: the entry {short(split)} is damaged. {again}")
    return known


def _described(world: World) -> dict[str, str]:
    """Describe ``world`` by its class, its environment and a hash of the code.

    The hash covers only the user's code, and not code of this project or of installed packages.
    """
    sources = code_of(*map(type, _layers(world))).parts.get("code", [])
    texts = {CLASS: kind_of(world), ENV: _spec(world), CODE: json_hash(sources) if sources else ""}
    return {key: value for key, value in texts.items() if value}


def _is_same(before: str | None, now: str | None) -> bool:
    """Return whether two texts are equal or are paths of the same file."""
    if before == now or CHANGES in (before, now):
        return True
    with suppress(OSError, TypeError, ValueError, RecursionError):
        return samefile(*(f"{Path(json.loads(text or ''))}" for text in (before, now)))
    return False


def _layers(world: World) -> Iterator[Any]:
    """Yield the world, the environment inside it, and the environments that it wraps."""
    layer: Any = world
    for _ in range(MOST_LAYERS):
        if layer is not None:
            yield layer
        layer = _member(layer, "env")


def name_of(world: World) -> str:
    """Return the name of a world's class.

    If a world of this project wraps an environment, return the name of the environment's class.
    """
    env = _member(world, "env")
    shipped = type(world).__module__.startswith("mitigate.")
    inner = _member(env, "unwrapped") or env if shipped and env is not None else world
    return type(inner).__name__


def _difference(key: str, before: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Describe how the entry ``key`` of a world's description changed, for a message."""
    if key == CODE:
        return f"the code of {now[CLASS]} was changed"
    if key == READ:
        return f"the class attributes of {now[CLASS]}, or what its code reads, were changed"
    was, is_ = (short(texts[key], 200) if key in texts else "not set" for texts in (before, now))
    return f"{key} was {was} and is {is_}"


def _episode_hash(episode: Episode) -> str:
    """Return the hash of those parts of an episode that an agent and a world use."""
    content = {
        "ids": [episode.episode_id, episode.trajectory_id, episode.scene_id],
        "start": [*map(float, (*episode.start_position, *episode.start_rotation))],
        "goals": [[[*map(float, goal.position)], goal.radius] for goal in episode.goals],
        "instruction": episode.instruction.text,
        "seed": str(episode.info.get("seed")),
    }
    return json_hash(content)


def _spec(world: World) -> str:
    """Return the id and arguments of the environment inside a world, or an empty string."""
    spec = _member(_member(world, "env"), "spec")
    if _member(spec, "id") is None:
        return ""
    kwargs = _member(spec, "kwargs") or {}
    return f"{spec.id} {json.dumps(kwargs, sort_keys=True, default=lambda x: str(type(x)))}"


def _member(owner: Any, name: str) -> Any:
    """Return the attribute ``name`` of an environment, or None if it is missing."""
    # gymnasium and torchrl have no common base class that declares the attribute
    return getattr(owner, name, None)


def first_world(
    make: Callable[[], World], version: str | None = None
) -> tuple[World, dict[str, str]]:
    """Construct a world, and describe how it was constructed.

    If ``make`` comes from a config, the description contains the config's entries. For a function,
    the description contains the arguments, the defaults and the values that the code refers to. For
    any other callable object, it contains the class and the attributes. The description also
    contains a hash of the values that the code of the world's classes refers to. A value that
    changes while the world is constructed, such as a cache, is described as ``CHANGES``.

    ``version`` is a string that the user sets if the state of a class cannot be read.
    """
    _check_version(version)
    before = {name: _text(value) for name, value in _made_by(make)}
    same = {place for place, (_, last) in _read_by.items() if last == _names_read(*place)[0]}
    world = make()
    after = {name: _text(value) for name, value in _made_by(make)}
    changed = {key for key in {**before, **after} if before.get(key) != after.get(key)}
    place = tuple(type(layer) for layer in _layers(world)), version
    digest, unreadable = _names_read(*place)
    _read_by[place] = (_read_by[place][0] if place in same else digest), ""
    of_classes = {READ: _read_by[place][0], UNREADABLE: unreadable}
    made_by = after | dict.fromkeys(changed, CHANGES)
    return world, made_by | {key: text for key, text in of_classes.items() if text}


def check_classes(agent: Any, world: World, expected: str) -> None:
    """Raise ValueError if the classes differ between a worker process and its parent process.

    ``expected`` is the value of ``Known.classes`` in the parent process.
    """
    layers = tuple(type(layer) for layer in _layers(world))
    if _hash_of_classes(agent, _names_read(layers, None)[0]) != expected:
        raise ValueError(
            f"The class attributes of {type(agent).__name__} or {name_of(world)}, or global "
            "variables that their code uses, have different values in a worker process. Set them "
            "only where they are defined, or set workers=1."
        )


def _hash_of_classes(agent: Any, of_world: str) -> str:
    return json_hash([_names_read((type(agent),), None)[0], of_world])


def _names_read(kinds: Sequence[type], version: str | None) -> tuple[str, str]:
    """Return a hash of the user's classes among ``kinds``, and a message that describes state that
    could not be read.

    The hash covers the attributes of the classes, and the functions and global variables that their
    code names.
    """
    content = code_of(*kinds)
    names = content.parts.get("names", {})
    if content.unreadable and version is not None:
        return json_hash([names, version]), ""
    return json_hash(names) if names else "", content.explain() if content.unreadable else ""


def kind_of(value: object) -> str:
    """Return the name of an object's class, with its module."""
    return f"{type(value).__module__}.{type(value).__qualname__}"


def json_hash(value: Any) -> str:
    """Return 12 hex digits of the hash of JSON data.

    The data may contain number types of NumPy and other libraries.
    """
    return hashlib.sha256(json.dumps(value, default=float).encode()).hexdigest()[:12]


def _made_by(make: Any) -> Iterator[tuple[str, Any]]:
    """Yield the names and values that determine which world ``make`` constructs."""
    if isinstance(make, Maker):
        yield from _flat("env.world", make.node)
    elif isinstance(make, partial):
        arguments = {str(number): value for number, value in enumerate(make.args)} | make.keywords
        yield from _flat(f"{MADE}, argument", arguments)
        yield from _made_by(make.func)
    elif isinstance(make, MethodType):
        yield from _made_by(make.__func__)
        yield from _made_by(make.__self__)
    elif isinstance(make, FunctionType):
        if is_users(make):
            # bytecode is used because the source lines may contain other code too
            code = make.__code__
            yield MADE, [code.co_names, [c for c in code.co_consts if c is not None]]
            defaults = {str(number): value for number, value in enumerate(make.__defaults__ or ())}
            yield from _flat(f"{MADE}, default", defaults | (make.__kwdefaults__ or {}))
            yield from _flat(f"{MADE}, value", named_values(make))
    elif not isinstance(make, type):
        yield f"{MADE}, class", kind_of(make)
        yield f"{MADE}, code", json_hash(code_of(type(make)).parts.get("code", []))
        yield from _flat(f"{MADE}, attribute", dict(attributes_of(make)))


def _flat(name: str, values: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the entries of nested mappings; dots join the keys of each entry."""
    for key, value in values.items():
        nested = type(value) is dict and value and name.startswith("env.world")
        yield from _flat(f"{name}.{key}", value) if nested else [(f"{name}.{key}", value)]


def _text(value: Any) -> str:
    """Return ``value`` as JSON. An object that JSON does not support is converted by ``_as_data``.

    If the conversion fails, return the name of the class. A long text is shortened.
    """
    try:
        text = json.dumps(_with_text_keys(value), sort_keys=True, default=_as_data)
    except (TypeError, ValueError, RecursionError):  # a cycle, or an object that JSON rejects
        return kind_of(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({json_hash(text)})"


def _with_text_keys(value: Any) -> Any:
    """Return ``value`` with all keys of dicts converted to strings, as JSON requires."""
    if isinstance(value, dict):
        items = value.items()
        return {k if isinstance(k, str) else _text(k): _with_text_keys(v) for k, v in items}
    return [*map(_with_text_keys, value)] if isinstance(value, (list, tuple)) else value


def _as_data(value: Any) -> Any:
    """Convert an object that JSON does not support to plain data, or to the name of its class."""
    if isinstance(value, (Enum, PurePath)):
        return str(value)
    if isinstance(value, np.generic) and not value.dtype.hasobject:
        return value.item()
    if sha := array_sha(value):
        return f"array {value.dtype} {value.shape} {sha}"
    if is_dataclass(value) and not isinstance(value, type):
        return [kind_of(value), [getattr(value, one.name) for one in fields(value)]]  # with slots
    if isinstance(value, (set, frozenset)):
        return sorted(map(_text, value))
    # only classes and functions have ``__qualname__``
    return value.__qualname__ if isinstance(value, (type, FunctionType)) else kind_of(value)
