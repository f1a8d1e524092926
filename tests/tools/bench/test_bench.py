"""Tests of the benchmark: its clocks, its calls of other libraries, and its page."""

from __future__ import annotations

import time

import numpy as np
import pytest

from mitigate.corruptions import DEPTH, NAMES
from tools.bench import evaluation, report, suite, tensors, timing, training
from tools.bench.peers import plain
from tools.bench.renderers import OURS


def test_clocks_measure_a_call():
    assert 1.9 < timing.steady(lambda i: time.sleep(0.002), 0.01) < 20
    calls = []
    assert timing.fresh(calls.append, 0.001) < 1
    assert calls == list(range(len(calls))) and len(calls) > timing.LEAST


def test_plain_code_covers_every_depth_corruption():
    depth = np.full((2, 40, 48), 3.0, np.float32)
    depth[:, :, 24:] = 5.0
    calls = plain(depth, 0.6)
    assert set(calls) == set(DEPTH)
    for call in calls.values():
        out = np.asarray(call())
        assert out.shape == depth.shape and (out != depth).any()


@pytest.mark.parametrize("name", ["low_light", "quantization"])
def test_cost_is_measured_on_the_frame(name):
    frame = np.full((1, 32, 32, 3), 90, np.uint8)
    frame = frame if name not in DEPTH else frame[..., 0].astype(np.float32) / 30
    cost = suite.cost(name, frame, 1e-3, {"slow": 9.0, "fast": 7.0})
    assert cost.best_peer == ("fast", 7.0)
    assert 0 < cost.steady < 5 and 0 < cost.copy < cost.per_frame


def test_clock_counts_only_its_function():
    seconds = {"part": 0.0}
    assert training.timed(lambda x: time.sleep(0.01) or x, seconds, "part")(3) == 3
    time.sleep(0.01)
    assert 0.009 < seconds["part"] < 0.1


def test_page_has_a_row_for_each_measurement():
    good = suite.Cost(0.1, 0.2, 0.3, 0.05, {"peer 1": 0.4})
    alone = suite.Cost(0.5, 0.6, 0.7, 0.05, {})
    rates = {OURS: (100.0, 100.0), "other": (50.0, 25.0)}
    parts = {"rendering": 900.0, "network": 2700.0}
    stage = training.Stage("da_per_frame", "imitation", "fp32", 2000.0, 1600.0, 500.0, parts)
    stages = {False: [stage], True: []}
    costs = {"224x224": {"low_light": good, "quantization": alone}}
    paces = {"base": evaluation.Pace(26, 5.2, 2.6, True)}
    batches = {"cpu": [tensors.Batch("low_light", "8x1x224x224", 4.0, 1.0, 8.0)]}
    batches["cpu"] += [tensors.Batch("spatter", "8x1x224x224", None, 1.0, 8.0)]
    workers = {1: 9.0, 2: 5.0}
    text = report.page(costs, 3.9, stages, rates, 64, 0.2, paces, workers, batches, "--steps 3")
    assert '`make bench ARGS="--steps 3"` on' in text
    assert "| `low_light` | 0.1000 | 0.2000 | 0.3000 | peer 1: 0.400 | 4.0 | 2.0 | 2.0 |" in text
    assert "| `quantization` | 0.5000 | 0.6000 | 0.7000 | none |  |  | 10.0 |" in text
    assert (
        "| `da_per_frame` | imitation | fp32 | 0.50 | 2000 | 80% | 20% | 4.00 | 20% | 900" in text
    )
    assert "| other | 50 | 25 | 4 | 2.0 times |" in text
    assert "| `base` | 26 | 5.0 | 10.0 | 2.00 | equal |" in text
    assert "| `low_light` | 8x1x224x224 | 4.00 | 1.00 | 4.00 | 8.00 | 0.50 |" in text
    assert "| `spatter` | 8x1x224x224 |  | 1.00 |  | 8.00 |  |" in text
    assert "No GPU was available" in text
    assert "9.0 s with 1, 5.0 s with 2 (1.80 times)." in text


@pytest.mark.slow
def test_batches_are_measured_with_both_backends():
    rows = tensors.costs("cpu", "2x1x16x20", (2, 1, 16, 20), 1e-3)
    assert [row.name for row in rows] == list(NAMES)
    assert all(row.numpy > 0 and row.torch > 0 for row in rows)


@pytest.mark.slow
def test_paces_compare_equal_rows(monkeypatch):
    monkeypatch.setattr(evaluation, "CHECKPOINTS", ("checkpoints/base",))
    real, names = evaluation.conditions, ["clean", "flare", "missing_data"]
    monkeypatch.setattr(evaluation, "conditions", lambda _, *severities: real(names, *severities))
    (pace,) = evaluation.paces(1).values()
    assert pace.same and pace.count == 3 and pace.alone > 0 and pace.together > 0
