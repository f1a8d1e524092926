"""Tests of this project's part-of-speech tagger on hand-labelled words, and of spaCy if an English
pipeline is installed."""

from __future__ import annotations

from pathlib import Path

import pytest

from mitigate.corruptions.language import tagger

LABELLED = (Path(__file__).parent / "tagged.txt").read_text(encoding="utf-8")
TUNED, UNSEEN = LABELLED.split("# what follows")
CONTENT = {"NOUN", "PROPN", "VERB", "ADP"}


def pairs(text: str, tag) -> list[tuple[str, str, str]]:
    """Return (word, hand-made label, predicted tag) for every word, without punctuation."""
    matches = []
    for line in text.splitlines():
        if "/" not in line:
            continue
        words = [pair.rsplit("/", 1) for pair in line.split()]
        tags = tag(" ".join(word for word, _ in words))
        assert [token.text for token in tags] == [word for word, _ in words]
        matches += [(*pair, token.tag) for pair, token in zip(words, tags, strict=True)]
    return [triple for triple in matches if triple[1] != "PUNCT"]


def accuracy(triples: list[tuple[str, str, str]]) -> float:
    return sum(label == tag for _, label, tag in triples) / len(triples)


def test_tagger_scores_on_known_and_new_texts():
    tuned, unseen = pairs(TUNED, tagger.tag), pairs(UNSEEN, tagger.tag)
    assert len(tuned) >= 200 and len(unseen) >= 150
    assert round(accuracy(tuned), 3) == 0.99 and round(accuracy(unseen), 3) == 0.96  # docs


def test_installed_spacy_pipeline_is_used_with_overrides():
    try:
        spacy = tagger.named("spacy")
    except ValueError as error:
        assert "extra nlp" in str(error) and "tagger=own" in str(error)
        pytest.skip("no English spaCy pipeline is installed")
    assert accuracy(pairs(UNSEEN, spacy)) >= 0.9
    assert spacy("turn left")[1].tag == tagger.tag("turn left")[1].tag


def test_tokens_cover_every_word_of_any_text():
    text = "Don't go to [MASK]—the café’s 2nd room 🙂\x07!"
    matches = tagger.tokens(text)
    assert all(text[t.start : t.end] == t.text for t in matches)
    assert [t.text for t in matches if t.is_word] == [
        *("Don't", "go", "to", "the", "café’s", "2nd", "room"),
    ]
