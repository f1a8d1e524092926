"""Depth videos of LeRobot datasets, which store depth as 12-bit codes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core.names import short

MAX_CODE = 4095  # maximum of 12 bits (DEPTH_QMAX of lerobot)
MAX_METRES = 1e4  # limit for parameters in metres (heuristic)


@dataclass(frozen=True)
class DepthCode:
    """How a depth video encodes metres.

    A code c from 0 to ``MAX_CODE`` means ``near + (far - near) * c / MAX_CODE`` metres. If ``log``
    is true, the logarithm of (metres + ``shift``) is interpolated in the same way. The function
    ``quantize_depth`` of lerobot defines the codes, and its ``DepthEncoderConfig`` the defaults.

    Here, code 0 means no reading. lerobot writes this code both for pixels without a reading and
    for depth up to ``near``.
    """

    near: float = 0.01  # minimum depth in metres (code 0)
    far: float = 10.0  # maximum depth in metres (code MAX_CODE)
    shift: float = 3.5  # metres that are added before the logarithm is taken
    log: bool = True  # whether codes are logarithmic

    @classmethod
    def of(cls, info: Mapping[str, Any], place: str) -> DepthCode:
        """Return the depth encoding that the ``info`` of a feature describes.

        Raises:
            ValueError: If a parameter is invalid; the message begins with ``place``.
        """
        names = ("depth_min", "depth_max", "shift")
        defaults = (cls.near, cls.far, cls.shift)
        values = []
        for name, default in zip(names, defaults, strict=True):
            value = info.get(f"video.{name}")
            value = default if value is None else value
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not (is_number and abs(value) <= MAX_METRES):
                raise ValueError(
                    f"{place}: video.{name} must be a number of at most {MAX_METRES:g} metres, got "
                    f"{short(value)}."
                )
            values.append(float(value))
        log = info.get("video.use_log")
        log = cls.log if log is None else log
        near, far, shift = values
        if not isinstance(log, bool) or not 0 <= near < far or (log and near + shift <= 0):
            raise ValueError(
                f"{place}: the depth of a video must have 0 <= depth_min < depth_max, depth_min + "
                f"shift > 0 and use_log true or false, got {near:g}, {far:g}, {shift:g} and "
                f"{short(log)}."
            )
        return cls(near, far, shift, log)

    def metres(self, codes: np.ndarray) -> np.ndarray:
        """Convert codes to metres (float32); 0 means no reading."""
        share = np.minimum(codes, MAX_CODE).astype(np.float64) / MAX_CODE
        if self.log:
            low, high = math.log(self.near + self.shift), math.log(self.far + self.shift)
            metres = np.exp(low + share * (high - low)) - self.shift
        else:
            metres = self.near + share * (self.far - self.near)
        return np.where(codes == 0, 0, np.clip(metres, self.near, self.far)).astype(np.float32)

    def codes(self, metres: np.ndarray) -> np.ndarray:
        """Convert float32 metres to the nearest codes (uint16); only missing depth becomes 0."""
        valid = np.isfinite(metres) & (metres > 0)
        depth = np.clip(np.where(valid, metres, self.near), self.near, self.far)
        if self.log:
            low, high = math.log(self.near + self.shift), math.log(self.far + self.shift)
            share = (np.log(depth + self.shift) - low) / (high - low)
        else:
            share = (depth - self.near) / (self.far - self.near)
        return np.clip(np.rint(share * MAX_CODE), valid, MAX_CODE).astype(np.uint16)
