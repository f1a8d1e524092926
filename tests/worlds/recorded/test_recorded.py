"""Tests of reading recorded drives: folders and bags, the choice of steps, and square views."""

from __future__ import annotations

import json
import math
import struct
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from shutil import copytree

import cv2
import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from mitigate.core.observation import DEPTH, FORWARD, LEFT, POSE, RGB, RIGHT, STOP
from mitigate.replay.export_drive import TOPICS, messages, write_bag, write_frames
from mitigate.worlds.recorded import RecordedWorld, Step, load, open_recording
from mitigate.worlds.recorded.messages import read_stamp
from mitigate.worlds.recorded.recording import NO_ACTION, driver_actions
from mitigate.worlds.recorded.source import Lens, interpolate_poses
from mitigate.worlds.recorded.topics import IMAGES, INFO, Topics, choose_topics
from mitigate.worlds.recorded.views import square_view

SIZE = 32


def steps(poses: list[tuple[float, float, float]]) -> list[dict[str, np.ndarray]]:
    """Return one step per pose, each with different random frames."""
    rng = np.random.default_rng(0)
    return [
        {
            RGB: rng.integers(0, 255, (SIZE, SIZE, 3), np.uint8),
            DEPTH: (rng.integers(0, 8000, (SIZE, SIZE, 1)) / 1000).astype(np.float32),
            POSE: np.array(pose, np.float32),
        }
        for pose in poses
    ]


def path_poses() -> list[tuple[float, float, float]]:
    """Return the poses of two steps, a turn to the left, one step, and a turn to the right."""
    turn = math.radians(15)
    ahead = 0.25 * np.array([-math.sin(turn), math.cos(turn)])
    there = (ahead[0], 0.5 + ahead[1])
    return [(0, 0, 0), (0, 0.25, 0), (0, 0.5, 0), (0, 0.5, turn), (*there, turn), (*there, 0)]


def read(path: Path, **options):
    (source,) = open_recording(path, **options)
    return load(source, views=1, size=SIZE, step=Step())


@pytest.fixture
def folder(tmp_path):
    write_frames(tmp_path / "drive", steps(path_poses()), "walk to the door")
    return tmp_path / "drive"


def test_load_reads_a_folder(folder):
    recording = read(folder)
    expected = steps(path_poses())
    assert recording.instruction == "walk to the door"
    assert np.array_equal(recording.frames[RGB], np.stack([s[RGB] for s in expected]))
    assert np.allclose(recording.frames[DEPTH], np.stack([s[DEPTH] for s in expected]), atol=6e-4)
    assert np.allclose(recording.poses, np.stack([s[POSE] for s in expected]), atol=1e-5)
    assert recording.driven.actions.tolist() == [FORWARD, FORWARD, LEFT, FORWARD, RIGHT, STOP]


def test_load_ignores_a_byte_order_mark(folder):
    for name in ("instruction.txt", "poses.csv"):
        file = folder / name
        file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    recording = read(folder)
    assert recording.instruction == "walk to the door" and len(recording.poses) == len(path_poses())


@pytest.mark.parametrize("form", ["bag", "mcap"])
def test_load_reads_a_bag_like_a_folder(folder, tmp_path, form):
    bag = write_bag(tmp_path / "robot", steps(path_poses()), form)
    (tmp_path / "robot.txt").write_text("walk to the door\n")
    first, second = read(folder), read(bag)
    assert second.instruction == "walk to the door"
    for name in (RGB, DEPTH):
        assert np.array_equal(first.frames[name], second.frames[name]), name
    assert np.allclose(first.poses, second.poses, atol=1e-5)
    assert first.driven.actions.tolist() == second.driven.actions.tolist()


def bag_of(path: Path, headers: Sequence[int]) -> Path:
    """Write a ROS 1 bag with one step per header time; the receipt times start at 1000 s."""
    store = get_typestore(Stores.ROS1_NOETIC)
    connections = {}
    with Writer(path) as writer:
        for number, (step, stamped) in enumerate(zip(steps(path_poses()), headers, strict=True)):
            for name, message in messages(store, step, stamped, True):
                kind = message.__msgtype__
                if name not in connections:
                    connections[name] = writer.add_connection(TOPICS[name], kind, typestore=store)
                raw = store.serialize_ros1(message, kind)
                writer.write(connections[name], (1000 + number) * 10**9, raw)
    return path


@pytest.mark.parametrize("headers", [range(6), [0] * 6])
def test_bag_uses_header_times_if_any_is_set(tmp_path, headers):
    (drive,) = open_recording(bag_of(tmp_path / "robot.bag", headers))
    assert drive.times.tolist() == [(1000 if not any(headers) else 0) + n for n in range(6)]
    assert np.allclose(drive.poses, path_poses(), atol=1e-6)


def test_bag_reads_the_instruction_of_its_full_name(tmp_path):
    bag = write_bag(tmp_path / "drive.2", steps(path_poses()), "mcap")
    (tmp_path / "drive.txt").write_text("of another drive")
    assert (open_recording(bag)[0].name, read(bag).instruction) == ("drive.2", "")
    (tmp_path / "drive.2.txt").write_text("walk to the door")
    assert read(bag).instruction == "walk to the door"


def test_bag_rejects_hfov_next_to_camera_info(tmp_path):
    bag = write_bag(tmp_path / "robot", steps(path_poses()), "mcap")
    with pytest.raises(ValueError, match=r"contains the field of view of its cameras. Remove hfov"):
        open_recording(bag, hfov=60.0)
    (drive,) = open_recording(bag, hfov=60.0, topics={"info": "none"})
    assert drive.cameras[RGB].hfov == 60.0 and drive.cameras[DEPTH].focal is not None


def test_bag_suggests_topics_for_a_wrong_name(tmp_path):
    bag = write_bag(tmp_path / "robot", steps(path_poses()), "bag")
    with pytest.raises(ValueError, match="/camera/color/image_raw"):
        open_recording(bag, topics={"rgb": "/camera/colour/image_raw"})
    (source,) = open_recording(bag, topics={"rgb": "/camera/color/image_raw"})
    assert set(source.cameras) == {RGB, DEPTH}


@pytest.mark.parametrize("form", ["bag", "mcap"])
def test_bag_names_a_damaged_file(tmp_path, form):
    bag = write_bag(tmp_path / "robot", steps(path_poses()), form)
    file = bag if form == "bag" else next(bag.glob("*.mcap"))
    whole = file.read_bytes()
    rng = np.random.default_rng(0)
    for cut in (0, 10, len(whole) // 3, len(whole) - 40):
        file.write_bytes(whole[:cut])
        with pytest.raises(ValueError, match="robot"):
            read(bag)
    # a bag with flipped bytes may still be readable; if not, the error must name it
    for _ in range(10):
        damaged = bytearray(whole)
        for at in rng.integers(0, len(whole), 30):
            damaged[at] ^= 0xFF
        file.write_bytes(bytes(damaged))
        try:
            read(bag)
        except ValueError as error:
            assert "robot" in str(error)


def tum(folder: Path, frames: list[dict[str, np.ndarray]], hertz: float = 10.0) -> Path:
    """Write these frames as a drive in the layout of TUM RGB-D, with ``hertz`` frames per
    second."""
    lists = {RGB: [], DEPTH: []}
    poses = []
    for number, step in enumerate(frames):
        time = 100 + number / hertz
        for kind in (RGB, DEPTH):
            (folder / kind).mkdir(parents=True, exist_ok=True)
            picture = step[RGB][..., ::-1] if kind == RGB else np.rint(step[DEPTH][..., 0] * 5000)
            picture = picture if kind == RGB else picture.astype(np.uint16)
            cv2.imwrite(str(folder / kind / f"{time:.4f}.png"), picture)
            lists[kind].append(f"{time + (kind == DEPTH) * 0.01:.4f} {kind}/{time:.4f}.png")
        x, y, heading = step[POSE]
        # in camera coordinates, z (the optical axis) points forward, x to the right and y down
        ahead = np.array([-math.sin(heading), math.cos(heading), 0])
        right = np.array([math.cos(heading), math.sin(heading), 0])
        turned = np.stack([right, [0, 0, -1], ahead], 1)
        w = math.sqrt(max(0, 1 + np.trace(turned))) / 2
        q = [turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]]
        qx, qy, qz = (value / (4 * w) for value in q)
        poses.append(f"{time:.4f} {x} {y} 1.2 {qx} {qy} {qz} {w}")
    for kind, lines in lists.items():
        (folder / f"{kind}.txt").write_text("# time file\n" + "\n".join(lines))
    (folder / "groundtruth.txt").write_text("# time pose\n" + "\n".join(poses))
    return folder


def test_load_keeps_frames_one_step_apart(tmp_path):
    slow = [(0.0, 0.025 * i, 0.0) for i in range(41)]  # the robot drives one metre in 41 frames
    recording = read(tum(tmp_path / "lab", steps(slow)), hfov=90.0)
    assert len(recording.times) == 5
    assert np.allclose(np.diff(recording.poses[:, 1]), 0.25, atol=0.01)
    assert np.allclose(recording.poses[:, 2], 0, atol=1e-6)


def turn_poses(folder: Path, quaternion: str, numbers: Sequence[int]) -> None:
    """Replace the rotation of some poses in a TUM folder."""
    lines = (folder / "groundtruth.txt").read_text().splitlines()
    for n in numbers:  # line 0 is a comment
        lines[1 + n] = " ".join([*lines[1 + n].split()[:4], quaternion])
    (folder / "groundtruth.txt").write_text("\n".join(lines))


def test_tum_folder_rejects_poses_of_a_robot_frame(tmp_path):
    folder = tum(tmp_path / "lab", steps([(0.0, 0.25 * i, 0.0) for i in range(8)]))
    # a rotation about the vertical axis in a robot frame, whose x axis points forward
    turn_poses(folder, "0 0 0.38 0.92", range(8))
    with pytest.raises(ValueError, match=r"8 of 8 poses face up or down.*z ahead"):
        read(folder)


def test_tum_folder_interpolates_headings_of_vertical_poses(tmp_path):
    folder = tum(tmp_path / "lab", steps([(0.0, 0.25 * i, 0.1) for i in range(8)]))
    turn_poses(folder, "1 0 0 0", [3, 4])
    (drive,) = open_recording(folder)
    assert np.allclose(drive.poses[:, 2], 0.1, atol=1e-6) and drive.dropped == 0


def test_tum_folder_rejects_a_file_outside(tmp_path):
    folder = tum(tmp_path / "lab", steps(path_poses()))
    (folder / "rgb.txt").write_text("100.0 ../../secret.png\n")
    with pytest.raises(ValueError, match="outside"):
        read(folder)


@pytest.fixture
def recorded(tmp_path):
    """Write a folder with one episode, as ``mitigate run record=`` does."""
    write_frames(tmp_path / "x", steps(path_poses()), "")
    episode = tmp_path / "recorded" / "kitchen" / "17"
    episode.mkdir(parents=True)
    (tmp_path / "x" / "rgb").rename(episode / "rgb")
    (tmp_path / "x" / "depth").rename(episode / "depth")
    (tmp_path / "recorded" / "recording.json").write_text(json.dumps({"unit": 0.001}))
    (episode / "episode.json").write_text(json.dumps({"text": "go to the sink"}))
    cameras = {kind: {"kind": kind, "hfov": 90.0, "yaw": 0.0} for kind in (RGB, DEPTH)}
    (episode / "cameras.json").write_text(json.dumps(cameras))
    lines = [
        {"call": i, "position": [float(p[0]), 0.1, -float(p[1])], "heading": float(p[2])}
        for i, p in enumerate(path_poses())
    ]
    (episode / "steps.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    # a temporary folder that a killed run has left behind
    copytree(episode, episode.with_name(".18.4711.tmp"))
    return tmp_path / "recorded"


def change_steps(recorded: Path, change: Callable[[int, dict], object]) -> None:
    """Change each line of an episode file: call ``change`` with the line's number and content, and
    write the result."""
    file = recorded / "kitchen" / "17" / "steps.jsonl"
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    for number, line in enumerate(lines):
        change(number, line)
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))


def test_open_recording_rejects_headings_in_degrees(recorded):
    change_steps(recorded, lambda n, line: line.update(heading=15.0 * n))
    with pytest.raises(ValueError, match=r"steps\.jsonl: headings must be in radians, got 75"):
        read(recorded)


def test_open_recording_warns_about_missing_poses(recorded):
    change_steps(recorded, lambda n, line: n == 2 and line.pop("heading"))
    with pytest.warns(UserWarning, match=r"lacks the pose of 1 of 6 steps.*without poses"):
        assert read(recorded).poses is None


@pytest.mark.parametrize(
    ("file", "content", "part"),
    [
        ("cameras.json", b'{"rgb": {"kind": "thermal"}}', "camera rgb must be rgb or depth"),
        ("cameras.json", b'{"rgb": 90}', "kind of camera rgb must be rgb or depth, got 90"),
        ("episode.json", b'{"text": ["go"]}', "the instruction must be a string"),
    ],
)
def test_open_recording_rejects_odd_notes_of_an_episode(recorded, file, content, part):
    (recorded / "kitchen" / "17" / file).write_bytes(content)
    with pytest.raises(ValueError, match=part):
        read(recorded)


@pytest.mark.parametrize("kind", [RGB, DEPTH])
def test_open_recording_rejects_a_missing_frame(recorded, kind):
    (recorded / "kitchen" / "17" / kind / "000002.png").unlink()
    with pytest.raises(ValueError, match=rf"{kind} is incomplete: it has no frame 000002"):
        read(recorded)


def test_open_recording_accepts_a_missing_last_frame(recorded):
    (recorded / "kitchen" / "17" / DEPTH / "000005.png").unlink()
    assert len(read(recorded).times) == 5


def test_open_recording_rejects_other_encodings(folder):
    (folder / "instruction.txt").write_bytes("Gehe zur Küche.".encode("utf-16"))
    with pytest.raises(ValueError, match="must be UTF-8 text"):
        read(folder)


def test_load_warns_about_headings_off_the_path(folder):
    way = [(0.0, 0.25 * n, 0.0) for n in range(6)]
    # yaw is measured from +x, as in ROS
    for heading, strange in ((0.0, False), (math.pi / 2, True)):
        rows = "".join(f"{x},{y},{heading}\n" for x, y, _ in way)
        (folder / "poses.csv").write_text(rows)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            read(folder)
        assert [("5 of 5 steps that move" in str(w.message)) for w in caught] == [True] * strange


def test_load_reads_a_recording_of_mitigate_run(recorded):
    recording = read(recorded)
    assert (recording.name, recording.instruction) == ("kitchen/17", "go to the sink")
    assert np.allclose(recording.poses, np.array(path_poses()), atol=1e-6)


def test_square_view_keeps_a_matching_frame():
    frame = steps(path_poses())[0][RGB]
    assert np.array_equal(square_view(frame, Lens(RGB), SIZE), frame)


def test_square_view_pads_a_narrow_camera_with_black():
    frame = np.full((48, 64, 3), 200, np.uint8)
    # the camera is half as wide as the square view
    lens = Lens(RGB, hfov=math.degrees(2 * math.atan(0.5)))
    view = square_view(frame, lens, 64)[..., 0]
    assert (view[:, :15] == 0).all() and (view[:, 49:] == 0).all()
    assert (view[22:42, 18:46] == 200).all()
    assert abs((view > 0).mean() - 0.5 * 0.375) < 0.03


def test_square_view_crops_a_wide_camera():
    columns = np.arange(200)
    frame = np.repeat(np.repeat(columns[None, :, None], 100, 0), 3, 2).astype(np.uint8)
    lens = Lens(RGB, hfov=math.degrees(2 * math.atan(2.0)))  # twice as wide
    view = square_view(frame, lens, 50)[25, :, 0].astype(int)
    assert abs(view[0] - 50) <= 1 and abs(view[-1] - 149) <= 1


def test_square_view_keeps_missing_depth():
    frame = np.full((64, 64), 3.0, np.float32)
    frame[::2, ::2] = 0.0
    view = square_view(frame, Lens(DEPTH), 32)
    assert set(np.unique(view)) <= {0.0, 3.0}


def test_load_rejects_an_incomplete_panorama(folder):
    (source,) = open_recording(folder)
    with pytest.raises(ValueError, match="1 rgb cameras of the 12"):
        load(source, views=12, size=SIZE, step=Step())


def test_recorded_world_ignores_actions(folder):
    world = RecordedWorld(read(folder))
    observation = world.reset(world.episode())
    view = []
    while not world.done:
        view.append(observation[RGB])
        observation = world.step(STOP)
    assert np.array_equal(np.stack(view), world.recording.frames[RGB])
    with pytest.raises(RuntimeError, match="over"):
        world.step(STOP)


def test_driver_actions_wraps_turns():
    poses = np.array([(0, 0, math.pi - 0.05), (0, 0, -math.pi + 0.2)])
    assert driver_actions(poses).actions.tolist() == [LEFT, STOP]
    assert driver_actions(poses).radians[0] == pytest.approx(0.25)


def test_driver_actions_marks_backward_and_sideways_steps():
    poses = np.array([(0, 0, 0), (0, -0.25, 0), (0.25, -0.25, 0), (0.25, 0, 0)], float)
    done = driver_actions(poses)
    assert done.actions.tolist() == [NO_ACTION, NO_ACTION, FORWARD, STOP]
    assert done.metres.tolist() == pytest.approx([-0.25, 0, 0.25, 0])


def test_driver_actions_measures_an_arc():
    poses = np.array([(0, 0, 0), (-0.1, 0.4, math.radians(25))])
    done = driver_actions(poses)
    assert done.metres[0] == pytest.approx(0.41, abs=0.01)
    assert done.radians[0] == pytest.approx(math.radians(25))


def test_choose_keeps_the_last_instant():
    times, poses = np.arange(10.0), np.stack([np.zeros(10), 0.1 * np.arange(10), np.zeros(10)], 1)
    assert Step().choose(times, poses).tolist() == [0, 3, 6, 9]
    assert Step().choose(times[:8], poses[:8]).tolist() == [0, 3, 7]


def test_interpolate_poses_leaves_gaps_unknown():
    table = np.array([(0, 0, 0, 0), (1, 0, 1, 0.2), (10, 0, 2, 0.4), (11, np.nan, 0, 0)])
    poses, known = interpolate_poses(np.array([0.5, 5.0, 10.05, 10.5]), table)
    assert known.tolist() == [True, False, True, False]
    assert poses[0].tolist() == pytest.approx([0, 0.5, 0.1])


def test_lens_scales_intrinsics_and_rejects_another_aspect():
    lens = Lens(RGB, focal=(64, 64), centre=(64, 48), size=(128, 96))
    assert lens.intrinsics(48, 64) == (32, 32, 32, 24)
    with pytest.raises(ValueError, match="do not fit the CameraInfo"):
        lens.intrinsics(64, 64)
    with pytest.raises(ValueError, match="degrees"):
        Lens(RGB, focal=(1e5, 1e5), centre=(1, 1), size=(64, 48))


def test_square_view_needs_little_memory():
    frame = np.full((2000, 3000, 3), 90, np.uint8)
    view = square_view(frame, Lens(RGB, hfov=10.5), 64)
    assert view.shape == (64, 64, 3) and 0 < (view > 0).mean() < 0.02


def test_read_stamp_of_ros1_and_ros2():
    ros1 = struct.pack("<III", 7, 12, 500_000_000)
    cdr = b"\x00\x01\x00\x00" + struct.pack("<iI", 12, 500_000_000)
    assert read_stamp(ros1, ros2=False) == read_stamp(cdr, ros2=True) == 12.5
    assert read_stamp(b"", ros2=True) == 0.0


def test_choose_topics_of_a_camera_called_depth_camera():
    there = {
        "/depth_camera/image_raw": IMAGES[0],
        "/depth_camera/depth/image_raw": IMAGES[0],
        "/depth_camera/camera_info": INFO,
        "/odom": "nav_msgs/msg/Odometry",
    }
    recording = choose_topics(Path("a.bag"), there, Topics())
    assert recording[RGB] == "/depth_camera/image_raw"
    assert recording[DEPTH] == "/depth_camera/depth/image_raw"
    assert recording["depth_info"] == recording["info"] == "/depth_camera/camera_info"
    assert DEPTH not in choose_topics(Path("a.bag"), there, Topics(depth="none"))
    with pytest.raises(ValueError, match="must be a topic of sensor_msgs"):
        choose_topics(Path("a.bag"), there, Topics(rgb="/odom"))


def test_open_recording_rejects_options_without_effect(folder, tmp_path):
    bag = write_bag(tmp_path / "robot", steps(path_poses()), "bag")
    with pytest.raises(ValueError, match="cameras= applies only .* Choose topics.rgb= and"):
        open_recording(bag, cameras=["rgb"])
    with pytest.raises(ValueError, match="topics= applies only to a bag"):
        open_recording(folder, topics={"rgb": "/a"})
    with pytest.raises(ValueError, match="step by step"):
        load(open_recording(folder)[0], views=1, size=SIZE, step=Step(metres=0.5))


def test_open_recording_reads_a_folder_of_drives(tmp_path):
    write_bag(tmp_path / "a", steps(path_poses()), "mcap")
    write_frames(tmp_path / "b", steps(path_poses()), "go")
    assert [drive.name for drive in open_recording(tmp_path)] == ["a", "b"]


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (
            lambda f: (f / "poses.csv").write_text("x,y,heading\n0,0,0\n"),
            "number of frames and poses",
        ),
        (
            lambda f: (f / "poses.csv").write_text("heading,x,y\n" + "90,0,0\n" * 6),
            "line 1: .*heading",
        ),
        (lambda f: (f / "poses.csv").write_text("0,0,90\n0,0,0\n" * 3), "radians"),
        (lambda f: (f / "poses.csv").write_text("0,0\n" * 6), "line 1, must have 3 words"),
        (lambda f: (f / "poses.csv").write_text("x,y,heading\n\n0,0\n"), "line 3, must have"),
        (lambda f: (f / "poses.csv").write_text("x,y,heading\n0,0,a\n"), "line 2: .* got 'a'"),
        (lambda f: (f / "poses.csv").write_text("0,0,nan\n" * 6), "must be a finite number"),
        (
            lambda f: (f / "poses.csv").write_text("0,0,0\n" * 5 + "1e300,0,0\n"),
            "line 6: numbers must be at most",
        ),
        (
            lambda f: (
                (f / "rgb" / "000001.png").replace(f.parent / "a.png")
                and (f / "rgb" / "000001.png").symlink_to(f.parent / "a.png")
            ),
            "000001.png is a link to a place outside",
        ),
        (lambda f: (f / "rgb" / "000002.png").write_bytes(b"\x89PNG cut"), "000002.png"),
        (lambda f: (f / "rgb" / "000002.png").unlink(), "number of frames and poses"),
        (lambda f: (f / "depth" / "000001.png").replace(f / "rgb" / "000001.png"), "same number"),
    ],
)
def test_open_recording_names_a_damaged_file(folder, damage, message):
    damage(folder)
    with pytest.raises(ValueError, match=message):
        read(folder)


def test_open_recording_explains_what_a_drive_is(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"rgb\.txt"):
        open_recording(tmp_path)
    with pytest.raises(FileNotFoundError, match="no recording"):
        open_recording(tmp_path / "none")
    with pytest.raises(ValueError, match="field of view"):
        open_recording(tmp_path, hfov=400)
