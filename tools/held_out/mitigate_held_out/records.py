"""The records of all authors, and their division into two halves."""

from __future__ import annotations

from mitigate.corruptions import Record

from . import author_a, author_b, author_c

RECORDS = tuple(
    value
    for author in (author_a, author_b, author_c)
    for value in vars(author).values()
    if isinstance(value, Record)
)
NAMES = tuple(record.name for record in RECORDS)
# Each author wrote 8 RGB and 6 depth corruptions. So both halves contain 4 and 3 of each author.
VALIDATION_HALF = NAMES[0::2]  # to choose methods and settings
TEST_HALF = NAMES[1::2]  # to report
