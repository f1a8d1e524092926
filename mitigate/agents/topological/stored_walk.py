"""Walks by stored features: what a pose of a scene shows, and going from one to the next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from scipy.spatial import cKDTree
from tensordict import tensorclass
from torch import Tensor

from mitigate.agents.topological.waypoints import select
from mitigate.core.observation import VIEW_STEP_DEGREES, VIEWS
from mitigate.worlds.episodes import Episode, from_vlnce, heading_of
from mitigate.worlds.world import counts

if TYPE_CHECKING:
    from mitigate.agents.topological.agent import TopologicalAgent


@tensorclass
class ScenePoses:
    """The poses of one scene as they are stored: the entries of :class:`Features`, tensors."""

    xy: Tensor
    views: Tensor
    waypoints: Tensor
    seen: Tensor


class Features:
    """Arrays of one scene: xy [n, 2], views float16 [n, 12, F], waypoints [n, 6, 2] (metres 0 =
    none), seen uint64 [n, 12] (bit i: thing i shows in the middle of the view)."""

    def __init__(self, poses: ScenePoses) -> None:
        self.xy, self.views = poses.xy.numpy(), poses.views.numpy()
        self.waypoints, self.seen = poses.waypoints.numpy(), poses.seen.numpy().view(np.uint64)
        self.tree = cKDTree(self.xy)

    @torch.no_grad()
    def blank(self, agent: TopologicalAgent, size: int) -> None:
        """Replace what a blind agent cannot see by what it gets from blanked frames."""
        rgb = torch.zeros(1, VIEWS, size, size, 3, dtype=torch.uint8, device=agent.device)
        views, _, logits = agent.perceive(rgb, torch.zeros_like(rgb[..., :1], dtype=torch.float32))
        blanked, depth = views[0].float().cpu().numpy(), agent.planner.widths[-1]
        self.views, self.waypoints = self.views.copy(), self.waypoints.copy()
        if "rgb" in agent.blind:
            self.views[..., :-depth] = blanked[:, :-depth]
        if "depth" in agent.blind:
            self.views[..., -depth:] = blanked[:, -depth:]
            found = select(logits[0].float().cpu().numpy())
            self.waypoints[:] = 0
            self.waypoints[:, : len(found)] = found


class StoredWalk:
    """A rollout by stored features: every move ends on the lattice pose nearest to its target.

    ``shown`` holds, for each look, which views show the goal's landmark: float32 [12]. Nothing
    counts its steps, so it is never ``done``.
    """

    done = False

    def __init__(self, episode: Episode, features: Features, world: Any) -> None:
        self.episode, self.features = episode, features
        world.reset(episode)
        self.expert = world.expert()
        self.index = int(features.tree.query(from_vlnce(episode.start_position))[1])
        self.turn = _turns(heading_of(episode.start_rotation))
        self.landmarks = np.uint64(sum(1 << i for i in world.landmarks(episode)))
        self.shown: list[np.ndarray] = []

    def look(self) -> tuple[np.ndarray, np.ndarray]:
        """Views and waypoints from here."""
        held = self.features
        waypoints = held.waypoints[self.index]
        waypoints = waypoints[waypoints[:, 1] > 0].copy()
        waypoints[:, 0] = (waypoints[:, 0] + np.radians(VIEW_STEP_DEGREES) * self.turn) % (
            2 * np.pi
        )
        shows = (held.seen[self.index] & self.landmarks) > 0
        self.shown.append(np.roll(shows.astype(np.float32), self.turn))
        return np.roll(held.views[self.index].astype(np.float32), self.turn, 0), waypoints

    def pose(self) -> np.ndarray:
        turned = np.radians(VIEW_STEP_DEGREES) * self.turn
        return np.array([*self.features.xy[self.index], turned])

    def go(self, route: list[np.ndarray]) -> None:
        before = route[-2] if len(route) > 1 else self.features.xy[self.index]
        self.index = int(self.features.tree.query(route[-1])[1])
        dx, dy = route[-1] - before
        self.turn = _turns(float(np.arctan2(-dx, dy)))

    def distance(self, xy: np.ndarray) -> float:
        return self.expert.distance(xy)

    def counts(self, metres: float) -> bool:
        return counts(self.expert, metres)


def look(walks: Sequence[StoredWalk]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Stored views and waypoints of where each walk is."""
    return [walk.look() for walk in walks]


def _turns(heading: float) -> int:
    """Heading in steps of 30 degrees, counter-clockwise."""
    return int(np.round(np.degrees(heading) / VIEW_STEP_DEGREES)) % VIEWS
