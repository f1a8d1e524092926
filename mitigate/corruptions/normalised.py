"""Corrupt depth that is normalised to [0, 1], as Habitat's sensors return it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit

from mitigate.core import observation
from mitigate.corruptions.depth_sensor import LEAST, DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.suite import SENSOR, Corruption, check_corruption, corrupt_observation


def corrupt_normalised(
    obs: dict,
    corruption: Corruption,
    key: Key | int | str,
    sensor: DepthSensor = SENSOR,
    hfov: Mapping[str, float | None] | None = None,
) -> dict:
    """Call ``corrupt_observation`` on an observation whose ``depth`` is normalised.

    ``depth`` is float32 in [0, 1]. The value 0 means no reading, or depth of at most
    ``sensor.z_min``. Any other value v means z_min + v * (z_max - z_min) metres. Pixels that the
    corruption does not change keep their exact bits, as do pixels that are 0, negative, NaN or
    infinite. Pixels that the corruption removes get the normalised value of ``sensor.missing``,
    which is 0 by default and 1 for ``DepthSensor(missing=z_max)``.

    Args:
        obs: The observation.
        corruption: The corruption.
        key: Key of the random numbers.
        sensor: Depth range, and the value that marks missing depth.
        hfov: For each entry, the horizontal field of view in degrees, which camera faults need.

    Returns:
        A new dict; entries that are not corrupted are the same objects as in ``obs``.

    Raises:
        ValueError: If depth is above 1 (so probably in metres), ``sensor.missing`` is negative, or
            ``corrupt_observation`` raises an error.
    """
    check_sensor(sensor)
    if observation.DEPTH not in {*obs}.intersection(check_corruption(corruption).modalities):
        return corrupt_observation(obs, corruption, key, sensor, hfov)
    clean = np.ascontiguousarray(obs[observation.DEPTH])
    if clean.dtype != np.float32:
        raise ValueError(
            f"Normalised depth must be float32 from 0 to 1, got {clean.dtype}. Convert it: "
            "depth.astype(np.float32)."
        )
    metres = np.empty_like(clean)
    # the minimum and the length of the range, in metres
    range_ = np.float32(sensor.z_min), np.float32(sensor.z_max - sensor.z_min)
    maximum = _to_metres(clean.reshape(-1), *range_, metres.reshape(-1))
    if maximum > 1.0:
        raise ValueError(
            f"Normalised depth must be between 0 and 1, got {maximum:g}. For depth in metres, set "
            "normalised=False, or call corrupt_observation."
        )
    in_metres = {**obs, observation.DEPTH: metres}
    corrupted = corrupt_observation(in_metres, corruption, key, sensor, hfov)
    depth = np.ascontiguousarray(corrupted[observation.DEPTH])
    out = np.empty_like(clean)
    _normalise(depth.reshape(-1), metres.reshape(-1), clean.reshape(-1), *range_, out.reshape(-1))
    return {**corrupted, observation.DEPTH: out}


def check_sensor(sensor: DepthSensor) -> None:
    """Raise ValueError if ``missing`` cannot be normalised because it is negative or NaN."""
    if not sensor.missing >= 0.0:
        raise ValueError(
            "For normalised depth, missing must be 0 (no reading) or a depth in metres, got "
            f"{sensor}."
        )


@njit(cache=True)
def _to_metres(clean, z_min, span, out):
    """Convert valid depth to metres, and set all other pixels to 0.

    Return the largest valid value of ``clean``.
    """
    maximum = np.float32(0)
    for i in range(clean.size):
        value = clean[i]
        if value > 0 and value < np.inf:
            out[i] = z_min + value * span
            maximum = max(maximum, value)
        else:
            out[i] = 0
    return maximum


@njit(cache=True)
def _normalise(corrupted, metres, clean, z_min, span, out):
    """Normalise depth to [0, 1]; unchanged pixels keep their clean values."""
    for i in range(clean.size):
        depth = corrupted[i]
        if depth == metres[i]:
            out[i] = clean[i]
        elif depth > 0:
            out[i] = min(max((depth - z_min) / span, LEAST), np.float32(1))
        else:
            out[i] = 0
