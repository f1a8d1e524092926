"""Tests of the observation transformer for habitat-baselines, and of the sensor that gives it the
random key.

habitat-lab cannot be imported without its simulator, which is on no package index. The tests
therefore use a small replacement of the public interface of habitat-baselines.
"""

import dataclasses
import importlib
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import torch

from mitigate.corruptions import NAMES, DepthSensor, Schedule
from mitigate.worlds import habitat_baselines
from mitigate.worlds.habitat import corrupt_habitat


class Space:
    """The members of ``gym.spaces.Dict`` that the transformer uses."""

    def __init__(self, spaces: dict) -> None:
        self.spaces = spaces


def batch_of(*instants: dict) -> dict[str, torch.Tensor]:
    """Stack observations as habitat-baselines does."""
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


def test_transformer_equals_corrupt_habitat_per_row(batch):
    before = {entry: tensor.clone() for entry, tensor in batch.items()}
    schedule = Schedule("per_frame", 0.9, clean_share=0.0)
    transformer = habitat_baselines.CorruptObservation(schedule, 6, turn="right")
    out = transformer(batch)
    assert list(out) == [entry for entry in batch if entry != "corruption_key"]
    assert all(torch.equal(batch[entry], before[entry]) for entry in before)
    for row, (episode, frame) in enumerate(batch["corruption_key"].tolist()):
        corruption, key = schedule.draw(6, str(episode), frame)
        instant = {k: v[row].numpy() for k, v in batch.items() if k[0] in "rd"}
        expected = corrupt_habitat(instant, corruption, key, heading=0.5 * row, turn="right")
        for entry in instant:
            assert np.array_equal(out[entry][row].numpy(), expected[entry])
    assert any(not torch.equal(out[e], batch[e]) for e in out)


def test_transform_observation_space_removes_only_the_key():
    space = Space({"rgb": "box", "corruption_key": "box", "depth": "box"})
    transformer = habitat_baselines.CorruptObservation(Schedule.always("flare", 0.5))
    assert list(transformer.transform_observation_space(space).spaces) == ["rgb", "depth"]
    assert "corruption_key" in space.spaces


@pytest.mark.parametrize(
    ("entries", "parts"),
    [
        (
            ("rgb", "rgb_30", "compass"),
            ("camera named depth", "its entries are ['rgb', 'rgb_30', 'compass']"),
        ),
        (("rgb",), ("names=[motion_blur, low_light,", "foreign_object, black_out]")),
        (
            ("head_rgb", "head_depth"),
            ("its entries are ['head_rgb', 'head_depth']", "add or rename a camera"),
        ),
    ],
    ids=str,
)
def test_transformer_requires_the_corrupted_cameras(entries, parts):
    transformer = habitat_baselines.CorruptObservation.from_config({})
    batch = dict.fromkeys(entries, torch.zeros(2, 4, 4, 3, dtype=torch.uint8))
    batch["corruption_key"] = torch.zeros(2, 2, dtype=torch.int64)
    for call in (
        lambda: transformer.transform_observation_space(Space(dict(batch))),
        lambda: transformer(batch),
    ):
        with pytest.raises(ValueError, match="has no camera") as error:
            call()
        assert all(part in str(error.value) for part in parts) and "\n" not in str(error.value)
    clean = habitat_baselines.CorruptObservation.from_config({"mode": "clean"})
    assert list(clean(batch)) == list(entries)


def test_transformer_is_built_from_its_config():
    result = habitat_baselines.CorruptObservation.from_config(
        {"type": "CorruptObservation", "names": ["multipath"], "severity": 0.5, "depth_min": 0.5}
    )
    assert result.schedule.names == ("multipath",) and result.schedule.severity == 0.5
    assert result.sensor == DepthSensor(0.5, 10.0) and result.turn == "left"
    result = habitat_baselines.CorruptObservation.from_config(
        habitat_baselines.CorruptObservationConfig(seed=3)
    )
    assert result.seed == 3 and result.schedule.names == NAMES
    for config, part in (
        ({"severty": 0.5}, "Did you mean severity"),
        ({"severity": 1.5}, "from 0 .clean. to 1"),
        ({"depth_min": 5.0, "depth_max": 0.5}, "0 <= z_min < z_max"),
        ({"turn": "up"}, "turn must be"),
        ({"names": "low_light"}, r"names must be a list of corruptions, such as \['low_light'\]"),
    ):
        with pytest.raises(ValueError, match=part):
            habitat_baselines.CorruptObservation.from_config(config)


def test_transformer_explains_missing_keys(batch):
    transformer = habitat_baselines.CorruptObservation(Schedule.always("flare", 0.5))
    for wrong in (
        {k: v for k, v in batch.items() if k != "corruption_key"},
        {**batch, "corruption_key": batch["corruption_key"].float()},
    ):
        with pytest.raises(ValueError, match="to the task's lab_sensors"):
            transformer(wrong)


def test_key_depends_on_scene_episode_and_step():
    key = habitat_baselines.key_of("data/mp3d/x/x.glb", "7", 3)
    number = int(key[0])
    assert key.dtype == np.int64 and number > 0 and key[1] == 3
    assert int(habitat_baselines.key_of("/other/place/x.glb", 7, 0)[0]) == number
    assert int(habitat_baselines.key_of("x.glb", "8", 0)[0]) != number
    assert int(habitat_baselines.key_of("y.glb", "7", 0)[0]) != number


@pytest.fixture
def stand_in(monkeypatch):
    """Provide fake modules with the public names of habitat-lab and habitat-baselines 0.3 that the
    transformer uses."""
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

    def register(result, *, name):
        known[name] = result
        return result

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
        "gym": {"spaces": SimpleNamespace(Box=lambda *options: options)},
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


def test_import_registers_transformer_and_sensor(stand_in, batch):
    from hydra.core.config_store import ConfigStore

    known, base = stand_in
    module = importlib.reload(habitat_baselines)
    assert known["CorruptObservation"] is module.CorruptObservation
    assert issubclass(module.CorruptObservation, base)
    result = known["CorruptObservation"].from_config(module.CorruptObservationConfig(severity=1.0))
    assert "corruption_key" not in result(batch)
    sensor = known["CorruptionKeySensor"](sim=None, config=None)
    assert sensor.uuid == "corruption_key" and sensor.observation_space[2] == (2,)
    episode = SimpleNamespace(scene_id="x.glb", episode_id="7")
    seen = [
        sensor.get_observation(observations={}, episode=episode, task=None, **action)
        for action in ({}, {"action": 1}, {"action": 1}, {})
    ]
    assert seen[0].tolist() == module.key_of("x.glb", 7, 0).tolist()
    assert [int(key[1]) for key in seen] == [0, 1, 2, 0] and len({int(key[0]) for key in seen}) == 1
    store = ConfigStore.instance()
    assert "corruption_key.yaml" in store.list("habitat/task/lab_sensors")
    group = "habitat_baselines/rl/policy/obs_transforms"
    assert "corrupt_observation.yaml" in store.list(group)
