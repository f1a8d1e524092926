"""Corrupt batches of RGB and depth frames, with one corruption per row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import torch
from torch import Tensor

from mitigate.core.observation import DEPTH
from mitigate.corruptions.depth_sensor import LEAST, DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.normalised import check_sensor
from mitigate.corruptions.record import OF_NO_FRAME
from mitigate.corruptions.suite import SENSOR, Corruption, changed_entries, check_corruption
from mitigate.corruptions.tensors.pixels import is_valid
from mitigate.corruptions.tensors.suite import corrupt_tensors


@torch.no_grad()
def corrupt_observations(
    frames: Mapping[str, Tensor],
    corruptions: Sequence[Corruption],
    keys: Sequence[Key],
    *,
    headings: Sequence[float | None] | None = None,
    sensor: DepthSensor = SENSOR,
    normalised: bool = False,
    backend: str | None = None,
) -> dict[str, Tensor]:
    """Corrupt the frames of a batch of observations, for example one step of vectorised
    environments.

    Args:
        frames: Frames by modality: ``rgb`` (uint8 [B, V, H, W, 3]), ``depth`` (float32 [B, V, H, W,
            1]) or both.
        corruptions: For each row, a corruption, a pair of corruptions or CLEAN, for example from
            ``Schedule.draw``. Instruction corruptions are ignored.
        keys: Key of each row.
        headings: Heading of each row in radians, or None for rows without a known heading.
        sensor: Depth range, and the value that marks missing depth.
        normalised: Whether depth is normalised to [0, 1] over the sensor's range; otherwise it is
            in metres.
        backend: As in ``corrupt_tensors``.

    Returns:
        A new dict; entries that are not corrupted in any row are the same objects as in ``frames``.

    Raises:
        ValueError: If a modality is missing, if normalised depth is above 1, if there is not one
            corruption, key and heading per row, or if ``corrupt_tensors`` raises an error.
    """
    result = dict(frames)
    if headings is None:
        headings = [None] * len(keys)
    counts = {len(corruptions), len(keys), len(headings), *map(len, frames.values())}
    if len(counts) > 1:
        raise ValueError(
            "There must be one corruption, key and heading per row of the frames, got "
            f"{len(corruptions)} corruptions, {len(keys)} keys, {len(headings)} headings and "
            f"{[len(batch) for batch in frames.values()]} rows."
        )
    parts = [check_corruption(corruption).parts for corruption in corruptions]
    depth_rows = [row for row, c in enumerate(corruptions) if DEPTH in c.modalities]
    if normalised and DEPTH in frames and depth_rows:
        check_sensor(sensor)
        result[DEPTH] = _to_metres(frames[DEPTH], depth_rows, sensor)
    metres = result.get(DEPTH)
    for position in range(max(map(len, parts), default=0)):
        groups: dict[str, list[int]] = {}
        for row, of_row in enumerate(parts):
            if position < len(of_row) and of_row[position].modality not in OF_NO_FRAME:
                groups.setdefault(of_row[position].name, []).append(row)
        for name, rows in groups.items():
            for entry in changed_entries(result, Corruption(name, 0.0)):
                if result[entry] is frames[entry] or result[entry] is metres:
                    result[entry] = result[entry].clone()
                index = torch.tensor(rows, device=result[entry].device)
                result[entry][index] = corrupt_tensors(
                    result[entry][index],
                    name,
                    [corruptions[row].severity for row in rows],
                    keys=[keys[row] for row in rows],
                    headings=[headings[row] for row in rows],
                    sensor=sensor,
                    backend=backend,
                )
    if metres is not None and metres is not frames[DEPTH]:
        result[DEPTH] = _normalise(result[DEPTH], metres, frames[DEPTH], sensor)
    return result


def _to_metres(depth: Tensor, rows: Sequence[int], sensor: DepthSensor) -> Tensor:
    """Convert normalised depth to metres, with 0 at invalid pixels.

    Raises ValueError if depth in one of the ``rows`` is above 1.
    """
    invalid = ~is_valid(depth)
    most = float(depth.masked_fill(invalid, 0.0)[rows].amax())
    if most > 1.0:
        raise ValueError(
            f"Normalised depth must be between 0 and 1, got {most:g}. For depth in metres, set "
            "normalised=False."
        )
    metres = sensor.z_min + depth * (sensor.z_max - sensor.z_min)
    return metres.masked_fill(invalid, 0.0)


def _normalise(corrupted: Tensor, metres: Tensor, clean: Tensor, sensor: DepthSensor) -> Tensor:
    """Convert depth to [0, 1]; pixels that did not change keep their clean values."""
    unit = (corrupted - sensor.z_min) / (sensor.z_max - sensor.z_min)
    unit = unit.clamp(float(LEAST), 1.0).masked_fill(corrupted <= 0, 0.0)
    return torch.where(corrupted == metres, clean, unit)
