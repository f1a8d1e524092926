"""Corruptions inside torchrl: a ``Transform`` for environments and replay buffers alike."""

from __future__ import annotations

import torch
from tensordict import TensorDictBase
from torchrl.envs import Transform

from mitigate.corruptions import Schedule, corrupt_observation
from mitigate.keys import DEPTH, EPISODE, FRAME, POSE, RGB

_NEEDED = (EPISODE, FRAME)


class CorruptObservation(Transform):
    """Corrupts ``rgb`` and ``depth`` as a schedule says for (seed, ``episode``, ``frame``).

    The state of an episode (its corruption, the drops on its lens) is a function of the name in
    ``episode``, which changes at every reset; nothing is kept here. So the pixels do not depend on
    how many environments run side by side, on partial resets, or on whether a frame passes in an
    environment (``_call``) or later, out of a replay buffer that stores clean frames (``forward``,
    which also corrupts ``("next", ...)`` if it is there).

    Args:
        schedule: which frame is hurt by what.
        seed: of every random draw.

    Any batch shape. Raises ValueError if the data name no episode or frame.
    """

    def __init__(self, schedule: Schedule, seed: int = 0) -> None:
        super().__init__(in_keys=[RGB, DEPTH], out_keys=[RGB, DEPTH])
        self.schedule, self.seed = schedule, seed

    def _call(self, next_tensordict: TensorDictBase) -> TensorDictBase:
        return self._corrupt(next_tensordict)

    def _reset(
        self, tensordict: TensorDictBase | None, tensordict_reset: TensorDictBase
    ) -> TensorDictBase:
        return self._corrupt(tensordict_reset)

    def forward(self, tensordict: TensorDictBase) -> TensorDictBase:
        """Corrupt stored data of any batch shape in place of their clean frames."""
        self._corrupt(tensordict)
        following = tensordict.get("next", None)
        if following is not None:
            self._corrupt(following)
        return tensordict

    def _corrupt(self, data: TensorDictBase) -> TensorDictBase:
        present = set(data.keys())  # a tensordict has no `in` of its own
        missing = [name for name in _NEEDED if name not in present]
        if missing:
            raise ValueError(
                f"CorruptObservation finds no {' and no '.join(map(repr, missing))} in the data, "
                f"only {sorted(map(str, present))}. The environment must give 'episode' (a string "
                "unique to each run of an episode) and 'frame' (int64 [1]), as ApartmentsEnv does, "
                "because every random draw is keyed by them."
            )
        flat = data.select(RGB, DEPTH, POSE, EPISODE, FRAME, strict=False).reshape(-1)
        hurt = [self._instant(instant) for instant in flat.unbind(0)]
        for name in hurt[0]:
            data.set(
                name,
                torch.stack([frames[name] for frames in hurt])
                .reshape(data[name].shape)
                .to(data[name].device),
            )
        return data

    def _instant(self, instant: TensorDictBase) -> dict[str, torch.Tensor]:
        found = {name: instant.get(name, None) for name in (RGB, DEPTH, POSE)}
        frames = {name: value.cpu().numpy() for name, value in found.items() if value is not None}
        drawn = self.schedule.draw(self.seed, instant[EPISODE], int(instant[FRAME]))
        hurt = corrupt_observation(frames, *drawn)
        return {name: torch.from_numpy(hurt[name]) for name in frames if name != POSE}
