"""Export the agent of a run as a folder for deployment: ``mitigate export runs/a my_agent``.

The folder ``checkpoints/hardened/<name>`` contains ``config.yaml``, ``program.pt2``, a card, a
README, and the weights. If only adapters were trained, the folder contains the adapters and a
reference to their base instead of the weights. The folder is first written to a temporary place and
loaded in a new process. The folder is moved to its final place only if the loaded agent gives the
same outputs on fixed inputs.

``mitigate export checkpoints/hardened/harden --programs`` writes a missing ``program.pt2`` into
such a folder.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mitigate.core import build, conf
from mitigate.core.options import paths_and_overrides
from mitigate.evaluation import config as options
from mitigate.evaluation.episode_lists import episodes

if TYPE_CHECKING:  # the import is slow, so main() first parses the command line
    from mitigate.shipping.export import Walks


def main() -> None:
    """Run from the command line."""
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
        default=[],  # without a default, argparse would require at least one option
        metavar="key=value",
        help="options that name an agent of another class: agent=policy env=corridor",
    )
    parser.add_argument("--config-dir", type=Path, help="folder of your configs")
    parser.add_argument(
        "--out",
        type=Path,
        default=argparse.SUPPRESS,
        help="folder that contains the new folder (default checkpoints/hardened)",
    )
    parser.add_argument(
        "--rows", nargs="+", default=[], help="row files of the evaluation of this agent"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace a folder of that name")
    parser.add_argument("--onnx", action="store_true", help="also write ONNX files (extra `onnx`)")
    parser.add_argument(
        "--programs", action="store_true", help="write program.pt2 of the hardened folder RUN"
    )
    parsed = vars(parser.parse_intermixed_args())
    required = ("run",) if parsed["programs"] else ("run", "name")
    if missing := [name for name in required if parsed[name] is None]:
        parser.error(f"the following arguments are required: {', '.join(missing)}")
    if parsed["programs"] and parsed["name"] is not None:
        parser.error("--programs takes one hardened folder, and no name.")
    from mitigate.agents import loading
    from mitigate.agents.building import agent_option
    from mitigate.shipping.export import add_programs, export

    if parsed.pop("programs"):
        try:
            print(f"wrote {add_programs(parsed['run'])}")
        except (ValueError, OSError) as error:
            sys.exit(f"error: {conf.error_message(error)}")
        return
    overrides = parsed.pop("overrides")
    configs = parsed.pop("config_dir")
    parsed["rows"], more = paths_and_overrides(parsed["rows"])
    try:
        words = [*overrides, *more]
        words += agent_option(words, str(parsed["run"] / "agent"))
        if any(option.lstrip("+").startswith("agent=") for option in words):
            parsed["walks"] = _walks_of(parsed["run"], words, configs)
        folder = export(parsed.pop("run"), parsed.pop("name"), **parsed)
    except (ValueError, OSError) as error:
        sys.exit(f"error: {conf.error_message(error)}")
    card = loading.read_card(folder)
    if card["latency_ms"]:
        print(f"latency in ms: {json.dumps(card['latency_ms'])}")
    print(f"wrote {folder}")


def _walks_of(run: Path, overrides: list[str], configs: Path | None) -> Walks:
    """Return the check settings for the agent and the world that ``overrides`` name.

    The settings of the agent are read from the folder of the run, as data and not as code.
    """
    from mitigate.agents import building
    from mitigate.shipping.export import WALKS, Walks

    folder = [] if configs is None else [f"--config-dir={configs}"]
    config = options.read(conf.composed("evaluate", [*overrides, *folder]))
    node = building.settings_of(config.agent, str(run / "agent"), overrides)
    listed = episodes(config.env, config.split, WALKS)
    return Walks(build.maker(node), build.maker(config.env.world), listed)
