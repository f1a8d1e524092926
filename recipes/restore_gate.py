"""Train the gate of a restorer: which frames come nearer to the clean ones by being restored.

    L = BCE(gate, error after < ``BETTER`` error before, and at most ``SPENT`` fewer right pixels)

By the mean error alone it is better to blur a frame of which a part is wrong; to who reads it, it
is not. A frame that is neither clearly better afterwards nor clean or worse counts for neither. The
maps that the gate reads do not change here, so they are computed once, for ``instants`` random
instants, and learned from many times. Afterwards the threshold is set on clean frames of the
training scenes that were held back: ``touched`` of them lie above it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.guards.frames.network import texture
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.frames.sensor import TOLERANCE, SensorRestorer
from mitigate.recipes.restore import RESTORER
from mitigate.training.objective import Objective
from mitigate.training.restoration_pairs import Pairs, pairs_of, with_clean_share

CLEAN_SHARE = 0.35  # of the instants that are learned from (ours)
BETTER = 0.85  # of the error before: what restoring must get below to be worth it (ours)
SPENT = 0.15  # of the pixels (ours)
# Steps, so that no instant is one that the network was trained on, and none serves two ends.
OFFSETS = {"held": 1_000_000, "fresh": 2_000_000, "corrupted": 3_000_000, "learned": 4_000_000}


class Judged(NamedTuple):
    """Of N instants of V views: stats [N, V, s] and textures [N, V, t], which the gate reads;
    before, after [N]: mean error over the range as they are and as restored. spent [N]: share of
    right pixels before less that afterwards (``frames.TOLERANCE``)."""

    stats: Tensor
    textures: Tensor
    before: Tensor
    after: Tensor
    spent: Tensor

    @property
    def wanted(self) -> tuple[Tensor, Tensor]:
        """Which should be restored, and which are to be counted: bool [N] each."""
        kept = self.spent <= SPENT
        hit = (self.before > 0) & (self.after < BETTER * self.before) & kept
        return hit, hit | (self.after >= self.before) | ~kept


class RestoreGate(Objective):
    """Train the gate of a restorer.

    Args:
        agent: the restorer; the gate of its network of the sensor of ``pairs`` is trained in place.
        pairs: the source of frames.
        instants: to learn from, and as many single views.
        held: clean instants that set the threshold.
        batch: instants per step.
        single: share of the steps that learn from single views.
        touched: share of clean instants above the threshold.
        seed: of the batches.

    Raises:
        ValueError: for an invalid number.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"pairs": pairs_of}
    here = True  # a step takes milliseconds
    needs = ("restore", "doubt", "parts")
    otherwise = RESTORER

    def __init__(
        self,
        agent: Restorer,
        pairs: Pairs,
        instants: int = 400,
        held: int = 300,
        batch: int = 64,
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
        self.modality = pairs.sensor
        self.instants = instants
        self.held = held
        self.batch_size = batch
        self.single = single
        self.touched = touched
        self.seed = seed
        self.agent = agent.requires_grad_(False)
        self.net: SensorRestorer = agent.parts()[self.modality]
        self.net.gate.requires_grad_(True)
        self.pairs = with_clean_share(pairs, CLEAN_SHARE)
        self.clean = with_clean_share(pairs, 1.0)
        self.learned: list[Judged] = []  # of panoramas, if there are any, and of single views

    def identity(self) -> dict[str, str]:
        return self.pairs.identity()

    def start(self) -> None:
        self.pairs.start()
        self.clean.start()
        kinds = [True, False] if self.pairs.ring else [False]
        self.learned = [self._judged(self.pairs, self.instants, "learned", ring) for ring in kinds]

    def pieces(self) -> int:
        """1: a step is not shared."""
        return 1

    def batch(self, step: int) -> dict[str, Any]:
        assert self.learned, "start() collects the maps"
        rng = generator(self.seed, "gate batch", step)
        table = self.learned[-1 if rng.random() < self.single else 0]
        chosen = rng.integers(len(table.before), size=self.batch_size)
        return {"judged": Judged(*(part[torch.from_numpy(chosen)] for part in table))}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        judged = Judged(*(part.to(self.net.threshold.device) for part in batch["judged"]))
        logits, (hit, counted) = self._logits(judged), judged.wanted
        each = F.binary_cross_entropy_with_logits(logits, hit.float(), reduction="none")
        total, right = counted.sum().clamp(min=1), (logits > 0) == hit
        return {
            "loss": (each * counted).sum() / total,
            "accuracy": (right & counted).sum() / total,
            "wanted": (hit & counted).sum() / total,
        }

    def _logits(self, judged: Judged) -> Tensor:
        """[N]: each of the N is one instant."""
        stats, textures = (part.flatten(0, 1) for part in judged[:2])
        return self.net.gate(stats, textures, judged.stats.shape[1]).float()

    @torch.no_grad()
    def _judged(self, pairs: Pairs, count: int, which: str, ring: bool) -> Judged:
        """What the gate reads of ``count`` instants, and what restoring them comes to; ``ring``:
        of panoramas, or each view by itself."""
        parts: list[tuple[Tensor, ...]] = []
        step, have, device = OFFSETS[which], 0, self.net.threshold.device
        with Progress(f"{self.modality}, {which}", count, unit="instant") as progress:
            while have < count:
                batch = pairs.collate([pairs.work(job) for job in pairs.jobs(step)])
                frames, clean = (batch[n].flatten(0, 1).to(device) for n in ("frames", "clean"))
                parts.append(self._part(frames, clean, batch["frames"].shape[1] if ring else 1))
                found, step = min(len(parts[-1][0]), count - have), step + 1
                have += found
                progress.advance(found)
        return Judged(*(torch.cat(part)[:count] for part in zip(*parts, strict=True)))

    def _part(self, frames: Tensor, clean: Tensor, views: int) -> tuple[Tensor, ...]:
        """The entries of :class:`Judged` for frames [n, H, W, c]."""
        made = self.net(frames, views)
        less = self.net.small(*self.net.scaled(frames))
        read = (self.net.judge(*less, views)[0].stats, texture(*less))
        wanted, valid = self.net.scaled(clean)
        seen, _ = self.net.scaled(frames)
        wrong = [((x - wanted).abs() * valid).mean(1) for x in (seen, made)]
        errors = [part.mean((1, 2)) for part in wrong]
        right = [(part < TOLERANCE).float().mean((1, 2)) for part in wrong]
        parts = (*read, *errors, right[0] - right[1])
        stats, textures, *others = (part.unflatten(0, (-1, views)) for part in parts)
        return stats, textures, *(part.mean(1) for part in others)

    @torch.no_grad()
    def finish(self) -> None:
        """Set the threshold by the clean instants that were held back."""
        logits = self._logits(self._judged(self.clean, self.held, "held", self.pairs.ring))
        self.net.threshold.fill_(float(logits.quantile(1 - self.touched)))

    @torch.no_grad()
    def evaluate(self, step: int) -> dict[str, float]:
        """Return the threshold, which is set at the end, with the shares above it of other clean
        instants, and of corrupted ones that restoring makes clearly better."""
        ring = self.pairs.ring
        fresh = self._judged(self.clean, -(-self.held // 3), "fresh", ring)
        met = self._judged(self.pairs, -(-self.held // 3), "corrupted", ring)
        return {
            "threshold": float(self.net.threshold),
            "clean_touched": self._above(self._logits(fresh)),
            "helped_found": self._above(self._logits(met)[met.wanted[0]]),
        }

    def _above(self, logits: Tensor) -> float:
        return float((logits > self.net.threshold).float().mean())
