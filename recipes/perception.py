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

from mitigate.agents.adapters import adapted, adapter_parameters
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological.concepts import THINGS
from mitigate.agents.topological.waypoints import agreement, waypoint_loss
from mitigate.core.observation import DEPTH, POSE, RGB, VIEWS
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.training.recipe import Recipe
from mitigate.training.success import measure
from mitigate.worlds.apartments.drawing import side_by_side
from mitigate.worlds.apartments.labels import free_directions, view_labels
from mitigate.worlds.apartments.renderer import shared_renderer
from mitigate.worlds.apartments.simulator import apartment_of
from mitigate.worlds.apartments.tasks import share_of

PIECE = 6  # panoramas that one job renders (ours)


class PerceptionRecipe(Recipe):
    """Args: agent; modality "rgb" or "depth"; apartments: how many training layouts; panoramas: a
    batch; schedule: which panorama is hurt by what, None: none. A success-distributed schedule
    without rates starts from those of ``agent`` on ``refresh_episodes`` training episodes each.
    adapters_only: train the agent's adapters and nothing else.
    """

    ahead = True

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
        adapters_only: bool = False,
    ) -> None:
        super().__init__()
        if modality not in ("rgb", "depth"):
            raise ValueError(f"modality={modality!r} is unknown; choose 'rgb' or 'depth'.")
        self.agent, self.modality, self.seed = agent, modality, seed
        self.apartments, self.panoramas, self.size = apartments, panoramas, size
        self.schedule = schedule or Schedule("clean", 0.0)
        self.refresh_episodes = refresh_episodes
        agent.requires_grad_(False)
        parts = (
            (agent.rgb_encoder,)
            if modality == "rgb"
            else (agent.depth_encoder, agent.waypoint_head)
        )
        for part in parts:
            for trained in adapter_parameters(part) if adapters_only else part.parameters():
                trained.requires_grad_(True)
        self.ring = bool(adapted(agent))  # a ring adapter needs all views of a panorama

    def jobs(self, step: int) -> list[tuple]:
        """(step, piece, of how many, panoramas, the schedule's state) of each piece."""
        if self.schedule.mode == "success_distributed" and self.schedule.success is None:
            self.schedule.refresh(self._measure(step))
        pieces = -(-self.panoramas // PIECE)
        counts = [len(part) for part in np.array_split(np.arange(self.panoramas), pieces)]
        state = self.schedule.state_dict()
        return [(step, piece, pieces, count, state) for piece, count in enumerate(counts)]

    def work(self, job: tuple) -> list[tuple[np.ndarray, ...]]:
        """(frames, the same before the corruption, labels) of each random pose of a piece."""
        step, piece, pieces, count, state = job
        if state != self.schedule.state_dict():
            self.schedule.load_state_dict(state)
        rng = generator(self.seed, "perception", self.modality, step, piece)
        seeds = share_of(self.apartments, piece, pieces)
        return [self._panorama(rng, seeds, f"{step}-{piece}-{i}") for i in range(count)]

    def collate(self, step: int, pieces: list[list[tuple]]) -> dict[str, Any]:
        """The pieces as tensors "frames", "clean" and "targets"."""
        rows = [row for piece in pieces for row in piece]
        names = ("frames", "clean", "targets")
        batch = {
            name: torch.from_numpy(np.stack(column))
            for name, column in zip(names, zip(*rows, strict=True), strict=True)
        }
        self._last = rows[-1][0]
        return batch

    def _panorama(
        self, rng: np.random.Generator, seeds: range, name: str
    ) -> tuple[np.ndarray, ...]:
        """Frames, the same before the corruption, and labels of one random pose."""
        apartment = apartment_of(f"apartments/train/{seeds[int(rng.integers(len(seeds)))]:06d}")
        space = apartment.space
        xy = space.centre(int(rng.integers(len(space.cells)))) + rng.uniform(-0.05, 0.05, 2)
        heading = float(rng.uniform(-np.pi, np.pi))
        views = self._views(rng)
        renderer = shared_renderer(self.size)
        renderer.load(apartment)
        rgb, depth, ids = renderer.render(
            float(xy[0]), float(xy[1]), heading, views=views, rgb=self.modality == "rgb"
        )
        frames = {RGB: rgb, DEPTH: depth, POSE: np.array([*xy, heading], np.float32)}
        frames = corrupt_observation(frames, *self.schedule.draw(self.seed, name, 0))
        if self.modality == "depth":
            return frames[DEPTH], depth, free_directions(space, xy, heading)
        target, _ = view_labels(apartment, ids, depth)
        return frames[RGB][views], rgb[views], target[views]

    def _views(self, rng: np.random.Generator) -> np.ndarray:
        """The views of a panorama that are learned from: for RGB every second one, since neighbours
        overlap and half of them teach as much, but all where ring adapters need them."""
        if self.modality == "rgb" and not self.ring:
            return np.arange(int(rng.integers(2)), VIEWS, 2)
        return np.arange(VIEWS)

    def _measure(self, step: int) -> dict[str, float]:
        rates = measure(
            self.agent,
            self.schedule,
            shared_renderer(self.size),
            episodes=self.refresh_episodes,
            apartments=self.apartments,
            seed=self.seed,
            step=step,
        )
        self.agent.train()
        return rates

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """The last views of the last batch: of RGB side by side, of depth in metres as grey."""
        return {"views": side_by_side(self._last)}

    def get_extra_state(self) -> dict[str, Any]:
        return {"schedule": self.schedule.state_dict()}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self.schedule.load_state_dict(state["schedule"])

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        _, logits = self.see(self.agent, batch["frames"])
        return self.label_losses(logits, batch["targets"])

    def see(self, agent: TopologicalAgent, frames: Tensor) -> tuple[Tensor, Tensor]:
        """Features [P, V, F] of a batch's frames (for RGB with the concept probabilities) and the
        logits that the labels are for."""
        views = frames.shape[1]
        if self.modality == "depth":
            features = agent.depth_encoder(frames.flatten(0, 1)).unflatten(0, (-1, views))
            return features, agent.waypoint_head(features)
        features, logits = (
            x.unflatten(0, (-1, views)) for x in agent.rgb_encoder(frames.flatten(0, 1))
        )
        return torch.cat([features, logits.sigmoid()], -1), logits

    def label_losses(self, logits: Tensor, targets: Tensor) -> dict[str, Tensor]:
        """Losses of concepts [P, V, C] or waypoints [P, 120, 12] against the labels."""
        if self.modality == "depth":
            return {"loss": waypoint_loss(logits, targets), "iou": agreement(logits, targets)}
        loss = F.binary_cross_entropy_with_logits(
            logits.float(), targets, pos_weight=torch.tensor(2.0)
        )
        return {
            "loss": loss,
            "f1": f1(logits[..., THINGS], targets[..., THINGS]),
            "f1_all": f1(logits, targets),
        }


def f1(logits: Tensor, targets: Tensor) -> Tensor:
    """Micro F1 at probability 0.5."""
    predicted, true = logits > 0, targets > 0.5
    return 2 * (predicted & true).sum() / torch.clamp(predicted.sum() + true.sum(), min=1)
