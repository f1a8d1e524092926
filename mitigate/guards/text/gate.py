"""Check that a changed instruction keeps the meaning of the original.

Each check returns the reason to reject a change, or "" to accept it. A deletion removes whole
clauses and does not reword the rest, so the only check is that an instruction remains. A rewrite
must contain the same landmarks, numbers, colours, relations and negations, and the same turns and
stops in the same order.
"""

from __future__ import annotations

import re
from collections import Counter

from mitigate.corruptions.language.fidelity import check, facts
from mitigate.corruptions.language.words import CANONICAL, bag
from mitigate.guards.text.learning.routes import WORDS

_PLACES = bag(" ".join(WORDS["things"] + WORDS["rooms"]))
KNOWN = frozenset(CANONICAL) | frozenset(CANONICAL.values()) | _PLACES
LONG_TEXT = 3000  # texts with more characters are assumed to contain an instruction
# a rewrite with at most this many characters is never too long to be checked (heuristic)
SHORT_REWRITE = 200
# maximum ratio of the length of a longer rewrite to the length of the original (heuristic)
LENGTH_RATIO = 4
EXTRA_WORDS = 3  # a rewrite may have at most this many more words than the original
_CONDITIONS = bag("if unless until till before after otherwise once except instead")
_WORD = re.compile(r"\[mask\]|[a-z]+(?:['’][a-z]+)?|\d+")
_POLITE = re.compile(
    r"\bif (?:you|it|that|i)\b[^,.;]{0,40}"
    r"\b(?:mind|please|would|could|can|may|might|like|kind|ask)\b"
    r"|\b(?:grateful|glad|obliged|kind|delighted|appreciate it) (?:if|enough)\b|\bonce more\b"
    r"|\bbefore (?:too long|i forget|you know it)\b"
)
# "pass into a room", which the suite's styles write as "past into", means "enter a room"
_ENTER = re.compile(r"\bpass(?:ing|es)? into\b|\bpast into\b", re.IGNORECASE)
_LEAVE = re.compile(r"\b(?:exit|egress|depart)(?:s|ing)?\b|\bleav(?:e|es|ing)\b")
# "after this, turn left" means "then turn left"; "after this door" is a condition
_NEXT = re.compile(
    r"\bafter (?:this|that|which|doing so)"
    r"(?=,|;| (?:you|we|please|kindly|just|simply)\b)"
)


def words(text: str) -> list[str]:
    """Return the words of a text in lower case; "[mask]" is one word."""
    return _WORD.findall(text.lower())


def leaves_no_instruction(text: str, removed: str, rest: str) -> str:
    """Return the reason why ``rest`` is no longer an instruction, or "" if it is one.

    ``rest`` is the text that remains after the piece ``removed`` was deleted.
    """
    if len(words(rest)) < 2 and rest.isascii():
        return "nothing would be left"
    if not rest.isascii() or len(rest) > LONG_TEXT:
        return ""
    left = facts(rest)
    turns = [d for d in left.directions if d != "stop"]
    if not (left.landmarks or turns or left.relations) and facts(removed).landmarks:
        return "what is left names no place and no turn"
    return ""


def max_length(original: str) -> int:
    """Return the maximum number of characters of a rewrite; a longer one is not checked."""
    return max(SHORT_REWRITE, LENGTH_RATIO * len(original))


def rewrite_refused(original: str, rewrite: str | None, last: bool = False) -> str:
    """Return the reason why ``rewrite`` must not replace ``original``, or "" if it may.

    If ``last`` is true, ``original`` is the end of an instruction, and ``rewrite`` may add "stop".
    """
    if rewrite is None:
        return "no answer in time"
    if len(rewrite) > max_length(original):
        return "longer than what it replaces"
    if len(words(rewrite)) > len(words(original)) + EXTRA_WORDS:
        return "longer than what it replaces"
    plain = _ENTER.sub("into", original.replace("[MASK]", "the"))
    rewrite = _ENTER.sub("into", rewrite)
    if last and "stop" in facts(rewrite).directions and "stop" not in facts(plain).directions:
        plain = f"{plain.rstrip(' .!?;,')}, and stop."
    problems = [p for p in check(plain, rewrite) if not _is_harmless(p, plain)]
    if problems:
        return problems[0]
    before = Counter(words(_NEXT.sub(" ", _POLITE.sub(" ", plain.lower()))))
    lost = [word for word in sorted(_CONDITIONS) if before[word] > Counter(words(rewrite))[word]]
    return f"condition lost: {', '.join(lost)}" if lost else ""


def _is_harmless(problem: str, original: str) -> bool:
    """Return whether ``problem`` does not change the meaning.

    A lost word is probably not a landmark if it is unknown and no article precedes it. Verbs such
    as "exit" imply "out".
    """
    if problem == "relation invented: out":
        return bool(_LEAVE.search(original.lower()))
    kind, _, name = problem.partition(": ")
    if kind != "landmark lost" or name in KNOWN:
        return False
    return not re.search(
        rf"\b(?:the|an?|this|that|your) (?:\w+ )?{re.escape(name)}", original.lower()
    )
