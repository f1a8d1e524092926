"""Run training rollouts of the recurrent agent, and batch their steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from mitigate.agents import observation as checked
from mitigate.agents.agent import Batch, sample
from mitigate.agents.encoders import LABELS
from mitigate.agents.recurrent.policy import Odometer
from mitigate.core.observation import POSE, STOP, Observation
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, as_world, expert_of

INFLECTION = 3.2  # weight of a step at which the expert changes its action (as in VLN-CE)
_FARTHEST = 25.0  # maximum target of the distance loss in metres; larger targets are clipped
Piece = dict[str, Any]


@dataclass
class WalkDecisions(Batch):
    """A batch with all N steps of E rollouts.

    ``seen`` holds the world's labels and observations by name. Observations are either features
    [N, F] ("views" and "clean_views") or frames [N, H, W, c] ("rgb", "clean_rgb" and so on).
    """

    walk: Tensor  # int64 [N], the rollout of each step
    time: Tensor  # int64 [N], the index of each step in its rollout
    moves: Tensor  # [N, MOVES]
    tokens: Tensor  # [E, L]
    target: Tensor  # [N, 4]
    weight: Tensor  # [N]
    metres: Tensor  # [N], the distance to the goal; NaN where it is unknown
    seen: dict[str, Tensor]
    episode_ids: list[str]  # the episode of each step

    def padded(self, flat: Tensor) -> Tensor:
        """Return ``flat`` [N, ...] as [E, T, ...], with zeros after the end of each rollout."""
        size = (len(self.tokens), int(self.time.max()) + 1)
        return flat.new_zeros(*size, *flat.shape[1:]).index_put((self.walk, self.time), flat)


class TrainingWalk:
    """One training rollout.

    It records the observation, the action and the expert's answer of each step.
    """

    def __init__(self, world: World, episode: Episode, sensors: Sequence[str]) -> None:
        self.world, self.episode, self.sensors = as_world(world), episode, sensors
        self.observation: Observation = world.reset(episode)
        self.expert, self.odometer = expert_of(world), Odometer()
        self.steps: list[dict[str, Any]] = []
        self.before = -1

    def see(self, observation: Observation) -> dict[str, np.ndarray]:
        """Return the frames of an observation; the world may reuse these arrays."""
        return {n: checked.frame(observation, n, 1) for n in self.sensors}

    def record(self, features: dict[str, np.ndarray], clean: bool, frames: bool) -> None:
        """Add the current step, labelled with the expert's answer."""
        action = int(self.expert.action())
        seen = {n: np.array(f) for n, f in self.see(self.observation).items()} if frames else {}
        seen |= features
        if clean:
            before = self.see(self.observation.clean)
            seen |= {f"clean_{n}": np.array(f) for n, f in before.items()}
        truth: Mapping[str, np.ndarray] = self.world.truth()
        labels = [*(LABELS[name] for name in self.sensors if frames), "goal"]
        seen |= {name: np.array(truth[name]) for name in labels if name in truth}
        step = {"seen": seen, "moves": self.odometer.moves(), "answer": action}
        step["weight"] = INFLECTION if action != self.before else 1.0
        step["metres"] = self._metres()
        self.steps.append(step)
        self.before = action

    def _metres(self) -> float:
        if POSE not in self.observation:
            return float("nan")
        place = np.asarray(self.observation[POSE], np.float64)[:2]
        return min(float(self.expert.distance(place)), _FARTHEST)

    def go(self, chances: np.ndarray, expert_share: float, rng: np.random.Generator) -> None:
        """Take the expert's action, or an action sampled from ``chances`` [4]."""
        action = self.steps[-1]["answer"]
        if rng.random() >= expert_share:
            sampled = sample(chances, rng)
            action = action if sampled == STOP else sampled
        self.observation = self.world.step(action)
        self.odometer.add(action)


def piece_of(walks: Sequence[TrainingWalk]) -> Piece:
    """Return rollouts as plain data: tensors and lists."""
    steps = [step for walk in walks for step in walk.steps]

    def column(name: str) -> Tensor:
        return torch.from_numpy(np.array([step[name] for step in steps], np.float32))

    return {
        "texts": [walk.episode.instruction.text for walk in walks],
        "ids": [walk.episode.episode_id for walk in walks],
        "lengths": [len(walk.steps) for walk in walks],
        "answer": torch.tensor([step["answer"] for step in steps]),
        **{name: column(name) for name in ("moves", "weight", "metres")},
        "seen": {
            name: torch.from_numpy(np.stack([step["seen"][name] for step in steps]))
            for name in steps[0]["seen"]
        },
    }
