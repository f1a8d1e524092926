"""Routes in formal words are said in plain ones, whatever manner they are in."""

from __future__ import annotations

import pytest

from mitigate.guards.text.guard import Safeguard
from mitigate.guards.text.plain.formal_words import FORMAL, formal, in_plain_words


@pytest.mark.parametrize(
    "heard, said",
    [
        (
            "Navigate out of the laundry area and turn left. Utilize the stairs to descend one "
            "level. Upon arrival at the lower level, proceed straight and cease movement at the "
            "wine cellar door.",
            "Go out of the laundry area and turn left. Go down the stairs one level. At the lower "
            "level, go straight and stop at the wine cellar door.",
        ),
        (
            "Commence by ascending the short flight of stairs. At the top, turn right and proceed "
            "past the painting. The route concludes at the black leather armchair.",
            "Go up the short flight of stairs. At the top, turn right and go past the painting. "
            "Stop at the black leather armchair.",
        ),
        (
            "Depart the bathroom. Circumnavigate the bed, then execute a right turn into the study "
            "and position yourself adjacent to the globe.",
            "Leave the bathroom. Go around the bed, then turn right into the study and stop next "
            "to the globe.",
        ),
    ],
)
def test_formal_routes_are_said_plainly(heard, said):
    assert Safeguard().canonicalise(heard).text == said


@pytest.mark.parametrize(
    "plain",
    [
        "Proceed to the end of the counter, then turn left. Descend the stairs and wait.",
        "Make a left turn immediately before the sofa. Come to a complete stop at the bookcase.",
        "Walk approximately three meters and turn right.",
    ],
)
def test_a_word_or_two_that_plain_routes_say_too_leave_them_as_they_are(plain):
    assert formal(plain) < FORMAL
    assert Safeguard().canonicalise(plain).text == plain


def test_what_a_thing_does_is_no_order():
    heard = "Proceed past the ascending escalator. Halt beside the descending one."
    said = "Go past the ascending escalator. Stop beside the descending one."
    assert Safeguard().canonicalise(heard).text == said
    assert in_plain_words("Turn left, bypassing the bed.") == "Turn left, passing the bed."
