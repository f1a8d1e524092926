"""Corrupt batches of Habitat observations whose frames are torch tensors, on the device of the
tensors.

Habitat's batch renderer and ``HABITAT_SIM`` with ``gpu_gpu: True`` keep frames on the GPU.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from torch import Tensor

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import Corruption, DepthSensor, Key
from mitigate.corruptions.suite import SENSOR
from mitigate.corruptions.tensors import corrupt_observations
from mitigate.worlds.habitat import camera_views, check_cameras, check_turn


def corrupt_habitat_tensors(
    observations: Mapping[str, Tensor],
    corruptions: Sequence[Corruption],
    keys: Sequence[Key],
    sensor: DepthSensor = SENSOR,
    *,
    headings: Sequence[float | None] | None = None,
    turn: str = "left",
    normalised: bool = True,
    backend: str | None = None,
) -> dict[str, Tensor]:
    """Corrupt the cameras of a batch of observations.

    Each row of the result equals ``corrupt_habitat`` applied to that row.

    Args:
        observations: entries ``rgb*`` are uint8 [B, H, W, 3], and entries ``depth*`` are float32
            [B, H, W, 1] or [B, H, W]. Tensors may be on any device. All cameras of a modality have
            the same size.
        corruptions: Corruption of each row.
        keys: Key of the random numbers of each row, which is Key(seed, episode id, step).
        sensor: Depth range of the camera: 0 to 10 m for R2R-CE (the default), ``DepthSensor(0.5,
            5.0)`` for RxR-CE.
        headings: Heading of the agent in each row, in radians, counter-clockwise. Unknown headings
            are None.
        turn: Direction from ``rgb`` to ``rgb_30``: "left" (ETPNav) or "right".
        normalised: Whether depth is normalised to [0, 1]. If false, depth is in metres.
        backend: As in ``corrupt_tensors``.

    Returns:
        A new dictionary with the same entries, dtypes, shapes and devices. Entries that no
        corruption changes are not copied.

    Raises:
        ValueError: If no camera has the modality of a corruption. If the yaw of a camera is
            not 0, 30, ..., or 330 degrees, or if cameras of one modality have the same yaw or
            different sizes. Errors of ``corrupt_observations`` are passed on.
    """
    check_turn(turn)
    parts = [part for corruption in corruptions for part in corruption.parts]
    check_cameras(observations, {part.name for part in parts})
    cameras = {
        modality: camera_views(observations, modality, turn)
        for modality in (RGB, DEPTH)
        if any(modality in part.modalities for part in parts)
    }
    frames = {modality: _panoramas(observations, views) for modality, views in cameras.items()}
    corrupted = corrupt_observations(
        frames,
        corruptions,
        keys,
        headings=headings,
        sensor=sensor,
        normalised=normalised,
        backend=backend,
    )
    result = dict(observations)
    for modality, views in cameras.items():
        for entry, view in views.items():
            result[entry] = corrupted[modality][:, view].reshape(observations[entry].shape)
    return result


def _panoramas(observations: Mapping[str, Tensor], views: Mapping[str, int]) -> Tensor:
    """Return the frames as one tensor [B, V, H, W, C].

    The index on the second axis is the view number. V is the largest view number plus 1. Views
    without a camera are filled with zeros.
    """
    first = observations[next(iter(views))]
    for entry in views:
        frames = observations[entry]
        if frames.shape != first.shape or frames.dtype != first.dtype or frames.dim() not in (3, 4):
            raise ValueError(
                "All cameras of a panorama must have the same dtype and shape [B, H, W, channels], "
                f"got {frames.dtype} {list(frames.shape)} for {entry!r} and {first.dtype} "
                f"{list(first.shape)} for {next(iter(views))!r}."
            )
    shape = (*first.shape[:3], first.shape[3] if first.dim() == 4 else 1)
    panorama = first.new_zeros((shape[0], 1 + max(views.values()), *shape[1:]))
    for entry, view in views.items():
        panorama[:, view] = observations[entry].reshape(shape)
    return panorama
