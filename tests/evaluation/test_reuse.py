"""Tests that each frame of an episode is rendered and encoded once, and that this does not change
rows."""

from __future__ import annotations

import os
import signal
from functools import partial

import numpy as np
import pytest
import torch

from mitigate.core import workers
from mitigate.core.observation import DEPTH, RGB, STOP
from mitigate.corruptions import CLEAN, NAMES, Corruption
from mitigate.evaluation import rows
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.evaluator import evaluate
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.agents.rooms import wanderer

CONDITIONS = [CLEAN, *(Corruption(name, 0.6) for name in NAMES[::3])]
SIZE = 16


def measured(agent, episode, world):
    return [run_episode(agent, world, episode, c, 0) for c in CONDITIONS]


@pytest.mark.slow
def test_measures_do_not_depend_on_the_cache():
    agent, episode, world = wanderer(stop=0.0), load_episodes("val_seen")[0], ApartmentsWorld(SIZE)
    alone = measured(agent, episode, world)
    with agent.remembering(), world.remembering():
        assert measured(agent, episode, world) == alone
        features, rendered = len(agent._memory), len(world._memory)
    looks = sum(row["decisions"] for row in alone)
    assert rendered < looks and features < 2 * looks


class Scribbler:
    """An agent that modifies its observation and stores a copy of the first one."""

    def reset(self, instruction):
        self.seen = []

    def act(self, observation):
        for name in (RGB, DEPTH):
            self.seen.append(observation[name].copy())
            observation[name][:] = 0
        return STOP


def test_agent_cannot_change_cached_frames():
    agent, episode, world = Scribbler(), load_episodes("val_seen")[0], ApartmentsWorld(SIZE)
    looks = []
    with world.remembering():
        for _ in range(2):
            run_episode(agent, world, episode, CLEAN, 0)
            looks.append(agent.seen)
        assert len(world._memory) == 1
    assert all(np.array_equal(a, b) for a, b in zip(*looks, strict=True))


def encoded(agent):
    """Return a list that gets a new element for each call of the RGB encoder."""
    calls = []
    agent.rgb_encoder.register_forward_hook(lambda *_: calls.append(1))
    return calls


def test_cache_encodes_equal_frames_once():
    agent, episode, world = wanderer(stop=50.0), load_episodes("val_seen")[0], ApartmentsWorld(SIZE)
    calls = encoded(agent)

    def twice():
        before = len(calls)
        for _ in range(2):
            run_episode(agent, world, episode, CLEAN, 0)
        return len(calls) - before

    assert twice() == 2
    with agent.remembering():
        assert twice() == 1
        agent.train()
        assert twice() == 2
        agent.eval()
    assert twice() == 2


def test_cache_is_cleared_when_weights_change():
    agent, episode, world = wanderer(stop=50.0), load_episodes("val_seen")[0], ApartmentsWorld(SIZE)
    calls = encoded(agent)
    for _ in range(2):
        with agent.remembering():
            run_episode(agent, world, episode, CLEAN, 0)
        with torch.no_grad():
            agent.rgb_encoder.embed.weight += 1
    assert len(calls) == 2


class Mortal(torch.nn.Module):
    """An agent that stops at once. In its third episode it kills its process, unless ``deaths``
    processes have been killed already."""

    # empty settings, because a fingerprint of the attributes would change with each episode
    settings = dict

    def __init__(self, folder, deaths=1):
        super().__init__()
        self.folder, self.deaths = folder, deaths
        self.weight = torch.nn.Parameter(torch.zeros(1))
        self.episodes = 0

    def reset(self, instruction):
        self.episodes += 1
        if self.episodes == 3 and any(map(self._dies_as, range(self.deaths))):
            os.kill(os.getpid(), signal.SIGKILL)

    def _dies_as(self, number):
        """Return whether this process is the first to claim ``number``, even if two try at once."""
        try:
            (self.folder / f"died{number}").touch(exist_ok=False)
        except FileExistsError:
            return False
        return True

    def act(self, observation):
        return STOP


def run(agent, out, count):
    options = {"name": "test", "out": out, "split": "val_seen", "workers": count}
    return evaluate(
        agent,
        partial(ApartmentsWorld, SIZE),
        load_episodes("val_seen")[:3],
        CONDITIONS[:4],
        **options,
    )


@pytest.mark.slow
def test_killed_worker_does_not_change_rows(tmp_path, capsys):
    alone = run(Mortal(tmp_path, deaths=0), tmp_path / "alone.jsonl", 1)
    assert run(Mortal(tmp_path), tmp_path / "killed.jsonl", 2) == alone
    assert (tmp_path / "killed.jsonl").read_bytes() == (tmp_path / "alone.jsonl").read_bytes()
    assert "again in a new" in capsys.readouterr().out


def test_second_killed_worker_keeps_finished_rows(tmp_path):
    out = tmp_path / "rows.jsonl"
    with pytest.raises(
        workers.WorkersDied, match=r"finished rows are in .*rows.jsonl. Run the same"
    ):
        run(Mortal(tmp_path, deaths=9), out, 2)
    remaining = rows.read(out)
    assert remaining and len(remaining) < 12
    assert len(run(Mortal(tmp_path, deaths=0), out, 1)) == 12
