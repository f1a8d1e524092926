"""Write result rows as one HTML file: ``mitigate report ROWS... --out report.html``.

Takes row files and run or sweep folders, partial ones too. The file needs no network and no other
file: tables that sort, heatmaps whose cells list their episodes, curves, and walks where weights
are named that can walk again (``--walk base=checkpoints/base``).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from mitigate.core.progress import Progress

OUT = Path("runs/report.html")
ROWS = "docs/results"
MOST_WALKS = 200  # of a page (ours): each has two pictures, about 40 KB


def run(
    paths: Sequence[Path | str],
    out: Path | str = OUT,
    *,
    title: str = "Results",
    walk: Sequence[tuple[str, str]] = (),
    walks: int = 12,
    seed: int = 0,
    options: Sequence[str] = (),
) -> Path:
    """Write the page of the rows in ``paths`` to ``out`` and return it.

    Args:
        walk: (name in the rows, weights) of the agents whose walks are drawn, the plain one first.
        walks: how many episodes of ``options``' split they walk. seed: of the rows' keys that they
            walk by. options: of ``mitigate evaluate``, such as "split=val_seen".
    Raises FileNotFoundError for a path without rows, ValueError for damaged rows, names that are
    not in them, options without ``walk`` and an ``out`` that does not end in .html.
    """
    from mitigate.evaluation import rows
    from mitigate.evaluation.page import document
    from mitigate.evaluation.page.document import report

    document.check_out(out)  # before the walks, which take minutes
    if options and not walk:
        raise ValueError(
            f"There is no file {options[0]}, and an option says only where agents walk: check the "
            "path, or name the agents with --walk NAME=WEIGHTS."
        )
    files = [file for path in paths for file in rows.files(path)]
    with Progress("rows", len(files), unit="file") as progress:
        held = rows.gather(_each(files, progress))
    drawn = list(_walks(held, walk, walks, seed, options)) if walk else []
    return document.write(report(held, title=title, walks=drawn), out)


def _each(files: Sequence[Path], progress: Progress) -> Iterator[Path]:
    for file in files:
        yield file
        progress.advance()


def _walks(
    held: Sequence[dict[str, Any]],
    walk: Sequence[tuple[str, str]],
    most: int,
    seed: int,
    options: Sequence[str],
) -> Iterator[dict[str, Any]]:
    from mitigate.core import conf
    from mitigate.core.build import maker
    from mitigate.core.names import unknown
    from mitigate.evaluation import evaluate
    from mitigate.evaluation.config import read
    from mitigate.evaluation.page.walks import walk_again

    names = {row["name"] for row in held}
    for name, _ in walk:
        if name not in names:
            raise ValueError(unknown("agent in these rows", name, names))
    config = read(conf.load_config("evaluate", options))
    world = maker(config.env.world)()
    own = [r for r in held if r["split"] == config.split and r["rule"] == world.rule]
    agents: dict[str, Any] = {
        name: evaluate.load(config.agent, weights or None, overrides=options)
        for name, weights in walk
    }
    listed = evaluate.episodes(config.env, config.split, None)
    with Progress("walks", most, unit="episode") as progress:
        for drawn in walk_again(agents, world, listed, own, most=most, seed=seed):
            progress.advance()
            yield drawn


def named(text: str) -> tuple[str, str]:
    """Return ("base", "checkpoints/base") of "base=checkpoints/base"; no weights of "base="."""
    name, equals, weights = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(
            f"{text!r} must be NAME=WEIGHTS, such as base=checkpoints/base (NAME= of an agent that "
            "has none)"
        )
    return name, weights


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for a bad input)."""
    parser = argparse.ArgumentParser(
        prog="mitigate report",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "rows",
        nargs="*",
        metavar="ROWS",
        help=f"row files or run folders (default {ROWS}); words with = are options of mitigate "
        "evaluate that say where agents walk, such as split=val_seen",
    )
    parser.add_argument("--out", type=Path, default=OUT, help=f"file to write (default {OUT})")
    parser.add_argument("--title", default="Results", help="heading of the page")
    parser.add_argument(
        "--walk",
        action="append",
        type=named,
        default=[],
        metavar="NAME=WEIGHTS",
        help="draw walks of this agent of the rows; the plain one first, then hardened ones",
    )
    parser.add_argument(
        "--config-dir", type=Path, help="where the configs are of agents and worlds of your own"
    )
    parser.add_argument("--walks", type=int, default=12, help="how many episodes (default 12)")
    parser.add_argument("--seed", type=int, default=0, help="of the rows that are walked again")
    given = vars(parser.parse_intermixed_args(argv))
    words, configs = given.pop("rows"), given.pop("config_dir")
    paths = [word for word in words if "=" not in word or Path(word).exists()]
    options = [word for word in words if word not in paths]
    if configs is not None and given["walk"]:
        options = [f"--config-dir={configs}", *options]
    if not 1 <= given["walks"] <= MOST_WALKS:
        parser.error(f"--walks {given['walks']}: give 1 to {MOST_WALKS}.")
    return told("report", lambda: run(paths or [_shipped()], options=options, **given))


def told(name: str, work: Callable[[], Path | None]) -> int:
    """Do ``work``, which returns the file it wrote, if any; return the exit status, and say what is
    wrong with an input in one paragraph."""
    from hydra.errors import HydraException
    from omegaconf.errors import OmegaConfBaseException

    from mitigate.core import conf

    try:
        written = work()
    except (OSError, ValueError) as error:
        print(f"{name}: {conf.said(error)}", file=sys.stderr)
        return 2
    except (HydraException, OmegaConfBaseException) as error:
        print(f"{name}: {conf.explain(error, 'evaluate')}", file=sys.stderr)
        return 2
    if written is not None:
        print(f"wrote {written} ({Path(written).stat().st_size / 1e6:.1f} MB)")
    return 0


def _shipped() -> Path:
    from mitigate.core.files import find

    folder = find(ROWS)
    if not folder.is_dir():
        raise FileNotFoundError(f"There is no {ROWS} here: name row files or run folders.")
    return folder
