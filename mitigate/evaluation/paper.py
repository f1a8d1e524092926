"""The paper's Table II beside ours: its figure in brackets after each of our own."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from mitigate.core.markdown import markdown_table
from mitigate.evaluation.sections import Section, label

SEVERITY = 0.6  # of the paper's Table II (its caption); other severities stand alone


def beside(
    section: Section, paper: Mapping[str, Sequence], spent: Mapping[str, Mapping[str, float]]
) -> str:
    """Return Markdown of ``section`` with the paper's figures and the CPU minutes that it cost.

    Args:
        paper: "columns" -> names of its columns, and by row ("PRS-SR (RGB)", "motion_blur") its
            figures in their order. spent: CPU minutes by what they were spent on, and by column.
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
        kept = {c: section.retained.get((c, block, "SR")) for c in section.columns}
        values = {
            c: "–" if r is None else _prs(r.estimate.value) + section.marks(r, block)
            for c, r in kept.items()
        }
        lines.append(cells(f"**{title}**", title, values))
        for name in names:
            rates = {c: f"{100 * section.value(c, name):.1f}" for c in section.columns}
            lines.append(cells(label(name), name, rates))
    held = (" ".join(map(str, section.grid.seeds[c, section.severity])) for c in section.columns)
    lines.append(["Seeds", *held])
    for kind, minutes in spent.items():
        cost = (f"{minutes[c]:.1f}" if c in minutes else "–" for c in section.columns)
        lines.append([f"CPU minutes, {kind}", *cost])
    table = markdown_table(["Corruption", *section.columns], lines)
    return f"{_header(section, bool(theirs))}\n\n{table}\n"


def _prs(value: float) -> str:
    return "undefined" if math.isnan(value) else f"{value:.2f}"


def _header(section: Section, compared: bool) -> str:
    at = f"severity {section.severity:g}" if section.blocks else "clean only"
    text = (
        f"{section.grid.heading}, {at}, N = {len(section.grid.episodes)}, "
        f"corruption suite {section.grid.suite}. SR in %. Intervals, and what "
        "marks mean, are in table.md."
    )
    if compared:
        text += " In brackets the paper's figure for ETPNav on R2R (its Table II, clean SR 65)."
    return text
