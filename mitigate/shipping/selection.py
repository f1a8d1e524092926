"""Choose between the given policy, its trained copy and the average of their weights.

When a policy is trained on corruptions, it can lose abilities that it had before. The average of
the weights before and after training often keeps old and new abilities (WiSE-FT: Wortsman et al.,
"Robust fine-tuning of zero-shot models", CVPR 2022). Which of the three sets of weights is best
depends on the policy, so they are compared on validation episodes.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import torch
from torch import Tensor

from mitigate.agents.policies.policy import Policy, copied
from mitigate.core.progress import say
from mitigate.evaluation.comparison import CLEAN as CLEAN_NAME
from mitigate.evaluation.rows import Row
from mitigate.worlds.seeded import RETURN

# maps each candidate to the factor of the trained weights in its average (0.75 is heuristic)
MIXES = {"trained": 1.0, "averaged": 0.75, "given": 0.0}


def choose(policy: Policy, start: Mapping[str, Tensor], measure: Callable[..., list[Row]]) -> str:
    """Load the best weights into ``policy``, and return their name, which is a key of ``MIXES``.

    The score of an episode is the mean of two numbers: the success on clean frames, and the mean
    success under the corruptions. If the world measures only the return, the score uses returns.
    The given weights are kept unless the mean gain per episode exceeds its standard error (the
    one-standard-error rule: Breiman et al., "Classification and regression trees", 1984).

    Args:
        policy: the trained policy, changed in place.
        start: the weights of ``policy`` before training.
        measure: function that evaluates a policy on the validation episodes, clean and corrupted,
            and returns the rows. The function is called with the policy, ``name`` and ``version``.
    """
    end = {name: value.clone() for name, value in policy.network.state_dict().items()}
    scores: dict[str, np.ndarray] = {}
    for name, mix in MIXES.items():
        candidate = copied(policy)
        candidate.network.load_state_dict(average(start, end, mix))
        scores[name] = episode_scores(measure(candidate, name=name, version=candidate.version))
    best = max(MIXES, key=lambda name: scores[name].mean())
    gain = scores[best] - scores["given"]
    count = len(gain)
    error = gain.std(ddof=1) / math.sqrt(count) if count > 1 else 0.0
    if gain.mean() <= error:
        best = "given"
    listed = ", ".join(f"{name} {value.mean():.3g}" for name, value in scores.items())
    say(f"harden: mean score of {count} validation episodes: {listed}. Chosen: {best}.")
    policy.network.load_state_dict(average(start, end, MIXES[best]))
    return best


def average(
    start: Mapping[str, Tensor], end: Mapping[str, Tensor], mix: float
) -> dict[str, Tensor]:
    """Return ``(1 - mix) * start + mix * end``.

    Integer tensors, such as counters, are not averaged. Such tensors are copied from ``end`` if
    ``mix`` is at least 0.5, and from ``start`` otherwise.
    """
    nearer = end if mix >= 0.5 else start
    return {
        name: torch.lerp(start[name], end[name], mix) if value.is_floating_point() else nearer[name]
        for name, value in end.items()
    }


def episode_scores(rows: Sequence[Row]) -> np.ndarray:
    """Return the score of each episode, sorted by ``episode_id``."""
    measure = RETURN if rows[0]["rule"] == RETURN else "success"
    clean: dict[str, float] = {}
    corrupted: dict[str, list[float]] = defaultdict(list)
    for row in rows:
        if row["corruption"] == CLEAN_NAME:
            clean[row["episode_id"]] = row[measure]
        else:
            corrupted[row["episode_id"]].append(row[measure])
    return np.array([(clean[name] + np.mean(corrupted[name])) / 2 for name in sorted(clean)])
