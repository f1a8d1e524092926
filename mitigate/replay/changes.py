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

BLOCK = 10  # consecutive steps that are drawn as one: neighbours are alike (ours)


@dataclass(frozen=True)
class Changes:
    """Of an agent under one condition, over all drives.

    changed: share of the steps whose action differs from that on clean frames. stops, missed: steps
    at which it stops and did not, and the other way round. aim: median metres by which the point
    that it walks to moved, NaN if it has none. agreement: share of the steps at which it does what
    the driver did, or None where that is not known. steps: how many.
    """

    changed: Estimate
    stops: int
    missed: int
    aim: float
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
    moved = np.concatenate([np.hypot(*(b.aims - a.aims).T) for a, b in pairs])
    moved = moved[np.isfinite(moved)]
    known = [(r, found[r.name]) for r in recordings if r.driven is not None]
    agrees = [answers.actions == r.driven for r, answers in known]
    return Changes(
        _share(changed),
        stops,
        missed,
        float(np.median(moved)) if len(moved) else float("nan"),
        _share(agrees) if agrees else None,
        sum(map(len, changed)),
    )


def _share(walks: Sequence[np.ndarray]) -> Estimate:
    """The share of true steps with its interval, by resampling runs of ``BLOCK`` steps."""
    steps = np.concatenate(walks).astype(float)
    blocks = [part for walk in walks for part in _blocks(walk)]
    values = np.array([part.mean() for part in blocks])
    found = bootstrap.share(values)
    return Estimate(float(steps.mean()), found.low, found.high)


def _blocks(walk: np.ndarray) -> list[np.ndarray]:
    """Runs of about ``BLOCK`` steps, alike in length."""
    return np.array_split(walk.astype(float), max(1, round(len(walk) / BLOCK)))
