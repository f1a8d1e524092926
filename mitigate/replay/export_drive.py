"""Record an oracle's episodes as drives (recordings), as examples for ``mitigate replay``:
``mitigate export_drive OUT``.

OUT is a folder. Each episode is written to this folder as one drive, as a robot with a 90-degree
RGB-D camera would record it. A drive is a folder of frames, a ROS 1 bag, or a ROS 2 bag (MCAP).
With form=lerobot, OUT becomes one LeRobot dataset that contains all episodes.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from omegaconf import MISSING, DictConfig

from mitigate.core import conf
from mitigate.core.files import atomic_text, make_folder, write_bytes
from mitigate.core.locks import delete_abandoned
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.core.options import paths_and_overrides
from mitigate.core.output import output_folder
from mitigate.corruptions.frame_files import counts

FORMS = ("frames", "bag", "mcap", "lerobot")
_NOT_IN_NAMES = re.compile(r"[^\w-]+")  # these characters are replaced in the name of a drive
UNIT = 0.001  # metres per unit of a 16-bit depth value
SECOND = 1_000_000_000  # duration of a step in nanoseconds (one second)
TOPICS = {
    RGB: "/camera/color/image_raw",
    DEPTH: "/camera/aligned_depth_to_color/image_raw",
    "info": "/camera/color/camera_info",
    POSE: "/odom",
}


@dataclass
class ExportDriveConfig:
    """Types of the options in ``conf/export_drive.yaml``, which documents each of them."""

    split: str = "val_unseen"
    episodes: int = 3
    form: str = "frames"
    runs: str = "runs"
    env: Any = MISSING


conf.register("export_drive", ExportDriveConfig)


def run(config: ExportDriveConfig, out: Path) -> list[Path]:
    """Write the recorded drives into ``out`` and return their paths.

    A drive is written completely or not at all.

    Raises:
        ValueError: If the form or split is unknown, the world has more than one camera or no
            expert, or a drive already exists. A missing expert is detected only in the first
            episode; all other checks run earlier.
    """
    from mitigate.core import build
    from mitigate.core.progress import Progress
    from mitigate.evaluation.config import EnvConfig, open_entries
    from mitigate.evaluation.episode_lists import episodes

    if config.form not in FORMS:
        raise ValueError(unknown("form", config.form, FORMS))
    env = open_entries(EnvConfig, config.env)
    world = build.Maker(env.world)()
    if len(world.sensors[RGB].shape) != 3:
        raise ValueError("A drive has one camera. Set env.views=1.")
    listed = episodes(env, config.split, config.episodes)
    if config.form == "lerobot":
        from mitigate.replay.export_dataset import check_empty, write_dataset

        check_empty(out)
        with output_folder(out), Progress("export_drive", len(listed), unit="episode") as progress:
            recorded = []
            for episode in listed:
                recorded.append((*oracle(world, episode), episode.instruction.text))
                progress.advance(note=episode.episode_id)
            write_dataset(out, recorded)
        return [out]
    paths = _drive_paths(out, [episode.episode_id for episode in listed], config.form)
    progress = Progress("export_drive", len(listed), unit="drive")
    delete_abandoned(out.glob(".drive.*.tmp"))
    with output_folder(out) as root, progress:
        for episode, path in zip(listed, paths, strict=True):
            steps, _ = oracle(world, episode)
            instruction = episode.instruction.text
            root.check()
            with tempfile.TemporaryDirectory(f".{os.getpid()}.tmp", ".drive.", out) as temporary:
                draft = Path(temporary) / path.stem
                if config.form == "frames":
                    write_frames(draft, steps, instruction)
                else:
                    draft = write_bag(draft, steps, config.form)
                    # the instruction is written first, so that every complete bag has one
                    write_bytes(path.with_suffix(".txt"), instruction.encode())
                draft.rename(path)
            root.expected.append(path)
            progress.advance(note=path.name)
    return paths


def _drive_paths(out: Path, names: Sequence[str], form: str) -> list[Path]:
    """Return the output path of each episode, which is named after the episode id."""
    suffix = ".bag" if form == "bag" else ""
    safe_names = [_NOT_IN_NAMES.sub("-", name).strip("-") or "unnamed" for name in names]
    paths = [out / f"{name}{suffix}" for name in safe_names]
    for index, path in enumerate(paths):
        if path.exists():
            raise ValueError(f"{path} already exists. Name another folder, or delete it.")
        if path in paths[:index]:
            raise ValueError(
                f"Episodes {names[paths.index(path)]!r} and {names[index]!r} have the same path "
                f"{path}. Give them ids that differ in letters or digits."
            )
    return paths


def oracle(world: Any, episode: Any) -> tuple[list[dict[str, np.ndarray]], list[int]]:
    """Return the observation and the action of each step of the expert, including STOP."""
    from mitigate.worlds.world import expert_of

    observation = world.reset(episode)
    steps, actions = [], []
    while not world.done:
        steps.append({name: np.asarray(observation[name]).copy() for name in (RGB, DEPTH, POSE)})
        actions.append(int(expert_of(world).action()))
        observation = world.step(actions[-1])
    return steps, actions


def write_frames(path: Path, steps: Sequence[dict[str, np.ndarray]], instruction: str) -> None:
    """Write a recorded drive as a folder of frames.

    The folder contains ``rgb/``, ``depth/``, ``poses.csv`` and ``instruction.txt``.
    """
    for number, step in enumerate(steps):
        write_bytes(path / RGB / f"{number:06d}.png", _png(step[RGB][..., ::-1]))
        write_bytes(path / DEPTH / f"{number:06d}.png", _png(counts(step[DEPTH][..., 0], UNIT)))
    write_bytes(path / "instruction.txt", instruction.encode())
    with atomic_text(path / "poses.csv") as file:
        file.write("x,y,heading\n")
        file.writelines(",".join(f"{float(v):.6f}" for v in step[POSE]) + "\n" for step in steps)


def _png(picture: np.ndarray) -> bytes:
    success, encoded = cv2.imencode(".png", picture)
    assert success
    return encoded.tobytes()


def write_bag(path: Path, steps: Sequence[dict[str, np.ndarray]], form: str) -> Path:
    """Write a recorded drive as a bag and return its path.

    Each step lasts one second. Odometry uses the axes of REP 103.
    """
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_typestore

    path = path.with_suffix(".bag") if form == "bag" else path
    make_folder(path.parent)
    ros1 = form == "bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    writer = Writer1(path) if ros1 else Writer2(path, version=9, storage_plugin=StoragePlugin.MCAP)
    serialize = store.serialize_ros1 if ros1 else store.serialize_cdr
    with writer:
        connections = {}
        for number, step in enumerate(steps):
            for name, message in messages(store, step, number, ros1):
                kind = message.__msgtype__
                if name not in connections:
                    connections[name] = writer.add_connection(TOPICS[name], kind, typestore=store)
                writer.write(connections[name], number * SECOND, serialize(message, kind))
    return path


def messages(
    store: Any, step: dict[str, np.ndarray], number: int, ros1: bool
) -> Iterator[tuple[str, Any]]:
    """Yield the ROS messages of a step: odometry, CameraInfo, RGB and depth."""
    types = store.types
    time = types["builtin_interfaces/msg/Time"](sec=number, nanosec=0)
    extra = {"seq": number} if ros1 else {}
    header = types["std_msgs/msg/Header"](stamp=time, frame_id="camera", **extra)
    yield POSE, _odometry(types, header, step[POSE])
    height, width = step[RGB].shape[:2]
    k = np.array([width / 2, 0, width / 2, 0, width / 2, height / 2, 0, 0, 1.0])
    roi = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    matrices = (np.zeros(5), k, np.eye(3).ravel(), np.zeros(12))
    info = types["sensor_msgs/msg/CameraInfo"]
    yield "info", info(header, height, width, "plumb_bob", *matrices, 0, 0, roi)
    image = types["sensor_msgs/msg/Image"]
    yield RGB, image(header, height, width, "rgb8", 0, width * 3, step[RGB].ravel())
    depth = counts(step[DEPTH], UNIT).ravel().view(np.uint8)
    yield DEPTH, image(header, height, width, "16UC1", 0, width * 2, depth)


def _odometry(types: Any, header: Any, pose: np.ndarray) -> Any:
    """Return the odometry message of a pose on the floor plan."""

    def make(name: str, *fields: Any) -> Any:
        return types[f"geometry_msgs/msg/{name}"](*fields)

    x, y, heading = map(float, pose)
    half = (heading + np.pi / 2) / 2  # the yaw in ROS is the heading plus 90 degrees
    orientation = make("Quaternion", 0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
    place = make("Pose", make("Point", x, y, 0.0), orientation)
    still = make("Vector3", 0.0, 0.0, 0.0)
    twist = make("TwistWithCovariance", make("Twist", still, still), np.zeros(36))
    place = make("PoseWithCovariance", place, np.zeros(36))
    return types["nav_msgs/msg/Odometry"](header, "base_link", place, twist)


def main() -> None:
    """Run from the command line."""
    if len(sys.argv) == 1:
        print(conf.help_text(__doc__ or "", "export_drive"))
        sys.exit(2)
    paths, sys.argv[1:] = paths_and_overrides(sys.argv[1:])

    def program(cfg: DictConfig) -> None:
        if len(paths) != 1:
            raise ValueError(f"export_drive needs one folder, OUT, got {len(paths)}. See --help.")
        drives = run(conf.typed(cfg, "export_drive"), Path(paths[0]))
        print("\n".join(f"wrote {drive}" for drive in drives))

    again = "To run it again, after deleting what it wrote"
    hydra_main = conf.hydra_program("export_drive", program)
    conf.main(hydra_main, "export_drive", behind=paths, again=again)
