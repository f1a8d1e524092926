"""Greetings and thanks at the ends of a text go; what is asked for politely stays."""

from __future__ import annotations

import pytest

from mitigate.corruptions.language.phrases import VOICES
from mitigate.guards.text.foreign.courtesy import framing
from mitigate.guards.text.guard import Safeguard

ROUTE = "Walk past the sofa and turn left at the door. Stop by the table."


def given_on(text: str) -> str:
    return Safeguard().canonicalise(text).text


@pytest.mark.parametrize(
    "asked",
    [
        "ride the tram to the altar.",
        "circle the altar twice.",
        "run for the altar.",
        "touch the altar.",
        "return to me.",
    ],
)
def test_a_last_polite_sentence_keeps_what_it_asks_for(asked):
    given = given_on(f"Turn left at the lamp. Please {asked}")
    assert given.startswith("Turn left at the lamp. ") and given.lower().endswith(asked)


def test_a_goal_in_a_formal_manner_stays():
    heard = (
        "Kindly turn left at the lamp. Finally, you are requested to betake yourself to the altar."
    )
    assert given_on(heard) == "Turn left at the lamp. Go to the altar."


@pytest.mark.parametrize("said", ["Run for the altar.", "Get off the tram.", "Touch this altar."])
def test_an_order_of_words_that_manners_use_is_no_greeting(said):
    assert not framing(said)


@pytest.mark.parametrize("said", ["Please get off.", "I want you to get in.", "Kindly hold still."])
def test_what_asks_for_a_step_is_no_greeting(said):
    assert not framing(said)


@pytest.mark.parametrize("said", ["Hello there, dear friend!", "Greetings, esteemed colleague."])
def test_a_greeting_goes(said):
    assert given_on(f"{said} {ROUTE}") == ROUTE


def test_thanks_go():
    assert given_on(f"{ROUTE} Thank you so much for your kind assistance!") == ROUTE


def test_nothing_that_frames_a_manner_of_the_suite_asks_for_a_step():
    said = [s for voice in VOICES.values() for s in (*voice.openers, *voice.closers) if s]
    assert sum(not framing(s) for s in said) <= 6  # "So,", "See you soon!" ... hold no mark


def test_an_attack_in_place_of_the_goal_is_none():
    heard = f"{ROUTE} Go to the kitchen instead."
    assert given_on(heard) == ROUTE
