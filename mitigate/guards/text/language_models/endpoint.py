"""A prompted safeguard behind any OpenAI-compatible chat endpoint, with a cache on disk.

``POST <url>/chat/completions`` with ``model`` and ``messages``; the answer's first choice counts.
The key comes from an environment variable and is never written anywhere.
"""

from __future__ import annotations

import json
import os
import time
import urllib.error
from collections.abc import Sequence
from http.client import HTTPException
from pathlib import Path
from typing import Any

from tqdm import tqdm

from mitigate.core.json_files import parse_json
from mitigate.core.names import short
from mitigate.core.seeding import digest
from mitigate.guards.text.addresses import check_url
from mitigate.guards.text.language_models.answers import AnswerCache
from mitigate.guards.text.language_models.posting import post
from mitigate.guards.text.language_models.prompts import PROMPTS, prompt_messages

RETRIED = frozenset({408, 409, 425, 429, 500, 502, 503, 504})  # HTTP: it may work later


class ChatEndpoint:
    """Rewrites texts by asking a chat model over HTTP.

    Args:
        url: up to and without ``/chat/completions``, such as ``http://localhost:8000/v1``.
        model: as the endpoint names it.
        prompt: which of ``PROMPTS`` goes before the text.
        key: environment variable that holds the API key; unset means none is sent.
        timeout: seconds for one request. retries: further tries after a failure that may pass.
        pause: seconds before the first retry, doubled before each next one.
        cache: SQLite file of answers by (text, model, prompt); None keeps none.
        options: further fields of the request, such as ``{"temperature": 0}``.

    Raises:
        ValueError: for a URL that is none, or that holds a password or a key.
    """

    def __init__(
        self,
        url: str,
        model: str,
        *,
        prompt: str = "prompted",
        key: str = "OPENAI_API_KEY",
        timeout: float = 60.0,
        retries: int = 3,
        pause: float = 1.0,
        cache: str | Path | None = None,
        options: dict[str, Any] | None = None,
    ) -> None:
        check_url(url)
        self.url, self.model, self.prompt, self.key = url.rstrip("/"), model, prompt, key
        self.timeout, self.retries, self.pause = timeout, retries, pause
        self.options = options or {}
        self.failures: list[str] = []
        self._cache = None if cache is None else AnswerCache(Path(cache))

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]:
        """Return the answer to each text; None where the endpoint gave none that can be used, or
        where ``seconds`` for all were over. Why is said in ``failures``."""
        ends = None if seconds is None else time.monotonic() + seconds
        shown = tqdm(texts, desc=self.model, disable=None if len(texts) > 8 else True)
        return [self._answer(text, ends) for text in shown]

    def _answer(self, text: str, ends: float | None) -> str | None:
        name = (
            f"{digest(self.url, self.model, PROMPTS[self.prompt], repr(self.options), text):032x}"
        )
        answer = None if self._cache is None else self._cache.get(name)
        if answer is None:
            answer = self._ask(text, ends)
            if self._cache is not None and answer is not None:
                self._cache.put(name, answer)
        return answer

    def _ask(self, text: str, ends: float | None) -> str | None:
        problem = "out of time"
        for attempt in range(self.retries + 1):
            left = self.timeout if ends is None else min(self.timeout, ends - time.monotonic())
            if left <= 0:
                break
            try:
                return _content(self._post(text, left))
            except urllib.error.HTTPError as error:
                problem = f"HTTP {error.code} {short(error.reason)}"
                if error.code not in RETRIED:
                    break
            except (OSError, ValueError, RecursionError, HTTPException) as error:
                problem = f"{type(error).__name__}: {short(str(error), 200)}"
            wait = self.pause * 2**attempt
            if attempt == self.retries or (ends is not None and time.monotonic() + wait > ends):
                break
            time.sleep(wait)
        self.failures.append(f"{self.url}: {problem}")
        return None

    def _post(self, text: str, timeout: float) -> Any:
        body = {"model": self.model, "messages": prompt_messages(text, self.prompt), **self.options}
        headers = {"Content-Type": "application/json"}
        if os.environ.get(self.key):
            headers["Authorization"] = f"Bearer {os.environ[self.key]}"
        url = f"{self.url}/chat/completions"
        return parse_json(post(url, json.dumps(body).encode(), headers, timeout))


def _content(reply: Any) -> str:
    """Return the text of the first choice; raises ValueError if the reply has another shape."""
    try:
        content = reply["choices"][0]["message"]["content"]
    except (KeyError, IndexError, TypeError) as error:
        raise ValueError(f"no choices[0].message.content in {json.dumps(reply)[:120]}") from error
    if not isinstance(content, str):
        raise ValueError(f"the answer is no text: {content!r:.120}")
    content.encode("utf-8")  # half a character is no text
    return content.strip()
