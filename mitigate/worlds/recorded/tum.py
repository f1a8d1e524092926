"""Folders in the form of the TUM RGB-D benchmark (Sturm et al., IROS 2012): lists of times and
files, and the camera's trajectory."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mitigate.core.observation import DEPTH, RGB
from mitigate.worlds.recorded.source import (
    LONGEST,
    SLOP,
    Lens,
    near,
    placed,
    plan_pose,
    rotated,
    text,
)

LISTS, TRAJECTORY = ("rgb.txt", "depth.txt"), "groundtruth.txt"
MOST_LINES = LONGEST  # of a list or trajectory
UNIT = 1 / 5000  # metres of a count; TUM RGB-D benchmark, file formats
HFOV = math.degrees(2 * math.atan(320 / 525))  # its default calibration: 640 pixels, focal 525


def is_one(path: Path) -> bool:
    """Whether ``path`` has a list of images."""
    return any((path / name).is_file() for name in LISTS)


def read(
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
    cameras = {kind: Lens(kind, HFOV if hfov is None else hfov) for kind in files}
    poses = None if poses is None else poses[kept]
    return cameras, files, times[kept], poses, int((~kept).sum())


def _listed(path: Path, name: str) -> list[tuple[float, Path]]:
    """(time, file) of each line of a list of TUM's; files lie below ``path``."""
    found = []
    for line, words in _table(path / name, least=2):
        file = path / words[1]
        if "\0" in words[1] or path.resolve() not in file.resolve().parents:
            raise ValueError(f"{path / name}, line {line}, names a file outside of {path}.")
        found.append((number(words[0], path / name, line), file))
    return sorted(found)


def _trajectory(file: Path) -> np.ndarray:
    """float64 [N, 4]: time and plan pose of lines "time x y z qx qy qz qw". Raises ValueError if
    most look up or down, as a robot's poses would be read."""
    rows = []
    for line, words in _table(file, least=8):
        numbers = [number(word, file, line) for word in words[:8]]
        ahead = rotated(numbers[4:], (0.0, 0.0, 1.0))
        rows.append((numbers[0], *plan_pose(numbers[1], numbers[2], ahead)))
    if not rows:
        raise ValueError(f"{file} holds no pose.")
    unknown = sum(math.isnan(row[3]) for row in rows)
    if 2 * unknown > len(rows):
        raise ValueError(
            f"{file}: {unknown} of {len(rows)} poses look up or down, or are none. They must be of "
            "the camera's optical axis (z ahead, x right, y down), with z up in the room. Turn "
            "those of a robot (x ahead) so, or delete the file to go without poses."
        )
    return np.array(sorted(rows))


def _table(file: Path, least: int) -> Iterator[tuple[int, list[str]]]:
    """The words of each line that is no comment, with its number."""
    if not file.is_file():
        return
    for number, line in enumerate(io.StringIO(text(file)), 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if len(words) < least:
            raise ValueError(f"{file}, line {number}, has {len(words)} words, not {least}.")
        if number > MOST_LINES:
            raise ValueError(f"{file} has more than {MOST_LINES} lines: cut the recording.")
        yield number, words


def number(word: str, file: Path, line: int) -> float:
    """``word`` as a finite number. Raises ValueError, naming file and line, if it is none."""
    try:
        found = float(word)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise ValueError(f"{file}, line {line}: {word[:40]!r} is no finite number.")
    return found
