"""Compare all methods, as in Table II of the paper: ``mitigate table2 seeds=[0] jobs=2``.

The command trains and evaluates every column of the table for every seed. It processes ``jobs``
pairs of column and seed in parallel. Run the same command again to resume. ``evaluations=beyond``
also evaluates every trained agent under other corruption suites, and writes one report per suite.
"""

from __future__ import annotations

from mitigate.core import conf
from mitigate.training.tables import run


def main() -> None:
    """Run from the command line."""
    conf.main(conf.hydra_program("table2", lambda cfg: run(cfg)), "table2")
