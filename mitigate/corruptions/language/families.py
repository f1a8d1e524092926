"""The records of the instruction corruptions (``instruction.py`` applies them)."""

from __future__ import annotations

from mitigate.corruptions.record import Record


def _family(name: str, place: int, severity: str, label: str = "") -> Record:
    return Record(
        name, "instruction", None, severity, place, label, episode="all draws", source="NavTrust"
    )


RECORDS = (
    _family("friendly", 20, "probability that it is told in a friendly manner"),
    _family("novice", 21, "probability that it is told as by a novice"),
    _family("professional", 22, "probability that it is told as by a professional"),
    _family("formal", 23, "probability that it is told in a formal manner"),
    _family("capitalize", 24, "share of words that are stressed by capitals", "Capitalizing"),
    _family("mask", 25, "share of words that are hidden", "Masking"),
    _family("black_box", 26, "share of the bank of misleading prefixes", "Black-box prompt"),
    _family("white_box", 27, "the same, in the system prompt", "White-box prompt"),
)
