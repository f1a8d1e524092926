"""Report the outcomes of all faults, as lines and as the table in docs/lab/fault-injection.md."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mitigate.core.files import write_bytes
from mitigate.core.progress import duration

BEGIN = "<!-- table: make test-faults ARGS=--write -->"
END = "<!-- end of the table -->"
# outcomes by recipe and fault: "survived", "not run: ..." or a description of the problem
Outcomes = Mapping[str, Mapping[str, str]]
NOT_RUN, UNBROKEN = "not run", "unbroken"


def line(name: str, outcomes: Mapping[str, str], seconds: float) -> str:
    """Return one line for a recipe: how many faults it survived, and all other outcomes."""
    tried, survived = count({name: outcomes})
    others = [f"{fault}: {outcome}" for fault, outcome in outcomes.items() if outcome != "survived"]
    text = "; ".join([f"{survived} of {tried} faults survived in {duration(seconds)}", *others])
    return f"{name}: {text}"


def count(outcomes: Outcomes) -> tuple[int, int]:
    """Return how many faults were injected, and how many of them the program survived."""
    texts = [outcome for by_fault in outcomes.values() for outcome in by_fault.values()]
    tried = [outcome for outcome in texts if not outcome.startswith(NOT_RUN)]
    return len(tried), tried.count("survived")


def table(outcomes: Outcomes, families: Mapping[str, str], seed: int) -> str:
    """Return a Markdown table with a row per fault and a column per recipe."""
    names = list(outcomes)
    faults = list(dict.fromkeys(fault for by_fault in outcomes.values() for fault in by_fault))
    heads = [f"`{name}` ({families[name]})" if name in families else name for name in names]
    lines = [f"| fault | {' | '.join(heads)} |", f"|---|{':---:|' * len(names)}"]
    for fault in faults:
        cells = [_cell(outcomes[name].get(fault)) for name in names]
        lines.append(f"| {fault} | {' | '.join(cells)} |")
    tried, survived = count(outcomes)
    return "\n".join([*lines, "", f"Tried {tried}, survived {survived}; seed {seed}."])


def _cell(outcome: str | None) -> str:
    if outcome is None or outcome.startswith(NOT_RUN):
        return "–"
    return "survived" if outcome == "survived" else "**failed**"


def write(page: Path, outcomes: Outcomes, families: Mapping[str, str], seed: int) -> None:
    """Write the table between the two marker lines of ``page``.

    Raises:
        ValueError: If the page does not contain these lines.
    """
    before, first_marker, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    _, last_marker, after = rest.partition(END)
    if not (first_marker and last_marker):
        raise ValueError(
            f"{page} must contain the lines {BEGIN!r} and {END!r}, which enclose the table. Add "
            "them."
        )
    text = table(outcomes, families, seed)
    write_bytes(page, f"{before}{BEGIN}\n{text}\n{END}{after}".encode())
