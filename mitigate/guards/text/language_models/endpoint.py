"""Rewrite texts with a chat model behind an OpenAI-compatible endpoint."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from mitigate.core.chat import ChatClient, NoAnswer
from mitigate.core.seeding import digest
from mitigate.guards.text import gate
from mitigate.guards.text.language_models.answers import AnswerCache
from mitigate.guards.text.language_models.prompts import PROMPTS, prompt_messages

PROMPT = "prompted"  # name of the prompt that precedes the text


class ChatEndpoint(ChatClient):
    """Rewrites texts by asking a chat model over HTTP.

    Args:
        url: address without ``/chat/completions``, such as ``http://localhost:8000/v1``.
        model: name of the model at the endpoint.
        cache: SQLite file that stores the answer for each text, model and prompt, or None for no
            cache.
        request: other arguments of :class:`ChatClient`.

    Attributes:
        failures: maps each text of the last :meth:`rewrite` that has no answer to the reason,
            without the API key.

    Raises:
        ValueError: If the URL is invalid, or it contains a password or a key.
    """

    def __init__(
        self,
        url: str,
        model: str,
        *,
        cache: str | Path | None = None,
        **request: Any,
    ) -> None:
        super().__init__(url, model, **request)
        self.failures: dict[str, str] = {}
        self._cache = None if cache is None else AnswerCache(Path(cache))

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]:
        """Return the model's answer to each text.

        An answer is None if no usable answer arrived within ``seconds``, the time limit for all
        texts together. The attribute ``failures`` states the reasons.
        """
        ends = None if seconds is None else time.monotonic() + seconds
        progress = tqdm(texts, desc=self.model, disable=None if len(texts) > 8 else True)
        failures: dict[str, str] = {}
        answers: list[str | None] = []
        for text in progress:
            try:
                answers.append(self._answer(text, ends))
            except NoAnswer as error:
                answers.append(None)
                failures[text] = str(error)
        self.failures = failures
        return answers

    def _answer(self, text: str, ends: float | None) -> str:
        name = f"{digest(self.url, self.model, PROMPTS[PROMPT], repr(self.options), text):032x}"
        answer = None if self._cache is None else self._cache.get(name)
        if answer is not None:
            return answer
        answer = self.ask(prompt_messages(text, PROMPT), gate.max_length(text), ends)
        if self._cache is not None:
            self._cache.put(name, answer)
        return answer
