"""Edits of speech that would lose or change what is said are taken back.

In the sentences below, words in braces are those that a tagger would take out, and a phrase that it
would put stands in angle brackets before its word.
"""

from __future__ import annotations

import re

import pytest

from mitigate.guards.text.learning.speech_words import counted
from mitigate.guards.text.plain.edits import DROP, KEEP, NUMBER, Edit, edited, tokens
from mitigate.guards.text.plain.speech_words import speech_words
from mitigate.guards.text.plain.taken_back import taken_back


def given(marked: str, drop: float = 0.99) -> str:
    """Return what is given on of a marked sentence; ``drop``: how sure the tagger is."""
    heard, out, before = "", set(), {}
    inside = False
    for part in re.split(r"([{}]|<[^>]+>)", marked):
        if part in ("{", "}"):
            inside = part == "{"
        elif part.startswith("<"):
            before[len(heard)] = NUMBER[part[1:-1]]
        else:
            if inside:
                out |= set(range(len(heard), len(heard) + len(part)))
            heard += part
    found = tokens(heard)
    starts = sorted(before)
    phrases = {min(t.start for t in found if t.start >= at): before[at] for at in starts}
    edits = [Edit(DROP if t.start in out else KEEP, phrases.get(t.start, 0)) for t in found]
    chances = [drop if edit.act == DROP else 0.0 for edit in edits]
    return edited(heard, taken_back(found, edits, chances), found)


@pytest.mark.parametrize(
    "marked, said",
    [
        ("{There's a} piano, {so you go past it}, and turn left.", "go past it"),
        ("{You will need to get up those} and stop at the lamp.", "get up those"),
        ("{Just} hop {up} the steps and turn left.", "hop up the steps"),
        ("{I'd like you to quit} the cabin and turn left.", "quit the cabin"),
        ("Turn {about} and go left.", "turn about"),
        ("{Then it's} the {next} room {you want}, stop there.", "room"),
        ("When the counter {ends}, turn right.", "counter ends"),
        ("Walk to the bathroom and stop {inside}.", "stop inside"),
        ("Walk {parallel} to the steps.", "parallel to"),
        ("Go down the hallway {in the opposite direction}.", "in the opposite direction"),
    ],
)
def test_a_step_in_whatever_words_comes_back(marked, said):
    assert said in given(marked).lower()


def test_a_step_that_another_way_of_saying_tells_may_go():
    assert given("<go past the>{There's a} piano{, so you go past it}.") == ("Go past the piano.")


def test_what_others_do_is_no_step():
    marked = "Stop at the door{, which people use to go through}."
    assert given(marked) == "Stop at the door."


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Turn left, not {a lot}, {just} slightly.", "not a lot"),
        ("{Forget about the} cellar, go straight.", "Forget about the cellar"),
        ("{No need to} go all the way in, stop at the door.", "No need to go all the way in"),
        ("Start over {if you lose the trail}.", "Start over if you lose the trail"),
        ("{Pay no attention to the} noise, go straight.", "Pay no attention to the noise"),
    ],
)
def test_a_denial_and_a_condition_are_kept_or_dropped_whole(marked, said):
    assert said in given(marked)


def test_what_denies_nothing_of_the_way_may_go():
    assert given("{Don't worry, just} walk past the lamp.") == "Walk past the lamp."
    assert given("{If you would, kindly} walk past the lamp.") == "Walk past the lamp."


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Pass the bench with <turn>a red heart and go straight.", "turn a red"),
        ("<go through the>{There's a} mirror and you walk by it.", "through"),
        ("See <up>the couch and go straight.", "up"),
        ("<go through the>{You'll see} doors on your left, and take the third.", "through"),
        ("Walk past the bed and <turn>right out onto the porch.", "turn"),
    ],
)
def test_a_phrase_that_nothing_heard_backs_is_taken_back(marked, said):
    assert said not in given(marked)


@pytest.mark.parametrize(
    "marked",
    [
        "{At the bench make a} <turn>left.",
        "<go through the>{You will find a} door.",
        "<go past the>{There is a} lamp, {and you walk by it}.",
    ],
)
def test_a_phrase_that_is_backed_stays(marked):
    phrase = re.findall(r"<([^>]+)>", marked)[0]
    assert phrase in given(marked).lower()


@pytest.mark.parametrize(
    "marked",
    [
        "Walk to the bench and {hang tight there}.",
        "{Assume a holding position} next to the bench.",
        "Go past the lamp and {call it a day} by the bench.",
        "{All movement is to be discontinued} beside the bench.",
    ],
)
def test_a_stop_in_other_words_is_said(marked):
    assert "stop" in given(marked).lower()


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Go {beyond} the bed.", "Go beyond the bed."),
        ("Stop {and enjoy the} air.", "Stop and enjoy the air."),
        ("Enter the living {area} and stop.", "Enter the living area and stop."),
        ("Turn {180-}degree.", "Turn 180-degree."),
        ("Make a 180-degree turn {if you would}.", "Make a 180-degree turn."),
        ("{Would you mind tracking down} a bed?", "Find a bed?"),
        ("Walk {in the direction of} the bed.", "Walk towards the bed."),
        ("Turn left {when you get to} the bed.", "Turn left at the bed."),
        ("Stop {prior to} reaching the rug.", "Stop prior to reaching the rug."),
    ],
)
def test_words_that_do_not_go_together_get_back_what_stood_between(marked, said):
    assert given(marked) == said


def test_a_word_that_may_tell_of_the_way_stays_in_a_clause_that_stays():
    assert given("Penetrate the large {banquet} hall.") == "Penetrate the large banquet hall."
    assert given("{Kindly} walk into the hall.") == "Walk into the hall."


def test_a_clause_of_unknown_words_goes_only_if_each_surely_goes():
    marked = "{Orthogonal reversal,} then go straight."
    assert given(marked, drop=0.8).startswith("Orthogonal reversal")
    assert given(marked, drop=0.95) == "Then go straight."


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Turn left{, turn} right, stop at the lamp.", "Turn left, turn right, stop at the lamp."),
        ("Turn left{, then} turn right.", "Turn left, turn right."),
        ("Walk past the lamp {and} turn {a bit} left.", "Walk past the lamp and turn left."),
        ("Step into {your place} until you see the lamp.",
         "Step into your place until you see the lamp."),
        ("{Alter your course, and} head left.", "Head left."),
        ("{Alter your course,} and head left.", "Head left."),
        ("Pass the door with the lamp {above} it.", "Pass the door with the lamp above it."),
    ],
)  # fmt: skip
def test_turns_one_behind_the_other_keep_their_verbs_and_no_word_is_left_without_its_thing(
    marked, said
):
    assert given(marked) == said


def test_a_place_at_the_beginning_with_an_unknown_verb_stays_and_an_aside_without_one_goes():
    assert given("{Levae the bedroom,} turn left.") == "Levae the bedroom, turn left."
    assert given("{Happily ever after,} turn left.") == "Turn left."


def test_edits_that_harm_nothing_stay_as_they_are():
    assert (
        given("{So, um,} walk past the sofa {for me} and stop.") == "Walk past the sofa and stop."
    )


def test_the_words_of_speech_are_those_of_the_train_voices():
    assert speech_words() == counted()


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Pass the stove{, and then it's a} right.", "Pass the stove, take a right."),
        ("Go past {the} vases{, and then I think it's} the second right.",
         "Go past vases, take the second right."),
        ("Walk past the lamp{, and take} the first left.",
         "Walk past the lamp, take the first left."),
        ("Exit the office and {take} a right at the desk.",
         "Exit the office and take a right at the desk."),
        ("Go past the bench{, veering} to {the} right.",
         "Go past the bench, veering to the right."),
        ("{Then it's} left, {no} wait, {sorry,} right, {and you} go on.", "Turn right, go on."),
        ("Take a right, {sorry, I meant a} left at the bed.", "Take a left at the bed."),
        ("Take a, {hmm,} a left at the bed.", "Take a left at the bed."),
    ],
)  # fmt: skip
def test_a_turn_that_stays_keeps_its_verb_and_what_joined_it(marked, said):
    assert given(marked) == said


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Stop when the {blue} carpet {turns} left.", "Stop when the blue carpet turns left."),
        ("Stop {when} <at>the gray tile turns right.", "Stop when the gray tile turns right."),
        ("Go on{, it} turns into {this narrow} corridor.",
         "Go on, it turns into this narrow corridor."),
        ("Enter the hall{, there's a} lamp on the wall {so you know it's the} right {one}.",
         "Enter the hall, there's a lamp on the wall so you know it's the right one."),
        ("{So} the piano {is behind} you.", "The piano is behind you."),
        ("Stop at the door {straight} ahead.", "Stop at the door straight ahead."),
        ("Go straight {all the way} to the bench.", "Go straight all the way to the bench."),
        ("Go to the gate, through which trees {may be seen}.",
         "Go to the gate, through which trees may be seen."),
        ("Stop by the stairs {which lead up}.", "Stop by the stairs which lead up."),
        ("Stop in the doorway, the {one} to the porch.",
         "Stop in the doorway, the one to the porch."),
        ("Go to the left of {them} and into the hall.",
         "Go to the left of them and into the hall."),
        ("Climb the steps {that} are on the left.", "Climb the steps that are on the left."),
        ("Wait there until you {are fetched}.", "Wait there until you are fetched."),
        ("The bed {is behind} you{, so} walk on.", "The bed is behind you, walk on."),
        ("Leave the hall and {it's} the third door.", "Leave the hall and it's the third door."),
        ("Turn left{, keep going} till the wall.", "Turn left, keep going till the wall."),
        ("Pass the bed and come to <stop>{rest} by the door.",
         "Pass the bed and come to rest by the door."),
    ],
)  # fmt: skip
def test_what_is_told_of_things_stays_whole(marked, said):
    assert given(marked) == said


def test_the_robot_that_turns_is_told_to_turn():
    assert "the robot" not in given("{The robot} turns left at the bed.").lower()


def test_a_stop_in_two_words_with_a_place_is_said():
    assert given("{Hang on} near the shelf.") == "Stop near the shelf."
    assert given("{Hold on} by the shelf and {don't fret}.").startswith("Stop by the shelf")


@pytest.mark.parametrize(
    "marked, said",
    [
        ("But don't go {all} the way{, just} two steps.",
         "But don't go all the way, just two steps."),
        ("Stop at the top{,} don't go down it.", "Stop at the top, don't go down it."),
        ("{You are requested to} leave the hall and to go straight.",
         "Leave the hall and go straight."),
        ("{You} are {then to} leave the hall.", "Leave the hall."),
        ("{Just keep} moving forward past the lamp.", "Keep moving forward past the lamp."),
        ("{Please keep} going straight.", "Go straight."),
        ("Turn around and {head} towards the hall.", "Turn around and head towards the hall."),
    ],
)  # fmt: skip
def test_a_denial_keeps_its_marks_and_a_request_leaves_nothing_behind(marked, said):
    assert given(marked) == said


@pytest.mark.parametrize(
    "marked, said",
    [
        ("Go in the hallway{,} after you turn on the left.", "Go in the hallway, after you turn"),
        ("Turn left{, love, you} pass the sofa.", "Turn left, pass the sofa."),
        ("Go past the sofa{;} stop.", "Go past the sofa; stop."),
        ("Go past{, er,} the sofa.", "Go past the sofa."),  # stood around what was aside
        ("Go past the sofa{,} and stop.", "Go past the sofa and stop."),
        ("Turn left<then>{, } go on.", "Turn left then go on."),
        ("Walk to the end and{, like,} stop.", "Walk to the end and stop."),
    ],
)
def test_what_parts_two_clauses_stays_unless_something_else_parts_them(marked, said):
    assert given(marked).startswith(said)


@pytest.mark.parametrize(
    "marked, said",
    [
        ("{Having} left the kitchen, turn to the right.", "Having left the kitchen, turn"),
        ("Go past the chairs and {freeze in} front of the lamp.", "and stop in front of the lamp"),
    ],
)
def test_what_was_done_before_and_how_one_stops_stay_told(marked, said):
    assert said in given(marked)


@pytest.mark.parametrize(
    "marked, said",
    [
        ("{Then just sneak} into the library.", "Go into the library."),
        ("{You just go} past the sofa.", "Go past the sofa."),
        ("Past the sofa is a lamp.", "Past the sofa is a lamp."),
        ("From the bed, {you should} turn left.", "From the bed, turn left."),
    ],
)
def test_a_sentence_without_a_verb_is_told_to_go(marked, said):
    assert given(marked) == said


def test_no_verb_is_put_before_another():
    assert given("{Then just} <walk>cruise along the railing.") == "Cruise along the railing."
    assert given("{And} <stop>wait {for me} by the pool.") == "Wait by the pool."
