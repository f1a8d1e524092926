"""Turns of an edited sentence: each that stays needs the verb that was heard for it and what joined
it to what stands before, and what a thing does ("the hallway turns left") is no turn."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.plain.edits import DROP, KEEP, NUMBER, PLAIN, Edited
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.steps import DETERMINERS, HALTS, MARKS, MOVES, STEP, TURNS, WAY

_SIDES = bag("left right")
_ORDINALS = bag("first second third fourth last next 1st 2nd 3rd")
_BEFORE = (
    DETERMINERS
    | _ORDINALS
    | bag(
        "to another immediate immediately sharp sharply slight slightly hard quick gentle gently "
        "really very little big"
    )
)
_TURNS = TURNS | bag("hang hanging do doing have turning veering bearing swinging") | MOVES
_IT_IS = bag("it's that's is it'll be there's")
_JOINS = bag("and or then") | frozenset(",.;")
_DOES = bag("turns bends curves veers forks swings")  # what a thing does where one turns
_SOON = bag("then slightly sharply gently just suddenly")
_IT = bag("it that which")
# with these a sentence begins that has lost its verb
_WAYS = bag(
    "into past through from out down up across along towards toward around back straight forward "
    "upstairs downstairs onto"
)
_VERBS = MOVES | STEP.keys() | HALTS | TURNS | bag("is are be was has have see do")
_THING = ("NOUN", "PROPN", "ADJ")  # a thing may be tagged as what comes before one
_WHERE = bag("when once until till where if as")
# who is told to turn
_AGENTS = bag(
    "agent robot unit assistant device machine system bot user person navigator traveller traveler "
    "walker visitor one you he she"
)


def turns_told(made: Edited) -> bool:
    """Give back what tells that a side is a turn, or whose; return whether there was such."""
    changed = any(_of_things(made, place) for place in range(1, len(made.found)))
    for place, token in enumerate(made.found):
        if token.lower in _SIDES and made.kept(place) and not _place_name(made, place):
            changed |= _told(made, place)
    return changed


def motion_told(made: Edited) -> None:
    """Say "go" before a sentence that begins with a way and has no verb left ("Into the bath.")."""
    said = made.said()
    alone = said and not said[0].phrase and said[0].word in _WAYS
    if alone and not any(one.word in _VERBS for one in said):
        made.before[said[0].place] = NUMBER["go"]


def _place_name(made: Edited, side: int) -> bool:
    behind = [t.lower for t in made.found[side + 1 : side + 2]]
    return behind != [] and (behind[0] in ("of", "one") or made.found[side + 1].tag == "NOUN")


def _told(made: Edited, side: int) -> bool:
    """Give back the verb of a turn and what joined it; return whether they were taken out."""
    found, first = made.found, side
    while first and found[first - 1].lower in _BEFORE:
        first -= 1
    lead = first - 1
    word = found[lead].lower if lead >= 0 else ""
    before = [one for one in made.said() if (one.place, not one.phrase) < (side, True)]
    between = []
    while before and before[-1].word in _BEFORE:
        between.append(before.pop().word)
    verb = before[-1].word if before else ""
    right = plain_form(verb) in _TURNS and not (verb == "turn" and _ORDINALS & {*between})
    if right or (word not in _TURNS and word not in _IT_IS):
        return False
    if word in _IT_IS:
        return _it_is(made, lead, side)
    changed = made.give_back(range(lead, side + 1))
    return _joined(made, lead) or changed


def _it_is(made: Edited, lead: int, side: int) -> bool:
    """Say "take the first left" for "it's the first left", and what joined it."""
    first, word = lead + 1, made.found[lead].lower
    named = made.found[first].lower in DETERMINERS | {"another"}
    if not named and (first < side or word != "it's"):
        changed = made.give_back(range(lead, side + 1))
        return _joined(made, lead) or changed
    old = (list(made.acts), list(made.before))
    made.give_back(range(first, side + 1))
    made.acts[lead], made.before[lead] = DROP, 0
    made.before[first] = NUMBER["take" if named else "turn"]
    joined = _joined(made, lead)
    return joined or old != (made.acts, made.before)


def _joined(made: Edited, verb: int) -> bool:
    """Give back the nearest mark or word that joined a verb to what stays before it."""
    ahead = [one for one in made.said() if one.place < verb]
    if not ahead or ahead[-1].word in _JOINS:
        return False
    for place in range(ahead[-1].place + 1, verb):
        if made.found[place].lower in _JOINS:
            return made.give_back([place])
    return False


def _of_things(made: Edited, verb: int) -> bool:
    """Give back all of what a thing does, if a part of it is left."""
    found = made.found
    if found[verb].lower not in _DOES:
        return False
    subject = verb - 1
    while subject and found[subject].lower in _SOON:
        subject -= 1
    one, last = found[subject], _last(made, verb)
    by_it = one.lower in _IT and subject > 0
    if last < 0 or one.lower in _AGENTS or not (by_it or one.tag in _THING):
        return False
    if not any(made.kept(p) for p in range(verb, last)):
        return False
    first = subject
    while first and not by_it and found[first - 1].tag in ("NOUN", "ADJ", "DET"):
        first -= 1
    if first and (found[first - 1].lower in _WHERE or (by_it and found[first - 1].text in MARKS)):
        first -= 1
    plain = made.acts[verb] == PLAIN
    changed = made.give_back(range(first, last))
    made.acts[verb] = KEEP
    return changed or plain


def _last(made: Edited, verb: int) -> int:
    """Return the place behind where a thing turns to: a side, or what it becomes; -1 for none."""
    for place in range(verb + 1, min(verb + 4, len(made.found))):
        word = made.found[place].lower
        if word in _SIDES:
            return place + 1
        if word in WAY:
            return made.end_of_clause(place)
    return -1
