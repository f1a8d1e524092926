"""Tests that the bootstrap is paired and seeded, and that its intervals have the theoretical
width."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import (
    NO_INTERVAL,
    Z,
    mean,
    prs,
    prs_difference,
    resampled_means,
    share,
    wilson,
)


@pytest.fixture
def results():
    """Return successes on clean [300] and corrupted frames [8, 300]; all conditions share the
    difficulty of an episode."""
    generator = np.random.default_rng(1)
    hard = generator.random(300)
    return (hard < 0.65).astype(float), (hard < generator.normal(0.4, 0.03, (8, 1))).astype(float)


def test_interval_is_deterministic(results):
    clean, corrupted = results
    assert prs(clean, corrupted) == prs(clean, corrupted)
    assert prs(clean, corrupted, seed=1) != prs(clean, corrupted)


def test_resamples_are_those_of_a_plain_loop(results):
    clean, _ = results
    draws = np.random.Generator(np.random.PCG64(5)).integers(300, size=(50, 300))
    expected = [np.mean([clean[i] for i in row]) for row in draws]
    assert np.allclose(resampled_means(clean, resamples=50, seed=5)[:, 0], expected)


def test_resamples_do_not_depend_on_chunk_size(results, monkeypatch):
    clean, corrupted = results
    whole = resampled_means(corrupted, resamples=101)
    bootstrap._times_drawn.cache_clear()
    monkeypatch.setattr(bootstrap, "CHUNK", 7 * 300)
    assert np.array_equal(resampled_means(corrupted, resamples=101), whole)
    bootstrap._times_drawn.cache_clear()


def test_episodes_of_a_scene_are_drawn_together(results):
    scenes, (clean, corrupted) = np.repeat(np.arange(30), 10), results
    together = resampled_means(np.repeat(clean[:30], 10), resamples=50, units=scenes)
    assert np.allclose(together, resampled_means(clean[:30], resamples=50))
    alike = prs(np.repeat(clean[:30], 10), np.repeat(corrupted[:, :30], 10, axis=1), units=scenes)
    assert alike == prs(clean[:30], corrupted[:, :30])
    assert share(np.ones(300), units=scenes) == share(np.ones(30))


def test_scenes_with_few_episodes_weigh_less():
    values, scenes = np.array([0.0, 0, 0, 1]), np.array([7, 7, 7, 2])
    draws = np.random.Generator(np.random.PCG64(0)).integers(2, size=(20, 2))
    drawn = [np.concatenate([[1.0] if unit == 0 else [0.0] * 3 for unit in row]) for row in draws]
    expected = [row.mean() for row in drawn]
    assert np.allclose(resampled_means(values, resamples=20, units=scenes)[:, 0], expected)


def test_interval_of_a_rate_is_binomial():
    wins = np.repeat([1.0, 0.0], [240, 160])
    result, half = mean(wins), 1.96 * math.sqrt(0.6 * 0.4 / 400)
    assert result.value == 0.6
    assert result.low == pytest.approx(0.6 - half, abs=0.005)
    assert result.high == pytest.approx(0.6 + half, abs=0.005)


@pytest.mark.parametrize(("value", "low", "high"), [(0.0, 0.0, 0.30), (1.0, 0.70, 1.0)])
def test_nine_equal_outcomes_are_no_certainty(value, low, high):
    result = share(np.full(9, value))  # the width of Wilson's interval is 3.84 / (9 + 3.84) = 0.30
    assert (result.value, result.low, result.high) == pytest.approx((value, low, high), abs=0.001)
    varied = np.repeat([1.0, 0.0], [240, 160])
    assert share(varied) == mean(varied)


def test_wilson_inverts_the_score_test():
    assert wilson(0.0, 0) == (0.0, 1.0)
    for value in (0.0, 1.0):
        assert wilson(value, 9) == pytest.approx(wilson(abs(value - 1e-12), 9))
    for bound in wilson(0.3, 10):  # each bound is Z of its own standard deviations away
        assert abs(bound - 0.3) == pytest.approx(Z * math.sqrt(bound * (1 - bound) / 10))


def test_intervals_have_nominal_coverage():
    generator = np.random.default_rng(0)
    inside = 0
    for _ in range(200):
        hard = generator.random(200)
        clean, corrupted = (hard < 0.8).astype(float), (hard < 0.4).astype(float)
        matches = prs(clean, corrupted[None], resamples=1000)
        inside += matches.low <= 0.5 <= matches.high
    assert 180 <= inside <= 199


def test_prs_is_the_mean_ratio_to_clean(results):
    clean, corrupted = results
    matches = prs(clean, corrupted)
    assert matches.value == pytest.approx(np.mean([row.mean() / clean.mean() for row in corrupted]))
    assert matches.low < matches.value < matches.high


def test_clean_and_corrupted_vary_together_within_a_prs(results):
    clean, _ = results
    unhurt = prs(clean, np.stack([clean, clean]))
    assert (unhurt.value, unhurt.low, unhurt.high) == pytest.approx((1.0, 1.0, 1.0))


def test_equal_agents_differ_by_exactly_nothing(results):
    matches = prs_difference(results, results)
    assert (matches.value, matches.low, matches.high) == (0.0, 0.0, 0.0)
    assert not matches.excludes_zero


def test_pairing_narrows_the_interval_of_a_difference(results):
    clean, corrupted = results
    better = np.maximum(corrupted, (np.arange(300) % 10 == 0) * clean)
    paired = prs_difference((clean, better), (clean, corrupted))
    # in unpaired episodes, the difficulty does not cancel
    order = np.random.default_rng(3).permutation(300)
    unpaired = prs_difference((clean[order], better[:, order]), (clean, corrupted))
    assert paired.value == pytest.approx(unpaired.value)
    assert paired.excludes_zero
    assert paired.high - paired.low < 0.7 * (unpaired.high - unpaired.low)


def test_prs_needs_clean_success():
    matches = prs(np.zeros(20), np.zeros((3, 20)))
    assert all(math.isnan(x) for x in (matches.value, matches.low, matches.high))
    assert not matches.excludes_zero


@pytest.mark.parametrize("wins", [1.0, 1 / 3])
@pytest.mark.parametrize("episodes", [1, 7])
def test_interval_without_width_excludes_nothing(episodes, wins):
    clean, corrupted = np.ones(episodes), np.full((2, episodes), wins)
    for result in (prs(clean, corrupted), mean(corrupted[0])):
        assert result.value == pytest.approx(wins)
        assert not (result.has_width or result.excludes_zero)
        assert result.interval(".2f") == NO_INTERVAL
    assert mean([0.1, 0.4]).interval(".1f", 100) == "[10.0, 40.0]"


def test_gaps_and_unequal_episodes_are_refused(results):
    clean, corrupted = results
    with pytest.raises(ValueError, match="1 NaN"):
        mean([1.0, math.nan])
    with pytest.raises(ValueError, match=r"same episodes in both arguments, got 299 and 300"):
        prs_difference(results, (clean[1:], corrupted[:, 1:]))
