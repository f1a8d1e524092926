"""What became of all faults, as lines and as the table of docs/lab/fault-injection.md."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mitigate.core.progress import duration
from tools.bench.pages import put

BEGIN = "<!-- table: make test-faults ARGS=--write -->"
END = "<!-- end of the table -->"
Found = Mapping[str, Mapping[str, str]]  # recipe: fault: what it came to
NOT_RUN, UNBROKEN = "not run", "unbroken"


def line(name: str, found: Mapping[str, str], seconds: float) -> str:
    """One line for a recipe: what survived, and all that did not in its own words."""
    tried, survived = count({name: found})
    others = [f"{fault}: {came}" for fault, came in found.items() if came != "survived"]
    told = "; ".join([f"{survived} of {tried} faults survived in {duration(seconds)}", *others])
    return f"{name}: {told}"


def count(found: Found) -> tuple[int, int]:
    """How many faults were tried, and how many were survived."""
    came = [came for of in found.values() for came in of.values()]
    tried = [one for one in came if not one.startswith(NOT_RUN)]
    return len(tried), tried.count("survived")


def table(found: Found, families: Mapping[str, str], seed: int) -> str:
    """Markdown: a row a fault, a column a recipe."""
    names = list(found)
    faults = list(dict.fromkeys(fault for of in found.values() for fault in of))
    heads = [f"`{name}` ({families[name]})" if name in families else name for name in names]
    lines = [f"| fault | {' | '.join(heads)} |", f"|---|{':---:|' * len(names)}"]
    for fault in faults:
        cells = [_cell(found[name].get(fault)) for name in names]
        lines.append(f"| {fault} | {' | '.join(cells)} |")
    tried, survived = count(found)
    return "\n".join([*lines, "", f"Tried {tried}, survived {survived}; seed {seed}."])


def _cell(came: str | None) -> str:
    if came is None or came.startswith(NOT_RUN):
        return "–"
    return "survived" if came == "survived" else "**failed**"


def write(page: Path, found: Found, families: Mapping[str, str], seed: int) -> None:
    """Put the table between the marks of ``page``."""
    put(table(found, families, seed), page, BEGIN, END)
