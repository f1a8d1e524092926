"""Words to ids: a small closed vocabulary with ``[MASK]`` and unknown words.

An agent's vocabulary is one of its settings, so it comes with the weights and counts towards the
agent's identity: with equally many but other words, weights would load and misread.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import torch

from mitigate.agents.concepts import CONCEPTS

SPECIAL = ("[PAD]", "[UNK]", "[MASK]")
PAD, UNKNOWN, MASK = range(3)
MAX_WORDS = 80
_WORDS = """
    a after ahead all along an and are armchair around at back bathroom bathtub bear bed
    bedroom beside beyond blue bookshelf brown by cabinet carry chair completely continue
    cross desk dining done door doorway enter exit face find for forward fridge front full go
    going green head in inside into it keep kitchen lamp leave left living locate look machine
    make move near nearest next of office on once orange other out painting pass past plant
    proceed purple reach red right room rug search side sink sofa stand step stop stove
    straight swing table take that the then there through to toilet towards turn tv up wait
    walk wardrobe washing way when white with yellow you your
"""
WORDS = tuple(_WORDS.split())  # all of the apartments' training templates
_WORD = re.compile(r"\[MASK\]|[a-z]+")


class Vocabulary:
    """The words an agent knows, in the order of their ids.

    Args: words: lower-case words without the special ones; None: ``WORDS``. Raises ValueError for
    a word that comes twice or that no text could hold, and if a concept's word is missing.
    """

    def __init__(self, words: Sequence[str] | None = None) -> None:
        self.words = WORDS if words is None else tuple(words)
        wrong = [word for word in self.words if not re.fullmatch("[a-z]+", word)]
        if wrong or len(set(self.words)) < len(self.words):
            raise ValueError(
                f"A vocabulary lists words of the letters a to z, each once; these are not: "
                f"{', '.join(map(repr, wrong[:4])) or 'some come twice'}."
            )
        self.ids = {word: index for index, word in enumerate((*SPECIAL, *self.words))}
        lacking = {w for concept in CONCEPTS for w in _words_of(concept)} - self.ids.keys()
        if lacking:
            raise ValueError(
                f"The vocabulary lacks {', '.join(sorted(lacking)[:8])}: the agent names what it "
                "sees by these words."
            )

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self):
        return iter(self.ids)

    def encode(self, text: str) -> list[int]:
        """Ids of the words of an instruction (lower case; at most ``MAX_WORDS``), never empty."""
        lowered = re.sub(r"\[mask\]", "[MASK]", text.lower())
        ids = [self.ids.get(word, UNKNOWN) for word in _WORD.findall(lowered)]
        return ids[:MAX_WORDS] or [UNKNOWN]

    def concept_words(self) -> torch.Tensor:
        """Matrix float32 [concepts, vocabulary]: row c averages the words of concept c."""
        out = torch.zeros(len(CONCEPTS), len(self))
        for row, concept in enumerate(CONCEPTS):
            ids = [self.ids[word] for word in _words_of(concept)]
            out[row, ids] = 1.0 / len(ids)
        return out


def pad(rows: list[list[int]]) -> torch.Tensor:
    """Token rows to int64 [n, longest], padded with ``PAD``."""
    out = torch.full((len(rows), max(map(len, rows))), PAD, dtype=torch.int64)
    for index, row in enumerate(rows):
        out[index, : len(row)] = torch.tensor(row)
    return out


def _words_of(concept: str) -> list[str]:
    return concept.removeprefix("near ").split()
