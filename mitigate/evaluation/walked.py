"""In which world and on which episodes the rows in a folder were walked, kept beside them.

A row says its world's rule, and in the agent's hash its sensors; nothing of all else that a world
is, and of its episode the id alone. So rows of another world would count as done.
"""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from pathlib import Path
from types import FunctionType
from typing import Any

from mitigate.core.build import Maker
from mitigate.core.files import atomic_text
from mitigate.core.identity import source_of
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.evaluation import list_hash
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

NOTE = "walked.json"
CLASS, CODE, ENV, MADE = (
    "its class",
    "its code",
    "its env",
    "what makes it",
)  # what differs, in words
MOST_LAYERS = 20  # of wrappers around an environment (ours)


def keep(
    folder: Path,
    make_world: Callable[[], World],
    world: World,
    split: str,
    episodes: Sequence[Episode],
    source: str | None = None,
) -> None:
    """Keep in ``folder`` what ``world`` is, which ``make_world`` made, a sum of each episode of
    ``split`` and one of ``source``, the file that they come from if they come from one; raise
    ValueError, saying what differs, if one of them is another now.

    Worlds of other sensors or of another rule stand beside one another: their rows say so. What a
    note of an older version does not say may be anything, as may all where there is no note.
    """
    if source is not None:
        list_hash.keep(folder, split, source)
    note = folder / NOTE
    known = read_json(note, "Delete its folder.") if note.is_file() else {}
    told, sums = described(make_world, world), {e.episode_id: _sum(e) for e in episodes}
    own, kind = known.get(split, {}), _told_by_rows(world)
    worlds, sums_before = own.get("worlds", {}), own.get("sums", {})
    before = worlds.get(kind, told | _older(own))
    different = [key for key in {**before, **told} if before.get(key) != told.get(key)]
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


def described(make_world: Callable[[], World], world: World) -> dict[str, str]:
    """Return what ``world`` is, as texts by name: its class, the environment inside it, the hash of
    their code where that is of neither this project nor an installed package, and what it was made
    by: the entries of a config, or a function's arguments and the values that it uses."""
    sources = [source for layer in _layers(world) for source in source_of(type(layer))]
    told = {CLASS: _kind(world), ENV: _spec(world), CODE: _hash(sources) if sources else ""}
    return {key: value for key, value in (*told.items(), *_made_by(make_world)) if value}


def _layers(world: World) -> Iterator[Any]:
    """The world, the environment in it, and those that this goes around."""
    layer: Any = world
    for _ in range(MOST_LAYERS):
        if layer is None:
            return
        yield layer
        layer = getattr(layer, "env", None)


def name_of(world: World) -> str:
    """Return what a world is called: its class, or, of one of ours around an environment, the
    class of that."""
    env = getattr(world, "env", None)
    ours = type(world).__module__.startswith("mitigate.")
    inner = getattr(env, "unwrapped", env) if ours and env is not None else world
    return type(inner).__name__


def _kind(thing: object) -> str:
    return f"{type(thing).__module__}.{type(thing).__qualname__}"


def _told_by_rows(world: World) -> str:
    """Return the hash of a world's rule and sensors."""
    return _hash([world.rule, {name: asdict(one) for name, one in sorted(world.sensors.items())}])


def _older(own: Mapping[str, Any]) -> dict[str, str]:
    """What a note of an older version says of the world, by today's names."""
    named = {"world": CLASS, "env": ENV}
    return {key: own[name] for name, key in named.items() if own.get(name)}


def _difference(key: str, before: Mapping[str, str], now: Mapping[str, str]) -> str:
    if key == CODE:
        return f"the code of {now[CLASS]} was changed"
    was, is_ = (short(held[key], 200) if key in held else "not set" for held in (before, now))
    return f"{key} was {was} and is {is_}"


def _made_by(make: Any) -> Iterator[tuple[str, str]]:
    """What a world is made by, as (name, text) each."""
    if isinstance(make, Maker):
        yield from _flat("env.world", make.node)
    elif isinstance(make, partial):
        given = {str(number): value for number, value in enumerate(make.args)} | make.keywords
        yield from _flat(f"{MADE}, argument", given)
        yield from _made_by(make.func)
    elif isinstance(make, FunctionType) and not make.__module__.startswith("mitigate."):
        code = make.__code__  # not its source, which is that of all that its lines hold
        yield from _flat(MADE, [code.co_names, [c for c in code.co_consts if c is not None]])
        with suppress(ValueError):  # what it uses is not there yet
            used = inspect.getclosurevars(make)
            yield from _flat(f"{MADE}, value", {**used.globals, **used.nonlocals})


def _flat(name: str, value: Any) -> Iterator[tuple[str, str]]:
    """The entries of nested mappings, by their names joined by points, as JSON."""
    if isinstance(value, Mapping) and value:
        for key, part in value.items():
            yield from _flat(f"{name}.{key}", part)
    else:
        yield name, json.dumps(value, sort_keys=True, default=_name)


def _name(value: Any) -> str:
    """What is no data, by its name or class alone: it may look otherwise in another process."""
    return str(getattr(value, "__qualname__", type(value)))


def _hash(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, default=float).encode()).hexdigest()[:12]


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
    return _hash(held)


def _spec(world: World) -> str:
    """Return what the environment inside a world, if there is one, says it was made of: worlds of
    one class differ in it alone."""
    spec = getattr(getattr(world, "env", None), "spec", None)
    name = getattr(spec, "id", None)
    if name is None:
        return ""
    made = json.dumps(getattr(spec, "kwargs", {}), sort_keys=True, default=lambda x: str(type(x)))
    return f"{name} {made}"
