"""Compare the success, return and retention of several agents on the same episodes, with paired
intervals.

``mitigate.harden`` uses this comparison; ``mitigate.benchmark`` uses it for tasks without a success
criterion. The tables of recipes are written by ``report.py`` instead.
"""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.agents.agent import Agent
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.names import counted
from mitigate.core.seeding import generator
from mitigate.core.spaces import ActionSpace
from mitigate.corruptions.registry import modality, title
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import LEVEL, RESAMPLES, Estimate, mean, share
from mitigate.evaluation.rows import Row
from mitigate.worlds.seeded import RETURN

CLEAN = "clean"
RANDOM = "random"  # agent name in the rows of random actions
# smallest number of equal changes that a sign test finds significant: 2 ** (1 - 6) < 0.05
ALIKE = 6
LABELS = {"rgb": "RGB", "depth": "Depth", "instruction": "Instruction"}


class RandomPolicy(Agent):
    """Agent with uniformly random actions, which are determined by a seed and the first
    observation.

    Args:
        space: action space of the world.
        seed: seed of the random actions.
    """

    def __init__(self, space: ActionSpace, seed: int = 0) -> None:
        self.space = space
        self.seed = seed
        self._rng: np.random.Generator | None = None

    def settings(self) -> dict[str, Any]:
        """Return the settings that determine the actions."""
        return {"space": str(self.space), "seed": self.seed}

    def reset(self, instruction: str) -> None:
        """Start an episode."""
        self._rng = None

    def act(self, observation: Mapping[str, Any]) -> Any:
        """Return a random action."""
        if self._rng is None:
            first = hashlib.sha256()
            for value in observation.values():
                first.update(np.asarray(value).tobytes())
            self._rng = generator(self.seed, "random policy", first.hexdigest())
        return self.space.sample(self._rng)


@dataclass(frozen=True)
class Line:
    """One line of a comparison table.

    Attributes:
        title: name of the measure, such as "SR (%): Clean".
        values: for each agent, its value.
        changes: for each agent except the first, the paired difference from the first agent.
        digits: number of decimal places.
    """

    title: str
    values: Mapping[str, Estimate]
    changes: Mapping[str, Estimate]
    digits: int = 1


@dataclass(frozen=True)
class Comparison:
    """A comparison of agents; ``str()`` gives a Markdown table.

    Attributes:
        lines: the lines of the table.
        agents: names of the agents.
        about: text that describes how the agents were evaluated.
    """

    lines: tuple[Line, ...]
    agents: tuple[str, ...]
    about: str

    def line(self, title: str) -> Line:
        """Return the line with the given title; raise KeyError if there is none."""
        known = {line.title: line for line in self.lines}
        if title not in known:
            raise KeyError(f"{title!r} must be one of {', '.join(known)}.")
        return known[title]

    def __str__(self) -> str:
        first, *others = self.agents
        heads = ["", first, *(head for name in others for head in (name, "change"))]
        rows = []
        for line in self.lines:
            form = f".{line.digits}f"
            cells = [line.values[first].text(form)]
            for name in others:
                cells += [line.values[name].text(form), _change(line.changes[name], f"+{form}")]
            rows.append([line.title, *cells])
        table = markdown_table([markdown_of(head) for head in heads], rows)
        return f"{table}\n\n{self.about}"


def compare(rows: Iterable[Row]) -> Comparison:
    """Compare the agents in ``rows``, which must have the same episode list, severity and success
    rule.

    If an episode was run with several seeds, the mean over the seeds is used.

    Rows with the name ``RANDOM`` hold the results of random actions. They are needed to compute the
    fraction of the return that an agent retains under corruption. The fraction is
    (R_corrupted - R_random) / (R_clean - R_random), where each R is a mean return.

    Raises:
        ValueError: If a corruption has several severities, the agents have no common episodes, or
            the first agent is no better than random actions.
    """
    rows = list(rows)
    if not rows:
        raise ValueError("There are no rows to compare. Evaluate the agents first.")
    cells: dict[tuple[str, str], dict[str, list[Row]]] = defaultdict(lambda: defaultdict(list))
    severities: dict[str, float] = {}
    for row in rows:
        severity = severities.setdefault(row["corruption"], row["severity"])
        if severity != row["severity"]:
            raise ValueError(
                f"Rows of {row['corruption']} must have one severity, got {severity:g} and "
                f"{row['severity']:g}. Compare the rows of one severity at a time."
            )
        cells[row["name"], row["corruption"]][row["episode_id"]].append(row)
    episodes = sorted(set.intersection(*(set(by_episode) for by_episode in cells.values())))
    if not episodes:
        raise ValueError(
            "The agents must have episodes in common. Evaluate all agents on the same list."
        )
    agents = tuple(dict.fromkeys(name for name, _ in cells if name != RANDOM))
    names = [name for name in dict.fromkeys(name for _, name in cells) if name != CLEAN]
    scores = _Scores(cells, episodes, agents)
    lines: list[Line] = []
    rule, has_random = rows[0]["rule"], (RANDOM, CLEAN) in cells
    more = "" if rule == RETURN else f" Success: {markdown_of(rule)}."
    if rule != RETURN:
        if has_random:
            scores.check_skill("success", "succeeds in a share of")
        lines += scores.lines("success", "SR (%)", names, 100.0)
        lines += scores.prs(names)
    if all(RETURN in row for row in rows) and any(row[RETURN] for row in rows):
        lines += scores.lines(RETURN, "Return", names, 1.0)
    if has_random and rule == RETURN:
        lines += scores.retention(names)
        more = (
            f" Random actions return {mean(scores.values(RANDOM, CLEAN, RETURN)).text('.1f')}. "
            "Retention = (R - R_random) / (R_clean - R_random), with R_clean of the first column."
        )
    listed_severities = sorted({severities[name] for name in names})
    seeds = sorted({row["seed"] for row in rows})
    listed_seeds = f"seed{'s' * (len(seeds) > 1)} {', '.join(map(str, seeds))}"
    about = (
        f"{counted(len(episodes), 'episode')}, {listed_seeds}, severity "
        f"{', '.join(f'{s:g}' for s in listed_severities)}.{more} Brackets: {100 * LEVEL:.0f} % "
        f"paired bootstrap over episodes, {RESAMPLES:,} resamples; where all or none succeed, "
        "or all episodes change alike, Wilson's; [–]: no resample differs. Changes in bold exclude "
        "zero."
    )
    return Comparison(tuple(lines), agents, about)


@dataclass(frozen=True)
class _Scores:
    """The result rows for measures, keyed by (agent, corruption) and then by episode."""

    cells: Mapping[tuple[str, str], Mapping[str, Sequence[Row]]]
    episodes: Sequence[str]
    agents: Sequence[str]

    def values(self, agent: str, corruption: str, measure: str) -> np.ndarray:
        """Return one value per episode [N], which is the mean over its seeds."""
        by_episode = self.cells[agent, corruption]
        return np.array([np.mean([row[measure] for row in by_episode[e]]) for e in self.episodes])

    def lines(self, measure: str, label: str, names: Sequence[str], scale: float) -> list[Line]:
        """Return the lines of a measure: its mean over corruptions, its clean value, and its value
        for each corruption.
        """
        by_condition = {
            name: {agent: scale * self.values(agent, name, measure) for agent in self.agents}
            for name in (CLEAN, *names)
        }
        largest = max(np.abs(values).max() for v in by_condition.values() for values in v.values())
        # returns between 0 and 1 need more than one decimal place
        digits = 1 if largest >= 10 else 2
        lines = []
        if len(names) > 1:
            averaged = {
                agent: np.mean([by_condition[name][agent] for name in names], axis=0)
                for agent in self.agents
            }
            heading = f"**{label}, mean of {len(names)} corruptions**"
            lines.append(self._line(heading, averaged, 0, digits))
        for name, values in by_condition.items():
            most = scale * (scale > 1)
            lines.append(self._line(f"{label}: {title(name)}", values, most, digits))
        return lines

    def _line(
        self, heading: str, values: Mapping[str, np.ndarray], most: float, digits: int
    ) -> Line:
        """Return one line.

        If the measure uses a Wilson interval, ``most`` is its value for a successful episode.
        Otherwise ``most`` is 0.
        """
        first, *others = self.agents
        estimates = {agent: _mean(values[agent], most) for agent in self.agents}
        changes = {agent: _difference(values[agent] - values[first]) for agent in others}
        return Line(heading, estimates, changes, digits)

    def retention(self, names: Sequence[str]) -> list[Line]:
        """Return the lines that show how much of the return is kept: on average, and for each
        corruption.
        """
        random = self.values(RANDOM, CLEAN, RETURN)
        self.check_skill(RETURN, "returns")
        groups = {f"**Retention, mean of {len(names)} corruptions**": names}
        groups = groups if len(names) > 1 else {}
        groups |= {f"Retention: {title(name)}": [name] for name in names}
        return [self._ratio(heading, RETURN, group, random) for heading, group in groups.items()]

    def check_skill(self, measure: str, verb: str) -> None:
        """Raise ValueError if the first agent is no better than random actions on clean frames."""
        agent = self.agents[0]
        value, random = (self.values(name, CLEAN, measure).mean() for name in (agent, RANDOM))
        if value <= random:
            raise ValueError(
                f"The policy {agent!r} {verb} {value:.2f} on clean episodes, no better than random "
                f"actions ({random:.2f}). Train it further, or check the observations that it gets."
            )

    def prs(self, names: Sequence[str]) -> list[Line]:
        """Return the lines with PRS-SR, one per modality, or no lines if an agent never succeeds on
        clean frames.
        """
        if not all(self.values(agent, CLEAN, "success").any() for agent in self.agents):
            return []
        groups: dict[str, list[str]] = defaultdict(list)
        for name in names:
            groups[f"PRS-SR ({LABELS.get(modality(name), modality(name))})"].append(name)
        return [self._ratio(heading, "success", group) for heading, group in groups.items()]

    def _ratio(
        self, heading: str, measure: str, names: Sequence[str], base: np.ndarray | float = 0.0
    ) -> Line:
        """Return the line with the mean of (corrupted - base) / (clean - base) over the corruptions
        ``names``.

        PRS divides by the clean success of the same agent, as the paper does. Retention divides by
        the clean return of the first agent, so that an agent cannot raise its retention by doing
        worse on clean frames.
        """
        first, *others = self.agents
        pairs = {}
        for agent in self.agents:
            clean = self.values(first if measure == RETURN else agent, CLEAN, measure)
            corrupted = np.mean([self.values(agent, name, measure) for name in names], axis=0)
            pairs[agent] = clean - base, corrupted - base
        estimates = {agent: bootstrap.prs(*pair) for agent, pair in pairs.items()}
        changes = {agent: bootstrap.prs_difference(pairs[agent], pairs[first]) for agent in others}
        return Line(heading, estimates, changes, digits=2)


def _mean(values: np.ndarray, most: float) -> Estimate:
    if not most:
        return mean(values)
    part = share(values / most)
    return Estimate(most * part.value, most * part.low, most * part.high)


def _difference(changes: np.ndarray) -> Estimate:
    """Return the mean of the episodes' changes [N] with its interval.

    If all changes are equal, no resample differs. The interval is then that of Wilson for the
    fraction of episodes that change.
    """
    estimate = mean(changes)
    if estimate.has_width or not estimate.value or len(changes) < ALIKE:
        return estimate
    part = share(np.ones(len(changes)))
    bounds = sorted((estimate.value * part.low, estimate.value * part.high))
    return Estimate(estimate.value, *bounds)


def _change(estimate: Estimate, form: str) -> str:
    text = f"{estimate.value:{form}}"
    return f"{f'**{text}**' if estimate.excludes_zero else text} {estimate.interval(form)}"
