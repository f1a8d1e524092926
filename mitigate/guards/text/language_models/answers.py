"""Cache the answers of an endpoint in a SQLite file, which is treated as untrusted."""

from __future__ import annotations

import os
import sqlite3
from contextlib import suppress
from pathlib import Path

from mitigate.core.files import make_folder
from mitigate.core.output import open_output

LONGEST = 1 << 16  # maximum number of characters of an answer (heuristic)
# maximum seconds to wait for a lock of another process, in addition to any deadline (heuristic)
WAIT = 0.1
_NO_CACHE = "is not a cache of endpoint answers"
_OTHER = "Name another file, or delete this one."


class AnswerCache:
    """Store texts by name.

    The constructor raises an error for a file that is not a cache. If the file is damaged later, or
    another process writes slowly, no error is raised. The only effect is one more request.

    Raises:
        ValueError: If the file is not a cache of this kind.
    """

    def __init__(self, path: Path) -> None:
        make_folder(path.parent)
        # reject a symbolic link, because SQLite would follow it
        if path.exists() or path.is_symlink():
            open_output(path, "ab").close()
        self._path = path.resolve()
        # connections by process id; a forked process must not use a connection of its parent
        self._opened: dict[int, sqlite3.Connection] = {}
        self._wait = 5.0
        try:
            file = self._file
            file.execute("CREATE TABLE IF NOT EXISTS answers (name TEXT PRIMARY KEY, answer)")
            objects = file.execute("SELECT type, name FROM sqlite_master").fetchall()
        except sqlite3.Error as error:
            if "locked" in str(error):
                what = f"{path} is in use by another process: wait for it, or name another file."
                raise ValueError(what) from error
            if isinstance(error, sqlite3.OperationalError):  # such as a missing folder
                raise ValueError(f"{path} cannot be opened ({error}). {_OTHER}") from error
            raise ValueError(f"{path} {_NO_CACHE} ({error}). {_OTHER}") from error
        others = [name for kind, name in objects if (kind, name) not in _OURS]
        if others:  # SQLite would run a view or trigger in the file as part of our queries
            raise ValueError(f"{path} {_NO_CACHE} (it holds {others[0]!r:.60}). {_OTHER}")
        self._opened.clear()
        self._wait = WAIT

    @property
    def _file(self) -> sqlite3.Connection:
        if os.getpid() not in self._opened:
            self._opened[os.getpid()] = connection = sqlite3.connect(self._path, self._wait)
            connection.execute("PRAGMA trusted_schema = OFF")
        return self._opened[os.getpid()]

    def get(self, name: str) -> str | None:
        """Return the text under ``name``, or None if it is missing or invalid."""
        try:
            row = self._file.execute(
                "SELECT answer FROM answers WHERE name = ? AND typeof(answer) = 'text' "
                "AND length(answer) <= ?",
                (name, LONGEST),
            ).fetchone()
        except (sqlite3.Error, UnicodeDecodeError):
            return None
        return None if row is None else row[0]

    def put(self, name: str, answer: str) -> None:
        """Store ``answer``, unless it is too long for ``get`` or the file cannot be written."""
        if len(answer) > LONGEST:
            return
        with suppress(sqlite3.Error, UnicodeEncodeError), self._file as file:
            file.execute("INSERT OR REPLACE INTO answers VALUES (?, ?)", (name, answer))


_OURS = (("table", "answers"), ("index", "sqlite_autoindex_answers_1"))
