"""Phrases of a tagger's edits that nothing heard backs: "turn" before what is no side, a way that
nobody spoke of."""

from __future__ import annotations

from collections.abc import Sequence

from mitigate.corruptions.language.tagger import Token
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.plain.edits import Edited
from mitigate.guards.text.plain.neighbours import side_first
from mitigate.guards.text.texts.plain_words import PHRASES, plain_form
from mitigate.guards.text.texts.speech import STOP
from mitigate.guards.text.texts.steps import (
    DOORS,
    HALTS,
    MARKS,
    MOVES,
    PRONOUNS,
    STEP,
    TURNS,
    WAY,
    Step,
    steps,
)

_PLACED = WAY.keys() | bag("there here where beside next near at on")  # "right there" is no turn
_IT_IS = bag("it's it'll")  # a left
_VERBS, _GOES = bag("go walk continue stop"), MOVES | STEP.keys() | HALTS
_SHOWN = bag("see there's there'll there're there spot notice count")  # "there's a door" is no way
# by which one stops, whether or not it is said so
_RESTS = HALTS | bag(
    "remains rests done end ends ending destination goal there here position place finished final "
    "still tight"
)


def unbacked(made: Edited) -> bool:
    """Take back phrases that nothing heard backs; return whether there were such."""
    open_ways = {step.way for step in steps(made.found) if _without_thing(made.found, step)}
    changed = False
    for place, number in enumerate(made.before):
        if not number:
            continue
        clause = [token.lower for token in made.found[slice(*made.clause(place))]]
        heard = open_ways | {WAY[word] for word in clause if word in WAY}
        if not _backed(made, place, PHRASES[number - 1].split(), heard, clause):
            made.before[place], changed = 0, True
    return changed


def _without_thing(found: Sequence[Token], step: Step) -> bool:
    """Return whether a step goes by what was named before: by "it", or by nothing."""
    behind = found[step.last + 1 : step.last + 2]
    return found[step.last].lower in PRONOUNS or not behind or behind[0].lower in MARKS


def _backed(
    made: Edited, place: int, phrase: Sequence[str], heard: set[str], clause: Sequence[str]
) -> bool:
    following = made.kept_words(place)
    if "turn" in phrase or phrase[-2:] == ["make", "a"]:
        turning = any(word in TURNS or word in _IT_IS for word in clause)
        emphasis = following[:1] == ["right"] and following[1:2] and following[1] in _PLACED
        if not turning or emphasis or not ("around" in phrase or side_first(following)):
            return False
    again = following[:1] != [] and following[0] in _GOES
    if again and phrase[-1] in _VERBS and plain_form(following[0]) != phrase[-1]:
        return False  # "go cruise", "stop wait"
    if "stop" in phrase and not (_RESTS & {*clause} or STOP.search(" ".join(clause))):
        return False
    for word in phrase:
        way = WAY.get(word)
        doors = way in ("through", "into", "out") and bool(DOORS & {*following[:4]})
        doors = doors and not _SHOWN & {*clause}
        if way and word not in ("in", "from", "by") and way not in heard and not doors:
            return False
    return True
