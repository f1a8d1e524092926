"""Measure how corruptions change an encoder's features.

The measures are cosine similarity, retrieval and a linear probe. Each measure has a 95 % interval
over scenes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from mitigate.core.progress import Progress
from mitigate.corruptions import Corruption, Key
from mitigate.encoders.model import Encoder
from mitigate.encoders.sources import Frames, corrupted
from mitigate.evaluation.bootstrap import Estimate, with_interval

BATCH = 32  # number of frames that are encoded at once
RESAMPLES = 1000  # number of bootstrap resamples of the scenes (heuristic)
FEWEST = 10  # minimum numbers of positive and of negative frames for a label to be used (heuristic)
# candidates for the ridge penalty, as multiples of the number of frames
RIDGES = (1e-3, 1e-2, 1e-1, 1.0, 10.0)
PROBE_SHARE = 0.25  # fraction of the training scenes used to choose the ridge penalty (heuristic)


@dataclass
class Score:
    """The value of one measure under one condition.

    ``value`` is the value for all frames, and ``samples`` are the values for the resamples of the
    scenes.
    """

    value: float
    samples: np.ndarray

    @property
    def estimate(self) -> Estimate:
        return with_interval(self.value, self.samples)

    def minus(self, other: Score) -> Estimate:
        """Return the paired difference of two scores."""
        return with_interval(self.value - other.value, self.samples - other.samples)


@torch.no_grad()
def features(
    encoder: Encoder,
    frames: Frames,
    corruption: Corruption,
    seed: int,
    progress: Progress,
) -> np.ndarray:
    """Return the pooled features of all frames under ``corruption``, float32 [N, C]."""
    device = next(encoder.model.parameters(), torch.zeros(())).device
    batches = []
    for start in range(0, len(frames), BATCH):
        part = range(start, min(start + BATCH, len(frames)))
        views = [
            corrupted(frames, index, corruption, Key(seed, f"report-{index}"), encoder.far())
            for index in part
        ]
        inputs = torch.from_numpy(np.stack(views)).to(device)
        batches.append(encoder.pooled(encoder(inputs)).cpu().numpy())
        progress.advance(len(part))
    return np.concatenate(batches)


class Resamples:
    """Bootstrap resamples: scenes that were sampled with replacement.

    ``weights`` (float32 [R, N]) contains how often each frame counts in each resample. With a
    single scene, the number of resamples R is 0, because the variation between scenes is unknown.
    """

    def __init__(self, scene: np.ndarray, seed: int = 0) -> None:
        _, scene_index = np.unique(scene, return_inverse=True)
        scenes = int(scene_index.max()) + 1
        count = RESAMPLES if scenes > 1 else 0
        rng = np.random.Generator(np.random.PCG64(seed))
        draws = rng.multinomial(scenes, np.full(scenes, 1 / scenes), size=count)
        self.weights = draws[:, scene_index].astype(np.float32)

    def mean(self, values: np.ndarray) -> Score:
        """Return the mean of ``values`` [N], which has one entry per frame."""
        totals = self.weights.sum(1)
        return Score(float(values.mean()), self.weights @ values.astype(np.float32) / totals)


def cosine(corrupted: np.ndarray, clean: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Return the cosine similarity [N] of each frame's corrupted and clean features [N, C].

    ``centre`` [C] is subtracted from both, because the features of most encoders have a large
    common mean, which makes all frames look similar.
    """
    a, b = _unit(corrupted - centre), _unit(clean - centre)
    return (a * b).sum(1)


def retrieval(corrupted: np.ndarray, clean: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Return for each corrupted frame whether retrieval finds its own clean version.

    This is the case if the clean version has the highest cosine similarity of all clean frames.
    ``centre`` [C] is first subtracted from all features.
    """
    similarity = _unit(corrupted - centre) @ _unit(clean - centre).T
    return (similarity.argmax(1) == np.arange(len(corrupted))).astype(np.float32)


def _unit(x: np.ndarray) -> np.ndarray:
    return x / np.maximum(np.linalg.norm(x, axis=1, keepdims=True), 1e-12)


class LinearProbe:
    """Ridge regression from clean features [N, C] to labels [N, L] in {0, 1}.

    The ridge penalty is the value in ``RIDGES`` that gives the highest mean average precision on a
    quarter of the training scenes. The attribute ``used`` contains the labels with enough training
    frames.
    """

    def __init__(self, clean: np.ndarray, labels: np.ndarray, scene: np.ndarray) -> None:
        self.mean, self.scale = clean.mean(0), clean.std(0) + 1e-6
        self.used = frequent_labels(labels)
        x, y = self._scaled(clean), labels[:, self.used].astype(np.float64)
        validation = np.isin(scene, np.unique(scene)[:: round(1 / PROBE_SHARE)])
        usable = frequent_labels(y[validation])
        scores = []
        # with a single scene, there is no validation part
        for ridge in RIDGES if not validation.all() else ():
            weights = _ridge(x[~validation], y[~validation], ridge)
            guess = x[validation] @ weights
            ones = np.ones((1, int(validation.sum())), np.float32)
            each = [average_precision(guess[:, i], y[validation][:, i], ones)[0] for i in usable]
            scores.append(np.mean(each) if each else 0.0)
        self.ridge = RIDGES[int(np.argmax(scores))] if scores else RIDGES[len(RIDGES) // 2]
        self.weights = _ridge(x, y, self.ridge)

    def _scaled(self, features: np.ndarray) -> np.ndarray:
        x = (features.astype(np.float64) - self.mean) / self.scale
        return np.concatenate([x, np.ones((len(x), 1))], 1)

    def score(self, features: np.ndarray, labels: np.ndarray, resamples: Resamples) -> Score:
        """Return the mean average precision over all labels that have enough frames."""
        guess, labels = self._scaled(features) @ self.weights, labels[:, self.used]
        usable = frequent_labels(labels)
        ones = np.ones((1, len(features)), np.float32)
        weights = np.concatenate([ones, resamples.weights])
        each = [average_precision(guess[:, i], labels[:, i], weights) for i in usable]
        means = np.nanmean(each, axis=0)
        return Score(float(means[0]), means[1:])


def frequent_labels(labels: np.ndarray) -> np.ndarray:
    """Return the columns of ``labels`` [N, L] that have enough positive and negative frames."""
    positive = labels.sum(0)
    return np.flatnonzero((positive >= FEWEST) & (len(labels) - positive >= FEWEST))


def _ridge(x: np.ndarray, y: np.ndarray, ridge: float) -> np.ndarray:
    gram = x.T @ x
    gram[np.diag_indices(len(gram) - 1)] += ridge * len(x)  # the constant term is not regularised
    return np.linalg.solve(gram, x.T @ y)


def average_precision(guess: np.ndarray, label: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the average precision [R] of the scores ``guess`` [N] for ``label`` [N].

    Each row of ``weights`` [R, N] holds frame weights and gives one value. The value is NaN if no
    frame with a nonzero weight has the label.
    """
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
    """Return the score for every (encoder, condition, measure).

    The clean features of the first encoder are the reference for all encoders; the probe is also
    fitted to them.
    """
    original = next(iter(encoders.values()))
    clean = Corruption("clean", 0.0)
    total = len(train) + len(unseen) * (1 + len(encoders) * len(conditions))
    with Progress("report", total, unit="frame") as progress:
        train_clean = features(original, train, clean, seed, progress)
        unseen_clean = features(original, unseen, clean, seed, progress)
        measured = {
            (name, condition.name): features(encoder, unseen, condition, seed, progress)
            for name, encoder in encoders.items()
            for condition in conditions
        }
    resamples, centre = Resamples(unseen.scene, seed), train_clean.mean(0)
    probe = None
    if train.labels is not None and unseen.labels is not None:
        probe = LinearProbe(train_clean, train.labels, train.scene)
        probe = probe if len(frequent_labels(unseen.labels[:, probe.used])) else None
    scores: dict[tuple[str, str, str], Score] = {}
    for (name, condition), values in measured.items():
        for title, compare in (("cosine", cosine), ("retrieval", retrieval)):
            similar = compare(values, unseen_clean, centre)
            scores[name, condition, title] = resamples.mean(similar)
        if probe is not None:
            assert unseen.labels is not None
            scores[name, condition, "probe"] = probe.score(values, unseen.labels, resamples)
    return scores


def average(scores: Iterable[Score]) -> Score:
    """Return the mean over conditions; all conditions use the same resamples."""
    values, samples = zip(*((score.value, score.samples) for score in scores), strict=True)
    return Score(float(np.mean(values)), np.mean(samples, axis=0))
