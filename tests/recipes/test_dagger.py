"""Tests that DAgger learns from new and stored rollouts, and that a resumed run samples the same
rollouts."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import torch

from mitigate.agents.recurrent import RecurrentAgent
from mitigate.core.seeding import seed_everything
from mitigate.corruptions import Schedule
from mitigate.recipes.dagger import Dagger
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.tiny import assemble

SMALL = {"width": 16, "heads": 2, "text_layers": 1}


def recipe(folder, **settings) -> Dagger:
    seed_everything(0, "dagger")
    agent = RecurrentAgent(["rgb"], 8, 8, SMALL, size=16)
    options = {
        "steps": 10,
        "episodes": 2,
        "every": 2,
        "walks": 3,
        "train_parts": "policy",
        **settings,
    }
    world = partial(ApartmentsWorld, 16, 2, views=1)
    return assemble(
        Dagger, agent, world=world, training=DrawnEpisodes(2), folder=str(folder), **options
    ).eval()


def walks(batch: dict) -> list[str]:
    """Return the episode id of each rollout in a batch."""
    ids, rows = batch["episode_ids"], batch["decisions"].walk.tolist()
    return [ids[rows.index(walk)] for walk in range(max(rows) + 1)]


def test_step_learns_from_fresh_and_stored_rollouts(tmp_path):
    objective = recipe(tmp_path)
    assert [len(walks(objective.batch(step))) for step in range(5)] == [2, 2, 3, 3, 3]
    assert len(list(tmp_path.glob("*.pt"))) == 6  # 3 steps stored 2 rollouts each


@pytest.mark.slow
def test_resumed_run_draws_the_same_rollouts(tmp_path):
    objective = recipe(tmp_path)
    batches = [objective.batch(step) for step in range(4)]
    again = recipe(tmp_path).batch(3)
    assert walks(again) == walks(batches[3])
    assert torch.equal(again["decisions"].moves, batches[3]["decisions"].moves)


def test_missing_stored_rollout_stops_a_resume(tmp_path):
    recipe(tmp_path).batch(0)
    for file in tmp_path.glob("*.pt"):
        file.write_bytes(file.read_bytes()[:100])
    with pytest.raises(ValueError, match="000000-.*missing or damaged.*start again"):
        recipe(tmp_path).batch(1)


def test_stored_rollouts_are_plain_data_and_half_as_large(tmp_path):
    objective = recipe(tmp_path)
    objective.batch(0)
    piece = torch.load(next(tmp_path.glob("*.pt")), weights_only=True)
    assert piece["seen"]["views"].dtype == torch.float16


@pytest.mark.slow
def test_kept_walks_have_gradients_as_fresh_ones(tmp_path):
    objective = recipe(tmp_path, every=1).train()
    for step in range(2):
        objective(objective.batch(step))["loss"].backward()
    assert objective.agent.policy.first.weight_hh.grad.abs().sum() > 0


def test_oracle_share_falls_over_the_steps(tmp_path):
    objective = recipe(tmp_path, follow_oracle=0.25)
    shares = [objective.jobs(step)[0][-1] for step in (0, 2, 6, 8)]
    assert shares[0] == 1 and shares == sorted(shares, reverse=True)
    assert shares[-2:] == pytest.approx([0.25, 0.25])


def test_only_the_policy_trains(tmp_path):
    objective = recipe(tmp_path)
    trained = {name.split(".")[1] for name, p in objective.named_parameters() if p.requires_grad}
    assert trained == {"policy"}


def test_walks_that_are_no_plain_data_are_refused(tmp_path):
    objective = recipe(tmp_path)
    with pytest.raises(ValueError, match=r"got object in the result.*recipe=imitation"):
        objective.collate(0, [(object(), None)])
    with pytest.raises(ValueError, match=r"got ndarray in the result\[0\]\['rgb'\]"):
        objective.collate(0, [([{"rgb": np.zeros(2)}], None)])


def test_schedule_by_success_is_rejected(tmp_path):
    with pytest.raises(ValueError, match="which this recipe does not measure"):
        recipe(tmp_path, schedule=Schedule("success_distributed", 0.6))
