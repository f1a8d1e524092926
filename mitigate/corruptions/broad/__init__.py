"""Apply random compositions of primitive transforms (broad augmentation), only for training.

A schedule with ``broad_share`` mixes random compositions with its named corruptions, so that an
agent does not adapt only to the named ones. Random compositions are never part of a suite. The
primitives follow PRIME (Modas et al., ECCV 2022: tone, filter, warp) and methods like AugMix;
sensor failures were added (noise, covered areas, lost parts). The primitives use OpenCV. It is
imported when the first frame is corrupted, so an agent can be loaded without OpenCV.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.record import Record

STATE = "primitives, maps"  # what stays constant during an episode


def broad_rgb(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Apply one to three primitives of ``rgb.py`` with random strengths up to ``severity``."""
    from mitigate.corruptions.broad import rgb

    return rgb.compose(views, severity, key)


def broad_depth(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Apply one to three primitives of ``depth.py`` with random strengths up to ``severity``."""
    from mitigate.corruptions.broad import depth

    return depth.compose(views, severity, key, sensor)


_record = partial(
    Record.of, severity="strongest primitive", episode=STATE, frame="noise, views, or maps"
)
RECORDS = (
    _record("rgb", broad_rgb, source="PRIME, AugMix", label="Broad RGB", version="2"),
    _record("depth", broad_depth, source="after PRIME", version="2"),
)
