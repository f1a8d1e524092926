"""Tests that the simulated cluster finishes all episodes and loses only running ones."""

from __future__ import annotations

import numpy as np
import pytest

from tools.bench.cluster import Cluster, draw, simulate


def test_simulate_without_failures_matches_arithmetic():
    outcome = simulate(np.full(96, 36.0), 1, Cluster(nodes=3, workers=4, days=1e9))
    assert outcome.hours == pytest.approx(8 * 36 / 3600)
    assert (outcome.lost, outcome.failures) == (0.0, 0) and outcome.idle == pytest.approx(
        0.0, abs=1e-9
    )


def test_simulate_idles_with_large_shares():
    seconds = draw(400, 60.0, 0.8, 0)
    small, large = (simulate(seconds, n, Cluster(4, 4, 1e9)) for n in (1, 25))
    assert large.hours > small.hours and large.idle > small.idle


def test_simulate_loses_only_the_running_episode():
    seconds = np.full(2000, 120.0)
    calm, rough = (simulate(seconds, 4, Cluster(5, 4, days)) for days in (1e9, 0.02))
    assert rough.failures > 5 and rough.hours > calm.hours
    assert 0 < rough.lost <= rough.failures * 4 * 120 / 3600


def test_draw_has_the_requested_mean_and_spread():
    seconds = draw(100_000, 17.0, 0.5, 0)
    assert seconds.mean() == pytest.approx(17.0, rel=0.02)
    assert seconds.std() / seconds.mean() == pytest.approx(0.5, rel=0.03)
