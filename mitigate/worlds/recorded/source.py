"""The interface of an opened recording, which has time steps with poses and with frames of named
cameras.

An opened recording is called a source. Times and poses are read when a source is opened, and frames
are read on request. ``folders.py`` and ``bags.py`` open files as sources.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mitigate.core.observation import POSE, VIEW_STEP_DEGREES

# Heuristic limits.
# maximum time in seconds between frames of one time step (the frame period of a 10 Hz camera)
MAX_FRAME_GAP = 0.1
# maximum time in seconds between recorded poses for which poses in between are interpolated
MAX_POSE_GAP = 2.0
MAX_INSTANTS = 1 << 20  # maximum number of time steps per drive, which is 9 hours at 30 Hz
MAX_TEXT_BYTES = 1 << 28  # maximum number of bytes of a text file that lists files or poses
MAX_INSTRUCTION_BYTES = 1 << 16
MIN_HFOV = 10.0  # limits of the horizontal field of view in degrees
MAX_HFOV = 179.0
MIN_VFOV = 1.0  # minimum vertical field of view in degrees
# maximum offset of the principal point from the centre, as a fraction of the width or height
MAX_CENTRE_OFFSET = 4.0
# A heading is defined if the horizontal component of a unit direction is at least this.
# The direction then points at most 73 degrees up or down.
MIN_LEVEL = 0.3
# maximum relative difference between the aspect ratios of an image and its CameraInfo
MAX_ASPECT_ERROR = 0.02

# advice for depth that is stored as integers
SET_UNIT = "Set unit= (metres per count), such as unit=0.0001."


@dataclass(frozen=True)
class Lens:
    """A pinhole camera. It is described by its field of view or by its intrinsics.

    Attributes:
        kind: "rgb" or "depth".
        hfov: Horizontal field of view in degrees. It is ignored if ``focal`` is set.
        yaw: Direction of the camera in degrees to the right of the heading.
        focal: Focal lengths (fx, fy) in pixels of an image of ``size``.
        centre: Principal point (cx, cy) in pixels of an image of ``size``.
        size: Width and height of the image in pixels.
        assumed: Whether ``hfov`` is a default, because the recording does not contain the field of
            view.

    Raises:
        ValueError: If the field of view or the principal point is out of range.
    """

    kind: str
    hfov: float = 90.0
    yaw: float = 0.0
    focal: tuple[float, float] | None = None
    centre: tuple[float, float] | None = None
    size: tuple[int, int] | None = None
    assumed: bool = False

    def __post_init__(self) -> None:
        hfov = vfov = self.hfov
        offset = 0.0
        if self.focal is not None and self.size is not None and self.centre is not None:
            hfov, vfov = self.fields_of_view(self.size[1], self.size[0])
            offset = max(abs(c - s / 2) / s for c, s in zip(self.centre, self.size, strict=True))
        if not (MIN_HFOV <= hfov <= MAX_HFOV and MIN_VFOV <= vfov <= MAX_HFOV):
            raise ValueError(
                f"The field of view of a camera must be {MIN_HFOV:g} to {MAX_HFOV:g} degrees "
                f"(vertically from {MIN_VFOV:g}), got {hfov:.3g} x {vfov:.3g}."
            )
        if offset > MAX_CENTRE_OFFSET:
            raise ValueError(
                "The principal point of a camera must be at most "
                f"{MAX_CENTRE_OFFSET:g} image sizes from the middle, got {offset:.3g}."
            )

    def intrinsics(self, height: int, width: int) -> tuple[float, float, float, float]:
        """Return (fx, fy, cx, cy) in pixels for an image of this size.

        Raises:
            ValueError: If the aspect ratio of the image differs from the aspect ratio of ``size``.
        """
        if self.focal is None or self.centre is None or self.size is None:
            focal = width / 2 / math.tan(math.radians(self.hfov) / 2)
            return focal, focal, width / 2, height / 2
        scale_x = width / self.size[0]
        scale_y = height / self.size[1]
        if abs(scale_x / scale_y - 1) > MAX_ASPECT_ERROR:
            raise ValueError(
                f"images of {width} x {height} do not fit the CameraInfo, which is for "
                f"{self.size[0]} x {self.size[1]}. Name the topic of their CameraInfo "
                "(topics.info=, topics.depth_info=)"
            )
        fx, fy = self.focal
        cx, cy = self.centre
        return fx * scale_x, fy * scale_y, cx * scale_x, cy * scale_y

    def fields_of_view(self, height: int, width: int) -> tuple[float, float]:
        """Return the horizontal and vertical field of view in degrees for an image of this size."""
        fx, fy, _, _ = self.intrinsics(height, width)
        across = 2 * math.degrees(math.atan2(width / 2, fx))
        return across, 2 * math.degrees(math.atan2(height / 2, fy))

    @property
    def view(self) -> int:
        """The index of the nearest view of the panorama (see ``core/observation.py``)."""
        return round(self.yaw / VIEW_STEP_DEGREES) % round(360 / VIEW_STEP_DEGREES)


@dataclass(kw_only=True)
class Source:
    """Base class of an opened recording of N time steps.

    Attributes:
        name: Name of the drive.
        instruction: Instruction text, which may be empty.
        cameras: Lens of each camera by name.
        times: float64 [N], increasing, in seconds.
        poses: float64 [N, 3], (x, y, heading) in the plan frame of ``core/observation.py``, or
            None if unknown.
        stepped: Whether each time step is one step of an agent. If false, each time step is one
            frame of the camera.
        dropped: Number of time steps that were skipped because no pose or no frame of the other
            camera was near in time.
        signals: Recorded numbers by name, such as "action": float64 [N, size].
        formats: Description of where and how the data is stored, for each camera and for "pose".
            Examples are "/odom" and "16-bit PNG, 0.001 metres per count (assumed)".
        damaged: Descriptions of the damaged images that ``frames`` has found so far.
        depth_advice: How a user can correct depth that is not in metres.
    """

    name: str
    instruction: str
    cameras: Mapping[str, Lens]
    times: np.ndarray
    poses: np.ndarray | None = None
    stepped: bool = False
    dropped: int = 0
    signals: Mapping[str, np.ndarray] = field(default_factory=dict)
    formats: Mapping[str, str] = field(default_factory=dict)
    damaged: list[str] = field(default_factory=list)
    depth_advice: str = "Convert it to metres."

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        """Yield the frames of all cameras at each chosen time step, in order.

        Args:
            chosen: Increasing indices of time steps.

        Yields: the frames by camera: RGB as uint8 [H, W, 3], depth in metres as float32 [H, W] with
        0 for missing depth. If an image is damaged, the dict is empty and ``damaged`` describes the
        image.

        Raises:
            ValueError: If a frame is damaged and this kind of source does not allow damaged frames.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no frames(chosen)")


def heading_along(quaternion: Sequence[float], axis: Sequence[float]) -> float:
    """Return the heading in radians of a ``quaternion`` (x, y, z, w) in a frame with z up.

    ``axis`` [3] is the forward direction before the rotation. The heading is NaN if the direction
    is up or down, or if ``quaternion`` is not a rotation.
    """
    values = np.asarray(quaternion, np.float64)
    length = float(np.linalg.norm(values))
    if not (values.shape == (4,) and np.isfinite(length) and length > 1e-6):
        return math.nan
    *imaginary, w = values / length
    u = np.array(imaginary)
    v = np.asarray(axis, np.float64)
    forward = v + 2 * np.cross(u, np.cross(u, v) + w * v)
    level = math.hypot(forward[0], forward[1]) >= MIN_LEVEL
    return math.atan2(-forward[0], forward[1]) if level else math.nan


def clean_depth(depth: np.ndarray) -> np.ndarray:
    """Return depth as float32, with negative and non-finite values replaced by 0."""
    return np.where(np.isfinite(depth) & (depth > 0), depth, 0).astype(np.float32)


def find_nearest(times: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the element of ``others`` that is nearest to each element of ``times``.

    Args:
        times: float64 [N], seconds.
        others: float64 [M], increasing, in seconds.

    Returns:
        Indices into ``others`` (int [N]), and the distances in seconds (float64 [N]).
    """
    right = np.clip(np.searchsorted(others, times), 1, max(1, len(others) - 1))
    left = right - 1
    right = np.minimum(right, len(others) - 1)
    nearest = np.where(times - others[left] <= others[right] - times, left, right)
    return nearest, np.abs(others[nearest] - times)


def interpolate_poses(
    times: np.ndarray, table: np.ndarray, tolerance: float = MAX_FRAME_GAP
) -> tuple[np.ndarray, np.ndarray]:
    """Interpolate poses at ``times``.

    Args:
        times: float64 [N], seconds.
        table: float64 [M, 4], (time, x, y, heading) of the known poses.
        tolerance: If a recorded pose is at most this many seconds from a time, the pose at that
            time counts as known.

    Returns:
        The poses (float64 [N, 3]), and whether each pose is known (bool [N]). Poses are unknown
        where recorded poses are more than ``MAX_POSE_GAP`` seconds apart, except within
        ``tolerance`` seconds of a recorded pose.
    """
    table = table[np.isfinite(table).all(1)]
    if not len(table):
        return np.zeros((len(times), 3)), np.zeros(len(times), bool)
    pose_times, first = np.unique(table[:, 0], return_index=True)
    poses = table[first, 1:]
    headings = np.interp(times, pose_times, np.unwrap(poses[:, 2]))
    xy = [np.interp(times, pose_times, poses[:, column]) for column in (0, 1)]
    after = np.searchsorted(pose_times, times)
    gaps = np.concatenate([[np.inf], np.diff(pose_times), [np.inf]])[after]
    close = find_nearest(times, pose_times)[1] <= tolerance
    return np.stack([*xy, headings], 1), (gaps <= MAX_POSE_GAP) | close


@dataclass(frozen=True)
class Instants:
    """The time steps at which all cameras have a frame and the pose is known.

    ``frames`` holds, for each camera, the index of its frame at each time step (int [N]).
    ``dropped`` is the number of skipped time steps.
    """

    times: np.ndarray
    poses: np.ndarray | None
    frames: dict[str, np.ndarray]
    dropped: int


def match_times(
    path: Path,
    stamps: Mapping[str, Sequence[float]],
    table: np.ndarray | None,
    tolerance: float,
    names: Mapping[str, str],
) -> Instants:
    """Match poses and the frames of several cameras by time.

    Args:
        path: The recording, for the error message.
        stamps: Times of the frames of each camera, in seconds. The first camera defines the time
            steps.
        table: float64 [M, 4], (time, x, y, heading) of the known poses, or None.
        tolerance: Maximum time difference in seconds between a time step and its frames.
        names: Displayed names of the cameras and of "pose". The default is their keys.

    Raises:
        ValueError: If no time step is complete.
    """
    times = np.sort(next(iter(stamps.values())))
    complete = np.ones(len(times), bool)
    frames = {}
    distances = []  # typical time differences as texts for the error message
    for name, seconds in stamps.items():
        order = np.argsort(seconds, kind="stable")
        nearest, distance = find_nearest(times, np.sort(seconds))
        frames[name] = order[nearest]
        distances.append(f"{names.get(name, name)} by {np.median(distance):.3g} s")
        complete &= distance <= tolerance
    poses = None
    if table is not None:
        poses, known = interpolate_poses(times, table, tolerance)
        _, distance = find_nearest(times, np.sort(table[:, 0]))
        distances.append(f"{names.get(POSE, POSE)} by {np.median(distance):.3g} s")
        complete &= known
    if not complete.any():
        first = next(iter(stamps))
        raise ValueError(
            f"{path}: the frames and poses of a time step must be at most {tolerance:g} s apart, "
            f"but the times of {names.get(first, first)} typically differ from "
            f"{' and '.join(distances[1:])}. Correct the clocks, increase tolerance=, or omit one "
            "of these inputs."
        )
    return Instants(
        times[complete],
        None if poses is None else poses[complete],
        {name: index[complete] for name, index in frames.items()},
        int((~complete).sum()),
    )


def read_instruction(file: Path) -> str:
    """Read the instruction from a text file, or return "" if the file does not exist."""
    instruction = read_text(file, MAX_INSTRUCTION_BYTES).strip() if file.is_file() else ""
    if "\N{REPLACEMENT CHARACTER}" in instruction or "\0" in instruction:
        raise ValueError(f"{file} must be UTF-8 text. Save it as UTF-8, or remove it.")
    return instruction


def read_text(file: Path, max_bytes: int = MAX_TEXT_BYTES) -> str:
    """Read a text file. Raise ValueError if it is larger than ``max_bytes``."""
    with open(file, "rb") as stream:
        # read(n) allocates n bytes in advance, so n is limited by the size of the file
        raw = stream.read(min(max_bytes, file.stat().st_size) + 1)
    if len(raw) > max_bytes:
        raise ValueError(
            f"{file} must have at most {max_bytes} bytes. Shorten or split the recording."
        )
    return raw.decode("utf-8-sig", errors="replace")
