"""The paper's Table I: ``python -m mitigate.table1 jobs=2``; ``table2.py`` makes both."""

from __future__ import annotations

import hydra
from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.training.table2 import run


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="table1")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    run(cfg)


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "table1")
