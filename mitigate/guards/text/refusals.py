"""Why a language model's answer may not stand for a passage."""

from __future__ import annotations

import re
from collections import Counter

from mitigate.corruptions.language.fidelity import ATTRIBUTES, facts
from mitigate.corruptions.language.tagger import tag
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.fidelity.goal_words import SAYINGS
from mitigate.guards.text.fidelity.wording import in_equal_words
from mitigate.guards.text.foreign import masks
from mitigate.guards.text.plain.plainly_said import Said
from mitigate.guards.text.texts.evidence import VERBS
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.steps import HALTS, MOVES, SEEKS
from mitigate.guards.text.texts.text import MASK, words

_CONDITIONS = bag("if unless until till before otherwise")
_WHICH = bag("first second third fourth fifth sixth seventh eighth ninth tenth last other another")
# what plain routes say of whatever was heard
_PLAIN = frozenset(VERBS | MOVES | HALTS | SEEKS) | bag(
    "be is are do have keep face start begin reach use see along front end way side again straight"
)
# what people say, and plain routes in other words; a little is no size, a little chapel has one
_IN_OTHER_WORDS = tuple(
    (re.compile(rf"\b(?:{pattern})\b", re.IGNORECASE), said)
    for pattern, said in (
        (r"(?<!\ba )little(?! (?:bit|way|further|more|to|left|right)\b)(?= [a-z])", "small"),
        (r"turn (?:you|yourself)(?: about| around| round)?|turn about", "turn around"),
        (r"descend(?:s|ed|ing)", "go down the stairs"),
        (r"ascend(?:s|ed|ing)", "go up the stairs"),
    )
)
_POLITE_IF = re.compile(
    r"\bif (?:\w+ )?(?:would|will|could|can|might|may) (?:\w+ )?be (?:so|as) \w+ as to\b|"
    r"\b(?:obliged|grateful|thankful|delighted|glad|pleased|happy|kind|appreciate it) if\b"
)
_STEM = 4  # letters in which a word and what was heard agree: surplices, surplice (ours)


def refusal(part: Said, answer: str | None, last: bool = False, spoken: bool = False) -> str:
    """Return why ``answer`` may not stand for ``part``, the ``last`` of its text or another; empty
    if it may. What a tagger takes for speech (``spoken``) passes as its edits do."""
    if answer is None:
        return "no answer in time"
    if MASK.search(part.heard):
        return _refused_filling(part.heard, answer)
    if len(words(answer)) > len(words(part.heard)) + 3:
        return "longer than what it replaces"
    if not spoken:
        problem = gate.rewrite_refused(part.heard, answer, last) or _plainer(part.heard, answer)
    elif part.said and not answer:
        problem = "the tagger would keep some of it"
    else:
        heard = _in_plain_words(part.heard)
        heard = gate.stopped(heard, answer) if last else heard
        problem = gate.edit_refused(heard, answer, part.aside) or _which(part, answer)
    return problem or _conditions(part.heard, answer) or _invented(part.heard, answer)


def _in_plain_words(heard: str) -> str:
    """Return ``heard`` with what plain routes say in the words that the gate reads."""
    for pattern, said in _IN_OTHER_WORDS:
        heard = pattern.sub(said, heard)
    return heard


def _conditions(heard: str, said: str) -> str:
    """Return a condition that ``heard`` makes and ``said`` does not, politeness aside."""
    old = Counter(words(_POLITE_IF.sub(" ", SAYINGS.sub(" ", heard.lower()))))
    lost = [w for w in sorted(_CONDITIONS) if old[w] > Counter(words(said))[w]]
    return f"condition lost: {', '.join(lost)}" if lost else ""


def _which(part: Said, said: str) -> str:
    """Return what ``part`` tells of which one is meant and ``said`` does not."""
    old, new = Counter(words(part.heard)), Counter(words(said))
    lost = [w for w in sorted(_WHICH - set(part.aside)) if old[w] > new[w]]
    return f"which one lost: {', '.join(lost)}" if lost else ""


def _invented(heard: str, said: str) -> str:
    """Return a word of ``said`` that says something and of which nothing was heard."""
    known = {*words(heard), *words(in_equal_words(heard.lower()))}
    known |= {plain_form(word) for word in known}
    stems = {word[:_STEM] for word in known}
    for token in tag(said):
        word, tells = token.lower, token.tag in ("NOUN", "PROPN", "ADJ", "NUM", "VERB")
        if tells and word[:_STEM] not in stems and not {word, plain_form(word)} & (_PLAIN | known):
            return f"invented: {word}"
    return ""


def _plainer(heard: str, said: str) -> str:
    """Return what of a thing ``heard`` tells and ``said`` does not: small, open, wooden ..."""
    old, new = ({plain_form(word) for word in words(text)} & ATTRIBUTES for text in (heard, said))
    lost = old - new
    return f"attributes: {', '.join(sorted(lost))} less" if lost else ""


def _refused_filling(passage: str, answer: str) -> str:
    """Return why ``answer`` may not fill the masks of ``passage``: only small words are hidden, so
    what stands for one must not say where to go, what is there or what it is like."""
    found = masks.filled(passage, answer)
    if found is None:
        return "other words than the masks changed"
    said = facts(", ".join(word for word in found if word))
    added = (*said.landmarks, *said.numbers, *said.compass, *said.attributes)
    if added:
        return f"invented: {', '.join(added)}"
    if said.denials or facts(answer).directions != facts(masks.fill(passage)).directions:
        return "directions changed by a hidden word"
    return ""
