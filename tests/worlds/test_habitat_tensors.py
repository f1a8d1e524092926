"""Tests of corruptions of Habitat observations whose frames are tensors."""

import numpy as np
import pytest
import torch

from mitigate.corruptions import CLEAN, Corruption, DepthSensor, Key
from mitigate.worlds.habitat import corrupt_habitat
from mitigate.worlds.habitat_tensors import corrupt_habitat_tensors

CORRUPTIONS = (Corruption("flare", 0.8), CLEAN, Corruption("low_light+missing_data", 0.7))
KEYS = [Key(2, f"x.glb/{row}", 4 * row) for row in range(3)]
HEADINGS = [0.3, None, -1.2]
R2R = DepthSensor(0.5, 5.0)


def batch_of(obs: dict, axes: int) -> dict[str, torch.Tensor]:
    """Return a batch of three rows with all cameras; depth is [B, H, W, 1] or [B, H, W]."""
    batch = {}
    for entry, frame in obs.items():
        if entry.startswith("rgb") and isinstance(frame, np.ndarray) and frame.ndim == 3:
            batch[entry] = torch.from_numpy(frame.copy()).repeat(3, 1, 1, 1)
        elif entry.startswith("depth") and isinstance(frame, np.ndarray):
            unit = torch.from_numpy((frame / 10.0).clip(max=1.0).astype(np.float32))
            batch[entry] = unit.repeat(3, 1, 1, 1) if axes == 4 else unit[..., 0].repeat(3, 1, 1)
    return {**batch, "compass": torch.zeros(3, 1)}


@pytest.mark.parametrize("turn", ["left", "right"])
@pytest.mark.parametrize(("backend", "axes"), [("numpy", 3), ("numpy", 4), ("torch", 4)])
def test_corrupt_habitat_tensors_equals_corrupt_habitat_per_row(backend, axes, turn, obs):
    batch = batch_of(obs, axes)
    out = corrupt_habitat_tensors(
        batch, CORRUPTIONS, KEYS, R2R, headings=HEADINGS, turn=turn, backend=backend
    )
    assert list(out) == list(batch) and out["compass"] is batch["compass"]
    for row, (corruption, key, heading) in enumerate(zip(CORRUPTIONS, KEYS, HEADINGS, strict=True)):
        instant = {entry: frames[row].numpy() for entry, frames in batch.items()}
        expected = corrupt_habitat(instant, corruption, key, R2R, heading=heading, turn=turn)
        for entry in (entry for entry in batch if entry != "compass"):
            actual = out[entry][row].numpy()
            assert actual.shape == expected[entry].shape
            if backend == "numpy":
                assert actual.tobytes() == expected[entry].tobytes()
            else:
                most = 1 if entry.startswith("rgb") else 2e-5  # 0.1 mm of 4.5 m
                close = np.abs(actual.astype(float) - expected[entry]) <= most
                assert (~close).sum() <= 0.001 * close.size


def test_corrupt_habitat_tensors_explains_invalid_input(obs):
    batch = batch_of(obs, 4)
    with pytest.raises(ValueError, match="has no camera named depth"):
        corrupt_habitat_tensors({"rgb": batch["rgb"]}, CORRUPTIONS, KEYS)
    with pytest.raises(ValueError, match="turn must be"):
        corrupt_habitat_tensors(batch, CORRUPTIONS, KEYS, turn="up")
    odd = {"rgb": batch["rgb"], "rgb_30": batch["rgb_30"][:, :20]}
    with pytest.raises(ValueError, match="All cameras of a panorama must have the same"):
        corrupt_habitat_tensors(odd, [CORRUPTIONS[0]] * 3, KEYS)
