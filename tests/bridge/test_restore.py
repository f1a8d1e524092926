"""A restorer behind the bridge: frames of programs are restored, by panorama or camera."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import torch

from mitigate.bridge.cameras import Rig
from mitigate.bridge.check import described, of
from mitigate.bridge.results import Told
from mitigate.core.observation import DEPTH, RGB
from mitigate.guards.frames.restorer import Restorer

from .conftest import condition


@pytest.fixture
def restorer():
    """It takes every frame for corrupted, and makes it twice as bright or as far."""
    made = Restorer(width=4, depth_width=4).eval()
    with torch.no_grad():
        for sensor, net in made.parts().items():
            channels = 3 if sensor == RGB else 1
            net.threshold.fill_(-1e9)
            bias = net.net.head.bias.view(-1, 4)
            bias[:channels], bias[2 * channels] = np.log(2.0), -100.0
    return made


def camera(name, kind=RGB, yaw=0.0, **more):
    shape, dtype = ([16, 16, 3], "uint8") if kind == RGB else ([16, 16, 1], "float32")
    told = {"name": name, "type": kind, "shape": shape, "dtype": dtype, "hfov": 90}
    return {**told, "orientation": [0.0, np.radians(yaw), 0.0], **more}


def filled(rig, value):
    offsets, size = rig.lay_out([RGB, DEPTH])
    memory = bytearray(size)
    for shown in rig.cameras:
        frame = np.full(shown.shape, value[shown.kind], shown.dtype)
        at = offsets[shown.name]
        memory[at : at + shown.bytes] = frame.tobytes()
    return memory, offsets


def test_frames_are_restored_in_place_and_told(restorer):
    ring = [camera(f"rgb_{yaw}", yaw=yaw) for yaw in range(0, 360, 30)]
    far = {"min_depth": 0.0, "max_depth": 10.0, "normalize_depth": True}
    rig = Rig([*ring, camera("front", yaw=7.0), camera("depth", DEPTH, **far)])
    memory, offsets = filled(rig, {RGB: 60, DEPTH: 0.04})
    changed = rig.restore(memory, offsets, restorer)
    assert sorted(changed) == sorted(shown.name for shown in rig.cameras)
    for shown in rig.cameras:
        frame = shown.read(memory, offsets)
        assert frame.mean() == pytest.approx(120 if shown.kind == RGB else 0.08, rel=0.03)


def test_what_is_taken_for_clean_is_not_told(restorer):
    for net in restorer.parts().values():
        net.threshold.fill_(1e9)
    rig = Rig([camera("rgb"), camera("depth", DEPTH)])
    memory, offsets = filled(rig, {RGB: 60, DEPTH: 2.0})
    before = bytes(memory)
    assert rig.restore(memory, offsets, restorer) == [] and bytes(memory) == before


def test_a_program_sees_restored_frames_even_where_nothing_is_corrupted(command, restorer):
    seen = [command(condition("clean", restorer=r), "--episodes", 1) for r in (None, restorer)]
    assert [ran.status for ran in seen] == [0, 0], seen[1].output
    plain, restored = (ran.seen() for ran in seen)
    assert plain.keys() == restored.keys()
    for look, entry in plain.items():
        shown = entry["frames"]
        assert any(restored[look]["frames"][name] != digest for name, digest in shown.items())


def test_a_restorer_of_what_no_camera_shows_is_refused_at_the_end_of_the_first_episode(
    run, tmp_path
):
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
    assert "is for depth, but episode one shows rgb: leave restore= out" in ended.stderr
    assert "spatter-s0.6: started" not in ended.stdout


def test_a_check_says_what_is_restored(restorer):
    rig = Rig([camera("rgb")])
    frames = {of("rgb"): np.zeros((16, 16, 3), np.uint8)}
    assert "restored: rgb" in described(Told(), rig, frames, restorer)
    only = Restorer(sensors=[DEPTH], depth_width=4)
    assert "restored: nothing of these, the restorer is for depth" in described(
        Told(), rig, frames, only
    )
    assert not any("restored" in line for line in described(Told(), rig, frames))
