"""Evaluate the shortest-path oracle and a random agent: ``mitigate controls split=val_unseen``.

They are the bounds of every result: the oracle shows that the episodes of a world can be solved
with the low-level actions, the random agent shows the success of chance. Both run without
corruption, on the episodes of split=, episodes= and env= (as for mitigate evaluate). out= names the
folder of the rows (runs/controls). The same command again runs only missing episodes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from mitigate.core import conf
from mitigate.core.build import maker
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.core.options import check_dashes, without_config_folder
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, SUITE_VERSION
from mitigate.evaluation import provenance, rows
from mitigate.evaluation.bootstrap import share
from mitigate.evaluation.config import EvaluateConfig, read
from mitigate.evaluation.episode_lists import episodes
from mitigate.evaluation.evaluator import EpisodeTask, Job, run_missing
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


class ControlTask(EpisodeTask):
    """Runs episodes of a control, one per group; the random agent is keyed by the episode."""

    def work(self, jobs: Sequence[Job]) -> Iterator[rows.Row]:
        if isinstance(self.agent, RandomAgent):
            self.agent.episode = jobs[0][0].episode_id
        return super().work(jobs)


def run(config: EvaluateConfig, out: Path) -> list[rows.Row]:
    """Run both on the episodes of ``config`` and return their rows.

    The rows are also in the folder ``out``; rows that are there already are reused.
    """
    env, split = config.env, config.split
    chosen = episodes(env, split, config.episodes)
    make_world = maker(env.world)
    results: list[rows.Row] = []
    with FolderLock(out) as lock:
        world, made_by = provenance.first_world(make_world)
        provenance.keep(out, world, made_by, split, chosen, env.episodes[split])
        lock.expect(out / rows.ROWS, *provenance.notes(out, split))
        for name, agent in {"oracle": OracleAgent(world), "random": RandomAgent()}.items():
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
            jobs = [(episode, CLEAN, {**label, **rows.of_episode(episode)}) for episode in chosen]
            task = ControlTask(agent, make_world, world=world)
            results += run_missing(task, world, jobs, out / rows.ROWS, name)
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
