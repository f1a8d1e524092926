"""Tests of the effect of each RGB corruption on pixels, sizes and panoramas."""

import numpy as np
import pytest

from mitigate.corruptions import RGB, Key, corrupt, masks
from mitigate.corruptions import rgb as kernels
from mitigate.corruptions.keying import digest, uniform

WHITE = np.full((60, 80, 3), 255, np.uint8)
GREY = np.full((12, 48, 64, 3), 120, np.uint8)
TURN = np.radians(30.0)


def halved(frame):
    high, wide = frame.shape[0] // 2, frame.shape[1] // 2
    return np.rint(frame.reshape(high, 2, wide, 2, 3).mean((1, 3))).astype(np.uint8)


@pytest.mark.parametrize("name", [n for n in RGB if n != "low_light_noise"])
@pytest.mark.parametrize("episode", ["a", "b"])
def test_frame_and_half_size_copy_are_corrupted_alike(name, episode, scene):
    full = scene.draw(256, 320)[0]
    key = Key(0, episode)
    big = halved(corrupt(full, name, 0.6, key=key)).astype(int)
    small = corrupt(halved(full), name, 0.6, key=key).astype(int)
    effect = np.abs(small - halved(full)).mean()
    assert np.abs(big - small).mean() < max(0.12 * effect, 0.7)


def test_motion_blur_under_one_pixel_is_the_identity(scene):
    frame = scene.draw(40, 50)[0]
    assert (corrupt(frame, "motion_blur", 0.19, key=Key(0, "a")) == frame).all()
    assert (corrupt(frame, "motion_blur", 0.25, key=Key(0, "a")) != frame).any()


@pytest.mark.parametrize(
    "length, angle, step",
    [(1.3, 0.1, 1), (6.4, -0.17, 1), (12.0, 0.1, 2), (38.4, 0.05, 2), (192.0, -0.1, 2)],
)
def test_blur_line_has_its_length_and_angle(length, angle, step):
    dy, dx, weights = kernels.line_taps(length, angle, step)
    share = weights / weights.sum()
    assert len(weights) % 4 == 0
    assert (share @ dx, share @ dy) == pytest.approx((0, 0), abs=1e-9)
    spread = np.sqrt(12 * (share @ dx**2))
    assert spread == pytest.approx(length * np.cos(angle), rel=0.05, abs=0.6 * step)
    square = share @ dx**2
    assert (share @ (dx * dy)) == pytest.approx(np.tan(angle) * square, rel=0.02, abs=0.05)


@pytest.mark.parametrize("size", [(64, 64), (224, 224), (240, 640), (60, 2000)])
@pytest.mark.parametrize("severity", [0.6, 1.0])
def test_motion_blur_is_a_line_filter_to_half_a_level(size, severity, scene):
    import cv2

    frame = scene.draw(*size)[0]
    length, key = 0.10 * severity * size[1], Key(0, "a")
    angle = np.radians(10 * (2 * uniform(digest(key, "motion_blur")) - 1))
    half = 0.5 * length * np.cos(angle)
    reach = int(np.ceil(half)) + 1
    line = np.zeros((2 * reach + 1, 2 * reach + 1))
    for x in range(-reach, reach + 1):
        cover = max(0.0, min(x + 0.5, half) - max(x - 0.5, -half))
        y = x * np.tan(angle)
        low = int(np.floor(y))
        for row, share in ((low, 1 - (y - low)), (low + 1, y - low)):
            if share * cover > 0:
                line[reach + row, reach + x] += share * cover
    border = cv2.BORDER_REPLICATE
    blurred = cv2.filter2D(frame.astype(np.float64), -1, line / line.sum(), borderType=border)
    exact = (0.5 - 0.5 * severity) * frame + (0.5 + 0.5 * severity) * blurred
    out = corrupt(frame, "motion_blur", severity, key=key)
    assert np.abs(out - exact).mean() < 0.4  # rounding to grey levels alone gives 0.25
    assert abs((out - exact).mean()) < 0.1 and np.abs(out - exact).max() < 4


def test_motion_blur_keeps_half_of_a_point_at_small_severity():
    frame = np.zeros((101, 201, 3), np.uint8)
    frame[50, 100] = 200
    out = corrupt(frame, "motion_blur", 0.5, key=Key(0, "a"))
    assert out[50, 100, 0] == pytest.approx(200 * (0.25 + 0.75 / 10.05), abs=6)
    assert int(out.sum()) == pytest.approx(int(frame.sum()), rel=0.05)


@pytest.mark.parametrize("episode", ["a", "b", "c", "d"])
def test_low_light_leaves_the_stated_share_of_light(episode):
    out = corrupt(WHITE, "low_light", 0.5, key=Key(0, episode)) / 255
    low, high = 1 - 0.5 * 0.97, 1 - 0.5 * 0.60
    assert out.min() >= low - 0.003 and out.max() <= high + 0.003
    assert out.max() - out.min() > 0.1  # the darkening is a gradient and not uniform


def test_low_light_uses_ramps_and_lights():
    kinds = [uniform(digest(Key(0, str(i)), "low_light")) < 0.5 for i in range(40)]
    assert 8 < sum(kinds) < 32


@pytest.mark.parametrize("name", ["low_light", "spatter", "foreign_object"])
def test_views_of_a_panorama_share_lens_and_light(name):
    out = corrupt(GREY, name, 0.7, key=Key(0, "a"), heading=0.4)
    assert (out == out[:1]).all() and (out[0] != GREY[0]).any()


@pytest.mark.parametrize("name", ["motion_blur", "low_light", "spatter", "flare", "defocus"])
def test_episode_state_stays_over_frames_and_differs_between_episodes(name, scene):
    frame = scene.draw(60, 80)[0]
    first = corrupt(frame, name, 0.7, key=Key(0, "a", 0))
    assert (first == corrupt(frame, name, 0.7, key=Key(0, "a", 9))).all()
    assert (first != corrupt(frame, name, 0.7, key=Key(0, "b", 0))).any()
    assert (first != corrupt(frame, name, 0.7, key=Key(1, "a", 0))).any()


@pytest.mark.parametrize("severity", [0.2, 0.6, 1.0])
def test_spatter_covers_its_share_in_one_of_two_colours(severity):
    colours = set()
    for i in range(12):
        out = corrupt(WHITE, "spatter", severity, key=Key(0, str(i)))
        assert (out != 255).any(-1).mean() == pytest.approx(0.45 * severity, abs=0.03)
        colours.add(tuple(out.reshape(-1, 3)[out.sum(-1).argmin()]))
    if severity == 1.0:
        assert colours == {(63, 42, 20), (175, 238, 238)}


def flared(key, heading):
    out = corrupt(GREY, "flare", 0.8, key=key, heading=heading)
    return out, [k for k in range(12) if (out[k] != GREY[k]).any()]


@pytest.mark.parametrize("episode", ["a", "b", "c", "d", "e"])
def test_only_views_facing_the_light_flare(episode):
    for heading in np.linspace(-3, 7, 9):
        _, views = flared(Key(0, episode), heading)
        # the views are 90 degrees wide and 30 degrees apart, so three show the light
        assert len(views) == 3
        steps = {(b - a) % 12 for a, b in zip(views, views[1:], strict=False)}
        assert steps <= {1, 10}


def test_light_stays_in_the_world_when_the_agent_turns():
    key = Key(0, "a")
    before, _ = flared(key, 0.2)
    # if the agent turns left by one view, the scene moves one view to the right
    left, _ = flared(key, 0.2 + TURN)
    assert np.abs(np.roll(left, -1, axis=0).astype(int) - before).max() <= 1
    around, _ = flared(key, 0.2 + 2 * np.pi)
    assert np.abs(around.astype(int) - before).max() <= 1


def test_view_to_the_right_sees_the_light_further_left():
    centres = masks.flare_centres(digest(Key(0, "a"), "flare"), 12, 64, 64, 0.2)
    seen = [k for k in range(12) if centres[k] is not None]
    ordered = seen if seen[-1] - seen[0] == 2 else sorted(seen, key=lambda k: (k + 6) % 12)
    columns = [centres[k][0] for k in ordered]
    assert columns == sorted(columns, reverse=True)


def test_light_without_heading_is_in_its_drawn_view():
    for i in range(50):
        x, y = masks.flare_centres(digest(Key(0, str(i)), "flare"), 1, 50, 100, None)[0]
        assert 10 <= x <= 90 and 0 <= y <= 25


def test_flare_is_a_screen_blend_that_never_darkens(scene):
    frame = scene.draw(60, 80)[0]
    out = corrupt(frame, "flare", 1.0, key=Key(0, "a"))
    x, y = masks.flare_centres(digest(Key(0, "a"), "flare"), 1, 60, 80, None)[0]
    assert (out >= frame).all() and out[int(y), int(x), 0] == 255


@pytest.mark.parametrize("sigma", [0.2, 0.9, 2.3, 2.4, 3.0, 5.0, 6.4, 12.0])
def test_defocus_is_the_gaussian_blur_it_says(sigma, scene):
    import cv2

    frame = scene.draw(240, 320)[0]
    out = np.empty_like(frame)[None]
    kernels.blur.gaussian(frame[None], *kernels.gaussian_weights(sigma), out)
    border = cv2.BORDER_REPLICATE
    exact = cv2.GaussianBlur(frame.astype(np.float64), (0, 0), sigma, borderType=border)
    assert np.abs(out[0] - exact).mean() <= 0.3  # rounding to grey levels alone gives 0.25
    assert abs((out[0] - exact).mean()) < 0.03 and np.abs(out[0] - exact).max() < 2


@pytest.mark.parametrize("sigma", [2.4, 4.9, 9.8])
def test_defocus_is_a_gaussian_even_for_white_noise(sigma):
    import cv2

    frame = np.random.default_rng(0).integers(0, 256, (200, 200, 3), dtype=np.uint8)
    out = np.empty_like(frame)[None]
    kernels.blur.gaussian(frame[None], *kernels.gaussian_weights(sigma), out)
    border = cv2.BORDER_REPLICATE
    exact = cv2.GaussianBlur(frame.astype(np.float64), (0, 0), sigma, borderType=border)
    assert np.abs(out[0] - exact).mean() <= 0.5


@pytest.mark.parametrize("sigma", [0.15, 0.5, 1.0, 2.5, 8.0, 40.0])
@pytest.mark.parametrize("grey", [0, 1, 128, 255])
def test_defocus_leaves_a_plain_frame_as_it_is(sigma, grey):
    frame = np.full((1, 90, 70, 3), grey, np.uint8)
    out = np.empty_like(frame)
    kernels.blur.gaussian(frame, *kernels.gaussian_weights(sigma), out)
    assert (out == grey).all()


def test_foreign_object_is_a_centred_disk():
    out = corrupt(WHITE, "foreign_object", 0.5, key=Key(0, "a"))
    assert (out == 0).mean() == pytest.approx(np.pi * 15**2 / (60 * 80), rel=0.02)
    assert (out == out[::-1]).all() and (out == out[:, ::-1]).all()


def test_black_out_is_drawn_for_each_frame_and_view():
    dark = np.stack(
        [
            (corrupt(GREY, "black_out", 0.3, key=Key(0, "a", i)) == 0).all((1, 2, 3))
            for i in range(200)
        ]
    )
    assert dark.mean() == pytest.approx(0.3, abs=0.03)
    assert dark.mean(0).std() < 0.08 and dark.mean(1).std() < 0.2
    assert abs(np.corrcoef(dark[:, 0], dark[:, 1])[0, 1]) < 0.25
    assert (corrupt(GREY, "black_out", 1.0, key=Key(0, "a")) == 0).all()


@pytest.mark.parametrize("heading", [float("nan"), float("inf")])
def test_flare_rejects_heading_that_is_not_a_number(scene, heading):
    """With an invalid heading, the light would be outside all views, and the frame would stay
    clean."""
    rgb, _ = scene.draw(24, 32)
    with pytest.raises(ValueError, match="heading must be a finite number"):
        corrupt(rgb, "flare", 1.0, key=Key(0, "a"), heading=heading)
