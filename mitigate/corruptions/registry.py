"""All corruptions there are: ours, and those that installed packages bring.

Ours are the suite, whose version every result row carries. A further one has a name of its own and
is drawn or evaluated only where it is named.
"""

from __future__ import annotations

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
    """Records of installed packages. Raises ValueError for one that is no :class:`Record`, or has
    the name of another."""
    found: dict[str, Record] = {}
    for point in entry_points(group=GROUP):
        record = point.load()
        if not isinstance(record, Record):
            raise ValueError(
                f"The entry point {point.name} = {point.value} of {GROUP} is a "
                f"{type(record).__name__}, not a mitigate.corruptions.Record."
            )
        if record.name in SUITE or record.name in found:
            raise ValueError(
                f"The entry point {point.value} of {GROUP} brings a corruption called "
                f"{record.name!r}, and there is one already: give it another name."
            )
        found[record.name] = record
    return found


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
