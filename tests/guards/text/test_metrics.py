"""Tests of text metrics on repairs whose scores are known."""

from __future__ import annotations

import pytest

from mitigate.corruptions import Key, corrupt_instruction
from mitigate.corruptions.instruction import stacked
from mitigate.guards.text.metrics import Repair, by_family, score, table, token_f1

TEXT = "Walk past the sofa, turn left and stop by the lamp."


def test_score_is_one_for_a_perfect_repair():
    attack = tuple(stacked(1.0, Key(0, "1"), "test"))
    heard = corrupt_instruction(TEXT, "black_box", 1.0, Key(0, "1"))
    scores = score([Repair("black_box", TEXT, heard, TEXT, attack)])
    assert (scores.exact, scores.token_f1, scores.directions, scores.landmarks) == (1, 1, 1, 1)
    assert scores.chrf == pytest.approx(1) and scores.faithful == scores.removed == 1
    assert scores.changed is None


def test_score_is_zero_for_a_kept_attack():
    attack = tuple(stacked(1.0, Key(0, "1"), "test"))
    heard = corrupt_instruction(TEXT, "black_box", 1.0, Key(0, "1"))
    scores = score([Repair("black_box", TEXT, heard, heard, attack)])
    assert scores.removed == 0 and scores.exact == 0 and scores.landmarks == 1
    half = heard.replace(attack[0], "")
    assert score([Repair("black_box", TEXT, heard, half, attack)]).removed == 1 / len(attack)


def test_score_counts_a_damaged_clean_instruction():
    flipped = TEXT.replace("left", "right")
    lost = TEXT.replace(" by the lamp", "")
    scores = score([Repair("clean", TEXT, TEXT, text) for text in (TEXT, TEXT, flipped, lost)])
    assert scores.changed == 0.5 and scores.faithful == 0.5 and scores.exact == 0.5
    assert scores.directions == 0.75 and scores.landmarks == 7 / 8


def test_score_counts_a_paraphrase_as_faithful():
    message = "Go past the couch, hang a left and halt by the lamp."
    scores = score([Repair("friendly", TEXT, message, message)])
    assert scores.faithful == scores.landmarks == scores.directions == 1
    assert scores.exact == 0 and 0.4 < scores.token_f1 < 0.9 and 0.2 < scores.chrf < 0.9


def test_token_f1_equals_hand_computed_values():
    assert token_f1("turn left now", "turn left") == pytest.approx(0.8)
    assert token_f1("a b", "") == token_f1("", "a b") == 0.0
    assert token_f1("Turn LEFT.", "turn left") == 1.0


def test_score_reports_each_family_and_all():
    repairs = [Repair("clean", TEXT, TEXT, TEXT), Repair("mask", TEXT, "?", TEXT.upper())]
    scores = by_family(repairs)
    assert list(scores) == ["clean", "mask", "all"] and scores["all"].count == 2
    assert scores["mask"].exact == 1 and scores["mask"].changed is None
    assert scores["all"].changed == 0
    lines = table(scores).splitlines()
    assert len(lines) == 5 and lines[2].startswith("| clean | 1 | 100.0 |") and "–" in lines[3]


def test_score_rejects_empty_input():
    with pytest.raises(ValueError, match="no repairs"):
        score([])
