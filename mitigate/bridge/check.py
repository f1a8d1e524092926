"""``mitigate run --check -- COMMAND``: look at the first frames of a program, and stop it.

Says what it sees and hears, which conditions of the suite apply, and draws what it would see.
"""

from __future__ import annotations

import io
import textwrap
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mitigate.bridge.attempt import Attempt
from mitigate.bridge.cameras import Group, Rig, corrupted
from mitigate.bridge.condition import Observer, applicable, untold
from mitigate.bridge.config import RunConfig, check_options, name_of
from mitigate.bridge.plan import Plan, cells
from mitigate.bridge.results import NEAR, NORMALISED, Told
from mitigate.core.files import write_bytes, write_figure
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.output import output_folder
from mitigate.core.pictures import depth_picture
from mitigate.corruptions import Corruption, Key
from mitigate.evaluation.plots import plain
from mitigate.guards.guard import NO_GUARDS, Guards

LATE = 900.0  # seconds that a program may take to its first frame (ours): models are loaded first
SHOWN = 4  # cameras of a panorama in a row of the sheet
SIDE, WIDE = 1.64, 22  # inches: side of a cell of the sheet; characters of a line of the names
HEADING = "heading"  # beside the cameras in the file of the first frames
TRIED = 40  # calls, until one is taken in which a corruption acts: some come and go (ours)


@dataclass
class FirstLook(Observer):
    """Keeps the frames of the first call in a file."""

    file: Path
    kinds: ClassVar[tuple[str, ...]] = (RGB, DEPTH)

    def frame(
        self, told: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Write the frames, once."""
        if not self.file.is_file():
            frames = {of(c.name): c.read(memory, offsets) for c in rig.cameras}
            heading = told.get("heading")
            frames[HEADING] = np.array([] if heading is None else [heading])
            packed = io.BytesIO()
            np.savez(packed, **frames)  # type: ignore[arg-type]
            write_bytes(self.file, packed.getvalue())


def check(config: RunConfig, command: Sequence[str]) -> Path | None:
    """Run ``command`` up to its first frames; return the path of the sheet, None without cameras.

    Raises ValueError as a run does for its options, and if the command ends before, or shows
    nothing within ``LATE`` seconds.
    """
    check_options(config, command)
    name = config.name or name_of(command)
    out = Path(config.out or f"{config.runs}/run/{name}-check")
    made = cells(Plan(config, tuple(command), "check", out))
    cell, file = made[0], out / "first.npz"
    cell.folder = out / "check"
    file.unlink(missing_ok=True)
    cell.condition.observers[:] = [FirstLook(file)]  # nothing is recorded: it ends in mid-episode
    print(f"check: started, its output is in {cell.log}", flush=True)
    attempt = Attempt(cell)
    try:
        with output_folder(out):
            attempt.start()
            _wait(attempt, file)
    finally:
        attempt.kill()
    told = cell.told()
    with np.load(file, allow_pickle=False) as held:
        frames = dict(held)
    seen = [camera for camera in told.cameras if of(camera["name"]) in frames]
    rig = Rig(seen, config.missing, config.turn)
    print("\n".join(described(told, rig, frames, cell.condition.guards)))
    fitting = []
    for other in made[1:]:
        reason = applicable(other.corruption, told)
        lacks = untold(other.corruption, told, other.condition.words)
        applies = "needs tokenizer=, the agent reads tokens" if lacks else "applies"
        print(f"  {other.name}: {f'not applicable, {reason}' if reason else applies}")
        if not reason:
            fitting += [p for p in other.corruption.parts if p.modality in (RGB, DEPTH)]
    if not rig.groups:
        print("no frame was named as rgb or depth: there is nothing to draw", flush=True)
        return None
    shown = {group.cameras[0].kind for group in rig.groups}
    for kind in sorted({part.modality for part in fitting} - shown):
        print(f"the first call has no frame of {kind}: no corruption of it is drawn")
    drawn = [part for part in dict.fromkeys(fitting) if part.modality in shown]
    path = write_figure(out / "sheet.png", sheet(rig, frames, drawn, told.first, config.seed))
    print(f"wrote {path}: what the agent would see at its first frame", flush=True)
    return path


def _wait(attempt: Attempt, file: Path) -> None:
    began = spoke = time.monotonic()
    while not file.is_file():
        time.sleep(0.1)
        problem = attempt.poll()
        if problem is not None and not file.is_file():  # a short program may be over by now
            raise ValueError(problem or "the command ended before its first frame.")
        if time.monotonic() - began > LATE:
            raise ValueError(f"no frame came within {LATE:g} s. Its output:\n{attempt.cell.tail()}")
        if time.monotonic() - spoke > 10:
            spoke = time.monotonic()
            print(f"check: no frame after {spoke - began:.0f} s", flush=True)


def described(
    told: Told, rig: Rig, frames: Mapping[str, np.ndarray], guards: Guards = NO_GUARDS
) -> list[str]:
    """Return lines that say what the program is, sees and hears, and what of it is restored."""
    hello = told.hellos[0] if told.hellos else {}
    versions = {"Python": hello.get("python"), "numpy": hello.get("numpy")}
    versions |= {n: hello.get(n.replace("-", "_")) for n in ("habitat", "habitat-sim", "torch")}
    lines = ["program: " + ", ".join(f"{n} {v}" for n, v in versions.items() if v)]
    for group in rig.groups:
        first = group.cameras[0]
        size = " x ".join(map(str, first.shape))
        what = f"  {first.kind}: " + ", ".join(camera.name for camera in group.cameras)
        many = f", {len(group.cameras)} as one panorama" if len(group.cameras) > 1 else ""
        hfov = "" if first.hfov is None else f", hfov {first.hfov:g}"
        lines.append(f"{what}; {size} {first.dtype}{hfov}{many}{_range(group, frames)}")
    episode, said = told.first, []
    if episode:
        said.append(f"episode {episode['episode']} of {episode['scene']}")
        if episode.get("category"):
            said.append(f"goal category {episode['category']!r}")
        said.append(f"instruction {episode['text']!r}" if episode.get("text") else "no instruction")
    if guards.frames:
        shown = dict.fromkeys(group.cameras[0].kind for group in rig.groups)
        own = [kind for kind in shown if kind in guards.frames]
        nothing = f"nothing of these, the restorer is for {', '.join(guards.frames)}"
        lines.append(f"restored: {', '.join(own) or nothing}")
    return [lines[0], "cameras:", *lines[1:], "hears: " + ", ".join(said), "conditions:"]


def _range(group: Group, frames: Mapping[str, np.ndarray]) -> str:
    """What depth is said to be, what of it was seen, and whether that is strange."""
    first = group.cameras[0]
    if first.kind != DEPTH:
        return ""
    unit = "0 to 1 for" if first.normalised else "metres,"
    said = f", {unit} {first.sensor.z_min:g} to {first.sensor.z_max:g} m"
    seen = np.concatenate([c.metres(frames[of(c.name)]).ravel() for c in group.cameras])
    seen = seen[np.isfinite(seen) & (seen > 0)]
    if not seen.size:
        return f"{said}; nothing but holes was seen"
    low, middle, high = (f"{x:.2f}" for x in (seen.min(), np.median(seen), seen.max()))
    strange = ""
    if not first.normalised and seen.max() < NEAR:
        strange = f" - {NORMALISED}"
    return f"{said}; seen {low} to {high} (median {middle}) m{strange}"


def of(camera: str) -> str:
    """Return the name of a camera's frame in the file: none that `numpy.savez` takes itself."""
    return f"camera {camera}"


def sheet(
    rig: Rig,
    frames: Mapping[str, np.ndarray],
    corruptions: Sequence[Corruption],
    first: Mapping[str, Any],
    seed: int,
) -> Figure:
    """Draw a row for clean and each corruption, with the cameras of its modality that are most; a
    corruption that comes and goes is drawn at a call in which it acts."""
    scene = str(first.get("scene", "")).rpartition("/")[2]
    episode = f"{scene}/{first.get('episode', '')}"
    heading = float(frames[HEADING][0]) if frames[HEADING].size else None
    by_kind = {group.cameras[0].kind: group for group in reversed(rig.groups)}
    clean = {kind: _views(group, frames) for kind, group in by_kind.items()}
    rows = [([f"clean {kind}"], by_kind[kind], views) for kind, views in clean.items()]
    for corruption in corruptions:
        group, before = by_kind[corruption.modality], clean[corruption.modality]
        for call in range(TRIED):
            key = Key(seed, episode, call)
            views = corrupted(group, before.copy(), corruption, key, heading)
            if not np.array_equal(views, before, equal_nan=True):
                break
        acts = f"at call {call}" if call else ""
        if np.array_equal(views, before, equal_nan=True):
            acts = f"no change in {TRIED} calls"
        rows.append(([corruption.name, acts], group, views))
    across = 1 + min(SHOWN, max(len(group.cameras) for _, group, _ in rows))
    figure = Figure(figsize=(SIDE * across, SIDE * len(rows)), dpi=100, layout="constrained")
    for axes, row in zip(figure.subplots(len(rows), across, squeeze=False), rows, strict=True):
        _draw_row(axes, *row)
    return figure


def _views(group: Group, frames: Mapping[str, np.ndarray]) -> np.ndarray:
    views = np.zeros(group.shape, group.cameras[0].dtype)
    for camera, view in zip(group.cameras, group.views, strict=True):
        views[view] = frames[of(camera.name)]
    return views


def _draw_row(axes: Sequence[Axes], names: Sequence[str], group: Group, views: np.ndarray) -> None:
    """Draw the names, below them the entries that are drawn, and beside them their pictures."""
    for axis in axes:
        axis.axis("off")
    shown = list(zip(group.cameras, group.views, strict=True))[:SHOWN]
    entries = textwrap.fill(", ".join(camera.name for camera, _ in shown), WIDE)
    text = "\n".join([*filter(None, names), entries])
    axes[0].text(0, 0.5, plain(text), va="center", fontsize=8)
    for axis, (camera, view) in zip(axes[1:], shown, strict=False):
        frame = views[view]
        if camera.kind == DEPTH:
            metres = camera.metres(frame.reshape(frame.shape[:2]).astype(np.float32))
            frame = depth_picture(metres, camera.sensor.z_max)
        axis.imshow(frame)
