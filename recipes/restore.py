"""Train a restorer from pairs of corrupted and clean frames; no agent, label or action is needed.

    L = mean over scales of |out - clean| + w_grad |their image gradients|
        + w_right mean of e / (e + TOLERANCE), e = |out - clean| of a pixel

The last counts how many pixels are wrong rather than by how much: what is seen rightly beside
drops, stripes or noise is to stay as it was. In the first term depth that is too far counts
``w_far`` times: a way that is not there costs a walk, one that is not seen a detour. RGB counts in
[0, 1], depth in metres over the range; pixels of depth that read nothing in the clean frame do not
count. Nothing of an agent enters, so one restorer serves all. Its gate is trained afterwards, on
maps that no longer change (``restore_gate.py``).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.pictures import side_by_side
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.frames.sensor import TOLERANCE, SensorRestorer
from mitigate.training import limits, success
from mitigate.training.recipe import Recipe
from mitigate.training.restoration_pairs import pairs_of
from mitigate.worlds.world import TrainingEpisodes

SCALES = (1, 4)  # pixels: errors of edges, and of surfaces (ours)
RESTORER = "This recipe takes a restorer in an agent's place: agent=restorer (docs/restoration.md)."


class Restore(Recipe):
    """Args:
    agent: the restorer; its network of ``modality`` ("rgb" or "depth") is trained in place.
    world, training: where poses come from (``training/poses.py``), or a folder of frames.
    schedule: of corruptions; those of the sensor are drawn. panoramas: of 12 views, a step.
    frames: read of a folder, once. single: share of steps whose views are shown one by one.
    w_grad, w_right, w_far: of the loss above.
    """

    ahead = True
    needs = ("restore", "doubt", "parts")
    otherwise = RESTORER

    def __init__(
        self,
        agent: Restorer,
        world: Callable[[], Any],
        training: TrainingEpisodes | None,
        modality: str,
        schedule: Schedule,
        panoramas: int = 4,
        frames: int = 4800,
        single: float = 0.25,
        seed: int = 0,
        w_grad: float = 0.5,
        w_right: float = 0.05,
        w_far: float = 1.0,
    ) -> None:
        super().__init__()
        if not 0 <= single <= 1 or panoramas < 1:
            raise ValueError(
                f"recipe.single ({single}) is a share from 0 to 1, and recipe.panoramas "
                f"({panoramas}) at least 1."
            )
        limits.check_weights(w_grad=w_grad, w_right=w_right, w_far=w_far)
        success.refuse(schedule)
        self.agent, self.modality, self.single, self.seed = agent, modality, single, seed
        self.w_grad, self.w_right, self.w_far = w_grad, w_right, w_far
        agent.requires_grad_(False)
        self.net: SensorRestorer = agent.parts()[modality].requires_grad_(True)
        self.net.gate.requires_grad_(False)
        self.pairs = pairs_of(
            agent, world, training, schedule.only(modality),
            sensor=modality, panoramas=panoramas, seed=seed, frames=frames,
        )  # fmt: skip
        self._shown: np.ndarray | None = None

    def identity(self) -> dict[str, str]:
        return self.pairs.identity()

    def start(self) -> None:
        self.pairs.start()

    def jobs(self, step: int) -> list[Any]:
        return self.pairs.jobs(step)

    def work(self, job: Any) -> Any:
        return self.pairs.work(job)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        made = self.pairs.collate(pieces)
        alone = generator(self.seed, "restore views", step).random() < self.single
        views = made["frames"].shape[1] if self.pairs.ring and not alone else 1
        return {**made, "views": views}

    def weight(self, batch: dict[str, Any]) -> float:
        """Views."""
        return float(batch["frames"].shape[0] * batch["frames"].shape[1])

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        views = batch["views"]
        frames, clean = batch["frames"].flatten(0, 1), batch["clean"].flatten(0, 1)
        made = self.net(frames, views)
        with torch.autocast(frames.device.type, enabled=False):
            wanted, valid = self.net.scaled(clean)
            seen, _ = self.net.scaled(frames)
            loss = self._error(made, wanted, valid)
            before, after = (((x - wanted).abs() * valid).mean() for x in (seen, made.detach()))
        self._keep(frames, made, clean)
        return {"loss": loss, "before": before, "after": after}

    def _error(self, out: Tensor, wanted: Tensor, valid: Tensor) -> Tensor:
        """L1 at all scales, that of the image gradients, and the share of wrong pixels."""
        total = out.new_zeros(())
        difference = (out - wanted) * valid
        charged = torch.where(difference > 0, self.w_far * difference, difference)
        for scale in SCALES:
            total = total + F.avg_pool2d(charged, scale).abs().mean() / len(SCALES)
        for axis in (2, 3):
            near = valid.narrow(axis, 1, valid.shape[axis] - 1) * valid.narrow(
                axis, 0, valid.shape[axis] - 1
            )
            total = total + self.w_grad * (difference.diff(dim=axis) * near).abs().mean()
        wrong = difference.abs().mean(1)
        return total + self.w_right * (wrong / (wrong + TOLERANCE)).mean()

    def _keep(self, frames: Tensor, out: Tensor, clean: Tensor) -> None:
        if not self.training:
            return
        made = self.net.unscaled(out.detach()).to(frames.dtype)
        rows = [part[:: max(1, len(part) // 12)][:12].cpu() for part in (frames, made, clean)]
        self._shown = np.concatenate([side_by_side(row.numpy()) for row in rows])

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """Views of the last batch: corrupted, restored, clean."""
        return {} if self._shown is None else {"restored": self._shown}
