"""Train the gate of a restorer, which decides which frames are restored.

    L = BCE(gate, target)

The target is 1 if restoring a frame reduces its error to less than ``BETTER`` times the original
error, and lowers its fraction of correct pixels by at most ``SPENT``. Otherwise the target is 0.
The limit ``SPENT`` is needed, because blurring a partly wrong frame can reduce its mean error
although details are lost. A corrupted frame is ignored if restoring makes it neither clearly better
nor worse. The inputs of the gate do not change in this stage, so they are computed only once, for
``instants`` random time steps. At the end, the threshold is set such that the gate's logit
is above it for a fraction ``touched`` of held-out clean time steps from the training scenes.
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

CLEAN_SHARE = 0.35  # fraction of clean time steps in training (heuristic)
# the error after restoring must be below this fraction of the error before (heuristic)
BETTER = 0.85
# maximum number of correct pixels that become wrong, as a fraction of all pixels (heuristic)
SPENT = 0.15
# Each data set of this recipe uses the step numbers from its own offset onwards.
# Training uses smaller step numbers, so the time steps of all data sets are sampled independently.
# Frames of a folder can still occur in several data sets, because all of them share one pool.
OFFSETS = {"held": 1_000_000, "fresh": 2_000_000, "corrupted": 3_000_000, "learned": 4_000_000}


class GateSamples(NamedTuple):
    """Gate inputs and restoration errors of N time steps with V views.

    Attributes:
        stats: input of the gate [N, V, s].
        textures: input of the gate [N, V, t].
        before: mean error of the original frames [N], divided by the range.
        after: mean error of the restored frames [N].
        spent: how much restoring lowers the fraction of pixels within ``TOLERANCE`` [N].
    """

    stats: Tensor
    textures: Tensor
    before: Tensor
    after: Tensor
    spent: Tensor

    @property
    def labels(self) -> tuple[Tensor, Tensor]:
        """Return masks [N] of time steps: those to be restored, and those used in the loss."""
        intact = self.spent <= SPENT
        better = (self.before > 0) & (self.after < BETTER * self.before) & intact
        return better, better | (self.after >= self.before) | ~intact


class RestoreGate(Objective):
    """Trains the gate of a restorer.

    Args:
        agent: the restorer; its network's gate for the sensor in ``pairs`` is trained in place.
        pairs: the source of frames.
        instants: number of time steps for training, and also the number of single views.
        held: number of held-out clean time steps for setting the threshold.
        batch: number of time steps per batch.
        single: fraction of training steps on single views.
        touched: fraction of clean time steps that may be above the threshold.
        seed: seed of the batches.

    Raises:
        ValueError: If a number is invalid.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"pairs": pairs_of}
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
                "single and touched must be fractions from 0 to 1, got "
                f"{single} and {touched}; instants, held and batch must be >= 1, got "
                f"{instants}, {held} and {batch}."
            )
        self.sensor = pairs.sensor
        self.instants = instants
        self.held = held
        self.batch_size = batch
        self.single = single
        self.touched = touched
        self.seed = seed
        self.agent = agent.requires_grad_(False)
        self.net: SensorRestorer = agent.parts()[self.sensor]
        self.net.gate.requires_grad_(True)
        self.pairs = with_clean_share(pairs, CLEAN_SHARE)
        self.clean = with_clean_share(pairs, 1.0)
        # one data set of panoramas (if there are any), and one of single views
        self.learned: list[GateSamples] = []

    def identity(self) -> dict[str, str]:
        return self.pairs.identity()

    def start(self) -> None:
        self.pairs.start()
        self.clean.start()
        kinds = [True, False] if self.pairs.ring else [False]
        self.learned = [self._samples(self.pairs, self.instants, "learned", ring) for ring in kinds]

    def pieces(self) -> int:
        """Return 1, because a batch cannot be divided among ranks."""
        return 1

    def batch(self, step: int) -> dict[str, Any]:
        assert self.learned, "start() collects the maps"
        rng = generator(self.seed, "gate batch", step)
        table = self.learned[-1 if rng.random() < self.single else 0]
        chosen = rng.integers(len(table.before), size=self.batch_size)
        return {"samples": GateSamples(*(part[torch.from_numpy(chosen)] for part in table))}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        samples = GateSamples(*(part.to(self.net.threshold.device) for part in batch["samples"]))
        logits = self._logits(samples)
        better, counted = samples.labels
        each = F.binary_cross_entropy_with_logits(logits, better.float(), reduction="none")
        total = counted.sum().clamp(min=1)
        right = (logits > 0) == better
        return {
            "loss": (each * counted).sum() / total,
            "accuracy": (right & counted).sum() / total,
            "wanted": (better & counted).sum() / total,
        }

    def _logits(self, samples: GateSamples) -> Tensor:
        """Return the gate's logit for each time step [N]."""
        stats = samples.stats.flatten(0, 1)
        textures = samples.textures.flatten(0, 1)
        return self.net.gate(stats, textures, samples.stats.shape[1]).float()

    @torch.no_grad()
    def _samples(self, pairs: Pairs, count: int, which: str, ring: bool) -> GateSamples:
        """Measure ``count`` time steps: whole panoramas if ``ring`` is true, otherwise single
        views.
        """
        parts: list[tuple[Tensor, ...]] = []
        step = OFFSETS[which]
        collected = 0
        device = self.net.threshold.device
        with Progress(f"{self.sensor}, {which}", count, unit="instant") as progress:
            while collected < count:
                jobs: list[Any] = list(pairs.jobs(step))
                batch = pairs.collate([pairs.work(job) for job in jobs])
                frames, clean = (batch[n].flatten(0, 1).to(device) for n in ("frames", "clean"))
                parts.append(self._part(frames, clean, batch["frames"].shape[1] if ring else 1))
                added = min(len(parts[-1][0]), count - collected)
                step += 1
                collected += added
                progress.advance(added)
        return GateSamples(*(torch.cat(part)[:count] for part in zip(*parts, strict=True)))

    def _part(self, frames: Tensor, clean: Tensor, views: int) -> tuple[Tensor, ...]:
        """Compute the fields of :class:`GateSamples` for frames [n, H, W, c]."""
        restored = self.net(frames, views)
        small = self.net.small(*self.net.scaled(frames))
        inputs = (self.net.judge(*small, views)[0].stats, texture(*small))
        target, valid = self.net.scaled(clean)
        seen, _ = self.net.scaled(frames)
        wrong = [((x - target).abs() * valid).mean(1) for x in (seen, restored)]
        errors = [part.mean((1, 2)) for part in wrong]
        right = [(part < TOLERANCE).float().mean((1, 2)) for part in wrong]
        parts = (*inputs, *errors, right[0] - right[1])
        stats, textures, *others = (part.unflatten(0, (-1, views)) for part in parts)
        return stats, textures, *(part.mean(1) for part in others)

    @torch.no_grad()
    def finish(self) -> None:
        """Set the threshold on held-out clean time steps."""
        logits = self._logits(self._samples(self.clean, self.held, "held", self.pairs.ring))
        self.net.threshold.fill_(float(logits.quantile(1 - self.touched)))

    @torch.no_grad()
    def evaluate(self, step: int) -> dict[str, float]:
        """Return the threshold and the fractions of clean and of corrupted time steps above it.

        The clean time steps are not used elsewhere. Of the corrupted time steps, only those with
        target 1 are counted. The threshold is set only at the end of training.
        """
        ring = self.pairs.ring
        fresh = self._samples(self.clean, -(-self.held // 3), "fresh", ring)
        corrupted = self._samples(self.pairs, -(-self.held // 3), "corrupted", ring)
        return {
            "threshold": float(self.net.threshold),
            "clean_touched": self._above(self._logits(fresh)),
            "helped_found": self._above(self._logits(corrupted)[corrupted.labels[0]]),
        }

    def _above(self, logits: Tensor) -> float:
        return float((logits > self.net.threshold).float().mean())
