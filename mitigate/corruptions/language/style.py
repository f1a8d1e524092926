"""Four manners of speaking: friendly, novice, professional, formal; offline and by rule.

Every clause of an instruction is recognised (turn, climb, pass, enter ...) and said again in the
words of the manner; a clause that is not understood keeps its words inside a frame of the manner.
The fidelity gate looks at each clause and at the whole, and what it refuses is said more plainly.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.language import phrases
from mitigate.corruptions.language.clauses import Clause, clauses
from mitigate.corruptions.language.fidelity import check
from mitigate.corruptions.language.text import check_text

MANNERS = ("friendly", "novice", "professional", "formal")
TRIES = 3  # rewrites of one instruction before the original is kept (ours)
Rewrite = Callable[[str, str], str]


@dataclass(frozen=True)
class Restyled:
    """A rewritten instruction: ``text``, what the gate refused on the way, and the outcome.

    ``tries``: rewrites the gate looked at. ``passed``: False if all were refused and ``text`` is
    the original. ``plain``: how many of the ``clauses`` kept their words, because no
    template fits them or the gate refused what it gave.
    """

    text: str
    tries: int
    passed: bool
    plain: int
    clauses: int
    refused: tuple[str, ...]


def restyle(text: str, manner: str, key: Key, rewrite: Rewrite | None = None) -> Restyled:
    """Say ``text`` in a manner, and return it with what the fidelity gate found.

    ``rewrite`` (text, manner) -> text asks a language model instead; what the gate refuses is
    replaced by the rewrite by rule. Raises ValueError for a text without a word.
    """
    check_text(text)
    refused: list[str] = []
    tries = count = 0
    if rewrite is not None:
        answer = rewrite(text, manner)
        spoken = answer.strip() if isinstance(answer, str) else ""
        tries, problems = 1, check(text, spoken) if spoken else ["empty answer"]
        if not problems:
            return Restyled(spoken, tries, True, 0, 0, ())
        refused += problems
    for attempt in range(TRIES):
        spoken, plain, count = _speak(text, manner, digest(key, f"{manner}-{attempt}"), attempt)
        tries += 1
        problems = check(text, spoken)
        if not problems:
            return Restyled(spoken, tries, True, plain, count, tuple(refused))
        refused += problems
    return Restyled(text, tries, False, count, count, tuple(refused))


class _Draw:
    """Choices of one stream, in the order in which they are made."""

    def __init__(self, stream: int) -> None:
        self._stream, self._count = stream, 0

    def __call__(self, options: tuple[str, ...]) -> str:
        self._count += 1
        return options[int(uniform(self._stream, self._count) * len(options))]


def _speak(text: str, manner: str, stream: int, attempt: int) -> tuple[str, int, int]:
    """Return ``text`` in a manner, how many clauses kept their words, and of how many.

    The first attempt uses templates and synonyms, the second templates, the third frames alone.
    """
    draw, voice = _Draw(stream), phrases.VOICES[manner]
    parts = clauses(text)
    sentences, plain, last = [draw(voice.openers)], 0, ""
    for index, clause in enumerate(parts):
        said = _say(clause, voice, draw, attempt)
        plain += said is None
        place = "first" if index == 0 else "last" if index == len(parts) - 1 else "middle"
        if clause.when:
            place, last = "when", ""
        frame = last
        while frame == last:
            frame = draw(voice.frames[place])
        last = frame
        sentences.append(_framed(frame, clause.when, said or clause.main))
    if sentences[0].endswith(","):
        sentences[1] = sentences[1] if sentences[1][:2] == "I " else _lowered(sentences[1])
    return " ".join(part for part in (*sentences, draw(voice.closers)) if part), plain, len(parts)


def _say(clause: Clause, voice: phrases.Voice, draw: _Draw, attempt: int) -> str | None:
    """Return the command of ``clause`` in the words of ``voice``, None to keep its own."""
    if attempt >= 2:
        return None
    for kind, pattern in phrases.PATTERNS.items():
        match = pattern.match(clause.main)
        if match is None:
            continue
        template = draw(voice.commands[kind])
        slots = {name: value or "" for name, value in match.groupdict().items()}
        said = re.sub(r"\s+", " ", template.format_map(slots)).strip()
        said = re.sub(r"\s+([,.])", r"\1", said)
        if attempt == 0:
            said = phrases.swap_nouns(said, voice.nouns)
        return said if not check(clause.main, said) else None
    return None


def _lowered(text: str) -> str:
    return text[:1].lower() + text[1:]


def _framed(frame: str, when: str, said: str) -> str:
    """Return one sentence; a command that does not begin with a verb is not put after "to"."""
    if not re.match(phrases.BARE_VERB, said, re.IGNORECASE):
        frame = "{}"
    body = said if frame == "{}" else frame.format(_lowered(said))
    if when:
        body = f"{when}, {body if body.startswith('I ') else _lowered(body)}"
    body = body.rstrip(" ,") or said
    return body[0].upper() + body[1:] + ("" if body.endswith((".", "!", "?")) else ".")
