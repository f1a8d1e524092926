"""Split instructions into clauses, each with one command. Words that join clauses are removed."""

from __future__ import annotations

import re
from dataclasses import dataclass

from mitigate.corruptions.language.words import listed

COMMANDS = (
    "walk|go|head|turn|take|make|stop|wait|exit|enter|leave|continue|proceed|move|pass|climb|"
    "descend|ascend|step|keep|stay|stand|cross|follow|veer|bear|face|come|hang|pivot|rotate|"
    "halt|pause|travel|advance|look|find|navigate|approach|reach|traverse|spin|swing|hug|run|"
    "you will|you'll|you should|you are done|you're done|get|start|begin|circle|curve|open|use|"
    "position|locate|end|search"
)
_ADVERBS = r"(?:then|next|now|immediately|finally|again|just|simply|slowly|directly|please|also)"
# maximum number of adverbs before a command (heuristic; people do not use longer sequences)
MOST_ADVERBS = 8
# A match cannot begin in the middle of a run of white space, so matching takes linear time.
_JOIN = (
    r"(?:(?:(?<!\s)\s+)?[,;]\s*(?:and\s+)?|(?<!\s)\s+(?:and|but)\s+"
    r"|(?:(?<!\s)\s+)?(?:,\s*)?(?:and\s+)?\bthen\b(?:\s*,)?\s*)"
)
_SPLIT = re.compile(
    rf"{_JOIN}(?=(?:{_ADVERBS}(?:\s*,)?\s+){{0,{MOST_ADVERBS}}}(?!go back\b)(?:(?:{COMMANDS})\b"
    rf"|(?:in|at|once|when|after|from) (?:the|you|inside) [^,.;]{{1,40}}? (?:{COMMANDS})\b))",
    re.IGNORECASE,
)
_SENTENCE = re.compile(r"(?<=[.!?;])\s+|\n+|(?<=[a-z)])\.(?=[A-Z])")
_LEAD = re.compile(
    r"^(?:(?:and|then|next|now|finally|lastly|first|afterwards|after that|from there|"
    r"once there|next up|so|also|second|secondly|okay|ok|please)\b\s*,?\s*(?!to\b|side\b))+",
    re.IGNORECASE,
)
_BEGINS_CONDITION = re.compile(
    r"(?:once|when|as|after|before|upon|at|in|on|from|with|inside|if|until|while)\b(?! to\b)",
    re.IGNORECASE,
)
_COMMAND = re.compile(rf"(?:{_ADVERBS}\s+)*\b(?:{COMMANDS})\b", re.IGNORECASE)
_NO_COMMAND_AFTER = listed("no_command_after")


@dataclass(frozen=True)
class Clause:
    """One command (``main``) and its condition (``when``), such as "once you reach the bed".

    The condition may be "".
    """

    when: str
    main: str


def clauses(text: str) -> list[Clause]:
    """Return the clauses of ``text`` in order.

    Words that join clauses and final punctuation are removed.
    """
    parsed = []
    for sentence in _SENTENCE.split(text.strip()):
        pending = ""
        for part in _SPLIT.split(_led(sentence)):
            part = (pending + part).strip().rstrip(".!;,").strip()
            pending = ""
            if not part:
                continue
            if _BEGINS_CONDITION.match(part) and _divided(part) is None:  # of the next command
                pending = part + ", "
                continue
            parsed.append(_clause(part))
        if pending:
            parsed.append(_clause(pending.rstrip(", ")))
    return parsed or [Clause("", text.strip())]


def _clause(part: str) -> Clause:
    body = _led(part)
    divided = _divided(body)
    if divided is None:
        return Clause("", body)
    return Clause(divided[0].strip(" ,"), _led(divided[1]))


def _led(text: str) -> str:
    """Return ``text`` without leading words such as "and then", unless nothing would remain."""
    return _LEAD.sub("", text).strip(" ,") or text.strip()


def _divided(body: str) -> tuple[str, str] | None:
    """Split text such as "at the bench, turn left" into (condition, command).

    Return None for other text.
    """
    if not _BEGINS_CONDITION.match(body):
        return None
    for match in _COMMAND.finditer(body):
        before = body[: match.start()].rstrip()
        if match.start() and before.lower().split()[-1].strip(",") not in _NO_COMMAND_AFTER:
            return before, body[match.start() :]
    return None
