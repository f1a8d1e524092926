"""Ask a chat model behind an OpenAI-compatible endpoint, with deadlines and retries.

A request is ``POST <url>/chat/completions`` with ``model`` and ``messages``; the first choice in
the answer is used. The API key is read from an environment variable and is never written anywhere.
"""

from __future__ import annotations

import json
import os
import threading
import time
import urllib.request
from collections.abc import Mapping, Sequence
from queue import Empty, SimpleQueue
from typing import Any
from urllib.parse import urlsplit

import urllib3

from mitigate.core.addresses import check_url
from mitigate.core.json_files import parse_json
from mitigate.core.names import short

KEY = "OPENAI_API_KEY"  # environment variable with the key; if it is not set, no key is sent
# HTTP status codes after which a retry may succeed
RETRIED = frozenset({408, 409, 425, 429, 500, 502, 503, 504})
# maximum size in bytes of the parts of an answer other than its text, such as token counts
ENVELOPE = 1 << 15
# fraction of the deadline that connecting to one address of a host may take (heuristic)
CONNECT_SHARE = 0.25


class NoAnswer(Exception):
    """Raised if an endpoint gave no usable answer in time; the message states the last reason."""


class _Refused(Exception):
    """Raised for an answer with an HTTP status other than success."""

    def __init__(self, status: int, reason: str) -> None:
        super().__init__(f"HTTP {status} {short(_without_key(reason))}")
        self.status = status


class ChatClient:
    """Client of one model at one endpoint; several threads may use it at once.

    Args:
        url: address without ``/chat/completions``, such as ``http://localhost:8000/v1``.
        model: name of the model at the endpoint.
        timeout: seconds for one request.
        retries: number of retries after a temporary failure.
        pause: seconds before the first retry; the pause doubles before each later retry.
        options: additional fields of the request, such as ``{"temperature": 0}``.

    Raises:
        ValueError: If the URL is invalid, or it contains a password or a key.
    """

    def __init__(
        self,
        url: str,
        model: str,
        *,
        timeout: float = 60.0,
        retries: int = 3,
        pause: float = 1.0,
        options: Mapping[str, Any] | None = None,
    ) -> None:
        check_url(url)
        self.url, self.model = url.rstrip("/"), model
        self.timeout, self.retries, self.pause = timeout, retries, pause
        self.options = dict(options or {})

    def ask(
        self, messages: Sequence[Mapping[str, Any]], longest: int, ends: float | None = None
    ) -> str:
        """Return the answer to ``messages``.

        Args:
            messages: the conversation in OpenAI's format.
            longest: maximum length of the answer, in characters.
            ends: value of ``time.monotonic()`` at which requests end; None sets no limit.

        Raises:
            NoAnswer: If all attempts failed, a failure was permanent, or the time limit has passed.
        """
        problem = "out of time"
        for attempt in range(self.retries + 1):
            left = self.timeout if ends is None else min(self.timeout, ends - time.monotonic())
            if left <= 0:
                break
            try:
                answer = _content(self._post(messages, left, longest))
                if len(answer) > longest:
                    raise ValueError(f"the answer has more than {longest} characters")
                return answer
            except _Refused as error:
                problem = str(error)
                if error.status not in RETRIED:
                    break
            except (OSError, ValueError, RecursionError, urllib3.exceptions.HTTPError) as error:
                problem = f"{type(error).__name__}: {short(_without_key(str(error)), 200)}"
            wait = self.pause * 2**attempt
            if attempt == self.retries or (ends is not None and time.monotonic() + wait > ends):
                break
            time.sleep(wait)
        raise NoAnswer(f"{self.url}: {problem}")

    def _post(self, messages: Sequence[Mapping[str, Any]], timeout: float, longest: int) -> Any:
        body = json.dumps({"model": self.model, "messages": messages, **self.options}).encode()
        headers = {"Content-Type": "application/json"}
        if key := os.environ.get(KEY):
            headers["Authorization"] = f"Bearer {key}"
        most = ENVELOPE + 6 * longest  # JSON may need six bytes per character
        return parse_json(post(f"{self.url}/chat/completions", body, headers, timeout, most))


def post(url: str, body: bytes, headers: dict[str, str], seconds: float, most: int) -> bytes:
    """Send ``body`` to ``url`` and return the answer.

    ``seconds`` limits the total time, including name resolution, connecting and reading. The
    request runs in a thread, because socket timeouts do not limit name resolution, and each address
    of a host has its own timeout. A thread that exceeds the limit is abandoned; it ends when its
    socket times out.

    Raises:
        TimeoutError: If no complete answer arrived in time.
        ValueError: If the answer has more than ``most`` bytes.
        _Refused: If the HTTP status is not 2xx. Redirects are not followed.
    """
    answers: SimpleQueue[bytes | Exception] = SimpleQueue()

    def ask() -> None:
        try:
            answers.put(_exchange(url, body, headers, seconds, most))
        except Exception as error:
            answers.put(error)

    threading.Thread(target=ask, daemon=True).start()
    try:
        answer = answers.get(timeout=seconds)
    except Empty:
        raise TimeoutError(f"no complete answer within {seconds:g} s") from None
    if isinstance(answer, Exception):
        raise answer
    return answer


def _exchange(url: str, body: bytes, headers: dict[str, str], seconds: float, most: int) -> bytes:
    parts = urlsplit(url)
    proxy = urllib.request.getproxies().get(parts.scheme)
    if proxy is None or urllib.request.proxy_bypass(parts.hostname or ""):
        pool = urllib3.PoolManager()
    else:
        pool = urllib3.ProxyManager(proxy)
    # the connect timeout applies to each address of the host, so time must remain for the next one
    limit = urllib3.Timeout(connect=CONNECT_SHARE * seconds, read=seconds)
    ends = time.monotonic() + seconds
    # a redirect would send the text and the key to a different host
    reply = pool.request("POST", url, body=body, headers=headers, timeout=limit, retries=False,
                         redirect=False, preload_content=False)  # fmt: skip
    try:
        if not 200 <= reply.status < 300:
            raise _Refused(reply.status, reply.reason or "")
        answer = b""
        while len(answer) <= most and time.monotonic() < ends:
            part = reply.read1(1 << 14, decode_content=False)
            if not part:
                return answer
            answer += part
    finally:
        reply.close()
        pool.clear()
    if len(answer) > most:
        raise ValueError(f"the answer has more than {most} bytes")
    raise TimeoutError(f"no complete answer within {seconds:g} s")


def _without_key(text: str) -> str:
    """Replace the API key in ``text``, because a server or a library may repeat the key.

    A key with white space, such as a final newline, is escaped in messages. So each part between
    white space is replaced. Parts of fewer than four characters are too short to be secret.
    """
    for part in os.environ.get(KEY, "").split():
        if len(part) >= 4:
            text = text.replace(part, "[key]")
    return text


def _content(reply: Any) -> str:
    """Return the text of the first choice; raise ValueError if the reply has an unexpected form."""
    try:
        content = reply["choices"][0]["message"]["content"]
    except (KeyError, IndexError, TypeError) as error:
        raise ValueError(
            f"no choices[0].message.content in {_without_key(json.dumps(reply))[:120]}"
        ) from error
    if not isinstance(content, str):
        raise ValueError(f"the answer is not text: {_without_key(repr(content))[:120]}")
    content.encode("utf-8")  # a single surrogate is not valid text
    return content.strip()
