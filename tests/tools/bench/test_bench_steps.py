"""Tests of the CI check that fails if training is much slower when it is limited to AVX2."""

from __future__ import annotations

from itertools import accumulate
from pathlib import Path
from unittest import mock

import pytest

from mitigate.training.journal import Journal
from tools.bench.steps import main, step_costs

USUAL = {"perception": (9.0, 0.2, 0.25), "imitation": (20.0, 1.0, 1.5)}


def make(folder: Path, costs: dict[str, tuple[float, ...]]) -> Path:
    """Create a run folder in which each stage has logged these CPU seconds per step with a
    Journal."""
    for stage, seconds in costs.items():
        clock = accumulate((5.0, *seconds))
        with (
            mock.patch("time.process_time", side_effect=clock),
            Journal(folder / stage, total=len(seconds)) as journal,
        ):
            for step in range(1, len(seconds) + 1):
                journal.advance({})
                journal.scalars(step, {"loss": 1.0})
    return folder


def scaled(factor: float) -> dict[str, tuple[float, ...]]:
    return {name: tuple(factor * t for t in times) for name, times in USUAL.items()}


def test_step_costs_use_the_cheapest_step(tmp_path):
    run = make(tmp_path, {"one": (0.1, 0.5, 0.4, 3.0)})
    assert step_costs(run) == {"one": pytest.approx(0.4, rel=1e-5)}


def test_main_passes_within_the_bound(tmp_path, capsys):
    runs = [make(tmp_path / "a", USUAL), make(tmp_path / "b", scaled(2.2))]
    assert main([*map(str, runs), "--most", "3"]) == 0
    out = capsys.readouterr().out
    assert "0.200 and 0.440 CPU s per step: 2.20 times, at most 3" in out and "imitation" in out


def test_main_fails_and_names_the_stage(tmp_path, capsys):
    slow = {**USUAL, "imitation": (20.0, 4.5, 4.6)}
    runs = [make(tmp_path / "a", USUAL), make(tmp_path / "b", slow)]
    assert main(list(map(str, runs))) == 1
    message = capsys.readouterr().err
    assert "Steps of imitation cost more than 4 times" in message and "precision" in message


def test_main_ignores_noise_in_some_steps(tmp_path):
    noisy = {**USUAL, "perception": (9.0, 2.0, 0.2, 2.0)}
    runs = [make(tmp_path / "a", USUAL), make(tmp_path / "b", noisy)]
    assert main(list(map(str, runs))) == 0


@pytest.mark.parametrize(
    ("costs", "words"),
    [
        ({}, "contains no stage with TensorBoard files"),
        (
            {"perception": (1.0, 1.0), "imitation": (1.0, 1.0)},
            "logged the cost of 2 steps, fewer than 3",
        ),
        ({"perception": (1.0, 1.0, 1.0)}, "different stages"),
    ],
)
def test_main_rejects_runs_that_cannot_be_compared(tmp_path, capsys, costs, words):
    runs = [make(tmp_path / "a", USUAL), make(tmp_path / "b", costs)]
    with pytest.raises(SystemExit) as stop:
        main(list(map(str, runs)))
    assert stop.value.code == 2 and words in capsys.readouterr().err
