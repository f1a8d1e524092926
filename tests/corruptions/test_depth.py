"""Tests of the effect of each depth corruption in metres."""

import numpy as np
import pytest

from mitigate.corruptions import DepthSensor, Key, corrupt
from mitigate.corruptions.depth import echo_polynomial, echo_shift

WALL = np.full((12, 96, 128), 4.0, np.float32)


@pytest.mark.parametrize("metres", [0.7, 4.0])
@pytest.mark.parametrize("severity", [0.1, 0.6])
def test_noise_grows_with_the_square_of_depth(metres, severity):
    noise = corrupt(np.full_like(WALL, metres), "gaussian_noise", severity, key=Key(0, "a"))
    noise = noise - np.float32(metres)
    sigma = severity * (0.02 + 0.02 * metres**2)
    assert noise.std() == pytest.approx(sigma, rel=0.02)
    assert abs(noise.mean()) < 0.02 * sigma
    assert np.abs(noise).max() < 4.6 * sigma


@pytest.mark.parametrize("name", ["gaussian_noise", "ripple", "broad_depth"])
@pytest.mark.parametrize("metres", [11.0, 65.5, 3.4e38])
def test_depth_beyond_the_range_is_clipped_first(name, metres):
    near = np.full((4, 24, 32), 4.0, np.float32)
    far, end = near.copy(), near.copy()
    far[:, :8], end[:, :8] = metres, 10.0
    for episode in "abcdefgh":
        output = corrupt(far, name, 1.0, key=Key(0, episode))
        assert np.array_equal(output, corrupt(end, name, 1.0, key=Key(0, episode)))
    if name == "gaussian_noise":
        assert output[:, :8].min() > 1.0


def test_noise_is_new_for_every_frame_and_view():
    first = corrupt(WALL, "gaussian_noise", 0.5, key=Key(0, "a", 0)) - 4
    second = corrupt(WALL, "gaussian_noise", 0.5, key=Key(0, "a", 1)) - 4
    pairs = (first[0], first[1]), (first[0], second[0])
    for a, b in pairs:
        assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.03


@pytest.mark.parametrize("severity", [0.3, 0.6, 1.0])
def test_missing_data_has_its_shares_in_every_view(severity):
    out = corrupt(WALL, "missing_data", severity, key=Key(0, "a"))
    holes, far = (out == 0).mean((1, 2)), (out == 10).mean((1, 2))
    assert holes == pytest.approx(0.375 * severity, abs=0.02)
    assert far == pytest.approx(0.125 * severity, abs=0.015)
    assert ((out == 0) | (out == 10) | (out == 4)).all()


def test_holes_are_blobs_that_move_every_five_frames():
    frames = [corrupt(WALL[:2], "missing_data", 0.6, key=Key(0, "a", i)) for i in range(11)]
    groups = [frame.tobytes() for frame in frames]
    assert len(set(groups[:5])) == len(set(groups[5:10])) == 1 and len(set(groups)) == 3
    hole = frames[0][0] != 4
    assert (hole[:, 1:] != hole[:, :-1]).mean() < 0.3 * 2 * hole.mean() * (1 - hole.mean())
    views = frames[0] != 4
    assert (views[0] != views[1]).any()
    rolls = {np.sort(view.sum(0)).tobytes() for view in views}
    assert len(rolls) == 1  # all views show parts of the same random field of the episode


def test_sentinel_of_the_sensor_is_written():
    out = corrupt(
        WALL, "missing_data", 0.6, key=Key(0, "a"), sensor=DepthSensor(0.5, 5.0, missing=-1.0)
    )
    assert set(np.unique(out)) == {-1.0, 4.0, 5.0}


def corner():
    """Return depth with a box edge: 2 m on the left, 3 m on the right."""
    depth = np.full((100, 200), 3.0, np.float32)
    depth[:, :100] = 2.0
    return depth


def test_multipath_overestimates_beside_a_farther_surface_only():
    depth = corner()
    out = corrupt(depth, "multipath", 0.6, key=Key(0, "a"))
    beta, scale = 0.9 * 0.6, 299792458 / (4 * np.pi * 20e6)
    phase = 1.0 / scale
    expected = scale * np.arctan2(beta * np.sin(phase), 1 + beta * np.cos(phase))
    # the range is 0.03 * 100 = 3 px
    assert (out[:, 97:100] - 2.0) == pytest.approx(expected, abs=1e-4)
    assert (out[:, :97] == 2.0).all() and (out[:, 100:] == 3.0).all()
    assert 0.2 < expected < 1.0


def test_echo_is_never_beyond_the_farther_surface(scene):
    gaps = np.linspace(0, 2.5, 500)
    assert (echo_shift(gaps, 1.0) <= gaps + 1e-9).all()
    depth = scene.draw(96, 128)[1]
    out = corrupt(depth, "multipath", 1.0, key=Key(0, "a"))
    assert (out >= depth).all() and out.max() <= depth.max() + 1e-5


@pytest.mark.parametrize("severity", [1e-3, 0.1, 0.6, 1.0])
def test_echo_polynomial_matches_the_phasor_sum(severity):
    gaps = np.linspace(0, 2.5, 5001)
    coefficients = echo_polynomial(severity)
    assert coefficients.dtype == np.float32
    fitted = gaps * np.polynomial.polynomial.polyval(gaps, coefficients.astype(float))
    assert np.abs(fitted - echo_shift(gaps, severity)).max() < 1e-5


@pytest.mark.parametrize("hole", [0.0, np.nan, np.inf, -3.0])
def test_invalid_neighbours_cast_no_echo(hole):
    depth = np.full((60, 60), 2.0, np.float32)
    depth[30, 30] = hole
    out = corrupt(depth, "multipath", 1.0, key=Key(0, "a"))
    assert out.tobytes() == depth.tobytes()


def test_echo_window_matches_a_plain_dilation(scene):
    depth = scene.draw(77, 90)[1]
    reach = round(0.03 * 77)
    padded = np.pad(depth, reach)
    side = 2 * reach + 1
    windows = np.lib.stride_tricks.sliding_window_view(padded, (side, side))
    gap = np.clip(windows.max((2, 3)) - depth, 0, 2.5)
    scale = 299792458 / (4 * np.pi * 20e6)
    phase, beta = gap / scale, 0.9 * 0.7
    expected = depth + scale * np.arctan2(beta * np.sin(phase), 1 + beta * np.cos(phase))
    assert corrupt(depth, "multipath", 0.7, key=Key(0, "a")) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("severity", [0.2, 0.6, 1.0])
def test_quantization_rounds_to_its_step(severity):
    depth = np.linspace(0.01, 10, 5000, dtype=np.float32).reshape(50, 100)
    step = 0.5 * severity
    out = corrupt(depth, "quantization", severity, key=Key(0, "a"))
    expected = np.clip(np.rint(depth / step) * step, 1e-3, 10)
    assert out == pytest.approx(expected, abs=1e-5)
    assert len(np.unique(out)) <= 10 / step + 2


@pytest.mark.parametrize("name", ["gaussian_noise", "missing_data", "multipath", "quantization"])
def test_valid_depth_is_clipped_to_the_sensor_range(name):
    depth = np.array([[1e-5, 4.9, 7.0]] * 20, np.float32)
    out = corrupt(depth, name, 0.05, key=Key(0, "a"), sensor=DepthSensor(0.5, 5.0))
    assert out.max() <= 5.0 and out[out != 0].min() >= np.float32(1e-3)


@pytest.mark.parametrize("severity", [0.0, 0.6])
@pytest.mark.parametrize("name", ["gaussian_noise", "missing_data", "multipath", "quantization"])
def test_millimetres_are_refused(name, severity):
    depth = np.full((48, 64), 2500, np.float32)
    depth[:3] = np.array([0.0, np.nan, np.inf, -1.0] * 16, np.float32)
    with pytest.raises(ValueError, match=r"z_max of 10 m \(median 2500\).*millimetres") as error:
        corrupt(depth, name, severity, key=1)
    assert "\n" not in str(error.value)
    corrupt(depth, name, severity, key=1, sensor=DepthSensor(z_max=3000.0))


def test_few_extreme_readings_do_not_change_the_unit():
    depth = np.full((48, 64), 2500, np.float32)
    depth[-3:] = 12.0  # one in sixteen
    for frame in (depth, depth[::-1]):
        with pytest.raises(ValueError, match="Depth must be in metres"):
            corrupt(frame, "multipath", 0.6, key=1)
    outdoors = np.full((48, 64), 1000.0, np.float32)
    outdoors[38:] = np.linspace(40.0, 2.0, 10, dtype=np.float32)[:, None]  # the ground
    assert (corrupt(outdoors, "multipath", 0.6, key=1)[:38] == 10.0).all()


@pytest.mark.parametrize("depth", [12.0, 0.0, np.nan, np.inf])
def test_far_wall_and_frame_without_readings_are_valid(depth):
    out = corrupt(np.full((8, 8), depth, np.float32), "multipath", 0.6, key=1)
    expected = np.full((8, 8), 10.0 if depth == 12.0 else depth)
    assert np.array_equal(out, expected, equal_nan=True)


@pytest.mark.parametrize(
    "ends", [(5.0, 0.5), (0.0, 0.0), (0.0, -5.0), (0.0, np.inf), (0.0, np.nan)]
)
def test_sensor_without_a_range_is_rejected(ends):
    with pytest.raises(ValueError, match="must be 0 <= z_min < z_max"):
        DepthSensor(*ends)


def test_normalised_sensor_is_converted_to_metres_and_back():
    sensor = DepthSensor(0.5, 5.0)
    unit = np.array([0.0, 0.2, 1.0], np.float32)
    assert sensor.to_metres(unit).tolist() == pytest.approx([0.0, 1.4, 5.0])
    assert sensor.from_metres(sensor.to_metres(unit)) == pytest.approx(unit)
    near = sensor.from_metres(np.array([0.0, sensor.z_min / 2, sensor.z_min]))
    assert near[0] == 0 and (near[1:] > 0).all()  # a valid pixel must not become a hole (0)
    assert sensor.to_metres(unit).dtype == np.float32
    invalid = sensor.from_metres(np.array([np.inf, np.nan, -1.0, 0.0], np.float32))
    assert (invalid == 0).all()


def test_half_size_depth_is_corrupted_alike(scene):
    full = scene.draw(256, 320)[1]
    half = full[::2, ::2]
    for name in ("missing_data", "multipath", "quantization", "gaussian_noise"):
        errors = [
            np.mean(
                [np.abs(corrupt(z, name, 0.6, key=Key(0, str(i))) - z).mean() for i in range(6)]
            )
            for z in (full, half)
        ]
        assert errors[0] == pytest.approx(errors[1], rel=0.15), name


def test_corrupt_names_the_depth_corruptions_for_depth_under_an_rgb_corruption():
    with pytest.raises(ValueError, match=r"spatter needs an RGB frame .* missing_data"):
        corrupt(np.ones((8, 8), np.float32), "spatter", 0.5, key=0)
