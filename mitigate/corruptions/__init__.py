"""Corruptions: what can happen to a frame, keyed, monotone and the same everywhere."""

from mitigate.corruptions.depth import DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.normalised import corrupt_normalised
from mitigate.corruptions.schedule import MODES, Schedule
from mitigate.corruptions.suite import (
    CLEAN,
    DEPTH,
    NAMES,
    RGB,
    SUITE_VERSION,
    Corruption,
    corrupt,
    corrupt_observation,
)

__all__ = [
    "CLEAN",
    "DEPTH",
    "MODES",
    "NAMES",
    "RGB",
    "SUITE_VERSION",
    "Corruption",
    "DepthSensor",
    "Key",
    "Schedule",
    "corrupt",
    "corrupt_normalised",
    "corrupt_observation",
]
