"""What all tests of a process share."""

from __future__ import annotations

import copy
import os
import re
from collections.abc import Iterable
from importlib import import_module
from multiprocessing import forkserver

import pytest
from omegaconf import DictConfig

from mitigate.cli import COMMANDS
from mitigate.core import conf
from mitigate.core.workers import context
from mitigate.training.workers import PRELOAD

PLACE = re.compile(r"(folder|runs|out)=(/[\w./-]+)")  # an option that names a folder of one test
compose = conf.load_config
composed: dict[tuple, DictConfig] = {}


def load_config(primary: str, overrides: Iterable[str] = ()) -> DictConfig:
    """Compose each set of options once per process: Hydra takes 0.2 s each time."""
    overrides = [*overrides]
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


conf.load_config = load_config
SLOW_FIXTURES = {"cluster"}  # a Ray cluster takes long to start
for command in ("train", "evaluate", "table1", "table2", "sweep", "run", "replay", "export_drive"):
    import_module(COMMANDS[command].module)  # registers the types of its options


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Send tests that share a module's fixture to one worker, and mark those with slow fixtures."""
    for item in items:
        if SLOW_FIXTURES & item._fixtureinfo.name2fixturedefs.keys():
            item.add_marker(pytest.mark.slow)
        made = item._fixtureinfo.name2fixturedefs.values()
        if any(found[-1].scope == "module" for found in made) and not item.get_closest_marker(
            "xdist_group"
        ):
            item.add_marker(pytest.mark.xdist_group(item.module.__name__))


def pytest_collection_finish() -> None:
    """Start the process that workers are forked from with what most of them import: it starts once
    for all tests, and the first that asks for workers may need less. In a run of many tests only
    (of pytest-xdist): a single one would wait for it."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        context(PRELOAD)
        forkserver.ensure_running()
