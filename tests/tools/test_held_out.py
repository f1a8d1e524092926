"""Tests of the corruptions of independent authors, which ``tools/held_out`` adds as a package."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from mitigate.corruptions import DepthSensor, Key, corrupt, registry
from tools.held_out.mitigate_held_out.records import NAMES, RECORDS, TEST_HALF, VALIDATION_HALF

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pytest installs it for these Python versions

FOLDER = Path(__file__).parents[2] / "tools/held_out"
GROUPS = tomllib.loads((FOLDER / "pyproject.toml").read_text())["project"]["entry-points"]
POINTS = GROUPS["mitigate.corruptions"]
SENSOR = DepthSensor(z_max=6.0, missing=6.5)
KEY = Key(3, "episode-7", 4)
SIZES = ((3, 64, 64), (1, 97, 130))  # views, height, width


def smooth(size, channels, low, high):
    """Return views of smooth random values."""
    count, height, width = size
    rng = np.random.default_rng(height)
    grids = rng.uniform(low, high, (count, 7, 7, channels)).astype(np.float32)
    return np.stack([cv2.resize(grid, (width, height)) for grid in grids])


def views_of(record, size):
    if record.modality == "rgb":
        return smooth(size, 3, 0, 255).astype(np.uint8)
    depth = smooth(size, 1, 0.5, 5.5)
    depth[:, :4, :7] = 0  # missing
    return depth


def apply(record, views, severity=0.6, **parts):
    key = Key(**{**vars(KEY), **parts})
    return record.apply(views, severity, key, None if record.modality == "rgb" else SENSOR)


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("record", RECORDS, ids=NAMES)
def test_corruption_keeps_shape_dtype_and_input(record, size):
    views = views_of(record, size)
    before = views.copy()
    for severity in (0.01, 0.6, 1.0):
        out = apply(record, views, severity)
        assert out.shape == views.shape and out.dtype == views.dtype
        assert np.array_equal(views, before) and not np.shares_memory(out, views)
        if record.modality == "depth":
            assert (((out > 0) & (out <= SENSOR.z_max)) | (out == SENSOR.missing)).all()


@pytest.mark.parametrize("record", RECORDS, ids=NAMES)
def test_corruption_depends_on_the_key_only(record):
    views = views_of(record, SIZES[0])
    out = apply(record, views)
    assert np.array_equal(apply(record, views), out)
    assert not np.array_equal(apply(record, views, episode="episode-8"), out)
    assert not np.array_equal(apply(record, views, seed=4), out)
    assert np.array_equal(apply(record, views, frame=5), out) == (record.frame == "-")


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("record", RECORDS, ids=NAMES)
def test_mean_change_grows_with_severity(record, size):
    views = views_of(record, size)

    def change(severity):
        outs = [apply(record, views, severity, episode=episode) for episode in "abc"]
        return np.mean([np.abs(out.astype(np.float32) - views).mean() for out in outs])

    changes = [change(severity) for severity in (0.2, 0.6, 1.0)]
    assert 0 < changes[0] < changes[1] < changes[2]


def test_halves_divide_the_corruptions_of_each_author_and_sensor():
    assert len(set(NAMES)) == 42 and {*VALIDATION_HALF, *TEST_HALF} == {*NAMES}
    for author in "abc":
        for modality, count in (("rgb", 4), ("depth", 3)):
            names = [r.name for r in RECORDS if (r.name[0], r.modality) == (author, modality)]
            assert len({*names} & {*VALIDATION_HALF}) == len({*names} & {*TEST_HALF}) == count


def test_page_lists_both_halves():
    lines = re.findall(r"^\| `(\w+)` \|.*\| `(\w+)` \|", (FOLDER / "README.md").read_text(), re.M)
    assert lines == list(zip(VALIDATION_HALF, TEST_HALF, strict=True))


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Install the entry points of the package in this process."""
    metadata = tmp_path / "mitigate_held_out-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: mitigate-held-out\n")
    lines = [f"{name} = {value}" for name, value in POINTS.items()]
    (metadata / "entry_points.txt").write_text("\n".join(["[mitigate.corruptions]", *lines]))
    monkeypatch.syspath_prepend(FOLDER)
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    registry.plugin_records.cache_clear()
    yield
    registry.plugin_records.cache_clear()


def test_installed_package_adds_the_corruptions_to_no_suite(installed):
    assert tuple(POINTS) == NAMES and {*NAMES} <= {*registry.known("rgb", "depth")}
    built_in = {*registry.names("rgb", "depth"), *registry.unseen_names("rgb", "depth")}
    assert not built_in & {*NAMES}
    lines = [line.split() for line in registry.table().splitlines()]
    assert all(line[-1] == "-" for line in lines if line[0] in NAMES)
    frame = views_of(RECORDS[0], SIZES[0])
    assert np.array_equal(corrupt(frame, NAMES[0], 0.6, key=KEY), apply(RECORDS[0], frame))
