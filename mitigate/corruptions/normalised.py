"""Depth that a sensor has normalised to [0, 1], as Habitat's do: to metres, corrupted, and back."""

from __future__ import annotations

import numpy as np

from mitigate.core import observation
from mitigate.corruptions.depth import DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.suite import SENSOR, Corruption, corrupt_observation

LEAST = np.float32(1e-6)  # of the range: what valid depth at or under z_min becomes, as 0 is a hole


def corrupt_normalised(
    obs: dict, corruption: Corruption, key: Key, sensor: DepthSensor = SENSOR
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
    if corruption.modality != "depth" or observation.DEPTH not in obs:
        return corrupt_observation(obs, corruption, key, sensor)
    clean = np.asarray(obs[observation.DEPTH])
    valid = _valid(clean)
    metres = np.where(valid, sensor.to_metres(clean), np.float32(0))
    corrupted = corrupt_observation({**obs, observation.DEPTH: metres}, corruption, key, sensor)
    return {
        **corrupted,
        observation.DEPTH: _normalise(corrupted[observation.DEPTH], metres, clean, sensor),
    }


def check_sensor(sensor: DepthSensor) -> None:
    """Raise ValueError for a sentinel that normalised depth cannot hold: a negative one or NaN."""
    if not sensor.missing >= 0.0:
        raise ValueError(
            f"{sensor} cannot be normalised: missing must be 0 (no reading) or more metres."
        )


def _valid(clean: np.ndarray) -> np.ndarray:
    if clean.dtype != np.float32:
        raise ValueError(
            f"Normalised depth must be float32 in 0-1, but this frame is {clean.dtype}. Convert it "
            "first: depth.astype(np.float32)."
        )
    valid = (clean > 0) & (clean < np.inf)
    most = float(clean[valid].max(initial=0.0))
    if most > 1.0:
        raise ValueError(
            f"Normalised depth must be in 0-1, but this frame reaches {most:g}. Is it in metres? "
            "Then say normalised=False, or call corrupt_observation."
        )
    return valid


def _normalise(
    corrupted: np.ndarray, metres: np.ndarray, clean: np.ndarray, sensor: DepthSensor
) -> np.ndarray:
    """Back to [0, 1]; where ``corrupted`` still is ``metres``, the clean values themselves."""
    unit = (corrupted - np.float32(sensor.z_min)) / np.float32(sensor.z_max - sensor.z_min)
    read = np.where(corrupted > 0, np.clip(unit, LEAST, 1), np.float32(0))
    return np.where(corrupted == metres, clean, read).astype(np.float32)
