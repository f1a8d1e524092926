"""Tests of test-time adaptation: what changes during an episode, and that all changes are undone
after it."""

import json

import pytest
import torch
from torch import nn

import mitigate
from mitigate.agents.policies.wrapping import as_policy
from mitigate.core import checkpoint
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.episode_lists import training_episodes
from mitigate.evaluation.evaluator import EpisodeJob, EpisodeTask
from mitigate.guards.adaptation.norm import Norm
from mitigate.guards.adaptation.recentre import Recentre
from mitigate.guards.adaptation.tent import Tent
from mitigate.guards.guard import Guard, Guards
from mitigate.guards.opening import labels, open_guards
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes
from tests.shipping.test_harden import Lights, Net, trained

DARK = Corruption("low_light", 0.8)
EPISODES = seeded_episodes(range(6))


class Normalised(nn.Module):
    """A network with BatchNorm and LayerNorm."""

    def __init__(self):
        super().__init__()
        self.conv = nn.Conv2d(3, 8, 4, 4)
        self.norm = nn.BatchNorm2d(8)
        self.layer = nn.LayerNorm(128)
        self.head = nn.Linear(128, 2)

    def forward(self, frames):
        features = self.norm(self.conv(frames.permute(0, 3, 1, 2).float() / 255)).relu()
        return self.head(self.layer(features.flatten(1)))


def world():
    return GymWorld(Lights())


def normalised():
    torch.manual_seed(0)
    return Normalised().eval()


def recentred(agent, **options):
    guard = Recentre(**options)
    guard.calibrate(agent, world(), training_episodes(world(), None))
    return guard


def guard_of(kind, agent, **options):
    if kind == "recentre":
        return recentred(agent, **options)
    return {"norm": Norm, "tent": Tent}[kind](**options)


def answers(agent, guard, episodes, conditions=(DARK,)):
    """Run some episodes and return the logits of every decision."""
    outputs = []
    handle = agent.network.register_forward_hook(
        lambda *call: None if torch.is_grad_enabled() else outputs.append(call[2].clone())
    )
    here = world()
    for episode in episodes:
        for condition in conditions:
            run_episode(agent, here, episode, condition, 0, Guards([guard]))
    handle.remove()
    return outputs


KINDS = ("norm", "tent", "recentre")


@pytest.mark.parametrize("kind", KINDS)
def test_adaptation_changes_decisions_and_restores_the_agent(kind):
    agent = as_policy(normalised(), world())
    before = checkpoint.weights_sha(agent.network)
    flags = [parameter.requires_grad for parameter in agent.parameters()]
    plain = answers(agent, Guard(), EPISODES)
    adapted = answers(agent, guard_of(kind, agent), EPISODES)
    assert not all(torch.equal(a, b) for a, b in zip(plain, adapted, strict=True))
    assert checkpoint.weights_sha(agent.network) == before
    assert flags == [parameter.requires_grad for parameter in agent.parameters()]
    again = answers(agent, Guard(), EPISODES)
    assert all(torch.equal(a, b) for a, b in zip(plain, again, strict=True))


@pytest.mark.parametrize("guard", [Tent(lr=0.0), Norm(momentum=0.0)])
def test_adaptation_of_strength_zero_equals_no_guard(guard):
    agent = as_policy(normalised(), world())
    plain, adapted = (answers(agent, one, EPISODES) for one in (Guard(), guard))
    assert all(torch.equal(a, b) for a, b in zip(plain, adapted, strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_adaptation_per_episode_does_not_depend_on_the_order(kind):
    agent = as_policy(normalised(), world())
    guard = guard_of(kind, agent)
    forward = [answers(agent, guard, [episode]) for episode in EPISODES]
    backward = [answers(agent, guard, [episode]) for episode in reversed(EPISODES)][::-1]
    for one, other in zip(forward, backward, strict=True):
        assert all(torch.equal(a, b) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_adaptation_without_reset_continues_until_restart(kind):
    agent = as_policy(normalised(), world())
    guard = guard_of(kind, agent, reset="never")
    first, second = (answers(agent, guard, EPISODES[:1]) for _ in range(2))
    guard.restart()
    restarted = answers(agent, guard, EPISODES[:1])
    assert not torch.equal(first[-1], second[-1])
    assert all(torch.equal(a, b) for a, b in zip(first, restarted, strict=True))


def test_adaptation_restores_the_agent_after_an_error():
    agent = as_policy(normalised(), world())
    before = checkpoint.weights_sha(agent.network)
    with pytest.raises(RuntimeError, match="stopped"), Guards([Norm(), Tent()]).attach(agent):
        agent.reset("Go.")
        agent.act(world().reset(EPISODES[0]))
        assert checkpoint.weights_sha(agent.network) != before
        raise RuntimeError("stopped")
    assert checkpoint.weights_sha(agent.network) == before
    assert "act" not in vars(agent)


def test_norm_moves_statistics_to_those_of_the_frames():
    agent = as_policy(normalised(), world())
    observation = world().reset(EPISODES[0])
    agent.reset("Go.")
    with Norm(momentum=1.0).attach(agent), agent.recording("norm") as outputs:
        agent.act(observation)
    mean = outputs[0].mean((0, 2, 3))
    torch.testing.assert_close(mean, torch.zeros(8), atol=1e-5, rtol=0)


def test_tent_lowers_the_entropy_of_a_repeated_frame():
    agent = as_policy(normalised(), world())
    observation = world().reset(EPISODES[0])
    agent.reset("Go.")
    with Tent(lr=0.1).attach(agent):
        entropies = []
        for _ in range(5):
            agent.act(observation)
            entropies.append(agent.entropy(observation).item())
    assert entropies == sorted(entropies, reverse=True) and entropies[-1] < entropies[0]


class Shift(nn.Module):
    """Adds a constant to frames before a network."""

    def __init__(self, network, shift=0.0):
        super().__init__()
        self.network, self.shift = network, shift

    def forward(self, frames):
        return self.network(frames.float() + self.shift)


def test_recentre_moves_features_of_shifted_frames_to_the_clean_mean():
    agent = as_policy(Shift(Net()), world())
    guard = recentred(agent, prior=0.01)
    (mean,) = guard.means
    agent.network.shift = 40.0

    def distance(chosen):
        with chosen.attach(agent), agent.recording("network.conv") as outputs:
            run_episode(agent, world(), EPISODES[0], CLEAN, 0)
        features = torch.cat(outputs)
        return (features.mean((0, 2, 3)) - mean).norm().item()

    assert distance(guard) < 0.1 * distance(Guard())


def test_norm_and_tent_name_the_alternative_without_normalisation():
    agent = as_policy(Net(), world())
    for guard in (Norm(), Tent()):
        with pytest.raises(ValueError, match="Net|Policy.*adapt=recentre"):
            guard.check_agent(agent)


def test_tent_rejects_continuous_actions_and_agents_without_entropy():
    continuous = lambda: GymWorld(Lights(True), score="return")  # noqa: E731
    agent = as_policy(
        nn.Sequential(nn.Flatten(), nn.LayerNorm(768), nn.Linear(768, 1)), continuous()
    )
    with pytest.raises(ValueError, match="entropy of discrete actions"):
        Tent().check_agent(agent)
    with pytest.raises(ValueError, match=r"no entropy\(observation\)"):
        Tent().check_agent(normalised())


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Norm(momentum=2), "momentum must be"),
        (lambda: Tent(lr=-1), "lr must be"),
        (lambda: Recentre(prior=0), "prior must be"),
        (lambda: Tent(reset="weekly"), "episode, never"),
        (lambda: open_guards(None, None, adapt="tend"), "tent"),
        (lambda: open_guards(None, None, adapt="tent:often"), "episode, never"),
    ],
)
def test_adaptation_rejects_invalid_settings(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_open_guards_chains_adaptations():
    guards = open_guards(None, None, adapt="norm+tent:never").guards
    assert [type(guard) for guard in guards] == [Norm, Tent]
    assert [guard.reset for guard in guards] == ["episode", "never"]
    assert labels(None, None, "norm+tent:never") == ["norm+tent-never"]
    assert labels(None, None, Tent(lr=1.0)) == ["tent"]


def test_fingerprint_of_an_adaptation_covers_its_settings():
    agent = as_policy(Net(), world())
    guards = [Norm(), Norm(0.2), Norm(reset="never"), Tent(), Tent(0.2), Recentre()]
    guards += [recentred(agent), recentred(as_policy(trained(), world()))]
    assert len({guard.fingerprint() for guard in guards}) == len(guards)
    assert Tent().fingerprint() == Tent().fingerprint()


def test_recentre_needs_calibration_and_known_modules():
    agent = as_policy(Net(), world())
    with pytest.raises(ValueError, match="calibrate"):
        Recentre().check_agent(agent)
    with pytest.raises(ValueError, match="conv, head"):
        recentred(agent, modules=["stem"])


def test_agent_caches_no_features_while_a_guard_adapts_it():
    agent = as_policy(normalised(), world())
    agent.remembering = lambda: pytest.fail("the agent caches features")
    task = EpisodeTask(agent, world, Guards([Norm()]))
    with task.ready():
        jobs = [EpisodeJob(EPISODES[0], DARK, {"seed": 0})]
        assert [row["steps"] for row in task.work(jobs)] == [5]


ARGUMENTS = {"world": world, "listed": EPISODES, "suite": ["low_light", "spatter"], "severity": 0.8}


@pytest.mark.parametrize("adapt", ["recentre", "norm+tent"])
def test_benchmark_adapts_and_separates_its_rows(tmp_path, adapt):
    net = normalised()
    with torch.no_grad():
        net.head.weight.mul_(3)
    for choice in (None, adapt):
        mitigate.benchmark(net, adapt=choice, out=tmp_path, **ARGUMENTS)
    rows = [json.loads(line) for line in (tmp_path / "rows.jsonl").read_text().splitlines()]
    assert {row["name"] for row in rows} == {"Normalised", f"Normalised+{adapt}"}
    assert len({row["agent"] for row in rows}) == 2


@pytest.mark.slow
def test_benchmark_without_reset_repeats_episodes_before_missing_rows(tmp_path):
    net = normalised()
    options = ARGUMENTS | {"adapt": Tent(lr=0.5, reset="never")}
    mitigate.benchmark(net, out=tmp_path / "whole", **options)
    file = tmp_path / "whole" / "rows.jsonl"
    whole = file.read_text().splitlines()
    assert len({json.loads(line)["return"] for line in whole}) > 1, "the rows must differ"
    cut = [line for line in whole if json.loads(line)["episode_id"] in ("0", "1", "4")]
    file.write_text("\n".join(cut) + "\n")
    mitigate.benchmark(net, out=tmp_path / "whole", **options)
    assert sorted(file.read_text().splitlines()) == sorted(whole)
