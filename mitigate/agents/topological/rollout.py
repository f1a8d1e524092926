"""Episodes in lock-step for imitation: worlds to act in, the oracle, scheduled sampling.

A *world* is where decisions take effect: ``RenderedWorld`` walks in the simulator with corrupted
frames; ``CachedWorld`` (``cache.py``) hops between poses whose features are stored.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import torch

from mitigate.agents.topological.mapping import Decision, TopologicalMap
from mitigate.agents.topological.planner import Planner, collate
from mitigate.worlds.episodes import Episode

STOP_WITHIN = 1.0  # metres: the oracle stops here ...
STOP_BEST = 1.75  # ... or here, if no ghost is nearer to the goal
_TEMPERATURE = 0.3  # metres; ghosts about as good as the best share the target
_TRAVEL = 0.4  # weight of the metres to a ghost against the metres from it to the goal


class World(Protocol):
    """One episode's world: where the agent is, and what a route does to that."""

    episode: Episode

    def pose(self) -> np.ndarray: ...
    def go(self, route: list[np.ndarray]) -> None: ...
    def distance(self, xy: np.ndarray) -> float: ...


# looks around in some worlds at once: views float32 [12, F] and waypoints [n, 2] of each
Look = Callable[[list], list[tuple[np.ndarray, np.ndarray]]]


@dataclass
class Step:
    """One decision with the oracle's answer: target float32 [1 + g] over [stop] + ghosts, adding
    up to 1, and the geodesic metres from the stop token's place, each node and each ghost."""

    decision: Decision
    target: np.ndarray
    metres: np.ndarray


@dataclass
class Trace:
    """One rolled-out episode. ``views`` are the features each decision saw, in order."""

    episode: Episode
    steps: list[Step] = field(default_factory=list)
    views: list[np.ndarray] = field(default_factory=list)


def oracle(world: World, graph: TopologicalMap, decision: Decision) -> Step:
    """The shortest-path oracle's answer for a decision."""
    nodes = [world.distance(p) for p in graph.positions]
    ghosts = np.array([world.distance(graph.ghosts[g].position) for g in decision.ghosts])
    here = nodes[graph.current]
    target = np.zeros(1 + len(ghosts), np.float32)
    nearer = len(ghosts) > 0 and ghosts.min() < here - 0.25
    if here <= STOP_WITHIN or (here <= STOP_BEST and not nearer) or not len(ghosts):
        target[0] = 1.0
    else:
        cost = ghosts + _TRAVEL * decision.travel
        weight = np.exp(-(cost - cost.min()) / _TEMPERATURE)
        target[1:] = weight / weight.sum()
    return Step(decision, target, np.array([here, *nodes, *ghosts], np.float32))


@torch.no_grad()
def roll_out(
    planner: Planner,
    tokens: torch.Tensor,
    worlds: Sequence[World],
    look: Look,
    *,
    follow_oracle: float,
    rngs: Sequence[np.random.Generator],
    limit: int = 12,
) -> list[Trace]:
    """Run all worlds to the oracle's stop or ``limit`` decisions.

    Each decision follows the oracle with probability ``follow_oracle``, else the planner's own
    distribution over ghosts (sampled). The planner's stop is never taken, so that every trace holds
    the decisions after a wrong one. ``rngs``: one generator a world, so that a world's draws do not
    depend on which others run beside it.
    """
    graphs = [TopologicalMap() for _ in worlds]
    traces = [Trace(world.episode) for world in worlds]
    text = planner.read(tokens)
    tokens_of: list[list[torch.Tensor]] = [[] for _ in worlds]
    running = list(range(len(worlds)))
    for _ in range(limit):
        seen = look([worlds[i] for i in running])
        for i, (views, waypoints) in zip(running, seen, strict=True):
            traces[i].views.append(views)
            graphs[i].add(worlds[i].pose(), waypoints)
            traces[i].steps.append(
                oracle(worlds[i], graphs[i], graphs[i].decision(worlds[i].pose()))
            )
        running = [i for i in running if traces[i].steps[-1].target[0] < 1.0]
        own = [i for i in running if rngs[i].random() >= follow_oracle]
        chosen = {i: _draw(traces[i].steps[-1].target[1:], rngs[i]) for i in running}
        if follow_oracle < 1.0 and running:
            seen_now = torch.from_numpy(np.stack([traces[i].views[-1] for i in running]))
            fresh = planner.look(seen_now.to(tokens.device))
            for row, i in enumerate(running):
                tokens_of[i].append(fresh[row])
        if own:
            chosen.update(
                zip(own, _planned(planner, text, own, traces, tokens_of, rngs), strict=True)
            )
        for i in running:
            ghost = traces[i].steps[-1].decision.ghosts[chosen[i]]
            route = graphs[i].route(ghost)
            graphs[i].arrive(ghost)
            worlds[i].go(route)
        if not running:
            break
    return traces


def _planned(
    planner: Planner,
    text: Any,
    own: list[int],
    traces: list[Trace],
    tokens_of: list[list[torch.Tensor]],
    rngs: Sequence[np.random.Generator],
) -> list[int]:
    offsets = np.cumsum([0, *(len(tokens_of[i]) for i in own)])[:-1]
    views = torch.stack([t for i in own for t in tokens_of[i]])
    decisions = [traces[i].steps[-1].decision for i in own]
    batch = collate(decisions, own, list(offsets)).to(views.device)
    logits = planner(text, views, batch)["logits"]
    first = 1 + batch.nodes.shape[1]
    probabilities = logits[:, first:].softmax(-1).double().cpu().numpy()
    counts = [len(traces[i].steps[-1].decision.ghosts) for i in own]
    return [_draw(p[:n], rngs[i]) for i, p, n in zip(own, probabilities, counts, strict=True)]


def _draw(probabilities: np.ndarray, rng: np.random.Generator) -> int:
    total = np.cumsum(probabilities.astype(np.float64))
    return int(min(np.searchsorted(total, rng.random() * total[-1], side="right"), len(total) - 1))
