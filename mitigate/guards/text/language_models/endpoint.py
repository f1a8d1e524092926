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
        url: see :class:`ChatClient`, which also describes errors.
        model: name of the model at the endpoint.
        cache: SQLite file that stores the answer for each text, model and prompt, or None.
        request: other arguments of :class:`ChatClient`.
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
        self.failures: list[str] = []
        self._cache = None if cache is None else AnswerCache(Path(cache))

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]:
        """Return the answer to each text, or None if no usable answer arrived within ``seconds``.

        The attribute ``failures`` lists the reasons.
        """
        ends = None if seconds is None else time.monotonic() + seconds
        progress = tqdm(texts, desc=self.model, disable=None if len(texts) > 8 else True)
        return [self._answer(text, ends) for text in progress]

    def _answer(self, text: str, ends: float | None) -> str | None:
        name = f"{digest(self.url, self.model, PROMPTS[PROMPT], repr(self.options), text):032x}"
        answer = None if self._cache is None else self._cache.get(name)
        if answer is not None:
            return answer
        try:
            answer = self.ask(prompt_messages(text, PROMPT), gate.longest(text), ends)
        except NoAnswer as error:
            self.failures.append(str(error))
            return None
        if self._cache is not None:
            self._cache.put(name, answer)
        return answer
