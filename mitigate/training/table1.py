"""Compare kinds of agent: ``mitigate table1 table=objects jobs=2``.

``table=routes`` and ``table=objects`` correspond to Table I of the paper: they evaluate plain and
hardened agents under all conditions. ``routes_ablations`` and ``objects_ablations`` evaluate these
agents with one sensor removed at a time. Run the same command again to resume.
"""

from __future__ import annotations

import hydra
from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.training.tables import run


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="table1")
def hydra_main(cfg: DictConfig) -> None:
    """Entry point for Hydra."""
    run(cfg)


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "table1")
