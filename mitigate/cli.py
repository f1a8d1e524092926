"""The command ``mitigate``: ``mitigate train recipe=da_per_episode``.

``python -m mitigate.train`` runs the same command; ``commands/`` contains such modules for the
older commands.
"""

from __future__ import annotations

import io
import os
import signal
import sys
import threading
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NamedTuple

from mitigate.core.errors import missing_package_message
from mitigate.core.names import printable, unknown
from mitigate.core.signals import Ended, raise_ended


class Command(NamedTuple):
    """A subcommand of the program ``mitigate``."""

    module: str  # module whose ``main()`` reads ``sys.argv`` and returns an exit status
    about: str  # description of the command, shown in the help text
    example: str  # example options, shown in the help text
    extra: str = "train"  # the extra of the package that the command needs


COMMANDS = {
    "train": Command(
        "mitigate.training.train",
        "train an agent with a recipe, and compare it before and after",
        "recipe=da_per_episode severity=0.6 seed=1",
    ),
    "evaluate": Command(
        "mitigate.evaluation.evaluate",
        "measure the success of an agent on clean input and under every corruption",
        "checkpoint=checkpoints/base split=val_seen",
    ),
    "harden": Command(
        "mitigate.shipping.harden_command",
        "make a trained policy from another library robust, without an expert",
        "policy=my_policy:load world=my_policy:make_world severity=0.6",
    ),
    "controls": Command(
        "mitigate.evaluation.controls",
        "run the shortest-path oracle and a random agent, the bounds of every result",
        "split=val_seen episodes=40",
    ),
    "table": Command(
        "mitigate.evaluation.table",
        "join result rows of any number of runs into one table with pictures",
        "runs/a runs/b --out report",
    ),
    "report": Command(
        "mitigate.evaluation.page.command",
        "write result rows as one HTML file: sortable tables, heatmaps, episodes, paths",
        "runs/a runs/b --out report.html --walk base=checkpoints/base",
    ),
    "leaderboard": Command(
        "mitigate.evaluation.leaderboard.command",
        "show, check and add entries of the leaderboard",
        "show --out leaderboard.html",
    ),
    "table1": Command(
        "mitigate.training.table1",
        "evaluate all kinds of agent, plain and hardened: the paper's Table I",
        "table=objects jobs=2",
    ),
    "table2": Command(
        "mitigate.training.table2",
        "train and evaluate every method of the paper's Table II",
        "seeds=[0] jobs=2",
    ),
    "sweep": Command(
        "mitigate.training.sweep",
        "train or evaluate with every combination of options, here or on a cluster; one table",
        "recipe=da_per_frame,da_per_episode seed=0,1 jobs=2",
    ),
    "run": Command(
        "mitigate.bridge.run",
        "run an agent of another project, unchanged, under every corruption",
        "severity=0.6 episodes=100 -- conda run -n etpnav bash run_r2r/main.bash eval 2333",
    ),
    "replay": Command(
        "mitigate.replay.replay",
        "run agents on recorded drives (folders, ROS bags, MCAP) and compare their decisions",
        "drive.mcap agents=[checkpoints/recurrent/base] instruction='\"walk to the door\"'",
    ),
    "corrupt": Command(
        "mitigate.corruptions.frames_command",
        "corrupt a folder of recorded frames",
        "recorded/ corrupted/ corruption=spatter severity=0.5",
        "files",
    ),
    "corrupt_episodes": Command(
        "mitigate.worlds.corrupt_episodes_command",
        "corrupt the instructions of an R2R-CE or RxR-CE file",
        "val_unseen.json.gz out.json.gz corruption=mask severity=0.5",
        "files",
    ),
    "export_drive": Command(
        "mitigate.replay.export_drive",
        "write episodes of the oracle as recorded drives, to test replay",
        "drives/ episodes=3 form=mcap",
    ),
    "export": Command(
        "mitigate.shipping.export_command",
        "write the agent of a run as a hardened checkpoint",
        "runs/ts_distill-s0.6-seed0 mine",
    ),
    "export_scene": Command(
        "mitigate.worlds.apartments.export_command",
        "write apartments and their episodes for Habitat",
        "habitat/ split=val_unseen scenes=3",
        "files",
    ),
    "doctor": Command(
        "mitigate.core.doctor", "report what this machine has and what is missing", ""
    ),
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run a command from the command line, and exit with its status."""
    _prepare_streams()
    warnings.formatwarning = _format_warning
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, raise_ended)  # so that temporary files are deleted
    # add the current folder, as python -m does, so that the user's modules can be imported
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        status = _run(words[0] if words else "", words[1:])
        sys.stdout.flush()
    except BrokenPipeError:  # the program that reads the output (for example ``head``) has ended
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 128 + signal.SIGPIPE
    sys.exit(status)


def _run(name: str, options: Sequence[str]) -> int | None:
    """Run the command ``name`` and return its exit status."""
    if name in ("", "-h", "--help", "help"):
        print(usage())
        return 0 if name else 2
    name = name.replace("-", "_")
    if name not in COMMANDS:
        sys.exit(f"mitigate: {unknown('command', name, COMMANDS)} See mitigate --help.")
    sys.argv = [f"mitigate {name}", *options]
    try:
        return import_module(COMMANDS[name].module).main()
    except ModuleNotFoundError as error:
        message = missing_package_message(f"mitigate {name}", error, COMMANDS[name].extra)
        if not message:
            raise
        sys.exit(message)
    # commands that can resume catch this themselves and print how to resume
    except KeyboardInterrupt as error:
        print(f"\nmitigate {name}: stopped.", file=sys.stderr)
        return error.status if isinstance(error, Ended) else 128 + signal.SIGINT


def _prepare_streams() -> None:
    """Replace closed standard streams, and make stdout and stderr escape unencodable characters.

    A closed stream is replaced by the null device. Otherwise, the next opened file, such as a file
    of rows, would get the stream's descriptor number, and child processes would print into that
    file. Characters that an encoding lacks are printed as escapes.
    """
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    for number, name in ((1, "stdout"), (2, "stderr")):
        stream = getattr(sys, name)
        if stream is None:  # it was closed
            stream = open(number, "w", errors="backslashreplace", closefd=False)  # noqa: SIM115
            setattr(sys, name, stream)
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


_default_format = warnings.formatwarning


def _format_warning(message: Warning | str, *details: Any, **more: Any) -> str:
    """Format a warning without control characters, because it may quote names from files."""
    return _default_format(printable(str(message)), *details, **more)


def usage() -> str:
    """Return the help text, which lists every command with a description and an example."""
    lines = ["Corrupt, train, measure and ship navigation agents.", ""]
    lines += ["usage: mitigate COMMAND [OPTIONS], each with --help", ""]
    for name, command in COMMANDS.items():
        lines += [f"  {name:17s} {command.about}"]
        lines += [f"  {'':17s}   mitigate {name} {command.example}".rstrip(), ""]
    return "\n".join(lines).rstrip()
