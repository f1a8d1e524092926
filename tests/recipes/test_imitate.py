"""Tests that imitation trains only the selected parts."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from mitigate.agents.adapters import backbone_sha
from mitigate.agents.agent import Output
from mitigate.agents.topological import TopologicalAgent
from mitigate.core.checkpoint import weights_sha
from mitigate.corruptions import Schedule
from mitigate.recipes.distil import policy_kl
from mitigate.recipes.imitate import Imitate, check_losses, decide, imitation
from mitigate.training.rollouts import Rollouts, batch_of
from mitigate.training.trainer import Trainer
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.tiny import assemble

SMALL = {"heads": 2, "text_layers": 1, "layers": 1}
SOURCES = {"world": partial(ApartmentsWorld, 64, 2), "training": DrawnEpisodes(2)}
RING = {"target_modules": [], "ring": [r"rgb_encoder\.stages\.2"]}


def recipe(agent: TopologicalAgent, *parts: str) -> Imitate:
    schedule = Schedule("clean", 0.0)
    return assemble(Imitate, agent, **SOURCES, schedule=schedule, train_parts=parts, episodes=1)


def test_adapters_alone_train_in_frozen_modules(tmp_path):
    agent = TopologicalAgent(16, SMALL, adapters=RING)
    backbone, whole = backbone_sha(agent), weights_sha(agent)
    Trainer(recipe(agent, "adapters"), steps=2, folder=tmp_path, seed=0, lr=1e-2, warmup=0).fit()
    assert backbone_sha(agent) == backbone and weights_sha(agent) != whole


def test_unknown_part_is_rejected():
    with pytest.raises(ValueError, match="adapters"):
        recipe(TopologicalAgent(16, SMALL), "encoder")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"losses": {"waypoints": -1.0}}, r"losses.waypoints must be a number from 0"),
        ({"losses": {"waypoints": float("nan")}}, "losses.waypoints must be .* got nan"),
        ({"follow_oracle": 1.5}, "follow_oracle must be a fraction from 0 to 1"),
        ({"follow_oracle": -0.1}, "follow_oracle must be .* got -0.1"),
    ],
)
def test_weights_and_shares_that_make_no_sense_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        assemble(
            Imitate,
            TopologicalAgent(16, SMALL),
            **SOURCES,
            schedule=Schedule("clean", 0.0),
            **options,
        )


def test_imitate_rejects_weights_of_unknown_losses():
    agent = TopologicalAgent(16, SMALL)
    out = Output(losses={"waypoints": torch.ones(())})
    check_losses(agent, {**agent.loss_weights, "waypoints": 0.5}, out)
    with pytest.raises(
        ValueError, match=r"has a weight for 'waypoint', but decide.* are waypoints"
    ):
        check_losses(agent, {"waypoint": 0.5}, out)


def test_step_needs_an_episode():
    with pytest.raises(ValueError, match="must be a whole number >= 1, got"):
        schedule = Schedule("clean", 0.0)
        assemble(Imitate, TopologicalAgent(16, SMALL), **SOURCES, schedule=schedule, episodes=0)


def test_rollouts_measure_missing_success_rates_once():
    schedule = Schedule("success_distributed", 0.6, names=("flare",))
    objective = assemble(
        Imitate,
        TopologicalAgent(16, SMALL),
        **SOURCES,
        schedule=schedule,
        episodes=1,
        refresh_episodes=1,
    )
    assert objective.jobs(0)[0][-1]["success"].keys() == {"flare"}
    before = schedule.success = {"flare": 0.25}
    assert objective.jobs(1)[0][-1] == {"success": before}


def test_measuring_success_leaves_the_agent_in_training_mode():
    """If the agent stayed in eval mode, all later steps would train without dropout."""
    schedule = Schedule("success_distributed", 0.6, names=("flare",))
    objective = assemble(
        Imitate,
        TopologicalAgent(16, SMALL),
        **SOURCES,
        schedule=schedule,
        train_parts=("planner",),
        episodes=1,
        refresh_every=1,
        refresh_episodes=1,
    ).train()
    assert objective.jobs(0)[0][-1] == {"success": {"flare": schedule.success["flare"]}}
    assert all(module.training for module in objective.modules())


def test_nan_logits_give_nan_loss():
    """If NaN logits gave a loss of 0, only the norm of the gradient would show the error."""
    target, weight = torch.tensor([[0.0, 1.0, 0.0]]), torch.ones(1)
    decisions = SimpleNamespace(target=target, weight=weight)

    nan = float("nan")
    loss = float(imitation(Output(torch.full((1, 3), nan)), decisions, {})["loss"])
    assert loss != loss
    assert float(policy_kl(torch.zeros(1, 3), torch.full((1, 3), nan), 2.0)) != 0


def test_imitation_adds_weighted_auxiliary_losses():
    """There are two decisions with two choices each; the correct choices have the probabilities 0.8
    and 0.4."""
    logits = torch.tensor([[0.8, 0.2], [0.6, 0.4]]).log()
    decisions = SimpleNamespace(
        target=torch.tensor([[1.0, 0.0], [0.0, 1.0]]), weight=torch.tensor([1.0, 3.0])
    )
    out = Output(logits, losses={"near": torch.tensor(2.0), "far": torch.tensor(5.0)})
    values = imitation(out, decisions, {"near": 0.5})
    expected = -(1.0 * np.log(0.8) + 3.0 * np.log(0.4)) / 4.0
    assert float(values["imitation"]) == pytest.approx(expected, abs=1e-6)
    assert float(values["loss"]) == pytest.approx(expected + 0.5 * 2.0 + 5.0, abs=1e-5)
    assert float(values["accuracy"]) == 0.5


def test_every_step_and_piece_draws_other_episodes_and_keys():
    """No piece of a batch may reuse the random numbers of another piece or step."""
    drawn, keys = [], []

    class Listed(DrawnEpisodes):
        def draw(self, rng, piece):
            drawn.append(float(rng.random()))
            return super().draw(rng, piece)

    class Kept:
        def collect(self, worlds, episodes, **_):
            keys.extend((world.seed, world.name) for world in worlds)
            return []

    schedule = Schedule("per_frame", 0.6)
    how = {"episodes": 8, "follow_oracle": 1.0, "seed": 7}
    output = Rollouts(Kept(), SOURCES["world"], Listed(2), schedule, **how)
    for step in (0, 1):
        for job in output.jobs(step):
            output.work(job)
    assert len(drawn) == len({*drawn}) == len(keys) == len({*keys}) == 16
    first = [*keys]
    output.work(output.jobs(0)[0])
    assert keys[len(first) :] == first[: len(keys) - len(first)]


def test_results_of_other_types_are_named():
    agent = SimpleNamespace(decide=lambda decisions: torch.zeros(2, 4))
    with pytest.raises(ValueError, match=r"decide\(\) of SimpleNamespace must .* got Tensor"):
        decide(agent, None, {})
    with pytest.raises(ValueError, match=r"join\(\) .* with episode_ids, target, weight .* dict"):
        batch_of({"target": torch.zeros(2, 4)})
