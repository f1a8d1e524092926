"""The records of the instruction corruptions (``instruction.py`` applies them)."""

from __future__ import annotations

from mitigate.corruptions.record import Record


def _record(name: str, place: int, severity: str, label: str = "") -> Record:
    return Record(
        name, "instruction", None, severity, place, label, episode="all draws", source="NavTrust"
    )


RECORDS = (
    _record("friendly", 20, "probability that it is told in a friendly manner"),
    _record("novice", 21, "probability that it is told as by a novice"),
    _record("professional", 22, "probability that it is told as by a professional"),
    _record("formal", 23, "probability that it is told in a formal manner"),
    _record("capitalize", 24, "share of words that are stressed by capitals", "Capitalizing"),
    _record("mask", 25, "share of words that are hidden", "Masking"),
    _record("black_box", 26, "share of the bank of misleading prefixes", "Black-box prompt"),
    _record("white_box", 27, "the same, in the system prompt", "White-box prompt"),
)
