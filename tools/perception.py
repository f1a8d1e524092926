"""What an agent still sees under each corruption: a look at its encoders in half a minute.

    python tools/perception.py checkpoints/base runs/mine/agent

Random poses of a validation split, each under every corruption; RGB is scored by the F1 of the
things that each view shows (labels of the id pass), depth by the overlap of the predicted and the
true free space. Closed-loop success is what counts; this says where it is lost.
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

SIZE = 64  # pixels, as the reference agent sees
SUITES = {"full": NAMES, **{half: unseen_names("rgb", "depth", half=half) for half in HALVES}}


class Poses:
    """``count`` random poses of a split's layouts: clean observations and their labels."""

    def __init__(self, split: str, count: int, seed: int) -> None:
        scenes = sorted({episode.scene_id for episode in load_episodes(split)})
        self.seed, self.observations, self.things, self.free = seed, [], [], []
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
        """For things and for free space: float64 [2, poses], (right ones, what they are a share
        of), so that the ratio of sums is the micro F1, or the intersection over union."""
        things, free = [], []
        for index, clean in enumerate(self.observations):
            seen = corrupt_observation(clean, corruption, Key(self.seed, f"pose {index}", 0))
            seen = seen if restorer is None else restorer.observe(seen)
            frames = (torch.from_numpy(seen[name])[None] for name in (RGB, DEPTH))
            _, concepts, waypoints = agent.perceive(*frames)
            said, true = concepts[0, :, THINGS].cpu().numpy() > 0, self.things[index]
            things.append((2 * (said & true).sum(), said.sum() + true.sum()))
            open_, real = waypoints[0].cpu().numpy() > 0, self.free[index]
            free.append(((open_ & real).sum(), (open_ | real).sum()))
        return np.array(things, float).T, np.array(free, float).T


def measure(
    agent: Any,
    poses: Poses,
    names: Sequence[str],
    severity: float,
    restorer: Guard | None = None,
) -> dict[str, tuple[float, float, float]]:
    """Score with its 95 % interval over poses, by condition: "clean" and every RGB corruption of
    ``names`` (F1), "clean depth" and every depth corruption (overlap)."""
    things, free = poses.counts(agent, CLEAN, restorer)
    found = {"clean": _ratio(things), "clean depth": _ratio(free)}
    for name in names:
        things, free = poses.counts(agent, Corruption(name, severity), restorer)
        found[name] = _ratio(things if modality(name) == "rgb" else free)
    return found


def _ratio(counts: np.ndarray) -> tuple[float, float, float]:
    samples = resampled_means(counts, resamples=2000)
    low, high = np.quantile(samples[:, 0] / samples[:, 1], (0.025, 0.975))
    return float(counts[0].sum() / counts[1].sum()), float(low), float(high)


def table(scores: dict[str, dict[str, tuple[float, float, float]]]) -> str:
    """Markdown: a row a condition, a column an agent, in percent."""
    conditions = tuple(next(iter(scores.values())))
    seen = [n for n in conditions if not n.startswith("clean")]
    rgb, depth = ([n for n in seen if modality(n) == sensor] for sensor in (RGB, DEPTH))
    lines = []
    for name in ("clean", *rgb, "clean depth", *depth):
        cells = [found[name] for found in scores.values()]
        title = {"clean": "Clean RGB", "clean depth": "Clean depth"}.get(name) or label(name)
        lines.append(
            [title, *(f"{100 * v:.1f} [{100 * a:.1f}, {100 * b:.1f}]" for v, a, b in cells)]
        )
    for place, sensor, names in ((1 + len(rgb), "RGB", rgb), (len(lines) + 1, "depth", depth)):
        means = [np.mean([found[n][0] for n in names]) for found in scores.values()]
        lines.insert(place, [f"**Mean of {sensor}**", *(f"{100 * m:.1f}" for m in means)])
    return markdown_table(["", *scores], lines)


def _column(weights: str, taken: Collection[str]) -> str:
    """The name of ``weights``, or their path where another has that name."""
    name = name_of(weights)
    return weights if name in taken else name


@lru_cache(maxsize=1)
def _agent_node() -> Any:
    with initialize_config_dir(str(conf.CONF), version_base="1.3"):
        return compose("evaluate").agent


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(
        description="What agents still see under each corruption, in percent: F1 of the things in "
        "each view (RGB), overlap of the free space (depth), with 95 % intervals over poses."
    )
    parser.add_argument("agents", nargs="+", help="weights: folders or .safetensors files")
    parser.add_argument("--split", default="val_seen", choices=("val_seen", "val_unseen"))
    parser.add_argument(
        "--suite", default="full", choices=list(SUITES), help="the twelve, or a half of the unseen"
    )
    parser.add_argument("--poses", type=int, default=60, help="random ones (default 60)")
    parser.add_argument("--severity", type=float, default=0.6)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--restore", help="a restorer's folder: each agent behind it as well")
    options = parser.parse_args(arguments)
    if options.poses < 1:
        raise ValueError(f"--poses {options.poses}: at least one is needed.")
    agents: dict[str, Any] = {}
    for weights in options.agents:  # all first: a wrong path must not cost the others' minutes
        agents[_column(weights, agents)] = load(_agent_node(), weights)
    poses = Poses(options.split, options.poses, options.seed)
    scores, names = {}, SUITES[options.suite]
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
