"""Compare kinds of agent: ``mitigate table1 table=objects jobs=2``.

``table=routes`` and ``table=objects`` correspond to Table I of the paper: they evaluate plain and
hardened agents under all conditions. ``routes_ablations`` and ``objects_ablations`` evaluate these
agents with one sensor removed at a time. Run the same command again to resume.
"""

from __future__ import annotations

from mitigate.core import conf
from mitigate.training.tables import run


def main() -> None:
    """Run from the command line."""
    conf.main(conf.hydra_program("table1", lambda cfg: run(cfg)), "table1")
