"""Tests of normalised depth: conversion, corruption, and unchanged values (bit for bit)."""

import numpy as np
import pytest

from mitigate.corruptions import DEPTH, Corruption, DepthSensor, Key, Schedule, corrupt
from mitigate.corruptions.normalised import corrupt_normalised

KEY = Key(1, "a", 2)
SENSORS = [DepthSensor(), DepthSensor(0.5, 5.0), DepthSensor(0.5, 5.0, missing=5.0)]


@pytest.fixture
def depth(scene):
    unit = (scene.draw(48, 64)[1] / 10.0).clip(0, 1)[..., None]
    unit[0, :5, 0] = 0.0, np.nan, np.inf, -np.inf, -0.25
    return unit


@pytest.mark.parametrize("sensor", SENSORS, ids=str)
@pytest.mark.parametrize("name", DEPTH)
@pytest.mark.parametrize("severity", [0.0, 0.6, 1.0])
def test_range_dtype_shape_and_invalid_pixels_stay(depth, name, severity, sensor):
    before = depth.tobytes()
    out = corrupt_normalised({"depth": depth}, Corruption(name, severity), KEY, sensor)["depth"]
    assert depth.tobytes() == before
    assert out.shape == depth.shape and out.dtype == np.float32
    assert out[0, :5].tobytes() == depth[0, :5].tobytes()
    valid = (depth > 0) & np.isfinite(depth)
    assert (out[valid] >= 0).all() and (out[valid] <= 1).all()
    if severity == 0.0:
        assert out.tobytes() == before
    else:
        assert (out[valid] != depth[valid]).any()
    if name != "missing_data":
        assert (out[valid] > 0).all()  # a value of 0 would mean missing depth


@pytest.mark.parametrize("name", DEPTH)
def test_normalised_depth_equals_the_metric_corruption(depth, name):
    sensor = DepthSensor(0.5, 5.0)
    out = corrupt_normalised({"depth": depth}, Corruption(name, 0.7), KEY, sensor)["depth"]
    valid = (depth > 0) & np.isfinite(depth)
    metres = np.where(valid, 0.5 + 4.5 * depth, 0).astype(np.float32)
    expected = corrupt(metres, name, 0.7, key=KEY, sensor=sensor)
    remaining = valid & (expected > 0.5)
    np.testing.assert_allclose(0.5 + 4.5 * out[remaining], expected[remaining], atol=1e-5)
    assert (out[valid & (expected == 0)] == 0).all()


def test_normalised_depth_uses_the_sensors_sentinel(depth):
    holes = {}
    for missing in (0.0, 10.0):
        sensor = DepthSensor(missing=missing)
        obs = corrupt_normalised({"depth": depth}, Corruption("missing_data", 1.0), KEY, sensor)
        holes[missing] = obs["depth"]
    lost = (holes[0.0] == 0) & (depth > 0)
    assert 0.2 < lost.mean() < 0.6 and (holes[10.0][lost] == 1).all()


def test_wrong_depth_and_sensors_are_refused(depth):
    hurt = Corruption("multipath", 0.5)
    with pytest.raises(ValueError, match="got 3.*in metres"):
        corrupt_normalised({"depth": np.full((4, 4), 3, np.float32)}, hurt, KEY)
    with pytest.raises(ValueError, match="must be float32 from 0 to 1, got float64"):
        corrupt_normalised({"depth": np.ones((4, 4))}, hurt, KEY)
    with pytest.raises(ValueError, match="For normalised depth"):
        corrupt_normalised({"depth": depth}, hurt, KEY, DepthSensor(missing=-1.0))
    with pytest.raises(ValueError, match="lacks"):
        corrupt_normalised({"rgb": np.zeros((4, 4, 3), np.uint8)}, hurt, KEY)


def test_schedule_of_one_corruption_always_draws_it():
    schedule = Schedule.always("spatter", 0.4)
    drawn = {schedule.draw(0, str(e), f)[0] for e in range(20) for f in range(3)}
    assert drawn == {Corruption("spatter", 0.4)}
    with pytest.raises(ValueError, match="Did you mean spatter"):
        Schedule.always("spater", 0.4)
