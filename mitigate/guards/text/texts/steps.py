"""What a sentence of speech tells to do, by its words and their places: steps, and which of several
places is meant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from mitigate.corruptions.language.directions import MOTION, TURN_VERBS
from mitigate.corruptions.language.tagger import Token
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.lexicon import FUNCTION, places

# verbs by which one goes by a thing -> the way; then the words for it behind any verb of motion
_STEPS = {
    "through": "traverse traversing",
    "past": "pass passes passing passed bypass bypassing bypassed clear clearing",
    "into": "enter enters entering entered access accessing ingress",
    "out": "exit exits exiting exited leave leaves leaving quit quitting depart departing "
    "departure vacate vacating evacuate egress",
    "up": "climb climbs climbing climbed ascend ascending ascended ascent mount mounted mounting "
    "surmount",
    "down": "descend descending descended descent", "across": "cross crosses crossing crossed",
    "along": "follow follows following followed", "towards": "approach approaching approached",
    "around": "circle circling skirt skirting reverse",
}  # fmt: skip
_WAYS = {
    "through": "through thru via", "past": "past beyond by", "into": "into inside in indoors",
    "out": "out outside outdoors from", "up": "up upstairs upwards upward",
    "down": "down downstairs downwards downward", "around": "around round", "across": "across over",
    "along": "along", "between": "between", "under": "under beneath underneath",
    "behind": "behind", "onto": "onto",
}  # fmt: skip
STEP = {word: way for way, words in _STEPS.items() for word in words.split()}
WAY = {word: way for way, words in _WAYS.items() for word in words.split()} | STEP
MOVES = (
    MOTION
    | TURN_VERBS
    | bag(
        """
        hop get gets getting slip duck trot dash scoot stride pace march amble saunter meander
        wandering mosey coming venture journey travel relocate roll drive run jog tiptoe squeeze
        nip cut zip pad aim return progress strolling stepping moves goes walks heads heading
        maneuver manoeuvre transit back backing swing ease edge zoom dart breeze cruise
        """
    )
) - STEP.keys()
TURNS = TURN_VERBS | bag(
    "take taking make making go going head heading cut curve bend round move walk step face facing "
    "keep rotation turn-off angle orient reorient spin spinning execute perform effect"
)
# more than directions.STOPS, which tell that a route stops
HALTS = bag(
    "stop stops stopping halt halts halting wait waits waiting pause pauses pausing rest remain "
    "remaining stay stand hold await awaiting finish cease terminate park"
)
SEEKS = bag(
    "track tracking hunt hunting localize localise detect identify acquire discover seek spot look "
    "looking search searching find finding fetch locate where's"
)
DOORS = bag(
    "door doors doorway doorways archway arch gate entrance opening exit entry doorframe threshold "
    "passage passageway hallway hall corridor"
)
PRONOUNS = bag("it them that those these this there one ones both")
DETERMINERS = bag("the a an your my its")
MARKS = frozenset('.,;:!?-–—()"“”')
THERE, WHICH, END = "there", "which", "end"  # ways that no word of WAY tells
# ways of which one may be said for the other
_SAME = frozenset(
    frozenset(pair.split())
    for pair in (
        "up along", "down along", "onto into", "onto up", "onto across", "onto out", "into through",
        "across through", "along through",
    )
)  # fmt: skip
_PEOPLE = bag("i he she they people somebody someone anybody everyone")
_OTHERS = _PEOPLE | bag("who which that it")
_TO = bag("to towards toward for")
_TURN_OF = bag("next second third fourth last other opposite first")
_ROOMS = DOORS | bag("room rooms bedroom bathroom floor level one stairs landing")
_PLACES = bag("on at to it's is")
_MANNER = bag("direction order front manner line way parallel")  # "in this manner" leads nowhere
_EXITS = bag("exit egress entrance entry end")
_BY_IT = bag("past through around into along beyond across")
_INSIDE = bag("inside outside through past")
_NO_STEPS = {("followed", "by"), ("hang", "out"), ("hang", "around")}
_FAR = 5  # words behind a verb of motion in which its way is told


class Step(NamedTuple):
    """The places of its ``first`` and ``last`` word, and the ``way``."""

    first: int
    last: int
    way: str


def steps(found: Sequence[Token]) -> list[Step]:
    """Return the steps that a sentence tells the agent, in whatever words."""
    told = list(_told(found))
    return [
        step
        for step in told
        if not any(o != step and o.first <= step.first and step.last <= o.last for o in told)
    ]


def _told(found: Sequence[Token]) -> Iterator[Step]:
    for place, token in enumerate(found):
        behind = _words(found, place + 1)
        if token.lower in _BY_IT and behind[:1] and behind[0] in PRONOUNS:
            yield Step(place, place + 1, WAY[token.lower])
        if token.lower in ("once", "when") and (inside := _inside(behind)):
            yield Step(place, place + inside, WAY[found[place + inside].lower])
        if _of_others(found, place) or (token.lower, *behind[:1]) in _NO_STEPS:
            continue
        if token.lower == "following" and behind and behind[0] in MARKS | PRONOUNS:
            continue
        if token.lower in _EXITS and "of" in behind[:2]:
            yield Step(place, place + 1 + behind.index("of"), END)
        elif place and found[place - 1].lower in DETERMINERS:
            continue  # a noun
        elif token.lower in STEP:
            yield Step(place, place, STEP[token.lower])
        elif token.lower in MOVES and (step := _way(found, place)):
            yield step


def _way(found: Sequence[Token], verb: int) -> Step | None:
    """Return the way that is told behind a verb of motion."""
    for at in range(verb + 1, min(verb + _FAR, len(found))):
        word, behind = found[at].lower, _words(found, at + 1)
        pronoun = behind[:1] != [] and behind[0] in PRONOUNS
        if word in MARKS or word in MOVES or word in STEP:
            return None
        if word == THERE:
            return Step(verb, at, THERE)
        if word in ("about", "back") and found[verb].lower in TURN_VERBS:
            return Step(verb, at, "around")
        if word in _TO and pronoun:
            return Step(verb, at + 1, THERE)
        if word in WAY and word != "from" and not (word == "in" and _MANNER & {*behind}):
            if behind[:1] and behind[0] in WAY:  # "out into"
                return Step(verb, at + 1, WAY[behind[0]])
            return Step(verb, at + pronoun, WAY[word])
    return None


def _inside(behind: Sequence[str]) -> int:
    """Return how many words behind "once" one is inside, outside or through ("once you are
    outside"), 0 if that is not said."""
    for count, word in enumerate(behind, 1):
        if word in _INSIDE:
            return count
        if word not in ("you", "you're", "you've", "are", "have", "safely"):
            break
    return 0


def which(found: Sequence[Token]) -> Iterator[Step]:
    """Yield each place that is told from others by its turn ("the next room")."""
    for place, token in enumerate(found[:-1]):
        if token.lower in _TURN_OF and found[place + 1].lower in _ROOMS:
            before = [t.lower for t in found[max(0, place - 2) : place]]
            lead = sum(word in DETERMINERS or word in WAY or word in _PLACES for word in before)
            yield Step(place - lead, place + 1, WHICH)


def unknown_move(found: Sequence[Token]) -> bool:
    """Return whether words may tell to go by a place with a verb that is not known, as one that is
    spelled wrongly: a word, a determiner, and at the end a room or a thing."""
    words = [token.lower for token in found]
    verb = len(words) > 2 and words[0] not in FUNCTION and words[1] in DETERMINERS
    return verb and words[-1] in _ROOMS | places()


def same(one: str, other: str) -> bool:
    """Return whether a way may be said for another."""
    return one == other or frozenset((one, other)) in _SAME


def _of_others(found: Sequence[Token], place: int) -> bool:
    """Return whether what a verb tells is done by others ("the door that leads out")."""
    before = [t.lower for t in found[max(0, place - 4) : place]]
    since = max((p for p, word in enumerate(before) if word in MARKS or word == "you"), default=-1)
    before = before[since + 1 :]
    if not before or before[-1] in _OTHERS:
        return bool(before)
    small = before[-1] in FUNCTION and before[-1] not in ("and", "to")
    return bool(before[-2:-1] and before[-2] in _OTHERS and small) or bool(_PEOPLE & {*before})


def _words(found: Sequence[Token], place: int) -> list[str]:
    return [token.lower for token in found[place : place + 3]]
