"""Write a run's agent as a folder to ship: ``mitigate export runs/a my_agent``.

``checkpoints/hardened/<name>`` gets the weights (or adapters and a reference to their base),
``config.yaml``, ``program.pt2``, a card and a README. The folder is made aside, reloaded in a fresh
process and renamed into place only if the outputs on a fixed probe are the same.

``mitigate export checkpoints/hardened/harden --programs`` writes a missing ``program.pt2`` of such
a folder.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mitigate.core import build, conf, settings
from mitigate.core.options import paths_and_overrides
from mitigate.evaluation import config as options
from mitigate.evaluation.episode_lists import episodes

if TYPE_CHECKING:  # nothing slow is imported before main() has read the command line
    from mitigate.shipping.export import Walks


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="mitigate export",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("run", type=Path, nargs="?", help="a finished run folder, such as runs/...")
    parser.add_argument("name", nargs="?", help="name of the folder to write")
    parser.add_argument(
        "overrides",
        nargs="*",
        default=[],  # or argparse counts them among those that are required
        metavar="key=value",
        help="of an agent of your own: agent=policy env=corridor, as for mitigate evaluate",
    )
    parser.add_argument("--config-dir", type=Path, help="where such configs are")
    parser.add_argument(
        "--out",
        type=Path,
        default=argparse.SUPPRESS,
        help="folder to write it in (default checkpoints/hardened)",
    )
    parser.add_argument("--rows", nargs="+", default=[], help="row files of its evaluation")
    parser.add_argument("--overwrite", action="store_true", help="replace a folder of that name")
    parser.add_argument("--onnx", action="store_true", help="ONNX files too (extra `onnx`)")
    parser.add_argument(
        "--programs", action="store_true", help="write program.pt2 of the hardened folder RUN"
    )
    given = vars(parser.parse_intermixed_args())
    required = ("run",) if given["programs"] else ("run", "name")
    if missing := [name for name in required if given[name] is None]:
        parser.error(f"the following arguments are required: {', '.join(missing)}")
    if given["programs"] and given["name"] is not None:
        parser.error("--programs takes one hardened folder and no name.")
    from mitigate.agents import loading
    from mitigate.shipping.export import add_programs, export

    if given.pop("programs"):
        try:
            print(f"wrote {add_programs(given['run'])}")
        except (ValueError, OSError) as error:
            sys.exit(f"error: {conf.said(error)}")
        return
    overrides, configs = given.pop("overrides"), given.pop("config_dir")
    given["rows"], more = paths_and_overrides(given["rows"])
    try:
        chosen = [*overrides, *more]
        if not any(option.lstrip("+").startswith("agent=") for option in chosen):
            chosen += _own_kind(given["run"])
        if any(option.lstrip("+").startswith("agent=") for option in chosen):
            given["walks"] = _walks_of(given["run"], chosen, configs)
        folder = export(given.pop("run"), given.pop("name"), **given)
    except (ValueError, OSError) as error:
        sys.exit(f"error: {conf.said(error)}")
    card = loading.read_card(folder)
    if card["latency_ms"]:
        print(f"latency in ms: {json.dumps(card['latency_ms'])}")
    print(f"wrote {folder}")


def _own_kind(run: Path) -> list[str]:
    """The option that names the agent of ``run`` where it is one of ours that has no programs."""
    from mitigate.agents import loading

    config = run / loading.CONFIG
    kind = loading.kind_of(config) if config.is_file() else loading.TARGET
    name = "" if kind == loading.TARGET else settings.named(kind)
    return [f"agent={name}"] if name else []


def _walks_of(run: Path, overrides: list[str], configs: Path | None) -> Walks:
    """How to make the agent and the world that ``overrides`` name; the agent's settings are those
    beside the run's weights, read as data."""
    from mitigate.agents import building
    from mitigate.shipping.export import WALKS, Walks

    folder = [] if configs is None else [f"--config-dir={configs}"]
    config = options.read(conf.composed("evaluate", [*overrides, *folder]))
    node = building.settings_of(config.agent, str(run / "agent"), overrides)
    listed = episodes(config.env, config.split, WALKS)
    return Walks(build.maker(node), build.maker(config.env.world), listed)
