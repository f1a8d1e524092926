"""What the rows in a folder belong to: the agent, the world, and the episodes.

A row says its world's rule, and in the agent's hash its sensors; nothing of all else that a world
is, and of its episode the id alone. So rows of another world would count as done. Notes beside the
rows tell them apart.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, fields, is_dataclass
from enum import Enum
from functools import partial
from itertools import count
from os.path import samefile
from pathlib import Path, PurePath
from types import FunctionType, MethodType
from typing import Any

import numpy as np

from mitigate.agents.fingerprint import contents, hash_of, says_all, source_of
from mitigate.agents.state import array_sha
from mitigate.core import output
from mitigate.core.build import Maker
from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_object
from mitigate.core.names import short
from mitigate.evaluation.episode_lists import LIST_HASH, keep_list_hash
from mitigate.evaluation.rows import read
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

# of agents without settings(), by id: the agent, its parts after the last run, and before the first
_last: dict[int, tuple[Callable[[], Any], Any, Any]] = {}
# what the code of worlds reads, by their layers' classes and the user's version: a hash from before
# the first episode, and one from after the last
_read_by: dict[tuple[tuple[type, ...], str | None], tuple[str, str]] = {}


class Known:
    """``hash`` of ``agent`` in ``world`` behind ``front``, taken before episodes change its
    arrays and attributes, and ``classes``, a hash of what their classes read; a context manager
    around all episodes.

    The attributes of an agent without ``settings()`` count. If only episodes have changed the
    object since the last call, its hash is the one from before them. The same holds for the
    attributes of the world's classes.
    """

    def __init__(self, agent: Any, world: World, front: str, version: str | None = None) -> None:
        if version is not None and not (isinstance(version, str) and version):
            raise ValueError(
                f"version must be a non-empty string, got {version!r:.80}. Name what the agent is, "
                'such as version="2026-11 weights", and change it whenever its behaviour changes.'
            )
        self.agent = agent
        self.layers = tuple(type(layer) for layer in _layers(world))
        self.version = version
        read = _read_by.get((self.layers, None))
        of_world = read[0] if read else _what_is_read(self.layers, None)[0]
        self.classes = _hash_of_classes(agent, of_world)
        self.without_settings = not says_all(agent)
        found = contents(agent, version)
        same, after, before = _last.get(id(agent), (lambda: None, None, None))
        self.parts = before if same() is agent and after == found.parts else found.parts
        self.unreadable = found.explain() if found.unreadable else ""
        self.hash = hash_of(self.parts, world.sensors, front)

    def __enter__(self) -> Known:
        return self

    def __exit__(self, *_: object) -> None:
        place = self.layers, self.version
        if place in _read_by:
            _read_by[place] = _read_by[place][0], _what_is_read(*place)[0]
        if not self.without_settings:
            return
        agent = self.agent
        key = id(agent)
        try:
            same: Callable[[], Any] = weakref.ref(agent, lambda _: _last.pop(key, None))
        except TypeError:  # its class takes no weak references: the agent is kept alive

            def same() -> Any:
                return agent

        _last[key] = same, contents(agent, self.version).parts, self.parts

    def check(self, file: Path, name: str) -> Known:
        """Report that all rows of ``name`` in ``file`` belong to another agent; return self.

        Raises:
            ValueError: there are earlier rows, and the agent cannot be read completely.
        """
        rows = read(file) if file.exists() else []
        known = any(row["agent"] == self.hash for row in rows)
        kind = type(self.agent).__name__
        if self.unreadable:
            _report_unreadable(file, name, "agent", f"this {kind}", self.unreadable, known)
        if known or not any(row["name"] == name for row in rows):
            return self
        counts = "attributes" if self.without_settings else "settings()"
        print(
            f"{name}: the rows of this name in {file} are of another agent, with another class, "
            f"code, weights, {counts}, hooks or version: all episodes run again.",
            flush=True,
        )
        if self.without_settings:
            print(
                f"Every attribute of a {kind} counts, also one that changes by itself, such as a "
                "clock: give it settings() if only some of them should.",
                flush=True,
            )
        return self


NOTE = "walked.json"
CLASS, CODE, ENV = "its class", "its code", "its env"  # what differs, in words
READ = "what its code reads"
UNREADABLE = "what cannot be read of it"
MOST_LAYERS = 20  # of wrappers around an environment (ours)


def keep(
    folder: Path,
    world: World,
    made_by: Mapping[str, str],
    split: str,
    episodes: Sequence[Episode],
    source: str | None = None,
) -> None:
    """Keep in ``folder`` what ``world`` is and what it was ``made_by`` (``first_world``), a sum of
    each episode of ``split`` and one of ``source``, the file that they come from if they come from
    one; raise ValueError, saying what differs, if one of them is another now.

    Worlds of other sensors or of another rule stand beside one another: their rows say so. What a
    note of an older version does not say may be anything, as may all where there is no note.
    """
    if source is not None:
        keep_list_hash(folder, split, source)
    note = folder / NOTE
    known = _read(note) if output.is_regular(note) else {}
    told, sums = {**_described(world), **made_by}, {e.episode_id: _sum(e) for e in episodes}
    own, kind = known.get(split, {}), _told_by_rows(world)
    worlds, sums_before = own.get("worlds", {}), own.get("sums", {})
    if unreadable := told.pop(UNREADABLE, ""):
        owner = "the classes of this world"
        _report_unreadable(folder, name_of(world), "world", owner, unreadable, kind in worlds)
    before = worlds.get(kind, told | _older(own))
    if READ in told:  # older versions did not note it
        before = {**before, READ: before.get(READ, told[READ])}
    different = [k for k in {**before, **told} if not _is_same(before.get(k), told.get(k))]
    other = [name for name, held in sums_before.items() if sums.get(name, held) != held]
    if different or other:
        what = f"episode {other[0]} of another list" if other else "another world"
        key = "" if other else f": {_difference(different[0], before, told)}"
        raise ValueError(
            f"{folder} holds rows of {what}{key}. Name another folder (out=..., of a training "
            "folder=...), or delete this one."
        )
    known[split] = {"worlds": worlds | {kind: told}, "sums": sums_before | sums}
    with atomic_text(note) as file:
        json.dump(known, file)


def _report_unreadable(
    place: Path, name: str, kind: str, owner: str, unreadable: str, earlier: bool
) -> None:
    """Print that rows of an agent or a world cannot be reused; raise ValueError if there are
    earlier ones in ``place``."""
    if earlier:
        raise ValueError(
            f"{place} holds rows of {name}, perhaps of another {kind}: of {owner}, {unreadable} "
            'cannot be read. Give version="..." to reuse rows of that version, and change it '
            f"whenever the {kind}'s behaviour changes; or name another folder (out=...)."
        )
    print(
        f"{name}: of {owner}, {unreadable} cannot be read, so no later call can reuse these rows. "
        'Give version="..." to allow it.',
        flush=True,
    )


def notes(folder: Path, split: str) -> list[Path]:
    """Return the files that :func:`keep` wrote for ``split``."""
    paths = (folder / NOTE, folder / LIST_HASH.format(split=split))
    return [path for path in paths if path.is_file()]


def _read(note: Path) -> dict[str, dict[str, Any]]:
    """Return what the ``note`` of a folder says, by split. Raises ValueError if it is damaged."""
    again = f"Copy the file back, or move {note.parent} aside and evaluate again."
    known = read_object(note, again)
    for split, entry in known.items():
        if not _is_entry(entry):
            raise ValueError(f"{note}: the entry {short(split)} is damaged. {again}")
    return known


def _is_entry(entry: Any) -> bool:
    """Whether a note's entry of a split has objects where :func:`keep` reads them."""
    if not isinstance(entry, dict):
        return False
    worlds, sums = entry.get("worlds", {}), entry.get("sums", {})
    if not isinstance(worlds, dict) or not isinstance(sums, dict):
        return False
    return all(isinstance(world, dict) for world in worlds.values())


def _described(world: World) -> dict[str, str]:
    """Return what ``world`` is, as texts by name: its class, the environment inside it, and the
    hash of their code where that is of neither this project nor an installed package."""
    sources = [source for layer in _layers(world) for source in source_of(type(layer))]
    told = {CLASS: kind_of(world), ENV: _spec(world), CODE: json_hash(sources) if sources else ""}
    return {key: value for key, value in told.items() if value}


def _is_same(before: str | None, now: str | None) -> bool:
    """Whether two texts say the same: also by two paths of one file."""
    if before == now or CHANGES in (before, now):
        return True
    with suppress(OSError, TypeError, ValueError):
        return samefile(*(f"{Path(json.loads(text or ''))}" for text in (before, now)))
    return False


def _layers(world: World) -> Iterator[Any]:
    """The world, the environment in it, and those that this goes around."""
    layer: Any = world
    for _ in range(MOST_LAYERS):
        if layer is None:
            return
        yield layer
        layer = _environment(layer)


def name_of(world: World) -> str:
    """Return what a world is called: its class, or, of one of ours around an environment, the
    class of that."""
    env = _environment(world)
    ours = type(world).__module__.startswith("mitigate.")
    inner = _member(env, "unwrapped") or env if ours and env is not None else world
    return type(inner).__name__


def _told_by_rows(world: World) -> str:
    """Return the hash of a world's rule and sensors."""
    return json_hash(
        [world.rule, {name: asdict(one) for name, one in sorted(world.sensors.items())}]
    )


def _older(own: Mapping[str, Any]) -> dict[str, str]:
    """What a note of an older version says of the world, by today's names."""
    named = {"world": CLASS, "env": ENV}
    return {key: own[name] for name, key in named.items() if own.get(name)}


def _difference(key: str, before: Mapping[str, str], now: Mapping[str, str]) -> str:
    if key == CODE:
        return f"the code of {now[CLASS]} was changed"
    if key == READ:
        return (
            f"the class attributes of {now[CLASS]}, or the global variables and functions that its "
            "code names, were changed"
        )
    was, is_ = (short(held[key], 200) if key in held else "not set" for held in (before, now))
    return f"{key} was {was} and is {is_}"


def _sum(episode: Episode) -> str:
    """Return 12 hex digits of what an agent and a world are told of an episode; whatever else it
    carries may look otherwise in another process."""
    held = {
        "ids": [episode.episode_id, episode.trajectory_id, episode.scene_id],
        "start": [*map(float, (*episode.start_position, *episode.start_rotation))],
        "goals": [[[*map(float, goal.position)], goal.radius] for goal in episode.goals],
        "instruction": episode.instruction.text,
        "seed": str(episode.info.get("seed")),
    }
    return json_hash(held)


def _spec(world: World) -> str:
    """Return what the environment inside a world, if there is one, says it was made of: worlds of
    one class differ in it alone."""
    spec = _member(_environment(world), "spec")
    entries: Mapping[str, Any] = {}
    with suppress(TypeError):  # None, or an object with slots
        entries = vars(spec)
    if entries.get("id") is None:
        return ""
    kwargs = entries.get("kwargs", {})
    made = json.dumps(kwargs, sort_keys=True, default=lambda x: str(type(x)))
    return f"{entries['id']} {made}"


def _environment(layer: Any) -> Any:
    """The environment inside a world or a wrapper, None if there is none."""
    return _member(layer, "env")


def _member(thing: Any, name: str) -> Any:
    """Return what gymnasium, torchrl and others call ``name``; None if ``thing`` has none."""
    return getattr(thing, name, None)  # their classes have no base in common


MADE = "what makes it"
CHANGES = "changes while worlds are made"
SHOWN = 100  # characters of a value that are kept as they are; of the rest a hash (ours)
DEEPEST, ENTRIES = 5, 50  # of nested values; of a mapping that are told one by one (ours)
MOST = 100_000  # lists, mappings and objects in one value that are told (ours)


def first_world(
    make: Callable[[], World], version: str | None = None
) -> tuple[World, dict[str, str]]:
    """Return a world and what it was made by: the entries of a config, or a function's arguments,
    defaults and the values that it uses, a callable object's class and attributes. Of a value that
    making one changes, such as a cache, ``CHANGES``. Also what the code of its classes reads.

    ``version`` names what cannot be read of the classes.
    """
    before = dict(_made_by(make))
    same = {place for place, (_, last) in _read_by.items() if last == _what_is_read(*place)[0]}
    world = make()
    after = dict(_made_by(make))
    changed = {key for key in {**before, **after} if before.get(key) != after.get(key)}
    place = tuple(type(layer) for layer in _layers(world)), version
    digest, unreadable = _what_is_read(*place)
    _read_by[place] = (_read_by[place][0] if place in same else digest), ""
    told = {READ: _read_by[place][0], UNREADABLE: unreadable}
    found = after | dict.fromkeys(changed, CHANGES)
    return world, found | {key: text for key, text in told.items() if text}


def check_classes(agent: Any, world: World, expected: str) -> None:
    """Raise ValueError if the classes of an agent and a world in a worker process are not those of
    the process that started it (``Known.classes``)."""
    layers = tuple(type(layer) for layer in _layers(world))
    if _hash_of_classes(agent, _what_is_read(layers, None)[0]) != expected:
        raise ValueError(
            f"The class attributes of {type(agent).__name__} or {name_of(world)}, or the global "
            "variables and functions that their code names, are not the same in a worker process, "
            "which imports them again. Set them where they are defined, not later, or give "
            "workers=1."
        )


def _hash_of_classes(agent: Any, of_world: str) -> str:
    return json_hash([_what_is_read((type(agent),), None)[0], of_world])


def _what_is_read(kinds: Sequence[type], version: str | None) -> tuple[str, str]:
    """Return a hash of the attributes of the user's classes among ``kinds``, with the functions
    and global variables that their code names, and what cannot be read of them; "" if nothing."""
    own = tuple(kind for kind in kinds if _is_users(kind))
    if not own:
        return "", ""
    found = contents(own)  # a tuple, as a class may have settings() for its objects
    if found.unreadable and version is not None:
        found = contents(own, version)
    return json_hash(found.parts), found.explain() if found.unreadable else ""


def _is_users(kind: type) -> bool:
    return kind.__module__ == "__main__" or bool(source_of(kind))


def kind_of(thing: object) -> str:
    """The name of a thing's class, with its module."""
    return f"{type(thing).__module__}.{type(thing).__qualname__}"


def json_hash(value: Any) -> str:
    """Return 12 hex digits of what is JSON, or numbers of other libraries."""
    return hashlib.sha256(json.dumps(value, default=float).encode()).hexdigest()[:12]


def _made_by(make: Any) -> Iterator[tuple[str, str]]:
    if isinstance(make, Maker):
        yield from _flat("env.world", make.node)
    elif isinstance(make, partial):
        given = {str(number): value for number, value in enumerate(make.args)} | make.keywords
        yield from _flat(f"{MADE}, argument", given)
        yield from _made_by(make.func)
    elif isinstance(make, MethodType):
        yield from _made_by(make.__func__)
        yield from _object(make.__self__)
    elif isinstance(make, FunctionType):
        if not str(make.__module__).startswith("mitigate."):
            yield from _function(make)
    elif not isinstance(make, type):
        yield from _object(make)


def _function(make: FunctionType) -> Iterator[tuple[str, str]]:
    code = make.__code__  # not its source, which is that of all that its lines hold
    yield from _flat(MADE, [code.co_names, [c for c in code.co_consts if c is not None]])
    defaults = {str(number): value for number, value in enumerate(make.__defaults__ or ())}
    yield from _flat(f"{MADE}, default", defaults | (make.__kwdefaults__ or {}))
    with suppress(ValueError):  # what it uses is not there yet
        used = inspect.getclosurevars(make)
        yield from _each(f"{MADE}, value", {**used.globals, **used.nonlocals})


def _object(thing: Any) -> Iterator[tuple[str, str]]:
    """Of one whose method makes worlds, or that is called itself."""
    if isinstance(thing, type):
        yield f"{MADE}, class", thing.__qualname__
        return
    yield f"{MADE}, class", kind_of(thing)
    yield f"{MADE}, code", json_hash(source_of(type(thing)))
    with suppress(TypeError):  # an object with slots
        yield from _each(f"{MADE}, attribute", vars(thing))


def _each(name: str, values: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Each as a whole: it may change as a whole."""
    return ((f"{name}.{key}", _text(value)) for key, value in values.items())


def _flat(name: str, value: Any, depth: int = 0) -> Iterator[tuple[str, str]]:
    """The entries of nested mappings, by their names joined by points, as JSON."""
    parts: list[tuple[Any, Any]] = []
    if isinstance(value, Mapping) and depth < DEEPEST:
        with suppress(Exception):  # a mapping of the user's
            parts = [*value.items()] if len(value) <= ENTRIES else []
    for key, part in parts:
        yield from _flat(f"{name}.{key}", part, depth + 1)
    if not parts and not (depth == 0 and type(value) is dict and not value):
        yield name, _text(value)


def _text(value: Any) -> str:
    try:
        text = json.dumps(_data(value, 0, count()), sort_keys=True)
    except Exception:  # whatever an object of the user's does when it is looked at
        return kind_of(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({json_hash(text)})"


def _data(value: Any, depth: int, told: Iterator[int]) -> Any:
    """``value`` as JSON; what is no data, too deep, or beyond what is ``told``, by its class."""
    if isinstance(value, (Enum, PurePath)):
        return str(value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic) and not value.dtype.hasobject:
        return value.item()
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return f"array {value.dtype} {value.shape} {array_sha(value)}"
    if depth < DEEPEST and next(told) < MOST:
        inner = partial(_data, depth=depth + 1, told=told)
        if is_dataclass(value) and not isinstance(value, type):
            named = [getattr(value, one.name) for one in fields(value)]  # it may have slots
            return [kind_of(value), [*map(inner, named)]]
        if isinstance(value, dict):
            return {json.dumps(inner(key)): inner(part) for key, part in value.items()}
        if isinstance(value, (list, tuple)):
            return [*map(inner, value)]
        if isinstance(value, (set, frozenset)):
            return sorted(map(inner, value), key=json.dumps)
    # a class or function of any kind, such as a builtin one, or else an object
    return str(getattr(value, "__qualname__", kind_of(value)))
