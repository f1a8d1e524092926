"""Corruptions for Habitat's observations, without Habitat: a function on dictionaries.

An observation of ETPNav and its kin has an entry for each camera: ``rgb``, ``rgb_30``, ...,
``rgb_330`` and ``depth``, ``depth_30``, ..., ``depth_330``. The number is the camera's yaw in
degrees from ``rgb`` and ``depth``. ETPNav gives camera ``rgb_A`` the orientation [0, +A, 0], and
Habitat's y axis points up, so a growing number turns LEFT (and its policy reverses the order to
have it clockwise). View k of ``mitigate.core.observation`` turns right: ``rgb_30`` is view 11.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from mitigate.core.observation import DEPTH, POSE, RGB, VIEW_STEP_DEGREES, VIEWS
from mitigate.corruptions import registry
from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.keying import Key
from mitigate.corruptions.normalised import corrupt_normalised
from mitigate.corruptions.suite import (
    NAMES,
    SENSOR,
    Corruption,
    check_corruption,
    corrupt_observation,
)

TURNS = ("left", "right")
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
    """A new observation with all cameras of the modality concerned corrupted as one panorama.

    Entries, their order, dtypes, shapes and ranges stay as they are; other entries are the same
    objects. Depth is Habitat's, normalised by ``normalize_depth: True``: a hole of missing data
    reads 0 (``sensor.missing`` = 0.0 metres), which Habitat writes too where nothing was hit; an
    agent that takes 0 for "near" rather than "no reading" wants ``DepthSensor(missing=z_max)``.

    Args:
        obs: one instant of one environment: ``rgb*`` uint8 [H, W, 3], ``depth*`` float32 [H, W, 1]
            or [H, W]; sizes may differ between the two, not within one.
        corruption, key: what happens, and the name of the draw: Key(seed, episode id, step).
        sensor: 0-10 m for R2R-CE (the default), ``DepthSensor(0.5, 5.0)`` for RxR-CE.
        heading: the agent's, in radians, counter-clockwise (Habitat's ``compass`` and ``heading``
            sensors give it), by which a flare stays at its place in the world.
        turn: where ``rgb_30`` looks from ``rgb``: "left" (ETPNav) or "right".
        normalised: False for depth in metres.

    Raises ValueError if there is no camera of the modality, if a camera's number is no multiple of
    30 degrees below 360, if the sizes of a modality's cameras differ, and as ``corrupt_normalised``
    does.
    """
    if turn not in TURNS:
        raise ValueError(f"turn must be 'left' or 'right', where rgb_30 looks, but it is {turn!r}.")
    if len(check_corruption(corruption).parts) > 1:
        for part in corruption.parts:
            obs = corrupt_habitat(
                obs, part, key, sensor, heading=heading, turn=turn, normalised=normalised
            )
        return obs
    modality = corruption.modality
    if modality in (RGB, DEPTH):
        check_cameras(obs, [corruption.name])
    views = _views(obs, modality, turn)
    frames = {} if not views else {modality: _panorama(obs, views)}
    if heading is not None:
        frames[POSE] = np.array([0.0, 0.0, heading])
    corrupt_frames = corrupt_normalised if normalised else corrupt_observation
    corrupted = corrupt_frames(frames, corruption, key, sensor)
    return {**obs, **{entry: corrupted[modality][view] for entry, view in views.items()}}


def is_camera(entry: str) -> bool:
    """Whether an entry of an observation is an RGB or depth camera by its name."""
    return _CAMERA.fullmatch(entry) is not None


def check_cameras(entries: Iterable[str], names: Iterable[str]) -> None:
    """Raise ValueError if one of the corruptions ``names`` corrupts what no camera gives."""
    entries = list(entries)
    given = {camera[1] for camera in map(_CAMERA.fullmatch, entries) if camera}
    for name in names:
        lost = registry.modality(name)
        if lost not in given:
            fit = ", ".join(name for name in NAMES if registry.modality(name) in given)
            raise ValueError(
                f"{name!r} corrupts {lost}, but the observation holds no camera called {lost}, "
                f"{lost}_30, ... (it holds {', '.join(entries) or 'nothing'}). "
                f"{f'Draw only from names=[{fit}]' if fit else 'Rename the cameras'}, or give the "
                f"robot a {lost} camera of that name."
            )


def _views(obs: dict, modality: str, turn: str) -> dict[str, int]:
    """The view number in ``mitigate.core.observation``' sense of each camera of a modality."""
    views: dict[str, int] = {}
    for entry in obs:
        camera = _CAMERA.fullmatch(entry)
        if camera is None or camera[1] != modality:
            continue
        steps = float(camera[2] or 0) / VIEW_STEP_DEGREES
        if steps != int(steps) or steps >= VIEWS:
            raise ValueError(
                f"The camera {entry!r} is not at a multiple of {VIEW_STEP_DEGREES:g} degrees "
                "below 360, but the suite's panoramas have 12 views 30 degrees apart. Corrupt this "
                "camera by itself with mitigate.corruptions.corrupt."
            )
        view = int(steps) if turn == "right" else -int(steps) % VIEWS
        if view in views.values():
            twin = next(name for name, taken in views.items() if taken == view)
            raise ValueError(
                f"The cameras {twin!r} and {entry!r} look the same way. Corrupt one of them by "
                "itself with mitigate.corruptions.corrupt."
            )
        views[entry] = view
    return views


def _panorama(obs: dict, views: dict[str, int]) -> np.ndarray:
    """[1 + last view, ...]: the frames at their views; views without a camera are zero."""
    frames = {entry: np.asarray(obs[entry]) for entry in views}
    first = next(iter(frames.values()))
    for entry, frame in frames.items():
        if frame.shape != first.shape or frame.dtype != first.dtype:
            raise ValueError(
                f"All cameras of a panorama must be alike, but {next(iter(frames))!r} is "
                f"{first.dtype} {first.shape} and {entry!r} is {frame.dtype} {frame.shape}."
            )
    if first.ndim not in (2, 3):
        raise ValueError(
            f"A camera's frame must be [H, W, channels] or [H, W], but the shape is {first.shape}. "
            "Pass one instant of one environment at a time: every instant has its own key."
        )
    panorama = np.zeros((1 + max(views.values()), *first.shape), first.dtype)
    for entry, view in views.items():
        panorama[view] = frames[entry]
    return panorama
