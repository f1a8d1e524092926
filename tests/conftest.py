"""What all tests of a process share."""

from __future__ import annotations

import os
from multiprocessing import forkserver

from mitigate.core.workers import context
from mitigate.training.workers import PRELOAD


def pytest_collection_finish() -> None:
    """Start the process that workers are forked from with what most of them import: it starts once
    for all tests, and the first that asks for workers may need less. In a run of many tests only
    (of pytest-xdist): a single one would wait for it."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        context(PRELOAD)
        forkserver.ensure_running()
