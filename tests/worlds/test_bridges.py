"""Tests that worlds work as torchrl environments, and that environments work as worlds.

The environments are from torchrl and gymnasium.
"""

from __future__ import annotations

import numpy as np
import pytest
import torch
from torchrl.envs.utils import check_env_specs

from mitigate.core.observation import RGB, STOP, Observation, Sensor
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation.episode import run_episode
from mitigate.worlds.apartments.tasks import DrawnEpisodes, load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode, Instruction
from mitigate.worlds.tensordict import EnvWorld, WorldEnv
from mitigate.worlds.world import Corrupted

gymnasium = pytest.importorskip("gymnasium")
BY_REWARD = {"success": lambda end: end.reward > 0, "rule": "reward > 0 at the end"}
SIZE = 16


def episode(seed: int) -> Episode:
    instruction = Instruction("Go.")
    return Episode(
        f"e{seed}", "0", "room", (0, 0, 0), (0, 0, 0, 1), (), instruction, (), info={"seed": seed}
    )


class Brightness:
    """An agent that stops if the frame is dark and otherwise takes action 1. It records its
    frames."""

    def reset(self, instruction):
        self.seen = []

    def act(self, observation):
        self.seen.append(np.array(observation[RGB]))
        return int(self.seen[-1].mean() > 100)


class Room(gymnasium.Env):
    """A room that becomes dark after a number of steps, which depends on the seed. Stopping in the
    dark succeeds."""

    def __init__(self, entry: str | None = None):
        box = gymnasium.spaces.Box(0, 255, (SIZE, SIZE, 3), np.uint8)
        self.entry, self.action_space = entry, gymnasium.spaces.Discrete(2)
        self.observation_space = box if entry is None else gymnasium.spaces.Dict({entry: box})

    def _look(self):
        frame = np.full((SIZE, SIZE, 3), 200 if self.left > 0 else 10, np.uint8)
        return frame if self.entry is None else {self.entry: frame}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.left = seed
        return self._look(), {}

    def step(self, action):
        won = self.left <= 0 and action == STOP
        self.left -= 1
        return self._look(), float(won), action == STOP, False, {"won": won}


@pytest.mark.parametrize(
    "world", [ApartmentsWorld(SIZE), Corrupted(ApartmentsWorld(SIZE), Corruption("flare", 0.5), 0)]
)
def test_world_env_passes_the_spec_check(world):
    check_env_specs(WorldEnv(world, load_episodes("val_seen")[:2]))
    check_env_specs(WorldEnv(world, DrawnEpisodes(2)), seed=3)


def test_world_env_returns_frames_and_final_success():
    world, listed = ApartmentsWorld(SIZE), load_episodes("val_seen")[:1]
    env = WorldEnv(ApartmentsWorld(SIZE), listed)
    data, seen = env.reset(), world.reset(listed[0])
    rewards = []
    while not data["done"]:
        assert np.array_equal(data["rgb"].numpy(), seen[RGB])
        action = world.expert().action()
        data, seen = env.step(data.set("action", torch.tensor(action)))["next"], world.step(action)
        rewards.append(float(data["reward"]))
    assert sum(rewards) == rewards[-1] == world.measures()["success"] == 1


@pytest.mark.parametrize("entry", [None, "camera"])
def test_gym_world_runs_an_environment(entry):
    from mitigate.worlds.gym import GymWorld

    named = BY_REWARD if entry is None else {"entries": {"rgb": entry}, "success": "won"}
    world, agent = GymWorld(Room(entry), **named), Brightness()
    assert world.sensors[RGB] == Sensor(RGB, (SIZE, SIZE, 3), "uint8")
    assert world.rule == ("reward > 0 at the end" if entry is None else "won at the end")
    measures = run_episode(agent, world, episode(3), CLEAN, 0)
    assert measures["success"] == 1 and measures["steps"] == 4 == measures["decisions"]
    dark = run_episode(agent, world, episode(3), Corruption("low_light", 1.0), 0)
    assert dark["success"] == 0 and dark["steps"] == 1  # the agent stops when a frame looks dark
    world.reset(episode(3))
    with pytest.raises(ValueError, match="must be 0 to 1, got"):
        world.step(5)


def test_gym_world_requires_a_reported_success():
    from mitigate.worlds.gym import GymWorld

    world = GymWorld(Room(), success="is_success")
    with pytest.raises(ValueError, match="no entry 'is_success', only 'won'"):
        run_episode(Brightness(), world, episode(3), CLEAN, 0)
    with pytest.raises(ValueError, match=r"no entry 'success'.*success=lambda end"):
        run_episode(Brightness(), GymWorld(Room()), episode(3), CLEAN, 0)


class Long(gymnasium.Wrapper):
    """An environment that ends after 525 steps and reports success only then."""

    def __init__(self) -> None:
        super().__init__(Room())

    def step(self, action):
        seen, _, _, _, _ = self.env.step(1)
        over = self.env.left <= -522
        return seen, float(over), over, False, {"success": True} if over else {}


def test_gym_world_lets_the_environment_end_an_episode():
    from mitigate.worlds.gym import GymWorld

    measures = run_episode(Brightness(), GymWorld(Long()), episode(3), CLEAN, 0)
    assert measures["success"] == 1 and measures["steps"] == 525 and "cut" not in measures


@pytest.mark.parametrize(("limit", "cut"), [(500, 1), (525, 0), (600, 0)])
def test_gym_world_measures_the_limit(limit, cut):
    from mitigate.worlds.gym import GymWorld

    measures = run_episode(Brightness(), GymWorld(Long(), limit=limit), episode(3), CLEAN, 0)
    assert (measures["cut"], measures["limit"], measures["success"]) == (cut, limit, 1 - cut)


def test_env_world_measures_the_limit():
    from mitigate.worlds.gym import GymWorld

    for limit, cut in ((2, 1), (9, 0)):
        env = WorldEnv(GymWorld(Room("rgb"), success="won"), [episode(3)])
        world = EnvWorld(env, limit=limit, **BY_REWARD)
        measures = run_episode(Brightness(), world, episode(3), CLEAN, 0)
        assert (measures["cut"], measures["success"]) == (cut, 1 - cut)


def test_run_episode_reports_a_world_that_never_ends(monkeypatch):
    from mitigate.worlds.gym import GymWorld

    monkeypatch.setattr("mitigate.evaluation.episode.MOST_STEPS", 20)
    with pytest.raises(ValueError, match=r"step 21: .*not ended the episode after 20 steps"):
        run_episode(Brightness(), GymWorld(Room(), **BY_REWARD), episode(99), CLEAN, 0)


def test_gym_world_passes_the_ending_to_success():
    from mitigate.worlds.gym import GymWorld

    ends = []
    world = GymWorld(Room(), success=lambda end: ends.append(end) or True, rule="anything")
    assert run_episode(Brightness(), world, episode(3), CLEAN, 0)["success"] == 1
    assert (ends[0].steps, ends[0].total, ends[0].reward, ends[0].info["won"]) == (4, 1.0, 1.0, 1)
    assert world.rule == "anything"


NO_TRUTH = [float("nan"), "False", {"s": False}, 0.3, -1, "no", [0, 2], [[1], [0, 1]]]


@pytest.mark.parametrize("reported", NO_TRUTH, ids=str)
def test_gym_world_rejects_invalid_success_values(reported):
    from mitigate.worlds.gym import GymWorld

    world = GymWorld(Room(), success=lambda end: reported, rule="anything")
    with pytest.raises(ValueError, match=r"must be True, False, 0 or 1"):
        run_episode(Brightness(), world, episode(3), CLEAN, 0)


@pytest.mark.parametrize(
    ("reported", "won"),
    [
        *((value, 0) for value in (None, [], [False], False, 0, 0.0, np.bool_(False))),
        *((value, 1) for value in (1, 1.0, np.float32(1), np.uint8(1), [0, 1], np.ones((1, 1)))),
        (torch.tensor([True]), 1),
        ([None, True], 1),
    ],
    ids=str,
)
def test_gym_world_accepts_truth_values(reported, won):
    from mitigate.worlds.gym import GymWorld

    world = GymWorld(Room(), success=lambda end: reported, rule="anything")
    assert run_episode(Brightness(), world, episode(3), CLEAN, 0)["success"] == won


@pytest.mark.parametrize("success", [3, "", ["won"]])
def test_gym_world_rejects_invalid_success_arguments(success):
    from mitigate.worlds.gym import GymWorld

    with pytest.raises(ValueError, match="success must be the name of an entry or a function"):
        GymWorld(Room(), success=success)
    with pytest.raises(ValueError, match="needs rule="):
        GymWorld(Room(), success=len)


class Within(Room):
    """A room whose observation contains nested dicts for the camera and the goal."""

    def __init__(self):
        super().__init__()
        box = gymnasium.spaces.Dict({"rgb": self.observation_space})
        goal = gymnasium.spaces.Dict({"polar": gymnasium.spaces.Box(-9, 9, (2,), np.float32)})
        self.observation_space = gymnasium.spaces.Dict({"camera": box, "goal": goal})

    def _look(self):
        return {
            "camera": {"rgb": super()._look()},
            "goal": {"polar": np.array([self.left, 0.5], np.float32)},
        }


def test_gym_world_names_nested_entries_with_dots():
    from mitigate.worlds.gym import GymWorld

    world = GymWorld(Within(), {"rgb": "camera.rgb", "goal": "goal.polar"})
    seen = world.reset(episode(3))
    assert seen[RGB].shape == (SIZE, SIZE, 3) and seen["goal"].tolist() == [3.0, 0.5]
    with pytest.raises(ValueError, match="it has camera.rgb, goal.polar"):
        GymWorld(Within(), {"rgb": "camera"})


def test_gym_world_rejects_spaces_without_arrays():
    from mitigate.worlds.gym import GymWorld

    room, spaces = Room("rgb"), gymnasium.spaces
    room.observation_space = spaces.Dict(
        {"rgb": room.observation_space["rgb"], "mission": spaces.Text(9)}
    )
    GymWorld(room)
    with pytest.raises(ValueError, match=r"no array mission; it has rgb"):
        GymWorld(room, {"rgb": "rgb", "words": "mission"})
    room.observation_space = spaces.Tuple([spaces.Discrete(2)])
    with pytest.raises(ValueError, match="no array rgb or depth; it has none"):
        GymWorld(room)
    room.action_space = spaces.Text(2)
    with pytest.raises(ValueError, match="must be Discrete, Box"):
        GymWorld(room)


@pytest.mark.parametrize("seed", [-1, 1.5, 1 << 40, True, "7"])
def test_seeded_episodes_rejects_invalid_seeds(seed):
    from mitigate.worlds.seeded import seeded_episodes

    with pytest.raises(ValueError, match="must be a whole number from 0 to 2147483647"):
        seeded_episodes([0, seed])


@pytest.mark.parametrize("shape", [(SIZE, SIZE, 4), (3, SIZE, SIZE), (SIZE, SIZE), (SIZE, SIZE, 1)])
def test_gym_world_rejects_unsupported_frame_shapes(shape):
    from mitigate.worlds.gym import GymWorld

    room = Room()
    room.observation_space = gymnasium.spaces.Box(0, 255, shape, np.uint8)
    with pytest.raises(ValueError, match=r"must be \[H, W, 3\], .*Wrap the environment"):
        GymWorld(room)


class Deep(Room):
    """A room with constant depth."""

    def __init__(self, depth, most=60000):
        super().__init__("rgb")
        self.depth = np.asarray(depth)
        box = gymnasium.spaces.Box(0, most, (SIZE, SIZE, 1), self.depth.dtype.type)
        self.observation_space = gymnasium.spaces.Dict({**self.observation_space, "depth": box})

    def _look(self):
        return {**super()._look(), "depth": np.full((SIZE, SIZE, 1), self.depth)}


def test_gym_world_requires_the_unit_of_integer_depth():
    from mitigate.worlds.gym import GymWorld

    with pytest.raises(
        ValueError, match=r"'depth' is uint16, .*unit is unknown.*unit=.*millimetres"
    ):
        GymWorld(Deep(np.uint16(2500)))
    world = GymWorld(Deep(np.uint16(2500)), unit=0.001)
    seen = world.reset(episode(3))["depth"]
    assert seen.dtype == np.float32 and np.allclose(seen, 2.5)
    with pytest.raises(ValueError, match="farther than 2500 m: it is not in metres"):
        GymWorld(Deep(np.float32(2500))).reset(episode(3))["depth"]
    for unit in (0, -1.0, float("nan"), "0.001", True):
        with pytest.raises(ValueError, match="unit must be a number of metres"):
            GymWorld(Deep(np.float32(2)), unit=unit)


def test_gym_world_requires_the_unit_of_normalised_depth():
    from mitigate.worlds.gym import GymWorld

    near = Deep(np.float32(0.25), most=1.0)
    with pytest.raises(ValueError, match=r"'depth' is 1, .*normalised.*Set unit="):
        GymWorld(near)
    for unit in (10, 1.0):
        world = GymWorld(near, unit=unit)
        assert np.allclose(world.reset(episode(3))["depth"], 0.25 * unit)
        assert world.sensors["depth"].high == unit


@pytest.mark.parametrize(("most", "far"), [(np.inf, np.inf), (8.0, 8.0)])
def test_env_world_keeps_the_maximum_of_depth(most, far):
    """If a space has no maximum, torchrl uses the largest number of the dtype."""
    from torchrl.envs import GymWrapper

    from mitigate.worlds.gym import GymWorld

    room = Deep(np.float32(2.5), most=most)
    back = EnvWorld(WorldEnv(GymWorld(room), [episode(3)]))
    for world in (GymWorld(room), EnvWorld(GymWrapper(room)), back):
        assert world.sensors["depth"].high == far
    missing = Corrupted(back, Corruption("missing_data", 0.6), 0).reset(episode(3))["depth"]
    assert missing.max() <= 10


def test_env_world_requires_a_reported_success():
    from mitigate.worlds.gym import GymWorld

    env = WorldEnv(GymWorld(Room("rgb"), success="won"), [episode(1)])
    with pytest.raises(ValueError, match=r"no entry 'won', only .*'rgb'"):
        run_episode(Brightness(), EnvWorld(env, success="won"), episode(1), CLEAN, 0)


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
def test_gym_world_replaces_invalid_depth(value):
    from mitigate.worlds.gym import GymWorld

    assert not GymWorld(Deep(np.float32(value))).reset(episode(3))["depth"].any()


@pytest.mark.parametrize("limit", [0, -3, 1.5, "3", True])
def test_gym_world_rejects_invalid_limits(limit):
    from mitigate.worlds.gym import GymWorld

    with pytest.raises(ValueError, match="limit must be a whole number of steps >= 1 or None"):
        GymWorld(Room(), limit=limit)


def test_gym_world_rejects_steps_after_the_end():
    from mitigate.worlds.gym import GymWorld

    world = GymWorld(Room(), limit=1)
    world.reset(episode(3))
    world.step(1)
    with pytest.raises(RuntimeError, match="over. Call reset"):
        world.step(1)


def test_gym_world_requires_frames():
    from mitigate.worlds.gym import GymWorld

    with pytest.raises(ValueError, match="it has camera"):
        GymWorld(Room("camera"))
    with pytest.raises(ValueError, match="uint8"):
        GymWorld(gymnasium.make("CartPole-v1"))


def test_env_world_runs_an_environment():
    """Convert a world to an environment and back."""
    listed = load_episodes("val_seen")[:1]
    world = EnvWorld(WorldEnv(ApartmentsWorld(SIZE), listed), **BY_REWARD)
    assert world.sensors[RGB].shape == (12, SIZE, SIZE, 3)

    class Stopper(Brightness):
        def act(self, observation):
            super().act(observation)
            return STOP

    agent = Stopper()
    measures = run_episode(agent, world, listed[0], Corruption("black_out", 1.0), 0)
    assert measures["steps"] == 1 and measures["success"] == 0 and agent.seen[0].max() == 0
    clean = ApartmentsWorld(SIZE).reset(listed[0])
    run_episode(agent, world, listed[0], CLEAN, 0)
    assert np.array_equal(agent.seen[0], clean[RGB]) and isinstance(clean, Observation)


def test_env_world_requires_the_named_frames():
    with pytest.raises(ValueError, match="no array pixels"):
        EnvWorld(WorldEnv(ApartmentsWorld(SIZE), load_episodes("val_seen")[:1]), {"rgb": "pixels"})


class Failing(Room):
    """An environment whose reset or step raises an error."""

    def __init__(self, call, error):
        super().__init__("rgb")
        self.call, self.error = call, error

    def reset(self, *, seed=None, options=None):
        if self.call == "reset":
            raise self.error
        return super().reset(seed=3 if seed is None else seed)

    def step(self, action):
        if self.call == "step":
            raise self.error
        return super().step(action)


@pytest.mark.parametrize("torchrl", [False, True])
@pytest.mark.parametrize("call", ["reset", "step"])
@pytest.mark.parametrize("error", [RuntimeError("no\nconnection"), KeyError("pose")], ids=repr)
def test_worlds_name_the_episode_of_an_error(torchrl, call, error):
    from torchrl.envs import GymWrapper

    from mitigate.worlds.gym import GymWorld

    room = Failing("none", error)
    world = EnvWorld(GymWrapper(room), **BY_REWARD) if torchrl else GymWorld(room, **BY_REWARD)
    room.call = call
    what = rf"{call}\(\) raised {type(error).__name__} in episode e3: .*raised in .*test_bridges.py"
    with pytest.raises(ValueError, match=what) as raised:
        run_episode(Brightness(), world, episode(3), CLEAN, 0)
    assert "\n" not in str(raised.value)
    cause = raised.value.__cause__
    assert error in (cause, cause.__cause__)


def test_worlds_name_the_episode_of_an_invalid_success():
    from mitigate.worlds.gym import GymWorld

    def fail(end):
        return end.info["wn"]

    for success, part in (
        (lambda end: 0.3, r"function must be .* at the end of episode e3, got 0.3"),
        (fail, r"function raised KeyError in episode e3: 'wn' \(raised in .*fail\(\)\)"),
    ):
        world = GymWorld(Room(), success=success, rule="anything")
        with pytest.raises(ValueError, match=part):
            run_episode(Brightness(), world, episode(3), CLEAN, 0)


class Changing(Room):
    """An environment whose ``step`` returns a tuple with one replaced element."""

    def __init__(self, place, value):
        super().__init__()
        self.place, self.value = place, value

    def step(self, action):
        answer = list(super().step(action))
        answer[self.place] = self.value
        return tuple(answer)


@pytest.mark.parametrize(
    ("place", "value", "part"),
    [
        (0, np.zeros((SIZE, SIZE, 3), np.float32), "must be uint8 .*got float32"),
        (0, np.zeros((SIZE, 8, 3), np.uint8), r"after step 1 of episode e3 must be .*16, 8, 3"),
        (1, float("nan"), "reward of step 1 of episode e3 must not be NaN"),
        (1, None, r"step\(\) raised TypeError in episode e3"),
        (4, None, r"step\(\) raised TypeError in episode e3"),
    ],
    ids=str,
)
def test_gym_world_rejects_invalid_step_results(place, value, part):
    from mitigate.worlds.gym import GymWorld

    with pytest.raises(ValueError, match=part):
        run_episode(
            Brightness(), GymWorld(Changing(place, value), **BY_REWARD), episode(3), CLEAN, 0
        )


def test_env_world_rejects_other_action_spaces():
    from torchrl.data import Binary, MultiOneHot

    env = WorldEnv(ApartmentsWorld(SIZE), load_episodes("val_seen")[:1])
    for spec in (Binary(4), MultiOneHot([2, 3])):
        env.action_spec = spec
        with pytest.raises(ValueError, match="must be Categorical, OneHot, MultiCategorical"):
            EnvWorld(env, **BY_REWARD)


def test_env_world_takes_the_action_spaces_of_torchrl():
    from torchrl.data import Bounded, MultiCategorical

    env = WorldEnv(ApartmentsWorld(SIZE), load_episodes("val_seen")[:1])
    env.action_spec = Bounded(-1, 1, shape=(2,))
    assert EnvWorld(env, **BY_REWARD).action_space.low.tolist() == [-1, -1]
    env.action_spec = MultiCategorical([2, 3])
    assert EnvWorld(env, **BY_REWARD).action_space.counts.tolist() == [2, 3]


@pytest.mark.parametrize("shape", [(), (1,)])
def test_env_world_accepts_categorical_actions(shape):
    from torchrl.data import Categorical

    listed = load_episodes("val_seen")[:1]
    env = WorldEnv(ApartmentsWorld(SIZE), listed)
    env.action_spec = Categorical(4, shape=shape)
    world = EnvWorld(env, **BY_REWARD)
    world.reset(listed[0])
    world.step(1)
    assert world.measures() == {"success": 0, "spl": 0.0, "return": 0.0, "steps": 1}


def test_env_world_runs_the_same_episode_as_gym_world():
    from torchrl.envs import GymWrapper

    from mitigate.worlds.gym import GymWorld
    from mitigate.worlds.seeded import seeded_episodes

    start = seeded_episodes([7])[0]
    frames = []
    for world in (
        GymWorld(Room("rgb"), **BY_REWARD),
        EnvWorld(GymWrapper(Room("rgb")), **BY_REWARD),
    ):
        frames.append([world.reset(start)["rgb"], world.step(1)["rgb"]])
    np.testing.assert_array_equal(*frames)


def test_hfov_of_a_world_lets_camera_faults_warp_its_frames():
    from mitigate.worlds.gym import GymWorld

    fault = Corruption("camera_roll", 0.6)

    def first(world) -> np.ndarray:
        return np.array(Corrupted(world, fault, 0).reset(episode(2))[RGB])

    frame = first(GymWorld(Room(), **BY_REWARD, hfov=90))
    assert (frame == 0).any() and (frame == 200).any(), "corners that the camera did not see are 0"
    env = WorldEnv(GymWorld(Room("rgb"), **BY_REWARD), [episode(2)])
    assert np.array_equal(first(EnvWorld(env, success="reward", hfov=90)), frame)
    with pytest.raises(ValueError, match="needs the horizontal field of view"):
        first(GymWorld(Room(), **BY_REWARD))
    with pytest.raises(ValueError, match="hfov must be above 0 and below 180 degrees, got 200"):
        GymWorld(Room(), hfov=200)
