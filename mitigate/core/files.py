"""Files written whole or not at all; text and JSON, gzipped or not, opened by content, streamed."""

from __future__ import annotations

import difflib
import gzip
import hashlib
import io
import json
import os
import re
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn, TextIO

GZIP_MAGIC = b"\x1f\x8b"  # RFC 1952
CHUNK = 1 << 16  # characters read at a time (ours)
RECORDING = "recording.json"  # in the folder of a recording by `mitigate run record=FOLDER`
LARGEST_VALUE = 1 << 25  # characters of one JSON value; more means a broken file (ours)


PACKAGE = Path(__file__).resolve().parents[1]  # the folder of mitigate
ROOT = PACKAGE.parent  # of the checkout, or of all installed packages


def find(path: str | Path) -> Path:
    """Return ``path``, or where the project itself has it, if it does not exist from here: the
    configs name shipped weights and episodes as ``checkpoints/base``, ``mitigate/worlds/...``."""
    places = (Path(path), ROOT / path, PACKAGE / path)
    return next((place for place in places if place.exists()), Path(path))


def open_text(path: Path | str) -> TextIO:
    """Open ``path`` for reading as UTF-8; gzip is told by the first two bytes, not by the name.

    Raises FileNotFoundError, with the nearest names in the folder, if there is no such file.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(_absent(path))
    with open(path, "rb") as file:
        gzipped = file.read(2) == GZIP_MAGIC
    return gzip.open(path, "rt", encoding="utf-8") if gzipped else open(path, encoding="utf-8")


@contextmanager
def atomic_text(path: Path | str) -> Iterator[TextIO]:
    """Yield a UTF-8 text file that becomes ``path`` only if the block ends without an error.

    A name ending in ``.gz`` is gzipped, without time stamp or name: equal text, equal bytes.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with open(temporary, "wb") as raw:
            if path.suffix == ".gz":
                with (
                    gzip.GzipFile("", "wb", fileobj=raw, mtime=0) as packed,
                    io.TextIOWrapper(packed, encoding="utf-8", newline="\n") as text,
                ):
                    yield text
            else:
                plain = io.TextIOWrapper(raw, encoding="utf-8", newline="\n")
                yield plain
                plain.detach()  # flushes, and leaves the file open
            raw.flush()
            os.fsync(raw.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def sha256(path: Path | str) -> str:
    """Return the sha256 of a file, as hex."""
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def write_atomically(path: Path, write: Callable[[Path], Any]) -> Path:
    """Call ``write`` on a temporary neighbour of ``path``, flush it to disk, then rename it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        with open(temporary, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
    return path


def write_bytes(path: Path | str, data: bytes) -> None:
    """Write ``data`` to ``path``, which is there whole or not at all. Makes the folder."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with open(temporary, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def json_members(path: Path | str, streamed: str) -> Iterator[tuple[str, Any]]:
    """Yield the (key, value) pairs of the JSON object in ``path``, one value in memory at a time.

    The value of the key ``streamed``, if it is a list, comes as an iterator over its items.
    Raises ValueError if the file is no JSON object, is malformed, cut short or not text.
    """
    with open_text(path) as file:
        json_file = _JsonFile(file, path)
        json_file.expect("{", "a JSON object")
        for _ in json_file.until("}"):
            key = json_file.value()
            json_file.expect(":", "':' after a key")
            if key == streamed and json_file.accept("["):
                items = (json_file.value() for _ in json_file.until("]"))
                yield key, items
                for _ in items:  # what the caller left unread
                    pass
            else:
                yield key, json_file.value()


class _JsonFile:
    """Reads JSON from an open text file value by value; ``_at`` is the place in the buffer."""

    _decode = json.JSONDecoder().raw_decode
    _space = re.compile(r"[ \t\r\n]*")

    def __init__(self, file: TextIO, path: Path | str) -> None:
        self._file, self._path = file, path
        self._text, self._at, self._before = "", 0, 0

    def until(self, bracket: str) -> Iterator[None]:
        """Yield before each comma-separated item, up to the closing ``bracket``."""
        if self.accept(bracket):
            return
        while True:
            yield
            if self.accept(bracket):
                return
            self.expect(",", f"',' or '{bracket}'")

    def expect(self, character: str, name: str) -> None:
        """Pass ``character`` or raise."""
        if not self.accept(character):
            self._fail(f"expected {name}")

    def accept(self, character: str) -> bool:
        """Pass white space, and ``character`` if it comes next; return whether it did."""
        while True:
            self._at = self._space.match(self._text, self._at).end()  # type: ignore[union-attr]
            if self._at < len(self._text) or not self._more():
                break
        found = self._text.startswith(character, self._at)
        self._at += len(character) * found
        return found

    def value(self) -> Any:
        """Return the next JSON value, reading on until it is whole."""
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
            except RecursionError:
                self._fail("too many levels")

    def _more(self) -> bool:
        """Append what comes next, as much as is held, and drop what is done."""
        self._before += self._at
        self._text = self._text[self._at :]
        self._at = 0
        try:
            more = self._file.read(max(CHUNK, len(self._text)))
        except (EOFError, zlib.error, gzip.BadGzipFile, UnicodeDecodeError) as error:
            self._fail(str(error))
        self._text += more
        return bool(more)

    def _fail(self, problem: str) -> NoReturn:
        raise ValueError(
            f"{self._path} is not whole JSON: {problem}, near character "
            f"{self._before + self._at}. It is cut short, damaged or another kind of file: "
            "download or write it again."
        )


def _absent(path: Path) -> str:
    names = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, names, n=3, cutoff=0.5)
    if path.is_dir():
        return f"{path} is a folder, not a file: name a file in it."
    if not path.parent.is_dir():
        return f"There is no file {path}, nor its folder: check the path."
    found = f"the nearest names there are {', '.join(near)}" if near else "nothing there is near"
    return f"There is no file {path}; {found}. Check the path."
