"""Tests of the features of clauses."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core.files import find
from mitigate.guards.text import choices, classifier
from mitigate.guards.text.features import ALIKE, CLIP, FEATURES, features

RARE, CAPITALS, YOU, ME, TURNS, DENIALS, SHOUT, DIGITS = 22, 23, 25, 26, 27, 30, 31, 33
PREVIOUS, BEFORE, AFTER, SPLIT = 36, 37, 38, 39


@pytest.fixture(scope="module")
def shipped():
    return classifier.load(find(choices.CLASSIFIER))


def computed(text, shipped):
    return features(text, shipped.clauses(text), shipped)


def test_features_are_finite_for_odd_texts(shipped):
    for text in (
        "Go",
        "... !!! ???",
        "请 不要 去. Stop.",
        "x " * 500,
        "<b></b> a. b. c.",
        "1 2 3. 4",
    ):
        if clauses := shipped.clauses(text):
            values = features(text, clauses, shipped)
            assert values.shape == (len(clauses), FEATURES)
            assert np.isfinite(values).all() and np.abs(values).max() <= CLIP


def test_features_describe_how_a_clause_is_written(shipped):
    plain, loud, mine = computed(
        "Turn left at the sofa. DON'T YOU MOVE! I lost my zorbly gr8 k3y.", shipped
    )
    assert plain[TURNS] == 1 and loud[TURNS] == 0
    assert loud[CAPITALS] > plain[CAPITALS] and loud[SHOUT] > plain[SHOUT]
    assert loud[YOU] > plain[YOU] == 0 and loud[DENIALS] == 1
    assert mine[ME] > plain[ME] == 0
    assert mine[RARE] > plain[RARE] and mine[DIGITS] > plain[DIGITS]


def test_similarity_is_high_among_clauses_with_the_same_words(shipped):
    values = computed(
        "The cat wants milk today. The cat wants milk today. Turn left at the sofa.", shipped
    )
    first, second, route = values
    assert first[PREVIOUS] == first[BEFORE] == first[SPLIT] == route[AFTER] == 0
    assert second[PREVIOUS] == pytest.approx(ALIKE, rel=1e-3)
    assert route[PREVIOUS] < 0.3 * ALIKE
    # the boundary between the two topics separates the text better than the one inside a topic
    assert route[SPLIT] < second[SPLIT]
