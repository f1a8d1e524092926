"""In which world and on which episodes the rows in a folder were walked, kept beside them.

A row says its world's rule, and in the agent's hash its sensors; nothing of all else that a world
is, and of its episode the id alone. So rows of another world would count as done.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from os.path import samefile
from pathlib import Path
from typing import Any

from mitigate.agents.fingerprint import source_of
from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_object
from mitigate.core.names import short
from mitigate.evaluation import list_hash, making
from mitigate.evaluation.making import hash_of, kind_of
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

NOTE = "walked.json"
CLASS, CODE, ENV = "its class", "its code", "its env"  # what differs, in words
MOST_LAYERS = 20  # of wrappers around an environment (ours)


def keep(
    folder: Path,
    world: World,
    made_by: Mapping[str, str],
    split: str,
    episodes: Sequence[Episode],
    source: str | None = None,
) -> None:
    """Keep in ``folder`` what ``world`` is and what it was ``made_by`` (``making.first``), a sum of
    each episode of ``split`` and one of ``source``, the file that they come from if they come from
    one; raise ValueError, saying what differs, if one of them is another now.

    Worlds of other sensors or of another rule stand beside one another: their rows say so. What a
    note of an older version does not say may be anything, as may all where there is no note.
    """
    if source is not None:
        list_hash.keep(folder, split, source)
    note = folder / NOTE
    known = _read(note) if note.is_file() else {}
    told, sums = {**_described(world), **made_by}, {e.episode_id: _sum(e) for e in episodes}
    own, kind = known.get(split, {}), _told_by_rows(world)
    worlds, sums_before = own.get("worlds", {}), own.get("sums", {})
    before = worlds.get(kind, told | _older(own))
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


def notes(folder: Path, split: str) -> list[Path]:
    """Return the files that :func:`keep` wrote for ``split``."""
    paths = (folder / NOTE, folder / list_hash.LIST.format(split=split))
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
    told = {CLASS: kind_of(world), ENV: _spec(world), CODE: hash_of(sources) if sources else ""}
    return {key: value for key, value in told.items() if value}


def _is_same(before: str | None, now: str | None) -> bool:
    """Whether two texts say the same: also by two paths of one file."""
    if before == now or making.CHANGES in (before, now):
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
    inner = getattr(env, "unwrapped", env) if ours and env is not None else world
    return type(inner).__name__


def _told_by_rows(world: World) -> str:
    """Return the hash of a world's rule and sensors."""
    return hash_of([world.rule, {name: asdict(one) for name, one in sorted(world.sensors.items())}])


def _older(own: Mapping[str, Any]) -> dict[str, str]:
    """What a note of an older version says of the world, by today's names."""
    named = {"world": CLASS, "env": ENV}
    return {key: own[name] for name, key in named.items() if own.get(name)}


def _difference(key: str, before: Mapping[str, str], now: Mapping[str, str]) -> str:
    if key == CODE:
        return f"the code of {now[CLASS]} was changed"
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
    return hash_of(held)


def _spec(world: World) -> str:
    """Return what the environment inside a world, if there is one, says it was made of: worlds of
    one class differ in it alone."""
    spec = getattr(_environment(world), "spec", None)  # gymnasium's, or of another library
    name = getattr(spec, "id", None)
    if name is None:
        return ""
    made = json.dumps(getattr(spec, "kwargs", {}), sort_keys=True, default=lambda x: str(type(x)))
    return f"{name} {made}"


def _environment(layer: Any) -> Any:
    """The environment inside a world or a wrapper, None if there is none."""
    return getattr(layer, "env", None)  # of any library
