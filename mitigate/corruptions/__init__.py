"""Corrupt frames and instructions with pure functions of input, severity and key."""

from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.example import example_depth, example_rgb
from mitigate.corruptions.instruction import (
    NotApplicable,
    corrupt_instruction,
    inject_system_prompt,
)
from mitigate.corruptions.keying import Key
from mitigate.corruptions.normalised import corrupt_normalised
from mitigate.corruptions.record import Record
from mitigate.corruptions.schedule import MODES, Schedule
from mitigate.corruptions.stream import FrameStream
from mitigate.corruptions.suite import (
    CLEAN,
    DEPTH,
    INSTRUCTION,
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
    "INSTRUCTION",
    "MODES",
    "NAMES",
    "RGB",
    "SUITE_VERSION",
    "Corruption",
    "DepthSensor",
    "FrameStream",
    "Key",
    "NotApplicable",
    "Record",
    "Schedule",
    "corrupt",
    "corrupt_instruction",
    "corrupt_normalised",
    "corrupt_observation",
    "example_depth",
    "example_rgb",
    "inject_system_prompt",
]
