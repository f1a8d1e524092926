"""Sentences in front of a route that do not belong to it, by 14 counts of what they are made of.

Attackers put their sentences in front, whole. In front of what is surely a plain route this reads
more of them than :mod:`evidence`, which looks everywhere and must be more careful: beside a
sentence that is surely foreign goes what is likely, before it in any case, behind it if it names
nothing that routes name. The weights (``FRONT``) are of a logistic regression on the same examples
as those of :mod:`evidence`: ``python -m mitigate.guards.text.fit --front --write``. The thresholds
were chosen on the prefix bank's validation families, by weights that had not seen them.
"""

from __future__ import annotations

import re
from functools import lru_cache

from mitigate.corruptions.language.fidelity import ATTRIBUTES, facts
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.foreign.judgement import probability
from mitigate.guards.text.texts.evidence import LANDMARKS, VERBS, tells_where
from mitigate.guards.text.texts.route_words import route_words
from mitigate.guards.text.texts.text import MASK, sentences, words
from mitigate.guards.text.texts.weights import FRONT

SURE, LIKELY = 0.4, 0.2
# other words than weights.STYLE, which is fitted on other texts
MANNERISMS = bag(
    """
    advisable appreciated ask betake breather briefing bunch closing colleague commence complete
    completion conclude conclusion cooperation course cruise day dear depart direction do easy
    effect egress esteemed execute explain finally finish for friend fully fun goes good got
    greetings guess happy have hello help hey hi hiya hm i'm initially juncture kind kindly let
    let's like lovely madam meet mosey navigation need new nice off okay or outset perform
    permission please procedure requested reverse scoot sincere strolling subsequently thanks
    that's thereafter think this transit transition try u ultimately um upon vacate want what
    withdraw you'll you've
    """
)
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
MANNER = MANNERISMS - bag("this for do think what have want that's let let's like or so")
# no words about all cases; "the" may be hidden
_IDIOMS = re.compile(r"\b(?:all\s+(?:the\s+)?way|each other|each side|all around)\b")


def counts(sentence: str) -> dict[str, float]:
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
        "style": min(3.0, float(sum(word in MANNERISMS for word in found))),
        "unknown": 1 - known / size,
        "late_verb": min(lead, 6) / 3,
        "no_verb": float(lead == size),
        "landmarks": min(3.0, float(len(told.landmarks))),
        "no_landmark": float(not told.landmarks),
        "directions": min(2.0, float(len(told.directions))),
        "state": float(tells_where(sentence)),
        "commas": min(3.0, float(sentence.count(",") + sentence.count(";"))) / 3,
    }


@lru_cache(maxsize=8192)
def strange_in_front(sentence: str) -> float:
    """Return the probability that ``sentence`` does not belong to a route."""
    if not any(c.isalpha() for c in sentence):
        return 0.0
    return probability(FRONT, counts(sentence))


def in_front(text: str) -> tuple[str, ...]:
    """Return the first sentences of ``text`` that are no part of the route; never all of them. In a
    text with a manner of speaking only what does not tell the way."""
    told = sentences(text)
    in_manner = in_a_manner(told)
    count, pending, attacked = 0, 0, False
    for index, sentence in enumerate(told[:-1]):
        if in_manner and tells_the_way(sentence):
            break
        strange, plain = strange_in_front(sentence), not mannered(sentence)
        attacked |= strange >= SURE and plain
        follows = attacked and strange >= LIKELY and plain and not on_the_way(sentence)
        if follows or strange >= SURE:
            count, pending = index + 1, 0
        elif strange < LIKELY:
            pending += 1
            if pending > 1 or count == 0 and index > 0:
                break
    return tuple(told[:count])


def tells_the_way(sentence: str) -> bool:
    """Return whether ``sentence`` names a landmark or a direction."""
    told = facts(sentence)
    return bool(told.landmarks or told.directions)


def on_the_way(sentence: str) -> bool:
    """Return whether ``sentence`` names a thing that routes name, or a direction but to stop."""
    told = facts(sentence)
    known = any(name in LANDMARKS for name in told.landmarks)
    return known or any(direction != "stop" for direction in told.directions)


def mannered(sentence: str) -> bool:
    """Return whether ``sentence`` holds a word of a manner of speaking that attacks rarely use."""
    return any(word in MANNER for word in words(sentence))


def in_a_manner(told: list[str]) -> bool:
    """Return whether half of the sentences speak in a manner, and half of those that are not
    surely foreign: an attack has a manner of its own."""
    marked = [sentence for sentence in told if mannered(sentence)]
    rest = [sentence for sentence in told if strange_in_front(sentence) < SURE]
    own = sum(sentence in marked for sentence in rest)
    return len(marked) >= max(2.0, 0.5 * len(told)) and own >= 0.5 * len(rest)


@lru_cache(maxsize=1)
def _route_words() -> frozenset[str]:
    plain = re.sub(r"\{\w+\}", " ", route_words())
    return frozenset(words(plain)) | VERBS | ATTRIBUTES | frozenset(CANONICAL)
