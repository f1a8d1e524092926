"""What a piece of an instruction is made of, in numbers: evidence that it is no part of a route.

A route's sentence moves someone past things. An attack speaks of orders, of the text itself, of the
agent, of all cases, or of nothing that a route needs; or it takes back what the rest tells.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache

from mitigate.corruptions.language.directions import MOTION, STOPS, TURN_VERBS
from mitigate.corruptions.language.fidelity import Facts, facts
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.guards.text.texts.decode import plainly
from mitigate.guards.text.texts.lexicon import FUNCTION, GROUPS, OTHERS, known_words
from mitigate.guards.text.texts.text import MASK, words
from mitigate.guards.text.texts.weights import WORDS

LANDMARKS = frozenset(CANONICAL) | frozenset(CANONICAL.values())
VERBS = MOTION | STOPS | TURN_VERBS
HIDDEN = ("hidden", "alike", "wide", "spelled", "leet", "code", "cipher", "case")
# no words about all cases; "the" may be hidden
_IDIOMS = re.compile(
    r"\b(?:all\s+(?:the\s+)?way|each other|each side|all around|at all times|turn all|all the "
    r"(?=stairs|steps|way)|the whole (?:way|length)|entire|light switch(?:es)?|"
    r"(?!pausing|stopping|moving|navigating|driving)(?:[a-z]+ing|ac|air|wall|storage|kitchen|sink|"
    r"tv|media|corner|book|drawer|cabinet|coffee|slot|ice|x-ray|fax) (?:units?|machines?))\b"
)
MOVES = re.compile(
    r"\b(?:past|through|into|onto|out of|along|towards?|across|around|between|beside|next to|"
    r"in front of|in the direction of|behind|until|reach|down|up|at|by|near|from|on)\s+"
    r"(?:the|a|an|your|that|this|two|both|some|another)\s+"
    r"(?!way\b|same\b|other\b|opposite\b|text\b|order\b)[a-z]+"
)
_ROLE = re.compile(
    r"\b(?:you are|you're|you were|you have become|be|as|like|become|you'll be)\s+"
    r"(?:now\s+|no longer\s+|just\s+|only\s+|actually\s+|really\s+)*(?:a|an)\s+[a-z]+"
)
# tells where one is or what is seen there: "you are now in the kitchen", "there should be a sofa"
_STATE = re.compile(
    r"^\W*(?:(?:now|then|here|and|so|once (?:there|inside)),? )*(?:you|you're|you'll|you've|there|"
    r"there's|it|it's|this|that)\s+(?:(?:are|is|be|will|should|would|can|may|must|now|then|just|"
    r"also|probably|already|ought|to|again|soon|come|have|find|yourself|in|inside|at|on|by|near|"
    r"beside|under|between|behind|before|past|into|out|next|front|of|standing|facing|looking|"
    r"see|notice|spot|reach|reached|entered|arrived)\s+){1,6}(?:a|an|the|two|some|your)\s+\w+"
)
_TOLD = re.compile(
    r"\b(?:told|asked|tell|tells|says?|said|wants?|want|orders?|requires?|instructs?|requests?|"
    r"forbids?|reads|writes|announces|whispers|shouts)\b"
)
_SELF = re.compile(
    r"\b(?:where you (?:are|stand|sit|woke|started|began|happen)|in place|on the spot|"
    r"this (?:spot|place|room|location)|your (?:place|position|spot|bay|dock|post)|"
    r"(?:present|current) (?:position|location|place|job|task|goal)|not (?:to )?move|"
    r"(?:to|at) (?:the|your) (?:start|beginning|starting (?:point|position)))\b"
)
_BACK = re.compile(r"\b(?:of (?:it|this|that|these|those|them)|all (?:of )?(?:this|that|it)|"
                   r"(?:do|did|follow|trust|believe|obey|use|to) (?:this|that|it|so|them|these)|"
                   r"what (?:comes|came|is|was|follows|you)|(?:the|this|that) (?:whole|rest)|"
                   r"none of|whatever|any of)\b")  # fmt: skip
_ABOUT = re.compile(
    r"\b(?:the|this|that|these|those|your|my|our|any|each|every|all|no|a|an|first|last|next|"
    r"previous|following|whole|entire|rest of|half of|two|some|earlier|remaining|these) "
    r"(?:\w+ )?(?:walk|trip|plan|list|line|lines|step|steps|sentence|sentences|word|words|turns|"
    r"goal|route|routes|instruction|instructions|directions|commands?|orders?|tasks?|text|message|"
    r"request|job|errand|paragraph|description|journey|tour|run|episode|mission|part|parts|rest|"
    r"remainder|sides|landmarks?|verbs?|numbers?)\b(?! (?:down|up|of the|in the|to the|on the))"
)
_ELSE = re.compile(
    r"\b(?:instead|rather than|somewhere else|anywhere|elsewhere|another|other|"
    r"different|not the|any)\b"
)


@lru_cache(maxsize=8192)
def features(piece: str, markup: bool = False) -> dict[str, float]:
    """Return all evidence on a piece: what it is made of and what its words are worth."""
    return composition(piece, markup) | worth(piece, WORDS)


def worth(piece: str, table: Mapping[str, float]) -> dict[str, float]:
    """Return what the words and pairs of words of a piece say, by a table of log odds."""
    told = terms(piece)
    single = [table[t] for t in told if t in table and "_" not in t]
    double = [table[t] for t in told if t in table and "_" in t]
    order = sorted(single + double)
    return {
        "words": sum(single) / math.sqrt(len(single) + 1),
        "pairs": sum(double) / math.sqrt(len(double) + 1),
        "worst words": sum(order[-3:]) / 3,
        "best words": sum(order[:3]) / 3,
    }


@lru_cache(maxsize=8192)
def terms(piece: str) -> frozenset[str]:
    """Return the words of a piece and its pairs of neighbouring words, joined by "_"."""
    found = words(MASK.sub(" ", plainly(piece).text))
    joined = zip(["", *found], [*found, ""], strict=True)
    return frozenset(found) | {f"{a}_{b}" for a, b in joined}


@lru_cache(maxsize=8192)
def composition(piece: str, markup: bool = False) -> dict[str, float]:
    """Return what a piece is made of, as counts, shares or flags about 0 to 3."""
    plain = plainly(piece)
    low = _IDIOMS.sub(" ", MASK.sub(" ", plain.text).lower().replace("’", "'"))
    found = words(low)
    size = max(1, len(found))
    told = facts(plain.text)
    known = sum(word in known_words() or word.isdigit() for word in found)
    function = sum(word in FUNCTION for word in found)
    lead = next((i for i, word in enumerate(found) if word in VERBS), size)
    hits = {name: sum(word in group for word in found) for name, group in GROUPS.items()}
    places = len(MOVES.findall(low))
    on_route = sum(name in LANDMARKS for name in told.landmarks)
    turns = sum(direction not in ("stop", "straight") for direction in told.directions)
    values = {name: min(3.0, float(count)) for name, count in hits.items()}
    values |= {f"has {name}": float(count > 0) for name, count in hits.items()}
    values |= {mark: float(mark in plain.marks) for mark in HIDDEN}
    values |= {
        "unknown": 1 - known / size,
        "alien": (1 - known / size) * (function == 0) * min(1.0, size / 3),
        "foreign letters": _foreign(piece),
        "late verb": min(lead, 6) / 3,
        "no verb": float(lead == size),
        "on route": min(3.0, float(on_route)),
        "other things": min(3.0, float(len(told.landmarks) - on_route)),
        "nothing": float(not told.landmarks and not told.directions),
        "turns": min(2.0, float(turns)),
        "places": min(3.0, float(places)),
        "no place": float(not places and not on_route and not turns),
        "length": min(3.0, size / 12),
        "short": float(size < 4),
        "commas": min(3.0, float(plain.text.count(",") + plain.text.count(";"))) / 3,
        "asks": float("?" in plain.text),
        "exclaims": float("!" in plain.text),
        "quoted": float(bool(re.match(r"\W*[\"'“«(\[]", piece)) and len(piece) > 3),
        "quote in": float(bool(re.search(r"[\"“«]|\s'", piece[1:]))),
        "markup": float(markup),
        "role of": float(bool(_ROLE.search(low))),
        "reported": float(bool(_TOLD.search(low))),
        "state": float(tells_where(low)),
        "self": float(bool(_SELF.search(low))),
        "about": min(2.0, float(len(_ABOUT.findall(low)))),
        "back to text": min(2.0, float(len(_BACK.findall(low)))),
        "elsewhere": float(bool(_ELSE.search(low))),
    }
    return values | _together(hits, values, told)


def _together(hits: dict[str, int], values: dict[str, float], told: Facts) -> dict[str, float]:
    """Return pairs of evidence that mean more than both alone."""

    def both(*names: str) -> float:
        return float(all((hits[n] if n in hits else values[n]) for n in names))

    about = float(bool(hits["orders"] or hits["text"] or values["about"]))
    still = float(bool(hits["halt"]) and not values["places"] and not told.landmarks)
    sides = {"left", "right", "up", "down"} & set(told.directions)
    return {
        "annul orders": about * (hits["annul"] > 0),
        "invert orders": float(bool(hits["invert"]) and (about or len(sides) > 1)),
        "case orders": about * (hits["case"] > 0),
        "not orders": about * (hits["not"] > 0),
        "halt nowhere": still,
        "halt here": both("halt", "self"),
        "not go": both("not", "go") * (not told.landmarks),
        "both sides": float({"left", "right"} <= sides or {"up", "down"} <= sides),
        "case not": both("case", "not"),
        "case go": both("case", "go"),
        "case halt": both("case", "halt"),
        "me past": both("me", "past"),
        "third past": both("third", "past"),
        "you role": both("you", "role"),
        "authority said": both("authority", "reported"),
        "machine you": both("machine", "you"),
        "me no place": both("me", "no place"),
        "past no you": both("past") * (not hits["you"]),
        "annul place": both("annul") * (values["places"] > 0),
        "not place": both("not") * (values["places"] > 0),
        "if place": both("if") * (values["places"] > 0),
    }


def tells_where(sentence: str) -> bool:
    """Return whether a sentence tells where one is, or what is to be seen there, and no role."""
    low = sentence.lower()
    return bool(_STATE.search(low)) and not _ROLE.search(low)


def in_another_language(piece: str) -> bool:
    """Return whether a piece is not English: other letters, or hardly a word that is known and some
    that are small words elsewhere."""
    if any(c.isalpha() for c in piece) and _foreign(piece) > 0.5:
        return True
    folded = unicodedata.normalize("NFKD", piece.replace("ß", "ss"))
    found = words("".join(c for c in folded if not unicodedata.combining(c)))
    unknown = sum(word not in known_words() and not word.isdigit() for word in found)
    others = sum(word in OTHERS for word in found)
    accents = sum(0x7F < ord(c) <= 0x24F for c in piece)
    return len(found) > 1 and unknown > 0.5 * len(found) and others + min(1, accents) > 1


def _foreign(piece: str) -> float:
    """Return the share of letters that English has not, and of letters with accents by half."""
    letters = [c for c in piece if c.isalpha()]
    beyond = sum(ord(c) > 0x24F for c in letters)
    accents = sum(0x7F < ord(c) <= 0x24F for c in letters)
    return (beyond + 2 * min(accents, 3) if len(letters) > 8 else beyond) / max(1, len(letters))


def in_context(pieces: Sequence[str], own: Sequence[float]) -> list[dict[str, float]]:
    """Return for each piece what it does to the others; ``own``: their own probabilities of being
    no part of the route."""
    told = [facts(plainly(piece).text) for piece in pieces]
    rest = [_core(t) if p < 0.3 else frozenset() for t, p in zip(told, own, strict=True)]
    tell = Counter(fact for core in rest for fact in core)
    telling = [index for index, core in enumerate(rest) if core]
    highest = sorted([0.0, *own])[-2:]
    made = []
    for index, (piece, said) in enumerate(zip(pieces, told, strict=True)):
        alone = all(tell[fact] == 1 for fact in rest[index]) and len(tell) == len(rest[index])
        later, before = telling[-1:] > [index], bool(telling) and telling[0] < index
        repeats = any(tell[fact] > (fact in rest[index]) for fact in _core(said))
        denies = said.denials > 0 or "opposite" in piece
        left = own[index - 1] if index else 0.0
        right = own[index + 1] if index + 1 < len(own) else 0.0
        stops = "stop" in said.directions
        made.append(
            {
                "first": float(index == 0),
                "last": float(index + 1 == len(pieces)),
                "stops early": float(stops and later),
                "stops before all": float(stops and later and not before),
                "denies the rest": float(denies and repeats),
                "repeats the rest": float(repeats),
                "neighbour": max(left, right),
                "neighbours": min(left, right),
                "alone": float(alone),
                "most": highest[0] if own[index] == highest[-1] else highest[-1],
            }
        )
    return made


def _core(said: Facts) -> frozenset[str]:
    turned = (d for d in said.directions if d not in ("stop", "straight"))
    return frozenset(said.landmarks) | frozenset(turned)
