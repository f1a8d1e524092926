"""Parts of a sentence that are told as they were heard or not at all, and what is left over of
requests: statements ("the stairs are behind you"), relative clauses, verbs behind "keep"."""

from __future__ import annotations

import re

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.plain.edits import CLAUSE_ENDS, DROP, KEEP, PLAIN, Edited
from mitigate.guards.text.plain.wholes import span_of, spelled, wholes
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.steps import MARKS, MOVES, PRONOUNS, STEP, TURNS, WAY

_SEEN = re.compile(
    r"(?<![^ ])(?:there's|there is|there are|you'll see|you will see|you see|you should see|"
    r"which is|which are)(?= )"
)
_WHEN = bag("after before until till when once as if while where")
_ORDINALS = bag("first second third fourth last next 1st 2nd 3rd final")
_AS_LONG = bag("until till while")
_KEEPS = bag("keep keeps continue start begin")
_MOVES = MOVES | STEP.keys() | TURNS
_RELATIVE = bag("that which who")
_OF_WHAT = bag("of to with past through into behind beside at near") | WAY.keys()
_DENIES = bag("don't dont not never")
_BUT = bag("just only but instead rather go simply")
_JOINS = bag("and then or") | frozenset(",;")
_ENDS = MARKS | {"and"}
_ON = bag("carry go keep head move walk continue come")
_AGAIN = bag("again left right")
_TOWARDS = bag("to towards toward")


def clauses_told(made: Edited) -> bool:
    """Give back what is told whole or not at all; return whether there was such."""
    changed = wholes(made) | _denied(made) | _again(made) | _seen(made)
    for place in range(len(made.found)):
        changed |= _kept_up(made, place) | _asked(made, place) | _relative(made, place)
        changed |= _pronoun(made, place) | _verb(made, place) | _subject(made, place)
        changed |= _it_is(made, place)
    return changed


def _seen(made: Edited) -> bool:
    """Give back "there's a" between words that tell and a thing ("turn left and there's a lamp");
    return whether there was such."""
    text, places = spelled(made.found)
    for match in _SEEN.finditer(text):
        span = span_of(match, places)
        said = made.said()
        ahead = [one for one in said if one.place < span.start]
        behind = [one for one in said if one.place >= span.start]
        if not ahead or not behind or behind[0].phrase or made.kept(span.start):
            continue
        word, last, thing = ahead[-1].word, ahead[-1].place, behind[0].place
        loose = word == "and" or word in _AGAIN or made.found[last].tag == "NOUN"
        if loose and not ahead[-1].phrase and _named(made, thing) <= span.stop + 3:
            return made.give_back(range(last + 1, thing + 1))
    return False


def _named(made: Edited, place: int) -> int:
    """Return the place of the noun that is named from ``place`` on, one far away for none."""
    while place < len(made.found) and made.found[place].tag in ("DET", "ADJ", "NUM"):
        place += 1
    noun = place < len(made.found) and made.found[place].tag in ("NOUN", "PROPN")
    return place if noun else len(made.found) + 9


def _it_is(made: Edited, place: int) -> bool:
    """Give back "it's" of "and it's the second door"; return whether it was taken out."""
    words = [t.lower for t in made.found[place : place + 3]]
    if words[:2] != ["it's", "the"] or words[-1] not in _ORDINALS or made.kept(place):
        return False
    thing = _named(made, place + 3)
    if thing >= len(made.found) or made.found[thing].lower in ("left", "right"):
        return False
    ahead = [one for one in made.said() if one.place < place]
    alone = not ahead or ahead[-1].word in _ENDS
    between = any(made.before[place : place + 3])
    return alone and made.kept(thing) and not between and made.give_back([place, place + 1])


def _subject(made: Edited, place: int) -> bool:
    """Give back "you" of "after you get in", and what it does at the end ("until you are called");
    return whether there was such."""
    if made.found[place - 1].lower in _AS_LONG and made.kept(place - 1) and made.before[place]:
        return made.give_back(range(place, min(place + 2, len(made.found))))
    if made.found[place].lower != "you" or not place or place + 1 >= len(made.found):
        return False
    when = made.found[place - 1].lower in _WHEN and made.kept(place - 1)
    if when and not made.kept(place) and not made.before[place + 1]:
        plain = made.acts[place + 1] == KEEP and made.found[place + 1].tag in ("VERB", "AUX")
        return plain and made.give_back([place])
    rest = made.kept_words(place + 1)
    if made.kept(place) and not any(made.before[place + 1 :]) and rest in ([], ["."]):
        return made.give_back(range(place, made.end_of_clause(place)))
    return False


def _denied(made: Edited) -> bool:
    """Give back the marks around a denial that stays ("don't go all the way, just three steps")."""
    changed = False
    for place, token in enumerate(made.found):
        if token.lower not in _DENIES or not made.kept(place):
            continue
        first, end = made.clause(place)
        alone = not any(made.kept(p) for p in range(first, place) if made.found[p].lower != "but")
        if alone and first and not made.kept(first - 1) and made.kept_words(0)[0] != token.lower:
            changed |= made.give_back([first - 1])
        behind = [t.lower for t in made.found[end + 1 : end + 2]]
        if end < len(made.found) and behind and behind[0] in _BUT and made.kept_words(end + 1):
            changed |= made.give_back([end, end + 1])
    return changed


def _again(made: Edited) -> bool:
    """Take out a phrase whose last word is said again, and a word that is said twice for a pause
    ("take a, er, a left"); return whether there was such."""
    said = [one for one in made.said() if one.word not in CLAUSE_ENDS]
    for one, other in zip(said, said[1:], strict=False):
        if one.word != other.word or one.place == other.place:
            continue
        if one.phrase and not other.phrase:
            made.before[one.place] = 0
            return True
        marks = [p for p in range(one.place + 1, other.place) if made.found[p].text == ","]
        if marks and one.word in ("a", "the", "to") and not (one.phrase or other.phrase):
            for place in (one.place, *marks):
                made.acts[place] = DROP
            return True
    return False


def _kept_up(made: Edited, place: int) -> bool:
    """Give back "keep" before "moving", or say the verb plainly; return whether that was needed."""
    word = made.found[place].lower
    heard = place and made.found[place - 1].lower in _KEEPS
    if not heard or not word.endswith("ing") or not made.kept(place):
        return False
    keeps = made.kept(place - 1)
    if keeps and made.acts[place] == PLAIN:
        made.acts[place] = KEEP
        return True
    if keeps or made.before[place] or made.acts[place] == PLAIN:
        return False
    if plain_form(word) == word:
        return made.give_back([place - 1])
    made.acts[place] = PLAIN
    return True


def _asked(made: Edited, place: int) -> bool:
    """Take out what is left over of a request: "are" and "to" of "you are to go"."""
    words = [t.lower for t in made.found]
    if not made.kept(place) or not place:
        return False
    left = words[place] == "are" and words[place - 1] == "you" and not made.kept(place - 1)
    behind = place + 1 < len(words) and made.kept(place + 1)
    verb = behind and plain_form(words[place + 1]) in _MOVES
    earlier = [p for p in range(place) if words[p] == "to" and plain_form(words[p + 1]) in _MOVES]
    again = words[place - 1] in _JOINS and verb and earlier and not made.kept(earlier[-1])
    if (left and "to" in words[place + 1 : place + 4]) or (words[place] == "to" and again):
        made.acts[place] = DROP
        return True
    return False


def _relative(made: Edited, place: int) -> bool:
    """Give back "that" between a thing and what it does ("the stairs that are on the right"), or
    what one does with it ("the lamp that you pass"), and "is" behind it; return whether there was
    such."""
    found, end = made.found, len(made.found) - 1
    if found[place].lower not in _RELATIVE or not 0 < place < end:
        return False
    if not made.kept(place - 1) or found[place - 1].tag != "NOUN":
        return False
    verb = place + 1 + (found[place + 1].lower == "you")
    if verb > end or any(made.before[place : verb + 1]):
        return False
    if made.kept(verb) and found[verb].tag in ("VERB", "AUX"):
        return made.give_back(range(place, verb))
    links = found[verb].lower in ("is", "are") and made.kept(place)
    return links and verb < end and made.kept(verb + 1) and made.give_back([verb])


def _pronoun(made: Edited, place: int) -> bool:
    """Give back "them" of "to the right of them and"."""
    one = made.found[place]
    if not place or one.lower not in PRONOUNS or made.kept(place) or not made.kept(place - 1):
        return False
    behind = made.end_of_clause(place) <= place + 1 or made.found[place + 1].lower in _JOINS
    asks = made.found[place - 1].lower in _OF_WHAT
    return behind and asks and made.give_back([place])


def _verb(made: Edited, place: int) -> bool:
    """Give back a verb between "and" and where it leads ("turn left and head towards the hall")."""
    words = [t.lower for t in made.found]
    if place + 1 >= len(words):
        return False
    if made.kept(place + 1) and words[place] in MOVES and not made.kept(place):
        said = [o for o in made.said() if o.place < place]
        if words[place + 1] in _AS_LONG or (
            words[place + 1] == "straight" and (not said or said[-1].word in _ENDS)
        ):
            first = place - bool(place and words[place - 1] in _KEEPS)
            joins = [p for p in range(said[-1].place + 1 if said else 0, first) if words[p] == ","]
            return made.give_back([*joins[-1:], *range(first, place + 1)])
    on = words[place] == "on" and place and words[place - 1] in _ON
    verb = place - 1 if on else place
    if made.kept(verb) or made.before[verb] or not (on or words[verb] in MOVES):
        return False
    leads = words[place + 1] in _TOWARDS or words[place + 1] in WAY
    if not leads or not made.kept(place + 1) or made.before[place] or made.before[place + 1]:
        return False
    ahead = [one for one in made.said() if one.place < verb]
    if not ahead:
        return False
    joins = [p for p in range(ahead[-1].place + 1, verb) if words[p] in _JOINS]
    if joins or ahead[-1].word in ("and", "or", "first"):
        return made.give_back([*joins[-1:], *range(verb, place + 1)])
    return False
