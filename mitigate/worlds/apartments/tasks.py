"""Generate episodes in apartments for two tasks: VLN (follow an instruction) and OGN (find an
object of a category).

``tools/apartment_episodes.py`` writes the fixed lists of validation episodes. Training episodes are
generated from (seed, index) when they are needed.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from mitigate.worlds.apartments.apartment import Apartment, apartment_of
from mitigate.worlds.apartments.instructions import describe, find
from mitigate.worlds.apartments.layout import gap_to
from mitigate.worlds.apartments.palette import SEED_RANGES
from mitigate.worlds.episodes import (
    Episode,
    Goal,
    Instruction,
    from_vlnce,
    heading_of,
    read_episodes,
    share_of,
)

# R2R-CE uses 3.0 m for paths of 10 m.
# This value is smaller, because paths in apartments are shorter (docs/base-agent.md).
SUCCESS_METRES = 2.0
# limits of the distance from start to goal on the grid with eight directions, in metres
SHORTEST, LONGEST = 4.0, 12.0
TASKS = ("vln", "ogn")
# This is the version of the episode lists and texts, which is part of every episode id.
# Results of different versions are therefore never mixed.
EDITION = 2
OGN_SHARE = 0.15  # fraction of OGN episodes in training (heuristic)
_TRIES = 60
_POOL = 60  # number of different training paths per apartment
PER_APARTMENT = 10  # number of episodes per apartment in the episode lists


def to_vlnce(xy: np.ndarray | tuple[float, float]) -> tuple[float, float, float]:
    """Convert a plan position to a VLN-CE position (x, y, z) with y up."""
    return round(float(xy[0]), 4), 0.0, round(-float(xy[1]), 4)


def make_episode(apartment: Apartment, task: str, index: int, seed: int = 0) -> Episode:
    """Return episode ``index`` of an apartment. The result depends only on the arguments.

    Raises ``RuntimeError`` if no start position is between ``SHORTEST`` and ``LONGEST`` metres away
    from a goal.
    """
    rng = np.random.default_rng([apartment.seed, TASKS.index(task), index, seed])
    for _ in range(_TRIES):
        goals, target = _draw_vln(apartment, rng) if task == "vln" else _draw_ogn(apartment, rng)
        if not goals:
            continue
        field = apartment.space.distances(goals)
        starts = np.flatnonzero((field > SHORTEST) & (field < LONGEST))
        if len(starts):
            break
    else:
        raise RuntimeError(
            f"Apartment {apartment.seed} offers no {task} episode of {SHORTEST}-{LONGEST} m."
        )
    start = int(rng.choice(starts))
    path = apartment.space.shortest_path(start, field)
    heading = float(np.radians(15.0 * rng.integers(24)))
    category = apartment.furniture[target].category
    if task == "vln":
        text = describe(apartment, path, heading, target, rng)
    else:
        text = find(apartment, category, rng)
    thinned = np.concatenate([path[:-1:5], path[-1:]])
    metres = round(apartment.space.shortest_length(path[0], goals), 4)
    return Episode(
        episode_id=f"{apartment.seed:06d}-{task}{EDITION}-{index}" + (f"-{seed}" if seed else ""),
        trajectory_id=f"{apartment.seed:06d}-{index}",
        scene_id=apartment.scene_id,
        start_position=to_vlnce(path[0]),
        start_rotation=(0.0, float(np.sin(heading / 2)), 0.0, float(np.cos(heading / 2))),
        goals=tuple(Goal(to_vlnce(apartment.space.centre(g)), SUCCESS_METRES) for g in goals),
        instruction=Instruction(text, None, "en-US"),
        reference_path=tuple(to_vlnce(p) for p in thinned),
        geodesic_distance=metres,
        info={"geodesic_distance": metres, "task": task, "category": category, "landmark": target},
    )


def _draw_vln(apartment: Apartment, rng: np.random.Generator) -> tuple[list[int], int]:
    target = int(rng.integers(len(apartment.furniture)))
    kinds = [(p.category, p.colour, apartment.rooms[p.room].kind) for p in apartment.furniture]
    cells = view_cells(apartment, target)
    usable = kinds.count(kinds[target]) == 1 and len(cells)
    return ([int(rng.choice(cells))] if usable else []), target


def _draw_ogn(apartment: Apartment, rng: np.random.Generator) -> tuple[list[int], int]:
    category = str(rng.choice(sorted({p.category for p in apartment.furniture})))
    same = [i for i, p in enumerate(apartment.furniture) if p.category == category]
    cells = [view_cells(apartment, i) for i in same]
    return [int(c[len(c) // 2]) for c in cells if len(c)], same[0]


def view_cells(apartment: Apartment, instance: int) -> np.ndarray:
    """Return the free cells that are in the room of a piece of furniture and within 0.8 m of it."""
    piece = apartment.furniture[instance]
    xy = (apartment.space.cells[:, ::-1] + 0.5) * 0.1
    x0, y0, x1, y1 = apartment.rooms[piece.room].rect
    inside = (xy[:, 0] > x0) & (xy[:, 0] < x1) & (xy[:, 1] > y0) & (xy[:, 1] < y1)
    return np.flatnonzero((gap_to(piece.rect, xy) < 0.8) & inside)


@dataclass(frozen=True)
class DrawnEpisodes:
    """Source of training episodes (``worlds/world.py``).

    Attributes:
        layouts: number of training layouts.
        ogn_share: fraction of object-goal episodes.
    """

    layouts: int = 400
    ogn_share: float = OGN_SHARE

    def draw(self, rng: np.random.Generator, share: tuple[int, int] = (0, 1)) -> Episode:
        """Sample an episode with a newly generated instruction.

        The layouts are split into ``count`` parts, and ``share`` = (index, count) selects the part
        to sample from. Each layout has ``_POOL`` different paths.
        """
        seeds = share_of(range(self.layouts), *share)
        seed = seeds[int(rng.integers(len(seeds)))]
        index = int(rng.integers(_POOL))
        task = "ogn" if rng.random() < self.ogn_share else "vln"
        episode: Episode = pickle.loads(_pooled(seed, task, index))
        if task == "ogn":
            return episode
        path = np.stack([from_vlnce(p) for p in episode.reference_path])
        heading = heading_of(episode.start_rotation)
        apartment = apartment_of(episode.scene_id)
        text = describe(apartment, path, heading, episode.info["landmark"], rng)
        return replace(episode, instruction=Instruction(text, None, "en-US"))


def landmarks(episode: Episode) -> list[int]:
    """Return the indices of the furniture that marks the goal.

    In VLN, this is one piece. In OGN, it is all pieces of the goal category.

    Raises ValueError if the info of the episode does not contain the goal.
    """
    furniture = apartment_of(episode.scene_id).furniture
    info, here = episode.info, range(len(furniture))
    if info.get("task") == "vln" and info.get("landmark") in here:
        return [int(info["landmark"])]
    if info.get("task") != "ogn" or "category" not in info:
        raise ValueError(
            f"The info of episode {episode.episode_id} must contain the goal: a landmark (index of "
            'a piece of furniture) if task is "vln", or a category if task is "ogn".'
        )
    return [i for i, piece in enumerate(furniture) if piece.category == episode.info["category"]]


def view_points(episode: Episode) -> list[int]:
    """Return the free cells next to the goal object, as for the object goals of VLN-CE."""
    return list(_view_points(episode.scene_id, tuple(landmarks(episode))))


@lru_cache(maxsize=64)
def _view_points(scene_id: str, things: tuple[int, ...]) -> np.ndarray:
    apartment = apartment_of(scene_id)
    return np.unique(np.concatenate([view_cells(apartment, thing) for thing in things]))


def fixed_episodes(split: str, task: str, count: int) -> Iterator[Episode]:
    """Yield the first ``count`` episodes of a split, in the order of apartment seeds.

    Each apartment has ``PER_APARTMENT`` episodes.
    """
    low, _ = SEED_RANGES[split]
    for number in range(count):
        yield make_episode(Apartment(low + number // PER_APARTMENT), task, number % PER_APARTMENT)


@lru_cache(maxsize=100_000)
def _pooled(seed: int, task: str, index: int) -> bytes:
    """Return a pickled training episode, because cached objects would need ten times the memory."""
    scene = f"apartments/train/{seed:06d}"
    return pickle.dumps(make_episode(apartment_of(scene), task, index, seed=1))


def episode_file(split: str, task: str = "vln") -> Path:
    """Return the path of the shipped file that lists the episodes of a validation split."""
    return Path(__file__).parent / "episodes" / f"{split}_{task}.json.gz"


def load_episodes(split: str, task: str = "vln") -> list[Episode]:
    """Return the shipped episodes of a validation split, in order."""
    return list(read_episodes(episode_file(split, task)))
