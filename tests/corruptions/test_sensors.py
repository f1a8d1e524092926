"""Tests of the corruptions that model the depth errors of specific cameras."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core import conf
from mitigate.corruptions import DepthSensor, Key, corrupt, sensors

NAMES = tuple(record.name for record in sensors.CAMERAS)
KEY = Key(0, "episode", 3)
STEP = 9 / 351.3  # metres between two neighbouring depth values of a Kinect v1 at 3 m
# published standard deviation in metres at a depth of 3 m, and largest depth in metres
PUBLISHED = {
    "kinect_v1": (np.hypot(0.0012 + 0.0019 * 2.6**2, STEP / 12**0.5), 4.0),
    "realsense_d435": (9 * 0.08 / (424 * 0.05), 10.0),
    "realsense_l515": (0.0025 + 2 * 0.001625, 9.0),
    "azure_kinect": (0.017, 3.86),
}


def plane(metres: float, side: int = 160) -> np.ndarray:
    return np.full((1, side, side), metres, np.float32)


def test_suite_lists_every_camera():
    suite = conf.load_config("evaluate", ["suite=sensors"]).suite.conditions
    assert suite == ["clean", *NAMES] and set(NAMES) == set(PUBLISHED)


@pytest.mark.parametrize("name", NAMES)
def test_noise_has_the_published_size_at_half_severity(name):
    out = corrupt(plane(3.0), name, 0.5, key=KEY)
    assert out.std() == pytest.approx(PUBLISHED[name][0], rel=0.12)
    twice = corrupt(plane(3.0), name, 1.0, key=KEY)
    if (twice > 0).all():  # otherwise a depth of 3 m is beyond the range at this severity
        assert twice.std() == pytest.approx(2 * out.std(), rel=0.15)
    assert abs(out.mean() - 3.0) < 0.015, "the systematic error is at most 14 mm"


@pytest.mark.parametrize("name", NAMES)
def test_depth_beyond_the_range_has_no_reading(name):
    sensor = DepthSensor(0.0, 20.0, missing=-1.0)
    far = PUBLISHED[name][1]
    assert (corrupt(plane(1.5 * far), name, 0.5, key=KEY, sensor=sensor) == -1.0).all()
    assert (corrupt(plane(0.7 * far), name, 0.5, key=KEY, sensor=sensor) > 0).all()


@pytest.mark.parametrize("name", NAMES)
def test_invalid_pixels_stay_and_readings_stay_valid(name):
    depth = np.random.default_rng(0).uniform(0.01, 12, (3, 40, 50)).astype(np.float32)
    depth[:, ::7] = 0.0
    depth[:, :, ::11] = np.nan
    out = corrupt(depth, name, 0.8, key=KEY)
    invalid = ~(depth > 0)
    assert out[invalid].tobytes() == depth[invalid].tobytes()
    assert ((out[~invalid] >= 0) & (out[~invalid] <= 10)).all()


def test_kinect_rounds_disparity():
    out = corrupt(plane(3.5), "kinect_v1", 0.5, key=KEY)
    steps = 351.3 / np.unique(out).astype(np.float64)
    assert np.abs(steps - np.rint(steps)).max() < 1e-3
    gap = np.diff(np.unique(out)).min()
    assert gap == pytest.approx(3.5**2 / 351.3, rel=0.2)


def test_kinect_moves_the_edges_of_objects():
    depth = plane(3.0)
    depth[:, :, 80:] = 1.0
    out = corrupt(depth, "kinect_v1", 0.5, key=KEY)
    wrong = np.abs(out - depth) > 1.0
    assert wrong.any() and np.abs(np.nonzero(wrong)[2] - 79.5).max() < 4


def test_systematic_error_is_constant_in_an_episode():
    def error(episode: str, frame: int) -> float:
        depth = corrupt(plane(1.0), "azure_kinect", 1.0, key=Key(0, episode, frame))
        return float(depth.mean()) - 1.0

    assert error("a", 0) == pytest.approx(error("a", 5), abs=2e-3)
    assert abs(error("a", 0) - error("b", 0)) > 2e-3


def test_strong_noise_is_five_times_that_of_the_suite():
    noise = [
        corrupt(plane(3.0), name, 0.6, key=KEY) - 3.0
        for name in ("strong_gaussian_noise", "gaussian_noise")
    ]
    assert noise[0] == pytest.approx(5 * noise[1], abs=1e-5)
