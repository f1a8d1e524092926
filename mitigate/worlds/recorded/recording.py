"""Load a recorded drive as observations for an agent, and replay it as a world.

The frames of each camera are cropped and resized to square views of 90 degrees, the field of view
that agents expect. Pixels outside the recorded image are black, or missing depth (``views.py``).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import cv2
import numpy as np

from mitigate.core.observation import (
    DEPTH,
    FORWARD,
    FORWARD_METRES,
    HFOV_DEGREES,
    LEFT,
    POSE,
    RGB,
    RIGHT,
    STOP,
    TURN_DEGREES,
    VIEWS,
    Observation,
    Sensor,
    cameras,
)
from mitigate.core.progress import Progress
from mitigate.worlds.episodes import Episode, placeless_episode
from mitigate.worlds.recorded.source import Source
from mitigate.worlds.recorded.summary import Camera, describe, warn_about
from mitigate.worlds.recorded.views import border_fraction, covered_tangent, square_view
from mitigate.worlds.world import World, check_metres

# action number of a motion that no action describes, such as driving backwards or sideways
NO_ACTION = -1

OBSERVED = "observation."  # prefix of the names of signals that an agent may read

# The limits below are heuristic.
# A new step begins when the motion since the last step exceeds this fraction of ``Step``.
# The fraction is below 1, so that rounding does not lose a motion of exactly one step.
STEP_TOLERANCE = 0.98
MIN_MOVE = 0.05  # in metres; the odometry of a robot that stands still varies by less than this
# if the last step is shorter than this fraction of ``Step``, it is merged into the previous step
MIN_LAST_STEP = 0.5
MAX_FRAME_BYTES = 1 << 32  # maximum number of bytes that all frames of a drive may take
# a warning is given if more than this fraction of moving steps goes backwards or sideways
MAX_OFF_HEADING = 1 / 3
MIN_MOVING_STEPS = 5  # minimum number of moving steps for a warning about the heading
MIN_READABLE = 0.5  # minimum fraction of steps whose images are undamaged
# maximum angle in degrees between a camera and the view of the panorama that it provides
MAX_YAW_ERROR = 3.0


@dataclass(frozen=True)
class Recording:
    """One recorded drive of T steps, loaded into memory.

    Attributes:
        name: Name of the drive.
        instruction: Instruction text, which may be empty.
        frames: "rgb" (uint8 [T, S, S, 3]) and "depth" in metres (float32 [T, S, S, 1]). With 12
            views, the shapes are [T, 12, S, S, C]. Sensors that were not recorded are absent.
        times: float64 [T], in seconds since the first step.
        poses: float64 [T, 3], (x, y, heading), or None if unknown.
        driven: The driver's actions, or None if the poses are unknown.
        signals: Recorded numbers by name, such as "action": float64 [T, size].
        hfov: Field of view of the square views in degrees.
        summary: Description of what was read, with one line of text for the drive and one per
            sensor.
    """

    name: str
    instruction: str
    frames: Mapping[str, np.ndarray]
    times: np.ndarray
    poses: np.ndarray | None
    driven: Driven | None
    signals: Mapping[str, np.ndarray] = field(default_factory=dict)
    hfov: float = HFOV_DEGREES
    summary: Sequence[str] = ()

    @property
    def sensors(self) -> dict[str, Sensor]:
        """The recorded sensors by name (see ``core/observation.py``)."""
        first = next(iter(self.frames.values()))
        sensors = cameras(first.shape[-2], first.shape[1] if first.ndim == 5 else 1)
        recorded = {*self.frames, *([] if self.poses is None else [POSE])}
        return {
            name: replace(sensor, hfov=sensor.hfov and self.hfov)
            for name, sensor in sensors.items()
            if name in recorded
        }


def load(source: Source, *, views: int, size: int, step: Step, crop: bool = False) -> Recording:
    """Load the frames of ``source`` at times that are one agent step apart.

    Args:
        source: An opened drive.
        views: Number of views per frame: 1 for one camera, or 12 for a panorama.
        size: Height and width of a view in pixels.
        step: Distance between two chosen time steps.
        crop: Whether to crop views to the largest square field of view that all cameras cover. If
            false, views have a field of view of 90 degrees and may have a black border.

    Returns:
        The drive with its frames in memory. Steps with a damaged image are left out.

    Raises:
        ValueError: If the source lacks a camera or is too large, or most of its images are damaged.
    """
    if source.stepped and step != Step():
        raise ValueError(
            f"step.* has no effect on {source.name}, which is recorded step by step. Remove step.*."
        )
    steps = np.arange(len(source.times))
    chosen = steps if source.stepped else step.choose(source.times, source.poses)
    view_cameras = _assign_cameras(source, views)
    pixel_bytes = {RGB: 3, DEPTH: 4}
    needed = len(chosen) * size * size * sum(pixel_bytes[kind] for kind, _ in view_cameras)
    if needed > MAX_FRAME_BYTES:
        longer = "" if source.stepped else " set longer steps (step.metres=0.5),"
        raise ValueError(
            f"The frames of {source.name} must take at most {MAX_FRAME_BYTES >> 30} GiB, got "
            f"{needed / 2**30:.1f} GiB. Shorten or split the recording,{longer} or use smaller "
            "frames (size=)."
        )
    frames, readable, shapes, tangent = _read_views(
        source, chosen.tolist(), view_cameras, size, crop
    )
    chosen = chosen[readable]
    if DEPTH in frames:
        check_metres(frames[DEPTH], f"the depth of {source.name}", source.depth_advice)
    poses = None if source.poses is None else source.poses[chosen]
    times = source.times[chosen] - source.times[0]
    driven = None
    if poses is not None:
        driven = driver_actions(poses)
        _check_headings(source.name, poses, driven)
    signals = {name: values[chosen] for name, values in source.signals.items()}
    hfov = 2 * math.degrees(math.atan(tangent))
    recording = Recording(
        source.name, source.instruction, frames, times, poses, driven, signals, hfov
    )
    cameras = {
        kind: Camera(
            source.cameras[name],
            shapes[name],
            source.formats.get(name, name),
            border_fraction(source.cameras[name], *shapes[name], tangent),
        )
        for (kind, view), name in view_cameras.items()
        if view == 0
    }
    warn_about(source, recording, cameras)
    return replace(recording, summary=describe(source, recording, cameras, step))


def _read_views(
    source: Source,
    chosen: Sequence[int],
    view_cameras: Mapping[tuple[str, int], str],
    size: int,
    crop: bool,
) -> tuple[dict[str, np.ndarray], np.ndarray, dict[str, tuple[int, int]], float]:
    """Read the square views at the chosen time steps. :func:`load` describes the arguments.

    Returns:
        The tuple (frames, readable, shapes, tangent). ``frames`` contains the frames of the
        readable steps in the format of :class:`Recording`. ``readable`` (bool [T]) states whether
        all images of a chosen step could be read. ``shapes`` contains the height and width of each
        camera's images. ``tangent`` is the tangent of half the field of view of the square views.
    """
    views = 1 + max(view for _, view in view_cameras)
    shape = (len(chosen), *([views] if views > 1 else []), size, size)
    frames = {
        kind: np.zeros((*shape, 3 if kind == RGB else 1), np.uint8 if kind == RGB else np.float32)
        for kind, _ in view_cameras
    }
    readable = np.ones(len(chosen), bool)
    shapes: dict[str, tuple[int, int]] = {}
    tangent = 1.0
    with Progress(f"read {source.name}", len(chosen), unit="instant") as progress:
        for row, images in enumerate(source.frames(chosen)):
            progress.advance()
            readable[row] = bool(images)
            if not images:
                continue
            camera = ", ".join(view_cameras.values())
            try:
                if not shapes:
                    shapes = {name: images[name].shape[:2] for name in view_cameras.values()}
                    lenses = [(source.cameras[name], shapes[name]) for name in shapes]
                    tangent = covered_tangent(lenses) if crop else 1.0
                for (kind, view), camera in view_cameras.items():
                    target = frames[kind][row] if views == 1 else frames[kind][row, view]
                    target[...] = square_view(images[camera], source.cameras[camera], size, tangent)
            except (ValueError, cv2.error) as error:
                raise ValueError(f"{source.name}, {camera}: {error}.") from error
        if not readable.all():
            damage = (
                f"{(~readable).sum()} of {len(readable)} steps with damaged images, the first "
                f"because {source.damaged[0]}"
            )
            if readable.mean() < MIN_READABLE:
                raise ValueError(f"{source.name} has {damage}. Choose another topic.")
            progress.say(f"{source.name}: left out {damage}")
            frames = {kind: array[readable] for kind, array in frames.items()}
        if source.dropped:
            progress.say(f"{source.name}: left out {source.dropped} frames without a match in time")
    return frames, readable, shapes, tangent


def kinds(source: Source, views: int) -> list[str]:
    """Return which kinds of frames ("rgb", "depth") :func:`load` would read.

    Raises:
        ValueError: If the source lacks a camera.
    """
    return sorted({kind for kind, _ in _assign_cameras(source, views)}, reverse=True)


def _assign_cameras(source: Source, views: int) -> dict[tuple[str, int], str]:
    """Return the camera of each (kind, view), for the front view or the whole panorama."""
    assigned: dict[tuple[str, int], str] = {}
    for name, lens in source.cameras.items():
        yaw_error = abs((lens.yaw - 30.0 * lens.view + 180) % 360 - 180)
        if yaw_error > MAX_YAW_ERROR or (views == 1 and lens.view != 0):
            continue
        if (lens.kind, lens.view) in assigned:
            raise ValueError(
                f"{source.name} has two {lens.kind} cameras that face the same way, {name} and "
                f"{assigned[lens.kind, lens.view]}. Choose one, for example cameras=[rgb,depth]. "
                f"Cameras: {_list_cameras(source)}."
            )
        assigned[lens.kind, lens.view] = name
    for kind in sorted({kind for kind, _ in assigned}, reverse=True):
        count = sum(k == kind for k, _ in assigned)
        if count < views:
            raise ValueError(
                f"{source.name} has {count} {kind} cameras of the {VIEWS} that the agent's "
                f"panorama needs, one every 30 degrees. Cameras: {_list_cameras(source)}. Use "
                "agents with one camera: agents=[checkpoints/recurrent/base]."
            )
    if not assigned:
        raise ValueError(
            f"{source.name} has no camera that faces forward. Cameras: {_list_cameras(source)}."
        )
    return assigned


def _list_cameras(source: Source) -> str:
    """Return a text that lists the cameras of a source, for error messages."""
    cameras = source.cameras.items()
    listed = [f"{name} ({lens.kind}, {lens.yaw:g} degrees)" for name, lens in cameras]
    return ", ".join(listed[:6]) + (" ..." if len(listed) > 6 else "") or "none"


def _check_headings(name: str, poses: np.ndarray, driven: Driven) -> None:
    """Warn if too many moving steps have a direction that differs from the heading."""
    moves = np.hypot(*np.diff(poses[:, :2], axis=0).T) >= MIN_MOVE
    moves &= np.isin(driven.actions[:-1], (FORWARD, NO_ACTION))
    off_heading = int((driven.actions[:-1][moves] == NO_ACTION).sum())
    moving = int(moves.sum())
    if moving >= MIN_MOVING_STEPS and off_heading > MAX_OFF_HEADING * moving:
        warnings.warn(
            f"{name}: {off_heading} of {moving} steps that move go backwards or sideways. Check "
            "the heading: it is counter-clockwise from +y, in radians. For a bag, yaw= sets the "
            "direction of its camera.",
            stacklevel=3,
        )


class RecordedWorld(World):
    """World that replays a recording. Each step returns the next recorded observation, independent
    of the action.

    The episode ends after the last recorded step. Success cannot be measured in a recording.
    """

    rule = "recorded: the way is the driver's"

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.sensors = recording.sensors
        self.index = 0
        self.done = True

    def episode(self) -> Episode:
        """Return an episode with the name and the instruction of the recorded drive."""
        return placeless_episode(self.recording.name, self.recording.instruction)

    def reset(self, episode: Episode) -> Observation:
        self.index = 0
        self.done = False
        return self._observation()

    def step(self, action: int) -> Observation:
        """Return the next recorded observation.

        When the episode ends, return the last observation again.
        """
        if self.done:
            raise RuntimeError("The recording is over. Call reset() before step().")
        self.index += 1
        self.done = self.index >= len(self.recording.times)
        return self._observation()

    def measures(self) -> dict[str, float]:
        """Return an empty dict, because the driver and not the agent chose the path."""
        return {}

    def _observation(self) -> Observation:
        index = min(self.index, len(self.recording.times) - 1)
        poses = self.recording.poses
        ready = {
            name: values[index].astype(np.float32)
            for name, values in self.recording.signals.items()
            if name.startswith(OBSERVED)  # an agent must not read the recorded action
        }
        if poses is not None:
            ready[POSE] = poses[index].astype(np.float32)
        frames = self.recording.frames
        return Observation(ready, lambda: {n: f[index].copy() for n, f in frames.items()}, frames)


@dataclass(frozen=True)
class Step:
    """Distance between two observations of an agent. The default is the size of an agent's actions.

    Attributes:
        metres: Distance in metres that the agent moves between two observations.
        degrees: Angle in degrees that the agent turns between two observations.
        seconds: Time in seconds between two observations; used only if poses are unknown.

    Raises:
        ValueError: If a value is not above 0.
    """

    metres: float = FORWARD_METRES
    degrees: float = TURN_DEGREES
    seconds: float = 0.5

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"step.{name} must be above 0, got {value:g}.")

    def share(self, before: np.ndarray, after: np.ndarray) -> float:
        """Return the distance between two poses [3] as a fraction of a step."""
        moved = float(np.hypot(*(after[:2] - before[:2]))) / self.metres
        return max(moved, abs(turn(before[2], after[2])) / math.radians(self.degrees))

    def choose(self, times: np.ndarray, poses: np.ndarray | None) -> np.ndarray:
        """Choose the recorded times at which an agent receives an observation.

        The earliest time is always chosen. A later time is chosen if it is about one step or more
        after the previously chosen time. If poses are known, the final time is also chosen. If the
        final two chosen times then have nearly the same pose, only the final time is kept.

        Args:
            times: float64 [N], seconds.
            poses: float64 [N, 3], or None if unknown.

        Returns:
            Indices of the chosen times, int [T].
        """
        chosen = [0]
        for index in range(1, len(times)):
            previous = chosen[-1]
            if poses is None:
                is_step = times[index] - times[previous] >= self.seconds
            else:
                is_step = self.share(poses[previous], poses[index]) > STEP_TOLERANCE
            if is_step:
                chosen.append(index)
        end = len(times) - 1
        if chosen[-1] != end and poses is not None:
            if len(chosen) > 1 and self.share(poses[chosen[-1]], poses[end]) < MIN_LAST_STEP:
                chosen.pop()
            chosen.append(end)
        return np.array(chosen)


@dataclass(frozen=True)
class Driven:
    """The driver's motion at each of T steps. The last motion is STOP.

    Attributes:
        actions: int [T], the agent action that is most similar to the motion, or ``NO_ACTION``.
        metres: float [T], forward motion in metres; negative values mean backwards.
        radians: float [T], angle in radians turned to the left.
    """

    actions: np.ndarray
    metres: np.ndarray
    radians: np.ndarray


def turn(before: float, after: float) -> float:
    """Return the angle in radians by which the heading turned to the left, from -pi to pi."""
    return float((after - before + math.pi) % (2 * math.pi) - math.pi)


def driver_actions(poses: np.ndarray) -> Driven:
    """Return the motions between the poses [T, 3]. The last action is STOP.

    If a step both moves and turns, the larger part determines its action. The parts are compared in
    units of 0.25 m and 15 degrees.
    """
    count = len(poses)
    actions = np.full(count, STOP)
    metres = np.zeros(count)
    radians = np.zeros(count)
    for index in range(count - 1):
        before = poses[index]
        after = poses[index + 1]
        dx, dy = after[:2] - before[:2]
        radians[index] = turn(before[2], after[2])
        middle = before[2] + radians[index] / 2
        ahead = -dx * math.sin(middle) + dy * math.cos(middle)
        sideways = abs(dx * math.cos(middle) + dy * math.sin(middle))
        metres[index] = ahead
        turned = abs(radians[index]) / math.radians(TURN_DEGREES)
        if turned >= math.hypot(ahead, sideways) / FORWARD_METRES:
            actions[index] = LEFT if radians[index] > 0 else RIGHT if turned > 0 else NO_ACTION
        else:
            actions[index] = FORWARD if ahead > sideways else NO_ACTION
    return Driven(actions, metres, radians)


def movements(actions: np.ndarray) -> Driven:
    """Return the motions of a driver who executes ``actions`` exactly."""
    turned = math.radians(TURN_DEGREES) * ((actions == LEFT) * 1.0 - (actions == RIGHT))
    return Driven(actions, FORWARD_METRES * (actions == FORWARD), turned)
