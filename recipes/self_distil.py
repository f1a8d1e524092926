"""Self-distil a trained policy: a policy teaches a copy of itself, without an expert or rewards.

The copy (student) runs episodes under corruptions. At every step, the unchanged policy (teacher)
answers the clean frame, and the student learns to give the same answer for the corrupted frame.
This is DAgger (Ross et al. 2011), where the teacher on clean frames replaces the expert. The loss
has four terms:

* ``w_policy``: the KL divergence of the action distributions (the squared error for actions without
  a distribution),
* ``w_imitation``: the cross-entropy of the teacher's most likely action (the squared error for
  continuous actions), without which a small shift of nearly equal probabilities could change the
  action,
* ``w_feat``: the squared error of the features of one module, relative to their variance,
* ``w_consistency``: the divergence between the student's answers to two corruptions of one frame.

The severity rises during the first part of training, and the last part uses mostly clean frames, so
that the student behaves as before on clean frames (STRONG-VLA, 2026, uses the same order).

Rollouts are slower than training steps, so the student runs episodes only every ``every`` steps.
The clean frames of these episodes are stored, and each step corrupts a random sample of all stored
frames with new random numbers. If episodes are short, a round has more of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors import SafetensorError
from safetensors.numpy import load_file, save
from torch import Tensor

from mitigate.agents.adapters import adapted
from mitigate.agents.policies.answers import Answer, divergence, imitation
from mitigate.agents.policies.policy import Policy, copied, last_convolution
from mitigate.core import checkpoint
from mitigate.core.files import write_bytes
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.pictures import picture
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.recipes.distil import feature_loss
from mitigate.training.objective import Objective, check_counts, check_weights
from mitigate.worlds.world import Corrupted, TrainingEpisodes, World, depth_sensor

RISE = 0.6  # fraction of training during which the severity rises (heuristic)
SETTLE = 0.85  # after this fraction of training, most frames are clean (heuristic)
SETTLED_CLEAN = 0.75  # fraction of clean frames in the last part of training (heuristic)
# A round of short episodes continues until it has this many frames, or this many times the usual
# number of episodes (heuristic). A few hundred different frames in total are too few.
ROUND_FRAMES, ROUND_TIMES = 1000, 16


class SelfDistil(Objective):
    """Trains a policy to take the same actions under corruptions as on clean frames.

    Args:
        agent: the student, which is trained in place; if it has adapters, only these are trained.
            The teacher is a copy of the initial student without adapters.
        world: function that constructs a world.
        training: source of the episodes.
        schedule: samples the corruption of each frame.
        folder: folder of the stored frames, one file per round of rollouts.
        steps: number of training steps.
        every: number of steps between two rounds of rollouts.
        episodes: number of episodes per round; more if they are short (``ROUND_FRAMES``).
        frames: maximum number of frames that are stored per episode, at even intervals.
        batch: number of frames per step.
        window: number of consecutive frames for a recurrent policy; 1 for other policies.
        w_policy, w_imitation, w_feat, w_consistency: weights of the losses.
        module: name of the network module whose output is compared; None means the last
            convolution.
        curriculum: whether the severity rises and the last part uses mostly clean frames.
        seed: seed of episodes and corruptions.

    Raises:
        ValueError: If a number is out of range, or if the policy reads no frames or has no such
            module.
    """

    def __init__(
        self,
        agent: Policy,
        world: Callable[[], World],
        training: TrainingEpisodes,
        schedule: Schedule,
        folder: str | Path,
        steps: int,
        every: int = 300,
        episodes: int = 8,
        frames: int = 400,
        batch: int = 64,
        window: int = 16,
        w_policy: float = 1.0,
        w_imitation: float = 1.0,
        w_feat: float = 1.0,
        w_consistency: float = 0.1,
        module: str | None = None,
        curriculum: bool = True,
        seed: int = 0,
    ) -> None:
        super().__init__()
        check_weights(
            w_policy=w_policy, w_imitation=w_imitation, w_feat=w_feat, w_consistency=w_consistency
        )
        check_counts(every=every, episodes=episodes, frames=frames, batch=batch)
        check_frames(agent)
        self.agent = agent
        self.world = world
        self.training_episodes = training
        self.schedule = schedule
        self.folder = Path(folder)
        self.steps = steps
        self.every = every
        self.episodes = episodes
        self.frames = frames
        self.window = window if agent.recurrent else 1
        self.batch_windows = max(1, batch // self.window)
        self.w_policy = w_policy
        self.w_imitation = w_imitation
        self.w_feat = w_feat
        self.w_consistency = w_consistency
        self.curriculum = curriculum
        self.seed = seed
        self.teacher = clean_teacher(agent)
        self.module = module or last_convolution(agent)
        # windows of each round of rollouts, [n, window, ...]
        self._stored: list[dict[str, np.ndarray]] = []
        self._resumed_at = 0  # step of the checkpoint; the rounds before it are already stored
        self._picture: np.ndarray | None = None
        # constructed only once, because constructing an environment takes time
        self._world: World | None = None

    def identity(self) -> dict[str, str]:
        return {"teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def pieces(self) -> int:
        """Return 1, because each process trains on the frames that it stored."""
        return 1

    def batch(self, step: int) -> dict[str, Any]:
        """Return clean frames and two corrupted versions of each; the arrays of a sensor are [B *
        window, ...].
        """
        for number in range(len(self._stored), step // self.every + 1):
            self._stored.append(self._round(number * self.every))
        rng = generator(self.seed, "self-distil", step)
        ends = np.cumsum([len(next(iter(stored.values()))) for stored in self._stored])
        places = rng.integers(ends[-1], size=self.batch_windows)
        rounds = np.searchsorted(ends, places, side="right")
        clean: list[dict[str, np.ndarray]] = []
        corrupted: tuple[list, list] = ([], [])
        schedule = self.schedule_at(step)
        sensor = depth_sensor(self._shared_world().sensors)
        for place, number in zip(places, rounds, strict=True):
            within = place - (ends[number - 1] if number else 0)
            window = {name: frames[within] for name, frames in self._stored[number].items()}
            for draw, observations in enumerate(corrupted):
                name = f"{step}-{len(clean) // self.window}-{draw}"
                for frame in range(self.window):
                    observation = {n: frames[frame] for n, frames in window.items()}
                    corruption, key = schedule.draw(self.seed, name, frame)
                    observations.append(corrupt_observation(observation, corruption, key, sensor))
            clean += [{n: frames[f] for n, frames in window.items()} for f in range(self.window)]
        self._picture = picture(corrupted[0][0])
        return {
            "clean": stacked(clean),
            "first": stacked(corrupted[0]),
            "second": stacked(corrupted[1]),
        }

    def schedule_at(self, step: int) -> Schedule:
        """Return the corruption schedule that applies at training step ``step``.

        With ``curriculum``, the maximum severity rises during training, and most frames are clean
        at the end.
        """
        if not self.curriculum:
            return self.schedule
        progress = step / max(1, self.steps)
        clean_share = SETTLED_CLEAN if progress >= SETTLE else self.schedule.clean_share
        severity = self.schedule.severity
        if isinstance(severity, tuple):
            low, high = severity
            severity = (low, low + (high - low) * min(1.0, progress / RISE))
        return replace(self.schedule, severity=severity, clean_share=clean_share)

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        first, features = self._answer(self.agent, batch["first"])
        second, _ = self._answer(self.agent, batch["second"])
        with torch.no_grad():
            target, target_features = self._answer(self.teacher, batch["clean"])
        policy = (_mean(divergence, target, first) + _mean(divergence, target, second)) / 2
        imitated = (_mean(imitation, target, first) + _mean(imitation, target, second)) / 2
        values = {
            "policy": policy,
            "imitation": imitated,
            "feat": feature_loss(features, target_features),
            "consistency": _mean(divergence, first, second),
        }
        loss = self.w_policy * policy + self.w_imitation * imitated
        if self.w_feat and (features.requires_grad or not torch.is_grad_enabled()):
            loss = loss + self.w_feat * values["feat"]
        if self.w_consistency:
            loss = loss + self.w_consistency * values["consistency"]
        return {**values, "loss": loss}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return {} if self._picture is None else {"seen": self._picture}

    def _answer(self, policy: Policy, frames: dict[str, np.ndarray]) -> tuple[list[Answer], Tensor]:
        with policy.recording(self.module) as outputs:
            answers = policy.answers(frames, self.window)
        return answers, torch.cat([output.float().flatten(1) for output in outputs])

    def _round(self, step: int) -> dict[str, np.ndarray]:
        """Run the rollouts of ``step``, or read stored ones; return their windows."""
        file = self.folder / f"frames-{step:06d}.safetensors"
        if file.is_file():
            return _read(file)
        if step < self._resumed_at:
            raise ValueError(
                f"{file} is missing. Training cannot resume without its stored frames. Restore "
                "the file if you have a copy, or choose another folder (out=...)."
            )
        windows: list[dict[str, np.ndarray]] = []
        steps = 0
        for number in range(ROUND_TIMES * self.episodes):
            if number >= self.episodes and steps >= ROUND_FRAMES:
                break
            frames, length = self._rollout(step, number)
            windows.append(frames)
            steps += length
        stored = {name: np.concatenate([w[name] for w in windows]) for name in windows[0]}
        write_bytes(file, save(stored))
        return stored

    def _rollout(self, step: int, number: int) -> tuple[dict[str, np.ndarray], int]:
        """Run an episode; return its clean frames in windows, and its length in steps."""
        rng = generator(self.seed, "self-distil rollout", step, number)
        episode = self.training_episodes.draw(rng, (0, 1))
        schedule = self.schedule_at(step)
        world = Corrupted(self._shared_world(), schedule, self.seed, f"rollout {step}-{number}")
        observation = world.reset(episode)
        self.agent.reset(episode.instruction.text)
        seen: list[dict[str, np.ndarray]] = []
        while not world.done:
            seen.append({name: np.array(observation.clean[name]) for name in self.agent.sensors})
            observation = world.step(self.agent.act(observation))
        length = len(seen)
        # the last window is filled with copies of its last frame
        seen += [seen[-1]] * (-len(seen) % self.window)
        starts = np.arange(0, len(seen), self.window)
        most = max(1, self.frames // self.window)
        if len(starts) > most:
            starts = starts[np.sort(rng.choice(len(starts), most, replace=False))]
        windows = {
            name: np.stack([[frames[name] for frames in seen[s : s + self.window]] for s in starts])
            for name in seen[0]
        }
        return windows, length

    def _shared_world(self) -> World:
        """Return the world, which is constructed at the first call."""
        self._world = self._world or self.world()
        return self._world

    def get_extra_state(self) -> dict[str, Any]:
        return {"rounds": len(self._stored)}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self._resumed_at = int(state["rounds"]) * self.every


def check_frames(policy: Policy) -> None:
    """Raise ValueError if the policy reads no frames."""
    if not {RGB, DEPTH} & set(policy.sensors):
        raise ValueError(
            f"{policy.name} reads {', '.join(policy.sensors) or 'nothing'}, but no rgb and no "
            "depth, so that no corruption changes its input. Name its frames: "
            "GymWorld(entries=...)."
        )


def clean_teacher(policy: Policy) -> Policy:
    """Return a frozen copy of a policy, without adapters."""
    teacher = copied(policy)
    if adapted(teacher):
        teacher = teacher.as_teacher()
    return teacher.requires_grad_(False)


def _mean(
    loss: Callable[[Answer, Answer], Tensor], teacher: list[Answer], student: list[Answer]
) -> Tensor:
    """Return the loss averaged over the positions in a window."""
    pairs = [loss(one, other) for one, other in zip(teacher, student, strict=True)]
    return torch.stack(pairs).mean()


def stacked(observations: list[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Stack the arrays of each sensor."""
    return {name: np.stack([o[name] for o in observations]) for name in observations[0]}


def _read(file: Path) -> dict[str, np.ndarray]:
    try:
        return load_file(file)
    except (SafetensorError, OSError) as error:
        raise ValueError(
            f"The stored frames {file} are damaged. Restore the file if you have a copy, or choose "
            "another folder (out=...)."
        ) from error
