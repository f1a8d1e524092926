"""Read untrusted JSON files: small files at once, large files one value at a time."""

from __future__ import annotations

import gzip
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn, TextIO

from mitigate.core.files import lfs_problem, open_text, read_bounded
from mitigate.core.names import short
from mitigate.core.output import UnsafePathError

CHUNK = 1 << 16  # number of characters that are read at a time (heuristic)
# maximum length of one JSON value in characters (heuristic); a longer value means a broken file
LARGEST_VALUE = 1 << 25
# maximum size in bytes of a JSON file that is read as a whole (heuristic)
# For comparison, the card.json of a hardened agent has about 1e4 bytes.
LARGEST_JSON = 1 << 24
# maximum size in bytes of a JSON file that lists files (heuristic: 100 bytes per listed file)
LARGEST_LIST = 1 << 28


class JsonListError(ValueError):
    """Raised if a file holds a JSON list instead of an object."""


def read_json(path: Path, again: str, most: int = LARGEST_JSON) -> Any:
    """Return the value in the untrusted JSON file ``path``.

    Raises:
        ValueError: If the file has more than ``most`` bytes, holds a number that is not finite, or
            is damaged. Each message ends with the advice ``again``.
        UnsafePathError: If the path is a FIFO, a socket or a device.
    """
    try:
        return parse_json(read_bounded(path, most).decode("utf-8-sig"))
    except UnsafePathError:
        raise
    except (ValueError, RecursionError) as error:
        if pointer := lfs_problem(path):
            raise ValueError(f"{path} {pointer}.") from error
        raise ValueError(f"{path} is truncated or damaged ({error!s:.200}). {again}") from error


def read_object(path: Path, again: str, most: int = LARGEST_JSON) -> dict[str, Any]:
    """Return the JSON object in ``path``; it is read with :func:`read_json`.

    Raises:
        ValueError: If the file is damaged or holds a different kind of value, such as null or a
            list. The message names the file and ends with the text ``again``.
    """
    value = read_json(path, again, most)
    if not isinstance(value, dict):
        raise ValueError(f"{path} must hold a JSON object, got {short(value)}. {again}")
    return value


def parse_json(text: str | bytes) -> Any:
    """Parse JSON like ``json.loads``, but raise ValueError for numbers that are not finite."""
    if isinstance(text, bytes):
        text = text.decode(json.detect_encoding(text), "surrogatepass")
    return _FINITE.decode(text)


def _no_number(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")


def _finite(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise ValueError(f"{digits:.20} is too large a number")
    return value


_FINITE = json.JSONDecoder(parse_constant=_no_number, parse_float=_finite)


def json_members(path: Path | str, streamed: str) -> Iterator[tuple[str, Any]]:
    """Yield the pairs (key, value) of the JSON object in ``path``; keep only one value in memory.

    If the value of the key ``streamed`` is a list, an iterator over its items is yielded instead of
    the list. Raises ValueError if the file is not text, is malformed or truncated, does not contain
    a JSON object, or contains anything after the object.
    """
    with open_text(path) as file:
        json_file = _JsonFile(file, path)
        if json_file.accept("["):
            raise JsonListError(f"{path} must hold a JSON object, got a list.")
        json_file.expect("{", "a JSON object")
        for _ in json_file.until("}"):
            key = json_file.value()
            if not isinstance(key, str):
                raise ValueError(f"The keys of {path} must be text, got {key!r:.60}.")
            json_file.expect(":", "':' after a key")
            if key == streamed and json_file.accept("["):
                items = (json_file.value() for _ in json_file.until("]"))
                yield key, items
                for _ in items:  # skip the items that the caller did not read
                    pass
            else:
                yield key, json_file.value()
        json_file.end()


class _JsonFile:
    """Reads JSON values from an open text file through the buffer ``_text``."""

    _decode = json.JSONDecoder().raw_decode
    _space = re.compile(r"[ \t\r\n]*")

    def __init__(self, file: TextIO, path: Path | str) -> None:
        self._file = file
        self._path = path
        self._text = ""
        self._at = 0  # current position in the buffer
        self._before = 0  # number of characters in the file before the buffer

    def until(self, bracket: str) -> Iterator[None]:
        """Yield once before each comma-separated item, until the closing ``bracket``."""
        if self.accept(bracket):
            return
        while True:
            yield
            if self.accept(bracket):
                return
            self.expect(",", f"',' or '{bracket}'")

    def expect(self, character: str, name: str) -> None:
        """Skip the next character; raise ValueError if it is not ``character``."""
        if not self.accept(character):
            self._fail(f"expected {name}")

    def accept(self, character: str) -> bool:
        """Skip white space, and then ``character`` if it is next; return whether it was."""
        while True:
            self._at = self._space.match(self._text, self._at).end()  # type: ignore[union-attr]
            if self._at < len(self._text) or not self._more():
                break
        accepted = self._text.startswith(character, self._at)
        self._at += len(character) * accepted
        return accepted

    def end(self) -> None:
        """Raise ValueError if the rest of the file contains anything except white space."""
        self.accept("")
        if self._at < len(self._text):
            self._fail("expected the end of the file")

    def value(self) -> Any:
        """Return the next JSON value; read more of the file until the value is complete."""
        self.accept("")
        while True:
            try:
                value, end = self._decode(self._text, self._at)
                if end < len(self._text) or not self._more():
                    self._at = end
                    return value
            except json.JSONDecodeError as error:
                if len(self._text) - self._at > LARGEST_VALUE or not self._more():
                    self._fail(error.msg)
            except ValueError as error:  # the number has more digits than Python can convert
                self._fail(str(error))
            except RecursionError:
                self._fail("too many levels")

    def _more(self) -> bool:
        """Discard the parsed part of the buffer, and append more text from the file.

        The appended part is as long as the rest or longer, so a long value needs few reads.
        Returns False at the end of the file.
        """
        self._before += self._at
        self._text = self._text[self._at :]
        self._at = 0
        try:
            more = self._file.read(max(CHUNK, len(self._text)))
        except (gzip.BadGzipFile, UnicodeDecodeError) as error:
            self._fail(str(error))
        self._text += more
        return bool(more)

    def _fail(self, problem: str) -> NoReturn:
        if pointer := lfs_problem(self._path):
            raise ValueError(f"{self._path} {pointer}.")
        raise ValueError(
            f"{self._path} is not complete JSON: {problem}, near character "
            f"{self._before + self._at}. It is truncated, damaged or another kind of file: "
            "download or write it again."
        )
