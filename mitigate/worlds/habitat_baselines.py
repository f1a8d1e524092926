"""An observation transformer for habitat-baselines that corrupts frames, and the sensor that
provides its random keys.

If habitat-lab and habitat-baselines are installed, importing this module registers both classes. If
not, the transformer is a plain torch module with the same three methods.

habitat-baselines passes only a batch of frames to a transformer, but not the episode, the step or
the mask. The lab sensor ``CorruptionKeySensor`` therefore adds the entry ``corruption_key`` to
every observation. The transformer removes it, so the policy does not receive it.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch

from mitigate.core.names import unknown
from mitigate.corruptions import NAMES, DepthSensor, Key, Schedule
from mitigate.corruptions.keying import digest
from mitigate.corruptions.normalised import check_sensor
from mitigate.worlds.habitat import check_cameras, check_turn, is_camera
from mitigate.worlds.habitat_tensors import corrupt_habitat_tensors

try:
    from habitat_baselines.common.baseline_registry import baseline_registry
    from habitat_baselines.common.obs_transformers import ObservationTransformer
    from habitat_baselines.config.default_structured_configs import ObsTransformConfig
except ImportError:
    baseline_registry = None
    ObservationTransformer = torch.nn.Module
    ObsTransformConfig = object

KEY = "corruption_key"
# names of the sensors that measure the heading (in radians, counter-clockwise)
_HEADINGS = ("compass", "heading")


class CorruptObservation(ObservationTransformer):
    """Corrupt the cameras of a batch of Habitat observations (see ``corrupt_habitat``).

    A batch must contain ``corruption_key`` (int64 [B, 2], from ``CorruptionKeySensor``), and may
    contain ``rgb*`` (uint8 [B, H, W, 3]) and ``depth*`` (float32 [B, H, W, 1] in [0, 1]). Tensors
    on a GPU are corrupted on the GPU. If a ``compass`` or ``heading`` sensor is present, a lens
    flare keeps its direction in the world when the agent turns.

    Args:
        schedule: The schedule that selects the corruption of each frame.
        seed: Corruption seed.
        sensor: Depth range, and the value that marks missing depth.
        turn: Direction from ``rgb`` to ``rgb_30``: "left" (ETPNav) or "right".

    Raises:
        ValueError: If the observation space or a batch has no camera that a corruption of the
            schedule can change. ``forward`` also raises it if ``corruption_key`` is missing, or if
            ``corrupt_habitat`` raises it.
    """

    def __init__(
        self,
        schedule: Schedule,
        seed: int = 0,
        *,
        sensor: DepthSensor | None = None,
        turn: str = "left",
    ) -> None:
        super().__init__()
        self.schedule = schedule
        self.seed = seed
        self.turn = turn
        self.sensor = sensor or DepthSensor()
        check_sensor(self.sensor)
        check_turn(turn)

    @classmethod
    def from_config(cls, config: Any) -> CorruptObservation:
        """Build the transformer from a ``CorruptObservationConfig``, or from a mapping that
        contains some of its entries.

        Raises:
            ValueError: If the mapping has an unknown entry.
        """
        entries = dict(config) if isinstance(config, Mapping) else dict(vars(config))
        known = [field.name for field in fields(CorruptObservationConfig)]
        for name in entries:
            if name not in known:
                raise ValueError(
                    unknown("option of CorruptObservation", name, known)
                    + " Pass only the transformer's part of the config."
                )
        options = CorruptObservationConfig(**entries)
        schedule = Schedule(
            options.mode,
            options.severity,
            options.severity_depth,
            clean_share=options.clean_share,
            names=options.names or NAMES,
        )
        sensor = DepthSensor(options.depth_min, options.depth_max, options.depth_missing)
        return cls(schedule, options.seed, sensor=sensor, turn=options.turn)

    def transform_observation_space(self, observation_space: Any, **kwargs: Any) -> Any:
        """Return a copy of the observation space without the entry ``corruption_key``."""
        space = copy.deepcopy(observation_space)
        space.spaces.pop(KEY, None)
        self._check(space.spaces)
        return space

    @torch.no_grad()
    def forward(self, observations: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        """Return a new batch in which the camera frames are corrupted and ``corruption_key`` is
        removed.
        """
        keys = _keys(observations)
        self._check(observations)
        heading = next((observations[h] for h in _HEADINGS if h in observations), None)
        drawn = [self.schedule.draw(self.seed, str(episode), frame) for episode, frame in keys]
        corrupted = corrupt_habitat_tensors(
            observations,
            [corruption for corruption, _ in drawn],
            [key for _, key in drawn],
            self.sensor,
            headings=None if heading is None else heading.reshape(len(keys), -1)[:, 0].tolist(),
            turn=self.turn,
        )
        out = copy.copy(observations)
        del out[KEY]
        for entry in filter(is_camera, observations):
            out[entry] = corrupted[entry]
        return out

    def _check(self, entries: Iterable[str]) -> None:
        if self.schedule.mode != "clean":
            check_cameras((entry for entry in entries if entry != KEY), self.schedule.names)


@dataclass
class CorruptObservationConfig(ObsTransformConfig):
    """Options of ``CorruptObservation`` in a habitat-baselines config."""

    type: str = "CorruptObservation"
    mode: str = "per_episode"  # mitigate.corruptions.Schedule lists the modes
    # corruptions from which the schedule samples; an empty list means the standard suite
    names: tuple[str, ...] = ()
    severity: float = 0.6
    severity_depth: float | None = None  # if None, equal to severity
    clean_share: float = 0.0
    seed: int = 0
    depth_min: float = 0.0  # in metres; 0.5 for RxR-CE
    depth_max: float = 10.0  # in metres; 5.0 for RxR-CE
    depth_missing: float = 0.0  # value in metres that marks missing depth
    turn: str = "left"  # direction from rgb to rgb_30


def key_of(scene_id: str, episode_id: str | int, step: int) -> np.ndarray:
    """Return the key of an observation as int64 [2]: the number of the episode, and the step.

    The episode number consists of 63 bits of a digest of the episode id and the file name of the
    scene. Therefore the number of an episode is the same in every run and process.
    """
    name = f"{str(scene_id).rpartition('/')[2]}/{episode_id}"
    return np.array([digest(Key(0, name), "habitat") >> 1, step], np.int64)


def _keys(observations: Mapping[str, torch.Tensor]) -> list[list[int]]:
    keys = observations.get(KEY)
    if keys is None or keys.dtype != torch.int64 or keys.shape[1:] != (2,):
        actual = "nothing" if keys is None else f"{keys.dtype} {tuple(keys.shape)}"
        raise ValueError(
            f"The batch must have {KEY!r}, int64 [B, 2], which determines the corruption of each "
            f"frame, got {actual}. Add {KEY!r} to the task's lab_sensors (see "
            "docs/corruption-entry-points.md). Elsewhere, call corrupt_habitat."
        )
    return keys.tolist()


def _register() -> None:
    """Register the transformer, the sensor and their configs in Habitat's registries."""
    from gym import spaces
    from habitat.config.default_structured_configs import LabSensorConfig
    from habitat.core.registry import registry
    from habitat.core.simulator import Sensor, SensorTypes
    from hydra.core.config_store import ConfigStore

    class CorruptionKeySensor(Sensor):
        """Sensor that provides the entry ``corruption_key``, int64 [2]: the episode number and the
        step.
        """

        def __init__(self, *args: Any, **kwargs: Any) -> None:
            self._step = 0
            super().__init__(*args, **kwargs)

        def _get_uuid(self, *args: Any, **kwargs: Any) -> str:
            return KEY

        def _get_sensor_type(self, *args: Any, **kwargs: Any) -> SensorTypes:
            return SensorTypes.TENSOR

        def _get_observation_space(self, *args: Any, **kwargs: Any) -> spaces.Box:
            return spaces.Box(0, np.iinfo(np.int64).max, (2,), np.int64)

        def get_observation(self, *args: Any, episode: Any, **kwargs: Any) -> np.ndarray:
            # Habitat passes no action at a reset
            self._step = self._step + 1 if "action" in kwargs else 0
            return key_of(episode.scene_id, episode.episode_id, self._step)

    registry.register_sensor(CorruptionKeySensor, name="CorruptionKeySensor")
    baseline_registry.register_obs_transformer(CorruptObservation, name="CorruptObservation")
    store = ConfigStore.instance()
    store.store(
        group="habitat/task/lab_sensors",
        name=KEY,
        package=f"habitat.task.lab_sensors.{KEY}",
        node=LabSensorConfig(type="CorruptionKeySensor"),
    )
    store.store(
        group="habitat_baselines/rl/policy/obs_transforms",
        name="corrupt_observation",
        node=CorruptObservationConfig,
    )


if baseline_registry is not None:
    _register()
