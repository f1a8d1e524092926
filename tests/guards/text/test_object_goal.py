"""Requests for one thing are said in plain words, and nothing else is."""

from __future__ import annotations

import pytest

from mitigate.guards.text.guard import open_safeguard
from mitigate.guards.text.plain.object_goal import object_goal


@pytest.mark.parametrize(
    "heard, plain",
    [
        ("Hey buddy, could you find me a red backpack? Thanks!", "Look for a red backpack."),
        ("Please find the target chair and remain there.", "Look for the chair and stop."),
        ("Pretty please find the chaise longue.", "Look for the chaise longue."),
        ("So, a sofa. Go find one for us, pal!", "Look for a sofa."),
        ("Dear Sir or Madam, kindly proceed to the TV.", "Go to the TV."),
        ("Please find a TV, and come to a halt beside it.", "Look for a TV and stop beside it."),
        ("I'm not sure, but I think you look for the nearest sink.", "Look for the nearest sink."),
        ("Could you please look for a plant in the house?", "Look for a plant."),
        ("Um, you get to the side table. And then you stop.", "Go to the side table and stop."),
        ("Look [MASK] [MASK] painting.", "Look for a painting."),
        ("Look for [MASK] bed [MASK] wait next to it.", "Look for a bed and stop next to it."),
        ("Find [MASK] nearest bed and stop [MASK].", "Look for the nearest bed and stop."),
        ("So, you find a bed. And then you stop walking.", "Look for a bed and stop."),
        ("You need to go over to a bed and stop, please.", "Go to a bed and stop."),
        ("To get going, find a lamp. Now stop there, easy as that!", "Look for a lamp and stop."),
    ],
)  # fmt: skip
def test_a_request_for_one_thing_keeps_the_thing_and_what_it_is_like(heard, plain):
    assert object_goal(heard) == plain


@pytest.mark.parametrize(
    "heard",
    [
        "Please go around the table for me, thanks a lot.",  # how to go by it
        "Could you please get out of the bed? Thank you!",
        "So, um, walk past the chair please, my dear friend.",
        "Hi! Please find the chair behind the sofa, thank you.",  # where it stands
        "Hi! Please find the chair with red legs, thank you.",
        "Please find a chair or a bed, whichever, thank you so much.",  # two things
        "Hello! Please don't look for a chair, thank you so much.",  # denied
        "Please stop looking for the chair now, thanks so much.",
        "Hello! The chair has been located, thanks so much for that.",
        "Please start at the bed, thank you so much, my dear.",
        "Hello! Please turn left and then find a chair, thanks!",  # a turn
        "Hello! Please go up the stairs and find a chair, thanks!",
        "I need you to smash the lamp please, thank you.",  # something else to do
        "Hello! Could you find me two chairs please? Thanks!",  # a number
        "Hey, could you please find the stop sign? Thanks!",  # part of a name
        "Be a star, find the bedside table, and stay there till I come.",  # until when
        "Could you find the bed and wait by it until I arrive, please?",
        "Could you please find the lamp and get it to me?",  # what to do with it
        "Please find a chair, thank you, and take it away.",
        "Please find the chair, and then look around, thanks.",
        "Could you find a bed, please, and after that come back to me?",
        "Could you please find the clock that is ahead?",
        "Hi! Please go to the sofa and back.",
        "Please search the bedroom.",  # what is done to the thing, or in it
        "Please move the chair.",
        "Please take the chair.",
        "Could you walk the dog?",
        "Let me know when you see the piano. Then stop.",
        "Hey there! And then take the shorter one, if you would. See you soon!",
        "Look for a chair.",  # plain
        "Walk to the bed and wait.",
        "Look for the bed and wait next to it.",
        "Find a sofa, go to it and stop there.",
        "Hello there, and thank you very much!",  # no thing
        "Look for a [MASK], please.",
        "",
    ],
)
def test_whatever_else_is_told_leaves_the_text_as_it_is(heard):
    assert object_goal(heard) is None


def test_the_rules_alone_say_it_plainly_and_why():
    heard = "Good day. You are kindly requested to proceed to the sofa. In closing, you may stop."
    decision = open_safeguard("rules").canonicalise(heard)
    assert decision.text == "Go to the sofa and stop."
    assert decision.route == "rules"
    assert "a request for one thing, said in plain words" in decision.reasons


def test_where_to_wait_is_no_attack_and_is_said_plainly():
    heard = "Hi friend! So, find the nearest bed. To finish off, wait for me. Thanks a bunch!"
    given = open_safeguard("rules").canonicalise(heard).text
    assert given == "Look for the nearest bed and stop."


def test_what_is_asked_for_is_not_lost_with_what_stands_beside_it():
    heard = (
        "I want to know what time it is so I think you need to find a clock. They're round a lot "
        "of the time and sometimes they hang on a wall."
    )
    assert "clock" in open_safeguard("rules").canonicalise(heard).text
    heard = "Uh oh, I've lost my backpack again! Be a sweetheart and track it down for me?"
    assert "track it down" in open_safeguard("rules").canonicalise(heard).text
