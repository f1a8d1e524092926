"""Summarise what was read from a recording, and warn about views that agents cannot use well."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mitigate.core.names import counted, escaped
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.worlds.recorded.source import Lens, Source

if TYPE_CHECKING:
    from mitigate.worlds.recorded.recording import Recording, Step

# Heuristic limits of warnings.
MAX_BORDER = 0.1  # maximum fraction of a view's pixels that are border
NEAR_MEDIAN = 0.2  # median depth in metres
FAR_MEDIAN = 10.0


@dataclass(frozen=True)
class Camera:
    """The camera of a sensor that faces forward.

    ``shape`` is the height and width of the images in pixels. ``format`` describes where and how
    the images are stored. ``border`` is the fraction of a view's pixels that lie outside the
    camera's field of view.
    """

    lens: Lens
    shape: tuple[int, int]
    format: str
    border: float


def describe(
    source: Source, recording: Recording, cameras: Mapping[str, Camera], step: Step
) -> list[str]:
    """Return one line each for the drive, its cameras, its pose and its instruction.

    ``cameras`` maps each sensor to the camera that faces forward. ``step`` is the distance between
    two time steps.
    """
    seconds = float(source.times[-1] - source.times[0])
    drive = f"{recording.name}: {counted(len(recording.times), 'step')}"
    if source.stepped:
        drive += ", one per frame"
    elif seconds > 0:
        rate = (len(source.times) - 1) / seconds
        distance = f"{step.metres:g} m or {step.degrees:g} degrees"
        distance = f"{step.seconds:g} s" if recording.poses is None else distance
        drive += f", one per {distance}, from {seconds:.1f} s with {rate:.3g} frames per second"
    if source.dropped:
        drive += f"; {source.dropped} frames without a match in time were left out"
    if source.damaged:
        drive += f"; {counted(len(source.damaged), 'damaged image')} left out"
    lines = [drive]
    view = recording.hfov
    for kind, camera in cameras.items():
        height, width = camera.shape
        across, down = camera.lens.fields_of_view(height, width)
        assumed = " (assumed)" if camera.lens.assumed else ""
        line = f"{kind}: {camera.format}, {width} x {height}, {across:.0f} x {down:.0f} degrees"
        line += f"{assumed}, seen as {view:.0f} x {view:.0f}"
        if camera.border >= 0.005:
            nothing = "a black border" if kind == RGB else "a border without reading"
            line += f"; {100 * camera.border:.0f} % of each view is {nothing}"
        if kind == DEPTH:
            line += f"; {_depth_range(recording.frames[DEPTH], camera.border)}"
        lines.append(line)
    if recording.poses is None:
        lines.append(
            f"{POSE}: none, so agents receive the motion of the actions that they chose for the "
            "clean frames"
        )
    else:
        metres = np.hypot(*np.diff(recording.poses[:, :2], axis=0).T).sum()
        lines.append(f"{POSE}: {source.formats.get(POSE, 'yes')}, {metres:.1f} m driven")
    text = escaped(recording.instruction)
    lines.append(f'instruction: "{text}"' if text else "instruction: none")
    return lines


def _depth_range(depth: np.ndarray, border: float) -> str:
    """Describe depth by its median, its maximum and the fraction of missing readings."""
    readings = depth[depth > 0]
    if not len(readings):
        return "no readings"
    missing = 1 - len(readings) / depth.size
    inside = max(0.0, (missing - border) / max(1e-9, 1 - border))
    return (
        f"median {np.median(readings):.2g} m, maximum {readings.max():.2g} m, "
        f"{100 * inside:.0f} % without reading inside the image"
    )


def warn_about(source: Source, recording: Recording, cameras: Mapping[str, Camera]) -> None:
    """Warn about a large border, an implausible scale of depth, or a missing instruction."""
    name = recording.name
    border = max(camera.border for camera in cameras.values())
    if border > MAX_BORDER:
        warnings.warn(
            f"{name}: {100 * border:.0f} % of each view is a border, because the camera covers "
            "less than 90 x 90 degrees. The border acts as a corruption of the clean frames. "
            "crop=true removes it, but then objects look larger than in training.",
            stacklevel=3,
        )
    if DEPTH in recording.frames:
        depth = recording.frames[DEPTH]
        median = float(np.median(depth[depth > 0])) if (depth > 0).any() else 1.0
        if not NEAR_MEDIAN <= median <= FAR_MEDIAN:
            warnings.warn(
                f"{name}: the median depth is {median:.3g} m, which is unusual for a robot "
                f"indoors. Check the scale. {source.depth_advice}",
                stacklevel=3,
            )
    if not recording.instruction:
        warnings.warn(
            f"{name} has no instruction, so agents receive an empty text. Set instruction=.",
            stacklevel=3,
        )
