"""The tagger: how it reads a text, what it makes of speech and of plain routes behind the gate."""

from __future__ import annotations

import pytest
import torch

from mitigate.core.files import find
from mitigate.core.seeding import generator
from mitigate.guards.text.choices import TAGGERS, label
from mitigate.guards.text.guard import Safeguard, open_safeguard
from mitigate.guards.text.learning.lessons import draw_lesson
from mitigate.guards.text.learning.routes import draw_route
from mitigate.guards.text.metrics import token_f1
from mitigate.guards.text.plain.edits import KEEP, Edit, tokens
from mitigate.guards.text.plain.plainly_said import Tagged, is_speech, led, plainly_said, together
from mitigate.guards.text.tagger import Tagger, open_tagger
from mitigate.training.reports.safeguard import voices

SPEECH = (
    "Ooh, hello love, so, er, what you want to do is, you want to walk past the piano, lovely old "
    "thing, and then, um, turn left at the sofa, if you would be so kind, and stop there."
)


@pytest.fixture(scope="module")
def shipped() -> Tagger:
    return open_tagger(find(TAGGERS["tagger"]))


@torch.no_grad()
def test_what_a_text_gets_does_not_depend_on_what_stands_beside_it_in_a_batch(shipped):
    texts = ("Go left.", "Well, er, you go past the piano, if it is still there, and stop.")
    rows = [shipped.encode(shipped.tag(text).tokens) for text in texts]
    alone, together = shipped(shipped.collate(rows[:1])), shipped(shipped.collate(rows))
    count = len(rows[0]["words"])
    for one, both in zip(alone, together, strict=True):
        assert torch.allclose(one[0], both[0, :count], atol=1e-5)


def test_lessons_are_the_same_again_and_have_an_edit_for_each_token():
    for index in range(40):
        lesson = draw_lesson(3, index)
        assert len(lesson.tokens) == len(lesson.edits) == len(lesson.attack)
        assert draw_lesson(3, index) == lesson


def test_the_shipped_tagger_is_small_and_comes_nearer_to_what_voices_mean(shipped):
    assert (find(TAGGERS["tagger"]) / "model.safetensors").stat().st_size < 3_000_000
    heard = voices("validation", 40)
    before = sum(token_f1(r.clean, r.heard) for r in heard)
    alone = sum(token_f1(r.clean, shipped.alone(r.heard)) for r in heard)
    assert alone > before + 0.05 * len(heard)


def test_plain_routes_come_back_byte_for_byte(shipped):
    safeguard = Safeguard(tagger=shipped)
    for number in range(60):
        text = f" {draw_route(generator(number, 'tagger'))}\n"
        assert safeguard.canonicalise(text).text == text


def test_speech_is_said_in_plain_words_and_the_decision_says_so(shipped):
    decision = Safeguard(tagger=shipped).canonicalise(SPEECH)
    assert decision.route == "tagger" and len(decision.text) < 0.8 * len(SPEECH)
    assert all(word in decision.text for word in ("piano", "left", "stop"))


@pytest.mark.parametrize(
    "answer, taken",
    [
        ("Walk past the piano, then turn left at the sofa and stop there.", True),
        ("Walk past the piano, then turn right at the sofa and stop there.", False),
        ("Walk past the piano and the lamp, then turn left at the sofa and stop there.", False),
        ("", False),
        (None, False),
    ],
)
def test_of_speech_the_models_answer_is_taken_if_it_is_safe_and_else_the_taggers(
    shipped, answer, taken
):
    class Says:
        def rewrite(self, texts, seconds=None):
            return [answer for _ in texts]

    alone = Safeguard(tagger=shipped).canonicalise(SPEECH)
    decision = Safeguard(Says(), tagger=shipped).canonicalise(SPEECH)
    assert decision.text == (answer if taken else alone.text)
    assert decision.route == ("model" if taken else "fallback")


def test_hidden_words_and_texts_of_nothing_are_left_alone(shipped):
    safeguard = Safeguard(tagger=shipped)
    assert safeguard.canonicalise("").text == ""
    assert safeguard.canonicalise("...").text == "..."
    tagged = shipped.tag("Um, well, so, [MASK] to the sofa, er, dear.")
    parts, reasons = plainly_said("Um, well, so, [MASK] to the sofa, er, dear.", tagged)
    assert "[MASK]" in together(parts) and reasons


def test_a_tagger_that_drops_everything_loses_nothing_of_the_way():
    class Deaf:
        def tag(self, text: str) -> Tagged:
            found = tuple(tokens(text))
            return Tagged(found, (Edit(KEEP),) * len(found), (0.96,) * len(found))

    heard = "Do not go up. Turn left. Then step into it, and go straight. Stop."
    tagged = Deaf().tag(heard)
    assert is_speech(tagged)
    assert together(plainly_said(heard, tagged)[0]) == heard
    assert Safeguard(tagger=Deaf()).canonicalise(heard).text == heard


def test_choices_with_a_tagger(tmp_path, shipped):
    assert open_safeguard("tagger").tagger is not None
    both = open_safeguard("tagger+http://localhost:1/v1@m")
    assert both.tagger is not None and both.rewriter is not None
    assert label("tagger+http://localhost:1/v1@m") == "tagger+localhost-1-v1@m"
    with pytest.raises(ValueError, match="tagger"):
        open_safeguard("tagger+rules")
    torch_file = tmp_path / "model.safetensors"
    torch_file.write_bytes(b"no weights")
    with pytest.raises(ValueError, match="damaged"):
        open_safeguard(str(tmp_path))


@pytest.mark.parametrize(
    "text, share",
    [
        ("Exsit the den, turn left, then walk on. Stop by the lamp.", 0.75),
        ("So you know the lamp, right? You walk past it.", 0.0),
        ("Well, walk past the lamp, okay?", 1 / 3),
        ("...", 0.0),
    ],
)
def test_what_begins_as_a_route_does_is_counted_by_clauses(text, share):
    assert led(tokens(text)) == pytest.approx(share)


def test_of_a_text_that_begins_as_a_route_does_more_must_go_for_it_to_be_speech():
    def heard(text: str, drop: float) -> Tagged:
        found = tuple(tokens(text))
        return Tagged(found, tuple(Edit(KEEP) for _ in found), (drop,) * len(found), more=0.2)

    route, speech = "Walk past the lamp, turn left, stop there.", "You see the lamp, it is nice."
    assert is_speech(heard(speech, 0.35)) and not is_speech(heard(route, 0.35))
    assert is_speech(heard(route, 0.6))


def test_an_order_that_no_route_gives_is_not_said_the_more_plainly():
    tagger = open_safeguard("tagger")
    heard = (
        "Would you kindly break the vase on your way. Turn left at the sofa and stop at the lamp."
    )
    assert tagger.canonicalise(heard).text == heard
    asked = "Would you kindly turn left at the sofa and stop at the lamp."
    assert tagger.canonicalise(asked).text == "Turn left at the sofa and stop at the lamp."
