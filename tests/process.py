"""A pytest plugin that caches configs, marks slow tests and starts the fork server."""

from __future__ import annotations

import copy
import gc
import os
import re
from collections.abc import Iterable
from importlib import import_module
from multiprocessing import forkserver

import numpy as np
import pytest
from omegaconf import DictConfig

from mitigate.cli import COMMANDS
from mitigate.core import conf
from mitigate.core.workers import context
from mitigate.corruptions import NAMES, Key, corrupt
from mitigate.corruptions.registry import modality, unseen_names
from mitigate.training.workers import PRELOAD

# options whose value is a temporary folder of one test
PLACE = re.compile(r"(folder|runs|out)=(/[\w./-]+)")
compose = conf.load_config
composed: dict[tuple, DictConfig] = {}


def load_config(primary: str, words: Iterable[str] = (), with_hydra: bool = False) -> DictConfig:
    """Compose each set of options only once per process, because Hydra needs 0.2 s each time."""
    overrides = [*words]
    if with_hydra:
        return compose(primary, overrides, with_hydra=True)
    places = dict(match.groups() for match in map(PLACE.fullmatch, overrides) if match)
    rest = tuple(option for option in overrides if not PLACE.fullmatch(option))
    if primary not in conf.TYPES or any(option.startswith("-") for option in rest):
        return compose(primary, overrides)
    key = (primary, rest, conf.CONF)
    if key not in composed:
        composed[key] = compose(primary, rest)
    if not places.keys() <= composed[key].keys():
        return compose(primary, overrides)
    cfg = copy.deepcopy(composed[key])
    for name, folder in places.items():
        cfg[name] = folder
    return cfg


# Until the tests are collected, garbage collection takes time and frees nothing.
gc.disable()
conf.load_config = load_config
SLOW_FIXTURES = {"cluster"}  # starting a Ray cluster takes a long time
for command in (
    *("train", "evaluate", "table1", "table2", "sweep", "harden", "run", "replay", "export_drive"),
):
    import_module(COMMANDS[command].module)  # registers the types of the command's options


@pytest.hookimpl(tryfirst=True)  # runs before pytest-xdist reads the marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Send all tests of a module to one worker, and mark the tests that use slow fixtures.

    Tests of a module share fixtures, composed configs and imports.
    """
    for item in items:
        if SLOW_FIXTURES & item._fixtureinfo.name2fixturedefs.keys():
            item.add_marker(pytest.mark.slow)
        if not item.get_closest_marker("xdist_group"):
            item.add_marker(pytest.mark.xdist_group(item.module.__name__))


def compile_kernels(share: int, workers: int) -> None:
    """Compile one worker's part of the corruption kernels (a minute in a new checkout).

    No test starts before all workers have compiled their kernels. Then each worker reads the
    kernels of the others from numba's cache.
    """
    frames = {
        "rgb": np.full((12, 32, 32, 3), 90, np.uint8),
        "depth": np.full((12, 32, 32, 1), 2.0, np.float32),
    }
    names = [*NAMES, *unseen_names(*frames)]
    for name in names[share::workers]:
        corrupt(frames[modality(name)], name, 0.6, key=Key(0, "compile"), heading=0.0)


@pytest.hookimpl(tryfirst=True)  # runs before a pytest-xdist worker sends its list of tests
def pytest_collection_finish() -> None:
    """Start the fork server with the modules that most workers import.

    The fork server starts only once per process, and a test might start it with fewer modules. In
    runs without pytest-xdist it is not started here, because a single test would have to wait for
    it. Garbage collection is enabled again, but ignores all modules and tests that are loaded now.
    """
    gc.freeze()
    gc.enable()
    if worker := os.environ.get("PYTEST_XDIST_WORKER"):
        compile_kernels(int(worker[2:]), int(os.environ["PYTEST_XDIST_WORKER_COUNT"]))
        context(PRELOAD)
        forkserver.ensure_running()
