"""Evaluate the shortest-path oracle and a random agent: ``mitigate controls split=val_unseen``.

They are the bounds of every result: the oracle shows that the episodes of a world can be solved
with the low-level actions, the random agent shows the success of chance. Both run without
corruption, on the episodes of split=, episodes= and env= (as for mitigate evaluate). out= names the
folder of the rows (runs/controls). The same command again runs only missing episodes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core import conf
from mitigate.core.build import maker
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.core.options import check_dashes, without_config_folder
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, SUITE_VERSION
from mitigate.evaluation import rows
from mitigate.evaluation.bootstrap import share
from mitigate.evaluation.config import EvaluateConfig, read
from mitigate.evaluation.episode_lists import episodes
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of

OUT = "runs/controls"
OPTIONS = ("env", "split", "episodes", "out")  # options of an evaluation that apply here
_STOP_SHARE = 0.01  # share of STOP in random actions: about 100 actions per episode


class OracleAgent:
    """Takes the actions of the world's expert; it reads no frames."""

    def __init__(self, world: World) -> None:
        self.world = world

    def reset(self, instruction: str) -> None:
        self.expert = expert_of(self.world)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        return self.expert.action()


class RandomAgent:
    """Random forward, left and right actions, with a small chance of STOP.

    The generator is keyed by ``episode``, an id, because episodes may have equal texts.
    """

    episode = ""

    def reset(self, instruction: str) -> None:
        self.rng = generator("random agent", self.episode)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        if self.rng.random() < _STOP_SHARE:
            return STOP
        return int(self.rng.choice([FORWARD, FORWARD, LEFT, RIGHT]))


def run(config: EvaluateConfig, out: Path) -> list[rows.Row]:
    """Run both on the episodes of ``config`` and return their rows.

    The rows are also in the folder ``out``; rows that are there already are reused.
    """
    from mitigate.evaluation import provenance

    env, split = config.env, config.split
    chosen = episodes(env, split, config.episodes)
    with FolderLock(out) as lock:
        world, made_by = provenance.first_world(maker(env.world))
        provenance.keep(out, world, made_by, split, chosen, env.episodes[split])
        lock.expect(out / rows.ROWS, *provenance.notes(out, split))
        return _run_missing(world, split, chosen, out / rows.ROWS)


def _run_missing(world: World, split: str, chosen: Sequence[Episode], out: Path) -> list[rows.Row]:
    from mitigate.evaluation.episode import run_episode

    random_agent = RandomAgent()
    controls: dict[str, Any] = {"oracle": OracleAgent(world), "random": random_agent}
    earlier = rows.unique(rows.read(out) if out.exists() else ())
    known = {rows.identity(row): row for row in earlier}
    results = []
    for name, agent in controls.items():
        label = {
            "agent": name,
            "name": name,
            "corruption": "clean",
            "severity": 0.0,
            "split": split,
            "seed": 0,
            "suite": SUITE_VERSION,
            "rule": world.rule,
        }
        jobs = [(episode, {**label, **rows.of_episode(episode)}) for episode in chosen]
        todo = [job for job in jobs if rows.identity(job[1]) not in known]
        with Progress(name, len(jobs), unit="episode", start=len(jobs) - len(todo)) as progress:
            for episode, entries in todo:
                random_agent.episode = episode.episode_id
                row = entries | run_episode(agent, world, episode, CLEAN, 0)
                known[rows.identity(row)] = row
                rows.append(out, [row])
                progress.advance()
        results += [known[rows.identity(entries)] for _, entries in jobs]
    return results


def main() -> int:
    """Run from the command line; return the exit status (2 for a bad input)."""
    if {"-h", "--help"} & {*sys.argv[1:]}:
        print(__doc__)
        return 0
    options = sys.argv[1:]
    try:
        check_dashes(options)
        _check(without_config_folder(options)[1])
        config = read(conf.composed("evaluate", options))
        out = Path(config.out or OUT)
        results = run(config, out)
    except (OSError, ValueError) as error:
        print(f"controls: {conf.error_message(error)}", file=sys.stderr)
        return 2
    for name in dict.fromkeys(row["name"] for row in results):
        selected = [row for row in results if row["name"] == name]
        success, spl = (share([float(row[key]) for row in selected]) for key in ("success", "spl"))
        print(
            f"{name}: SR {100 * success.value:.1f} [{100 * success.low:.1f}, "
            f"{100 * success.high:.1f}] %, SPL {spl.value:.2f}, {counted(len(selected), 'episode')}"
        )
    print(f"rows in {out}")
    return 0


def _check(options: Sequence[str]) -> None:
    """Raise ValueError for an option of an evaluation that would have no effect."""
    for option in options:
        name = re.split(r"[.=]", option.lstrip("+~"))[0]
        if not option.startswith("-") and name not in OPTIONS:
            raise ValueError(
                f"{option} has no effect: the oracle and the random agent run without corruption "
                f"and with seed 0. Options are {', '.join(OPTIONS)}."
            )


if __name__ == "__main__":
    sys.exit("Write `mitigate controls split=val_unseen`.")
