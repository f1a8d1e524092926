"""Write the table and the pictures of a replay."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from mitigate.core.files import write_figure
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.observation import DEPTH
from mitigate.corruptions import Corruption
from mitigate.evaluation.plots import DPI, draw_cells, plain
from mitigate.evaluation.trajectories import view_picture
from mitigate.guards.guard import NO_GUARDS, Guards
from mitigate.replay import walk
from mitigate.replay.walk import Answers, Changes
from mitigate.worlds.recorded import Recording

# maps the name of an agent to a dict from condition names to the changes of its decisions
AgentChanges = Mapping[str, Mapping[str, Changes]]
MAX_CELLS = 6  # maximum number of decisions that a picture shows


def table(
    changes: AgentChanges,
    severity: float,
    steps: int,
    drives: int,
    guards: Guards = NO_GUARDS,
    notes: Sequence[str] = (),
) -> str:
    """Return the report as Markdown.

    Args:
        changes: Changes of decisions by agent and condition.
        severity: Severity of the corruptions.
        steps: Number of steps, summed over all drives.
        drives: Number of drives.
        guards: Guards that processed the frames.
        notes: Warnings that are shown above the tables.

    Returns:
        A table of changed decisions and a table of the other measures.
    """
    agents = list(changes)
    conditions = [name for name in _conditions(changes) if name != "clean"]
    restorer = ""
    if guards.frames:
        kinds = " and ".join(guards.frames)
        restorer = f" Frames of {kinds} went through the restorer `{guards.frames_hash()}`."
    lines = [
        f"Decisions that a corruption of severity {severity:g} changes, in %, of {steps} steps in "
        f"{drives} drive{'s' * (drives > 1)}, compared with the same agent on clean frames. "
        "Brackets are 95 % bootstrap intervals over blocks of ten steps; with fewer than "
        f"{walk.MIN_BLOCKS} blocks, or if all are equal, Wilson's intervals.{restorer}",
        "",
        *(f"**Warning:** {markdown_of(note)}\n" for note in notes),
    ]
    enough = walk.MIN_BLOCKS * walk.BLOCK_STEPS
    if steps < enough:
        lines += [
            f"Below {enough} steps the intervals are too wide to compare corruptions: replay a "
            "longer drive, or several drives.",
            "",
        ]
    by_condition = {name: [changes[a].get(name) for a in agents] for name in conditions}
    rows = [
        [name, *(change.changed.text(".1f", 100) if change else "–" for change in row)]
        for name, row in by_condition.items()
    ]
    means = []
    for agent in agents:
        shares = [c.changed.value for name, c in changes[agent].items() if name != "clean"]
        means.append(f"{100 * sum(shares) / len(shares):.1f}" if shares else "–")
    rows.append([f"**mean of {len(conditions)}**", *means])
    table = markdown_table(["condition", *map(markdown_of, agents)], rows)
    return "\n".join([*lines, table, "", *_other_measures(changes)]) + "\n"


def _conditions(changes: AgentChanges) -> list[str]:
    """Return the conditions that at least one agent has run, in order."""
    return list(dict.fromkeys(name for by_condition in changes.values() for name in by_condition))


def _other_measures(changes: AgentChanges) -> list[str]:
    """Return a table of stops, changed target positions and agreement with the driver."""
    text = (
        "False stops: steps with STOP here but not on clean frames; missed stops: the reverse. Aim "
        "moved: share of the steps, in %, at which the point that the agent moves to is more than "
        "0.5 m from that on clean frames. As the driver: share of the steps, in %, with the same "
        "action as the driver."
    )
    head = ["agent", "condition", "false stops", "missed stops", "aim moved", "as the driver"]
    continuous = any(c.distance for by_condition in changes.values() for c in by_condition.values())
    if continuous:
        head.append("distance")
        text += (
            " Distance: mean Euclidean distance of continuous actions to those on clean frames. "
            "Such a decision counts as changed if one number moves by more than "
            f"{100 * walk.MIN_ACTION_SHIFT:g} % of its range on clean frames."
        )
    rows = []
    for agent, by_condition in changes.items():
        for name, change in by_condition.items():
            shares = [
                "–" if share is None else share.text(".1f", 100)
                for share in (change.aim, change.agreement)
            ]
            distance = "–" if change.distance is None else change.distance.text(".3g")
            cells = [markdown_of(agent), name, change.stops, change.missed, *shares, distance]
            rows.append(cells[: len(head)])
    return [text, "", markdown_table(head, rows, words=2)]


def summaries(recordings: Sequence[Recording]) -> str:
    """Return a Markdown list that describes what was read from each drive."""
    lines = ["", "Drives:", ""]
    for recording in recordings:
        first, *others = recording.summary or (recording.name,)
        lines += [f"- {markdown_of(first)}", *(f"    - {markdown_of(line)}" for line in others)]
    return "\n".join(lines) + "\n"


def heatmap(changes: AgentChanges, severity: float, path: Path) -> Path:
    """Plot the fraction of changed decisions as a heatmap.

    The heatmap has one row per condition and one column per agent.
    """
    agents = list(changes)
    names = [name for name in _conditions(changes) if name != "clean"]
    values = np.full((len(names), len(agents)), np.nan)
    texts = np.full(values.shape, "", object)
    for i, j in np.ndindex(values.shape):
        if change := changes[agents[j]].get(names[i]):
            values[i, j] = change.changed.value
            texts[i, j] = f"{100 * change.changed.value:.0f}"
    size = (2.6 + 1.3 * len(agents), 1.6 + 0.33 * len(names))
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    draw_cells(axes, 1 - values, texts, names, agents, fontsize=9)
    axes.set_title(f"changed decisions, %, severity {severity:g}", fontsize=10)
    return write_figure(path, figure, dpi=DPI, facecolor="white")


def spread(changed: list[int]) -> list[int]:
    """Choose at most ``MAX_CELLS`` of the steps, spread evenly."""
    if len(changed) <= MAX_CELLS:
        return changed
    return [changed[i] for i in np.linspace(0, len(changed) - 1, MAX_CELLS).round().astype(int)]


def picture(
    recording: Recording, corruption: Corruption, clean: Answers, corrupted: Answers, path: Path
) -> Path:
    """Plot the steps in ``corrupted.seen``.

    For each step, the picture shows the clean frame, the corrupted frame and both decisions.
    """
    corrupted_frames = [part for part in corruption.modalities if part in recording.frames]
    modality = (*corrupted_frames, *recording.frames)[0]
    frames = recording.frames[modality]
    columns = 3 if frames.ndim == 4 else 1
    rows = math.ceil(len(corrupted.seen) / columns)
    figure = Figure(figsize=(10, 0.7 + (2.0 if columns == 3 else 1.2) * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axis in axes:
        axis.axis("off")
    for axis, (step, seen) in zip(axes, sorted(corrupted.seen.items()), strict=False):
        far = max(1e-3, frames[step].max())  # both pictures of depth have the range of clean frames
        before = view_picture(frames[step], far)
        gap = np.full((len(before), max(1, len(before) // 40), 3), 255, np.uint8)
        views = (before, gap, view_picture(seen[modality], far))
        axis.imshow(np.concatenate(views, 1), interpolation="nearest")
        old, new = (walk.named_action(a.actions[step]) for a in (clean, corrupted))
        text = f"step {step}, {recording.times[step]:.1f} s: {old} -> {new}"
        axis.set_title(text, fontsize=8)
    legend = ""
    if modality == DEPTH:
        legend = "; yellow: near, violet: the farthest point of the clean frame, white: no reading"
    title = f"{recording.name}: {modality} clean, and under {corruption.name}{legend}"
    figure.suptitle(plain(title), fontsize=10)
    return write_figure(path, figure, dpi=DPI, facecolor="white")
