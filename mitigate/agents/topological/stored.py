"""Stored features of whole scenes, for training without rendering.

``ScenesTask`` computes the features of an agent's encoders in worker processes, on a lattice of
poses in each scene. ``Store`` keeps the features in memory-mapped folders, which worker processes
share. ``StoredWalk`` runs episodes on stored features. A scene may have corrupted *variants*, each
with one fixed corruption. Only training imports this module, because tensordict is as slow to
import as torch. Agents are instances of :class:`TopologicalAgent`. This module cannot import that
class, because the class's module imports this one.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import torch
from scipy.spatial import cKDTree
from tensordict import tensorclass
from torch import Tensor

from mitigate.agents.topological.perception import MAX_WAYPOINTS, select
from mitigate.agents.topological.rollout import Piece, roll_out
from mitigate.core import precision
from mitigate.core import workers as processes
from mitigate.core.checkpoint import weights_sha
from mitigate.core.files import make_folder
from mitigate.core.locks import delete_abandoned
from mitigate.core.observation import DEPTH, POSE, RGB, VIEW_STEP_DEGREES, VIEWS
from mitigate.core.precision import computing
from mitigate.core.progress import Progress
from mitigate.core.signals import uninterrupted
from mitigate.corruptions import SUITE_VERSION, Schedule, corrupt_observation
from mitigate.corruptions.registry import BROAD, version
from mitigate.worlds.episodes import Episode, from_vlnce, heading_of
from mitigate.worlds.world import depth_sensor, expert_of

SPACING = 0.5  # metres between poses
# The hash of a variant uses these fixed values for Schedule fields that do not affect it.
UNUSED: dict[str, Any] = {"success": None, "clean_share": 0.0, "alpha": 1.0, "floor": 1.0}
WORTH = 4  # minimum number of scenes per process (heuristic); one scene takes about 5 s
ON_GPU = 8  # maximum number of processes that encode on one GPU; each takes 0.5 GB
_BATCH = 16  # number of panoramas that are encoded at once

Job = tuple[str, Sequence[int]]  # the name of a scene, and the numbers of its variants


@tensorclass
class ScenePoses:
    """The stored form of one scene: the entries of :class:`Features` as tensors."""

    xy: Tensor
    views: Tensor
    waypoints: Tensor
    seen: Tensor


# folders store the class name, so this name must match folders of earlier versions
ScenePoses.__module__ = "mitigate.agents.topological.stored_walk"


class Features:
    """The stored features of one scene at n poses.

    Attributes:
        xy: [n, 2].
        views: float16 [n, 12, F].
        waypoints: [n, 6, 2]; unused rows have 0 metres.
        seen: uint64 [n, 12]; bit i is set if object i is visible in the centre of the view.
    """

    def __init__(self, poses: ScenePoses) -> None:
        self.xy, self.views = poses.xy.numpy(), poses.views.numpy()
        self.waypoints, self.seen = poses.waypoints.numpy(), poses.seen.numpy().view(np.uint64)
        self.tree = cKDTree(self.xy)

    @torch.no_grad()
    def blank(self, agent: Any, size: int) -> None:
        """Use the features of blank frames for all inputs in ``agent.blind``."""
        rgb = torch.zeros(1, VIEWS, size, size, 3, dtype=torch.uint8, device=agent.device)
        views, _, logits = agent.perceive(rgb, torch.zeros_like(rgb[..., :1], dtype=torch.float32))
        blanked, depth = views[0].float().cpu().numpy(), agent.planner.widths[-1]
        self.views, self.waypoints = self.views.copy(), self.waypoints.copy()
        if "rgb" in agent.blind:
            self.views[..., :-depth] = blanked[:, :-depth]
        if "depth" in agent.blind:
            self.views[..., -depth:] = blanked[:, -depth:]
            selected = select(logits[0].float().cpu().numpy())
            self.waypoints[:] = 0
            self.waypoints[:, : len(selected)] = selected


class StoredWalk:
    """A rollout on stored features; each move ends at the lattice pose nearest to its target.

    For each observation, ``landmark_views`` (float32 [12]) marks views that show the goal's
    landmark. Low-level steps are not counted, so the episode is never ``done``.
    """

    done = False

    def __init__(self, episode: Episode, features: Features, world: Any) -> None:
        self.episode, self.features = episode, features
        world.reset(episode)
        self.expert = expert_of(world)
        self.index = int(features.tree.query(from_vlnce(episode.start_position))[1])
        self.turn = _turns(heading_of(episode.start_rotation))
        self.landmarks = np.uint64(sum(1 << i for i in world.landmarks(episode)))
        self.landmark_views: list[np.ndarray] = []

    def perceive(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the view features and waypoints at the current pose."""
        features = self.features
        waypoints = features.waypoints[self.index]
        waypoints = waypoints[waypoints[:, 1] > 0].copy()
        turned = np.radians(VIEW_STEP_DEGREES) * self.turn
        waypoints[:, 0] = (waypoints[:, 0] + turned) % (2 * np.pi)
        visible = (features.seen[self.index] & self.landmarks) > 0
        self.landmark_views.append(np.roll(visible.astype(np.float32), self.turn))
        return np.roll(features.views[self.index].astype(np.float32), self.turn, 0), waypoints

    def pose(self) -> np.ndarray:
        turned = np.radians(VIEW_STEP_DEGREES) * self.turn
        return np.array([*self.features.xy[self.index], turned])

    def go(self, route: list[np.ndarray]) -> None:
        before = route[-2] if len(route) > 1 else self.features.xy[self.index]
        self.index = int(self.features.tree.query(route[-1])[1])
        dx, dy = route[-1] - before
        self.turn = _turns(float(np.arctan2(-dx, dy)))


def _turns(heading: float) -> int:
    """Convert a heading to a number of counter-clockwise steps of 30 degrees."""
    return int(np.round(np.degrees(heading) / VIEW_STEP_DEGREES)) % VIEWS


@dataclass
class ScenesTask:
    """Compute the features of scenes in worker processes (``mitigate/core/workers.py``).

    The result of a job is a list of pairs: a variant's number, and the entries of its
    ``ScenePoses``. Variant 0 is clean. ``schedule`` samples the corruptions of all other variants,
    and ``seed`` is their seed. ``kind`` is the floating-point precision of the encoders.
    """

    agent: Any
    make_world: Callable[[], Any]
    schedule: Schedule | None
    seed: int
    kind: str
    world: Any = None
    preload: ClassVar[str] = "mitigate.agents.topological.stored"

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "world": None}

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Use one torch thread, so that features do not depend on the number of processes."""
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        self.agent.eval()
        self.world = self.world or self.make_world()
        try:
            with computing(self.kind, self.agent.device):
                yield
        finally:
            torch.set_num_threads(threads)

    def work(self, jobs: Sequence[Job]) -> Iterator[list[tuple[int, dict[str, np.ndarray]]]]:
        """Yield the result of each job."""
        for scene, variants in jobs:
            yield list(self._poses(scene, variants))

    def name(self, job: Job) -> str:
        return f"scene {job[0]}"

    @torch.no_grad()
    def _poses(
        self, scene: str, variants: Sequence[int]
    ) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        self.world.enter(scene)
        points = self.world.points()
        xy = points[lattice(points)]
        clean = [_frames(self.world, p) for p in xy]
        clean_features = _features(self.agent, clean)
        for variant in variants:
            frames = clean if not variant else self._corrupted(clean, f"{scene}-{variant}")
            features = {**clean_features, **_features(self.agent, frames, clean)}
            views = np.concatenate([features[RGB], features[DEPTH]], -1)
            entries = {"xy": xy, "views": views}
            yield variant, entries | {name: features[name] for name in ("waypoints", "seen")}

    def _corrupted(self, frames: list[tuple], name: str) -> list[tuple]:
        """Return the corrupted frames of all poses for the variant ``name``."""
        assert self.schedule is not None
        schedule = replace(self.schedule, clean_share=0.0)
        sensor = depth_sensor(self.world.sensors)
        corrupted = []
        for number, (rgb, depth, seen) in enumerate(frames):
            # the corruption may depend on the heading, as a lens flare does
            observation = {RGB: rgb, DEPTH: depth, POSE: np.zeros(3, np.float32)}
            corruption, key = schedule.draw(self.seed, name, number)
            result = corrupt_observation(observation, corruption, key, sensor)
            corrupted.append((result[RGB], result[DEPTH], seen))
        return corrupted


def lattice(points: np.ndarray) -> np.ndarray:
    """Return the indices of those ``points`` [n, 2] that are nearest to the points of a lattice."""
    key = np.floor(points / SPACING).astype(int)
    middle = np.abs(points / SPACING - key - 0.5).sum(1)
    order = np.lexsort((middle, key[:, 1], key[:, 0]))
    first = np.ones(len(order), bool)
    first[1:] = (np.diff(key[order], axis=0) != 0).any(1)
    return np.sort(order[first])


def _frames(world: Any, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return RGB, depth, and the objects visible in each view (as bits of a uint64)."""
    frames, truth = world.put(xy, 0.0)
    seen = truth["seen"].astype(np.uint64)
    bits = seen << np.arange(seen.shape[1], dtype=np.uint64)
    return frames[RGB], frames[DEPTH], bits.sum(1, dtype=np.uint64)


def _features(
    agent: Any, frames: list[tuple], known: list[tuple] | None = None
) -> dict[str, np.ndarray]:
    """Return a dict that maps the name of each feature to its values for all ``frames``.

    Sensors are left out if their frames are the same as in ``known``.
    """
    rgb, depth, seen = zip(*frames, strict=True)
    features = {"seen": np.stack(seen).view(np.int64)}  # torch cannot map uint64
    known_rgb, known_depth, _ = zip(*known, strict=True) if known else ((), (), ())
    if [*map(id, rgb)] != [*map(id, known_rgb)]:
        outputs = [agent.encode_rgb(batch) for batch in _batches(agent, rgb)]
        views = [torch.cat([view, concepts.sigmoid()], -1) for view, concepts in outputs]
        features[RGB] = torch.cat(views).half().cpu().numpy()
    if [*map(id, depth)] != [*map(id, known_depth)]:
        outputs = [agent.encode_depth(batch) for batch in _batches(agent, depth)]
        features[DEPTH] = torch.cat([views for views, _ in outputs]).half().cpu().numpy()
        grids = torch.cat([logits for _, logits in outputs]).float().cpu().numpy()
        features["waypoints"] = np.zeros((len(frames), MAX_WAYPOINTS, 2), np.float32)
        for row, grid in enumerate(grids):
            chosen = select(grid)
            features["waypoints"][row, : len(chosen)] = chosen
    return features


def _batches(agent: Any, frames: Sequence[np.ndarray]) -> Iterator[Tensor]:
    """Yield the frames in batches on the agent's device."""
    for first in range(0, len(frames), _BATCH):
        yield torch.from_numpy(np.stack(frames[first : first + _BATCH])).to(agent.device)


class Store:
    """The stored features that an agent's encoders compute in all scenes of a world.

    Args:
        agent: the agent whose encoders are used.
        world: function that returns a world. The world must render from any pose and have an
            expert. Its ground truth must have the entry "seen", which marks the objects that are
            visible in each view.
        root: parent folder of the stores, which has one subfolder per set of encoders.
        schedule: samples the corruption of each variant. Its ``clean_share`` is the fraction of
            rollouts on clean scenes.
        variants: number of corrupted variants per scene.
        seed: corruption seed.

    Raises:
        ValueError: If ``variants`` is above 0, but no schedule samples corruptions.
    """

    def __init__(
        self,
        agent: Any,
        world: Callable[[], Any],
        root: Path | str,
        schedule: Schedule | None = None,
        variants: int = 0,
        seed: int = 0,
    ) -> None:
        if variants and (schedule is None or schedule.mode == "clean"):
            raise ValueError(
                f"variants must be 0 if the schedule has no corruptions, got {variants}. Set a "
                "schedule such as per_episode."
            )
        self.agent = agent
        self.make_world = world
        self.schedule = schedule
        self.variants = variants
        self.seed = seed
        self.world = world()
        self.size = self.world.sensors[RGB].shape[1]
        perception = (agent.rgb_encoder, agent.depth_encoder, agent.waypoint_head)
        encoders = torch.nn.ModuleList(perception)
        encoder_size = agent.rgb_encoder.size
        resized = "" if encoder_size == self.size else f"-to-{encoder_size}"
        kind = precision.current(agent.device)
        self.folder = Path(root) / f"{weights_sha(encoders)}-{self.size}{resized}-{kind}"
        if schedule is not None and variants:
            settings = repr((*_content(schedule), seed)).encode()
            digest = blake2b(settings, digest_size=6).hexdigest()
            self.corrupted = self.folder / f"corrupted-{digest}"
        self._loaded: dict[tuple[str, int], Features] = {}

    def build(self, workers: int | None = None) -> None:
        """Compute the features that are not stored yet.

        The features are stored without blanking inputs; :meth:`Features.blank` does that later. The
        features do not depend on the number of processes.

        Args:
            workers: number of worker processes. None starts one process per core if there is enough
                work, and 0 uses only this process.
        """
        for folder in (self.folder, self.corrupted) if self.variants else (self.folder,):
            delete_abandoned(make_folder(folder).glob(".*.tmp"))
        scenes, every = self.world.scenes, range(self.variants + 1)
        missing = {s: [v for v in every if not self.path(s, v).exists()] for s in scenes}
        jobs = [(scene, variants) for scene, variants in missing.items() if variants]
        if not jobs:
            return
        kind = precision.current(self.agent.device)
        task = ScenesTask(self.agent, self.make_world, self.schedule, self.seed, kind)
        started = processes.count(1 if workers == 0 else workers, len(jobs), WORTH)
        if self.agent.device.type != "cpu":
            started = min(started, ON_GPU)
        stored = len(scenes) - len(jobs)
        with Progress("stored features", len(scenes), unit="scene", start=stored) as progress:
            for item in processes.results(task, [[job] for job in jobs], started, progress):
                if item is None:
                    continue
                number, results = item
                with uninterrupted():  # an interrupt is delayed until the scene is stored
                    for variant, arrays in results:
                        _save(arrays, self.path(jobs[number][0], variant))
                progress.advance()

    def path(self, scene: str, variant: int = 0) -> Path:
        """Return the folder that stores a variant of a scene; variant 0 is clean."""
        name = scene.replace("/", "-")
        return self.corrupted / f"{name}-{variant}" if variant else self.folder / name

    def features(self, scene: str, variant: int = 0) -> Features:
        """Return the features of a scene, with the inputs in ``agent.blind`` blanked."""
        key = (scene, variant)
        if key not in self._loaded:
            self._loaded[key] = Features(ScenePoses.load_memmap(self.path(*key)))  # type: ignore[attr-defined]
            if self.agent.blind:
                self._loaded[key].blank(self.agent, self.size)
        return self._loaded[key]

    def draw_variant(self, rng: np.random.Generator) -> int:
        """Sample the variant of a scene for a rollout."""
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
        """Run episodes like ``TopologicalAgent.collect``, but on stored features."""
        walks = [
            StoredWalk(e, self.features(e.scene_id, self.draw_variant(rng)), self.make_world())
            for e, rng in zip(episodes, rngs, strict=True)
        ]
        traces = roll_out(
            self.agent.planner,
            self.agent.tokens([e.instruction.text for e in episodes]),
            walks,
            lambda running: [walk.perceive() for walk in running],
            expert_share=expert_share,
            rngs=rngs,
        )
        goal = np.stack([view for walk in walks for view in walk.landmark_views])
        views = np.stack([view for trace in traces for view in trace.views])
        return Piece(traces, {"goal": goal, "views": views})


def _save(arrays: dict[str, np.ndarray], path: Path) -> None:
    """Write the entries of ``ScenePoses`` atomically.

    They are written to a temporary folder, which is then renamed.
    """
    tensors = {name: torch.from_numpy(array) for name, array in arrays.items()}
    poses = ScenePoses(**tensors, batch_size=[len(arrays["xy"])])  # type: ignore[call-arg]
    suffix = f".{os.getpid()}.tmp"
    with tempfile.TemporaryDirectory(suffix, f".{path.name}.", path.parent) as aside:
        # a new subfolder is readable for other users, unlike the temporary folder
        draft = Path(aside) / path.name
        draft.mkdir()
        poses.memmap(draft, num_threads=0)  # type: ignore[attr-defined]
        try:
            draft.rename(path)
        except OSError:
            if not path.is_dir():  # a different process may have written this folder
                raise


def _content(schedule: Schedule) -> tuple[Any, ...]:
    """Return the content of a schedule that, together with the seed, determines a variant.

    This is the settings that the schedule uses, and the versions of its corruptions.
    """
    names = (*schedule.names, *(BROAD if schedule.broad_share else ()))
    return replace(schedule, **UNUSED), SUITE_VERSION, [version(name) for name in names]
