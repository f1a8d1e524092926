"""Fixtures that run ``lab/agent.py``, a program for a fake habitat-lab, as a user's command."""

import json
import os
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pytest
from omegaconf import OmegaConf

from mitigate.bridge import program
from mitigate.bridge import run as run_module
from mitigate.bridge.condition import Condition, Words
from mitigate.bridge.results import read
from mitigate.bridge.server import Listener
from mitigate.core.conf import load_config
from mitigate.corruptions import Corruption
from mitigate.evaluation import plots

from . import warm

LAB = Path(__file__).parent / "lab"
AGENT = f"{sys.executable} {LAB / 'agent.py'} {{out}}/seen"


def condition(name="clean", severity=0.6, **more):
    """Return a condition by name; the severity of "clean" is 0."""
    corruption = Corruption(name, 0.0 if name == "clean" else severity)
    return Condition(corruption, seed=0, words=more.pop("words", Words()), **more)


def config(*options):
    """Return the options of ``mitigate run`` as a typed config."""
    return OmegaConf.to_object(load_config("run", [*options]))


def python(listener, code, *arguments):
    """Run code as a user's program."""
    environment = {**os.environ, **listener.environment()}
    environment["PYTHONPATH"] += os.pathsep + str(LAB)
    return warm.run(["-c", code, *map(str, arguments)], environment, timeout=30)


class CommandResult:
    """The result of a command: its status, output and reports, and the frames of its workers."""

    def __init__(self, process, folder, seen):
        self.status = process.returncode
        self.output = process.stdout
        self.reports = read(folder)
        self._seen = seen

    def seen(self):
        """Return a dict {(episode, step number): entry} with the entries of all workers."""
        entries = {}
        for file in sorted(self._seen.parent.glob(f"{self._seen.name}.*")):
            steps = {}
            for entry in json.loads(file.read_text()):
                number = steps[entry["episode"]] = steps.get(entry["episode"], -1) + 1
                entries[entry["episode"], number] = entry
        return entries


@pytest.fixture
def command(tmp_path):
    """Run ``lab/agent.py`` with these options under a condition, as ``mitigate run`` does."""

    def run(settings, *options, python=sys.executable, patience=10.0, **environment):
        folder = tmp_path / f"{settings.corruption.name}-{len(list(tmp_path.iterdir()))}"
        with Listener(settings, folder, patience) as listener:
            variables = {**os.environ, **listener.environment(), "MITIGATE_TEST": "1"}
            variables["PYTHONPATH"] = os.pathsep.join([variables["PYTHONPATH"], str(LAB)])
            variables.update(environment)
            arguments = [str(LAB / "agent.py"), str(folder / "seen"), *map(str, options)]
            if python == sys.executable:
                process = warm.run(arguments, variables, timeout=60)
            else:
                process = subprocess.run(
                    [python, *arguments],
                    env=variables,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    text=True,
                    timeout=60,
                    check=False,
                )
        return CommandResult(process, folder, folder / "seen")

    return run


@dataclass
class RunResult:
    """The output of a command, and its error message if it failed."""

    stdout: str
    stderr: str = ""

    @property
    def returncode(self):
        return int(bool(self.stderr))


# The tests in these modules start new interpreters, as a user's command does. All other tests fork.
NEW_INTERPRETERS = {"test_run", "test_leftovers", "test_pythons"}


@pytest.fixture
def run(request, capsys, monkeypatch):
    """Run a command as the command line does, in this process, without plotting heat maps.

    Heat maps are tested by the tests of the report. Plotting a heat map takes a third as long as
    running a short condition.
    """
    monkeypatch.setattr(plots, "heatmap", lambda section, path: path.touch())
    monkeypatch.setattr(run_module, "PAUSE", 0.05)
    if request.module.__name__.rpartition(".")[2] not in NEW_INTERPRETERS:
        names = ("DEVNULL", "STDOUT", "TimeoutExpired")
        used = {name: getattr(subprocess, name) for name in names}
        monkeypatch.setattr(program, "subprocess", SimpleNamespace(Popen=warm.popen, **used))

    def call(out, options, command=AGENT, **environment):
        path = os.pathsep.join([str(LAB), environment.pop("PYTHONPATH", "")])
        monkeypatch.setenv("PYTHONPATH", path)
        problem = ""
        try:
            run_module.run(config(f"out={out}", *options.split()), shlex.split(command))
        except ValueError as error:
            problem = str(error)
        return RunResult(capsys.readouterr().out, problem)

    return call
