"""Tests of other libraries' policies as agents: equal actions, gradients and errors."""

from dataclasses import replace

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium import spaces
from torch import nn
from torch.distributions import Categorical, Normal

from mitigate.agents.policies.answers import divergence, imitation, mode
from mitigate.agents.policies.policy import copied
from mitigate.agents.policies.wrapping import as_policy, load_policy
from mitigate.core import checkpoint
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes

ACTIONS = {
    "discrete": spaces.Discrete(3),
    "box": spaces.Box(-2.0, 1.0, (2,), np.float32),
    "multi": spaces.MultiDiscrete([2, 3]),
}


class Noise(gymnasium.Env):
    """Environment with random frames and depth in millimetres as uint16."""

    def __init__(self, actions="discrete", depth=False, size=36):
        frame = spaces.Box(0, 255, (size, size, 3), np.uint8)
        metres = spaces.Box(0, 9000, (size, size, 1), np.uint16)
        self.observation_space = spaces.Dict({"image": frame, "far": metres}) if depth else frame
        self.action_space = ACTIONS[actions]
        self.depth = depth

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.steps = 0
        self.observation_space.seed(seed)
        return self.observation_space.sample(), {}

    def step(self, action):
        assert self.action_space.contains(action)
        self.steps += 1
        return self.observation_space.sample(), 1.0, self.steps == 6, False, {"success": True}


def world_of(env):
    entries = {"rgb": "image", "depth": "far"} if env.depth else None
    return GymWorld(env, entries, unit=0.001 if env.depth else None)


def rollout(world, policy, seed=0):
    """Return the observations and actions of an episode."""
    observation = world.reset(seeded_episodes([seed])[0])
    policy.reset("")
    frames, actions = [], []
    while not world.done:
        frames.append(dict(observation))
        actions.append(policy.act(observation))
        observation = world.step(actions[-1])
    return frames, actions


@pytest.mark.parametrize("algorithm", ["PPO", "A2C", "DQN", "SAC", "TD3"])
@pytest.mark.parametrize("depth", [False, True])
def test_as_policy_acts_as_stable_baselines(algorithm, depth):
    sb3 = pytest.importorskip("stable_baselines3")
    env = Noise("box" if algorithm in ("SAC", "TD3") else "discrete", depth)
    kind = "MultiInputPolicy" if depth else "CnnPolicy"
    options = {"buffer_size": 10} if algorithm in ("DQN", "SAC", "TD3") else {}
    model = getattr(sb3, algorithm)(kind, env, seed=0, **options)
    world = world_of(env)
    frames, actions = rollout(world, as_policy(model, world))
    for observation, action in zip(frames, actions, strict=True):
        native = world.native(observation)
        expected, _ = model.predict(native, deterministic=True)
        np.testing.assert_array_equal(action, expected)
        assert env.observation_space.contains(native)


GREY = torch.tensor([0.2125, 0.7154, 0.0721], dtype=torch.float64)


def grey_and_stacked(policy, frames, stack):
    """Convert and stack frames as the wrappers of gymnasium do (docs/harden.md)."""
    grey = (frames.double() * GREY).sum(-1).to(torch.uint8)[:, None]
    stack = grey.repeat(1, 4, 1, 1) if stack is None else torch.cat([stack[:, 1:], grey], 1)
    return policy.get_distribution(stack).distribution, stack


def test_as_policy_stacks_grey_frames_in_forward():
    """A policy that was trained behind wrappers acts as in the wrapped environment."""
    sb3 = pytest.importorskip("stable_baselines3")
    from gymnasium.wrappers import FrameStackObservation, GrayscaleObservation

    wrapped = FrameStackObservation(GrayscaleObservation(Noise()), 4)
    model = sb3.PPO("CnnPolicy", wrapped, seed=0)
    world = world_of(Noise())
    policy = as_policy(model.policy, world, forward=grey_and_stacked, recurrent=True)
    frames, actions = rollout(world, policy)
    observation, _ = wrapped.reset(seed=seeded_episodes([0])[0].info["seed"])
    for action in actions:
        expected, _ = model.predict(observation, deterministic=True)
        assert action == expected
        observation, *_ = wrapped.step(expected)
    policy.answers({"rgb": frames[0]["rgb"][None]})[0][0].entropy()
    copied(policy)  # although the network stores its last distribution


def test_as_policy_remembers_as_recurrent_ppo():
    contrib = pytest.importorskip("sb3_contrib")
    env = Noise()
    model = contrib.RecurrentPPO("CnnLstmPolicy", env, seed=0)
    world = world_of(env)
    policy = as_policy(model, world)
    frames, actions = rollout(world, policy)
    state, start = None, np.array([True])
    for observation, action in zip(frames, actions, strict=True):
        expected, state = model.predict(observation["rgb"], state, start, deterministic=True)
        assert action == expected
        start = np.array([False])
    batch = {"rgb": np.stack([f["rgb"] for f in frames])}
    places = policy.answers(batch, length=len(frames))
    assert [int(mode(answer[0])[0]) for answer in places] == actions


@pytest.mark.parametrize("actions", ["discrete", "box"])
def test_as_policy_acts_as_torchrl(actions):
    from tensordict import TensorDict
    from tensordict.nn import (
        NormalParamExtractor,
        TensorDictModule,
    )
    from torchrl.modules import ProbabilisticActor, TanhNormal

    class Net(nn.Module):
        def __init__(self, count, extract):
            super().__init__()
            self.layers = nn.Sequential(nn.Conv2d(3, 4, 6, 6), nn.Flatten(), nn.Linear(144, count))
            self.extract = extract

        def forward(self, pixels):
            return self.extract(self.layers(pixels.permute(0, 3, 1, 2).float() / 255))

    torch.manual_seed(0)
    if actions == "discrete":
        module = TensorDictModule(Net(3, nn.Identity()), ["pixels"], ["logits"])
        actor = ProbabilisticActor(module, in_keys=["logits"], distribution_class=Categorical)
    else:
        module = TensorDictModule(Net(4, NormalParamExtractor()), ["pixels"], ["loc", "scale"])
        actor = ProbabilisticActor(
            module,
            in_keys=["loc", "scale"],
            distribution_class=TanhNormal,
            distribution_kwargs={"low": -2.0, "high": 1.0},
        )
    env = Noise(actions)
    world = world_of(env)
    frames, chosen = rollout(world, as_policy(actor, world))
    for observation, action in zip(frames, chosen, strict=True):
        inputs = TensorDict({"pixels": torch.from_numpy(observation["rgb"])[None]}, [1])
        with torch.no_grad():
            distribution = actor.get_dist(inputs)
        expected = (
            distribution.probs.argmax(-1)
            if actions == "discrete"
            else distribution.deterministic_sample
        )
        np.testing.assert_allclose(action, expected[0].numpy(), rtol=1e-5, atol=1e-6)


class Memory(nn.Module):
    def __init__(self):
        super().__init__()
        self.cell = nn.GRUCell(3, 5)
        self.head = nn.Linear(5, 3)

    def forward(self, frames, memory=None):
        memory = self.cell(frames.float().mean((1, 2)) / 255, memory)
        return self.head(memory), memory


def test_as_policy_takes_a_recurrent_module():
    torch.manual_seed(0)
    world = world_of(Noise())
    policy = as_policy(Memory(), world, recurrent=True)
    frames, actions = rollout(world, policy)
    batch = {"rgb": np.stack([f["rgb"] for f in frames])}
    assert [int(mode(a[0])[0]) for a in policy.answers(batch, len(frames))] == actions


def test_as_policy_splits_logits_of_several_choices():
    net = nn.Sequential(nn.Flatten(), nn.Linear(36 * 36 * 3, 5))
    world = world_of(Noise("multi"))
    _, actions = rollout(
        world, as_policy(net, world, forward=lambda net, frames: net(frames.float()))
    )
    assert all(action.shape == (2,) for action in actions)


def test_as_policy_names_entries_that_the_world_leaves_out():
    sb3 = pytest.importorskip("stable_baselines3")
    env = Noise(depth=True)
    model = sb3.PPO("MultiInputPolicy", env)
    with pytest.raises(ValueError, match="'far': 'far'"):
        as_policy(model, GymWorld(env, {"rgb": "image"}))


def test_as_policy_names_an_entry_that_the_forward_function_misses():
    world = world_of(Noise(depth=True))
    policy = as_policy(nn.Linear(1, 3), world, forward=lambda net, seen: seen["vector"])
    with pytest.raises(ValueError, match="'vector', but the world passes only image, far"):
        rollout(world, policy)


def test_as_policy_says_that_the_world_passes_only_the_frame():
    world = world_of(Noise())
    policy = as_policy(nn.Linear(1, 3), world, forward=lambda net, seen: {}["state"])
    with pytest.raises(ValueError, match="'state', but the world passes only the frame. Name"):
        rollout(world, policy)


def test_as_policy_rejects_stacked_frames():
    world = world_of(Noise())
    world.sensors["rgb"] = replace(world.sensors["rgb"], shape=(4, 36, 36, 3))
    with pytest.raises(ValueError, match="stack them in forward="):
        as_policy(Memory(), world)


def test_act_rejects_another_number_of_values():
    net = nn.Sequential(nn.Flatten(), nn.Linear(36 * 36 * 3, 7))
    world = world_of(Noise())
    with pytest.raises(ValueError, match="7 values for the 3 actions"):
        rollout(world, as_policy(net, world, forward=lambda net, seen: net(seen.float())))


def test_act_describes_what_the_network_receives():
    net = nn.Sequential(nn.Conv2d(3, 4, 6, 6), nn.Flatten(), nn.Linear(144, 3))
    world = world_of(Noise())
    with pytest.raises(
        ValueError,
        match=r"Sequential raised RuntimeError: .*uint8 \[1, 36, 36, 3\].*channels last.*forward=",
    ):
        rollout(world, as_policy(net, world))
    rollout(world, as_policy(net, world, forward=lambda net, x: net(x.permute(0, 3, 1, 2) / 255.0)))
    world = world_of(Noise(depth=True))
    with pytest.raises(
        ValueError, match=r"a dict \(image: uint8 \[1, 36, 36, 3\], far: uint16 \[1, 36, 36, 1\]\)"
    ):
        rollout(world, as_policy(net, world))


@pytest.mark.parametrize(
    ("actions", "output", "message"),
    [
        (
            "discrete",
            lambda logits: (logits.argmax(-1), logits[:, 0], logits[:, 0], logits[:, :1]),
            r"logits \[N, 3\] or a torch.distributions object, got a tuple \(int64 \[1\], ",
        ),
        ("discrete", lambda logits: (logits, logits), "recurrent=True"),
        ("discrete", lambda logits: logits.argmax(-1), r"got int64 \[1\].*no sampled action"),
        ("multi", lambda logits: logits[:, :2], r"logits \[N, 5\] .*, got float32 \[1, 2\]"),
        ("box", lambda logits: {"action": logits}, r"actions \[N, 2\] .*, got a dict \(action: "),
        ("box", lambda logits: None, "got type NoneType"),
    ],
)
def test_act_rejects_outputs_that_are_no_answer(actions, output, message):
    world = world_of(Noise(actions))
    policy = as_policy(
        nn.Linear(3, 5), world, forward=lambda net, x: output(net(x.float().mean((1, 2))))
    )
    with pytest.raises(ValueError, match=message):
        rollout(world, policy)


def test_act_rejects_a_recurrent_module_that_returns_no_memory():
    world = world_of(Noise())
    policy = as_policy(
        nn.Linear(3, 3),
        world,
        forward=lambda net, x, m: net(x.float().mean((1, 2))),
        recurrent=True,
    )
    with pytest.raises(ValueError, match=r"pair \(output, new memory\).*got float32 \[1, 3\]"):
        rollout(world, policy)


def test_as_policy_names_forward_for_a_module_without_it():
    class Agent(nn.Module):
        def __init__(self):
            super().__init__()
            self.actor = nn.Linear(3, 3)

    world = world_of(Noise())
    with pytest.raises(ValueError, match=r"Agent must have a method forward .*such as forward="):
        as_policy(Agent(), world)
    rollout(
        world, as_policy(Agent(), world, forward=lambda net, x: net.actor(x.float().mean((1, 2))))
    )


def test_as_policy_takes_a_function_that_creates_the_world():
    policy = as_policy(Memory(), lambda: world_of(Noise()), recurrent=True)
    assert policy.space.n == 3
    with pytest.raises(ValueError, match="Noise must have action_space and native"):
        as_policy(Memory(), Noise())


def test_as_policy_rejects_objects_without_weights():
    with pytest.raises(TypeError, match="stable-baselines3"):
        as_policy(object(), world_of(Noise()))


@pytest.mark.parametrize(
    "make",
    [
        lambda shift: [Categorical(logits=torch.zeros(4, 3) + shift * torch.arange(3.0))],
        lambda shift: [Normal(torch.zeros(4, 2) + shift, 1.0)],
        lambda shift: torch.randn(4, 2, generator=torch.Generator().manual_seed(0)) + shift,
    ],
    ids=["discrete", "normal", "actions"],
)
def test_divergence_is_zero_only_for_equal_answers(make):
    assert float(divergence(make(0.0), make(0.0))) == 0
    assert float(divergence(make(0.0), make(1.0))) > 0.1


def test_divergence_of_certain_answers_is_finite():
    teacher = [Categorical(logits=torch.tensor([[0.0, 90.0]]))]
    same = [Categorical(logits=torch.tensor([[0.0, 200.0]], requires_grad=True))]
    other = [Categorical(logits=torch.tensor([[200.0, 0.0]]))]
    assert divergence(teacher, same).item() == pytest.approx(0)
    assert float(divergence(teacher, other)) == pytest.approx(200)
    divergence(teacher, same).backward()


def test_imitation_matters_where_the_teacher_is_undecided():
    teacher = [Categorical(probs=torch.tensor([[0.51, 0.49]]))]
    same = [Categorical(probs=torch.tensor([[0.51, 0.49]]))]
    swapped = [Categorical(probs=torch.tensor([[0.49, 0.51]]))]
    certain = [Categorical(probs=torch.tensor([[0.99, 0.01]]))]
    assert float(divergence(teacher, swapped)) < 0.001
    losses = [float(imitation(teacher, student)) for student in (certain, same, swapped)]
    assert losses == sorted(losses)
    assert losses[1] == pytest.approx(-np.log(0.51))


def test_imitation_of_normals_is_the_relative_error_of_their_means():
    teacher = [Normal(torch.tensor([[0.0], [2.0]]), 9.0)]
    student = [Normal(torch.tensor([[1.0], [3.0]]), 1.0)]
    assert float(imitation(teacher, student)) == pytest.approx(0.5)  # error 1, variance 2


def test_divergence_of_normals_is_the_formula():
    teacher, student = [Normal(torch.tensor([[1.0, 2.0]]), 1.0)], [Normal(torch.zeros(1, 2), 1.0)]
    assert float(divergence(teacher, student)) == pytest.approx((1 + 4) / 2)


def test_native_returns_the_environment_s_own_depth():
    world = world_of(Noise(depth=True))
    observation = world.reset(seeded_episodes([0])[0])
    raw = world.env.observation_space
    raw.seed(0)
    expected = raw.sample()
    native = world.native(observation)
    np.testing.assert_array_equal(native["far"], expected["far"])
    np.testing.assert_array_equal(native["image"], expected["image"])


def test_load_policy_restores_the_weights(tmp_path):
    net = nn.Linear(3, 2)
    checkpoint.save_weights(net, tmp_path / "agent")
    other = load_policy(nn.Linear(3, 2), tmp_path / "agent")
    assert torch.equal(other.weight, net.weight)


def test_copied_policies_share_no_weights():
    policy = as_policy(Memory(), world_of(Noise()), recurrent=True)
    twin = copied(policy)
    with torch.no_grad():
        twin.network.head.weight.zero_()
    assert policy.network.head.weight.abs().sum() > 0
