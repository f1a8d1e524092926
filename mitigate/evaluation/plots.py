"""Plot the results: a heatmap as in the paper, and curves of SR against severity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mitigate.core.files import write_figure
from mitigate.corruptions import registry
from mitigate.evaluation.curves import curves
from mitigate.evaluation.grid import Grid
from mitigate.evaluation.sections import Section

COLOURS = mpl.colormaps["viridis"]  # readable without colour vision; bright means good
# The colour-blind safe palette of Okabe and Ito (2008), without its yellow
OKABE_ITO = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#000000")
LINES = [mpl.colors.to_rgba(colour) for colour in OKABE_ITO]
DASHES = ("-", "--", "-.", ":")
WIDTH, MARKER = 1.2, 3.0  # line width and marker size in points
# difference in marker size between successive columns, and maximum marker size, in points
RIM, LARGEST = 1.4, 8.0
DPI = 150
STACKED = 5  # with at least this many columns, the panels of a heatmap are stacked vertically


def heatmap(section: Section, path: Path | str) -> Path:
    """Plot a heatmap with one panel per block of corruptions and one column per agent.

    The rows of a panel are PRS-SR, PRS-SPL, clean, and the corruptions. A cell shows SR (%) / SPL,
    and its colour encodes SR divided by the best clean SR. The colour of a PRS encodes its value.
    With many agents, the panels are stacked vertically.
    """
    rows = [3 + len(names) for names in section.blocks.values()]
    width, narrow = 1.6 + 0.95 * len(section.columns), len(section.columns) < STACKED
    size = (1.0 + len(rows) * width, 2.0 + 0.36 * max(rows))
    if not narrow:
        size = (1.0 + width, 1.0 + sum(0.9 + 0.36 * count for count in rows))
    figure = Figure(figsize=size, layout="constrained")
    down, across = (1, len(rows)) if narrow else (len(rows), 1)
    ratios = None if narrow else rows
    axes = figure.subplots(down, across, squeeze=False, height_ratios=ratios).ravel()
    for axis, (block, names) in zip(axes, section.blocks.items(), strict=True):
        _panel(axis, section, block, names)
    grid = section.grid
    figure.suptitle(
        f"SR (%) / SPL on {plain(grid.heading)}, severity {section.severity:g}, "
        f"N = {len(grid.episodes)}\n"
        f"{plain(grid.rule)}; suite {plain(grid.suite)}",
        fontsize=10,
    )
    return write_figure(path, figure, dpi=DPI, facecolor="white")


def severity_curves(grid: Grid, path: Path | str) -> Path:
    """Plot SR (%) against severity, one panel per corruption, with 95 % bootstrap bands.

    Coinciding lines stay visible, because later lines are dashed and have smaller markers.
    """
    names = grid.corruptions
    across = min(3, len(names))
    down = math.ceil(len(names) / across)
    figure = Figure(figsize=(2.6 * across + 0.6, 2.0 * down + 1.2), layout="constrained")
    axes = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False).ravel()
    for axis, name in zip(axes, names, strict=False):
        _draw_curves(axis, grid, name)
        axis.set_title(registry.title(name), fontsize=11)
        axis.set(xlim=(-0.03, 1.03), ylim=(-3, 103))
        axis.tick_params(labelsize=9)
        axis.grid(alpha=0.3)
    for axis in axes[len(names) :]:
        axis.set_visible(False)
    for axis in axes[max(0, len(names) - across) : len(names)]:
        axis.set_xlabel("severity", fontsize=10)
        axis.tick_params(labelbottom=True)
    figure.supylabel("SR (%)", fontsize=10)
    figure.suptitle(
        f"SR against severity on {plain(grid.heading)}, N = {len(grid.episodes)}; "
        f"{plain(grid.rule)}; suite {plain(grid.suite)}",
        fontsize=10,
    )
    drawn = {line.get_label(): line for axis in axes for line in axis.get_lines()}
    handles = [drawn[x] for x in map(plain, grid.columns) if x in drawn]
    figure.legend(handles=handles, loc="outside lower center", ncols=across, fontsize=10)
    return write_figure(path, figure, dpi=DPI, facecolor="white")


def draw_cells(
    axis: Axes,
    colours: np.ndarray,
    texts: np.ndarray,
    rows: Sequence[str],
    columns: Sequence[str],
    fontsize: int,
) -> None:
    """Draw the cells of a heatmap: ``texts`` [R, C] on the colours of values from 0 to 1 [R, C]."""
    axis.imshow(colours, cmap=COLOURS, vmin=0, vmax=1, aspect="auto")
    for (i, j), text in np.ndenumerate(texts):
        # a NaN cell is not coloured, so its text is black
        colour = "white" if colours[i, j] < 0.6 else "black"
        axis.text(j, i, text, ha="center", va="center", fontsize=fontsize, color=colour)
    names = [plain(name) for name in columns]
    axis.set_xticks(range(len(names)), names, rotation=25, ha="right", fontsize=fontsize)
    axis.set_yticks(range(len(rows)), rows, fontsize=fontsize)


def _panel(axis: Axes, section: Section, block: str, names: tuple[str, ...]) -> None:
    rows = ["PRS-SR", "PRS-SPL", "Clean", *map(registry.title, names)]
    shape = (len(rows), len(section.columns))
    colours, texts = np.full(shape, np.nan), np.full(shape, "–", object)
    best = max((section.value(c, "clean") for c in section.columns), default=math.nan)
    for j, column in enumerate(section.columns):
        for i, metric in enumerate(("SR", "SPL")):
            retained = section.retained.get((column, block, metric))
            if retained is not None and not math.isnan(retained.estimate.value):
                colours[i, j] = retained.estimate.value
                texts[i, j] = f"{retained.estimate.value:.2f}{section.marks(retained, block)}"
        for i, name in enumerate(("clean", *names), start=2):
            rate, spl = (section.value(column, name, metric) for metric in ("SR", "SPL"))
            if not math.isnan(rate):
                colours[i, j] = rate / best if best else 0.0
                texts[i, j] = f"{100 * rate:.0f} / {spl:.2f}" + "*" * section.partial(column, name)
    draw_cells(axis, colours, texts, rows, section.columns, fontsize=10)
    axis.axhline(1.5, color="black", linewidth=1.5)
    axis.set_title(block, fontsize=11)


def _draw_curves(axis: Axes, grid: Grid, name: str) -> None:
    """Plot the curves of one panel; their dashes and marker sizes differ in case they coincide."""
    columns = list(grid.columns)
    rim = min(RIM, (LARGEST - MARKER) / len(columns))
    for curve in curves(grid, name):
        index = columns.index(curve.column)
        colour = LINES[index % len(LINES)]
        value, low, high = 100 * np.array([[x.value, x.low, x.high] for x in curve.points]).T
        axis.plot(
            curve.severities,
            value,
            color=colour,
            label=plain(curve.column),
            linestyle=DASHES[index % len(DASHES)],
            linewidth=WIDTH,
            marker="o",
            markersize=MARKER + rim * (len(columns) - 1 - index),
        )
        axis.fill_between(curve.severities, low, high, color=colour, alpha=0.15, linewidth=0)


def plain(name: str) -> str:
    """Escape a name, so that matplotlib draws it as plain text and shows it in the legend."""
    return name.replace("$", r"\$").replace("_", " _", name.startswith("_"))
