"""The stand-in lab's program, run as a user's command."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mitigate.bridge.connection import Condition
from mitigate.bridge.results import read
from mitigate.bridge.server import Listener
from mitigate.bridge.words import Words
from mitigate.corruptions import Corruption

LAB = Path(__file__).parent / "lab"


def condition(name="clean", severity=0.6, **more):
    """A condition by name; clean has severity 0."""
    corruption = Corruption(name, 0.0 if name == "clean" else severity)
    return Condition(corruption, seed=0, words=more.pop("words", Words()), **more)


class Ran:
    """How a command went: its status, output, what it told, and what its workers saw."""

    def __init__(self, process, folder, seen):
        self.status, self.output = process.returncode, process.stdout
        self.told, self._seen = read(folder), seen

    def seen(self):
        """{(episode, number of the look): what was seen}, of all workers."""
        found = {}
        for file in sorted(self._seen.parent.glob(f"{self._seen.name}.*")):
            looks = {}
            for entry in json.loads(file.read_text()):
                number = looks[entry["episode"]] = looks.get(entry["episode"], -1) + 1
                found[entry["episode"], number] = entry
        return found


@pytest.fixture
def command(tmp_path):
    """Run the stand-in's program with options under a condition, as ``mitigate run`` does."""

    def run(what, *options, python=sys.executable, patience=10.0, **environment):
        folder = tmp_path / f"{what.corruption.name}-{len(list(tmp_path.iterdir()))}"
        with Listener(what, folder, patience) as listener:
            given = {**os.environ, **listener.environment(), "MITIGATE_TEST": "1"}
            given["PYTHONPATH"] = os.pathsep.join([given["PYTHONPATH"], str(LAB)])
            process = subprocess.run(
                [python, str(LAB / "agent.py"), str(folder / "seen"), *map(str, options)],
                env={**given, **environment},
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=60,
                check=False,
            )
        return Ran(process, folder, folder / "seen")

    return run
