"""All corruptions there are: the suite, the unseen ones, and those that installed packages bring.

Every result row carries the version of the suite. An unseen or further one has a version of its own
and is drawn or evaluated only where it is named. Two at once are a pair, such as
``low_light+missing_data``: the first is applied first, and each draws what it draws alone.
"""

from __future__ import annotations

import warnings
from functools import lru_cache
from importlib.metadata import entry_points

from mitigate.core.names import unknown
from mitigate.corruptions import broad, depth, eld, rgb, unseen
from mitigate.corruptions.record import MODALITIES, TEST, VALIDATION, Record


def _record(name: str, place: int, severity: str, label: str = "") -> Record:
    return Record(
        name, "instruction", None, severity, place, label, episode="all draws", source="NavTrust"
    )


INSTRUCTIONS = (  # applied by instruction.py
    _record("friendly", 20, "probability that it is told in a friendly manner"),
    _record("novice", 21, "probability that it is told as by a novice"),
    _record("professional", 22, "probability that it is told as by a professional"),
    _record("formal", 23, "probability that it is told in a formal manner"),
    _record("capitalize", 24, "share of words that are stressed by capitals", "Capitalizing"),
    _record("mask", 25, "share of words that are hidden", "Masking"),
    _record("black_box", 26, "share of the bank of misleading prefixes", "Black-box prompt"),
    _record("white_box", 27, "the same, in the system prompt", "White-box prompt"),
)


GROUP = "mitigate.corruptions"  # of entry points: name = "package.module:RECORD"
SUITE = {
    record.name: record
    for record in sorted(
        (*rgb.RECORDS, *eld.RECORDS, *depth.RECORDS, *INSTRUCTIONS), key=lambda r: r.place
    )
}
HALVES = (VALIDATION, TEST)
UNSEEN = {
    record.name: record
    for record in sorted(
        unseen.RECORDS, key=lambda r: (MODALITIES.index(r.modality), HALVES.index(r.half))
    )
}
BROAD = {record.name: record for record in broad.RECORDS}  # to train on, by modality
AND = "+"  # between the names of a pair
HEAD = (
    "name",
    "corrupts",
    "severity s",
    "kept in an episode",
    "drawn each frame",
    "source",
    "suite",
)


@lru_cache(maxsize=1)
def further() -> dict[str, Record]:
    """Records of installed packages; one that is none, or has the name of another, is left out with
    a warning, so that a package that nobody named stops nothing."""
    found: dict[str, Record] = {}
    for point in entry_points(group=GROUP):
        try:
            record = point.load()
            problem = _problem(record, {"clean", *SUITE, *UNSEEN, *BROAD, *found})
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


def unseen_names(*modalities: str, half: str = "") -> tuple[str, ...]:
    """Names of the unseen corruptions of ``modalities``, of one half or of both.

    Raises ValueError for a half that is none.
    """
    if half not in ("", *HALVES):
        raise ValueError(unknown("half of the unseen corruptions", half, HALVES))
    return tuple(
        name
        for name, record in UNSEEN.items()
        if record.modality in modalities and half in ("", record.half)
    )


def known(*modalities: str) -> tuple[str, ...]:
    """As :func:`names`, with the unseen, the broad and the further ones behind."""
    others = {**BROAD, **further()}.items()
    own = names(*modalities) + unseen_names(*modalities)
    return own + tuple(n for n, r in others if r.modality in modalities)


def broad_name(modality: str) -> str:
    """The broad augmentation of a modality."""
    return next(name for name, record in BROAD.items() if record.modality == modality)


def record(name: str) -> Record:
    """The record of a known corruption; KeyError for another."""
    return SUITE.get(name) or UNSEEN.get(name) or BROAD.get(name) or further()[name]


def parts(name: str) -> tuple[str, ...]:
    """The corruptions that ``name`` stands for, in their order: one, or those of a pair."""
    return tuple(name.split(AND))


def title(name: str) -> str:
    """The name of a corruption in tables; of one that is not installed here, in words."""
    if AND in name:
        return f" {AND} ".join(map(title, parts(name)))
    if name in {**SUITE, **UNSEEN, **BROAD} or name in further():
        return record(name).title
    return name.replace("_", " ").capitalize()


def version(name: str) -> dict[str, str]:
    """What a row says of a corruption that is not, or not only, the suite's."""
    own = (part for part in parts(name) if part != "clean" and part not in SUITE)
    versions = [record(part).version for part in own]
    return {"version": AND.join(versions)} if versions else {}


def modality(name: str) -> str:
    """What the corruption ``name`` corrupts."""
    return record(name).modality


def table() -> str:
    """All corruptions of frames as lines of aligned columns, a heading first."""
    found = [record(name) for name in known("rgb", "depth")]
    rows = [
        (r.name, r.modality, r.severity, r.episode, r.frame, r.source, _suite(r)) for r in found
    ]
    rows = [HEAD, *rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
    return "\n".join(lines)


def _suite(record: Record) -> str:
    """The smallest suite of ``conf/suite`` that has it; none has a further one."""
    short = {VALIDATION: "unseen_val", TEST: "unseen_test"}
    return "full" if record.name in SUITE else short.get(record.half, "-")
