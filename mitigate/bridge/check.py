"""``mitigate run --check -- COMMAND``: run a program up to its first frames, and stop it.

The check prints the cameras, the instruction and the applicable conditions, and writes a
picture of corrupted frames.
"""

from __future__ import annotations

import io
import textwrap
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mitigate.bridge.attempt import Attempt
from mitigate.bridge.cameras import Group, Rig, corrupt_group
from mitigate.bridge.condition import Observer, needs_tokenizer, why_not_applicable
from mitigate.bridge.config import RunConfig
from mitigate.bridge.plan import make_cells, make_plan
from mitigate.bridge.results import NORMALISED_HINT, NORMALISED_LIMIT, Reports
from mitigate.core.files import write_bytes, write_figure
from mitigate.core.names import counted
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.output import output_folder
from mitigate.core.pictures import depth_picture
from mitigate.corruptions import Corruption, Key
from mitigate.corruptions.record import TEMPORAL
from mitigate.corruptions.registry import record
from mitigate.evaluation.plots import plain
from mitigate.guards.guard import NO_GUARDS, Guards

# maximum seconds until the first frame (heuristic); programs load their models first
FIRST_FRAME_LIMIT = 900.0
MAX_DRAWN = 4  # maximum number of cameras of a panorama that the picture shows per row
SIDE = 1.64  # side of one frame in the picture, in inches
LINE_WIDTH = 22  # maximum number of characters per line when camera names are wrapped
HEADING = "heading"  # name of the array in ``first.npz`` that contains the agent's heading
# maximum number of calls to try until a corruption changes a frame (heuristic)
TRIED_CALLS = 40


@dataclass
class FirstFrames(Observer):
    """Observer that writes the frames of the first call to a file."""

    file: Path
    kinds: ClassVar[tuple[str, ...]] = (RGB, DEPTH)

    def frame(
        self, message: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Write the frames of the first call; ignore later calls."""
        if not self.file.is_file():
            frames = {entry_name(c.name): c.read(memory, offsets) for c in rig.cameras}
            heading = message.get("heading")
            frames[HEADING] = np.array([] if heading is None else [heading])
            buffer = io.BytesIO()
            np.savez(buffer, **frames)  # type: ignore[arg-type]
            write_bytes(self.file, buffer.getvalue())


def check(config: RunConfig, command: Sequence[str]) -> Path | None:
    """Run ``command`` up to its first frames; return the path of the picture.

    If the command has no cameras, the result is None.

    Raises:
        ValueError: If an option is invalid, if the command ends before its first frame, or if
            ``FIRST_FRAME_LIMIT`` seconds pass before that frame.
    """
    plan = make_plan(config, command)
    out = Path(config.out or f"{config.runs}/run/{plan.name}-check")
    cells = make_cells(replace(plan, out=out))
    cell = cells[0]
    file = out / "first.npz"
    cell.folder = out / "check"
    file.unlink(missing_ok=True)
    # FirstFrames replaces the recording, which ``mitigate run --check`` does not need
    cell.condition.observer = FirstFrames(file)
    print(f"check: started, its output is in {cell.log}", flush=True)
    attempt = Attempt(cell)
    try:
        with output_folder(out):
            attempt.start()
            _wait(attempt, file)
    finally:
        attempt.kill()
    reports = cell.reports()
    with np.load(file, allow_pickle=False) as entries:
        frames = dict(entries)
    cameras = [camera for camera in reports.cameras if entry_name(camera["name"]) in frames]
    rig = Rig(cameras, config.missing, config.turn)
    print("\n".join(describe(reports, rig, frames, cell.condition.guards)))
    applicable = []
    for other in cells[1:]:
        if reason := why_not_applicable(other.corruption, reports):
            print(f"  {other.name}: not applicable, {reason}")
            continue
        no_tokenizer = needs_tokenizer(other.corruption, reports, other.condition.words)
        applies = "needs tokenizer=, the agent reads tokens" if no_tokenizer else "applies"
        print(f"  {other.name}: {applies}")
        applicable += [p for p in other.corruption.parts if _sensors(p) and not _shows_past(p)]
    if not rig.groups:
        print("no frame is named or described as rgb or depth: nothing to plot", flush=True)
        return None
    kinds = {group.cameras[0].kind for group in rig.groups}
    for kind in sorted({_sensors(part)[0] for part in applicable} - kinds):
        print(f"the first call has no {kind} frame: no {kind} corruption is plotted")
    drawn = [part for part in dict.fromkeys(applicable) if kinds.intersection(_sensors(part))]
    print(f"check: plotting {counted(len(drawn), 'corruption')}", flush=True)
    figure = draw_sheet(rig, frames, drawn, reports.first, config.seed)
    path = write_figure(out / "sheet.png", figure)
    print(f"wrote {path}: the first frame of the agent under each condition", flush=True)
    return path


def _sensors(part: Corruption) -> list[str]:
    """Return the sensors that a single corruption changes."""
    return [kind for kind in record(part.name).modalities if kind in (RGB, DEPTH)]


def _shows_past(part: Corruption) -> bool:
    """Return whether a corruption is a temporal fault that cannot be shown with a single frame.

    Most of these faults repeat earlier frames. The fault ``intermittent`` has no effect of its own:
    it determines when another corruption acts.
    """
    return record(part.name).family == TEMPORAL and record(part.name).draw is not None


def _wait(attempt: Attempt, file: Path) -> None:
    """Wait until the first frames have been written to ``file``."""
    start = time.monotonic()
    last_print = start
    while not file.is_file():
        time.sleep(0.1)
        problem = attempt.poll()
        if problem is not None and not file.is_file():  # a short program can end before this check
            raise ValueError(problem or "the command ended before its first frame.")
        if time.monotonic() - start > FIRST_FRAME_LIMIT:
            raise ValueError(
                f"the command sent no frame within {FIRST_FRAME_LIMIT:g} s."
                f"{attempt.cell.output_excerpt()}"
            )
        if time.monotonic() - last_print > 10:
            last_print = time.monotonic()
            print(f"check: no frame after {last_print - start:.0f} s", flush=True)


def describe(
    reports: Reports, rig: Rig, frames: Mapping[str, np.ndarray], guards: Guards = NO_GUARDS
) -> list[str]:
    """Return lines about the program: its versions, cameras, instruction and restored frames."""
    hello = reports.hellos[0] if reports.hellos else {}
    versions = {"Python": hello.get("python"), "numpy": hello.get("numpy")}
    versions |= {n: hello.get(n.replace("-", "_")) for n in ("habitat", "habitat-sim", "torch")}
    lines = ["program: " + ", ".join(f"{n} {v}" for n, v in versions.items() if v)]
    for group in rig.groups:
        first = group.cameras[0]
        size = " x ".join(map(str, first.shape))
        names = f"  {first.kind}: " + ", ".join(camera.name for camera in group.cameras)
        panorama = f", {len(group.cameras)} as one panorama" if len(group.cameras) > 1 else ""
        hfov = "" if first.hfov is None else f", hfov {first.hfov:g}"
        lines.append(
            f"{names}; {size} {first.dtype}{hfov}{panorama}{_describe_depth(group, frames)}"
        )
    episode, parts = reports.first, []
    if episode:
        parts.append(f"episode {episode['episode']} of {episode['scene']}")
        if episode.get("category"):
            parts.append(f"goal category {episode['category']!r}")
        text = episode.get("text")
        parts.append(f"instruction {text!r}" if text else "no instruction")
    if guards.frames:
        kinds = dict.fromkeys(group.cameras[0].kind for group in rig.groups)
        restored = [kind for kind in kinds if kind in guards.frames]
        nothing = f"none of these, the restorer is for {', '.join(guards.frames)}"
        lines.append(f"restored: {', '.join(restored) or nothing}")
    return [lines[0], "cameras:", *lines[1:], "hears: " + ", ".join(parts), "conditions:"]


def _describe_depth(group: Group, frames: Mapping[str, np.ndarray]) -> str:
    """Describe the declared range of depth and the range in the frames; warn if they differ."""
    first = group.cameras[0]
    if first.kind != DEPTH:
        return ""
    unit = "0 to 1 for" if first.normalised else "metres,"
    declared = f", {unit} {first.sensor.z_min:g} to {first.sensor.z_max:g} m"
    depth = np.concatenate([c.metres(frames[entry_name(c.name)]).ravel() for c in group.cameras])
    depth = depth[np.isfinite(depth) & (depth > 0)]
    if not depth.size:
        return f"{declared}; the frames hold only holes"
    low, median, high = (f"{x:.2f}" for x in (depth.min(), np.median(depth), depth.max()))
    doubtful = not first.normalised and depth.max() < NORMALISED_LIMIT
    warning = f" - {NORMALISED_HINT}" if doubtful else ""
    return f"{declared}; seen {low} to {high} (median {median}) m{warning}"


def entry_name(camera: str) -> str:
    """Return the name of the array in ``first.npz`` that contains a camera's frame.

    The name must not be the name of an argument of ``numpy.savez``.
    """
    return f"camera {camera}"


def draw_sheet(
    rig: Rig,
    frames: Mapping[str, np.ndarray],
    corruptions: Sequence[Corruption],
    first: Mapping[str, Any],
    seed: int,
) -> Figure:
    """Plot a row of clean frames and one row per corruption, for the largest group of cameras.

    If a corruption does not change every frame, its picture shows the first call that it changes.
    Faults that repeat earlier frames are left out.

    Args:
        rig: The cameras.
        frames: The frames of the first call, named by :func:`entry_name`, and the heading.
        corruptions: Corruptions that change at least one kind of frame in ``rig``.
        first: The event that began the first episode; random numbers depend on it.
        seed: The corruption seed.
    """
    scene = str(first.get("scene", "")).rpartition("/")[2]
    episode = f"{scene}/{first.get('episode', '')}"
    heading = float(frames[HEADING][0]) if frames[HEADING].size else None
    by_kind = {group.cameras[0].kind: group for group in reversed(rig.groups)}
    clean = {kind: _views(group, frames) for kind, group in by_kind.items()}
    rows = [([f"clean {kind}"], by_kind[kind], views) for kind, views in clean.items()]
    for corruption in corruptions:
        kind = next(kind for kind in _sensors(corruption) if kind in by_kind)
        group, before = by_kind[kind], clean[kind]
        for call in range(TRIED_CALLS):
            key = Key(seed, episode, call)
            views = corrupt_group(group, before.copy(), corruption, key, heading, group.stream())
            if not np.array_equal(views, before, equal_nan=True):
                note = f"at call {call}" if call else ""
                break
        else:
            note = f"no change in {TRIED_CALLS} calls"
            print(f"  {corruption.name}: {note} with the first frame", flush=True)
        rows.append(([corruption.name, note], group, views))
    columns = 1 + min(MAX_DRAWN, max(len(group.cameras) for _, group, _ in rows))
    figure = Figure(figsize=(SIDE * columns, SIDE * len(rows)), dpi=100, layout="constrained")
    for axes, row in zip(figure.subplots(len(rows), columns, squeeze=False), rows, strict=True):
        _draw_row(axes, *row)
    return figure


def _views(group: Group, frames: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the frames of a group, [views, ...]; views without a camera are filled with zeros."""
    views = np.zeros(group.shape, group.cameras[0].dtype)
    for camera, view in zip(group.cameras, group.views, strict=True):
        views[view] = frames[entry_name(camera.name)]
    return views


def _draw_row(axes: Sequence[Axes], names: Sequence[str], group: Group, views: np.ndarray) -> None:
    """Plot each name with its cameras below it, and the frames to the right of both."""
    for axis in axes:
        axis.axis("off")
    drawn = list(zip(group.cameras, group.views, strict=True))[:MAX_DRAWN]
    cameras = textwrap.fill(", ".join(camera.name for camera, _ in drawn), LINE_WIDTH)
    text = "\n".join([*filter(None, names), cameras])
    axes[0].text(0, 0.5, plain(text), va="center", fontsize=8)
    for axis, (camera, view) in zip(axes[1:], drawn, strict=False):
        frame = views[view]
        if camera.kind == DEPTH:
            metres = camera.metres(frame.reshape(frame.shape[:2]).astype(np.float32))
            frame = depth_picture(metres, camera.sensor.z_max)
        axis.imshow(frame)
