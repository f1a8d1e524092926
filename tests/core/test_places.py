"""Tests of the folders that are searched for shipped weights."""

import sys
from pathlib import Path

import pytest

from mitigate.core import files


@pytest.fixture
def nowhere(tmp_path, monkeypatch):
    """An empty folder. There is no checkout, no package of weights and no environment variable."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(files, "ROOT", tmp_path / "site-packages")
    monkeypatch.setattr(files, "PACKAGE", tmp_path / "site-packages" / "mitigate")
    monkeypatch.setattr(files, "WEIGHTS_PACKAGE", "mitigate_weights_of_this_test")
    monkeypatch.delenv(files.WEIGHTS_VARIABLE, raising=False)
    return tmp_path


def make(folder: Path) -> Path:
    (folder / "base").mkdir(parents=True)
    return folder / "base"


def test_find_searches_cwd_package_checkout_then_variable(nowhere, monkeypatch):
    named = make(nowhere / "named")
    monkeypatch.setenv(files.WEIGHTS_VARIABLE, str(nowhere / "named"))
    assert files.find("checkpoints/base") == named
    checkout = make(nowhere / "site-packages" / "checkpoints")
    assert files.find("checkpoints/base") == checkout
    package = make(nowhere / "packages" / files.WEIGHTS_PACKAGE)
    monkeypatch.setattr(sys, "path", [str(nowhere / "packages"), *sys.path])
    assert files.find("checkpoints/base") == package
    make(nowhere / "checkpoints")
    assert files.find("checkpoints/base") == Path("checkpoints/base")


def test_find_names_the_places_without_weights(nowhere):
    with pytest.raises(FileNotFoundError, match="site-packages.*not installed.*not set"):
        files.find("checkpoints/base")
    assert files.find("other/base") == Path("other/base")
