"""A plugin for processes that run tests: cached configs, marks of slow tests, the fork server."""

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

PLACE = re.compile(r"(folder|runs|out)=(/[\w./-]+)")  # options that name a folder of one test
compose = conf.load_config
composed: dict[tuple, DictConfig] = {}


def load_config(primary: str, words: Iterable[str] = ()) -> DictConfig:
    """Compose each set of options once per process, since Hydra takes 0.2 s each time."""
    overrides = [*words]
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


gc.disable()  # until the tests are collected, imported objects are not garbage
conf.load_config = load_config
SLOW_FIXTURES = {"cluster"}  # a Ray cluster takes long to start
for command in (
    *("train", "evaluate", "table1", "table2", "sweep", "harden", "run", "replay", "export_drive"),
):
    import_module(COMMANDS[command].module)  # registers the types of its options


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Send all tests of a module to one worker, and mark those with slow fixtures.

    They share fixtures, composed configs and what the first of them imports.
    """
    for item in items:
        if SLOW_FIXTURES & item._fixtureinfo.name2fixturedefs.keys():
            item.add_marker(pytest.mark.slow)
        if not item.get_closest_marker("xdist_group"):
            item.add_marker(pytest.mark.xdist_group(item.module.__name__))


def compile_kernels(share: int, workers: int) -> None:
    """Compile a share of the corruptions' kernels, which takes a minute in a new checkout.

    No test starts before all workers have compiled their share. Each worker reads the kernels of
    the others from numba's cache and does not compile them.
    """
    frames = {
        "rgb": np.full((12, 32, 32, 3), 90, np.uint8),
        "depth": np.full((12, 32, 32, 1), 2.0, np.float32),
    }
    names = [*NAMES, *unseen_names(*frames)]
    for name in names[share::workers]:
        corrupt(frames[modality(name)], name, 0.6, key=Key(0, "compile"))


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reports the tests
def pytest_collection_finish() -> None:
    """Start the fork server with the modules that most workers import.

    Garbage collection starts again, without the modules and tests of this process. The fork server
    starts once for all tests, and the first test that needs workers may preload less. Only runs
    of many tests (pytest-xdist) start it here: a single test would wait for it.
    """
    gc.freeze()
    gc.enable()
    if worker := os.environ.get("PYTEST_XDIST_WORKER"):
        compile_kernels(int(worker[2:]), int(os.environ["PYTEST_XDIST_WORKER_COUNT"]))
        context(PRELOAD)
        forkserver.ensure_running()
