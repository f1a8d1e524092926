"""Imitation of the shortest-path oracle with scheduled sampling, on rendered and corrupted frames.

Every step rolls out a few training episodes with the current weights under the schedule's
corruptions, then trains on all their decisions. Loss = cross-entropy to the oracle over [stop] +
ghosts, plus what keeps the perception honest under corruption: concepts (labels of the id pass) and
waypoints (true free space). The same module trained in three schedules gives ``da_per_frame``,
``da_per_episode`` and ``da_success``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.agents.adapters import adapter_parameters
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological.concepts import THINGS
from mitigate.agents.topological.planner import collate
from mitigate.agents.topological.rendered import RenderedWorld
from mitigate.agents.topological.rollout import Trace, roll_out
from mitigate.agents.topological.waypoints import agreement, select, waypoint_loss
from mitigate.core.files import sha256
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.training.recipe import Recipe
from mitigate.training.success import measure, prior_rates
from mitigate.worlds.apartments.drawing import strip
from mitigate.worlds.apartments.renderer import shared_renderer
from mitigate.worlds.apartments.tasks import draw_training_episode, share_of
from mitigate.worlds.episodes import Episode
from recipes.perception import f1

MODULES = ("rgb_encoder", "depth_encoder", "waypoint_head", "planner")
PARTS = (*MODULES, "adapters")
PIECES = 4  # jobs that the episodes of a step are shared out to (ours)
_STOP_WEIGHT = 1.5  # one decision in about six is a stop


class ImitationRecipe(Recipe):
    """Args:
    agent: trained in place. schedule: which frame is hurt by what.
    train_parts: of ``PARTS``; the others stay frozen, as ETPNav's encoders and waypoints do. A
    module's adapters train with it; "adapters" trains them in frozen modules as well.
    episodes: a step. follow_oracle: share of rollout decisions taken by the oracle.
    apartments: how many training layouts. ogn_share: of object-goal episodes.
    w_concepts, w_waypoints: weights of the perception terms; w_distance, w_grounding: of the
    planner's auxiliary terms (metres to the goal; which views show the goal's landmark).
    prior: rows of one earlier evaluation, from which a success-distributed schedule starts.
    refresh_every: steps between two measurements of the success rates that such a schedule draws
    by, each on ``refresh_episodes`` training episodes under every corruption; 0: never.

    Raises ValueError for an unknown part and for no episodes.
    """

    def __init__(
        self,
        agent: TopologicalAgent,
        schedule: Schedule,
        train_parts: tuple[str, ...] = MODULES,
        episodes: int = 3,
        follow_oracle: float = 0.5,
        apartments: int = 400,
        ogn_share: float = 0.15,
        size: int = 64,
        seed: int = 0,
        w_concepts: float = 2.0,
        w_waypoints: float = 2.0,
        w_distance: float = 0.3,
        w_grounding: float = 0.3,
        prior: str | None = None,
        refresh_every: int = 0,
        refresh_episodes: int = 8,
    ) -> None:
        super().__init__()
        unknown = sorted(set(train_parts) - set(PARTS))
        if unknown:
            raise ValueError(f"train_parts={unknown} is unknown; choose from {', '.join(PARTS)}.")
        if episodes < 1:
            raise ValueError(f"episodes={episodes} a step are none: give 1 or more (rollouts=20).")
        self.agent, self.schedule, self.seed = agent, schedule, seed
        self.episodes, self.follow_oracle = episodes, follow_oracle
        self.apartments, self.ogn_share, self.size = apartments, ogn_share, size
        self.weights = {
            "concepts": w_concepts,
            "waypoints": w_waypoints,
            "distance": w_distance,
            "grounding": w_grounding,
        }
        self.prior = prior
        self.refresh_every, self.refresh_episodes = refresh_every, refresh_episodes
        self.trains_perception = set(train_parts) != {"planner"}
        for part in MODULES:
            getattr(agent, part).requires_grad_(part in train_parts)
        for parameter in adapter_parameters(agent) if "adapters" in train_parts else ():
            parameter.requires_grad_(True)
        if prior is not None:
            schedule.refresh(prior_rates(prior))

    def identity(self) -> dict[str, str]:
        if self.prior is None:
            return {}
        return {"prior_sha256": sha256(self.prior)}

    def jobs(self, step: int) -> list[tuple]:
        """(step, piece, of how many, episodes, the schedule's state) of each piece."""
        if self.refresh_every and step % self.refresh_every == 0 and not (step == 0 and self.prior):
            self.refresh(step)
        parts = np.array_split(np.arange(self.episodes), min(PIECES, self.episodes))
        state = self.schedule.state_dict()
        return [(step, i, len(parts), len(part), state) for i, part in enumerate(parts)]

    def work(self, job: tuple) -> tuple[list[Trace], dict[str, np.ndarray], np.ndarray]:
        """Roll out the episodes of a piece with the current weights: what was decided, what was
        seen at each decision, by entry, and a picture of the first panorama."""
        step, piece, pieces, _, state = job
        if state != self.schedule.state_dict():
            self.schedule.load_state_dict(state)
        episodes, rngs = self.draw(job)
        renderer = shared_renderer(self.size)
        worlds = [
            RenderedWorld(e, f"{step}-{piece}-{i}", self.schedule, self.seed, renderer)
            for i, e in enumerate(episodes)
        ]
        traces = roll_out(
            self.agent.planner,
            self.agent.tokens([e.instruction.text for e in episodes]),
            worlds,
            self.look,
            follow_oracle=self.follow_oracle,
            rngs=rngs,
        )
        looks = [look for world in worlds for look in world.looks]
        seen = {name: np.stack([look[name] for look in looks]) for name in self.entries()}
        return traces, seen, strip(looks[0][RGB])

    def draw(self, job: tuple) -> tuple[list[Episode], list[np.random.Generator]]:
        """The episodes of a piece, and the generator of each one's rollout."""
        step, piece, pieces, count, _ = job
        rngs = [generator(self.seed, "rollout", step, piece, i) for i in range(count)]
        seeds = share_of(self.apartments, piece, pieces)
        return [draw_training_episode(rng, seeds, self.ogn_share) for rng in rngs], rngs

    def collate(self, step: int, pieces: list[tuple]) -> dict[str, Any]:
        """All decisions of the pieces, padded, with what was seen."""
        traces = [trace for found, *_ in pieces for trace in found]
        stacked = {
            name: torch.from_numpy(np.concatenate([seen[name] for _, seen, _ in pieces]))
            for name in pieces[0][1]
        }
        self._picture = pieces[0][2]
        if not self.trains_perception:
            views = np.stack([view for trace in traces for view in trace.views])
            stacked["views"] = torch.from_numpy(views)
        tokens = self.agent.tokens([trace.episode.instruction.text for trace in traces])
        return {**decisions_of(traces), **stacked, "tokens": tokens}

    def entries(self) -> tuple[str, ...]:
        """What ``forward`` reads of the looks (``mitigate/agents/topological/rendered.py``)."""
        return (RGB, DEPTH, "concepts", "free", "shows") if self.trains_perception else ("shows",)

    def look(self, worlds: list[RenderedWorld]) -> list[tuple[np.ndarray, np.ndarray]]:
        """What the agent makes of the (corrupted) panorama of each world."""
        for world in worlds:
            world.observe()
        rgb, depth = (
            torch.from_numpy(np.stack([w.looks[-1][name] for w in worlds])).to(self.agent.device)
            for name in (RGB, DEPTH)
        )
        views, _, waypoints = self.agent.perceive(rgb, depth)
        found = waypoints.float().cpu().numpy()
        features = views.float().cpu().numpy()
        return [(v, select(w)) for v, w in zip(features, found, strict=True)]

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """A panorama as the agent saw it in the last batch."""
        return {"panorama": self._picture}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        views, values = self.perception(batch)
        losses = self.planner_losses(batch, self.plan(self.agent, batch, views))
        for name in ("concepts", "waypoints") if values else ():
            losses["loss"] = losses["loss"] + self.weights[name] * values[name]
        return {**losses, **values}

    def perception(self, batch: dict[str, Any]) -> tuple[Tensor, dict[str, Tensor]]:
        """View features [P, 12, F] and the perception's losses (none while it is frozen)."""
        if not self.trains_perception:
            return batch["views"], {}
        views, concepts, waypoints = self.agent.perceive(batch[RGB], batch[DEPTH])
        return views, {
            "concepts": F.binary_cross_entropy_with_logits(
                concepts.float(), batch["concepts"], pos_weight=torch.tensor(2.0)
            ),
            "waypoints": waypoint_loss(waypoints, batch["free"]),
            "f1": f1(concepts[..., THINGS], batch["concepts"][..., THINGS]),
            "iou": agreement(waypoints, batch["free"]),
        }

    @staticmethod
    def plan(agent: TopologicalAgent, batch: dict[str, Any], views: Tensor) -> dict[str, Tensor]:
        """What ``agent`` makes of the batch's decisions from view features [P, 12, F]."""
        planner = agent.planner
        return planner(planner.read(batch["tokens"]), planner.look(views), batch["decisions"])

    def planner_losses(self, batch: dict[str, Any], out: dict[str, Tensor]) -> dict[str, Tensor]:
        """Imitation and auxiliary terms of the planner's answer ``out``."""
        decisions = batch["decisions"]
        target, stop = batch["target"], batch["target"][:, 0]
        log_p = out["logits"].log_softmax(-1).masked_fill(~decisions.allowed, 0.0)
        entropy = -(target * target.clamp(min=1e-9).log()).sum(-1)
        each = -(target * log_p).sum(-1) - entropy
        weight = 1 + (_STOP_WEIGHT - 1) * stop
        imitation = (each * weight).sum() / weight.sum()
        distance = F.smooth_l1_loss(out["distance"], batch["metres"] / 5, reduction="none")
        distance = (distance * decisions.valid).sum() / decisions.valid.sum()
        grounding = F.binary_cross_entropy_with_logits(
            out["grounding"], batch["shows"], pos_weight=torch.tensor(2.0)
        )
        loss = (
            imitation + self.weights["distance"] * distance + self.weights["grounding"] * grounding
        )
        chosen = out["logits"].argmax(-1)
        right = target.gather(1, chosen[:, None])[:, 0] > 0.4 * target.max(1).values
        return {
            "loss": loss,
            "imitation": imitation,
            "distance": distance,
            "grounding": grounding,
            "accuracy": right.float().mean(),
            "stop_recall": ((chosen == 0) & (stop > 0)).sum() / stop.sum().clamp(min=1),
            "false_stop": ((chosen == 0) & (stop == 0)).sum() / (stop == 0).sum().clamp(min=1),
        }

    def refresh(self, step: int) -> None:
        """Measure the success under every corruption on training episodes, for the schedule."""
        self.schedule.refresh(
            measure(
                self.agent,
                self.schedule,
                shared_renderer(self.size),
                episodes=self.refresh_episodes,
                apartments=self.apartments,
                seed=self.seed,
                step=step,
            )
        )
        self.agent.train()

    def evaluate(self, step: int) -> dict[str, float]:
        """The schedule's weights, for the log."""
        return {f"p/{name}": weight for name, weight in self.schedule.weights.items()}

    def get_extra_state(self) -> dict[str, Any]:
        return {"schedule": self.schedule.state_dict()}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self.schedule.load_state_dict(state["schedule"])


def decisions_of(traces: list[Trace]) -> dict[str, Any]:
    """Padded decisions of all traces with their targets and metres, each [B, 1 + N + G]."""
    steps = [(row, step) for row, trace in enumerate(traces) for step in trace.steps]
    offsets = np.cumsum([0, *(len(trace.steps) for trace in traces)])
    decisions = collate(
        [s.decision for _, s in steps],
        [row for row, _ in steps],
        [int(offsets[row]) for row, _ in steps],
    )
    size, first = decisions.valid.shape, 1 + decisions.nodes.shape[1]
    target, metres = np.zeros(size, np.float32), np.zeros(size, np.float32)
    for index, (_, step) in enumerate(steps):
        ghosts, nodes = len(step.decision.ghosts), len(step.decision.nodes)
        target[index, 0], target[index, first : first + ghosts] = step.target[0], step.target[1:]
        metres[index, : 1 + nodes], metres[index, first : first + ghosts] = (
            step.metres[: 1 + nodes],
            step.metres[1 + nodes :],
        )
    return {
        "decisions": decisions,
        "target": torch.from_numpy(target),
        "metres": torch.from_numpy(np.minimum(metres, 25)),
        "episode_ids": [trace.episode.episode_id for trace in traces],
    }
