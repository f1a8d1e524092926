"""Tests that an agent's answer must be an action, and that errors name episode, step and line."""

from __future__ import annotations

import pickle
import random
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from mitigate.agents.stepwise import StepwiseAgent
from mitigate.core.errors import error_message
from mitigate.core.observation import Observation
from mitigate.core.workers import portable
from mitigate.corruptions import CLEAN
from mitigate.evaluation.episode import run_episode, run_side_by_side
from mitigate.worlds.episodes import Episode, Instruction

EPISODE = Episode("e7", "0", "room", (0, 0, 0), (0, 0, 0, 1), (), Instruction("Go."), ())


class Cell:
    """A world with one dark cell, in which STOP is correct."""

    rule, sensors = "STOP", {}

    def reset(self, episode):
        self.done = False
        return self.look()

    def step(self, action):
        self.done = action == 0
        return self.look()

    def look(self):
        return Observation({}, lambda: {"rgb": np.zeros((4, 4, 3), np.uint8)}, ("rgb",))

    def measures(self):
        return {"success": 1, "spl": 1.0}

    def expert(self):
        return self

    def action(self):
        return 1


class Answers:
    """An agent that returns its ``answers`` in turn. A callable answer is called first."""

    together = 1

    def __init__(self, *answers):
        self.answers = [*answers]

    def reset(self, instruction):
        pass

    def begin(self, instruction):
        return None

    def act(self, observation):
        answer = self.answers.pop(0)
        return answer() if callable(answer) else answer

    def act_all(self, observations, memories):
        return [self.act(seen) for seen in observations]


class Logits(StepwiseAgent):
    def __init__(self, *logits):
        super().__init__()
        self.scale, self.logits = nn.Linear(1, 1), torch.tensor([logits])

    def forward(self, frames, texts):
        return self.logits, {}


@pytest.mark.parametrize("answer", [0, np.int64(0), torch.tensor(0), np.array(0)])
def test_action_of_accepts_integers(answer):
    assert run_episode(Answers(1, answer), Cell(), EPISODE, CLEAN, 0)["success"] == 1


@pytest.mark.parametrize("answer", [1.7, None, np.zeros(4), "0", torch.zeros(4)])
def test_run_episode_rejects_invalid_actions(answer):
    words = r"Episode e7, clean, step 2: act\(\) of Answers must return a whole number"
    with pytest.raises(ValueError, match=words):
        run_episode(Answers(1, answer), Cell(), EPISODE, CLEAN, 0)
    with pytest.raises(ValueError, match=words):
        list(run_side_by_side(Answers(1, answer), [Cell()], [(EPISODE, CLEAN, 0)]))


def test_global_random_numbers_depend_on_seed_and_episode_only():
    def episode(seed, condition=CLEAN):
        drawn = []

        def draw():
            drawn.extend([random.random(), np.random.rand(), torch.rand(()).item()])
            return 0

        run_episode(Answers(draw), Cell(), EPISODE, condition, seed)
        return drawn

    first = episode(0)
    np.random.seed(3)
    expected = np.random.rand(2)
    np.random.seed(3)
    between = [np.random.rand()]
    assert episode(0) == first != episode(1)
    assert [*between, np.random.rand()] == expected.tolist()  # the caller's numbers continue


def test_measures_rejects_a_success_between_0_and_1():
    cell = Cell()
    cell.measures = lambda: {"success": 0.5, "spl": 0.5}
    with pytest.raises(ValueError, match=r"clean: measures\(\) .* success 0 or 1, got 0.5"):
        run_episode(Answers(0), cell, EPISODE, CLEAN, 0)


def test_measures_may_be_numbers_of_numpy_or_torch(tmp_path):
    cell = Cell()
    cell.measures = lambda: {"success": np.bool_(True), "spl": np.float32(0.5), "m": torch.ones(())}
    measured = run_episode(Answers(0), cell, EPISODE, CLEAN, 0)
    assert {n: measured[n] for n in ("success", "spl", "m")} == {"success": 1, "spl": 0.5, "m": 1.0}
    assert [type(measured[n]) for n in ("success", "spl", "m")] == [int, float, float]


@pytest.mark.parametrize("displayed", [{"rgb": np.zeros((4, 4, 3), np.uint8)}, (0, 1.0, False, {})])
def test_run_episode_rejects_invalid_observations(displayed):
    cell = Cell()
    cell.look = lambda: displayed
    name = type(displayed).__name__
    with pytest.raises(ValueError, match=f"of Cell must return an Observation, got {name}"):
        run_episode(Answers(0), cell, EPISODE, CLEAN, 0)


def test_run_episode_names_a_missing_frame():
    class Curious(Logits):
        def forward(self, frames, texts):
            return self.logits + frames["depth"].mean(), {}

    with pytest.raises(ValueError, match=r"reads 'depth', but its needs = \('rgb',\) do not name"):
        run_episode(Curious(0.0, 1.0, 2.0, 3.0), Cell(), EPISODE, CLEAN, 0)


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize("logits", [(NAN,) * 4, (0.0, NAN, 0.0, 0.0), (INF, 0, 0, 0), (-INF,) * 4])
def test_logits_that_are_no_numbers_are_no_stop(logits):
    with pytest.raises(
        ValueError, match="Episode e7, clean, step 1: Logits of Logits must be finite"
    ):
        run_episode(Logits(*logits), Cell(), EPISODE, CLEAN, 0)
    walks = {"expert_share": 0.0, "rngs": [np.random.default_rng(0)]}
    with pytest.raises(ValueError, match="Episode e7, step 1: Logits of Logits must be finite"):
        Logits(*logits).collect([Cell()], [EPISODE], **walks)


def test_run_episode_masks_forbidden_actions():
    assert run_episode(Logits(0.0, -INF, -9.0, -INF), Cell(), EPISODE, CLEAN, 0)["success"] == 1


def broken():
    return int(np.ones(3) @ np.ones(4))


def test_run_episode_error_names_line_and_episode():
    settings = rf"raised in {Path(__file__)}, line \d+, broken\(\)"
    with pytest.raises(ValueError, match=rf"Episode e7, clean, step 2: matmul.* \({settings}\)"):
        run_episode(Answers(1, broken), Cell(), EPISODE, CLEAN, 0)
    with pytest.raises(ValueError, match="matmul") as caught:
        broken()
    error, _ = portable(caught.value)  # in the form in which a worker process returns it
    assert error_message(pickle.loads(pickle.dumps(error))).endswith("broken())")


def test_run_episode_keeps_messages_of_the_project():
    with pytest.raises(ValueError) as caught:
        run_episode(Answers(None), Cell(), EPISODE, CLEAN, 0)
    assert "raised in" not in error_message(caught.value)


def leave():
    raise SystemExit(0)


@pytest.mark.parametrize("place", ["act", "reset", "step", "measures"])
def test_run_episode_turns_exits_into_errors(place):
    agent, cell = Answers(leave if place == "act" else 0), Cell()
    if place != "act":
        setattr(cell, place, lambda *_: leave())
    words = rf"Episode e7, clean: .*SystemExit\(0\).*{Path(__file__).name}, line \d+, leave\(\)"
    with pytest.raises(ValueError, match=words):
        run_episode(agent, cell, EPISODE, CLEAN, 0)
    agent = Answers(leave if place == "act" else 0)
    with pytest.raises(ValueError, match=words):
        list(run_side_by_side(agent, [cell], [(EPISODE, CLEAN, 0)]))
