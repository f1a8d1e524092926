"""Train a restorer from pairs of corrupted and clean frames; no agent, label or action is needed.

    L = mean over scales of |out - clean| + w_grad |their image gradients|     (out, and unrefined)
        + w_gate BCE(gate, corrupted or not)

RGB counts in [0, 1], depth in metres over the range; pixels of depth that read nothing in the clean
frame do not count. Nothing of an agent enters, so one restorer serves all. Afterwards the gate's
threshold is set on clean frames of the training scenes: ``touched`` of them may lie above it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.observation import DEPTH, RGB
from mitigate.core.pictures import side_by_side
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.corruptions.registry import modality
from mitigate.restoration.frames import SensorRestorer
from mitigate.restoration.pairs import pairs_of
from mitigate.restoration.restorer import Restorer
from mitigate.training.recipe import Recipe
from mitigate.worlds.world import TrainingEpisodes

HELD = 1_000_000  # steps from here on are for the threshold: training never draws them (ours)
HIT = {RGB: 0.5 / 255, DEPTH: 5e-4}  # mean change, over the range, that a gate must see (ours)
SCALES = (1, 4)  # pixels: errors of edges, and of surfaces (ours)
COARSE = 0.5  # weight of the frames before they are refined (ours)


class Restore(Recipe):
    """Args:
    agent: the restorer; its network of ``modality`` ("rgb" or "depth") is trained in place.
    world, training: where poses come from (``training/poses.py``), or a folder of frames.
    schedule: of corruptions; those of the sensor are drawn. panoramas: of 12 views, a step.
    frames: read of a folder, once. single: share of steps whose views are shown one by one.
    w_grad, w_gate: of the loss above. touched: share of clean frames above the threshold.
    held: clean panoramas that set it.
    """

    ahead = True

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
        w_gate: float = 0.2,
        touched: float = 0.005,
        held: int = 300,
    ) -> None:
        super().__init__()
        if not 0 <= single <= 1 or not 0 < touched < 1 or panoramas < 1 or held < 1:
            raise ValueError(
                f"recipe.single ({single}) and recipe.touched ({touched}) are shares from 0 to 1, "
                f"recipe.panoramas ({panoramas}) and recipe.held ({held}) at least 1."
            )
        self.agent, self.modality, self.single, self.seed = agent, modality, single, seed
        self.w_grad, self.w_gate, self.touched, self.held = w_grad, w_gate, touched, held
        agent.requires_grad_(False)
        self.net: SensorRestorer = agent.parts()[modality].requires_grad_(True)  # type: ignore[assignment]
        names = tuple(name for name in schedule.names if _of(name) == modality)
        if not names:
            raise ValueError(f"schedule.names has no corruption of {modality}.")
        how = {"sensor": modality, "panoramas": panoramas, "seed": seed, "frames": frames}
        schedule = dataclasses.replace(schedule, names=names)
        self.pairs = pairs_of(agent, world, training, schedule, **how)
        clean = dataclasses.replace(schedule, clean_share=1.0)
        self.clean = pairs_of(agent, world, training, clean, **how)
        self._shown: np.ndarray | None = None

    def start(self) -> None:
        self.pairs.start()
        self.clean.start()

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
            values = {
                "out": self._error(made.out, wanted, valid),
                "coarse": self._error(made.coarse, wanted, valid),
                "before": ((seen - wanted).abs() * valid).mean(),
                "after": ((made.out - wanted).abs() * valid).mean().detach(),
            }
            change = (seen - wanted).abs().mean((1, 2, 3)).unflatten(0, (-1, views)).mean(1)
            hit = change > HIT[self.modality] / (views if self.modality == RGB else 1)
            sure = (hit | (change == 0)).float()
            each = F.binary_cross_entropy_with_logits(
                made.gate.float(), hit.float(), reduction="none"
            )
            values["gate"] = (each * sure).sum() / sure.sum().clamp(min=1)
            loss = values["out"] + COARSE * values["coarse"] + self.w_gate * values["gate"]
        self._keep(frames, made.out, clean)
        return {"loss": loss, **values}

    def _error(self, out: Tensor, wanted: Tensor, valid: Tensor) -> Tensor:
        """L1 at all scales, and that of the image gradients."""
        total = out.new_zeros(())
        difference, weight = (out - wanted) * valid, valid
        for scale in SCALES:
            if scale > 1:
                difference, weight = (F.avg_pool2d(part, scale) for part in (difference, weight))
            total = total + difference.abs().mean() / len(SCALES)
        difference = (out - wanted) * valid
        for axis in (2, 3):
            near = valid.narrow(axis, 1, valid.shape[axis] - 1) * valid.narrow(
                axis, 0, valid.shape[axis] - 1
            )
            total = total + self.w_grad * (difference.diff(dim=axis) * near).abs().mean()
        return total

    @torch.no_grad()
    def evaluate(self, step: int) -> dict[str, float]:
        """Set the threshold on clean frames of poses that training never draws; return it, and the
        shares of held-out clean and corrupted frames above it."""
        clean, _ = self._gates(self.clean, HELD)
        self.net.threshold.fill_(float(clean.quantile(1 - self.touched)))
        fresh, _ = self._gates(self.clean, 2 * HELD)
        logits, hit = self._gates(self.pairs, 3 * HELD)
        found = (logits > self.net.threshold)[hit].float().mean()
        return {
            "threshold": float(self.net.threshold),
            "clean_touched": float((fresh > self.net.threshold).float().mean()),
            "corrupted_found": float(found),
        }

    def _gates(self, pairs: Any, first: int) -> tuple[Tensor, Tensor]:
        """Logits of about ``held`` instants of held-out batches, and which are corrupted."""
        logits, hits, step = [], [], first
        while sum(map(len, logits)) < self.held:
            batch = pairs.collate([pairs.work(job) for job in pairs.jobs(step)])
            views = batch["frames"].shape[1] if pairs.ring else 1
            frames = batch["frames"].flatten(0, 1).to(self.net.threshold.device)
            x, valid = self.net.scaled(frames)
            logits.append(self.net.judge(*self.net.small(x, valid), views)[1].float().cpu())
            same = (batch["frames"] == batch["clean"]).flatten(2).all(2)
            hits.append(~(same.all(1) if pairs.ring else same.flatten()))
            step += 1
        return torch.cat(logits), torch.cat(hits)

    def _keep(self, frames: Tensor, out: Tensor, clean: Tensor) -> None:
        if not self.training:
            return
        made = self.net.unscaled(out.detach()).to(frames.dtype)
        rows = [part[:: max(1, len(part) // 12)][:12].cpu() for part in (frames, made, clean)]
        self._shown = np.concatenate([side_by_side(row.numpy()) for row in rows])

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """Views of the last batch: corrupted, restored, clean."""
        return {} if self._shown is None else {"restored": self._shown}


def _of(name: str) -> str:
    return modality(name)
