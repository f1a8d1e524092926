"""Read and write episode files in the VLN-CE format, such as the files of R2R-CE, RxR-CE and the
apartments.

A file contains ``{"episodes": [...], ...}`` as plain or gzipped JSON. Positions are in metres in
the VLN-CE frame ``(x, y, z)`` with y up, and rotations are unit quaternions ``(x, y, z, w)``. Files
are read and written as streams, so only one episode is in memory at a time. Unknown keys are
preserved.
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
from mitigate.core.json_files import JsonListError, json_members
from mitigate.core.names import short

Vector = tuple[float, ...]
# Heuristic limits.
MAX_METRES = 1e6
# allowed error of a quaternion's norm, because files may contain rounded numbers
MAX_LENGTH_ERROR = 1e-2
# maximum absolute x and z of a quaternion, which corresponds to a tilt of 11 degrees
MAX_TILT = 0.1
NEEDED = (
    "An episode needs episode_id, trajectory_id, scene_id, start_position [x, y, z], "
    "start_rotation [x, y, z, w], goals [{position, radius}], instruction {instruction_text} and "
    "reference_path [[x, y, z], ...] (goals and reference_path may be absent from a test split "
    "read with hidden_goals=True). "
    "Correct the file, or download it again."
)


class Record:
    """A JSON object that was read from a file. Its error messages name the file and the place."""

    def __init__(self, raw: Any, path: Path | str, where: str) -> None:
        self.raw, self.path, self.where = raw, path, where
        if not isinstance(raw, dict):
            self.fail("is not a JSON object")

    def fail(self, problem: str) -> NoReturn:
        """Raise ValueError with the file, the place, ``problem`` and the expected format."""
        raise ValueError(f"{self.path}: {self.where} {problem}. {NEEDED}")

    def get(self, key: str, kinds: type | tuple[type, ...], default: Any = ...) -> Any:
        """Return the value of ``key``, which must have one of the types ``kinds``.

        A ``default`` of ``...`` means that the key is required.
        """
        value = self.raw.get(key)
        if value is None:
            if default is ...:
                self.fail(f"lacks the key {key!r}")
            return default
        if not isinstance(value, kinds) or isinstance(value, bool):
            self.fail(f"has an invalid {key!r}: {short(value)}")
        return value

    def metres(self, key: str) -> float | None:
        """Return the value of ``key``, a number of metres >= 0, or None if it is absent."""
        value = self.get(key, (int, float), None)
        if value is not None and not (_finite(value) and value >= 0):
            self.fail(f"has an invalid {key!r}: it must be metres >= 0, got {short(value)}")
        return value

    def vector(self, key: str, size: int) -> Vector:
        """Return the value of ``key``, which must be a list of ``size`` finite numbers."""
        return self._vector(key, self.get(key, list), size)

    def rotation(self, key: str) -> Vector:
        """Return the value of ``key``: a unit quaternion (x, y, z, w) about the vertical y axis."""
        quaternion = self.vector(key, 4)
        x, _, z, _ = quaternion
        length_error = abs(math.hypot(*quaternion) - 1)
        if length_error > MAX_LENGTH_ERROR or max(abs(x), abs(z)) > MAX_TILT:
            self.fail(
                f"has an invalid {key!r}: it must be a unit quaternion [x, y, z, w] about the "
                f"vertical y, got {short(list(quaternion))} (is it [w, x, y, z]?)"
            )
        return quaternion

    def vectors(self, key: str, size: int) -> tuple[Vector, ...]:
        """Return the value of ``key``, which must be a non-empty list of vectors."""
        return tuple(self._vector(key, value, size) for value in self._items(key))

    def records(self, key: str) -> list[Record]:
        """Return the value of ``key``, which must be a non-empty list of objects."""
        items = enumerate(self._items(key))
        return [Record(item, self.path, f"{self.where}, {key}[{i}],") for i, item in items]

    def rest(self, *known: str) -> dict[str, Any]:
        """Return all entries except those whose keys are in ``known``."""
        return {key: value for key, value in self.raw.items() if key not in known}

    def _items(self, key: str) -> list[Any]:
        items = self.get(key, list)
        if not items:
            self.fail(f"has an empty {key!r}")
        return items

    def _vector(self, key: str, value: Any, size: int) -> Vector:
        if not isinstance(value, list) or len(value) != size or not all(map(_finite, value)):
            self.fail(
                f"has an invalid {key!r}: it must be {size} finite numbers, got {short(value)}"
            )
        return tuple(map(float, value))


def _finite(value: Any) -> bool:
    """Return whether a value is a number with an absolute value of at most ``MAX_METRES``."""
    # the comparison is false for NaN
    return isinstance(value, (int, float)) and abs(value) <= MAX_METRES


IDS = ("episode_id", "trajectory_id")
MAX_ID = 200  # maximum number of characters of an id (heuristic)
MAX_TEXT = 100_000  # maximum number of characters of an instruction (heuristic)
KEYS = (
    "scene_id",
    "start_position",
    "start_rotation",
    "info",
    "goals",
    "instruction",
    "reference_path",
)

# Defaults for an episode that has a seed. Its world does not read these values.
_SEEDED = {"scene_id": "", "start_position": [0, 0, 0], "start_rotation": [0, 0, 0, 1]}


def from_vlnce(position: Vector) -> np.ndarray:
    """Convert a VLN-CE position to a plan position: float64 [2] in metres."""
    return np.array([position[0], -position[2]], np.float64)


def heading_of(rotation: Vector) -> float:
    """Convert a quaternion [x, y, z, w] about the vertical to a heading in radians."""
    return float(2 * np.arctan2(rotation[1], rotation[3]))


@dataclass(frozen=True)
class Goal:
    """A goal of an episode.

    Attributes:
        position: VLN-CE position [3] in metres.
        radius: Success radius in metres, or None if the file does not specify it.
        extra: Other keys of the file.
    """

    position: Vector
    radius: float | None = None
    extra: dict[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Instruction:
    """An instruction.

    Attributes:
        text: The text.
        tokens: Token ids, or None if the file has no tokens.
        language: Language code, such as ``en-US`` in RxR.
        extra: Other keys of the file.
    """

    text: str
    tokens: tuple[int, ...] | None = None
    language: str | None = None
    extra: dict[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Episode:
    """An episode.

    Attributes:
        episode_id: Id as a string. :func:`write_episodes` writes it with the JSON type that it had
            in the file.
        trajectory_id: Id of the reference path; its type is handled as for ``episode_id``.
        scene_id: Name of the scene.
        start_position: VLN-CE position [3] in metres.
        start_rotation: Quaternion [x, y, z, w].
        goals: List of goals. It is empty only if a test split hides the goals.
        instruction: The instruction.
        reference_path: VLN-CE positions [N][3]. The list is empty only if a test split hides the
            path.
        geodesic_distance: Distance in metres from start to goal, as in
            ``info["geodesic_distance"]``, or None.
        info: Value of the key ``info``.
        extra: Other keys of the file.
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


def placeless_episode(name: str, text: str, **info: Any) -> Episode:
    """Return an episode without positions, for worlds that read only its id, text and info."""
    return Episode(
        episode_id=name,
        trajectory_id=name,
        scene_id="",
        start_position=(0.0, 0.0, 0.0),
        start_rotation=(0.0, 0.0, 0.0, 1.0),
        goals=(),
        instruction=Instruction(text),
        reference_path=(),
        info=info,
    )


def read_episodes(path: Path | str, *, hidden_goals: bool = False) -> Iterator[Episode]:
    """Yield the episodes of a file in order.

    If an episode has a seed (``info["seed"]``, see ``worlds/seeded.py``), it needs only an id and
    an instruction.

    Args:
        path: The file.
        hidden_goals: Whether to accept episodes without goals and without a reference path, as in
            test splits.

    Raises:
        FileNotFoundError: If the file does not exist.
        ValueError: If an episode is invalid. The message names the file, the episode and the key.
    """
    has_episodes = False
    for key, items in _members(path):
        if key != "episodes":
            continue
        has_episodes = True
        if not isinstance(items, Iterator):
            raise ValueError(
                f"{path}: 'episodes' must be a list, got {short(items)}. Correct the file, or "
                "download it again."
            )
        for index, raw in enumerate(items):
            yield _read_episode(raw, path, index, hidden_goals)
    if not has_episodes:
        raise ValueError(
            f"{path} has no key 'episodes': it is not a VLN-CE episode file. The format is "
            '{"episodes": [...]}; ground truth (*_gt.json.gz) is not read, and '
            "files of the discrete R2R and RxR tasks must first be converted to VLN-CE."
        )


def share_of(items: Any, piece: int, pieces: int) -> Any:
    """Return every n-th item of a list or range, starting at the index of a worker.

    This divides items such as scenes among n workers. ``piece`` is the index of the worker, and
    ``pieces`` is the number of workers, n.
    """
    return items[piece % len(items) :: pieces]


def is_seed(value: Any) -> bool:
    """Return whether ``value`` is a valid seed of an environment.

    Valid seeds are integers from 0 to 2**31 - 1.
    """
    return type(value) is int and 0 <= value < 1 << 31


class ListedEpisodes:
    """Source of training episodes (``worlds/world.py``) from the episode file ``path``.

    Each of n workers samples only from every n-th episode, so different parts of a batch use
    different episodes. Raises ValueError if the file is invalid or contains no episode.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = str(path)
        self._episodes = list(read_episodes(path))
        if not self._episodes:
            raise ValueError(f"{path} must contain at least one episode to train on.")

    def draw(self, rng: np.random.Generator, share: tuple[int, int] = (0, 1)) -> Episode:
        """Sample an episode; see ``TrainingEpisodes`` (``worlds/world.py``)."""
        episodes = share_of(self._episodes, *share)
        return episodes[int(rng.integers(len(episodes)))]

    def identity(self) -> dict[str, str]:
        """Return the sha256 of the file, because training must not resume with a different file."""
        return {"training_sha256": sha256(self.path)}


def read_extras(path: Path | str) -> dict[str, Any]:
    """Return all entries of a file except the episodes, such as ``instruction_vocab``."""
    return {key: value for key, value in _members(path) if key != "episodes"}


def _members(path: Path | str) -> Iterator[tuple[str, Any]]:
    """Yield the keys and values of an episode file.

    Raise ValueError with advice if the file belongs to the discrete R2R task.
    """
    try:
        yield from json_members(path, "episodes")
    except JsonListError as error:
        raise ValueError(
            f"{error} Is it a list of the discrete R2R task (scan, path, instructions)? Convert "
            'it, or use R2R-CE: {"episodes": [...]}.'
        ) from error


def write_episodes(
    path: Path | str, episodes: Iterable[Episode], extras: Mapping[str, Any] | None = None
) -> Path:
    """Write a VLN-CE file, and return its path. If writing fails, the old file is kept.

    Args:
        path: Path of the file. The file is gzipped if the name ends in ``.gz``.
        episodes: The episodes.
        extras: Other top-level keys and their values, as returned by :func:`read_extras`.

    Raises:
        ValueError: If a value cannot be written as JSON, such as NaN or infinity.
    """
    path = Path(path)
    with atomic_text(path) as file:
        file.write('{"episodes": [')
        for index, episode in enumerate(episodes):
            file.write(",\n" if index else "\n")
            file.write(_dump(to_json(episode), path, f"episode {episode.episode_id}"))
        file.write("\n]")
        for key, value in (extras or {}).items():
            file.write(f",\n{json.dumps(key)}: {_dump(value, path, key)}")
        file.write("}\n")
    return path


def to_json(episode: Episode) -> dict[str, Any]:
    """Return an episode as a JSON object of a VLN-CE file."""
    data: dict[str, Any] = {
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
        data["info"]["geodesic_distance"] = episode.geodesic_distance
    for key in ("info", "goals", "reference_path"):
        if not data[key]:
            del data[key]
    return data | {key: value for key, value in episode.extra.items() if key not in IDS}


def _read_episode(raw: Any, path: Path | str, index: int, hidden_goals: bool) -> Episode:
    episode_id = raw.get("episode_id") if isinstance(raw, dict) else None
    seeded = isinstance(raw, dict) and isinstance(raw.get("info"), dict) and "seed" in raw["info"]
    if seeded:
        raw = {"trajectory_id": episode_id, **_SEEDED, **raw}
        hidden_goals = True
    record = Record(raw, path, f"episode {index} of the list (episode_id {short(episode_id)})")
    if seeded and not is_seed(raw["info"]["seed"]):
        record.fail("has an invalid 'seed' in info: it must be an integer from 0 to 2147483647")
    hide = hidden_goals and raw.get("goals") is None and raw.get("reference_path") is None
    info = record.get("info", dict, {})
    ids = {key: record.get(key, (int, str)) for key in IDS}
    for key, value in ids.items():
        if not str(value) or len(str(value)) > MAX_ID or not str(value).isprintable():
            record.fail(
                f"has an invalid {key!r}: it must be one line of at most {MAX_ID} characters"
            )
    return Episode(
        episode_id=str(ids["episode_id"]),
        trajectory_id=str(ids["trajectory_id"]),
        scene_id=record.get("scene_id", str),
        start_position=record.vector("start_position", 3),
        start_rotation=record.rotation("start_rotation"),
        goals=() if hide else tuple(map(_read_goal, record.records("goals"))),
        instruction=_read_instruction(record),
        reference_path=() if hide else record.vectors("reference_path", 3),
        geodesic_distance=Record(info, path, f"{record.where}, info,").metres("geodesic_distance"),
        info=info,
        extra=record.rest(*IDS, *KEYS) | {k: v for k, v in ids.items() if isinstance(v, int)},
    )


def _read_goal(record: Record) -> Goal:
    return Goal(
        position=record.vector("position", 3),
        radius=record.metres("radius"),
        extra=record.rest("position", "radius"),
    )


def _read_instruction(episode: Record) -> Instruction:
    raw = episode.get("instruction", dict)
    record = Record(raw, episode.path, f"{episode.where}, instruction,")
    tokens = record.get("instruction_tokens", list, None)
    text = record.get("instruction_text", str)
    if len(text) > MAX_TEXT:
        record.fail(f"has an 'instruction_text' of more than {MAX_TEXT} characters")
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
    data: dict[str, Any] = {"instruction_text": instruction.text}
    if instruction.tokens is not None:
        data["instruction_tokens"] = list(instruction.tokens)
    if instruction.language is not None:
        data["language"] = instruction.language
    return data | instruction.extra


def _identifier(episode: Episode, key: str) -> int | str:
    """Return an id with the JSON type that it had in the file.

    If the id of the episode was changed after the file was read, return the new id as a string.
    """
    text = str(vars(episode)[key])
    original = episode.extra.get(key)
    return original if isinstance(original, int) and str(original) == text else text


def _dump(value: Any, path: Path, name: str) -> str:
    """Return a value as JSON text. Raise ValueError if JSON cannot represent the value."""
    try:
        text = json.dumps(value, ensure_ascii=False, allow_nan=False)
        text.encode("utf-8")  # encoding fails if the text contains half a surrogate pair
        return text
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"{path}: {name} has a value that JSON cannot represent ({error}). Replace NaN, "
            "infinity, arrays and numpy numbers by plain finite numbers, lists and strings."
        ) from error
