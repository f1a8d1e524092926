"""Rewrite instructions with rules in four styles: friendly, novice, professional and formal.

Each clause of an instruction is classified (turn, climb, pass, enter and others) and rewritten with
a template of the style. A clause of an unknown kind keeps its words. Clauses that begin with a verb
are then inserted into phrases of the style, such as "Then {}". The fidelity gate checks each clause
and the whole text. If the gate rejects a text, the instruction is rewritten again with fewer
changes.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.language import phrases
from mitigate.corruptions.language.clauses import Clause, clauses
from mitigate.corruptions.language.fidelity import check
from mitigate.corruptions.language.text import check_text

MANNERS = ("friendly", "novice", "professional", "formal")
TRIES = 3  # maximum number of attempts before the original text is used (heuristic)
Rewrite = Callable[[str, str], str]
Draw = Callable[[Sequence[str]], str]  # makes a random choice


@dataclass(frozen=True)
class Restyled:
    """A rewritten instruction, and what the fidelity gate decided."""

    text: str
    tries: int  # number of rewrites that the gate checked
    passed: bool  # whether a rewrite was accepted; if not, ``text`` is the original
    plain: int  # number of clauses whose words were not replaced by a template
    clauses: int  # number of clauses


def restyle(text: str, manner: str, key: Key, rewrite: Rewrite | None = None) -> Restyled:
    """Rewrite ``text`` in a style and check the result with the fidelity gate.

    The optional function ``rewrite`` (text, style) -> text, such as a language model, is tried
    first. If the gate rejects its answer, rules rewrite the text. Raises ValueError for a text
    without a word.
    """
    check_text(text)
    tries = count = 0
    if rewrite is not None:
        answer = rewrite(text, manner)
        rewritten = answer.strip() if isinstance(answer, str) else ""
        tries = 1
        if rewritten and not check(text, rewritten):
            return Restyled(rewritten, tries, True, 0, 0)
    for attempt in range(TRIES):
        rewritten, plain, count = _speak(text, manner, digest(key, f"{manner}-{attempt}"), attempt)
        tries += 1
        if not check(text, rewritten):
            return Restyled(rewritten, tries, True, plain, count)
    return Restyled(text, tries, False, count, count)


def _speak(text: str, manner: str, stream: int, attempt: int) -> tuple[str, int, int]:
    """Return the rewritten text, the number of unchanged clauses, and the number of all clauses.

    The first attempt uses templates and synonyms. The second uses only templates, and the third
    only frames.
    """
    numbers, voice, parts = itertools.count(1), phrases.VOICES[manner], clauses(text)

    def draw(options: Sequence[str]) -> str:
        return options[int(uniform(stream, next(numbers)) * len(options))]

    sentences, plain, last = [draw(voice.openers)], 0, ""
    for index, clause in enumerate(parts):
        command = _say(clause, voice, draw, attempt)
        plain += command is None
        place = "first" if index == 0 else "last" if index == len(parts) - 1 else "middle"
        if clause.when:
            place, last = "when", ""
        frame = last
        while frame == last:
            frame = draw(voice.frames[place])
        last = frame
        sentences.append(_framed(frame, clause.when, command or clause.main))
    if sentences[0].endswith(","):
        sentences[1] = sentences[1] if sentences[1][:2] == "I " else _lowered(sentences[1])
    return " ".join(part for part in (*sentences, draw(voice.closers)) if part), plain, len(parts)


def _say(clause: Clause, voice: phrases.Voice, draw: Draw, attempt: int) -> str | None:
    """Rewrite the command in the style; return None if it must keep its words."""
    if attempt >= 2:
        return None
    for kind, pattern in phrases.PATTERNS.items():
        match = pattern.match(clause.main)
        if match is None:
            continue
        template = draw(voice.commands[kind])
        slots = {name: value or "" for name, value in match.groupdict().items()}
        command = re.sub(r"\s+", " ", template.format_map(slots)).strip()
        command = re.sub(r"\s+([,.])", r"\1", command)
        if attempt == 0:
            command = phrases.swap_nouns(command, voice.nouns)
        return command if not check(clause.main, command) else None
    return None


def _lowered(text: str) -> str:
    return text[:1].lower() + text[1:]


def _framed(frame: str, when: str, command: str) -> str:
    """Return one sentence; the frame is used only if the command begins with a verb."""
    if not re.match(phrases.BARE_VERB, command, re.IGNORECASE):
        frame = "{}"
    body = command if frame == "{}" else frame.format(_lowered(command))
    if when:
        body = f"{when}, {body if body.startswith('I ') else _lowered(body)}"
    body = body.rstrip(" ,") or command
    return body[0].upper() + body[1:] + ("" if body.endswith((".", "!", "?")) else ".")
