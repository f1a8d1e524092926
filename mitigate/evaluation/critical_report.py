"""Write critical severities and areas as Markdown tables, JSON and pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import make_folder, write_json, write_text
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.names import counted
from mitigate.corruptions.registry import title
from mitigate.evaluation.bootstrap import LEVEL, NO_INTERVAL, NO_WIDTH, RESAMPLES
from mitigate.evaluation.critical import Score, Scores
from mitigate.evaluation.report import MOST_HEATMAPS, NO_PICTURE, is_drawable

GRID_STEP = 0.05  # spacing of the severities in the full grid with which ``_cost`` compares


def write(parts: Sequence[Scores], folder: Path | str) -> list[Path]:
    """Write ``critical.md``, ``critical.json`` and pictures; return their paths."""
    from mitigate.evaluation import plots  # matplotlib is slow to import

    folder = make_folder(folder)
    texts = []
    pictures: list[str] = []
    for number, part in enumerate(parts, 1):
        image = NO_PICTURE
        if is_drawable(part.grid) and len(pictures) < MOST_HEATMAPS:
            pictures.append("critical.png" if number == 1 else f"critical-{number}.png")
            plots.severity_curves(part.grid, folder / pictures[-1])
            image = f"![SR against severity]({pictures[-1]})"
        texts.append(f"{markdown(part)}\n\n{image}\n")
    write_text(folder / "critical.md", "\n".join(texts))
    listed = [entry for part in parts for entry in entries(part)]
    write_json(folder / "critical.json", listed, indent=1)
    return [folder / "critical.md", folder / "critical.json", *(folder / one for one in pictures)]


def markdown(part: Scores) -> str:
    """Return the Markdown text of ``critical.md``.

    Each measure has a table of values and a table of differences between columns. Notes follow the
    tables.
    """
    grid = part.grid
    seeds = {s for columns, names, _ in part.results for s in part.seeds(columns, names)}
    columns = [names for names in part.comparisons if len(names) == 1]
    pairs = [names for names in part.comparisons if len(names) == 2]
    about = (
        f"N = {_episodes(part)}, seed{'s' * (len(seeds) > 1)} "
        f"{', '.join(map(str, sorted(seeds)))}, "
        f"corruption suite {markdown_of(grid.suite)}. Success: {markdown_of(grid.rule)}. Brackets: "
        f"{100 * LEVEL:.0f} % paired bootstrap over {grid.resampled}, {RESAMPLES:,} resamples, "
        "each with its own decreasing fit."
    )
    texts = [f"## {markdown_of(grid.heading)}, critical severities\n\n{about}"]
    for loss in part.measures:
        heading = "Area under the retention curve"
        if loss is not None:
            heading = f"Severity at which {100 * loss:g} % of the clean success is lost"
        texts.append(f"### {heading}\n\n{_table(part, columns, loss)}")
        if pairs:
            reference = markdown_of(part.columns[0])
            texts.append(f"Difference from {reference}:\n\n{_table(part, pairs, loss)}")
    notes = [
        "\\> 1: less is lost at severity 1, so the value is only known to be above 1 (censored). "
        "Means and differences count it as 1; ≥ and ≤ mark the bounds that result.",
        _cost(part),
    ]
    if len(part.columns) > 1:
        notes.insert(1, "Differences in bold have intervals that exclude zero.")
    if NO_INTERVAL in "".join(texts):
        notes.append(NO_WIDTH)
    return "\n\n".join([*texts, "\n".join(f"- {note}" for note in notes)])


def _table(part: Scores, comparisons: Sequence[tuple[str, ...]], loss: float | None) -> str:
    """Return the table of one measure. The table's columns are agents or pairs of agents."""
    lines = []
    for names in part.groups:
        label = title(names[0]) if len(names) == 1 else f"**Mean of {len(names)} corruptions**"
        scores = [part.results.get((columns, names, loss)) for columns in comparisons]
        lines.append([label, *(_cell(score, len(comparisons[0])) for score in scores)])
    return markdown_table(["Corruption", *(markdown_of(c[0]) for c in comparisons)], lines)


def _cell(score: Score | None, columns: int) -> str:
    if score is None:
        return "–"
    estimate, form = score.estimate, ".2f" if columns == 1 else "+.2f"
    if math.isinf(estimate.low):
        return "> 1 [> 1]"
    text = {"lower": "≥ ", "upper": "≤ "}.get(score.bound, "") + f"{estimate.value:{form}}"
    if math.isinf(estimate.value):
        text = "> 1"
    elif score.bound == "unknown" and estimate.value == 0:
        text = "both > 1"
    elif columns == 2 and estimate.excludes_zero:
        text = f"**{text}**"
    high = "> 1" if math.isinf(estimate.high) else f"{estimate.high:{form}}"
    interval = f"[{estimate.low:{form}}, {high}]" if estimate.has_width else NO_INTERVAL
    return f"{text} {interval}"


def _episodes(part: Scores) -> str:
    """Return the number of episodes as text, or a range if it differs between the scores."""
    counts = [score.episodes for score in part.results.values()]
    least = "" if min(counts) == max(counts) else f"{min(counts)} to "
    return f"{least}{counted(max(counts), 'episode')}"


def _cost(part: Scores) -> str:
    """Return a sentence that compares the number of corrupted episodes with that of a full grid."""
    measured = whole = 0
    for column in part.columns:
        for name in part.corruptions:
            for seed in part.seeds((column,), (name,)):
                _, *corrupted = part.curve(column, name, seed).values()
                common = int((~np.isnan(corrupted).any(axis=0)).sum())
                measured += common * len(corrupted)
                whole += common * round(1 / GRID_STEP)
    return (
        f"From {measured:,} corrupted episodes; severities in steps of {GRID_STEP:g} would need "
        f"{whole:,}."
    )


def entries(part: Scores) -> list[dict[str, Any]]:
    """Return the scores and differences as entries of ``critical.json``; null means above 1."""
    grid = part.grid
    results = []
    for (columns, names, loss), score in part.results.items():
        seeds = part.seeds(columns, names)
        curves = [part.curve(columns[0], name, seed) for name in names for seed in seeds]
        estimate = score.estimate
        bounds = {"value": estimate.value, "low": estimate.low, "high": estimate.high}
        results.append(
            {
                "split": grid.heading,
                "suite": grid.suite,
                "rule": grid.rule,
                "column": columns[0],
                "against": columns[1] if len(columns) == 2 else None,
                "corruption": names[0] if len(names) == 1 else "mean",
                "measure": "area" if loss is None else "critical_severity",
                "loss": loss,
                **{k: round(v, 6) if math.isfinite(v) else None for k, v in bounds.items()},
                "bound": score.bound,
                "episodes": score.episodes,
                "seeds": seeds,
                "severities": sorted({at for curve in curves for at in curve}),
            }
        )
    return results
