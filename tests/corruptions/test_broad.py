"""Tests of broad augmentation: a schedule's ``broad_share`` sets the fraction of frames that get
random compositions in training."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.corruptions import NAMES, DepthSensor, Key, Schedule, corrupt
from mitigate.corruptions.broad import depth, rgb
from mitigate.corruptions.broad.composition import stream
from mitigate.corruptions.registry import BROAD, modality, names, unseen_names, version
from tools.pages.gallery import primitives

KEYS = [Key(0, f"episode-{i}", 2) for i in range(60)]


@pytest.fixture(params=sorted(BROAD))
def name(request):
    return request.param


def frame_for(name, panorama):
    return panorama[0] if modality(name) == "rgb" else panorama[1]


def test_broad_is_in_no_suite_and_has_a_version(name):
    assert name not in names("rgb", "depth") + unseen_names("rgb", "depth")
    assert version(name) == {"version": BROAD[name].version}


def test_broad_keeps_shape_dtype_and_input(name, panorama):
    frame = frame_for(name, panorama)
    before = frame.copy()
    assert corrupt(frame, name, 0.0, key=KEYS[0]).tobytes() == frame.tobytes()
    for key in KEYS:
        output = corrupt(frame, name, 0.9, key=key)
        assert output.shape == frame.shape and output.dtype == frame.dtype
        assert np.isfinite(output[np.isfinite(frame)]).all()
    assert frame.tobytes() == before.tobytes()


def test_equal_keys_give_equal_pixels(name, panorama):
    frame = frame_for(name, panorama)
    output = [corrupt(frame, name, 0.8, key=key).tobytes() for key in KEYS]
    assert output == [corrupt(frame, name, 0.8, key=key).tobytes() for key in KEYS]
    assert len(set(output)) >= 50  # some primitives have only a few different results


def test_composition_is_constant_within_an_episode(panorama):
    """All frames of an episode have the same composition, so a composition without noise corrupts
    them in the same way."""
    remaining = [
        corrupt(panorama[0], "broad_rgb", 0.8, key=Key(0, f"e{i}", 0)).tobytes()
        == corrupt(panorama[0], "broad_rgb", 0.8, key=Key(0, f"e{i}", 1)).tobytes()
        for i in range(40)
    ]
    assert 5 < sum(remaining) < 35


def test_higher_severity_corrupts_more_on_average(name, panorama):
    frame = frame_for(name, panorama)
    valid = (frame > 0) & (frame < 100)

    def change(severity):
        output = [corrupt(frame, name, severity, key=key)[valid] for key in KEYS]
        return np.mean([np.abs(m - frame[valid].astype(np.float64)).mean() for m in output])

    assert change(0.2) < change(0.5) < change(1.0)


def test_draw_follows_its_composition(name, panorama, monkeypatch):
    called = []

    def noted(primitive):
        def change(*arguments):
            called.append(primitive.__name__.replace("_", " "))
            return primitive(*arguments)

        change.__name__ = primitive.__name__
        return change

    module = {"broad_rgb": rgb, "broad_depth": depth}[name]
    monkeypatch.setattr(module, "PRIMITIVES", tuple(map(noted, module.PRIMITIVES)))
    for key in KEYS[:20]:
        called.clear()
        corrupt(frame_for(name, panorama), name, 0.8, key=key)
        assert called == primitives(name, key) and called


@pytest.mark.parametrize("primitive", rgb.PRIMITIVES, ids=lambda p: p.__name__)
def test_rgb_primitive_changes_views_within_their_range(primitive):
    views = np.random.default_rng(0).random((3, 20, 28, 3), np.float32)
    output = [primitive(views.copy(), 0.8, stream(i), stream(100 + i)) for i in range(12)]
    assert all(m.shape == views.shape and m.min() >= 0 and m.max() <= 1 for m in output)
    assert sum(not np.array_equal(m, views) for m in output) >= 8


@pytest.mark.parametrize("primitive", depth.PRIMITIVES, ids=lambda p: p.__name__)
def test_depth_primitive_changes_views_that_have_holes(primitive):
    views = np.random.default_rng(0).uniform(0.05, 0.7, (3, 20, 28)).astype(np.float32)
    views[:, 3:5, 3:5] = np.nan
    output = [primitive(views.copy(), 0.8, stream(i), stream(100 + i)) for i in range(12)]
    assert all(m.shape == views.shape for m in output)
    assert sum(not np.array_equal(m, views, equal_nan=True) for m in output) >= 6


def test_depth_keeps_invalid_pixels_and_stays_in_range(panorama):
    sensor = DepthSensor(z_max=5.0, missing=7.0)
    frame = panorama[1].copy()
    frame[0, :4], frame[1, :2] = 0.0, np.nan
    for key in KEYS:
        output = corrupt(frame, "broad_depth", 1.0, key=key, sensor=sensor)
        valid = (frame > 0) & np.isfinite(frame)
        assert output[~valid].tobytes() == frame[~valid].tobytes()
        assert (((output[valid] > 0) & (output[valid] <= 5.0)) | (output[valid] == 7.0)).all()


@pytest.mark.parametrize("size", [(1, 1), (3, 5), (48, 31)])
def test_odd_and_tiny_frames_work(name, size):
    rng = np.random.default_rng(1)
    frame = rng.integers(0, 256, (2, *size, 3), np.uint8)
    if modality(name) == "depth":
        frame = rng.uniform(0.1, 9.0, (2, *size)).astype(np.float32)
    assert all(corrupt(frame, name, 1.0, key=key).shape == frame.shape for key in KEYS)


def test_schedule_draws_broad_for_its_share():
    schedule = Schedule("per_episode", 0.6, clean_share=0.25, broad_share=0.4)
    drawn = [schedule.draw(0, f"e{i}", 0)[0] for i in range(4000)]
    broad = [c for c in drawn if c.name in BROAD]
    assert abs(len(broad) / 4000 - 0.75 * 0.4) < 0.03
    assert abs(sum(c.name == "broad_rgb" for c in broad) / len(broad) - 8 / 12) < 0.05
    plain = Schedule("per_episode", 0.6, clean_share=0.25)
    same = [plain.draw(0, f"e{i}", 0)[0] for i in range(4000)]
    assert all(a == b for a, b in zip(drawn, same, strict=True) if a.name not in BROAD)


def test_schedule_without_a_share_draws_no_broad():
    schedule = Schedule("per_frame", 0.6)
    assert {schedule.draw(0, "e", i)[0].name for i in range(500)} <= {"clean", *NAMES}
    with pytest.raises(ValueError, match="broad_share must be in"):
        Schedule("per_frame", 0.6, broad_share=1.5)


def test_each_modality_has_one_broad():
    assert {f"broad_{modality}" for modality in ("rgb", "depth")} == set(BROAD)
