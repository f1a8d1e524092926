"""Tests of hand-written texts in different styles, and of their split into train and test texts."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.guards.text.learning import spoken


def test_spoken_splits_share_no_voice_and_no_text():
    matches = {split: spoken.spoken(split) for split in spoken.SPLITS}
    by_voice = [{text.voice for text in texts} for texts in matches.values()]
    assert sum(map(len, by_voice)) == len(set.union(*by_voice)) >= 16
    lines_of_text = [{text.original.lower() for text in texts} for texts in matches.values()]
    assert sum(map(len, lines_of_text)) == len(set.union(*lines_of_text))
    assert sum(len(texts) for texts in matches.values()) >= 1500


def test_spoken_texts_have_plain_parts():
    for split in spoken.SPLITS:
        for text in spoken.spoken(split):
            assert text.plain and text.original != text.plain, text
            assert all(message.strip() for message, _ in text.parts), text
            assert text.task in ("route", "object")


def test_passage_returns_neighbouring_parts_of_a_train_voice():
    train = {text.original: text for text in spoken.spoken("train")}
    for seed in range(200):
        message, plain = spoken.passage(np.random.default_rng(seed))
        assert message and len(message.split()) <= 250
        (whole,) = [t for heard, t in train.items() if message in heard][:1]
        assert all(part in whole.plain for part in plain.split(". ")[:1] if part)


def test_spoken_names_the_known_splits():
    with pytest.raises(ValueError, match="train, validation, test"):
        spoken.spoken("dev")
