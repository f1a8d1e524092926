"""Episode files in the VLN-CE format: one streaming reader and writer for R2R-CE, RxR-CE and ours.

A file is ``{"episodes": [...], ...}``, plain or gzipped JSON. Positions are metres in the VLN-CE
frame ``(x, y up, z)``, rotations unit quaternions ``(x, y, z, w)``. One episode at a time is held
in memory, whatever the size of the file; keys this code does not know come back when written.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from mitigate.core.files import atomic_text, sha256
from mitigate.core.json_files import json_members
from mitigate.core.names import short

Vector = tuple[float, ...]
FARTHEST = 1e6  # metres (ours)
OFF_ONE = 1e-2  # of a quaternion's length, for digits that were cut (ours)
TILTED = 0.1  # of a quaternion's x and z: 11 degrees (ours)
NEEDED = (
    "An episode needs episode_id, trajectory_id, scene_id, start_position [x, y, z], "
    "start_rotation [x, y, z, w], goals [{position, radius}], instruction {instruction_text} and "
    "reference_path [[x, y, z], ...] (goals and reference_path may be absent from a test split "
    "read with hidden_goals=True); a ground-truth entry needs locations [[x, y, z], ...]. "
    "Correct the file, or download it again."
)


class Record:
    """A JSON object of a file, read with errors that say where it stands."""

    def __init__(self, raw: Any, path: Path | str, where: str) -> None:
        self.raw, self.path, self.where = raw, path, where
        if not isinstance(raw, dict):
            self.fail("is not a JSON object")

    def fail(self, problem: str) -> NoReturn:
        """Raise ValueError with file, place, ``problem`` and what is needed."""
        raise ValueError(f"{self.path}: {self.where} {problem}. {NEEDED}")

    def get(self, key: str, kinds: type | tuple[type, ...], default: Any = ...) -> Any:
        """Return the value of ``key``, checked against ``kinds``; ``...`` means required."""
        value = self.raw.get(key)
        if value is None and default is not ...:
            return default
        if value is None:
            self.fail(f"lacks the key {key!r}")
        if not isinstance(value, kinds) or isinstance(value, bool):
            self.fail(f"has a wrong {key!r}: {short(value)}")
        return value

    def metres(self, key: str) -> float | None:
        """Return the finite number ``key``, 0 or more, None if it is absent."""
        value = self.get(key, (int, float), None)
        if value is not None and not (_finite(value) and value >= 0):
            self.fail(f"has a wrong {key!r}: metres from 0 on are needed, not {short(value)}")
        return value

    def vector(self, key: str, size: int) -> Vector:
        """Return ``key`` as ``size`` finite numbers."""
        return self._vector(key, self.get(key, list), size)

    def rotation(self, key: str) -> Vector:
        """Return ``key`` as a unit quaternion (x, y, z, w) about the vertical y."""
        found = self.vector(key, 4)
        x, _, z, _ = found
        if abs(math.hypot(*found) - 1) > OFF_ONE or max(abs(x), abs(z)) > TILTED:
            self.fail(
                f"has a wrong {key!r}: a unit quaternion [x, y, z, w] about the vertical y is "
                f"needed, not {short(list(found))} (is it [w, x, y, z]?)"
            )
        return found

    def vectors(self, key: str, size: int) -> tuple[Vector, ...]:
        """Return ``key`` as a non-empty list of vectors."""
        values = self.get(key, list)
        if not values:
            self.fail(f"has an empty {key!r}")
        return tuple(self._vector(key, value, size) for value in values)

    def records(self, key: str) -> list[Record]:
        """Return the objects of the non-empty list ``key``."""
        values = self.get(key, list)
        if not values:
            self.fail(f"has an empty {key!r}")
        return [Record(v, self.path, f"{self.where}, {key}[{i}],") for i, v in enumerate(values)]

    def rest(self, *known: str) -> dict[str, Any]:
        """Return the keys that are not ``known``."""
        return {key: value for key, value in self.raw.items() if key not in known}

    def _vector(self, key: str, value: Any, size: int) -> Vector:
        if not isinstance(value, list) or len(value) != size or not all(map(_finite, value)):
            self.fail(f"has a wrong {key!r}: {size} finite numbers are needed, not {short(value)}")
        return tuple(map(float, value))


def _finite(value: Any) -> bool:
    return isinstance(value, (int, float)) and abs(value) <= FARTHEST  # not of NaN, nor of True


IDS = ("episode_id", "trajectory_id")
LONGEST_ID, LONGEST_TEXT = 200, 100_000  # characters (ours)
KEYS = (
    *("scene_id", "start_position", "start_rotation", "info", "goals", "instruction"),
    "reference_path",
)

# of an episode that is a seed, whose world reads nothing else of it
_NOWHERE = {"scene_id": "", "start_position": [0, 0, 0], "start_rotation": [0, 0, 0, 1]}


def from_vlnce(position: Vector) -> np.ndarray:
    """VLN-CE position to plan metres, the frame of poses: float64 [2]."""
    return np.array([position[0], -position[2]], np.float64)


def heading_of(rotation: Vector) -> float:
    """Quaternion [x, y, z, w] about the vertical to a heading in radians."""
    return float(2 * np.arctan2(rotation[1], rotation[3]))


@dataclass(frozen=True)
class Goal:
    """Where to end: ``position`` [3] and success ``radius`` in metres, None if not in the file."""

    position: Vector
    radius: float | None = None
    extra: dict[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Instruction:
    """What to do: text, its tokens if the file has them, its language (RxR: ``en-US`` ...)."""

    text: str
    tokens: tuple[int, ...] | None = None
    language: str | None = None
    extra: dict[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Episode:
    """One episode; ids are strings here and get back the JSON type they had when written.

    ``goals`` and ``reference_path`` [N][3] are empty only where a test split hides them.
    ``geodesic_distance`` (metres, start to goal) is ``info["geodesic_distance"]``, or None.
    """

    episode_id: str
    trajectory_id: str
    scene_id: str
    start_position: Vector
    start_rotation: Vector
    goals: tuple[Goal, ...]
    instruction: Instruction
    reference_path: tuple[Vector, ...]
    geodesic_distance: float | None = None
    info: dict[str, Any] = field(default_factory=dict, hash=False)
    extra: dict[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True, eq=False)
class GroundTruth:
    """The path an annotator's route follows: ``locations`` float64 [N, 3] and its actions."""

    locations: np.ndarray
    actions: tuple[int, ...] = ()


def read_episodes(path: Path | str, *, hidden_goals: bool = False) -> Iterator[Episode]:
    """Yield the episodes of ``path`` in order.

    ``hidden_goals`` accepts episodes without goals and reference path, as in test splits. Of one
    that is a seed (``info["seed"]``, ``worlds/seeded.py``) an id and an instruction will do.
    Raises FileNotFoundError, or ValueError naming file, episode and key, while iterating.
    """
    found = False
    for key, items in json_members(path, "episodes"):
        if key != "episodes":
            continue
        found = True
        if not isinstance(items, Iterator):
            raise ValueError(
                f"{path}: 'episodes' is {short(items)}, not a list. Correct the file, or download "
                "it again."
            )
        for index, raw in enumerate(items):
            yield _episode(raw, path, index, hidden_goals)
    if not found:
        raise ValueError(
            f"{path} has no key 'episodes': it is not a VLN-CE episode file. The format is "
            '{"episodes": [...]}; ground truth (*_gt.json.gz) is read by read_ground_truth, and '
            "files of the discrete R2R and RxR tasks must first be converted to VLN-CE."
        )


def share_of(items: Any, piece: int, pieces: int) -> Any:
    """Of a list or range, of scenes say, what piece ``piece`` of ``pieces`` of every step draws
    from: a worker process then opens only those of its pieces."""
    return items[piece % len(items) :: pieces]


def is_seed(value: Any) -> bool:
    """Whether an environment can be seeded by ``value``: a whole number of 31 bits."""
    return type(value) is int and 0 <= value < 1 << 31


class ListedEpisodes:
    """Training episodes (``worlds/world.py``) drawn from a file.

    Args: path: as :func:`read_episodes`; errors as there. Worker processes that draw different
    pieces of a batch draw from different episodes, every n-th of the file.
    """

    def __init__(self, path: Path | str) -> None:
        self.path, self._listed = str(path), list(read_episodes(path))
        if not self._listed:
            raise ValueError(f"{path} lists no episode to train on.")

    def draw(self, rng: np.random.Generator, share: tuple[int, int] = (0, 1)) -> Episode:
        """A function of the generator's state and of ``share``: (piece, of how many)."""
        mine = share_of(self._listed, *share)
        return mine[int(rng.integers(len(mine)))]

    def identity(self) -> dict[str, str]:
        """The hash of the file: a training is not continued on another."""
        return {"training_sha256": sha256(self.path)}


def read_extras(path: Path | str) -> dict[str, Any]:
    """Return what ``path`` holds beside its episodes, such as R2R-CE's ``instruction_vocab``."""
    return {key: value for key, value in json_members(path, "episodes") if key != "episodes"}


def write_episodes(
    path: Path | str, episodes: Iterable[Episode], extras: Mapping[str, Any] | None = None
) -> Path:
    """Write a VLN-CE file (gzipped if the name ends in ``.gz``) and return its path.

    ``extras`` are further top-level keys (see :func:`read_extras`). The file appears whole or not
    at all. Numbers that JSON cannot hold (NaN, infinity) raise ValueError.
    """
    path = Path(path)
    with atomic_text(path) as file:
        file.write('{"episodes": [')
        for index, episode in enumerate(episodes):
            file.write(",\n" if index else "\n")
            file.write(_json(to_json(episode), path, f"episode {episode.episode_id}"))
        file.write("\n]")
        for key, value in (extras or {}).items():
            file.write(f",\n{json.dumps(key)}: {_json(value, path, key)}")
        file.write("}\n")
    return path


def read_ground_truth(path: Path | str) -> dict[str, GroundTruth]:
    """Return ``episode_id -> GroundTruth`` of a VLN-CE ``*_gt.json`` or ``*_gt.json.gz``."""
    truths = {}
    for key, value in json_members(path, "episodes"):
        if key == "episodes":
            raise ValueError(f"{path} is an episode file: read it with read_episodes.")
        record = Record(value, path, f"ground-truth entry {key!r}")
        locations = record.vectors("locations", 3)
        truths[key] = GroundTruth(np.array(locations), tuple(record.get("actions", list, [])))
    return truths


def to_json(episode: Episode) -> dict[str, Any]:
    """Return ``episode`` as the dictionary a VLN-CE file holds."""
    written: dict[str, Any] = {
        "episode_id": _identifier(episode, "episode_id"),
        "trajectory_id": _identifier(episode, "trajectory_id"),
        "scene_id": episode.scene_id,
        "start_position": list(episode.start_position),
        "start_rotation": list(episode.start_rotation),
        "info": dict(episode.info),
        "goals": [_goal_json(goal) for goal in episode.goals],
        "instruction": _instruction_json(episode.instruction),
        "reference_path": [list(point) for point in episode.reference_path],
    }
    if episode.geodesic_distance is not None:
        written["info"]["geodesic_distance"] = episode.geodesic_distance
    for key in ("info", "goals", "reference_path"):
        if not written[key]:
            del written[key]
    return written | {key: value for key, value in episode.extra.items() if key not in IDS}


def _episode(raw: Any, path: Path | str, index: int, hidden_goals: bool) -> Episode:
    identity = raw.get("episode_id") if isinstance(raw, dict) else None
    seeded = isinstance(raw, dict) and isinstance(raw.get("info"), dict) and "seed" in raw["info"]
    if seeded:
        raw, hidden_goals = {"trajectory_id": identity, **_NOWHERE, **raw}, True
    record = Record(raw, path, f"episode {index} of the list (episode_id {short(identity)})")
    if seeded and not is_seed(raw["info"]["seed"]):
        record.fail("has a wrong 'seed' in info: it must be a whole number from 0 to 2147483647")
    hide = hidden_goals and raw.get("goals") is None and raw.get("reference_path") is None
    info = record.get("info", dict, {})
    ids = {key: record.get(key, (int, str)) for key in IDS}
    for key, value in ids.items():
        if not str(value) or len(str(value)) > LONGEST_ID or not str(value).isprintable():
            record.fail(
                f"has a wrong {key!r}: it must be one line of at most {LONGEST_ID} characters"
            )
    return Episode(
        episode_id=str(ids["episode_id"]),
        trajectory_id=str(ids["trajectory_id"]),
        scene_id=record.get("scene_id", str),
        start_position=record.vector("start_position", 3),
        start_rotation=record.rotation("start_rotation"),
        goals=() if hide else tuple(map(_goal, record.records("goals"))),
        instruction=_instruction(record),
        reference_path=() if hide else record.vectors("reference_path", 3),
        geodesic_distance=Record(info, path, f"{record.where}, info,").metres("geodesic_distance"),
        info=info,
        extra=record.rest(*IDS, *KEYS) | {k: v for k, v in ids.items() if isinstance(v, int)},
    )


def _goal(record: Record) -> Goal:
    return Goal(
        position=record.vector("position", 3),
        radius=record.metres("radius"),
        extra=record.rest("position", "radius"),
    )


def _instruction(episode: Record) -> Instruction:
    raw = episode.get("instruction", dict)
    record = Record(raw, episode.path, f"{episode.where}, instruction,")
    tokens = record.get("instruction_tokens", list, None)
    text = record.get("instruction_text", str)
    if len(text) > LONGEST_TEXT:
        record.fail(f"has an 'instruction_text' of more than {LONGEST_TEXT} characters")
    return Instruction(
        text=text,
        tokens=None if tokens is None else tuple(tokens),
        language=record.get("language", str, None),
        extra=record.rest("instruction_text", "instruction_tokens", "language"),
    )


def _goal_json(goal: Goal) -> dict[str, Any]:
    radius = {} if goal.radius is None else {"radius": goal.radius}
    return {"position": list(goal.position)} | radius | goal.extra


def _instruction_json(instruction: Instruction) -> dict[str, Any]:
    written: dict[str, Any] = {"instruction_text": instruction.text}
    if instruction.tokens is not None:
        written["instruction_tokens"] = list(instruction.tokens)
    if instruction.language is not None:
        written["language"] = instruction.language
    return written | instruction.extra


def _identifier(episode: Episode, key: str) -> int | str:
    """Return an id as the file had it, unless it was replaced since."""
    text, original = str(vars(episode)[key]), episode.extra.get(key)
    return original if isinstance(original, int) and str(original) == text else text


def _json(value: Any, path: Path, name: str) -> str:
    try:
        text = json.dumps(value, ensure_ascii=False, allow_nan=False)
        text.encode("utf-8")  # which half a character is not
        return text
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"{path}: {name} holds what JSON cannot ({error}): replace NaN, infinity, arrays and "
            "numpy numbers by plain finite numbers, lists and strings."
        ) from error
