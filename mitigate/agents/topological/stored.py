"""Stored features of a lattice of poses: training the planner without rendering.

Poses lie about ``SPACING`` metres apart and look along heading 0. Headings are multiples of 30
degrees, where a panorama is the heading-0 one with its views rolled. Built once, in order,
resumable: each scene is a folder of memory-mapped arrays that is there whole or not at all, and
that worker processes share. Beside the clean scene there may be *variants* of it, in each of which
one corruption is kept.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch import Tensor

from mitigate.agents.topological.rollout import Piece, roll_out
from mitigate.agents.topological.stored_walk import Features, ScenePoses, StoredWalk, look
from mitigate.agents.topological.waypoints import COUNT, select
from mitigate.core import precision
from mitigate.core.checkpoint import weights_sha
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.progress import Progress
from mitigate.core.signals import unbroken
from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import depth_sensor

if TYPE_CHECKING:
    from mitigate.agents.topological.agent import TopologicalAgent

SPACING = 0.5  # metres
_BATCH = 16  # panoramas encoded at once


class Store:
    """Features of an agent's encoders in all scenes of a world.

    Args: world: makes a world that can look from anywhere, names the goal's landmarks among what
    its truth calls "seen", and has an expert. root: of the folders, one a kind of encoders.
    variants: corrupted ones of each scene; ``schedule`` draws the corruption of each by ``seed``,
    and its clean share is that of the walks that see the clean scene. Raises ValueError for
    variants that no schedule corrupts.
    """

    def __init__(
        self,
        agent: TopologicalAgent,
        world: Callable[[], Any],
        root: Path | str,
        schedule: Schedule | None = None,
        variants: int = 0,
        seed: int = 0,
    ) -> None:
        if variants and (schedule is None or schedule.mode == "clean"):
            raise ValueError(f"variants={variants} need a schedule that corrupts (per_episode).")
        self.agent, self.make_world = agent, world
        self.schedule, self.variants, self.seed = schedule, variants, seed
        self.world = world()
        self.size = self.world.sensors[RGB].shape[1]
        encoders = torch.nn.ModuleList(
            [agent.rgb_encoder, agent.depth_encoder, agent.waypoint_head]
        )
        own = agent.rgb_encoder.size
        resized = "" if own == self.size else f"-to-{own}"
        kind = precision.current(agent.device)
        self.folder = Path(root) / f"{weights_sha(encoders)}-{self.size}{resized}-{kind}"
        if schedule is not None and variants:
            settings = repr((replace(schedule, success=None), seed)).encode()
            self.corrupted = (
                self.folder / f"corrupted-{blake2b(settings, digest_size=6).hexdigest()}"
            )
        self._held: dict[tuple[str, int], Features] = {}

    @torch.no_grad()
    def build(self) -> None:
        """Fill the store; what is there is kept. It holds what the encoders see, also those of a
        blind agent (:meth:`Features.blank`)."""
        (self.corrupted if self.variants else self.folder).mkdir(parents=True, exist_ok=True)
        scenes, every = self.world.scenes, range(self.variants + 1)
        missing = [s for s in scenes if not all(self.path(s, v).exists() for v in every)]
        if not missing:
            return
        done = len(scenes) - len(missing)
        self.agent.eval()
        with Progress("stored features", len(scenes), unit="scene", start=done) as progress:
            for scene in missing:
                with unbroken():  # as far as it is worth keeping
                    for variant, poses in self._poses(scene):
                        _save(poses, self.path(scene, variant))
                progress.advance()

    def path(self, scene: str, variant: int = 0) -> Path:
        """The folder of a scene; variant 0 is the clean one."""
        name = scene.replace("/", "-")
        return self.corrupted / f"{name}-{variant}" if variant else self.folder / name

    def features(self, scene: str, variant: int = 0) -> Features:
        """The features of a scene, as the agent sees them."""
        key = (scene, variant)
        if key not in self._held:
            self._held[key] = Features(ScenePoses.load_memmap(self.path(*key)))  # type: ignore[attr-defined]
            if self.agent.blind:
                self._held[key].blank(self.agent, self.size)
        return self._held[key]

    def drawn(self, rng: np.random.Generator) -> int:
        """The variant that a walk sees."""
        if not self.variants or self.schedule is None or rng.random() < self.schedule.clean_share:
            return 0
        return 1 + int(rng.integers(self.variants))

    def collect(
        self,
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
    ) -> Piece:
        """As ``TopologicalAgent.collect``, by stored features."""
        walks = [
            StoredWalk(e, self.features(e.scene_id, self.drawn(rng)), self.make_world())
            for e, rng in zip(episodes, rngs, strict=True)
        ]
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

    def _poses(self, scene: str) -> Iterator[tuple[int, ScenePoses]]:
        """What is stored of ``scene``: each variant that is missing."""
        self.world.enter(scene)
        points = self.world.points()
        xy = points[lattice(points)]
        clean = [_frames(self.world, p) for p in xy]
        known = _features(self.agent, clean)
        for variant in range(self.variants + 1):
            if self.path(scene, variant).exists():
                continue
            frames = clean if not variant else self._corrupted(clean, f"{scene}-{variant}")
            made = {**known, **_features(self.agent, frames, clean)}
            tensors = {name: torch.from_numpy(array) for name, array in _stored(made).items()}
            poses = ScenePoses(**tensors, xy=torch.from_numpy(xy), batch_size=[len(xy)])  # type: ignore[call-arg]
            yield variant, poses

    def _corrupted(self, frames: list[tuple], name: str) -> list[tuple]:
        """Frames of all poses under the corruption of the variant ``name``."""
        assert self.schedule is not None
        schedule, sensor = replace(self.schedule, clean_share=0.0), depth_sensor(self.world.sensors)
        made = []
        for number, (rgb, depth, seen) in enumerate(frames):
            drawn = schedule.draw(self.seed, name, number)
            found = corrupt_observation({RGB: rgb, DEPTH: depth}, *drawn, sensor)
            made.append((found[RGB], found[DEPTH], seen))
        return made


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
    with tempfile.TemporaryDirectory(prefix=f".{path.name}.", dir=path.parent) as aside:
        draft = Path(aside) / path.name  # which others may read, unlike aside
        draft.mkdir()
        poses.memmap(draft, num_threads=0)  # type: ignore[attr-defined]
        try:
            draft.rename(path)
        except OSError:
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


def _features(
    agent: TopologicalAgent, frames: list[tuple], known: list[tuple] | None = None
) -> dict[str, np.ndarray]:
    """Features of frames by what made them; those of frames that ``known`` holds are left out."""
    seen = np.stack([frame[2] for frame in frames]).view(np.int64)  # torch maps no uint64
    found = {"seen": seen}
    rgb, depth = ([frame[i] for frame in frames] for i in (0, 1))
    same_rgb, same_depth = (
        known is not None and all(a[i] is b[i] for a, b in zip(frames, known, strict=True))
        for i in (0, 1)
    )
    if not same_rgb:
        found["rgb"] = np.concatenate([_rgb(agent, part) for part in _parts(agent, rgb)])
    if not same_depth:
        views, logits = zip(*(_depth(agent, part) for part in _parts(agent, depth)), strict=True)
        found["depth"] = np.concatenate(views)
        found["waypoints"] = np.zeros((len(frames), COUNT, 2), np.float32)
        for row, grid in enumerate(np.concatenate(logits)):
            chosen = select(grid)
            found["waypoints"][row, : len(chosen)] = chosen
    return found


def _parts(agent: TopologicalAgent, frames: list[np.ndarray]) -> Iterator[Tensor]:
    for first in range(0, len(frames), _BATCH):
        yield torch.from_numpy(np.stack(frames[first : first + _BATCH])).to(agent.device)


def _rgb(agent: TopologicalAgent, frames: Tensor) -> np.ndarray:
    """float16 [n, 12, rgb + concepts]."""
    features, concepts = agent.encode_rgb(frames)
    return torch.cat([features, concepts.sigmoid()], -1).half().cpu().numpy()


def _depth(agent: TopologicalAgent, frames: Tensor) -> tuple[np.ndarray, np.ndarray]:
    """float16 [n, 12, depth] and waypoint logits."""
    features, logits = agent.encode_depth(frames)
    return features.half().cpu().numpy(), logits.float().cpu().numpy()


def _stored(made: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The entries of ``ScenePoses`` but xy."""
    views = np.concatenate([made["rgb"], made["depth"]], -1)
    return {"views": views, "waypoints": made["waypoints"], "seen": made["seen"]}
