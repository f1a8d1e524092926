"""Retention of a return: its formula, its intervals, and errors."""

import numpy as np
import pytest

from mitigate.core.spaces import Box, Discrete
from mitigate.evaluation.returns import RANDOM, RandomPolicy, returns


def rows_of(name, corruption, values):
    return [
        {"name": name, "corruption": corruption, "episode_id": str(i), "return": value}
        for i, value in enumerate(values)
    ]


def example(clean=(10.0, 12.0), dark=(6.0, 6.0), random=(2.0, 0.0)):
    return [
        *rows_of(RANDOM, "clean", random),
        *rows_of("before", "clean", clean),
        *rows_of("before", "dark", dark),
        *rows_of("after", "clean", clean),
        *rows_of("after", "dark", [10.0, 11.0]),
    ]


def test_retention_is_one_for_clean_and_zero_for_random():
    report = returns(example())
    assert report.retention["before", "dark"].value == pytest.approx((6 - 1) / (11 - 1))
    assert report.retention["after", "mean"].value == pytest.approx((10.5 - 1) / 10)
    assert report.gain["after"].value == pytest.approx(0.45)


def test_retention_intervals_are_paired():
    rng = np.random.default_rng(0)
    difficulty = rng.normal(0, 50, 100)
    rows = [
        *rows_of(RANDOM, "clean", difficulty),
        *rows_of("before", "clean", difficulty + 100),
        *rows_of("before", "dark", difficulty + 50),
    ]
    low, high = report_bounds(returns(rows).retention["before", "dark"])
    assert low == pytest.approx(0.5) and high == pytest.approx(0.5)


def report_bounds(estimate):
    return estimate.low, estimate.high


def test_retention_is_undefined_for_a_policy_like_random():
    with pytest.raises(ValueError, match="no more than random"):
        returns(example(clean=(1.0, 1.0)))


def test_returns_need_rows_of_random_actions():
    with pytest.raises(ValueError, match="random actions"):
        returns([row for row in example() if row["name"] != RANDOM])


def test_random_policy_is_keyed():
    policy = RandomPolicy(Box(-np.ones(2, np.float32), np.ones(2, np.float32)), seed=3)
    draws = []
    for _ in range(2):
        policy.reset("Reach the goal.")
        draws.append(np.stack([policy.act({}) for _ in range(3)]))
    np.testing.assert_array_equal(*draws)
    assert (
        len(
            {
                RandomPolicy(Discrete(5, start=1)).space.sample(np.random.default_rng(s))
                for s in range(40)
            }
        )
        == 5
    )
