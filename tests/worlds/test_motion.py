"""Tests of motion faults: what each fault does to discrete and to continuous actions."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mitigate.bridge.config import RunConfig, check_options
from mitigate.core import conf
from mitigate.core.observation import FORWARD, LEFT, POSE, RIGHT, STOP, Observation
from mitigate.core.spaces import Box, Discrete
from mitigate.corruptions import Corruption, Key, corrupt, registry
from mitigate.corruptions.faults import motion as faults
from mitigate.corruptions.folders import Settings
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.trajectories import Traced
from mitigate.replay.replay import inapplicable
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.tasks import make_episode
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.habitat_world import HabitatWorld
from mitigate.worlds.motion import BIAS, FaultyMotion, with_motion
from mitigate.worlds.world import World

NAMES = registry.fault_names("motion")
EPISODE = make_episode(Apartment(200021), "vln", 0)
TURNS = [LEFT, LEFT, RIGHT, LEFT] * 10


class Plane(World):
    """A robot on an empty plane."""

    rule, done, sensors = "none", False, {}

    def reset(self, episode):
        self.xy, self.heading, self.steps = np.zeros(2), 0.0, 0
        return self._observe()

    def step(self, action):
        if action == STOP:
            self.done = True
            return self._observe()
        return self.move(0.25 * (action == FORWARD), 15.0 * ((action == LEFT) - (action == RIGHT)))

    def move(self, metres, degrees):
        self.steps += 1
        self.xy = self.xy + metres * np.array([-math.sin(self.heading), math.cos(self.heading)])
        self.heading += math.radians(degrees)
        return self._observe()

    def _observe(self):
        return Observation({POSE: np.array([*self.xy, self.heading])})


class Arm(World):
    """A world with continuous actions that records every action."""

    rule, done, sensors = "none", False, {}
    action_space = Box(np.array([-1.0, 0.0], np.float32), np.array([1.0, 4.0], np.float32))

    def reset(self, episode):
        self.taken = []
        return Observation({})

    def step(self, action):
        self.taken.append(np.array(action))
        return Observation({})


def drive(name, actions, severity=0.6, seed=0) -> tuple[list[float], list[float]]:
    """Return the distance in metres and the turn in degrees of each step."""
    world = FaultyMotion(Plane(), Corruption(name, severity), seed)
    poses = [world.reset(EPISODE)[POSE], *(world.step(action)[POSE] for action in actions)]
    steps = np.diff(np.stack(poses), axis=0)
    return np.hypot(*steps[:, :2].T).round(6).tolist(), np.degrees(steps[:, 2]).round(6).tolist()


def test_suite_lists_every_fault():
    suite = conf.load_config("evaluate", ["suite=motion"]).suite.conditions
    assert suite == ["clean", *NAMES] and all(registry.version(name) for name in NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_fault_at_severity_zero_is_the_identity(name):
    actions = [FORWARD, LEFT, FORWARD, RIGHT, FORWARD]
    assert drive(name, actions, 0.0) == ([0.25, 0, 0.25, 0, 0.25], [0, 15, 0, -15, 0])


@pytest.mark.parametrize("name", NAMES)
def test_fault_repeats_itself_and_depends_on_the_seed(name):
    actions = [FORWARD, LEFT] * 20
    assert drive(name, actions) == drive(name, actions)
    assert len({str(drive(name, actions, seed=seed)) for seed in range(6)}) > 1


def test_slip_shortens_each_movement_by_a_random_part():
    metres, _ = drive("motion_slip", [FORWARD] * 40, 1.0)
    _, degrees = drive("motion_slip", [LEFT] * 40, 1.0)
    least = 1 - faults.SLIP
    assert 0.25 * least <= min(metres) < 0.1 and 0.2 < max(metres) <= 0.25
    assert 15 * least <= min(degrees) < 6 and 12 < max(degrees) <= 15
    weak, _ = drive("motion_slip", [FORWARD] * 40, 0.3)
    assert all(a >= b for a, b in zip(weak, metres, strict=True))  # slip grows with severity


def test_drift_turns_the_robot_while_it_moves_forward():
    sides = set()
    for seed in range(6):
        metres, degrees = drive("motion_drift", [FORWARD] * 5 + [LEFT], 0.6, seed)
        assert metres == [0.25] * 5 + [0] and degrees[5] == 15
        assert len(set(degrees[:5])) == 1 and abs(degrees[0]) == pytest.approx(6.0)
        sides.add(degrees[0] > 0)
    assert sides == {True, False}


def test_gain_is_constant_in_an_episode():
    gains = set()
    for seed in range(6):
        metres, _ = drive("motion_gain", [FORWARD] * 4, 1.0, seed)
        _, degrees = drive("motion_gain", [LEFT, RIGHT] * 2, 1.0, seed)
        assert len(set(metres)) == 1 and {abs(d) for d in degrees} == {abs(degrees[0])}
        assert 0.125 <= metres[0] <= 0.375 and 7.5 <= abs(degrees[0]) <= 22.5
        gains.add((metres[0], degrees[0]))
    assert len(gains) == 6


def test_dropped_action_is_a_step_without_movement():
    metres, _ = drive("dropped_action", [FORWARD] * 200, 1.0)
    assert set(metres) == {0.0, 0.25} and 0.4 < np.mean(np.array(metres) == 0) < 0.6
    world = FaultyMotion(Plane(), Corruption("dropped_action", 1.0), 0)
    world.reset(EPISODE)
    for _ in range(30):
        world.step(FORWARD)
    assert world.world.steps == 30


def test_repeated_action_executes_the_previous_one():
    _, degrees = drive("repeated_action", TURNS, 1.0)
    commands = [15.0 if action == LEFT else -15.0 for action in TURNS]
    for number in range(1, len(TURNS)):
        assert degrees[number] in (commands[number], degrees[number - 1])
    differing = [a != b for a, b in zip(commands, degrees, strict=True)]
    assert any(differing) and not differing[0]


def test_stop_is_always_executed():
    for name in NAMES:
        for seed in range(8):
            world = FaultyMotion(Plane(), Corruption(name, 1.0), seed)
            world.reset(EPISODE)
            world.step(FORWARD)
            world.step(STOP)
            assert world.done


def test_continuous_actions_are_changed_and_clipped():
    action = np.array([0.5, 3.0], np.float32)

    def taken(name, severity=1.0, seed=0):
        world = FaultyMotion(Arm(), Corruption(name, severity), seed)
        world.reset(EPISODE)
        for number in range(40):
            world.step(action if number % 2 == 0 else -action * [1, -1])
        space = world.world.action_space
        assert all(np.array_equal(space.check(each), each) for each in world.world.taken)
        return np.stack(world.world.taken)

    even = taken("motion_slip")[::2]
    assert np.ptp(even[:, 0]) > 0.1 and (even <= action).all()
    drift = taken("motion_drift")
    side = np.sign(drift[0, 0] - 0.5)
    assert np.allclose(drift[0], np.clip(action + side * BIAS * np.array([1, 2]), -1, 4))
    gain = taken("motion_gain")
    assert len(np.unique(gain[::2], axis=0)) == 1 and not np.array_equal(gain[0], action)
    dropped = taken("dropped_action")
    assert 5 < (dropped == 0).all(axis=1).sum() < 35
    repeated = taken("repeated_action")
    assert (repeated[1:] == repeated[:-1]).all(axis=1).any()
    assert np.array_equal(taken("motion_slip", 0.0)[0], action)


def test_other_actions_can_only_be_repeated():
    class Game(Arm):
        action_space = Discrete(5)

    world = with_motion(Game(), Corruption("repeated_action", 1.0), 0)
    world.reset(EPISODE)
    for number in range(30):
        world.step(number % 5)
    assert [int(a) for a in world.world.taken] != [number % 5 for number in range(30)]
    for name in NAMES[:-1]:
        with pytest.raises(ValueError, match="cannot change the actions of Game"):
            with_motion(Game(), Corruption(name, 0.5), 0)


class Walker:
    """Drives forward, then stops."""

    def reset(self, instruction):
        self.step = 0

    def act(self, observation):
        self.step += 1
        return FORWARD if self.step < 12 else STOP


@pytest.mark.parametrize("name", [*NAMES, "motion_drift+foreign_object"])
def test_apartments_execute_actions_with_faults(name):
    def walk(world, corruption):
        return run_episode(Walker(), world, EPISODE, corruption, 1)

    clean = walk(ApartmentsWorld(16), Corruption("clean", 0.0))
    faulty = walk(ApartmentsWorld(16), Corruption(name, 1.0))
    assert faulty["steps"] == clean["steps"] == 12
    if name == "repeated_action":  # repeated actions do not affect a robot that only drives forward
        assert faulty == clean
    else:
        assert faulty["distance_to_goal"] != clean["distance_to_goal"]
    traced = Traced(ApartmentsWorld(16))
    assert walk(traced, Corruption(name, 1.0)) == faulty and len(traced.path) > 2


def test_habitat_moves_by_the_distorted_amounts(monkeypatch):
    acted = []
    amounts = {"move_forward": 0.25, "turn_left": 15.0, "turn_right": 15.0}
    space = {n: SimpleNamespace(actuation=SimpleNamespace(amount=a)) for n, a in amounts.items()}
    agent = SimpleNamespace(agent_config=SimpleNamespace(action_space=space))
    agent.act = lambda name: acted.append((name, space[name].actuation.amount))
    habitat = HabitatWorld("scenes")
    habitat._sim = SimpleNamespace(get_agent=lambda _: agent)
    habitat.stopped, habitat.steps, habitat.collisions, habitat.path = False, 0, 0, []
    monkeypatch.setattr(habitat, "_position", lambda: np.zeros(3))
    monkeypatch.setattr(habitat, "_observation", lambda: Observation({}))
    habitat.move(0.2, -4.0)
    habitat.move(0.0, 12.0)
    habitat.move(0.0, 0.0)
    assert acted == [("move_forward", 0.2), ("turn_right", 4.0), ("turn_left", 12.0)]
    assert habitat.steps == 3
    assert {n: spec.actuation.amount for n, spec in space.items()} == amounts


def test_motion_faults_are_rejected_where_they_cannot_apply():
    with pytest.raises(ValueError, match="changes actions, not frames"):
        corrupt(np.zeros((4, 4, 3), np.uint8), "motion_slip", 0.5, key=Key(0, "e"))
    with pytest.raises(ValueError, match="motion fault"):
        Settings("motion_slip", 0.5)
    with pytest.raises(ValueError, match="must be the first name of a pair"):
        Corruption("intermittent+motion_slip", 0.5)
    config = RunConfig(conditions=["motion_slip"], suite={"conditions": []}, launcher=None)
    with pytest.raises(ValueError, match="does not intercept"):
        check_options(config, ["python", "x.py"])
    reason = inapplicable(Corruption("motion_slip", 0.5), Walker(), [])
    assert reason == "the recording decides how the robot moves"
