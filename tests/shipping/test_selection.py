"""Tests that validation episodes decide which weights are kept: given, trained or averaged."""

from functools import partial

import pytest
import torch
from torch import nn

import mitigate
from mitigate.agents.policies.policy import copied
from mitigate.agents.policies.wrapping import as_policy
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation.evaluator import evaluate
from mitigate.shipping.selection import MIXES, average, choose, episode_scores
from mitigate.training.trainer import Trainer
from mitigate.worlds.seeded import seeded_episodes
from tests.shipping.test_harden import FEW, SHORT, trained, world

CONDITIONS = [CLEAN, Corruption("low_light", 0.6)]
EPISODES = seeded_episodes(range(100, 106))


def chosen(tmp_path, given, trained_net) -> tuple[str, nn.Module]:
    """Return the name of the chosen weights, and a network with these weights."""
    policy = as_policy(given, world())
    start = {name: value.clone() for name, value in policy.network.state_dict().items()}
    policy = copied(policy)
    policy.network.load_state_dict(trained_net.state_dict())
    measure = partial(
        evaluate,
        world=world,
        episodes=EPISODES,
        conditions=CONDITIONS,
        out=tmp_path / "rows.jsonl",
        split="validation",
    )
    return choose(policy, start, measure), policy.network


def broken() -> nn.Module:
    net = trained()
    with torch.no_grad():
        net.head.weight.neg_()  # always the wrong side
    return net


def same(one: nn.Module, other: nn.Module) -> bool:
    pairs = zip(one.state_dict().values(), other.state_dict().values(), strict=True)
    return all(torch.equal(a, b) for a, b in pairs)


def test_choose_keeps_the_given_weights_if_training_broke_the_policy(tmp_path):
    name, network = chosen(tmp_path, trained(), broken())
    assert name == "given"
    assert same(network, trained())


@pytest.mark.slow
def test_choose_takes_the_trained_weights_only_if_they_are_better(tmp_path):
    name, network = chosen(tmp_path / "better", broken(), trained())
    assert name == "trained"
    assert same(network, trained())
    assert chosen(tmp_path / "equal", trained(), trained())[0] == "given"


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ([0, 0, 0, 0], [1, 1, 1, 1], "trained"),
        ([0, 0, 0, 0], [1, 0, 0, 0], "given"),  # one lucky episode
        ([0, 0, 1, 1], [1, 1, 1, 0], "given"),
        ([0, 0, 0, 0], [1, 1, 1, 0], "trained"),
        ([1, 1, 1, 1], [1, 1, 1, 1], "given"),
    ],
)
def test_choose_keeps_the_given_weights_unless_the_gain_exceeds_its_standard_error(
    before, after, expected
):
    def measure(policy, name, version):
        successes = before if name == "given" else after
        return [
            {"rule": "goal", "corruption": corruption, "episode_id": str(n), "success": success}
            for n, success in enumerate(successes)
            for corruption in ("clean", "low_light")
        ]

    policy = as_policy(trained(), world())
    start = {name: value.clone() for name, value in policy.network.state_dict().items()}
    assert choose(policy, start, measure) == expected


def test_average_interpolates_floats_and_copies_counters():
    start = {"weight": torch.tensor([0.0, 4.0]), "batches": torch.tensor(3)}
    end = {"weight": torch.tensor([4.0, 0.0]), "batches": torch.tensor(9)}
    mixed = average(start, end, MIXES["averaged"])
    assert mixed["weight"].tolist() == [3.0, 1.0]
    assert int(mixed["batches"]) == 9
    assert torch.equal(average(start, end, 0.0)["weight"], start["weight"])
    assert torch.equal(average(start, end, 1.0)["weight"], end["weight"])


def test_score_weighs_clean_and_corrupted_episodes_equally():
    def rows(corruption, *successes):
        return [
            {"rule": "goal", "corruption": corruption, "success": success, "episode_id": str(n)}
            for n, success in enumerate(successes)
        ]

    measured = rows("clean", 1, 1) + rows("low_light", 0, 1) + rows("flare", 1, 1)
    assert episode_scores(measured).tolist() == [0.75, 1.0]


def test_harden_returns_the_given_policy_if_validation_prefers_it(tmp_path, capsys, monkeypatch):
    def fit(trainer):
        trainer.objective.agent.network.head.weight.data.neg_()

    monkeypatch.setattr(Trainer, "fit", fit)
    net = trained()
    result = mitigate.harden(net, world, listed=FEW, out=tmp_path, **(SHORT | {"validation": 4}))
    assert result.chosen == "given"
    assert same(result.policy, net)
    assert "the policy is unchanged" in " ".join(capsys.readouterr().out.split())


def test_harden_skips_validation_on_request(tmp_path):
    result = mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **SHORT)
    assert result.chosen == "trained"
    assert not (tmp_path / "validation.jsonl").exists()


def test_harden_rejects_a_negative_number_of_validation_episodes(tmp_path):
    with pytest.raises(ValueError, match="validation must be a whole number >= 0, got -1"):
        mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **(SHORT | {"validation": -1}))
