"""Tests of critical severities, their intervals, and the search for them."""

from __future__ import annotations

import json
import math
import shutil
from functools import partial
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

import mitigate
from mitigate.core import conf
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import critical_report, evaluate, rows, table
from mitigate.evaluation.bootstrap import resampled_means
from mitigate.evaluation.critical import (
    WIDTH,
    Scores,
    area,
    crossing,
    decreasing,
    first_conditions,
    next_severities,
    scores,
    search,
)
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import RETURN, seeded_episodes
from tests.evaluation.made_rows import row

LOSS = 0.5


def measured(limits: np.ndarray, severities, corruption="spatter", noise=None, **changes) -> list:
    """Return rows of episodes that succeed at severities below their limit.

    ``noise`` [episodes, severities] overrides the success under corruption where it is not NaN.
    """
    result = []
    for column, severity in enumerate(severities):
        name = corruption if severity else "clean"
        for episode, limit in enumerate(limits):
            success = float(severity < limit)
            if noise is not None and severity and not np.isnan(noise[episode, column]):
                success = noise[episode, column]
            labels = {"corruption": name, "severity": severity, **changes}
            result.append(row(episode, success, **labels))
    return result


def only(records, losses=(LOSS,), **options) -> Scores:
    (part,) = scores(records, losses, **options)
    return part


@pytest.mark.parametrize(
    ("values", "fit"),
    [
        ([0.9, 0.5, 0.1], [0.9, 0.5, 0.1]),
        ([0.9, 0.4, 0.6, 0.1], [0.9, 0.5, 0.5, 0.1]),
        ([0.2, 0.4, 0.9], [0.5, 0.5, 0.5]),
    ],
)
def test_decreasing_pools_values_that_increase(values, fit):
    np.testing.assert_allclose(decreasing([values, values]), [fit, fit])


def test_decreasing_is_the_least_squares_fit():
    """Compare the fit with random decreasing vectors: none of them has a smaller error."""
    random = np.random.default_rng(0)
    values = random.random(6)
    error = ((decreasing(values) - values) ** 2).sum()
    others = -np.sort(-random.random((20_000, 6)), axis=1)
    assert np.diff(decreasing(values)).max() <= 1e-12
    assert error <= ((others - values) ** 2).sum(axis=1).min()


def test_crossing_interpolates_between_measured_severities():
    rates = [0.8, 0.4, 0.0]
    assert crossing([0, 0.5, 1], rates, 0.25) == pytest.approx(0.25)
    assert crossing([0, 0.5, 1], rates, 0.5) == pytest.approx(0.5)
    assert crossing([0, 0.5, 1], rates, 0.75) == pytest.approx(0.75)


def test_crossing_is_infinite_if_less_is_lost_and_undefined_without_clean_success():
    result = crossing([0, 1], [[0.8, 0.75], [0.8, 0.72], [0.0, 0.0]], 0.1)
    assert math.isinf(result[0]) and result[1] == pytest.approx(1.0) and math.isnan(result[2])


def test_crossing_ignores_a_single_drop_that_later_severities_contradict():
    assert math.isinf(crossing([0, 0.25, 0.5, 1], [0.9, 0.78, 0.9, 0.9], 0.1))


def test_area_is_the_trapezoid_of_the_measured_retention():
    assert area([0, 0.5, 1], [0.8, 0.8, 0.4]) == pytest.approx(0.5 * 1 + 0.5 * 0.75)


def test_next_severities_halves_the_interval_of_each_crossing():
    rates = {0.0: 0.9, 0.6: 0.6, 1.0: 0.0}
    assert next_severities(rates, [0.1, 0.5]) == [0.3, 0.8]
    assert next_severities({0.0: 0.9, 1.0: 0.85}, [0.1]) == []
    assert next_severities({0.0: 0.9, 0.1: 0.0, 1.0: 0.0}, [0.1]) == []
    assert next_severities({0.0: 0.0, 1.0: 0.0}, [0.1]) == []


def simulate(limits: np.ndarray, requests: list):
    """Return a function that simulates measuring episodes with these limits, and records which
    conditions were requested."""

    def measure(conditions):
        requests.append(conditions)
        result = []
        for one in conditions:
            result += measured(limits, [one.severity], one.name)
        return result

    return measure


def test_search_finds_the_critical_severities_of_a_known_agent():
    """The limits are uniform from 0 to 1, so the agent has lost a fraction x of its success at
    severity x."""
    limits = (np.arange(100) + 0.5) / 100
    start = first_conditions([CLEAN, Corruption("spatter", 0.6)], "a rule")
    records = search(simulate(limits, []), start, [0.1, 0.5])
    part = only(records, [0.1, 0.5])
    for loss in (0.1, 0.5):
        estimate = part.results[("base",), ("spatter",), loss].estimate
        assert estimate.value == pytest.approx(loss, abs=0.01)
        assert estimate.low < loss < estimate.high
    assert part.results[("base",), ("spatter",), None].estimate.value == pytest.approx(
        0.5, abs=0.01
    )
    severities = [*part.curve("base", "spatter", 0)]
    assert len(severities) <= 9, "a grid with step 0.05 has 21"
    gaps = [b - a for a, b in zip(severities, severities[1:], strict=False) if a < 0.5 <= b]
    assert max(gaps) <= WIDTH + 1e-9


def test_search_stops_after_severity_one_if_nothing_is_lost():
    requests: list = []
    start = first_conditions([Corruption("spatter", 0.6)], "a rule")
    search(simulate(np.full(20, 2.0), requests), start, [0.1])
    assert requests == [[CLEAN, Corruption("spatter", 0.6), Corruption("spatter", 1.0)]]


def noisy_agent(random, count: int) -> tuple[np.ndarray, np.ndarray, list[float]]:
    """Return the limits and the noise of an agent, and the severities of a typical search."""
    severities = [0.0, 0.3, 0.375, 0.45, 0.525, 0.6, 1.0]
    limits = random.normal(0.5, 0.2, count)
    limits[random.random(count) < 0.1] = -1.0  # episodes that also fail on clean frames
    flips = random.random((count, len(severities))) < 0.1
    noise = np.where(flips, random.random(flips.shape) < 0.5, np.nan)
    return limits, noise, severities


@pytest.mark.slow
def test_intervals_cover_the_true_critical_severity(monkeypatch):
    """The clean SR is 0.894, and half of it is lost at s = 0.5048.

    For s > 0, SR(s) = 0.81 * P(s < limit) + 0.05, where ``limit`` is an episode's random limit.
    """
    fewer = partial(resampled_means, resamples=500)
    monkeypatch.setattr("mitigate.evaluation.critical.resampled_means", fewer)
    random = np.random.default_rng(1)
    covered = 0
    for _ in range(120):
        limits, noise, severities = noisy_agent(random, 60)
        part = only(measured(limits, severities, noise=noise))
        estimate = part.score(("base",), ("spatter",), LOSS).estimate
        covered += estimate.low <= 0.5048 <= estimate.high
    # if the coverage is 0.95, ``covered`` is in this range with a probability above 0.99
    assert 106 <= covered <= 119


def test_censored_values_are_reported_above_one():
    strong = measured(np.full(30, 2.0), [0, 0.6, 1])
    part = only(strong)
    score = part.results[("base",), ("spatter",), LOSS]
    assert math.isinf(score.estimate.value) and score.bound == "lower"
    assert "> 1 [> 1]" in critical_report.markdown(part)
    entry = critical_report.entries(part)[0]
    assert entry["value"] is None and entry["high"] is None and entry["bound"] == "lower"


def test_interval_reaches_above_one_if_some_resamples_are_censored():
    limits = np.r_[np.full(19, 2.0), np.full(21, 0.8)]
    estimate = (
        only(measured(limits, [0, 0.6, 0.9, 1])).results[("base",), ("spatter",), LOSS].estimate
    )
    assert 0.6 < estimate.low < estimate.value <= 1 and math.isinf(estimate.high)


def test_difference_from_a_censored_agent_is_a_lower_bound():
    weak = measured(np.r_[np.full(15, 0.2), np.full(15, 0.4)], [0, 0.3, 0.6, 1])
    strong = measured(np.full(30, 2.0), [0, 0.6, 1], name="strong", agent="b" * 12)
    part = only(weak + strong)
    score = part.results[("strong", "base"), ("spatter",), LOSS]
    base = part.results[("base",), ("spatter",), LOSS].estimate
    assert score.bound == "lower" and score.estimate.excludes_zero
    assert score.estimate.value == pytest.approx(1 - base.value)
    assert "**≥ +" in critical_report.markdown(part)
    reverse = only(weak + strong, against="strong").results[("base", "strong"), ("spatter",), LOSS]
    assert reverse.bound == "upper" and reverse.estimate.value == -score.estimate.value


def test_difference_of_two_censored_agents_is_unknown():
    records = [r for n in "ab" for r in measured(np.full(30, 2.0), [0, 1], name=n, agent=n * 12)]
    part = only(records)
    assert part.results[("b", "a"), ("spatter",), LOSS].bound == "unknown"
    assert "both > 1" in critical_report.markdown(part)


def test_differences_are_paired():
    """In every episode, the limit of the second agent is 0.1 above the limit of the first agent.

    So the interval of the difference must be narrower than the interval of one agent.
    """
    limits = np.random.default_rng(0).uniform(0.2, 0.8, 60)
    severities = np.linspace(0, 1, 11).round(2).tolist()
    first = measured(limits, severities)
    second = measured(limits + 0.1, severities, name="second", agent="b" * 12)
    part = only(first + second)
    alone = part.results[("base",), ("spatter",), LOSS].estimate
    change = part.results[("second", "base"), ("spatter",), LOSS].estimate
    assert change.value == pytest.approx(0.1, abs=0.01)
    assert change.high - change.low < (alone.high - alone.low) / 2


def test_mean_over_corruptions_counts_censored_values_as_one():
    records = measured(np.full(20, 0.5), [0, 0.45, 0.55, 1])
    records += measured(np.full(20, 2.0), [1.0], "flare")
    part = only(records)
    (names,) = [names for names in part.groups if len(names) == 2]
    score = part.results[("base",), names, LOSS]
    assert score.estimate.value == pytest.approx((0.5 + 1) / 2) and score.bound == "lower"


def test_seeds_are_averaged():
    records = measured(np.full(20, 0.3), [0, 0.25, 0.35, 1])
    records += measured(np.full(20, 0.7), [0, 0.65, 0.75, 1], seed=1)
    score = only(records).results[("base",), ("spatter",), LOSS]
    assert score.estimate.value == pytest.approx(0.5)


def test_unfinished_severities_are_left_out():
    records = measured(np.full(20, 0.5), [0, 0.4, 1])
    part = only(records + measured(np.full(3, 0.5), [0.45]))
    assert [*part.curve("base", "spatter", 0)] == [0, 0.4, 1]
    assert part.results[("base",), ("spatter",), LOSS].episodes == 20


def test_scores_require_clean_successes_and_severity_one():
    for records in (
        measured(np.full(5, 2.0), [0, 0.6]),
        measured(np.full(5, 2.0), [1.0]),
        measured(np.full(5, -1.0), [0, 1]),
    ):
        with pytest.raises(
            ValueError, match=r"of a corruption at severity 1.*critical=\[0.1,0.5\]"
        ):
            scores(records, [LOSS])


def test_table_joins_row_files(tmp_path, capsys):
    limits = np.linspace(0, 1, 30)
    rows.write(tmp_path / "a.jsonl", measured(limits, [0, 0.4, 0.6, 1]))
    other = measured(limits + 0.2, [0, 0.6, 0.8, 1], name="other", agent="b" * 12)
    rows.write(tmp_path / "b.jsonl", other)
    paths = [str(tmp_path / name) for name in ("a.jsonl", "b.jsonl")]
    arguments = [*paths, "--critical", "[0.1,0.5]", "--out", str(tmp_path / "out")]
    assert table.main(arguments) == 0
    printed = capsys.readouterr().out
    assert "Severity at which 10 % of the clean success is lost" in printed
    assert "Difference from base:" in printed
    for name in ("critical.md", "critical.json", "critical.png"):
        assert (tmp_path / "out" / name).stat().st_size
    entries = json.loads((tmp_path / "out/critical.json").read_text())
    assert {entry["loss"] for entry in entries} == {0.1, 0.5, None}
    with pytest.raises(SystemExit):
        table.main([paths[0], "--critical", "half"])
    assert "must be fractions such as 0.1,0.5" in capsys.readouterr().err
    assert table.main([paths[0], "--critical", "10"]) == 2
    assert "between 0 and 1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["critical=[]"], "critical must hold fractions"),
        (["critical=[10]"], r"between 0 and 1.*got \[10.0\]"),
        (["critical=[0.5]", "severity=0"], "severity above 0"),
        (["critical=[0.5]", "conditions=[clean]"], "critical needs corruptions"),
    ],
)
def test_evaluate_rejects_invalid_searches(tmp_path, options, message):
    cfg = conf.load_config("evaluate", [*options, f"runs={tmp_path}", "env.size=16", "episodes=1"])
    with pytest.raises(ValueError, match=message):
        evaluate.run(cfg)
    assert not list(tmp_path.iterdir())


def test_search_requires_a_success_criterion():
    with pytest.raises(ValueError, match="a success criterion"):
        first_conditions([Corruption("spatter", 0.6)], RETURN)


class Lamp(gymnasium.Env):
    """A world with one step and a grey level that depends on the seed; action 1 succeeds."""

    def __init__(self) -> None:
        self.observation_space = spaces.Dict({"rgb": spaces.Box(0, 255, (8, 8, 3), np.uint8)})
        self.action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.grey = 100 + 15 * (seed % 10)
        return self._frame(), {}

    def step(self, action):
        return self._frame(), 0.0, True, False, {"won": action == 1}

    def _frame(self):
        return {"rgb": np.full((8, 8, 3), self.grey, np.uint8)}


def lamp_world() -> GymWorld:
    return GymWorld(Lamp(), success="won")


class Watcher:
    """An agent that succeeds while the frame is bright enough."""

    def settings(self):
        return {}

    def reset(self, instruction: str) -> None:
        pass

    def act(self, observation) -> int:
        return int(np.asarray(observation["rgb"]).mean() > 60)


def run_benchmark(out: Path):
    return mitigate.benchmark(
        Watcher(),
        world=lamp_world,
        listed=seeded_episodes(range(10)),
        suite=["low_light"],
        critical=(0.1, 0.5),
        out=out,
    )


def test_benchmark_continues_an_interrupted_search(tmp_path, capsys):
    """A kill in the second round leaves only the first rows, and the last of them is incomplete."""
    entry = run_benchmark(tmp_path / "whole")
    assert entry.severity == 0.6 and entry.SR["clean"][0] == 1.0
    printed = capsys.readouterr().out
    assert "critical: next severities: low_light" in printed and "is lost" in printed
    shutil.copytree(tmp_path / "whole", tmp_path / "parts")
    for path in (tmp_path / "parts").glob("critical.*"):
        path.unlink()
    content = (tmp_path / "whole/rows.jsonl").read_bytes().splitlines(keepends=True)
    (tmp_path / "parts/rows.jsonl").write_bytes(b"".join(content[:33]) + content[33][:90])
    assert run_benchmark(tmp_path / "parts").scores == entry.scores
    for name in ("rows.jsonl", "critical.md", "critical.json"):
        whole = (tmp_path / "whole" / name).read_bytes()
        assert (tmp_path / "parts" / name).read_bytes() == whole, name
