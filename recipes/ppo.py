"""Reinforcement learning under corruption: train a policy with PPO on the reward of the world.

An already trained policy runs episodes with corrupted frames and samples its actions. It learns
from the reward of the environment with the clipped loss of PPO (Schulman et al. 2017).
``ClipPPOLoss`` and the generalised advantages come from torchrl. If ``w_kl`` is above 0, the policy
also stays near the unchanged policy, which sees the clean frames.

Training alternates between rounds of rollouts and updates. A round consists of whole episodes, and
a fixed number of training steps follows each round. The collectors of torchrl are not used, because
their environments keep running between rounds, and a resumed run could not restore the state of the
environments. In this implementation, each episode starts from its seed, and a resumed run repeats
the interrupted round with the weights at the start of that round. Therefore the resumed run gives
bit-identical weights if the environment is deterministic for a given seed and actions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents.policies.actor_critic import ActorCritic, Joint
from mitigate.agents.policies.answers import divergence
from mitigate.agents.policies.policy import Policy, last_convolution
from mitigate.core import checkpoint
from mitigate.core.contracts import read
from mitigate.core.pictures import picture
from mitigate.core.seeding import digest, generator
from mitigate.corruptions import Schedule
from mitigate.recipes.self_distil import check_frames, clean_teacher, stacked
from mitigate.training.objective import Objective, check_counts, check_share, check_weights
from mitigate.worlds.world import Corrupted, TrainingEpisodes, World

CHUNK = 256  # number of frames whose values are computed at once


class Ppo(Objective):
    """Train a policy by PPO while its frames are corrupted.

    Args:
        agent: the policy, which is trained in place. If it has adapters, only these are trained.
            The policy must return an action distribution and must have no memory.
        world: function that constructs a world with a ``reward``, such as ``GymWorld`` or
            ``EnvWorld``.
        training: source of the episodes.
        schedule: schedule that selects the corruption of each episode or frame.
        rollout: minimum number of environment steps per round. The episode that reaches this number
            is run to its end.
        epochs: number of times that each environment step of a round is used.
        batch: minimum number of environment steps per training step.
        gamma: discount factor of rewards.
        lmbda: decay factor of the generalised advantage estimation (GAE).
        clip: maximum relative change of the probability of an action in a round (the clipping
            parameter of PPO).
        w_critic, w_entropy: weights of the critic loss and of the entropy loss.
        w_kl: weight of the divergence from the unchanged policy, which sees the clean frames.
        critic_rounds: number of rounds at the start in which only the critic is trained.
        module: name of the module whose output a new critic reads. The default is the last
            convolution.
        seed: seed of episodes, corruptions and actions.

    Raises:
        ValueError: If a number is out of range, or if the world has no reward. It is also raised if
            the policy reads no frames, has a memory or returns no action distribution.
    """

    loss: Any  # ClipPPOLoss
    scale: Tensor

    def __init__(
        self,
        agent: Policy,
        world: Callable[[], World],
        training: TrainingEpisodes,
        schedule: Schedule,
        rollout: int = 1024,
        epochs: int = 4,
        batch: int = 128,
        gamma: float = 0.99,
        lmbda: float = 0.95,
        clip: float = 0.2,
        w_critic: float = 0.5,
        w_entropy: float = 0.0,
        w_kl: float = 0.0,
        critic_rounds: int = 2,
        module: str | None = None,
        seed: int = 0,
    ) -> None:
        super().__init__()
        check_weights(w_critic=w_critic, w_entropy=w_entropy, w_kl=w_kl)
        check_counts(rollout=rollout, epochs=epochs, batch=batch)
        for name, share in {"gamma": gamma, "lmbda": lmbda, "clip": clip}.items():
            check_share(name, share)
        if critic_rounds < 0:
            raise ValueError(f"critic_rounds must be >= 0, got {critic_rounds}.")
        if not w_critic:
            raise ValueError("w_critic must be above 0, because advantages need a critic, got 0.")
        check_frames(agent)
        self.training_episodes = training
        self.schedule = schedule
        self.rollout = rollout
        # both numbers count training steps, not environment steps
        self.steps_per_epoch = max(1, rollout // batch)
        self.steps_per_round = epochs * self.steps_per_epoch
        self.gamma = gamma
        self.lmbda = lmbda
        self.w_kl = w_kl
        self.critic_rounds = critic_rounds
        self.seed = seed
        # constructed only once, because constructing an environment takes time
        self.world: Any = world()
        if read(self.world, "reward") is None:
            raise ValueError(
                f"{type(self.world).__name__} has no reward, but method='ppo' needs one. GymWorld "
                "and EnvWorld have a reward. Your own world needs the attributes reward (of the "
                "last step) and terminated. Or use method='self_distil'."
            )
        example = {
            name: np.zeros((1, *sensor.shape), sensor.dtype)
            for name, sensor in self.world.sensors.items()
        }
        with _random(agent.device, seed, "ppo critic"):
            self.actor = ActorCritic(agent, example, module or last_convolution(agent))
        # a copy with the weights from the start of the round, which runs the round's episodes
        self.behaviour = self.actor.copied()
        self.teacher = clean_teacher(agent) if w_kl else None
        self.loss = _loss(self.actor, clip, w_critic, w_entropy)
        # standard deviation of the returns of the first round, by which rewards are divided
        self.register_buffer("scale", torch.ones(()))
        self._rollouts: dict[str, Any] = {}
        self._number = -1  # index of the round that ``_rollouts`` contains
        self._steps_before = 0  # number of environment steps in all earlier rounds
        self._steps_now = 0  # number of environment steps in the newest round
        self._picture: np.ndarray | None = None

    def identity(self) -> dict[str, str]:
        if self.teacher is None:
            return {}
        return {"teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def pieces(self) -> int:
        """Return 1, which requires a single process, because a process keeps its own episodes."""
        return 1

    @torch.no_grad()
    def batch(self, step: int) -> dict[str, Any]:
        """Return a minibatch of the round's environment steps. Each environment step is used once
        per epoch.
        """
        number, within = divmod(step, self.steps_per_round)
        if number != self._number:
            if within == 0:  # if not 0, a resumed run repeats the interrupted round
                self.behaviour.load_state_dict(self.actor.state_dict())
                self._steps_before += self._steps_now
            self._rollouts = self._round(number)
            self._number = number
            self._steps_now = len(self._rollouts["action"])
        epoch, part = divmod(within, self.steps_per_epoch)
        order = generator(self.seed, "ppo order", number, epoch).permutation(self._steps_now)
        rows = np.array_split(order, self.steps_per_epoch)[part]
        batch: dict[str, Any] = {
            name: {sensor: frames[rows] for sensor, frames in value.items()}
            if isinstance(value, dict)
            else value[rows]
            for name, value in self._rollouts.items()
            if name != "return"
        }
        return batch | {
            "critic_only": number < self.critic_rounds,
            "return": self._rollouts["return"],
            "environment_steps": self._steps_before + self._steps_now,
        }

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        from tensordict import TensorDict

        names = ("action", "log_prob", "advantage", "value_target")
        inputs = TensorDict({name: batch[name] for name in names}, [len(batch["action"])])
        inputs["frames"] = {name: torch.from_numpy(f) for name, f in batch["frames"].items()}
        values = self.loss(inputs)
        losses = {name: values[f"loss_{name}"] for name in ("objective", "critic")}
        loss = losses["critic"]
        if not batch["critic_only"]:
            loss = loss + losses["objective"]
            if "loss_entropy" in values:
                loss = loss + values["loss_entropy"]
        logged = {name: values[name] for name in ("clip_fraction", "kl_approx", "ESS")}
        if self.teacher is not None:
            answer = self.actor.policy.answers(batch["frames"])[0]
            with torch.no_grad():
                target = self.teacher.answers(batch["clean"])[0]
            logged["kl_teacher"] = divergence(target, answer)
            if not batch["critic_only"]:
                loss = loss + self.w_kl * logged["kl_teacher"]
        rollouts = {name: batch[name] for name in ("return", "environment_steps")}
        return {**losses, **logged, **rollouts, "loss": loss}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return {} if self._picture is None else {"seen": self._picture}

    def _round(self, number: int) -> dict[str, Any]:
        """Run the episodes of a round, and return their environment steps with advantages."""
        from torchrl.objectives.value.functional import generalized_advantage_estimate

        steps: list[dict[str, Any]] = []
        returns: list[float] = []
        with _random(self.behaviour.policy.device, self.seed, "ppo actions", number):
            while len(steps) < self.rollout:
                episode_steps = self._episode(number, len(returns))
                returns.append(sum(step["reward"] for step in episode_steps))
                steps += episode_steps
        observed = [name for name in ("frames", "clean") if name in steps[0]]
        rollouts: dict[str, Any] = {
            name: stacked([step[name] for step in steps]) for name in observed
        }
        rollouts |= {name: torch.stack([s[name] for s in steps]) for name in ("action", "log_prob")}
        rewards = np.array([step["reward"] for step in steps], np.float32)
        ends = np.array([step["done"] for step in steps])
        if number == 0:
            self.scale.fill_(float(_discounted(rewards, ends, self.gamma).std()) or 1.0)
        values = self._values(rollouts["frames"])
        after = torch.cat([values[1:], values[-1:]])
        last = [place for place, step in enumerate(steps) if "last" in step]
        if last:
            after[last] = self._values(stacked([steps[place]["last"] for place in last]))
        rewarded = torch.from_numpy(rewards)[:, None].to(values) / self.scale
        done = torch.from_numpy(ends)[:, None].to(values.device)
        terminated = torch.tensor([[s["terminated"]] for s in steps], device=values.device)
        advantage, target = generalized_advantage_estimate(
            self.gamma, self.lmbda, values, after, rewarded, done, terminated
        )
        self._picture = picture(steps[0]["frames"])
        return rollouts | {
            "advantage": advantage,
            "value_target": target,
            "return": float(np.mean(returns)),
        }

    def _episode(self, number: int, index: int) -> list[dict[str, Any]]:
        """Run an episode with sampled actions, and return its environment steps.

        If the episode ends although the task is not over, the last step also contains the frames
        after it, under "last".
        """
        policy = self.behaviour.policy
        episode = self.training_episodes.draw(
            generator(self.seed, "ppo episode", number, index), (0, 1)
        )
        world = Corrupted(self.world, self.schedule, self.seed, f"ppo {number}-{index}")
        observation = world.reset(episode)
        policy.reset(episode.instruction.text)
        steps: list[dict[str, Any]] = []
        while not world.done:
            frames = {name: np.array(observation[name]) for name in policy.sensors}
            distribution = self.behaviour.actions({n: f[None] for n, f in frames.items()})
            action = distribution.sample()
            step: dict[str, Any] = {
                "frames": frames,
                "action": action[0],
                "log_prob": distribution.log_prob(action)[0],
            }
            if self.teacher is not None:
                step["clean"] = {n: np.array(observation.clean[n]) for n in policy.sensors}
            observation = world.step(policy.executable(action[0]))
            step |= {
                "reward": float(self.world.reward),
                "done": world.done,
                "terminated": bool(self.world.terminated),
            }
            steps.append(step)
        if not steps[-1]["terminated"]:
            steps[-1]["last"] = {name: np.array(observation[name]) for name in policy.sensors}
        return steps

    def _values(self, frames: dict[str, np.ndarray]) -> Tensor:
        """Return the values [N, 1] that the critic of the current round predicts."""
        count = len(next(iter(frames.values())))
        return torch.cat(
            [
                self.behaviour.values({n: f[start : start + CHUNK] for n, f in frames.items()})
                for start in range(0, count, CHUNK)
            ]
        )

    def get_extra_state(self) -> dict[str, Any]:
        return {"steps_before": self._steps_before, "steps_now": self._steps_now}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self._steps_before = state["steps_before"]
        self._steps_now = state["steps_now"]


class _Networks:
    """The policy and its critic, with the interface that torchrl's losses expect of each."""

    in_keys = ("frames",)

    def __init__(self, actor: ActorCritic) -> None:
        self.actor = actor

    def get_dist(self, inputs: Any) -> Joint:
        return self.actor.actions(_arrays(inputs))

    def __call__(self, inputs: Any) -> Any:
        return inputs.set("state_value", self.actor.values(_arrays(inputs)))


def _arrays(inputs: Any) -> dict[str, np.ndarray]:
    return {name: frames.numpy() for name, frames in inputs["frames"].items()}


def _loss(actor: ActorCritic, clip: float, w_critic: float, w_entropy: float) -> nn.Module:
    from torchrl.objectives import ClipPPOLoss

    networks = _Networks(actor)
    loss = ClipPPOLoss(
        networks,
        networks,
        clip_epsilon=clip,
        entropy_bonus=w_entropy > 0,
        entropy_coeff=w_entropy,
        critic_coeff=w_critic,
        loss_critic_type="l2",
        normalize_advantage=True,
        functional=False,
    )
    loss.set_keys(sample_log_prob="log_prob")
    return loss


def _discounted(rewards: np.ndarray, ends: np.ndarray, gamma: float) -> np.ndarray:
    """Return the discounted returns [N], from each step to the end of its episode."""
    returns = np.zeros(len(rewards))
    following = 0.0
    for place in reversed(range(len(rewards))):
        following = rewards[place] + gamma * following * (not ends[place])
        returns[place] = following
    return returns


@contextmanager
def _random(device: torch.device, *key: int | str) -> Iterator[None]:
    """Seed torch's random number generators with ``key`` inside the ``with`` block."""
    with torch.random.fork_rng([device] if device.type == "cuda" else []):
        torch.manual_seed(digest(*key) & (2**63 - 1))
        yield
