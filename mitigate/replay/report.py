"""The table and the pictures of a replay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np
from matplotlib.figure import Figure

from mitigate.core.files import write_bytes, write_figure
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.observation import DEPTH, RGB, VIEWS
from mitigate.core.pictures import depth_picture, strip
from mitigate.corruptions import Corruption
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.plots import COLOURS, DPI, plain
from mitigate.evaluation.sections import label
from mitigate.guards.guard import NO_GUARDS, Guards
from mitigate.replay.walk import ACTIONS, FEW, Answers, Changes
from mitigate.worlds.recorded import Recording

Found = Mapping[str, Mapping[str, Changes]]  # agent -> condition -> changes
SHOWN = 6  # decisions in a picture
WIDE = 800  # pixels of a cell, from which there is one in a row
SIDE = 160  # pixels: height of a view in a picture


def table(
    found: Found, severity: float, steps: int, drives: int, guards: Guards = NO_GUARDS
) -> str:
    """The report as Markdown: one block for changed decisions, one for the rest. guards: which
    the frames went through."""
    agents = list(found)
    conditions = [name for name in _conditions(found) if name != "clean"]
    behind = ""
    if guards.frames:
        kinds = " and ".join(guards.frames)
        behind = f" Frames of {kinds} went through the restorer `{guards.frames_hash()}`."
    lines = [
        f"Decisions that a corruption of severity {severity:g} changes, in %, of {steps} steps in "
        f"{drives} drive{'s' * (drives > 1)}, against the same agent on clean frames. Brackets are "
        f"95 % bootstrap intervals over runs of ten steps; of fewer than {FEW} runs, or where all "
        f"are alike, Wilson's.{behind}",
        "",
    ]
    rows = []
    for name in conditions:
        cells = [_percent(found[a][name].changed) if name in found[a] else "–" for a in agents]
        rows.append([label(name), *cells])
    means = []
    for agent in agents:
        of = [c.changed.value for name, c in found[agent].items() if name != "clean"]
        means.append(f"{100 * sum(of) / len(of):.1f}" if of else "–")
    rows.append(["**mean**", *means])
    table = markdown_table(["condition", *map(markdown_of, agents)], rows)
    return "\n".join([*lines, table, "", *_others(found)]) + "\n"


def _conditions(found: Found) -> list[str]:
    """All that any agent met, in order."""
    return list(dict.fromkeys(name for of in found.values() for name in of))


def _others(found: Found) -> list[str]:
    """What else is known of each agent and condition."""
    lines = [
        "False stops: it stops where it did not on clean frames; missed stops: the reverse. Aim "
        "moved: share of the steps, in %, at which the point that it walks to is more than 0.5 m "
        "from that on clean frames. As the driver: share of the steps, in %, at which it does what "
        "whoever drove did.",
        "",
    ]
    rows = []
    for agent, of in found.items():
        for name, changes in of.items():
            aim = "–" if changes.aim is None else _percent(changes.aim)
            agrees = "–" if changes.agreement is None else _percent(changes.agreement)
            counts = (changes.stops, changes.missed)
            rows.append([markdown_of(agent), label(name), *counts, aim, agrees])
    head = ("agent", "condition", "false stops", "missed stops", "aim moved", "as the driver")
    return [*lines, markdown_table(head, rows, words=2)]


def _percent(share: Estimate) -> str:
    return f"{100 * share.value:.1f} {share.interval('.1f', 100)}"


def heatmap(found: Found, severity: float, path: Path) -> Path:
    """Draw the share of changed decisions: rows conditions, columns agents."""
    agents = list(found)
    names = [name for name in _conditions(found) if name != "clean"]
    values = np.full((len(names), len(agents)), np.nan)
    for (i, j), _ in np.ndenumerate(values):
        if names[i] in found[agents[j]]:
            values[i, j] = found[agents[j]][names[i]].changed.value
    size = (2.6 + 1.3 * len(agents), 1.6 + 0.33 * len(names))
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    axes.imshow(1 - values, cmap=COLOURS, vmin=0, vmax=1, aspect="auto")
    for (i, j), value in np.ndenumerate(values):
        if np.isnan(value):
            continue
        dark = abs(1 - value - 0.5) > 0.35  # both ends of the colour map
        colour = "white" if dark else "black"
        axes.text(j, i, f"{100 * value:.0f}", ha="center", va="center", color=colour, fontsize=9)
    axes.set_xticks(range(len(agents)), [*map(plain, agents)], rotation=25, ha="right", fontsize=9)
    axes.set_yticks(range(len(names)), [label(name) for name in names], fontsize=9)
    axes.set_title(f"changed decisions, %, severity {severity:g}", fontsize=10)
    return write_figure(path, figure, dpi=DPI, facecolor="white")


def spread(changed: Sequence[int]) -> list[int]:
    """Up to ``SHOWN`` of the steps, spread over them."""
    if len(changed) <= SHOWN:
        return list(changed)
    return [changed[i] for i in np.linspace(0, len(changed) - 1, SHOWN).round().astype(int)]


def picture(
    recording: Recording, corruption: Corruption, clean: Answers, found: Answers, path: Path
) -> Path:
    """Draw steps at which the decision changed: what there was to see, what the agent saw, and
    what it answered to each. ``found.seen`` holds them."""
    shown = RGB if RGB in recording.frames else DEPTH
    own = [part for part in corruption.modalities if part in recording.frames]
    shown = own[0] if own else shown
    cells = []
    for step, frames in sorted(found.seen.items()):
        before, after = recording.frames[shown][step], frames[shown]
        views = np.concatenate([_view(before, before), _gap(), _view(after, before)], 1)
        was, now = (ACTIONS.get(int(a.actions[step]), "?") for a in (clean, found))
        text = f"step {step}, {recording.times[step]:.1f} s: {was} -> {now}"
        cell = np.concatenate([_title(text, views.shape[1]), views])
        cells.append(np.pad(cell, ((0, 0), (0, 16), (0, 0)), constant_values=255))
    across = 1 if cells[0].shape[1] > WIDE else 3
    cells += [np.full_like(cells[0], 255)] * (-len(cells) % across)
    rows = [np.concatenate(cells[i : i + across], 1) for i in range(0, len(cells), across)]
    holes = "; white: no reading" if shown == DEPTH else ""
    about = f"{recording.name}: {shown} clean, and under {corruption.name}{holes}"
    whole = np.concatenate([_title(about, rows[0].shape[1]), *rows])
    write_bytes(path, cv2.imencode(".png", whole[..., ::-1])[1].tobytes())
    return path


def _title(text: str, width: int) -> np.ndarray:
    """A line of text, uint8 [26, width, 3]."""
    line = np.full((26, width, 3), 255, np.uint8)
    cv2.putText(line, text, (4, 18), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
    return line


def _view(frame: np.ndarray, clean: np.ndarray) -> np.ndarray:
    """A frame, or the middle of each view of a panorama, as uint8 [SIDE, W, 3]; depth in the
    colours of the clean frame's range."""
    if frame.shape[-1] == 1:
        far = max(1e-3, float(clean.max()))
        views = frame if frame.ndim == 4 else frame[None]
        coloured = np.stack([depth_picture(view[..., 0], far) for view in views])
        frame = coloured if frame.ndim == 4 else coloured[0]
    flat = strip(frame) if len(frame) == VIEWS and frame.ndim == 4 else frame
    width = round(flat.shape[1] * SIDE / flat.shape[0])
    return cv2.resize(flat, (width, SIDE), interpolation=cv2.INTER_NEAREST)


def _gap() -> np.ndarray:
    return np.full((SIDE, 4, 3), 255, np.uint8)
