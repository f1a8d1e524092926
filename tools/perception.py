"""Measure what an agent's encoders recognise under each corruption, in half a minute.

    python tools/perception.py checkpoints/base runs/mine/agent

The tool uses random poses of a validation split under every corruption. The score of RGB is the F1
of the objects in each view (labels from the id pass of the renderer). The score of depth is the
overlap of predicted and true free space. Closed-loop success is the final measure; these scores
show where success is lost.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import torch
from hydra import compose, initialize_config_dir
from tqdm import tqdm

from mitigate.agents.text import THINGS
from mitigate.core import conf
from mitigate.core.markdown import markdown_table
from mitigate.core.names import name_of
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, NAMES, Corruption, Key, corrupt_observation
from mitigate.corruptions.registry import HALVES, modality, unseen_names
from mitigate.evaluation.bootstrap import resampled_means
from mitigate.evaluation.evaluate import load
from mitigate.evaluation.sections import label
from mitigate.guards.guard import Guard
from mitigate.guards.opening import open_restorer
from mitigate.worlds.apartments.labels import free_directions, view_labels
from mitigate.worlds.apartments.renderer import Renderer
from mitigate.worlds.apartments.simulator import apartment_of
from mitigate.worlds.apartments.tasks import load_episodes

SIZE = 64  # view size in pixels, as in the input of the reference agent
SUITES = {"full": NAMES, **{half: unseen_names("rgb", "depth", half=half) for half in HALVES}}


class Poses:
    """Return clean observations with labels at ``count`` random poses in a split's layouts."""

    def __init__(self, split: str, count: int, seed: int) -> None:
        scenes = sorted({episode.scene_id for episode in load_episodes(split)})
        self.seed = seed
        self.observations: list[dict[str, np.ndarray]] = []
        self.things: list[np.ndarray] = []
        self.free: list[np.ndarray] = []
        renderer = Renderer(SIZE)
        for index in range(count):
            rng = generator(seed, "poses", index)
            apartment = apartment_of(scenes[index % len(scenes)])
            xy = apartment.space.centre(int(rng.integers(len(apartment.space.cells))))
            heading = float(rng.uniform(-np.pi, np.pi))
            renderer.load(apartment)
            rgb, depth, ids = renderer.render(float(xy[0]), float(xy[1]), heading)
            pose = np.array([*xy, heading], np.float32)
            self.observations.append({RGB: rgb.copy(), DEPTH: depth.copy(), POSE: pose})
            self.things.append(view_labels(apartment, ids, depth)[0][:, THINGS] > 0.5)
            self.free.append(free_directions(apartment.space, xy, heading) > 0.5)

    @torch.no_grad()
    def counts(
        self, agent: Any, corruption: Corruption, restorer: Guard | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return numerators and denominators of the scores per pose, for objects and for free
        space.

        Returns:
            Two arrays, float64 [2, poses]. The ratio of their sums is the micro F1 of objects, and
            the intersection over union of free space.
        """
        things, free = [], []
        for index, clean in enumerate(self.observations):
            observation = corrupt_observation(clean, corruption, Key(self.seed, f"pose {index}", 0))
            if restorer is not None:
                observation = restorer.observe(observation)
            frames = (torch.from_numpy(observation[name])[None] for name in (RGB, DEPTH))
            _, concepts, waypoints = agent.perceive(*frames)
            predicted = concepts[0, :, THINGS].cpu().numpy() > 0
            true = self.things[index]
            things.append((2 * (predicted & true).sum(), predicted.sum() + true.sum()))
            predicted_free = waypoints[0].cpu().numpy() > 0
            true_free = self.free[index]
            free.append(((predicted_free & true_free).sum(), (predicted_free | true_free).sum()))
        return np.array(things, float).T, np.array(free, float).T


def measure(
    agent: Any,
    poses: Poses,
    names: Sequence[str],
    severity: float,
    restorer: Guard | None = None,
) -> dict[str, tuple[float, float, float]]:
    """Return the score of each condition with its 95 % interval over poses.

    The score of "clean" and RGB corruptions is the F1 of objects; the score of "clean depth" and
    depth corruptions is the overlap of free space.
    """
    things, free = poses.counts(agent, CLEAN, restorer)
    scores = {"clean": _ratio(things), "clean depth": _ratio(free)}
    for name in names:
        things, free = poses.counts(agent, Corruption(name, severity), restorer)
        scores[name] = _ratio(things if modality(name) == "rgb" else free)
    return scores


def _ratio(counts: np.ndarray) -> tuple[float, float, float]:
    """Return the ratio of the sums with its 95 % interval."""
    samples = resampled_means(counts, resamples=2000)
    low, high = np.quantile(samples[:, 0] / samples[:, 1], (0.025, 0.975))
    return float(counts[0].sum() / counts[1].sum()), float(low), float(high)


def table(scores: dict[str, dict[str, tuple[float, float, float]]]) -> str:
    """Return a Markdown table in percent, with a row per condition and a column per agent."""
    conditions = tuple(next(iter(scores.values())))
    corruptions = [n for n in conditions if not n.startswith("clean")]
    rgb, depth = ([n for n in corruptions if modality(n) == sensor] for sensor in (RGB, DEPTH))
    lines = []
    for name in ("clean", *rgb, "clean depth", *depth):
        cells = [by_condition[name] for by_condition in scores.values()]
        title = {"clean": "Clean RGB", "clean depth": "Clean depth"}.get(name) or label(name)
        lines.append(
            [title, *(f"{100 * v:.1f} [{100 * a:.1f}, {100 * b:.1f}]" for v, a, b in cells)]
        )
    for row, sensor, names in ((1 + len(rgb), "RGB", rgb), (len(lines) + 1, "depth", depth)):
        means = [np.mean([by_condition[n][0] for n in names]) for by_condition in scores.values()]
        lines.insert(row, [f"**Mean of {sensor}**", *(f"{100 * m:.1f}" for m in means)])
    return markdown_table(["", *scores], lines)


def _column(weights: str, used: Collection[str]) -> str:
    """Return the name of ``weights``, or their path if ``used`` already contains that name."""
    name = name_of(weights)
    return weights if name in used else name


@lru_cache(maxsize=1)
def _agent_node() -> Any:
    with initialize_config_dir(str(conf.CONF), version_base="1.3"):
        return compose("evaluate").agent


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description="Print what agents recognise under each corruption, in percent: F1 of the "
        "objects in each view (RGB), overlap of the free space (depth), with 95 % intervals over "
        "poses."
    )
    parser.add_argument("agents", nargs="+", help="weights: folders or .safetensors files")
    parser.add_argument("--split", default="val_seen", choices=("val_seen", "val_unseen"))
    parser.add_argument(
        "--suite",
        default="full",
        choices=list(SUITES),
        help="the standard suite, or a half of the unseen corruptions",
    )
    parser.add_argument("--poses", type=int, default=60, help="number of poses (default 60)")
    parser.add_argument("--severity", type=float, default=0.6)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--restore", help="folder of a restorer: also measure each agent with restored frames"
    )
    options = parser.parse_args(arguments)
    if options.poses < 1:
        raise ValueError(f"--poses must be >= 1, got {options.poses}.")
    agents: dict[str, Any] = {}
    # all are loaded before the first measurement, to find wrong paths early
    for weights in options.agents:
        agents[_column(weights, agents)] = load(_agent_node(), weights)
    poses = Poses(options.split, options.poses, options.seed)
    scores = {}
    names = SUITES[options.suite]
    restorer = open_restorer(options.restore)
    for name, agent in tqdm(agents.items(), desc="agents", disable=None):
        scores[name] = measure(agent, poses, names, options.severity)
        if restorer is not None:
            scores[f"{name}+restorer"] = measure(agent, poses, names, options.severity, restorer)
    print(
        f"{options.poses} poses of {options.split}, severity {options.severity:g}, seed "
        f"{options.seed}\n\n{table(scores)}"
    )


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")
