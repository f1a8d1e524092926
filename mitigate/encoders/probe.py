"""How much of its clean features an encoder keeps under a corruption, and what they are still good
for: cosine, a linear probe of labels, and retrieval; each with 95 % intervals over scenes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from mitigate.core.progress import Progress
from mitigate.corruptions import Corruption, Key
from mitigate.encoders.model import Encoder
from mitigate.encoders.sources import Frames, corrupted
from mitigate.evaluation.bootstrap import LEVEL, Estimate

RESAMPLES = 1000  # of the scenes (ours)
FEWEST = 10  # frames that must show a label, and as many not, for it to count (ours)
RIDGES = (1e-3, 1e-2, 1e-1, 1.0, 10.0)  # times the number of frames; chosen on training frames
PROBE_SHARE = 0.25  # of the training scenes on which the ridge is chosen (ours)


@dataclass
class Score:
    """One measure under one condition: of each resample of the scenes, and of all frames."""

    value: float
    samples: np.ndarray

    @property
    def estimate(self) -> Estimate:
        return _estimate(self.value, self.samples)

    def minus(self, other: Score) -> Estimate:
        """The paired difference."""
        return _estimate(self.value - other.value, self.samples - other.samples)


def _estimate(value: float, samples: np.ndarray) -> Estimate:
    if not len(samples):
        return Estimate(float(value), math.nan, math.nan)
    low, high = np.quantile(samples, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return Estimate(float(value), float(low), float(high))


@torch.no_grad()
def features(
    encoder: Encoder,
    frames: Frames,
    corruption: Corruption,
    seed: int,
    progress: Progress,
    batch: int = 32,
) -> np.ndarray:
    """Pooled features float32 [N, C] of every frame under ``corruption``."""
    device, found = next(encoder.model.parameters(), torch.zeros(())).device, []
    for start in range(0, len(frames), batch):
        part = range(start, min(start + batch, len(frames)))
        keys = [Key(seed, f"report-{index}") for index in part]
        views = [
            corrupted(frames, index, corruption, key, encoder.far())
            for index, key in zip(part, keys, strict=True)
        ]
        given = torch.from_numpy(np.stack(views)).to(device)
        found.append(encoder.pooled(encoder(given)).cpu().numpy())
        progress.advance(len(part))
    return np.concatenate(found)


class Resamples:
    """Scenes drawn with replacement: ``weights`` float32 [R, N], how often each frame counts. Of a
    single scene there are none (R = 0): it does not say how much scenes differ."""

    def __init__(self, scene: np.ndarray, seed: int = 0, count: int = RESAMPLES) -> None:
        _, own = np.unique(scene, return_inverse=True)
        scenes = int(own.max()) + 1
        draws = np.random.Generator(np.random.PCG64(seed)).multinomial(
            scenes, np.full(scenes, 1 / scenes), size=count if scenes > 1 else 0
        )
        self.weights = draws[:, own].astype(np.float32)

    def mean(self, values: np.ndarray) -> Score:
        """Of values [N], one a frame."""
        totals = self.weights.sum(1)
        return Score(float(values.mean()), self.weights @ values.astype(np.float32) / totals)


def cosine(found: np.ndarray, clean: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Cosine [N] of features [N, C] to the clean ones, both less ``centre`` [C]: most encoders'
    features share a large mean, beside which all frames look alike."""
    a, b = _unit(found - centre), _unit(clean - centre)
    return (a * b).sum(1)


def retrieval(found: np.ndarray, clean: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Whether [N] the clean frame nearest to a corrupted one (centred cosine) is its own."""
    near = _unit(found - centre) @ _unit(clean - centre).T
    return (near.argmax(1) == np.arange(len(found))).astype(np.float32)


def _unit(x: np.ndarray) -> np.ndarray:
    return x / np.maximum(np.linalg.norm(x, axis=1, keepdims=True), 1e-12)


class LinearProbe:
    """Ridge regression from clean features [N, C] to labels [N, L] in {0, 1}.

    The ridge is the one of ``RIDGES`` with the highest mean average precision on the frames of a
    quarter of the training scenes. ``used``: the labels that enough training frames show.
    """

    def __init__(self, clean: np.ndarray, labels: np.ndarray, scene: np.ndarray) -> None:
        self.mean, self.scale = clean.mean(0), clean.std(0) + 1e-6
        self.used = shown_enough(labels)
        x, y = self._scaled(clean), labels[:, self.used].astype(np.float64)
        held = np.isin(scene, np.unique(scene)[:: round(1 / PROBE_SHARE)])
        kept = shown_enough(y[held])
        scores = []
        for ridge in RIDGES if not held.all() else ():  # of one scene there is nothing to choose by
            weights = _ridge(x[~held], y[~held], ridge)
            guess = x[held] @ weights
            one = np.ones((1, int(held.sum())), np.float32)
            each = [average_precision(guess[:, i], y[held][:, i], one)[0] for i in kept]
            scores.append(np.mean(each) if each else 0.0)
        self.ridge = RIDGES[int(np.argmax(scores))] if scores else RIDGES[len(RIDGES) // 2]
        self.weights = _ridge(x, y, self.ridge)

    def _scaled(self, found: np.ndarray) -> np.ndarray:
        x = (found.astype(np.float64) - self.mean) / self.scale
        return np.concatenate([x, np.ones((len(x), 1))], 1)

    def score(self, found: np.ndarray, labels: np.ndarray, resamples: Resamples) -> Score:
        """Mean average precision over the labels that enough of these frames show."""
        guess, labels = self._scaled(found) @ self.weights, labels[:, self.used]
        kept = shown_enough(labels)
        one = np.ones((1, len(found)), np.float32)
        weights = np.concatenate([one, resamples.weights])
        each = [average_precision(guess[:, i], labels[:, i], weights) for i in kept]
        means = np.nanmean(each, axis=0)
        return Score(float(means[0]), means[1:])


def shown_enough(labels: np.ndarray) -> np.ndarray:
    """The columns of labels [N, L] with enough of both."""
    shown = labels.sum(0)
    return np.flatnonzero((shown >= FEWEST) & (len(labels) - shown >= FEWEST))


def _ridge(x: np.ndarray, y: np.ndarray, ridge: float) -> np.ndarray:
    gram = x.T @ x
    gram[np.diag_indices(len(gram) - 1)] += ridge * len(x)  # not of the constant
    return np.linalg.solve(gram, x.T @ y)


def average_precision(guess: np.ndarray, label: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Average precision [R] of scores [N] for labels [N], frames weighted by [R, N]; NaN where no
    frame that counts has the label."""
    order = np.argsort(-guess, kind="stable")
    w = weights[:, order]
    positive = w * label[order].astype(np.float32)
    hits, total = positive.cumsum(1), w.cumsum(1)
    with np.errstate(invalid="ignore", divide="ignore"):
        precision = np.where(total > 0, hits / total, 0.0)
        return (positive * precision).sum(1) / hits[:, -1]


def measure(
    encoders: dict[str, Encoder],
    conditions: Sequence[Corruption],
    train: Frames,
    unseen: Frames,
    seed: int,
) -> dict[tuple[str, str, str], Score]:
    """Every (encoder, condition, measure): the features of the first of ``encoders``, clean, are
    what all are compared with, and what the probe is fitted to."""
    original = next(iter(encoders.values()))
    clean = Corruption("clean", 0.0)
    total = len(train) + len(unseen) * (1 + len(encoders) * len(conditions))
    with Progress("report", total, unit="frame") as progress:
        known = features(original, train, clean, seed, progress)
        wanted = features(original, unseen, clean, seed, progress)
        seen = {
            (name, condition.name): features(encoder, unseen, condition, seed, progress)
            for name, encoder in encoders.items()
            for condition in conditions
        }
    resamples, centre = Resamples(unseen.scene, seed), known.mean(0)
    probe = None
    if train.labels is not None and unseen.labels is not None:
        probe = LinearProbe(known, train.labels, train.scene)
        probe = probe if len(shown_enough(unseen.labels[:, probe.used])) else None
    scores: dict[tuple[str, str, str], Score] = {}
    for (name, met), found in seen.items():
        scores[name, met, "cosine"] = resamples.mean(cosine(found, wanted, centre))
        scores[name, met, "retrieval"] = resamples.mean(retrieval(found, wanted, centre))
        if probe is not None:
            assert unseen.labels is not None
            scores[name, met, "probe"] = probe.score(found, unseen.labels, resamples)
    return scores


def average(scores: Iterable[Score]) -> Score:
    """The mean over conditions, resampled together."""
    listed = list(scores)
    return Score(
        float(np.mean([s.value for s in listed])), np.mean([s.samples for s in listed], axis=0)
    )
