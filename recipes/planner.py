"""Planner training on stored features: imitation without rendering, hundreds of decisions a step.

The encoders are frozen; features of a lattice of poses of ``cached`` training apartments are
computed once (``mitigate/agents/cache.py``). Otherwise as ``recipes/imitation.py``, whose losses it
uses.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from mitigate.agents import cache
from mitigate.agents.rollout import roll_out
from mitigate.agents.topological import TopologicalAgent
from mitigate.checkpoint import weights_sha
from mitigate.corruptions import Schedule
from mitigate.envs.apartments.tasks import draw_training_episode
from mitigate.seeding import generator
from recipes.imitation import ImitationRecipe, decisions_of

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
        encoders = torch.nn.ModuleList(
            [agent.rgb_encoder, agent.depth_encoder, agent.waypoint_head]
        )
        own = agent.rgb_encoder.size
        resized = "" if own == self.size else f"-to-{own}"
        self.folder = Path(folder) / f"{weights_sha(encoders)}-{self.size}{resized}"
        self.steps = steps
        agent.eval()
        cache.build(agent, self.folder, range(cached), self.size)
        self.caches = [cache.load(self.folder, seed) for seed in range(cached)]
        for stored in self.caches if agent.blind else ():
            stored.blank(agent, self.size)

    def batch(self, step: int) -> dict[str, Any]:
        rng = generator(self.seed, "planner", step)
        episodes = [
            draw_training_episode(rng, self.apartments, self.ogn_share)
            for _ in range(self.episodes)
        ]
        worlds = [cache.CachedWorld(e, self.caches[int(e.scene_id[-6:])]) for e in episodes]
        share = max(0.0, 1 - step / (_DECAY * self.steps))
        self.agent.eval()
        tokens = self.agent.tokens([e.instruction.text for e in episodes])
        with torch.autocast(self.agent.device.type, torch.bfloat16):
            traces = roll_out(
                self.agent.planner,
                tokens,
                worlds,
                cache.look,
                follow_oracle=self.follow_oracle + share * (1 - self.follow_oracle),
                rng=rng,
            )
        self.agent.train()
        views = torch.stack([v for trace in traces for v in trace.views])
        shows = np.stack([s for world in worlds for s in world.shown])
        return {
            **decisions_of(traces),
            "views": views,
            "shows": torch.from_numpy(shows),
            "tokens": tokens,
        }

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return {}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        return self.planner_losses(batch, self.plan(self.agent, batch, batch["views"]))
