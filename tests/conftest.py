"""Load the plugin ``tests/process.py`` in every process that runs tests."""

from __future__ import annotations

import os
from importlib import import_module

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """The process that only distributes tests to workers does not load the plugin, whose imports
    take seconds."""
    if "PYTEST_XDIST_WORKER" in os.environ or not config.getoption("numprocesses", None):
        config.pluginmanager.register(import_module("tests.process"))
