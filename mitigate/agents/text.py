"""Words to ids: a small closed vocabulary with ``[MASK]`` and unknown words."""

from __future__ import annotations

import re
from functools import lru_cache

import torch

from mitigate.agents.concepts import CONCEPTS
from mitigate.envs.apartments.furniture import CATEGORIES, ROOM_KINDS
from mitigate.envs.apartments.instructions import OPENERS, TEMPLATES
from mitigate.envs.apartments.palette import COLOUR_NAMES

PAD, UNKNOWN, MASK = 0, 1, 2
MAX_WORDS = 80
_WORD = re.compile(r"\[MASK\]|[a-z]+")


@lru_cache(maxsize=1)
def vocabulary() -> dict[str, int]:
    """Every word of the training templates and of the names of things, colours and rooms."""
    phrases = [p for group in TEMPLATES["train"].values() for p in group]
    phrases += [*OPENERS, *CATEGORIES, *COLOUR_NAMES, *ROOM_KINDS]
    words = {w for p in phrases for w in _WORD.findall(re.sub(r"\{.*?\}", " ", p))}
    return {word: index for index, word in enumerate(["[PAD]", "[UNK]", "[MASK]", *sorted(words)])}


def encode(text: str) -> list[int]:
    """Ids of the words of an instruction (lower case; at most ``MAX_WORDS``), never empty."""
    lowered = re.sub(r"\[mask\]", "[MASK]", text.lower())
    ids = [vocabulary().get(word, UNKNOWN) for word in _WORD.findall(lowered)]
    return ids[:MAX_WORDS] or [UNKNOWN]


def pad(rows: list[list[int]]) -> torch.Tensor:
    """Token rows to int64 [n, longest], padded with ``PAD``."""
    out = torch.full((len(rows), max(map(len, rows))), PAD, dtype=torch.int64)
    for index, row in enumerate(rows):
        out[index, : len(row)] = torch.tensor(row)
    return out


def concept_words() -> torch.Tensor:
    """Matrix float32 [concepts, vocabulary]: row c averages the words of concept c."""
    out = torch.zeros(len(CONCEPTS), len(vocabulary()))
    for row, concept in enumerate(CONCEPTS):
        ids = [vocabulary()[word] for word in concept.removeprefix("near ").split()]
        out[row, ids] = 1.0 / len(ids)
    return out
