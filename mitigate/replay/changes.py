"""How much a corruption changes of an agent's decisions along a drive, with intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mitigate.core.observation import STOP
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.replay.walk import Answers
from mitigate.worlds.recorded import Recording
from mitigate.worlds.recorded.recording import NONE

FAR = 0.5  # metres, two steps (ours)
FEW = 8  # runs of steps that are too few to be resampled (ours)
BLOCK = 10  # consecutive steps that are drawn as one: neighbours are alike (ours)


@dataclass(frozen=True)
class Changes:
    """Of an agent under one condition, over all drives.

    changed: share of the steps whose action differs from that on clean frames. stops, missed: steps
    at which it stops and did not, and the other way round. aim: share of the steps at which the
    point that it walks to moved by more than ``FAR``, None if it has none. agreement: share of the
    steps at which it does what the driver did, of those that one of its actions can name, or None
    where that is not known. steps: how many.
    """

    changed: Estimate
    stops: int
    missed: int
    aim: Estimate | None
    agreement: Estimate | None
    steps: int


def compare(
    recordings: Sequence[Recording], clean: Mapping[str, Answers], found: Mapping[str, Answers]
) -> Changes:
    """Compare answers with those on clean frames, by the drives' names."""
    pairs = [(clean[r.name], found[r.name]) for r in recordings]
    changed = [a.actions != b.actions for a, b in pairs]
    stops = sum(int(((b.actions == STOP) & (a.actions != STOP)).sum()) for a, b in pairs)
    missed = sum(int(((a.actions == STOP) & (b.actions != STOP)).sum()) for a, b in pairs)
    moved = [np.hypot(*(b.aims - a.aims).T) for a, b in pairs]
    moved = [part[np.isfinite(part)] > FAR for part in moved if np.isfinite(part).any()]
    known = [(r.driven.actions, found[r.name].actions) for r in recordings if r.driven is not None]
    agrees = [(mine == his)[his != NONE] for his, mine in known if (his != NONE).any()]
    return Changes(
        _share(changed),
        stops,
        missed,
        _share(moved) if moved else None,
        _share(agrees) if agrees else None,
        sum(map(len, changed)),
    )


def _share(walks: Sequence[np.ndarray]) -> Estimate:
    """The share of true steps with its interval: by resampling runs of ``BLOCK`` steps, or, of
    fewer than ``FEW`` runs or runs that are alike, Wilson's score interval, each run counting
    once."""
    blocks = [part for walk in walks for part in _blocks(walk)]
    true, steps = (np.array([measure(part) for part in blocks]) for measure in (np.sum, len))
    value = float(true.sum() / steps.sum())
    if len(blocks) >= FEW and np.ptp(true / steps) > 0:
        return bootstrap.ratio(true, steps)
    n, z = len(blocks), bootstrap.Z
    middle = (value + z * z / (2 * n)) / (1 + z * z / n)
    half = z * np.sqrt(value * (1 - value) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return Estimate(value, max(0.0, float(middle - half)), min(1.0, float(middle + half)))


def _blocks(walk: np.ndarray) -> list[np.ndarray]:
    """Runs of about ``BLOCK`` steps, alike in length."""
    return np.array_split(walk.astype(float), max(1, round(len(walk) / BLOCK)))
