"""Train the gate of a restorer: which frames are corrupted, and from which doubt on it acts.

    L = BCE(gate, corrupted or not)

The maps that the gate reads do not change here, so they are computed once, for ``instants`` random
instants, and learned from many times. A frame that a corruption hardly changed counts for neither.
Afterwards the threshold is set on clean frames of the training scenes that were held back:
``touched`` of them lie above it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.observation import DEPTH, RGB
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.restoration.frames import SensorRestorer
from mitigate.restoration.network import texture
from mitigate.restoration.pairs import Pairs, of_sensor, pairs_of
from mitigate.restoration.restorer import Restorer
from mitigate.training.recipe import Recipe
from mitigate.worlds.world import TrainingEpisodes

CLEAN_SHARE = 0.4  # of the instants that are learned from (ours)
HIT = {RGB: 0.5 / 255, DEPTH: 5e-4}  # mean change of a view, over the range, that counts (ours)
    RGB: 0.5 / 255,
    DEPTH: 5e-4,
}  # mean change of a view, over the range, that must be seen (ours)
OFFSETS = {"learned": 0, "held": 1_000_000, "fresh": 2_000_000, "corrupted": 3_000_000}  # of steps


class Judged(NamedTuple):
    """Of N instants of V views: stats [N, V, s] and textures [N, V, t], which the gate reads;
    change [N, V], mean, over the range."""

    stats: Tensor
    textures: Tensor
    change: Tensor


class RestoreGate(Recipe):
    """Args:
    agent: the restorer; the gate of its network of ``modality`` is trained in place. world,
    training, schedule, frames: as ``Restore``. instants: learned from. held: clean ones that set
    the threshold. batch: instants a step; in a share ``single`` of the steps views count by
    themselves. touched: share of clean instants above the threshold.
    """

    here = True  # a step takes milliseconds

    def __init__(
        self,
        agent: Restorer,
        world: Callable[[], Any],
        training: TrainingEpisodes | None,
        modality: str,
        schedule: Schedule,
        instants: int = 600,
        held: int = 300,
        batch: int = 64,
        frames: int = 4800,
        single: float = 0.3,
        touched: float = 0.005,
        seed: int = 0,
    ) -> None:
        super().__init__()
        if not (0 <= single <= 1 and 0 < touched < 1 and min(instants, held, batch) >= 1):
            raise ValueError(
                f"recipe.single ({single}) and recipe.touched ({touched}) are shares from 0 to 1; "
                f"recipe.instants ({instants}), held ({held}) and batch ({batch}) at least 1."
            )
        self.modality, self.instants, self.held, self.batch_size = modality, instants, held, batch
        self.single, self.touched, self.seed = single, touched, seed
        self.agent = agent.requires_grad_(False)
        self.net: SensorRestorer = agent.parts()[modality]  # type: ignore[assignment]
        self.net.gate.requires_grad_(True)
        own = of_sensor(schedule, modality)
        how = {"sensor": modality, "panoramas": 4, "seed": seed, "frames": frames}
        self.pairs, self.clean = (
            pairs_of(agent, world, training, dataclasses.replace(own, clean_share=share), **how)
            for share in (CLEAN_SHARE, 1.0)
        )
        self.learned: Judged | None = None

    def start(self) -> None:
        self.pairs.start()
        self.clean.start()
        self.learned = self._judged(self.pairs, self.instants, "learned")

    def batch(self, step: int) -> dict[str, Any]:
        assert self.learned is not None, "start() collects the maps"
        rng = generator(self.seed, "gate batch", step)
        chosen = torch.from_numpy(rng.integers(len(self.learned.change), size=self.batch_size))
        stats, textures, change = (part[chosen] for part in self.learned)
        if not self.pairs.ring or rng.random() < self.single:
            stats, textures, change = (
                part.flatten(0, 1)[:, None] for part in (stats, textures, change)
            )
        return {"stats": stats, "textures": textures, "change": change}

    def weight(self, batch: dict[str, Any]) -> float:
        """Instants."""
        return float(len(batch["change"]))

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        change = batch["change"]
        logits = self._logits(Judged(**batch))
        hit = (change > HIT[self.modality]).any(1)
        sure = (hit | (change == 0).all(1)).float()
        each = F.binary_cross_entropy_with_logits(logits, hit.float(), reduction="none")
        right = ((logits > 0) == hit).float()
        total = sure.sum().clamp(min=1)
        return {"loss": (each * sure).sum() / total, "accuracy": (right * sure).sum() / total}

    def _logits(self, judged: Judged) -> Tensor:
        """[N]: each of the N is one instant."""
        stats, textures = (part.flatten(0, 1) for part in judged[:2])
        return self.net.gate(stats, textures, judged.stats.shape[1]).float()

    @torch.no_grad()
    def _judged(self, pairs: Pairs, count: int, which: str) -> Judged:
        """What the gate reads of about ``count`` instants."""
        parts: list[tuple[Tensor, ...]] = []
        step, have, device = OFFSETS[which], 0, self.net.threshold.device
        with Progress(f"{self.modality}, {which}", count, unit="instant") as progress:
            while have < count:
                batch = pairs.collate([pairs.work(job) for job in pairs.jobs(step)])
                frames, clean = (batch[n].flatten(0, 1).to(device) for n in ("frames", "clean"))
                x, valid = self.net.scaled(frames)
                less = self.net.small(x, valid)
                views = batch["frames"].shape[1] if pairs.ring else 1
                stats = self.net.net.encode(self.net.seen(*less), views).stats
                change = (x - self.net.scaled(clean)[0]).abs().mean((1, 2, 3))
                found = (stats, texture(*less), change)
                parts.append(tuple(part.unflatten(0, (-1, views)) for part in found))
                have, step = have + len(parts[-1][0]), step + 1
                progress.advance(min(len(parts[-1][0]), count - (have - len(parts[-1][0]))))
        return Judged(*(torch.cat(part)[:count] for part in zip(*parts, strict=True)))

    @torch.no_grad()
    def evaluate(self, step: int) -> dict[str, float]:
        """Set the threshold; return it, with the shares above it of other clean instants, and of
        corrupted ones."""
        logits = self._logits(self._judged(self.clean, self.held, "held"))
        self.net.threshold.fill_(float(logits.quantile(1 - self.touched)))
        fresh = self._judged(self.clean, -(-self.held // 3), "fresh")
        met = self._judged(self.pairs, -(-self.held // 2), "corrupted")
        hit = (met.change > HIT[self.modality]).any(1)
        return {
            "threshold": float(self.net.threshold),
            "clean_touched": self._above(self._logits(fresh)),
            "corrupted_found": self._above(self._logits(met)[hit]),
        }

    def _above(self, logits: Tensor) -> float:
        return float((logits > self.net.threshold).float().mean())
