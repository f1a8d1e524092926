"""A recorded drive as an agent's own cameras would have seen it, and the world that it is.

Frames of any camera become square views of 90 degrees, as agents know them: cut and resized, and
black (no reading in depth) where the camera did not look.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from mitigate.core.observation import (
    DEPTH,
    FORWARD,
    FORWARD_METRES,
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
from mitigate.worlds.episodes import Episode, Instruction
from mitigate.worlds.recorded.source import Lens, Source
from mitigate.worlds.world import World, check_metres

NONE = -1  # what was done is none of an agent's actions: it went back, or sideways
NEARLY = 0.98  # of a step: one of exactly its length must not be missed by rounding (ours)
MOVES = 0.05  # metres: a robot that stands is measured to move by less (ours)
PAUSE = 0.5  # of a step: less is none (ours)

LARGEST = 1 << 32  # bytes of the frames of a drive (ours)
STRANGE = 1 / 3  # of the steps that move: more do not go along the heading by mistake (ours)
ENOUGH = 5  # steps that move, to say so (ours)
OVER = 4  # pixels of a side of what is drawn into, for one of a view that is not filled (ours)
OFF = 3.0  # degrees that a camera may look beside its view of the panorama (ours)


@dataclass(frozen=True)
class Recording:
    """One drive, ready to be walked along.

    frames: "rgb" uint8 [T, S, S, 3] and "depth" float32 metres [T, S, S, 1], of a panorama
    [T, 12, S, S, c]; those that there are. times: float64 [T], seconds since the first.
    poses: float64 [T, 3], or None. driven: what whoever drove did, or None.
    """

    name: str
    instruction: str
    frames: Mapping[str, np.ndarray]
    times: np.ndarray
    poses: np.ndarray | None
    driven: Driven | None

    @property
    def sensors(self) -> dict[str, Sensor]:
        """What it gives, as ``core/observation.py`` says."""
        first = next(iter(self.frames.values()))
        of = cameras(first.shape[-2], first.shape[1] if first.ndim == 5 else 1)
        held = {*self.frames, *([] if self.poses is None else [POSE])}
        return {name: sensor for name, sensor in of.items() if name in held}


def load(source: Source, *, views: int, size: int, step: Step) -> Recording:
    """Read the instants of ``source`` that are a step apart, with ``views`` (1 or 12) views of
    ``size`` pixels.

    Raises ValueError for a source without the cameras, and for one that is too long.
    """
    if source.stepped and step != Step():
        raise ValueError(f"{source.name} is recorded step by step: leave step.* out.")
    chosen = np.arange(len(source.times))
    if not source.stepped:
        chosen = step.choose(source.times, source.poses)
    looks = _looks(source, views)
    count = {RGB: 3, DEPTH: 4}
    needed = len(chosen) * size * size * sum(count[kind] for kind, _ in looks)
    if needed > LARGEST:
        longer = "" if source.stepped else " or set longer steps (step.metres=0.5),"
        raise ValueError(
            f"{source.name} has {len(chosen)} steps, whose frames take {needed / 2**30:.1f} GiB, "
            f"more than {LARGEST >> 30}: cut the recording,{longer} or take smaller frames (size=)."
        )
    shape = (len(chosen), *([views] if views > 1 else []), size, size)
    frames = {
        kind: np.zeros((*shape, 3 if kind == RGB else 1), np.uint8 if kind == RGB else np.float32)
        for kind, _ in looks
    }
    with Progress(f"read {source.name}", len(chosen), unit="instant") as progress:
        for row, shown in enumerate(source.frames(chosen.tolist())):
            for (kind, view), camera in looks.items():
                place = frames[kind][row] if views == 1 else frames[kind][row, view]
                try:
                    place[...] = square(shown[camera], source.cameras[camera], size)
                except (ValueError, cv2.error) as error:
                    raise ValueError(f"{source.name}, {camera}: {error}.") from error
            progress.advance()
        if source.dropped:
            progress.say(
                f"{source.name}: {source.dropped} frames were left out, as no pose or no frame of "
                "the other camera was near in time"
            )
    if DEPTH in frames:
        unit = "Of 16-bit PNG set unit= (metres of a count)."
        check_metres(frames[DEPTH], f"{source.name}'s depth", unit)
    poses = None if source.poses is None else source.poses[chosen]
    times = source.times[chosen] - source.times[0]
    taken = None if poses is None else driven(poses)
    if poses is not None and taken is not None:
        _check_headings(source.name, *strange(poses, taken))
    return Recording(source.name, source.instruction, frames, times, poses, taken)


def kinds(source: Source, views: int) -> list[str]:
    """Of which kinds ("rgb", "depth") are the frames that :func:`load` would read of ``source``;
    raises as it does for a source without the cameras."""
    return sorted({kind for kind, _ in _looks(source, views)}, reverse=True)


def _looks(source: Source, views: int) -> dict[tuple[str, int], str]:
    """Which camera gives which (kind, view): the one ahead, or all of the panorama."""
    looks: dict[tuple[str, int], str] = {}
    for name, lens in source.cameras.items():
        beside = abs((lens.yaw - 30.0 * lens.view + 180) % 360 - 180)
        if beside > OFF or (views == 1 and lens.view != 0):
            continue
        if (lens.kind, lens.view) in looks:
            raise ValueError(
                f"{source.name} has two {lens.kind} cameras that look the same way, {name} and "
                f"{looks[lens.kind, lens.view]}: say which, cameras=[rgb,depth] (it has "
                f"{_told(source)})."
            )
        looks[lens.kind, lens.view] = name
    for kind in sorted({kind for kind, _ in looks}, reverse=True):
        there = sum(k == kind for k, _ in looks)
        if there < views:
            raise ValueError(
                f"{source.name} has {there} {kind} cameras of the {VIEWS} that the agent's "
                f"panorama needs, each 30 degrees from the next (it has {_told(source)}). Give "
                "agents with one camera: agents=[checkpoints/recurrent/base]."
            )
    if not looks:
        raise ValueError(f"{source.name} has no camera that looks ahead, only {_told(source)}.")
    return looks


def _told(source: Source) -> str:
    cameras = source.cameras.items()
    listed = [f"{name} ({lens.kind}, {lens.yaw:g} degrees)" for name, lens in cameras]
    return ", ".join(listed[:6]) + (" ..." if len(listed) > 6 else "") or "none"


def square(frame: np.ndarray, lens: Lens, size: int) -> np.ndarray:
    """A frame as a square view of 90 degrees: uint8 [size, size, 3], or float32 [size, size, 1].

    A frame that is one already, of this size, comes back bit for bit.
    """
    depth = lens.kind == DEPTH
    frame = frame.reshape(*frame.shape[:2], -1)
    height, width = frame.shape[:2]
    fx, fy, cx, cy = lens.of(height, width)
    edges = (cx - fx, cx + fx, cy - fy, cy + fy)
    if min(edges[0], edges[2], width - edges[1], height - edges[3]) < -0.5:
        return _inside(frame, edges, size, depth)
    left, right, top, bottom = (round(edge) for edge in edges)
    whole = frame[max(0, top) : bottom, max(0, left) : right]
    if whole.shape[:2] != (size, size):
        whole = _resized(whole, size, size, depth)
    return whole.reshape(size, size, -1)


def _inside(
    frame: np.ndarray, edges: tuple[float, float, float, float], size: int, depth: bool
) -> np.ndarray:
    """A view of which the frame fills a part: drawn larger, so that its edges fall where they
    are, and then reduced."""
    height, width = frame.shape[:2]
    left, right, top, bottom = edges
    large = OVER * size
    across, down = large / (right - left), large / (bottom - top)
    x0, x1 = (round(min(large, max(0, (x - left) * across))) for x in (0, width))
    y0, y1 = (round(min(large, max(0, (y - top) * down))) for y in (0, height))
    canvas = np.zeros((large, large, frame.shape[2]), frame.dtype)
    if x1 > x0 and y1 > y0:
        cut = frame[max(0, round(top)) : round(bottom), max(0, round(left)) : round(right)]
        canvas[y0:y1, x0:x1] = _resized(cut, x1 - x0, y1 - y0, depth).reshape(y1 - y0, x1 - x0, -1)
    return _resized(canvas, size, size, depth).reshape(size, size, -1)


def _resized(frame: np.ndarray, width: int, height: int, depth: bool) -> np.ndarray:
    """Colours by area where they shrink; of depth the nearest, so that holes stay holes."""
    shrinks = width < frame.shape[1] or height < frame.shape[0]
    kind = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return cv2.resize(
        frame, (width, height), interpolation=cv2.INTER_NEAREST_EXACT if depth else kind
    )


def _check_headings(name: str, strange: int, moves: int) -> None:
    """Warn if too many of the steps that move go another way than the heading."""
    if moves >= ENOUGH and strange > STRANGE * moves:
        warnings.warn(
            f"{name}: {strange} of {moves} steps that move go back or sideways. Does the heading "
            "point along the way? It is counter-clockwise from +y, in radians; of a bag, yaw= says "
            "where its camera looks.",
            stacklevel=3,
        )


class RecordedWorld(World):
    """A world in which every step leads to the next instant of a recording, whatever the agent
    does. It is over after the last one; nobody says how well an agent would have walked."""

    rule = "recorded: the way is the driver's"

    def __init__(self, recording: Recording) -> None:
        self.recording, self.sensors = recording, recording.sensors
        self.at, self.done = 0, True

    def episode(self) -> Episode:
        """What there is to walk: the drive, by its name and instruction."""
        name, nowhere = self.recording.name, (0.0, 0.0, 0.0)
        return Episode(
            episode_id=name,
            trajectory_id=name,
            scene_id=name,
            start_position=nowhere,
            start_rotation=(*nowhere, 1.0),
            goals=(),
            instruction=Instruction(self.recording.instruction),
            reference_path=(),
        )

    def reset(self, episode: Episode) -> Observation:
        """Begin at the first instant."""
        self.at, self.done = 0, False
        return self._seen()

    def step(self, action: int) -> Observation:
        """The next instant. Raises RuntimeError after the last one."""
        if self.done:
            raise RuntimeError("The recording is over: reset first.")
        self.at += 1
        self.done = self.at >= len(self.recording.times)
        return self._seen()

    def measures(self) -> dict[str, float]:
        """None: the way was the driver's."""
        return {}

    def _seen(self) -> Observation:
        at = min(self.at, len(self.recording.times) - 1)
        held = self.recording
        ready = {} if held.poses is None else {POSE: held.poses[at].astype(np.float32)}
        frames = held.frames
        return Observation(ready, lambda: {n: f[at].copy() for n, f in frames.items()}, frames)


@dataclass(frozen=True)
class Step:
    """How far apart the instants are that an agent is shown: as far as its own steps take it.

    metres, degrees: moved or turned since the last one. seconds: where poses are not known. Raises
    ValueError for what is not above 0.
    """

    metres: float = FORWARD_METRES
    degrees: float = TURN_DEGREES
    seconds: float = 0.5

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"step.{name}={value:g} must be above 0.")

    def share(self, before: np.ndarray, after: np.ndarray) -> float:
        """How much of a step lies between two poses [3]."""
        moved = float(np.hypot(*(after[:2] - before[:2]))) / self.metres
        return max(moved, abs(turn(before[2], after[2])) / math.radians(self.degrees))

    def choose(self, times: np.ndarray, poses: np.ndarray | None) -> np.ndarray:
        """Which instants are shown: the first, each that is a step away from the one before, and
        the last, in place of its neighbour if it stands where that does."""
        chosen = [0]
        for index in range(1, len(times)):
            last = chosen[-1]
            if poses is None:
                away = times[index] - times[last] >= self.seconds
            else:
                away = self.share(poses[last], poses[index]) > NEARLY
            if away:
                chosen.append(index)
        end = len(times) - 1
        if chosen[-1] != end and poses is not None:
            if len(chosen) > 1 and self.share(poses[chosen[-1]], poses[end]) < PAUSE:
                chosen.pop()
            chosen.append(end)
        return np.array(chosen)


@dataclass(frozen=True)
class Driven:
    """What was done at each of T steps, the last one included, at which the drive ends.

    actions: int [T], the nearest of an agent's actions, ``NONE`` where none is like it. metres:
    float [T], gone ahead (below 0: back). radians: float [T], turned to the left.
    """

    actions: np.ndarray
    metres: np.ndarray
    radians: np.ndarray


def turn(before: float, after: float) -> float:
    """Radians turned to the left from one heading to another, -pi to pi."""
    return float((after - before + math.pi) % (2 * math.pi) - math.pi)


def driven(poses: np.ndarray) -> Driven:
    """What whoever drove did at poses [T, 3]; at the last, STOP.

    A step that did both counts as what it did more of, one unit being 0.25 m or 15 degrees.
    """
    count = len(poses)
    actions, metres, radians = np.full(count, STOP), np.zeros(count), np.zeros(count)
    for index in range(count - 1):
        before, after = poses[index], poses[index + 1]
        dx, dy = after[:2] - before[:2]
        radians[index] = turn(before[2], after[2])
        middle = before[2] + radians[index] / 2
        ahead = -dx * math.sin(middle) + dy * math.cos(middle)
        aside = abs(dx * math.cos(middle) + dy * math.sin(middle))
        metres[index] = ahead
        turned = abs(radians[index]) / math.radians(TURN_DEGREES)
        if turned >= math.hypot(ahead, aside) / FORWARD_METRES:
            actions[index] = LEFT if radians[index] > 0 else RIGHT if turned > 0 else NONE
        else:
            actions[index] = FORWARD if ahead > aside else NONE
    return Driven(actions, metres, radians)


def strange(poses: np.ndarray, taken: Driven) -> tuple[int, int]:
    """How many of the steps between poses [T, 3] that move, by ``MOVES`` or more, none of an
    agent's actions is like, and how many move."""
    moves = np.hypot(*np.diff(poses[:, :2], axis=0).T) >= MOVES
    moves &= np.isin(taken.actions[:-1], (FORWARD, NONE))
    return int((taken.actions[:-1][moves] == NONE).sum()), int(moves.sum())


def answered(actions: np.ndarray) -> Driven:
    """What would have been done, had the driver taken ``actions``: whole steps."""
    turned = math.radians(TURN_DEGREES) * ((actions == LEFT) * 1.0 - (actions == RIGHT))
    return Driven(actions, FORWARD_METRES * (actions == FORWARD), turned)
