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

from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP, VIEW_STEP_DEGREES

SLOP = 0.1  # seconds between what belongs to one instant, at most (ours; a frame at 10 Hz)
LONGEST = 1 << 20  # instants of a drive (ours): 9 hours at 30 Hz


@dataclass(frozen=True)
class Lens:
    """A pinhole camera: kind "rgb" or "depth"; focal lengths and centre in pixels, None for those
    that its pictures' size gives (``hfov``); yaw: degrees to the right of the heading."""

    kind: str
    hfov: float = 90.0
    yaw: float = 0.0
    focal: tuple[float, float] | None = None
    centre: tuple[float, float] | None = None

    def of(self, height: int, width: int) -> tuple[float, float, float, float]:
        """Focal lengths and centre (fx, fy, cx, cy) in pixels of pictures of this size."""
        if self.focal is not None and self.centre is not None:
            return (*self.focal, *self.centre)
        focal = width / 2 / math.tan(math.radians(self.hfov) / 2)
        return focal, focal, width / 2, height / 2

    @property
    def view(self) -> int:
        """The nearest of the panorama's views (``core/observation.py``)."""
        return round(self.yaw / VIEW_STEP_DEGREES) % round(360 / VIEW_STEP_DEGREES)


class Source(Protocol):
    """One drive.

    times: float64 [N], seconds, growing. poses: float64 [N, 3] = (x, y, heading) in the plan frame
    of ``core/observation.py``, or None where they are not known. stepped: each instant is one step
    of an agent; else the camera's own rate.
    """

    name: str
    instruction: str
    cameras: Mapping[str, Lens]
    times: np.ndarray
    poses: np.ndarray | None
    stepped: bool

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        """Of each instant ``chosen``, in order, the frame of each camera: uint8 [H, W, 3], or
        float32 metres [H, W], 0 where there is no reading. Raises ValueError for what is
        damaged."""


@dataclass(frozen=True)
class Step:
    """How far apart the instants are that an agent is shown: as far as its own steps take it.

    metres, degrees: moved or turned since the last one. seconds: where poses are not known.
    """

    metres: float = 0.25
    degrees: float = 15.0
    seconds: float = 0.5

    def __post_init__(self) -> None:
        for name in ("metres", "degrees", "seconds"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"step.{name}={value:g} must be above 0.")

    def choose(self, times: np.ndarray, poses: np.ndarray | None) -> np.ndarray:
        """Which instants are shown: the first, then each that is a step away from the last."""
        chosen = [0]
        for index in range(1, len(times)):
            last = chosen[-1]
            if poses is None:
                away = times[index] - times[last] >= self.seconds
            else:
                moved = np.hypot(*(poses[index, :2] - poses[last, :2]))
                turned = abs(turn(poses[last, 2], poses[index, 2]))
                # nearly: a step of exactly this length must not be missed by rounding
                away = moved > 0.98 * self.metres or turned > 0.98 * math.radians(self.degrees)
            if away:
                chosen.append(index)
        return np.array(chosen)


def turn(before: float, after: float) -> float:
    """Radians turned to the left from one heading to another, -pi to pi."""
    return (after - before + math.pi) % (2 * math.pi) - math.pi


def driven(poses: np.ndarray) -> np.ndarray:
    """The low-level actions int [N] that whoever drove took at poses [N, 3]; at the last, STOP.

    A step that did both counts as what it did more of, one unit being 0.25 m or 15 degrees.
    """
    actions = np.full(len(poses), STOP)
    step = Step()
    for index in range(len(poses) - 1):
        moved = float(np.hypot(*(poses[index + 1, :2] - poses[index, :2]))) / step.metres
        turned = turn(poses[index, 2], poses[index + 1, 2]) / math.radians(step.degrees)
        if moved >= abs(turned):
            actions[index] = FORWARD
        else:
            actions[index] = LEFT if turned > 0 else RIGHT
    return actions


def plan_pose(x: float, y: float, forward: np.ndarray) -> tuple[float, float, float]:
    """The pose in the plan frame of an agent at (x, y) that faces ``forward`` [3] (z is up)."""
    return x, y, math.atan2(-forward[0], forward[1])


def rotated(quaternion: Sequence[float], axis: Sequence[float]) -> np.ndarray:
    """``axis`` [3] turned by a quaternion (x, y, z, w). Raises ValueError for one that is none."""
    found = np.asarray(quaternion, np.float64)
    length = float(np.linalg.norm(found))
    if not (found.shape == (4,) and np.isfinite(length) and length > 1e-6):
        raise ValueError(f"The quaternion {found.tolist()} is no rotation.")
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


def between(times: np.ndarray, at: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Poses [N, 3] at ``times``, on the line between those at the times ``at`` (growing)."""
    headings = np.interp(times, at, np.unwrap(poses[:, 2]))
    xy = [np.interp(times, at, poses[:, column]) for column in (0, 1)]
    return np.stack([*xy, headings], 1)


def words(file: Path) -> str:
    """The instruction in a text file; empty if there is none."""
    return file.read_text(encoding="utf-8", errors="replace").strip() if file.is_file() else ""
