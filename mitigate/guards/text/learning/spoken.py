"""Load hand-written texts in many styles, each paired with a plain version of the same route.

These texts are training and test data. They are not in the package, only in the folder
``tools/safeguard/data/styles`` of a checkout. A line of a file ``<style>.jsonl`` has the form
``{"task": "route", "parts": [[styled, plain], ...]}``. The task may also be "object". Each part
consists of whole sentences and a plain translation of them. The translation is empty if the part
does not describe the route. Some styles are never used for training.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from mitigate.core.files import find
from mitigate.core.names import unknown

FOLDER = "tools/safeguard/data/styles"
VALIDATION = ("butler", "gps", "non_native")  # styles that are used only to choose settings
# styles that are used only for the reported results
TEST = ("bureaucratic", "elaborate", "poetic", "storyteller", "tour_guide")
SPLITS = ("train", "validation", "test")
LONGEST = 80  # maximum number of words of a training passage (heuristic)


@dataclass(frozen=True)
class Spoken:
    """A hand-written text.

    ``parts`` lists pairs (styled sentences, plain sentences) in order. ``task`` is "route" or
    "object".
    """

    voice: str
    task: str
    parts: tuple[tuple[str, str], ...]

    @property
    def original(self) -> str:
        """The complete text in its original style."""
        return " ".join(original for original, _ in self.parts)

    @property
    def plain(self) -> str:
        """The plain translation of the complete text."""
        return " ".join(plain for _, plain in self.parts if plain)


def available() -> bool:
    """Return whether the texts are available; they exist only in a checkout of the repository."""
    return find(FOLDER).is_dir()


@lru_cache(maxsize=4)
def spoken(split: str) -> tuple[Spoken, ...]:
    """Return all texts of the styles in a split.

    Raises ValueError for an unknown split.
    """
    if split not in SPLITS:
        raise ValueError(unknown("split", split, SPLITS))
    styles = {"validation": VALIDATION, "test": TEST}.get(split)
    texts: list[Spoken] = []
    for file in sorted(find(FOLDER).glob("*.jsonl")):
        held_out = file.stem in (*VALIDATION, *TEST)
        if file.stem in styles if styles else not held_out:
            texts += _read(file)
    return tuple(texts)


def passage(rng: np.random.Generator) -> tuple[str, str]:
    """Sample consecutive parts of a random training text.

    Returns these parts in their original style, and their plain translation.
    """
    texts = spoken("train")
    parts = texts[int(rng.integers(len(texts)))].parts
    share = rng.random()
    count = 1 if share < 0.45 else int(rng.integers(2, 4)) if share < 0.8 else len(parts)
    first = int(rng.integers(max(1, len(parts) - count + 1)))
    chosen = parts[first : first + count]
    while len(chosen) > 1 and sum(len(original.split()) for original, _ in chosen) > LONGEST:
        chosen = chosen[:-1]
    return " ".join(original for original, _ in chosen), " ".join(
        plain for _, plain in chosen if plain
    )


def _read(file: Path) -> list[Spoken]:
    texts = []
    for line in file.read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        parts = tuple((original, plain) for original, plain in entry["parts"])
        texts.append(Spoken(file.stem, entry["task"], parts))
    return texts
