"""Kinds of agent side by side: ``mitigate table1 table=objects jobs=2``.

``table=routes`` and ``table=objects`` are the paper's Table I: plain and hardened agents under
everything. ``routes_ablations`` and ``objects_ablations`` blank their senses one by one. The same
command again goes on where the last one stopped.
"""

from __future__ import annotations

import hydra
from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.training.tables import run


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="table1")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    run(cfg)


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "table1")
