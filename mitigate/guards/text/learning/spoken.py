"""Load hand-written texts in many styles, each paired with a plain version of the same route.

These texts are training data. They are not in the package, only in the folder
``tools/safeguard/data/styles`` of a checkout. A line of a file ``<style>.jsonl`` has the form
``{"task": "route", "parts": [[styled, plain], ...]}``. The task may also be "object". Each part
consists of whole sentences and a plain translation of them. The translation is empty if the part
does not describe the route.
"""

from __future__ import annotations

import json
from functools import lru_cache

import numpy as np

from mitigate.core.files import find
from mitigate.core.seeding import pick

FOLDER = "tools/safeguard/data/styles"
# styles that the language model never sees in training
EXCLUDED = (
    "butler",
    "gps",
    "non_native",
    "bureaucratic",
    "elaborate",
    "poetic",
    "storyteller",
    "tour_guide",
)
LONGEST = 80  # maximum number of words of a training passage (heuristic)
Parts = tuple[tuple[str, str], ...]  # pairs (styled sentences, plain sentences), in order


def available() -> bool:
    """Return whether the texts are available; they exist only in a checkout of the repository."""
    return find(FOLDER).is_dir()


@lru_cache(maxsize=1)
def texts() -> tuple[Parts, ...]:
    """Return the parts of each training text."""
    files = [file for file in sorted(find(FOLDER).glob("*.jsonl")) if file.stem not in EXCLUDED]
    lines = [line for file in files for line in file.read_text(encoding="utf-8").splitlines()]
    return tuple(
        tuple((original, plain) for original, plain in json.loads(x)["parts"]) for x in lines
    )


def passage(rng: np.random.Generator) -> tuple[str, str]:
    """Sample consecutive parts of a random training text.

    Returns these parts in their original style, and their plain translation.
    """
    parts = pick(texts(), rng)
    share = rng.random()
    count = 1 if share < 0.45 else int(rng.integers(2, 4)) if share < 0.8 else len(parts)
    first = int(rng.integers(max(1, len(parts) - count + 1)))
    chosen = parts[first : first + count]
    while len(chosen) > 1 and sum(len(original.split()) for original, _ in chosen) > LONGEST:
        chosen = chosen[:-1]
    source = " ".join(original for original, _ in chosen)
    return source, " ".join(plain for _, plain in chosen if plain)
