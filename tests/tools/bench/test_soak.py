"""Tests that the soak test detects growing memory and open files, and reports series that are too
short."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from tools.bench import soak
from tools.bench.growth import Growth, growth

HOURS = np.linspace(0, 1, 600)


def wander(seed: int, share: float = 0.9) -> np.ndarray:
    """Return autocorrelated noise with a standard deviation of 3."""
    rng = np.random.default_rng(seed)
    values = np.zeros(len(HOURS))
    for n in range(1, len(values)):
        values[n] = share * values[n - 1] + rng.normal(0, 3 * (1 - share**2) ** 0.5)
    return values


def test_growth_finds_a_leak():
    result = growth(HOURS, 900 + 40 * HOURS + wander(0))
    assert result.low < 40 < result.high and result.low > 20
    assert result.verdict == "grows"


def test_growth_ignores_the_first_quarter():
    values = 900 - 500 * np.exp(-HOURS / 0.03) + wander(1, 0.2)
    assert growth(HOURS, values).verdict == "flat"


def test_growth_interval_covers_the_true_slope():
    covered = [g.low <= 0 <= g.high for g in (growth(HOURS, wander(seed)) for seed in range(30))]
    assert 0.75 <= np.mean(covered) <= 1.0


def test_growth_is_undecided_for_a_short_series():
    short = np.linspace(0, 0.05, 60)
    assert growth(short, 900 + wander(2)[:60]).verdict == "too short to say"
    with pytest.raises(ValueError, match="A slope needs >= 20"):
        growth(short[:10], np.ones(10))


def test_growth_of_a_constant_is_flat():
    assert Growth(1.0, 100.0, 0.0, 0.0, 0.0).verdict == "flat"


HOLDS = """
import subprocess, sys
files = [open("/dev/null") for _ in range(40)]
if len(sys.argv) > 1:
    child = subprocess.Popen([sys.executable, __file__])
print("ready", flush=True)
sys.stdin.read()
"""


def test_measured_counts_all_processes(tmp_path):
    script = tmp_path / "holds.py"
    script.write_text(HOLDS)
    command = [sys.executable, str(script), "parent"]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == process.stdout.readline() == "ready\n"
        count, memory, descriptors = soak.measured(process.pid)
        assert count == 2 and descriptors >= 80 and 4 < memory < 200
    finally:
        process.stdin.close()
        process.wait()
    assert soak.measured(process.pid) == (0, 0.0, 0)


def test_main_reports_a_load_that_ends(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(soak, "LOADS", {"nothing": None})
    assert soak.main(["--minutes", "0.2", "--every", "0.1", "--out", str(tmp_path)]) == 1
    output = capsys.readouterr().out
    assert "nothing ended early" in output and "KeyError" in output
    assert (tmp_path / "soak.csv").is_file() and (tmp_path / "soak.png").is_file()
    assert sorted(p.name for p in tmp_path.iterdir() if p.is_dir()) == []
