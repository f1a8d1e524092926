"""Controls that frame every result: the shortest-path oracle and a random walker.

``python -m mitigate.evaluation.controls --split val_unseen --out runs/controls.jsonl`` runs both on
the episodes of a world, clean. The oracle shows that episodes can be solved with the low-level
actions; the random walker shows what chance gives.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mitigate.agents.agent import Agent
from mitigate.core import conf
from mitigate.core.build import maker
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, SUITE_VERSION
from mitigate.evaluation import rows
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.episode_lists import episodes
from mitigate.worlds.world import World, expert_of

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
    """Forward, left and right at random, with a small chance of STOP; keyed by the text."""

    def reset(self, instruction: str) -> None:
        self.rng = generator("random agent", instruction)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        if self.rng.random() < _STOP_SHARE:
            return STOP
        return int(self.rng.choice([FORWARD, FORWARD, LEFT, RIGHT]))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--env", default="apartments", help="a config of conf/env")
    parser.add_argument("--split", default="val_unseen", choices=["val_seen", "val_unseen"])
    parser.add_argument("--task", default="vln", choices=["vln", "ogn"])
    parser.add_argument("--episodes", type=int, default=300)
    parser.add_argument("--out", type=Path, default=Path("runs/controls.jsonl"))
    args = parser.parse_args()
    if args.episodes < 1:
        parser.error(f"--episodes {args.episodes} is none: give 1 or more.")
    env = conf.load_config("evaluate", [f"env={args.env}"]).env
    split = args.split if args.task == "vln" else f"{args.split}_{args.task}"
    world, chosen = maker(env.world)(), episodes(env, split, args.episodes)
    controls: dict[str, Agent] = {"oracle": OracleAgent(world), "random": RandomAgent()}
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
        found = []
        with Progress(name, len(chosen), unit="episode") as progress:
            for episode in chosen:
                measures = run_episode(agent, world, episode, CLEAN, 0)
                found.append(label | {"episode_id": episode.episode_id} | measures)
                progress.advance()
        rows.append(args.out, found)
        print(
            f"{name}: SR {np.mean([r['success'] for r in found]):.3f}  "
            f"SPL {np.mean([r['spl'] for r in found]):.3f}  N {len(found)}"
        )


if __name__ == "__main__":
    main()
