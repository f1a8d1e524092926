"""Tests of PPO under corruption: the first loss, the critic targets, and the trained policy."""

import numpy as np
import pytest
import torch
from torch.distributions import Categorical, Normal, OneHotCategorical

from mitigate.agents.policies.actor_critic import Joint
from mitigate.agents.policies.wrapping import as_policy
from mitigate.corruptions import Schedule
from mitigate.recipes.ppo import Ppo
from mitigate.shipping.harden import _Training
from mitigate.worlds.gym import GymWorld
from tests.recipes.test_self_distil import Counting
from tests.shipping.test_harden import Lights, Net, trained

CLEAN = Schedule("clean", 0.0)
DARK = Schedule("per_frame", 1.0, names=("black_out",), clean_share=0.0)
SMALL = {"rollout": 20, "epochs": 2, "batch": 10, "critic_rounds": 0}


def objective(schedule=CLEAN, net=None, env=Lights, **options):
    world = lambda: GymWorld(env())  # noqa: E731
    torch.manual_seed(0)
    agent = as_policy(net or Net(), world())
    return Ppo(agent, world, _Training(None, []), schedule, **SMALL | options)


def test_joint_sums_the_log_probabilities_of_all_numbers_of_an_action():
    mean = torch.tensor([[0.5, -1.0, 2.0]])
    real = Joint([Normal(mean, torch.ones(3))])
    action = real.sample()
    expected = Normal(mean, torch.ones(3)).log_prob(action).sum(1)
    torch.testing.assert_close(real.log_prob(action), expected)
    logits = [torch.tensor([[0.0, 1.0]]), torch.tensor([[2.0, 0.0, 1.0]])]
    whole = Joint([Categorical(logits=part) for part in logits])
    action = torch.tensor([[1, 2]])
    expected = logits[0].log_softmax(-1)[:, 1] + logits[1].log_softmax(-1)[:, 2]
    torch.testing.assert_close(whole.log_prob(action), expected)
    assert whole.sample().shape == (1, 2)


def test_joint_gives_indices_for_one_hot_actions():
    one_hot = Joint([OneHotCategorical(logits=torch.tensor([[-50.0, 50.0, -50.0]]))])
    assert one_hot.sample().tolist() == [1]


def test_ppo_changes_no_probability_before_the_first_update():
    task = objective(DARK)
    values = task(task.batch(0))
    assert float(values["clip_fraction"]) == 0
    assert float(values["ESS"]) == pytest.approx(1.0)
    assert abs(values["objective"].item()) < 1e-6  # normalised advantages have mean 0


def test_ppo_targets_are_discounted_returns_without_bootstrapping():
    task = objective(gamma=0.5, lmbda=1.0)
    task.batch(0)
    steps = task._rollouts
    rewards = steps["value_target"].view(-1, 5) * task.scale
    decoded = rewards[:, :-1] - 0.5 * rewards[:, 1:]  # an episode has five rewards, each 0 or 1
    torch.testing.assert_close(decoded, decoded.round(), atol=1e-5, rtol=0)
    torch.testing.assert_close(rewards[:, -1], rewards[:, -1].round(), atol=1e-5, rtol=0)


class Truncated(Lights):
    """The environment ``Lights``, but a time limit ends (truncates) the episode."""

    def step(self, action):
        observation, reward, terminated, _, info = super().step(action)
        return observation, reward, False, terminated, info


def test_ppo_targets_contain_the_value_after_a_limit():
    ended, cut = objective(lmbda=0.0), objective(lmbda=0.0, env=Truncated)
    for task in (ended, cut):
        task.batch(0)
    difference = (cut._rollouts["value_target"] - ended._rollouts["value_target"]).view(-1, 5)
    assert (difference[:, :-1] == 0).all()
    assert (difference[:, -1] != 0).all()


def test_ppo_trains_only_the_critic_in_the_first_rounds():
    task = objective(DARK, critic_rounds=1)
    task(task.batch(0))["loss"].backward()
    assert all(p.grad is not None for p in task.actor.critic.parameters())
    assert all(p.grad is None for p in task.actor.policy.parameters())
    task.zero_grad()
    task(task.batch(task.steps_per_round))["loss"].backward()
    assert all(p.grad is not None for p in task.actor.policy.parameters())
    assert all(p.grad is None for p in task.behaviour.parameters())


def test_ppo_uses_each_environment_step_once_per_epoch():
    task = objective()
    batches = [task.batch(step) for step in range(task.steps_per_round)]
    for epoch in (batches[:2], batches[2:]):
        log_probs = torch.cat([batch["log_prob"] for batch in epoch])
        assert torch.equal(log_probs.sort().values, task._rollouts["log_prob"].sort().values)


def test_ppo_distance_to_the_teacher_is_zero_for_clean_frames():
    clean, dark = objective(w_kl=1.0), objective(DARK, w_kl=1.0)
    assert clean(clean.batch(0))["kl_teacher"].item() == 0
    assert dark(dark.batch(0))["kl_teacher"].item() > 0


def test_ppo_repeats_an_interrupted_round_from_its_state():
    task, resumed = objective(DARK), objective(DARK, net=Net())
    task.batch(0)
    with torch.no_grad():  # an update
        task.actor.policy.network.head.bias.add_(1.0)
    expected = task.batch(1)
    resumed.load_state_dict(task.state_dict())
    batch = resumed.batch(1)
    for name in ("action", "log_prob", "advantage"):
        assert torch.equal(batch[name], expected[name])
    assert batch["environment_steps"] == expected["environment_steps"] == 20
    task.batch(task.steps_per_round)
    assert task.batch(task.steps_per_round)["environment_steps"] == 40


@pytest.mark.slow
def test_ppo_raises_the_return():
    task = objective(rollout=60, batch=60, epochs=8)
    optimizer = torch.optim.Adam([p for p in task.parameters() if p.requires_grad], 1e-2)
    returns = []
    for step in range(8 * 10):
        batch = task.batch(step)
        returns.append(batch["return"])
        optimizer.zero_grad()
        task(batch)["loss"].backward()
        optimizer.step()
    # the maximum return is 5, and random actions get 2.5
    assert returns[0] < 3.5 and returns[-1] > 4.4


@pytest.mark.parametrize("entropy", [0.0, 0.01])
def test_ppo_trains_continuous_actions_of_a_distribution(entropy):
    world = lambda: GymWorld(Lights(True), score="return")  # noqa: E731
    forward = lambda net, frames: Normal(net(frames), 0.5)  # noqa: E731
    agent = as_policy(Net(1), world(), forward=forward)
    task = Ppo(agent, world, _Training(None, []), DARK, **SMALL, w_entropy=entropy)
    batch = task.batch(0)
    assert batch["action"].shape == (10, 1)
    task(batch)["loss"].backward()
    assert agent.network.head.bias.grad is not None


def test_ppo_takes_an_actor_of_torchrl():
    modules = pytest.importorskip("torchrl.modules")
    from tensordict.nn import TensorDictModule

    actor = modules.ProbabilisticActor(
        TensorDictModule(Net(), in_keys=["pixels"], out_keys=["logits"]),
        in_keys=["logits"],
        distribution_class=modules.OneHotCategorical,
        return_log_prob=True,
    )
    task = objective(DARK, net=actor)
    batch = task.batch(0)
    task(batch)["loss"].backward()
    assert batch["action"].shape == (10,)


def test_ppo_starts_from_the_critic_of_stable_baselines():
    sb3 = pytest.importorskip("stable_baselines3")
    model = sb3.PPO("CnnPolicy", Lights(size=36), n_steps=16, batch_size=16, seed=0)
    world = lambda: GymWorld(Lights(size=36))  # noqa: E731
    task = Ppo(as_policy(model, world()), world, _Training(None, []), CLEAN, **SMALL)
    frames = {"rgb": np.stack([Lights(size=36).reset(seed=s)[0] for s in range(3)])}
    expected = model.policy.predict_values(model.policy.obs_to_tensor(frames["rgb"])[0])
    assert torch.equal(task.actor.values(frames), expected)
    task(task.batch(0))["loss"].backward()
    assert all(p.grad is not None for p in task.actor.policy.network.action_net.parameters())


@pytest.mark.parametrize(
    ("net", "recurrent", "options", "message"),
    [
        (Counting(), True, {"module": "scale"}, "has a memory.*self_distil"),
        (Net(), False, {"gamma": 1.5}, "gamma"),
        (Net(), False, {"rollout": 0}, "rollout must be"),
        (Net(), False, {"w_critic": 0}, "w_critic must be above 0"),
        (Net(), False, {"critic_rounds": -1}, "critic_rounds"),
    ],
)
def test_ppo_rejects_invalid_arguments(net, recurrent, options, message):
    world = GymWorld(Lights())
    agent = as_policy(net, world, recurrent=recurrent)
    with pytest.raises(ValueError, match=message):
        Ppo(agent, lambda: world, _Training(None, []), CLEAN, **SMALL | options)


def test_ppo_rejects_actions_without_a_distribution():
    world = GymWorld(Lights(True), score="return")
    with pytest.raises(ValueError, match="needs a distribution of actions.*Normal"):
        Ppo(as_policy(trained(True), world), lambda: world, _Training(None, []), CLEAN)


def test_ppo_rejects_a_world_without_reward():
    world = GymWorld(Lights())

    class NoReward:
        sensors = world.sensors

    with pytest.raises(ValueError, match="NoReward has no reward"):
        Ppo(as_policy(Net(), world), NoReward, _Training(None, []), CLEAN)
