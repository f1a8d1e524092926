"""Compute the main published tables again, with the code and the weights of this checkout.

    make results                                  # run it again to continue after an interruption
    make results ARGS="quick=true"                # small versions of all tables, about an hour
    make results ARGS="only=[faults] launcher=ray"
    make results ARGS="costs=true"                # print the costs only

``results.yaml`` contains the options and the tables. Tables are computed one after the other. The
output of the commands is shown, and stored in ``log.txt`` in the folder of the table. A table that
is finished is computed again only if its commands have changed.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from mitigate.core.errors import command
from mitigate.core.files import make_folder, write_text
from mitigate.core.markdown import markdown_table, plain_text
from mitigate.core.names import unknown
from mitigate.core.output import open_output
from mitigate.core.progress import say

CONFIG = Path(__file__).with_suffix(".yaml")
LOG, DONE = "log.txt", "done.txt"


@dataclass
class Table:
    """A table of the documentation, as described in ``results.yaml``."""

    page: str = ""
    hours: float = 0.0
    minutes: float = 0.0
    commands: list[str] = field(default_factory=list)
    full: str = ""
    quick: str = ""

    def programs(self, out: str, quick: bool) -> list[list[str]]:
        """Return the arguments of the programs that compute the table."""
        size = self.quick if quick else self.full
        programs = [shlex.split(text.replace("{size}", size)) for text in self.commands]
        # a folder name may contain spaces
        return [[word.replace("{out}", out) for word in words] for words in programs]


@dataclass
class Options:
    """The options in ``results.yaml``."""

    quick: bool = False
    only: Any = None
    costs: bool = False
    out: str = "runs/results"
    jobs: int = 2
    launcher: str = "local"
    cells: str = ""
    third_party: str = ""
    tables: dict[str, Table] = field(default_factory=dict)


def read_options(arguments: Sequence[str]) -> Options:
    """Return the options of ``results.yaml``, changed by arguments such as ``quick=true``.

    Raises:
        ValueError: If an option or a table does not exist, or if a value has the wrong type.
    """
    try:
        merged = OmegaConf.merge(
            OmegaConf.structured(Options),
            OmegaConf.load(CONFIG),
            OmegaConf.from_dotlist(list(arguments)),
        )
        options: Any = OmegaConf.to_object(merged)
    except OmegaConfBaseException as error:
        reason = str(error).splitlines()[0].rstrip(".")
        raise ValueError(f"{error.full_key}: {reason}. {CONFIG} lists the options.") from error
    only = options.only
    options.only = only.split(",") if isinstance(only, str) else only or list(options.tables)
    for name in options.only:
        if name not in options.tables:
            raise ValueError(unknown("table", name, options.tables))
    return options


def compute(options: Options) -> list[str]:
    """Compute the tables; return a line for each table that failed.

    The cost of the tables is printed first.
    """
    out = Path(options.out) / ("quick" if options.quick else "full")
    names = options.only
    programs = {name: options.tables[name].programs(str(out), options.quick) for name in names}
    texts = {name: "".join(f"{shlex.join(p)}\n" for p in programs[name]) for name in names}
    done = {name for name in names if is_done(out / name, texts[name])}
    print(plain_text(cost_table(options, names, done)), flush=True)
    failed = []
    for name in [] if options.costs else names:
        if name in done:
            continue
        folder = make_folder(out / name)
        if problem := run(programs[name], folder / LOG):
            failed.append(f"{name}: {problem}")
            say(failed[-1])
        else:
            write_text(folder / DONE, texts[name])
    return failed


def is_done(folder: Path, commands: str) -> bool:
    """Return whether the table in ``folder`` was computed by these commands."""
    file = folder / DONE
    return file.is_file() and file.read_text("utf-8") == commands


def cost_table(options: Options, names: Sequence[str], done: set[str]) -> str:
    """Return a table with the CPU time of each table that is not done."""
    unit = "minutes" if options.quick else "hours"
    rows, total = [], 0.0
    for name in names:
        table = options.tables[name]
        cost = table.minutes if options.quick else table.hours
        rows.append([name, table.page, "done" if name in done else f"{cost:g}"])
        total += 0.0 if name in done else cost
    rows.append(["total", "", f"{total:g}"])
    return markdown_table(["Table", "Page", f"CPU {unit}"], rows, words=2)


def run(programs: Sequence[Sequence[str]], log: Path) -> str:
    """Run the programs of a table one after the other until one fails; return its error."""
    with open_output(log, "ab") as file:
        for words in programs:
            say(shlex.join(words))
            module = ["-m", "mitigate"] if words[0] == "mitigate" else []
            process = subprocess.Popen(
                [sys.executable, *module, *words[1:]],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
            )
            assert process.stdout
            for line in process.stdout:
                sys.stdout.buffer.write(line)
                sys.stdout.flush()
                file.write(line)
                file.flush()
            if status := process.wait():
                return f"{shlex.join(words)} ended with status {status}; its output is in {log}"
    return ""


@command("results")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return 1 if a table failed, and 2 for invalid options."""
    arguments = sys.argv[1:] if argv is None else argv
    if any(word in ("-h", "--help") for word in arguments):
        print(f"{__doc__}\n{CONFIG.read_text('utf-8')}")
        return 0
    failed = compute(read_options(arguments))
    if failed:
        say("These tables failed. Run the same command again to continue them.")
        print("\n".join(failed), flush=True)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
