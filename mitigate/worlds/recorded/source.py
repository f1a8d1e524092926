"""What a recording is to those who read it: instants with frames of named cameras, and poses.

A source knows when its frames were taken and where the agent was; frames are read for the instants
that are asked for. ``folders.py`` and ``bags.py`` make sources of files.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from mitigate.core.observation import VIEW_STEP_DEGREES

SLOP = 0.1  # seconds between frames of one instant, at most (ours; a frame at 10 Hz)
GAP = 2.0  # seconds between two poses, at most, for a place between them to be known (ours)
LONGEST = 1 << 20  # instants of a drive (ours): 9 hours at 30 Hz
LARGEST_TEXT, LARGEST_WORDS = 1 << 28, 1 << 16  # bytes of a list, of an instruction (ours)
NARROW, WIDE = 10.0, 179.0  # degrees that a camera sees
LEVEL = 0.3  # of a direction's length lies level, or it has no heading: 73 degrees down (ours)
LOW, BESIDE = 1.0, 4.0  # degrees from top to bottom; pictures from the middle to the centre (ours)
ASPECT = 0.02  # share by which a picture's aspect may differ from its CameraInfo's (ours)


@dataclass(frozen=True)
class Lens:
    """A pinhole camera: kind "rgb" or "depth"; yaw: degrees to the right of the heading.

    focal, centre: in pixels of pictures of ``size`` (width, height); None: what ``hfov``, the
    horizontal field of view in degrees, gives. Raises ValueError for one that sees too little or
    too much.
    """

    kind: str
    hfov: float = 90.0
    yaw: float = 0.0
    focal: tuple[float, float] | None = None
    centre: tuple[float, float] | None = None
    size: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        wide = self.hfov
        if self.focal is not None and self.size is not None:
            wide = math.degrees(2 * math.atan2(self.size[0] / 2, self.focal[0]))
        if not NARROW <= wide <= WIDE:
            raise ValueError(f"A camera that sees {wide:.3g} degrees is none (10 to 179).")
        if self.focal is not None and self.size is not None and self.centre is not None:
            tall = math.degrees(2 * math.atan2(self.size[1] / 2, self.focal[1]))
            beside = max(abs(c - s / 2) / s for c, s in zip(self.centre, self.size, strict=True))
            if not LOW <= tall <= WIDE or beside > BESIDE:
                raise ValueError(
                    f"A camera that sees {tall:.3g} degrees from top to bottom, its centre "
                    f"{beside:.3g} pictures beside the middle, is none."
                )

    def of(self, height: int, width: int) -> tuple[float, float, float, float]:
        """Focal lengths and centre (fx, fy, cx, cy) in pixels of pictures of this size. Raises
        ValueError for pictures of another shape than ``size``."""
        if self.focal is None or self.centre is None or self.size is None:
            focal = width / 2 / math.tan(math.radians(self.hfov) / 2)
            return focal, focal, width / 2, height / 2
        across, down = width / self.size[0], height / self.size[1]
        if abs(across / down - 1) > ASPECT:
            raise ValueError(
                f"pictures of {width} x {height} are not of the camera that CameraInfo is of "
                f"({self.size[0]} x {self.size[1]}): name its topic (topics.info=, "
                "topics.depth_info=)"
            )
        (fx, fy), (cx, cy) = self.focal, self.centre
        return fx * across, fy * down, cx * across, cy * down

    @property
    def view(self) -> int:
        """The nearest of the panorama's views (``core/observation.py``)."""
        return round(self.yaw / VIEW_STEP_DEGREES) % round(360 / VIEW_STEP_DEGREES)


class Source(Protocol):
    """One drive.

    times: float64 [N], seconds, growing. poses: float64 [N, 3] = (x, y, heading) in the plan frame
    of ``core/observation.py``, or None where they are not known. stepped: each instant is one step
    of an agent; else the camera's own rate. dropped: instants that were left out, as no pose or no
    frame of the other camera was near.
    """

    @property
    def name(self) -> str: ...

    @property
    def instruction(self) -> str: ...

    @property
    def cameras(self) -> Mapping[str, Lens]: ...

    @property
    def times(self) -> np.ndarray: ...

    @property
    def poses(self) -> np.ndarray | None: ...

    @property
    def stepped(self) -> bool: ...

    @property
    def dropped(self) -> int: ...

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        """Of each instant ``chosen``, in order, the frame of each camera: uint8 [H, W, 3], or
        float32 metres [H, W], 0 where there is no reading. Raises ValueError for what is
        damaged."""


def plan_pose(x: float, y: float, forward: np.ndarray) -> tuple[float, float, float]:
    """The pose in the plan frame of an agent at (x, y) that faces ``forward`` [3] (z is up); its
    heading is NaN where it faces up or down."""
    level = math.hypot(forward[0], forward[1]) >= LEVEL
    return x, y, math.atan2(-forward[0], forward[1]) if level else math.nan


def rotated(quaternion: Sequence[float], axis: Sequence[float]) -> np.ndarray:
    """``axis`` [3] turned by a quaternion (x, y, z, w); NaN for one that is no rotation."""
    found = np.asarray(quaternion, np.float64)
    length = float(np.linalg.norm(found))
    if not (found.shape == (4,) and np.isfinite(length) and length > 1e-6):
        return np.full(3, np.nan)
    x, y, z, w = found / length
    u, v = np.array([x, y, z]), np.asarray(axis, np.float64)
    return v + 2 * np.cross(u, np.cross(u, v) + w * v)


def near(times: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of ``others`` (growing) is nearest to each of ``times``, and how far away."""
    right = np.clip(np.searchsorted(others, times), 1, max(1, len(others) - 1))
    left = right - 1
    right = np.minimum(right, len(others) - 1)
    nearest = np.where(times - others[left] <= others[right] - times, left, right)
    return nearest, np.abs(others[nearest] - times)


def placed(times: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Poses [N, 3] at ``times``, on the line between those of ``table`` [M, 4] = (time, x, y,
    heading), and which are known: bool [N], none in a gap of more than ``GAP`` seconds."""
    table = table[np.isfinite(table).all(1)]
    if not len(table):
        return np.zeros((len(times), 3)), np.zeros(len(times), bool)
    at, first = np.unique(table[:, 0], return_index=True)
    poses = table[first, 1:]
    headings = np.interp(times, at, np.unwrap(poses[:, 2]))
    xy = [np.interp(times, at, poses[:, column]) for column in (0, 1)]
    after = np.searchsorted(at, times)
    inside = (after > 0) & (after < len(at))
    gaps = np.diff(at)[np.clip(after - 1, 0, max(0, len(at) - 2))] if len(at) > 1 else np.inf
    known = (inside & (gaps <= GAP)) | (near(times, at)[1] <= SLOP)
    return np.stack([*xy, headings], 1), known


def words(file: Path) -> str:
    """The instruction in a text file; empty if there is none. Raises ValueError for a long one, and
    for one that is not UTF-8."""
    found = text(file, LARGEST_WORDS).strip() if file.is_file() else ""
    if "\N{REPLACEMENT CHARACTER}" in found or "\0" in found:
        raise ValueError(f"{file} must be UTF-8 text: save it again as UTF-8, or leave it out.")
    return found


def text(file: Path, most: int = LARGEST_TEXT) -> str:
    """What a text file holds. Raises ValueError if it has more than ``most`` bytes."""
    with open(file, "rb") as held:
        raw = held.read(min(most, file.stat().st_size) + 1)  # as much memory is taken for it
    if len(raw) > most:
        raise ValueError(f"{file} has more than {most} bytes: cut the recording.")
    return raw.decode("utf-8-sig", errors="replace")
