"""Tests that waypoints lead to free places, and that the controller reaches them by odometry
alone."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.agents.controller import Controller
from mitigate.agents.topological.perception import (
    ANGLES,
    LONGEST,
    MAX_WAYPOINTS,
    SHORTEST,
    YAWS,
    select,
)
from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, TURN_DEGREES
from mitigate.worlds.apartments.labels import free_directions
from mitigate.worlds.apartments.navigation import CELL
from tests.agents.rooms import room, sure


def walk(space, xy, heading, route) -> tuple[np.ndarray, int]:
    """Follow a route with a controller; return its final position and the number of its actions."""
    controller, xy, steps = Controller(), np.array(xy, float), 0
    controller.follow([np.array(p, float) for p in route])
    while (action := controller.action(np.array([*xy, heading]))) is not None:
        if action == FORWARD:
            xy, _ = space.move(xy, heading, FORWARD_METRES)
        else:
            heading += np.radians(TURN_DEGREES) * (1 if action == LEFT else -1)
        steps += 1
    return xy, steps


@pytest.mark.parametrize("number", range(8))
def test_controller_reaches_its_targets(number):
    rng = np.random.default_rng(number)
    space = room(8, 8)
    points = rng.uniform(1, 7, (4, 2))
    end, steps = walk(space, points[0], rng.uniform(-3, 3), points[1:])
    assert np.hypot(*(end - points[-1])) < 0.2
    length = np.hypot(*np.diff(points, axis=0).T).sum()
    assert steps < 1.5 * length / FORWARD_METRES + 3 * 12 + 6


def test_controller_gives_up_on_a_blocked_target():
    space = room(4, 4)
    # the first position is outside the free space
    end, steps = walk(space, (2, 2), 0.0, [(2, 6), (1, 1)])
    assert np.hypot(*(end - (1, 1))) < 0.2 and steps < 60


def test_controller_copies_the_pose():
    controller, pose, steps = Controller(), np.zeros(3), 0
    controller.follow([np.array([0.0, 3.0])])
    while (action := controller.action(pose)) is not None and steps < 40:
        pose[2] += np.radians(TURN_DEGREES) * {LEFT: 1, FORWARD: 0}.get(action, -1)
        if action == FORWARD:
            pose[:2] += FORWARD_METRES * np.array([-np.sin(pose[2]), np.cos(pose[2])])
        steps += 1
    assert np.hypot(*(pose[:2] - (0, 3))) < 0.3


def test_controller_without_route_returns_none():
    controller = Controller()
    assert controller.action(np.zeros(3)) is None
    controller.follow([np.zeros(2)])
    assert controller.action(np.array([0.1, 0.0, 1.0])) is None


def test_free_directions_gives_free_distances():
    space = room(6, 6)
    grid = free_directions(space, np.array([3.0, 5.0]), 0.0)  # the wall is about 0.7 m ahead
    metres = 0.25 * grid.sum(1)
    assert grid.shape == (ANGLES, 12) and set(np.unique(grid)) == {0, 1}
    assert metres[np.abs(YAWS).argmin()] <= 0.75 < 2.9 < metres[np.abs(YAWS - np.pi).argmin()]
    # each direction is free up to some distance, and blocked beyond
    assert (np.diff(grid, axis=1) <= 0).all()


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_free_directions_turns_against_the_heading(quarters):
    space, xy = room(5, 3), np.array([1.0, 1.2])
    # if the agent turns left, the relative directions shift to the right
    turned = free_directions(space, xy, quarters * np.pi / 2)
    assert np.array_equal(
        np.roll(free_directions(space, xy, 0.0), quarters * ANGLES // 4, 0), turned
    )


@pytest.mark.parametrize("heading", [0.0, 1.1])
def test_select_gives_free_separate_waypoints(heading):
    space, xy = room(6, 4), np.array([2.0, 1.5])
    chosen = select(sure(space, xy, heading))
    assert 3 <= len(chosen) <= MAX_WAYPOINTS and chosen.dtype == np.float32
    for yaw, metres in chosen:
        assert SHORTEST <= metres <= LONGEST
        angle = heading - yaw
        end = xy + metres * np.array([-np.sin(angle), np.cos(angle)])
        assert space.free[int(end[1] / CELL), int(end[0] / CELL)]
    yaws = np.sort(np.degrees(chosen[:, 0]) % 360)
    gaps = np.diff(yaws, append=yaws[0] + 360)
    assert gaps.min() > 24


def test_select_finds_both_ends_of_a_corridor():
    space = room(1.0, 9)
    chosen = select(sure(space, np.array([0.5, 4.5]), 0.0))
    assert abs(np.cos(chosen[:2, 0])).min() > 0.99
    assert np.cos(chosen[0, 0]) * np.cos(chosen[1, 0]) < 0  # one waypoint ahead and one behind
    assert chosen[:2, 1] == pytest.approx(LONGEST)


def test_select_without_free_space_is_empty():
    assert select(np.full((ANGLES, 12), -20.0)).shape == (0, 2)
