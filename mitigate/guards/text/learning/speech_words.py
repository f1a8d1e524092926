"""The words that people say beside the way (``plain/speech_words.txt``), counted in the train
voices.

``python -m mitigate.guards.text.learning.speech_words --write`` writes them anew, in a checkout.
"""

from __future__ import annotations

import argparse
from collections import Counter

from mitigate.core.files import atomic_text
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.guards.text.learning.spoken import spoken
from mitigate.guards.text.plain.edits import DROP, taught, tokens
from mitigate.guards.text.plain.speech_words import FILE
from mitigate.guards.text.texts.lexicon import FUNCTION

SHARE, LEAST = 0.7, 3  # how often of how many times a word is left out at least (ours)


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
