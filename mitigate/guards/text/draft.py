"""One instruction on its way through the safeguard: rules, a network that says it plainly,
a language model; what each did and could not do."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mitigate.guards.text import rules
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.foreign import masks
from mitigate.guards.text.foreign.formatting import unformatted
from mitigate.guards.text.foreign.judgement import judged
from mitigate.guards.text.plain.manners import plainer, restyled
from mitigate.guards.text.plain.object_goal import object_goal
from mitigate.guards.text.plain.plainly_said import (
    Said,
    Tags,
    is_speech,
    judging,
    plainly_said,
    together,
)
from mitigate.guards.text.refusals import refusal
from mitigate.guards.text.texts.decode import plainly
from mitigate.guards.text.texts.pieces import sections, sentence_pieces
from mitigate.guards.text.texts.text import MASK, sentences, tidy, words

MARKS = 2  # style words from which a text counts as restyled; one occurs in plain text (ours)
PASSAGE = 12  # words rewritten at once, about a sentence; of 30 the model lost clauses
# words, marks, characters and sentences from which a text is read in sections:
# time grows with their square (ours)
ENDLESS, MARKED, LONG, MANY = 2_000, 1_000, 20_000, 300
SECTION, READ = 2_000, 60_000  # characters of a section, and of the text that is read (ours)
TOO_LONG = 600  # words; a longer text gets the rules alone (ours; RxR's longest have about 500)
_OTHER = re.compile(r"[^\W\d_\u0000-\u024f]+")  # words in letters that English has not


@dataclass(frozen=True)
class Decision:
    """What became of one instruction.

    ``route``: "clean" (all was read, and stays as it was), "rules", "tagger" (said in plain words
    by it), "model", or "fallback" (the model was asked, and none of its answers was safe).
    ``reasons``: what was done and refused, in words. ``seconds``: its share of the time.
    """

    original: str
    text: str
    route: str
    reasons: tuple[str, ...]
    seconds: float


class Draft:
    """One instruction on its way: what the rules made of it, its passages, the reasons so far."""

    def __init__(self, original: str, tagger: Tags | None = None) -> None:
        self.original, self.tagger = original, tagger
        self.heard = unformatted(original)
        self.tidied = tidy(self.heard)
        length = len(words(self.tidied))
        marks = sum(not sign.isalnum() and not sign.isspace() for sign in self.tidied)
        self.endless = length > ENDLESS or marks > MARKED or len(self.heard) > LONG
        self.endless |= len(sentence_pieces(self.heard[:LONG])) > MANY
        short = length <= TOO_LONG
        self.judge = tagger if short else None  # reads the text as it is heard
        self.reasons: list[str] = []
        self.asked = self.taken = 0
        self.readable = _readable(self.tidied)
        self.plain = not self.readable or (
            not self.endless
            and _untouched(self.heard, self.judge)
            and not self._spoken()
            and object_goal(self.tidied) is None
        )
        self.doubtful: list[str] = []
        if not (self.plain or self.endless):
            heard = rules.lower_capitals(self.heard)
            self.doubtful = rules.doubtful(heard, judging(self.judge, heard))
        self.repair(set())

    def _spoken(self) -> bool:
        """Return whether the tagger takes the text for speech."""
        return self.judge is not None and is_speech(self.judge.tag(self.tidied))

    def repair(self, empty: set[str]) -> None:
        """Apply the rules; ``empty`` are doubtful sentences that the model would leave out."""
        self.spoken = self.tagged = self.styled = self.unread = False
        self.passages: list[Said] = []
        if self.plain:
            self.repaired, self.same = self.heard, True
            self.reasons = [] if self.readable else ["nothing readable in English"]
            return
        if self.endless:
            self._repair_sections()
            return
        done = rules.repair(self.heard, empty.__contains__, self.judge)
        self.same = done.text == self.heard
        self.repaired, self.reasons = tidy(done.text), list(done.reasons)
        self.styled = done.marks >= MARKS
        if len(words(self.repaired)) > TOO_LONG:
            self.reasons.append(f"over {TOO_LONG} words: rules alone")
            return
        if not self._say_goal():
            self._say_orders()
            parts = self._say_speech() or [Said(part, part) for part in sentences(self.repaired)]
            self.passages = _passages(parts)

    def _repair_sections(self) -> None:
        """Apply the rules to one section of the text after the other, and to none behind READ."""
        self.unread = len(self.heard) > READ
        read = sections(self.heard[:READ], SECTION)
        done = rules.repaired_sections(read)
        self.same = done == read
        said = "".join(
            old if old == new else f"{tidy(new)} " for old, new in zip(read, done, strict=True)
        )
        self.repaired, self.reasons = said + self.heard[READ:], ["read in sections, by the rules"]
        if self.unread:
            self.reasons.append(f"what is behind {READ:,} characters left as it is")

    def _say_goal(self) -> bool:
        """Say a request for one thing in plain words; return whether it was one."""
        goal = object_goal(self.repaired, self.styled)
        if goal is None:
            return False
        self.reasons.append("a request for one thing, said in plain words")
        self.repaired, self.same = goal, False
        return True

    def _say_orders(self) -> None:
        """Say orders of a manner of speaking in plain words."""
        if not (self.styled or restyled(self.repaired)):
            return
        plain = plainer(self.repaired)
        if plain != self.repaired:
            self.reasons.append("orders said in plain words")
            self.repaired, self.same = plain, False

    def _say_speech(self) -> list[Said]:
        """Let the tagger say speech in plain words; return its sentences, none of what is no
        speech."""
        tagged = self.tagger.tag(self.repaired) if self.tagger else None
        if tagged is None or not is_speech(tagged):
            return []
        self.spoken = True
        parts, kept = plainly_said(self.repaired, tagged)
        self.reasons += kept
        self.tagged = any(part.said != part.heard for part in parts)
        if self.tagged:
            self.reasons.append("said in plain words by the tagger")
            self.repaired, self.same = together(parts), False
        return parts

    @property
    def wanted(self) -> list[str]:
        """The passages that the model is to say again, as they were heard."""
        found = [part.heard for part in self.passages]
        return found if self.styled or self.spoken else [p for p in found if MASK.search(p)]

    def take(self, said: dict[str, str | None]) -> None:
        """Put safe answers in the place of their passages."""
        wanted = set(self.wanted)
        for index, part in enumerate(self.passages):
            if part.heard not in wanted:
                continue
            self.asked += 1
            answer, last = said.get(part.heard), index == len(self.passages) - 1
            problem = refusal(part, answer, last, self.spoken)
            if problem:
                self.reasons.append(f"kept {part.heard[:40]!r}: {problem}")
            else:
                self.passages[index] = replace(part, said=answer or "")
                self.taken += 1

    def decision(self, seconds: float) -> Decision:
        text = self.heard if self.same else self.repaired
        if self.heard != self.original:
            self.reasons.append("marks of how words look taken off")
        if self.taken:
            text = self._said(text)
        if not self.plain and MASK.search(text):
            text = masks.fill(text)
            self.reasons.append("masks filled by rule")
        if text != self.original and not self.reasons:
            self.reasons.append("said again by the model" if self.taken else "characters tidied")
        done = "tagger" if self.tagged else "rules"
        route = "model" if self.taken else "fallback" if self.asked else done
        if text == self.original and not (self.asked or self.unread):
            route = "clean"
        return Decision(self.original, text, route, tuple(self.reasons), seconds)

    def _said(self, text: str) -> str:
        """Return the model's answers and the other passages, or ``text`` if the whole is unsafe."""
        heard, said = " ".join(part.heard for part in self.passages), together(self.passages)
        problem = gate.result_refused(heard, said)
        problem = problem or (gate.goal_refused(heard, said) if self.spoken else "")
        if problem:
            self.taken = 0
            self.reasons.append(f"kept all: {problem}")
            return text
        return said


def _passages(parts: Sequence[Said]) -> list[Said]:
    """Return ``parts`` in passages of about ``PASSAGE`` words as heard, at most."""
    found: list[Said] = []
    for part in parts:
        last = found[-1] if found else None
        if last and len(last.heard.split()) + len(part.heard.split()) <= PASSAGE:
            found[-1] = Said(
                f"{last.heard} {part.heard}", together([last, part]), last.aside + part.aside
            )
        else:
            found.append(part)
    return found


def _readable(text: str) -> bool:
    """Return whether there are words, mostly in Latin letters or in letters that stand for them;
    of other texts, whose other half cannot be judged, whether their English holds an attack."""
    letters = [c for c in text if c.isalpha()]
    if not letters or _latin(letters):
        return bool(letters)
    for part in sections(text[:READ], SECTION):
        plain = plainly(part)
        english = _OTHER.sub(" ", plain.text)
        if plain.marks and _latin([c for c in plain.text if c.isalpha()]):
            return True
        if any(one.own >= gate.ATTACK for one in judged(english)):
            return True
    return False


def _latin(letters: Sequence[str]) -> bool:
    return sum(c.isascii() for c in letters) > 0.5 * len(letters)


def _untouched(text: str, tagger: Tags | None) -> bool:
    """Return whether ``text`` shows no mark of any corruption."""
    return (
        not MASK.search(text)
        and rules.lower_capitals(text) == text
        and not _restyled(text)
        and not rules.doubtful(text, judging(tagger, text))
        and rules.repair(text, tags=tagger).text == text
    )


def _restyled(text: str) -> bool:
    """Return whether ``text`` shows marks or sayings of a manner of speaking."""
    return rules.style_marks(text) >= MARKS or restyled(text)
