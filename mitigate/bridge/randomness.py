"""How much the results of an agent differ from one clean run to the next."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from mitigate.evaluation import bootstrap
from mitigate.evaluation.rows import Row


def randomness(runs: Sequence[Sequence[Row]]) -> str:
    """Return a Markdown paragraph on repeated clean runs: their SR, the share of episodes that end
    otherwise in another run, and the SR difference of the first two with its interval.

    Only episodes that all runs hold count, by the rule of the first row.
    """
    rule = runs[0][0]["rule"]
    held = [{r["episode_id"]: r["success"] for r in run if r["rule"] == rule} for run in runs]
    names = sorted(set.intersection(*(set(run) for run in held)))
    if not names:
        return "The repeated clean runs have no episode in common.\n"
    won = np.array([[run[name] for name in names] for run in held])
    flips = np.mean([np.mean(a != b) for a, b in combinations(won, 2)])
    moved = bootstrap.mean(won[1] - won[0])
    rates = ", ".join(f"{100 * rate:.1f}" for rate in won.mean(axis=1))
    return (
        f"## The agent's own randomness\n\n{len(runs)} clean runs of the same {len(names)} "
        f"episodes: SR {rates}. From one run to another {100 * flips:.1f} % of the episodes end "
        f"otherwise; second minus first {100 * moved.value:+.1f} "
        f"{moved.interval('+.1f', 100)}. A difference between two conditions "
        "that is not larger says nothing.\n"
    )
