"""A wrapper for gymnasium vector environments whose observations are torch tensors.

Needs gymnasium 1.1 or newer. For vector environments of numpy arrays, wrap each environment with
``mitigate.worlds.wrappers.CorruptObservation``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

try:
    from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
except ImportError as error:
    raise ImportError(
        "Vector environments need gymnasium 1.1 or newer. Run: pip install 'gymnasium>=1.1'."
    ) from error

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import Corruption, DepthSensor, Schedule
from mitigate.corruptions.schedule import drawn, names_of
from mitigate.corruptions.suite import SENSOR
from mitigate.corruptions.tensors import corrupt_observations
from mitigate.corruptions.tensors.suite import check_backend
from mitigate.worlds.modalities import ENTRY_FIX, check_available


class CorruptVectorObservation(VectorWrapper):
    """Corrupt the frames of a vector environment on the device of the frames.

    An observation is a mapping with tensors. The entry ``rgb`` is uint8 [N, H, W, 3] or [N, V, H,
    W, 3], and the entry ``depth`` is float32 [N, H, W, 1] or [N, V, H, W, 1]. Other entries do not
    change. The final observations in ``info`` do not change either.

    Environment i of N runs the episodes i, i + N, i + 2 * N and so on, so the episode numbers of
    one environment do not depend on the others. The random numbers depend on the episode number, as
    with ``EpisodeCounter`` of ``mitigate.worlds.transforms``. A reset with a seed restarts the
    episode numbers. A reset with ``options={"reset_mask": mask}`` starts new episodes only in the
    environments that the mask selects.

    Args:
        env: The vector environment.
        schedule: A schedule that selects the corruption of each frame, or one corruption for all
            frames. Faults are not supported.
        seed: Corruption seed.
        rgb: Name of the RGB entry. Observations may lack this entry.
        depth: Name of the depth entry. Observations may lack this entry.
        sensor: Depth range, and the value that marks missing depth.
        normalised: Whether depth is normalised to [0, 1] over the range of the sensor. If false,
            depth is in metres.
        autoreset_mode: The time at which an environment resets itself after the end of an episode.
            If None, it is read from ``env.metadata["autoreset_mode"]``. ManiSkill and Isaac Lab use
            SAME_STEP.
        backend: As in ``mitigate.corruptions.tensors.corrupt_tensors``.

    Raises:
        ValueError: If ``autoreset_mode`` is missing, or if the observation lacks the frames that a
            corruption changes. Errors of ``corrupt_observations`` are passed on.
    """

    def __init__(
        self,
        env: VectorEnv,
        schedule: Schedule | Corruption,
        seed: int = 0,
        *,
        rgb: str = RGB,
        depth: str = DEPTH,
        sensor: DepthSensor = SENSOR,
        normalised: bool = False,
        autoreset_mode: AutoresetMode | None = None,
        backend: str | None = None,
    ) -> None:
        super().__init__(env)
        mode = autoreset_mode or (env.metadata or {}).get("autoreset_mode")
        if not isinstance(mode, AutoresetMode):
            raise ValueError(
                "autoreset_mode must be a gymnasium.vector.AutoresetMode, because it determines "
                f"which step begins an episode, got {mode!r}. Pass it to the wrapper, or set "
                "metadata['autoreset_mode'] of the environment."
            )
        self.schedule, self.seed, self.sensor = schedule, seed, sensor
        self.entries = {RGB: rgb, DEPTH: depth}
        self._normalised = normalised
        self._mode = mode
        self._backend = check_backend(backend)
        self._resets = torch.zeros(self.num_envs, dtype=torch.int64)
        self._steps = torch.zeros(self.num_envs, dtype=torch.int64)
        self._over = torch.zeros(self.num_envs, dtype=torch.bool)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start the next episode in all environments, or in those that the reset mask selects."""
        observations, info = self.env.reset(seed=seed, options=options)
        if seed is not None:
            self._resets.zero_()
        mask = (options or {}).get("reset_mask")
        self._begin(torch.ones_like(self._over) if mask is None else _on_host(mask))
        return self._corrupt(observations), info

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Step the environments and corrupt the observations."""
        observations, rewards, terminated, truncated, info = self.env.step(actions)
        over = _on_host(terminated) | _on_host(truncated)
        self._steps += 1
        if self._mode is AutoresetMode.SAME_STEP:
            self._begin(over)
        elif self._mode is AutoresetMode.NEXT_STEP:
            self._begin(self._over)
            self._over = over
        return self._corrupt(observations), rewards, terminated, truncated, info

    def _begin(self, mask: Tensor) -> None:
        self._resets += mask
        self._steps[mask] = 0
        self._over = self._over & ~mask

    def _corrupt(self, observations: Mapping[str, Any]) -> dict[str, Any]:
        frames = {n: observations[e] for n, e in self.entries.items() if e in observations}
        for name, views in frames.items():
            if isinstance(views, Tensor) and views.dim() == 4:
                frames[name] = views.unsqueeze(1)
        check_available(names_of(self.schedule), frames, "the observation has no {0}", ENTRY_FIX)
        numbers = torch.arange(self.num_envs) + (self._resets - 1).clamp(min=0) * self.num_envs
        instants = zip(numbers.tolist(), self._steps.tolist(), strict=True)
        draws = [drawn(self.schedule, self.seed, str(number), step) for number, step in instants]
        corrupted = corrupt_observations(
            frames,
            [corruption for corruption, _ in draws],
            [key for _, key in draws],
            sensor=self.sensor,
            normalised=self._normalised,
            backend=self._backend,
        )
        changed = {
            self.entries[name]: views.reshape(observations[self.entries[name]].shape)
            for name, views in corrupted.items()
            if views is not frames[name]
        }
        return {**observations, **changed}


def _on_host(mask: Any) -> Tensor:
    """Return ``mask`` as a bool tensor [N] on the CPU, with one element per environment."""
    return torch.as_tensor(mask).cpu().bool()
