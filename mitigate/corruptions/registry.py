"""All corruptions there are: ours, and those that installed packages bring.

Ours are the suite, whose version every result row carries. A further one has a name of its own and
is drawn or evaluated only where it is named.
"""

from __future__ import annotations

import warnings
from functools import lru_cache
from importlib.metadata import entry_points

from mitigate.corruptions import depth, eld, rgb
from mitigate.corruptions.language import families
from mitigate.corruptions.record import Record

GROUP = "mitigate.corruptions"  # of entry points: name = "package.module:RECORD"
SUITE = {
    record.name: record
    for record in sorted(
        (*rgb.RECORDS, *eld.RECORDS, *depth.RECORDS, *families.RECORDS), key=lambda r: r.place
    )
}
HEAD = ("name", "corrupts", "severity s", "kept in an episode", "drawn each frame", "source")


@lru_cache(maxsize=1)
def further() -> dict[str, Record]:
    """Records of installed packages; one that is none, or has the name of another, is left out with
    a warning, so that a package that nobody named stops nothing."""
    found: dict[str, Record] = {}
    for point in entry_points(group=GROUP):
        try:
            record = point.load()
            problem = _problem(record, {"clean", *SUITE, *found})
        except Exception as error:  # of any kind: it is another package's code
            problem = f"cannot be imported ({type(error).__name__}: {error})"
        if problem:
            warnings.warn(
                f"The corruption {point.name} = {point.value} of {point.dist and point.dist.name} "
                f"is left out: it {problem}.",
                stacklevel=2,
            )
        else:
            found[record.name] = record
    return found


def _problem(record: object, taken: set[str]) -> str:
    if not isinstance(record, Record):
        return f"is a {type(record).__name__}, not a mitigate.corruptions.Record"
    if record.name in taken:
        return f"is called {record.name!r}, as another one is"
    if record.modality == "instruction":
        return "corrupts instructions, which only ours do"
    return ""


def names(*modalities: str) -> tuple[str, ...]:
    """Names of the suite's corruptions of ``modalities``, in their order."""
    return tuple(name for name, record in SUITE.items() if record.modality in modalities)


def known(*modalities: str) -> tuple[str, ...]:
    """As :func:`names`, with the further ones behind."""
    own = names(*modalities)
    return own + tuple(n for n, r in further().items() if r.modality in modalities)


def record(name: str) -> Record:
    """The record of a known corruption; KeyError for another."""
    return SUITE[name] if name in SUITE else further()[name]


def title(name: str) -> str:
    """The name of a corruption in tables; of one that is not installed here, in words."""
    if name in SUITE or name in further():
        return record(name).title
    return name.replace("_", " ").capitalize()


def version(name: str) -> dict[str, str]:
    """What a row says of a corruption that is not the suite's."""
    return {"version": further()[name].version} if name in further() else {}


def modality(name: str) -> str:
    """What the corruption ``name`` corrupts."""
    return record(name).modality


def table() -> str:
    """All corruptions of frames as lines of aligned columns, a heading first."""
    found = [record(name) for name in known("rgb", "depth")]
    rows = [HEAD, *((r.name, r.modality, r.severity, r.episode, r.frame, r.source) for r in found)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
    return "\n".join(lines)
