"""The topological map of one episode: visited nodes, ghost nodes (seen but not visited), routes.

The rules are simplified from ETPNav: a waypoint within ``MERGE`` metres of a ghost or node is
merged into it. A ghost stores the views that face it. When the agent arrives at a ghost, the
ghost is replaced by a node.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mitigate.core.observation import VIEW_STEP_DEGREES, VIEWS

MERGE = 0.6  # distance in metres; ETPNav uses 0.5
SIGHTINGS = 4  # number of views that are stored per ghost
GEOMETRY = 12  # number of features of a token's position relative to the agent
_STOP, _NODE, _GHOST = 0, 1, 2


@dataclass
class Ghost:
    """A place that was seen from the nodes ``parents`` but not visited."""

    position: np.ndarray
    parents: list[int]
    sightings: list[tuple[int, int]]  # (panorama, view)
    count: int = 1


@dataclass(frozen=True)
class Decision:
    """The input of the planner for one decision; the order of tokens is [stop], nodes, ghosts."""

    panorama: int  # index of the current panorama
    nodes: np.ndarray  # int [n], the panorama of each node
    sightings: np.ndarray  # int [g, SIGHTINGS, 2], (panorama, view) of each ghost, -1 where unused
    geometry: np.ndarray  # float32 [1 + n + g, GEOMETRY]
    ghosts: list[int]  # ids of the ghosts, in order
    travel: np.ndarray  # metres along the map to each ghost


@dataclass
class TopologicalMap:
    """A map with visited nodes, edges in metres, ghosts by id, and the panorama of each node."""

    positions: list[np.ndarray] = field(default_factory=list)
    edges: list[dict[int, float]] = field(default_factory=list)
    ghosts: dict[int, Ghost] = field(default_factory=dict)
    start: np.ndarray | None = None
    panoramas: int = 0
    node_panorama: list[int] = field(default_factory=list)
    current: int = -1
    _next_ghost: int = 0  # id of the next ghost

    def add(self, pose: np.ndarray, waypoints: np.ndarray) -> None:
        """Add a panorama at ``pose`` [3] with ``waypoints`` [n, 2] (clockwise yaw, metres)."""
        self.start = pose.copy() if self.start is None else self.start
        node = self._visit(pose[:2].astype(np.float64))
        for yaw, metres in waypoints:
            angle = pose[2] - yaw
            where = pose[:2] + metres * np.array([-np.sin(angle), np.cos(angle)])
            view = int(np.round(np.degrees(yaw) / VIEW_STEP_DEGREES)) % VIEWS
            self._sight(node, where, (self.panoramas, view))
        self.panoramas += 1

    def route(self, ghost: int) -> list[np.ndarray]:
        """Return the positions on the way to a ghost; the last position is the ghost."""
        distance, before = self._dijkstra()
        parent = min(self.ghosts[ghost].parents, key=lambda p: distance[p] + self._gap(p, ghost))
        return [*self._nodes_to(parent, before), self.ghosts[ghost].position]

    def route_to_node(self, node: int) -> list[np.ndarray]:
        """Return the positions on the way to a visited node."""
        return self._nodes_to(node, self._dijkstra()[1])

    def arrive(self, ghost: int) -> None:
        """Remove a ghost that the agent has reached; the ghost is replaced by a node."""
        self.ghosts.pop(ghost, None)

    def decision(self, pose: np.ndarray) -> Decision:
        """Return the planner's input at a pose; call it after ``add``."""
        distance, _ = self._dijkstra()
        ids = list(self.ghosts)
        travel = np.array(
            [min(distance[p] + self._gap(p, g) for p in self.ghosts[g].parents) for g in ids],
            np.float32,
        )
        ghosts = [self.ghosts[g].position for g in ids]
        places = [self.positions[self.current], *self.positions, *ghosts]
        kinds = [_STOP, *[_NODE] * len(self.positions), *[_GHOST] * len(ids)]
        routes = np.concatenate([[0.0], distance, travel])
        sightings = np.full((len(ids), SIGHTINGS, 2), -1, np.int64)
        for row, g in enumerate(ids):
            seen = self.ghosts[g].sightings[-SIGHTINGS:]
            sightings[row, : len(seen)] = seen
        geometry = self._geometry(pose, np.array(places), np.array(kinds), routes)
        return Decision(
            self.panoramas - 1, np.array(self.node_panorama), sightings, geometry, ids, travel
        )

    def _geometry(
        self, pose: np.ndarray, places: np.ndarray, kinds: np.ndarray, routes: np.ndarray
    ) -> np.ndarray:
        assert self.start is not None
        out = np.zeros((len(places), GEOMETRY), np.float32)
        for column, origin in ((0, pose), (4, self.start)):
            offset = places - origin[:2]
            length = np.hypot(offset[:, 0], offset[:, 1])
            angle = np.arctan2(-offset[:, 0], offset[:, 1]) - origin[2]
            near = np.minimum(length / 0.3, 1.0)
            out[:, column : column + 4] = np.stack(
                [np.sin(angle) * near, np.cos(angle) * near, length / 3, length < 0.3], 1
            )
        out[:, 8] = routes / 5
        out[np.arange(len(places)), 9 + kinds] = 1.0
        return out

    def _visit(self, position: np.ndarray) -> int:
        """Return the node at ``position``, which is added if no node is near.

        The node is joined to the previous node, and replaces all ghosts near it.
        """
        gaps = [float(np.hypot(*(p - position))) for p in self.positions]
        if gaps and min(gaps) < MERGE / 2:
            node = int(np.argmin(gaps))
            self.node_panorama[node] = self.panoramas
        else:
            node = len(self.positions)
            self.positions.append(position)
            self.edges.append({})
            self.node_panorama.append(self.panoramas)
        if self.current >= 0 and node != self.current:
            self._join(self.current, node)
        self.current = node
        for ghost_id, ghost in [*self.ghosts.items()]:
            if np.hypot(*(ghost.position - position)) < MERGE:
                for parent in ghost.parents:
                    self._join(parent, node)
                del self.ghosts[ghost_id]
        return node

    def _sight(self, node: int, where: np.ndarray, sighting: tuple[int, int]) -> None:
        """Merge a waypoint seen from ``node`` into a near node or ghost, or add a ghost."""
        gaps = [float(np.hypot(*(p - where))) for p in self.positions]
        if min(gaps) < MERGE:
            self._join(node, int(np.argmin(gaps)))
            return
        for ghost in self.ghosts.values():
            if np.hypot(*(ghost.position - where)) < MERGE:
                ghost.position = (ghost.position * ghost.count + where) / (ghost.count + 1)
                ghost.count += 1
                ghost.sightings.append(sighting)
                if node not in ghost.parents:
                    ghost.parents.append(node)
                return
        self.ghosts[self._next_ghost] = Ghost(where, [node], [sighting])
        self._next_ghost += 1

    def _join(self, a: int, b: int) -> None:
        if a != b:
            length = float(np.hypot(*(self.positions[a] - self.positions[b])))
            self.edges[a][b] = self.edges[b][a] = length

    def _gap(self, node: int, ghost: int) -> float:
        return float(np.hypot(*(self.positions[node] - self.ghosts[ghost].position)))

    def _dijkstra(self) -> tuple[np.ndarray, dict[int, int]]:
        """Return the metres from the current node to each node, and each node's predecessor."""
        distance = np.full(len(self.positions), np.inf)
        distance[self.current] = 0.0
        before: dict[int, int] = {}
        open_nodes = set(range(len(self.positions)))
        while open_nodes:
            node = min(open_nodes, key=lambda n: distance[n])
            open_nodes.remove(node)
            for other, length in self.edges[node].items():
                if distance[node] + length < distance[other]:
                    distance[other], before[other] = distance[node] + length, node
        return np.minimum(distance, 50.0), before

    def _nodes_to(self, node: int, before: dict[int, int]) -> list[np.ndarray]:
        chain = [node]
        while chain[-1] in before:
            chain.append(before[chain[-1]])
        return [self.positions[n] for n in reversed(chain) if n != self.current]
