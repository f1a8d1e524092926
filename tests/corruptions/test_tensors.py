"""Tests that corruptions of torch tensors equal the corruptions of numpy arrays."""

from __future__ import annotations

import subprocess
import sys
import warnings

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mitigate.corruptions import (
    CLEAN,
    NAMES,
    Corruption,
    DepthSensor,
    Key,
    corrupt,
    corrupt_normalised,
    corrupt_observation,
)
from mitigate.corruptions.keying import digest, field, normals, scramble, top_share
from mitigate.corruptions.registry import modality, unseen_names
from mitigate.corruptions.tensors import FUNCTIONS, corrupt_observations, corrupt_tensors, draws
from mitigate.corruptions.tensors import suite as tensor_suite

# maximum difference at which two pixels count as equal: grey levels, and metres
GREY, METRES = 1, 1e-4
DIFFERENT = 0.001  # maximum fraction of pixels whose difference is above GREY or METRES
SHAPES = ((2, 33, 47), (1, 64, 48), (3, 21, 90))  # views, height, width
SENSOR = DepthSensor(0.5, 5.0, missing=-1.0)
ROWS = (  # severity, key and heading of each row of a batch
    (0.6, Key(0, "kitchen", 3), None),
    (1.0, Key(7, "hall", 12), 0.4),
    (0.0, Key(7, "hall", 13), 0.4),
    (0.07, Key(-3, "7", 0), -2.0),
)


def batch_of(name: str, scene, shape: tuple[int, int, int], rows: int = len(ROWS)) -> torch.Tensor:
    """Return a batch of rendered frames with invalid depth."""
    views, height, width = shape
    drawn = [
        [scene.draw(height, width, rows * view + row) for view in range(views)]
        for row in range(rows)
    ]
    if modality(name) == "rgb":
        return torch.from_numpy(np.array([[rgb for rgb, _ in views] for views in drawn]))
    depth = np.array([[depth for _, depth in views] for views in drawn])[..., None]
    depth[:, :, :2, :5] = 0.0
    depth[:, 0, 9, 10:14, 0] = np.nan, np.inf, -np.inf, -1.0
    return torch.from_numpy(depth)


def different(actual: np.ndarray, expected: np.ndarray) -> int:
    """Return the number of pixels whose difference is above GREY or METRES."""
    assert actual.dtype == expected.dtype and actual.shape == expected.shape
    if actual.dtype == np.uint8:
        return int((np.abs(actual.astype(int) - expected) > GREY).any(-1).sum())
    both_invalid = ~np.isfinite(expected) & (actual.view(np.int32) == expected.view(np.int32))
    with np.errstate(invalid="ignore"):
        return int((~both_invalid & ~(np.abs(actual - expected) <= METRES)).sum())


def check_equal(name: str, frames: torch.Tensor, rows=ROWS, sensor=SENSOR, device="cpu") -> None:
    severities, keys, headings = zip(*rows, strict=True)
    clean = frames.to(device, copy=True)
    out = corrupt_tensors(
        clean, name, severities, keys=keys, headings=headings, sensor=sensor, backend="torch"
    )
    assert out.dtype == frames.dtype and out.shape == frames.shape and out.device == clean.device
    assert torch.equal(clean.cpu().nan_to_num(), frames.nan_to_num()), "the input was modified"
    out = out.cpu()
    wrong = 0
    for row, (severity, key, heading) in enumerate(rows):
        expected = corrupt(
            frames[row].numpy(), name, severity, key=key, heading=heading, sensor=sensor
        )
        wrong += different(out[row].numpy(), expected)
    assert wrong <= DIFFERENT * out[..., 0].numel(), f"{wrong} of {out[..., 0].numel()} pixels"


def test_every_corruption_has_a_tensor_function():
    assert {*FUNCTIONS} == {*NAMES, *unseen_names("rgb", "depth")}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_torch_equals_numpy(name, scene):
    for shape in SHAPES:
        check_equal(name, batch_of(name, scene, shape))


@st.composite
def batches(draw):
    """Generate a corruption, frames (random pixels or a scene), and the severity, key and heading
    of each row."""
    name = draw(st.sampled_from(sorted(FUNCTIONS)))
    shape = draw(st.integers(1, 4)), draw(st.integers(1, 70)), draw(st.integers(1, 70))
    keys = st.builds(Key, st.integers(-(2**70), 2**70), st.text(max_size=8), st.integers(0, 10**9))
    row = st.tuples(st.floats(0.0, 1.0), keys, st.none() | st.floats(-10, 10))
    rows = draw(st.lists(row, min_size=1, max_size=3))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    if modality(name) == "rgb":
        frames = rng.integers(0, 256, (len(rows), *shape, 3), dtype=np.uint8)
    else:
        frames = rng.uniform(0.01, 12.0, (len(rows), *shape, 1)).astype(np.float32)
        for value in (0.0, -1.0, np.nan, np.inf, -np.inf):
            frames[rng.random(frames.shape) < 0.05] = value
    return name, torch.from_numpy(frames), rows, draw(st.sampled_from((SENSOR, DepthSensor())))


@settings(max_examples=15, deadline=None, derandomize=True)
@given(batches())
def test_torch_equals_numpy_for_random_frames(batch):
    check_equal(*batch)


@pytest.mark.slow
@settings(max_examples=500, deadline=None, derandomize=True)
@given(batches())
def test_torch_equals_numpy_for_many_random_frames(batch):
    check_equal(*batch)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [(1, 480, 640), (12, 224, 224), (2, 127, 251)], ids=str)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_torch_equals_numpy_at_camera_sizes(name, shape, scene):
    rows = [(s, Key(1, str(s), 4), 0.3) for s in (0.2, 0.6, 1.0)]
    check_equal(name, batch_of(name, scene, shape, len(rows)), rows)


def test_words_equal_the_stream_of_keying():
    values = [0, 5, 2**63, 2**64 - 1]
    streams = draws.on_device(np.array(values, np.uint64), torch.zeros(0), 1)
    words = draws.mix(streams, torch.arange(5)).numpy().view(np.uint64)
    assert words.tolist() == [[scramble(v, counter) for counter in range(5)] for v in values]
    words = draws.mix(streams, torch.arange(3))
    for value, row in zip(values, draws.normals(words, 10), strict=True):
        assert np.array_equal(row.numpy(), normals(value, 10))


@pytest.mark.parametrize("size", [(48, 64), (33, 20), (7, 300)])
def test_fields_equal_the_field_of_keying(size):
    values, shares = [3, 2**64 - 9], [0.3, 0.0]
    smooth, cells = draws.fields(values, *size, 0.05, torch.zeros(0))
    levels = draws.levels(cells, shares)
    for row, (value, share) in enumerate(zip(values, shares, strict=True)):
        expected, expected_cells = field(value, *size, 0.05)
        assert np.abs(smooth[row].numpy() - expected).max() < 1e-5
        assert float(levels[row]) == pytest.approx(top_share(expected_cells, share), abs=1e-5)


@pytest.mark.parametrize("name", ["spatter", "gaussian_noise", "compression"])
def test_numpy_backend_gives_the_same_bits(name, scene):
    frames = batch_of(name, scene, SHAPES[0])
    severities, keys, headings = zip(*ROWS, strict=True)
    for backend in (None, "numpy"):
        out = corrupt_tensors(
            frames, name, torch.tensor(severities), keys=keys, headings=headings, backend=backend
        )
        for row, key in enumerate(keys):
            severity = float(torch.tensor(severities)[row])
            expected = corrupt(frames[row].numpy(), name, severity, key=key, heading=headings[row])
            assert out[row].numpy().tobytes() == expected.tobytes()


def test_corruption_without_a_function_runs_on_the_host_with_one_warning(scene):
    tensor_suite._warn_host.cache_clear()
    frames = batch_of("broad_rgb", scene, SHAPES[0])
    keys = [key for _, key, _ in ROWS]
    with pytest.warns(UserWarning, match="'broad_rgb' has no torch function"):
        out = corrupt_tensors(frames, "broad_rgb", 0.7, keys=keys, backend="torch")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        corrupt_tensors(frames, "broad_rgb", 0.7, keys=keys, backend="torch")
    for row, key in enumerate(keys):
        assert np.array_equal(out[row], corrupt(frames[row].numpy(), "broad_rgb", 0.7, key=key))


@pytest.mark.parametrize("name", ["low_light_noise", "missing_data"])
def test_rows_do_not_depend_on_the_batch(name, scene, monkeypatch):
    frames = batch_of(name, scene, SHAPES[0])
    keys = [key for _, key, _ in ROWS]
    whole = corrupt_tensors(frames, name, 0.5, keys=keys, backend="torch")
    monkeypatch.setattr(tensor_suite, "MAX_PIXELS", 1)  # one row per pass
    strided = frames.transpose(2, 3).contiguous().transpose(2, 3)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        apart = corrupt_tensors(strided, name, 0.5, keys=keys, backend="torch")
    assert torch.equal(whole.nan_to_num(), apart.nan_to_num())


def observations(scene) -> dict[str, torch.Tensor]:
    return {
        "rgb": batch_of("spatter", scene, SHAPES[0]),
        "depth": batch_of("quantization", scene, SHAPES[0]),
    }


CORRUPTIONS = (
    Corruption("spatter", 0.8),
    CLEAN,
    Corruption("multipath+low_light", 0.6),
    Corruption("missing_data", 0.9),
)


@pytest.mark.parametrize("backend", ["numpy", "torch"])
@pytest.mark.parametrize("normalised", [False, True])
def test_corrupt_observations_equals_the_suite_per_row(backend, normalised, scene):
    frames = observations(scene)
    if normalised:
        frames["depth"] = (frames["depth"] / 8.0).clamp(max=1.0)
    headings = [heading for _, _, heading in ROWS]
    out = corrupt_observations(
        frames,
        CORRUPTIONS,
        [key for _, key, _ in ROWS],
        headings=headings,
        normalised=normalised,
        backend=backend,
    )
    single = corrupt_normalised if normalised else corrupt_observation
    for row, (_, key, heading) in enumerate(ROWS):
        instant = {name: views[row].numpy() for name, views in frames.items()}
        pose = {} if heading is None else {"pose": np.array([0.0, 0.0, heading])}
        expected = single({**instant, **pose}, CORRUPTIONS[row], key)
        for name in frames:
            actual = out[name][row].numpy()
            if backend == "numpy":
                assert actual.tobytes() == expected[name].tobytes()
            else:
                assert different(actual, expected[name]) <= DIFFERENT * actual[..., 0].size


def test_corrupt_observations_returns_uncorrupted_entries(scene):
    frames = observations(scene)
    keys = [key for _, key, _ in ROWS]
    out = corrupt_observations(frames, [CLEAN] * 3 + [Corruption("formal", 1.0)], keys)
    assert all(out[name] is frames[name] for name in frames)
    with pytest.raises(ValueError, match="needs the entry 'depth'"):
        corrupt_observations({"rgb": frames["rgb"]}, CORRUPTIONS, keys)
    with pytest.raises(ValueError, match="Normalised depth must be between 0 and 1"):
        corrupt_observations(frames, CORRUPTIONS, keys, normalised=True)
    with pytest.raises(ValueError, match=r"one corruption, key and heading per row.*4 .*3 keys"):
        corrupt_observations(frames, CORRUPTIONS, keys[:3])


RGB = torch.zeros(2, 1, 8, 9, 3, dtype=torch.uint8)
DEPTH = torch.ones(2, 1, 8, 9, 1)


@pytest.mark.parametrize(
    ("frames", "name", "options", "part"),
    [
        (RGB, "flur", {}, "flare"),
        (RGB, "frozen_frame", {}, "got the temporal fault.*FrameStream"),
        (RGB.float(), "spatter", {}, r"must be torch.uint8.*\* 255"),
        (DEPTH.double(), "multipath", {}, "must be torch.float32.*divided by 1000"),
        (RGB[:, 0], "spatter", {}, r"\[rows, views, H, W, 3\].*frames\[:, None\]"),
        (RGB, "multipath", {}, r"\[rows, views, H, W, 1\]"),
        (RGB.expand(2, 37, 8, 9, 3), "spatter", {}, "at most 36 views"),
        (RGB.numpy(), "spatter", {}, "must be a torch tensor, got ndarray"),
        (DEPTH * 3000.0, "multipath", {}, "Depth must be in metres"),
        (RGB, "spatter", {"keys": [1]}, "keys must have one entry per row"),
        (RGB, "spatter", {"keys": "ab"}, "keys must have one entry per row"),
        (RGB, "spatter", {"severity": [0.1, 1.2]}, "Severity must be a number from 0"),
        (RGB, "spatter", {"severity": [0.1]}, "severity must have one entry per row"),
        (RGB, "flare", {"headings": [0.1, float("nan")]}, "heading must be a finite number"),
        (RGB, "spatter", {"backend": "cuda"}, "numpy, torch"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_corrupt_tensors_explains_invalid_input(frames, name, options, part):
    arguments = {"severity": 0.5, "keys": [1, 2], "backend": "torch", **options}
    with pytest.raises(ValueError, match=part):
        corrupt_tensors(frames, name, **arguments)


def test_corrupt_tensors_accepts_an_empty_batch():
    for backend in ("numpy", "torch"):
        out = corrupt_tensors(DEPTH[:0], "multipath", 0.5, keys=[], backend=backend)
        assert out.shape == (0, 1, 8, 9, 1)


@pytest.mark.slow
def test_the_suite_without_tensors_does_not_import_torch():
    code = "import sys, mitigate.corruptions; assert 'torch' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.gpu
@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_gpu_equals_numpy(name, scene):
    check_equal(name, batch_of(name, scene, (2, 224, 224)), device="cuda")


def test_pixel_words_depend_on_frame_view_and_pixel():
    keys = [Key(0, "a", 1), Key(0, "a", 2)]
    views = torch.zeros(2, 2, 3, 4)
    rows = draws.Rows([1.0, 1.0], keys, [None, None], SENSOR)
    words = draws.pixel_words(rows, "gaussian_noise", views).numpy().view(np.uint64)
    stream = scramble(digest(keys[1], "gaussian_noise", frame=True), 1)
    assert words[1, 1, 0, 3] == scramble(stream, 3)
