"""Chatty orders are said in plain words, where a text has more than one of them."""

from __future__ import annotations

import pytest

from mitigate.guards.text.guard import open_safeguard
from mitigate.guards.text.plain.chatty_words import chatty, in_plain_words
from mitigate.guards.text.plain.manners import plainer, restyled


@pytest.mark.parametrize(
    "heard, plain",
    [
        ("hang a right at the bed.", "turn right at the bed."),
        ("take a nice left.", "turn left."),
        ("pop on down the stairs.", "go down the stairs."),
        ("stroll straight past the sofa.", "walk straight past the sofa."),
        ("wander back to the bed.", "wander back to the bed."),
        ("stop for a breather just inside.", "stop just inside."),
        ("stop right there by the crib, and that's it!", "stop by the crib."),
        ("wait for me by the pool, if you would.", "wait by the pool."),
        ("walk to the lamp, okay?", "walk to the lamp."),
        ("swing all the way around.", "turn around."),
        ("swing around the pool table.", "go around the pool table."),
        ("park yourself next to the desk.", "stop next to the desk."),
    ],
)
def test_a_saying_is_said_plainly(heard, plain):
    assert in_plain_words(heard) == plain


@pytest.mark.parametrize(
    "heard",
    [
        "Take the left door.",
        "Stop at the pop machine.",
        "Hang the coat on the left hook.",
        "Walk around the swing.",
        "Take a left turn.",
        "Wait for the lift.",
        "The path wanders off to the left.",
    ],
)
def test_what_only_sounds_like_one_stays(heard):
    assert in_plain_words(heard) == heard and chatty(heard) == 0


def test_one_saying_alone_makes_no_manner_of_speaking():
    heard = "Walk past the bed, hang a left and stop at the door."
    assert not restyled(heard) and plainer(heard) == heard
    assert open_safeguard("rules").canonicalise(heard).text == heard


def test_cheers_go_and_what_tells_the_way_stays():
    heard = "Pop into the kitchen. You can do it! Hang a left. There's a fridge on the left!"
    assert plainer(heard) == "Go into the kitchen. Turn left. There's a fridge on the left!"


def test_a_sentence_that_lost_its_beginning_has_a_capital():
    heard = (
        "Route guidance as follows. With the couch on your left, advance ahead through the sliding "
        "door. To complete the task, halt at the edge of the pool."
    )
    assert (
        open_safeguard("rules")
        .canonicalise(heard)
        .text.endswith("door. Stop at the edge of the pool.")
    )


@pytest.mark.parametrize(
    "said", ["Not the red one!", "The other way!", "All the way!", "Only if it is open!"]
)
def test_what_says_more_of_a_step_is_no_cheer(said):
    assert said in plainer(f"Pop into the hall, then hang a left. {said} Stop by the lamp.")
