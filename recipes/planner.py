"""Planner training on stored features: imitation without rendering, hundreds of decisions a step.

The encoders are frozen; features of a lattice of poses of ``cached`` training apartments are
computed once (``agents/topological/cache.py``). Otherwise as ``recipes/imitation.py``, whose losses
it uses.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from mitigate.agents.topological import TopologicalAgent, cache
from mitigate.agents.topological.rollout import Trace, roll_out
from mitigate.core import precision
from mitigate.core.checkpoint import weights_sha
from mitigate.corruptions import Schedule
from recipes.imitation import ImitationRecipe

_DECAY = 0.6  # share of the steps until the oracle takes follow_oracle of the decisions


class PlannerRecipe(ImitationRecipe):
    """Args: as ``ImitationRecipe``; cached: apartments; folder: of the feature caches; steps: over
    0.6 of them the oracle's share of rollout decisions falls from 1 to ``follow_oracle``."""

    def __init__(
        self,
        agent: TopologicalAgent,
        folder: str,
        steps: int,
        cached: int = 250,
        episodes: int = 40,
        follow_oracle: float = 0.25,
        **others: Any,
    ) -> None:
        super().__init__(
            agent,
            Schedule("clean", 0.0),
            ("planner",),
            episodes,
            follow_oracle,
            apartments=cached,
            **others,
        )
        self.root, self.steps = Path(folder), steps
        self._caches: dict[int, cache.ApartmentCache] = {}

    def start(self) -> None:
        """Make the feature caches, in the precision of the training."""
        agent = self.agent
        encoders = torch.nn.ModuleList(
            [agent.rgb_encoder, agent.depth_encoder, agent.waypoint_head]
        )
        own = agent.rgb_encoder.size
        resized = "" if own == self.size else f"-to-{own}"
        kind = precision.current(agent.device)
        self.folder = self.root / f"{weights_sha(encoders)}-{self.size}{resized}-{kind}"
        agent.eval()
        cache.build(agent, self.folder, range(self.apartments), self.size)

    def work(self, job: tuple) -> tuple[list[Trace], dict[str, np.ndarray], None]:
        step = job[0]
        episodes, rngs = self.draw(job)
        worlds = [cache.CachedWorld(e, self.stored(int(e.scene_id[-6:]))) for e in episodes]
        share = max(0.0, 1 - step / (_DECAY * self.steps))
        traces = roll_out(
            self.agent.planner,
            self.agent.tokens([e.instruction.text for e in episodes]),
            worlds,
            cache.look,
            follow_oracle=self.follow_oracle + share * (1 - self.follow_oracle),
            rngs=rngs,
        )
        return traces, {"shows": np.stack([s for world in worlds for s in world.shown])}, None

    def stored(self, seed: int) -> cache.ApartmentCache:
        """The features of a training apartment, as the agent sees them."""
        if seed not in self._caches:
            self._caches[seed] = cache.load(self.folder, seed)
            if self.agent.blind:
                self._caches[seed].blank(self.agent, self.size)
        return self._caches[seed]

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return {}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        return self.planner_losses(batch, self.plan(self.agent, batch, batch["views"]))
