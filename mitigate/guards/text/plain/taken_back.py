"""Edits of speech that are taken back, since what they leave of a sentence is not what was said.

A tagger decides word by word. Its edits of a sentence are read once more here, by what stands
where, and each of these is mended by giving back what was heard:

- a word that may tell of the way, by what the train voices say beside it (``speech_words.py``);
- a phrase that nothing heard backs (``phrases.py``);
- a denial or a condition of which a part would stay ("not a lot, just slightly": "not slightly");
- a step or a stop that would be lost, in whatever words ("go past it", "hop up the steps");
- words that do not go together, or stand alone, but for what was taken out (``neighbours.py``);
- a turn without its verb (``turns_told.py``), half a statement (``clauses.py``).

Nothing is put that was neither heard nor chosen by the tagger, but for "stop", "find",
"at" and "towards" where that was said in other words.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from mitigate.corruptions.language.tagger import Token
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.plain.clauses import clauses_told
from mitigate.guards.text.plain.edits import DROP, KEEP, NUMBER, Edit, Edited
from mitigate.guards.text.plain.marks import marks_kept
from mitigate.guards.text.plain.neighbours import parted
from mitigate.guards.text.plain.phrases import unbacked
from mitigate.guards.text.plain.speech_words import speech_words
from mitigate.guards.text.plain.turns_told import motion_told, turns_told
from mitigate.guards.text.plain.wholes import span_of, spelled, together
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.speech import SIDE_BACK, STOP
from mitigate.guards.text.texts.steps import (
    HALTS,
    MARKS,
    PRONOUNS,
    SEEKS,
    WAY,
    WHICH,
    same,
    steps,
    unknown_move,
    which,
)

_AT = bag("in inside outside by from")  # where a thing is, unless a verb of motion stands before
_IF = bag("if unless")
_DENIALS = _IF | bag(
    "not never don't dont doesn't didn't can't cannot won't isn't aren't wasn't shouldn't mustn't "
    "needn't n't no forget avoid ignore disregard skip without instead rather except nor neither "
    "attention alone"
)
# what denies nothing of the way
_NO_DENIAL = re.compile(
    r"(?:do not|don't|never|not to) (?:forget|worry|hesitate|mind|fret|panic)|"
    r"if (?:you|i) (?:will|would|please|may|might|could|don't|do not|like|wish|can)\b|"
    r"if (?:needed|possible|necessary|that)|"
    r"not (?:far|long|only|yet|at all|too|very|quite|sure)|"
    r"no (?:problem|worries|hurry|rush|doubt|pressure|sweat|less|fewer)\b|"
    r"can't miss|don't you\b(?! dare)|not a problem"
)
# what is said in many words -> the phrase for it
_SAYINGS = (
    (re.compile(r"(?<![^ ])in the direction of(?= )"), "towards"),
    (
        re.compile(
            r"(?<![^ ])(?:when|once|as soon as|after|upon)(?: you(?:'ve|'re| have| are)?)? "
            r"(?:get to|gotten to|reach(?:ed|ing)?|arriv(?:e|ed|ing) at|com(?:e|ing) to)(?= the )"
        ),
        "at",
    ),
    (re.compile(r"(?<![^ ])in (?:the vicinity of|(?:close |the )?proximity (?:to|of))(?= )"), "by"),
)
# what is said of the speaker alone
_NOTHING = re.compile(
    r"(?<![^ ])(?:i'll|i will|we'll) be right (?:with you|back|there|behind you|along)(?= )"
)
_AT_THAT = bag("upon once when after")
# words that are told together or not at all
_WHEN = bag("until till before prior after upon once when")  # tells when, of what comes then
# probability of dropping from which a word may go although it may tell of the way (chosen on the
# validation voices)
SURE = 0.9
_ROUNDS = 24  # each gives something back, so there is an end anyway


def taken_back(found: Sequence[Token], edits: Sequence[Edit], drop: Sequence[float]) -> list[Edit]:
    """Return the ``edits`` of a sentence's tokens less those that would harm what it says;
    ``drop``: how probably each token goes."""
    wrong = _corrected(found)
    rest = [place for place in range(len(found)) if place not in wrong]
    made = Edited(
        [found[p] for p in rest], [edits[p].act for p in rest], [edits[p].before for p in rest]
    )
    if not any(made.before) and not made.kept_words(0):
        return list(edits)  # the gate decides on whole sentences
    for side in (at for at, p in enumerate(rest) if p - 1 in wrong):
        made.give_back([side])
    _mended(made, [drop[p] for p in rest])
    out = [Edit(DROP)] * len(found)
    for place, act, phrase in zip(rest, made.acts, made.before, strict=True):
        out[place] = Edit(act, phrase)
    return out


def _corrected(found: Sequence[Token]) -> set[int]:
    """Return the places of sides that are taken back, and of how ("left, no wait,")."""
    text, places = spelled(found)
    return {p for match in SIDE_BACK.finditer(text) for p in span_of(match, places)[:-1]}


def _mended(made: Edited, drop: Sequence[float]) -> None:
    _sayings(made)
    for _ in range(_ROUNDS):
        mended = [
            together(made),
            _denials(made),
            _words(made, drop),
            unbacked(made),
            _times(made),
            _steps(made),
        ]
        more = [_stops(made), parted(made), turns_told(made), clauses_told(made)]
        if not any([*mended, *more]):
            break
    marks_kept(made)
    motion_told(made)


def _sayings(made: Edited) -> None:
    """Say what is said in many words by its phrase, where they would not all stay."""
    text, places = spelled(made.found)
    for match in _NOTHING.finditer(text):
        for place in span_of(match, places):
            made.acts[place], made.before[place] = DROP, 0
    for pattern, phrase in _SAYINGS:
        for match in pattern.finditer(text):
            first, behind = (span := span_of(match, places)).start, span.stop
            thing = any(made.kept(p) for p in range(behind, made.end_of_clause(behind)))
            if thing and not all(made.kept(p) for p in span):
                made.acts[first:behind] = [DROP] * len(span)
                made.before[first:behind] = [0] * len(span)
                made.before[behind] = NUMBER[phrase]
                if made.found[behind].lower == "the":
                    made.acts[behind] = KEEP


def _times(made: Edited) -> bool:
    """Give back words that say when a thing is done that is still told; return whether there were
    such."""
    changed = False
    for place, token in enumerate(made.found):
        behind = range(place + 1, min(place + 6, made.end_of_clause(place)))
        if token.lower not in _WHEN or made.kept(place):
            continue
        told = [p for p in behind if made.kept(p)]
        if token.lower in _AT_THAT:  # may be told by a phrase, or by the order of what is told
            by_phrase = any(made.before[p] for p in (place, *behind))
            before = any(made.kept(p) for p in range(place) if made.found[p].is_word)
            told = told if before and not by_phrase else []
        if told:
            changed |= made.give_back(range(place, told[0] + 1))
    return changed


def _words(made: Edited, drop: Sequence[float]) -> bool:
    """Give back words of a clause that may tell of the way: of one of which a part stays, all but
    what people say beside it; of others all, unless each such word surely goes, and no place
    ends what the sentence begins with. Return whether there were such."""
    changed, start, aside = False, 0, speech_words() | SEEKS
    while start < len(made.found):
        end = made.end_of_clause(start)
        content = [p for p in range(start, end) if made.found[p].lower not in FUNCTION]
        told = [p for p in content if made.found[p].lower not in aside]
        if any(made.kept(p) for p in content):
            for place in told:
                if not made.kept(place):
                    made.acts[place], changed = KEEP, True
        elif any(drop[p] < SURE for p in told) or not start and unknown_move(made.found[:end]):
            changed |= made.give_back(range(start, end))
        start = end + 1
    return changed


def _denials(made: Edited) -> bool:
    """Give back denials and conditions of which a part is left; return whether there were such."""
    text, places = spelled(made.found)
    excused = {places[m.start()] for m in _NO_DENIAL.finditer(text) if m.start() in places}
    changed = False
    for place, token in enumerate(made.found):
        if token.lower in _DENIALS and place not in excused:
            scope = _scope(made, place)
            told = [p for p in scope if p == place or made.found[p].lower not in FUNCTION]
            if len({made.kept(p) for p in told}) > 1:
                changed |= made.give_back(scope)
    return changed


def _scope(made: Edited, place: int) -> range:
    """Return the places that a denial or a condition at ``place`` speaks of."""
    word, first, last = made.found[place].lower, place, made.end_of_clause(place)
    if word in _IF:
        while first and made.found[first - 1].lower not in MARKS:
            first -= 1
        if first == place and last < len(made.found) - 1:
            last = made.end_of_clause(last + 1)  # what is so then
    elif word in ("attention", "alone"):  # pay no ..., leave that ...
        first = max(0, place - 2)
    return range(first, last)


def _steps(made: Edited) -> bool:
    """Give back steps whose way is not said; return whether there were such."""
    told = [*steps(made.found), *which(made.found)]
    own = {place for step in told for place in range(step.first, step.last + 1)}
    free = [
        WAY[one.word]
        for one in made.said()
        if one.word in WAY and (one.phrase or (one.place not in own and one.word not in _AT))
    ]
    changed = False
    for first, last, way in told:
        span = range(first, last + 1)
        if way == WHICH and any(made.kept(p) for p in span):
            continue
        if any(made.kept(p) and WAY.get(made.found[p].lower) == way for p in span):
            changed |= made.found[last].lower in PRONOUNS and made.give_back(span)
            continue
        match = next((said for said in free if same(said, way)), None)
        if match is not None:
            free.remove(match)
        else:
            changed |= made.give_back(span)
    return changed


def _stops(made: Edited) -> bool:
    """Say "stop" where that is said in other words and would be lost; return whether it was."""
    if any(one.word in HALTS for one in made.said()) or not made.kept_words(0):
        return False
    text, places = spelled(made.found)
    for match in STOP.finditer(text):
        if match.start() not in places:
            continue
        span = span_of(match, places)
        if span.stop >= len(made.found):
            return made.give_back(span)
        for place in span:
            made.acts[place], made.before[place] = DROP, 0
        made.before[span.stop] = NUMBER["stop"]
        return True
    return False
