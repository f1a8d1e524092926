"""Define names, dtypes, shapes and units of observations, and the direction of turns.

An observation describes one time step: a panorama of ``VIEWS`` RGB-D views and the pose of the
agent.

* ``rgb``    uint8   ``[12, H, W, 3]``
* ``depth``  float32 ``[12, H, W, 1]``, metres along the optical axis; 0 means "no reading"
* ``pose``   float32 ``[3]`` = (x, y, heading): metres, metres, radians, in the plan frame

View ``k`` faces ``30 k`` degrees to the RIGHT of the heading (clockwise, seen from above).
``heading`` is an angle in counter-clockwise direction; the agent faces ``(-sin h, cos h)``. The
point (x, y) in the plan frame is the point (x, height, -y) in VLN-CE's frame, whose second axis
points up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

RGB = "rgb"
DEPTH = "depth"
POSE = "pose"
CLEAN_RGB = "clean_rgb"  # entry of training batches: frames before the corruption
CLEAN_DEPTH = "clean_depth"
# entries of torchrl environments: instruction, name of the episode's run, number of low-level steps
INSTRUCTION = "instruction"
EPISODE = "episode"
FRAME = "frame"

VIEWS = 12
VIEW_STEP_DEGREES = 30.0
HFOV_DEGREES = 90.0
Z_MAX = 10.0  # maximum range in metres of the depth sensor in R2R-CE (VLN-CE config)

STOP, FORWARD, LEFT, RIGHT = 0, 1, 2, 3
FORWARD_METRES = 0.25  # VLN-CE
TURN_DEGREES = 15.0  # VLN-CE
MAX_STEPS = 500  # VLN-CE


@dataclass(frozen=True)
class Sensor:
    """Describes one entry of an observation."""

    kind: str  # "rgb", "depth", "pose" or "text"
    shape: tuple[int, ...]  # shape of the array; the first axis counts views if there are several
    dtype: str  # numpy name of the dtype
    unit: str = ""  # "m" for depth
    hfov: float | None = None  # horizontal field of view in degrees
    # directions of the views, in degrees to the right of the heading
    yaws: tuple[float, ...] = (0.0,)
    low: float = -math.inf  # least valid value
    high: float = math.inf  # greatest valid value
    missing: float | None = None  # value that means "no reading"


def cameras(size: int, views: int = VIEWS) -> dict[str, Sensor]:
    """Return the standard sensors, which this module's docstring describes.

    Args:
        size: height and width of a view in pixels.
        views: number of views. 1 means a single forward camera, whose frames ``[H, W, c]`` have no
            axis for views.
    """
    yaws = tuple(VIEW_STEP_DEGREES * k for k in range(views))
    shape = (views, size, size) if views > 1 else (size, size)
    return {
        RGB: Sensor(RGB, (*shape, 3), "uint8", "", HFOV_DEGREES, yaws, 0, 255),
        DEPTH: Sensor(DEPTH, (*shape, 1), "float32", "m", HFOV_DEGREES, yaws, 0, missing=0.0),
        POSE: Sensor(POSE, (3,), "float32", "m, m, rad"),
    }


def sensor_lines(sensors: Mapping[str, Sensor], read: Any = None) -> tuple[str, ...]:
    """Return one line per sensor of a world that an agent reads.

    Args:
        sensors: the sensors that the world provides.
        read: the names of the sensors that the agent reads. If the world has none of them, all
            sensors of the world are listed.
    """
    names = read if isinstance(read, Sequence) and {*map(str, read)} & {*sensors} else sensors
    lines = []
    for name in [name for name in sensors if name in names]:
        sensor = sensors[name]
        several = len(sensor.yaws) > 1
        views = f"{len(sensor.yaws)} views of " if several else ""
        shape = " x ".join(map(str, sensor.shape[several:]))
        unit = f", {sensor.unit}" if sensor.unit else ""
        width = f", {sensor.hfov:g} degrees wide" if sensor.hfov else ""
        lines.append(f"{name}: {views}{shape} {sensor.dtype}{unit}{width}")
    return tuple(lines)


class Observation(Mapping[str, Any]):
    """An observation that renders its frames when one of them is read for the first time.

    Args:
        ready: available entries, such as the pose.
        make: function that returns the frames, or None if all entries are ready.
        frames: names of the frames.
        clean: the observation before corruption, or None if this observation is clean.
    """

    def __init__(
        self,
        ready: Mapping[str, Any],
        make: Callable[[], Mapping[str, Any]] | None = None,
        frames: Iterable[str] = (),
        *,
        clean: Observation | None = None,
    ) -> None:
        self.ready = dict(ready)
        self.frames = tuple(frames)
        self._make = make
        self._clean = clean
        self._frame_data: dict[str, Any] | None = None

    @property
    def clean(self) -> Observation:
        """The observation before the corruption."""
        return self if self._clean is None else self._clean

    def __getitem__(self, name: str) -> Any:
        if name in self.frames:
            if self._frame_data is None:
                self._frame_data = dict(self._make()) if self._make else {}
            return self._frame_data[name]
        return self.ready[name]

    def __iter__(self) -> Iterator[str]:
        return iter((*self.ready, *self.frames))

    def __len__(self) -> int:
        return len(self.ready) + len(self.frames)
