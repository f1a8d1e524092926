"""Tests of ``mitigate.harden``, which hardens policies from other libraries without an expert."""

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium import spaces
from torch import nn

import mitigate
from mitigate.agents.policies.wrapping import as_policy
from mitigate.core import checkpoint
from mitigate.recipes.ppo import Ppo
from mitigate.recipes.self_distil import SelfDistil
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes


class Lights(gymnasium.Env):
    """An environment of five steps. At each step, the policy must choose the lit side."""

    def __init__(self, continuous=False, size=16):
        self.observation_space = spaces.Box(0, 255, (size, size, 3), np.uint8)
        self.action_space = (
            spaces.Box(-1, 1, (1,), np.float32) if continuous else spaces.Discrete(2)
        )
        self.continuous = continuous

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.steps = self.right = 0
        return self.observe(), {}

    def observe(self):
        self.side = int(self.np_random.integers(2))
        frame = np.full(self.observation_space.shape, 90, np.uint8)
        frame[4:12, 8 * self.side + 2 : 8 * self.side + 7] = (40, 220, 40)
        return frame

    def step(self, action):
        chosen = float(action[0]) > 0 if self.continuous else int(action)
        reward = float(chosen == self.side)
        self.right += reward
        self.steps += 1
        return self.observe(), reward, self.steps == 5, False, {"success": self.right == 5}


class Net(nn.Module):
    def __init__(self, outputs=2):
        super().__init__()
        self.conv = nn.Conv2d(3, 8, 4, 4)
        self.head = nn.Linear(128, outputs)

    def forward(self, frames):
        return self.head(self.conv(frames.permute(0, 3, 1, 2).float() / 255).relu().flatten(1))


def trained(continuous=False):
    torch.manual_seed(0)
    net, env = Net(1 if continuous else 2), Lights(continuous)
    optimizer = torch.optim.Adam(net.parameters(), 1e-2)
    env.reset(seed=7)
    for _ in range(60):
        frames, sides = zip(*[(env.observe(), env.side) for _ in range(16)], strict=True)
        output, target = net(torch.from_numpy(np.stack(frames))), torch.tensor(sides)
        loss = (
            (output[:, 0] - (2.0 * target - 1)).square().mean()
            if continuous
            else nn.functional.cross_entropy(output, target)
        )
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    return net


def imitate(policy, env):
    """Train a stable-baselines3 policy to choose the side of the light."""
    optimizer = torch.optim.Adam(policy.parameters(), 1e-3)
    env.reset(seed=7)
    for _ in range(40):
        frames, sides = zip(*[(env.observe(), env.side) for _ in range(16)], strict=True)
        inputs, _ = policy.obs_to_tensor(np.stack(frames))
        loss = -policy.get_distribution(inputs).log_prob(torch.tensor(sides)).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()


def world():
    return GymWorld(Lights())


def continuous_world():
    return GymWorld(Lights(True), score="return")


SHORT = {"steps": 6, "every": 3, "episodes": 2, "batch": 8, "suite": ["low_light", "spatter"]}
SHORT |= {"validation": 0}
FEW = seeded_episodes(range(4))


def test_harden_returns_and_writes_a_hardened_copy_and_a_report(tmp_path):
    net = trained()
    before = checkpoint.weights_sha(net)
    result = mitigate.harden(net, world, listed=FEW, out=tmp_path, **SHORT)
    assert checkpoint.weights_sha(net) == before
    assert type(result.policy) is Net
    assert checkpoint.weights_sha(result.policy) != before
    assert {row["name"] for row in result.rows} == {"before", "after", "random"}
    line = result.report.line("**SR (%), mean of 2 corruptions**")
    assert line.values["before"].value == 100.0
    assert "| change |" in str(result)
    loaded = mitigate.load_policy(Net(), tmp_path / "agent")
    assert checkpoint.weights_sha(loaded) == checkpoint.weights_sha(result.policy)


class FixedLights(Lights):
    """Lights with spaces that are class attributes."""

    observation_space = spaces.Box(0, 255, (16, 16, 3), np.uint8)
    action_space = spaces.Discrete(2)

    def __init__(self):
        self.continuous = False


def test_harden_repeats_with_spaces_of_the_class(tmp_path, capsys):
    def make():
        return GymWorld(FixedLights())

    options = SHORT | {"listed": FEW, "out": tmp_path}
    first = mitigate.harden(trained(), make, **options)
    assert "cannot be read" not in capsys.readouterr().out
    again = mitigate.harden(trained(), make, **options)
    assert capsys.readouterr().out.count("all already done") == 3  # before, random and after
    assert again.rows == first.rows


def test_harden_repeats_an_unreadable_world_with_a_version(tmp_path, capsys):
    class Unreadable(FixedLights):
        numbers = iter([1])

    def make():
        return GymWorld(Unreadable())

    options = SHORT | {"listed": FEW, "out": tmp_path}
    for _ in range(2):
        mitigate.harden(trained(), make, version="1", **options)
    assert capsys.readouterr().out.count("all already done") == 3
    with pytest.raises(ValueError, match="version: 1 -> 2"):
        mitigate.harden(trained(), make, version="2", **options)
    with pytest.raises(ValueError, match="version must be a non-empty string, got 1"):
        mitigate.harden(trained(), make, version=1, **options)


PPO = {"method": "ppo", "steps": 6, "rollout": 15, "epochs": 2, "batch": 7}
PPO |= {"suite": ["low_light", "spatter"], "critic_rounds": 0, "validation": 0}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "options"),
    [
        (SelfDistil, SHORT),
        (SelfDistil, SHORT | {"tune": "adapters"}),
        (Ppo, PPO),
    ],
)
def test_harden_resumes_to_the_same_bits(tmp_path, kind, options, monkeypatch):
    whole = mitigate.harden(trained(), world, listed=FEW, out=tmp_path / "whole", **options)
    forward, calls = kind.forward, []

    def interrupted(self, batch):
        calls.append(1)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return forward(self, batch)

    monkeypatch.setattr(kind, "forward", interrupted)
    with pytest.raises(KeyboardInterrupt):
        mitigate.harden(trained(), world, listed=FEW, out=tmp_path / "cut", **options)
    resumed = mitigate.harden(trained(), world, listed=FEW, out=tmp_path / "cut", **options)
    assert len(calls) > 5
    assert checkpoint.weights_sha(resumed.policy) == checkpoint.weights_sha(whole.policy)
    assert [r["success"] for r in resumed.rows] == [r["success"] for r in whole.rows]


@pytest.mark.slow
def test_harden_with_adapters_leaves_the_policy_frozen(tmp_path):
    net = trained()
    result = mitigate.harden(net, world, listed=FEW, tune="adapters", out=tmp_path, **SHORT)
    for name, value in net.state_dict().items():
        assert torch.equal(result.policy.state_dict()[name], value)
    loaded = mitigate.load_policy(trained(), tmp_path / "agent")
    frames = torch.from_numpy(np.stack([Lights().reset(seed=s)[0] for s in range(4)]))
    assert torch.equal(loaded(frames), result.policy(frames))


@pytest.mark.parametrize(
    ("method", "tune", "rate"),
    [("self_distil", "all", 1e-3), ("self_distil", "adapters", 2e-3), ("ppo", "all", 3e-4)],
)
def test_adapters_have_a_higher_learning_rate(tmp_path, monkeypatch, method, tune, rate):
    given = {}

    class Stop(Exception):
        pass

    def trainer(objective, **options):
        given.update(options)
        raise Stop

    monkeypatch.setattr("mitigate.shipping.harden.Trainer", trainer)
    with pytest.raises(Stop):
        options = (SHORT if method == "self_distil" else PPO) | {"tune": tune}
        mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **options)
    assert given["lr"] == rate


@pytest.mark.slow
def test_harden_with_ppo_and_adapters_leaves_the_policy_frozen(tmp_path):
    net = trained()
    options = PPO | {"tune": "adapters", "schedule": "per_frame"}
    result = mitigate.harden(net, world, listed=FEW, out=tmp_path, **options)
    for name, value in net.state_dict().items():
        assert torch.equal(result.policy.state_dict()[name], value)
    assert len(result.policy.state_dict()) > len(net.state_dict())


@pytest.mark.slow
def test_harden_continuous_policy_reports_the_return(tmp_path):
    result = mitigate.harden(trained(True), continuous_world, listed=FEW, out=tmp_path, **SHORT)
    assert result.report.line("Return: Clean").values["before"].value == 5.0
    assert result.report.line("Retention: Spatter").values["after"].value == pytest.approx(1.0)
    loaded = as_policy(mitigate.load_policy(Net(1), tmp_path / "agent"), continuous_world())
    observation = continuous_world().reset(FEW[0])
    np.testing.assert_array_equal(loaded.act(observation), result.agent.act(observation))


@pytest.mark.parametrize("continuous", [False, True])
def test_harden_stops_before_training_without_skill(tmp_path, continuous):
    net = Net(1 if continuous else 2)
    with torch.no_grad():
        net.head.weight.zero_()
        net.head.bias.copy_(torch.ones(1) if continuous else torch.tensor([0.0, 1.0]))  # right
    listed = seeded_episodes([3, 5])
    make = continuous_world if continuous else world
    with pytest.raises(ValueError, match="no better than random"):
        mitigate.harden(net, make, listed=listed, out=tmp_path, **SHORT)
    assert not list((tmp_path / "training").glob("step-*"))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"steps": 0}, "steps must be"),
        ({"stepz": 3}, "Did you mean steps"),
        ({"tune": "adapter"}, "all, adapters"),
        ({"suite": ["spater"]}, "spatter"),
        ({"suite": "fulll"}, "full"),
        ({"suite": "flare"}, r'suite=\["spatter", "flare"\]'),
        ({"batch": "a"}, "batch must be a whole number"),
        ({"world": GymWorld(Lights())}, "must be a function"),
        ({"world": Lights}, "not a world"),
        ({"training": seeded_episodes([2, 3, 9])}, "share 2 episodes"),
        ({"w_policy": -1}, "w_policy"),
        ({"method": "a2c"}, "self_distil, ppo"),
        ({"schedule": "per_day"}, "per_episode, per_frame"),
        ({"method": "ppo"}, "'episodes'.*rollout, epochs"),
        ({"listed": range(5)}, r"listed must .*got 0.*listed=seeded_episodes\(range\(5\)\)"),
        ({"listed": 5}, "listed must contain only Episode objects, got 5"),
        ({"listed": []}, "listed must hold at least one episode"),
        ({"training": range(5)}, r"training must .*got 0.*training=seeded_episodes"),
    ],
)
def test_harden_rejects_arguments_before_any_episode(tmp_path, options, message):
    arguments = {"world": world, "listed": FEW} | SHORT | options
    with pytest.raises(ValueError, match=message):
        mitigate.harden(trained(), out=tmp_path, **arguments)
    assert not (tmp_path / "rows.jsonl").exists()


@pytest.mark.slow
def test_harden_takes_a_model_of_stable_baselines(tmp_path):
    sb3 = pytest.importorskip("stable_baselines3")
    wide = {"size": 36}
    env = Lights(**wide)
    model = sb3.PPO("CnnPolicy", env, n_steps=16, batch_size=16, seed=0)
    imitate(model.policy, env)
    result = mitigate.harden(
        model, lambda: GymWorld(Lights(**wide)), listed=FEW, out=tmp_path, **SHORT
    )
    frame, _ = env.reset(seed=0)
    action, _ = result.policy.predict(frame, deterministic=True)
    assert int(action) == result.agent.act(GymWorld(env).reset(FEW[0]))
    assert result.policy.policy is not model.policy


@pytest.mark.slow
def test_harden_names_frames_that_were_lost(tmp_path):
    mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **SHORT)
    for file in (tmp_path / "frames").iterdir():
        file.unlink()
    newest = max((tmp_path / "training").glob("step-*.pt"))
    newest.unlink()
    with pytest.raises(ValueError, match="cannot resume without its stored frames"):
        mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **SHORT)


@pytest.mark.slow
def test_harden_rejects_another_policy_in_the_folder(tmp_path):
    mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **SHORT)
    other = trained()
    with torch.no_grad():
        other.head.bias.add_(1)
    rows = (tmp_path / "rows.jsonl").read_bytes()
    with pytest.raises(ValueError, match=r"other settings \(policy: .*out="):
        mitigate.harden(other, world, listed=FEW, out=tmp_path, **SHORT)
    for changed in ({"training": seeded_episodes([90])}, {"severity": 0.9}, {"validation": 3}):
        with pytest.raises(ValueError, match=rf"other settings \({next(iter(changed))}: .*out="):
            mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **SHORT | changed)
    assert (tmp_path / "rows.jsonl").read_bytes() == rows


@pytest.mark.slow
def test_harden_rejects_another_world_in_the_folder(tmp_path):
    mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **SHORT)
    with pytest.raises(ValueError, match="another world"):
        mitigate.harden(
            trained(), lambda: GymWorld(Lights(), limit=3), listed=FEW, out=tmp_path, **SHORT
        )


@pytest.mark.slow
def test_harden_leaves_out_corruptions_of_sensors_that_are_not_read(tmp_path, capsys):
    options = SHORT | {"suite": ["low_light", "missing_data"]}
    result = mitigate.harden(trained(), world, listed=FEW, out=tmp_path, **options)
    assert "reads only rgb: left out missing_data" in capsys.readouterr().out
    assert {row["corruption"] for row in result.rows} == {"clean", "low_light"}


def test_harden_names_corruptions_of_a_sensor_that_the_policy_does_not_read(tmp_path, capsys):
    from tensordict.nn import TensorDictModule

    class LightsWithDepth(Lights):
        def __init__(self):
            super().__init__()
            depth = spaces.Box(0, 10, (16, 16, 1), np.float32)
            self.observation_space = spaces.Dict({"rgb": self.observation_space, "depth": depth})

    actor = TensorDictModule(Net(), ["rgb"], ["logits"])
    options = SHORT | {"suite": ["low_light", "missing_data"], "w_feat": -1}
    with pytest.raises(ValueError, match="w_feat"):
        mitigate.harden(actor, lambda: GymWorld(LightsWithDepth()), out=tmp_path, **options)
    assert "reads only rgb: left out missing_data" in capsys.readouterr().out


def test_harden_does_not_report_corruptions_of_a_suite_for_sensors_that_the_world_lacks(
    tmp_path, capsys
):
    options = SHORT | {"suite": "quick", "w_feat": -1}
    with pytest.raises(ValueError, match="w_feat"):
        mitigate.harden(trained(), world, out=tmp_path, **options)
    assert "left out" not in capsys.readouterr().out


def test_benchmark_takes_a_policy_of_another_library(tmp_path):
    entry = mitigate.benchmark(trained(), world=world, listed=FEW, suite=["spatter"], out=tmp_path)
    assert entry.name == "Net"
    assert entry.SR["clean"][0] == 1.0
    assert "PRS-SR (RGB): 1.00 [–]" in str(entry)  # no resample differs


def test_benchmark_says_that_the_list_is_short_and_constructs_few_worlds(tmp_path, capsys):
    made = []

    def counting():
        made.append(world())
        return made[-1]

    options = {"world": counting, "listed": FEW, "suite": ["spatter"], "out": tmp_path}
    mitigate.benchmark(trained(), episodes=10, **options)
    assert f"episodes=10, but the list holds only {len(FEW)}" in capsys.readouterr().out
    assert len(made) == 2  # some simulators allow only a few at once


def test_benchmark_calls_the_network_with_forward(tmp_path):
    class Agent(nn.Module):
        def __init__(self):
            super().__init__()
            self.actor = trained()

    entry = mitigate.benchmark(
        Agent(),
        forward=lambda net, frames: net.actor(frames),
        world=world,
        listed=FEW,
        suite=["spatter"],
        out=tmp_path,
    )
    assert entry.SR["clean"][0] == 1.0


def test_benchmark_reuses_rows_of_a_policy_with_a_forward_function(tmp_path, capsys):
    sign = 1
    policies = [
        as_policy(trained(), world(), forward=lambda net, frames: sign * net(frames)),
        as_policy(trained(), world(), forward=lambda net, frames: sign * net(frames)),
        as_policy(trained(), world(), forward=lambda net, frames: -sign * net(frames)),
    ]
    entries, printed = [], []
    for policy in policies:
        entries.append(
            mitigate.benchmark(policy, world=world, listed=FEW, suite=["spatter"], out=tmp_path)
        )
        printed.append(capsys.readouterr().out)
    first, again, other = entries
    assert "cannot be read" not in printed[0]
    assert "all already done" in printed[1] and first.agents == again.agents
    assert "another agent" in printed[2] and first.agents != other.agents
    assert (first.SR["clean"][0], other.SR["clean"][0]) == (1, 0)


def test_benchmark_reports_the_return_and_reuses_rows(tmp_path, capsys):
    for _ in range(2):
        report = mitigate.benchmark(
            trained(True), world=continuous_world, listed=FEW, suite=["spatter"], out=tmp_path
        )
        assert report.line("Return: Clean").values["Net"].value == 5.0
    assert "all already done" in capsys.readouterr().out


def test_benchmark_leaves_out_corruptions_of_sensors_that_the_world_lacks(tmp_path, capsys):
    entry = mitigate.benchmark(trained(), world=world, listed=FEW, suite="quick", out=tmp_path)
    assert "the world has no depth: left out" in capsys.readouterr().out
    assert "missing_data" not in entry.SR
