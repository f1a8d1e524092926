"""Stored features of lattice poses of training apartments: planner training without rendering.

Poses lie about ``SPACING`` metres apart and look along heading 0. Headings are multiples of 30
degrees, where a panorama is the heading-0 one with its views rolled. Built once, in order,
resumable: each apartment is one file written atomically.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import torch
from scipy.spatial import cKDTree

from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological.waypoints import COUNT, select
from mitigate.core.files import write_atomically
from mitigate.core.observation import VIEW_STEP_DEGREES, VIEWS
from mitigate.core.progress import Progress
from mitigate.worlds.apartments.apartment import Apartment, apartment_of
from mitigate.worlds.apartments.labels import view_labels
from mitigate.worlds.apartments.renderer import Renderer
from mitigate.worlds.apartments.simulator import goal_field
from mitigate.worlds.apartments.tasks import from_vlnce, heading_of, landmarks
from mitigate.worlds.episodes import Episode

SPACING = 0.5  # metres
_BATCH = 16  # panoramas encoded at once


class ApartmentCache:
    """Arrays of one apartment: xy [n, 2], views float16 [n, 12, F], waypoints [n, 6, 2] (metres 0 =
    none), seen uint64 [n, 12] (bit i: furniture i shows in the middle of the view)."""

    def __init__(self, arrays: dict[str, np.ndarray]) -> None:
        self.xy, self.views = arrays["xy"], arrays["views"]
        self.waypoints, self.seen = arrays["waypoints"], arrays["seen"]
        self.tree = cKDTree(self.xy)

    @torch.no_grad()
    def blank(self, agent: TopologicalAgent, size: int) -> None:
        """Replace what a blind agent cannot see by what it gets from blanked frames."""
        rgb = torch.zeros(1, VIEWS, size, size, 3, dtype=torch.uint8, device=agent.device)
        views, _, logits = agent.perceive(rgb, torch.zeros_like(rgb[..., :1], dtype=torch.float32))
        blanked, depth = views[0].float().cpu().numpy(), agent.planner.widths[-1]
        if "rgb" in agent.blind:
            self.views[..., :-depth] = blanked[:, :-depth]
        if "depth" in agent.blind:
            self.views[..., -depth:] = blanked[:, -depth:]
            found = select(logits[0].float().cpu().numpy())
            self.waypoints[:] = 0
            self.waypoints[:, : len(found)] = found


def lattice(cells: np.ndarray, xy: np.ndarray) -> np.ndarray:
    """Indices of free cells on a ``SPACING`` lattice: the cell nearest to each lattice point."""
    key = np.floor(xy / SPACING).astype(int)
    middle = np.abs(xy / SPACING - key - 0.5).sum(1)
    order = np.lexsort((middle, key[:, 1], key[:, 0]))
    first = np.ones(len(order), bool)
    first[1:] = (np.diff(key[order], axis=0) != 0).any(1)
    return np.sort(order[first])


def path_of(folder: Path, seed: int) -> Path:
    return folder / f"{seed:06d}.npz"


@torch.no_grad()
def build(agent: TopologicalAgent, folder: Path, apartments: range, size: int = 64) -> None:
    """Fill the cache of some training apartments; those already there are kept.

    It holds what the encoders see, also those of a blind agent (``ApartmentCache.blank``).
    """
    folder.mkdir(parents=True, exist_ok=True)
    missing = [seed for seed in apartments if not path_of(folder, seed).exists()]
    if not missing:
        return
    done = len(apartments) - len(missing)
    with Progress("feature cache", len(apartments), unit="apartment", start=done) as progress:
        renderer = Renderer(size, scenes=2)
        for seed in missing:
            arrays = _arrays(agent, renderer, apartment_of(f"apartments/train/{seed:06d}"))
            write_atomically(path_of(folder, seed), partial(_save, arrays))
            progress.advance()


def _arrays(
    agent: TopologicalAgent, renderer: Renderer, apartment: Apartment
) -> dict[str, np.ndarray]:
    """Arrays of an :class:`ApartmentCache` of ``apartment``."""
    renderer.load(apartment)
    xy_all = (apartment.space.cells[:, ::-1] + 0.5) * 0.1
    xy = xy_all[lattice(apartment.space.cells, xy_all)]
    return _features(agent, [_frames(renderer, apartment, p) for p in xy]) | {"xy": xy}


def _save(arrays: dict[str, np.ndarray], path: Path) -> None:
    with open(path, "wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]


def _frames(
    renderer: Renderer, apartment: Apartment, xy: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """RGB, depth and, for each view, which furniture shows (bits of a uint64)."""
    rgb, depth, ids = renderer.render(float(xy[0]), float(xy[1]), 0.0)
    _, seen = view_labels(apartment, ids, depth)
    bits = (seen.astype(np.uint64) << np.arange(seen.shape[1], dtype=np.uint64)).sum(
        1, dtype=np.uint64
    )
    return rgb, depth, bits


def _features(agent: TopologicalAgent, frames: list[tuple]) -> dict[str, np.ndarray]:
    views, chosen = [], np.zeros((len(frames), COUNT, 2), np.float32)
    for first in range(0, len(frames), _BATCH):
        part = frames[first : first + _BATCH]
        rgb, depth = (
            torch.from_numpy(np.stack([frame[i] for frame in part])).to(agent.device)
            for i in (0, 1)
        )
        features, _, logits = agent.encode(rgb, depth)
        views.append(features.half().cpu().numpy())
        for row, grid in enumerate(logits.float().cpu().numpy(), first):
            found = select(grid)
            chosen[row, : len(found)] = found
    return {
        "views": np.concatenate(views),
        "waypoints": chosen,
        "seen": np.stack([frame[2] for frame in frames]),
    }


def load(folder: Path, seed: int) -> ApartmentCache:
    with np.load(path_of(folder, seed), allow_pickle=False) as arrays:
        return ApartmentCache({name: arrays[name] for name in arrays.files})


class CachedWorld:
    """A world of stored features: every move ends on the lattice pose nearest to its target.

    ``shown`` holds, for each look, which views show the goal's landmark: float32 [12].
    """

    def __init__(self, episode: Episode, cache: ApartmentCache) -> None:
        self.episode, self.cache = episode, cache
        self.space = apartment_of(episode.scene_id).space
        self.field = goal_field(episode.scene_id, tuple(goal.position for goal in episode.goals))
        self.index = int(cache.tree.query(from_vlnce(episode.start_position))[1])
        self.turn = _turns(heading_of(episode.start_rotation))
        self.landmarks = np.uint64(sum(1 << i for i in landmarks(episode)))
        self.shown: list[np.ndarray] = []

    def look(self) -> tuple[np.ndarray, np.ndarray]:
        waypoints = self.cache.waypoints[self.index]
        waypoints = waypoints[waypoints[:, 1] > 0].copy()
        waypoints[:, 0] = (waypoints[:, 0] + np.radians(VIEW_STEP_DEGREES) * self.turn) % (
            2 * np.pi
        )
        shows = (self.cache.seen[self.index] & self.landmarks) > 0
        self.shown.append(np.roll(shows.astype(np.float32), self.turn))
        views = self.cache.views[self.index].astype(np.float32)
        return np.roll(views, self.turn, 0), waypoints

    def pose(self) -> np.ndarray:
        return np.array([*self.cache.xy[self.index], np.radians(VIEW_STEP_DEGREES) * self.turn])

    def go(self, route: list[np.ndarray]) -> None:
        before = route[-2] if len(route) > 1 else self.cache.xy[self.index]
        self.index = int(self.cache.tree.query(route[-1])[1])
        dx, dy = route[-1] - before
        self.turn = _turns(float(np.arctan2(-dx, dy)))

    def distance(self, xy: np.ndarray) -> float:
        return float(self.field[self.space.cell_of(xy)])


def look(worlds: list[CachedWorld]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Stored views and waypoints of where each world's agent is."""
    return [world.look() for world in worlds]


def _turns(heading: float) -> int:
    """Heading in steps of 30 degrees, counter-clockwise."""
    return int(np.round(np.degrees(heading) / VIEW_STEP_DEGREES)) % VIEWS
