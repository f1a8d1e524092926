"""Show, check and add entries of the leaderboard (docs/leaderboard.md).

mitigate leaderboard show --out leaderboard.html
mitigate leaderboard check docs/leaderboard/harden.json
mitigate leaderboard add rows.jsonl.gz --name mine --training-data "R2R-CE train"
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.core.build import located, maker
from mitigate.core.files import find
from mitigate.evaluation import config  # noqa: F401 - registers the options
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry, load
from mitigate.evaluation.leaderboard.from_rows import entry_of, left_out, sensors_of
from mitigate.evaluation.leaderboard.page import render
from mitigate.evaluation.page import document
from mitigate.evaluation.page.command import told
from mitigate.evaluation.rows import Row

FOLDER = "docs/leaderboard"
OUT = Path("runs/leaderboard.html")
CLOSE = 1e-5  # of figures that entries round to six digits (ours)
_OTHERS = re.compile(r"[^\w.-]+")  # signs that the name of an entry's file does not have


def entries_of(paths: Sequence[Path | str] = ()) -> list[LeaderboardEntry]:
    """Return the entries in files and folders; of none, those shipped in ``docs/leaderboard``.

    Raises as ``entry.load``; FileNotFoundError if there is none.
    """
    return [load(file) for file in _files(paths)]


def _files(paths: Sequence[Path | str]) -> list[Path]:
    files: list[Path] = []
    for path in [Path(path) for path in paths] or [find(FOLDER)]:
        files += sorted(path.glob("*.json")) if path.is_dir() else [path]
    if not files:
        raise FileNotFoundError("There is no entry (*.json) in the folders named.")
    return files


def rows_of(entry: LeaderboardEntry) -> list[Row]:
    """Return the rows in the file that ``entry`` names, of other agents, too. Raises
    FileNotFoundError if they are not at hand, ValueError if they are damaged or no file."""
    file = entry.rows["file"]
    if not file or not find(file).exists():
        raise FileNotFoundError(
            f"The rows of {entry.name} are not at hand ({file or 'no file is named'}): fetch them "
            f"to {file or 'a file'}, from the folder in which you run this."
        )
    if not find(file).is_file():
        raise ValueError(
            f"The rows of {entry.name} are said to be in {file}, which is "
            f"{'a folder' if find(file).is_dir() else 'no plain file'}: an entry names one file "
            "of rows. Name it with `mitigate leaderboard add`."
        )
    return result_rows.gather([find(file)])


def differences(entry: LeaderboardEntry, rows: Iterable[Row]) -> list[str]:
    """Return how ``entry`` differs from what ``rows`` say, a line each; none if it does not.

    Of ``rows``, those of its agents, their seeds and its conditions count; a file may hold more.
    Raises ValueError if they hold nothing of the entry.
    """
    agents = {(one["agent"], one["seed"]) for one in entry.agents}
    own = [row for row in rows if (row["agent"], row["seed"]) in agents]
    if not own:
        told = ", ".join(f"{agent} with seed {seed}" for agent, seed in sorted(agents))
        raise ValueError(f"The rows hold none of {told:.300}.")
    again = entry_of(
        [row for row in own if row["corruption"] in entry.SR],
        entry.name,
        severity=entry.severity,
        split=entry.split,
        sensors=entry.sensors,
        training_data=entry.training_data,
        link=entry.link,
        file=entry.rows["file"],
    )
    said, found = _figures(entry), _figures(again)
    return [
        f"{key} is {said.get(key)!r:.120}, but its rows say {found.get(key)!r:.120}"
        for key in said | found
        if key != "version" and not _same(said.get(key), found.get(key))
    ]


def _figures(entry: LeaderboardEntry) -> dict[str, Any]:
    """Return the values of an entry by name, those of its mappings each by its own."""
    held: dict[str, Any] = {}
    for key, value in asdict(entry).items():
        parts = value if isinstance(value, dict) else {}
        held |= {f"{key}, {name},": own for name, own in parts.items()} or {key: value}
    return held


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return all(_same(x, y) for x, y in zip_longest(a, b))
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) < CLOSE
    return bool(a == b)


def show(paths: Sequence[Path | str] = (), out: Path | str = OUT) -> Path:
    """Write the page of the entries in ``paths``; return its path. Errors as :func:`entries_of`
    and ``document.check_out``."""
    document.check_out(out)
    return document.write(render(entries_of(paths)), out)


def check(paths: Sequence[Path | str] = ()) -> list[str]:
    """Print of each entry whether its rows say the same and what of them it leaves out, and which
    files are none; return what is wrong, a line each. Raises FileNotFoundError if there is none."""
    wrong = []
    for file in _files(paths):
        try:
            entry = load(file)
        except (OSError, ValueError) as error:
            print(f"{file}: NO entry", flush=True)
            wrong.append(conf.said(error))
            continue
        try:
            rows = rows_of(entry)
            found, unsaid = differences(entry, rows), left_out(entry, rows)
        except (OSError, ValueError) as error:
            found, unsaid = [conf.said(error)], ""
        named = f"{file}: {entry.name}"
        print(f"{named}, {'NOT as' if found else 'as'} its rows say", flush=True)
        if unsaid:
            print(f"{named}, WARNING: its rows also hold {unsaid:.1000}", flush=True)
        wrong += [f"{named}, {line}" for line in found]
    return wrong


def add(
    paths: Sequence[Path | str],
    name: str,
    *,
    severity: float = 0.6,
    split: str | None = None,
    training_data: str = "",
    link: str = "",
    options: Sequence[str] = (),
    config_dir: Path | None = None,
    folder: Path | str = FOLDER,
    overwrite: bool = False,
) -> Path:
    """Write the entry of the column ``name`` of the rows in ``paths``; return its file.

    The sensors are those of the world of ``options`` (of ``mitigate evaluate``, with the user's
    configs in ``config_dir``) that the kind of agent among them reads; none, and it is said so, if
    the rows are of another world, by their split or rule. Raises ValueError if the file is there
    already, and as ``entry_of``.
    """
    place = Path(folder) / f"{_OTHERS.sub('-', name).strip('.-') or 'entry'}.json"
    if place.exists() and not overwrite:
        raise ValueError(
            f"{place} exists already: replace it with --overwrite, or name another folder "
            "(--folder) if it is another agent's."
        )
    cfg = conf.composed("evaluate", options, config_dir)
    entry = entry_of(
        result_rows.gather(paths),
        name,
        severity=severity,
        split=split,
        training_data=training_data,
        link=link,
        file=_named(paths),
    )
    replace(entry, sensors=_sensors(cfg, entry)).save(place)
    load(place)
    return place


def _sensors(cfg: DictConfig, entry: LeaderboardEntry) -> tuple[str, ...]:
    """A line for each sensor that the config's agent reads; none if its world is not the rows'."""
    world = maker(cfg.env.world)()
    if entry.split not in cfg.env.episodes or entry.rule != world.rule:
        print(
            f"The rows are not of {cfg.env.name} ({entry.split}, {entry.rule}), so the entry says "
            "nothing of sensors. Name the world and the kind of agent: env=..., agent=..., of your "
            "own with --config-dir.",
            flush=True,
        )
        return ()
    read = cfg.agent.get("sensors", getattr(located(cfg.agent._target_), "sensors", None))
    return sensors_of(world.sensors, read)


def _named(paths: Sequence[Path | str]) -> str:
    """Return the one file of the rows, if it is one and lies below this folder."""
    files = [file for path in paths for file in result_rows.files(path)]
    inside = len(files) == 1 and not files[0].is_absolute() and ".." not in files[0].parts
    return files[0].as_posix() if inside else ""


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status: 2 for a bad input, 1 for a wrong entry."""
    parser = _parser()
    given, more = parser.parse_known_args(argv)  # which leaves words behind an option, as of "add"
    options = vars(given)
    what = options.pop("what")
    if unknown := [word for word in more if word.startswith("-")]:
        parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    options["paths"] += more
    if what == "check":
        wrong: list[str] = []
        status = told("leaderboard", lambda: wrong.extend(check(options["paths"])))
        print("\n".join(wrong), end="\n" * bool(wrong))
        return status or int(bool(wrong))
    if what == "show":
        return told("leaderboard", lambda: show(**options))
    words = options.pop("paths")
    paths = [word for word in words if "=" not in word or Path(word).exists()]
    own = [word for word in words if word not in paths]
    if not paths:
        parser.error(f"add: name a row file; there is none of {', '.join(own)}.")
    return told("leaderboard", lambda: add(paths, options=own, **options))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="mitigate leaderboard",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parts = parser.add_subparsers(dest="what", required=True, metavar="show | check | add")
    shown = parts.add_parser("show", help="write the page of entries")
    checked = parts.add_parser("check", help="compute entries again from their rows")
    for part in (shown, checked):
        part.add_argument("paths", nargs="*", metavar="ENTRY", help=f"default: all in {FOLDER}")
    shown.add_argument("--out", type=Path, default=OUT, help=f"file to write (default {OUT})")
    added = parts.add_parser("add", help="write the entry of an agent's rows")
    added.add_argument(
        "paths",
        nargs="+",
        metavar="ROWS",
        help="row file; words with = are options of mitigate evaluate that say what it sees, "
        "such as env.views=1",
    )
    added.add_argument("--name", required=True, help="the agent's name in the rows")
    added.add_argument("--severity", type=float, default=0.6, help="default 0.6")
    added.add_argument("--split", help="needed where the rows are of several")
    added.add_argument("--training-data", default="", help="what the agent was trained on")
    added.add_argument("--link", default="", help="where its weights or paper are")
    added.add_argument(
        "--config-dir", type=Path, help="folder of configs of your own, that env= and agent= name"
    )
    added.add_argument("--folder", default=FOLDER, help=f"where to write (default {FOLDER})")
    added.add_argument("--overwrite", action="store_true", help="replace an entry of that name")
    return parser
