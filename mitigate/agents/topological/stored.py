"""Stored features of a lattice of poses: training the planner without rendering.

``scene_poses.py`` makes them: poses lie about ``SPACING`` metres apart and look along heading 0.
Headings are multiples of 30 degrees, where a panorama is the heading-0 one with its views rolled.
Built once, resumable: each scene is a folder of memory-mapped arrays that is there whole or not at
all, and that worker processes share. Beside the clean scene there may be *variants* of it, in each
of which one corruption is kept.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from mitigate.agents.topological.rollout import Piece, roll_out
from mitigate.agents.topological.scene_poses import ScenesTask
from mitigate.agents.topological.stored_walk import Features, ScenePoses, StoredWalk, look
from mitigate.core import precision
from mitigate.core import workers as processes
from mitigate.core.checkpoint import weights_sha
from mitigate.core.files import make_folder
from mitigate.core.observation import RGB
from mitigate.core.progress import Progress
from mitigate.core.signals import unbroken
from mitigate.corruptions import SUITE_VERSION, Schedule
from mitigate.corruptions.registry import BROAD, version
from mitigate.worlds.episodes import Episode

if TYPE_CHECKING:
    from mitigate.agents.topological.agent import TopologicalAgent

# of a schedule, what says who meets a variant and not what it is of
UNUSED: dict[str, Any] = {"success": None, "clean_share": 0.0, "alpha": 1.0, "floor": 1.0}
WORTH = 4  # scenes that make a process worth its start (ours): some 5 s each
ON_GPU = 8  # processes at most that encode on one GPU, each of which takes 0.5 GB of it for itself


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
            settings = repr((*_drawn(schedule), seed)).encode()
            self.corrupted = (
                self.folder / f"corrupted-{blake2b(settings, digest_size=6).hexdigest()}"
            )
        self._held: dict[tuple[str, int], Features] = {}

    def build(self, workers: int | None = None) -> None:
        """Fill the store; what is there is kept. It holds what the encoders see, also those of a
        blind agent (:meth:`Features.blank`). ``workers``: processes, to the same bits for any
        number; None: one a core if there is work for them, 0: this one alone."""
        make_folder(self.corrupted if self.variants else self.folder)
        scenes, every = self.world.scenes, range(self.variants + 1)
        missing = [
            (scene, [v for v in every if not self.path(scene, v).exists()]) for scene in scenes
        ]
        jobs = [(scene, variants) for scene, variants in missing if variants]
        if not jobs:
            return
        kind = precision.current(self.agent.device)
        task = ScenesTask(self.agent, self.make_world, self.schedule, self.seed, kind)
        started = processes.count(1 if workers == 0 else workers, len(jobs), WORTH)
        if self.agent.device.type != "cpu":
            started = min(started, ON_GPU)
        done = len(scenes) - len(jobs)
        with Progress("stored features", len(scenes), unit="scene", start=done) as progress:
            for item in processes.results(task, [[job] for job in jobs], started, progress):
                if item is None:
                    continue
                number, made = item
                with unbroken():  # as far as it is worth keeping
                    for variant, arrays in made:
                        _save(arrays, self.path(jobs[number][0], variant))
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


def _save(arrays: dict[str, np.ndarray], path: Path) -> None:
    """Write the entries of ``ScenePoses`` aside and rename the folder: it is whole or not there."""
    tensors = {name: torch.from_numpy(array) for name, array in arrays.items()}
    poses = ScenePoses(**tensors, batch_size=[len(arrays["xy"])])  # type: ignore[call-arg]
    with tempfile.TemporaryDirectory(prefix=f".{path.name}.", dir=path.parent) as aside:
        draft = Path(aside) / path.name  # which others may read, unlike aside
        draft.mkdir()
        poses.memmap(draft, num_threads=0)  # type: ignore[attr-defined]
        try:
            draft.rename(path)
        except OSError:
            if not path.is_dir():  # else another process was quicker
                raise


def _drawn(schedule: Schedule) -> tuple[Any, ...]:
    """What the pixels of a variant depend on beside the seed: settings, and versions of what is
    drawn."""
    names = (*schedule.names, *(BROAD if schedule.broad_share else ()))
    return replace(schedule, **UNUSED), SUITE_VERSION, [version(name) for name in names]
