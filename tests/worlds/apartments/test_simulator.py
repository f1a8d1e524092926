"""Tests of the simulator's motion, geodesic distances, errors and expert."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from mitigate.core.observation import FORWARD, LEFT, MAX_STEPS, RIGHT, STOP
from mitigate.corruptions import CLEAN
from mitigate.evaluation.control_agents import OracleAgent
from mitigate.evaluation.episode import run_episode
from mitigate.worlds.apartments.apartment import Apartment, apartment_of
from mitigate.worlds.apartments.navigation import CELL, FreeSpace
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import SUCCESS_METRES, load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import from_vlnce


@pytest.fixture(scope="module")
def episodes():
    return load_episodes("val_seen")[:40:4]


@pytest.fixture
def simulator(episodes) -> Simulator:
    result = Simulator(16)
    result.reset(episodes[0])
    return result


def free_at(space: FreeSpace, xy: np.ndarray) -> bool:
    return bool(space.free[int(xy[1] / CELL), int(xy[0] / CELL)])


def box(width: int, depth: int) -> FreeSpace:
    """Return an empty room with blocked borders."""
    blocked = np.ones((depth, width), bool)
    blocked[1:-1, 1:-1] = False
    return FreeSpace(blocked)


def test_expert_solves_ten_episodes(episodes):
    world = ApartmentsWorld(16)
    rows = [run_episode(OracleAgent(world), world, e, CLEAN, 0) for e in episodes]
    assert [row["success"] for row in rows] == [1] * 10
    assert min(row["spl"] for row in rows) > 0.8
    # no decisions are counted, because the expert does not read frames
    assert [row["decisions"] for row in rows] == [0] * 10


def test_geodesic_distance_is_at_least_euclidean():
    space = apartment_of("apartments/val_seen/100000").space
    goal = len(space.cells) // 3
    field = space.distances([goal])
    straight = np.hypot(*(space.cells - space.cells[goal]).T) * CELL
    assert np.isfinite(field).all() and (field >= straight - 1e-5).all()
    room = box(60, 40)
    field = room.distances([0])
    assert field.max() < 1.09 * np.hypot(*(room.cells.max(0) - room.cells[0])) * CELL


def test_shortest_path_descends_through_free_cells():
    space = apartment_of("apartments/val_seen/100001").space
    field = space.distances([5])
    path = space.shortest_path(len(space.cells) - 1, field)
    length = np.hypot(*np.diff(path, axis=0).T).sum()
    assert length == pytest.approx(field[-1], abs=1e-3)
    assert all(free_at(space, p) for p in path) and np.allclose(path[-1], space.centre(5))


def test_shortest_length_bends_at_the_corners_of_walls():
    room = box(40, 40)
    start, end = room.cell_of((0.55, 0.55)), room.cell_of((3.05, 2.25))
    straight = np.hypot(*(room.centre(end) - room.centre(start)))
    assert room.shortest_length(room.centre(start), [end]) == pytest.approx(straight, abs=1e-6)
    wall = np.zeros((42, 42), bool)
    wall[[0, -1]] = wall[:, [0, -1]] = wall[:30, 19:22] = True
    room = FreeSpace(wall)
    start, end = room.centre(room.cell_of((0.85, 1.05))), room.cell_of((3.55, 0.75))
    # around the wall and its margin, the path is the convex hull without the line back to the start
    cells = np.argwhere(~room.free[11:35, 10:30])[:, ::-1] + [10, 11]
    corners = (cells[:, None] + [[0, 0], [0, 1], [1, 0], [1, 1]]).reshape(-1, 2) * CELL
    back = np.hypot(*(room.centre(end) - start))
    around = ConvexHull([start, room.centre(end), *corners]).area - back
    assert room.shortest_length(start, [end]) == pytest.approx(around, abs=1e-4)
    assert room.shortest_length(start, [end, room.cell_of(start)]) == 0.0


@pytest.mark.parametrize("seed", range(100000, 100006))
def test_shortest_length_is_between_the_straight_line_and_the_grid_path(seed):
    space = apartment_of(f"apartments/val_seen/{seed}").space
    targets = np.random.default_rng(seed).choice(len(space.cells), 3, replace=False).tolist()
    field, ends = space.distances(targets), (space.cells[targets][:, ::-1] + 0.5) * CELL
    lengths = np.array([space.shortest_length(space.centre(c), targets) for c in range(0, 900, 30)])
    grid = field[0:900:30]
    straight = [np.hypot(*(ends - space.centre(c)).T).min() for c in range(0, 900, 30)]
    assert (lengths <= grid + 1e-4).all() and (lengths >= np.array(straight) - 1e-4).all()
    assert 1.02 < (grid.sum() / lengths.sum()) < 1.09


@pytest.mark.parametrize("seed", range(4))
def test_move_never_enters_blocked_cells(simulator, seed):
    rng = np.random.default_rng(seed)
    for _ in range(400):
        simulator.step(int(rng.choice([FORWARD, FORWARD, FORWARD, LEFT, RIGHT])))
        assert free_at(simulator.space, simulator.xy)
    assert simulator.collisions > 0


def test_forward_moves_or_slides():
    room = box(40, 40)
    xy, hit = room.move(np.array([2.0, 2.0]), 0.0, 0.25)
    assert np.allclose(xy, [2.0, 2.25]) and not hit
    # a positive angle is counter-clockwise, which is to the left
    xy, hit = room.move(np.array([2.0, 2.0]), np.pi / 2, 0.25)
    assert np.allclose(xy, [1.75, 2.0]) and not hit
    for _ in range(12):
        xy, hit = room.move(xy, 0.0, 0.25)
    assert hit and free_at(room, xy) and xy[0] == pytest.approx(1.75)
    # a motion that hits the wall at 45 degrees slides along the wall
    slid, hit = room.move(xy, -np.pi / 4, 0.25)
    assert hit and slid[0] > xy[0] + 0.1 and abs(slid[1] - xy[1]) < CELL


def test_left_turns_15_degrees_counter_clockwise(simulator):
    before = simulator.heading
    simulator.step(LEFT)
    assert np.degrees(simulator.heading - before) == pytest.approx(15)
    simulator.step(RIGHT)
    simulator.step(RIGHT)
    assert np.degrees(simulator.heading - before) == pytest.approx(-15)
    assert np.allclose(simulator.odometry()["pose"], [*simulator.xy, simulator.heading])


def test_episode_ends_at_stop_or_the_limit(simulator, episodes):
    simulator.step(STOP)
    assert simulator.done and simulator.stopped
    with pytest.raises(RuntimeError, match="The episode is over"):
        simulator.step(FORWARD)
    simulator.reset(episodes[1])
    for _ in range(MAX_STEPS):
        assert not simulator.done
        simulator.step(LEFT)
    assert simulator.done and not simulator.stopped


def test_distance_to_goal_matches_the_episode(simulator, episodes):
    shortest, space = episodes[0].geodesic_distance, simulator.space
    assert shortest < simulator.field[space.cell_of(simulator.xy)] < 1.09 * shortest
    goal = from_vlnce(episodes[0].goals[0].position)
    assert simulator.field[space.cell_of(goal)] == 0.0 and SUCCESS_METRES == 2.0


def start_at(episode, xy):
    return replace(episode, start_position=(float(xy[0]), 0.0, -float(xy[1])))


def test_reset_moves_a_blocked_start(simulator, episodes):
    space = simulator.space
    blocked = (np.argwhere(~space.free)[:, ::-1] + 0.5) * CELL
    away = [np.hypot(*(space.centre(space.cell_of(xy)) - xy)) for xy in blocked]
    inside = blocked[[0.05 < metres < 0.3 for metres in away]][::40]
    for xy in inside:
        simulator.reset(start_at(episodes[0], xy))
        assert free_at(space, simulator.xy) and len(inside) > 3
        for _ in range(24):
            simulator.step(FORWARD)
            simulator.step(LEFT)
        assert len(np.unique(simulator.path, axis=0)) > 2
    free = space.centre(7) + [0.031, -0.017]
    simulator.reset(start_at(episodes[0], free))
    assert np.array_equal(simulator.xy, free)


def test_world_measures_the_shortest_path(episodes):
    world, first = ApartmentsWorld(16), episodes[0]
    own_value = first.geodesic_distance
    elsewhere = (first.reference_path[-1], *first.reference_path[1:])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for reported in (own_value, own_value + 0.9, None):
            world.reset(replace(first, geodesic_distance=reported, reference_path=elsewhere))
            assert world.measures()["geodesic_distance"] == own_value
    for reported in (0.0, 2 * own_value):
        other = ApartmentsWorld(16)
        with pytest.warns(
            UserWarning, match=rf" {reported:g} m for episode {first.episode_id}, but"
        ):
            other.reset(replace(first, geodesic_distance=reported))
        assert other.measures()["geodesic_distance"] == own_value
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            other.reset(replace(episodes[1], geodesic_distance=reported))


def test_step_names_the_allowed_actions(simulator):
    with pytest.raises(ValueError, match="must be 0 STOP, 1 FORWARD.*got 4"):
        simulator.step(4)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("mp3d/17DRP5sb8fy/17DRP5sb8fy.glb", "Matterport3D scans need the Habitat simulator"),
        ("apartments/train/200000", "belongs to split 'val_unseen'"),
        ("apartments/train/150000", "allowed seeds: train 0-99999"),
    ],
)
def test_reset_explains_an_unknown_scene(episodes, scene, words):
    with pytest.raises(ValueError, match=words):
        Simulator(16).reset(replace(episodes[0], scene_id=scene))


def test_reset_rejects_positions_outside_free_space(episodes):
    """Without this check, a wrong sign of z or positions from another scene would go unnoticed.

    They would only lower the success rate.
    """
    first = episodes[0]
    x, y, z = first.start_position
    for wrong in (
        replace(first, start_position=(x, y, -z)),
        replace(first, goals=(replace(first.goals[0], position=(x + 500.0, y, z)),)),
    ):
        with pytest.raises(ValueError, match=rf"{first.episode_id}.*free position.*z is -y"):
            Simulator(16).reset(wrong)


@pytest.mark.parametrize("seed", [0, 1, 100_000, 200_000])
def test_apartment_rooms_and_doors_are_reachable(seed):
    apartment = Apartment(seed)
    rooms = {
        apartment.room_at(apartment.space.centre(c)) for c in range(len(apartment.space.cells))
    }
    assert rooms == set(range(len(apartment.rooms)))
    assert 4 <= len(apartment.rooms) <= 8
    assert all(free_at(apartment.space, np.array([door.x, door.y])) for door in apartment.doors)


def test_step_raises_after_the_end():
    world = ApartmentsWorld(16)
    world.reset(load_episodes("val_seen")[0])
    world.simulator.steps = MAX_STEPS - 1
    world.step(LEFT)
    assert world.done
    with pytest.raises(RuntimeError, match="The episode is over"):
        world.step(LEFT)
