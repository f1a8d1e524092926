"""Styles by a language model, every answer kept in a file: the paper's way of making them.

The model is any function (system prompt, text) -> answer, such as a chat endpoint's or a local
model's. Answers are read from the cache by (text, manner, model, prompt, seed), so a file of
corrupted episodes is made again without the model, word for word.
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
_HALF = re.compile("[\ud800-\udfff]")  # half characters, which no file of text can hold


class Rewriter:
    """Says texts in a manner by a model, from the cache where it has been asked before.

    Args:
        ask: (system prompt, text) -> answer.
        model: its name, part of the cache's key.
        cache: a JSONL file; it grows by one line an answer. Lines that hold none, such as a cut
            last one, are passed over.
        seed: part of the key, for models that answer differently each time.

    Raises ValueError if ``cache`` is a folder.
    """

    def __init__(
        self, ask: Callable[[str, str], str], model: str, cache: Path | str, seed: int = 0
    ) -> None:
        self._ask, self._model, self._cache, self._seed = ask, model, Path(cache), seed
        if self._cache.is_dir():
            raise ValueError(f"{cache} is a folder: name the file that keeps the answers.")
        self._known = dict(_read(self._cache))

    def __call__(self, text: str, manner: str) -> str:
        """Return ``text`` in ``manner``.

        Raises ValueError for an unknown manner, and for an answer that is no text, which is not
        kept: the next call asks again.
        """
        if manner not in TONES:
            raise ValueError(f"There is no manner {manner!r}. Choose one of: {', '.join(MANNERS)}.")
        prompt = PROMPT.format(tone=TONES[manner])
        asked = {
            "text": text,
            "manner": manner,
            "model": self._model,
            "prompt": prompt,
            "seed": self._seed,
        }
        key = _key(asked)
        if key not in self._known:
            answer = self._ask(prompt, text)
            if not _is_said(answer):
                raise ValueError(
                    f"The model {self._model!r} answered {answer!r:.60} for {text!r:.60}: an "
                    "answer is a text that is not blank. It is not kept; ask again, or another "
                    "model."
                )
            self._known[key] = answer
            self._append(asked | {"answer": answer})
        return self._known[key]

    def _append(self, line: dict[str, object]) -> None:
        make_folder(self._cache.parent)
        with open_output(self._cache, "ab+") as file:
            file.seek(-1 if file.tell() else 0, os.SEEK_END)
            whole = file.read() in (b"", b"\n")
            file.write((("" if whole else "\n") + json.dumps(line) + "\n").encode())


def _key(asked: dict[str, object]) -> str:
    return blake2b(json.dumps(asked, sort_keys=True).encode(), digest_size=16).hexdigest()


def _is_said(answer: object) -> bool:
    """Return whether ``answer`` is a text that is not blank and can be written."""
    return isinstance(answer, str) and bool(answer.strip()) and not _HALF.search(answer)


def _read(cache: Path) -> list[tuple[str, str]]:
    """Return (key, answer) of every whole line."""
    found = []
    for line in cache.read_bytes().split(b"\n") if cache.is_file() else ():
        try:
            kept = json.loads(line)
            answer = kept.pop("answer")
        except (ValueError, KeyError, AttributeError, RecursionError):
            continue
        if _is_said(answer):
            found.append((_key(kept), answer))
    return found
