"""Tests with inputs from public bug reports, such as long names and control characters."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import gymnasium
import numpy as np
import pytest
import torch
from gymnasium import spaces
from safetensors.torch import save_file
from tensordict import TensorDict
from torch import nn

from mitigate.agents import loading
from mitigate.core.files import write_text
from mitigate.core.json_files import read_json
from mitigate.core.names import escaped
from mitigate.corruptions import Corruption, Schedule, folders, frame_files
from mitigate.corruptions.folders import Settings
from mitigate.corruptions.language.text import is_english
from mitigate.encoders.loading import load_weights
from mitigate.worlds.episodes import read_extras
from mitigate.worlds.recorded import open_recording
from mitigate.worlds.recorded.topics import Topics, choose_topics
from mitigate.worlds.transforms import CorruptObservation
from mitigate.worlds.wrappers import CorruptObservation as Wrapper

POINTER = f"version https://git-lfs.github.com/spec/v1\noid sha256:{'0' * 64}\nsize 5000000\n"
WALL = np.linspace(1.5, 3.5, 64)[None].repeat(48, 0)  # metres
MM = np.rint(WALL * 1000).astype(np.uint32)


def png(path: Path, pixels: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), pixels)


@pytest.mark.parametrize(
    ("counts", "part"),
    [
        (np.rint(WALL * 5000).astype(np.uint16), "unit=0.0002"),
        ((((MM << 3) | (MM >> 13)) & 0xFFFF).astype(np.uint16), "SUN RGB-D"),
    ],
)
def test_corrupt_rejects_a_guessed_unit_that_does_not_fit(tmp_path, counts, part):
    """Issue T2, item 12."""
    png(tmp_path / "in/0.png", counts)
    with pytest.raises(ValueError, match=part):
        folders.run(tmp_path / "in", tmp_path / "out", Settings("quantization", 0.3))
    assert not (tmp_path / "out").exists()
    settings = Settings("quantization", 0.3, unit=0.0002)
    assert folders.run(tmp_path / "in", tmp_path / "out", settings)["written"] == 1


def test_corrupt_keeps_65535_as_no_reading(tmp_path):
    """Issue T2, item 12."""
    counts = np.full((96, 128), 2000, np.uint16)
    counts[40:60, 50:80] = 65535
    png(tmp_path / "in/0.png", counts)
    folders.run(tmp_path / "in", tmp_path / "out", Settings("quantization", 0.3))
    out = cv2.imread(str(tmp_path / "out/0.png"), cv2.IMREAD_UNCHANGED)
    assert (out[40:60, 50:80] == 65535).all() and (np.delete(out, range(40, 60), 0) < 3000).all()
    assert (frame_files.read(tmp_path / "in/0.png", 0.001)[40:60, 50:80] == 0).all()


def test_corrupt_rejects_normalised_npy(tmp_path):
    """Issue T2, item 12."""
    (tmp_path / "in").mkdir()
    np.save(tmp_path / "in/0.npy", (WALL / 10).astype(np.float32))
    with pytest.raises(ValueError, match="unit=m"):
        folders.run(tmp_path / "in", tmp_path / "out", Settings("missing_data", 0.6))
    settings = Settings("missing_data", 0.6, unit=1.0)
    assert folders.run(tmp_path / "in", tmp_path / "out", settings)["written"] == 1


@pytest.mark.parametrize("rgb_first", [True, False])
def test_open_recording_reads_associations(tmp_path, rgb_first):
    """Issue T2, item 12."""
    lines = []
    for i in range(3):
        png(tmp_path / f"drive/rgb/{i}.png", np.full((48, 64, 3), 60, np.uint8))
        png(tmp_path / f"drive/depth/{i}.png", np.full((48, 64), 12000, np.uint16))
        words = [f"{i} rgb/{i}.png", f"{i} depth/{i}.png"]
        lines.append(" ".join(words if rgb_first else words[::-1]))
    (tmp_path / "drive/associations.txt").write_text("\n".join(lines))
    (source,) = open_recording(tmp_path / "drive")
    depth = next(source.frames([0]))["depth"]
    assert np.allclose(depth, 2.4)
    (tmp_path / "drive/associations.txt").unlink()
    with pytest.raises(ValueError, match="unit=0.0002"):
        open_recording(tmp_path / "drive")


def test_choose_topics_leaves_goals_out(tmp_path):
    """Issue T2, item 12."""
    pose, image = "geometry_msgs/msg/PoseStamped", "sensor_msgs/msg/Image"
    available = {"/camera/image_raw": image, "/goal_pose": pose}
    with pytest.warns(UserWarning, match="topics.pose=/goal_pose"):
        assert "pose" not in choose_topics(tmp_path, available, Topics())
    named = choose_topics(tmp_path, available, Topics(pose="/goal_pose"))
    assert named["pose"] == "/goal_pose"
    available = {"/camera/image_raw": image, "/place": pose}
    with pytest.warns(UserWarning, match="topics.pose=/place"):
        choose_topics(tmp_path, available, Topics(), {"/camera/image_raw": 6, "/place": 1})


def test_bag_with_an_unreadable_definition_is_read(tmp_path):
    """Issue T2, item 12."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    with Writer(tmp_path / "drive", version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        kind = "sensor_msgs/msg/Image"
        images = bag.add_connection("/camera/image_raw", kind, typestore=store)
        for i in range(3):
            stamp = types["builtin_interfaces/msg/Time"](sec=1000 + i, nanosec=0)
            head = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera")
            data = np.full(48 * 64 * 3, 90, np.uint8)
            message = types[kind](head, 48, 64, "rgb8", 0, 64 * 3, data)
            bag.write(images, (1000 + i) * 10**9, store.serialize_cdr(message, kind))
        text = "=" * 80 + "\nSRV: our_msgs/srv/Count\nint64 first\n---\nint64 total\n"
        event = bag.add_connection(
            "/count/_service_event",
            "our_msgs/srv/Count_Event",
            msgdef=text,
            rihs01="RIHS01_" + "0" * 64,
        )
        bag.write(event, 1001 * 10**9, b"\0\1\0\0" + bytes(32))
    (source,) = open_recording(tmp_path / "drive", hfov=69.0)
    assert len(source.times) == 3 and len(list(source.frames([0, 1, 2]))) == 3


def test_transform_leaves_next_without_frames_alone():
    """Issue T2, item 12."""
    steps = torch.arange(6)[:, None]
    data = TensorDict(
        {
            "rgb": torch.full((6, 32, 32, 3), 120, dtype=torch.uint8),
            "episode": steps // 3,
            "frame": steps % 3,
            "next": {"reward": torch.zeros(6, 1)},
        },
        [6],
    )
    out = CorruptObservation(Corruption("low_light", 0.6))(data)
    assert out["rgb"].float().mean() < 100 and list(out["next"].keys()) == ["reward"]


class Camera(gymnasium.Env):
    observation_space = spaces.Box(0, 255, (32, 32, 3), np.uint8)
    action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        return np.full((32, 32, 3), 120, np.uint8), {}


def test_wrapper_is_made_again_from_its_spec():
    """Issue T2, item 12."""
    gymnasium.register("Field-v0", entry_point=Camera)
    env = Wrapper(gymnasium.make("Field-v0"), Schedule.always("spatter", 0.6), seed=3)
    again = gymnasium.make(env.spec)
    assert isinstance(again, Wrapper) and again.seed == 3
    assert np.array_equal(env.reset(seed=0)[0], again.reset(seed=0)[0])


@pytest.mark.parametrize("kind", ["numpy", "array", "rng", "two"])
def test_load_weights_reads_checkpoints_with_other_data(tmp_path, kind):
    """Issue T2, item 12."""
    net = nn.Sequential(nn.Conv2d(3, 4, 3))
    state = net.state_dict()
    contents = {
        "numpy": {"state_dict": state, "best": np.float64(0.3)},
        "array": {"state_dict": state, "scores": np.arange(3.0)},
        "rng": {"model": state, "rng_state": torch.get_rng_state()},
        "two": {"student": state, "teacher": {f"backbone.{k}": v for k, v in state.items()}},
    }
    torch.save(contents[kind], tmp_path / "net.pth")
    prefix = "teacher.backbone." if kind == "two" else ""
    loaded = nn.Sequential(nn.Conv2d(3, 4, 3))
    load_weights(loaded, str(tmp_path / "net.pth"), prefix)
    assert torch.equal(loaded[0].weight, net[0].weight)


def test_readers_name_a_git_lfs_pointer(tmp_path):
    """Issue T2, item 12."""
    for name in ("net.pth", "net.safetensors", "drive.bag", "a.json", "in/0.png"):
        write_text(tmp_path / name, POINTER)
    for name in ("net.pth", "net.safetensors"):
        with pytest.raises(ValueError, match="Git LFS pointer"):
            load_weights(nn.Conv2d(3, 4, 3), str(tmp_path / name))
    with pytest.raises(ValueError, match="Git LFS pointer"):
        open_recording(tmp_path / "drive.bag")
    with pytest.raises(ValueError, match="Git LFS pointer"):
        read_json(tmp_path / "a.json", "")
    with pytest.raises(ValueError, match="Git LFS pointer"):
        read_extras(tmp_path / "a.json")
    with pytest.raises(frame_files.LeftOutError, match="Git LFS pointer"):
        frame_files.modality(tmp_path / "in/0.png")


def test_read_extras_names_a_list_of_the_r2r_task(tmp_path):
    """Issue T2, item 12."""
    write_text(tmp_path / "r2r.json", json.dumps([{"path_id": 1, "scan": "x", "path": ["a"]}]))
    with pytest.raises(ValueError, match="a list of the discrete R2R task"):
        read_extras(tmp_path / "r2r.json")


def test_is_english_checks_the_script_of_unmarked_text():
    """Issue T2, item 12."""
    assert is_english(None, "Walk past the sofa.") and is_english("en", "经过沙发")
    assert not is_english(None, "经过沙发，在门口停下。") and not is_english("", "दरवाजे पर रुकें")


def test_load_rejects_settings_larger_than_the_weights(tmp_path, monkeypatch):
    """Issue T2, item 8."""
    monkeypatch.setattr(loading, "FREE_WEIGHTS", 1000)
    shipped = Path(__file__).parents[2] / "checkpoints/recurrent/base/config.yaml"
    write_text(tmp_path / "config.yaml", shipped.read_text())
    save_file({"x": torch.zeros(3)}, tmp_path / "model.safetensors")
    with pytest.raises(ValueError, match="require .* weights, but .* has .* bytes"):
        loading.load(tmp_path)


def test_corrupt_writes_a_frame_with_a_long_name(tmp_path):
    """Issue T2, item 10."""
    for name in ("a" * 246 + ".png", "b.png"):
        png(tmp_path / "b.png", np.full((24, 32, 3), 90, np.uint8))
        (tmp_path / "in").mkdir(exist_ok=True)
        shutil.copy(tmp_path / "b.png", tmp_path / "in" / name)
    summary = folders.run(tmp_path / "in", tmp_path / "out", Settings("spatter", 0.5))
    assert summary["written"] == 2 and not summary["left_out"]
    write_text(tmp_path / ("ü" * 120), "long")


def test_escaped_is_printable_and_short():
    """Issue T2, item 11."""
    text = escaped("\x1b[31mred\n" + "x" * 10**6)
    assert text.isprintable() and len(text) == 200 and text.startswith("\\x1b[31mred")
    assert escaped("Küche") == "Küche"


@pytest.mark.parametrize("name", ["/\x1b[2Jimage", "/" + "x" * 5000])
def test_bag_with_an_unprintable_topic_is_read_without_it(tmp_path, name):
    """Issue T2, item 11."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(tmp_path / "drive", version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        bag.add_connection(name, "sensor_msgs/msg/Image", typestore=store)
    with pytest.raises(ValueError, match="has no topic with images") as error:
        open_recording(tmp_path / "drive", hfov=69.0)
    assert str(error.value).isprintable() and len(str(error.value)) < 1000
