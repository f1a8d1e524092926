"""Define the range of a depth camera, and which of its pixels are valid.

A pixel is invalid if its depth is 0, negative, NaN or infinite.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from mitigate.core import observation

NEAREST = np.float32(1e-3)  # minimum valid depth after a corruption, in metres
# normalised value of valid depth at or below z_min; it is not 0, because 0 means no reading
LEAST = np.float32(1e-6)
# This check of the unit is a heuristic; it checks about UNIT_SAMPLES pixels.
# At least one in MIN_NEAR valid pixels must be nearer than MAX_RANGES * z_max.
# One in ten is enough, because outdoors only the ground is so near.
MAX_RANGES = 3.0
MIN_NEAR = 10
UNIT_SAMPLES = 8192
LIGHT_SPEED = 299_792_458.0  # metres per second


@dataclass(frozen=True)
class DepthSensor:
    """The range of a depth camera, and its value for missing depth.

    Agents interpret the value 0 differently: R2R-CE agents treat it as missing, VLFM as far away,
    and L3MVN as the maximum of the image column.

    Attributes:
        z_min: Minimum depth in metres.
        z_max: Maximum depth in metres.
        missing: Value in metres that marks missing depth.

    Raises:
        ValueError: If the range is invalid.
    """

    z_min: float = 0.0
    z_max: float = observation.Z_MAX
    missing: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.z_min < self.z_max < math.inf:
            raise ValueError(
                f"The range of a depth sensor must be 0 <= z_min < z_max in metres, got {self}. "
                "Use DepthSensor(0.0, 10.0) for R2R-CE or DepthSensor(0.5, 5.0) for RxR-CE."
            )

    def to_metres(self, normalised: np.ndarray) -> np.ndarray:
        """Convert normalised depth in [0, 1] to metres; 0 (no reading) stays 0."""
        metres = self.z_min + normalised * np.float32(self.z_max - self.z_min)
        return np.where(normalised == 0, 0, metres).astype(np.float32)

    def from_metres(self, metres: np.ndarray) -> np.ndarray:
        """Convert metres to normalised depth in [0, 1]; only invalid pixels become 0."""
        valid = (metres > 0) & (metres < np.inf)
        unit = (np.where(valid, metres, 0) - self.z_min) / np.float32(self.z_max - self.z_min)
        return np.where(valid, np.clip(unit, LEAST, 1), 0).astype(np.float32)


@njit(inline="always")
def is_valid(z):
    """Return a mask of valid depth."""
    return (z > np.float32(0)) & (z < np.float32(np.inf))


@njit(cache=True)
def _is_near(pixels, limit):
    """Return whether enough of the sampled valid pixels are nearer than ``limit``.

    The loop usually ends after a few pixels, so it costs almost nothing per frame.
    """
    near = valid = 0
    step = pixels.size // UNIT_SAMPLES + 1
    for i in range(0, pixels.size, step):
        valid += is_valid(pixels[i])
        near += is_valid(pixels[i]) & (pixels[i] <= limit)
        if MIN_NEAR * near * step >= pixels.size:
            return True
    return MIN_NEAR * near >= valid


def check_unit(views: np.ndarray, sensor: DepthSensor) -> None:
    """Raise ValueError if nearly all depth values [V, H, W] are far beyond z_max.

    Such values are probably not in metres. Clipping them to the sensor's range would give a flat
    wall.
    """
    if not _is_near(views.reshape(-1), np.float32(MAX_RANGES * sensor.z_max)):
        median = float(np.median(views[(views > 0) & (views < np.inf)]))
        raise ValueError(
            f"Depth must be in metres, but nearly all of it is far beyond the sensor's z_max of "
            f"{sensor.z_max:g} m (median {median:g}). If it is in millimetres, divide it by 1000, "
            "or set unit=mm for a folder of PNG files. If it is in metres, use a sensor with a "
            "larger z_max."
        )
