"""Check observations before an agent uses them.

Without these checks, a wrong unit or layout would raise no error, and the agent would navigate
badly.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mitigate.agents.agent import as_agent
from mitigate.agents.text import MAX_WORDS, UNKNOWN, Vocabulary
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB, VIEWS, Sensor

# Depth is rejected if most values exceed FARTHEST metres (heuristic).
# Indoors, at least the floor is always nearer than that.
FARTHEST = 50.0
# A panorama causes a warning if its depth never exceeds NEAREST metres (heuristic).
# In almost every room, at least one surface is farther away.
NEAREST = 1.0

CHANNELS = {RGB: 3, DEPTH: 1}


def check_fits(agent: Any, sensors: Mapping[str, Sensor], world: str) -> None:
    """Check that a world has the sensors and the number of views that an agent declares.

    Args:
        agent: any agent; its ``sensors`` and ``views`` are compared.
        sensors: the sensors of the world.
        world: name of the world, for messages.

    Raises:
        ValueError: If a sensor is missing, or the number of views differs.
    """
    contract = as_agent(agent)
    declared = contract.sensors
    read = declared if isinstance(declared, Sequence) else ()
    for name in read:
        if name not in (*sensors, POSE):
            raise ValueError(
                f"{type(agent).__name__} reads {name}, which the world {world} does not have. "
                f"{unknown('sensor', name, sensors)} Otherwise, choose another agent, or another "
                "world (env=...)."
            )
    expected = contract.views
    if expected not in (1, VIEWS):
        return
    for name, sensor in sensors.items():
        views = sensor.shape[0] if len(sensor.shape) == 4 else 1
        if name in (RGB, DEPTH) and views != expected:
            raise ValueError(
                f"The number of views in {name} is {views} in the world {world}, but "
                f"{type(agent).__name__} needs {expected}. Set env.views={expected} "
                f'(mitigate.benchmark: options=["env.views={expected}"]).'
            )


def frames(observation: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return RGB uint8 [12, H, H, 3] and depth float32 [12, H, H, 1]; see :func:`frame`."""
    return frame(observation, RGB, VIEWS), frame(observation, DEPTH, VIEWS)


def frame(observation: Mapping[str, Any], name: str, views: int) -> np.ndarray:
    """Return the entry "rgb" (uint8) or "depth" (float32 metres), ready for torch.

    A warning is issued for depth that looks normalised.

    Args:
        observation: an observation of the world.
        name: "rgb" or "depth".
        views: the number of views, 1 or 12.

    Returns:
        An array [12, H, H, c] for 12 views, or [H, H, c] for one view. The array is C-contiguous
        and writeable.

    Raises:
        KeyError: If the entry is missing.
        TypeError: If RGB is not uint8, or depth is not floating point.
        ValueError: If the shape is not the expected shape, or depth is in millimetres.
    """
    array = _entry(observation, name)
    if name == RGB and array.dtype != np.uint8:
        raise TypeError(
            f"rgb must be uint8 with values 0 to 255, got {array.dtype}. For values 0 to 1, give "
            "(rgb * 255).round().astype(np.uint8)."
        )
    if name == DEPTH and not np.issubdtype(array.dtype, np.floating):
        raise TypeError(
            f"depth must be float32 metres, got {array.dtype}. For millimetres, give "
            "depth.astype(np.float32) / 1000."
        )
    channels, first = CHANNELS[name], () if views == 1 else (views,)
    size = array.shape[-2] if array.ndim > 1 else 0
    if not size or array.shape != (*first, size, size, channels):
        expected = f"{views} square views, one per 30 degrees: [{views}, H, H, {channels}]"
        if views == 1:
            expected = f"one square forward view (env.views=1): [H, H, {channels}]"
        raise ValueError(
            f"{name} has the shape {list(array.shape)}, but the agent needs {expected}, H > 0."
        )
    if name == DEPTH:
        _check_unit(array, views)
    # torch needs contiguous and writeable arrays, so other arrays are copied
    return np.require(array, np.uint8 if name == RGB else np.float32, ["C", "W"])


def pose(observation: Mapping[str, Any]) -> np.ndarray:
    """Check the pose [3] and return it unchanged.

    Raises:
        KeyError: If the pose is missing.
        ValueError: If the pose does not consist of three finite numbers.
    """
    array = _entry(observation, POSE)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(
            f"pose must be three finite numbers, (x, y, heading) in metres and radians, got "
            f"{array.tolist()}."
        )
    return array


def instruction(text: str, vocabulary: Vocabulary) -> None:
    """Warn if ``text`` contains no word of ``vocabulary``, or too many words.

    Raises:
        TypeError: If ``text`` is not a string.
    """
    if not isinstance(text, str):
        raise TypeError(f"instruction must be a string, got a {type(text).__name__}.")
    if set(vocabulary.encode(text)) == {UNKNOWN}:
        warnings.warn(
            f"The agent knows no word of the instruction {text[:60]!r}: it knows English routes.",
            stacklevel=3,
        )
    if len(text.split()) > MAX_WORDS:
        warnings.warn(
            f"An instruction has more than {MAX_WORDS} words. The agent reads only the first "
            f"{MAX_WORDS}.",
            stacklevel=3,
        )


def _entry(observation: Mapping[str, Any], name: str) -> np.ndarray:
    try:
        return np.asarray(observation[name])
    except KeyError:
        raise KeyError(
            f"The observation has no entry {name!r}; it holds {', '.join(map(str, observation))}. "
            f"The agent needs {RGB}, {DEPTH} and {POSE}."
        ) from None


def _check_unit(depth: np.ndarray, views: int) -> None:
    """Raise ValueError if depth is in millimetres; warn if depth looks normalised."""
    valid = depth[np.isfinite(depth) & (depth > 0)]
    if not len(valid):
        return
    if np.count_nonzero(valid > FARTHEST) > len(valid) / 2:
        raise ValueError(
            f"depth must be in metres, but its median is {np.median(valid):g}. If these are "
            "millimetres, divide by 1000."
        )
    if valid.max() <= NEAREST and views > 1:  # a single camera may face a wall
        warnings.warn(
            f"The largest depth is {valid.max():g} m. If it is normalised, as Habitat's is by "
            "default, multiply it by the sensor's range first.",
            stacklevel=3,
        )
