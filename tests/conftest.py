"""Set up all tests of a process: cached configs, marks of slow tests, the fork server."""

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
        fixtures = item._fixtureinfo.name2fixturedefs.values()
        if any(each[-1].scope == "module" for each in fixtures) and not item.get_closest_marker(
            "xdist_group"
        ):
            item.add_marker(pytest.mark.xdist_group(item.module.__name__))


def pytest_collection_finish() -> None:
    """Start the fork server with the modules that most workers import.

    It starts once for all tests, and the first test that needs workers may preload less. Only runs
    of many tests (pytest-xdist) start it here: a single test would wait for it.
    """
    if "PYTEST_XDIST_WORKER" in os.environ:
        context(PRELOAD)
        forkserver.ensure_running()
