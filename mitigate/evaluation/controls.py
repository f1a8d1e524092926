"""Walk the shortest-path oracle and a random walker: ``mitigate controls split=val_unseen``.

They frame every result: the oracle shows that a world's episodes can be solved with the low-level
actions, the random walker what chance gives. Both walk clean, on the episodes of split=, episodes=
and env=, as of mitigate evaluate; out= names the folder of the rows (runs/controls). The same
command again only walks what is missing.
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
OPTIONS = ("env", "split", "episodes", "out")  # those of an evaluation that mean anything here
_STOP_SHARE = 0.01  # of random actions; about 100 actions an episode


class OracleAgent:
    """Does what the world's expert says; it reads no frames."""

    def __init__(self, world: World) -> None:
        self.world = world

    def reset(self, instruction: str) -> None:
        self.expert = expert_of(self.world)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        return self.expert.action()


class RandomAgent:
    """Forward, left and right at random, with a small chance of STOP; keyed by ``episode``, an id,
    since many episodes may have one text."""

    episode = ""

    def reset(self, instruction: str) -> None:
        self.rng = generator("random agent", self.episode)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        if self.rng.random() < _STOP_SHARE:
            return STOP
        return int(self.rng.choice([FORWARD, FORWARD, LEFT, RIGHT]))


def run(config: EvaluateConfig, out: Path) -> list[rows.Row]:
    """Walk both on the episodes that ``config`` names; return their rows, which are in the folder
    ``out`` too. Those that it has count."""
    from mitigate.evaluation import provenance

    env, split = config.env, config.split
    chosen = episodes(env, split, config.episodes)
    with FolderLock(out) as lock:
        world, made_by = provenance.first_world(maker(env.world))
        provenance.keep(out, world, made_by, split, chosen, env.episodes[split])
        lock.expect(out / rows.ROWS, *provenance.notes(out, split))
        return _walked(world, split, chosen, out / rows.ROWS)


def _walked(world: World, split: str, chosen: Sequence[Episode], out: Path) -> list[rows.Row]:
    from mitigate.evaluation.episode import run_episode

    chance = RandomAgent()
    controls: dict[str, Any] = {"oracle": OracleAgent(world), "random": chance}
    earlier = rows.unique(rows.read(out) if out.exists() else ())
    held = {rows.identity(row): row for row in earlier}
    found = []
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
        todo = [job for job in jobs if rows.identity(job[1]) not in held]
        with Progress(name, len(jobs), unit="episode", start=len(jobs) - len(todo)) as progress:
            for episode, own in todo:
                chance.episode = episode.episode_id
                row = own | run_episode(agent, world, episode, CLEAN, 0)
                held[rows.identity(row)] = row
                rows.append(out, [row])
                progress.advance()
        found += [held[rows.identity(own)] for _, own in jobs]
    return found


def main() -> int:
    """Run from the command line; return the exit status (2 for a bad input)."""
    if {"-h", "--help"} & {*sys.argv[1:]}:
        print(__doc__)
        return 0
    given = sys.argv[1:]
    try:
        check_dashes(given)
        _check(without_config_folder(given)[1])
        config = read(conf.composed("evaluate", given))
        out = Path(config.out or OUT)
        found = run(config, out)
    except (OSError, ValueError) as error:
        print(f"controls: {conf.said(error)}", file=sys.stderr)
        return 2
    for name in dict.fromkeys(row["name"] for row in found):
        own = [row for row in found if row["name"] == name]
        success, spl = (share([float(row[key]) for row in own]) for key in ("success", "spl"))
        print(
            f"{name}: SR {100 * success.value:.1f} [{100 * success.low:.1f}, "
            f"{100 * success.high:.1f}] %, SPL {spl.value:.2f}, {counted(len(own), 'episode')}"
        )
    print(f"rows in {out}")
    return 0


def _check(options: Sequence[str]) -> None:
    """Raise ValueError for an option of an evaluation that would have no effect."""
    for option in options:
        name = re.split(r"[.=]", option.lstrip("+~"))[0]
        if not option.startswith("-") and name not in OPTIONS:
            raise ValueError(
                f"{option} has no effect: oracle and random walker walk clean, by seed 0. Options "
                f"are {', '.join(OPTIONS)}."
            )


if __name__ == "__main__":
    sys.exit("Write `mitigate controls split=val_unseen`.")
