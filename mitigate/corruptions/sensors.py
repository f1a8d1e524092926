"""Simulate the depth errors of four cameras, and Gaussian noise that is stronger than in the suite.

The models of cameras come from publications and datasheets. At severity 0.5, a frame has the errors
that the source reports. At other severities, the errors are multiplied by 2 * severity. A profile
has up to five errors, which are applied in this order: (1) pixels take the depth of a neighbour
(lateral noise), (2) depth has a wrong offset and scale in the whole episode, (3) axial noise is
added, (4) disparity is rounded, and (5) the range is limited. Functions have the same arguments and
results as in ``corruptions/depth.py``, and treat invalid pixels in the same way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numba import njit

from mitigate.corruptions.depth import gaussian_noise
from mitigate.corruptions.depth_sensor import NEAREST, DepthSensor, is_valid
from mitigate.corruptions.keying import Key, digest, mix, normal_table, uniform, view_streams
from mitigate.corruptions.record import Record

PUBLISHED = 0.5  # severity at which errors have their published size
# text in the records of two cameras: the part of the error that is constant in an episode
BIAS = "systematic error"


@dataclass(frozen=True)
class Profile:
    """The errors of a depth camera."""

    # coefficients (a, b, c) of the standard deviation a + b * d + c * d^2 in metres
    sd: tuple[float, float, float]
    far: float  # maximum depth that is measured, in metres
    origin: float = 0.0  # depth in metres at which d is 0: d = z - origin
    lateral: float = 0.0  # standard deviation of the lateral error, as a fraction of the width
    # depth takes only the values disparity / n metres for whole n; 0 means no rounding
    disparity: float = 0.0
    offset: float = 0.0  # maximum constant error in metres
    scale: float = 0.0  # maximum error that is proportional to depth, as a fraction of depth


# The Kinect for Xbox 360 uses structured light.
# Axial and lateral noise are from Nguyen, Izadi and Lovell 2012.
# The noise is valid for surfaces that face the camera, in images that are 640 pixels wide.
# Steps of 1/8 pixel are from Barron and Malik 2013, and the range is from the datasheet.
KINECT_V1 = Profile(
    sd=(0.0012, 0.0, 0.0019), origin=0.4, lateral=0.8 / 640, disparity=351.3, far=4.0
)
# The RealSense D435 uses active stereo.
# The RMS error is z^2 * e / (f * B) (Grunnet-Jepsen, Sweetser and Woodfill 2018).
# The error e is 0.08 pixels, and the baseline B is 0.05 m.
# The focal length f is that of images that are 848 pixels and 90 degrees wide.
# Steps of 1/32 pixel and the range come from the datasheet.
REALSENSE_D435 = Profile(sd=(0.0, 0.0, 0.08 / (424 * 0.05)), disparity=32 * 424 * 0.05, far=10.0)
# The RealSense L515 scans the scene with a laser.
# The datasheet gives an indoor standard deviation of 2.5 mm at 1 m and 15.5 mm at 9 m.
# The datasheet gives a mean error of 5 mm at 1 m and 14 mm at 9 m.
REALSENSE_L515 = Profile(
    sd=(0.0025, 0.001625, 0.0), origin=1.0, offset=0.0039, scale=0.0011, far=9.0
)
# The Azure Kinect uses time of flight.
# The datasheet gives a standard deviation of up to 17 mm and the range of the narrow mode.
# The datasheet gives a systematic error of up to 11 mm + 0.1 % of the depth.
# Tolgyessy et al. 2021 confirm these values.
AZURE_KINECT = Profile(sd=(0.017, 0.0, 0.0), offset=0.011, scale=0.001, far=3.86)

_U = np.uint64


@njit(cache=True)
def _measure(views, streams, sd, origin, lateral, steps, bias, limits, missing, table, out):
    """Write the measured depth of each pixel to ``out``.

    ``bias`` is (offset, scale), and ``limits`` is (far, z_max).
    """
    count, height, width = views.shape
    for v in range(count):
        for y in range(height):
            for x in range(width):
                out[v, y, x] = views[v, y, x]
                if not is_valid(views[v, y, x]):
                    continue
                word = mix(streams[v], _U(y * width + x))
                across = table[(word >> _U(4)) & _U(0xFFF)]
                down = table[(word >> _U(20)) & _U(0xFFF)]
                column = min(max(x + int(np.rint(lateral * width * across)), 0), width - 1)
                row = min(max(y + int(np.rint(lateral * width * down)), 0), height - 1)
                z = views[v, row, column]
                if not is_valid(z):
                    z = views[v, y, x]
                far = max(z - origin, 0.0)
                z += bias[0] + bias[1] * z
                z += (sd[0] + sd[1] * far + sd[2] * far * far) * table[(word >> _U(36)) & _U(0xFFF)]
                if steps > 0 and z > 0:
                    z = steps / max(np.rint(steps / z), 1.0)
                if z > limits[0]:
                    out[v, y, x] = missing
                else:
                    out[v, y, x] = min(max(np.float32(z), NEAREST), limits[1])


def measured(
    name: str, profile: Profile, views: np.ndarray, severity: float, key: Key, sensor: DepthSensor
) -> np.ndarray:
    """Return depth with the errors of the camera ``name``, as described by ``profile``.

    The published errors are multiplied by ``severity / PUBLISHED``; the range is divided by this
    factor.
    """
    factor = severity / PUBLISHED
    sign = 2.0 * uniform(digest(key, name)) - 1.0
    bias = np.array([profile.offset, profile.scale]) * factor * sign
    far = profile.far / factor if profile.far < factor * sensor.z_max else math.inf
    out = np.empty_like(views)
    _measure(
        views,
        view_streams(key, name, len(views)),
        np.array(profile.sd) * factor,
        profile.origin,
        profile.lateral * factor,
        profile.disparity / factor,
        bias,
        np.array([far, sensor.z_max], np.float32),
        np.float32(sensor.missing),
        normal_table(),
        out,
    )
    return out


STRONGER = 5.0  # under this noise, our frontier agent loses about as much as those of the paper


def strong_gaussian_noise(
    views: np.ndarray, severity: float, key: Key, sensor: DepthSensor
) -> np.ndarray:
    """Add the noise of ``gaussian_noise`` with five times its standard deviation."""
    return gaussian_noise(views, STRONGER * severity, key, sensor)


CAMERAS = tuple(
    Record(
        name,
        "depth",
        partial(measured, name, profile),
        "2 s times the errors of the camera",
        label=label,
        source=source,
        episode=episode,
        frame="noise",
        version="1",
    )
    for name, profile, label, source, episode in (
        ("kinect_v1", KINECT_V1, "Kinect v1", "Nguyen 2012, Barron & Malik 2013", "-"),
        ("realsense_d435", REALSENSE_D435, "RealSense D435", "Grunnet-Jepsen 2018", "-"),
        ("realsense_l515", REALSENSE_L515, "RealSense L515", "datasheet", BIAS),
        ("azure_kinect", AZURE_KINECT, "Azure Kinect", "Tolgyessy 2021, datasheet", BIAS),
    )
)
RECORDS = (
    *CAMERAS,
    Record.of(
        "depth",
        strong_gaussian_noise,
        severity="5 times the noise of gaussian_noise",
        source="heuristic",
        episode="-",
        frame="noise",
        version="1",
    ),
)
