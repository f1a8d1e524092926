"""What the cameras of an agent are, where their frames lie in shared memory, and their corruption.

Cameras of one call that are alike (size, field of view, place, level) and 30 degrees apart are one
panorama; every other camera stands alone and has draws of its own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, HFOV_DEGREES, POSE, RGB, VIEW_STEP_DEGREES, VIEWS
from mitigate.corruptions import Corruption, DepthSensor, Key, corrupt_observation
from mitigate.corruptions.normalised import corrupt_normalised
from mitigate.guards.guard import Guards

LARGEST = 1 << 30  # bytes of all frames of a call (ours): 24 cameras of 1080 x 1920 have 5e8
MOST = 256  # cameras of a call (ours)
FARTHEST = 100.0  # metres: a median depth beyond it is not metres, unless the range says so (ours)
CHANNELS = {RGB: (3,), DEPTH: (1,)}
_TURNED = re.compile(r"(?:rgb|depth)_(\d+(?:\.\d+)?)")  # name of a camera that says its yaw
_LEVEL = 1e-3  # radians: a pitch or roll below it is none
_DTYPES = {RGB: ("uint8",), DEPTH: ("float32", "float64", "float16")}


@dataclass(frozen=True)
class Camera:
    """One camera as the agent's process describes it.

    kind: "rgb" or "depth". yaw: in degrees to the left of the agent; pitch and roll count as
    ``level`` False. sensor: range of depth; normalised: depth is in [0, 1] over it.
    """

    name: str
    kind: str
    shape: tuple[int, ...]
    dtype: str
    hfov: float | None
    place: tuple[float, ...] | None
    yaw: float
    level: bool
    sensor: DepthSensor
    normalised: bool

    @property
    def bytes(self) -> int:
        return math.prod(self.shape) * np.dtype(self.dtype).itemsize

    def read(self, memory: Any, offsets: Mapping[str, int]) -> np.ndarray:
        """A copy of its frame in ``memory``."""
        frame = np.frombuffer(memory, self.dtype, math.prod(self.shape), offsets[self.name])
        return frame.reshape(self.shape).copy()

    def metres(self, depth: np.ndarray) -> np.ndarray:
        """Its depth in metres."""
        return self.sensor.to_metres(depth) if self.normalised else depth

    def check_depth(self, middle: float) -> None:
        """Raise ValueError if depth of this median cannot be what the camera is said to give."""
        at = f"{middle:.4g} (the median of its first frame)"
        if self.normalised and middle > 1.01:
            raise ValueError(
                f"The camera {self.name!r} reads {at}, but it is said to be normalised, 0 to 1: "
                "leave normalize_depth out where it gives metres."
            )
        if not self.normalised and middle > max(FARTHEST, self.sensor.z_max):
            raise ValueError(
                f"The camera {self.name!r} reads {at}, which are no metres of a range up to "
                f"{self.sensor.z_max:g}. Divide millimetres by 1000, or describe the range: "
                f"cameras={{{self.name!r}: {{'type': 'depth', 'min_depth': 0, 'max_depth': 500}}}}."
            )

    def alike(self) -> tuple:
        """What cameras of one panorama have in common."""
        depth = (self.sensor, self.normalised)
        return (self.kind, self.shape, self.dtype, self.hfov, self.place, *depth)


def read_camera(told: Mapping[str, Any], sensor: DepthSensor) -> Camera:
    """Return the camera that a message describes; ``sensor``: of depth whose range is not told.

    Raises ValueError for what cannot be corrupted.
    """
    name, kind = told.get("name"), told.get("type")
    if not isinstance(name, str):
        raise ValueError(f"A camera is called {name!r}: its name must be text.")
    if kind not in CHANNELS:
        raise ValueError(f"The camera {name!r} is of the kind {kind!r}, not rgb or depth.")
    shape = tuple(told.get("shape") or ())
    fits = len(shape) == 3 and shape[2] in CHANNELS[kind] or len(shape) == 2 and kind == DEPTH
    if not fits or not all(isinstance(n, int) and 0 < n < 1 << 16 for n in shape):
        raise ValueError(
            f"The camera {name!r} gives {kind} of the shape {list(shape)}; it must be "
            f"{'[H, W, 3]' if kind == RGB else '[H, W, 1] or [H, W]'}."
        )
    if told.get("dtype") not in _DTYPES[kind]:
        raise ValueError(
            f"The camera {name!r} gives {kind} as {told.get('dtype')}; it must be "
            f"{' or '.join(_DTYPES[kind])}"
            f"{', in metres: divide millimetres by 1000' if kind == DEPTH else ''}."
        )
    pitch, yaw, roll = _turned(told.get("orientation"), name)
    low, high = (_number(told.get(end)) for end in ("min_depth", "max_depth"))
    if low is not None or high is not None:
        low, high = sensor.z_min if low is None else low, sensor.z_max if high is None else high
        sensor = DepthSensor(low, high, sensor.missing)
    return Camera(
        name,
        kind,
        shape,
        told["dtype"],
        _number(told.get("hfov")),
        None if told.get("position") is None else tuple(map(float, told["position"])),
        yaw,
        abs(pitch) < _LEVEL and abs(roll) < _LEVEL,
        sensor,
        kind == DEPTH and bool(told.get("normalize_depth")),
    )


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _turned(orientation: Sequence[float] | None, name: str) -> tuple[float, float, float]:
    """Pitch and roll in radians, yaw in degrees to the left; by the name where it is not told."""
    if orientation is not None and len(orientation) == 3:
        pitch, yaw, roll = map(float, orientation)
        return pitch, round(math.degrees(yaw), 3) % 360, roll
    by_name = _TURNED.fullmatch(name)
    return 0.0, float(by_name[1]) % 360 if by_name else 0.0, 0.0


@dataclass(frozen=True)
class Group:
    """Cameras that are corrupted as one: ``views`` is the view of each, see
    ``core/observation.py``; own: part of the keys, empty for the panorama that sees most."""

    cameras: tuple[Camera, ...]
    views: tuple[int, ...]
    own: str

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array of all views; those without a camera are zero."""
        return (1 + max(self.views), *self.cameras[0].shape)


class Rig:
    """All cameras of a call.

    Args: told: as the agent's process describes them. missing: metres that a hole of missing data
    reads. turn: where a growing yaw turns, "left" (Habitat) or "right". Raises ValueError for
    cameras that cannot be corrupted, and for too many.
    """

    def __init__(
        self, told: Sequence[Mapping[str, Any]], missing: float = 0.0, turn: str = "left"
    ) -> None:
        if len(told) > MOST:
            raise ValueError(f"{len(told)} cameras are more than {MOST}.")
        self.turn = turn
        self.cameras = [read_camera(t, DepthSensor(missing=missing)) for t in told]
        names = [camera.name for camera in self.cameras]
        if len(set(names)) < len(names):
            raise ValueError(f"Two cameras have one name: {', '.join(names)}.")
        self.groups = [g for kind in CHANNELS for g in _groups(self.cameras, kind, turn)]

    def told(self) -> dict[str, dict[str, Any]]:
        """Kind, field of view, yaw (degrees to the right) of each camera, by name, and whether it
        looks level."""
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

    def lay_out(self, kinds: Sequence[str]) -> tuple[dict[str, int], int]:
        """Return where the frame of each camera of these kinds begins in memory, and the size of
        all. Raises ValueError for more than ``LARGEST``."""
        offsets: dict[str, int] = {}
        at = 0
        for group in self.groups:
            if group.cameras[0].kind in kinds:
                step = group.cameras[0].bytes
                offsets |= {
                    camera.name: at + view * step
                    for camera, view in zip(group.cameras, group.views, strict=True)
                }
                at += -(-step * group.shape[0] // 64) * 64
        if at > LARGEST:
            raise ValueError(f"The frames of a call have {at} bytes, more than {LARGEST}.")
        return offsets, at

    def corrupt(
        self,
        memory: Any,
        offsets: Mapping[str, int],
        corruption: Corruption,
        key: Key,
        heading: float | None,
    ) -> list[str]:
        """Corrupt the frames in ``memory``, in place; return the names of the cameras concerned:
        none if no camera is of a modality that it corrupts. Raises ValueError as ``corrupt`` does.
        """
        changed: dict[str, None] = {}
        for part in (part for part in corruption.parts if part.modality in CHANNELS):
            for group in (g for g in self.groups if g.cameras[0].kind == part.modality):
                views = _views(memory, offsets, group)
                views[...] = corrupted(group, views, part, key, heading)
                changed |= dict.fromkeys(camera.name for camera in group.cameras)
        return list(changed)

    def guard(self, memory: Any, offsets: Mapping[str, int], guards: Guards) -> list[str]:
        """Let ``guards`` change the frames in ``memory``, in place; return the names of the cameras
        concerned.

        A panorama of 12 cameras is one frame; every other camera stands alone. One RGB and one
        depth frame of the same place, direction and size are one observation.
        """
        shown = [
            frame
            for group in self.groups
            if group.cameras[0].kind in guards.frames
            for frame in _frames(group, _views(memory, offsets, group))
        ]
        changed: list[str] = []
        for frames in _paired(shown):
            given = {frame.kind: frame.read() for frame in frames}
            made = guards.observe(given)
            for frame in (f for f in frames if made[f.kind] is not given[f.kind]):
                frame.write(made[frame.kind])
                changed += [camera.name for camera in frame.cameras]
        return changed


@dataclass(frozen=True)
class Frame:
    """What a guard gets as one frame: the views of a panorama or of one camera, in memory."""

    cameras: tuple[Camera, ...]
    views: np.ndarray

    @property
    def kind(self) -> str:
        return self.cameras[0].kind

    def read(self) -> np.ndarray:
        """Return it as an observation holds it: uint8 [..., 3], or float32 metres [..., 1]."""
        first = self.cameras[0]
        if first.kind != DEPTH:
            return self.views
        frames = self.views if len(first.shape) == 3 else self.views[..., None]
        frames = frames.astype(np.float32, copy=False)
        return first.sensor.to_metres(frames) if first.normalised else frames

    def write(self, made: np.ndarray) -> None:
        """Put what a guard made of :meth:`read` into memory."""
        first = self.cameras[0]
        if first.kind == DEPTH and first.normalised:
            made = first.sensor.from_metres(made)
        self.views[...] = made.reshape(self.views.shape).astype(self.views.dtype, copy=False)

    def geometry(self) -> tuple:
        """What an RGB and a depth frame of the same view have in common."""
        first = self.cameras[0]
        where = sorted((camera.yaw, camera.place or ()) for camera in self.cameras)
        return (*where, first.hfov, first.shape[:2])


def _frames(group: Group, views: np.ndarray) -> list[Frame]:
    """The panorama as one frame if it is whole, else each camera of a group."""
    cameras = group.cameras
    if len(cameras) == len(views) == VIEWS and cameras[0].hfov == HFOV_DEGREES:
        return [Frame(cameras, views)]
    pairs = zip(cameras, group.views, strict=True)
    return [Frame((camera,), views[view]) for camera, view in pairs]


def _paired(frames: Sequence[Frame]) -> list[list[Frame]]:
    """Observations: an RGB and a depth frame together where both are level and there is one of each
    with their geometry; every other frame alone."""
    alike: dict[tuple, list[Frame]] = {}
    for frame in frames:
        alike.setdefault(frame.geometry(), []).append(frame)
    found = []
    for held in alike.values():
        level = all(frame.cameras[0].level for frame in held)
        one_of_each = len({frame.kind for frame in held}) == len(held)
        found += [held] if level and one_of_each else [[frame] for frame in held]
    return found


def corrupted(
    group: Group, views: np.ndarray, corruption: Corruption, key: Key, heading: float | None
) -> np.ndarray:
    """Return the views of a group as one corruption of theirs leaves them."""
    first = group.cameras[0]
    frames: dict[str, Any] = {first.kind: views}
    if first.kind == DEPTH:
        frames = {DEPTH: views.astype(np.float32, copy=False)}
    if heading is not None:
        frames[POSE] = np.array([0.0, 0.0, heading])
    if group.own:
        key = Key(key.seed, f"{key.episode}|{group.own}", key.frame)
    by = corrupt_normalised if first.normalised else corrupt_observation
    return by(frames, corruption, key, first.sensor)[first.kind]


def _views(memory: Any, offsets: Mapping[str, int], group: Group) -> np.ndarray:
    """[views, ...] in ``memory``: the frames of a group."""
    first = group.cameras[0]
    at = offsets[first.name] - group.views[0] * first.bytes
    count = math.prod(group.shape)
    return np.frombuffer(memory, first.dtype, count, at).reshape(group.shape)


def _groups(cameras: Sequence[Camera], kind: str, turn: str) -> list[Group]:
    """The groups of a kind of camera, the one that sees most first, then by name: the order in
    which cameras are told changes no draw."""
    rings: dict[tuple, dict[int, Camera]] = {}
    alone = []
    for camera in sorted((c for c in cameras if c.kind == kind), key=lambda camera: camera.name):
        steps = camera.yaw / VIEW_STEP_DEGREES
        view = round(steps if turn == "right" else -steps) % VIEWS
        ring = rings.setdefault(camera.alike(), {})
        if camera.level and abs(steps - round(steps)) < _LEVEL and view not in ring:
            ring[view] = camera
        else:
            alone.append(camera)
    found = [(tuple(ring.values()), tuple(ring)) for ring in rings.values() if ring]
    found += [((camera,), (0,)) for camera in alone]
    found.sort(key=lambda group: (-len(group[0]), group[0][0].name))
    return [
        Group(cameras, views, "" if number == 0 else cameras[0].name)
        for number, (cameras, views) in enumerate(found)
    ]
