"""Stored features of a lattice of poses: training the planner without rendering.

Poses lie about ``SPACING`` metres apart and look along heading 0. Headings are multiples of 30
degrees, where a panorama is the heading-0 one with its views rolled. Built once, in order,
resumable: each scene is a folder of memory-mapped arrays that is there whole or not at all, and
that worker processes share.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from scipy.spatial import cKDTree
from tensordict import tensorclass
from torch import Tensor

from mitigate.agents.topological.decisions import Piece
from mitigate.agents.topological.rollout import roll_out
from mitigate.agents.topological.waypoints import COUNT, select
from mitigate.core import precision
from mitigate.core.checkpoint import weights_sha
from mitigate.core.observation import DEPTH, RGB, VIEW_STEP_DEGREES, VIEWS
from mitigate.core.progress import Progress
from mitigate.core.signals import unbroken
from mitigate.worlds.episodes import Episode, from_vlnce, heading_of

if TYPE_CHECKING:
    from mitigate.agents.topological.agent import TopologicalAgent

SPACING = 0.5  # metres
_BATCH = 16  # panoramas encoded at once


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


class Store:
    """Features of an agent's encoders in all scenes of a world.

    Args: world: makes a world that can look from anywhere, names the goal's landmarks among what
    its truth calls "seen", and has an expert. root: of the folders, one a kind of encoders.
    """

    def __init__(self, agent: TopologicalAgent, world: Callable[[], Any], root: Path | str) -> None:
        self.agent, self.make_world = agent, world
        self.world = world()
        self.size = self.world.sensors[RGB].shape[1]
        encoders = torch.nn.ModuleList(
            [agent.rgb_encoder, agent.depth_encoder, agent.waypoint_head]
        )
        own = agent.rgb_encoder.size
        resized = "" if own == self.size else f"-to-{own}"
        kind = precision.current(agent.device)
        self.folder = Path(root) / f"{weights_sha(encoders)}-{self.size}{resized}-{kind}"
        self._held: dict[str, Features] = {}

    @torch.no_grad()
    def build(self) -> None:
        """Fill the store; what is there is kept. It holds what the encoders see, also those of a
        blind agent (:meth:`Features.blank`)."""
        self.folder.mkdir(parents=True, exist_ok=True)
        scenes = self.world.scenes
        missing = [scene for scene in scenes if not self.path(scene).exists()]
        if not missing:
            return
        done = len(scenes) - len(missing)
        self.agent.eval()
        with Progress("stored features", len(scenes), unit="scene", start=done) as progress:
            for scene in missing:
                with unbroken():  # as far as it is worth keeping
                    _save(self._poses(scene), self.path(scene))
                progress.advance()

    def path(self, scene: str) -> Path:
        """The folder of a scene."""
        return self.folder / scene.replace("/", "-")

    def features(self, scene: str) -> Features:
        """The features of a scene, as the agent sees them."""
        if scene not in self._held:
            self._held[scene] = Features(ScenePoses.load_memmap(self.path(scene)))
            if self.agent.blind:
                self._held[scene].blank(self.agent, self.size)
        return self._held[scene]

    def collect(
        self,
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
    ) -> Piece:
        """As ``TopologicalAgent.collect``, by stored features."""
        walks = [StoredWalk(e, self.features(e.scene_id), self.make_world()) for e in episodes]
        traces = roll_out(
            self.agent.planner,
            self.agent.tokens([e.instruction.text for e in episodes]),
            walks,
            look,
            follow_oracle=expert_share,
            rngs=rngs,
        )
        return Piece(
            traces,
            {
                "goal": np.stack([s for walk in walks for s in walk.shown]),
                "views": np.stack([view for trace in traces for view in trace.views]),
            },
        )

    def _poses(self, scene: str) -> ScenePoses:
        """What is stored of ``scene``."""
        self.world.enter(scene)
        points = self.world.points()
        xy = points[lattice(points)]
        made = _features(self.agent, [_frames(self.world, p) for p in xy])
        tensors = {name: torch.from_numpy(array) for name, array in made.items()}
        return ScenePoses(**tensors, xy=torch.from_numpy(xy), batch_size=[len(xy)])


class StoredWalk:
    """A rollout by stored features: every move ends on the lattice pose nearest to its target.

    ``shown`` holds, for each look, which views show the goal's landmark: float32 [12].
    """

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


def look(walks: Sequence[StoredWalk]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Stored views and waypoints of where each walk is."""
    return [walk.look() for walk in walks]


def lattice(points: np.ndarray) -> np.ndarray:
    """Indices of the points [n, 2] on a ``SPACING`` lattice: the nearest to each lattice point."""
    key = np.floor(points / SPACING).astype(int)
    middle = np.abs(points / SPACING - key - 0.5).sum(1)
    order = np.lexsort((middle, key[:, 1], key[:, 0]))
    first = np.ones(len(order), bool)
    first[1:] = (np.diff(key[order], axis=0) != 0).any(1)
    return np.sort(order[first])


def _save(poses: ScenePoses, path: Path) -> None:
    """Write ``poses`` aside and rename the folder: it is whole or not there."""
    aside = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
    try:
        poses.memmap(aside, num_threads=0)
        aside.rename(path)
    except BaseException:
        shutil.rmtree(aside, ignore_errors=True)
        if not path.is_dir():  # else another process was quicker
            raise


def _frames(world: Any, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """RGB, depth and, for each view, which things show (bits of a uint64)."""
    frames, truth = world.put(xy, 0.0)
    seen = truth["seen"]
    bits = (seen.astype(np.uint64) << np.arange(seen.shape[1], dtype=np.uint64)).sum(
        1, dtype=np.uint64
    )
    return frames[RGB], frames[DEPTH], bits


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
        "seen": np.stack([frame[2] for frame in frames]).view(np.int64),  # torch maps no uint64
    }


def _turns(heading: float) -> int:
    """Heading in steps of 30 degrees, counter-clockwise."""
    return int(np.round(np.degrees(heading) / VIEW_STEP_DEGREES)) % VIEWS
