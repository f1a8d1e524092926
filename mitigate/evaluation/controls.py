"""Evaluate the shortest-path oracle and a random agent: ``mitigate controls split=val_unseen``.

The two agents are the upper and the lower reference for every result. The oracle shows that the
episodes of a world can be solved with the low-level actions, and the random agent shows how often
random actions succeed. Both agents run without corruption. As in mitigate evaluate, split=,
episodes= and env= choose the episodes. out= names the folder for the rows; the default is
runs/controls. If the command is run again, it runs only missing episodes.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from mitigate.core import conf
from mitigate.core.errors import command
from mitigate.core.names import counted
from mitigate.core.options import check_dashes, without_config_folder
from mitigate.evaluation.bootstrap import share
from mitigate.evaluation.config import read

OUT = "runs/controls"
# options of ``mitigate evaluate`` that this command also accepts
OPTIONS = ("env", "split", "episodes", "out")


@command("controls")
def main() -> int:
    """Run from the command line; return the exit status (2 for invalid input)."""
    options = sys.argv[1:]
    if {"-h", "--help"} & {*options}:
        print(__doc__)
        return 0
    check_dashes(options)
    for option in without_config_folder(options)[1]:
        name = re.split(r"[.=]", option.lstrip("+~"))[0]
        if not option.startswith("-") and name not in OPTIONS:
            raise ValueError(
                f"{option} has no effect: the oracle and the random agent run without corruption "
                f"and with seed 0. Options are {', '.join(OPTIONS)}."
            )
    config = read(conf.composed("evaluate", options))
    out = Path(config.out or OUT)
    from mitigate.evaluation.control_agents import run  # torch takes seconds to import

    results = run(config, out)
    for name in dict.fromkeys(row["name"] for row in results):
        selected = [row for row in results if row["name"] == name]
        success, spl = (share([float(row[key]) for row in selected]) for key in ("success", "spl"))
        print(
            f"{name}: SR {100 * success.value:.1f} [{100 * success.low:.1f}, "
            f"{100 * success.high:.1f}] %, SPL {spl.value:.2f}, {counted(len(selected), 'episode')}"
        )
    print(f"rows in {out}")
    return 0


if __name__ == "__main__":
    sys.exit("Write `mitigate controls split=val_unseen`.")
