"""Apply corruptions: ``corrupt`` to one frame, ``corrupt_observation`` to an observation.

Both are pure functions of (frame, name, severity, key, heading).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core import observation
from mitigate.core.names import unknown
from mitigate.corruptions import registry
from mitigate.corruptions.depth_sensor import DepthSensor, check_unit
from mitigate.corruptions.faults.camera import NARROWEST, WIDEST, Mount, warp
from mitigate.corruptions.faults.temporal import GATE
from mitigate.corruptions.keying import Key, as_key
from mitigate.corruptions.record import (
    CAMERA,
    FRAMES,
    MODALITIES,
    MOTION,
    OF_NO_FRAME,
    TEMPORAL,
    Record,
)

# Increase this version when the result of any corruption changes in any pixel or word.
# A change that affects only invalid inputs needs no new version.
# docs/corruptions.md and docs/instructions.md describe valid inputs.
SUITE_VERSION = "1.1"

# names of corruptions; in core/observation.py, RGB and DEPTH are the names of sensors
RGB = registry.names("rgb")
DEPTH = registry.names("depth")
NAMES = RGB + DEPTH
# instruction.py applies these corruptions before an episode starts
INSTRUCTION = registry.names("instruction")
SENSOR = DepthSensor()
_TRIED: list[Record] = []  # records of plugins whose function gave equal results twice

# This is the maximum number of views per time step.
# R2R's discrete panoramas have 12 views at each of 3 elevations, and VLN-CE has 12 views.
MAX_VIEWS = 36


def rgb_views(frame: np.ndarray) -> np.ndarray:
    """Return an RGB frame as contiguous uint8 [V, H, W, 3]; raise ValueError for other frames."""
    if frame.dtype != np.uint8:
        raise ValueError(
            f"RGB frames must be uint8 from 0 to 255, got {frame.dtype}. Convert them: "
            "np.rint(frame * 255).astype(np.uint8) if values are from 0 to 1, "
            "np.rint(frame).astype(np.uint8) if they are from 0 to 255."
        )
    if frame.ndim not in (3, 4) or frame.shape[-1] != 3 or 0 in frame.shape:
        raise ValueError(
            f"RGB frames must be [H, W, 3] or [views, H, W, 3], got {frame.shape}. The channels "
            "must be the last axis, without alpha. Corrupt the time steps of a batch one at a "
            "time, because each has its own key."
        )
    return _one_instant(np.ascontiguousarray(frame if frame.ndim == 4 else frame[None]))


def depth_views(frame: np.ndarray, sensor: DepthSensor, name: str) -> np.ndarray:
    """Return a depth frame as contiguous float32 [V, H, W]; raise ValueError for other frames."""
    if frame.ndim > 2 and frame.shape[-1] == 3:
        raise ValueError(
            f"{name} needs a depth frame, but the last axis of {frame.shape} is 3, as in "
            f"RGB. RGB corruptions: {', '.join(registry.known('rgb'))}. For depth with 3 "
            "columns, add a last axis of 1: frame[..., None]."
        )
    if frame.dtype != np.float32:
        raise ValueError(
            f"Depth must be float32 in metres, got {frame.dtype}. Convert it: "
            "depth.astype(np.float32), divided by 1000 for millimetres (uint16). Convert "
            "normalised depth (0 to 1) with DepthSensor(z_min, z_max).to_metres."
        )
    shape = frame.shape[:-1] if frame.ndim > 2 and frame.shape[-1] == 1 else frame.shape
    if len(shape) not in (2, 3) or 0 in shape:
        raise ValueError(
            f"Depth must be [H, W], [H, W, 1], [views, H, W] or [views, H, W, 1], got "
            f"{frame.shape}. Corrupt the time steps of a batch one at a time, because each has its "
            "own key."
        )
    views = _one_instant(np.ascontiguousarray(frame.reshape(-1, *shape[-2:])))
    check_unit(views, sensor)
    return views


def _one_instant(views: np.ndarray) -> np.ndarray:
    """Return ``views`` [V, ...]; raise ValueError if there are more views than in a panorama."""
    if len(views) > MAX_VIEWS:
        raise ValueError(
            f"A frame must have at most {MAX_VIEWS} views, got {len(views)}. The first axis "
            "contains the views of one panorama, which share one mask. Corrupt the time steps of a "
            "batch one at a time, because each has its own key."
        )
    return views


def check_name(name: str, allowed: tuple[str, ...] | None = None) -> str:
    """Return ``name`` if it is allowed; otherwise raise ValueError with the nearest allowed name.

    By default, all frame corruptions are allowed, including plugins.
    """
    if name in (NAMES if allowed is None else allowed):
        return name
    allowed = registry.known("rgb", "depth") if allowed is None else allowed
    if name in allowed:
        return name
    if name in INSTRUCTION:
        raise ValueError(
            f"corruption must be one of {', '.join(allowed)}, got {name!r}, "
            "which changes instructions. Corrupt instructions with mitigate corrupt_episodes, or "
            "with corrupt_instruction in Python."
        )
    if name in registry.FAULTS:
        raise ValueError(
            f"corruption must be one of {', '.join(allowed)}, got "
            f"the {registry.family(name)} fault {name!r}. A fault can be used as a condition of "
            f"an evaluation (conditions=[{name}]) or in a Corruption object; training schedules "
            "do not sample faults."
        )
    if registry.AND in str(name):
        raise ValueError(
            f"corruption must be a single corruption, got the pair {name!r}. A pair can be used "
            f"as a condition of an evaluation (conditions=[{name}]) or in a Corruption object."
        )
    raise ValueError(unknown("corruption", name, allowed))


def check_severity(severity: float) -> float:
    """Return ``severity`` as a float.

    Raises:
        ValueError: If it is a bool, or not a number in [0, 1].
    """
    try:
        value = math.nan if isinstance(severity, (str, bool, np.bool_)) else float(severity)
    except (TypeError, ValueError):
        value = math.nan
    if not 0.0 <= value <= 1.0:
        raise ValueError(
            f"Severity must be a number from 0 (clean) to 1 (worst), got {severity!r}. The paper "
            "uses 0.6 for R2R, and 0.5 for RxR and HM3D. Divide percentages by 100, and severities "
            "1 to 5 of ImageNet-C by 5."
        )
    return value


@dataclass(frozen=True)
class Corruption:
    """A corruption, or a pair of corruptions, with a severity.

    Attributes:
        name: "clean", the name of a corruption, or a pair such as "low_light+missing_data", whose
            first corruption is applied first.
        severity: Severity in [0, 1]; both corruptions of a pair have this severity.

    Raises:
        ValueError: If the name is unknown, a pair is invalid, the severity is outside [0, 1], or
            "clean" has a severity above 0.
    """

    name: str
    severity: float

    def __post_init__(self) -> None:
        if registry.AND in str(self.name):
            _check_pair(self.name)
        elif self.name not in ("clean", *NAMES, *INSTRUCTION):
            check_name(self.name, ("clean", *registry.known(*MODALITIES), *registry.FAULTS))
        object.__setattr__(self, "severity", check_severity(self.severity))
        if self.name == "clean" and self.severity > 0.0:
            raise ValueError(
                f"The severity of 'clean' must be 0, got {self.severity}. Use CLEAN, or one of the "
                f"corruptions {', '.join((*NAMES, *INSTRUCTION))}."
            )

    @property
    def parts(self) -> tuple[Corruption, ...]:
        """The single corruptions in the order in which they are applied; empty for "clean".

        Camera faults are applied first, because they change what the lens sees.
        """
        if self.name == "clean":
            return ()
        names = registry.parts(self.name)
        if len(names) == 1:
            return (self,)
        ordered = sorted(names, key=lambda n: (n != GATE, registry.family(n) != CAMERA))
        return tuple(Corruption(name, self.severity) for name in ordered)

    @property
    def modalities(self) -> tuple[str, ...]:
        """The corrupted modalities: "rgb", "depth", "instruction".

        A fault that affects both sensors has both modalities. It also works if only one of them is
        available.
        """
        records = [registry.record(part.name) for part in self.parts if part.name != GATE]
        return tuple(dict.fromkeys(m for record in records for m in record.modalities))

    @property
    def modality(self) -> str:
        """The corrupted modalities as one string: "rgb", "rgb+depth", or "none" if clean."""
        return registry.AND.join(self.modalities) or "none"


def _check_pair(name: str) -> None:
    """Raise ValueError unless ``name`` is a pair of two different corruptions."""
    names = registry.parts(name)
    if "clean" in names:
        raise ValueError(
            f"A pair must consist of two corruptions other than 'clean', got {name!r}. Name the "
            "other corruption alone, or a pair such as low_light+missing_data."
        )
    for part in names:
        check_name(part, (*registry.known(*MODALITIES), *registry.FAULTS))
    if GATE in names:
        gated = registry.record(names[-1])
        if names[0] != GATE or gated.modality in OF_NO_FRAME or gated.family == TEMPORAL:
            raise ValueError(
                f"{GATE!r} must be the first name of a pair, and the second name must be a "
                f"frame corruption that is not a temporal fault, got {name!r}. An example is "
                f"{GATE}+spatter."
            )
    if len(names) != 2 or names[0] == names[1]:
        raise ValueError(
            f"A pair must consist of two different corruptions, got {name!r}. An example is "
            "low_light+missing_data; the first corruption is applied first."
        )


CLEAN = Corruption("clean", 0.0)


def check_gate(corruption: Corruption) -> Corruption:
    """Return ``corruption``; raise ValueError if it is ``intermittent`` alone."""
    if corruption.name == GATE:
        raise ValueError(
            f"{GATE!r} must be the first name of a pair, such as {GATE}+spatter. The second "
            "corruption of the pair is then active only in intervals."
        )
    return corruption


def check_corruption(corruption: Corruption) -> Corruption:
    """Return ``corruption``; raise ValueError if it is not a :class:`Corruption`."""
    if not isinstance(corruption, Corruption):
        raise ValueError(
            f"The corruption must be a Corruption(name, severity), such as "
            f"Corruption('spatter', 0.6), got {corruption!r:.60}."
        )
    return corruption


def check_heading(heading: float | None) -> float | None:
    """Return ``heading`` as a float or None; raise ValueError for NaN, infinity and text."""
    if heading is None or (type(heading) is float and math.isfinite(heading)):
        return heading
    try:
        array = np.asarray(heading)
        value = float(array) if array.ndim == 0 and array.dtype.kind in "iuf" else math.nan
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(
            f"The heading must be a finite number (radians), got {heading!r}. If the heading is "
            "unknown, pass heading=None or an observation without a pose; a flare then keeps its "
            "position in view 0."
        )
    return value


def corrupt(
    frame: np.ndarray,
    name: str,
    severity: float,
    *,
    key: Key | int | str,
    heading: float | None = None,
    sensor: DepthSensor = SENSOR,
    hfov: float | None = None,
) -> np.ndarray:
    """Corrupt the frame of one modality at one time step.

    Args:
        frame: For RGB corruptions, uint8 [H, W, 3] or [V, H, W, 3]. For depth corruptions,
            float32 metres [H, W], [H, W, 1], [V, H, W] (W is not 3) or [V, H, W, 1]. V is the
            number of views of one time step (at most 36), which share one mask. View number k has a
            yaw of -30 * k degrees and no pitch. Corrupt the images of a batch separately, because
            each has its own key; V > 1 without a heading gives a warning.
        name: One of NAMES, or any other registered frame corruption.
        severity: Severity in [0, 1]; 0 returns a bit-exact copy.
        key: Key of the random numbers. An int sets only the seed, and a str sets only the episode.
        heading: Heading of the agent in radians, counter-clockwise, or None if it is unknown. If
            the heading is known, a flare keeps its direction in the world; otherwise, it keeps its
            position in view 0.
        sensor: Depth range, and the value that marks missing depth.
        hfov: Horizontal field of view in degrees; camera faults need it.

    Returns:
        A new array of the same shape and dtype; the input is not modified.

    Raises:
        ValueError: If an argument is invalid, the corruption depends on earlier frames, or nearly
            all depth values are far beyond the sensor's z_max (they are probably in millimetres).
    """
    shape = np.shape(frame)
    several = len(shape) == 4 or (len(shape) == 3 and shape[-1] not in (1, 3))
    if heading is None and several and shape[0] > 1:
        warnings.warn(
            f"The frame {list(shape)} counts as one panorama of {shape[0]} views, which share one "
            "mask. If it is a batch of unrelated images, corrupt each image by itself, with its "
            "own key.",
            stacklevel=2,
        )
    return corrupt_views(frame, name, severity, key, heading, sensor, hfov)


def corrupt_views(
    frame: np.ndarray,
    name: str,
    severity: float,
    key: Key | int | str,
    heading: float | None,
    sensor: DepthSensor,
    hfov: float | None = None,
) -> np.ndarray:
    """Corrupt a frame like :func:`corrupt`, without the warning about several views."""
    if not isinstance(name, str):
        raise ValueError(
            f"The name of a corruption must be a string, got {type(name).__name__}. Call "
            "corrupt(frame, name, severity, key=...)."
        )
    if name not in registry.FAULTS:
        check_name(name)
    severity = check_severity(severity)
    key = as_key(key)
    heading = check_heading(heading)
    frame = np.asarray(frame)
    if frame.dtype.kind in "OSU":
        raise ValueError(
            f"The frame must be an array of numbers, got {frame.ravel()[:1].tolist()!r:.60}. Read "
            'a file with cv2.imread("photo.jpg")[..., ::-1]; cv2.imread returns None if it cannot '
            "read the file."
        )
    record = registry.record(name)
    if record.family == MOTION:
        raise ValueError(
            f"{name!r} changes actions, not frames. Apply it with mitigate evaluate, or with "
            "FaultyMotion in mitigate.worlds.motion."
        )
    if record.family == TEMPORAL and record.draw is not None:
        raise ValueError(
            f"{name!r} is a {record.family} fault, which depends on earlier frames. Instead of a "
            "single frame, pass the frames of a sequence in order to a FrameStream "
            "(docs/faults.md)."
        )
    rgb = record.modality == "rgb" or (record.modality == FRAMES and frame.dtype == np.uint8)
    if record.modality == "rgb" and frame.dtype.kind == "f" and frame.shape[-1:] != (3,):
        raise ValueError(
            f"{name} needs an RGB frame [H, W, 3], but {frame.dtype} {list(frame.shape)} looks "
            f"like depth. Depth corruptions: {', '.join(registry.known('depth'))}."
        )
    views = rgb_views(frame) if rgb else depth_views(frame, sensor, name)
    if severity == 0.0:
        return frame.copy()
    if record.family == CAMERA:
        assert record.draw is not None, "camera faults have a function"
        mount = record.draw(severity, key)
        degrees = _check_camera(name, mount, hfov)
        return warp(views, mount, degrees, None if rgb else sensor).reshape(frame.shape)
    assert record.apply is not None, "frame corruptions have a function"
    arguments = (severity, key, heading if rgb else sensor)
    if name not in registry.plugin_records():
        return record.apply(views, *arguments).reshape(frame.shape)
    result = record.apply(views.copy(), *arguments)
    is_array = isinstance(result, np.ndarray)
    if not is_array or result.dtype != views.dtype or result.shape != views.shape:
        actual = f"{result.dtype} {result.shape}" if is_array else type(result).__name__
        raise ValueError(
            f"The function of corruption {name!r} must return an array of the same shape and dtype "
            f"as its input, got {actual} for {views.dtype} {views.shape}."
        )
    if record not in _TRIED:  # the first call is repeated
        if not np.array_equal(result, record.apply(views.copy(), *arguments), equal_nan=True):
            raise ValueError(
                f"The function of corruption {name!r} must give the same pixels for the same key, "
                "but two calls differ. Derive its random numbers from the key only "
                "(docs/bring-your-own.md)."
            )
        _TRIED.append(record)
    return result.reshape(frame.shape)


def _check_camera(name: str, mount: Mount, hfov: float | None) -> float:
    """Return ``hfov``; raise ValueError if the camera fault cannot be computed from a frame."""
    if mount.height:
        raise ValueError(
            f"{name!r} needs a world that can render from a different camera height: this view "
            "cannot be computed from a frame. Use the apartments or another world that defines "
            "displaced() (docs/faults.md), or leave out this fault."
        )
    if hfov is None:
        raise ValueError(
            f"{name!r} needs the horizontal field of view of the camera. Pass hfov=DEGREES, or set "
            "hfov of the Sensor of your world."
        )
    if not NARROWEST <= hfov <= WIDEST:
        raise ValueError(
            f"hfov must be between {NARROWEST:g} and {WIDEST:g} degrees, got {hfov!r}."
        )
    return float(hfov)


def corrupt_observation(
    obs: dict,
    corruption: Corruption,
    key: Key | int | str,
    sensor: DepthSensor = SENSOR,
    hfov: Mapping[str, float | None] | None = None,
) -> dict:
    """Corrupt the frames of an observation (``core/observation.py``).

    This function ignores instruction corruptions, which ``corrupt_instruction`` applies, and
    motion faults, which ``mitigate/worlds/motion.py`` applies.

    Args:
        obs: The observation. The heading is read from ``obs["pose"]``, if this entry exists.
        corruption: The corruption.
        key: Key of the random numbers.
        sensor: Depth range, and the value that marks missing depth.
        hfov: For each entry, the horizontal field of view in degrees, which camera faults need.

    Returns:
        A new dict; entries that are not corrupted are the same objects as in ``obs``.

    Raises:
        ValueError: If the modality is missing, the shape of the pose is not [3], ``corruption`` is
            not a Corruption, or ``corrupt`` raises an error.
    """
    parts = [p for p in check_corruption(corruption).parts if p.modality not in OF_NO_FRAME]
    pose = obs.get(observation.POSE) if parts else None
    if pose is not None and np.shape(pose) != (3,):
        raise ValueError(
            f"{observation.POSE!r} must be [3] = (x, y, heading), got {np.shape(pose)}. Leave "
            "it out if the heading is unknown; a flare then keeps its position in view 0."
        )
    heading = None if pose is None else float(pose[2])
    result = dict(obs)
    for part in parts:
        for entry in changed_entries(obs, part):
            degrees = (hfov or {}).get(entry)
            result[entry] = corrupt_views(
                result[entry], part.name, part.severity, key, heading, sensor, degrees
            )
    return result


def changed_entries(obs: Mapping[str, Any], part: Corruption) -> tuple[str, ...]:
    """Return the names of the entries of an observation that a single corruption changes.

    Raises:
        ValueError: If the observation has no entry that the corruption could change.
    """
    modalities = registry.record(part.name).modalities
    # each entry is named after its modality
    entries = tuple(name for name in modalities if name in obs)
    if not entries:
        raise ValueError(
            f"{part.name!r} needs the entry {' or '.join(map(repr, modalities))}, which the "
            f"observation lacks (it has {', '.join(map(repr, obs)) or 'none'}). Add this sensor, "
            f"or leave {part.name!r} out of the suite."
        )
    return entries
