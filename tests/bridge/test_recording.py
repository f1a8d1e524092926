"""Tests of recording a program's frames: the written files, and errors."""

import json
import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from mitigate.bridge.cameras import Rig, read_camera
from mitigate.bridge.events import put_aside
from mitigate.bridge.recording import Recorder, is_whole, path_part, png, unique_part
from mitigate.core.output import UnsafePathError
from mitigate.corruptions import DepthSensor
from mitigate.encoders.sources import TRAIN, UNSEEN, FolderFrames

from .conftest import AGENT, condition


@pytest.mark.slow
def test_recorder_writes_clean_frames_poses_actions_and_measures(command, tmp_path):
    folder = tmp_path / "recording"
    met = condition("low_light", observer=Recorder(folder))
    seen = command(met, "--cameras", 2, "--steps", 3).seen()
    clean = command(condition(), "--cameras", 2, "--steps", 3).seen()
    assert seen["0", 1]["frames"]["rgb"] != clean["0", 1]["frames"]["rgb"]
    episode = folder / "s0" / "0"
    assert json.loads((episode / "episode.json").read_text())["text"] == "Walk to the door 0."
    steps = [json.loads(line) for line in (episode / "steps.jsonl").read_text().splitlines()]
    assert [step["call"] for step in steps] == [0, 1, 2, 3]
    assert steps[2]["position"] == [0.0, 0.0, -0.5]
    end = json.loads((episode / "end.json").read_text())
    assert end["actions"] == [1, 1, 0] and end["metrics"]["success"] == 1.0
    for camera in ("rgb", "rgb_30", "depth", "depth_30"):
        assert len(list((episode / camera).glob("*.png"))) == 4
    depth = cv2.imread(str(episode / "depth" / "000000.png"), cv2.IMREAD_UNCHANGED)
    assert depth.dtype == np.uint16 and 900 < depth.min() < depth.max() < 9100  # millimetres
    frames = FolderFrames(str(folder), held_out=0.5)
    assert list(frames.scenes(TRAIN)) == ["s0"] and list(frames.scenes(UNSEEN)) == ["s1"]


@pytest.mark.parametrize("name", ["../../etc/passwd", "..", "a/b", "", "x\n.y"])
def test_path_part_stays_in_the_folder(name):
    output = path_part(name)
    assert output and "/" not in output and not output.startswith(".") and "\n" not in output


def test_unique_part_distinguishes_similar_names():
    names = ["left-door", "left door", "left/door", "日本", "中国", "-", ".x", "x", "", "a" * 400]
    names.append("a" * 399)
    output = [unique_part(name) for name in names]
    assert len({*output}) == len(names) and max(map(len, output)) < 200
    assert output[0] == "left-door" and output[1].startswith("left-door-") and output[7] == "x"
    assert all("/" not in name and not name.startswith(".") for name in output)


def test_recorder_writes_the_cameras_of_all_calls(tmp_path):
    recorder, memory = Recorder(tmp_path), bytearray(4096)
    recorder.episode({"scene": "k.glb", "id": "left door"})
    for call, description in enumerate(
        [
            {"name": "rgb", "type": "rgb", "shape": [4, 4, 3], "dtype": "uint8"},
            {"name": "depth", "type": "depth", "shape": [4, 4, 1], "dtype": "float32"},
        ]
    ):
        rig = Rig([description])
        recorder.frame({"call": call}, rig, memory, rig.lay_out(["rgb", "depth"])[0])
    recorder.end({"kind": "end"})
    (file,) = tmp_path.glob("k/left-door-*/cameras.json")
    assert {*json.loads(file.read_text())} == {"rgb", "depth"}


def test_png_holds_millimetres_and_holes():
    description = {"name": "depth", "type": "depth", "shape": [2, 2, 1], "dtype": "float32"}
    description |= {"min_depth": 0.5, "max_depth": 5.0, "normalize_depth": True}
    camera = read_camera(description, DepthSensor())
    frame = np.array([[0.0, 1.0], [0.5, np.nan]], np.float32)[:, :, None]
    counts = cv2.imdecode(np.frombuffer(png(camera, frame), np.uint8), cv2.IMREAD_UNCHANGED)
    assert counts.tolist() == [[0, 5000], [2750, 0]]


def test_recorder_deletes_an_unfinished_episode(run, tmp_path):
    options = f"conditions=[clean] record={tmp_path / 'recording'}"
    assert run(tmp_path / "out", options, f"{AGENT} --die-at 2").returncode == 1
    assert (tmp_path / "recording/clean/recording.json").is_file()
    assert not list((tmp_path / "recording/clean").glob("s*/*"))


def test_run_deletes_drafts_of_ended_processes(run, tmp_path):
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    scene = tmp_path / "recording" / "clean" / "s0"
    for pid in (dead.pid, os.getpid(), 10**30):
        (scene / f".7.{pid}.tmp" / "rgb").mkdir(parents=True)
    options = f"conditions=[clean] record={tmp_path / 'recording'}"
    assert run(tmp_path / "out", options).returncode == 0
    names = [path.name for path in scene.iterdir()]
    assert "0" in names and [n for n in names if n[0] == "."] == [f".7.{os.getpid()}.tmp"]


def test_recorder_keeps_a_recording_until_the_next_end(tmp_path):
    """After the last episode, Habitat's loops call reset, which starts the first episode again."""
    recorder, description = Recorder(tmp_path), {"scene": "k.glb", "id": "1"}
    recorder.episode(description)
    recorder.end({"kind": "end", "steps": 3})
    recorder.episode(description)
    assert is_whole(tmp_path, [{"scene": "k.glb", "episode": "1"}])
    recorder.end({"kind": "end", "steps": 4})
    assert json.loads((tmp_path / "k" / "1" / "end.json").read_text())["steps"] == 4
    assert [path.name for path in (tmp_path / "k").iterdir()] == ["1"]


TOLD = {"scene": "k.glb", "id": "1"}


@pytest.mark.parametrize("inner", ["r", "r/clean", "r/clean/k", "r/clean/k/1"])
def test_recorder_deletes_nothing_behind_a_link(tmp_path, inner):
    remaining = tmp_path / "v" / Path("r/clean/k/1").relative_to(inner) / "keep.txt"
    remaining.parent.mkdir(parents=True)
    remaining.write_text("mine")
    link = tmp_path / inner
    link.parent.mkdir(parents=True, exist_ok=True)
    link.symlink_to(tmp_path / "v")
    recorder = Recorder(tmp_path / "r" / "clean", tmp_path / "r")
    if inner == "r":  # the folder that the user named may be a link
        recorder.episode(TOLD)
        recorder.end({"kind": "end"})
        assert (tmp_path / "v/clean/k/1/end.json").is_file()
        return
    with pytest.raises(UnsafePathError, match="must be a folder, got a symbolic link"):
        recorder.episode(TOLD)
        recorder.end({"kind": "end"})
    recorder.leave()
    assert remaining.read_text() == "mine" and len(list((tmp_path / "v").rglob("*.*"))) == 1


@pytest.mark.parametrize("plant", [lambda path: path.symlink_to("../../v"), os.mkfifo])
def test_run_rejects_link_or_fifo_in_recording(run, tmp_path, plant):
    remaining = tmp_path / "v" / "0" / "keep.txt"
    remaining.parent.mkdir(parents=True)
    remaining.write_text("mine")
    scene = tmp_path / "r" / "clean" / "s0"
    scene.parent.mkdir(parents=True)
    plant(scene)
    options = f"conditions=[clean] record={tmp_path / 'r'}"
    assert "s0 must be a folder, got a " in run(tmp_path / "out", options).stderr
    assert remaining.read_text() == "mine" and len(list((tmp_path / "v").rglob("*"))) == 2


@pytest.mark.parametrize("kind", ["unfinished", "finished"])
def test_put_aside_rejects_a_fifo(tmp_path, kind):
    (tmp_path / "clean").mkdir()
    (tmp_path / "clean" / "output.txt").write_text("")
    os.mkfifo(tmp_path / f"clean.{kind}")
    with pytest.raises(UnsafePathError, match=f"clean.{kind} must be a folder, got a FIFO"):
        put_aside(tmp_path / "clean", kind)
    assert (tmp_path / "clean" / "output.txt").is_file()


def test_recorder_leaves_a_folder_with_a_predictable_temporary_name(tmp_path):
    """Issue T2, item 10."""
    planted = tmp_path / "k" / f".1.{os.getpid()}.tmp"
    planted.mkdir(parents=True)
    recorder = Recorder(tmp_path)
    recorder.episode(TOLD)
    recorder.end({"kind": "end"})
    assert planted.is_dir() and (tmp_path / "k/1/end.json").is_file()
