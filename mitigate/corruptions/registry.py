"""Registry of all corruptions: the standard suite, unseen corruptions, errors of named depth
cameras, faults, random compositions, and plugins (packages).

Every result row contains the version of the suite. Corruptions outside the suite have their own
versions, and are used only where they are named explicitly. A pair, such as
``low_light+missing_data``, combines two corruptions: the first one is applied first, and each one
uses the same random numbers as when it is applied alone.
"""

from __future__ import annotations

import warnings
from functools import lru_cache, partial
from importlib.metadata import entry_points

from mitigate.core.names import unknown
from mitigate.corruptions import broad, depth, faults, rgb, sensors, unseen
from mitigate.corruptions.record import ACTION, FRAMES, MODALITIES, TEST, VALIDATION, Record

_record = partial(
    Record, modality="instruction", apply=None, episode="all draws", source="NavTrust"
)
INSTRUCTIONS = (  # applied by instruction.py
    _record("friendly", severity="probability of a rewrite in a friendly style"),
    _record("novice", severity="probability of a rewrite in the style of a novice"),
    _record("professional", severity="probability of a rewrite in a professional style"),
    _record("formal", severity="probability of a rewrite in a formal style"),
    _record("capitalize", severity="share of words in capitals", label="Capitalizing"),
    _record("mask", severity="share of words that are hidden", label="Masking"),
    _record("black_box", severity="share of misleading prefixes", label="Black-box prompt"),
    _record("white_box", severity="the same, in the system prompt", label="White-box prompt"),
)

# entry point group with entries of the form name = "package.module:RECORD"
GROUP = "mitigate.corruptions"
SUITE = {record.name: record for record in (*rgb.RECORDS, *depth.RECORDS, *INSTRUCTIONS)}
HALVES = (VALIDATION, TEST)
UNSEEN = {
    record.name: record
    for record in sorted(
        unseen.RECORDS, key=lambda r: (MODALITIES.index(r.modality), HALVES.index(r.half))
    )
}
# measured errors of named depth cameras, and stronger noise
SENSORS = {record.name: record for record in sensors.RECORDS}
# names of the random compositions for training
BROAD = {record.name: record for record in broad.RECORDS}
FAULTS = {record.name: record for record in faults.RECORDS}
INCLUDED = {**SUITE, **UNSEEN, **SENSORS, **FAULTS, **BROAD}
AND = "+"  # separator between the names of a pair


@lru_cache(maxsize=1)
def plugin_records() -> dict[str, Record]:
    """Return the records of installed packages.

    An invalid record is skipped with a warning, so that a broken package causes no error if it is
    not used.
    """
    records: dict[str, Record] = {}
    for point in entry_points(group=GROUP):
        try:
            record = point.load()
            problem = _problem(record, {"clean", *INCLUDED, *records})
        except Exception as error:  # the code of an installed package may raise any error
            problem = f"cannot be imported ({type(error).__name__}: {error})"
        if problem:
            warnings.warn(
                f"The corruption {point.name} = {point.value} of {point.dist and point.dist.name} "
                f"is left out: it {problem}.",
                stacklevel=2,
            )
        else:
            records[record.name] = record
    return records


def _problem(record: object, names: set[str]) -> str:
    """Return the reason why a package's record cannot be used, or "" if it can."""
    if not isinstance(record, Record):
        return f"is a {type(record).__name__}, not a mitigate.corruptions.Record"
    if record.name in names:
        return f"has the name {record.name!r} of another corruption"
    if record.modality == "instruction":
        return "corrupts instructions, which packages cannot add"
    if record.family or record.draw or record.modality not in MODALITIES:
        return "is a fault, which packages cannot add"
    return ""


def names(*modalities: str) -> tuple[str, ...]:
    """Return the names of the suite's corruptions that change one of ``modalities``, in order."""
    return tuple(name for name, record in SUITE.items() if record.modality in modalities)


def unseen_names(*modalities: str, half: str = "") -> tuple[str, ...]:
    """Return the names of the unseen corruptions that change one of ``modalities``.

    ``half`` restricts them to the validation or the test set.

    Raises:
        ValueError: If ``half`` is unknown.
    """
    if half not in ("", *HALVES):
        raise ValueError(unknown("half of the unseen corruptions", half, HALVES))
    return tuple(
        name
        for name, record in UNSEEN.items()
        if record.modality in modalities and half in ("", record.half)
    )


def known(*modalities: str) -> tuple[str, ...]:
    """Return the names of all corruptions that change one of ``modalities``, except faults."""
    records = {**SUITE, **UNSEEN, **SENSORS, **BROAD, **plugin_records()}
    return tuple(name for name, record in records.items() if record.modality in modalities)


def fault_names(*families: str) -> tuple[str, ...]:
    """Return the names of all faults in ``families``, in order."""
    return tuple(name for name, record in FAULTS.items() if record.family in families)


def family(name: str) -> str:
    """Return the family of the first fault in a corruption or pair, or "" without a fault."""
    return next((FAULTS[part].family for part in parts(name) if part in FAULTS), "")


def record(name: str) -> Record:
    """Return the record of a corruption; raise KeyError for an unknown name."""
    return INCLUDED[name] if name in INCLUDED else plugin_records()[name]


def parts(name: str) -> tuple[str, ...]:
    """Split the name of a pair into its two names; a single name gives a tuple of one."""
    return tuple(name.split(AND))


def title(name: str) -> str:
    """Return the title of a corruption for tables, even if its package is not installed."""
    if AND in name:
        return f" {AND} ".join(map(title, parts(name)))
    if name in INCLUDED or name in plugin_records():
        return record(name).title
    return name.replace("_", " ").capitalize()


def version(name: str) -> dict[str, str]:
    """Return the entry ``version`` of a result row; it is empty if all parts are in the suite."""
    others = (part for part in parts(name) if part != "clean" and part not in SUITE)
    versions = [record(part).version for part in others]
    return {"version": AND.join(versions)} if versions else {}


def modality(name: str) -> str:
    """Return the modality that a corruption changes, or "rgb+depth" for faults of both sensors."""
    return record(name).modality


def table() -> str:
    """Return a text table of all frame corruptions, in aligned columns with a heading."""
    rows = [("name", "corrupts", "severity s", "per episode", "per frame", "source", "suite")]
    for r in (*(record(name) for name in known("rgb", "depth")), *FAULTS.values()):
        if r.modality != ACTION:
            sensor = "both" if r.modality == FRAMES else r.modality
            rows.append((r.name, sensor, r.severity, r.episode, r.frame, r.source, _suite(r)))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
    return "\n".join(lines)


def _suite(record: Record) -> str:
    """Return the smallest suite in ``conf/suite`` that contains a corruption, or "-"."""
    short = {VALIDATION: "unseen_val", TEST: "unseen_test"}
    if record.name in SUITE:
        return "full"
    if record in sensors.CAMERAS:
        return "sensors"
    return record.family or short.get(record.half, "-")
