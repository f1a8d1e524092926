"""Describe an agent's cameras, lay out their frames in shared memory, and corrupt them.

Cameras in one call form a panorama if they are level, have the same frame size, field of view and
position, and if their yaws are multiples of 30 degrees. Each camera outside a panorama
forms a separate group with separate random numbers.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, HFOV_DEGREES, POSE, RGB, VIEW_STEP_DEGREES, VIEWS
from mitigate.corruptions import Corruption, DepthSensor, FrameStream, Key
from mitigate.guards.guard import Guards

# maximum size of all frames in a call, in bytes (heuristic); 24 cameras of 1080 x 1920 need 5e8
MAX_BYTES = 1 << 30
MAX_CAMERAS = 256  # maximum number of cameras per call (heuristic)
MAX_MEDIAN = 100.0  # if the median depth (metres) is above this, a range is required (heuristic)
CHANNELS = {RGB: (3,), DEPTH: (1,)}
_NAME_WITH_YAW = re.compile(r"(?:rgb|depth)_(\d+(?:\.\d+)?)")
_LEVEL = 1e-3  # a camera is level if its pitch and roll are smaller than this (radians)
_DTYPES = {RGB: ("uint8",), DEPTH: ("float32", "float64", "float16")}


@dataclass(frozen=True)
class Camera:
    """One camera, as the agent's process describes it."""

    name: str  # name of the camera in the observations
    kind: str  # "rgb" or "depth"
    shape: tuple[int, ...]  # shape of a frame, [H, W, C] or [H, W]
    dtype: str
    hfov: float | None  # horizontal field of view in degrees; None if unknown
    place: tuple[float, ...] | None  # position relative to the agent in metres; None if unknown
    yaw: float  # direction, in degrees to the left of the agent's heading
    level: bool  # whether pitch and roll are 0
    sensor: DepthSensor  # range of depth in metres
    normalised: bool  # whether depth values are scaled from this range to [0, 1]

    @property
    def bytes(self) -> int:
        return math.prod(self.shape) * np.dtype(self.dtype).itemsize

    def read(self, memory: Any, offsets: Mapping[str, int]) -> np.ndarray:
        """Return a copy of the camera's frame in ``memory``."""
        frame = np.frombuffer(memory, self.dtype, math.prod(self.shape), offsets[self.name])
        return frame.reshape(self.shape).copy()

    def metres(self, depth: np.ndarray) -> np.ndarray:
        """Return the camera's depth in metres."""
        return self.sensor.to_metres(depth) if self.normalised else depth

    def check_depth(self, median: float) -> None:
        """Raise ValueError if the median depth of a frame contradicts the description."""
        if self.normalised and median > 1.01:
            raise ValueError(
                f"Depth of the camera {self.name!r}, which is described as normalised, must be "
                f"from 0 to 1, got {median:.4g} (median of the first frame). Leave "
                "normalize_depth out if it returns metres."
            )
        if not self.normalised and median > max(MAX_MEDIAN, self.sensor.z_max):
            raise ValueError(
                f"Depth of the camera {self.name!r} must be metres up to {self.sensor.z_max:g}, "
                f"got {median:.4g} (median of the first frame). Divide millimetres by 1000, or set "
                f"cameras={{{self.name!r}: {{'type': 'depth', 'max_depth': 500}}}}."
            )

    def panorama_key(self) -> tuple:
        """Return the properties that all cameras of a panorama have in common."""
        depth = (self.sensor, self.normalised)
        return (self.kind, self.shape, self.dtype, self.hfov, self.place, *depth)


def read_camera(description: Mapping[str, Any], sensor: DepthSensor) -> Camera:
    """Return the camera that is described in a message.

    ``sensor`` is the depth range to use if the description has none. Raises ValueError if frames of
    the camera cannot be corrupted.
    """
    name, kind = description.get("name"), description.get("type")
    if not isinstance(name, str):
        raise ValueError(f"The name of a camera must be text, got {name!r}.")
    if kind not in CHANNELS:
        raise ValueError(f"The kind of the camera {name!r} must be rgb or depth, got {kind!r}.")
    shape = tuple(description.get("shape") or ())
    fits = len(shape) == 3 and shape[2] in CHANNELS[kind] or len(shape) == 2 and kind == DEPTH
    if not fits or not all(isinstance(n, int) and 0 < n < 1 << 16 for n in shape):
        raise ValueError(
            f"The shape of {kind} of the camera {name!r} must be "
            f"{'[H, W, 3]' if kind == RGB else '[H, W, 1] or [H, W]'}, got {list(shape)}."
        )
    if description.get("dtype") not in _DTYPES[kind]:
        raise ValueError(
            f"The dtype of {kind} of the camera {name!r} must be {' or '.join(_DTYPES[kind])}, got "
            f"{description.get('dtype')}.{' Divide millimetres by 1000.' * (kind == DEPTH)}"
        )
    pitch, yaw, roll = _read_orientation(description.get("orientation"), name)
    low, high, hfov = (
        None if description.get(name) is None else float(description[name])
        for name in ("min_depth", "max_depth", "hfov")
    )
    sensor = DepthSensor(
        sensor.z_min if low is None else low, sensor.z_max if high is None else high, sensor.missing
    )
    position = description.get("position")
    return Camera(
        name,
        kind,
        shape,
        description["dtype"],
        hfov,
        place=None if position is None else tuple(map(float, position)),
        yaw=yaw,
        level=abs(pitch) < _LEVEL and abs(roll) < _LEVEL,
        sensor=sensor,
        normalised=kind == DEPTH and bool(description.get("normalize_depth")),
    )


def _read_orientation(orientation: Sequence[float] | None, name: str) -> tuple[float, float, float]:
    """Return pitch and roll in radians and yaw in degrees to the left.

    If there is no orientation, the yaw is read from the camera's name.
    """
    if orientation is not None and len(orientation) == 3:
        pitch, yaw, roll = map(float, orientation)
        return pitch, round(math.degrees(yaw), 3) % 360, roll
    match = _NAME_WITH_YAW.fullmatch(name)
    return 0.0, float(match[1]) % 360 if match else 0.0, 0.0


@dataclass(frozen=True)
class Group:
    """A group of cameras that are corrupted together."""

    cameras: tuple[Camera, ...]
    views: tuple[int, ...]  # the view number of each camera (``core/observation.py``)
    suffix: str  # suffix of the key for random numbers; empty for the largest panorama

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array that holds all views; views without a camera are filled with zeros."""
        return (1 + max(self.views), *self.cameras[0].shape)

    def stream(self) -> FrameStream:
        """Return a new stream for the frames of these cameras."""
        one = self.cameras[0]
        return FrameStream(one.sensor, normalised=one.normalised, hfov={one.kind: one.hfov})


class Rig:
    """All cameras of a call.

    Args:
        descriptions: The descriptions that the agent's process sent.
        missing: Value in metres for missing depth.
        turn: Direction of increasing yaw, "left" (Habitat) or "right".
        streams: Maps each group of cameras to the stream of its recent frames. Pass the streams of
            the previous rig of an environment to continue them; None starts new streams.

    Raises:
        ValueError: If a camera cannot be corrupted, or there are too many cameras.
    """

    def __init__(
        self,
        descriptions: Sequence[Mapping[str, Any]],
        missing: float = 0.0,
        turn: str = "left",
        streams: dict[Group, FrameStream] | None = None,
    ) -> None:
        if len(descriptions) > MAX_CAMERAS:
            raise ValueError(
                f"A call must have at most {MAX_CAMERAS} cameras, got {len(descriptions)}."
            )
        self.turn = turn
        self.cameras = [read_camera(d, DepthSensor(missing=missing)) for d in descriptions]
        names = [camera.name for camera in self.cameras]
        if len(set(names)) < len(names):
            raise ValueError(f"Names of cameras must be different, got {', '.join(names)}.")
        self.groups = [g for kind in CHANNELS for g in _make_groups(self.cameras, kind, turn)]
        self.streams = {} if streams is None else streams

    def describe(self) -> dict[str, dict[str, Any]]:
        """Return kind, field of view, yaw (degrees to the right) and ``level`` of each camera."""
        sign = 1 if self.turn == "right" else -1
        return {
            camera.name: {
                "kind": camera.kind,
                "hfov": camera.hfov,
                "yaw": sign * camera.yaw % 360,
                "level": camera.level,
            }
            for camera in self.cameras
        }

    def lay_out(self, kinds: Collection[str]) -> tuple[dict[str, int], int]:
        """Return the memory offset of each camera of the given ``kinds``, and the total size.

        Raises ValueError if the size is above ``MAX_BYTES``.
        """
        offsets: dict[str, int] = {}
        size = 0
        for group in self.groups:
            if group.cameras[0].kind in kinds:
                step = group.cameras[0].bytes
                offsets |= {
                    camera.name: size + view * step
                    for camera, view in zip(group.cameras, group.views, strict=True)
                }
                size += -(-step * group.shape[0] // 64) * 64
        if size > MAX_BYTES:
            raise ValueError(f"The frames of a call must have <= {MAX_BYTES} bytes, got {size}.")
        return offsets, size

    def corrupt(
        self,
        memory: Any,
        offsets: Mapping[str, int],
        corruption: Corruption,
        key: Key,
        heading: float | None,
    ) -> list[str]:
        """Corrupt the frames in ``memory`` in place; return the names of the cameras that changed.

        Args:
            memory: Shared memory.
            offsets: Offset of each camera in ``memory``.
            corruption: Corruption to apply; parts for other modalities are ignored.
            key: Key from which all random numbers are derived.
            heading: The agent's heading in radians; None if unknown.
        """
        changed: list[str] = []
        for group in (g for g in self.groups if g.cameras[0].kind in corruption.modalities):
            if group not in self.streams:
                self.streams[group] = group.stream()
            views = _views(memory, offsets, group)
            views[...] = corrupt_group(group, views, corruption, key, heading, self.streams[group])
            changed += [camera.name for camera in group.cameras]
        return changed

    def guard(
        self,
        memory: Any,
        offsets: Mapping[str, int],
        guards: Guards,
        started: dict[tuple[str, ...], Guards],
    ) -> list[str]:
        """Apply ``guards`` to the frames in ``memory``; return the names of the changed cameras.

        A panorama of 12 cameras is one frame; each camera outside a panorama has its own frame. An
        RGB frame and a depth frame with the same position, direction and size form one observation.
        ``started`` maps the camera names of an observation to its guards in the current episode;
        this method adds guards for new observations.
        """
        frames = [
            frame
            for group in self.groups
            if group.cameras[0].kind in guards.frames
            for frame in _make_frames(group, _views(memory, offsets, group))
        ]
        changed: list[str] = []
        for pair in _pair(frames):
            names = tuple(camera.name for frame in pair for camera in frame.cameras)
            if names not in started:
                started[names] = guards.for_episode()
            before = {frame.kind: frame.read() for frame in pair}
            after = started[names].observe(before)
            for frame in (f for f in pair if after[f.kind] is not before[f.kind]):
                frame.write(after[frame.kind])
                changed += [camera.name for camera in frame.cameras]
        return changed


@dataclass(frozen=True)
class Frame:
    """One frame for a guard: either all views of a complete panorama, or the view of one camera."""

    cameras: tuple[Camera, ...]
    views: np.ndarray  # the views, as an array in shared memory

    @property
    def kind(self) -> str:
        return self.cameras[0].kind

    def read(self) -> np.ndarray:
        """Return the frame as in an observation: uint8 [..., 3], or float32 metres [..., 1]."""
        first = self.cameras[0]
        if first.kind != DEPTH:
            return self.views
        frames = self.views if len(first.shape) == 3 else self.views[..., None]
        frames = frames.astype(np.float32, copy=False)
        return first.sensor.to_metres(frames) if first.normalised else frames

    def write(self, frame: np.ndarray) -> None:
        """Write a frame, in the format that :meth:`read` returns, to memory."""
        first = self.cameras[0]
        if first.kind == DEPTH and first.normalised:
            frame = first.sensor.from_metres(frame)
        self.views[...] = frame.reshape(self.views.shape).astype(self.views.dtype, copy=False)

    def geometry(self) -> tuple:
        """Return the properties that RGB and depth frames of the same view have in common."""
        first = self.cameras[0]
        poses = sorted((camera.yaw, camera.place or ()) for camera in self.cameras)
        return (*poses, first.hfov, first.shape[:2])


def _make_frames(group: Group, views: np.ndarray) -> list[Frame]:
    """Return one frame for a complete panorama, otherwise one frame per camera of the group."""
    cameras = group.cameras
    if len(cameras) == len(views) == VIEWS and cameras[0].hfov == HFOV_DEGREES:
        return [Frame(cameras, views)]
    pairs = zip(cameras, group.views, strict=True)
    return [Frame((camera,), views[view]) for camera, view in pairs]


def _pair(frames: Sequence[Frame]) -> list[list[Frame]]:
    """Group frames into observations.

    An RGB frame and a depth frame form one observation if they have the same geometry, both are
    level, and no other frame has this geometry. Each remaining frame forms a separate observation.
    """
    by_geometry: dict[tuple, list[Frame]] = {}
    for frame in frames:
        by_geometry.setdefault(frame.geometry(), []).append(frame)
    observations = []
    for same in by_geometry.values():
        level = all(frame.cameras[0].level for frame in same)
        one_of_each = len({frame.kind for frame in same}) == len(same)
        observations += [same] if level and one_of_each else [[frame] for frame in same]
    return observations


def corrupt_group(
    group: Group,
    views: np.ndarray,
    corruption: Corruption,
    key: Key,
    heading: float | None,
    stream: FrameStream,
) -> np.ndarray:
    """Return the corrupted views of a group; parts for other modalities are ignored."""
    first = group.cameras[0]
    dtype = np.float32 if first.kind == DEPTH else np.uint8
    frames: dict[str, Any] = {first.kind: views.astype(dtype, copy=False)}
    if heading is not None:
        frames[POSE] = np.array([0.0, 0.0, heading])
    if group.suffix:
        key = Key(key.seed, f"{key.episode}|{group.suffix}", key.frame)
    return stream.corrupt(frames, corruption, key, partial=True)[first.kind]


def _views(memory: Any, offsets: Mapping[str, int], group: Group) -> np.ndarray:
    """Return the frames of a group in ``memory``, [views, ...]."""
    first = group.cameras[0]
    offset = offsets[first.name] - group.views[0] * first.bytes
    count = math.prod(group.shape)
    return np.frombuffer(memory, first.dtype, count, offset).reshape(group.shape)


def _make_groups(cameras: Sequence[Camera], kind: str, turn: str) -> list[Group]:
    """Return the camera groups of one kind, sorted by decreasing size and then by name.

    This order makes random numbers independent of the order in which cameras are described.
    """
    rings: dict[tuple, dict[int, Camera]] = {}
    single = []
    for camera in sorted((c for c in cameras if c.kind == kind), key=lambda camera: camera.name):
        steps = camera.yaw / VIEW_STEP_DEGREES
        view = round(steps if turn == "right" else -steps) % VIEWS
        ring = rings.setdefault(camera.panorama_key(), {})
        if camera.level and abs(steps - round(steps)) < _LEVEL and view not in ring:
            ring[view] = camera
        else:
            single.append(camera)
    groups = [(tuple(ring.values()), tuple(ring)) for ring in rings.values() if ring]
    groups += [((camera,), (0,)) for camera in single]
    groups.sort(key=lambda group: (-len(group[0]), group[0][0].name))
    return [
        Group(cameras, views, "" if number == 0 else cameras[0].name)
        for number, (cameras, views) in enumerate(groups)
    ]
