"""Tests of the topological map on small examples: positions of ghosts, merging of ghosts, and
routes."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.agents.topological.mapping import GEOMETRY, MERGE, TopologicalMap

RIGHT, BACK, LEFT = np.pi / 2, np.pi, 3 * np.pi / 2


def pose(x: float, y: float, heading: float = 0.0) -> np.ndarray:
    return np.array([x, y, heading])


def waypoints(*pairs: tuple[float, float]) -> np.ndarray:
    return np.array(pairs, np.float32).reshape(-1, 2)


def places(graph: TopologicalMap) -> list[list[float]]:
    return [np.round(ghost.position, 3).tolist() for ghost in graph.ghosts.values()]


def corridor() -> TopologicalMap:
    """Return a map with nodes at y = 0, 2 and 4. One ghost is to the right of the first node, and
    one after the last node."""
    graph = TopologicalMap()
    graph.add(pose(0, 0), waypoints((RIGHT, 1.5), (0, 2)))
    graph.add(pose(0, 2), waypoints((0, 2)))
    graph.add(pose(0, 4), waypoints((0, 2)))
    return graph


def test_add_places_ghosts_clockwise_from_the_heading():
    graph = TopologicalMap()
    graph.add(pose(0, 0), waypoints((0, 1), (RIGHT, 1.5), (LEFT, 2)))
    assert places(graph) == [[0, 1], [1.5, 0], [-2, 0]]
    turned = TopologicalMap()
    turned.add(pose(1, 1, np.pi / 2), waypoints((0, 1), (RIGHT, 1)))  # looks along -x
    assert places(turned) == [[0, 1], [1, 2]]


def test_add_merges_near_waypoints():
    graph = TopologicalMap()
    graph.add(pose(0, 0), waypoints((0, 2)))
    # this waypoint is not merged, because it is the second node itself
    graph.add(pose(1, 0), waypoints((LEFT, 0.2)))
    graph.add(pose(0, 3.2), waypoints((BACK, 1)))  # 0.2 m from the first ghost
    assert places(graph) == [[0, 2.1]]
    ghost = next(iter(graph.ghosts.values()))
    assert ghost.parents == [0, 2] and ghost.sightings == [(0, 0), (2, 6)]


def test_add_joins_waypoints_at_visited_nodes():
    graph = TopologicalMap()
    graph.add(pose(0, 0), waypoints())
    graph.add(pose(3, 0), waypoints())
    graph.add(pose(3, 3), waypoints((0, 1)))
    before = len(graph.ghosts)
    graph.add(pose(3, 0.1), waypoints((LEFT, 2.9)))  # faces the first node
    assert len(graph.ghosts) == before and graph.edges[1][0] == pytest.approx(3)


def test_add_turns_a_reached_ghost_into_a_node():
    graph = TopologicalMap()
    graph.add(pose(0, 0), waypoints((0, 2), (RIGHT, 2)))
    graph.add(pose(0.1, 2 + MERGE / 3), waypoints())
    assert places(graph) == [[2, 0]] and len(graph.positions) == 2
    assert 1 in graph.edges[0]


def test_add_updates_the_panorama_of_a_node():
    graph = corridor()
    graph.add(pose(0.1, 0.1), waypoints())
    assert len(graph.positions) == 3 and graph.current == 0 and graph.node_panorama == [3, 1, 2]


def test_route_follows_visited_nodes():
    graph = corridor()
    ghost = next(i for i, g in graph.ghosts.items() if g.position[0] > 1)
    assert np.allclose(graph.route(ghost), [[0, 2], [0, 0], [1.5, 0]], atol=1e-6)
    assert np.allclose(graph.route_to_node(0), [[0, 2], [0, 0]])
    assert graph.route_to_node(2) == []


def test_route_takes_the_shorter_way():
    graph = corridor()
    graph.add(pose(1.5, 3), waypoints())
    # at the position of the first ghost, so it is joined to node 0
    graph.add(pose(1.5, 0), waypoints((RIGHT, 2)))
    assert 0 in graph.edges[4]
    # this route is 4.8 m long, the other one 5.5 m
    assert np.allclose(graph.route_to_node(2), [[1.5, 3], [0, 4]])
    assert np.allclose(graph.route_to_node(1), [[0, 0], [0, 2]])
    assert np.allclose(graph.route(max(graph.ghosts)), [[3.5, 0]], atol=1e-6)


def test_decision_lists_stop_nodes_and_ghosts():
    graph = corridor()
    output = graph.decision(pose(0, 4))
    assert output.panorama == 2 and output.nodes.tolist() == [0, 1, 2]
    assert output.geometry.shape == (1 + 3 + 2, GEOMETRY)
    assert output.travel == pytest.approx([5.5, 2.0])
    # for each ghost, the index of the panorama and of the view that saw it
    assert output.sightings[:, 0].tolist() == [[0, 3], [2, 0]]
    assert (output.sightings[:, 1:] == -1).all()


def test_geometry_is_invariant_to_the_world_frame():
    def geometry(shift: np.ndarray, turn: float) -> np.ndarray:
        graph = TopologicalMap()
        c, s = np.cos(turn), np.sin(turn)
        for x, y, heading in ((0, 0, 0.3), (0, 2, 0.0), (1, 3, -1.2)):
            where = shift + np.array([c * x - s * y, s * x + c * y])
            graph.add(np.array([*where, heading + turn]), waypoints((0, 2), (RIGHT, 1.7)))
        return graph.decision(np.array([*where, heading + turn])).geometry

    here = geometry(np.zeros(2), 0.0)
    assert np.allclose(here, geometry(np.array([3.0, -5.0]), 0.8), atol=1e-5)
    assert not np.allclose(here[1:], here[:1])


def test_arrive_removes_the_ghost():
    graph = corridor()
    for ghost in list(graph.ghosts):
        graph.arrive(ghost)
    graph.arrive(99)
    assert not graph.ghosts and graph.decision(pose(0, 4)).ghosts == []
