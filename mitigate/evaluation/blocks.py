"""Which corruptions stand together in a table, and what a PRS over them stands for."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from mitigate.corruptions.registry import AND, HALVES, UNSEEN, names, unseen_names
from mitigate.evaluation.rows import Row

BLOCKS = {  # of ours; a corruption of another package is no part of them
    "RGB": names("rgb"),
    "Depth": names("depth"),
    "Instruction": names("instruction"),
    "unseen RGB": unseen_names("rgb"),
    "unseen depth": unseen_names("depth"),
}
FRAMES = frozenset((*BLOCKS["RGB"], *BLOCKS["Depth"]))  # the paper's twelve
SUITE, UNSEEN_KIND, PAIRS = "", "unseen corruptions", "pairs of corruptions"  # a table each
PROMPT_ONLY = "white_box"  # not applicable to agents without a system prompt: these have no row


def kind(corruption: str) -> str:
    """Return in which table a corruption stands: the suite's and what other packages bring, the
    unseen ones, or the pairs."""
    return PAIRS if AND in corruption else UNSEEN_KIND if corruption in UNSEEN else SUITE


def by_kind(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Return the rows of each table, with the clean ones of the agents that are in it.

    The suite's numbers are thus the same whatever else was measured, for whichever seeds. Agents
    that were never corrupted stand beside the suite.
    """
    rows = list(rows)
    kinds = {row["corruption"]: kind(row["corruption"]) for row in rows}
    members: dict[tuple, set[str]] = defaultdict(set)
    for row in rows:
        if row["corruption"] != "clean":
            members[_column(row)].add(kinds[row["corruption"]])
    found: dict[str, list[Row]] = {SUITE: [], UNSEEN_KIND: [], PAIRS: []}
    for row in rows:
        own = {kinds[row["corruption"]]}
        for name in (members[_column(row)] or own) if row["corruption"] == "clean" else own:
            found[name].append(row)
    return {name: held for name, held in found.items() if held}


def _column(row: Row) -> tuple:
    return tuple(row[key] for key in ("split", "suite", "rule", "name", "agent"))


def meant(block: str, held: Sequence[str]) -> tuple[str, ...]:
    """Return the corruptions that a PRS over ``block`` stands for where ``held`` are measured.

    One that does not apply (:data:`PROMPT_ONLY`) counts only where it was measured, and a half of
    the unseen ones only where one of it was.
    """
    every = tuple(n for n in BLOCKS.get(block, held) if n in held or n != PROMPT_ONLY)
    halves = {UNSEEN[name].half for name in held if name in UNSEEN}
    return tuple(n for n in every if n not in UNSEEN or UNSEEN[n].half in halves)


def halves(blocks: dict[str, tuple[str, ...]]) -> dict[str, dict[str, tuple[str, ...]]]:
    """Return by block what is measured of each half, by its heading, where both are."""
    found = {
        block: {
            f"{block}, {half}": tuple(n for n in names if n in UNSEEN and UNSEEN[n].half == half)
            for half in HALVES
        }
        for block, names in blocks.items()
    }
    return {block: parts for block, parts in found.items() if all(parts.values())}
