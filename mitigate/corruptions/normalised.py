"""Depth that a sensor has normalised to [0, 1], as Habitat's do: to metres, corrupted, and back."""

from __future__ import annotations

import numpy as np
from numba import njit

from mitigate.core import observation
from mitigate.corruptions.depth_sensor import LEAST, DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.suite import SENSOR, Corruption, check_corruption, corrupt_observation


def corrupt_normalised(
    obs: dict, corruption: Corruption, key: Key | int | str, sensor: DepthSensor = SENSOR
) -> dict:
    """``corrupt_observation`` for an observation whose ``depth`` is normalised.

    ``depth`` is float32 in [0, 1]: 0 means no reading (or not beyond ``sensor.z_min``), other
    values v are z_min + v (z_max - z_min) metres. Pixels that the corruption does not touch, and
    all that are 0, negative, NaN or infinite, come back bit for bit. A hole of missing data reads
    ``sensor.missing`` metres: 0 for the default, 1 for ``DepthSensor(missing=z_max)``.

    Raises ValueError for depth above 1 (it is in metres), a negative sentinel, and as
    ``corrupt_observation`` does.
    """
    check_sensor(sensor)
    if observation.DEPTH not in {*obs}.intersection(check_corruption(corruption).modalities):
        return corrupt_observation(obs, corruption, key, sensor)
    clean = np.ascontiguousarray(_checked(np.asarray(obs[observation.DEPTH])))
    metres, range_ = np.empty_like(clean), _range(sensor)
    most = _to_metres(clean.reshape(-1), *range_, metres.reshape(-1))
    if most > 1.0:
        raise ValueError(
            f"Normalised depth must be in 0-1, but this frame reaches {most:g}. Is it in metres? "
            "Then say normalised=False, or call corrupt_observation."
        )
    corrupted = corrupt_observation({**obs, observation.DEPTH: metres}, corruption, key, sensor)
    made, out = np.ascontiguousarray(corrupted[observation.DEPTH]), np.empty_like(clean)
    _normalise(made.reshape(-1), metres.reshape(-1), clean.reshape(-1), *range_, out.reshape(-1))
    return {**corrupted, observation.DEPTH: out}


def check_sensor(sensor: DepthSensor) -> None:
    """Raise ValueError for a sentinel that normalised depth cannot hold: a negative one or NaN."""
    if not sensor.missing >= 0.0:
        raise ValueError(
            f"{sensor} cannot be normalised: missing must be 0 (no reading) or more metres."
        )


def _checked(clean: np.ndarray) -> np.ndarray:
    if clean.dtype != np.float32:
        raise ValueError(
            f"Normalised depth must be float32 in 0-1, but this frame is {clean.dtype}. Convert it "
            "first: depth.astype(np.float32)."
        )
    return clean


def _range(sensor: DepthSensor) -> tuple[np.float32, np.float32]:
    """Nearest depth and extent of the range, in metres."""
    return np.float32(sensor.z_min), np.float32(sensor.z_max - sensor.z_min)


@njit(cache=True)
def _to_metres(clean, z_min, span, out):
    """Metres of valid depth, 0 for the rest; returns the largest valid value."""
    most = np.float32(0)
    for i in range(clean.size):
        value = clean[i]
        if value > 0 and value < np.inf:
            out[i] = z_min + value * span
            most = max(most, value)
        else:
            out[i] = 0
    return most


@njit(cache=True)
def _normalise(corrupted, metres, clean, z_min, span, out):
    """Back to [0, 1]; where ``corrupted`` still is ``metres``, the clean values themselves."""
    for i in range(clean.size):
        depth = corrupted[i]
        if depth == metres[i]:
            out[i] = clean[i]
        elif depth > 0:
            out[i] = min(max((depth - z_min) / span, LEAST), np.float32(1))
        else:
            out[i] = 0
