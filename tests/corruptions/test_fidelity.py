"""Tests of the fidelity check: the facts it extracts, and the rewrites it accepts and rejects."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path

import pytest

from mitigate.corruptions import Key
from mitigate.corruptions.instruction import SPLITS, prefixes
from mitigate.corruptions.language import phrases
from mitigate.corruptions.language.fidelity import check, facts
from mitigate.corruptions.language.style import MANNERS, restyle
from mitigate.worlds.episodes import read_episodes
from tests.r2r_ce import FOLDER, needs_r2r_ce

HANDWRITTEN = [
    line
    for line in (Path(__file__).parents[1] / "guards/text/handwritten.txt").read_text().splitlines()
    if line and not line.startswith("#")
]
OURS = "mitigate/worlds/apartments/episodes/val_unseen_vln.json.gz"
FLIPS = {"left": "right", "right": "left", "up": "down", "down": "up"}


@pytest.mark.parametrize(
    ("text", "directions"),
    [
        ("Turn left and walk down the stairs, then wait.", "left down stop"),
        ("Go down the hall and take the second right.", "right"),
        ("Stop right before the door, next to the left wall.", "stop left"),
        ("Once you have left the kitchen, bear right.", "right"),
        ("Turn all the way around and go back.", "around"),
        ("Make a full turn and go back, then head up.", "around up"),
        ("Turn 180 degrees. Walk around the table.", "around"),
        ("Turn around the corner to your right.", "right"),
        ("Stop by the sofa. Wait there.", "stop"),
        ("Stop by the sofa, go on to the bed and stop.", "stop stop"),
        ("Climb up the steps and ascend the ramp.", "up up"),
        ("Climb down the ladder; halt.", "down stop"),
        ("Walk up to the bed and pause.", "stop"),
        ("Go straight ahead, then forward through the arch.", "straight"),
        ("You will end up by the sofa and you are done.", "stop"),
        ("Go ahead and take the door on the left-hand side.", "left"),
    ],
)
def test_directions_are_read_in_order(text, directions):
    assert facts(text).directions == tuple(directions.split())


def test_landmarks_numbers_and_the_rest_are_read():
    message = facts("Don't enter the first room; take two steps past the grey couches, 3 m north.")
    assert message.landmarks == ("room", "sofa")
    assert message.numbers == ("first", "two step", "three meter")
    assert (message.compass, message.attributes, message.denials) == (("north",), ("grey",), 1)
    assert facts("First, turn left. Then take a right.").numbers == ()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Walk past the couch and enter the hallway.", "Go past the sofa into the corridor."),
        ("Take a left at the fridge.", "Hang a left by the refrigerator!"),
        ("Go up the stairs, stop by the TV.", "Ascend the staircase and halt at the television."),
        ("In the kitchen stop at the table.", "Stop at the table in the kitchen."),
        ("Exit the room.", "Kindly leave the room."),
    ],
)
def test_faithful_text_passes(old, new):
    assert check(old, new) == []


@pytest.mark.parametrize(
    ("new", "kind"),
    [
        ("Turn right at the sofa, go past the red lamp and stop.", "directions"),
        ("Turn left at the sofa, go past the red lamp.", "directions"),
        ("Turn left, go past the red lamp and stop.", "landmark lost: sofa"),
        ("Turn left at the sofa, go past the red lamp and the bed and stop.", "landmark invented"),
        ("Turn left at the lamp, go past the red sofa and stop.", "landmark order"),
        ("Turn left at the sofa, go past the blue lamp and stop.", "attribute invented: blue"),
        ("Turn left at the sofa, go past the lamp and stop.", "attribute lost: red"),
        ("Turn left at the sofa, go two metres past the red lamp and stop.", "number invented"),
        ("Turn left at the sofa, go 5 m past the red lamp and stop.", "number invented"),
        ("Turn left at the sofa, go north past the red lamp and stop.", "compass invented"),
        ("Turn left at the sofa, do not go past the red lamp and stop.", "denial"),
        ("Turn left at the sofa, go behind the red lamp and stop.", "relation"),
        ("Turn left at the second sofa, go past the red lamp and stop.", "number invented"),
    ],
)
def test_changed_meaning_is_detected(new, kind):
    problems = check("Turn left at the sofa, go past the red lamp and stop.", new)
    assert any(problem.startswith(kind) for problem in problems)


def corpus(name: str) -> list[str]:
    if name == "handwritten":
        return HANDWRITTEN
    path = FOLDER / "val_seen.json.gz" if name == "r2r" else OURS
    return [e.instruction.text for e in islice(read_episodes(path), 500)]


CORPORA = ["handwritten", "ours", pytest.param("r2r", marks=[needs_r2r_ce, pytest.mark.slow])]


@pytest.mark.parametrize("name", CORPORA)
def test_identical_text_passes_and_single_changes_do_not(name):
    flips = missed = 0
    for text in corpus(name):
        assert check(text, text) == []
        assert check(text, text.upper()) == check(text, text.lower()) == []
        assert check(text, text + " Walk 3 metres north.")
        for match in re.finditer(r"\b(?:left|right)\b", text):
            flipped = text[: match.start()] + FLIPS[match.group()] + text[match.end() :]
            flips += 1
            missed += not check(text, flipped)
    assert flips > 50 and missed <= 0.01 * flips, (missed, flips)


@pytest.mark.slow
@pytest.mark.parametrize("manner", MANNERS)
@pytest.mark.parametrize("name", CORPORA)
def test_most_rewrites_pass_and_all_returned_ones_do(manner, name):
    matches = [(t, restyle(t, manner, Key(0, str(i)))) for i, t in enumerate(corpus(name))]
    assert all(check(text, r.text) == [] for text, r in matches)
    assert sum(r.passed for _, r in matches) >= 0.98 * len(matches)
    assert all(r.text != text for text, r in matches if r.passed)
    remaining, count = (sum(getattr(r, k) for _, r in matches) for k in ("plain", "clauses"))
    assert remaining <= 0.3 * count


@pytest.mark.parametrize("manner", MANNERS)
def test_style_frames_add_no_facts(manner):
    voice = phrases.VOICES[manner]
    frames = [frame for group in voice.frames.values() for frame in group]
    frames += [f"{opener} {{}}." for opener in voice.openers]
    frames += [f"{{}}. {closer}" for closer in voice.closers]
    for frame in frames:
        assert check("walk to the sofa", frame.format("walk to the sofa")) == []
    assert set(voice.commands) == set(phrases.PATTERNS)
    for noun, other in voice.nouns.items():
        assert check(f"go to the {noun}", f"go to the {other}") == []


def test_false_model_answer_is_replaced():
    text = "Turn left at the sofa and stop."
    liar = restyle(text, "formal", Key(0, "1"), lambda text, manner: text.replace("left", "right"))
    assert "left" in liar.text and liar.passed and liar.tries == 2
    honest = restyle(text, "formal", Key(0, "1"), lambda *_: "Kindly turn left at the couch, stop.")
    assert honest.text.startswith("Kindly turn left at the couch") and honest.tries == 1
    assert restyle(text, "formal", Key(0, "1"), lambda *_: " ").passed


def test_attacks_are_seen_as_changes():
    sentences = [s for split in SPLITS for group in prefixes(split).values() for s in group]
    seen = sum(
        bool(check("Turn left at the sofa.", f"{s} Turn left at the sofa.")) for s in sentences
    )
    assert seen >= 0.85 * len(sentences)
