"""Rewrite instructions in a style with a language model, as in the paper, and cache all answers.

The model is any function (system prompt, text) -> answer, for example a chat endpoint or a local
model. The cache key is (text, style, model, prompt, seed). A file of corrupted episodes can
therefore be reproduced exactly without the model.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from hashlib import blake2b
from pathlib import Path

from mitigate.core.files import make_folder
from mitigate.core.output import open_output
from mitigate.corruptions.language.style import MANNERS

TONES = {
    "friendly": "warm and chatty, as to a friend",
    "novice": "simple and a little unsure, as by someone who never gave directions before",
    "professional": "concise and technical, as in an operating procedure",
    "formal": "polite and elaborate, as in a letter to a stranger",
}
PROMPT = (
    "Rewrite the navigation instruction in another manner: {tone}. Keep every left, right, up, "
    "down, straight and stop, in the same order. Keep every object, room, colour and number. Add "
    "no distance, no compass word and no object. Answer with the rewritten instruction alone."
)
LONGEST_LINE = 1 << 20  # maximum size of a cached answer in bytes (heuristic)
_HALF = re.compile("[\ud800-\udfff]")  # lone surrogates; a text file cannot contain them


class Rewriter:
    """Callable that rewrites texts in a style with a model, and caches the answers.

    Args:
        ask: function (system prompt, text) -> answer.
        model: name of the model; it is part of the cache key.
        cache: a JSONL file with one line per answer. Invalid lines, such as an incomplete last
            line, are ignored.
        seed: a number in the cache key, which separates different answers of the same model.

    Raises:
        ValueError: If ``cache`` is a folder.
    """

    def __init__(
        self, ask: Callable[[str, str], str], model: str, cache: Path | str, seed: int = 0
    ) -> None:
        self._ask, self._model, self._cache, self._seed = ask, model, Path(cache), seed
        if self._cache.is_dir():
            raise ValueError(
                f"cache must be a file, got the folder {cache}. Name a file for the answers."
            )
        self._known = _read(self._cache)

    def __call__(self, text: str, manner: str) -> str:
        """Return ``text`` rewritten in the style ``manner``.

        Raises ValueError for an unknown style, and for an answer that is not text. An invalid
        answer is not cached, so the next call asks the model again.
        """
        if manner not in TONES:
            raise ValueError(f"manner must be one of {', '.join(MANNERS)}, got {manner!r}.")
        prompt = PROMPT.format(tone=TONES[manner])
        request = {
            "text": text,
            "manner": manner,
            "model": self._model,
            "prompt": prompt,
            "seed": self._seed,
        }
        key = _key(request)
        if key not in self._known:
            answer = self._ask(prompt, text)
            if not _is_valid(answer):
                raise ValueError(
                    f"The model {self._model!r} answered {answer!r:.60} for {text!r:.60}: an "
                    "answer must be text that is not blank. It was not cached. Ask again, or use "
                    "another model."
                )
            self._known[key] = answer
            self._append(request | {"answer": answer})
        return self._known[key]

    def _append(self, line: dict[str, object]) -> None:
        make_folder(self._cache.parent)
        with open_output(self._cache, "ab+") as file:
            file.seek(-1 if file.tell() else 0, os.SEEK_END)
            whole = file.read() in (b"", b"\n")
            file.write((("" if whole else "\n") + json.dumps(line) + "\n").encode())


def _key(request: dict[str, object]) -> str:
    return blake2b(json.dumps(request, sort_keys=True).encode(), digest_size=16).hexdigest()


def _is_valid(answer: object) -> bool:
    """Return whether ``answer`` is a non-blank text that can be encoded."""
    return isinstance(answer, str) and bool(answer.strip()) and not _HALF.search(answer)


def _read(cache: Path) -> dict[str, str]:
    """Return the answers of all valid lines, by key."""
    answers: dict[str, str] = {}
    if not cache.is_file():
        return answers
    with open(cache, "rb") as file:
        for line in iter(lambda: file.readline(LONGEST_LINE), b""):
            try:
                entry = json.loads(line)
                answer = entry.pop("answer")
            except (ValueError, KeyError, AttributeError, RecursionError):
                continue
            if _is_valid(answer):
                answers[_key(entry)] = answer
    return answers
