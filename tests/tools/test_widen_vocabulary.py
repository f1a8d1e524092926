"""New words for an agent: known ones keep their embedding, new ones start near their like."""

from __future__ import annotations

import torch

from mitigate.agents.text import SPECIAL, WORDS, Vocabulary
from tools.widen_vocabulary import LIKE, widened


def test_known_words_keep_their_rows_and_a_new_one_starts_from_its_like():
    known = ["go", "turn", "walk"]
    table = torch.arange(6.0)[:, None].expand(-1, 4)  # three special ones in front
    found = widened(table, known, ("swing", "go", "step", "zebra"))
    assert found[: len(SPECIAL)].equal(table[: len(SPECIAL)])
    swing, go, step, zebra = found[len(SPECIAL) :, 0]
    assert (swing, go, step, zebra) == (4, 3, 4, 4)  # as turn; itself; of walk and go; the mean


def test_every_new_word_is_of_the_vocabulary_and_its_like_are_words():
    assert set(LIKE) <= set(WORDS)
    assert {word for like in LIKE.values() for word in like.split()} <= set(Vocabulary())
