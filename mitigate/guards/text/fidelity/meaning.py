"""What an instruction means, finer than ``fidelity.check``: which way to each landmark, how sharp a
turn is, what is denied, in which order; and whether a rewrite says the same.

Words that say the same are first made equal; then two readings are compared.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache

from mitigate.corruptions.language.directions import MOTION
from mitigate.corruptions.language.fidelity import COLOURS, COMPASS, facts
from mitigate.corruptions.language.landmarks import CANONICAL, PLAIN, normal
from mitigate.corruptions.language.tagger import tag
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity.ways import AGREE, OPPOSED, OPPOSITES, RELATION, SENSES
from mitigate.guards.text.fidelity.wording import in_equal_words
from mitigate.guards.text.texts.evidence import VERBS
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.speech import meant

_WEAK = bag(
    """
    bottom top foot base end side flight set seat place somewhere wherever way bit spot front back
    gap space inside outside path junction fork level slide choose highest lowest done found thing
    head area room house home floor row one ones stop stops chance instance kind stretch extent
    entering going leaving order reach arm step steps look yourself
    """
)
# no things, though a tagger of plain routes takes them for nouns in speech (of the train voices)
_SPEECH = bag(
    """
    er um erm uh mean say said says one yes yeah hmm he she they done ur taken found give given
    since wrong lot pretty sorry better miss sweet quick anyway anyhow ooh feel told cause til
    used word imagine comfy teeny wee whatever lol why everybody nobody somebody somewhere ever
    love proper pls plz teh em smell bet repeat smile perfect intermediate thought finished
    however note thereby conduct therefore whereupon thereupon need choose assume secure real
    free concern cheer whoa else stuck time oneself themself gentle hold match win alone catch
    best correct seem meant ascertain presence safety comfort latter sound worry cute sleepy
    tour yet utilize secondary endpoint implement encountered finalize confirm haven't thx im
    nxt jus ull acquire needed advance provide displayed commence terminate negotiate deviate
    proceed initiate discontinue suspend execute prior initial subsequent adjacent
    aforementioned principal uppermost sir madam lady lordship goodness colleague traveller
    visitor guest people listener robot unit machine buddy pal mate chap chum dude honey darling
    answer explain remember forget promise trust swear admit suppose reckon fancy gorgeous
    lovely grand splendid rather quite honestly frankly basically actually literally obviously
    naturally
    """
)
_AGAIN = re.compile(r"\b(?:again|another|second|next|once more|also|too)\b")
_LEVEL = bag(
    "stairs stair steps step staircase stairway stairwell flight flights level floor story storey "
    "ramp basement ladder escalator landing attic loft lift elevator tower row garden"
)
_DENY = re.compile(r"\b(?:not|never|avoid|don't|dont|can't|cannot|won't|isn't|aren't|no|n't|nor)\b")
_CLAUSE = re.compile(
    r"[.;:!?]|,? (?:and )?then\b|,(?! (?:the|a|which|its?|on|in|past)\b)|\band (?=(?:go|turn|walk|"
    r"stop|wait|take|make|past|into|out|head|climb|towards|left|right|find|keep|continue|around|"
    r"across|stand|follow|move|step|up|down)\b)|\bafter (?:it|that)\b"
)
# categories of Habitat's, HM3D's and MP3D's object goals and of the apartments
CATEGORIES = bag(
    """
    chair table picture cabinet cushion sofa bed dresser plant sink toilet stool towel tv shower
    bathtub counter fireplace equipment seating clothes desk lamp bookshelf armchair rug wardrobe
    painting nightstand fridge stove oven mirror monitor refrigerator couch microwave bench
    """
)
_MEET = bag(
    "find reach follow see cross face keep pass meet spot locate seek fetch use take open enter "
    "exit leave climb ignore watch avoid touch"
)
_THINGS = frozenset(CANONICAL) | frozenset(CANONICAL.values()) | CATEGORIES
_SENSED = frozenset().union(*(bag for pair in SENSES for bag in pair))
_WORD = re.compile(r"[a-z0-9']+")
_SHADES = bag("dark pale light")


@dataclass(frozen=True)
class Meaning:
    """What a text tells. ``turns``: left, right, around, stop with their clause; ``levels``: up and
    down; ``ways``: landmark -> how one goes by it; ``order``: landmark -> its first clause;
    ``sharpness``: slight and sharp turns in order; ``denied``: how often; ``numbers``, ``colours``,
    ``compass``; ``words``: all."""

    turns: tuple[tuple[str, int], ...]
    levels: frozenset[str]
    ways: dict[str, frozenset[str]]
    order: dict[str, int]
    sharpness: tuple[str, ...]
    denied: int
    numbers: tuple[str, ...]
    colours: tuple[str, ...]
    compass: tuple[str, ...]
    words: frozenset[str]
    objects: frozenset[str]


def differs(heard: str, said: str) -> str:
    """Return how the meaning of ``said`` differs from that of ``heard``; "" if it does not."""
    old, new = meaning(heard), meaning(said)
    for tell in (_turns, _things, _ways, _rest, _order):
        problem = tell(old, new)
        if problem:
            return problem
    return ""


@lru_cache(maxsize=512)
def meaning(text: str) -> Meaning:
    """Return what ``text`` means."""
    equal = _WORD.sub(_plain, in_equal_words(meant(text)))
    turns: list[tuple[str, int]] = []
    levels: set[str] = set()
    ways: dict[str, set[str]] = {}
    order: dict[str, int] = {}
    for number, clause in enumerate(part for part in _CLAUSE.split(equal) if part.strip()):
        told = facts(clause)
        for turn in told.directions:
            if turn in ("left", "right", "around", "stop") and not _says_again(turn, clause, turns):
                turns.append((turn, number))
        levels |= _levels(clause)
        for name, way in _passed(clause):
            ways.setdefault(name, set()).update(way)
            order.setdefault(name, number)
    whole = facts(equal)
    words = re.findall(r"[a-z]+", equal)
    return Meaning(
        tuple(turns),
        frozenset(levels),
        {name: frozenset(found) for name, found in ways.items()},
        order,
        tuple(w for w in words if w in ("slightly", "sharply")),
        len(_DENY.findall(equal)),
        tuple(n.split()[0] for n in whole.numbers),
        tuple(a for a in whole.attributes if a in COLOURS)
        + tuple(w for w in words if w in _SHADES),
        tuple(w for w in words if COMPASS.match(w)),
        frozenset(words),
        frozenset(name for clause in _CLAUSE.split(equal) for name in _objects(clause)),
    )


def _plain(match: re.Match[str]) -> str:
    """Return a word in its plain form, but for words that tell ways and turns apart."""
    word = match.group()
    return word if word in _SENSED or len(word) < 3 else plain_form(word)


def _says_again(turn: str, clause: str, turns: list[tuple[str, int]]) -> bool:
    """Return whether a clause only repeats the turn told last ("left, yes, it is left")."""
    repeats = bool(turns) and turns[-1][0] == turn and turn in ("left", "right")
    moves = any(word in MOTION for word in re.findall(r"[a-z]+", clause))
    return repeats and not moves and not _AGAIN.search(clause) and not _passed(clause)


def _levels(clause: str) -> set[str]:
    """Return "up" and "down" where a clause changes the level."""
    words = re.findall(r"[a-z']+", clause)
    found = set()
    for place, word in enumerate(words):
        near = set(words[place + 1 : place + 6])
        if word in ("upstairs", "ascend", "upwards") or (
            word == "climb" and "down" not in words[place + 1 : place + 3]
        ):
            found.add("up")
        elif word in ("downstairs", "descend", "downwards"):
            found.add("down")
        elif word in ("up", "down") and (
            near & _LEVEL or set(words[:place]) & _LEVEL or place + 1 == len(words)
            or words[place + 1] in ("it", "them", "there", "one")
        ):  # fmt: skip
            found.add(word)
    return found


def _passed(clause: str) -> list[tuple[str, set[str]]]:
    """Return (landmark, how one goes by it) in the order of a clause."""
    found: list[tuple[str, set[str]]] = []
    way: set[str] = set()
    since = 0
    for place, token in enumerate(tokens := tag(clause)):
        since += 1
        if token.lower in RELATION:
            fresh = {RELATION[token.lower]}
            way = way | fresh if since <= 1 and way and token.lower != "to" else fresh
            since = 0
        name = normal(token.lower)
        noun = token.tag in ("NOUN", "PROPN") and token.lower not in PLAIN and len(name) > 1
        noun = noun and token.lower not in RELATION
        if noun and not (place == 0 and len(tokens) > 2) and name not in COLOURS:
            after = " ".join(t.lower for t in tokens[place + 1 : place + 5])
            turned = re.match(r"(?:is |at |lies )?(?:behind you|your back|behind)\b", after)
            found.append((name, {"away"} if turned else set(way) if since <= 6 else set()))
    return found


def _objects(clause: str) -> list[str]:
    """Return the things that a verb of the way takes: "follow the rail", "find a treadmill"."""
    found, verb = [], -99
    for place, token in enumerate(tag(clause)):
        if token.lower in VERBS or token.lower in _MEET:
            verb = place
        elif token.tag in ("NOUN", "PROPN") and place - verb <= 5:
            found.append(normal(token.lower))
        elif token.tag in ("VERB", "AUX", "PRON", "SCONJ"):
            verb = -99
    return found


def _turns(old: Meaning, new: Meaning) -> str:
    before, after = (Counter(d for d, _ in m.turns if d != "stop") for m in (old, new))
    if before != after:
        return f"directions: {_listed(before)} -> {_listed(after)}"
    stops = [sum(d == "stop" for d, _ in m.turns) for m in (old, new)]
    if bool(stops[0]) != bool(stops[1]) or abs(stops[0] - stops[1]) > 1:
        return f"directions, stops: {stops[0]} -> {stops[1]}"
    if old.levels != new.levels:
        return f"directions, levels: {_listed(old.levels)} -> {_listed(new.levels)}"
    if old.sharpness and new.sharpness and old.sharpness != new.sharpness:
        return f"sharpness: {_listed(old.sharpness)} -> {_listed(new.sharpness)}"
    return ""


def _things(old: Meaning, new: Meaning) -> str:
    lost, added = missing(old, new), missing(new, old, every=True)
    if lost:
        return f"landmark lost: {lost[0]}"
    return f"landmark invented: {added[0]}" if added else ""


def missing(old: Meaning, new: Meaning, *, every: bool = False, speech: bool = False) -> list[str]:
    """Return the things that ``old`` tells of and ``new`` does not; ``speech``: whether or not they
    are of the way; ``every``: and although speech has such words for what is no thing."""
    return [
        name
        for name in old.ways
        if name not in _WEAK
        and not _named(name, new)
        and (every or (name not in _SPEECH and (speech or _meant(name, old))))
    ]


def moved(old: Meaning, new: Meaning) -> str:
    """Return a thing that one goes by in another way, or in another order; "" if there is none."""
    return _ways(old, new) or _order(old, new)


def _meant(name: str, old: Meaning) -> bool:
    """Return whether a thing is one of the way: routes name such, or one goes by it."""
    return bool(old.ways[name]) or name in _THINGS or name in old.objects


def _named(name: str, other: Meaning) -> bool:
    """Return whether a landmark is named in another text, maybe as a part of a word."""
    stem = name[: max(4, len(name) - 2)]
    return name in other.ways or any(w.startswith(stem) or normal(w) == name for w in other.words)


def _ways(old: Meaning, new: Meaning) -> str:
    for name, before in old.ways.items():
        if name in _WEAK:
            continue
        after = new.ways.get(name, frozenset())
        for was in before - after:
            for now in after - before:
                if frozenset((was, now)) in OPPOSED:
                    return f"way changed: {was} -> {now} {name}"
        strange = (frozenset((a, b)) not in AGREE for a in before for b in after)
        if before and after and before.isdisjoint(after) and all(strange):
            return f"way changed: {_listed(before)} -> {_listed(after)} {name}"
    for one, other in SENSES:
        if one & old.words and not other & old.words and other & new.words and not one & new.words:
            return f"sense changed: {_listed(one & old.words)} -> {_listed(other & new.words)}"
    return ""


def _rest(old: Meaning, new: Meaning) -> str:
    if bool(old.denied) != bool(new.denied):
        return f"denials: {old.denied} -> {new.denied}"
    for kind in ("numbers", "colours", "compass"):
        before, after = Counter(getattr(old, kind)), Counter(getattr(new, kind))
        if kind == "numbers":
            before, after = Counter(set(before)), Counter(set(after))
        if before != after:
            return f"{kind[:-1]} changed: {_listed(before)} -> {_listed(after)}"
    for one, other in OPPOSITES:
        for first, second in ((one, other), (other, one)):
            if first in old.words and first not in new.words and second in new.words - old.words:
                return f"{first} -> {second}"
    return ""


def _order(old: Meaning, new: Meaning) -> str:
    """Return what has changed places: in another clause before, and in another clause behind."""
    before, after = dict(old.order), dict(new.order)
    for mine, m in ((before, old), (after, new)):
        seen: Counter[str] = Counter()
        for turn, clause in m.turns:
            seen[turn] += 1
            mine[f"{turn} {seen[turn]}"] = clause
    names = [name for name in before if name in after]
    for one in names:
        for other in names:
            if before[one] < before[other] and after[one] > after[other]:
                return f"order: {one} before {other}"
    return ""


def _listed(names: object) -> str:
    return ", ".join(sorted(map(str, names))) or "none"  # type: ignore[call-overload]
