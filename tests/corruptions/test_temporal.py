"""Tests of temporal faults: their properties, and that all entry points give equal frames."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from mitigate.bridge.cameras import Rig
from mitigate.core import conf
from mitigate.core.observation import DEPTH, POSE, RGB, Observation, cameras
from mitigate.corruptions import (
    Corruption,
    DepthSensor,
    FrameStream,
    Key,
    Schedule,
    corrupt,
    corrupt_observation,
    folders,
    frame_files,
    registry,
)
from mitigate.corruptions.faults import temporal
from mitigate.corruptions.folders import Settings
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.grid import by_kind, kind
from mitigate.worlds.episodes import Episode, Instruction
from mitigate.worlds.habitat import corrupt_habitat
from mitigate.worlds.world import Corrupted, World

STEPS = 45
NAMES = registry.fault_names("temporal")
SUITE = list(conf.load_config("evaluate", ["suite=temporal"]).suite.conditions)[1:]


def instant(number: int) -> dict[str, np.ndarray]:
    """Return frames that contain their time step: RGB pixels equal ``number``, and depth is 1 +
    ``number`` / 16 metres."""
    depth = np.full((2, 6, 8, 1), 1.0 + number / 16, np.float32)
    depth[:, 0] = 0.0  # no reading
    pose = np.array([0.0, 0.0, 0.1 * number], np.float32)
    return {RGB: np.full((2, 6, 8, 3), number, np.uint8), DEPTH: depth, POSE: pose}


def run(name: str, severity: float = 0.6, episode: str = "5-0", seed: int = 3) -> list[dict]:
    stream = FrameStream()
    corruption = Corruption(name, severity)
    return [stream.corrupt(instant(i), corruption, Key(seed, episode, i)) for i in range(STEPS)]


def shown(name: str, severity: float = 0.6, entry: str = RGB, **key) -> list[int]:
    """Return, for each frame, the index of the time step that it shows."""
    frames = [frames[entry][:, 1:] for frames in run(name, severity, **key)]
    assert all((frame == frame.flat[0]).all() for frame in frames)
    scale = 1.0 if entry == RGB else 16.0
    offset = 0.0 if entry == RGB else 1.0
    return [round((float(frame.flat[0]) - offset) * scale) for frame in frames]


# ------------------------------------------------------------------------------------ properties


def test_suite_lists_every_fault_and_intermittent_pairs():
    alone = [name for name in SUITE if registry.AND not in name]
    assert alone == [name for name in NAMES if name != temporal.GATE]
    assert all(name.startswith("intermittent+") for name in SUITE[len(alone) :])
    assert {kind(name) for name in SUITE} == {"temporal faults"}
    assert all(registry.version(name) for name in SUITE)


@pytest.mark.parametrize("name", SUITE)
def test_fault_at_severity_zero_is_the_identity(name):
    for number, frames in enumerate(run(name, 0.0)):
        for entry, clean in instant(number).items():
            assert np.array_equal(frames[entry], clean)


@pytest.mark.parametrize("name", SUITE)
def test_fault_does_not_change_its_input_and_repeats_itself(name):
    stream = FrameStream()
    for _ in range(2):
        for number, expected in enumerate(run(name)):
            obs = instant(number)
            frames = stream.corrupt(obs, Corruption(name, 0.6), Key(3, "5-0", number))
            assert all(np.array_equal(obs[entry], instant(number)[entry]) for entry in obs)
            assert all(np.array_equal(frames[entry], expected[entry]) for entry in obs)


@pytest.mark.parametrize("severity, frames", [(0.2, 1), (0.6, 3), (1.0, temporal.DELAY)])
def test_frame_delay_shows_both_sensors_late(severity, frames):
    late = [max(0, number - frames) for number in range(STEPS)]
    assert shown("frame_delay", severity) == shown("frame_delay", severity, DEPTH) == late


def test_depth_lag_delays_depth_only():
    assert shown("depth_lag") == list(range(STEPS))
    assert shown("depth_lag", entry=DEPTH) == [max(0, number - 3) for number in range(STEPS)]


@pytest.mark.parametrize(
    "name, period, longest",
    [
        ("frozen_frame", temporal.FREEZE_PERIOD, temporal.LONGEST_FREEZE),
        ("repeated_frames", temporal.BURST_PERIOD, temporal.LONGEST_BURST),
    ],
)
def test_frozen_frames_repeat_the_last_one_and_recover(name, period, longest):
    previous: set[int] = set()
    for severity in (0.2, 0.6, 1.0):
        numbers = shown(name, severity)
        frozen = {i for i in range(1, STEPS) if numbers[i] != i}
        assert all(numbers[i] == numbers[i - 1] for i in frozen)
        # the freeze at a higher severity contains the freeze at the lower severity
        assert previous <= frozen
        previous = frozen
    share = np.mean([len({*range(STEPS)} - {*shown(name, 1.0, seed=s)}) for s in range(20)]) / STEPS
    assert share == pytest.approx(longest / period, abs=0.1)


def test_dropped_frames_are_black_in_the_bursts_of_repeated_frames():
    repeated = [i for i, number in enumerate(shown("repeated_frames")) if number != i]
    for number, frames in enumerate(run("dropped_frames")):
        lost = number in repeated
        if number:  # frame 0 can be lost, but there is no earlier frame that could be repeated
            assert lost == (not frames[RGB].any()) == (not frames[DEPTH].any())


def test_dropped_depth_reads_as_missing_but_invalid_depth_stays():
    key = next(k for k in (Key(3, "5-0", i) for i in range(9)) if temporal.repeated_frames(1.0, k))
    stream = FrameStream(DepthSensor(missing=10.0))
    depth = stream.corrupt(instant(1), Corruption("dropped_frames", 1.0), key)[DEPTH]
    assert (depth[:, 0] == 0).all() and (depth[:, 1:] == 10.0).all()


def test_exposure_flicker_changes_each_frame_alike_in_all_views():
    clean = np.full((2, 6, 8, 3), 100, np.uint8)
    gains = set()
    for number in range(20):
        key = Key(0, "e", number)
        weak, strong = (corrupt(clean, "exposure_flicker", s, key=key) for s in (0.3, 1.0))
        assert (strong == strong.flat[0]).all()
        assert abs(int(strong.flat[0]) - 100) >= abs(int(weak.flat[0]) - 100)
        gains.add(int(strong.flat[0]))
    assert min(gains) < 70 and max(gains) > 140 and len(gains) > 15


def test_intermittent_limits_the_second_corruption_to_intervals():
    active = []
    for number, frames in enumerate(run("intermittent+foreign_object")):
        key = Key(3, "5-0", number)
        constant = corrupt_observation(instant(number), Corruption("foreign_object", 0.6), key)
        clean = np.array_equal(frames[RGB], instant(number)[RGB])
        assert clean or np.array_equal(frames[RGB], constant[RGB])
        active.append(not clean)
    assert 0.3 < np.mean(active[1:]) < 0.7
    assert np.abs(np.diff(np.array(active[1:], int))).sum() <= 5  # intervals, not single frames


def test_delayed_frame_keeps_the_noise_and_heading_of_its_instant():
    noisy = run("low_light_noise+frame_delay")
    for number in range(3, STEPS):
        key = Key(3, "5-0", number - 3)
        then = corrupt_observation(instant(number - 3), Corruption("low_light_noise", 0.6), key)
        assert np.array_equal(noisy[number][RGB], then[RGB])
        assert np.array_equal(noisy[number][POSE], instant(number)[POSE])  # poses are not delayed
    other = run("frame_delay+low_light_noise")
    assert all(np.array_equal(a[RGB], b[RGB]) for a, b in zip(noisy, other, strict=True))


def test_stream_forgets_earlier_episodes():
    stream, delay = FrameStream(), Corruption("frame_delay", 1.0)
    for number in range(8):
        stream.corrupt(instant(50 + number), delay, Key(0, "a", number))
    assert stream.corrupt(instant(9), delay, Key(0, "b", 0))[RGB].flat[0] == 9
    assert stream.corrupt(instant(7), delay, Key(0, "b", 0))[RGB].flat[0] == 7  # run again


def test_stream_keeps_few_frames():
    stream = FrameStream()
    for number in range(100):
        stream.remember(instant(number), Key(0, "a", number))
    assert len(stream._past[RGB]) == temporal.OLDEST + 1


# ---------------------------------------------------------------------------------- entry points


class Numbered(World):
    """A world whose observation n is ``instant(n)``."""

    sensors = cameras(8, 2)
    done = False
    rule = "none"

    def reset(self, episode):
        self.number = 0
        return self._observe()

    def step(self, action):
        self.number += 1
        return self._observe()

    def _observe(self):
        obs = instant(self.number)
        return Observation({POSE: obs[POSE]}, lambda: obs, (RGB, DEPTH))


def episode(name: str) -> Episode:
    origin = (0.0, 0.0, 0.0)
    words = Instruction("walk")
    return Episode(name, name, "scene", origin, (*origin, 1.0), (), words, ())


def in_a_world(name, every: int = 1):
    world = Corrupted(Numbered(), Corruption(name, 0.6), 3)
    observation = world.reset(episode("5-0"))
    for number in range(STEPS):
        if number % every == 0:
            yield number, observation
        observation = world.step(0)


def in_gymnasium(name):
    gymnasium = pytest.importorskip("gymnasium")
    from mitigate.worlds.wrappers import CorruptObservation

    class Env(gymnasium.Env):
        action_space = gymnasium.spaces.Discrete(2)
        observation_space = gymnasium.spaces.Dict(
            {
                RGB: gymnasium.spaces.Box(0, 255, (2, 6, 8, 3), np.uint8),
                DEPTH: gymnasium.spaces.Box(0, 10, (2, 6, 8, 1), np.float32),
                POSE: gymnasium.spaces.Box(-9, 9, (3,), np.float32),
            }
        )

        def reset(self, *, seed=None, options=None):
            self.number = 0
            return instant(0), {}

        def step(self, action):
            self.number += 1
            return instant(self.number), 0.0, False, False, {}

    env = CorruptObservation(Env(), Corruption(name, 0.6), 3, pose=POSE)
    yield 0, env.reset(seed=5)[0]
    for number in range(1, STEPS):
        yield number, env.step(0)[0]


def in_torchrl(name):
    pytest.importorskip("torchrl")
    from torchrl.envs import SerialEnv, TransformedEnv

    from mitigate.worlds.tensordict import WorldEnv
    from mitigate.worlds.transforms import CorruptObservation

    def env(number):
        return lambda: WorldEnv(Sized(), [episode("5-0"), episode("6-0")][number:])

    class Sized(Numbered):
        sensors = {
            name: type(sensor)(sensor.kind, (2, 6, 8, sensor.shape[-1]), sensor.dtype)
            if len(sensor.shape) > 1
            else sensor
            for name, sensor in Numbered.sensors.items()
        }

        def measures(self):
            return {"success": 0.0, "spl": 0.0}

    envs = SerialEnv(2, [env(1), env(0)])
    transformed = TransformedEnv(envs, CorruptObservation(Corruption(name, 0.6), 3))
    data = transformed.reset()
    for number in range(STEPS):
        yield number, {entry: data[entry][1].numpy() for entry in (RGB, DEPTH)}
        data["action"] = transformed.action_spec.zero() + 1
        data = transformed.step(data)["next"]


def in_the_bridge(name):
    shapes = {RGB: [6, 8, 3], DEPTH: [6, 8, 1]}
    described = [
        {
            "name": f"{kind}{suffix}",
            "type": kind,
            "shape": shapes[kind],
            "dtype": "uint8" if kind == RGB else "float32",
        }
        for kind in (RGB, DEPTH)
        for suffix in ("", "_330")  # the camera at Habitat's yaw 330 is view 1
    ]
    rig = Rig(described)
    offsets, size = rig.lay_out((RGB, DEPTH))
    memory = bytearray(size)
    for number in range(STEPS):
        obs = instant(number)
        for camera in rig.cameras:
            frame = np.ascontiguousarray(obs[camera.kind][int(camera.name.endswith("330"))])
            start = offsets[camera.name]
            memory[start : start + camera.bytes] = frame.tobytes()
        key = Key(3, "5-0", number)
        rig.corrupt(memory, offsets, Corruption(name, 0.6), key, float(obs[POSE][2]))
        by_name = {camera.name: camera.read(memory, offsets) for camera in rig.cameras}
        yield (
            number,
            {kind: np.stack([by_name[kind], by_name[f"{kind}_330"]]) for kind in (RGB, DEPTH)},
        )


@pytest.mark.parametrize("name", SUITE)
def test_all_entry_points_give_equal_frames(name):
    expected = run(name)
    for entry_point in (in_a_world, in_gymnasium, in_torchrl, in_the_bridge):
        count = 0
        for number, frames in entry_point(name):
            for entry in (RGB, DEPTH):
                same = np.array_equal(frames[entry], expected[number][entry])
                assert same, (entry_point.__name__, number, entry)
            count += 1
        assert count == STEPS


@pytest.mark.parametrize("name", ["frozen_frame", "frame_delay", "intermittent+spatter"])
def test_corrupted_world_shows_the_frames_of_steps_that_were_not_read(name):
    expected = run(name)
    for number, frames in in_a_world(name, every=7):
        assert np.array_equal(frames[RGB], expected[number][RGB])


@pytest.mark.parametrize("name", SUITE)
def test_folder_of_files_gets_equal_frames_and_resumes(name, tmp_path):
    stream = FrameStream()
    (tmp_path / "in/5-0").mkdir(parents=True)
    expected = []
    for number in range(STEPS):
        obs = {RGB: instant(number)[RGB][0], DEPTH: instant(number)[DEPTH][0]}
        Image.fromarray(obs[RGB]).save(tmp_path / f"in/5-0/rgb{number}.png")
        np.save(tmp_path / f"in/5-0/depth{number}.npy", obs[DEPTH])
        expected.append(stream.corrupt(obs, Corruption(name, 0.6), Key(3, "5-0", number)))
    settings = Settings(name, 0.6, seed=3)
    summary = folders.run(tmp_path / "in", tmp_path / "out", settings)
    changes = Corruption(name, 0.6).modalities
    assert summary["written"] == STEPS * len(changes) and not summary["left_out"]
    for number in (4, 17, 18, 30):
        (tmp_path / f"out/5-0/{'rgb' if RGB in changes else 'depth'}{number}").with_suffix(
            ".png" if RGB in changes else ".npy"
        ).unlink()
    assert folders.run(tmp_path / "in", tmp_path / "out", settings)["written"] == 4
    for number in range(STEPS):
        for entry, suffix in ((RGB, "png"), (DEPTH, "npy")):
            if entry in changes:
                frame = frame_files.read(tmp_path / f"out/5-0/{entry}{number}.{suffix}", 0.001)
                assert np.array_equal(frame, expected[number][entry])


# ---------------------------------------------------------------------------------------- errors


def test_faults_are_rejected_where_they_cannot_apply():
    frame = np.zeros((6, 8, 3), np.uint8)
    with pytest.raises(ValueError, match="FrameStream"):
        corrupt(frame, "frozen_frame", 0.5, key=0)
    with pytest.raises(ValueError, match="FrameStream"):
        corrupt_observation({RGB: frame}, Corruption("intermittent+spatter", 0.5), 0)
    with pytest.raises(ValueError, match="training schedules do not sample faults"):
        Schedule("per_episode", 0.5, names=("frozen_frame",))
    with pytest.raises(ValueError, match="corrupt_habitat does not support faults"):
        corrupt_habitat({RGB: frame}, Corruption("frame_delay", 0.5), Key(0, "e"))
    for pair in ("spatter+intermittent", "intermittent+frozen_frame", "intermittent+mask"):
        with pytest.raises(ValueError, match="must be the first name of a pair"):
            Corruption(pair, 0.5)
    for check in (
        lambda: conditions(["intermittent"], 0.5, None),
        lambda: Settings("intermittent", 0.5),
        lambda: FrameStream().corrupt({RGB: frame}, Corruption("intermittent", 0.5), 0),
    ):
        with pytest.raises(ValueError, match="must be the first name of a pair"):
            check()
    with pytest.raises(ValueError, match="same shape"):
        stream = FrameStream()
        stream.remember({RGB: frame}, Key(0, "e", 0))
        stream.remember({RGB: frame[1:]}, Key(0, "e", 1))


def test_replay_buffer_rejects_a_temporal_fault():
    pytest.importorskip("torchrl")
    from tensordict import TensorDict

    from mitigate.worlds.transforms import CorruptObservation

    with pytest.raises(ValueError, match="replay buffer"):
        CorruptObservation(Corruption("frame_delay", 0.5)).forward(TensorDict({}, [2]))


def test_fault_of_both_sensors_needs_one_of_them():
    met = [Corruption("frozen_frame", 0.6)]
    check_sensors(met, [RGB], "world")
    check_sensors(met, [DEPTH], "world")
    with pytest.raises(ValueError, match="The suite contains frozen_frame"):
        check_sensors(met, ["state"], "world")
    assert [c.severity for c in conditions(["frozen_frame", "depth_lag"], 0.6, 0.4)] == [0.6, 0.4]


def test_rows_of_faults_have_their_own_table():
    row = {"split": "s", "suite": "1.1", "rule": "r", "name": "n", "agent": "a"}
    rows = [row | {"corruption": name} for name in ("clean", "frozen_frame", "spatter")]
    tables = by_kind(rows)
    assert {n: [r["corruption"] for r in t] for n, t in tables.items()} == {
        "": ["clean", "spatter"],
        "temporal faults": ["clean", "frozen_frame"],
    }
