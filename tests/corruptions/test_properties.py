"""Properties that hold for any frame, severity and key (hypothesis draws them)."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mitigate.corruptions import DEPTH, NAMES, DepthSensor, Key, corrupt
from mitigate.corruptions.depth import echo_shift
from mitigate.corruptions.registry import modality, unseen_names

SENSORS = (DepthSensor(), DepthSensor(0.5, 5.0, missing=-1.0))
names = st.sampled_from((*NAMES, *unseen_names("rgb", "depth")))
severities = st.floats(0.0, 1.0)
keys = st.builds(Key, st.integers(-(2**70), 2**70), st.text(max_size=8), st.integers(0, 10**9))
quick = settings(max_examples=40, deadline=None, derandomize=True)


@st.composite
def instants(draw, fewest=1):
    """RGB uint8 [V, H, W, 3] and depth float32 [V, H, W, 1] of any size, some readings invalid.

    (Depth [V, H, W] of width 1 would be read as one view [H, W, 1].)
    """
    shape = draw(st.integers(fewest, 5)), draw(st.integers(1, 23)), draw(st.integers(1, 23))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    rgb = rng.integers(0, 256, (*shape, 3), dtype=np.uint8)
    depth = rng.uniform(0.01, 12.0, shape).astype(np.float32)
    for value in (0.0, -1.0, np.nan, np.inf, -np.inf):
        depth[rng.random(shape) < 0.05] = value
    return rgb, depth[..., None]


def frame_of(name, instant):
    return instant[modality(name) != "rgb"]


def same(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


@quick
@given(names, instants(), keys)
def test_severity_zero_is_the_identity(name, instant, key):
    frame = frame_of(name, instant)
    assert same(corrupt(frame, name, 0.0, key=key), frame)


@quick
@given(names, instants(), severities, keys, st.none() | st.floats(-10, 10))
def test_input_dtype_shape_and_range_are_kept(name, instant, severity, key, heading):
    frame = frame_of(name, instant)
    before = frame.copy()
    out = corrupt(frame, name, severity, key=key, heading=heading)
    assert same(frame, before) and not np.shares_memory(out, frame)
    assert out.dtype == frame.dtype and out.shape == frame.shape
    if name in DEPTH and severity > 0:
        valid = np.isfinite(frame) & (frame > 0)
        assert ((out[valid] >= 0) & (out[valid] <= 10.0)).all()


@quick
@given(st.sampled_from(DEPTH), instants(), severities, keys, st.sampled_from(SENSORS))
def test_invalid_depth_comes_back_bit_for_bit(name, instant, severity, key, sensor):
    frame = instant[1]
    out = corrupt(frame, name, severity, key=key, sensor=sensor)
    invalid = ~(np.isfinite(frame) & (frame > 0))
    assert out[invalid].tobytes() == frame[invalid].tobytes()
    if name != "missing_data":
        assert ((out > 0) & np.isfinite(out))[~invalid].all()


@quick
@given(names, instants(fewest=2), severities, keys, st.data())
def test_batch_of_any_size_gives_the_same_pixels(name, instant, severity, key, data):
    frame = frame_of(name, instant)
    whole = corrupt(frame, name, severity, key=key, heading=0.4)
    size = data.draw(st.integers(1, len(frame)))
    assert same(corrupt(frame[:size], name, severity, key=key, heading=0.4), whole[:size])
    backwards = frame[::-1][:, :, ::-1].copy()[:, :, ::-1][::-1]  # the same pixels, other strides
    assert same(corrupt(backwards, name, severity, key=key, heading=0.4), whole)


@quick
@given(st.sampled_from(sorted({*NAMES} - {"flare"})), instants(), severities, keys, st.data())
def test_view_is_corrupted_by_its_place_only(name, instant, severity, key, data):
    frame = frame_of(name, instant)
    view = data.draw(st.integers(0, len(frame) - 1))
    alone = np.repeat(frame[view][None], len(frame), axis=0)
    out = corrupt(frame, name, severity, key=key)
    assert same(corrupt(alone, name, severity, key=key)[view], out[view])


@quick
@given(names, instants(), severities, keys)
def test_torch_tensor_as_numpy_gives_the_same_pixels(name, instant, severity, key):
    frame = frame_of(name, instant)
    tensor = torch.from_numpy(frame.copy())
    out = corrupt(frame, name, severity, key=key)
    assert same(corrupt(tensor.numpy(), name, severity, key=key), out)
    assert same(corrupt(tensor, name, severity, key=key), out)  # through the array protocol


@quick
@given(st.floats(0.01, 1.0), st.floats(0.5, 4.0), st.floats(0.0, 3.5), st.integers(20, 90))
def test_multipath_on_a_corner_is_the_closed_form(severity, near, gap, side):
    depth = np.full((side, 2 * side), near + gap, np.float32)
    depth[:, :side] = near
    out = corrupt(depth, "multipath", severity, key=Key(0, "a"))
    reach = max(1, round(0.03 * side))
    shift = echo_shift(np.array(min(gap, 2.5)), severity)
    assert out[:, side - reach : side] - near == pytest.approx(max(shift, 0), abs=1e-4)
    assert (out[:, : side - reach] == depth[:, : side - reach]).all()
    assert (out[:, side:] == depth[:, side:]).all()


@settings(quick, max_examples=10)
@given(st.floats(0.05, 1.0), keys, st.integers(8, 12))
def test_masks_of_frame_and_half_size_copy_are_alike(severity, key, side):
    white = np.full((32 * side, 40 * side, 3), 255, np.uint8)
    for name in ("low_light", "spatter", "foreign_object", "flare"):
        full = corrupt(white // 2, name, severity, key=key).astype(float)
        half = corrupt(white[::2, ::2] // 2, name, severity, key=key).astype(float)
        pooled = full.reshape(16 * side, 2, 20 * side, 2, 3).mean((1, 3))
        effect = np.abs(half - 127.0).mean()
        assert np.abs(pooled - half).mean() < 0.6 + 0.12 * effect, name
