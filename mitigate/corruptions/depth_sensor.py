"""A depth camera, and which of its pixels say anything.

A pixel is invalid where z <= 0, NaN or infinite.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from mitigate.core import observation

NEAREST = np.float32(1e-3)  # metres: valid depth never falls below
LEAST = np.float32(1e-6)  # of the range: what valid depth at or under z_min becomes, as 0 is a hole
BEYOND = 3.0  # times z_max: a frame with hardly anything nearer is not in metres (ours)
LEAST_NEAR = 10  # one valid pixel in so many is nearer; outdoors, the ground alone is (ours)
LOOKED_AT = 8192  # pixels, to tell the unit by (ours)
LIGHT_SPEED = 299_792_458.0  # metres a second


@dataclass(frozen=True)
class DepthSensor:
    """A depth camera that normalises: range in metres and the value that means "no reading".

    ``missing`` is what missing data writes, in metres, and it is part of the contract with the
    agent: R2R-CE agents read 0 as a hole; VLFM reads it as far and L3MVN as the column maximum.
    Raises ValueError for a range that is none.
    """

    z_min: float = 0.0
    z_max: float = observation.Z_MAX
    missing: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.z_min < self.z_max < math.inf:
            raise ValueError(
                f"{self} has no range in metres: it needs 0 <= z_min < z_max, such as "
                "DepthSensor(0.0, 10.0) for R2R-CE or DepthSensor(0.5, 5.0) for RxR-CE."
            )

    def to_metres(self, normalised: np.ndarray) -> np.ndarray:
        """[0, 1] float to metres; the sentinel 0 (no reading) stays 0."""
        metres = self.z_min + normalised * np.float32(self.z_max - self.z_min)
        return np.where(normalised == 0, 0, metres).astype(np.float32)

    def from_metres(self, metres: np.ndarray) -> np.ndarray:
        """Metres to [0, 1] float; the sentinel 0 (no reading) stays 0, and nothing else is 0."""
        unit = (metres - self.z_min) / np.float32(self.z_max - self.z_min)
        return np.where(metres == 0, 0, np.clip(unit, LEAST, 1)).astype(np.float32)


@njit(inline="always")
def is_valid(z):
    return (z > np.float32(0)) & (z < np.float32(np.inf))


def flat(views: np.ndarray) -> np.ndarray:
    return views.reshape(views.shape[0], -1)


@njit(cache=True)
def _is_near(pixels, limit):
    """Whether one valid pixel in ``LEAST_NEAR`` is at most ``limit``, or none is valid; of a large
    frame about ``LOOKED_AT`` are looked at, evenly."""
    near = valid = 0
    step = pixels.size // LOOKED_AT + 1
    for i in range(0, pixels.size, step):
        valid += is_valid(pixels[i])
        near += is_valid(pixels[i]) & (pixels[i] <= limit)
        if LEAST_NEAR * near * step >= pixels.size:  # enough, whatever the others are
            return True
    return LEAST_NEAR * near >= valid


def check_unit(views: np.ndarray, sensor: DepthSensor) -> None:
    """Raise ValueError for depth [V, H, W] that cannot be metres: nearly all of it is far beyond
    z_max.

    Clipped to the sensor's range, it would be one flat wall.
    """
    if not _is_near(views.reshape(-1), np.float32(BEYOND * sensor.z_max)):
        middle = float(np.median(views[(views > 0) & (views < np.inf)]))
        raise ValueError(
            f"Nearly all valid pixels lie far beyond the sensor's z_max of {sensor.z_max:g} m "
            f"(median {middle:g}): is the depth in millimetres? Divide it by 1000, "
            "give unit=mm for a folder of PNG, or a sensor with a greater z_max if these are "
            "metres."
        )
