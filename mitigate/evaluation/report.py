"""Write the report: Table II of the paper in Markdown, with paired intervals and pictures.

All numbers are computed from result rows. If rows are missing, the report lists the incomplete
cells of the table.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from mitigate.core.files import make_folder, write_text
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.names import counted
from mitigate.corruptions import registry
from mitigate.evaluation.bootstrap import LEVEL, NO_INTERVAL, NO_WIDTH, RESAMPLES, Estimate
from mitigate.evaluation.grid import METRICS, PROMPT_ONLY, Grid, expected_corruptions
from mitigate.evaluation.metrics import FLOOR
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import (
    NO_DIFFERENCE,
    Difference,
    Retained,
    Section,
    sections,
)

# These limits for pictures are heuristic.
# Without limits, rows from an untrusted source could make plotting very slow.
MOST_CORRUPTIONS = 100  # of a picture
MOST_COLUMNS = 50  # of a picture
MOST_HEATMAPS = 50  # of a report
NO_PICTURE = (
    f"No picture: it would show more than {MOST_CORRUPTIONS} corruptions or {MOST_COLUMNS} "
    f"columns, or this report has {MOST_HEATMAPS} heatmaps."
)
FEW = 10  # with fewer episodes than this, no difference is printed in bold (heuristic)


def markdown(
    parts: Sequence[Section], pictures: Sequence[Sequence[str]] = (), intervals: bool = False
) -> str:
    """Return the tables as Markdown.

    ``pictures[i]`` lists the picture files that are shown below section i. With ``intervals``, each
    corruption also has an interval, and its differences from the clean SR and from the reference
    column.
    """
    texts = []
    several_rules = len({section.grid.rule for section in parts}) > 1
    for section, names in zip(parts, pictures or [()] * len(parts), strict=True):
        images = "\n".join(f"![{Path(name).stem}]({name})" for name in names)
        if pictures and section.blocks and not names:
            images = NO_PICTURE
        table = _table(section, intervals)
        about = f"{NO_WIDTH}\n" * (NO_INTERVAL in table) + _notes(section)
        texts.append(f"{_heading(section, several_rules)}\n\n{table}\n\n{about}\n\n{images}")
    return "\n\n".join(text.strip() for text in texts) + "\n"


def write(
    rows: Iterable[Row],
    folder: Path | str,
    first: str | None = None,
    least: int = 1,
    against: str | None = None,
    drawn: str | None = None,
    intervals: bool = False,
) -> list[Path]:
    """Write ``table.md``, ``heatmap.png`` and ``severity.png`` to ``folder``; return their paths.

    The pictures of further sections and grids are called ``heatmap-2.png``, ``severity-2.png`` and
    so on. Sections that are too large have no pictures, and the report has at most
    ``MOST_HEATMAPS`` heatmaps.

    Args:
        rows: result rows.
        folder: output folder.
        first: success rule whose sections come first.
        least: minimum number of severities that a grid needs for its curves to be plotted.
        against: name of the reference column, as in :func:`sections`.
        drawn: unit that the bootstrap resamples, as in :func:`sections`.
        intervals: whether each corruption has intervals, as in :func:`markdown`.
    """
    from mitigate.evaluation import plots  # matplotlib is slow to import

    parts = sorted(sections(rows, against, drawn), key=lambda part: part.grid.rule != first)
    folder = make_folder(folder)
    pictures: list[list[str]] = [[] for _ in parts]
    heatmaps = 0
    grids: list[Grid] = []
    for section, names in zip(parts, pictures, strict=True):
        if not section.blocks or not is_drawable(section.grid) or heatmaps == MOST_HEATMAPS:
            continue
        names.append(_numbered("heatmap", heatmaps))
        plots.heatmap(section, folder / names[-1])
        heatmaps += 1
        if section.grid not in grids and len(section.grid.severities) >= least:
            names.append(_numbered("severity", len(grids)))
            plots.severity_curves(section.grid, folder / names[-1])
            grids.append(section.grid)
    write_text(folder / "table.md", markdown(parts, pictures, intervals))
    return [folder / "table.md", *(folder / name for names in pictures for name in names)]


def is_drawable(grid: Grid) -> bool:
    """Return whether a grid is small enough for a picture of all its corruptions and columns."""
    return len(grid.corruptions) <= MOST_CORRUPTIONS and len(grid.columns) <= MOST_COLUMNS


def _heading(section: Section, several_rules: bool) -> str:
    """Return the heading of a section and the text below it."""
    grid, columns = section.grid, section.columns
    at = f"severity {section.severity:g}" if section.blocks else "clean only"
    at = f"{section.kind}, {at}" if section.kind else at
    if several_rules:
        at += f", success rule {markdown_of(grid.rule.partition(':')[0])}"
    by_column = {c: ", ".join(map(str, grid.seeds[c, section.severity])) for c in columns}
    seeds = "seeds " + "; ".join(f"{n} of {markdown_of(c)}" for c, n in by_column.items())
    if len({*by_column.values()}) == 1:
        seeds = f"seed {by_column[columns[0]]}"
    agents = ", ".join(
        f"{markdown_of(x)} " + " ".join(f"`{a}`" for a in grid.agents_at(x, section.severity))
        for x in columns
    )
    return (
        f"## {markdown_of(grid.heading)}, {at}\n\n"
        f"N = {counted(len(grid.episodes), 'episode')}, {seeds}, corruption suite "
        f"{markdown_of(grid.suite)}. Success: {markdown_of(grid.rule)}. Agents: {agents}.\n"
        f"SR in %. PRS is the agent's SR (SPL), averaged over the block's corruptions and divided "
        f"by its clean SR (SPL). Brackets: {100 * LEVEL:.0f} % paired bootstrap over "
        f"{grid.resampled}, {RESAMPLES:,} resamples; where all or none succeed, Wilson's."
    )


def _table(section: Section, intervals: bool) -> str:
    columns = section.columns
    lines: list[list[str]] = []
    changes = _changes(section) if len(columns) > 1 else []
    against = f"against {markdown_of(section.reference)}"
    for metric in METRICS:
        cells = [_interval(section.clean.get((c, metric)), metric) for c in columns]
        lines.append([f"Clean {metric}", *cells])
    lines += _by_seed(section, "clean", "Clean SR", lambda value: f"{100 * value:.1f}")
    if changes:
        cells = [_difference(section, change.clean) for change in changes]
        lines.append([f"Clean SR {against}", *cells])
    if section.corrupted:
        count = sum(map(section.whole, section.blocks))
        cells = [
            _mean_sr(section, section.corrupted.get(column), *section.blocks) for column in columns
        ]
        lines.append([f"Mean SR of {count} corruptions", *cells])
    if section.corrupted and changes:
        cells = [_change(section, change.corrupted, *section.blocks) for change in changes]
        lines.append([f"Mean SR {against}", *cells])
    for block, names in section.blocks.items():
        for metric in METRICS:
            cells = [_prs(section, (c, block, metric)) for c in columns]
            lines.append([f"**PRS-{metric} ({block})**", *cells])
        lines += _by_seed(section, block, "PRS-SR", _rounded_prs)
        for metric in METRICS if changes else ():
            values = [change.retained.get((block, metric)) for change in changes]
            cells = [_change(section, value, block, form="+.2f", scale=1) for value in values]
            lines.append([f"PRS-{metric} {against}", *cells])
        for half in section.halves.get(block, {}):
            lines.append([f"PRS-SR ({half})", *(_prs(section, (c, half, "SR")) for c in columns)])
        for name in names:
            rates = [registry.title(name), *(_rate(section, c, name) for c in columns)]
            lines += _with_intervals(section, name) if intervals else [rates]
        if _prompt_not_applicable(section, block):
            lines.append([registry.title(PROMPT_ONLY), *["n/a"] * len(columns)])
    return markdown_table(["Corruption", *map(markdown_of, columns)], lines)


def _changes(section: Section) -> list[Difference]:
    """Return each column's difference from the reference; for the reference, it is empty."""
    return [section.differences.get(c, NO_DIFFERENCE) for c in section.columns]


def _mean_sr(section: Section, value: Retained | None, *parts: str) -> str:
    """Format a mean SR over the corruptions of ``parts``, or the SR under one corruption."""
    if value is None:
        return "–"
    return _interval(value.estimate, "SR") + _marks(section, value, *parts)


def _by_seed(
    section: Section, key: str, title: str, text: Callable[[float], str]
) -> list[list[str]]:
    """Return a table line with the value of each seed, or no line if all columns have one seed."""
    columns = [section.by_seed.get((column, key), {}) for column in section.columns]
    if not any(len(values) > 1 for values in columns):
        return []
    cells = (" / ".join(map(text, values.values())) or "–" for values in columns)
    return [[f"{title}, seed by seed", *cells]]


def _notes(section: Section) -> str:
    notes = []
    if any(r.near_floor for r in section.retained.values()):
        notes.append(
            f"‡ clean value below {FLOOR:g}: PRS saturates near the performance floor and says "
            "little."
        )
    retained = section.retained.items()
    if any(len(r.corruptions) < section.whole(part) for (_, part, _), r in retained):
        notes.append("† over k of the K corruptions: the others are not measured or not complete.")
    blocks = section.blocks.items()
    expected = [name for block, names in blocks for name in expected_corruptions(block, names)]
    if absent := [name for name in expected if name not in section.corruptions]:
        notes.append(f"Not measured: {', '.join(map(registry.title, absent))}.")
    if any(_prompt_not_applicable(section, block) for block in section.blocks):
        notes.append(
            f"n/a: {registry.title(PROMPT_ONLY)} changes an agent's system prompt; no agent here "
            "has one, so it is not applicable and not part of the PRS."
        )
    if any(change.clean or change.retained for change in _changes(section)):
        notes.append(
            f"With fewer than {FEW} episodes an interval says little: no difference is in bold."
            if _is_few(section)
            else "Differences in bold have intervals that exclude zero."
        )
    pairs = [(column, section.reference) for column in section.columns[1:]]
    unpaired = [pair[0] for pair in pairs if section.grid.paired(pair, section.severity) is None]
    if unpaired:
        notes.append(
            f"No seed in common with {markdown_of(section.reference)}, and so no difference: "
            f"{', '.join(map(markdown_of, unpaired))}."
        )
    if section.by_seed:
        notes.append(
            "Several seeds: the value of an episode is their mean, and two columns are compared "
            f"over the seeds that both have. Intervals are over {section.grid.drawn}s; the values "
            "seed by seed show the differences between training runs."
        )
    notes += section.notes(markdown_of)
    if section.gaps:
        notes.append("\\* over the available episodes. Missing cells:")
        notes += [
            f"- {markdown_of(gap.column)}, {gap.corruption} at {gap.severity:g}: "
            f"{gap.have} of {counted(gap.want, 'episode')}"
            for gap in section.gaps
        ]
    return "\n".join(notes)


def _prompt_not_applicable(section: Section, block: str) -> bool:
    return block == "Instruction" and PROMPT_ONLY not in section.blocks[block]


def _with_intervals(section: Section, corruption: str) -> list[list[str]]:
    """Return the table lines of a corruption: its SR, and the differences from the clean SR and
    from the reference column.
    """
    title = registry.title(corruption)
    cells = []
    for column in section.columns:
        rate = section.mean_sr(column, (corruption,))
        # without enough episodes for an interval, the cell shows their mean
        cells.append(_mean_sr(section, rate) if rate else _rate(section, column, corruption))
    lines = [[title, *cells]]
    changes = [section.changes(column, corruption) for column in section.columns]
    kinds = {"clean": "clean", section.reference: markdown_of(section.reference)}
    for kind, against in kinds.items():
        if any(kind in change for change in changes):
            cells = [_change(section, change.get(kind)) for change in changes]
            lines.append([f"{title} against {against}", *cells])
    return lines


def _rate(section: Section, column: str, corruption: str) -> str:
    value = section.value(column, corruption)
    if math.isnan(value):
        return "–"
    return f"{100 * value:.1f}" + ("\\*" if section.partial(column, corruption) else "")


def _interval(estimate: Estimate | None, metric: str) -> str:
    if estimate is None:
        return "–"
    return estimate.text(".1f", 100) if metric == "SR" else estimate.text(".2f")


def _prs(section: Section, place: tuple[str, str, str]) -> str:
    value = section.retained.get(place)
    if value is None:
        return "–"
    prs, marks = value.estimate, _marks(section, value, place[1])
    if math.isnan(prs.value):
        return f"undefined{marks}"
    return f"**{prs.value:.2f}** {prs.interval('.2f')}{marks}"


def _rounded_prs(value: float) -> str:
    return "undefined" if math.isnan(value) else f"{value:.2f}"


def _difference(
    section: Section, change: Estimate | None, form: str = "+.1f", scale: float = 100
) -> str:
    """Format a difference; it is bold if its interval excludes zero."""
    if change is None or math.isnan(change.value):
        return "–"
    text = f"{scale * change.value:{form}}"
    if change.excludes_zero and not _is_few(section):
        text = f"**{text}**"
    return f"{text} {change.interval(form, scale)}"


def _is_few(section: Section) -> bool:
    """Return whether there are too few episodes for an interval to be reliable."""
    return len(section.grid.episodes) < FEW


def _change(section: Section, value: Retained | None, *parts: str, **options: Any) -> str:
    """Format a difference of two means or PRS over the corruptions of ``parts``."""
    if value is None or math.isnan(value.estimate.value):
        return "–"
    return _difference(section, value.estimate, **options) + _marks(section, value, *parts)


def _marks(section: Section, value: Retained, *parts: str) -> str:
    return section.marks(value, *parts).replace("*", "\\*")


def _numbered(stem: str, index: int) -> str:
    return f"{stem}.png" if index == 0 else f"{stem}-{index + 1}.png"


# severity of Table II in the paper, from its caption; results are compared only at this severity
SEVERITY = 0.6


def beside(section: Section, paper: Mapping[str, Sequence]) -> str:
    """Return a Markdown table of ``section``, with the paper's figures in brackets.

    Args:
        section: the results.
        paper: the paper's figures. The key "columns" holds the names of the columns. Every other
            key is a row name, such as "PRS-SR (RGB)" or "motion_blur", and holds the figures of
            that row in the order of the columns.
    """
    theirs = {
        name: dict(zip(paper["columns"], values, strict=True))
        for name, values in paper.items()
        if name != "columns" and section.severity == SEVERITY
    }

    def cells(title: str, name: str, values: Mapping[str, str]) -> list[str]:
        known = theirs.get(name, {})
        return [title, *(f"{v} ({known[c]})" if c in known else v for c, v in values.items())]

    lines = [["Clean SR", *(f"{100 * section.value(c, 'clean'):.1f}" for c in section.columns)]]
    for block, names in section.blocks.items():
        title = f"PRS-SR ({block})"
        retained = {c: section.retained.get((c, block, "SR")) for c in section.columns}
        values = {
            c: "–" if r is None else _rounded_prs(r.estimate.value) + section.marks(r, block)
            for c, r in retained.items()
        }
        lines.append(cells(f"**{title}**", title, values))
        for name in names:
            rates = {c: f"{100 * section.value(c, name):.1f}" for c in section.columns}
            lines.append(cells(registry.title(name), name, rates))
    seeds = (" ".join(map(str, section.grid.seeds[c, section.severity])) for c in section.columns)
    lines.append(["Seeds", *seeds])
    at = f"severity {section.severity:g}" if section.blocks else "clean only"
    about = (
        f"{section.grid.heading}, {at}, N = {len(section.grid.episodes)}, corruption suite "
        f"{section.grid.suite}. SR in %. Intervals, and what marks mean, are in table.md."
    )
    if theirs:
        about += (
            " In brackets the paper's figure for ETPNav on R2R (its Table II, clean SR 65). PRS in "
            "brackets is relative to this 65, our PRS to the agent's own clean SR."
        )
    table = markdown_table(["Corruption", *section.columns], lines)
    return f"{about}\n\n{table}\n"
