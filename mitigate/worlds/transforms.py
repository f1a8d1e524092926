"""Transforms of torchrl that corrupt the frames of environments and replay buffers."""

from __future__ import annotations

import math
import multiprocessing
import warnings

import numpy as np
import torch
from tensordict import NestedKey, TensorDictBase
from torchrl.data import Bounded, Composite, Unbounded
from torchrl.envs import Transform

from mitigate.core.observation import DEPTH, EPISODE, FRAME, POSE, RGB
from mitigate.corruptions import CLEAN, Corruption, DepthSensor, FrameStream, Key, Schedule
from mitigate.corruptions.registry import family, modality
from mitigate.corruptions.schedule import drawn, names_of
from mitigate.corruptions.stream import is_timed
from mitigate.corruptions.tensors import corrupt_observations
from mitigate.corruptions.tensors.suite import check_backend
from mitigate.worlds.modalities import ENTRY_FIX, check_available


class CorruptObservation(Transform):
    """Corrupt ``rgb`` and ``depth`` with the corruptions that a schedule selects.

    Random numbers depend only on (seed, ``episode``, ``frame``).

    All properties of an episode, such as its corruption and the water drops on its lens, are a
    function of the name in ``episode``, which changes at every reset. Therefore the pixels do not
    depend on the number of parallel environments or on partial resets. The pixels are also the same
    if a clean frame is stored in a replay buffer and corrupted when it is read. ``forward`` does
    this, and also corrupts the frames in ``("next", ...)``. An environment without episode names
    needs an ``EpisodeCounter`` before this transform.

    Only temporal faults need state between steps: the last frames of each batch row. A replay
    buffer does not return frames in order, so ``forward`` rejects temporal faults.

    RGB frames are uint8 [*batch, H, W, 3] or [*batch, V, H, W, 3], and depth frames are float32
    [*batch, (V,) H, W, 1]. Put this transform before transforms that move channels or convert
    frames to float. Any batch shape and device are supported. Frames on a GPU are corrupted on the
    GPU (``mitigate.corruptions.tensors``), but faults are computed on the CPU.

    Args:
        schedule: A schedule that selects the corruption of each frame, or one corruption for all
            frames.
        seed: Corruption seed.
        rgb: Name of the RGB entry. The data may lack this entry.
        depth: Name of the depth entry. The data may lack this entry.
        sensor: Depth range, and the value that marks missing depth.
        normalised: Whether depth is normalised to [0, 1] over the range of the sensor. If False or
            None, depth is in metres. None adds a check for replay buffers: if no depth value is
            above 1, the depth may be normalised, so an error is raised.
        hfov: Horizontal field of view of the cameras in degrees; camera faults require it.
        backend: "torch" computes on the device of the frames, and "numpy" computes on the CPU. If
            None, torch is used for frames on a GPU and numpy for frames on the CPU.

    Raises:
        ValueError: If the data has no episode or frame number, or if the schedule corrupts a
            missing entry. If a temporal fault is applied to a replay buffer. Errors of
            ``corrupt_observation`` are passed on.
    """

    def __init__(
        self,
        schedule: Schedule | Corruption,
        seed: int = 0,
        *,
        rgb: NestedKey = RGB,
        depth: NestedKey = DEPTH,
        sensor: DepthSensor | None = None,
        normalised: bool | None = None,
        hfov: float | None = None,
        backend: str | None = None,
    ) -> None:
        super().__init__(in_keys=[rgb, depth], out_keys=[rgb, depth])
        self.schedule, self.seed = schedule, seed
        self.entries = {RGB: rgb, DEPTH: depth, POSE: POSE}
        self.sensor = sensor or DepthSensor()
        self._normalised = normalised
        self._backend = check_backend(backend)
        self._hfov = dict.fromkeys((RGB, DEPTH), hfov)
        self._streams: dict[int, FrameStream] = {}  # one stream per batch row

    def transform_observation_spec(self, observation_spec: Composite) -> Composite:
        """Return the spec unchanged. Raise ValueError if depth seems to be normalised but would be
        corrupted as metres.
        """
        entry = self.entries[DEPTH]
        if self._corrupts_metres() and entry in observation_spec.keys(True, True):
            spec = observation_spec[entry]
            high = float(spec.space.high.max()) if isinstance(spec, Bounded) else math.inf
            if high <= 1.0:
                raise ValueError(
                    f"The maximum of the depth spec is {high:g}, so depth may be normalised to "
                    "[0, 1]. Set normalised=True and sensor=DepthSensor(z_min, z_max), or use a "
                    "spec in metres."
                )
        return observation_spec

    def _corrupts_metres(self) -> bool:
        depth = any(modality(name) == DEPTH for name in names_of(self.schedule))
        return depth and not self._normalised

    def _call(self, next_tensordict: TensorDictBase) -> TensorDictBase:
        return self._corrupt(next_tensordict)

    def _reset(
        self, tensordict: TensorDictBase | None, tensordict_reset: TensorDictBase
    ) -> TensorDictBase:
        """Corrupt only the rows that were reset, because torchrl ignores the other rows."""
        mask = _reset_mask(self, tensordict, tensordict_reset)
        return self._corrupt(tensordict_reset, mask.nonzero().flatten().tolist())

    def forward(self, tensordict: TensorDictBase) -> TensorDictBase:
        """Return stored data, of any batch shape, with corrupted frames.

        The result is a new tensordict, because the input may be the storage of a replay buffer.
        Entries other than frames are shared with the input.

        Raises:
            ValueError: If the corruption is a temporal fault, or the depth may be normalised.
        """
        if isinstance(self.schedule, Corruption) and is_timed(self.schedule):
            raise ValueError(
                f"{self.schedule.name!r} depends on earlier frames, which a replay buffer does not "
                "return in order. Put CorruptObservation into the environment "
                "(TransformedEnv), and store its frames."
            )
        depth = tensordict.get(self.entries[DEPTH], None)
        if depth is not None and self._normalised is None and self._corrupts_metres():
            readings = depth[depth.isfinite() & (depth > 0)]
            if readings.numel() and readings.max() <= 1.0:
                raise ValueError(
                    f"The maximum depth of the data is {float(readings.max()):.3g}, so it may be "
                    "normalised to [0, 1]. Set normalised=True and sensor=DepthSensor(z_min, "
                    "z_max), or normalised=False for depth in metres."
                )
        out = self._corrupt(tensordict.copy())
        following = out.get("next", None)
        if following is not None and any(following.get(k, None) is not None for k in self.in_keys):
            self._corrupt(following)
        return out

    def _corrupt(self, data: TensorDictBase, rows: list[int] | None = None) -> TensorDictBase:
        drawn = self._draw(data)
        batch = len(data.batch_size)
        stored = {
            name: value.reshape(-1, *value.shape[batch:])
            for name, entry in self.entries.items()
            if (value := data.get(entry, None)) is not None
        }
        check_available(names_of(self.schedule), stored, "the data have no {0}", ENTRY_FIX)
        if self._uses_torch(stored):
            return self._corrupt_on_device(data, stored, drawn, rows)
        frames = {name: value.numpy(force=True) for name, value in stored.items()}
        corrupted: dict[str, np.ndarray] = {}
        for row in range(len(drawn)) if rows is None else rows:
            corruption, key = drawn[row]
            if not corruption.modalities:
                continue
            instant = {entry: views[row] for entry, views in frames.items()}
            if row not in self._streams:
                self._streams[row] = FrameStream(
                    self.sensor, normalised=bool(self._normalised), hfov=self._hfov
                )
            result = self._streams[row].corrupt(instant, corruption, key)
            for name in frames.keys() & {*corruption.modalities}:
                corrupted.setdefault(name, frames[name].copy())[row] = result[name]
        for name, views in corrupted.items():
            value = data.get(self.entries[name])
            data.set(self.entries[name], torch.from_numpy(views).reshape(value.shape).to(value))
        return data

    def _uses_torch(self, stored: dict[str, torch.Tensor]) -> bool:
        """Return whether torch corrupts the frames. Otherwise numpy corrupts them on the CPU."""
        if isinstance(self.schedule, Corruption) and family(self.schedule.name):
            return False
        if self._backend is not None:
            return self._backend == "torch"
        return any(value.device.type != "cpu" for value in stored.values())

    def _corrupt_on_device(
        self,
        data: TensorDictBase,
        frames: dict[str, torch.Tensor],
        drawn: list[tuple[Corruption, Key]],
        rows: list[int] | None,
    ) -> TensorDictBase:
        corruptions = [corruption for corruption, _ in drawn]
        if rows is not None:
            reset = set(rows)
            corruptions = [c if row in reset else CLEAN for row, c in enumerate(corruptions)]
        pose = frames.pop(POSE, None)
        frames = {name: f.unsqueeze(1) if f.dim() == 4 else f for name, f in frames.items()}
        corrupted = corrupt_observations(
            frames,
            corruptions,
            [key for _, key in drawn],
            headings=None if pose is None else pose.reshape(-1, 3)[:, 2].tolist(),
            sensor=self.sensor,
            normalised=bool(self._normalised),
            backend="torch",
        )
        for name, views in corrupted.items():
            if views is not frames[name]:
                entry = self.entries[name]
                data.set(entry, views.reshape(data.get(entry).shape))
        return data

    def _draw(self, data: TensorDictBase) -> list[tuple[Corruption, Key]]:
        """Return the corruption and the random key of every time step, in row-major order."""
        present = set(data.keys())  # a set, because a tensordict does not support `in`
        missing = [name for name in (EPISODE, FRAME) if name not in present]
        if missing:
            raise ValueError(
                f"The data must have {' and '.join(map(repr, missing))}, which determine the "
                f"random numbers, got only {sorted(map(str, present))}. The environment must "
                "provide them, as ApartmentsEnv does. Otherwise put an EpisodeCounter() before "
                "CorruptObservation."
            )
        instants = data.select(EPISODE, FRAME).cpu().reshape(-1).unbind(0)
        return [
            drawn(self.schedule, self.seed, _name(instant[EPISODE]), int(instant[FRAME]))
            for instant in instants
        ]


class EpisodeCounter(Transform):
    """Add the entries ``episode`` and ``frame`` (int64 [*batch, 1]) to an environment that has
    neither.

    ``episode`` is the number of the episode, and ``frame`` is the number of steps since the reset.
    If the batch has n rows, row i runs the episodes i, i + n, i + 2 * n and so on. A partial reset
    advances only the rows in its mask, so the numbers of a row do not depend on the other rows.

    Args:
        worker: Index of this environment if environments run in several processes. The rows of all
            processes are numbered as one batch.
        workers: Number of processes that run environments. None means 1. In a child process,
            None also causes a warning, because all processes would get the same corruptions.

    Raises:
        ValueError: If ``worker`` is not between 0 and ``workers`` - 1.
    """

    def __init__(self, worker: int = 0, workers: int | None = None) -> None:
        if workers is None:
            workers = 1
            if multiprocessing.parent_process() is not None:
                warnings.warn(
                    "Environments in several processes get the same corruptions: pass "
                    "EpisodeCounter(worker=i, workers=n) in process i of n, or workers=1.",
                    stacklevel=2,
                )
        if not 0 <= worker < workers:
            raise ValueError(
                f"worker must be 0 to {workers - 1} with workers={workers}, got {worker}."
            )
        super().__init__(in_keys=[], out_keys=[EPISODE, FRAME])
        self.worker, self.workers = worker, workers
        self._resets: torch.Tensor | None = None  # int64 [rows], the number of resets of each row

    def transform_observation_spec(self, observation_spec: Composite) -> Composite:
        """Return the spec after adding the two entries to it."""
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
        resets = torch.zeros(rows, dtype=torch.int64) if self._resets is None else self._resets
        self._resets = resets + mask
        first = self.worker * rows + torch.arange(rows)
        number = first + (self._resets - 1).clamp(min=0) * rows * self.workers
        shape, device = (*tensordict_reset.batch_size, 1), tensordict_reset.device
        tensordict_reset.set(EPISODE, number.reshape(shape).to(device))
        return tensordict_reset.set(FRAME, torch.zeros(shape, dtype=torch.int64, device=device))

    def _step(self, tensordict: TensorDictBase, next_tensordict: TensorDictBase) -> TensorDictBase:
        next_tensordict.set(EPISODE, tensordict.get(EPISODE))
        return next_tensordict.set(FRAME, tensordict.get(FRAME) + 1)

    def forward(self, tensordict: TensorDictBase) -> TensorDictBase:
        """Raise RuntimeError, because this transform works only in an environment.

        Stored data must already contain the numbers of its episodes and frames.
        """
        raise RuntimeError("EpisodeCounter belongs in an environment, not in a replay buffer.")


def _reset_mask(
    transform: Transform, tensordict: TensorDictBase | None, reset: TensorDictBase
) -> torch.Tensor:
    """Return a bool mask [rows], on the CPU, of the batch rows that are being reset."""
    parent = transform.parent
    name = "_reset" if parent is None else parent.reset_keys[0]
    mask = None if tensordict is None else tensordict.get(name, None)
    if mask is None:
        return torch.ones(reset.batch_size.numel(), dtype=torch.bool)
    return mask.cpu().reshape(reset.batch_size.numel(), -1).any(-1)


def _name(episode: str | torch.Tensor) -> str:
    return str(int(episode)) if isinstance(episode, torch.Tensor) else episode
