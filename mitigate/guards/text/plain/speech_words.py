"""Words that people say beside the way, by the train voices: in parts of a text that tell of it,
they are mostly left out of the same part in plain words.

``learning/speech_words.py`` counts them.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

FILE = Path(__file__).with_name("speech_words.txt")


@lru_cache(maxsize=1)
def speech_words() -> frozenset[str]:
    """Return the words, in lower case."""
    return frozenset(FILE.read_text(encoding="utf-8").split())
