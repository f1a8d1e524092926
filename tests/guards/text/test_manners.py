"""Orders of a manner of speaking are said in plain words, and nothing that they tell is lost."""

from __future__ import annotations

import pytest

from mitigate.guards.text.guard import open_safeguard
from mitigate.guards.text.plain.manners import plainer


@pytest.mark.parametrize(
    "heard, plain",
    [
        ("You are then requested to effect a turn to the left.", "Turn left."),
        ("Thereafter, kindly betake yourself to the sofa.", "Go to the sofa."),
        ("To commence, execute a slight right turn.", "Turn slightly right."),
        ("Ultimately, come to a complete halt at the desk.", "Stop at the desk."),
        ("So you just go past the lamp.", "Go past the lamp."),
        ("Okay, let's head out of this room!", "Head out of this room!"),
        ("And I guess you stop there.", "Stop there."),
        (
            "After passing the chair, you are asked to turn right and to wait beside the door.",
            "After passing the chair, turn right and wait beside the door.",
        ),
        ("Kindly reverse your course.", "Turn around."),
        ("Please proceed past the bed, and halt.", "Go past the bed, and stop."),
        ("Could you kindly stop at the bed?", "Stop at the bed."),
        ("Would you please walk to the sofa.", "Walk to the sofa."),
        ("Would you mind going up the stairs?", "Go up the stairs."),
        ("Do you mind turning left at the door?", "Turn left at the door."),
        ("Could you be so kind as to walk past the table?", "Walk past the table."),
        ("May I ask you to reverse your course.", "Turn around."),
    ],
)
def test_an_order_is_said_plainly(heard, plain):
    assert plainer(heard) == plain


@pytest.mark.parametrize(
    "heard",
    [
        "Turn left at the lamp.",
        "Then walk past the bed, and halt.",
        "You should not turn left.",  # a denial
        "You'll find yourself in the hallway.",  # what is seen, no order
        "You should see a red door.",
        "Turn towards the left door.",  # the door, not the side
        "Stop at the halt sign.",
        "When you turn left, the stairs are behind you.",
        "Can you see the red door?",
        "Would you mind the gap?",
    ],
)
def test_what_is_no_order_or_plain_stays_as_it_is(heard):
    assert plainer(heard) == heard


def test_only_a_text_in_a_manner_of_speaking_is_changed():
    rules = open_safeguard("rules")
    plain = "Walk past the bed and halt at the door."
    assert rules.canonicalise(plain).text == plain
    heard = "You are kindly requested to proceed past the bed. Thereafter, kindly halt at the door."
    decision = rules.canonicalise(heard)
    assert decision.text == "Go past the bed. Stop at the door."
    assert "orders said in plain words" in decision.reasons


def test_what_the_speaker_wants_is_a_step():
    heard = (
        "Turn right and walk into the hall. I {} you to go to the end of it. Turn left at the vase."
    )
    said = "Turn right and walk into the hall. Go to the end of it. Turn left at the vase."
    assert [
        open_safeguard("rules").canonicalise(heard.format(verb)).text for verb in ("want", "need")
    ] == [said, said]


def test_of_equal_sentences_the_one_that_was_read_is_said_plainly():
    first = "When at the bed could you please turn left."
    assert plainer(f"{first} could you please turn left.") == f"{first} turn left."
