"""Habitat's dictionaries: cameras as one panorama, and the observation transformer.

habitat-lab does not import without its simulator, which no package registry has, so the transformer
meets a small stand-in of habitat-baselines' public interface here.
"""

import dataclasses
import importlib
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import torch

from mitigate.corruptions import NAMES, RGB, Corruption, DepthSensor, Key, Schedule, corrupt
from mitigate.envs import habitat_baselines
from mitigate.envs.habitat import corrupt_habitat

KEY = Key(2, "71", 4)


@pytest.fixture(scope="module")
def panorama():
    """RGB uint8 [12, 32, 32, 3], and depth of another size in [0, 1] with holes."""
    rng = np.random.default_rng(0)
    depth = rng.uniform(0.06, 0.4, (12, 40, 48, 1)).astype(np.float32)
    depth[:, :3, :5] = 0.0
    return rng.integers(20, 230, (12, 32, 32, 3), dtype=np.uint8), depth


@pytest.fixture
def obs(panorama):
    """As ETPNav has it: rgb_A looks A degrees to the left, so at view 12 - A / 30."""
    rgb, depth = panorama
    entries = {"instruction": "go", "rgb": rgb[0], "depth": depth[0]}
    for step in range(1, 12):
        entries[f"rgb_{30 * step}"] = rgb[-step]
        entries[f"depth_{30 * step}"] = depth[-step]
    return entries | {"rgb_features": np.ones(3), "depth_scale": 2}


def test_the_cameras_are_the_panorama_of_the_suite(obs, panorama):
    for name in RGB:
        out = corrupt_habitat(obs, Corruption(name, 0.9), KEY, heading=0.4)
        wanted = corrupt(panorama[0], name, 0.9, key=KEY, heading=0.4)
        assert np.array_equal(out["rgb"], wanted[0])
        for step in range(1, 12):
            assert np.array_equal(out[f"rgb_{30 * step}"], wanted[-step])


@pytest.mark.parametrize("name", NAMES)
def test_entries_order_dtype_shape_and_range_stay(obs, name):
    before = {k: v.tobytes() for k, v in obs.items() if isinstance(v, np.ndarray)}
    out = corrupt_habitat(obs, Corruption(name, 1.0), KEY, DepthSensor(0.5, 5.0))
    hurt = "rgb" if name in RGB else "depth"
    assert list(out) == list(obs) and out is not obs
    changed = 0
    for entry, value in obs.items():
        if entry.partition("_")[0] == hurt and entry[-1] in "bh0":
            assert out[entry].shape == value.shape and out[entry].dtype == value.dtype
            changed += not np.array_equal(out[entry], value)
        else:
            assert out[entry] is value
        if entry in before:
            assert value.tobytes() == before[entry]
    assert changed >= (3 if name == "flare" else 12)
    depth = np.stack([v for k, v in out.items() if k.startswith("depth") and k[-1] in "h0"])
    assert depth.min() >= 0 and depth.max() <= 1
    clean = np.stack([v for k, v in obs.items() if k.startswith("depth") and k[-1] in "h0"])
    assert (depth[clean == 0] == 0).all()  # holes stay holes


def test_the_turning_sense_decides_which_cameras_see_a_flare(obs):
    flare = Corruption("flare", 1.0)

    def lit(turn):
        out = corrupt_habitat(obs, flare, KEY, heading=2.5, turn=turn)
        return {int(e[4:] or 0) for e in RGB_CAMERAS if not np.array_equal(out[e], obs[e])}

    left, right = lit("left"), lit("right")
    assert left != right and left == {-angle % 360 for angle in right}


RGB_CAMERAS = ["rgb", *(f"rgb_{30 * step}" for step in range(1, 12))]


def test_a_camera_turned_left_sees_a_light_that_the_agent_sees_after_a_left_turn(panorama):
    frame = panorama[0][0]
    flare = Corruption("flare", 1.0)
    for episode in range(6):
        key = Key(0, str(episode))
        ahead = corrupt_habitat({"rgb": frame}, flare, key, heading=0.2 + np.pi / 2)["rgb"]
        left = corrupt_habitat({"rgb": frame, "rgb_90": frame}, flare, key, heading=0.2)["rgb_90"]
        assert np.array_equal(ahead, left)


def test_a_few_cameras_get_what_the_whole_panorama_gives_them(obs):
    some = {entry: obs[entry] for entry in ("rgb", "rgb_90", "depth_270", "depth_30")}
    for name in NAMES:
        hurt = Corruption(name, 0.8)
        all_of_them, few = corrupt_habitat(obs, hurt, KEY), corrupt_habitat(some, hurt, KEY)
        assert all(np.array_equal(few[entry], all_of_them[entry]) for entry in some)


def test_wrong_observations_are_explained(obs):
    hurt = Corruption("spatter", 0.5)
    small = {**obs, "rgb_60": obs["rgb_60"][:4]}
    for given, part in (
        ({"rgb": obs["rgb"], "rgb_45": obs["rgb"]}, "'rgb_45' is not at a multiple of 30"),
        ({"rgb_360": obs["rgb"]}, "'rgb_360' is not at a multiple"),
        (small, "must be alike, but 'rgb' is uint8.*'rgb_60'"),
        ({"depth": obs["depth"]}, "does not hold"),
        ({"rgb": obs["rgb"][None]}, "one instant of one environment"),
        ({"rgb": obs["rgb"] / np.float32(255)}, "RGB frames must be uint8"),
    ):
        with pytest.raises(ValueError, match=part):
            corrupt_habitat(given, hurt, KEY)
    with pytest.raises(ValueError, match="turn must be 'left' or 'right'"):
        corrupt_habitat(obs, hurt, KEY, turn="clockwise")
    with pytest.raises(ValueError, match="reaches 4"):
        corrupt_habitat(
            {"depth": np.full((4, 4, 1), 4, np.float32)}, Corruption("multipath", 1), KEY
        )


# ------------------------------------------------------------------------------- the transformer


class Space:
    """What the transformer needs of a ``gym.spaces.Dict``."""

    def __init__(self, spaces: dict) -> None:
        self.spaces = spaces


def batch_of(*instants: dict) -> dict[str, torch.Tensor]:
    """As habitat-baselines batches them."""
    stacked = {e: np.stack([i[e] for i in instants]) for e in instants[0]}
    return {entry: torch.from_numpy(array) for entry, array in stacked.items()}


@pytest.fixture
def batch(obs):
    frames = {k: v for k, v in obs.items() if k[-1] in "bh0"}
    return batch_of(
        *(
            {
                **frames,
                "compass": np.array([0.5 * n], np.float32),
                "corruption_key": habitat_baselines.key_of(f"data/{n}.glb", n, 3 * n),
            }
            for n in range(3)
        )
    )


def test_the_transformer_does_to_each_row_what_the_function_does(batch):
    before = {entry: tensor.clone() for entry, tensor in batch.items()}
    schedule = Schedule("per_frame", 0.9, clean_share=0.0)
    transformer = habitat_baselines.CorruptObservation(schedule, 6, turn="right")
    out = transformer(batch)
    assert list(out) == [entry for entry in batch if entry != "corruption_key"]
    assert all(torch.equal(batch[entry], before[entry]) for entry in before)
    for row, (episode, frame) in enumerate(batch["corruption_key"].tolist()):
        corruption, key = schedule.draw(6, str(episode), frame)
        instant = {k: v[row].numpy() for k, v in batch.items() if k[0] in "rd"}
        wanted = corrupt_habitat(instant, corruption, key, heading=0.5 * row, turn="right")
        for entry in instant:
            assert np.array_equal(out[entry][row].numpy(), wanted[entry])
    assert any(not torch.equal(out[e], batch[e]) for e in out)


def test_the_observation_space_loses_the_key_alone():
    space = Space({"rgb": "box", "corruption_key": "box", "depth": "box"})
    transformer = habitat_baselines.CorruptObservation(Schedule.always("flare", 0.5))
    assert list(transformer.transform_observation_space(space).spaces) == ["rgb", "depth"]
    assert "corruption_key" in space.spaces


def test_it_is_built_from_its_config():
    made = habitat_baselines.CorruptObservation.from_config(
        {"type": "CorruptObservation", "names": ["multipath"], "severity": 0.5, "depth_min": 0.5}
    )
    assert made.schedule.names == ("multipath",) and made.schedule.severity == 0.5
    assert made.sensor == DepthSensor(0.5, 10.0) and made.turn == "left"
    made = habitat_baselines.CorruptObservation.from_config(
        habitat_baselines.CorruptObservationConfig(seed=3)
    )
    assert made.seed == 3 and made.schedule.names == NAMES
    for config, part in (
        ({"severty": 0.5}, "Did you mean 'severity'"),
        ({"severity": 1.5}, "from 0 .clean. to 1"),
        ({"depth_min": 5.0, "depth_max": 0.5}, "no range"),
        ({"turn": "up"}, "turn must be"),
    ):
        with pytest.raises(ValueError, match=part):
            habitat_baselines.CorruptObservation.from_config(config)


def test_a_batch_without_keys_is_explained(batch):
    transformer = habitat_baselines.CorruptObservation(Schedule.always("flare", 0.5))
    for wrong in (
        {k: v for k, v in batch.items() if k != "corruption_key"},
        {**batch, "corruption_key": batch["corruption_key"].float()},
    ):
        with pytest.raises(ValueError, match="to the task's lab_sensors"):
            transformer(wrong)


def test_the_key_names_scene_episode_and_step_and_counts_from_each_reset():
    episode = SimpleNamespace(scene_id="data/mp3d/x/x.glb", episode_id="7")
    steps = habitat_baselines.EpisodeSteps()
    seen = [steps.key(episode), steps.key(episode, action=1), steps.key(episode, action=1)]
    seen += [steps.key(episode)]
    assert [int(k[1]) for k in seen] == [0, 1, 2, 0] and len({int(k[0]) for k in seen}) == 1
    number = int(seen[0][0])
    assert seen[0].dtype == np.int64 and number > 0
    assert int(habitat_baselines.key_of("/other/place/x.glb", 7, 0)[0]) == number
    assert int(habitat_baselines.key_of("x.glb", "8", 0)[0]) != number
    assert int(habitat_baselines.key_of("y.glb", "7", 0)[0]) != number


@pytest.fixture
def stand_in(monkeypatch):
    """Modules with the public names of habitat-lab and habitat-baselines 0.3 that are used."""
    known = {}

    class ObservationTransformer(torch.nn.Module):
        @classmethod
        def from_config(cls, config):
            raise NotImplementedError

    class Sensor:
        def __init__(self, *args, **kwargs):
            self.uuid = self._get_uuid(*args, **kwargs)
            self.sensor_type = self._get_sensor_type(*args, **kwargs)
            self.observation_space = self._get_observation_space(*args, **kwargs)

    @dataclasses.dataclass
    class TypedConfig:
        type: str = "?"

    def register(made, *, name):
        known[name] = made
        return made

    contents = {
        "habitat_baselines.common.baseline_registry": {
            "baseline_registry": SimpleNamespace(register_obs_transformer=register)
        },
        "habitat_baselines.common.obs_transformers": {
            "ObservationTransformer": ObservationTransformer
        },
        "habitat_baselines.config.default_structured_configs": {"ObsTransformConfig": TypedConfig},
        "habitat.config.default_structured_configs": {"LabSensorConfig": TypedConfig},
        "habitat.core.registry": {"registry": SimpleNamespace(register_sensor=register)},
        "habitat.core.simulator": {
            "Sensor": Sensor,
            "SensorTypes": SimpleNamespace(TENSOR="tensor"),
        },
        "gym": {"spaces": SimpleNamespace(Box=lambda *given: given)},
    }
    for path, names in contents.items():
        parts = path.split(".")
        for end in range(1, len(parts) + 1):
            name = ".".join(parts[:end])
            if name not in sys.modules or name == path:
                monkeypatch.setitem(sys.modules, name, ModuleType(name))
        vars(sys.modules[path]).update(names)
    yield known, ObservationTransformer
    monkeypatch.undo()
    importlib.reload(habitat_baselines)


def test_transformer_and_sensor_are_registered_where_habitat_is_installed(stand_in, batch):
    from hydra.core.config_store import ConfigStore

    known, base = stand_in
    module = importlib.reload(habitat_baselines)
    assert known["CorruptObservation"] is module.CorruptObservation
    assert issubclass(module.CorruptObservation, base)
    made = known["CorruptObservation"].from_config(module.CorruptObservationConfig(severity=1.0))
    assert "corruption_key" not in made(batch)
    sensor = known["CorruptionKeySensor"](sim=None, config=None)
    assert sensor.uuid == "corruption_key" and sensor.observation_space[2] == (2,)
    episode = SimpleNamespace(scene_id="x.glb", episode_id="7")
    first = sensor.get_observation(observations={}, episode=episode, task=None)
    second = sensor.get_observation(observations={}, episode=episode, task=None, action={})
    assert first.tolist() == module.key_of("x.glb", 7, 0).tolist() and second[1] == 1
    store = ConfigStore.instance()
    assert "corruption_key.yaml" in store.list("habitat/task/lab_sensors")
    group = "habitat_baselines/rl/policy/obs_transforms"
    assert "corrupt_observation.yaml" in store.list(group)
