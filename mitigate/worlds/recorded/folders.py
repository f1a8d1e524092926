"""Folders of recorded frames: by ``mitigate run record=``, in TUM RGB-D's form, or simply named.

* ``recording.json`` and ``<scene>/<episode>/<camera>/000000.png``: what ``mitigate run`` recorded;
* ``rgb.txt``, ``depth.txt``, ``groundtruth.txt``: the form of the TUM RGB-D benchmark (Sturm et
  al., IROS 2012), which most tools for RGB-D cameras write;
* ``rgb/`` and ``depth/`` with a file for each step, in the order of their names; with
  ``poses.csv``, a line "x,y,heading" for each (metres, radians, forward is (-sin h, cos h)).

Beside each, ``instruction.txt`` may hold the words.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import RECORDING
from mitigate.core.json_files import parse_json, read_json
from mitigate.core.names import short, unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import frame_files
from mitigate.corruptions.frame_files import SUFFIXES, natural
from mitigate.worlds.episodes import from_vlnce
from mitigate.worlds.recorded.source import (
    LARGEST_WORDS,
    LONGEST,
    SLOP,
    Lens,
    near,
    placed,
    plan_pose,
    rotated,
    text,
    words,
)

CAMERAS, STEPS, EPISODE = "cameras.json", "steps.jsonl", "episode.json"
POSES, WORDS = "poses.csv", "instruction.txt"
MOST = 1e6  # of a number in a recording: metres, degrees (ours)
MOST_TURNED = 50.0  # radians: eight turns, not degrees (ours)


@dataclass(frozen=True)
class Frames:
    """A drive in files; ``files``: of each camera, one for each instant. ``unit``: metres of a
    count of 16-bit depth. The rest as ``source.py`` says of a Source."""

    name: str
    instruction: str
    cameras: Mapping[str, Lens]
    files: Mapping[str, Sequence[Path]]
    times: np.ndarray
    poses: np.ndarray | None
    stepped: bool
    dropped: int
    unit: float

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        for index in chosen:
            yield {name: self._read(name, files[index]) for name, files in self.files.items()}

    def _read(self, camera: str, path: Path) -> np.ndarray:
        try:
            frame = frame_files.read(path, self.unit)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} {error}. Mend it, or take it out of the drive.") from error
        wanted = self.cameras[camera].kind
        if (frame.shape[-1] == 3) != (wanted == RGB):
            raise ValueError(f"{path} is no {wanted} frame, but lies among those of {camera!r}.")
        if wanted == RGB:
            return frame
        depth = frame[..., 0]
        return np.where(np.isfinite(depth) & (depth > 0), depth, 0).astype(np.float32)


def open_folder(
    path: Path, hfov: float | None, unit: float | None, cameras: Sequence[str] | None = None
) -> list[Frames]:
    """The drives in a folder, or in those below it; ``hfov`` (degrees) and ``unit`` (metres of a
    count of depth) where the folder does not say; ``cameras``: those that are read of a recording
    by ``mitigate run``.

    Raises FileNotFoundError if there is none, ValueError for what is damaged or does not fit.
    """
    if (path / RECORDING).is_file():
        if unit is not None:
            raise ValueError(f"{path} says the unit of its depth itself: leave unit= out.")
        # a hidden one is of an episode that somebody is in, or was when he was killed
        episodes = sorted(file.parent for file in path.glob(f"[!.]*/[!.]*/{STEPS}"))
        read = (_recorded(folder, path, hfov, cameras) for folder in episodes)
        return [drive for drive in read if drive is not None]
    if cameras:
        raise ValueError(f"cameras= chooses of a recording by mitigate run, which {path} is not.")
    if _has_lists(path):
        lenses, files, times, poses, dropped = _read_lists(path, hfov)
        said, per_count = words(path / WORDS), TUM_UNIT if unit is None else unit
        return [Frames(path.name, said, lenses, files, times, poses, False, dropped, per_count)]
    if (path / TRAJECTORY).is_file():
        raise ValueError(f"{path} has {TRAJECTORY}, but not its lists {', '.join(LISTS)}.")
    return [_simple(path, hfov, unit)]


def is_drive(folder: Path) -> bool:
    """Whether a folder holds frames in one of the forms above."""
    return any((folder / name).exists() for name in (RECORDING, *LISTS, RGB, DEPTH))


def _recorded(
    folder: Path, top: Path, hfov: float | None, chosen: Sequence[str] | None
) -> Frames | None:
    """An episode that ``mitigate run`` recorded; None for one without a frame. One that was cut off
    ends with its last whole step."""
    told, steps = _json(folder / EPISODE), _lines(folder / STEPS)
    listed = _json(folder / CAMERAS) if (folder / CAMERAS).is_file() else {}
    names = sorted(p.name for p in folder.iterdir() if p.is_dir())
    for camera in chosen or ():
        if camera not in names:
            raise ValueError(unknown("camera", camera, names))
    files = {n: _ordered(folder / n) for n in names if not chosen or n in chosen}
    files = {name: there for name, there in files.items() if there and _level(listed, name)}
    if not steps or not files:
        return None
    cameras = {name: _lens(name, there[0], listed, hfov) for name, there in files.items()}
    name = folder.relative_to(top).as_posix()
    counts = [len(steps), *map(len, files.values())]
    if max(counts) - min(counts) > 1:
        raise ValueError(
            f"{folder} has {min(counts)} to {max(counts)} frames of its cameras and "
            f"{len(steps)} steps: it is not whole."
        )
    steps = steps[: min(counts)]
    _check_calls(steps, files)
    poses = _places(steps, folder / STEPS)
    said = told.get("text") or told.get("category") or ""
    if not isinstance(said, str):
        raise ValueError(f"{folder / EPISODE}: the instruction must be a text, got {short(said)}.")
    said = said[:LARGEST_WORDS]
    unit = _told(_json(top / RECORDING), "unit", top / RECORDING) or 0.001
    if not 0 < unit <= 1:
        raise ValueError(f"{top / RECORDING} says that a count of depth is {unit:g} m.")
    times = np.arange(len(steps)) * 1.0
    return Frames(name, said, cameras, files, times, poses, True, 0, unit)


def _check_calls(steps: Sequence[Any], files: Mapping[str, Sequence[Path]]) -> None:
    """Raise ValueError if a frame is not of the call of its step, as when one in the middle is
    missing."""
    for place, step in enumerate(steps):
        call = step.get("call") if isinstance(step, dict) else None
        for there in files.values():
            if type(call) is int and there[place].stem != f"{call:06d}":
                raise ValueError(
                    f"{there[place].parent} has no frame {call:06d}, which {STEPS} names: it is "
                    "not whole. Copy it again, or leave this drive out."
                )


def _level(listed: Mapping[str, Any], name: str) -> bool:
    """Whether a camera looks level, as far as is told."""
    own = listed.get(name)
    return not isinstance(own, dict) or own.get("level") is not False


def _lens(name: str, first: Path, listed: Mapping[str, Any], hfov: float | None) -> Lens:
    """The lens of a camera, as the recording says, or by its first frame and ``hfov``."""
    own = listed.get(name)
    if own is not None and (not isinstance(own, dict) or own.get("kind") not in (RGB, DEPTH)):
        raise ValueError(
            f"{first.parent.parent / CAMERAS} must say kind, {RGB} or {DEPTH}, of {name}, got "
            f"{short(own)}. Copy it again, or leave this drive out."
        )
    if own is None:
        return Lens(frame_files.modality(first), 90.0 if hfov is None else hfov)
    wide, yaw = (_told(own, key, first.parent.parent / CAMERAS) for key in ("hfov", "yaw"))
    if wide is None and hfov is None:
        raise ValueError(f"{first.parent}: nobody said how wide the camera sees: give hfov=79.")
    if wide is not None and hfov is not None:
        raise ValueError(f"{first.parent} says how wide it sees ({wide:g}): leave hfov= out.")
    return Lens(own["kind"], wide or hfov or 0.0, yaw or 0.0)


def _told(held: Mapping[str, Any], key: str, file: Path) -> float | None:
    """A number of a JSON object, None if it has none. Raises ValueError for anything else."""
    value = held.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or abs(value) > MOST:
        raise ValueError(f"{file}: {key} is {short(value)}, not a number up to {MOST:g}.")
    return float(value)


def _places(steps: Sequence[Any], file: Path) -> np.ndarray | None:
    """float64 [N, 3] of the lines of steps.jsonl; None, with a warning if it is not of all, where
    a line does not say where the agent was."""
    there = sum(map(_is_place, steps))
    if there < len(steps):
        if there:
            warnings.warn(
                f"{file} lacks the pose of {len(steps) - there} of {len(steps)} steps: the drive "
                "is read without poses.",
                stacklevel=2,
            )
        return None
    poses = [(*from_vlnce(step["position"]), step["heading"]) for step in steps]
    return _in_radians(np.array(poses, np.float64), file)


def _is_place(step: Any) -> bool:
    """Whether a line of steps.jsonl says where the agent was."""
    place = step.get("position") if isinstance(step, dict) else None
    if not isinstance(place, list) or len(place) != 3:
        return False
    numbers = (*place, step.get("heading"))
    return all(isinstance(n, (int, float)) and abs(n) <= MOST for n in numbers)


def _simple(path: Path, hfov: float | None, unit: float | None) -> Frames:
    """``rgb/``, ``depth/`` and ``poses.csv``: each file is a step."""
    files = {kind: _ordered(path / kind) for kind in (RGB, DEPTH)}
    files = {kind: there for kind, there in files.items() if there}
    counts = {f"{kind}/": len(there) for kind, there in files.items()}
    poses = _poses(path / POSES) if (path / POSES).is_file() else None
    if poses is not None:
        counts[POSES] = len(poses)
    if len(set(counts.values())) != 1 or not files:
        told = ", ".join(f"{count} in {where}" for where, count in counts.items()) or "no frame"
        raise ValueError(f"{path} must hold as many of each, one a step, but has {told}.")
    stems = [[file.stem for file in there] for there in files.values()]
    if len(stems) == 2 and stems[0] != stems[1] and set(stems[0]) & set(stems[1]):
        raise ValueError(f"{path}: some frames of rgb/ have no partner of their name in depth/.")
    cameras = {kind: Lens(kind, 90.0 if hfov is None else hfov) for kind in files}
    per_count = 0.001 if unit is None else unit
    times = np.arange(len(stems[0])) * 1.0
    return Frames(path.name, words(path / WORDS), cameras, files, times, poses, True, 0, per_count)


def _poses(file: Path) -> np.ndarray:
    """float64 [N, 3] of lines "x,y,heading", with or without these names above them."""
    lines = [
        (n, [word.strip() for word in line.split(",")])
        for n, line in enumerate(text(file).splitlines(), 1)
        if line.strip()
    ]
    first = lines[0][1] if lines else []
    if any(word.isalpha() and word.lower() != "nan" for word in first):
        if first != ["x", "y", "heading"]:
            raise ValueError(f"{file} has the columns {','.join(first)}, not x,y,heading.")
        lines = lines[1:]
    wrong = [n for n, line in lines if len(line) != 3]
    if wrong:
        raise ValueError(f"{file}, line {wrong[0]}, is not x,y,heading.")
    poses = np.array([[number(w, file, n) for w in line] for n, line in lines])
    return _in_radians(poses.reshape(-1, 3), file)


def _in_radians(poses: np.ndarray, file: Path) -> np.ndarray:
    """``poses`` [N, 3]. Raises ValueError for headings that are degrees."""
    headings = poses[:, 2]
    if len(poses) and np.ptp(headings) > 0 and np.abs(headings).max() > MOST_TURNED:
        raise ValueError(f"{file} has headings up to {np.abs(headings).max():g}: give radians.")
    return poses


def _ordered(folder: Path) -> list[Path]:
    """The frames of a folder by name, digits counting as numbers."""
    if not folder.is_dir():
        return []
    files = [p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and p.name[0] != "."]
    return sorted(files, key=lambda file: natural(file.name))


def _json(file: Path) -> dict[str, Any]:
    found = read_json(file, "Copy it again, or leave this drive out.")
    if not isinstance(found, dict):
        raise ValueError(f"{file} is no JSON object.")
    return found


def _lines(file: Path) -> list[Any]:
    """The JSON lines of a file; a last one that was cut off is left out."""
    found = []
    lines = text(file).splitlines()
    if len(lines) > LONGEST:
        raise ValueError(f"{file} has more than {LONGEST} steps: cut the recording.")
    for place, line in enumerate(lines, 1):
        try:
            found.append(parse_json(line))
        except (ValueError, RecursionError) as error:
            if place < len(lines):
                problem = f"{file}, line {place}, cannot be read ({error!s:.200})."
                raise ValueError(problem) from error
    return found


LISTS, TRAJECTORY = ("rgb.txt", "depth.txt"), "groundtruth.txt"
TUM_UNIT = 1 / 5000  # metres of a count; TUM RGB-D benchmark, file formats
TUM_HFOV = math.degrees(2 * math.atan(320 / 525))  # its default calibration: 640 pixels, focal 525


def _has_lists(path: Path) -> bool:
    """Whether ``path`` has a list of images."""
    return any((path / name).is_file() for name in LISTS)


def _read_lists(
    path: Path, hfov: float | None
) -> tuple[dict[str, Lens], dict[str, list[Path]], np.ndarray, np.ndarray | None, int]:
    """Cameras, the files of each, times and poses of a folder, and how many instants were left out,
    as nothing of the other lists was near; an instant is an RGB image with what
    is nearest in time. The agent's way is that of the camera's optical axis.

    Raises ValueError for what is damaged, and if nothing fits together.
    """
    listed = {kind: _listed(path, f"{kind}.txt") for kind in (RGB, DEPTH)}
    listed = {kind: lines for kind, lines in listed.items() if lines}
    if not listed:
        raise ValueError(f"{path}: its lists name no image.")
    leading = RGB if RGB in listed else DEPTH
    times = np.array([time for time, _ in listed[leading]])
    files: dict[str, list[Path]] = {leading: [file for _, file in listed[leading]]}
    kept = np.ones(len(times), bool)
    for kind, lines in listed.items():
        if kind != leading:
            nearest, away = near(times, np.array([time for time, _ in lines]))
            files[kind] = [lines[i][1] for i in nearest]
            kept &= away <= SLOP
    poses = None
    if (path / TRAJECTORY).is_file():
        poses, known = placed(times, _trajectory(path / TRAJECTORY))
        kept &= known
    if not kept.any():
        raise ValueError(f"{path}: no frame of one list is within {SLOP} s of the others' lines.")
    files = {
        k: [f for f, keep in zip(there, kept, strict=True) if keep] for k, there in files.items()
    }
    cameras = {kind: Lens(kind, TUM_HFOV if hfov is None else hfov) for kind in files}
    poses = None if poses is None else poses[kept]
    return cameras, files, times[kept], poses, int((~kept).sum())


def _listed(path: Path, name: str) -> list[tuple[float, Path]]:
    """(time, file) of each line of a list of TUM's; files lie below ``path``."""
    found = []
    for line, row in _table(path / name, least=2):
        file = path / row[1]
        if "\0" in row[1] or path.resolve() not in file.resolve().parents:
            raise ValueError(f"{path / name}, line {line}, names a file outside of {path}.")
        found.append((number(row[0], path / name, line), file))
    return sorted(found)


def _trajectory(file: Path) -> np.ndarray:
    """float64 [N, 4]: time and plan pose of lines "time x y z qx qy qz qw". Raises ValueError if
    most look up or down, as a robot's poses would be read."""
    rows = []
    for line, row in _table(file, least=8):
        numbers = [number(word, file, line) for word in row[:8]]
        ahead = rotated(numbers[4:], (0.0, 0.0, 1.0))
        rows.append((numbers[0], *plan_pose(numbers[1], numbers[2], ahead)))
    if not rows:
        raise ValueError(f"{file} holds no pose.")
    lost = sum(math.isnan(row[3]) for row in rows)
    if 2 * lost > len(rows):
        raise ValueError(
            f"{file}: {lost} of {len(rows)} poses look up or down, or are none. They must be of "
            "the camera's optical axis (z ahead, x right, y down), with z up in the room. Turn "
            "those of a robot (x ahead) so, or delete the file to go without poses."
        )
    return np.array(sorted(rows))


def _table(file: Path, least: int) -> Iterator[tuple[int, list[str]]]:
    """The words of each line that is no comment, with its number."""
    if not file.is_file():
        return
    for place, line in enumerate(io.StringIO(text(file)), 1):
        row = line.split()
        if not row or row[0].startswith("#"):
            continue
        if len(row) < least:
            raise ValueError(f"{file}, line {place}, has {len(row)} words, not {least}.")
        if place > LONGEST:
            raise ValueError(f"{file} has more than {LONGEST} lines: cut the recording.")
        yield place, row


def number(word: str, file: Path, line: int) -> float:
    """``word`` as a finite number. Raises ValueError, naming file and line, if it is none."""
    try:
        found = float(word)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise ValueError(f"{file}, line {line}: {word[:40]!r} is no finite number.")
    return found
