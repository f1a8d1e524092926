"""Write result rows as one HTML file: ``mitigate report ROWS... --out report.html``.

ROWS are row files, or folders of runs or sweeps, which may be incomplete. The page is one file and
needs no network. The page has sortable tables, heatmaps whose cells list their episodes, and
curves. With ``--walk base=checkpoints/base``, agents run some episodes again, and the page draws
their trajectories.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from mitigate.core.errors import command
from mitigate.core.files import find
from mitigate.core.progress import Progress

OUT = Path("runs/report.html")
ROWS = "docs/results"
# This is the maximum number of episodes with trajectories per page (heuristic).
# Each trajectory adds a picture of about 100 KB.
MOST_WALKS = 200


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
    """Write a page for the rows in ``paths`` to ``out`` and return its path.

    Args:
        paths: row files or folders.
        out: path of the page.
        title: heading of the page.
        walk: pairs (name in the rows, weights) of the agents whose trajectories are plotted. The
            baseline comes first.
        walks: number of episodes whose trajectories are plotted.
        seed: corruption seed for these episodes, which must occur in the rows.
        options: options of ``mitigate evaluate``, such as "split=val_seen".

    Raises:
        FileNotFoundError: If a path contains no rows.
        ValueError: If rows are damaged, or if a name does not occur in them. It is also raised if
            ``options`` are given without ``walk``, or if ``out`` does not end in .html.
    """
    from mitigate.evaluation import rows
    from mitigate.evaluation.page import document

    document.check_out(out)  # checked first, because the rollouts take minutes
    if options and not walk:
        raise ValueError(
            f"There is no file or folder {options[0]}. If you meant a path, correct it. If you "
            "meant an option of mitigate evaluate, also pass --walk NAME=WEIGHTS for each agent "
            "that runs episodes with this option."
        )
    files = [file for path in paths for file in rows.files(path)]
    with Progress("rows", len(files), unit="file") as progress:
        all_rows = rows.gather(_each(files, progress))
    drawn = list(_walks(all_rows, walk, walks, seed, options)) if walk else []
    return document.write(document.report(all_rows, title=title, walks=drawn), out)


def _each(files: Sequence[Path], progress: Progress) -> Iterator[Path]:
    for file in files:
        yield file
        progress.advance()


def _walks(
    rows: Sequence[dict[str, Any]],
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

    names = {row["name"] for row in rows}
    for name, _ in walk:
        if name not in names:
            raise ValueError(unknown("agent in these rows", name, names))
    config = read(conf.composed("evaluate", options))
    world = maker(config.env.world)()
    matching = [r for r in rows if r["split"] == config.split and r["rule"] == world.rule]
    agents: dict[str, Any] = {
        name: evaluate.load(config.agent, weights or None, overrides=options)
        for name, weights in walk
    }
    listed = evaluate.episodes(config.env, config.split, None)
    with Progress("walks", most, unit="episode") as progress:
        for drawn in walk_again(agents, world, listed, matching, most=most, seed=seed):
            progress.advance()
            yield drawn


def named(text: str) -> tuple[str, str]:
    """Split "base=checkpoints/base" into name and weights; the weights may be empty."""
    name, equals, weights = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(
            f"must be NAME=WEIGHTS, such as base=checkpoints/base (NAME= for an agent without "
            f"weights), got {text!r}"
        )
    return name, weights


@command("report")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for invalid input)."""
    parser = argparse.ArgumentParser(
        prog="mitigate report",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "rows",
        nargs="*",
        metavar="ROWS",
        help=f"row files or run folders (default {ROWS}); key=value arguments are options of "
        "mitigate evaluate for the agents of --walk, such as split=val_seen",
    )
    parser.add_argument("--out", type=Path, default=OUT, help=f"file to write (default {OUT})")
    parser.add_argument("--title", default="Results", help="heading of the page")
    parser.add_argument(
        "--walk",
        action="append",
        type=named,
        default=[],
        metavar="NAME=WEIGHTS",
        help="plot paths of this agent of the rows; name the baseline first, then hardened agents",
    )
    parser.add_argument(
        "--config-dir", type=Path, help="folder of configs of your agents and worlds"
    )
    parser.add_argument("--walks", type=int, default=12, help="number of episodes (default 12)")
    parser.add_argument("--seed", type=int, default=0, help="corruption seed of the walks' rows")
    arguments = vars(parser.parse_intermixed_args(argv))
    words, configs = arguments.pop("rows"), arguments.pop("config_dir")
    paths: list[Path | str] = [word for word in words if "=" not in word or Path(word).exists()]
    options = [word for word in words if word not in paths]
    if configs is not None and arguments["walk"]:
        options = [f"--config-dir={configs}", *options]
    if not 1 <= arguments["walks"] <= MOST_WALKS:
        parser.error(f"--walks must be from 1 to {MOST_WALKS}, got {arguments['walks']}.")
    if not paths:
        shipped = find(ROWS)
        if not shipped.is_dir():
            raise FileNotFoundError(f"There is no folder {ROWS}. Name row files or run folders.")
        paths = [shipped]
    print(description(run(paths, options=options, **arguments)))
    return 0


def description(page: Path) -> str:
    """Return a text that states the path and the size of a page."""
    return f"wrote {page} ({page.stat().st_size / 1e6:.1f} MB)"
