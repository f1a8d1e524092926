"""What all tests of a process share."""

from __future__ import annotations

import os
from importlib import import_module
from multiprocessing import forkserver

import pytest

from mitigate.cli import COMMANDS
from mitigate.core.workers import context
from mitigate.training.workers import PRELOAD

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
