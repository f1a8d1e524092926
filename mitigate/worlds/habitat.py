"""Corrupt Habitat observations (dictionaries of arrays) without importing Habitat.

An observation of ETPNav and similar agents has one entry per camera: ``rgb``, ``rgb_30``, ...,
``rgb_330`` and ``depth``, ``depth_30``, ..., ``depth_330``. The number is the camera's yaw in
degrees. ETPNav gives camera ``rgb_A`` the orientation [0, +A, 0], and Habitat's y axis points up.
So cameras with larger numbers are further to the LEFT; ETPNav's policy reverses this order. In
``mitigate.core.observation``, views with larger numbers are further to the right, so ``rgb_30`` is
view 11.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from mitigate.core.observation import DEPTH, POSE, RGB, VIEW_STEP_DEGREES, VIEWS
from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.normalised import corrupt_normalised
from mitigate.corruptions.registry import family
from mitigate.corruptions.suite import SENSOR, Corruption, check_corruption, corrupt_observation
from mitigate.worlds.modalities import check_available

_CAMERA = re.compile(r"(rgb|depth)(?:_(\d+(?:\.\d+)?))?")


def corrupt_habitat(
    obs: dict,
    corruption: Corruption,
    key: Key,
    sensor: DepthSensor = SENSOR,
    *,
    heading: float | None = None,
    turn: str = "left",
    normalised: bool = True,
) -> dict:
    """Corrupt an observation of Habitat. All cameras of one modality form one panorama.

    By default, depth must be normalised by Habitat (``normalize_depth: True``). Missing depth
    becomes 0, the value that Habitat writes if a ray hits nothing (``sensor.missing`` = 0.0
    metres). If an agent interprets 0 as a near obstacle, use ``DepthSensor(missing=z_max)``.

    Args:
        obs: Observation of one environment at one time step: entries ``rgb*`` are uint8 [H, W, 3],
            and entries ``depth*`` are float32 [H, W, 1] or [H, W]. All cameras of a modality have
            the same size.
        corruption: The corruption.
        key: Key of the random numbers, which is Key(seed, episode id, step).
        sensor: Depth range of the camera: 0 to 10 m for R2R-CE (the default), ``DepthSensor(0.5,
            5.0)`` for RxR-CE.
        heading: Heading of the agent in radians, counter-clockwise, as measured by Habitat's
            ``compass`` and ``heading`` sensors. If it is given, a lens flare keeps its direction in
            the world when the agent turns.
        turn: Direction from ``rgb`` to ``rgb_30``: "left" (ETPNav) or "right".
        normalised: Whether depth is normalised to [0, 1]. If false, depth is in metres.

    Returns:
        A new dictionary with the same entries, order, dtypes, shapes and ranges. Entries that are
        not corrupted are not copied.

    Raises:
        ValueError: If the corruption is a fault, or if no camera has its modality. If the yaw
            of a camera is not 0, 30, ..., or 330 degrees, or if cameras of one modality have the
            same yaw or different sizes. Errors of ``corrupt_normalised`` are passed on.
    """
    check_turn(turn)
    if fault := family(check_corruption(corruption).name):
        raise ValueError(
            f"corrupt_habitat does not support faults, got the {fault} fault {corruption.name!r}. "
            "Use mitigate run, the gymnasium wrapper, or a FrameStream (docs/faults.md)."
        )
    corrupt_frames = corrupt_normalised if normalised else corrupt_observation
    obs = dict(obs)
    for part in corruption.parts:
        modality = part.modality
        if modality in (RGB, DEPTH):
            check_cameras(obs, [part.name])
        views = camera_views(obs, modality, turn)
        frames = {modality: _panorama(obs, views)} if views else {}
        if heading is not None:
            frames[POSE] = np.array([0.0, 0.0, heading])
        corrupted = corrupt_frames(frames, part, key, sensor)
        obs |= {entry: corrupted[modality][view] for entry, view in views.items()}
    return obs


def check_turn(turn: str) -> None:
    """Raise ValueError if ``turn`` is not "left" or "right"."""
    if turn not in ("left", "right"):
        raise ValueError(
            f"turn must be 'left' or 'right', the direction from rgb to rgb_30, got {turn!r}."
        )


def is_camera(entry: str) -> bool:
    """Return whether ``entry`` is the name of an RGB or depth camera in an observation."""
    return _CAMERA.fullmatch(entry) is not None


def check_cameras(entries: Iterable[str], names: Iterable[str]) -> None:
    """Raise ValueError if a corruption changes a modality that no camera has.

    Args:
        entries: Names of the entries of an observation.
        names: Names of corruptions.
    """
    entries = list(entries)
    available = {camera[1] for camera in map(_CAMERA.fullmatch, entries) if camera}
    lack = f"the observation has no camera named {{0}}, {{0}}_30, ... (its entries are {entries})"
    check_available(names, available, lack, "add or rename a camera")


def camera_views(obs: Iterable[str], modality: str, turn: str) -> dict[str, int]:
    """Return the view number (``mitigate.core.observation``) of each camera of a modality."""
    views: dict[str, int] = {}
    for entry in obs:
        camera = _CAMERA.fullmatch(entry)
        if camera is None or camera[1] != modality:
            continue
        steps = float(camera[2] or 0) / VIEW_STEP_DEGREES
        if steps != int(steps) or steps >= VIEWS:
            raise ValueError(
                f"A camera must be at a multiple of {VIEW_STEP_DEGREES:g} degrees below 360, got "
                f"{entry!r}. Corrupt this camera separately with mitigate.corruptions.corrupt."
            )
        view = int(steps) if turn == "right" else -int(steps) % VIEWS
        if view in views.values():
            other = next(name for name, known in views.items() if known == view)
            raise ValueError(
                f"The cameras {other!r} and {entry!r} face the same way. Corrupt one of them "
                "separately with mitigate.corruptions.corrupt."
            )
        views[entry] = view
    return views


def _panorama(obs: dict, views: dict[str, int]) -> np.ndarray:
    """Return the frames as one array [V, ...].

    The index on the first axis is the view number. V is the largest view number plus 1. Views
    without a camera are 0.
    """
    frames = {entry: np.asarray(obs[entry]) for entry in views}
    first = next(iter(frames.values()))
    for entry, frame in frames.items():
        if frame.shape != first.shape or frame.dtype != first.dtype:
            raise ValueError(
                f"All cameras of a panorama must have the same dtype and shape, but "
                f"{next(iter(frames))!r} is {first.dtype} {first.shape} and {entry!r} is "
                f"{frame.dtype} {frame.shape}."
            )
    if first.ndim not in (2, 3):
        raise ValueError(
            f"A camera's frame must be [H, W, channels] or [H, W], got {first.shape}. Pass one "
            "time step of one environment at a time, because every time step has its own key."
        )
    panorama = np.zeros((1 + max(views.values()), *first.shape), first.dtype)
    for entry, view in views.items():
        panorama[view] = frames[entry]
    return panorama
