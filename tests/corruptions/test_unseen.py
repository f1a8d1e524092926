"""Tests that unseen corruptions follow the suite's rules, are split into two halves, and are not
used in training."""

from __future__ import annotations

import numpy as np
import pytest
import yaml
from omegaconf import OmegaConf

from mitigate.core import build, conf
from mitigate.corruptions import NAMES, Corruption, DepthSensor, Key, Record, Schedule, corrupt
from mitigate.corruptions.record import TEST, VALIDATION
from mitigate.corruptions.registry import record, table, unseen_names, version
from tools.pages.curves import SLIPS, curves
from tools.pages.descriptions import DESCRIPTIONS

KEY = Key(3, "episode-7", 4)
RGB, DEPTH = unseen_names("rgb"), unseen_names("depth")
UNSEEN_NAMES = RGB + DEPTH
LOSE = ("edge_shadow", "range_limit")  # these corruptions remove depth values, as missing_data does
TENTHS = np.linspace(0.0, 1.0, 11)
RECIPES = sorted(path.stem for path in (conf.CONF / "recipe").glob("*.yaml"))
SCHEDULES = sorted(path.stem for path in (conf.CONF / "schedule").glob("*.yaml"))


def frame_for(name, pair):
    return pair[0] if name in RGB else pair[1]


def same(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


# definition of the unseen corruptions ---------------------------------------------------------


def test_unseen_halves_are_separate_from_the_suite():
    assert len(RGB) >= 9 and len(DEPTH) >= 7 and not set(UNSEEN_NAMES) & set(NAMES)
    for modality in ("rgb", "depth"):
        halves = [unseen_names(modality, half=half) for half in (VALIDATION, TEST)]
        assert abs(len(halves[0]) - len(halves[1])) <= 2, "add corruptions to the other half"
        assert sorted(sum(halves, ())) == sorted(unseen_names(modality))


@pytest.mark.parametrize("name", UNSEEN_NAMES)
def test_record_is_described_in_the_docs(name):
    matches = record(name)
    assert matches.severity and matches.source and all(DESCRIPTIONS[name])
    assert matches.version and version(name) == {"version": matches.version}
    (line,) = (line for line in table().splitlines() if line.split()[0] == name)
    assert line.endswith({VALIDATION: "unseen_val", TEST: "unseen_test"}[matches.half])


def test_unknown_half_is_rejected():
    with pytest.raises(ValueError, match="no half of the unseen corruptions 'tset'"):
        unseen_names("rgb", half="tset")
    with pytest.raises(ValueError, match="'validation' or 'test'"):
        Record("fog", "rgb", lambda views, *_: views, "s", half="train")


@pytest.mark.slow
def test_unseen_corruptions_are_in_their_suites_only():
    def suite(name: str) -> list[str]:
        return list(conf.load_config("evaluate", [f"suite={name}"]).suite.conditions)

    assert suite("unseen") == ["clean", *UNSEEN_NAMES]
    assert suite("unseen_val") == ["clean", *unseen_names("rgb", "depth", half=VALIDATION)]
    assert suite("unseen_test") == ["clean", *unseen_names("rgb", "depth", half=TEST)]
    assert suite("unseen_rgb") == ["clean", *RGB] and suite("unseen_depth") == ["clean", *DEPTH]
    for path in (conf.CONF / "suite").glob("*.yaml"):
        if not path.stem.startswith("unseen"):
            assert not set(suite(path.stem)) & set(UNSEEN_NAMES), path


# no recipe trains on unseen corruptions -------------------------------------------------------


def schedules(node) -> list[dict]:
    """Return all schedules in a config, at any nesting level."""
    if isinstance(node, list):
        return [matches for value in node for matches in schedules(value)]
    if not isinstance(node, dict):
        return []
    own_value = [node] if str(node.get("_target_", "")).endswith(".Schedule") else []
    return own_value + [matches for value in node.values() for matches in schedules(value)]


def drawn(node: dict) -> set[str]:
    schedule = build.build(OmegaConf.create(node))
    matches = {schedule.draw(seed, "e", frame)[0].name for seed in range(40) for frame in range(10)}
    return matches | set(schedule.names)


@pytest.mark.slow
@pytest.mark.parametrize("option", [f"recipe={r}" for r in RECIPES])
def test_recipes_draw_no_unseen_corruption(option):
    cfg = OmegaConf.to_container(conf.load_config("train", [option]), resolve=True)
    matches = schedules(cfg)
    assert matches
    assert not set().union(*map(drawn, matches)) & set(UNSEEN_NAMES)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCHEDULES)
def test_schedules_draw_unseen_corruptions_only_by_name(name):
    options = [f"schedule={name}", "recipe=imitation"]
    loaded = schedules(OmegaConf.to_container(conf.load_config("train", options), resolve=True))
    assert not set().union(*map(drawn, loaded)) & set(UNSEEN_NAMES)
    named = conf.load_config("train", ["recipe=da_per_frame", "schedule.names=[haze,flare]"])
    loaded = schedules(OmegaConf.to_container(named, resolve=True))
    assert set().union(*map(drawn, loaded)) == {"clean", "haze", "flare"}


def test_configs_name_no_unseen_corruption():
    for path in conf.CONF.rglob("*.yaml"):
        words = str(yaml.safe_load(path.read_text(encoding="utf-8"))).replace("+", " ").split()
        content = {word.strip("'[]{},:") for word in words}
        assert not content & set(UNSEEN_NAMES), path


def test_python_schedule_draws_unseen_corruptions_only_by_name():
    assert Schedule("per_frame", 0.6).names == NAMES
    assert Schedule.always("haze", 0.6).draw(0, "e", 1)[0] == Corruption("haze", 0.6)


# the suite's rules ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", UNSEEN_NAMES)
def test_severity_zero_changes_no_bit_and_the_input_stays(name, panorama):
    frame = frame_for(name, panorama)
    before = frame.tobytes()
    assert same(corrupt(frame, name, 0.0, key=KEY), frame)
    for severity in (1e-9, 0.6, 1.0):
        out = corrupt(frame, name, severity, key=KEY, heading=0.3)
        assert frame.tobytes() == before and not np.shares_memory(out, frame)
        assert out.shape == frame.shape and out.dtype == frame.dtype
    assert not same(out, frame) or name == "glossy_floor"  # the generated scene has no floor


@pytest.mark.parametrize("name", RGB)
def test_psnr_never_rises_and_ssim_within_the_bound(name, scene):
    frame = scene.draw(64, 80)[0]
    for episode in "ab":
        seen = [corrupt(frame, name, s, key=Key(0, episode)) for s in TENTHS]
        signal = [min(200.0, scene.psnr(frame, x)) for x in seen]
        assert np.diff(signal).max() <= 1e-9 and signal[-1] < 26.0, signal
        likeness = [scene.ssim(frame, x) for x in seen]
        assert np.diff(likeness).max() <= 10 * SLIPS.get(name, 0.0) + 1e-6, likeness


@pytest.mark.parametrize("name", DEPTH)
def test_mean_absolute_depth_error_never_falls(name, scene):
    frame = room(64, 80) if name == "glossy_floor" else scene.draw(64, 80)[1]
    for episode in "ab":
        seen = [corrupt(frame, name, s, key=Key(0, episode)) for s in TENTHS]
        errors = [np.abs(x - frame).mean() for x in seen]
        assert np.diff(errors).min() >= -10 * SLIPS.get(name, 0.0) and errors[-1] > 0.03, errors


def test_strength_on_finer_grid_decreases_within_the_bound(scene):
    rgb, depth = scene.draw(40, 52)
    grid = np.linspace(0.5, 0.7, 21)
    matches = curves(rgb[None], depth[None, ..., None], grid, UNSEEN_NAMES)
    for name, curve in matches.items():
        assert curve.slip <= max(SLIPS.get(name, 0.0), 1e-6), (name, curve.slip)


@pytest.mark.parametrize("name", DEPTH)
@pytest.mark.parametrize("sensor", [DepthSensor(), DepthSensor(0.5, 5.0, missing=-1.0)])
def test_invalid_depth_is_kept_and_valid_depth_stays_valid(name, sensor, panorama):
    depth = panorama[1]
    valid = np.isfinite(depth) & (depth > 0)
    for severity in (0.1, 0.6, 1.0):
        out = corrupt(depth, name, severity, key=KEY, sensor=sensor)
        assert out[~valid].tobytes() == depth[~valid].tobytes()
        remaining = out[valid]
        remaining = remaining[remaining != sensor.missing] if name in LOSE else remaining
        assert ((remaining >= np.float32(1e-3)) & (remaining <= sensor.z_max)).all()
    nothing = np.array([[0.0, np.nan], [np.inf, -2.0]], np.float32)
    assert same(corrupt(nothing, name, 1.0, key=KEY), nothing)


@pytest.mark.parametrize("name", UNSEEN_NAMES)
def test_view_is_corrupted_by_its_place_only(name, panorama):
    frame = frame_for(name, panorama)[:4]
    whole = corrupt(frame, name, 0.6, key=KEY)
    assert same(corrupt(frame[:2], name, 0.6, key=KEY), whole[:2])
    alone = np.repeat(frame[3][None], 4, axis=0)
    assert same(corrupt(alone, name, 0.6, key=KEY)[3], whole[3])
    assert same(corrupt(frame[0], name, 0.6, key=KEY), whole[0])
    strided = np.repeat(frame, 2, axis=2)[:, :, ::2]
    assert same(corrupt(strided, name, 0.6, key=KEY), whole)


@pytest.mark.parametrize("name", UNSEEN_NAMES)
def test_draws_per_frame_match_the_record(name, panorama):
    frame, matches = frame_for(name, panorama), record(name)

    def seen(**changed):
        return corrupt(frame, name, 0.7, key=Key(**{**vars(KEY), **changed}))

    assert same(seen(), seen())
    assert same(seen(frame=5), seen()) == (matches.frame == "-")
    others = [seen(episode=str(n)) for n in range(4)]
    random = (matches.episode, matches.frame) != ("-", "-")
    assert any(not same(other, others[0]) for other in others) == random or name == "glossy_floor"


@pytest.mark.parametrize("name", UNSEEN_NAMES)
@pytest.mark.parametrize("size", [(1, 1), (1, 9), (7, 1), (5, 31)])
def test_odd_and_tiny_frames_work(name, size):
    frame = np.full((*size, 3), 90, np.uint8) if name in RGB else np.full(size, 3.0, np.float32)
    assert corrupt(frame, name, 0.9, key=KEY).shape == frame.shape


@pytest.mark.parametrize("name", ["haze", "scratches", "refraction", "rolling_shutter", "ghosting"])
def test_frame_and_half_size_copy_are_corrupted_alike(name):
    y, x = np.mgrid[:128, :160]
    smooth = np.stack([100 + 60 * np.sin(x / 40 + c) * np.cos(y / 30) for c in range(3)], -1)
    frame = np.rint(smooth).astype(np.uint8)
    half = np.rint(frame.reshape(64, 2, 80, 2, 3).mean((1, 3))).astype(np.uint8)
    full = corrupt(frame, name, 0.6, key=KEY).astype(float).reshape(64, 2, 80, 2, 3).mean((1, 3))
    small = corrupt(half, name, 0.6, key=KEY).astype(float)
    assert np.abs(full - small).mean() < 0.15 * np.abs(small - half).mean() + 0.6


# the effect of each corruption ----------------------------------------------------------------


def room(height: int, width: int, wall: float = 4.0, tall: float = 1.2) -> np.ndarray:
    """Return the depth [H, W] of a wall and a floor for a level camera ``tall`` metres high."""
    down = (np.arange(height) + 0.5 - 0.5 * height) / (0.5 * width)
    floor = np.where(down > 0, tall / np.maximum(down, 1e-6), np.inf)
    return np.repeat(np.minimum(floor, wall)[:, None], width, axis=1).astype(np.float32)


def test_haze_thins_contrast_towards_its_own_grey():
    black, white = np.zeros((1, 32, 32, 3), np.uint8), np.full((1, 32, 32, 3), 255, np.uint8)
    low, high = (corrupt(x, "haze", 0.6, key=KEY).astype(int) for x in (black, white))
    assert (high > low).all() and (high - low).mean() < 160


def test_grey_stays_grey_under_hue_and_not_under_light():
    grey = np.full((8, 8, 3), 120, np.uint8)
    assert same(corrupt(grey, "hue_shift", 0.7, key=KEY), grey)
    assert np.ptp(corrupt(grey, "white_balance", 0.7, key=KEY)[0, 0].astype(int)) > 20


def test_overexposure_clips_and_keeps_black():
    ramp = np.tile(np.arange(256, dtype=np.uint8)[None, :, None], (4, 1, 3))
    out = corrupt(ramp, "overexposure", 0.6, key=KEY)
    assert (out[:, 0] == 0).all() and (out[:, 200:] == 255).all() and (out >= ramp).all()


def test_flat_blocks_come_out_of_compression_as_they_were():
    frame = np.repeat(np.repeat(np.arange(4, dtype=np.uint8) * 60, 8)[None, :], 32, axis=0)
    frame = np.repeat(frame[..., None], 3, axis=2)
    assert np.abs(corrupt(frame, "compression", 1.0, key=KEY).astype(int) - frame).max() <= 1


def test_impulses_and_slices_are_nested_in_severity(panorama):
    for name in ("impulse_noise", "lost_slices"):
        mild, strong = (corrupt(panorama[0], name, s, key=KEY) for s in (0.3, 0.8))
        struck = (mild != panorama[0]).any(-1)
        assert (strong[struck] == mild[struck]).all()
    share = (corrupt(panorama[0], "impulse_noise", 1.0, key=KEY) != panorama[0]).any(-1).mean()
    assert share == pytest.approx(0.3, abs=0.02)


def test_ghost_is_the_shifted_picture():
    frame = np.zeros((32, 64, 3), np.uint8)
    frame[12:20, 24:40] = 200
    out = corrupt(frame, "ghosting", 1.0, key=KEY)
    assert sorted(np.unique(out)) == [0, 100, 200]


def test_shadow_lies_on_one_side_of_the_near_surface():
    depth = np.full((16, 64), 4.0, np.float32)
    depth[:, 24:40] = 1.5
    out = corrupt(depth, "edge_shadow", 0.6, key=KEY)
    lost = np.flatnonzero(out[8] == 0)
    assert len(lost) and (np.diff(lost) == 1).all() and (depth[8, lost] == 4.0).all()
    assert lost[-1] == 23 or lost[0] == 40


def test_near_surface_grows_and_flying_pixels_lie_between():
    depth = np.full((40, 40), 4.0, np.float32)
    depth[:, 20:] = 1.5
    grown = corrupt(depth, "fattening", 1.0, key=KEY)
    assert (grown <= depth).all() and (grown[:, 17:] == 1.5).all() and (grown[:, :16] == 4.0).all()
    flying = corrupt(depth, "flying_pixels", 1.0, key=KEY)
    assert ((flying >= 1.5) & (flying <= 4.0)).all() and (flying[:, :18] == 4.0).all()
    assert ((flying > 1.6) & (flying < 3.9)).any()


def test_glossy_floor_reads_the_room_depth_and_walls_stay():
    depth = room(48, 64)
    out = corrupt(depth, "glossy_floor", 1.0, key=KEY)
    floor = depth < 4.0
    assert (out[floor] > depth[floor]).all() and (out[floor] <= 4.0).all()
    assert same(out[~floor], depth[~floor])


def test_out_of_range_or_shadow_reads_the_sentinel():
    depth = np.array([[0.5, 2.0, 4.0, 9.0]], np.float32)
    out = corrupt(depth, "range_limit", 0.5, key=KEY, sensor=DepthSensor(missing=10.0))
    assert out.tolist() == [[0.5, 2.0, 10.0, 10.0]]
