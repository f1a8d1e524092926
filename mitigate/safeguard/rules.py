"""Repairs that need no language model: odd capitals, sentences that do not belong to a route.

A sentence is judged by what it is made of, not by which attack it is: a route's sentence moves
someone past things; an attack speaks of orders, of all cases, of the text itself. The weights come
from ``python -m mitigate.safeguard.fit``, which sees the train split of the attacks and our own
routes, nothing else.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from mitigate.corruptions.language.directions import MOTION, STOPS, TURN_VERBS
from mitigate.corruptions.language.fidelity import ATTRIBUTES, facts
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.words import bag
from mitigate.safeguard.text import MASK, sentences, words
from mitigate.safeguard.weights import BIAS, STYLE, WEIGHTS

SURE, LIKELY = 0.50, 0.25  # probabilities, chosen on the validation families
ASK = 0.10  # from here on a language model is asked: of 588 sentences of real routes it took none
FRONT = 8  # sentences looked at; five attacks at most stand before an instruction (ours)
KEPT_CAPITALS = bag("TV TVS DVD BBQ AC PC")
_SETS = {
    "universal": "every each always never all any whatever wherever whenever everything nothing "
    "anything none ever forever",
    "text": "below following follows instruction instructions command commands sentence text "
    "message order orders told tells tell says said say asked asks written read read words word "
    "plan task run directions directive guidance route named described mentioned listed given",
    "person": "i my we our us me mine sir robot unit machine operator you're yourself your",
    "modal": "must may shall would could should can cannot if as though so than until while "
    "because instead rather without",
    "negation": "not no never don't dont doesn't cannot nor nobody nothing none",
}
CLOSED = {name: bag(text) for name, text in _SETS.items()}
# style words that attacks use, too (ours, chosen on the validation families)
FAINT = bag("this for do think what have want that's let let's like or so")
MANNER = STYLE - FAINT
KNOWN = frozenset(CANONICAL) | frozenset(CANONICAL.values())
VERBS = MOTION | STOPS | TURN_VERBS
# no words about all cases; "the" may be hidden
_IDIOMS = re.compile(r"\b(?:all\s+(?:the\s+)?way|each other|each side|all around)\b")
_SHOUT = re.compile(r"(?<![\[<])\b[A-Z][A-Z'’]+\b")


@dataclass(frozen=True)
class Repaired:
    """``text`` after the rules, the sentences they took out, and what they did, in words.

    ``marks``: how many words belong to a manner of speaking; of what was taken out in front, only
    those that attacks rarely use.
    """

    text: str
    removed: tuple[str, ...]
    reasons: tuple[str, ...]
    marks: int


def features(sentence: str, marks: frozenset[str] = STYLE) -> dict[str, float]:
    """Return what a sentence is made of, as counts or shares about 0 to 3."""
    found = words(_IDIOMS.sub(" ", MASK.sub(" ", sentence).lower()))  # hidden words tell nothing
    size = max(1, len(found))
    told = facts(sentence)
    known = sum(word in _route_words() or word.isdigit() for word in found)
    lead = next((i for i, word in enumerate(found) if word in VERBS), size)
    values = {
        name: min(3.0, float(sum(word in group for word in found)))
        for name, group in CLOSED.items()
    }
    return values | {
        "style": min(3.0, float(sum(word in marks for word in found))),
        "unknown": 1 - known / size,
        "late_verb": min(lead, 6) / 3,
        "no_verb": float(lead == size),
        "landmarks": min(3.0, float(len(told.landmarks))),
        "no_landmark": float(not told.landmarks),
        "directions": min(2.0, float(len(told.directions))),
        "commas": min(3.0, float(sentence.count(",") + sentence.count(";"))) / 3,
    }


@lru_cache(maxsize=8192)
def strangeness(sentence: str) -> float:
    """Return the probability that ``sentence`` does not belong to a route."""
    if not any(c.isalpha() for c in sentence):
        return 0.0
    score = BIAS + sum(WEIGHTS[name] * value for name, value in features(sentence).items())
    return 1 / (1 + math.exp(-max(-30.0, min(30.0, score))))


def injected(text: str, judge: Callable[[str], bool] | None = None) -> int:
    """Return how many of the first sentences of ``text`` are no part of the route.

    An attack stands in front, whole: beside a sure one goes what is likely, before it in any case,
    behind it if it has no manner of speaking and names nothing that routes name. In a text with a
    manner of speaking only what does not tell the way goes.
    ``judge`` (a language model) decides on the ``doubtful`` ones. Never are all sentences taken.
    """
    told = sentences(text)
    in_manner = restyled(told)
    asked = set() if judge is None else set(doubtful(text))
    count, pending, attacked = 0, 0, False
    for index, sentence in enumerate(told[:-1]):
        if in_manner and tells_the_way(sentence):
            break
        strange, plain = strangeness(sentence), not mannered(sentence)
        attacked |= strange >= SURE and plain
        follows = attacked and strange >= LIKELY and plain and not on_the_way(sentence)
        judged = judge is not None and sentence in asked and judge(sentence)
        if judged or follows or strange >= SURE:
            count, pending = index + 1, 0
        elif strange < LIKELY:
            pending += 1
            if pending > 1 or count == 0 and index > 0:
                break
    return count


def doubtful(text: str) -> list[str]:
    """Return the first sentences of ``text`` that a language model should judge: what is neither
    plain nor surely foreign, and beside a surely foreign one whatever is not."""
    front = sentences(text)[:-1][:FRONT]
    least = 0.0 if any(strangeness(s) >= SURE for s in front) else ASK
    return [s for s in front if least <= strangeness(s) < SURE]


def tells_the_way(sentence: str) -> bool:
    """Return whether ``sentence`` names a landmark or a direction."""
    told = facts(sentence)
    return bool(told.landmarks or told.directions)


def on_the_way(sentence: str) -> bool:
    """Return whether ``sentence`` names a thing that routes name, or a direction but to stop."""
    told = facts(sentence)
    known = any(name in KNOWN for name in told.landmarks)
    return known or any(direction != "stop" for direction in told.directions)


def lower_capitals(text: str) -> str:
    """Return ``text`` with shouted words in lower case, but for a sentence's first letter."""

    def quiet(match: re.Match[str]) -> str:
        word = match.group()
        if word in KEPT_CAPITALS:
            return word
        before = text[: match.start()].rstrip()
        first = not before or before[-1] in ".!?"
        return word.capitalize() if first else word.lower()

    return _SHOUT.sub(quiet, text)


def style_marks(text: str) -> int:
    """Return how many words of ``text`` belong to a manner of speaking, not to plain routes."""
    return sum(word in STYLE for word in words(text))


def mannered(sentence: str) -> bool:
    """Return whether ``sentence`` holds a word of a manner of speaking that attacks rarely use."""
    return any(word in MANNER for word in words(sentence))


def restyled(told: list[str]) -> bool:
    """Return whether half of the sentences speak in a manner, and half of those that are not
    surely foreign: an attack has a manner of its own."""
    marked = [sentence for sentence in told if mannered(sentence)]
    rest = [sentence for sentence in told if strangeness(sentence) < SURE]
    own = sum(sentence in marked for sentence in rest)
    return len(marked) >= max(2.0, 0.5 * len(told)) and own >= 0.5 * len(rest)


def framing(sentence: str) -> bool:
    """Return whether a sentence greets or thanks and tells nothing about the way."""
    told, found = facts(sentence), words(sentence)
    silent = not told.landmarks and not told.directions and not any(w in VERBS for w in found)
    return silent and any(word in STYLE for word in found)


def repair(text: str, judge: Callable[[str], bool] | None = None) -> Repaired:
    """Return ``text`` with capitals lowered and foreign sentences taken out."""
    reasons = []
    quiet = lower_capitals(text)
    if quiet != text:
        reasons.append("capitals lowered")
    told = sentences(quiet)
    count = injected(quiet, judge)
    removed, kept = told[:count], told[count:]
    marks = style_marks(" ".join(kept)) + sum(w in MANNER for s in removed for w in words(s))
    if removed:
        reasons.append(f"{count} injected sentence{'s' * (count > 1)} removed")
    frames = [s for s in (kept[0], kept[-1]) if len(kept) > 1 and framing(s)] if kept else []
    if frames:
        kept = [s for s in kept if s not in frames] or kept
        reasons.append("framing removed")
    changed = removed or frames
    text = " ".join(kept) if changed else quiet
    text = text[:1].upper() + text[1:] if changed else text
    return Repaired(text, (*removed, *frames), tuple(reasons), marks)


@lru_cache(maxsize=1)
def _route_words() -> frozenset[str]:
    from mitigate.safeguard import routes

    text = " ".join((routes.OPEN, routes.MIDDLE, routes.CLOSE, *routes.ASIDES, *routes.ROOMS,
        *routes.THINGS, *routes.LOOKS, *routes.STAIRS, *routes.DOORS, *routes.PLACES))  # fmt: skip
    plain = re.sub(r"\{\w+\}", " ", text)
    return frozenset(words(plain)) | VERBS | ATTRIBUTES | frozenset(CANONICAL)
