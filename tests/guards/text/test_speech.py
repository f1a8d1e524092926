"""The gate reads speech: what is taken back, counted out or said of others tells nothing."""

from __future__ import annotations

import pytest

from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.texts.speech import meant


@pytest.mark.parametrize(
    "heard, said",
    [
        ("Turn left, no, sorry, right at the sofa.", "Turn right at the couch."),
        ("At the stove you go right, not left.", "Turn right at the stove."),
        ("Step 2: turn left at the desk.", "Turn left at the desk."),
        ("Right, so, turn left at the desk.", "Turn left at the desk."),
        ("Walk right up to the piano and stop.", "Walk up to the piano and stop."),
        ("My uncle has left his hat there. Turn right.", "Turn right."),
        ("Don't worry, just go past the sink.", "Go past the sink."),
        ("Turn right and come to a full stop at the sink.", "Turn right and stop at the sink."),
        ("Conclude your journey at the piano.", "Stop at the piano."),
        ("It's superb. Walk past the two beds, three, no, two.", "Walk past the two beds."),
    ],
)
def test_what_is_said_and_not_meant_is_no_fact(heard, said):
    assert gate.rewrite_refused(heard, said) == ""


@pytest.mark.parametrize(
    "heard, said",
    [
        ("Turn left, no, sorry, right at the sofa.", "Turn left at the couch."),
        ("At the stove you go right, not left.", "Turn left at the stove."),
        ("Do not turn left at the stove.", "Turn left at the stove."),
        ("Don't go past the second sink.", "Go past the second sink."),
        ("You turn right at the door, then left.", "Turn left."),
        ("Go past the second sink.", "Go past the sink."),
        ("Follow the banister.", "Go on."),
        ("Come to rest at the sink.", "Go past the sink."),
    ],
)
def test_what_is_meant_may_not_change(heard, said):
    assert gate.rewrite_refused(heard, said)


def test_a_plain_route_means_all_that_it_says():
    text = "turn right before the second door and do not go left of the table. stop there."
    assert meant(text) == text


def test_an_edit_may_take_a_fact_with_words_that_are_surely_aside_and_no_other():
    heard = "Walk past the sofa; my aunt had a piano by the door. Turn left."
    said = "Walk past the couch. Turn left."
    assert "landmark lost: piano" in gate.edit_refused(heard, said, ["my", "aunt", "had"])
    assert gate.edit_refused(heard, said, ["my", "aunt", "had", "piano", "by", "the", "door"]) == ""
    assert "left" in gate.edit_refused("Turn left. Stop.", "Stop.", ["turn"])
    assert gate.edit_refused("Stop.", "Stop and go past.", [])  # longer than what was heard
