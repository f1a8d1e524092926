"""Read and write result rows, which are lines of JSON that describe one measurement each.

A row contains its identity (:data:`IDENTITY`) and its measures (:data:`MEASURES`). An evaluation
appends to a ``.jsonl`` file; shipped files end in ``.jsonl.gz``. If a process was killed while it
wrote, a ``.jsonl`` file may end in an incomplete line. Such a line is ignored, and the next append
removes it.
"""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.core.files import atomic_text, make_folder, open_text
from mitigate.core.json_files import parse_json
from mitigate.core.names import counted, short
from mitigate.core.output import open_output, writing
from mitigate.worlds.seeded import RETURN

if TYPE_CHECKING:
    from mitigate.worlds.episodes import Episode

Row = dict[str, Any]
ROWS = "rows.jsonl"  # name of the row file in an evaluation folder
IDENTITY: dict[str, Any] = {
    "agent": str,  # hash of weights, code, settings, sensors and guards (agents/fingerprint.py)
    "name": str,  # column name in tables, such as "base" or "da_per_episode"
    "corruption": str,  # "clean" or a corruption
    "severity": (int, float),
    "split": str,
    "episode_id": str,
    "seed": int,
    "suite": str,  # SUITE_VERSION of the corruptions
    "rule": str,  # rule of success
}
SCORES = ("success", "spl", RETURN)
REQUIRED = IDENTITY | {"success": (int, float), "spl": (int, float)}
_REQUIRED_OF_RETURN = IDENTITY | {RETURN: (int, float)}
MEASURES = (
    *("success", "spl", "path_length", "geodesic_distance", "distance_to_goal", "ndtw"),
    *("collisions", "decisions", "steps", "cut", "limit"),
)
SCENE = "scene"  # key of the entry that names the episode's scene
SUFFIXES = (".jsonl", ".jsonl.gz")
LONGEST_LINE = 1 << 16  # maximum number of characters of a row (heuristic); a row has about 450
LONGEST_TEXT = 200  # maximum number of characters of an entry (heuristic)
GREATEST = 1e9  # maximum value of a measure, in metres or steps (heuristic)
# pattern of corruption names; the name of a pair contains +
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*")
_HASH = re.compile(r"[A-Za-z0-9_.-]+")
_TEXTS = {key for key, kind in IDENTITY.items() if kind is str} | {"version", "weights", SCENE}
# patterns that match the ids of generated episodes and of episodes from the Habitat bridge
_OF_A_SCENE = re.compile(r"(\d+)-\w+-\d+|(.+)/[^/]+")
# the smallest and the greatest value of each number
_LIMITS = {
    **dict.fromkeys(MEASURES, (0, GREATEST)),
    **dict.fromkeys(("severity", "success", "spl", "ndtw", "cut"), (0, 1)),
    "seed": (-(2**63), 2**63),
    RETURN: (-GREATEST, GREATEST),
}
_ROUNDING = 1e-9
# byte order mark that Windows editors write; if files were joined, it may occur in the middle
_MARK = "\ufeff"


def identity(row: Row) -> tuple:
    """Return the identity of ``row``; rows with equal identities are the same measurement."""
    values = tuple(float(row[key]) if key == "severity" else row[key] for key in IDENTITY)
    # rows of a corruption from another package contain the version of that corruption
    return (*values, row.get("version", ""))


def of_episode(episode: Episode) -> Row:
    """Return the entries of a row that identify its episode.

    If the scene has a valid name, an entry with this name is included.
    """
    scene = stem_of(episode.scene_id)
    valid = scene and not allowed(SCENE, scene)
    return {"episode_id": episode.episode_id, **({SCENE: scene} if valid else {})}


def stem_of(scene: str) -> str:
    """Return the name of a scene: its file name without the folder, ".basis" and ".glb"."""
    return scene.rpartition("/")[2].removesuffix(".glb").removesuffix(".basis")


def scene_of(row: Row) -> str:
    """Return the scene of a row's episode.

    The scene is read from the entry :data:`SCENE`. Rows of older versions and of the bridge have no
    such entry, so the scene is read from the episode id.

    Raises:
        ValueError: If the row names no scene.
    """
    match = _OF_A_SCENE.fullmatch(row["episode_id"])
    scene = row.get(SCENE) or (match and (match[1] or match[2]))
    if not scene:
        raise ValueError(
            f"The rows do not name the scene of episode {short(row['episode_id'])}. Evaluate again "
            "(new rows name the scene), or resample episodes."
        )
    return str(scene)


def read(path: Path | str) -> list[Row]:
    """Return the rows of one file, in order.

    An incomplete last line of a plain file is ignored.

    Raises:
        ValueError: If a row is invalid. The message names the file, the line and the key.
    """
    rows: list[Row] = []
    try:
        with open_text(path) as file:
            file.reconfigure(errors="surrogateescape")
            lines = iter(lambda: file.readline(LONGEST_LINE + 1), "")
            for number, line in enumerate(lines, 1):
                row = _parse(line)
                cut = row is None and len(line) <= LONGEST_LINE and not line.endswith("\n")
                if cut and Path(path).suffix != ".gz":
                    break
                if problem := _problem(row):
                    advice = "Delete the line and evaluate again."
                    if not rows:
                        advice = "Check that this is a file of result rows."
                    raise ValueError(
                        f"{path}, line {number} {problem}. A result row must be one JSON object "
                        f"per line with {', '.join(REQUIRED)}. {advice}"
                    )
                rows.append(row)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise ValueError(
            f"{path} is damaged or not a file of result rows ({error}). Fetch or evaluate it again."
        ) from error
    return rows


def append(path: Path | str, rows: Iterable[Row]) -> None:
    """Append ``rows`` to a ``.jsonl`` file by a single write; create the file if needed."""
    path = Path(path)
    text = "".join(_line(row) for row in rows)
    make_folder(path.parent)
    with writing(path), open_output(path, "ab+") as file:
        _repair(file)
        file.write(text.encode())
        file.flush()
        os.fsync(file.fileno())


def write(path: Path | str, rows: Iterable[Row], *, fewer: bool = False) -> None:
    """Replace the content of the file ``path`` by ``rows``, atomically.

    Args:
        path: the file; it may not exist yet.
        rows: all rows of the new file.
        fewer: whether the new file may have fewer rows. The caller must then have checked that no
            row is lost.

    Raises:
        ValueError: If ``fewer`` is false, and the existing file is damaged or has more rows than
            ``rows``. The file is then not changed.
    """
    path, rows = Path(path), list(rows)
    before = len(read(path)) if path.exists() and not fewer else 0
    if len(rows) < before:
        raise ValueError(
            f"{path} holds {counted(before, 'row')}, but only {len(rows)} would replace them. "
            "It was not changed. Find out why rows are missing, or move the file and run again."
        )
    with atomic_text(path) as file:
        file.writelines(_line(row) for row in rows)


def cuts(rows: Iterable[Row]) -> str:
    """State how many episodes were cut off by the world's ``limit=``; return "" if none were."""
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
    """Return the rows of all ``paths``, which are row files or folders.

    :func:`unique` removes duplicate rows. Files in a folder that contain other JSON lines are
    ignored.

    Raises:
        FileNotFoundError: If a path does not exist, or a folder contains no rows.
    """
    return unique(row for path in paths for file in files(path) for row in read(file))


def unique(rows: Iterable[Row]) -> list[Row]:
    """Return one row per identity.

    If several rows have the same identity, the last one takes the position of the first. Warns if
    such rows differ in success or SPL.
    """
    by_identity: dict[tuple, Row] = {}
    different: list[Row] = []
    for row in rows:
        key = identity(row)
        before = by_identity.get(key)
        if before and any(before.get(score) != row.get(score) for score in SCORES):
            different.append(row)
        by_identity[key] = row
    if different:
        first = different[0]
        warnings.warn(
            f"{len(different)} rows have another success or SPL than an earlier row of the same "
            f"agent, episode and condition (first {first['name']}, episode {first['episode_id']}, "
            f"{first['corruption']}). The last row counts. Name the files of one evaluation.",
            # Python prints a repeated warning only once if it always comes from the same line
            stacklevel=1,
        )
    return list(by_identity.values())


def files(path: Path | str) -> list[Path]:
    """Return all row files in and below the folder ``path``, or ``path`` itself if it is a file.

    Raises:
        FileNotFoundError: If the folder contains no row files.
    """
    path = Path(path)
    if not path.is_dir():
        return [path]
    # rglob() is recursive and fails in folders that are nested a thousand levels deep
    names = (Path(folder, name) for folder, _, files in os.walk(path) for name in files)
    row_files = [p for p in names if p.name.endswith(SUFFIXES) and _holds_rows(p)]
    if not row_files:
        raise FileNotFoundError(
            f"No result rows under {path}: it has no {' or '.join(SUFFIXES)} file that begins with "
            "a row. Name a run folder or a row file, or evaluate first with `make evaluate`."
        )
    return sorted(row_files)


def _holds_rows(path: Path) -> bool:
    try:
        with open_text(path) as file:
            line = file.readline(LONGEST_LINE + 1)
    except (UnicodeDecodeError, OSError):
        return True  # the file is damaged; read() will raise an error that explains it
    first = _parse(line)
    if first is None and line.strip() and len(line) <= LONGEST_LINE:
        return True
    return isinstance(first, dict) and IDENTITY.keys() <= first.keys()


def _parse(line: str) -> Any:
    """Return the JSON value of a line, or None if the line is damaged or too long."""
    try:
        # raises ValueError if the line has surrogates, which stand for bytes that are not UTF-8
        line.encode()
        return parse_json(line.removeprefix(_MARK)) if len(line) <= LONGEST_LINE else None
    except (ValueError, RecursionError):
        return None


def _problem(row: Any) -> str:
    if not isinstance(row, dict):
        return f"is not a JSON object in UTF-8 (finite numbers, at most {LONGEST_LINE} characters)"
    required = _REQUIRED_OF_RETURN if row.get("rule") == RETURN else REQUIRED
    lacking = [key for key in required if key not in row]
    if lacking:
        return f"lacks {', '.join(lacking)}"
    for key, kind in required.items():
        if not isinstance(row[key], kind):
            kinds = kind if isinstance(kind, tuple) else (kind,)
            expected = " or ".join(one.__name__ for one in kinds)
            actual = type(row[key]).__name__
            return f"has a wrong {key}: {short(row[key])} ({expected}, not {actual})"
    for key, value in row.items():
        if expected := (_allowed_text if isinstance(value, str) else allowed)(key, value):
            return f"has a wrong {short(key)}: {short(value)} ({expected})"
    return ""


def allowed(key: str, value: Any) -> str:
    """Describe the allowed values if ``value`` is invalid for ``key``, else return ""."""
    if key in _LIMITS:
        return _allowed_number(key, value)
    if key == "corruption" and not _NAME.fullmatch(value):
        return "a name of letters, digits and _.+-"
    if key == "agent" and not _HASH.fullmatch(value):
        return "a hash: letters, digits and _.-"
    if key in REQUIRED and value == "":
        return "a text that is not empty"
    if key in _TEXTS and not (
        isinstance(value, str) and len(value) <= LONGEST_TEXT and value.isprintable()
    ):
        return f"a line of at most {LONGEST_TEXT} printable characters"
    return ""


# most rows of a file have the same texts
_allowed_text = lru_cache(maxsize=4096)(allowed)


def _allowed_number(key: str, value: Any) -> str:
    low, high = _LIMITS[key]
    if isinstance(value, bool):  # bool is a subclass of int
        return "a number: 1 for true, 0 for false"
    if isinstance(value, (int, float)):
        if low <= value <= high + _ROUNDING:
            return ""
    elif value is None and key in ("severity", *MEASURES):
        return ""
    return "a whole number below 2^63" if key == "seed" else f"a number from {low:g} to {high:g}"


def _line(row: Row) -> str:
    if problem := _problem(row):
        raise ValueError(
            f"A result row {problem}: {row!r:.300}. It must have {', '.join(REQUIRED)}."
        )
    try:
        return json.dumps(row, allow_nan=False) + "\n"
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"A result row must hold only finite numbers and strings ({error}), got {row!r:.300}."
        ) from error


def _repair(file: Any) -> None:
    """Add a missing newline at the end of ``file``, or remove an incomplete last line."""
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
