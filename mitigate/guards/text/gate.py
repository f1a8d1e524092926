"""Check that a rewritten instruction keeps the meaning of the original. Each function returns the
reason to reject a change, or "".

A deletion removes whole pieces and keeps the wording of the others, so only the completeness of the
remaining text is checked. A rewrite is checked fact by fact: turns, stops, landmarks, numbers,
colours, relations and negations, in order.
"""

from __future__ import annotations

import re
from collections import Counter

from mitigate.corruptions.language.fidelity import check, facts
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.learning.route_words import ROOMS, THINGS

KNOWN = frozenset(CANONICAL) | frozenset(CANONICAL.values()) | bag(" ".join((*THINGS, *ROOMS)))
LONG = 3000  # a text with this many characters contains an instruction
LENGTH = 200  # number of characters that every rewrite may have (heuristic)
TIMES = 4  # maximum length of a longer rewrite, as a multiple of the original's length (heuristic)
LONGER = 3  # maximum number of words by which a rewrite may exceed the text that it replaces
_CONDITIONS = bag("if unless until till before after otherwise once except instead")
_WORD = re.compile(r"\[mask\]|[a-z]+(?:['’][a-z]+)?|\d+")
_POLITE = re.compile(
    r"\bif (?:you|it|that|i)\b[^,.;]{0,40}"
    r"\b(?:mind|please|would|could|can|may|might|like|kind|ask)\b"
    r"|\b(?:grateful|glad|obliged|kind|delighted|appreciate it) (?:if|enough)\b|\bonce more\b"
    r"|\bbefore (?:you|too long|i forget)\b(?= (?:go|start|know))"
)


def words(text: str) -> list[str]:
    """Return the words of a text in lower case; a mask is one word, "[mask]"."""
    return _WORD.findall(text.lower())


def leaves_no_instruction(text: str, removed: str, rest: str) -> str:
    """Return the reason why ``rest``, the text without ``removed``, is not an instruction, or
    "".
    """
    if len(words(rest)) < 2 and rest.isascii():
        return "nothing would be left"
    if not rest.isascii() or len(rest) > LONG:
        return ""
    left = facts(rest)
    turns = [d for d in left.directions if d != "stop"]
    if not (left.landmarks or turns or left.relations) and facts(removed).landmarks:
        return "what is left names no place and no turn"
    return ""


def is_too_long(heard: str, rewrite: str) -> bool:
    """Return whether a rewrite is so long that it is not checked."""
    return len(rewrite) > max(LENGTH, TIMES * len(heard))


def rewrite_refused(heard: str, rewrite: str | None, last: bool = False) -> str:
    """Return the reason why ``said`` must not replace ``heard``, or "" if it may.

    If ``last`` is true, ``said`` may add a stop.
    """
    if rewrite is None:
        return "no answer in time"
    if is_too_long(heard, rewrite) or len(words(rewrite)) > len(words(heard)) + LONGER:
        return "longer than what it replaces"
    plain = heard.replace("[MASK]", "the")
    if last and "stop" in facts(rewrite).directions and "stop" not in facts(plain).directions:
        plain = f"{plain.rstrip(' .!?;,')}, and stop."
    problems = [p for p in check(plain, rewrite) if not _is_aside(p, plain)]
    if problems:
        return problems[0]
    before = Counter(words(_POLITE.sub(" ", plain.lower())))
    lost = [word for word in sorted(_CONDITIONS) if before[word] > Counter(words(rewrite))[word]]
    return f"condition lost: {', '.join(lost)}" if lost else ""


def _is_aside(problem: str, heard: str) -> bool:
    """Return whether a lost word is not a landmark: it is unknown and has no article before it."""
    kind, _, name = problem.partition(": ")
    if kind != "landmark lost" or name in KNOWN:
        return False
    return not re.search(rf"\b(?:the|an?|this|that|your) (?:\w+ )?{re.escape(name)}", heard.lower())
