"""Controls that frame every result: the shortest-path oracle and a random walker.

``python -m mitigate.evaluation.controls --split val_unseen --out runs/controls.jsonl`` runs both on
the shipped episodes, clean. The oracle shows that episodes can be solved with the low-level
actions; the random walker shows what chance gives.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from tqdm import tqdm

from mitigate.agents.topological.rollout import STOP_WITHIN
from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, STOP, TURN_DEGREES
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, SUITE_VERSION
from mitigate.evaluation import metrics, rows
from mitigate.evaluation.evaluator import Agent, run_episode
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import SUCCESS_METRES, load_episodes

_STOP_SHARE = 0.01  # of random actions; about 100 actions an episode


class OracleAgent:
    """Greedy geodesic follower: turns to the heading whose step lowers the geodesic distance most.

    It reads the simulator, not the frames.
    """

    def __init__(self, simulator: Simulator) -> None:
        self.simulator = simulator

    def reset(self, instruction: str) -> None:
        pass

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        simulator = self.simulator
        if simulator.distance_to_goal() < STOP_WITHIN:
            return STOP
        turns = sorted(range(-12, 13), key=abs)
        headings = [simulator.heading + np.radians(TURN_DEGREES) * turn for turn in turns]
        ends = [
            simulator.space.move(simulator.xy, heading, FORWARD_METRES)[0] for heading in headings
        ]
        best = turns[int(np.argmin([simulator.distance_to_goal(end) for end in ends]))]
        return FORWARD if best == 0 else LEFT if best > 0 else RIGHT


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
    parser.add_argument("--split", default="val_unseen", choices=["val_seen", "val_unseen"])
    parser.add_argument("--task", default="vln", choices=["vln", "ogn"])
    parser.add_argument("--episodes", type=int, default=300)
    parser.add_argument("--out", type=Path, default=Path("runs/controls.jsonl"))
    args = parser.parse_args()
    if args.episodes < 1:
        parser.error(f"--episodes {args.episodes} is none: give 1 or more.")
    simulator = Simulator()
    episodes = load_episodes(args.split, args.task)[: args.episodes]
    controls: dict[str, Agent] = {"oracle": OracleAgent(simulator), "random": RandomAgent()}
    for name, agent in controls.items():
        label = {
            "agent": name,
            "name": name,
            "corruption": "clean",
            "severity": 0.0,
            "split": args.split if args.task == "vln" else f"{args.split}_{args.task}",
            "seed": 0,
            "suite": SUITE_VERSION,
            "rule": metrics.rule(SUCCESS_METRES),
        }
        found = [
            label | {"episode_id": e.episode_id} | run_episode(agent, simulator, e, CLEAN, 0)
            for e in tqdm(episodes, desc=name)
        ]
        rows.append(args.out, found)
        print(
            f"{name}: SR {np.mean([r['success'] for r in found]):.3f}  "
            f"SPL {np.mean([r['spl'] for r in found]):.3f}  N {len(found)}"
        )


if __name__ == "__main__":
    main()
