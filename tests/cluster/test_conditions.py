"""Tests of ``mitigate run`` on a cluster: if a worker dies, its condition runs again."""

from __future__ import annotations

import sys

import pytest
from omegaconf import OmegaConf

from mitigate.bridge.plan import Plan, make_cells
from mitigate.bridge.run import run_all
from mitigate.core.conf import load_config

pytestmark = pytest.mark.xdist_group("launchers")  # as tests/cluster/test_launchers.py

# This agent runs two episodes.
# Under spatter, it kills its worker in the first episode, but only once.
AGENT = """
import os, pathlib, signal, sys, time
import mitigate_hook, numpy
note = pathlib.Path(sys.argv[1])
for name in "ab":
    episode = mitigate_hook.connect(name)
    for step in range(2):
        episode.corrupt({"rgb": numpy.full((8, 8, 3), 90, "uint8")})
    if sys.argv[2] == "spatter-s0.6" and not note.exists():
        note.touch()
        pid = os.getpid()
        for _ in range(3):  # the parent, the supervisor, the worker
            pid = int(open(f"/proc/{pid}/stat").read().rpartition(")")[2].split()[1])
        os.kill(pid, signal.SIGKILL)
        time.sleep(60)  # the supervisor ends this
    episode.finish(success=name == "a", spl=0.5 * (name == "a"))
"""


def test_lost_condition_runs_again(ray_launcher, tmp_path, capsys):
    program, out = tmp_path / "agent.py", tmp_path / "o"
    program.write_text(AGENT)
    command = [sys.executable, str(program), str(tmp_path / "died"), "{condition}"]
    options = [f"out={out}", "conditions=[spatter]", "launcher=ray"]
    config = OmegaConf.to_object(load_config("run", options))
    plan = Plan(config, tuple(command), "agent", out)
    spatter = make_cells(plan)[1]
    assert run_all(plan, [spatter]) == []
    assert (tmp_path / "died").exists() and "again on another" in capsys.readouterr().out
    results = [(row["episode_id"], row["rule"]) for row in spatter.rows()]
    assert {episode for episode, _ in results} == {"a", "b"} and len(results) == len({*results})
    assert run_all(plan, [spatter]) == []
    assert "spatter-s0.6: done before" in capsys.readouterr().out
