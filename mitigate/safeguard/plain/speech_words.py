"""Words that people say beside the way, by the train voices: in parts of a text that tell of it,
they are mostly left out of the same part in plain words.

``python -m mitigate.safeguard.plain.speech_words --write`` counts them anew, in a checkout.
"""

from __future__ import annotations

import argparse
from collections import Counter
from functools import lru_cache
from pathlib import Path

from mitigate.core.files import atomic_text
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.safeguard.learning.spoken import spoken
from mitigate.safeguard.lexicon import FUNCTION
from mitigate.safeguard.plain.edits import DROP, taught, tokens

FILE = Path(__file__).with_name("speech_words.txt")
SHARE, LEAST = 0.7, 3  # how often of how many times a word is left out at least (ours)


@lru_cache(maxsize=1)
def speech_words() -> frozenset[str]:
    """Return the words, in lower case."""
    return frozenset(FILE.read_text(encoding="utf-8").split())


def counted() -> frozenset[str]:
    """Return the words by the train voices, content words that name no landmark alone."""
    heard: Counter[str] = Counter()
    left_out: Counter[str] = Counter()
    for said, plain in (part for text in spoken("train") for part in text.parts if part[1]):
        for token, edit in zip(tokens(said), taught(said, plain), strict=True):
            heard[token.lower] += 1
            left_out[token.lower] += edit.act == DROP
    return frozenset(
        word
        for word, times in heard.items()
        if times >= LEAST
        and left_out[word] >= SHARE * times
        and word not in FUNCTION
        and word not in CANONICAL
        and any(c.isalpha() for c in word)
    )


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"write {FILE.name}")
    words = sorted(counted())
    if parser.parse_args().write:
        with atomic_text(FILE) as file:
            file.write("\n".join(words) + "\n")
    print(f"{len(words)} words")


if __name__ == "__main__":
    main()
