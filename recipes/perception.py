"""Pretrain the encoders on rendered views with labels that the id pass gives for free.

RGB: which things, near things, colours and rooms show in the middle of each view (binary
cross-entropy). Depth: where the agent can go straight (binary cross-entropy on the waypoint grid).
The two are independent nets; ``modality`` picks one, so that two processes can train at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.agents.concepts import THINGS, view_labels
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.waypoints import agreement, free_target, waypoint_loss
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.envs.apartments.drawing import strip
from mitigate.envs.apartments.renderer import Renderer
from mitigate.envs.apartments.simulator import apartment_of
from mitigate.evaluation.success import measure
from mitigate.keys import DEPTH, POSE, RGB, VIEWS
from mitigate.recipe import Recipe
from mitigate.seeding import generator


class PerceptionRecipe(Recipe):
    """Args: agent; modality "rgb" or "depth"; apartments: how many training layouts; panoramas: a
    batch; schedule: which panorama is hurt by what, None: none. A success-distributed schedule
    without rates starts from those of ``agent`` on ``refresh_episodes`` training episodes each.
    """

    def __init__(
        self,
        agent: TopologicalAgent,
        modality: str,
        apartments: int = 400,
        panoramas: int = 12,
        size: int = 64,
        seed: int = 0,
        schedule: Schedule | None = None,
        refresh_episodes: int = 8,
    ) -> None:
        super().__init__()
        if modality not in ("rgb", "depth"):
            raise ValueError(f"modality={modality!r} is unknown; choose 'rgb' or 'depth'.")
        self.agent, self.modality, self.seed = agent, modality, seed
        self.apartments, self.panoramas = apartments, panoramas
        self.schedule = schedule or Schedule("clean", 0.0)
        self.refresh_episodes = refresh_episodes
        agent.requires_grad_(False)
        for part in (
            (agent.rgb_encoder,)
            if modality == "rgb"
            else (agent.depth_encoder, agent.waypoint_head)
        ):
            part.requires_grad_(True)
        self.renderer = Renderer(size, scenes=apartments)

    def batch(self, step: int) -> dict[str, Any]:
        if self.schedule.mode == "success_distributed" and self.schedule.success is None:
            self.schedule.refresh(self._measure(step))
        rng = generator(self.seed, "perception", self.modality, step)
        rows = [self._panorama(rng, f"{step}-{i}") for i in range(self.panoramas)]
        frames, targets = (np.stack(column) for column in zip(*rows, strict=True))
        return {"frames": torch.from_numpy(frames), "targets": torch.from_numpy(targets)}

    def _panorama(self, rng: np.random.Generator, name: str) -> tuple[np.ndarray, np.ndarray]:
        apartment = apartment_of(f"apartments/train/{int(rng.integers(self.apartments)):06d}")
        space = apartment.space
        xy = space.centre(int(rng.integers(len(space.cells)))) + rng.uniform(-0.05, 0.05, 2)
        heading = float(rng.uniform(-np.pi, np.pi))
        self.renderer.load(apartment)
        rgb, depth, ids = self.renderer.render(float(xy[0]), float(xy[1]), heading)
        if self.modality == "rgb":
            target, _ = view_labels(apartment, ids, depth)
        else:
            target = free_target(space, xy, heading)
        frames = {RGB: rgb, DEPTH: depth, POSE: np.array([*xy, heading], np.float32)}
        frames = corrupt_observation(frames, *self.schedule.draw(self.seed, name, 0))
        self._last = frames
        if self.modality == "depth":
            return frames[DEPTH], target
        views = np.arange(
            int(rng.integers(2)), VIEWS, 2
        )  # neighbours overlap: half of them teach as much
        return frames[RGB][views], target[views]

    def _measure(self, step: int) -> dict[str, float]:
        rates = measure(
            self.agent,
            self.schedule,
            self.renderer,
            episodes=self.refresh_episodes,
            apartments=self.apartments,
            seed=self.seed,
            step=step,
        )
        self.agent.train()
        return rates

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """The last panorama of the last batch."""
        return {"panorama": strip(self._last[RGB])}

    def get_extra_state(self) -> dict[str, Any]:
        return {"schedule": self.schedule.state_dict()}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self.schedule.load_state_dict(state["schedule"])

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        frames = batch["frames"].flatten(0, 1)
        if self.modality == "depth":
            features = self.agent.depth_encoder(frames).unflatten(0, (-1, VIEWS))
            logits = self.agent.waypoint_head(features)
            return {
                "loss": waypoint_loss(logits, batch["targets"]),
                "iou": agreement(logits, batch["targets"]),
            }
        _, logits = self.agent.rgb_encoder(frames)
        targets = batch["targets"].flatten(0, 1)
        loss = F.binary_cross_entropy_with_logits(
            logits.float(), targets, pos_weight=torch.tensor(2.0)
        )
        return {
            "loss": loss,
            "f1": f1(logits[:, THINGS], targets[:, THINGS]),
            "f1_all": f1(logits, targets),
        }


def f1(logits: Tensor, targets: Tensor) -> Tensor:
    """Micro F1 at probability 0.5."""
    predicted, true = logits > 0, targets > 0.5
    return 2 * (predicted & true).sum() / torch.clamp(predicted.sum() + true.sum(), min=1)
