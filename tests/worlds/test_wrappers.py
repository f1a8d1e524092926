"""Tests of the gymnasium wrapper: keys, spaces, order of entries, and error messages."""

import importlib
import re
import sys

import numpy as np
import pytest

from mitigate.corruptions import (
    CLEAN,
    DEPTH,
    RGB,
    Corruption,
    DepthSensor,
    Key,
    Schedule,
    corrupt,
    corrupt_normalised,
)

gymnasium = pytest.importorskip("gymnasium")
from gymnasium import spaces  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

from mitigate.worlds.wrappers import CorruptObservation  # noqa: E402

FRAME = spaces.Box(0, 255, (24, 32, 3), np.uint8)
METRES = spaces.Box(0.0, 10.0, (24, 32, 1), np.float32)
HURT_RGB = Schedule("per_episode", 0.8, clean_share=0.0, names=RGB)


class Room(gymnasium.Env):
    """An environment whose frames depend on the step, and which ends after 3 steps."""

    def __init__(self, space: spaces.Space) -> None:
        self.observation_space, self.action_space = space, spaces.Discrete(2)

    def _show(self, space):
        if isinstance(space, spaces.Dict):
            return {name: self._show(part) for name, part in space.items()}
        ramp = np.linspace(0.2, 0.7, int(np.prod(space.shape))).reshape(space.shape)
        return ((ramp + 0.05 * self.time) * space.high.max()).astype(space.dtype)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.time = 0
        return self._show(self.observation_space), {}

    def step(self, action):
        self.time += 1
        return self._show(self.observation_space), 0.0, self.time == 3, False, {}


def episode(env, seed=None):
    frames = [env.reset(seed=seed)[0]]
    frames += [env.step(0)[0] for _ in range(3)]
    return frames


def test_wrapper_accepts_a_corruption_or_a_pair():
    space = spaces.Dict({"depth": METRES, "rgb": FRAME})
    alone, always = (
        episode(CorruptObservation(Room(space), by, 5), 3)
        for by in (Corruption("spatter", 0.7), Schedule.always("spatter", 0.7))
    )
    for a, b in zip(alone, always, strict=True):
        assert np.array_equal(a["rgb"], b["rgb"]) and np.array_equal(a["depth"], b["depth"])
    clean, both = (
        episode(CorruptObservation(Room(space), by, 5), 3)
        for by in (CLEAN, Corruption("spatter+quantization", 0.7))
    )
    for a, b in zip(clean, both, strict=True):
        assert (a["rgb"] != b["rgb"]).any() and (a["depth"] != b["depth"]).any()
    with pytest.raises(
        ValueError, match="'quantization' corrupts depth, but the environment has no depth"
    ):
        CorruptObservation(Room(FRAME), Corruption("spatter+quantization", 0.7))
    with pytest.raises(ValueError, match=r"such as Corruption\('spatter', 0.6\), got 'flare'"):
        CorruptObservation(Room(FRAME), "flare")


@pytest.mark.parametrize(
    "space",
    [FRAME, METRES, spaces.Dict({"depth": METRES, "rgb": FRAME})],
    ids=lambda s: s.__class__,
)
def test_wrapper_passes_the_gymnasium_check(space):
    names = RGB if space is FRAME else DEPTH if space is METRES else RGB + DEPTH
    env = CorruptObservation(Room(space), Schedule("per_frame", 1.0, names=names))
    assert env.observation_space == space
    check_env(env, skip_render_check=True)
    for frame in episode(env, 3):
        assert space.contains(frame)


def test_key_depends_on_seed_reset_and_step():
    env, clean = CorruptObservation(Room(FRAME), Schedule.always("spatter", 0.7), 5), Room(FRAME)
    assert env.reset()[0] is not None and re.fullmatch(r"unseeded-\w{8}-0", env.key.episode)
    for name, seed in (("9-0", 9), ("9-1", None), ("7-0", 7)):
        for number, (seen, settings) in enumerate(
            zip(episode(env, seed), episode(clean), strict=True)
        ):
            key = Key(5, name, number)
            assert np.array_equal(seen, corrupt(settings, "spatter", 0.7, key=key))
        assert env.key == Key(5, name, 3) and env.corruption.name == "spatter"


def test_wrapper_counts_automatic_resets():
    inside = CorruptObservation(gymnasium.wrappers.Autoreset(Room(FRAME)), HURT_RGB)
    outside = gymnasium.wrappers.Autoreset(CorruptObservation(Room(FRAME), HURT_RGB))
    inside.reset(seed=4), outside.reset(seed=4)
    for number in range(1, 10):  # the episode ends after 3 steps, and the next step resets it
        seen, expected = inside.step(0)[0], outside.step(0)[0]
        assert inside.key == outside.env.key == Key(0, f"4-{number // 4}", number % 4)
        assert np.array_equal(seen, expected)
    inside.reset()
    assert inside.key == Key(0, "4-3", 0) and inside.step(0) and inside.key == Key(0, "4-3", 1)


def test_step_requires_a_reset():
    room = Room(FRAME)
    room.time = 0
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"Call reset\(\) before step\(\)"):
        CorruptObservation(room, HURT_RGB).step(0)
    ordered = gymnasium.wrappers.OrderEnforcing(Room(FRAME))
    with pytest.raises(gymnasium.error.ResetNeeded, match="env.step"):  # the environment's own
        CorruptObservation(ordered, HURT_RGB).step(0)


def test_pixels_depend_on_the_seeds():
    def pixels(reset, seed=0):
        schedule = Schedule("per_frame", 0.9, clean_share=0.0, names=("spatter", "low_light_noise"))
        env = CorruptObservation(Room(FRAME), schedule, seed)
        return np.stack(episode(env, reset) + episode(env))

    assert np.array_equal(pixels(1), pixels(1))
    assert not np.array_equal(pixels(1), pixels(2))
    assert not np.array_equal(pixels(1), pixels(1, seed=1))


def test_wrapper_keeps_other_entries_and_their_order():
    space = spaces.Dict([("goal", spaces.Box(0, 1, (2,))), ("camera", FRAME), ("range", METRES)])
    env = CorruptObservation(
        Room(space), Schedule.always("multipath", 1.0), rgb="camera", depth="range"
    )
    clean, seen = Room(space).reset()[0], env.reset(seed=0)[0]
    assert list(seen) == list(clean) == ["goal", "camera", "range"]
    assert np.array_equal(seen["camera"], clean["camera"])
    assert np.array_equal(seen["goal"], clean["goal"])
    expected = corrupt(clean["range"], "multipath", 1.0, key=env.key)
    assert np.array_equal(seen["range"], expected) and not np.array_equal(expected, clean["range"])


def test_wrapper_corrupts_normalised_depth():
    space = spaces.Dict({"depth": spaces.Box(0.0, 1.0, (24, 32, 1), np.float32)})
    sensor = DepthSensor(0.5, 5.0)
    schedule = Schedule.always("quantization", 0.8)
    env = CorruptObservation(Room(space), schedule, sensor=sensor, normalised=True)
    seen, clean = env.reset(seed=1)[0], Room(space).reset()[0]
    expected = corrupt_normalised(clean, env.corruption, env.key, sensor)
    assert np.array_equal(seen["depth"], expected["depth"]) and space.contains(seen)
    assert not np.array_equal(seen["depth"], clean["depth"])


def test_pose_keeps_a_flare_in_place():
    space = spaces.Dict({"rgb": FRAME, "where": spaces.Box(-9, 9, (3,), np.float32)})
    env = CorruptObservation(Room(space), Schedule.always("flare", 1.0), pose="where")
    seen, clean = env.reset(seed=1)[0], Room(space).reset()[0]
    heading = float(clean["where"][2])
    expected = corrupt(clean["rgb"], "flare", 1.0, key=env.key, heading=heading)
    assert np.array_equal(seen["rgb"], expected)
    assert not np.array_equal(expected, corrupt(clean["rgb"], "flare", 1.0, key=env.key))
    with pytest.raises(ValueError, match="pose must be an entry .*rgb, where.*'were'"):
        CorruptObservation(Room(space), Schedule.always("flare", 1.0), pose="were")


@pytest.mark.parametrize(
    ("space", "options", "part"),
    [
        (spaces.Box(0, 1, (24, 32, 3), np.float32), {}, "must be a Box of uint8"),
        (spaces.Box(0, 255, (3, 24, 32), np.uint8), {}, "before frames are transposed"),
        (spaces.Dict({"rgb": METRES}), {}, "must be a Box of uint8"),
        (spaces.Dict({"image": FRAME}), {}, "Name the entries with rgb= and depth="),
        (spaces.Discrete(3), {}, "must be a Box of uint8"),
        (FRAME, {"names": DEPTH}, "corrupts depth, but the environment has no depth"),
        (METRES, {"names": RGB}, r"has no rgb.*Choose other corruptions"),
        (spaces.Box(0, 5.0, (4, 4), np.float32), {"names": DEPTH}, r"DepthSensor\(z_max=5\)"),
    ],
    ids=str,
)
def test_wrapper_explains_unsupported_spaces(space, options, part):
    names = options.get("names", RGB)
    with pytest.raises(ValueError, match=part) as error:
        CorruptObservation(Room(space), Schedule("per_episode", 0.5, names=names))
    assert "\n" not in str(error.value)


def test_wrapper_rejects_metres_as_normalised_depth():
    schedule = Schedule.always("multipath", 0.5)
    with pytest.raises(ValueError, match="must end at 1 if normalised=True"):
        CorruptObservation(Room(METRES), schedule, normalised=True)


def test_import_names_the_missing_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "mitigate.worlds.wrappers")
    with pytest.raises(ImportError, match=r"pip install -e '\.\[gymnasium\]'"):
        importlib.import_module("mitigate.worlds.wrappers")


def test_unseeded_environments_draw_different_corruptions():
    """Issue T2, item 12."""
    envs = [CorruptObservation(Room(FRAME), Corruption("spatter", 0.6)) for _ in range(4)]
    frames = [env.reset()[0].tobytes() for env in envs]
    assert len({*frames}) == 4
    again = [env.reset(seed=1)[0].tobytes() for env in envs]
    assert len({*again}) == 1  # the seed determines the episode's key
