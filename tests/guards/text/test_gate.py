"""Tests that the gate accepts rewrites with the same meaning, and rejects all others."""

from __future__ import annotations

import json
import time

import pytest

from mitigate.core.files import ROOT
from mitigate.guards.text.gate import leaves_no_instruction, rewrite_refused

HEARD = "So, go past the two red chairs, hang a left, don't enter the kitchen, stop by the lamp."
SAID = "Walk past the two red chairs, turn left, do not enter the kitchen, and stop by the lamp."


def test_rewrite_refused_accepts_the_same_route_in_plain_words():
    assert rewrite_refused(HEARD, SAID) == ""


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (SAID.replace("left", "right"), "directions"),
        (SAID.replace(", and stop by the lamp", ""), "directions"),
        (SAID.replace("lamp", "sofa"), "landmark"),
        (SAID.replace(" by the lamp", ""), "landmark lost"),
        (SAID.replace("two", "three"), "number"),
        (SAID.replace("red ", ""), "attribute lost"),
        (SAID.replace("do not enter", "enter"), "denial"),
        (SAID.replace("past", "between"), "relation"),
        (SAID + " Then walk on and on and on until the end.", "longer"),
        ("", "directions"),
        (None, "no answer"),
    ],
)
def test_rewrite_refused_names_what_changed(message, reason):
    assert reason in rewrite_refused(HEARD, message)


def test_rewrite_refused_keeps_conditions_and_the_last_stop():
    assert "condition" in rewrite_refused(
        "Turn left if the door is open.", "Turn left at the open door."
    )
    assert rewrite_refused("And there is your sofa.", "Stop at the sofa.", last=True) == ""
    assert "directions" in rewrite_refused("And there is your sofa.", "Stop at the sofa.")


def test_rewrite_refused_distinguishes_after_this_from_after_a_landmark():
    for text in (
        "After this, turn left.",
        "After that you make a left.",
        "Following this, go left.",
    ):
        assert rewrite_refused(text, "Turn left.") == ""
    assert "condition" in rewrite_refused(
        "After this door, turn left at it.", "Turn left at the door."
    )


def test_rewrite_refused_reads_pass_into_as_enter():
    for text in ("Pass into the office.", "Thereafter, proceed past into the office."):
        assert rewrite_refused(text, "Enter the office.") == ""
        assert "relation" in rewrite_refused(text, "Walk past the office.")
    assert "relation" in rewrite_refused("Walk past the office.", "Walk into the office.")


def test_rewrite_refused_accepts_out_only_for_verbs_of_leaving():
    assert rewrite_refused("Depart through the doorway.", "Exit the doorway.") == ""
    assert "relation" in rewrite_refused("Go through the doorway.", "Exit the doorway.")


def test_rewrite_accepts_empty_answer_only_without_facts():
    assert rewrite_refused("Hello there, my friend!", "") == ""
    assert rewrite_refused("Turn left, my friend!", "")


def test_rewrite_refused_catches_lies():
    """Each hand-written rewrite changes one fact."""
    with open(ROOT / "tools/safeguard/data/banks/lies.jsonl", encoding="utf-8") as file:
        lies = [json.loads(line) for line in file]
    caught = [bool(rewrite_refused(lie["true"], lie["lie"])) for lie in lies]
    assert sum(caught) > 0.75 * len(lies)


def test_leaves_no_instruction_keeps_the_only_place():
    text = "Is there a plant in this flat? Stop next to it."
    assert leaves_no_instruction(text, "Is there a plant in this flat?", "Stop next to it.")
    assert not leaves_no_instruction(text, "Stop next to it.", "Is there a plant in this flat?")
    assert leaves_no_instruction("Find a chair.", "Find a chair.", "")


ANSWERS = {
    "words": "left " * 160_000,
    "no Latin letters": "é" * 800_000,
    "points": ". " * 400_000,
    "quotes": "'" * 800_000,
    "one word": "x" * 800_000,
}


@pytest.mark.parametrize("answer", ANSWERS.values(), ids=ANSWERS)
def test_gate_rejects_a_huge_answer_in_little_time(answer):
    """Issue T2, item 9."""
    began = time.process_time()
    assert rewrite_refused("Kindly hang a left.", answer) == "longer than what it replaces"
    assert time.process_time() - began < 0.5
