"""Tests of the bridge with the real habitat-lab 0.3; they are skipped if no environment with it is
available.

``tools/pythons.sh FOLDER`` creates ``FOLDER/lab``; ``MITIGATE_PYTHONS`` must name the folder.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

from mitigate.bridge.results import OWN, read, rows
from mitigate.bridge.server import Listener
from mitigate.corruptions import Corruption
from mitigate.worlds.apartments.export_command import export

from .conftest import condition

pytestmark = pytest.mark.slow

PROGRAM = Path(__file__).parent / "real" / "lab_agent.py"


@pytest.fixture(scope="module")
def lab():
    """Return the path of a Python interpreter with habitat-lab."""
    matches = Path(os.environ.get("MITIGATE_PYTHONS", "")) / "lab" / "bin" / "python"
    if "MITIGATE_PYTHONS" not in os.environ or not matches.is_file():
        pytest.skip("no environment with habitat-lab: tools/pythons.sh makes one")
    return str(matches)


@pytest.fixture(scope="module")
def episodes(tmp_path_factory):
    """Return a file of this project's episodes that was exported for habitat-lab."""
    out = tmp_path_factory.mktemp("habitat")
    export(out, "val_unseen", 1, ["vln"])
    return out / "datasets" / "vln" / "val_unseen.json.gz"


def run_lab(lab, episodes, met, folder):
    with Listener(met, folder, patience=20.0) as listener:
        process = subprocess.run(
            [lab, "-W", "ignore", str(PROGRAM), str(folder / "seen.json"), str(episodes)],
            env={**os.environ, **listener.environment()},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=120,
            check=False,
        )
    assert process.returncode == 0, process.stdout
    return json.loads((folder / "seen.json").read_text()), read(folder)


def test_hook_corrupts_and_measures_a_lab_task(lab, episodes, tmp_path):
    clean, _ = run_lab(lab, episodes, condition(), tmp_path / "clean")
    seen, reports = run_lab(lab, episodes, condition("low_light"), tmp_path / "met")
    assert len(seen) == len(clean) > 20
    assert all(a["rgb"] != b["rgb"] for a, b in zip(seen, clean, strict=True))
    assert all(a["depth"] == b["depth"] for a, b in zip(seen, clean, strict=True))
    assert len(reports.ends) == 10 and not reports.dropped
    assert reports.cameras[1]["max_depth"] == 10.0 and reports.cameras[1]["normalize_depth"] is True
    label = {"agent": "a", "name": "n", "split": "s", "seed": 0}
    own_rows = [
        r for r in rows(reports, Corruption("low_light", 0.6), label, None) if r["rule"] == OWN
    ]
    for row, end in zip(own_rows, reports.ends.values(), strict=True):
        metrics = end["metrics"]
        assert row["success"] == metrics["success"] and row["spl"] == metrics["spl"]
        assert end["distance"] == pytest.approx(metrics["distance_to_goal"], abs=1e-5)


def test_hook_corrupts_the_lab_instruction_sensor(lab, episodes, tmp_path):
    clean, _ = run_lab(lab, episodes, condition(), tmp_path / "clean")
    from mitigate.bridge.condition import Words, load_tokenizer

    words = Words(load_tokenizer(str(episodes)))
    seen, _ = run_lab(lab, episodes, condition("capitalize", 1.0, words=words), tmp_path / "met")
    assert all(a["text"] != b["text"] for a, b in zip(seen, clean, strict=True))
    assert all(a["text"].lower() == b["text"].lower() for a, b in zip(seen, clean, strict=True))
