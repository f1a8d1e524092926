"""Camera faults: the camera is higher, tilted, turned, or has a different field of view.

The function ``draw(severity, key)`` of a record returns the displacement (a ``Mount``), which is
constant in an episode. Some worlds render the frames of the displaced camera (``World.displaced``).
All other frames are transformed by a homography. It is exact for a pinhole camera with square
pixels whose rotation or field of view changes. Pixels that the original camera did not see are
black, or have no depth reading. A change of height cannot be computed from a frame: the world must
render it.

The cameras of a panorama form a rigid rig: all views move together. If the rig pitches, the
sideways-facing cameras roll. In a pair of corruptions, the camera fault is applied first. The
ranges are heuristic.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import astuple, dataclass
from functools import partial

import numpy as np
from numba import njit

from mitigate.core.observation import VIEW_STEP_DEGREES
from mitigate.corruptions.depth_sensor import NEAREST, DepthSensor, is_valid
from mitigate.corruptions.keying import Key, digest, sign, uniform
from mitigate.corruptions.record import CAMERA, FRAMES, Record

HEIGHT = 0.6  # metres at severity 1
PITCH, ROLL, YAW = 30.0, 20.0, 30.0  # degrees at severity 1
FOV = 30.0  # degrees at severity 1
NARROWEST, WIDEST = 10.0, 150.0  # limits of the field of view in degrees
TWO_FAULTS = 0.3  # probability of a second fault in training (heuristic)
RIGHT, FORWARD, UP = range(3)  # axes of rotations
_DECIMALS = 12  # rotations are rounded, so that pixels do not depend on the last bit of sin()


@dataclass(frozen=True)
class Mount:
    """A displacement of the camera or the rig of a panorama, or a change of its field of view."""

    height: float = 0.0  # metres up
    pitch: float = 0.0  # degrees up
    roll: float = 0.0  # degrees clockwise, seen from behind the camera
    yaw: float = 0.0  # degrees to the left
    fov: float = 0.0  # degrees by which the horizontal field of view is widened

    def hfov(self, degrees: float) -> float:
        """Return the new horizontal field of view of a camera that originally had ``degrees``."""
        return min(max(degrees + self.fov, NARROWEST), WIDEST)

    def rotation(self) -> np.ndarray:
        """Return the rotation matrix [3, 3] for the axes (right, forward, up).

        The matrix applies roll, then pitch, then yaw.
        """
        return np.round(
            _turn(UP, self.yaw) @ _turn(RIGHT, self.pitch) @ _turn(FORWARD, self.roll), _DECIMALS
        )


def _turn(axis: int, degrees: float) -> np.ndarray:
    """Return the matrix of a rotation about an axis."""
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    plane = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[np.ix_(plane, plane)] = [[cos, -sin], [sin, cos]]
    return matrix


def total(mounts: Iterable[Mount]) -> Mount:
    """Return the sum of displacements."""
    return Mount(*map(sum, zip(*map(astuple, mounts), strict=True)))


def warp(
    views: np.ndarray, mount: Mount, hfov: float, sensor: DepthSensor | None = None
) -> np.ndarray:
    """Return the frames of displaced cameras, computed from the frames of the original cameras.

    Args:
        views: RGB uint8 [V, H, W, 3], or depth float32 metres [V, H, W]. View k has a yaw of -30 *
            k degrees and no pitch.
        mount: The displacement; its height is ignored.
        hfov: Horizontal field of view of the original cameras in degrees.
        sensor: The depth sensor, or None for RGB.

    Returns:
        RGB is interpolated bilinearly. Depth is the nearest reading, converted to metres along the
        new optical axis. Pixels that the original camera did not see are black, or
        ``sensor.missing``.
    """
    rotation = mount.rotation()
    turns = [_turn(UP, -VIEW_STEP_DEGREES * view) for view in range(len(views))]
    rotations = np.round(np.stack([turn.T @ rotation @ turn for turn in turns]), _DECIMALS)
    before, after = (math.tan(math.radians(angle) / 2) for angle in (hfov, mount.hfov(hfov)))
    out = np.zeros_like(views)
    if sensor is None:
        _warp_rgb(views, rotations, before, after, out)
    else:
        limits = (NEAREST, np.float32(sensor.z_max), np.float32(sensor.missing))
        _warp_depth(views, rotations, before, after, *limits, out)
    return out


@njit(inline="always")
def _source(rotation, row, column, height, width, before, after):
    """Return the source row and column of a pixel, and its depth factor.

    The factor is 0 if the pixel is behind the original camera.
    """
    x = (2 * column + 1 - width) / width * after
    z = (height - 1 - 2 * row) / width * after
    right = rotation[0, 0] * x + rotation[0, 1] + rotation[0, 2] * z
    forward = rotation[1, 0] * x + rotation[1, 1] + rotation[1, 2] * z
    up = rotation[2, 0] * x + rotation[2, 1] + rotation[2, 2] * z
    if forward <= 1e-6:
        return -1.0, -1.0, 0.0
    source_column = (right / forward / before * width + width - 1) / 2
    source_row = (height - 1 - up / forward / before * width) / 2
    return source_row, source_column, forward


@njit(inline="always")
def _is_inside(row, column, height, width):
    return -0.5 <= row <= height - 0.5 and -0.5 <= column <= width - 0.5


@njit(cache=True)
def _warp_rgb(views, rotations, before, after, out):
    count, height, width, channels = views.shape
    for view in range(count):
        for i in range(height):
            for j in range(width):
                row, column, forward = _source(rotations[view], i, j, height, width, before, after)
                if forward == 0.0 or not _is_inside(row, column, height, width):
                    continue
                row = min(max(row, 0.0), height - 1.0)
                column = min(max(column, 0.0), width - 1.0)
                top, left = int(row), int(column)
                bottom, right = min(top + 1, height - 1), min(left + 1, width - 1)
                down, across = row - top, column - left
                for c in range(channels):
                    above = (1 - across) * views[view, top, left, c]
                    above += across * views[view, top, right, c]
                    below = (1 - across) * views[view, bottom, left, c]
                    below += across * views[view, bottom, right, c]
                    out[view, i, j, c] = int((1 - down) * above + down * below + 0.5)


@njit(cache=True)
def _warp_depth(views, rotations, before, after, nearest, z_max, missing, out):
    count, height, width = views.shape
    for view in range(count):
        for i in range(height):
            for j in range(width):
                row, column, forward = _source(rotations[view], i, j, height, width, before, after)
                if forward == 0.0 or not _is_inside(row, column, height, width):
                    out[view, i, j] = missing
                    continue
                y = min(max(int(row + 0.5), 0), height - 1)
                x = min(max(int(column + 0.5), 0), width - 1)
                z = views[view, y, x]
                if is_valid(z):
                    z = min(max(np.float32(z / forward), nearest), z_max)
                out[view, i, j] = z


def camera_height(severity: float, key: Key) -> Mount:
    """Return the displacement of a camera that is mounted higher or lower."""
    return Mount(height=severity * HEIGHT * sign(key, "camera_height"))


def camera_pitch(severity: float, key: Key) -> Mount:
    """Return the displacement of a camera that points up or down."""
    return Mount(pitch=severity * PITCH * sign(key, "camera_pitch"))


def camera_roll(severity: float, key: Key) -> Mount:
    """Return the displacement of a camera that is tilted to a side."""
    return Mount(roll=severity * ROLL * sign(key, "camera_roll"))


def camera_yaw(severity: float, key: Key) -> Mount:
    """Return the displacement of a camera that is turned to a side."""
    return Mount(yaw=severity * YAW * sign(key, "camera_yaw"))


def camera_fov(severity: float, key: Key) -> Mount:
    """Return a change of the horizontal field of view, which becomes wider or narrower."""
    return Mount(fov=severity * FOV * sign(key, "camera_fov"))


DRAWS = (camera_height, camera_pitch, camera_roll, camera_yaw, camera_fov)


def random_mount(key: Key) -> Mount:
    """Return a random displacement for training: one or two faults, each with its own severity."""
    value = digest(key, "camera")
    first = int(uniform(value, 0) * len(DRAWS))
    second = (first + 1 + int(uniform(value, 1) * (len(DRAWS) - 1))) % len(DRAWS)
    chosen = [first, second][: 1 + (uniform(value, 2) < TWO_FAULTS)]
    return total(DRAWS[place](uniform(value, 3 + place), key) for place in chosen)


_record = partial(Record.drawn, CAMERA, FRAMES, episode="direction")
RECORDS = (
    _record(camera_height, f"height, up to +-{HEIGHT:g} m"),
    _record(camera_pitch, f"pitch, up to +-{PITCH:g} degrees"),
    _record(camera_roll, f"roll, up to +-{ROLL:g} degrees"),
    _record(camera_yaw, f"yaw offset, up to +-{YAW:g} degrees"),
    _record(camera_fov, f"field of view, up to +-{FOV:g} degrees", label="Field of view"),
)
