"""What an instruction says, and whether a rewritten one still says it.

:func:`facts` reads the turns, climbs and stops in order, the landmarks, numbers, compass words,
colours and denials of a text; :func:`check` lists what changed from one text to another.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from mitigate.corruptions import landmarks
from mitigate.corruptions.tagger import SENTENCE_ENDS, Token, tag

COMPASS = re.compile(r"(north|south|east|west)(east|west)?(ern|erly|ward|wards|bound)?$|o'clock$")
STOPS = frozenset("stop stops stopping stopped wait waits waiting halt halts pause pauses".split())
MOTION = frozenset(
    "go walk head proceed continue move enter exit leave turn climb descend ascend cross pass take "
    "make advance follow step veer bear approach traverse navigate going walking heading "
    "proceeding continuing moving entering exiting leaving turning climbing passing swing".split()
)
TURN_VERBS = frozenset(
    "turn turns turning turned veer veers veering bear bears bearing pivot rotate rotates swing "
    "hang swerve".split()
)
COLOURS = frozenset(
    "red blue green yellow orange white black brown grey purple pink beige tan gold golden silver "
    "maroon violet turquoise teal navy cream burgundy".split()
)
ATTRIBUTES = COLOURS | frozenset(
    "wooden metal leather marble wicker glass stone brick round square rectangular circular oval "
    "arched large small long short tall narrow wide open closed double single striped tiled "
    "carpeted spiral curved".split()
)
_SAME = {"gray": "grey", "big": "large", "huge": "large", "little": "small", "tiny": "small",
    "opened": "open", "shut": "closed", "rounded": "round", "wood": "wooden"}  # fmt: skip
_NUMBERS = {
    **{w: w for w in "two three four five six seven eight nine ten eleven twelve".split()},
    **{w: w for w in "twenty thirty forty fifty sixty ninety hundred half twice".split()},
    "couple": "two",
}  # fmt: skip
_DIGITS = dict(zip("2 3 4 5 6 7 8 9 10 11 12 20 30 40 50 60 90 100".split(), [
    *"two three four five six seven eight nine ten eleven twelve".split(),
    *"twenty thirty forty fifty sixty ninety hundred".split()], strict=True))  # fmt: skip
_ORDINALS = {
    **{w: w for w in "first second third fourth fifth sixth seventh eighth ninth last".split()},
    "1st": "first", "2nd": "second", "3rd": "third", "4th": "fourth", "5th": "fifth",
}  # fmt: skip
_UNITS = frozenset("foot feet meter meters metre metres yard yards inch inches pace paces step steps "
    "degree degrees minute minutes mile miles centimetres centimeters ft m cm".split())  # fmt: skip
_SAME_UNIT = {"feet": "foot", "ft": "foot", "m": "meter", "metre": "meter", "metres": "meter",
    "inches": "inch", "cm": "centimeter", "centimetres": "centimeter"}  # fmt: skip
_DENIALS = frozenset("not never avoid ignore skip don't dont can't cannot won't n't".split())
_ALONG = frozenset("hall hallway hallways corridor aisle path pathway walkway passage passageway row "
    "road street driveway alley rug carpet runner way line length sidewalk side edge room "
    "center middle patio porch deck bannister banister railing".split())  # fmt: skip
_LEVELS = frozenset("stairs stair steps step staircase stairway stairwell flight flights level floor "
    "story storey ramp basement ladder escalator ones".split())  # fmt: skip
_FILLERS = frozenset("the a an this that those these your same first second next set of two three "
    "long short small large entire main little few of wooden stone".split())  # fmt: skip
_RIGHT_ADVERB = frozenset("before after next in behind away past by beside under outside inside "
    "near above where when as there here beyond".split())  # fmt: skip
_RIGHT_TURN = TURN_VERBS | frozenset(
    "take the your a bear veer slight slightly hard sharp sharply immediate immediately far hand "
    "first second third next make and left to on another go".split()
)
_AROUND = re.compile(
    r"\b(?:turn|turning|spin|swing|rotate|pivot)(?: all the way| right| completely| fully| "
    r"yourself| straight)* (?:around|round|back|180 degrees?|one hundred and eighty degrees)"
    r"(?: 180 degrees?| completely| and go back)?(?: the other way)?"
    r"(?! (?:the|a|this|that|your|into|to|toward|towards|through|in)\b)"
    r"|\b(?:turn|turning) (?:around|round) (?:to|in|toward|towards|so)\b"
    r"|\b(?:full|u|complete|180 degree|180|half) turn(?: and go back)?|\babout face\b|\bu - turn\b"
    r"|\bturn and go back\b|\bgo back the (?:other way|way you came)\b|\breverse (?:your )?course\b"
)


@dataclass(frozen=True)
class Facts:
    """What a text says.

    ``directions``: left, right, around, straight, up, down and stop in the order of the text.
    ``landmarks``: canonical nouns in order, repeated as in the text. ``numbers``: numbers, ordinals
    and distances ("two", "first", "two steps"). ``compass``: compass words. ``attributes``: colours,
    shapes and sizes. ``turns``: how often one is told to turn. ``denials``: how often a thing is
    denied (not, never, avoid ...).
    """

    directions: tuple[str, ...]
    landmarks: tuple[str, ...]
    numbers: tuple[str, ...]
    compass: tuple[str, ...]
    attributes: tuple[str, ...]
    turns: int
    denials: int


def facts(text: str) -> Facts:
    """Return what ``text`` says (see :class:`Facts`)."""
    return _facts(text)[0]


def check(original: str, rewritten: str) -> list[str]:
    """Return what ``rewritten`` changes of ``original``'s meaning, in words; empty if nothing.

    Every entry begins with the kind of fact ("directions", "landmark lost", "landmark invented",
    "landmark order", "number lost", "number invented", "compass", "attribute lost", "attribute
    invented", "denial") and a colon.
    """
    (old, known), (new, kept) = _facts(original), _facts(rewritten)
    found = []
    if old.directions != new.directions:
        found.append(f"directions: {_listed(old.directions)} -> {_listed(new.directions)}")
    found += [f"landmark lost: {name}" for name in _unique(old.landmarks) if name not in kept]
    found += [f"landmark invented: {name}" for name in _unique(new.landmarks) if name not in known]
    if _order(old.landmarks, new.landmarks) != _order(new.landmarks, old.landmarks):
        found.append(f"landmark order: {_listed(old.landmarks)} -> {_listed(new.landmarks)}")
    found += _differences("number", old.numbers, new.numbers)
    found += [f"compass: {word} invented" for word in _unique(new.compass) if word not in known]
    found += [f"compass: {word} lost" for word in _unique(old.compass) if word not in kept]
    found += _differences("attribute", old.attributes, new.attributes)
    if old.denials != new.denials:
        found.append(f"denial: {old.denials} -> {new.denials}")
    return found


def _differences(kind: str, old: Sequence[str], new: Sequence[str]) -> list[str]:
    return [
        *(f"{kind} lost: {x}" for x in (Counter(old) - Counter(new))),
        *(f"{kind} invented: {x}" for x in (Counter(new) - Counter(old)) if x not in old),
    ]


def _order(names: Iterable[str], shared: Sequence[str]) -> list[str]:
    """Return the names also in ``shared`` in the order in which they first come."""
    return [name for name in _unique(names) if name in shared]


def _unique(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))


def _listed(names: Iterable[str]) -> str:
    return ", ".join(names) or "none"


@lru_cache(maxsize=4096)
def _facts(text: str) -> tuple[Facts, frozenset[str]]:
    """Return the facts and every word and landmark phrase of ``text``, normalised."""
    found = [token for token in tag(text)]
    marks = _joined(found)
    turned = _around(found)
    directions = _collapsed(_directions(found, turned), found)
    seen = frozenset(name for _, name, _ in marks) | {_SAME.get(t.lower, t.lower) for t in found}
    return (
        Facts(
            tuple(directions),
            tuple(name for _, name, is_noun in marks if is_noun),
            tuple(_numbers(found, turned)),
            tuple(t.lower for t in found if COMPASS.match(t.lower)),
            tuple(a for t in found if (a := _SAME.get(t.lower, t.lower)) in ATTRIBUTES),
            _turns(found, turned),
            sum(token.lower in _DENIALS for token in found),
        ),
        seen,
    )


def _joined(found: list[Token]) -> list[tuple[int, str, bool]]:
    """Return (place, canonical name, is a landmark) of every word, known phrases as one."""
    names: list[tuple[int, str, bool]] = []
    place = 0
    while place < len(found):
        for length in range(min(landmarks.LONGEST, len(found) - place), 1, -1):
            phrase = tuple(_bare(token.lower) for token in found[place : place + length])
            if phrase in landmarks.PHRASES:
                names.append((place, landmarks.PHRASES[phrase], True))
                place += length
                break
        else:
            names.append((place, landmarks.normal(found[place].lower), _is_landmark(found, place)))
            place += 1
    return names


def _bare(word: str) -> str:
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 4 else word


def _is_landmark(found: list[Token], place: int) -> bool:
    token = found[place]
    word = token.lower
    if token.tag not in ("NOUN", "PROPN") or word in landmarks.PLAIN or len(word) < 2:
        return False
    if word in ("step", "steps"):  # a distance, unless they are stairs
        return not any(t.tag == "NUM" or t.lower in ("a", "few", "couple", "more", "step", "small")
            for t in found[max(0, place - 3) : place])  # fmt: skip
    return _SAME.get(word, word) not in ATTRIBUTES and not COMPASS.match(word)


def _around(found: list[Token]) -> dict[int, int]:
    """Return first place -> last place of every phrase that means turning around."""
    text, starts = "", {}
    for index, token in enumerate(found):
        starts[len(text)] = index
        text += token.lower + " "
    spans = {}
    for match in _AROUND.finditer(text):
        last = len(text[: match.end()].split()) - 1
        spans[starts.get(match.start(), last)] = last
    return spans


def _directions(found: list[Token], turned: dict[int, int]) -> list[tuple[int, str]]:
    events: list[tuple[int, str]] = []
    skip = -1
    for place, token in enumerate(found):
        if place in turned:
            events.append((place, "around"))
            skip = turned[place]
        if place <= skip or not token.is_word:
            continue
        name = _direction(found, place)
        if name is not None:
            events.append((place, name))
    return events


def _direction(found: list[Token], place: int) -> str | None:
    word = found[place].lower
    before = found[place - 1].lower if place else ""
    after = found[place + 1].lower if place + 1 < len(found) else ""
    if word in ("left", "leftmost", "lefthand", "leftward", "leftwards", "left-hand"):
        past = before in ("have", "has", "you've", "just") or (before == "you" and after == "the")
        return None if past else "left"
    if word in ("right", "rightmost", "righthand", "rightward", "rightwards", "right-hand"):
        adverb = word == "right" and before not in _RIGHT_TURN and after in _RIGHT_ADVERB
        return None if adverb or before in ("all", "that's") else "right"
    if word in ("straight", "forward", "forwards", "onward", "onwards"):
        return "straight"
    if word == "ahead":
        return None if before == "go" and after in ("and", ",") else "straight"
    if word in ("upstairs", "ascend", "ascending", "upward", "upwards"):
        return "up"
    if word in ("downstairs", "descend", "descending", "downward", "downwards"):
        return "down"
    if word in ("climb", "climbing"):
        return None if "down" in (after, _at(found, place + 2)) else "up"
    if word in ("up", "down"):
        return _vertical(found, place, before)
    return "stop" if _stops(found, place) else None


def _vertical(found: list[Token], place: int, before: str) -> str | None:
    """Return up or down where it means a change of level, None where it means along."""
    word = found[place].lower
    if before in ("end", "ends", "pick", "set", "line", "lined", "sit", "lie", "slow", "upside"):
        return None
    for token in found[place + 1 : place + 7]:
        if token.lower in _LEVELS:
            return word
        if token.lower in _FILLERS or token.tag == "ADJ":
            continue
        leveled = token.is_word and token.tag != "VERB" and token.lower not in ("and", "then")
        return None if leveled else word
    return word


def _stops(found: list[Token], place: int) -> bool:
    word = found[place].lower
    if word in STOPS:
        return True
    if word in ("done", "arrived", "finished"):
        return any(
            t.lower in ("you", "you're", "you've", "are") for t in found[max(0, place - 3) : place]
        )
    return word == "rest" and _at(found, place - 1) == "to" and _at(found, place - 2) == "come"


def _at(found: list[Token], place: int) -> str:
    return found[place].lower if 0 <= place < len(found) else ""


def _collapsed(events: list[tuple[int, str]], found: list[Token]) -> list[str]:
    """Return the names; a stop, a way straight on or a climb told twice in a row counts once."""
    names: list[str] = []
    last = -1
    for place, name in events:
        between = found[last + 1 : place] if last >= 0 else []
        again = names and names[-1] == name
        moved = any(t.lower in MOTION and t.tag == "VERB" for t in between)
        near = name in ("up", "down") and len(between) <= 2
        if not (again and (near or (name in ("stop", "straight") and not moved))):
            names.append(name)
        last = place
    return names


def _numbers(found: list[Token], turned: dict[int, int]) -> list[str]:
    inside = {place for first, last in turned.items() for place in range(first, last + 1)}
    names = []
    for place, token in enumerate(found):
        word, after = token.lower, _at(found, place + 1)
        if place in inside:
            continue
        if word in _ORDINALS and not _adverbial(found, place):
            names.append(_ORDINALS[word])
        elif word in _NUMBERS or word.isdigit():
            unit = f" {_unit(after)}" if after in _UNITS else ""
            names.append((_NUMBERS.get(word) or _DIGITS.get(word, word)) + unit)
        elif word in _UNITS - {"step", "steps", "m", "foot", "feet", "yard"}:
            if _at(found, place - 1) not in _NUMBERS and not _at(found, place - 1).isdigit():
                names.append(_unit(word))
    return names


def _unit(word: str) -> str:
    return _SAME_UNIT.get(word, word.removesuffix("s"))


def _adverbial(found: list[Token], place: int) -> bool:
    """Return whether "first", "second" or "last" orders sentences and counts nothing."""
    before, after = _at(found, place - 1), found[place + 1] if place + 1 < len(found) else None
    if before in ("the", "your", "this", "at", "a", "in", "on", "take"):
        return (
            before == "at"
            and _at(found, place - 1) == "at"
            and (after is None or after.lower == ",")
        )
    starts = place == 0 or before in SENTENCE_ENDS or before in ("and", ",")
    return starts and (after is None or not after.is_word or after.tag in ("VERB", "PRON", "ADV"))


def _turns(found: list[Token], turned: dict[int, int]) -> int:
    """Return how often a turn is told: by a turning verb, or by "take a left" and the like."""
    count = len(turned)
    inside = {place for first, last in turned.items() for place in range(first, last + 1)}
    for place, token in enumerate(found):
        if place in inside:
            continue
        if token.lower in TURN_VERBS and token.tag == "VERB":
            count += 1
        elif token.lower in ("left", "right") and token.tag != "ADJ":
            near = [t.lower for t in found[max(0, place - 4) : place]]
            count += any(v in near for v in ("take", "make", "go", "head")) and not any(
                v in near for v in TURN_VERBS
            )
    return count
