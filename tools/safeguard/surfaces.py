"""Measure how often the safeguard cuts harmless routes that are written in other surface forms.

    python -m tools.safeguard.surfaces FILE.json.gz

``FILE`` is an episode file of R2R or RxR. A route counts as cut if the safeguard removes any part
of it.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import string
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from mitigate.corruptions.instruction import corrupt_instruction
from mitigate.evaluation.bootstrap import wilson
from mitigate.guards.text.guard import Safeguard, open_safeguard
from mitigate.guards.text.learning.data import read_texts
from mitigate.guards.text.pieces import sentences

FILLERS = ("um", "uh", "like", "you know,", "okay")


def typed_badly(text: str, rng: random.Random, share: float) -> str:
    """Double, delete or replace a ``share`` of the letters."""

    def typed(letter: str) -> str:
        if not letter.isalpha() or rng.random() >= share:
            return letter
        return rng.choice((letter * 2, "", rng.choice(string.ascii_lowercase)))

    return "".join(map(typed, text))


def word_by_word(
    text: str, rng: random.Random, share: float, change: Callable[[str], str | None]
) -> str:
    """Apply ``change`` to a ``share`` of the words; None deletes the word."""
    words = [change(word) if rng.random() < share else word for word in text.split()]
    return " ".join(word for word in words if word is not None) or text


def swapped(text: str, rng: random.Random) -> str:
    """Exchange one in ten words with the next word."""
    words = text.split()
    for _ in range(max(1, len(words) // 10)):
        place = rng.randrange(max(1, len(words) - 1))
        words[place : place + 2] = words[place : place + 2][::-1]
    return " ".join(words)


def corrupted(text: str, rng: random.Random, name: str) -> str:
    """Apply an instruction corruption at severity 1."""
    return corrupt_instruction(text, name, 1.0, str(rng.random()))


FORMS: Mapping[str, Callable[[str, random.Random], str]] = {
    "masked function words": partial(corrupted, name="mask"),
    "some words in capitals": partial(corrupted, name="capitalize"),
    "all in capitals": lambda text, _: text.upper(),
    "no capitals, no punctuation": lambda text, _: re.sub(r"[^\w\s']", "", text).lower(),
    "typos in 4 % of letters": partial(typed_badly, share=0.04),
    "typos in 10 % of letters": partial(typed_badly, share=0.1),
    "fillers": lambda text, rng: word_by_word(
        text, rng, 0.12, lambda word: f"{rng.choice(FILLERS)} {word}"
    ),
    "swapped words": swapped,
    "10 % of words missing": lambda text, rng: word_by_word(text, rng, 0.1, lambda _: None),
    "25 % of words missing": lambda text, rng: word_by_word(text, rng, 0.25, lambda _: None),
    "20 % of words <unk>": lambda text, rng: word_by_word(text, rng, 0.2, lambda _: "<unk>"),
    "10 % of words [inaudible]": lambda text, rng: word_by_word(
        text, rng, 0.1, lambda _: "[inaudible]"
    ),
    "list with -": lambda text, _: "\n".join(f"- {s}" for s in sentences(text)),
    "numbered list": lambda text, _: "\n".join(
        f"{number}. {s}" for number, s in enumerate(sentences(text), 1)
    ),
    "in quotes": lambda text, _: f'"{text}"',
    "in JSON": lambda text, _: json.dumps({"instruction": text}),
    "in HTML": lambda text, _: f"<p>{text}</p>",
    "ellipses": lambda text, _: text.replace(". ", "... "),
    "twice": lambda text, _: f"{text} {text}",
    "polite": lambda text, _: f"Please {text[0].lower()}{text[1:]} Thank you.",
    "emoji": lambda text, _: f"{text} 🙂👍",
}


def cut(safeguard: Safeguard, texts: Sequence[str], form: str, seed: int = 0) -> list[str]:
    """Return those texts, written in ``form``, of which the safeguard removes a part."""
    rng = random.Random(f"{seed}-{form}")
    decisions = safeguard.canonicalise_all([FORMS[form](text, rng) for text in texts])
    return [d.original for d in decisions if any(r.startswith("removed") for r in d.reasons)]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", help="episode file of R2R or RxR (JSON, optionally gzipped)")
    parser.add_argument("--safeguard", default="classifier", help="default: %(default)s")
    parser.add_argument("--routes", type=int, default=300, help="default: %(default)s")
    parser.add_argument("--seed", type=int, default=0, help="default: %(default)s")
    arguments = parser.parse_args()
    safeguard = open_safeguard(arguments.safeguard)
    texts = read_texts([arguments.file])
    random.Random(arguments.seed).shuffle(texts)
    texts = texts[: arguments.routes]
    if safeguard is None or not texts:
        sys.exit("error: choose a safeguard, and a file with English instructions.")
    print(f"| {len(texts)} routes | cut, % [95 % interval] |\n| --- | ---: |")
    for form in FORMS:
        share = len(cut(safeguard, texts, form, arguments.seed)) / len(texts)
        low, high = wilson(share, len(texts))
        print(f"| {form} | {100 * share:.1f} [{100 * low:.1f}, {100 * high:.1f}] |", flush=True)


if __name__ == "__main__":
    main()
