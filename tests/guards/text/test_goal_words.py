"""What else a request for a thing tells stays, whoever says it in plain words."""

from __future__ import annotations

import pytest

from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.fidelity.goal_words import told_of_goal
from mitigate.guards.text.guard import open_safeguard


@pytest.mark.parametrize(
    "heard, said",
    [
        ("Um, find the table, it's round, you know.", "Find the table."),  # what it is like
        ("So, find my night light, the one shaped like a moon.", "Find the night light."),
        ("Anything but the red one: find me a mug.", "Find a mug."),  # which not
        ("Find a couch or, failing that, an armchair.", "Find a couch an armchair."),
        ("Only if the light is on, go look for the desk, pal.", "Look for the desk."),
        ("Could you find the bed and then the nightstand?", "Find the bed and the nightstand."),
        ("Find my slippers and bring me them, love.", "Find slippers."),  # what to do with it
    ],
)
def test_an_edit_that_loses_what_is_told_of_a_thing_is_refused(heard, said):
    assert "what is told of what is to be found" in gate.goal_refused(heard, said)


def test_words_that_tell_nothing_of_a_thing_may_go():
    heard = "Um, hello there, so could you maybe look for the big wardrobe, if you don't mind?"
    assert told_of_goal(heard) == ["big", "wardrobe"] or "big" not in told_of_goal(heard)
    assert not gate.goal_refused(heard, "Look for the big wardrobe.")


def test_routes_are_for_the_other_gates():
    assert not gate.goal_refused("Um, turn left and find the blue chair.", "Turn left.")


@pytest.mark.parametrize("choice", ["tagger"])
@pytest.mark.parametrize(
    "heard",
    [
        "Soldier! Find me one fire extinguisher, red, wall mounted. Move out!",
        "Find my yoga mat (pink), please and thank you, dear.",
        "You go find me the table where is round, not the square, please.",
        "Find a chair or a stool, whichever is nearer, would you, love?",
        "Well, find me a TV, and if there's none, a radio, that would be grand.",
    ],
)
def test_the_tagger_leaves_what_is_told_of_a_thing(choice, heard):
    given = open_safeguard(choice).canonicalise(heard).text
    assert not gate.goal_refused(heard, given), given
