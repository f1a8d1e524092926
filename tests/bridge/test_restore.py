"""Tests of a restorer with the bridge: a panorama is restored as a whole, other cameras one by
one."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import torch

from mitigate.bridge.cameras import Rig
from mitigate.bridge.check import describe, entry_name
from mitigate.bridge.results import Reports
from mitigate.core.observation import DEPTH, RGB
from mitigate.evaluation import rows
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.guard import Guards
from mitigate.guards.opening import open_guards

from .conftest import condition

FILTERS = "tests.guards.filters"


@pytest.fixture
def restorer():
    """A restorer that doubles the brightness or the depth of every frame."""
    model = Restorer(width=4, depth_width=4).eval()
    with torch.no_grad():
        for sensor, net in model.parts().items():
            channels = 3 if sensor == RGB else 1
            net.threshold.fill_(-1e9)
            bias = net.net.head.bias.view(-1, 4)
            bias[:channels], bias[2 * channels] = np.log(2.0), -100.0
    return model


def camera(name, kind=RGB, yaw=0.0, **more):
    shape, dtype = ([16, 16, 3], "uint8") if kind == RGB else ([16, 16, 1], "float32")
    description = {"name": name, "type": kind, "shape": shape, "dtype": dtype, "hfov": 90}
    return {**description, "orientation": [0.0, np.radians(yaw), 0.0], **more}


def filled(rig, value):
    offsets, size = rig.lay_out([RGB, DEPTH])
    memory = bytearray(size)
    for observed in rig.cameras:
        frame = np.full(observed.shape, value[observed.kind], observed.dtype)
        at = offsets[observed.name]
        memory[at : at + observed.bytes] = frame.tobytes()
    return memory, offsets


def test_guard_restores_frames_in_place(restorer):
    ring = [camera(f"rgb_{yaw}", yaw=yaw) for yaw in range(0, 360, 30)]
    far = {"min_depth": 0.0, "max_depth": 10.0, "normalize_depth": True}
    rig = Rig([*ring, camera("front", yaw=7.0), camera("depth", DEPTH, **far)])
    memory, offsets = filled(rig, {RGB: 60, DEPTH: 0.04})
    changed = rig.guard(memory, offsets, Guards([restorer]), {})
    assert sorted(changed) == sorted(observed.name for observed in rig.cameras)
    for observed in rig.cameras:
        frame = observed.read(memory, offsets)
        assert frame.mean() == pytest.approx(120 if observed.kind == RGB else 0.08, rel=0.03)


def test_guard_leaves_clean_frames_unchanged(restorer):
    for net in restorer.parts().values():
        net.threshold.fill_(1e9)
    rig = Rig([camera("rgb"), camera("depth", DEPTH)])
    memory, offsets = filled(rig, {RGB: 60, DEPTH: 2.0})
    before = bytes(memory)
    assert rig.guard(memory, offsets, Guards([restorer]), {}) == [] and bytes(memory) == before


def test_hook_restores_frames_of_the_clean_condition(command, restorer):
    chains = (Guards(), Guards([restorer]))
    results = [command(condition("clean", guards=chain), "--episodes", 1) for chain in chains]
    assert [result.status for result in results] == [0, 0], results[1].output
    plain, restored = (result.seen() for result in results)
    assert plain.keys() == restored.keys()
    for look, entry in plain.items():
        observed = entry["frames"]
        assert any(restored[look]["frames"][name] != digest for name, digest in observed.items())


def test_run_rejects_a_restorer_without_a_camera(run, tmp_path):
    program = tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook, numpy\n"
        "episode = mitigate_hook.connect('one')\n"
        "episode.corrupt({'rgb': numpy.full((8, 8, 3), 90, 'uint8')})\n"
        "episode.finish(success=1)\n"
    )
    Restorer(sensors=[DEPTH], depth_width=4).save(tmp_path / "mine")
    options = f"conditions=[spatter] restore={tmp_path}/mine"
    ended = run(tmp_path / "out", options, f"{sys.executable} {program}")
    assert "is for depth, but episode one shows rgb: omit restore=" in ended.stderr
    assert "spatter-s0.6: started" not in ended.stdout


def test_guard_gets_rgb_and_depth_of_one_view_together():
    far = {"min_depth": 0.0, "max_depth": 10.0, "normalize_depth": True}
    pair = [camera("rgb"), camera("depth", DEPTH, **far)]
    apart = [camera("side", yaw=7.0), camera("other", DEPTH, yaw=9.0)]
    seen = []

    class Notes(Guards):
        frames = (RGB, DEPTH)

        def observe(self, observation):
            seen.append({name: frame.shape for name, frame in observation.items()})
            return (
                {**observation, DEPTH: observation[DEPTH] * 2}
                if DEPTH in observation
                else {**observation}
            )

    rig = Rig([*pair, *apart])
    memory, offsets = filled(rig, {RGB: 60, DEPTH: 0.25})
    assert sorted(rig.guard(memory, offsets, Notes(), {})) == ["depth", "other"]
    both, colour, depth = {RGB: (16, 16, 3), DEPTH: (16, 16, 1)}, (16, 16, 3), (16, 16, 1)
    assert sorted(seen, key=len) == [{RGB: colour}, {DEPTH: depth}, both]
    depths = [
        observed.read(memory, offsets).mean() for observed in rig.cameras if observed.kind == DEPTH
    ]
    assert depths == pytest.approx([0.5, 0.5])
    not_level = [camera("rgb", orientation=[0.3, 0.0, 0.0]), camera("depth", DEPTH)]
    seen.clear()
    rig = Rig(not_level)
    rig.guard(*filled(rig, {RGB: 60, DEPTH: 0.25}), Notes(), {})
    assert [len(observed) for observed in seen] == [1, 1]


def test_hook_gives_the_frames_of_a_callable(command):
    chains = (Guards(), open_guards(None, f"{FILTERS}:Brighter"))
    results = [command(condition("clean", guards=chain), "--episodes", 1) for chain in chains]
    assert [result.status for result in results] == [0, 0], results[1].output
    plain, brighter = (result.seen() for result in results)
    assert plain.keys() == brighter.keys()
    for look, entry in plain.items():
        for name, digest in entry["frames"].items():
            assert (brighter[look]["frames"][name] != digest) == name.startswith("rgb")


@pytest.mark.slow
def test_callable_changes_the_agent_in_rows(run, tmp_path):
    options = "conditions=[clean] name=stand split=toy"
    agents = {}
    for number, choice in enumerate(("null", f"{FILTERS}:median", f"{FILTERS}:median@2")):
        ended = run(tmp_path / str(number), f"{options} restore={choice}")
        assert ended.returncode == 0, ended.stdout + ended.stderr
        records = rows.read(tmp_path / str(number) / "rows.jsonl")
        agents |= {row["name"]: row["agent"] for row in records}
    assert [*agents] == ["stand", "stand+filters.median", "stand+filters.median@2"]
    assert len(set(agents.values())) == 3
    again = run(tmp_path / "1", f"{options} restore={FILTERS}:median")
    assert "clean: done before" in again.stdout
    other = run(tmp_path / "1", f"{options} restore={FILTERS}:median@3")
    assert "was run with another restore" in other.stderr


def test_run_names_a_failing_callable(run, tmp_path):
    ended = run(tmp_path / "out", f"conditions=[clean] restore={FILTERS}:broken")
    assert f"restore={FILTERS}:broken failed with RuntimeError: out of memory" in ended.stderr


def test_run_rejects_a_guard_that_adapts_the_agent(run, tmp_path):
    ended = run(tmp_path / "out", f"conditions=[clean] restore={FILTERS}:Politely")
    assert "filters.Politely adapts the agent, but the bridge cannot adapt" in ended.stderr


def test_describe_names_restored_frames(restorer):
    rig = Rig([camera("rgb")])
    frames = {entry_name("rgb"): np.zeros((16, 16, 3), np.uint8)}
    assert "restored: rgb" in describe(Reports(), rig, frames, Guards([restorer]))
    only = Restorer(sensors=[DEPTH], depth_width=4)
    assert "restored: none of these, the restorer is for depth" in describe(
        Reports(), rig, frames, Guards([only])
    )
    assert not any("restored" in line for line in describe(Reports(), rig, frames))
