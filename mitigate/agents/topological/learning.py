"""How the reference agent is trained: it collects decisions, answers them, and sees frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.agents.agent import Output
from mitigate.agents.concepts import THINGS
from mitigate.agents.losses import agreement, f1, free_loss, presence_loss
from mitigate.agents.topological.rollout import LiveWalk, Piece, roll_out
from mitigate.agents.topological.waypoints import select
from mitigate.core.observation import CLEAN_DEPTH, CLEAN_RGB, DEPTH, RGB
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

if TYPE_CHECKING:
    from mitigate.agents.topological.agent import TopologicalAgent
    from mitigate.agents.topological.decisions import MapDecisions

# of the planner (metres to the goal, which views show what the instruction ends at) and of the
# perception (what views show, where one can go); chosen for the shipped agents
LOSS_WEIGHTS = {"distance": 0.3, "grounding": 0.3, "concepts": 2.0, "waypoints": 2.0}
_PERCEPTION = ("rgb_encoder", "depth_encoder", "waypoint_head")
_SCALE = 5.0  # metres: the planner's distance is in units of it


def collect(
    agent: TopologicalAgent,
    worlds: Sequence[World],
    episodes: Sequence[Episode],
    *,
    expert_share: float,
    rngs: Sequence[np.random.Generator],
    clean: bool = False,
) -> Piece:
    """As ``agents/agent.py`` says. Views of a perception that does not train are kept as features,
    in place of the frames."""
    trains = trains_perception(agent)
    labels = ("concepts", "free", "goal") if trains else ("goal",)
    walks = [LiveWalk(w, e, labels, clean) for w, e in zip(worlds, episodes, strict=True)]

    def look(here: list[LiveWalk]) -> list[tuple[np.ndarray, np.ndarray]]:
        for walk in here:
            walk.look()
        rgb, depth = (np.stack([walk.looks[-1][name] for walk in here]) for name in (RGB, DEPTH))
        views, waypoints = _perceived(agent, rgb, depth)
        return [(v, select(w)) for v, w in zip(views, waypoints, strict=True)]

    traces = roll_out(
        agent.planner,
        agent.tokens([e.instruction.text for e in episodes]),
        walks,
        look,
        follow_oracle=expert_share,
        rngs=rngs,
    )
    looks = [look for walk in walks for look in walk.looks]
    kept = [name for name in looks[0] if trains or name not in (RGB, DEPTH)]
    seen = {name: np.stack([look[name] for look in looks]) for name in kept}
    if not trains:
        seen["views"] = np.stack([view for trace in traces for view in trace.views])
    return Piece(traces, seen)


def precompute(agent: TopologicalAgent, piece: Piece, *, clean: bool) -> Piece:
    """With ``clean``: features in place of the clean frames."""
    if clean and CLEAN_RGB in piece.seen:
        views, _ = _perceived(agent, piece.seen.pop(CLEAN_RGB), piece.seen.pop(CLEAN_DEPTH))
        piece.seen["clean_views"] = views
    return piece


def decide(agent: TopologicalAgent, decisions: MapDecisions, *, clean: bool = False) -> Output:
    """As ``agents/agent.py`` says; features "views" [P, 12, F] and "nodes" [tokens, width]."""
    views, losses, figures = _perception(agent, decisions, clean)
    planner, choices = agent.planner, decisions.choices
    out = planner(planner.read(decisions.tokens), planner.look(views), choices)
    distance = F.smooth_l1_loss(out["distance"], decisions.metres / _SCALE, reduction="none")
    own = {"distance": (distance * choices.valid).sum() / choices.valid.sum()}
    if decisions.goal is not None:
        own["grounding"] = presence_loss(out["grounding"], decisions.goal)
    features = {"views": views, "nodes": out["nodes"][choices.valid]}
    figures |= _stops(out["logits"], decisions.target[:, 0])
    return Output(out["logits"], choices.allowed, features, {**own, **losses}, figures)


def see(
    agent: TopologicalAgent, sensor: str, frames: Tensor, truth: Tensor | None = None
) -> Output:
    """As ``agents/agent.py`` says; of RGB the features hold the probabilities of concepts."""
    views = frames.shape[1]
    if sensor == DEPTH:
        features = agent.depth_encoder(frames.flatten(0, 1)).unflatten(0, (-1, views))
        logits = agent.waypoint_head(features)
    else:
        features, logits = (
            x.unflatten(0, (-1, views)) for x in agent.rgb_encoder(frames.flatten(0, 1))
        )
        features = torch.cat([features, logits.sigmoid()], -1)
    out = Output(features={"views": features})
    if truth is not None and sensor == DEPTH:
        out.losses = {"labels": free_loss(logits, truth)}
        out.figures = {"iou": agreement(logits, truth)}
    elif truth is not None:
        out.losses = {"labels": presence_loss(logits, truth)}
        out.figures = {
            "f1": f1(logits[..., THINGS], truth[..., THINGS]),
            "f1_all": f1(logits, truth),
        }
    return out


def trains_perception(agent: TopologicalAgent) -> bool:
    """Whether any weight that makes view features is trained."""
    parts = agent.parts()
    return any(p.requires_grad for name in _PERCEPTION for p in parts[name].parameters())


def _perceived(
    agent: TopologicalAgent, rgb: np.ndarray, depth: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """View features and waypoint logits of panoramas, without gradients."""
    with torch.no_grad():
        frames = (torch.from_numpy(array).to(agent.device) for array in (rgb, depth))
        views, _, waypoints = agent.perceive(*frames)
    return views.float().cpu().numpy(), waypoints.float().cpu().numpy()


def _perception(
    agent: TopologicalAgent, seen: MapDecisions, clean: bool
) -> tuple[Tensor, dict[str, Tensor], dict[str, Tensor]]:
    """View features [P, 12, F], and the perception's losses and figures where it trains."""
    if clean:
        if seen.clean_views is not None:
            return seen.clean_views, {}, {}
        assert seen.clean_rgb is not None and seen.clean_depth is not None
        return agent.perceive(seen.clean_rgb, seen.clean_depth)[0], {}, {}
    if seen.views is not None:
        return seen.views, {}, {}
    assert seen.rgb is not None and seen.depth is not None
    views, concepts, waypoints = agent.perceive(seen.rgb, seen.depth)
    losses, figures = {}, {}
    if seen.concepts is not None:
        losses["concepts"] = presence_loss(concepts, seen.concepts)
        figures["f1"] = f1(concepts[..., THINGS], seen.concepts[..., THINGS])
    if seen.free is not None:
        losses["waypoints"] = free_loss(waypoints, seen.free)
        figures["iou"] = agreement(waypoints, seen.free)
    return views, losses, figures


def _stops(logits: Tensor, stop: Tensor) -> dict[str, Tensor]:
    """How many of the stops were taken, and how many decisions were wrongly ended by one."""
    chosen = logits.argmax(-1) == 0
    return {
        "stop_recall": (chosen & (stop > 0)).sum() / stop.sum().clamp(min=1),
        "false_stop": (chosen & (stop == 0)).sum() / (stop == 0).sum().clamp(min=1),
    }
