"""Tests of the report's measures on inputs with known results."""

from __future__ import annotations

import json

import numpy as np

from mitigate.encoders.probe import (
    LinearProbe,
    Resamples,
    Score,
    average,
    average_precision,
    cosine,
    retrieval,
)
from mitigate.training.reports import encoder as report


def test_average_precision_of_a_known_list():
    guess = np.array([0.9, 0.8, 0.7, 0.6])
    label = np.array([1, 0, 1, 0])
    one = np.ones((1, 4), np.float32)
    assert np.isclose(average_precision(guess, label, one)[0], (1 + 2 / 3) / 2)
    twice = np.array([[1, 0, 2, 1]], np.float32)  # weights are repetitions
    assert np.isclose(average_precision(guess, label, twice)[0], 1.0)


def test_cosine_subtracts_the_mean():
    rng = np.random.default_rng(0)
    clean = 100 + rng.standard_normal((50, 8))
    other = 100 + rng.standard_normal((50, 8))
    centre = clean.mean(0)
    assert np.allclose(cosine(clean, clean, centre), 1)
    assert abs(cosine(other, clean, centre).mean()) < 0.2
    # without centring, all features are similar
    assert cosine(other, clean, 0 * centre).mean() > 0.99
    assert retrieval(clean, clean, centre).all() and retrieval(other, clean, centre).mean() < 0.2


def test_resamples_draw_scenes():
    scene = np.repeat(np.arange(10), 20)
    values = np.repeat(np.random.default_rng(0).standard_normal(10), 20)
    score = Resamples(scene).mean(values)
    assert np.isclose(score.value, values.mean())
    expected = values[::20].std() / np.sqrt(10)
    assert np.isclose(score.samples.std(), expected, rtol=0.15)


def test_resamples_of_one_scene_are_empty():
    values = np.random.default_rng(0).standard_normal(80)
    resamples = Resamples(np.zeros(80, int))
    score = resamples.mean(values)
    assert np.isclose(score.estimate.value, values.mean())
    for results in (score.estimate, score.minus(score), average([score, score]).estimate):
        assert np.isnan([results.low, results.high]).all()
    x, labels = values[:, None], values[:, None] > 0
    results = LinearProbe(x, labels, np.arange(80) % 4).score(x, labels, resamples).estimate
    assert results.value == 1 and np.isnan(results.low)


def test_probe_learns_only_a_linear_label():
    rng = np.random.default_rng(0)
    x = rng.standard_normal((400, 6)).astype(np.float32)
    scene = np.repeat(np.arange(20), 20)
    labels = np.stack([x[:, 0] + x[:, 1] > 0, rng.random(400) > 0.5], 1).astype(np.float32)
    for column, low, high in ((0, 0.95, 1.0), (1, 0.3, 0.7)):
        probe = LinearProbe(x[:200], labels[:200, [column]], scene[:200])
        score = probe.score(x[200:], labels[200:, [column]], Resamples(scene[200:]))
        assert low <= score.value <= high and score.samples.shape == (1000,)


def test_report_pairs_before_and_after(tmp_path, capsys):
    rng = np.random.default_rng(0)
    noise = rng.normal(0, 0.1, 1000)
    scores = {
        (state, condition, "cosine"): Score(value, value + noise)
        for state, condition, value in (
            ("before", "clean", 1.0),
            ("before", "spatter", 0.4),
            ("after", "clean", 0.9),
            ("after", "spatter", 0.7),
        )
    }
    report.write(report.with_mean(scores), tmp_path, "made")
    text = (tmp_path / "features.md").read_text()
    # both measures contain the same noise
    assert "| Spatter | 0.40" in text and "+0.30 [–] |" in text
    rows = [json.loads(line) for line in (tmp_path / "features.jsonl").read_text().splitlines()]
    assert [row["condition"] for row in rows] == ["clean", "spatter", report.MEAN]
    assert rows[1]["gain"] == [0.3, 0.3, 0.3]
    assert (tmp_path / "features.png").stat().st_size > 1000
