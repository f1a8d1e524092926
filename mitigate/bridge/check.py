"""``mitigate run --check -- COMMAND``: look at the first frames of a program, and stop it.

Says what it sees and hears, which conditions of the suite apply, and draws what it would see.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import cv2
import numpy as np
from omegaconf import DictConfig

from mitigate.bridge.cameras import Group, Rig
from mitigate.bridge.conditions import applicable, cells, untold
from mitigate.bridge.options import check_options, name_of
from mitigate.bridge.results import NEAR, NORMALISED, Told
from mitigate.bridge.sheet import HEADING, of, sheet
from mitigate.core.files import write_atomically, write_bytes
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.output import output_folder
from mitigate.guards.guard import NO_GUARDS, Guards

LATE = 900.0  # seconds that a program may take to its first frame (ours): models are loaded first


@dataclass
class FirstLook:
    """Keeps the frames of the first call in a file."""

    file: Path
    kinds: ClassVar = (RGB, DEPTH)

    def episode(self, told: Mapping[str, Any]) -> None:
        """Nothing: the events tell of it."""

    def frame(
        self, told: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Write the frames, once."""
        if not self.file.is_file():
            frames = {of(c.name): c.read(memory, offsets) for c in rig.cameras}
            heading = told.get("heading")
            frames[HEADING] = np.array([] if heading is None else [heading])
            write_atomically(self.file, lambda path: _save(path, frames))

    def end(self, told: Mapping[str, Any]) -> None:
        """Nothing: one look is enough."""

    def leave(self) -> None:
        """Nothing: the look stays."""


def _save(path: Path, frames: dict[str, np.ndarray]) -> None:
    with open(path, "wb") as file:
        np.savez(file, **frames)  # type: ignore[arg-type]


def check(cfg: DictConfig, command: Sequence[str]) -> Path | None:
    """Run ``command`` up to its first frames; return the path of the sheet, None without cameras.

    Raises ValueError as a run does for its options, and if the command ends before, or shows
    nothing within ``LATE`` seconds.
    """
    check_options(cfg, command)
    out = Path(cfg.out or f"{cfg.runs}/run/{cfg.name or name_of(command)}-check")
    made = cells(cfg, command, out, "check")
    cell, file = made[0], out / "first.npz"
    cell.folder = out / "check"
    file.unlink(missing_ok=True)
    cell.condition.observers[:] = [FirstLook(file)]  # nothing is recorded: it ends in mid-episode
    print(f"check: started, its output is in {cell.log}", flush=True)
    try:
        with output_folder(out):
            cell.start()
            _wait(cell, file)
    finally:
        cell.kill()
    told = cell.told()
    with np.load(file, allow_pickle=False) as held:
        frames = dict(held)
    seen = [camera for camera in told.cameras if of(camera["name"]) in frames]
    rig = Rig(seen, cfg.missing, cfg.turn)
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
    picture = sheet(rig, frames, drawn, told.first, cfg.seed)
    path = out / "sheet.png"
    png = cv2.imencode(".png", picture[..., ::-1])[1].tobytes()
    write_bytes(path, png)
    print(f"wrote {path}: what the agent would see at its first frame", flush=True)
    return path


def _wait(cell: Any, file: Path) -> None:
    began = spoke = time.monotonic()
    while not file.is_file():
        time.sleep(0.1)
        problem = cell.poll()
        if problem is not None and not file.is_file():  # a short program may be over by now
            raise ValueError(problem or "the command ended before its first frame.")
        if time.monotonic() - began > LATE:
            raise ValueError(f"no frame came within {LATE:g} s. Its output:\n{cell.tail()}")
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
