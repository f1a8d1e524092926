"""All methods side by side, the paper's Table II: ``mitigate table2 seeds=[0] jobs=2``.

Trains and evaluates every column for every seed, several cells at a time. The same command again
goes on where the last one stopped. ``evaluations=beyond`` measures each cell under more than the
table's suite; each of these has a report of its own.
"""

from __future__ import annotations

import hydra
from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.training.tables import run


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="table2")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    run(cfg)


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "table2")
