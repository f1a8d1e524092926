"""Tests that an unmodified program gets equal pixels in every process, and no clean frames."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mitigate.bridge.condition import Condition, Words
from mitigate.bridge.connection import Connection
from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import Corruption, Key
from mitigate.worlds.habitat import corrupt_habitat

from .conftest import LAB, condition


def clean_frames(tmp_path):
    """Return the frames of the first two steps in the fake lab, without the bridge."""
    code = (
        "import sys, numpy\n"
        "from habitat.core.env import Env\n"
        "env = Env(config={'cameras': 12})\n"
        "for number, seen in enumerate([env.reset(), env.step(1)]):\n"
        "    frames = {n: f for n, f in seen.items() if n.startswith(('rgb', 'depth'))}\n"
        "    numpy.savez(f'{sys.argv[1]}/{number}.npz', **frames)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(LAB)}
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], env=environment, check=True)
    return [dict(np.load(tmp_path / f"{number}.npz")) for number in range(2)]


@pytest.mark.slow
def test_hook_gives_the_pixels_of_corrupt_habitat(command, tmp_path):
    clean = clean_frames(tmp_path)
    for name in ("spatter", "flare", "missing_data", "spatter+gaussian_noise", "haze+flare"):
        result = command(condition(name), "--cameras", 12, "--episodes", 1, "--steps", 2)
        assert result.status == 0, result.output
        for number, instant in enumerate(clean):
            expected = corrupt_habitat(
                instant, Corruption(name, 0.6), Key(0, "s0.glb/0", number), heading=0.0
            )
            seen = result.seen()["0", number]["frames"]
            for camera, frame in expected.items():
                assert seen[camera] == hashlib.sha256(frame.tobytes()).hexdigest(), camera


@pytest.mark.parametrize("start", ["fork", "forkserver", "spawn"])
def test_hook_gives_workers_the_pixels_of_one_process(command, start):
    alone = command(condition("low_light_noise")).seen()
    result = command(condition("low_light_noise"), "--workers", 2, "--start", start)
    assert result.status == 0, result.output
    assert result.seen() == alone
    assert len(result.reports.ends) == 4


def test_hook_leaves_goal_pictures_clean(command):
    clean = command(condition(), "--teleport").seen()
    result = command(condition("low_light"), "--teleport")
    assert result.seen().keys() == clean.keys()
    for place, seen in result.seen().items():
        before = clean[place]
        assert list(seen["frames"]) == list(before["frames"])
        assert seen["frames"]["rgb"] != before["frames"]["rgb"]
        assert seen["frames"]["depth"] == before["frames"]["depth"]
        if "goal" in seen["frames"]:
            assert seen["frames"]["goal"] == before["frames"]["goal"]
        assert seen["owned"]["rgb"]


def test_hook_counts_one_call_per_step(command):
    """Reading a goal picture or rendering a frame does not count as a call."""
    reports = command(condition("spatter"), "--steps", 3).reports
    assert [end["calls"] for end in reports.ends.values()] == [4, 4, 4, 4]


def test_condition_draws_other_pixels_for_repeats(command):
    first = command(condition("gaussian_noise"), "--episodes", 1).seen()
    again = command(condition("gaussian_noise", repeat=1), "--episodes", 1).seen()
    assert first["0", 0]["frames"]["depth"] != again["0", 0]["frames"]["depth"]


def test_hook_corrupts_instructions(command):
    result = command(condition("capitalize", 1.0))
    assert result.seen()["2", 1]["words"]["text"] == "WALK TO the DOOR 2."


def test_hook_corrupts_frames_and_instruction_of_a_pair(command):
    clean = command(condition()).seen()["2", 1]
    seen = command(condition("spatter+capitalize", 1.0)).seen()["2", 1]
    assert seen["words"]["text"] == "WALK TO the DOOR 2."
    assert seen["frames"]["rgb"] != clean["frames"]["rgb"]
    assert seen["frames"]["depth"] == clean["frames"]["depth"]


def test_hook_stops_for_tokens_without_a_tokenizer(command):
    result = command(condition("capitalize", 1.0), "--tokens")
    assert result.status == 97
    assert "tokenizer=" in result.output and "would read the original instruction" in result.output
    assert not result.reports.ends


def test_hook_needs_no_tokenizer_for_unchanged_words(command):
    result = command(condition("spatter"), "--tokens")
    assert result.status == 0 and result.seen()["0", 0]["words"]["tokens"] == [4, 5, 6]


def test_hook_reports_results(command):
    reports = command(condition(), "--steps", 3).reports
    assert sorted(reports.ends) == ["s0/0", "s0/2", "s1/1", "s1/3"]
    end = reports.ends["s1/1"]
    assert end["stopped"] is True and end["metrics"]["success"] == 0.0  # 3.25 m away
    assert end["start_distance"] == 4.0 and end["distance"] == pytest.approx(3.5)
    assert len(end["path"]) == 3 and end["steps"] == 3
    assert "top_down_map.a" not in end["metrics"]


def test_hook_reports_an_unended_episode_at_the_next_reset(command):
    reports = command(condition(), "--no-stop").reports
    assert len(reports.ends) == 4  # the last episode ends when the Env is closed
    end = reports.ends["s0/0"]
    # measured at the end of the episode, not at the start of the next one
    assert end["distance"] == pytest.approx(0.5)
    assert end["stopped"] is False


def test_rig_groups_cameras_of_a_panorama():
    from mitigate.bridge.cameras import Rig

    def camera(name, yaw, size=8, pitch=0.0):
        description = {"name": name, "type": "rgb", "shape": [size, size, 3], "dtype": "uint8"}
        return {**description, "hfov": 90, "orientation": [pitch, np.radians(yaw), 0.0]}

    rig = Rig([camera("rgb", 0), camera("rgb_30", 30), camera("rgbdown", 0, pitch=-0.5),
               camera("rgbback", 180, size=16)])  # fmt: skip
    matches = {group.suffix: (len(group.cameras), group.views) for group in rig.groups}
    assert matches == {"": (2, (0, 11)), "rgbdown": (1, (0,)), "rgbback": (1, (6,))}
    offsets, size = rig.lay_out(["rgb"])
    assert len(set(offsets.values())) == 4 and size >= 12 * 192 + 192 + 7 * 768


def test_rig_separates_normalised_and_metric_depth():
    from mitigate.bridge.cameras import Rig

    description = {"type": "depth", "shape": [8, 8, 1], "dtype": "float32", "min_depth": 0}
    description |= {"max_depth": 10, "hfov": 90}
    rig = Rig(
        [
            {"name": "depth", **description},
            {"name": "depth_30", **description, "normalize_depth": True},
        ]
    )
    assert sorted(len(group.cameras) for group in rig.groups) == [1, 1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"shape": [4, 4, 3, 1]}, "shape"),
        ({"shape": [1 << 20, 4, 3]}, "shape"),
        ({"dtype": "float64"}, "uint8"),
        ({"type": "semantic"}, "kind"),
    ],
)
def test_rig_rejects_unsupported_cameras(change, words):
    from mitigate.bridge.cameras import Rig

    description = {"name": "rgb", "type": "rgb", "shape": [4, 4, 3], "dtype": "uint8", **change}
    with pytest.raises(ValueError, match=words):
        Rig([description])


def test_hook_does_nothing_outside_a_run(tmp_path):
    code = "import sys, mitigate_hook; mitigate_hook.install(); print(sys.meta_path[0])"
    result = subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": str(Path("mitigate/bridge/hook").resolve())},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "mitigate" not in result.stdout


def test_connection_keeps_frames_of_an_episode_across_calls(tmp_path):
    """A program may read RGB and depth in separate calls, each with its own camera description."""
    condition = Condition(Corruption("frame_delay", 0.4), 3, Words())
    connection = Connection(None, condition, tmp_path, "token", tmp_path)
    described = {
        RGB: {"name": "rgb", "type": "rgb", "shape": [4, 4, 3], "dtype": "uint8"},
        DEPTH: {"name": "depth", "type": "depth", "shape": [4, 4, 1], "dtype": "float32"},
    }

    def take(kind, number, call):
        offsets = connection.on_spec({"cameras": [described[kind]]})["offsets"]
        dtype = described[kind]["dtype"]
        shape = described[kind]["shape"]
        frame = np.frombuffer(
            connection.shared.map, dtype, int(np.prod(shape)), offsets[kind]
        ).reshape(shape)
        frame[...] = number
        connection.on_frame({"call": call})
        return float(frame.flat[0])

    for episode in ("7", "8"):  # the delay is 2 calls, so each sensor shows its previous frame
        connection.on_episode({"scene": "house.glb", "id": episode, "text": "Walk."})
        shown = [(take(RGB, n, 2 * n), take(DEPTH, n + 0.5, 2 * n + 1)) for n in range(1, 6)]
        assert shown == [(1, 1.5), (1, 1.5), (2, 2.5), (3, 3.5), (4, 4.5)]
