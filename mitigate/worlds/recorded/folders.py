"""Read drives from folders of frames.

Three layouts are supported:

* ``recording.json`` and ``<scene>/<episode>/<camera>/000000.png``: the layout of ``mitigate run
  record=``;
* ``rgb.txt``, ``depth.txt``, ``groundtruth.txt``: the layout of the TUM RGB-D benchmark (Sturm et
  al., IROS 2012), which most tools for RGB-D cameras write; ``associations.txt`` may replace both
  lists;
* ``rgb/`` and ``depth/``: one file per step, sorted by name. ``poses.csv`` is optional and has
  one line "x,y,heading" per step (metres, radians, forward is (-sin h, cos h)).

The last two layouts may contain the instruction as ``instruction.txt``.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
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
from mitigate.worlds.recorded.source import (
    MAX_FRAME_GAP,
    MAX_INSTANTS,
    MAX_INSTRUCTION_BYTES,
    Lens,
    Source,
    match_times,
    plan_pose,
    read_instruction,
    read_text,
)

# The layout of `mitigate run record=`.
CAMERAS = "cameras.json"
STEPS = "steps.jsonl"
EPISODE = "episode.json"
# The layout with rgb/ and depth/.
POSES = "poses.csv"
INSTRUCTION = "instruction.txt"
# The layout of the TUM RGB-D benchmark.
LISTS = ("rgb.txt", "depth.txt")
# both lists in one file, written by associate.py of that benchmark
ASSOCIATIONS = "associations.txt"
TRAJECTORY = "groundtruth.txt"
TUM_UNIT = 1 / 5000  # metres per count (TUM RGB-D benchmark, file formats)
# TUM's default calibration: width 640 pixels, focal length 525
TUM_HFOV = math.degrees(2 * math.atan(320 / 525))

FIX = "Copy it again, or leave this drive out."
MAX_NUMBER = 1e6  # maximum of a number in a recording, in metres or degrees (heuristic)
MAX_HEADING = 50.0  # in radians (heuristic): eight turns; larger headings must be in degrees


@dataclass
class Frames(Source):
    """A drive in files.

    Attributes:
        files: One file per time step, by camera.
        unit: Metres per count of 16-bit depth.
        unit_given: Whether the user or the recording states ``unit``; otherwise it is a default.
    """

    files: Mapping[str, Sequence[Path]]
    unit: float
    unit_given: bool = True

    def __post_init__(self) -> None:
        assumed = "" if self.unit_given else " (assumed)"
        self.formats = {
            name: f"{name}, 16-bit PNG, {self.unit:g} metres per count{assumed}"
            if self._is_counted(name)
            else f"{name}, {files[0].suffix[1:].upper()}"
            for name, files in self.files.items()
        }

    def _is_counted(self, camera: str) -> bool:
        """Return whether a camera's files hold depth in counts of ``unit``."""
        is_npy = self.files[camera][0].suffix.lower() == ".npy"
        return self.cameras[camera].kind == DEPTH and not is_npy

    def depth_advice(self) -> str:
        if any(map(self._is_counted, self.files)):
            return "Set unit= (metres per count), such as unit=0.0001."
        return super().depth_advice()

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        for index in chosen:
            yield {name: self._read(name, files[index]) for name, files in self.files.items()}

    def _read(self, camera: str, path: Path) -> np.ndarray:
        try:
            frame = frame_files.read(path, self.unit)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} {error}. Fix it, or remove it from the drive.") from error
        kind = self.cameras[camera].kind
        if (frame.shape[-1] == 3) != (kind == RGB):
            raise ValueError(
                f"{path} must be a {kind} frame, as the others of camera {camera!r}. Replace it."
            )
        if kind == RGB:
            return frame
        depth = frame[..., 0]
        return np.where(np.isfinite(depth) & (depth > 0), depth, 0).astype(np.float32)


def open_folder(
    path: Path,
    hfov: float | None,
    unit: float | None,
    cameras: Sequence[str] | None = None,
    tolerance: float | None = None,
) -> list[Frames]:
    """Open the drives of a folder in one of the three layouts.

    Args:
        path: The folder.
        hfov: Horizontal field of view in degrees, if the folder does not contain it.
        unit: Metres per count of 16-bit depth, if the folder does not contain it.
        cameras: Cameras to read from a recording by ``mitigate run``, or None for all.
        tolerance: Maximum seconds between the frames of a time step of a TUM folder; None: 0.1.

    Returns:
        The drives without their frames.

    Raises:
        FileNotFoundError: A file is missing.
        ValueError: The folder is damaged, or an option does not apply to it.
    """
    if (path / RECORDING).is_file():
        if unit is not None:
            raise ValueError(f"{path} contains the unit of its depth. Remove unit=.")
        # a hidden folder is an episode that is still being recorded or whose program was killed
        episodes = sorted(file.parent for file in path.glob(f"[!.]*/[!.]*/{STEPS}"))
        drives = (_read_recorded(folder, path, hfov, cameras) for folder in episodes)
        return [drive for drive in drives if drive is not None]
    if cameras:
        raise ValueError(
            f"cameras= applies only to a recording by mitigate run, which {path} is not. Remove "
            "cameras=."
        )
    if is_tum(path):
        return [_read_tum(path, hfov, unit, MAX_FRAME_GAP if tolerance is None else tolerance)]
    if (path / TRAJECTORY).is_file():
        raise ValueError(
            f"{path} has {TRAJECTORY}, but lacks the lists of its frames. Add {' or '.join(LISTS)}."
        )
    return [_read_simple(path, hfov, unit)]


def is_drive(folder: Path) -> bool:
    """Return whether a folder contains frames in one of the three layouts."""
    return any((folder / name).exists() for name in (RECORDING, *LISTS, ASSOCIATIONS, RGB, DEPTH))


def is_tum(folder: Path) -> bool:
    """Return whether a folder has the layout of TUM RGB-D."""
    return any((folder / name).is_file() for name in (*LISTS, ASSOCIATIONS))


def _read_recorded(
    folder: Path, recording: Path, hfov: float | None, chosen: Sequence[str] | None
) -> Frames | None:
    """Read an episode of a recording by ``mitigate run``; return None if it has no frames.

    An interrupted episode ends with its last complete step.
    """
    episode = read_object(folder / EPISODE, FIX)
    steps = _read_lines(folder / STEPS)
    described = read_object(folder / CAMERAS, FIX) if (folder / CAMERAS).is_file() else {}
    names = sorted(p.name for p in folder.iterdir() if p.is_dir())
    for camera in chosen or ():
        if camera not in names:
            raise ValueError(unknown("camera", camera, names))
    files = {n: _list_frames(folder / n) for n in names if not chosen or n in chosen}
    files = {name: paths for name, paths in files.items() if paths and _is_level(described, name)}
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
            f"{folder / EPISODE}: the instruction must be a text, got {short(instruction)}."
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
        dropped=0,
        files=files,
        unit=unit,
    )


def _check_calls(steps: Sequence[Any], files: Mapping[str, Sequence[Path]]) -> None:
    """Raise ValueError if a frame does not belong to its step, because a frame is missing."""
    for index, step in enumerate(steps):
        call = step.get("call") if isinstance(step, dict) else None
        for paths in files.values():
            if type(call) is int and paths[index].stem != f"{call:06d}":
                raise ValueError(
                    f"{paths[index].parent} is incomplete: it has no frame {call:06d}, which "
                    f"{STEPS} names. {FIX}"
                )


def _is_level(described: Mapping[str, Any], name: str) -> bool:
    """Return whether a camera is level, which is assumed if the recording does not state it."""
    camera = described.get(name)
    return not isinstance(camera, dict) or camera.get("level") is not False


def _read_lens(name: str, frame: Path, described: Mapping[str, Any], hfov: float | None) -> Lens:
    """Return the lens of a camera, from ``cameras.json`` or from one of its frames and ``hfov``."""
    camera = described.get(name)
    file = frame.parent.parent / CAMERAS
    if camera is None:
        return _assumed_lens(frame_files.modality(frame), hfov)
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


def _assumed_lens(kind: str, hfov: float | None, default: float = 90.0) -> Lens:
    """Return a lens with a field of view from the user, or with a default."""
    return Lens(kind, default if hfov is None else hfov, assumed=hfov is None)


def _number_or_none(values: Mapping[str, Any], key: str, file: Path) -> float | None:
    """Return a number in a JSON object, or None if it is missing or null.

    Raises:
        ValueError: The value is not a number, or it is too large.
    """
    value = values.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or abs(value) > MAX_NUMBER:
        raise ValueError(
            f"{file}: {key} must be a number up to {MAX_NUMBER:g}, got {short(value)}."
        )
    return float(value)


def _recorded_poses(steps: Sequence[Any], file: Path) -> np.ndarray | None:
    """Return the poses in the lines of steps.jsonl, float64 [N, 3].

    The result is None if a line has no pose, with a warning if other lines have poses.
    """
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


def _read_simple(path: Path, hfov: float | None, unit: float | None) -> Frames:
    """Read a drive from ``rgb/``, ``depth/`` and ``poses.csv``; each file is a step."""
    files = {kind: _list_frames(path / kind) for kind in (RGB, DEPTH)}
    files = {kind: paths for kind, paths in files.items() if paths}
    counts = {f"{kind}/": len(paths) for kind, paths in files.items()}
    poses = _read_poses(path / POSES) if (path / POSES).is_file() else None
    if poses is not None:
        counts[POSES] = len(poses)
    if len(set(counts.values())) != 1 or not files:
        listed = ", ".join(f"{count} in {name}" for name, count in counts.items()) or "no frame"
        raise ValueError(
            f"{path} must have as many of each, one per step, got {listed}. Add or remove the "
            "files that do not match."
        )
    if unit is None and DEPTH in files:
        try:
            frame_files.check_scale(files[DEPTH], 0.001, Z_MAX)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from error
    stems = [[file.stem for file in paths] for paths in files.values()]
    if len(stems) == 2 and stems[0] != stems[1] and set(stems[0]) & set(stems[1]):
        raise ValueError(
            f"{path}: some frames of rgb/ have no frame of the same name in depth/. Give both the "
            "same names."
        )
    return Frames(
        name=path.name,
        instruction=read_instruction(path / INSTRUCTION),
        cameras={kind: _assumed_lens(kind, hfov) for kind in files},
        files=files,
        times=np.arange(len(stems[0])) * 1.0,
        poses=poses,
        stepped=True,
        dropped=0,
        unit=0.001 if unit is None else unit,
        unit_given=unit is not None,
    )


def _read_poses(file: Path) -> np.ndarray:
    """Read lines "x,y,heading", with or without a header line, as float64 [N, 3]."""
    rows = list(_read_rows(file, 3, ","))
    if rows and rows[0][1] == ["x", "y", "heading"]:
        rows = rows[1:]
    poses = np.array([[number(word, file, line) for word in row] for line, row in rows])
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
    """Return the frames of a folder sorted by name, comparing digits as numbers."""
    if not folder.is_dir():
        return []
    files = [p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and p.name[0] != "."]
    return sorted(files, key=lambda file: natural(file.name))


def _read_lines(file: Path) -> list[Any]:
    """Read the JSON lines of a file, without an incomplete last line."""
    records = []
    lines = read_text(file).splitlines()
    if len(lines) > MAX_INSTANTS:
        raise ValueError(f"{file} must have at most {MAX_INSTANTS} steps. Cut the recording.")
    for line_number, line in enumerate(lines, 1):
        try:
            records.append(parse_json(line))
        except (ValueError, RecursionError) as error:
            if line_number < len(lines):
                problem = f"{file}, line {line_number}, cannot be read ({error!s:.200})."
                raise ValueError(problem) from error
    return records


def _read_tum(path: Path, hfov: float | None, unit: float | None, tolerance: float) -> Frames:
    """Read a drive in the layout of TUM RGB-D.

    A time step consists of an RGB image with the depth image and the pose that are nearest in time.
    The heading is the direction of the camera's optical axis.

    Raises:
        ValueError: A file is damaged, or no frame of one list is near in time to frames of the
            others.
    """
    if any((path / name).is_file() for name in LISTS):
        listed = {kind: _read_list(path, f"{kind}.txt") for kind in (RGB, DEPTH)}
    else:
        listed = _read_associations(path)
    listed = {kind: lines for kind, lines in listed.items() if lines}
    if not listed:
        raise ValueError(f"{path}: its lists name no image. Add lines to {' or '.join(LISTS)}.")
    stamps = {kind: [time for time, _ in lines] for kind, lines in listed.items()}
    has_poses = (path / TRAJECTORY).is_file()
    table = _read_trajectory(path / TRAJECTORY) if has_poses else None
    instants = match_times(stamps, table, tolerance)
    if not len(instants.times):
        raise ValueError(f"{path}: {instants.mismatch(tolerance)}")
    return Frames(
        name=path.name,
        instruction=read_instruction(path / INSTRUCTION),
        cameras={kind: _assumed_lens(kind, hfov, TUM_HFOV) for kind in listed},
        times=instants.times,
        poses=instants.poses,
        stepped=False,
        dropped=instants.dropped,
        files={kind: [listed[kind][i][1] for i in rows] for kind, rows in instants.frames.items()},
        unit=TUM_UNIT if unit is None else unit,
        unit_given=unit is not None,
    )


def _read_list(path: Path, name: str) -> list[tuple[float, Path]]:
    """Read the lines of a list of images as (time, file); raise ValueError for a file outside the
    folder.
    """
    return sorted(_read_entry(path, name, line, row) for line, row in _read_rows(path / name, 2))


def _read_associations(path: Path) -> dict[str, list[tuple[float, Path]]]:
    """Read lines "time file time file"; the files of the first line tell RGB from depth.

    Raises:
        ValueError: A file lies outside the folder, or both files have the same kind.
    """
    rows = list(_read_rows(path / ASSOCIATIONS, 4))
    pairs = [
        [_read_entry(path, ASSOCIATIONS, n, row[at : at + 2]) for n, row in rows] for at in (0, 2)
    ]
    try:
        listed = {frame_files.modality(pair[0][1]): sorted(pair) for pair in pairs if pair}
    except frame_files.LeftOutError as error:
        raise ValueError(
            f"{path / ASSOCIATIONS}: its first line names a file that {error}."
        ) from error
    if rows and len(listed) != 2:
        raise ValueError(
            f"{path / ASSOCIATIONS} must name one RGB and one depth image per line. Correct it."
        )
    return {kind: listed[kind] for kind in (RGB, DEPTH) if listed}


def _read_entry(path: Path, name: str, line: int, row: Sequence[str]) -> tuple[float, Path]:
    """Return the time and the file in a line of a list."""
    file = path / row[1]
    if "\0" in row[1] or path.resolve() not in file.resolve().parents:
        raise ValueError(f"{path / name}, line {line}, names a file outside of {path}.")
    return number(row[0], path / name, line), file


def _read_trajectory(file: Path) -> np.ndarray:
    """Read lines "time x y z qx qy qz qw" as float64 [N, 4], (time, x, y, heading).

    Raises:
        ValueError: Most poses face up or down. This happens if the poses describe a robot frame (x
            forward) instead of a camera's optical axis.
    """
    rows = []
    for line, row in _read_rows(file, 8):
        numbers = [number(word, file, line) for word in row[:8]]
        pose = plan_pose(numbers[1], numbers[2], numbers[4:], (0.0, 0.0, 1.0))
        rows.append((numbers[0], *pose))
    if not rows:
        raise ValueError(f"{file} has no pose. Add poses, or delete it to read without poses.")
    invalid = sum(math.isnan(row[3]) for row in rows)
    if 2 * invalid > len(rows):
        raise ValueError(
            f"{file}: {invalid} of {len(rows)} poses face up or down, or are not rotations. Poses "
            "must be of the camera's optical axis (z ahead, x right, y down), with z up in the "
            "room. Convert poses of a robot (x ahead), or delete the file to read without poses."
        )
    return np.array(sorted(rows))


def _read_rows(
    file: Path, columns: int, separator: str | None = None
) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the words of each line that is not a comment.

    A line may have more than ``columns`` words, unless there is a ``separator``.
    """
    if not file.is_file():
        return
    for line_number, line in enumerate(read_text(file).splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        row = [word.strip() for word in line.split(separator)]
        if len(row) < columns or (separator and len(row) > columns):
            raise ValueError(
                f"{file}, line {line_number}, must have {columns} words, got {len(row)}."
            )
        if line_number > MAX_INSTANTS:
            raise ValueError(f"{file} must have at most {MAX_INSTANTS} lines. Cut the recording.")
        yield line_number, row


def number(word: str, file: Path, line: int) -> float:
    """Parse a finite number.

    Raises:
        ValueError: The word is not a finite number; the message names file and line.
    """
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{file}, line {line}: must be a finite number, got {word[:40]!r}.")
    return value
