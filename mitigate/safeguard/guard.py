"""The safeguard in front of an agent: repairs an instruction once, and never makes it worse.

What looks plain passes untouched. Rules take out what is surely no part of a route; a language
model, if there is one, says the rest again, passage by passage, and each answer is taken only if
directions and landmarks survive and nothing new appears. Otherwise the passage stays as it was.
"""

from __future__ import annotations

import json
import os
import re
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

from mitigate.core.files import find
from mitigate.core.names import unknown
from mitigate.safeguard import gate, masks, rules
from mitigate.safeguard.addresses import check_choice
from mitigate.safeguard.plainly_said import Tags, is_speech, judging, plainly_said
from mitigate.safeguard.refusals import refusal
from mitigate.safeguard.text import MASK, passages, tidy, words

MARKS = 2  # style words from which a text counts as restyled; one occurs in plain text (ours)
PASSAGE = 12  # words rewritten at once, about a sentence; of 30 the model lost clauses
TOO_LONG = 600  # words; a longer text gets the rules alone (ours; RxR's longest have about 500)
CHOICES = ("none", "rules", "tagger", "reader", "prompted", "lora", "tagger+lora", "reader+lora",
    "http://host/v1@model")  # fmt: skip
ADAPTER, CACHE = "checkpoints/safeguard", "runs/endpoint-answers.sqlite"
TAGGERS = {"tagger": "checkpoints/safeguard_tagger", "reader": "checkpoints/safeguard_reader"}
ENDPOINT_SECONDS = 120.0
SECONDS = 20.0  # for the language model, each instruction (ours)


class Rewriter(Protocol):
    """A language model, local or behind an endpoint."""

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]: ...


@dataclass(frozen=True)
class Decision:
    """What became of one instruction.

    ``route``: "clean" (untouched), "rules", "tagger" (said in plain words by it), "model", or
    "fallback" (the model was asked, and none of its answers was safe). ``reasons``: what was done
    and refused, in words. ``seconds``: its share of the time.
    """

    original: str
    text: str
    route: str
    reasons: tuple[str, ...]
    seconds: float


class Safeguard:
    """Turns corrupted instructions into plain ones; the same text always gets the same answer.

    Args:
        rewriter: a language model; None works without.
        tagger: says speech in plain words before the model is asked; None leaves it as it is.
        seconds: time budget for the model, each instruction; what is late falls back.
        log: JSON-lines file that every new decision is added to.
    """

    def __init__(
        self,
        rewriter: Rewriter | None = None,
        *,
        tagger: Tags | None = None,
        seconds: float = SECONDS,
        log: str | Path | None = None,
    ) -> None:
        self.rewriter, self.tagger, self.seconds = rewriter, tagger, seconds
        self.log = None if log is None else Path(log)
        self._known: dict[str, Decision] = {}

    def canonicalise(self, text: str) -> Decision:
        """Return the decision on one instruction. Raises TypeError if it is no text."""
        return self.canonicalise_all([text])[0]

    def canonicalise_all(self, texts: Iterable[str]) -> list[Decision]:
        """Return the decision on each text; the model sees the passages of all in batches.

        Raises TypeError for an instruction that is no text.
        """
        texts = list(texts)
        for text in texts:
            if not isinstance(text, str):
                raise TypeError(f"An instruction must be a text (str), but this one is {text!r}.")
        fresh = [text for text in dict.fromkeys(texts) if text not in self._known]
        began = time.monotonic()
        drafts = [_Draft(text, self.tagger) for text in fresh]
        if self.rewriter is not None and drafts:
            self._ask(drafts)
        each = (time.monotonic() - began) / max(1, len(fresh))
        decided = [draft.decision(each) for draft in drafts]
        self._known.update((decision.original, decision) for decision in decided)
        if self.log is not None and decided:
            _append(self.log, decided)
        return [self._known[text] for text in texts]

    def _ask(self, drafts: list[_Draft]) -> None:
        assert self.rewriter is not None
        budget = self.seconds * len(drafts)
        began = time.monotonic()
        doubtful = list(dict.fromkeys(s for draft in drafts for s in draft.doubtful))
        answers = self.rewriter.rewrite(doubtful, budget) if doubtful else []
        empty = {s for s, answer in zip(doubtful, answers, strict=True) if answer == ""}
        for draft in drafts:
            draft.repair(empty)
        wanted = list(dict.fromkeys(p for draft in drafts for p in draft.wanted))
        left = max(0.0, budget - (time.monotonic() - began))
        found = self.rewriter.rewrite(wanted, left) if wanted else []
        said = dict(zip(wanted, found, strict=True))
        for draft in drafts:
            draft.take(said)


def open_safeguard(choice: str, log: str | Path | None = None) -> Safeguard | None:
    """Return the safeguard that ``choice`` names, None for "none".

    "rules"; "tagger" and "reader" (the rules, then ``checkpoints/safeguard_tagger`` or, with the
    package of MiniLM, ``checkpoints/safeguard_reader``) or a folder of one; "prompted" (the default
    language model as it comes); "lora" (``checkpoints/safeguard``) or an adapter folder;
    ``http://host/v1@model`` for an OpenAI-compatible endpoint; "tagger+" or "reader+" before one of
    the last three. Raises ValueError or FileNotFoundError.
    """
    from mitigate.core.checkpoint import WEIGHTS
    from mitigate.safeguard.reader import open_tags

    first, plus, second = choice.partition("+")
    if plus and first in TAGGERS:
        made = open_safeguard(second, log)
        if made is None or made.rewriter is None:
            raise ValueError(unknown("safeguard", choice, CHOICES))
        made.tagger = open_tags(find(TAGGERS[first]))
        return made
    if choice == "none":
        return None
    if choice == "rules":
        return Safeguard(log=log)
    check_choice(choice)  # before anything repeats it
    if choice in TAGGERS or (Path(choice) / WEIGHTS).is_file():
        folder = find(TAGGERS[choice]) if choice in TAGGERS else choice
        return Safeguard(tagger=open_tags(folder), log=log)
    if choice.lower().startswith(("http://", "https://")):
        from mitigate.safeguard.endpoint import ChatEndpoint

        url, _, model = choice.rpartition("@")
        return Safeguard(ChatEndpoint(url, model, cache=CACHE), seconds=ENDPOINT_SECONDS, log=log)
    from mitigate.safeguard.model import LanguageModel, open_adapter

    if choice == "prompted":
        return Safeguard(LanguageModel(prompt="prompted").eval(), log=log)
    if choice != "lora" and not Path(choice).is_dir():
        raise ValueError(unknown("safeguard", choice, CHOICES) + " Or name an adapter's folder.")
    return Safeguard(open_adapter(find(ADAPTER) if choice == "lora" else choice), log=log)


def label(choice: str) -> str:
    """Return a short name for a safeguard: an adapter's folder with a hash of its weights, an
    endpoint's host and model; the names of ours as they are."""
    if choice.startswith(("http://", "https://")):
        return re.sub(r"[^A-Za-z0-9.@-]+", "-", choice.partition("://")[2])
    from mitigate.core.checkpoint import WEIGHTS
    from mitigate.core.files import sha256
    from mitigate.safeguard.adapter_folder import ADAPTER as ADAPTER_FILE

    first, plus, second = choice.partition("+")
    if plus and first in TAGGERS:
        return f"{first}+{label(second)}"
    files = [Path(choice) / name for name in (ADAPTER_FILE, WEIGHTS)]
    weights = next((file for file in files if file.is_file()), None)
    if weights is None:
        return Path(choice).name
    folder = Path(choice)
    while folder.name == "agent":  # every trained adapter lies in a folder called so
        folder = folder.parent
    return f"{folder.name}-{sha256(weights)[:6]}"


class _Draft:
    """One instruction on its way: what the rules made of it, its passages, the reasons so far."""

    def __init__(self, original: str, tagger: Tags | None = None) -> None:
        self.original, self.tagger = original, tagger
        self.tidied = tidy(original)
        short = len(words(self.tidied)) <= TOO_LONG
        self.judge = tagger if short else None  # reads the text as it is heard
        self.reasons: list[str] = []
        self.asked = self.taken = 0
        self.plain = not _readable(self.tidied) or (
            _untouched(original, self.judge) and not self._spoken()
        )
        heard = rules.lower_capitals(original)
        self.doubtful = [] if self.plain else rules.doubtful(heard, judging(self.judge, heard))
        self.repair(set())

    def _spoken(self) -> bool:
        """Return whether the tagger takes the text for speech."""
        return self.judge is not None and is_speech(self.judge.tag(self.tidied))

    def repair(self, empty: set[str]) -> None:
        """Apply the rules; ``empty`` are doubtful sentences that the model would leave out."""
        if self.plain:
            self.repaired, self.passages, self.styled = self.original, [self.original], False
            self.same, self.tagged = True, False
            self.reasons = [] if _readable(self.tidied) else ["nothing readable in English"]
            return
        done = rules.repair(self.original, empty.__contains__, self.judge)
        self.same = done.text == self.original
        self.repaired, self.reasons = tidy(done.text), list(done.reasons)
        self.tagged = self._say_plainly()
        self.styled = done.marks >= MARKS
        if len(words(self.repaired)) > TOO_LONG:
            self.passages = [self.repaired]
            self.reasons.append(f"over {TOO_LONG} words: rules alone")
        else:
            self.passages = passages(self.repaired, PASSAGE)

    def _say_plainly(self) -> bool:
        """Let the tagger say speech in plain words; return whether it changed any."""
        if self.tagger is None or len(words(self.repaired)) > TOO_LONG:
            return False
        tagged = self.tagger.tag(self.repaired)
        if not is_speech(tagged):
            return False
        said, kept = plainly_said(self.repaired, tagged)
        self.reasons += kept
        changed = said != self.repaired
        if changed:
            self.reasons.append("said in plain words by the tagger")
            self.repaired, self.same = said, False
        return changed

    @property
    def wanted(self) -> list[str]:
        """The passages that the model is to say again."""
        if self.plain or len(words(self.repaired)) > TOO_LONG:
            return []
        return [p for p in self.passages if MASK.search(p) or self.styled]

    def take(self, said: dict[str, str | None]) -> None:
        """Put safe answers in the place of their passages."""
        wanted = set(self.wanted)
        for index, passage in enumerate(self.passages):
            if passage not in wanted:
                continue
            self.asked += 1
            problem = refusal(passage, said.get(passage), index == len(self.passages) - 1)
            if problem:
                self.reasons.append(f"kept {passage[:40]!r}: {problem}")
            else:
                self.passages[index] = said[passage] or ""
                self.taken += 1

    def decision(self, seconds: float) -> Decision:
        text = self.original if self.same else self.repaired
        if self.taken:
            text = self._said(text)
        if not self.plain and MASK.search(text):
            text = masks.fill(text)
            self.reasons.append("masks filled by rule")
        if text != self.original and not self.reasons:
            self.reasons.append("said again by the model" if self.taken else "characters tidied")
        done = "tagger" if self.tagged else "rules"
        route = "model" if self.taken else "fallback" if self.asked else done
        route = "clean" if text == self.original and not self.asked else route
        return Decision(self.original, text, route, tuple(self.reasons), seconds)

    def _said(self, text: str) -> str:
        """Return the model's answers and the kept passages, or ``text`` if the whole is unsafe."""
        said = " ".join(passage for passage in self.passages if passage).strip()
        problem = gate.result_refused(self.repaired, said)
        if problem:
            self.taken = 0
            self.reasons.append(f"kept all: {problem}")
            return text
        return said


def _readable(text: str) -> bool:
    """Return whether there are words, mostly in Latin letters, or a way is told in English."""
    letters = [c for c in text if c.isalpha()]
    latin = sum(c.isascii() for c in letters)
    return bool(letters) and (latin > 0.5 * len(letters) or bool(gate.route_facts(text)))


def _untouched(text: str, tagger: Tags | None) -> bool:
    """Return whether ``text`` shows no mark of any corruption."""
    return (
        not MASK.search(text)
        and rules.lower_capitals(text) == text
        and rules.style_marks(text) < MARKS
        and not rules.doubtful(text, judging(tagger, text))
        and rules.repair(text, tags=tagger).text == text
    )


def _append(path: Path, decisions: list[Decision]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = "".join(json.dumps(asdict(d), ensure_ascii=False) + "\n" for d in decisions)
    with open(path, "a", encoding="utf-8") as file:
        file.write(lines)
        file.flush()
        os.fsync(file.fileno())
