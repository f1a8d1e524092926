"""Corruptions inside torchrl: transforms for environments and replay buffers alike."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import torch
from tensordict import NestedKey, TensorDictBase
from torchrl.data import Composite, Unbounded
from torchrl.envs import Transform

from mitigate.core.observation import DEPTH, EPISODE, FRAME, POSE, RGB
from mitigate.corruptions import (
    Corruption,
    DepthSensor,
    Key,
    Schedule,
    corrupt_normalised,
    corrupt_observation,
    registry,
)
from mitigate.corruptions.schedule import drawn, names_of


class CorruptObservation(Transform):
    """Corrupts ``rgb`` and ``depth`` as a schedule says for (seed, ``episode``, ``frame``).

    The state of an episode (its corruption, the drops on its lens) is a function of the name in
    ``episode``, which changes at every reset; nothing is kept here. So the pixels do not depend on
    how many environments run side by side, on partial resets, or on whether a frame passes in an
    environment (``_call``) or later, out of a replay buffer that stores clean frames (``forward``,
    which also corrupts ``("next", ...)`` if it is there). An environment that names no episodes
    takes an ``EpisodeCounter`` before this transform.

    Frames are RGB uint8 [*batch, H, W, 3] or [*batch, V, H, W, 3] and depth float32
    [*batch, (V,) H, W, 1]: put it before transforms that move channels or make floats. Any batch
    shape, any device; the work is done on the CPU and the result goes back to the frames' device.

    Args:
        schedule: which frame meets what, or the corruption that all meet.
        seed: of every random draw.
        rgb, depth: names of the two entries; an absent one is left out.
        sensor: depth range and sentinel.
        normalised: depth is in [0, 1] over the sensor's range instead of in metres.

    Raises ValueError if the data name no episode or frame or lack what the schedule corrupts, and
    as ``corrupt_observation`` does.
    """

    def __init__(
        self,
        schedule: Schedule | Corruption,
        seed: int = 0,
        *,
        rgb: NestedKey = RGB,
        depth: NestedKey = DEPTH,
        sensor: DepthSensor | None = None,
        normalised: bool = False,
    ) -> None:
        super().__init__(in_keys=[rgb, depth], out_keys=[rgb, depth])
        self.schedule, self.seed = schedule, seed
        self.entries = {RGB: rgb, DEPTH: depth, POSE: POSE}
        self.sensor = sensor or DepthSensor()
        self._corrupt_instant = corrupt_normalised if normalised else corrupt_observation

    def _call(self, next_tensordict: TensorDictBase) -> TensorDictBase:
        return self._corrupt(next_tensordict)

    def _reset(
        self, tensordict: TensorDictBase | None, tensordict_reset: TensorDictBase
    ) -> TensorDictBase:
        """Corrupt what was reset; torchrl drops the other rows and keeps those it had."""
        mask = _reset_mask(self, tensordict, tensordict_reset)
        return self._corrupt(tensordict_reset, mask.nonzero().flatten().tolist())

    def forward(self, tensordict: TensorDictBase) -> TensorDictBase:
        """Stored data of any batch shape with corrupted frames.

        A new tensordict, as a buffer may hand out its very storage; other entries are shared.
        """
        out = self._corrupt(tensordict.copy())
        following = out.get("next", None)
        if following is not None:
            self._corrupt(following)
        return out

    def _corrupt(self, data: TensorDictBase, rows: list[int] | None = None) -> TensorDictBase:
        drawn = self._draw(data)
        batch = len(data.batch_size)
        stored = {name: data.get(entry, None) for name, entry in self.entries.items()}
        frames = {
            name: value.detach().cpu().reshape(-1, *value.shape[batch:]).numpy()
            for name, value in stored.items()
            if value is not None
        }
        self._check_entries(frames)
        corrupted: dict[str, np.ndarray] = {}
        for row in range(len(drawn)) if rows is None else rows:
            corruption, key = drawn[row]
            if not corruption.modalities:
                continue
            instant = {entry: views[row] for entry, views in frames.items()}
            after = self._corrupt_instant(instant, corruption, key, self.sensor)
            for name in corruption.modalities:
                corrupted.setdefault(name, frames[name].copy())[row] = after[name]
        for name, views in corrupted.items():
            value = stored[name]
            data.set(
                self.entries[name], torch.from_numpy(views).reshape(value.shape).to(value.device)
            )
        return data

    def _check_entries(self, frames: Collection[str]) -> None:
        """Raise ValueError at the first data, not when the draw first asks for what they lack."""
        names = names_of(self.schedule)
        lost = [name for name in names if registry.modality(name) not in frames]
        if lost:
            modality = registry.modality(lost[0])
            fit = ", ".join(name for name in names if name not in lost)
            raise ValueError(
                f"The schedule may draw {lost[0]!r}, which corrupts {modality}, but the data have "
                f"no entry {self.entries[modality]!r}. "
                f"{f'Draw only from names=[{fit}]' if fit else 'Choose other names'}, or say what "
                f"the entry is called: CorruptObservation(..., {modality}=...)."
            )

    def _draw(self, data: TensorDictBase) -> list[tuple[Corruption, Key]]:
        """The corruption and key of every instant, in row-major order."""
        present = set(data.keys())  # a tensordict has no `in` of its own
        missing = [name for name in (EPISODE, FRAME) if name not in present]
        if missing:
            raise ValueError(
                f"CorruptObservation finds no {' and no '.join(map(repr, missing))} in the data, "
                f"only {sorted(map(str, present))}. The environment must give 'episode' (a string "
                "or int64 [1], unique to each run of an episode) and 'frame' (int64 [1]), as "
                "ApartmentsEnv does, because every random draw is keyed by them; for another "
                "environment put an EpisodeCounter() before this transform."
            )
        instants = data.select(EPISODE, FRAME).cpu().reshape(-1).unbind(0)
        return [
            drawn(self.schedule, self.seed, _name(instant[EPISODE]), int(instant[FRAME]))
            for instant in instants
        ]


class EpisodeCounter(Transform):
    """Adds ``episode`` and ``frame``, int64 [*batch, 1], to an environment that has neither.

    ``episode`` numbers the runs of episodes and ``frame`` the steps since the reset. Row i of n
    parallel ones runs the episodes i, i + n, i + 2 n, ...: a reset mask moves on only the rows that
    it names, so the numbers do not depend on when the others end.

    Args:
        worker, workers: this environment is number ``worker`` of ``workers`` equal ones in
            processes of their own; their rows count as one batch.

    Raises ValueError for a worker outside 0 ... workers - 1.
    """

    def __init__(self, worker: int = 0, workers: int = 1) -> None:
        if not 0 <= worker < workers:
            raise ValueError(
                f"worker={worker} of workers={workers}: worker counts from 0 to {workers - 1}."
            )
        super().__init__(in_keys=[], out_keys=[EPISODE, FRAME])
        self.worker, self.workers = worker, workers
        self._begun: torch.Tensor | None = None  # int64 [rows]: resets of each row so far

    def transform_observation_spec(self, observation_spec: Composite) -> Composite:
        """The spec with the two entries added."""
        shape = (*self.parent.batch_size, 1)
        for name in self.out_keys:
            observation_spec[name] = Unbounded(
                shape=shape, dtype=torch.int64, device=observation_spec.device
            )
        return observation_spec

    def _reset(
        self, tensordict: TensorDictBase | None, tensordict_reset: TensorDictBase
    ) -> TensorDictBase:
        mask = _reset_mask(self, tensordict, tensordict_reset)
        rows = mask.numel()
        begun = torch.zeros(rows, dtype=torch.int64) if self._begun is None else self._begun
        self._begun = begun + mask
        place = self.worker * rows + torch.arange(rows)
        number = place + (self._begun - 1).clamp(min=0) * rows * self.workers
        shape, device = (*tensordict_reset.batch_size, 1), tensordict_reset.device
        tensordict_reset.set(EPISODE, number.reshape(shape).to(device))
        return tensordict_reset.set(FRAME, torch.zeros(shape, dtype=torch.int64, device=device))

    def _step(self, tensordict: TensorDictBase, next_tensordict: TensorDictBase) -> TensorDictBase:
        next_tensordict.set(EPISODE, tensordict.get(EPISODE))
        return next_tensordict.set(FRAME, tensordict.get(FRAME) + 1)

    def forward(self, tensordict: TensorDictBase) -> TensorDictBase:
        """Raise: stored data must hold the numbers that the environment gave them."""
        raise RuntimeError("EpisodeCounter belongs in an environment, not in a replay buffer.")


def _reset_mask(
    transform: Transform, tensordict: TensorDictBase | None, reset: TensorDictBase
) -> torch.Tensor:
    """bool [rows] on the CPU: which rows of the flattened batch are being reset."""
    parent = transform.parent
    name = "_reset" if parent is None else parent.reset_keys[0]
    mask = None if tensordict is None else tensordict.get(name, None)
    if mask is None:
        return torch.ones(reset.batch_size.numel(), dtype=torch.bool)
    return mask.cpu().reshape(reset.batch_size.numel(), -1).any(-1)


def _name(episode: str | torch.Tensor) -> str:
    return str(int(episode)) if isinstance(episode, torch.Tensor) else episode
