"""Tables of the return: for tasks that have no success.

The retention of a return is (R_corrupted - R_random) / (R_clean - R_random): 1 means that
corruption costs nothing, 0 that the policy is no better than random actions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.agents.agent import Agent
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.seeding import generator
from mitigate.core.spaces import ActionSpace
from mitigate.evaluation.bootstrap import LEVEL, RESAMPLES, Estimate, resampled_means
from mitigate.evaluation.rows import RETURN, Row

RANDOM = "random"  # name of the rows of random actions
_BOUNDS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)


class RandomPolicy(Agent):
    """An agent with uniformly random actions, keyed by a seed and the number of the episode."""

    sensors: Sequence[str] = ()

    def __init__(self, space: ActionSpace, seed: int = 0) -> None:
        self.space = space
        self.seed = seed

    def settings(self) -> dict[str, Any]:
        return {"space": str(self.space), "seed": self.seed}

    def reset(self, instruction: str) -> None:
        self._rng = generator(self.seed, "random policy", instruction)

    def act(self, observation: Mapping[str, Any]) -> Any:
        return self.space.sample(self._rng)


@dataclass(frozen=True)
class ReturnReport:
    """Returns of agents, clean and corrupted, over the same episodes.

    Attributes:
        means: mean return by (agent, corruption).
        retention: retention by (agent, corruption), and over all corruptions under the name "mean".
        gain: difference of the mean retention to the first agent, by agent.
        episodes: number of episodes.
    """

    means: dict[tuple[str, str], Estimate]
    retention: dict[tuple[str, str], Estimate]
    gain: dict[str, Estimate] = field(default_factory=dict)
    episodes: int = 0

    def __str__(self) -> str:
        """Return the report as a Markdown table."""
        agents = list(dict.fromkeys(agent for agent, _ in self.means if agent != RANDOM))
        corruptions = list(dict.fromkeys(name for agent, name in self.means if agent != RANDOM))
        lines = []
        for name in corruptions:
            cells = [_cell(self.means.get((agent, name)), ".1f") for agent in agents]
            lines.append([f"Return, {markdown_of(name)}", *cells])
        for name in [*corruptions[1:], "mean"]:
            title = "**Retention, mean**" if name == "mean" else f"Retention, {markdown_of(name)}"
            lines.append(
                [title, *(_cell(self.retention.get((agent, name)), ".2f") for agent in agents)]
            )
        if self.gain:
            cells = ["", *(_cell(self.gain[agent], "+.2f") for agent in agents[1:])]
            lines.append([f"Mean retention against {markdown_of(agents[0])}", *cells])
        random = self.means[RANDOM, "clean"]
        table = markdown_table(["", *map(markdown_of, agents)], lines)
        return (
            f"{table}\n\n{self.episodes} episodes. Random actions return {_cell(random, '.1f')}. "
            f"Retention = (R - R_random) / (R_clean - R_random). Brackets: {100 * LEVEL:.0f} % "
            f"paired bootstrap over episodes, {RESAMPLES:,} resamples."
        )


def returns(rows: Iterable[Row]) -> ReturnReport:
    """Return the report of rows with returns, of one split and severity, with rows of ``RANDOM``.

    Raises:
        ValueError: Rows are missing, or clean episodes return no more than random actions.
    """
    cells: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    for row in rows:
        if RETURN not in row:
            raise ValueError(
                f"The rows of {row['name']} must hold the return. Evaluate again with this version."
            )
        cells[row["name"], row["corruption"]][row["episode_id"]] = float(row[RETURN])
    if (RANDOM, "clean") not in cells:
        raise ValueError("The rows must hold clean episodes of random actions. Evaluate again.")
    episodes = sorted(set.intersection(*(set(values) for values in cells.values())))
    if not episodes:
        raise ValueError("The agents must share episodes. Evaluate all of them on the same list.")
    table = np.array([[values[e] for e in episodes] for values in cells.values()])
    samples = resampled_means(table)
    value = dict(zip(cells, table.mean(1), strict=True))
    sample = dict(zip(cells, samples.T, strict=True))
    means = {cell: _estimate(value[cell], sample[cell]) for cell in cells}
    retention: dict[tuple[str, str], Estimate] = {}
    average: dict[str, tuple[float, np.ndarray]] = {}
    for agent in dict.fromkeys(name for name, _ in cells if name != RANDOM):
        span = value[agent, "clean"] - value[RANDOM, "clean"]
        if span <= 0:
            raise ValueError(
                f"{agent} returns {value[agent, 'clean']:.1f} on clean episodes, no more than "
                f"random actions ({value[RANDOM, 'clean']:.1f}), so that retention is undefined. "
                "Train it further, or check its observations."
            )
        spans = sample[agent, "clean"] - sample[RANDOM, "clean"]
        shares = {
            name: (
                (value[agent, name] - value[RANDOM, "clean"]) / span,
                (sample[agent, name] - sample[RANDOM, "clean"]) / spans,
            )
            for one, name in cells
            if one == agent and name != "clean"
        }
        retention |= {(agent, name): _estimate(*share) for name, share in shares.items()}
        if shares:
            values, draws = zip(*shares.values(), strict=True)
            average[agent] = float(np.mean(values)), np.mean(draws, axis=0)
            retention[agent, "mean"] = _estimate(*average[agent])
    first, *others = average or [""]
    gain = {
        agent: _estimate(
            average[agent][0] - average[first][0], average[agent][1] - average[first][1]
        )
        for agent in others
    }
    return ReturnReport(means, retention, gain, len(episodes))


def _estimate(value: float, samples: np.ndarray) -> Estimate:
    low, high = np.quantile(samples, _BOUNDS)
    return Estimate(float(value), float(low), float(high))


def _cell(estimate: Estimate | None, form: str) -> str:
    if estimate is None:
        return "–"
    return f"{estimate.value:{form}} {estimate.interval(form)}"
