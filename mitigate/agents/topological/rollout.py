"""Run several episodes in parallel for imitation learning, and batch their decisions.

The oracle chooses among the ghost nodes of the map; a schedule sets the fraction of decisions that
follow the oracle. A *walk* executes the decisions of one episode. The class ``LiveWalk`` executes
decisions in any world, and ``StoredWalk`` (``stored.py``) moves between poses with stored features.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor

from mitigate.agents import observation as checked
from mitigate.agents.agent import check_logits, sample
from mitigate.agents.controller import Controller
from mitigate.agents.topological.mapping import Decision, TopologicalMap
from mitigate.agents.topological.planner import DecisionBatch, Planner, collate
from mitigate.core.observation import CLEAN_DEPTH, CLEAN_RGB, DEPTH, RGB
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of

# the oracle stops at most this many metres from the goal, if the world counts that as success
STOP_WITHIN = 1.0
STOP_BEST = 1.75  # this limit applies if no ghost node is closer to the goal
# temperature in metres; ghost nodes with similar costs get similar target probabilities
_TEMPERATURE = 0.3
STOP_WEIGHT = 1.5  # weight of stop decisions, which are about one decision in six
FARTHEST = 25.0  # targets of the distance loss are clipped at this many metres
_TRAVEL = 0.4  # weight of the path to a ghost relative to the path from the ghost to the goal


class Walk(Protocol):
    """One rollout: its pose, its expert, whether it has ended, and how it moves along a route."""

    episode: Episode

    @property
    def expert(self) -> Any: ...

    @property
    def done(self) -> bool: ...
    def pose(self) -> np.ndarray: ...
    def go(self, route: list[np.ndarray]) -> None: ...


# function that returns, for each of several walks, view features [12, F] and waypoints [n, 2]
Perceive = Callable[[list], list[tuple[np.ndarray, np.ndarray]]]


@dataclass
class Step:
    """One decision with the oracle's answer."""

    decision: Decision
    target: np.ndarray  # float32 [1 + g], the probabilities of [stop] and of the ghosts
    # geodesic distance in metres to the goal from the current position, each node and each ghost
    metres: np.ndarray


@dataclass
class Trace:
    """One episode of a rollout; ``views`` are the features at each decision, in order."""

    episode: Episode
    steps: list[Step] = field(default_factory=list)
    views: list[np.ndarray] = field(default_factory=list)


@dataclass
class Piece:
    """The traces of several episodes, and the observations [P, ...] of all their decisions."""

    traces: list[Trace]
    seen: dict[str, np.ndarray]


def oracle(walk: Walk, graph: TopologicalMap, decision: Decision) -> Step:
    """Return the decision with the oracle's answer, which is based on shortest paths.

    Raises:
        ValueError: If the world's expert does not provide distances.
    """
    nodes = [walk.expert.distance(p) for p in graph.positions]
    ghosts = np.array([walk.expert.distance(graph.ghosts[g].position) for g in decision.ghosts])
    if np.isnan([*nodes, *ghosts]).any():
        raise ValueError(
            "distance(xy) of the world's expert must be a number of metres to the goal, got NaN. "
            "Training a planning agent needs that method (docs/bring-your-own.md)."
        )
    here = nodes[graph.current]
    target = np.zeros(1 + len(ghosts), np.float32)
    nearer = len(ghosts) > 0 and ghosts.min() < here - 0.25
    near = here <= STOP_WITHIN or (here <= STOP_BEST and not nearer)
    if (near and walk.expert.counts(here)) or not len(ghosts):
        target[0] = 1.0
    else:
        cost = ghosts + _TRAVEL * decision.travel
        weight = np.exp(-(cost - cost.min()) / _TEMPERATURE)
        target[1:] = weight / weight.sum()
    return Step(decision, target, np.array([here, *nodes, *ghosts], np.float32))


class LiveWalk:
    """A rollout in a world, from the start of ``episode``.

    ``records`` holds the frames and labels of each decision, by name.

    Args:
        world: any world.
        episode: the episode to run.
        labels: ground-truth entries to store with each observation; missing entries are skipped.
        clean: also keep the frames before corruption.

    Raises:
        ValueError: If the world has no expert.
    """

    def __init__(
        self, world: World, episode: Episode, labels: Sequence[str] = (), clean: bool = False
    ) -> None:
        self.world = world
        self.episode = episode
        self.labels = labels
        self.clean = clean
        self.observation = world.reset(episode)
        self.expert = expert_of(world)
        self.records: list[dict[str, np.ndarray]] = []

    def record(self) -> None:
        """Add the current frames and labels to ``records``."""
        entries = dict(zip((RGB, DEPTH), checked.frames(self.observation), strict=True))
        if self.clean:
            clean = checked.frames(self.observation.clean)
            entries |= dict(zip((CLEAN_RGB, CLEAN_DEPTH), clean, strict=True))
        truth: Mapping[str, np.ndarray] = self.world.truth() if self.labels else {}
        entries |= {name: truth[name] for name in self.labels if name in truth}
        # these are copies, because a world may reuse its arrays
        self.records.append({name: np.array(value) for name, value in entries.items()})

    def pose(self) -> np.ndarray:
        return checked.pose(self.observation).astype(np.float64)

    @property
    def done(self) -> bool:
        return self.world.done

    def go(self, route: list[np.ndarray]) -> None:
        """Follow the route until its end or the end of the episode."""
        controller = Controller()
        controller.follow(route)
        while not self.done and (action := controller.action(self.pose())) is not None:
            self.observation = self.world.step(action)


@torch.no_grad()
def roll_out(
    planner: Planner,
    tokens: Tensor,
    walks: Sequence[Walk],
    perceive: Perceive,
    *,
    expert_share: float,
    rngs: Sequence[np.random.Generator],
    limit: int = 12,
) -> list[Trace]:
    """Run all episodes; each runs until the oracle stops, the limit is reached or the episode ends.

    Each decision follows the oracle with probability ``expert_share``; otherwise it is sampled
    from the planner's distribution over ghosts. The planner cannot choose to stop, so that a
    trace continues until the oracle stops.

    Args:
        planner: the planner.
        tokens: int64 [E, L], the instructions.
        walks: one :class:`Walk` per episode.
        perceive: function that encodes the current panorama of each walk.
        expert_share: probability of following the oracle.
        rngs: one random generator per walk, so that its samples do not depend on the other walks.
        limit: maximum number of decisions.
    """
    graphs = [TopologicalMap() for _ in walks]
    traces = [Trace(walk.episode) for walk in walks]
    text = planner.read(tokens)
    view_tokens: list[list[Tensor]] = [[] for _ in walks]  # of all decisions, by walk
    running = list(range(len(walks)))
    for _ in range(limit):
        perceived = perceive([walks[i] for i in running])
        for i, (views, waypoints) in zip(running, perceived, strict=True):
            traces[i].views.append(views)
            graphs[i].add(walks[i].pose(), waypoints)
            traces[i].steps.append(oracle(walks[i], graphs[i], graphs[i].decision(walks[i].pose())))
        running = [i for i in running if traces[i].steps[-1].target[0] < 1.0]
        by_planner = [i for i in running if rngs[i].random() >= expert_share]
        chosen = {i: sample(traces[i].steps[-1].target[1:], rngs[i]) for i in running}
        if expert_share < 1.0 and running:
            current = torch.from_numpy(np.stack([traces[i].views[-1] for i in running]))
            embedded = planner.embed_views(current.to(tokens.device))
            for row, i in enumerate(running):
                view_tokens[i].append(embedded[row])
        if by_planner:
            sampled = _sample_ghosts(planner, text, by_planner, traces, view_tokens, rngs)
            chosen.update(zip(by_planner, sampled, strict=True))
        for i in running:
            ghost = traces[i].steps[-1].decision.ghosts[chosen[i]]
            route = graphs[i].route(ghost)
            graphs[i].arrive(ghost)
            walks[i].go(route)
        running = [i for i in running if not walks[i].done]
        if not running:
            break
    return traces


def _sample_ghosts(
    planner: Planner,
    text: Any,
    rows: list[int],
    traces: list[Trace],
    view_tokens: list[list[Tensor]],
    rngs: Sequence[np.random.Generator],
) -> list[int]:
    """Sample a ghost node from the planner's distribution for each episode in ``rows``."""
    offsets = np.cumsum([0, *(len(view_tokens[i]) for i in rows)])[:-1]
    views = torch.stack([token for i in rows for token in view_tokens[i]])
    decisions = [traces[i].steps[-1].decision for i in rows]
    batch = collate(decisions, rows, list(offsets)).to(views.device)
    logits = planner(text, views, batch)["logits"]
    first = 1 + batch.nodes.shape[1]
    chances = check_logits(logits[:, first:], planner).softmax(-1)
    probabilities = chances.double().cpu().numpy()
    counts = [len(traces[i].steps[-1].decision.ghosts) for i in rows]
    return [sample(p[:n], rngs[i]) for i, p, n in zip(rows, probabilities, counts, strict=True)]


@dataclass
class MapDecisions(DecisionBatch):
    """B padded decisions of E episodes with P panoramas, and the oracle's answers.

    ``target`` and ``metres`` have the shape [B, 1 + N + G], ``weight`` has [B], and ``tokens`` is
    int64 [E, L]. Observations are either features (``views``, ``clean_views`` [P, 12, F]) or
    frames. Labels are None if the world lacks them.
    """

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


def join(pieces: Sequence[Piece], tokens: Callable[[list[str]], Tensor]) -> MapDecisions:
    """Join all decisions and targets into one padded batch; ``tokens`` encodes instructions."""
    traces = [trace for piece in pieces for trace in piece.traces]
    steps = [(row, step) for row, trace in enumerate(traces) for step in trace.steps]
    offsets = np.cumsum([0, *(len(trace.steps) for trace in traces)])
    choices = collate(
        [s.decision for _, s in steps],
        [row for row, _ in steps],
        [int(offsets[row]) for row, _ in steps],
    )
    target, metres = torch.zeros(choices.valid.shape), torch.zeros(choices.valid.shape)
    target[choices.allowed] = torch.from_numpy(np.concatenate([s.target for _, s in steps]))
    known = np.concatenate([s.metres for _, s in steps])
    metres[choices.valid] = torch.from_numpy(np.minimum(known, FARTHEST))
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
