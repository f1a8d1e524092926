"""What every corruption promises."""

import warnings

import numpy as np
import pytest

from mitigate.corruptions import (
    CLEAN,
    DEPTH,
    NAMES,
    RGB,
    Corruption,
    Key,
    corrupt,
    corrupt_normalised,
    corrupt_observation,
)
from tools.pages.curves import SLIPS, curves

KEY = Key(3, "episode-7", 4)
STRENGTHS = np.linspace(0.0, 1.0, 11)


def frame_for(name, panorama):
    return panorama[0] if name in RGB else panorama[1]


def same(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def test_suite_has_eight_rgb_and_four_depth_corruptions():
    assert len(RGB) == 8 and len(DEPTH) == 4 and NAMES == RGB + DEPTH


@pytest.mark.parametrize("name", NAMES)
def test_severity_zero_returns_a_bit_exact_copy(name, panorama):
    frame = frame_for(name, panorama)
    out = corrupt(frame, name, 0.0, key=KEY)
    assert same(out, frame) and not np.shares_memory(out, frame) and out.flags.writeable


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("severity", [1e-9, 0.02, 0.6, 1.0])
def test_input_is_unchanged_and_output_has_its_shape(name, severity, panorama):
    frame = frame_for(name, panorama)
    before = frame.tobytes()
    out = corrupt(frame, name, severity, key=KEY, heading=0.3)
    assert frame.tobytes() == before and not np.shares_memory(out, frame)
    assert out.shape == frame.shape and out.dtype == frame.dtype


@pytest.mark.parametrize("name", NAMES)
def test_layouts_of_one_view_agree(name, panorama):
    frame = frame_for(name, panorama)[:1]
    out = corrupt(frame, name, 0.7, key=KEY)
    assert same(corrupt(frame[0], name, 0.7, key=KEY), out[0])
    if name in DEPTH:
        assert same(corrupt(frame[0, ..., 0], name, 0.7, key=KEY), out[0, ..., 0])
        assert same(corrupt(frame[..., 0], name, 0.7, key=KEY), out[..., 0])
    strided = np.repeat(frame, 2, axis=2)[:, :, ::2]
    assert same(corrupt(strided, name, 0.7, key=KEY), out)


@pytest.mark.parametrize("name", RGB)
@pytest.mark.parametrize("episode", ["a", "b", "c"])
def test_ssim_and_psnr_to_the_clean_frame_never_rise(name, episode, scene):
    frame = scene.draw(96, 128)[0]
    hurt = [corrupt(frame, name, s, key=Key(0, episode)) for s in STRENGTHS]
    likeness = [scene.ssim(frame, x) for x in hurt]
    signal = [min(200.0, scene.psnr(frame, x)) for x in hurt]
    assert np.diff(likeness).max() <= 1e-6, likeness
    assert np.diff(signal).max() <= 1e-9, signal
    assert likeness[-1] < 0.9 and signal[-1] < 30.0


@pytest.mark.parametrize("name", DEPTH)
@pytest.mark.parametrize("episode", ["a", "b", "c"])
def test_mean_absolute_depth_error_never_falls(name, episode, scene):
    frame = scene.draw(96, 128)[1]
    hurt = [corrupt(frame, name, s, key=Key(0, episode)) for s in STRENGTHS]
    errors = [np.abs(x - frame).mean() for x in hurt]
    assert np.diff(errors).min() >= 0.0 and errors[-1] > 0.05, errors


@pytest.mark.slow
@pytest.mark.parametrize("size", [(48, 64), (96, 96)])
def test_strength_on_fine_grid_decreases_within_the_bound(size, scene):
    matches = curves(scene.draw(*size)[0][None], scene.draw(*size)[1][None, ..., None])
    assert list(matches) == list(NAMES)
    for name, curve in matches.items():
        assert curve.slip <= max(SLIPS.get(name, 0.0), 1e-6), (name, curve.slip)


@pytest.mark.parametrize("name", DEPTH)
@pytest.mark.parametrize("severity", [0.1, 0.6, 1.0])
def test_invalid_depth_is_kept_and_valid_depth_stays_valid(name, severity, panorama):
    depth = panorama[1]
    invalid = ~(np.isfinite(depth) & (depth > 0))
    out = corrupt(depth, name, severity, key=KEY)
    assert out[invalid].tobytes() == depth[invalid].tobytes()
    remaining = out[~invalid]
    assert np.isfinite(remaining).all() and remaining.max() <= 10.0
    if name == "missing_data":
        remaining = remaining[remaining != 0]
    assert remaining.min() >= np.float32(1e-3)


@pytest.mark.parametrize("name", DEPTH)
def test_depth_without_any_valid_pixel_comes_back_unchanged(name):
    depth = np.array([[0.0, np.nan], [np.inf, -2.0]], np.float32)
    assert same(corrupt(depth, name, 1.0, key=KEY), depth)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("size", [(1, 1), (1, 9), (7, 1), (5, 31)])
def test_odd_and_tiny_frames_work(name, size):
    frame = np.full((*size, 3), 90, np.uint8) if name in RGB else np.full(size, 3.0, np.float32)
    assert corrupt(frame, name, 0.9, key=KEY).shape == frame.shape


BAD_SEVERITIES = [1.2, -0.1, float("nan"), float("inf"), "much", None, "0.5", True, False, np.True_]


@pytest.mark.parametrize("frame", [None, "photo.jpg"])
def test_frame_that_was_not_read_is_rejected(frame):
    with pytest.raises(ValueError, match=r"array of numbers, got \[.*cv2\.imread"):
        corrupt(frame, "spatter", 0.6, key=7)


@pytest.mark.parametrize("severity", BAD_SEVERITIES)
def test_severity_outside_zero_to_one_is_rejected(severity, panorama):
    with pytest.raises(ValueError, match="from 0 .clean. to 1"):
        corrupt(panorama[0], "flare", severity, key=KEY)
    with pytest.raises(ValueError, match="from 0 .clean. to 1"):
        Corruption("flare", severity)


def test_unknown_name_is_rejected_with_the_nearest(panorama):
    with pytest.raises(ValueError, match="mean motion_blur"):
        corrupt(panorama[0], "motionblur", 0.5, key=KEY)
    with pytest.raises(ValueError, match="Choose one of: clean, motion_blur"):
        Corruption("fog", 0.5)
    with pytest.raises(ValueError, match="must be 0, got"):
        Corruption("clean", 0.5)


def test_float_rgb_is_refused_with_the_conversion(panorama):
    with pytest.raises(ValueError, match=r"np.rint\(frame \* 255\).astype\(np.uint8\)"):
        corrupt(panorama[0] / np.float32(255), "flare", 0.5, key=KEY)


def test_wrong_depth_type_is_rejected_with_the_conversion(panorama):
    with pytest.raises(ValueError, match="divided by 1000"):
        corrupt(np.full((4, 4), 900, np.uint16), "multipath", 0.5, key=KEY)
    with pytest.raises(ValueError, match="astype"):
        corrupt(np.ones((4, 4)), "multipath", 0.5, key=KEY)


@pytest.mark.parametrize("shape", [(4, 4), (4, 4, 4), (2, 2, 4, 4, 3), (0, 4, 3)])
def test_wrong_rgb_shapes_are_refused(shape):
    with pytest.raises(ValueError, match="RGB frames must be"):
        corrupt(np.zeros(shape, np.uint8), "flare", 0.5, key=KEY)


@pytest.mark.parametrize("shape", [(4,), (2, 3, 4, 4), (2, 3, 4, 4, 1)])
def test_wrong_depth_shapes_are_refused(shape):
    with pytest.raises(ValueError, match="Depth must be"):
        corrupt(np.ones(shape, np.float32), "multipath", 0.5, key=KEY)


@pytest.mark.parametrize(
    "frame",
    [
        np.zeros((48, 64, 3), np.uint8),
        np.zeros((12, 48, 64, 3), np.float32),
        np.ones((36, 64, 3), np.float32),
    ],
    ids=["uint8", "panorama", "as 36 views"],
)
def test_rgb_for_depth_is_rejected_with_fitting_names(frame):
    message = (
        "gaussian_noise needs a depth frame.*RGB corruptions: .*low_light_noise.*impulse_noise"
    )
    with pytest.raises(ValueError, match=message):
        corrupt(frame, "gaussian_noise", 0.5, key=KEY)
    narrow = np.ones((4, 5, 3, 1), np.float32)
    assert corrupt(narrow, "gaussian_noise", 0.5, key=KEY).shape == narrow.shape


@pytest.mark.parametrize(
    "frame", [np.zeros((37, 4, 5, 3), np.uint8), np.ones((64, 4, 5), np.float32)], ids=["rgb", "z"]
)
def test_batch_is_not_a_panorama(frame):
    name = "spatter" if frame.dtype == np.uint8 else "missing_data"
    with pytest.raises(ValueError, match="at most 36 views.*share one mask.*one at a time"):
        corrupt(frame, name, 0.5, key=KEY)
    assert corrupt(frame[:36], name, 0.5, key=KEY).shape == frame[:36].shape


def test_several_views_without_a_heading_give_a_warning(panorama):
    with pytest.warns(UserWarning, match="one panorama of 12 views.*batch of unrelated images"):
        corrupt(panorama[0], "spatter", 0.6, key=KEY)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        corrupt(panorama[0], "spatter", 0.6, key=KEY, heading=0.0)
        corrupt(panorama[0][0], "spatter", 0.6, key=KEY)
        corrupt(panorama[1][0], "missing_data", 0.6, key=KEY)


def test_swapped_arguments_are_rejected(panorama):
    with pytest.raises(ValueError, match=r"must be a string, got ndarray.*frame, name, severity"):
        corrupt("spatter", panorama[0], 0.6, key=KEY)


@pytest.mark.parametrize("key", [None, 1.5, True, (0, "a")])
def test_invalid_key_is_rejected(panorama, key):
    with pytest.raises(ValueError, match="key must be a Key.*whole number.*text"):
        corrupt(panorama[0], "flare", 0.5, key=key)


def test_number_or_text_is_a_valid_key(panorama):
    def hurt(key):
        return corrupt(panorama[0][0], "spatter", 0.5, key=key)

    assert same(hurt(7), hurt(Key(7, "0"))) and same(hurt(np.int64(7)), hurt(7))
    assert same(hurt("kitchen"), hurt(Key(0, "kitchen")))
    assert not same(hurt(7), hurt(8)) and not same(hurt("7"), hurt(7))


@pytest.mark.parametrize(
    "heading", ["north", "", True, np.True_, float("nan"), [1.0, 2.0], [], {}], ids=str
)
@pytest.mark.parametrize("name", ["flare", "spatter", "multipath"])
def test_heading_that_is_not_finite_is_rejected(panorama, name, heading):
    with pytest.raises(ValueError, match="heading must be a finite number"):
        corrupt(frame_for(name, panorama), name, 0.5, key=KEY, heading=heading)


@pytest.mark.parametrize("hurt", [corrupt_observation, corrupt_normalised])
def test_observation_takes_a_short_key(panorama, hurt):
    obs = {"rgb": panorama[0]}
    output = hurt(obs, Corruption("spatter", 0.5), 7)["rgb"]
    assert same(output, corrupt(panorama[0], "spatter", 0.5, key=7))
    for wrong in ("spatter", ("spatter", 0.5), None):
        with pytest.raises(ValueError, match=r"Corruption\('spatter', 0.6\)"):
            hurt(obs, wrong, 7)


def test_observation_changes_in_its_modality_only(panorama):
    rgb, depth = panorama
    obs = {"rgb": rgb, "depth": depth, "pose": np.array([1.0, 2.0, 0.5], np.float32), "step": 3}
    for name in NAMES:
        corruption = Corruption(name, 1.0)
        out = corrupt_observation(obs, corruption, KEY)
        hurt, other = ("rgb", "depth") if corruption.modality == "rgb" else ("depth", "rgb")
        assert out is not obs and list(out) == list(obs) and out["step"] == 3
        assert out[other] is obs[other]
        assert same(out[hurt], corrupt(obs[hurt], name, 1.0, key=KEY, heading=0.5))
        assert not same(out[hurt], obs[hurt])
    clean = corrupt_observation(obs, CLEAN, KEY)
    assert clean is not obs and clean["rgb"] is rgb and CLEAN.modality == "none"


@pytest.mark.parametrize("pose", [np.zeros(2), np.zeros(7), np.zeros((1, 3)), 0.5], ids=str)
def test_pose_of_another_shape_is_rejected(panorama, pose):
    obs = {"rgb": panorama[0], "pose": pose}
    with pytest.raises(ValueError, match=r"must be \[3\] = \(x, y, heading\)"):
        corrupt_observation(obs, Corruption("flare", 0.6), KEY)


def test_observation_without_the_modality_is_rejected(panorama):
    with pytest.raises(ValueError, match="lacks"):
        corrupt_observation({"rgb": panorama[0]}, Corruption("multipath", 0.5), KEY)
