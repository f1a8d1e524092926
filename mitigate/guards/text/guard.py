"""The safeguard in front of an agent: repairs an instruction once, and never makes it worse.

What looks plain passes untouched. Rules take out what is surely no part of a route; a language
model, if there is one, says the rest again, passage by passage, and each answer is taken only if
directions and landmarks survive and nothing new appears. Otherwise the passage stays as it was.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Protocol

from mitigate.core.files import find, make_folder, writing
from mitigate.core.names import unknown
from mitigate.core.output import open_output
from mitigate.guards.text.addresses import check_choice
from mitigate.guards.text.choices import ADAPTER, CHOICES, TAGGERS, VERSION, holds_tags, identity
from mitigate.guards.text.draft import Decision, Draft
from mitigate.guards.text.plain.plainly_said import Tags

CACHE = "runs/endpoint-answers.sqlite"
ENDPOINT_SECONDS = 120.0
SECONDS = 20.0  # for the language model, each instruction (ours)
KEPT = 4096  # texts whose decisions are remembered (ours)


class Rewriter(Protocol):
    """A language model, local or behind an endpoint."""

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]: ...


class Safeguard:
    """Turns corrupted instructions into plain ones; a text that comes again gets the same answer,
    until ``KEPT`` others came after it.

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
        kinds = (type(part).__qualname__ for part in (tagger, rewriter) if part is not None)
        self.identity = " ".join(["rules", *kinds, VERSION])  # in rows of results
        self._known: dict[str, Decision] = {}

    def canonicalise(self, text: str) -> Decision:
        """Return the decision on one instruction. Raises TypeError if it is no text."""
        return self.canonicalise_all([text])[0]

    def canonicalise_all(self, texts: Iterable[str]) -> list[Decision]:
        """Return the decision on each text; the model sees the passages of all in batches.

        Raises TypeError for one text in place of several, and for an instruction that is no text.
        """
        if isinstance(texts, str):
            raise TypeError(f"These must be several texts, but this is one: [{texts!r}] is a list.")
        texts = list(texts)
        for text in texts:
            if not isinstance(text, str):
                raise TypeError(f"An instruction must be a text (str), but this one is {text!r}.")
        known = {text: self._known[text] for text in texts if text in self._known}
        fresh = [text for text in dict.fromkeys(texts) if text not in known]
        began = time.monotonic()
        drafts = [Draft(text, self.tagger) for text in fresh]
        if self.rewriter is not None and drafts:
            self._ask(drafts)
        each = (time.monotonic() - began) / max(1, len(fresh))
        decided = [draft.decision(each) for draft in drafts]
        known.update((decision.original, decision) for decision in decided)
        self._known.update(known)
        for text in list(self._known)[: max(0, len(self._known) - KEPT)]:
            del self._known[text]
        if self.log is not None and decided:
            _append(self.log, decided)
        return [known[text] for text in texts]

    def _ask(self, drafts: list[Draft]) -> None:
        assert self.rewriter is not None
        budget = self.seconds * len(drafts)
        began = time.monotonic()
        doubtful = list(dict.fromkeys(s for draft in drafts for s in draft.doubtful))
        answers = self.rewriter.rewrite(doubtful, budget) if doubtful else []
        empty = {s for s, answer in zip(doubtful, answers, strict=True) if answer == ""}
        for draft in drafts:
            if not empty.isdisjoint(draft.doubtful):
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
    from mitigate.guards.text.choices import check

    check(choice)
    made = _opened(choice, log)
    if made is not None:
        made.identity = identity(choice)
    return made


def _opened(choice: str, log: str | Path | None) -> Safeguard | None:
    from mitigate.guards.text.reader import open_tags

    first, plus, second = choice.partition("+")
    if plus and first in TAGGERS:
        made = _opened(second, log)
        if made is None or made.rewriter is None:
            raise ValueError(unknown("safeguard", choice, CHOICES))
        made.tagger = open_tags(find(TAGGERS[first]))
        return made
    if choice == "none":
        return None
    if choice == "rules":
        return Safeguard(log=log)
    check_choice(choice)  # before anything repeats it
    if choice in TAGGERS or holds_tags(choice):
        folder = find(TAGGERS[choice]) if choice in TAGGERS else choice
        return Safeguard(tagger=open_tags(folder), log=log)
    if choice.lower().startswith(("http://", "https://")):
        from mitigate.guards.text.language_models.endpoint import ChatEndpoint

        url, _, model = choice.rpartition("@")
        return Safeguard(ChatEndpoint(url, model, cache=CACHE), seconds=ENDPOINT_SECONDS, log=log)
    from mitigate.guards.text.language_models.model import LanguageModel, open_adapter

    if choice == "prompted":
        return Safeguard(LanguageModel(prompt="prompted").eval(), log=log)
    return Safeguard(open_adapter(find(ADAPTER) if choice == "lora" else choice), log=log)


def _append(path: Path, decisions: list[Decision]) -> None:
    make_folder(path.parent)
    lines = "".join(json.dumps(asdict(d)) + "\n" for d in decisions)
    with writing(path), open_output(path, "a", encoding="utf-8") as file:
        file.write(lines)
        file.flush()
        os.fsync(file.fileno())
