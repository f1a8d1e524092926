"""Build the camera configs of a panorama for habitat-lab 0.3.

    from habitat.config import read_write
    from mitigate.worlds.habitat_lab import panorama

    with read_write(config):
        config.habitat.simulator.agents.main_agent.sim_sensors = panorama(rgb=224, depth=256)

This gives the observations of ETPNav: ``rgb``, ``rgb_30``, ... ``rgb_330`` and ``depth``,
``depth_30``, ... Needs habitat-lab.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from habitat.config.default_structured_configs import (
    HabitatSimDepthSensorConfig,
    HabitatSimRGBSensorConfig,
)

from mitigate.core.observation import HFOV_DEGREES, VIEW_STEP_DEGREES, VIEWS, Z_MAX


@dataclass
class NamedRGBSensorConfig(HabitatSimRGBSensorConfig):
    """Config of an RGB camera. ``uuid`` is the name of its entry in observations."""

    uuid: str = "rgb"


@dataclass
class NamedDepthSensorConfig(HabitatSimDepthSensorConfig):
    """Config of a depth camera. ``uuid`` is the name of its entry in observations."""

    uuid: str = "depth"


def panorama(rgb: int = 224, depth: int = 256, height: float = 1.25) -> dict[str, Any]:
    """Return the configs of 12 RGB and 12 depth cameras by name.

    Successive cameras are 30 degrees further to the left.

    Args:
        rgb: Height and width of the RGB cameras in pixels.
        depth: Height and width of the depth cameras in pixels.
        height: Height of the cameras above the floor in metres.
    """
    sensors = {}
    for kind, name, size in (
        (NamedRGBSensorConfig, "rgb", rgb),
        (NamedDepthSensorConfig, "depth", depth),
    ):
        for k in range(VIEWS):
            angle = VIEW_STEP_DEGREES * k
            uuid = f"{name}_{angle:g}" if k else name
            sensors[uuid] = kind(
                uuid=uuid,
                width=size,
                height=size,
                hfov=int(HFOV_DEGREES),
                position=[0.0, height, 0.0],
                orientation=[0.0, math.radians(angle), 0.0],
            )
            if kind is NamedDepthSensorConfig:
                sensors[uuid].max_depth = Z_MAX
    return sensors
