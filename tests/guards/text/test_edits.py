"""Edits bring speech near plain words and cannot tell of what was not heard."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitigate.core.seeding import generator
from mitigate.corruptions.language.fidelity import COLOURS, facts
from mitigate.corruptions.language.landmarks import normal
from mitigate.guards.text.learning.routes import draw_route
from mitigate.guards.text.learning.spoken import spoken
from mitigate.guards.text.plain.edits import DROP, KEEP, PLAIN, Edit, edited, taught, tokens
from mitigate.guards.text.texts.plain_words import PHRASES, plain_form

ROUTES = st.integers(0, 10_000).map(lambda n: draw_route(generator(n, "edits")))
SAID = st.sampled_from([text.said for text in spoken("validation")])
WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")


def drawn(data: st.DataObject, text: str) -> list[Edit]:
    edits = st.builds(Edit, st.sampled_from((KEEP, DROP, PLAIN)), st.integers(0, len(PHRASES)))
    count = len(tokens(text))
    return data.draw(st.lists(edits, min_size=count, max_size=count))


@settings(deadline=None, max_examples=60)
@given(st.data(), st.one_of(ROUTES, SAID))
def test_no_edits_say_a_word_that_was_not_heard_nor_is_in_a_phrase(data, text):
    heard = {word.lower() for word in WORD.findall(text)}
    allowed = heard | {plain_form(w) for w in heard} | set(" ".join(PHRASES).split())
    said = {word.lower() for word in WORD.findall(edited(text, drawn(data, text)))}
    assert said <= allowed


def test_the_phrases_name_no_thing_side_number_or_colour():
    for phrase in PHRASES:
        told = facts(phrase)
        assert not {"left", "right"} & set(told.directions), phrase
        assert not told.landmarks and not told.numbers and not told.compass, phrase
        assert not COLOURS & set(phrase.split()), phrase


def test_a_plain_form_is_the_same_thing_by_another_name():
    for heard, said in (("settee", "couch"), ("corridor", "hallway"), ("lift", "elevator")):
        assert plain_form(heard) == said and normal(heard) == normal(said)


@settings(deadline=None, max_examples=40)
@given(st.one_of(ROUTES, SAID), st.sampled_from(("", " ", "\n")))
def test_a_text_that_keeps_all_comes_back_byte_for_byte(text, space):
    text = space + text + space
    assert edited(text, [Edit(KEEP)] * len(tokens(text))) == text


def test_what_is_plain_is_taught_to_stay():
    text = "Walk past the couch. Turn left and stop at the door."
    assert taught(text, text) == [Edit(KEEP)] * len(tokens(text))


def test_taught_edits_take_speech_to_the_plain_text():
    heard = "So, er, if you'd just wander past the settee, lovely, and then it's left you go."
    given_on = edited(heard, taught(heard, "Walk past the couch and go left."))
    assert given_on == "Walk past the couch and go left."


def test_a_dropped_word_is_gone_wherever_it_stands():
    heard = "Go past the nice old sofa, dear, and stop."
    gone = ("nice", "old", "dear")
    edits = [Edit(DROP if t.lower in gone else KEEP) for t in tokens(heard)]
    assert edited(heard, edits) == "Go past the sofa, and stop."


def test_edits_come_nearer_to_what_is_meant_on_every_voice():
    from mitigate.guards.text.metrics import token_f1

    texts = spoken("train")[::40]
    before = [token_f1(t.plain, t.said) for t in texts]
    after = [token_f1(t.plain, edited(t.said, taught(t.said, t.plain))) for t in texts]
    assert sum(after) > sum(before) + 0.25 * len(texts)


@pytest.mark.parametrize(
    "heard, said",
    [
        ('Go by a "fire" box here.', 'Go by a "fire" box.'),
        ("Go by the “Sun room.” Now.", "Go by the “Sun room.”"),
        ("Go into the den/living room here.", "Go into the den/living room."),
        ("Go (to the left) here.", "Go (to the left)."),
    ],
)
def test_quotes_brackets_and_slashes_stand_as_close_as_they_were_heard(heard, said):
    found = tokens(heard)
    last = max(p for p, token in enumerate(found) if token.is_word)
    made = [Edit(DROP if p >= last and t.is_word else KEEP) for p, t in enumerate(found)]
    assert edited(heard, made, found).replace("”.", "”") == said
