"""Tests of the frontier agent: its map, its search, and the objects that it finds."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from mitigate.agents.agent import Seeing, Trainable
from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.frontier.agent import LIKELY, named
from mitigate.agents.frontier.grid import CELL, Grid, frontiers, object_cells, routes
from mitigate.agents.text import CONCEPTS, THING_NAMES
from mitigate.core.observation import LEFT, MAX_STEPS, RGB
from mitigate.evaluation.episode_lists import warn_of_tasks
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld

NOTHING = np.full((4, 2), 0.01, np.float32)


def wall(metres: float, size: int = 32) -> np.ndarray:
    """Return a depth image [H, W] of a wall ahead, with floor and ceiling."""
    up = np.abs(1 - (2 * np.arange(size) + 1) / size)[:, None] + np.zeros(size)
    return np.minimum(metres, 1.25 / up).astype(np.float32)


def looked(*looks: tuple[np.ndarray, np.ndarray]) -> Grid:
    grid = Grid(np.zeros(3), 1.25)
    for depth, pose in looks:
        grid.add(depth, pose, NOTHING, np.zeros(4))
    return grid


def test_grid_marks_walls_and_free_cells():
    grid = looked(*[(wall(2.0), np.zeros(3))] * 3)
    at = {metres: grid.cell(np.array([0.0, metres])) for metres in (1.0, 2.0, 3.0)}
    assert grid.known[at[1.0]] and grid.occupied[at[1.0]] < 0
    assert max(grid.occupied[grid.cell(np.array([0.0, y]))] for y in (1.9, 2.0, 2.1)) > 0
    assert not grid.known[at[3.0]]


def test_grid_ignores_missing_depth():
    assert not looked((np.zeros((32, 32)), np.zeros(3))).known.any()


def test_routes_avoid_occupied_cells():
    grid = looked()
    grid.known[:] = True
    row, column = grid.cell(np.zeros(2))
    grid.occupied[row + 10, column - 20 : column + 5] = 3.0
    ways = routes(grid, np.zeros(2))
    goal = np.array([row + 20, column])
    path = ways.to(goal)
    assert tuple(path[0]) == (row, column) and tuple(path[-1]) == tuple(goal)
    assert (grid.occupied[path[:, 0], path[:, 1]] <= 0).all()
    assert ways.at(goal[None])[0] > 2.0 + 0.3


def test_frontiers_border_on_unknown_cells():
    grid = looked(*[(wall(3.0), np.zeros(3))] * 3)
    groups = frontiers(grid)
    assert groups
    for group in groups:
        assert grid.known[group[:, 0], group[:, 1]].all()
        around = [grid.known[i - 1 : i + 2, j - 1 : j + 2].all() for i, j in group]
        assert not any(around)


def test_grid_locates_the_object_from_two_views():
    """One observation gives only a direction; a second observation from the side gives a
    position."""
    grid = Grid(np.zeros(3), 1.25)
    ahead = np.array([[0.02, 0.02], [0.95, 0.3], [0.02, 0.02], [0.02, 0.02]], np.float32)
    for _ in range(3):
        grid.add(wall(3.0), np.zeros(3), ahead, np.zeros(4))
    spread = len(object_cells(grid, 1.0))
    side = np.array([-1.5, 1.5, 0.0])
    for _ in range(3):
        grid.add(wall(1.5), side, np.roll(ahead, 1, 0), np.zeros(4))
    assert 0 < len(object_cells(grid, 1.0)) < spread


def test_named_returns_the_last_object():
    assert THING_NAMES[named("Find a washing machine.")] == "washing machine"
    assert THING_NAMES[named("Go past the sofa and stop at the blue chairs!")] == "chair"
    assert THING_NAMES[named("an armchair")] == "armchair"
    assert named("walk to the piano") is None


def test_likely_names_known_concepts():
    assert set(LIKELY) <= set(CONCEPTS)
    assert {name for names in LIKELY.values() for name in names} <= set(THING_NAMES)


def test_agent_finds_recognised_objects():
    world, agent, won = ApartmentsWorld(views=1), FrontierAgent().eval(), 0
    agent._recognise = lambda rgb: 0.01 + 0.98 * world.truth()["concepts"][None]
    for episode in load_episodes("val_seen", "ogn")[:4]:
        seen = world.reset(episode)
        agent.reset(episode.instruction.text)
        while not world.done:
            seen = world.step(agent.act(seen))
        won += world.measures()["success"]
        assert world.measures()["steps"] < MAX_STEPS
    assert won >= 3


def test_agent_turns_first_and_requires_its_sensors():
    world, agent = ApartmentsWorld(views=1), FrontierAgent().eval()
    seen = world.reset(load_episodes("val_seen", "ogn")[0])
    with pytest.raises(RuntimeError, match="reset"):
        agent.act(seen)
    agent.reset("Find a bed.")
    assert [agent.act(seen) for _ in range(3)] == [LEFT] * 3
    with pytest.raises(KeyError, match="pose"):
        agent.act({RGB: seen[RGB]})
    with pytest.raises(ValueError, match="smell"):
        FrontierAgent(blind=("smell",))
    with pytest.warns(UserWarning, match="names no object"):
        agent.reset("hello")


def test_evaluation_warns_of_unsupported_tasks():
    routes, objects = load_episodes("val_unseen")[:3], load_episodes("val_unseen", "ogn")[:2]
    with pytest.warns(UserWarning, match="mine can find an object, not follow a route, but 3 of 5"):
        warn_of_tasks(FrontierAgent(), [*routes, *objects], "mine", "val_unseen_ogn")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_tasks(FrontierAgent(), objects, "mine", "val_unseen_ogn")
        warn_of_tasks(object(), routes, "any that does not say", "val_unseen")


def test_frontier_agent_is_seeing_but_not_trainable():
    agent = FrontierAgent()
    assert isinstance(agent, Seeing) and not isinstance(agent, Trainable)
    assert {id(p) for m in agent.parts().values() for p in m.parameters()} == {
        id(p) for p in agent.parameters()
    }


def test_blind_agent_ignores_the_instruction():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        agent = FrontierAgent(blind=("instruction",))
        agent.reset("Find a bed.")
    assert agent.thing is None


def test_grid_covers_the_longest_episode():
    grid = looked()
    assert grid.cell(np.array([1e3, -1e3])) == (0, len(grid.known) - 1)
    assert np.allclose(
        grid.place(np.array([grid.cell(np.array([1.0, -2.0]))])), [[1, -2]], atol=CELL
    )


def test_act_all_keeps_episodes_independent():
    new_agent, episodes = FrontierAgent(size=16).eval(), load_episodes("val_seen", "ogn")[:3]
    assert new_agent.together > 1
    worlds = [ApartmentsWorld(16, 2, 1) for _ in episodes]
    seen = [world.reset(episode) for world, episode in zip(worlds, episodes, strict=True)]
    memories = [new_agent.begin(episode.instruction.text) for episode in episodes]
    alone, world = new_agent.begin(episodes[1].instruction.text), ApartmentsWorld(16, 2, 1)
    view, gone = world.reset(episodes[1]), []
    for _ in range(25):
        actions = new_agent.act_all(seen, memories)
        seen = [world.step(action) for world, action in zip(worlds, actions, strict=True)]
        gone.append(actions[1])
        assert new_agent.act_all([view], [alone]) == [actions[1]]
        view = world.step(actions[1])
    assert np.array_equal(alone.grid.evidence, memories[1].grid.evidence)
    assert set(gone) > {LEFT}  # the agent has turned around and moved away
