"""Read recorded drives in the layout of the TUM RGB-D benchmark (Sturm et al., IROS 2012).

A folder contains the image lists ``rgb.txt`` and ``depth.txt``, and the poses in
``groundtruth.txt``. The file ``associations.txt`` may replace both image lists. Most tools for
RGB-D cameras can write this layout.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import frame_files
from mitigate.worlds.recorded.drive_files import (
    INSTRUCTION,
    Frames,
    assumed_lens,
    number,
    read_rows,
)
from mitigate.worlds.recorded.options import Options
from mitigate.worlds.recorded.source import heading_along, match_times, read_instruction

LISTS = ("rgb.txt", "depth.txt")
# file that contains both lists, written by associate.py of the TUM RGB-D benchmark
ASSOCIATIONS = "associations.txt"
TRAJECTORY = "groundtruth.txt"
TUM_UNIT = 1 / 5000  # metres per integer step of depth (TUM RGB-D benchmark, file formats)
# field of view of the default calibration of TUM RGB-D: width 640, focal length 525 pixels
TUM_HFOV = math.degrees(2 * math.atan(320 / 525))


def is_tum(folder: Path) -> bool:
    """Return whether a folder has the layout of TUM RGB-D."""
    return any((folder / name).is_file() for name in (*LISTS, ASSOCIATIONS))


def read_tum(path: Path, options: Options) -> list[Frames]:
    """Read the drive in a folder with the layout of TUM RGB-D.

    A time step consists of an RGB image, and of the depth image and the pose that are nearest to it
    in time. The heading is the direction of the camera's optical axis.
    """
    if any((path / name).is_file() for name in LISTS):
        listed = {kind: _read_list(path, f"{kind}.txt") for kind in (RGB, DEPTH)}
    else:
        listed = _read_associations(path)
    listed = {kind: lines for kind, lines in listed.items() if lines}
    if not listed:
        raise ValueError(f"{path} must list at least one image. Add lines to {' or '.join(LISTS)}.")
    stamps = {kind: [time for time, _ in lines] for kind, lines in listed.items()}
    has_poses = (path / TRAJECTORY).is_file()
    table = _read_trajectory(path / TRAJECTORY) if has_poses else None
    instants = match_times(path, stamps, table, options.frame_gap, {})
    drive = Frames(
        name=path.name,
        instruction=read_instruction(path / INSTRUCTION),
        cameras={kind: assumed_lens(kind, options.hfov, TUM_HFOV) for kind in listed},
        times=instants.times,
        poses=instants.poses,
        dropped=instants.dropped,
        files={kind: [listed[kind][i][1] for i in rows] for kind, rows in instants.frames.items()},
        unit=TUM_UNIT if options.unit is None else options.unit,
        unit_given=options.unit is not None,
    )
    return [drive]


def _read_list(path: Path, name: str) -> list[tuple[float, Path]]:
    """Read a list of images as tuples (time, file)."""
    return sorted(_read_entry(path, name, line, row) for line, row in read_rows(path / name, 2))


def _read_associations(path: Path) -> dict[str, list[tuple[float, Path]]]:
    """Read lines "time file time file".

    The first line determines which column contains RGB and which column contains depth.
    """
    rows = list(read_rows(path / ASSOCIATIONS, 4))
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
    """Return the time and the path of the image in one line of an image list."""
    file = path / row[1]
    if "\0" in row[1] or path.resolve() not in file.resolve().parents:
        raise ValueError(f"{path / name}, line {line}, names a file outside of {path}.")
    return number(row[0], path / name, line), file


def _read_trajectory(file: Path) -> np.ndarray:
    """Read lines "time x y z qx qy qz qw" as float64 [N, 4]: time, x, y and heading."""
    rows = []
    for line, row in read_rows(file, 8):
        numbers = [number(word, file, line) for word in row[:8]]
        time, x, y = numbers[:3]
        heading = heading_along(numbers[4:], (0.0, 0.0, 1.0))
        rows.append((time, x, y, heading))
    if not rows:
        raise ValueError(
            f"{file} has no pose. Add poses. To read the images without poses, delete this file."
        )
    invalid = sum(math.isnan(row[3]) for row in rows)
    if 2 * invalid > len(rows):
        raise ValueError(
            f"{file}: {invalid} of {len(rows)} poses face up or down, or are not rotations. Poses "
            "must describe the optical frame of the camera (z ahead, x right, y down) in a room "
            "frame with z up. If they describe a robot (x ahead), convert them. To read the images "
            "without poses, delete this file."
        )
    return np.array(sorted(rows))
