"""The safeguard, which repairs each instruction once before the agent receives it.

The safeguard has three parts. A classifier finds text that does not belong to the instruction
(:mod:`detect`). An optional language model rewrites the rest in plain words
(:mod:`language_models`). Rules accept a change only if it preserves the meaning of the instruction
(:mod:`gate`).
"""

from __future__ import annotations

import json
import os
import re
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

from mitigate.core.files import find, make_folder
from mitigate.core.output import open_output, writing
from mitigate.guards.text import choices, gate, rules
from mitigate.guards.text.classifier import Classifier, load
from mitigate.guards.text.decode import visible
from mitigate.guards.text.detect import READ, take_out
from mitigate.guards.text.pieces import script, sentences

CACHE = "runs/endpoint-answers.sqlite"
ENDPOINT_SECONDS = 120.0
SECONDS = 20.0  # time limit of the language model in seconds per instruction
REMEMBERED = 4096  # maximum number of texts whose decisions are cached
# maximum number of words in a passage of several sentences, which the model rewrites together
# With 30 words, the model omitted clauses.
PASSAGE = 12
# a text with more characters is not rewritten (heuristic; 600 words have about 3,300)
TOO_LARGE = 6000
TOO_LONG = 600  # a text with more words is not rewritten; the longest texts of RxR have about 500
# marks of bold and coloured words, and of the items of a list
LOOKS = re.compile(
    r"</?(?:b|i|u|em|strong|span|mark|small|big|font)\b[^<>]{0,80}>|\*\*(?=\S)|(?<=\S)\*\*"
    r"|^[ \t]*[-*•][ \t]+",
    re.IGNORECASE | re.MULTILINE,
)


class Rewriter(Protocol):
    """Interface of a language model, which may run locally or behind an endpoint.

    A model may have an attribute ``failures``. It maps each text of the last call of ``rewrite``
    that has no answer to the reason.
    """

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]: ...


@dataclass(frozen=True)
class Decision:
    """The safeguard's decision on one instruction.

    ``route`` is "clean" if the instruction is unchanged, "classifier" if it was changed without a
    language model, "model" if the model rewrote it, and "fallback" if no answer of the model was
    accepted. ``reasons`` lists accepted and rejected changes, and why the model gave no answer.
    ``seconds`` is the mean computing time per instruction of the batch.
    """

    original: str
    text: str
    route: str
    reasons: tuple[str, ...]
    seconds: float


class Safeguard:
    """Repairs instructions.

    The decision on a text is cached until ``REMEMBERED`` other texts have been processed.

    Args:
        rewriter: a language model, or None.
        classifier: the classifier that finds attacks. The default is the shipped one.
        seconds: time limit for the model per instruction. Answers after this time are not used.
        log: file to which each new decision is appended as a line of JSON.
    """

    def __init__(
        self,
        rewriter: Rewriter | None = None,
        *,
        classifier: Classifier | None = None,
        seconds: float = SECONDS,
        log: str | Path | None = None,
    ) -> None:
        self.rewriter = rewriter
        self.classifier = classifier or load(find(choices.CLASSIFIER))
        self.seconds = seconds
        self.log = None if log is None else Path(log)
        kinds = [] if rewriter is None else [type(rewriter).__qualname__]
        self.identity = " ".join(["classifier", *kinds, choices.VERSION])  # used in result rows
        self._known: dict[str, Decision] = {}

    def canonicalise(self, text: str) -> Decision:
        """Return the decision on one instruction.

        Raises TypeError if the instruction is not a string.
        """
        return self.canonicalise_all([text])[0]

    def canonicalise_all(self, texts: Iterable[str]) -> list[Decision]:
        """Return the decision on each text; the model rewrites passages of all texts in batches.

        Raises TypeError if ``texts`` is a single string or if an instruction is not a string.
        """
        if isinstance(texts, str):
            raise TypeError(f"texts must be a list of strings, got a string. Pass [{texts!r}].")
        texts = list(texts)
        for text in texts:
            if not isinstance(text, str):
                raise TypeError(f"An instruction must be a string, got {text!r}.")
        known = {text: self._known[text] for text in texts if text in self._known}
        fresh = [text for text in dict.fromkeys(texts) if text not in known]
        began = time.monotonic()
        drafts = [_Draft(text, self.classifier, self.rewriter is not None) for text in fresh]
        requested = list(dict.fromkeys(p for draft in drafts for p in draft.requested))
        if self.rewriter is not None and requested:
            answers = self.rewriter.rewrite(requested, self.seconds * len(drafts))
            by_passage = dict(zip(requested, answers, strict=True))
            failures = getattr(self.rewriter, "failures", {})
            for draft in drafts:
                draft.accept(by_passage, failures)
        each = (time.monotonic() - began) / max(1, len(fresh))
        decided = [draft.decision(each) for draft in drafts]
        known.update((decision.original, decision) for decision in decided)
        if self.log is not None and decided:
            _append(self.log, decided)  # before the decisions are remembered, in case it fails
        self._known.update(known)
        for text in list(self._known)[: max(0, len(self._known) - REMEMBERED)]:
            self._known.pop(text, None)  # another thread may have deleted it
        return [known[text] for text in texts]


class _Draft:
    """An instruction during its repair, with its passages and the reasons collected so far."""

    def __init__(self, original: str, classifier: Classifier, rewrites: bool) -> None:
        self.original = original
        self.reasons: list[str] = []
        self.accepted = 0
        text = visible(original)
        if text != original:
            self.reasons.append("invisible characters taken out")
        plain = LOOKS.sub("", text)
        if plain != text and plain.strip():
            self.reasons.append("marks of how words look taken out")
            text = plain
        if len(text) > READ:
            text = _beginning(text)
            self.reasons.append(f"longer than {READ:,} characters: only the beginning is kept")
        # before the search for attacks, because the classifier takes many masks for an attack
        filled = rules.fill_masks(text) if rules.MASK.search(text) else text
        if filled != text:
            self.reasons.append("masks filled by rule")
            text = filled
        text, removed, refusals = take_out(text, classifier)
        self.reasons += refusals
        if removed:
            self.reasons.append("removed: " + "; ".join(repr(piece[:60]) for piece in removed))
        quiet = rules.lower_capitals(text, classifier.known)
        if quiet != text:
            self.reasons.append("capitals lowered")
        self.text = quiet
        self.parts: list[str] = []
        short = len(quiet) <= TOO_LARGE and len(quiet.split()) <= TOO_LONG
        if rewrites and short and script(quiet) == "latin":
            self.parts = passages(quiet)
        self.requested = [p for p in self.parts if rules.MASK.search(p) or classifier.styled(p)]

    def accept(self, answers: dict[str, str | None], failures: Mapping[str, str]) -> None:
        """Replace each requested passage by the model's answer if the gate accepts the answer.

        Args:
            answers: the model's answer to each passage.
            failures: the reason why a passage has no answer, if the model states it.
        """
        parts = list(self.parts)
        for place, passage in enumerate(self.parts):
            if passage not in self.requested:
                continue
            answer = answers[passage]
            problem = gate.rewrite_refused(passage, answer, last=place == len(parts) - 1)
            if answer is None and passage in failures:
                problem = f"the model gave no answer ({failures[passage]})"
            if problem:
                self.reasons.append(f"kept {passage[:40]!r}: {problem}")
            elif answer is not None and answer != passage:
                parts[place] = answer
                self.accepted += 1
        text = " ".join(filter(None, parts))
        if not self.accepted:
            return
        if not text.strip():
            self.reasons.append("kept all: nothing would be left")
            self.accepted = 0
        else:
            self.reasons.append("rewritten by the model")
            self.text = text

    def decision(self, seconds: float) -> Decision:
        route = "model" if self.accepted else "fallback" if self.requested else "classifier"
        if self.text == self.original and not self.requested:
            route = "clean"
        return Decision(self.original, self.text, route, tuple(self.reasons), seconds)


def _beginning(text: str) -> str:
    """Return the first ``READ`` characters of a text without repeated spaces.

    The result ends with the last complete sentence or, if there is none, with a complete word.
    """
    text = re.sub(r"(\s)\s+", r"\1", text)
    if len(text) <= READ:
        return text
    start = text[:READ]
    last = max(start.rfind(mark) for mark in ".!?\n")
    return start[: last + 1] if last > 0 else start.rsplit(None, 1)[0]


def open_safeguard(choice: str, log: str | Path | None = None) -> Safeguard | None:
    """Build the safeguard that ``choice`` names; return None for "none".

    The choices are:

    - "classifier" for ``checkpoints/safeguard_classifier`` ("rules" is its earlier name), or the
      folder of another classifier;
    - "prompted" for the default language model without fine-tuning;
    - "lora" for the adapter ``checkpoints/safeguard``, or the folder of another adapter;
    - ``http://host/v1@model`` for a model behind an OpenAI-compatible endpoint.

    Raises ValueError or FileNotFoundError if the choice is invalid (:func:`choices.check`).
    """
    choices.check(choice)
    name = choices.current(choice)
    if name == "none":
        return None
    safeguard = _opened(name, log)
    safeguard.identity = choices.identity(name)
    return safeguard


def _opened(name: str, log: str | Path | None) -> Safeguard:
    if name == "classifier":
        return Safeguard(log=log)
    if choices.is_endpoint(name):
        from mitigate.guards.text.language_models.endpoint import ChatEndpoint

        url, _, model = name.rpartition("@")
        return Safeguard(ChatEndpoint(url, model, cache=CACHE), seconds=ENDPOINT_SECONDS, log=log)
    if name not in choices.CHOICES and choices.kind(name) == "classifier":
        return Safeguard(classifier=load(find(name)), log=log)
    from mitigate.guards.text.language_models.model import LanguageModel, open_adapter

    if name == "prompted":
        return Safeguard(LanguageModel(prompt="prompted").eval(), log=log)
    return Safeguard(open_adapter(find(choices.ADAPTER if name == "lora" else name)), log=log)


def passages(text: str) -> list[str]:
    """Split a text into passages of about ``PASSAGE`` words; short sentences are joined."""
    results: list[str] = []
    for sentence in sentences(text):
        if results and len(results[-1].split()) + len(sentence.split()) <= PASSAGE:
            results[-1] += " " + sentence
        else:
            results.append(sentence)
    return results


def _append(path: Path, decisions: list[Decision]) -> None:
    make_folder(path.parent)
    lines = "".join(json.dumps(asdict(d)) + "\n" for d in decisions)
    with writing(path), open_output(path, "a", encoding="utf-8") as file:
        file.write(lines)
        file.flush()
        os.fsync(file.fileno())
