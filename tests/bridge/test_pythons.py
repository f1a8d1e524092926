"""Tests of the hook in all Python versions that agents use.

``tools/pythons.sh FOLDER`` creates an environment with numpy for each installed version. The
variable ``MITIGATE_PYTHONS`` must name the folder (CI sets it). Without the variable, these tests
are skipped.
"""

import os
import signal
import subprocess
from pathlib import Path

import pytest

from mitigate.bridge.results import read
from mitigate.bridge.server import Listener

from .conftest import condition

VERSIONS = ("3.6", "3.8", "3.9", "3.11", "3.13")
HOOK = Path("mitigate/bridge/hook").resolve()


@pytest.fixture(params=VERSIONS)
def python(request):
    """Return the interpreter of a Python version."""
    folder = os.environ.get("MITIGATE_PYTHONS")
    if folder is None:
        pytest.skip("MITIGATE_PYTHONS is not set: tools/pythons.sh makes what it names")
    path = Path(folder) / request.param / "bin" / "python"
    if not path.is_file():
        pytest.skip(f"Python {request.param} is not installed here")
    return str(path)


def test_hook_compiles(python, tmp_path):
    for file in sorted(HOOK.glob("*.py")):
        code = f"compile(open({str(file)!r}).read(), {file.name!r}, 'exec')"
        subprocess.run([python, "-c", code], check=True)


def test_hook_gives_equal_pixels_in_every_python(python, command):
    expected = command(condition("low_light_noise"), "--cameras", 12).seen()
    options = ("--cameras", 12, "--workers", 2, "--start", "forkserver")
    result = command(condition("low_light_noise"), *options, python=python)
    assert result.status == 0, result.output
    seen = result.seen()
    assert {key: entry["frames"]["rgb"] for key, entry in seen.items()} == {
        key: entry["frames"]["rgb"] for key, entry in expected.items()
    }
    assert len(result.reports.ends) == 4


LOOP = """
import numpy, mitigate_hook
rgb = numpy.full((16, 16, 3), 90, "uint8")
for scene, name in mitigate_hook.wanted([("x.glb", 1), ("x.glb", 2)]):
    episode = mitigate_hook.connect(name, scene=scene, instruction="Go to the door.")
    seen = episode.corrupt({"rgb": rgb, "depth": rgb[..., 0] / 90.0, "pose": numpy.eye(4)})
    assert (seen["rgb"] != rgb).any()
    episode.finish(success=numpy.array(1), spl=numpy.float32(0.5))
mitigate_hook.connect("3").corrupt({"left": [rgb, {"rgb": rgb}]})
"""


def test_loop_runs_and_reports_why_it_stops(python, tmp_path):
    with Listener(condition("low_light"), tmp_path) as listener:
        result = subprocess.run(
            [python, "-c", LOOP],
            env={**os.environ, **listener.environment()},
            stderr=subprocess.PIPE,
            text=True,
            timeout=20,
            check=False,
        )
    reports = read(tmp_path)
    assert result.returncode == 97 and sorted(reports.ends) == ["x/1", "x/2"], result.stderr
    assert "the entry left of an observation may be a frame" in reports.problems[0]


def test_hook_loads_without_numpy(python, tmp_path):
    """Every Python process of a command loads the hook, although most of them read no camera."""
    result = subprocess.run(
        [python, "-S", "-c", "import sys; sys.path.insert(0, sys.argv[1]); import sitecustomize",
         str(HOOK)],
        env={"MITIGATE_BRIDGE": "nowhere"},
        capture_output=True,
        text=True,
        check=True,
    )  # fmt: skip
    assert result.stderr == ""


def test_hook_is_not_loaded_in_python_2():
    guard = (HOOK / "sitecustomize.py").read_text().splitlines()
    assert "if sys.version_info >= (3, 6):" in guard and "import mitigate_hook" not in guard


def test_hook_stops_if_the_server_does_not_answer(python, tmp_path):
    code = "import mitigate_hook; mitigate_hook.connect('1')"
    with Listener(condition(), tmp_path, patience=1.0) as listener:
        os.killpg(listener.pid, signal.SIGSTOP)
        result = subprocess.run(
            [python, "-c", code],
            env={**os.environ, **listener.environment()},
            stderr=subprocess.PIPE,
            text=True,
            timeout=20,
            check=False,
        )
    assert result.returncode == 97 and "did not answer within 1 s" in result.stderr
