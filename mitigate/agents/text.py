"""Define the concepts that agents recognise in views, and the vocabulary of instructions.

The RGB encoder predicts the concepts in the central 36 degrees of each view. The planner and
the recurrent policy multiply the probability of each concept by the text embedding of its word. So
the concepts in views and the words of instructions share one embedding space.

A vocabulary is a small, fixed list of words, with extra tokens for ``[MASK]`` and unknown words.
The vocabulary is one of an agent's settings, so it is stored with the weights and is part of the
fingerprint. Loading weights with a different vocabulary of the same size would raise no error, but
each embedding would represent a wrong word.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn.utils.rnn import pad_sequence

THING_NAMES = (
    *("bed", "wardrobe", "sofa", "armchair", "tv", "bookshelf", "lamp", "plant", "painting"),
    *("rug", "fridge", "stove", "sink", "toilet", "bathtub", "washing machine", "desk", "table"),
    *("chair", "cabinet"),
)
COLOUR_NAMES = ("red", "orange", "yellow", "green", "blue", "purple", "brown", "white")
ROOM_NAMES = ("bedroom", "bathroom", "kitchen", "living room", "office", "dining room")
# concepts are visible objects, objects nearer than 2 m, colours of objects, and kinds of rooms
CONCEPTS = (*THING_NAMES, *(f"near {name}" for name in THING_NAMES), *COLOUR_NAMES, *ROOM_NAMES)
THINGS = slice(0, len(THING_NAMES))
NEAR = slice(len(THING_NAMES), 2 * len(THING_NAMES))


SPECIAL = ("[PAD]", "[UNK]", "[MASK]")
PAD, UNKNOWN = 0, 1
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
WORDS = tuple(_WORDS.split())  # all words that occur in the training instructions for apartments
_WORD = re.compile(r"\[MASK\]|[a-z]+")


class Vocabulary:
    """The words that an agent knows, in the order of their ids.

    Args:
        words: lower-case words without the special tokens. None means ``WORDS``.

    Raises:
        ValueError: If a word is repeated or contains characters other than a to z, or if the word
            for a concept is missing.
    """

    def __init__(self, words: Sequence[str] | None = None) -> None:
        self.words = WORDS if words is None else tuple(words)
        wrong = [word for word in self.words if not re.fullmatch("[a-z]+", word)]
        if wrong or len(set(self.words)) < len(self.words):
            raise ValueError(
                "words of a vocabulary must be unique and contain only the letters a to z, got "
                f"{', '.join(map(repr, wrong[:4])) or 'repeated words'}."
            )
        self.ids = {word: index for index, word in enumerate((*SPECIAL, *self.words))}
        lacking = {w for concept in CONCEPTS for w in _words_of(concept)} - self.ids.keys()
        if lacking:
            raise ValueError(
                f"The vocabulary lacks {', '.join(sorted(lacking)[:8])}. The agent needs these "
                "words for the concepts that it recognises."
            )

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self):
        return iter(self.ids)

    def encode(self, text: str) -> list[int]:
        """Return the ids of the first ``MAX_WORDS`` words of an instruction.

        An unknown word gets the id of ``[UNK]``. A text without words gives only this id.
        """
        lowered = re.sub(r"\[mask\]", "[MASK]", text.lower())
        ids = [self.ids.get(word, UNKNOWN) for word in _WORD.findall(lowered)]
        return ids[:MAX_WORDS] or [UNKNOWN]

    def batch(self, texts: Sequence[str], blank: bool = False) -> Tensor:
        """Return the ids of n texts, int64 [n, longest], padded with ``PAD``.

        With ``blank``, every text is read as if it were empty.
        """
        rows = [torch.tensor(self.encode("" if blank else text)) for text in texts]
        return pad_sequence(rows, True, PAD)

    def concept_words(self) -> Tensor:
        """Return a matrix float32 [concepts, vocabulary] that maps concepts to words.

        Row c is the mean of the one-hot codes of the words of concept c.
        """
        out = torch.zeros(len(CONCEPTS), len(self))
        for row, concept in enumerate(CONCEPTS):
            ids = [self.ids[word] for word in _words_of(concept)]
            out[row, ids] = 1.0 / len(ids)
        return out


def _words_of(concept: str) -> list[str]:
    return concept.removeprefix("near ").split()
