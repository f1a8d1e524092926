"""Train an agent with a recipe: ``mitigate train recipe=da_per_episode severity=0.6``.

A recipe has one or more stages, which train the same agent one after the other. Each stage has a
subfolder in the folder of the run. Run the same command again to resume. At the end, the agents
before and after training are both evaluated.
"""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig

from mitigate.core import conf
from mitigate.core.locks import FolderLock
from mitigate.core.names import printable
from mitigate.training import config as options


def run(cfg: DictConfig) -> Path:
    """Train with the options ``cfg``, evaluate, and return the folder of the run.

    The folder contains ``config.yaml``, one subfolder per stage, ``agent/model.safetensors``, and
    the results of the evaluation. User errors raise ValueError or FileNotFoundError.
    """
    # this imports torch, which is slow and not needed for --help
    from mitigate.training.plan import check, plan
    from mitigate.training.ranks import Ranks
    from mitigate.training.stages import run_plan

    config = options.read(cfg)
    check(config)
    folder = str(config.folder)
    with Ranks.of_environment() as ranks:
        within = ("agent", "walks", *config.stages)
        with FolderLock(folder, within) if ranks.first else nullcontext():
            return run_plan(plan(config, ranks), ranks)


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="train")
def hydra_main(cfg: DictConfig) -> None:
    """Name the output folder after the options that differ from the defaults, and train."""
    if cfg.folder is None:
        cfg.folder = options.default_folder(cfg, HydraConfig.get().job.override_dirname)
    try:
        run(cfg)
    except Exception as error:
        # in a sweep, Hydra continues with the next run and shows only the first error
        if HydraConfig.get().mode == RunMode.MULTIRUN:
            print(printable(f"failed: {cfg.folder}: {error}"), file=sys.stderr, flush=True)
        raise


def main() -> None:
    """Run from the command line."""
    conf.main(hydra_main, "train")
