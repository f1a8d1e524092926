"""Words of an edited sentence that do not go together, but for what was taken out between them."""

from __future__ import annotations

from collections.abc import Sequence

from mitigate.corruptions.language.directions import TURN_VERBS
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.plain.edits import DROP, KEEP, NUMBER, Edited, Said
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.steps import (
    DETERMINERS,
    HALTS,
    MARKS,
    MOVES,
    SEEKS,
    STEP,
    TURNS,
    WAY,
    steps,
)

_STAYS = bag("wait stand stay remain halt pause")
_SIDES = bag("left right around round back leftward rightward leftwards rightwards about")
_BEFORE_SIDE = bag(
    "to the your a sharp sharply slight slightly hard immediately immediate first second third "
    "next another all way completely fully ninety 90 degrees degree quarter gentle gently once"
)
_BARE = bag("go walk turn stop wait continue proceed move head")  # what takes no thing
_OF = bag("in of at with")
_DANGLING = DETERMINERS | _OF | bag(
    "and or into from not towards between to is are this they we i beside near for"
)  # fmt: skip
_SUBJECTS = bag("you they we i")
_SOON = bag("immediately slightly sharply directly")
_HALVES = bag("living dining laundry")  # of the names of rooms
_NO_START = bag("of than which")
_JOINS = bag("and or")  # joins nothing where a sentence begins
_ONTO = bag("into from towards toward between beside near to past behind")  # what asks for a thing
_THEN = bag("until till when once before after while and or then")
_GOALS = HALTS | bag("find locate look search seek spot fetch face")
_VERBS = MOVES | TURNS | STEP.keys() | _GOALS | bag(
    "reach see keep ignore avoid use open start begin have let watch meet hang be"
)  # fmt: skip


def side_first(words: Sequence[str]) -> bool:
    """Return whether a side comes before anything else that is turned to."""
    for word in words:
        if word in _SIDES:
            return True
        if word not in _BEFORE_SIDE:
            return False
    return False


def parted(made: Edited) -> bool:
    """Give back what was taken out between two words that do not go together without it; return
    whether there were such."""
    said = made.said()
    for one, other in zip(said, said[1:], strict=False):
        if _run_on(made, one, other):
            return True
        heard = other.place == one.place + 1 and not (one.phrase or other.phrase)
        inside = other.place == one.place and one.phrase == other.phrase
        if not heard and not inside and _clash(made, one, other) and _mend(made, one, other):
            return True
    return _twice(made, said) or _begins(made, said) or _ends(made, said)


def _run_on(made: Edited, one: Said, other: Said) -> bool:
    """Give back what joined a turn or a stop to the side or thing before it; return whether it was
    taken out."""
    ended = one.word in _SIDES | {"first", "again"} or made.found[one.place].tag == "NOUN"
    leads = other.word in TURN_VERBS | HALTS | MOVES | STEP.keys()
    if one.phrase or not ended or not leads or made.found[other.place].tag == "NOUN":
        return False
    between = range(one.place + 1, other.place)
    joins = (p for p in between if made.found[p].text in ",.;" or made.found[p].lower in _JOINS)
    return made.give_back(list(joins)[:1])


def _twice(made: Edited, said: Sequence[Said]) -> bool:
    """Take out "turn" behind a side that one turns to, "wait" behind a "stop" that was put, and
    "to" where nothing asks for it any more; return whether there was such."""
    for one, other, third in zip(said, said[1:], [*said[2:], Said("", 0, False)], strict=False):
        turned = (one.word, third.word) == ("turn", "turn") and other.word in ("left", "right")
        again = side_first(made.kept_words(third.place + 1))  # "turn right, turn left"
        if turned and not again and not third.phrase and third.place > one.place + 2 - one.phrase:
            made.acts[third.place] = DROP
            return True
        if one.phrase and one.word == "stop" and other.word in _STAYS and not other.phrase:
            made.acts[other.place] = DROP
            return True
        if one.word == "to" and not one.phrase and _idle(made, one, other):
            made.acts[one.place] = DROP
            return True
    return False


def _mend(made: Edited, one: Said, other: Said) -> bool:
    ahead = other.place - 1
    if one.phrase and ahead >= 0 and made.found[ahead].tag == "ADP" and not made.kept(ahead):
        number = made.before[one.place]
        made.acts[ahead], made.before[one.place] = KEEP, 0
        made.before[min(one.place, ahead)] = number
        return True
    if one.phrase or other.phrase:
        made.before[one.place if one.phrase else other.place] = 0
        return True
    return made.give_back(range(one.place + 1, other.place))


def _clash(made: Edited, one: Said, other: Said) -> bool:
    """Return whether two words cannot stand side by side."""
    if one.phrase or other.phrase:
        return _clash_by_phrase(one.word, other.word) or _clash_by_kind(made, one, other)
    return _clash_by_kind(made, one, other)


def _clash_by_phrase(word: str, after: str) -> bool:
    moves = after in STEP or after in MOVES
    return (word in WAY and after in WAY) or (moves and (word in _BARE or word == "to"))


def _clash_by_kind(made: Edited, one: Said, other: Said) -> bool:
    word, after = one.word, other.word
    noun = made.found[other.place].tag in ("NOUN", "PROPN") and not other.phrase
    kind = "" if one.phrase else made.found[one.place].tag
    ends, rest = after in MARKS, made.kept_words(other.place + 1)
    plain = plain_form(word)
    if plain in DETERMINERS:
        return (
            ends or after == "to" or (after in FUNCTION and after not in ("other", "same", "next"))
        )
    if plain in _BARE and (plain_form(after) in _BARE or after in DETERMINERS):
        return True
    return (
        (plain in _BARE and noun and after not in _SIDES)
        or (word in _SIDES and (noun or (after in _SIDES and not other.phrase)))
        or (word in _ONTO and not one.phrase and after in _THEN)
        or (kind == "NOUN" and after in DETERMINERS and other.place - one.place <= 5)
        or (kind == "ADJ" and word not in _SIDES and (ends or after in _OF or after in WAY))
        or (word in _HALVES and (ends or after in FUNCTION))
        or (word in _OF and (plain_form(after) in _BARE or after in STEP or after == "straight"))
        or (kind == "NOUN" and after in _SUBJECTS and rest[:1] in ([], ["."]))
        or (word in _SUBJECTS and made.found[other.place].tag in ("ADP", "DET", "NOUN", "ADJ"))
        or (word in HALTS and after == "to")
        or (word in _STAYS and noun and not one.phrase)
        or (word in _SOON and after in DETERMINERS and side_first([after, *rest]))
        or (ends and (word in _DANGLING or (word in MOVES and word != "turn")))
        or (word == "to" and after in ("and", "or"))
    )


def _idle(made: Edited, to: Said, behind: Said) -> bool:
    """Return whether a "to" is left of more words ("you are asked to turn", "close to the")."""
    if behind.phrase:
        return behind.word == "at"
    alone = to.place == 0 or not made.kept(to.place - 1)
    verb = alone and plain_form(behind.word) in _VERBS
    return behind.word == "to" or verb or (behind.word in HALTS and behind.place > to.place + 1)


def _begins(made: Edited, said: Sequence[Said]) -> bool:
    """Give back how a sentence begins, but for what joins it to nothing, or say "find" where a
    thing alone is left of what is to be found."""
    words = [entry for entry in said if entry.word not in MARKS]
    if words and words[0].word in _JOINS and words[0].place and not words[0].phrase:
        made.acts[words[0].place] = DROP
        return True
    if words and words[0].word in _NO_START and not words[0].phrase:
        return made.give_back(range(words[0].place))
    things = [w.place for w in words if not w.phrase and made.found[w.place].tag == "NOUN"]
    sought = any(token.lower in SEEKS for token in made.found)
    if not (sought and things) or any(plain_form(w.word) in _VERBS for w in words):
        return False
    first = things[0]
    while first and made.kept(first - 1) and made.found[first - 1].tag in ("DET", "ADJ"):
        first -= 1
    for place in range(first):
        made.acts[place], made.before[place] = DROP, 0
    made.before[first] = NUMBER["find"]
    return True


def _ends(made: Edited, said: Sequence[Said]) -> bool:
    """Give back how a sentence ends, and what it tells to do if no verb is left."""
    words = [entry for entry in said if entry.word not in MARKS]
    if not words:
        return False
    last = words[-1]
    if last.word in _DANGLING and made.give_back(
        range(last.place + (not last.phrase), made.end_of_clause(last.place + 1))
    ):
        return True
    if words[0].word in WAY or any(plain_form(w.word) in _VERBS for w in words):
        return False
    told = [range(step.first, step.last + 1) for step in steps(made.found)]
    goals = [[p] for p, t in enumerate(made.found) if t.lower in _GOALS and t.tag != "NOUN"]
    return made.give_back(next(iter([*told, *goals]), []))
