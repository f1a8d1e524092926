"""Result rows: one JSON line an episode, saying exactly what produced it.

A row holds its identity (:data:`IDENTITY`) and its measures (:data:`MEASURES`). Files end in
``.jsonl`` (appended to during an evaluation) or ``.jsonl.gz`` (shipped). A plain file that was cut
in the middle of its last line, as by a kill, is read up to there and mended by the next append.
"""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Iterable
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.core.files import atomic_text, make_folder, open_text
from mitigate.core.json_files import parse_json
from mitigate.core.names import counted, short
from mitigate.core.output import open_output, writing

if TYPE_CHECKING:
    from mitigate.worlds.episodes import Episode

Row = dict[str, Any]
ROWS = "rows.jsonl"  # in the folder of an evaluation
IDENTITY: dict[str, Any] = {
    "agent": str,  # agents/fingerprint.py: weights, code, settings, sensors, what stands in front
    "name": str,  # "base", "da_per_episode" ...: the column of a table
    "corruption": str,  # "clean" or one of the suite
    "severity": (int, float),
    "split": str,
    "episode_id": str,
    "seed": int,
    "suite": str,  # SUITE_VERSION of the corruptions
    "rule": str,  # what counts as success
}
REQUIRED = IDENTITY | {"success": (int, float), "spl": (int, float)}
MEASURES = (
    *("success", "spl", "path_length", "geodesic_distance", "distance_to_goal", "ndtw"),
    *("collisions", "decisions", "steps", "cut", "limit"),
)
SCENE = "scene"  # the entry of a row that says in which scene its episode is
SUFFIXES = (".jsonl", ".jsonl.gz")
LONGEST_LINE = 1 << 16  # characters; a row has about 450 (ours)
LONGEST_TEXT = 200  # characters of an entry (ours)
GREATEST = 1e9  # of a measure: metres, steps (ours)
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*")  # a corruption; + is between those of a pair
_HASH = re.compile(r"[A-Za-z0-9_.-]+")
_TEXTS = (*(key for key, kind in IDENTITY.items() if kind is str), "version", "weights", SCENE)
_OF_A_SCENE = re.compile(r"(\d+)-\w+-\d+|(.+)/[^/]+")  # ids of apartments; of the bridge
_SHARES = ("severity", "success", "spl", "ndtw", "cut")  # numbers from 0 to 1
_NUMBERS = ("severity", "seed", *MEASURES)
_ROUNDING = 1e-9
_MARK = "\ufeff"  # the byte order mark of editors of Windows; joined files have it in the middle


def identity(row: Row) -> tuple:
    """Return what makes ``row`` itself: two rows with one identity are the same measurement."""
    own = tuple(float(row[key]) if key == "severity" else row[key] for key in IDENTITY)
    return (*own, row.get("version", ""))  # of a corruption that another package brings


def of_episode(episode: Episode) -> Row:
    """Return what a row says of which episode it is, and of its scene if that has a name."""
    scene = stem_of(episode.scene_id)
    named = scene and not allowed(SCENE, scene)
    return {"episode_id": episode.episode_id, **({SCENE: scene} if named else {})}


def stem_of(scene: str) -> str:
    """The name of a scene: of its file, without its folder and what a GLB file ends in."""
    return scene.rpartition("/")[2].removesuffix(".glb").removesuffix(".basis")


def scene_of(row: Row) -> str:
    """Return the scene of a row's episode: what the row says, or the id's part that names it, as in
    rows of older versions and of the bridge.

    Raises ValueError if neither does.
    """
    found = _OF_A_SCENE.fullmatch(row["episode_id"])
    scene = row.get(SCENE) or (found and (found[1] or found[2]))
    if not scene:
        raise ValueError(
            f"The rows do not say in which scene episode {short(row['episode_id'])} is, so scenes "
            "cannot be drawn: evaluate again (rows now say it), or draw episodes."
        )
    return str(scene)


def read(path: Path | str) -> list[Row]:
    """Return the rows of one file, in order.

    Raises ValueError naming file, line and key if a row is not one; a last line cut short in a
    plain file is left out.
    """
    rows: list[Row] = []
    try:
        with open_text(path) as file:
            file.reconfigure(errors="surrogateescape")
            number = 0
            while line := file.readline(LONGEST_LINE + 1):
                number += 1
                row, text = _parse(line), _is_text(line)
                cut = row is None and len(line) <= LONGEST_LINE and not line.endswith("\n")
                if cut and text and not _gzipped(path):
                    break
                problem = _problem(row) if text else "is not UTF-8"
                if problem:
                    cure = "Delete the line and evaluate again." if rows else "Is it such a file?"
                    raise ValueError(
                        f"{path}, line {number} {problem}. A result row is one JSON object a line "
                        f"with {', '.join(REQUIRED)}. {cure}"
                    )
                rows.append(row)
    except OSError as error:
        if isinstance(error, FileNotFoundError):
            raise
        raise ValueError(
            f"{path} is damaged or not a file of result rows ({error}): fetch or evaluate it again."
        ) from error
    return rows


def append(path: Path | str, rows: Iterable[Row]) -> None:
    """Add ``rows`` to the end of ``path`` and flush them to disk; create it if need be.

    A plain file grows by one write; a ``.gz`` file is rewritten whole, atomically.
    """
    path, rows = Path(path), list(rows)
    text = "".join(_line(row) for row in rows)
    if _gzipped(path):
        write(path, chain(read(path) if path.exists() else [], rows))
        return
    make_folder(path.parent)
    with writing(path), open_output(path, "ab+") as file:
        _mend(file)
        file.write(text.encode())
        file.flush()
        os.fsync(file.fileno())


def write(path: Path | str, rows: Iterable[Row], *, fewer: bool = False) -> None:
    """Replace the file ``path`` by ``rows``, atomically.

    Args:
        path: The file, which need not exist.
        rows: All rows of the new file.
        fewer: Whether they may be fewer than the file holds: the caller has compared them.

    Raises:
        ValueError: The file holds more rows than ``rows``, or is damaged. It stays as it is.
    """
    path, rows = Path(path), list(rows)
    before = len(read(path)) if path.exists() and not fewer else 0
    if len(rows) < before:
        raise ValueError(
            f"{path} holds {counted(before, 'row')}, and only {len(rows)} would replace them. The "
            "file was left as it is. Find out why rows are missing, or move the file to another "
            "folder and run the same command again."
        )
    with atomic_text(path) as file:
        file.writelines(_line(row) for row in rows)


def upsert(*parts: Iterable[Row]) -> list[Row]:
    """Return the rows of all ``parts``, one an identity: the last in the first one's place."""
    return list({identity(row): row for row in chain(*parts)}.values())


def cuts(rows: Iterable[Row]) -> str:
    """Return in words how many episodes a world's ``limit=`` cut; empty if none were."""
    rows = list(rows)
    cut = [row for row in rows if row.get("cut")]
    if not cut:
        return ""
    limits = " and ".join(f"{n:g}" for n in sorted({row["limit"] for row in cut if "limit" in row}))
    return (
        f"{len(cut):,} of {counted(len(rows), 'episode')} were cut by limit={limits or 'unknown'} "
        "before the environment ended them; a cut episode is a failure unless it reports success."
    )


def gather(paths: Iterable[Path | str]) -> list[Row]:
    """Return the rows of files and of all row files under folders, as :func:`unique` does.

    In a folder, JSON lines of another kind are passed over. Raises FileNotFoundError if a path
    does not exist or a folder holds no rows.
    """
    return unique(row for path in paths for file in files(path) for row in read(file))


def unique(rows: Iterable[Row]) -> list[Row]:
    """Return one row per identity, the last in the place of the first; warn of those with another
    success or SPL than an earlier one."""
    held: dict[tuple, Row] = {}
    other: list[Row] = []
    for row in rows:
        before = held.get(identity(row), row)
        other += [row] if any(before[key] != row[key] for key in ("success", "spl")) else []
        held[identity(row)] = row
    if other:
        warnings.warn(
            f"{len(other)} rows say another success or SPL than one before of the same agent, "
            f"episode and condition (first {other[0]['name']}, episode {other[0]['episode_id']}, "
            f"{other[0]['corruption']}): the last counts. Name the files of one evaluation.",
            stacklevel=1,  # one place, so that the same text is printed once
        )
    return list(held.values())


def files(path: Path | str) -> list[Path]:
    """Return ``path``, or of a folder all row files in and below it. Raises FileNotFoundError if
    there is none."""
    path = Path(path)
    if not path.is_dir():
        return [path]
    named = (p for p in path.rglob("*") if p.name.endswith(SUFFIXES) and not p.is_dir())
    found = [p for p in named if _holds_rows(p)]
    if not found:
        raise FileNotFoundError(
            f"No result rows under {path}: no {' or '.join(SUFFIXES)} file there begins with a "
            "row. Name a run folder or a row file, or evaluate first with `make evaluate`."
        )
    return sorted(found)


def _holds_rows(path: Path) -> bool:
    try:
        with open_text(path) as file:
            line = file.readline(LONGEST_LINE + 1)
    except (UnicodeDecodeError, OSError):
        return True  # damaged: let read() say so
    first = _parse(line)
    if first is None and line.strip() and len(line) <= LONGEST_LINE:
        return True
    return isinstance(first, dict) and IDENTITY.keys() <= first.keys()


def _is_text(line: str) -> bool:
    """Whether the bytes of a line were UTF-8: others were read as half of a surrogate pair."""
    try:
        line.encode()
    except UnicodeEncodeError:
        return False
    return True


def _parse(line: str) -> Any:
    try:
        return parse_json(line.removeprefix(_MARK)) if len(line) <= LONGEST_LINE else None
    except (ValueError, RecursionError):
        return None


def _problem(row: Any) -> str:
    if not isinstance(row, dict):
        return f"is not a JSON object of finite numbers and at most {LONGEST_LINE} characters"
    lacking = [key for key in REQUIRED if key not in row]
    if lacking:
        return f"lacks {', '.join(lacking)}"
    for key, kind in REQUIRED.items():
        if not isinstance(row[key], kind):
            kinds = kind if isinstance(kind, tuple) else (kind,)
            wanted = " or ".join(one.__name__ for one in kinds)
            found = type(row[key]).__name__
            return f"has a wrong {key}: {short(row[key])} ({wanted}, not {found})"
    for key, value in row.items():
        wanted = allowed(key, value)
        if wanted:
            return f"has a wrong {short(key)}: {short(value)} ({wanted})"
    return ""


def allowed(key: str, value: Any) -> str:
    """Return what the ``value`` of a row's ``key`` may be in place of what it is; empty if it is
    good."""
    if key in _NUMBERS and isinstance(value, bool):  # which Python takes for one
        return "a number: 1 for true, 0 for false"
    if key in _SHARES and value is not None and not _number(value, 0, 1):
        return "a number from 0 to 1"
    if key == "corruption" and not _NAME.fullmatch(value):
        return "a name of letters, digits and _.+-"
    if key == "agent" and not _HASH.fullmatch(value):
        return "a hash: letters, digits and _.-"
    if key in REQUIRED and value == "":
        return "it is empty"
    if key in _TEXTS and not (
        isinstance(value, str) and len(value) <= LONGEST_TEXT and value.isprintable()
    ):
        return f"a line of at most {LONGEST_TEXT} printable characters"
    if key == "seed" and not _number(value, -(2**63), 2**63):
        return "a whole number below 2^63"
    if key in MEASURES and value is not None and not _number(value, 0, GREATEST):
        return f"a number from 0 to {GREATEST:g}"
    return ""


def _number(value: Any, low: float, high: float) -> bool:
    return isinstance(value, (int, float)) and low <= value <= high + _ROUNDING


def _line(row: Row) -> str:
    problem = _problem(row)
    if problem:
        raise ValueError(f"A result row {problem}: {row!r:.300}. Needed: {', '.join(REQUIRED)}.")
    try:
        return json.dumps(row, allow_nan=False) + "\n"
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"A result row holds what JSON cannot ({error}): {row!r:.300}. Use plain finite "
            "numbers and strings."
        ) from error


def _mend(file: Any) -> None:
    """Make ``file`` end in a whole line: end the last one, or cut it off if it is not whole."""
    size = file.seek(0, os.SEEK_END)
    tail = b""
    while b"\n" not in tail and len(tail) < size:
        file.seek(max(0, size - len(tail) - 4096))
        tail = file.read(size - len(tail) - file.tell()) + tail
    last = tail[tail.rfind(b"\n") + 1 :]
    if last and _parse(last.decode(errors="replace")) is None:
        file.truncate(size - len(last))
    elif last:
        file.write(b"\n")


def _gzipped(path: Path | str) -> bool:
    return Path(path).suffix == ".gz"
