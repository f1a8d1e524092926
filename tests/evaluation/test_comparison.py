"""Tests of comparisons: the formula of retention, paired intervals, and error messages."""

import numpy as np
import pytest

from mitigate.core.spaces import Box, Discrete
from mitigate.evaluation.comparison import RANDOM, RandomPolicy, compare


def rows_of(name, corruption, values, measure="return"):
    severity = 0.0 if corruption == "clean" else 0.6
    common = {"name": name, "corruption": corruption, "seed": 0, "severity": severity}
    rule = "return" if measure == "return" else "goal reached"
    return [
        {**common, "rule": rule, "episode_id": str(i), measure: value}
        for i, value in enumerate(values)
    ]


def example(clean=(10.0, 12.0), random=(2.0, 0.0)):
    return [
        *rows_of("before", "clean", clean),
        *rows_of("before", "flare", [6.0, 6.0]),
        *rows_of("before", "spatter", [1.0, 1.0]),
        *rows_of("after", "clean", [5.0, 5.0]),
        *rows_of("after", "flare", [10.0, 11.0]),
        *rows_of("after", "spatter", [1.0, 1.0]),
        *rows_of(RANDOM, "clean", random),
    ]


def test_compare_computes_retention_against_random():
    comparison = compare(example())
    flare = comparison.line("Retention: Flare")
    assert flare.values["before"].value == pytest.approx((6 - 1) / (11 - 1))
    assert flare.values["after"].value == pytest.approx((10.5 - 1) / 10)  # R_clean of before
    mean = comparison.line("**Retention, mean of 2 corruptions**")
    assert mean.values["after"].value == pytest.approx(0.95 / 2)
    assert mean.changes["after"].value == pytest.approx(0.45 / 2)
    assert "Random actions return 1.0" in str(comparison)


def test_compare_pairs_episodes():
    difficulty = np.random.default_rng(0).normal(0, 50, 100)
    rows = [
        *rows_of("before", "clean", difficulty + 100),
        *rows_of("before", "flare", difficulty + 50),
        *rows_of("after", "clean", difficulty + 100),
        *rows_of("after", "flare", difficulty + 60),
        *rows_of(RANDOM, "clean", difficulty),
    ]
    retention = compare(rows).line("Retention: Flare")
    for estimate, value in ((retention.values["before"], 0.5), (retention.changes["after"], 0.1)):
        assert (estimate.low, estimate.high) == pytest.approx((value, value))


def test_compare_shows_success_in_percent():
    rows = [
        *rows_of("before", "clean", [1, 1, 1, 1], "success"),
        *rows_of("before", "flare", [0, 0, 1, 1], "success"),
        *rows_of("after", "clean", [1, 1, 1, 1], "success"),
        *rows_of("after", "flare", [1, 1, 1, 1], "success"),
    ]
    comparison = compare(rows)
    flare = comparison.line("SR (%): Flare")
    assert flare.values["before"].value == 50.0
    assert flare.changes["after"].value == 50.0
    assert comparison.line("PRS-SR (RGB)").values["before"].value == 0.5
    assert comparison.line("SR (%): Clean").values["before"].low == pytest.approx(51.0, abs=0.1)


@pytest.mark.parametrize(("count", "significant"), [(5, False), (6, True), (30, True)])
def test_compare_marks_a_change_that_is_equal_in_all_of_six_or_more_episodes(count, significant):
    rows = [
        *rows_of("before", "clean", [1] * count, "success"),
        *rows_of("before", "flare", [0] * count, "success"),
        *rows_of("after", "clean", [1] * count, "success"),
        *rows_of("after", "flare", [1] * count, "success"),
    ]
    comparison = compare(rows)
    change = comparison.line("SR (%): Flare").changes["after"]
    assert (change.value, change.excludes_zero) == (100.0, significant)
    if significant:
        assert 50 < change.low < change.high == 100.0
    assert ("**+100.0**" in str(comparison)) == significant
    assert not comparison.line("SR (%): Clean").changes["after"].excludes_zero


def test_compare_averages_the_seeds_of_an_episode():
    rows = [
        {**row, "seed": seed}
        for seed, success in ((0, 0), (1, 1))
        for name in ("before", "after")
        for row in (
            *rows_of(name, "clean", [1, 1], "success"),
            *rows_of(name, "flare", [success, 1], "success"),
        )
    ]
    comparison = compare(rows)
    assert comparison.line("SR (%): Flare").values["after"].value == 75.0
    assert "seeds 0, 1" in comparison.about


def test_compare_rejects_an_agent_no_better_than_random():
    with pytest.raises(ValueError, match="no better than random"):
        compare(example(clean=(1.0, 1.0)))


def test_compare_rejects_agents_without_common_episodes():
    rows = [*rows_of("before", "clean", [1.0]), *rows_of("after", "clean", [1.0])]
    rows[1]["episode_id"] = "9"
    with pytest.raises(ValueError, match="must have episodes in common"):
        compare(rows)


def test_compare_rejects_several_severities_of_a_corruption():
    other = [{**row, "severity": 0.3} for row in rows_of("before", "flare", [6.0, 6.0])]
    with pytest.raises(ValueError, match=r"flare must have one severity, got 0\.6 and 0\.3"):
        compare([*example(), *other])


def test_compare_names_known_lines_for_an_unknown_one():
    with pytest.raises(KeyError, match="Return: Clean"):
        compare(example()).line("SR")


def test_random_policy_depends_on_seed_and_first_observation():
    box = Box(-np.ones(2, np.float32), np.ones(2, np.float32))

    def draws(seed, value):
        policy = RandomPolicy(box, seed)
        policy.reset("Reach the goal.")
        return np.stack([policy.act({"rgb": np.full(3, value)}) for _ in range(3)])

    np.testing.assert_array_equal(draws(3, 1), draws(3, 1))
    assert not np.array_equal(draws(3, 1), draws(4, 1))
    assert not np.array_equal(draws(3, 1), draws(3, 2))
    space = Discrete(5, start=1)
    assert {space.sample(np.random.default_rng(seed)) for seed in range(40)} == {1, 2, 3, 4, 5}
