"""Corrupt the observations of a sequence, including faults that depend on earlier frames.

All code that corrupts sequences passes each observation through a ``FrameStream``. For corruptions
of single frames, it gives the same result as ``corrupt_observation``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.corruptions import registry
from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.faults.camera import Mount, total
from mitigate.corruptions.faults.temporal import GATE, OLDEST
from mitigate.corruptions.keying import Key, as_key
from mitigate.corruptions.normalised import corrupt_normalised
from mitigate.corruptions.record import CAMERA, TEMPORAL
from mitigate.corruptions.suite import (
    SENSOR,
    Corruption,
    changed_entries,
    check_corruption,
    check_gate,
    corrupt_observation,
)


def is_timed(corruption: Corruption) -> bool:
    """Return whether a corruption contains a temporal fault."""
    return any(registry.record(part.name).family == TEMPORAL for part in corruption.parts)


def shows_past(corruption: Corruption) -> bool:
    """Return whether a corruption may show a frame of an earlier time step."""
    records = (registry.record(part.name) for part in corruption.parts if part.name != GATE)
    return any(record.family == TEMPORAL and record.draw is not None for record in records)


def mount_of(corruption: Corruption, key: Key) -> Mount | None:
    """Return the camera's displacement in a time step, or None if no camera fault is active."""
    parts = corruption.parts
    if parts and parts[0].name == GATE and not _draw(parts[0], key):
        return None
    mounts = [_draw(p, key) for p in parts if registry.record(p.name).family == CAMERA]
    return total(mounts) if mounts else None


def _draw(part: Corruption, key: Key) -> Any:
    """Return what a fault does in the time step of ``key``."""
    draw = registry.record(part.name).draw
    assert draw is not None, "only faults have a function draw"
    return draw(part.severity, key)


class FrameStream:
    """Corrupts the observations of episodes, one episode after another, in the order of their
    frames.

    For temporal faults, the stream keeps the clean frames of the last time steps. It forgets them
    when the episode of the key changes or its frame number does not increase. So the result depends
    only on the key and the frames of its episode.

    Args:
        sensor: Depth range, and the value that marks missing depth.
        normalised: Whether depth is normalised to [0, 1] over the sensor's range; otherwise it is
            in metres.
        hfov: For each entry, the horizontal field of view in degrees, which camera faults need.
    """

    def __init__(
        self,
        sensor: DepthSensor = SENSOR,
        *,
        normalised: bool = False,
        hfov: Mapping[str, float | None] | None = None,
    ) -> None:
        self.sensor = sensor
        self.hfov = hfov
        self._corrupt = corrupt_normalised if normalised else corrupt_observation
        # frame numbers and frames, by entry
        self._past: dict[str, list[tuple[int, np.ndarray]]] = {}
        self._episode = (0, "")

    def corrupt(
        self,
        obs: Mapping[str, Any],
        corruption: Corruption,
        key: Key | int | str,
        *,
        partial: bool = False,
        displaced: bool = False,
    ) -> dict:
        """Corrupt the frames of the next observation.

        Args:
            obs: The observation (``core/observation.py``); it is not modified.
            corruption: The corruption.
            key: Key of the random numbers; ``key.frame`` is the number of the time step.
            partial: Whether to ignore corruptions of modalities that ``obs`` lacks.
            displaced: Whether the frames were rendered with the camera faults
                (``World.displaced``).

        Returns:
            A new dict; entries that are not corrupted are the same objects as in ``obs``.

        Raises:
            ValueError: For the same reasons as in ``corrupt_observation``.
        """
        key = as_key(key)
        parts = check_gate(check_corruption(corruption)).parts
        parts = tuple(p for p in parts if {*registry.record(p.name).modalities} & {RGB, DEPTH})
        if partial:
            parts = tuple(p for p in parts if {*registry.record(p.name).modalities} & {*obs})
        if displaced:
            parts = tuple(p for p in parts if registry.record(p.name).family != CAMERA)
        if not is_timed(corruption):
            for each in parts if partial or displaced else (corruption,):
                obs = self._corrupt(dict(obs), each, key, self.sensor, self.hfov)
            return dict(obs)
        self.remember(obs, key)
        if parts and parts[0].name == GATE:
            parts = parts[1:] if _draw(parts[0], key) else ()
        changed: dict[str, list[Corruption]] = {}
        for part in parts:
            for entry in changed_entries(obs, part):
                changed.setdefault(entry, []).append(part)
        return {**obs, **{entry: self._arriving(entry, p, key) for entry, p in changed.items()}}

    def remember(self, obs: Mapping[str, Any], key: Key) -> None:
        """Keep the frames and the pose of a time step, because later time steps may show them.

        Raises:
            ValueError: If a frame and the previous frame have different shapes.
        """
        if (key.seed, key.episode) != self._episode:
            self._past.clear()
            self._episode = (key.seed, key.episode)
        for entry in {RGB, DEPTH, POSE}.intersection(obs):
            past = self._past.setdefault(entry, [])
            past[:] = [instant for instant in past if instant[0] < key.frame]
            frame = np.array(obs[entry])
            if past and past[-1][1].shape != frame.shape:
                raise ValueError(
                    f"All {entry} frames of an episode must have the same shape under a temporal "
                    f"fault, got {list(frame.shape)} after {list(past[-1][1].shape)}."
                )
            past.append((key.frame, frame))
            while len(past) > 1 and past[1][0] <= key.frame - OLDEST:
                del past[0]

    def _arriving(self, entry: str, parts: Sequence[Corruption], key: Key) -> np.ndarray:
        """Return the corrupted frame that the agent receives in the time step of ``key``.

        The temporal faults in ``parts`` may select an older frame. All other corruptions are
        applied with the key of the time step at which this frame was recorded.
        """
        frame_shown = key.frame
        for late in (part for part in parts if shows_past(part)):
            frame_shown -= _draw(late, replace(key, frame=frame_shown))
        # the delays of two temporal faults add up, but frames older than OLDEST are not stored
        frame_shown = max(frame_shown, key.frame - OLDEST)
        instant, frame = self._recall(entry, frame_shown)
        arriving: dict[str, Any] = {entry: frame.copy()}
        if POSE in self._past:
            arriving[POSE] = self._recall(POSE, instant)[1]
        then = replace(key, frame=instant)
        for part in (part for part in parts if not shows_past(part)):
            arriving = self._corrupt(arriving, part, then, self.sensor, self.hfov)
        return arriving[entry]

    def _recall(self, entry: str, number: int) -> tuple[int, np.ndarray]:
        """Return the newest stored pair (step number, frame) whose step is at most ``number``.

        If no such pair is stored, return the oldest pair.
        """
        past = self._past[entry]
        return next((instant for instant in reversed(past) if instant[0] <= number), past[0])
