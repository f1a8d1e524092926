"""Apply random compositions of primitive transforms (broad augmentation), only for training.

A schedule with ``broad_share`` mixes random compositions with its named corruptions, so that an
agent does not adapt only to the named ones. Random compositions are never part of a suite. The
primitives follow PRIME (Modas et al., ECCV 2022: tone, filter, warp) and methods like AugMix;
sensor failures were added (noise, covered areas, lost parts). The primitives use OpenCV. It is
imported when the first frame is corrupted, so an agent can be loaded without OpenCV.
"""

from __future__ import annotations

import numpy as np

from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.record import Record

STATE = "primitives, maps"  # what stays constant during an episode


def broad_rgb(views: np.ndarray, severity: float, key: Key, heading=None) -> np.ndarray:
    """Apply one to three primitives of ``rgb.py``, each with a random strength up to
    ``severity``.
    """
    from mitigate.corruptions.broad import rgb

    return rgb.compose(views, severity, key)


def broad_depth(views: np.ndarray, severity: float, key: Key, sensor: DepthSensor) -> np.ndarray:
    """Apply one to three primitives of ``depth.py``, each with a random strength up to
    ``severity``.
    """
    from mitigate.corruptions.broad import depth

    return depth.compose(views, severity, key, sensor)


RECORDS = (
    Record(
        name="broad_rgb",
        modality="rgb",
        apply=broad_rgb,
        version="2",
        label="Broad RGB",
        severity="strongest primitive",
        source="PRIME, AugMix",
        episode=STATE,
        frame="noise, views, or maps",
    ),
    Record(
        name="broad_depth",
        modality="depth",
        apply=broad_depth,
        version="1",
        label="Broad depth",
        severity="strongest primitive",
        source="after PRIME",
        episode=STATE,
        frame="noise, views, or maps",
    ),
)
