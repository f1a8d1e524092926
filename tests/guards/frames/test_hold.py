"""Tests of ``restore=hold``, which repeats the last frame in place of an empty one."""

import numpy as np
import pytest

from mitigate.bridge.cameras import Rig
from mitigate.core.observation import DEPTH, RGB, Observation
from mitigate.guards.frames.hold import HoldLast
from mitigate.guards.guard import Guarded, Guards
from mitigate.guards.opening import labels, open_guards
from mitigate.worlds.episodes import Episode, Instruction

EPISODE = Episode("1", "0", "room", (0, 0, 0), (0, 0, 0, 1), (), Instruction("Go."), ())


def rgb(value, views=()):
    return {RGB: np.full((*views, 4, 6, 3), value, np.uint8)}


def depth(value):
    return {DEPTH: np.full((4, 6, 1), value, np.float32)}


def test_hold_repeats_the_last_frame_that_was_not_empty():
    guard = HoldLast()
    assert [guard.observe(rgb(v))[RGB].max() for v in (7, 0, 0, 9, 0)] == [7, 7, 7, 9, 9]


@pytest.mark.parametrize("empty", [0, np.nan, -1, -np.inf])
def test_hold_repeats_depth_in_place_of_a_frame_without_a_reading(empty):
    guard = HoldLast()
    guard.observe(depth(2))
    assert (guard.observe(depth(empty))[DEPTH] == 2).all()


def test_hold_leaves_a_frame_with_one_reading_unchanged():
    guard, partly = HoldLast(), depth(0)
    guard.observe(depth(2))
    partly[DEPTH][1, 1] = 3
    assert guard.observe(partly) is partly


def test_hold_passes_empty_frames_on_before_the_first_frame():
    guard, black = HoldLast(), rgb(0)
    assert guard.observe(black) is black and guard.observe(black) is black
    assert guard.observe(rgb(5))[RGB].max() == 5 and guard.observe(black)[RGB].max() == 5


def test_hold_stops_repeating_at_the_limit():
    guard = HoldLast(limit=2)
    assert [guard.observe(rgb(v))[RGB].max() for v in (7, 0, 0, 0, 8, 0)] == [7, 7, 7, 0, 8, 8]


def test_hold_treats_each_view_of_a_panorama_separately():
    guard, second = HoldLast(), rgb(9, (2,))
    guard.observe(rgb(7, (2,)))
    second[RGB][1] = 0
    held = guard.observe(second)[RGB]
    assert held[0].max() == 9 and held[1].max() == 7 and second[RGB][1].max() == 0


def test_hold_keeps_its_own_copy_of_a_frame():
    guard, frame = HoldLast(), rgb(7)
    guard.observe(frame)
    frame[RGB][:] = 0  # a camera that writes every frame to the same memory
    assert guard.observe(frame)[RGB].max() == 7


class Camera:
    """A world whose very first frame is bright; all later frames, in any episode, are black."""

    rule, sensors, done = "STOP", {}, False

    def __init__(self):
        self.level = 200

    def reset(self, episode):
        return self.step(1)

    def step(self, action):
        level, self.level = self.level, 0
        return Observation({}, lambda: rgb(level), (RGB,))

    def measures(self):
        return {"success": 1, "spl": 1.0}


def test_hold_sees_frames_that_the_agent_does_not_read_and_forgets_earlier_episodes():
    world = Guarded(Camera(), Guards([HoldLast()]))
    world.reset(EPISODE)  # the agent does not read this frame
    assert world.step(1)[RGB].max() == 200
    assert world.reset(EPISODE)[RGB].max() == 0


def test_hold_is_a_value_of_restore_with_its_own_fingerprint():
    guards = open_guards(None, "hold")
    assert isinstance(guards.guards[0], HoldLast) and guards.label == "hold"
    assert labels(None, "hold") == ["hold"]
    assert guards.fingerprint() == Guards([HoldLast()]).fingerprint()
    assert guards.fingerprint() != Guards([HoldLast(limit=3)]).fingerprint()
    started = guards.for_episode()
    started.observe(rgb(3))
    assert guards.fingerprint() == open_guards(None, "hold").fingerprint()


def camera(name, yaw):
    pose = {"hfov": 90, "orientation": [0.0, np.radians(yaw), 0.0]}
    return {"name": name, "type": RGB, "shape": [4, 6, 3], "dtype": "uint8", **pose}


def test_hold_treats_each_camera_of_a_program_separately():
    rig = Rig([camera("left", 0), camera("right", 80)])
    offsets, size = rig.lay_out([RGB])
    memory, guards, started = bytearray(size), Guards([HoldLast()]), {}

    def call(left, right):
        for name, level in (("left", left), ("right", right)):
            memory[offsets[name] : offsets[name] + 72] = bytes([level]) * 72
        changed = rig.guard(memory, offsets, guards, started)
        return changed, [memory[offsets[name]] for name in ("left", "right")]

    assert call(7, 8) == ([], [7, 8])
    assert call(0, 9) == (["left"], [7, 9])
    started.clear()  # the next episode
    assert call(0, 9) == ([], [0, 9])
