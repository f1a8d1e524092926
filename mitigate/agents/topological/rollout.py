"""Episodes in lock-step for imitation, and the padded batch of all that was decided.

The oracle answers over the map's ghosts; its share of the decisions is scheduled.

A *walk* is where decisions take effect: ``LiveWalk`` in any world, ``StoredWalk`` (``stored.py``)
between poses whose features are stored.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor

from mitigate.agents import observation as checked
from mitigate.agents.agent import check_logits
from mitigate.agents.controller import Controller
from mitigate.agents.topological.mapping import Decision, TopologicalMap
from mitigate.agents.topological.planner import DecisionBatch, Planner, collate
from mitigate.core.observation import CLEAN_DEPTH, CLEAN_RGB, DEPTH, RGB
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of

STOP_WITHIN = 1.0  # metres: the oracle stops here, where the world's rule counts it ...
STOP_BEST = 1.75  # ... or here, if no ghost is nearer to the goal
_TEMPERATURE = 0.3  # metres; ghosts about as good as the best share the target
STOP_WEIGHT = 1.5  # one decision in about six is a stop
FARTHEST = 25.0  # metres; the distance loss asks for no more
_TRAVEL = 0.4  # weight of the metres to a ghost against the metres from it to the goal


class Walk(Protocol):
    """One episode's rollout: where the agent is, what a route does, what the oracle knows, and
    whether the episode is over."""

    episode: Episode

    @property
    def done(self) -> bool: ...
    def pose(self) -> np.ndarray: ...
    def go(self, route: list[np.ndarray]) -> None: ...
    def distance(self, xy: np.ndarray) -> float: ...
    def counts(self, metres: float) -> bool: ...


# looks around in some walks at once: views float32 [12, F] and waypoints [n, 2] of each
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


@dataclass
class Piece:
    """Rollouts of some episodes: their traces, and what was seen at each decision, in order: arrays
    [P, ...] by name."""

    traces: list[Trace]
    seen: dict[str, np.ndarray]


def oracle(walk: Walk, graph: TopologicalMap, decision: Decision) -> Step:
    """The shortest-path oracle's answer for a decision."""
    nodes = [walk.distance(p) for p in graph.positions]
    ghosts = np.array([walk.distance(graph.ghosts[g].position) for g in decision.ghosts])
    here = nodes[graph.current]
    target = np.zeros(1 + len(ghosts), np.float32)
    nearer = len(ghosts) > 0 and ghosts.min() < here - 0.25
    near = here <= STOP_WITHIN or (here <= STOP_BEST and not nearer)
    if (near and walk.counts(here)) or not len(ghosts):
        target[0] = 1.0
    else:
        cost = ghosts + _TRAVEL * decision.travel
        weight = np.exp(-(cost - cost.min()) / _TEMPERATURE)
        target[1:] = weight / weight.sum()
    return Step(decision, target, np.array([here, *nodes, *ghosts], np.float32))


class LiveWalk:
    """A rollout in a world, from the start of ``episode``.

    labels: of the world's truth that are kept with each look, where the world has them. clean: keep
    the frames before their corruption, too. ``looks``: what each decision saw, by name.
    Raises ValueError if the world has no expert.
    """

    def __init__(
        self, world: World, episode: Episode, labels: Sequence[str] = (), clean: bool = False
    ) -> None:
        self.world, self.episode, self.labels, self.clean = world, episode, labels, clean
        self.observation = world.reset(episode)
        self.expert = expert_of(world)
        self.looks: list[dict[str, np.ndarray]] = []

    def look(self) -> None:
        """Read the frames here, with their labels, into ``looks``."""
        kept = dict(zip((RGB, DEPTH), checked.frames(self.observation), strict=True))
        if self.clean:
            before = checked.frames(self.observation.clean)
            kept |= dict(zip((CLEAN_RGB, CLEAN_DEPTH), before, strict=True))
        truth: Mapping[str, np.ndarray] = self.world.truth() if self.labels else {}
        kept |= {name: truth[name] for name in self.labels if name in truth}
        # copies: a world may reuse its arrays
        self.looks.append({name: np.array(value) for name, value in kept.items()})

    def pose(self) -> np.ndarray:
        return checked.pose(self.observation).astype(np.float64)

    @property
    def done(self) -> bool:
        return self.world.done

    def go(self, route: list[np.ndarray]) -> None:
        """Walk the route, as far as the episode lasts."""
        controller = Controller()
        controller.follow(route)
        while not self.done and (action := controller.action(self.pose())) is not None:
            self.observation = self.world.step(action)

    def distance(self, xy: np.ndarray) -> float:
        metres = self.expert.distance(xy)
        if np.isnan(metres):
            raise ValueError(
                "The world's expert knows no distance(xy) to the goal, which teaches an agent that "
                "plans: give it that method (docs/bring-your-own.md)."
            )
        return metres

    def counts(self, metres: float) -> bool:
        return self.expert.counts(metres)


@torch.no_grad()
def roll_out(
    planner: Planner,
    tokens: Tensor,
    walks: Sequence[Walk],
    look: Look,
    *,
    follow_oracle: float,
    rngs: Sequence[np.random.Generator],
    limit: int = 12,
) -> list[Trace]:
    """Run all walks to the oracle's stop, ``limit`` decisions or the end of the episode.

    Each decision follows the oracle with probability ``follow_oracle``, else the planner's own
    distribution over ghosts (sampled). The planner's stop is never taken, so that every trace holds
    the decisions after a wrong one. ``rngs``: one generator a walk, so that its draws do not
    depend on which others run beside it.
    """
    graphs = [TopologicalMap() for _ in walks]
    traces = [Trace(walk.episode) for walk in walks]
    text = planner.read(tokens)
    tokens_of: list[list[Tensor]] = [[] for _ in walks]
    running = list(range(len(walks)))
    for _ in range(limit):
        seen = look([walks[i] for i in running])
        for i, (views, waypoints) in zip(running, seen, strict=True):
            traces[i].views.append(views)
            graphs[i].add(walks[i].pose(), waypoints)
            traces[i].steps.append(oracle(walks[i], graphs[i], graphs[i].decision(walks[i].pose())))
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
            walks[i].go(route)
        running = [i for i in running if not walks[i].done]
        if not running:
            break
    return traces


def _planned(
    planner: Planner,
    text: Any,
    own: list[int],
    traces: list[Trace],
    tokens_of: list[list[Tensor]],
    rngs: Sequence[np.random.Generator],
) -> list[int]:
    offsets = np.cumsum([0, *(len(tokens_of[i]) for i in own)])[:-1]
    views = torch.stack([t for i in own for t in tokens_of[i]])
    decisions = [traces[i].steps[-1].decision for i in own]
    batch = collate(decisions, own, list(offsets)).to(views.device)
    logits = planner(text, views, batch)["logits"]
    first = 1 + batch.nodes.shape[1]
    chances = check_logits(logits[:, first:], planner).softmax(-1)
    probabilities = chances.double().cpu().numpy()
    counts = [len(traces[i].steps[-1].decision.ghosts) for i in own]
    return [_draw(p[:n], rngs[i]) for i, p, n in zip(own, probabilities, counts, strict=True)]


def _draw(probabilities: np.ndarray, rng: np.random.Generator) -> int:
    total = np.cumsum(probabilities.astype(np.float64))
    return int(min(np.searchsorted(total, rng.random() * total[-1], side="right"), len(total) - 1))


@dataclass
class MapDecisions:
    """Padded decisions over [stop], nodes (N) and ghosts (G) of B decisions in E episodes, which
    saw P panoramas (``planner.DecisionBatch`` has the first seven).

    target, metres [B, 1 + N + G]; weight [B]; tokens int64 [E, L]. Seen: ``views`` and
    ``clean_views`` are features [P, 12, F] where they are known, else there are frames; labels are
    there where the world has them.
    """

    episode: Tensor
    panorama: Tensor
    nodes: Tensor
    sightings: Tensor
    geometry: Tensor
    valid: Tensor
    allowed: Tensor
    target: Tensor
    metres: Tensor
    weight: Tensor
    tokens: Tensor
    episode_ids: list[str]
    rgb: Tensor | None = None
    depth: Tensor | None = None
    clean_rgb: Tensor | None = None
    clean_depth: Tensor | None = None
    views: Tensor | None = None
    clean_views: Tensor | None = None
    concepts: Tensor | None = None
    free: Tensor | None = None
    goal: Tensor | None = None

    def to(self, device: Any) -> MapDecisions:
        """Return the decisions on ``device``."""
        tensors = {n: v.to(device) for n, v in vars(self).items() if isinstance(v, Tensor)}
        moved: dict[str, Any] = dict(tensors)
        return replace(self, **moved)

    @property
    def choices(self) -> DecisionBatch:
        """The decisions as the planner takes them."""
        return DecisionBatch(
            self.episode,
            self.panorama,
            self.nodes,
            self.sightings,
            self.geometry,
            self.valid,
            self.allowed,
        )


def join(pieces: Sequence[Piece], tokens: Callable[[list[str]], Tensor]) -> MapDecisions:
    """Pad the decisions of all traces with their targets; ``tokens`` encodes instructions."""
    traces = [trace for piece in pieces for trace in piece.traces]
    steps = [(row, step) for row, trace in enumerate(traces) for step in trace.steps]
    offsets = np.cumsum([0, *(len(trace.steps) for trace in traces)])
    choices = collate(
        [s.decision for _, s in steps],
        [row for row, _ in steps],
        [int(offsets[row]) for row, _ in steps],
    )
    target, metres = _answers(choices, [step for _, step in steps])
    seen = {
        name: torch.from_numpy(np.concatenate([piece.seen[name] for piece in pieces]))
        for name in pieces[0].seen
    }
    return MapDecisions(
        **vars(choices),
        target=target,
        metres=metres,
        weight=1 + (STOP_WEIGHT - 1) * target[:, 0],
        tokens=tokens([trace.episode.instruction.text for trace in traces]),
        episode_ids=[trace.episode.episode_id for trace in traces],
        **seen,
    )


def _answers(choices: DecisionBatch, steps: list[Step]) -> tuple[Tensor, Tensor]:
    """Padded targets and metres, each float32 [B, 1 + N + G]."""
    size, first = choices.valid.shape, 1 + choices.nodes.shape[1]
    target, metres = np.zeros(size, np.float32), np.zeros(size, np.float32)
    for index, step in enumerate(steps):
        ghosts, nodes = len(step.decision.ghosts), len(step.decision.nodes)
        target[index, 0], target[index, first : first + ghosts] = step.target[0], step.target[1:]
        metres[index, : 1 + nodes], metres[index, first : first + ghosts] = (
            step.metres[: 1 + nodes],
            step.metres[1 + nodes :],
        )
    return torch.from_numpy(target), torch.from_numpy(np.minimum(metres, FARTHEST))
