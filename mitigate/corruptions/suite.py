"""The suite: names, checks and the two calls that everything else uses.

``corrupt`` takes one modality of one instant, ``corrupt_observation`` an observation dict. Both
are pure functions of (frame, name, severity, key, heading).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mitigate.core import observation
from mitigate.core.names import unknown
from mitigate.corruptions import registry
from mitigate.corruptions.depth_sensor import DepthSensor, check_unit
from mitigate.corruptions.keying import Key, as_key
from mitigate.corruptions.record import MODALITIES

MOST_VIEWS = 36  # of one instant: R2R's discrete panoramas (3 elevations of 12); VLN-CE has 12


def rgb_views(frame: np.ndarray) -> np.ndarray:
    """The frame as contiguous uint8 [V, H, W, 3]; ValueError for anything else."""
    if frame.dtype != np.uint8:
        raise ValueError(
            f"RGB frames must be uint8 in 0-255, but this one is {frame.dtype}. Convert it first: "
            "np.rint(frame * 255).astype(np.uint8) if it is in 0-1, np.rint(frame).astype(np.uint8)"
            " if it is in 0-255. Float frames are refused because pipelines such as CLIP's divide "
            "by 255 only for uint8, so a float frame in 0-255 silently breaks them."
        )
    if frame.ndim not in (3, 4) or frame.shape[-1] != 3 or 0 in frame.shape:
        raise ValueError(
            f"RGB frames must be [H, W, 3] or [views, H, W, 3], but the shape is {frame.shape}. "
            "Move the channels last, drop an alpha channel, and corrupt a batch one instant at a "
            "time: every instant has its own key."
        )
    return _one_instant(np.ascontiguousarray(frame if frame.ndim == 4 else frame[None]))


def depth_views(frame: np.ndarray, sensor: DepthSensor, name: str) -> np.ndarray:
    """The frame as contiguous float32 [V, H, W]; ValueError for anything else, millimetres and RGB
    too."""
    if frame.ndim > 2 and frame.shape[-1] == 3:
        raise ValueError(
            f"{name} corrupts depth, and this looks like an RGB frame (the last axis of "
            f"{frame.shape} is 3). On RGB: {', '.join(registry.known('rgb'))}. If it is depth of 3 "
            "columns, give it a last axis of 1: frame[..., None]."
        )
    if frame.dtype != np.float32:
        raise ValueError(
            f"Depth must be float32 in metres, but this frame is {frame.dtype}. Convert it first: "
            "depth.astype(np.float32), divided by 1000 if it holds millimetres (uint16); a sensor "
            "that normalises to 0-1 goes through DepthSensor(z_min, z_max).to_metres."
        )
    shape = frame.shape[:-1] if frame.ndim > 2 and frame.shape[-1] == 1 else frame.shape
    if len(shape) not in (2, 3) or 0 in shape:
        raise ValueError(
            f"Depth must be [H, W], [H, W, 1], [views, H, W] or [views, H, W, 1], but the shape is "
            f"{frame.shape}. Corrupt a batch one instant at a time: every instant has its own key."
        )
    views = frame.reshape((1, *shape) if len(shape) == 2 else shape)
    views = _one_instant(np.ascontiguousarray(views))
    check_unit(views, sensor)
    return views


def _one_instant(views: np.ndarray) -> np.ndarray:
    """``views`` [V, ...] as they are; ValueError for more of them than a panorama has."""
    if len(views) > MOST_VIEWS:
        raise ValueError(
            f"There are {len(views)} views, but an instant has {MOST_VIEWS} at most. The leading "
            "axis is the views of one panorama, which share one mask. Is it a batch? Corrupt it "
            "one instant at a time: every instant has its own key."
        )
    return views


# changes when any pixel or word of any corruption changes, of frames and texts that keep the rules
# of docs/corruptions.md and docs/instructions.md
SUITE_VERSION = "1.1"

RGB = registry.names("rgb")
DEPTH = registry.names("depth")
NAMES = RGB + DEPTH
# what is done to the words before an episode begins: see instruction.py
INSTRUCTION = registry.names("instruction")
SENSOR = DepthSensor()


def check_name(name: str, allowed: tuple[str, ...] | None = None) -> str:
    """Return ``name``, or raise ValueError with the nearest allowed name; by default the
    corruptions of frames, with those of installed packages, are allowed."""
    if name in (NAMES if allowed is None else allowed):
        return name
    allowed = registry.known("rgb", "depth") if allowed is None else allowed
    if name in allowed:
        return name
    if name in INSTRUCTION:
        raise ValueError(
            f"{name!r} corrupts instructions, and here frames are corrupted, by one of "
            f"{', '.join(allowed)}. For instructions: mitigate corrupt_episodes, or in Python "
            "corrupt_instruction."
        )
    if registry.AND in str(name):
        raise ValueError(
            f"{name!r} is a pair: it is a condition of an evaluation (conditions=[{name}]), and "
            "Corruption holds it; here one corruption is meant."
        )
    raise ValueError(unknown("corruption", name, allowed))


def check_severity(severity: float) -> float:
    """Return ``severity`` as a float in [0, 1], or raise ValueError (for NaN, text and truth values
    too)."""
    try:
        value = math.nan if isinstance(severity, (str, bool, np.bool_)) else float(severity)
    except (TypeError, ValueError):
        value = math.nan
    if not 0.0 <= value <= 1.0:
        raise ValueError(
            f"Severity must be a number from 0 (clean) to 1 (worst), but it is {severity!r}. "
            "The paper uses 0.6 for R2R and 0.5 for RxR and HM3D; percentages and the 1-5 scale "
            "of ImageNet-C must be divided by 100 or 5 first."
        )
    return value


@dataclass(frozen=True)
class Corruption:
    """What is done: ``name`` ("clean", a known one, or a pair of them) at ``severity`` in [0, 1].

    A pair such as "low_light+missing_data" has one severity for both; the first is applied first.
    Raises ValueError for an unknown name, one that is twice in a pair or "clean" in it, a severity
    outside [0, 1], or "clean" with severity > 0.
    """

    name: str
    severity: float

    def __post_init__(self) -> None:
        if registry.AND in str(self.name):
            _check_pair(self.name)
        elif self.name not in ("clean", *NAMES, *INSTRUCTION):
            check_name(self.name, ("clean", *registry.known(*MODALITIES)))
        object.__setattr__(self, "severity", check_severity(self.severity))
        if self.name == "clean" and self.severity > 0.0:
            raise ValueError(
                f"'clean' has severity 0, but {self.severity} was given. Use CLEAN, or name the "
                f"corruption that is meant: {', '.join((*NAMES, *INSTRUCTION))}."
            )

    @property
    def parts(self) -> tuple[Corruption, ...]:
        """The corruptions of a pair in their order, one alone as it is; of "clean" none."""
        if self.name == "clean":
            return ()
        found = registry.parts(self.name)
        return (self,) if len(found) == 1 else tuple(Corruption(n, self.severity) for n in found)

    @property
    def modalities(self) -> tuple[str, ...]:
        """What is corrupted, each once: of "rgb", "depth" and "instruction"."""
        return tuple(dict.fromkeys(registry.modality(part.name) for part in self.parts))

    @property
    def modality(self) -> str:
        """The same in one word: "rgb", "rgb+depth", or "none" for clean episodes."""
        return registry.AND.join(self.modalities) or "none"


def _check_pair(name: str) -> None:
    found = registry.parts(name)
    if "clean" in found:
        raise ValueError(
            f"{name!r} is no pair: 'clean' is the absence of any corruption. Name the other one "
            "alone, or a pair of two corruptions, such as low_light+missing_data."
        )
    for part in found:
        check_name(part, registry.known(*MODALITIES))
    if len(found) != 2 or found[0] == found[1]:
        raise ValueError(
            f"{name!r} is no pair: it has two different names, such as low_light+missing_data, the "
            "first applied first."
        )


CLEAN = Corruption("clean", 0.0)


def check_corruption(corruption: Corruption) -> Corruption:
    """Return ``corruption``, or raise ValueError if it is a name or anything else."""
    if not isinstance(corruption, Corruption):
        raise ValueError(
            f"What is done is a Corruption(name, severity), such as Corruption('spatter', 0.6), "
            f"but it is {corruption!r:.60}."
        )
    return corruption


def check_heading(heading: float | None) -> float | None:
    """Return ``heading`` as a float or None, or raise ValueError for NaN, infinity and text."""
    if heading is None or (type(heading) is float and math.isfinite(heading)):
        return heading
    try:
        told = np.asarray(heading)
        value = float(told) if told.ndim == 0 and told.dtype.kind in "iuf" else math.nan
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(
            f"The heading must be in finite radians, not {heading!r}. Pass heading=None, or an "
            "observation without a pose, if it is not known: a flare then keeps its place in view "
            "0."
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
) -> np.ndarray:
    """Corrupt one modality of one instant.

    Args:
        frame: uint8 [H, W, 3] or [V, H, W, 3] for RGB names; float32 metres [H, W], [H, W, 1],
            [V, H, W] (W not 3) or [V, H, W, 1] for depth names. View k of V looks at yaw -30 k
            degrees, level: the flare knows no elevation. V counts the views of one instant, 36 at
            most: they share one mask. It is no batch axis; corrupt a batch one instant at a time,
            each with its own key.
        name: one of NAMES.
        severity: s in [0, 1]; 0 returns a bit-exact copy.
        key: names the random draw; a whole number is a seed, a text an episode.
        heading: the agent's heading in radians, counter-clockwise. The flare keeps its direction
            in the world; None (unknown) keeps it at its place in view 0 instead.
        sensor: depth range and sentinel.

    Returns a new array of the same shape and dtype; the input is not modified.
    Raises ValueError for a wrong name, severity, dtype, shape, heading or key, and for depth of
    which over nine tenths are beyond three times the sensor's z_max: it is in millimetres.
    """
    check_name(name)
    severity = check_severity(severity)
    key, heading = as_key(key), check_heading(heading)
    frame = np.asarray(frame)
    record = registry.record(name)
    rgb = record.modality == "rgb"
    views = rgb_views(frame) if rgb else depth_views(frame, sensor, name)
    if severity == 0.0:
        return frame.copy()
    assert record.apply is not None, "names of frames have a function"
    given = (severity, key, heading if rgb else sensor)
    if name not in registry.further():
        return record.apply(views, *given).reshape(frame.shape)
    made = record.apply(views.copy(), *given)
    array = isinstance(made, np.ndarray)
    if not array or made.dtype != views.dtype or made.shape != views.shape:
        given_back = f"{made.dtype} {made.shape}" if array else type(made).__name__
        raise ValueError(
            f"The corruption {name!r} gave {given_back} for {views.dtype} {views.shape}: its "
            "function must keep shape and dtype."
        )
    return made.reshape(frame.shape)


def corrupt_observation(
    obs: dict, corruption: Corruption, key: Key | int | str, sensor: DepthSensor = SENSOR
) -> dict:
    """A new observation dict with what ``corruption`` concerns corrupted (``core/observation.py``).

    The other entries are the same objects as in ``obs``. The heading is read from ``obs["pose"]``.
    A corrupted instruction leaves the frames clean: ``corrupt_instruction`` changed the words.
    Raises ValueError if the modality is missing, the pose is not [3] or ``corruption`` is none, and
    as ``corrupt`` does.
    """
    found = dict(obs)
    for part in check_corruption(corruption).parts:
        if part.modality != "instruction":
            found |= _corrupted_entry(found, part, key, sensor)
    return found


def _corrupted_entry(
    obs: dict, part: Corruption, key: Key | int | str, sensor: DepthSensor
) -> dict:
    """The entry that one corruption changes, by name."""
    entry = observation.RGB if part.modality == "rgb" else observation.DEPTH
    if entry not in obs:
        raise ValueError(
            f"{part.name!r} corrupts {entry!r}, which this observation does not hold (it "
            f"holds {', '.join(map(repr, obs)) or 'nothing'}). Give the agent that sensor or leave "
            f"{part.name!r} out of its suite."
        )
    pose = obs.get(observation.POSE)
    if pose is not None and np.shape(pose) != (3,):
        raise ValueError(
            f"{observation.POSE!r} must be [3] = (x, y, heading), but its shape is "
            f"{np.shape(pose)}. Leave it out if the heading is not known: a flare then keeps its "
            "place in view 0."
        )
    heading = None if pose is None else float(pose[2])
    return {
        entry: corrupt(
            obs[entry], part.name, part.severity, key=key, heading=heading, sensor=sensor
        )
    }
