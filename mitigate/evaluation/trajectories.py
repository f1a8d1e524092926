"""Plot trajectories of one episode: clean, corrupted, and corrupted after training."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle, islice
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mitigate.agents.agent import Agent
from mitigate.core.files import write_figure
from mitigate.core.observation import DEPTH, POSE, RGB, VIEWS, Observation
from mitigate.core.pictures import depth_picture, draw_path, strip
from mitigate.corruptions import CLEAN, Corruption, registry
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.rows import Row
from mitigate.guards.guard import NO_GUARDS, Guards
from mitigate.worlds.episodes import Episode, from_vlnce
from mitigate.worlds.world import Corrupted, World, WorldWrapper, as_world

# colours that colour-blind readers can tell apart, mostly from Okabe and Ito
REFERENCE, CLEAN_WALK = "#8a8a8a", "#0072b2"
CORRUPTED_WALKS = ("#d55e00", "#009e73", "#cc79a7", "#8c564b")
INCHES, DPI = (9.0, 10.5), 80
PICTURES = 4  # maximum number of episodes that :func:`write_pictures` plots (heuristic)


@dataclass(frozen=True)
class Walk:
    """The trajectory of one agent in an episode.

    Attributes:
        name: text in the legend.
        path: positions on the floor plan in metres, float64 [n, 2].
        won: whether the episode succeeded.
        metres_left: geodesic distance to the goal at the end, in metres.
        colour: colour of the line.
        agent: name of the agent.
        corruption: the corruption.
        measures: the measures of the episode, as in a result row.
    """

    name: str
    path: np.ndarray
    won: bool
    metres_left: float
    colour: str
    agent: str
    corruption: Corruption
    measures: Mapping[str, Any]


def draw_episode(
    walks: Sequence[Walk], world: World, episode: Episode, corruption: Corruption, seed: int
) -> Figure:
    """Plot the clean and corrupted start panorama, the floor plan, and all trajectories.

    If the world has a method ``draw(axes)``, this method draws the floor plan.
    """
    entry, sight = first_sight(world, episode, corruption, seed)
    figure = Figure(figsize=INCHES, layout="constrained")
    *above, plan = figure.subplots(3, 1, height_ratios=(1, 1, 3.4))
    clean = f"start, straight ahead in the middle: {entry}, clean"
    met = f"{registry.title(corruption.name)}, severity {corruption.severity:g}"
    for axes in above:
        axes.axis("off")
    for axes, picture, title in zip(above, sight, (clean, met), strict=False):
        axes.imshow(picture)
        axes.set_title(title, fontsize=9)
    if draw := as_world(world).draw:
        draw(plan)
    else:
        plan.set_aspect("equal")
        plan.axis("off")
    _draw_walks(plan, world.reset(episode)[POSE], episode, walks)
    figure.suptitle("\n".join(textwrap.wrap(episode.instruction.text, 100)), fontsize=11)
    return figure


def first_sight(
    world: World, episode: Episode, corruption: Corruption, seed: int
) -> tuple[str, list[np.ndarray]]:
    """Return the name of a sensor and its clean and corrupted frames at the start of an episode.

    The sensor is "depth" if ``corruption`` changes only depth or the world has no RGB, else "rgb".
    The frames are pictures, uint8 [H, W, 3]. For a world without frames, the name is "" and there
    are no pictures.
    """
    observation = Corrupted(world, corruption, seed).reset(episode)
    met = dict(observation)
    clean = dict(observation.clean)
    first = DEPTH if {DEPTH, RGB}.intersection(corruption.modalities) == {DEPTH} else RGB
    entry = next((name for name in (first, RGB, DEPTH) if name in clean), "")
    far = float(clean[DEPTH].max()) if DEPTH in clean else 0.0
    return entry, [view_picture(np.asarray(obs[entry]), far) for obs in (clean, met) if entry]


def view_picture(frames: np.ndarray, far: float) -> np.ndarray:
    """Return a picture of one view or of several views side by side, uint8 [H, W, 3].

    Depth is coloured up to ``far`` metres. Of a panorama, the middle parts of its views are joined.
    """
    views = frames if frames.ndim == 4 else frames[None]
    joined = strip(views) if len(views) == VIEWS else np.concatenate(list(views), axis=1)
    return depth_picture(joined[..., 0], far) if joined.shape[-1] == 1 else joined


def won_back(rows: Sequence[Row], before: str, after: str) -> Iterator[tuple[str, Corruption]]:
    """Yield pairs (episode id, corruption) for which ``before`` fails and ``after`` succeeds.

    The pairs are in the order of the rows. No two pairs share an episode or a corruption.
    """
    won = {(r["name"], r["episode_id"], r["corruption"], r["severity"]): r["success"] for r in rows}
    done: set[str] = set()
    for (name, episode, corruption, severity), success in won.items():
        if name != before or corruption == "clean" or {episode, corruption} & done:
            continue
        if not success and won.get((after, episode, corruption, severity)):
            done |= {episode, corruption}
            yield episode, Corruption(corruption, severity)


def write_pictures(
    agents: Mapping[str, Agent],
    world: World,
    episodes: Sequence[Episode],
    rows: Sequence[Row],
    folder: Path | str,
    *,
    seed: int = 0,
    guards: Mapping[str, Guards] | None = None,
) -> list[Path]:
    """Plot up to ``PICTURES`` episodes that the last agent solves and the first agent fails.

    If there is no such episode (:func:`won_back`), or only one agent, the episode of the first
    corrupted row is plotted. If the world has no poses, nothing is plotted.

    Args:
        agents: the agents before and after training, by their names in ``rows``.
        world: the world.
        episodes: the episodes of the rows.
        rows: result rows.
        folder: output folder.
        seed: corruption seed.
        guards: guards by the name of their agent.

    Returns:
        The paths of the pictures.
    """
    if POSE not in world.sensors:
        return []
    known = {episode.episode_id: episode for episode in episodes}
    place = {episode_id: index for index, episode_id in enumerate(known)}
    rows = sorted(rows, key=lambda row: place[row["episode_id"]])
    before, after = list(agents)[0], list(agents)[-1]
    met = ((r["episode_id"], r["corruption"], r["severity"]) for r in rows)
    first = ((one, Corruption(name, at)) for one, name, at in met if name != "clean")
    chosen = [*islice(won_back(rows, before, after), PICTURES)] or [*islice(first, 1)]
    paths = []
    for episode_id, corruption in chosen:
        # an episode id may contain characters that are invalid in a file name
        safe = re.sub(r"[^\w.-]+", "_", episode_id)[:60]
        out = Path(folder) / f"{safe}-{corruption.name}.png"
        episode = known[episode_id]
        walks = list(run_agents(agents, world, episode, corruption, seed, guards))
        figure = draw_episode(walks, world, episode, corruption, seed)
        paths.append(write_figure(out, figure, dpi=DPI, facecolor="white"))
    return paths


def run_agents(
    agents: Mapping[str, Agent],
    world: World,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    guards: Mapping[str, Guards] | None = None,
) -> Iterator[Walk]:
    """Run ``episode`` with each agent, and yield the trajectories.

    The first trajectory shows the first agent without corruption. The other trajectories show
    all agents under ``corruption``. Random keys and measures are the same as in an
    evaluation with ``seed``. ``guards`` maps the names of agents to their guards.
    """
    first = next(iter(agents))
    plans = [(f"{first}, clean", first, CLEAN, CLEAN_WALK)]
    plans += [
        (f"{name}, {registry.title(corruption.name)}", name, corruption, colour)
        for name, colour in zip(agents, cycle(CORRUPTED_WALKS), strict=False)
    ]
    for title, name, met, colour in plans:
        traced = Traced(world)
        guard = (guards or {}).get(name, NO_GUARDS)
        measures = run_episode(agents[name], traced, episode, met, seed, guard)
        left = measures.get("distance_to_goal", np.nan)
        path, success = np.array(traced.path), bool(measures["success"])
        yield Walk(title, path, success, left, colour, name, met, measures)


class Traced(WorldWrapper):
    """A world that records the agent's trajectory.

    ``path`` lists the positions on the floor plan in metres.
    """

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.path: list[np.ndarray] = []

    def reset(self, episode: Episode) -> Observation:
        self.path = []
        return super().reset(episode)

    def _observe(self, met: Observation) -> Observation:
        here = np.array(met[POSE][:2], np.float64)
        if not self.path or not np.array_equal(here, self.path[-1]):
            self.path.append(here)
        return met


def _draw_walks(axes: Axes, start: np.ndarray, episode: Episode, walks: Sequence[Walk]) -> None:
    if episode.reference_path:
        reference = np.stack([from_vlnce(point) for point in episode.reference_path])
        draw_path(axes, reference, REFERENCE, "reference path", "--")
    for walk in walks:
        end = "success" if walk.won else "fail"
        legend = f"{walk.name}: {end}, {walk.metres_left:.1f} m from the goal"
        draw_path(axes, walk.path, walk.colour, legend)
    if episode.goals:
        goals = np.stack([from_vlnce(goal.position) for goal in episode.goals])
        axes.plot(*goals.T, "*", color="#ffbf00", mec="black", ms=15, zorder=9, label="goal")
    ahead = 0.6 * np.array([-np.sin(start[2]), np.cos(start[2])])
    axes.arrow(*start[:2], *ahead, width=0.05, color="black", zorder=8)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, fontsize=9, frameon=False)
