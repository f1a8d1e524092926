"""Read drives from folders of frames.

Three layouts are supported:

* ``recording.json`` and ``<scene>/<episode>/<camera>/000000.png``, which ``mitigate run record=``
  writes;
* ``rgb.txt``, ``depth.txt`` and ``groundtruth.txt``, the layout of TUM RGB-D (``tum.py``);
* ``rgb/`` and ``depth/`` with one file per step, sorted by name. The optional file ``poses.csv``
  has one line "x,y,heading" per step, in metres and radians. The forward direction is (-sin h, cos
  h), where h is the heading.

In the last two layouts, the instruction may be stored in ``instruction.txt``.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import RECORDING
from mitigate.core.json_files import parse_json, read_object
from mitigate.core.names import short, unknown
from mitigate.core.observation import DEPTH, RGB, Z_MAX
from mitigate.corruptions import frame_files
from mitigate.corruptions.frame_files import SUFFIXES, natural
from mitigate.worlds.episodes import from_vlnce
from mitigate.worlds.recorded.drive_files import (
    INSTRUCTION,
    Frames,
    assumed_lens,
    number,
    read_rows,
)
from mitigate.worlds.recorded.options import Options
from mitigate.worlds.recorded.source import (
    MAX_INSTANTS,
    MAX_INSTRUCTION_BYTES,
    Lens,
    read_instruction,
    read_text,
)
from mitigate.worlds.recorded.tum import LISTS, TRAJECTORY

# File names in the layout of `mitigate run record=`.
CAMERAS = "cameras.json"
STEPS = "steps.jsonl"
EPISODE = "episode.json"
# File name in the layout with rgb/ and depth/.
POSES = "poses.csv"
FIX = "Copy it again, or leave this drive out."
# maximum absolute value of a number in a recording, in metres or degrees (heuristic)
MAX_NUMBER = 1e6
# eight full turns in radians (heuristic); larger values are assumed to be in degrees
MAX_HEADING = 50.0


def read_run(path: Path, options: Options) -> list[Frames]:
    """Read all episodes of a recording that ``mitigate run`` wrote."""
    # hidden folders are skipped: they hold episodes that are being recorded or were interrupted
    episodes = sorted(file.parent for file in path.glob(f"[!.]*/[!.]*/{STEPS}"))
    drives = (_read_episode(folder, path, options.hfov, options.cameras) for folder in episodes)
    return [drive for drive in drives if drive is not None]


def _read_episode(
    folder: Path, recording: Path, hfov: float | None, chosen: Sequence[str] | None
) -> Frames | None:
    """Read one episode up to its last complete step. Return None if it has no frames."""
    episode = read_object(folder / EPISODE, FIX)
    steps = _read_lines(folder / STEPS)
    described = read_object(folder / CAMERAS, FIX) if (folder / CAMERAS).is_file() else {}
    names = sorted(p.name for p in folder.iterdir() if p.is_dir())
    for camera in chosen or ():
        if camera not in names:
            raise ValueError(unknown("camera", camera, names))
    tilted = [n for n, c in described.items() if isinstance(c, dict) and c.get("level") is False]
    names = [n for n in names if n not in tilted and (not chosen or n in chosen)]
    files = {name: paths for name in names if (paths := _list_frames(folder / name))}
    if not steps or not files:
        return None
    cameras = {name: _read_lens(name, paths[0], described, hfov) for name, paths in files.items()}
    counts = [len(steps), *map(len, files.values())]
    if max(counts) - min(counts) > 1:
        raise ValueError(
            f"{folder} is incomplete: its cameras have {min(counts)} to {max(counts)} frames for "
            f"{len(steps)} steps. {FIX}"
        )
    steps = steps[: min(counts)]
    _check_calls(steps, files)
    instruction = episode.get("text") or episode.get("category") or ""
    if not isinstance(instruction, str):
        raise ValueError(
            f"{folder / EPISODE}: the instruction must be a string, got {short(instruction)}."
        )
    file = recording / RECORDING
    unit = _number_or_none(read_object(file, FIX), "unit", file) or 0.001
    if not 0 < unit <= 1:
        raise ValueError(
            f"{file}: unit must be above 0 and at most 1 metre per count, got {unit:g}."
        )
    return Frames(
        name=folder.relative_to(recording).as_posix(),
        instruction=instruction[:MAX_INSTRUCTION_BYTES],
        cameras=cameras,
        times=np.arange(len(steps)) * 1.0,
        poses=_recorded_poses(steps, folder / STEPS),
        stepped=True,
        files=files,
        unit=unit,
    )


def _check_calls(steps: Sequence[Any], files: Mapping[str, Sequence[Path]]) -> None:
    """Raise ValueError if a missing frame causes later frames to belong to the wrong step."""
    for index, step in enumerate(steps):
        call = step.get("call") if isinstance(step, dict) else None
        for paths in files.values():
            if type(call) is int and paths[index].stem != f"{call:06d}":
                raise ValueError(
                    f"{paths[index].parent} is incomplete: it has no frame {call:06d}, which "
                    f"{STEPS} names. {FIX}"
                )


def _read_lens(name: str, frame: Path, described: Mapping[str, Any], hfov: float | None) -> Lens:
    """Return the lens of a camera.

    If ``cameras.json`` does not describe the camera, its kind is inferred from a frame, and its
    field of view is ``hfov`` or a default.
    """
    camera = described.get(name)
    file = frame.parent.parent / CAMERAS
    if camera is None:
        return assumed_lens(frame_files.modality(frame), hfov)
    if not isinstance(camera, dict) or camera.get("kind") not in (RGB, DEPTH):
        raise ValueError(
            f"{file}: kind of camera {name} must be {RGB} or {DEPTH}, got {short(camera)}. {FIX}"
        )
    recorded_hfov = _number_or_none(camera, "hfov", file)
    yaw = _number_or_none(camera, "yaw", file)
    if recorded_hfov is None and hfov is None:
        raise ValueError(f"{file} lacks the field of view of camera {name}. Set it, as in hfov=79.")
    if recorded_hfov is not None and hfov is not None:
        raise ValueError(
            f"{file} contains the field of view of camera {name} ({recorded_hfov:g}). Remove hfov=."
        )
    return Lens(camera["kind"], recorded_hfov or hfov or 0.0, yaw or 0.0)


def _number_or_none(values: Mapping[str, Any], key: str, file: Path) -> float | None:
    """Return the number for ``key``, or None if the key is missing or null."""
    value = values.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or abs(value) > MAX_NUMBER:
        raise ValueError(
            f"{file}: {key} must be a number up to {MAX_NUMBER:g}, got {short(value)}."
        )
    return float(value)


def _recorded_poses(steps: Sequence[Any], file: Path) -> np.ndarray | None:
    """Return the poses of steps.jsonl, float64 [N, 3], or None if a line has no pose."""
    count = sum(map(_has_pose, steps))
    if count < len(steps):
        if count:
            warnings.warn(
                f"{file} lacks the pose of {len(steps) - count} of {len(steps)} steps: the drive "
                "is read without poses.",
                stacklevel=2,
            )
        return None
    poses = [(*from_vlnce(step["position"]), step["heading"]) for step in steps]
    return _check_radians(np.array(poses, np.float64), file)


def _has_pose(step: Any) -> bool:
    """Return whether a line of steps.jsonl has a valid pose."""
    position = step.get("position") if isinstance(step, dict) else None
    if not isinstance(position, list) or len(position) != 3:
        return False
    numbers = (*position, step.get("heading"))
    return all(isinstance(n, (int, float)) and abs(n) <= MAX_NUMBER for n in numbers)


def read_frames(path: Path, options: Options) -> list[Frames]:
    """Read the drive in ``rgb/``, ``depth/`` and ``poses.csv``. Each frame file is one step."""
    if (path / TRAJECTORY).is_file():
        raise ValueError(
            f"{path} has {TRAJECTORY}, but lacks the lists of its frames. Add {' or '.join(LISTS)}."
        )
    files = {kind: _list_frames(path / kind) for kind in (RGB, DEPTH)}
    files = {kind: paths for kind, paths in files.items() if paths}
    counts = {f"{kind}/": len(paths) for kind, paths in files.items()}
    poses = _read_poses(path / POSES) if (path / POSES).is_file() else None
    if poses is not None:
        counts[POSES] = len(poses)
    if len(set(counts.values())) != 1 or not files:
        listed = ", ".join(f"{count} in {name}" for name, count in counts.items()) or "no frame"
        raise ValueError(
            f"{path} must have the same number of frames and poses, one per step, got {listed}. "
            "Add or remove the ones that do not match."
        )
    if options.unit is None and DEPTH in files:
        try:
            frame_files.check_scale(files[DEPTH], 0.001, Z_MAX)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from error
    stems = [[file.stem for file in paths] for paths in files.values()]
    if len(stems) == 2 and stems[0] != stems[1] and set(stems[0]) & set(stems[1]):
        raise ValueError(
            f"{path}: frames of the same step in rgb/ and depth/ must have the same name."
        )
    drive = Frames(
        name=path.name,
        instruction=read_instruction(path / INSTRUCTION),
        cameras={kind: assumed_lens(kind, options.hfov) for kind in files},
        files=files,
        times=np.arange(len(stems[0])) * 1.0,
        poses=poses,
        stepped=True,
        unit=0.001 if options.unit is None else options.unit,
        unit_given=options.unit is not None,
    )
    return [drive]


def _read_poses(file: Path) -> np.ndarray:
    """Read lines "x,y,heading", with or without a header line, as float64 [N, 3]."""
    rows = list(read_rows(file, 3, ","))
    if rows and rows[0][1] == ["x", "y", "heading"]:
        rows = rows[1:]
    poses = np.array([[number(word, file, line) for word in row] for line, row in rows])
    if len(poses) and np.abs(poses).max() > MAX_NUMBER:
        line = rows[int(np.abs(poses).max(1).argmax())][0]
        raise ValueError(f"{file}, line {line}: numbers must be at most {MAX_NUMBER:g}.")
    return _check_radians(poses.reshape(-1, 3), file)


def _check_radians(poses: np.ndarray, file: Path) -> np.ndarray:
    """Return ``poses`` [N, 3]; raise ValueError if the headings are in degrees."""
    headings = poses[:, 2]
    if len(poses) and np.ptp(headings) > 0 and np.abs(headings).max() > MAX_HEADING:
        raise ValueError(
            f"{file}: headings must be in radians, got {np.abs(headings).max():g}. Convert them."
        )
    return poses


def _list_frames(folder: Path) -> list[Path]:
    """Return the frame files of a folder in natural order of their names."""
    if not folder.is_dir():
        return []
    files = [p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and p.name[0] != "."]
    drive = folder.parent.resolve()
    for file in files:
        if drive not in file.resolve().parents:
            raise ValueError(f"{file} is a link to a place outside of {drive}. Copy the file.")
    return sorted(files, key=lambda file: natural(file.name))


def _read_lines(file: Path) -> list[Any]:
    """Read the JSON lines of a file. An incomplete last line is left out."""
    records = []
    lines = read_text(file).splitlines()
    if len(lines) > MAX_INSTANTS:
        raise ValueError(
            f"{file} must have at most {MAX_INSTANTS} steps. Shorten or split the recording."
        )
    for line_number, line in enumerate(lines, 1):
        try:
            records.append(parse_json(line))
        except (ValueError, RecursionError) as error:
            if line_number < len(lines):
                problem = f"{file}, line {line_number}, cannot be read ({error!s:.200})."
                raise ValueError(problem) from error
    return records
