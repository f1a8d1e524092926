"""What the agent checks before it believes an observation.

Every check is one that a robot would pay for: a wrong unit or layout does not fail later, the agent
only walks badly.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mitigate.agents.agent import as_agent
from mitigate.agents.text import UNKNOWN, Vocabulary
from mitigate.core.observation import DEPTH, POSE, RGB, VIEWS, Sensor

FARTHEST = 50.0  # metres (ours): indoors some pixel of twelve views is nearer, if only the floor
NEAREST = 1.0  # metres (ours): a room of which nothing lies farther away is rare


CHANNELS = {RGB: 3, DEPTH: 1}


def check_fits(agent: Any, sensors: Mapping[str, Sensor], world: str) -> None:
    """Raise ValueError if the world with these sensors, called ``world``, shows no RGB or no depth
    though ``agent`` says that it reads it (``sensors``), or another number of views than it says
    that it takes (``views``)."""
    contract = as_agent(agent)
    reads = contract.sensors
    read = reads if isinstance(reads, Sequence) else ()
    for name in (RGB, DEPTH):
        if name in read and name not in sensors:
            raise ValueError(
                f"{type(agent).__name__} reads {name}, which the world {world} does not show: it "
                f"shows {', '.join(sensors)}. Choose another agent, or another world (env=...)."
            )
    wanted = contract.views
    if wanted not in (1, VIEWS):
        return
    for name, sensor in sensors.items():
        views = sensor.shape[0] if len(sensor.shape) == 4 else 1
        if name in (RGB, DEPTH) and views != wanted:
            raise ValueError(
                f"The world {world} shows {views} of {VIEWS} views in {name}, but "
                f"{type(agent).__name__} takes {wanted}. Set env.views={wanted}, as conf/agent "
                'does for this kind of agent (mitigate.benchmark: options=["env.views='
                f'{wanted}"]), or choose another agent.'
            )


def frames(observation: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return RGB uint8 [12, H, H, 3] and depth float32 [12, H, H, 1]; see :func:`frame`."""
    return frame(observation, RGB, VIEWS), frame(observation, DEPTH, VIEWS)


def frame(observation: Mapping[str, Any], name: str, views: int) -> np.ndarray:
    """Return the entry "rgb" (uint8) or "depth" (float32 metres) as torch takes it: of 12 views
    [12, H, H, c], of one [H, H, c].

    Raises KeyError for a missing entry; TypeError for anything but uint8 RGB and floating depth;
    ValueError for another shape and for depth in millimetres. Warns of depth that looks normalised.
    """
    found = _entry(observation, name)
    if name == RGB and found.dtype != np.uint8:
        raise TypeError(
            f"rgb must be uint8 with values 0 to 255, not {found.dtype}: for values 0 to 1, give "
            "(rgb * 255).round().astype(np.uint8)."
        )
    if name == DEPTH and not np.issubdtype(found.dtype, np.floating):
        raise TypeError(
            f"depth must be float32 metres, not {found.dtype}: for millimetres, give "
            "depth.astype(np.float32) / 1000."
        )
    channels, first = CHANNELS[name], () if views == 1 else (views,)
    size = found.shape[-2] if found.ndim > 1 else 0
    if not size or found.shape != (*first, size, size, channels):
        wanted = f"square views at once: [{views}, H, H, {channels}], H > 0, view k at 30 k "
        one = (
            f"square view ahead: [H, H, {channels}], H > 0. Show it one; a world of ours does with "
            "env.views=1."
        )
        raise ValueError(
            f"{name} has the shape {list(found.shape)}, but the agent sees {views} "
            + (one if views == 1 else f"{wanted}degrees to the right.")
        )
    if name == DEPTH:
        _check_unit(found, views)
    # C and writeable is what torch takes as it is; what has it already is not copied
    return np.require(found, np.uint8 if name == RGB else np.float32, ["C", "W"])


def pose(observation: Mapping[str, Any]) -> np.ndarray:
    """Return the pose [3] as it came. Raises KeyError if it is missing, ValueError unless it is
    three finite numbers."""
    found = _entry(observation, POSE)
    if found.shape != (3,) or not np.isfinite(found).all():
        raise ValueError(
            f"pose must be three finite numbers, (x, y, heading) in metres and radians, not "
            f"{found.tolist()}."
        )
    return found


def instruction(text: str, vocabulary: Vocabulary) -> str:
    """Return ``text``. Raises TypeError if it is no string; warns if it holds no word of
    ``vocabulary``."""
    if not isinstance(text, str):
        raise TypeError(f"An instruction is a string, not {type(text).__name__}.")
    if set(vocabulary.encode(text)) == {UNKNOWN}:
        warnings.warn(
            f"The agent knows no word of the instruction {text[:60]!r}, so it walks without one. "
            "It was trained on English routes.",
            stacklevel=3,
        )
    return text


def _entry(observation: Mapping[str, Any], name: str) -> np.ndarray:
    try:
        return np.asarray(observation[name])
    except KeyError:
        raise KeyError(
            f"The observation has no entry {name!r}; it holds {', '.join(map(str, observation))}. "
            f"The agent needs {RGB}, {DEPTH} and {POSE}."
        ) from None


def _check_unit(depth: np.ndarray, views: int) -> None:
    if ((depth > NEAREST) & (depth <= FARTHEST)).any():
        return  # metres; the rest says what else they may be
    valid = depth[np.isfinite(depth) & (depth > 0)]
    if not len(valid):
        return
    if valid.min() > FARTHEST:
        raise ValueError(
            f"Nothing in depth is nearer than {valid.min():g}: that is not metres. If these are "
            "millimetres, divide by 1000."
        )
    if valid.max() <= NEAREST and views > 1:  # one camera may well face a wall
        warnings.warn(
            f"Nothing in depth is farther than {valid.max():g} m. If it is normalised to 0..1 (as "
            "Habitat's is by default), multiply it by the sensor's range first.",
            stacklevel=3,
        )
