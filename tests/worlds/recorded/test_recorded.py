"""Recorded drives: what is read of folders and bags, which instants, and as which views."""

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
from mitigate.worlds.recorded.bags import IMAGES, INFO, Topics, chosen
from mitigate.worlds.recorded.messages import stamp
from mitigate.worlds.recorded.recording import NONE, driven, square
from mitigate.worlds.recorded.source import Lens, placed

SIZE = 32


def steps(poses: list[tuple[float, float, float]]) -> list[dict[str, np.ndarray]]:
    """Frames that differ from step to step, at these poses."""
    rng = np.random.default_rng(0)
    return [
        {
            RGB: rng.integers(0, 255, (SIZE, SIZE, 3), np.uint8),
            DEPTH: (rng.integers(0, 8000, (SIZE, SIZE, 1)) / 1000).astype(np.float32),
            POSE: np.array(pose, np.float32),
        }
        for pose in poses
    ]


def walk() -> list[tuple[float, float, float]]:
    """Two steps ahead, one turn to the left, one step, one turn to the right."""
    turn = math.radians(15)
    ahead = 0.25 * np.array([-math.sin(turn), math.cos(turn)])
    there = (ahead[0], 0.5 + ahead[1])
    return [(0, 0, 0), (0, 0.25, 0), (0, 0.5, 0), (0, 0.5, turn), (*there, turn), (*there, 0)]


def read(path: Path, **options):
    (source,) = open_recording(path, **options)
    return load(source, views=1, size=SIZE, step=Step())


@pytest.fixture
def folder(tmp_path):
    write_frames(tmp_path / "drive", steps(walk()), "walk to the door")
    return tmp_path / "drive"


def test_a_folder_gives_its_frames_poses_words_and_what_the_driver_did(folder):
    found, wanted = read(folder), steps(walk())
    assert found.instruction == "walk to the door"
    assert np.array_equal(found.frames[RGB], np.stack([s[RGB] for s in wanted]))
    assert np.allclose(found.frames[DEPTH], np.stack([s[DEPTH] for s in wanted]), atol=6e-4)
    assert np.allclose(found.poses, np.stack([s[POSE] for s in wanted]), atol=1e-5)
    assert found.driven.actions.tolist() == [FORWARD, FORWARD, LEFT, FORWARD, RIGHT, STOP]


def test_the_byte_order_mark_of_an_editor_is_no_part_of_a_text(folder):
    for name in ("instruction.txt", "poses.csv"):
        file = folder / name
        file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    found = read(folder)
    assert found.instruction == "walk to the door" and len(found.poses) == len(walk())


@pytest.mark.parametrize("form", ["bag", "mcap"])
def test_a_bag_gives_what_the_folder_gives(folder, tmp_path, form):
    bag = write_bag(tmp_path / "robot", steps(walk()), form)
    (tmp_path / "robot.txt").write_text("walk to the door\n")
    first, second = read(folder), read(bag)
    assert second.instruction == "walk to the door"
    for name in (RGB, DEPTH):
        assert np.array_equal(first.frames[name], second.frames[name]), name
    assert np.allclose(first.poses, second.poses, atol=1e-5)
    assert first.driven.actions.tolist() == second.driven.actions.tolist()


def bag_of(path: Path, headers: Sequence[int]) -> Path:
    """A bag of ROS 1, a step for each header's seconds, received from second 1000 on."""
    store = get_typestore(Stores.ROS1_NOETIC)
    made = {}
    with Writer(path) as writer:
        for number, (step, stamped) in enumerate(zip(steps(walk()), headers, strict=True)):
            for name, message in messages(store, step, stamped, True):
                kind = message.__msgtype__
                if name not in made:
                    made[name] = writer.add_connection(TOPICS[name], kind, typestore=store)
                raw = store.serialize_ros1(message, kind)
                writer.write(made[name], (1000 + number) * 10**9, raw)
    return path


@pytest.mark.parametrize("headers", [range(6), [0] * 6])
def test_a_time_of_zero_is_one_unless_no_header_says_another(tmp_path, headers):
    (drive,) = open_recording(bag_of(tmp_path / "robot.bag", headers))
    assert drive.times.tolist() == [(1000 if not any(headers) else 0) + n for n in range(6)]
    assert np.allclose(drive.poses, walk(), atol=1e-6)


def test_a_bag_that_is_a_folder_with_a_dot_has_its_own_words(tmp_path):
    bag = write_bag(tmp_path / "drive.2", steps(walk()), "mcap")
    (tmp_path / "drive.txt").write_text("of another drive")
    assert (open_recording(bag)[0].name, read(bag).instruction) == ("drive.2", "")
    (tmp_path / "drive.2.txt").write_text("walk to the door")
    assert read(bag).instruction == "walk to the door"


def test_a_width_beside_that_of_a_bag_is_refused(tmp_path):
    bag = write_bag(tmp_path / "robot", steps(walk()), "mcap")
    with pytest.raises(ValueError, match=r"says how wide its cameras see: leave hfov="):
        open_recording(bag, hfov=60.0)
    (there,) = open_recording(bag, hfov=60.0, topics=Topics(info="none"))
    assert there.cameras[RGB].hfov == 60.0 and there.cameras[DEPTH].focal is not None


def test_a_bag_says_which_topics_there_are_and_takes_one_that_is_named(tmp_path):
    bag = write_bag(tmp_path / "robot", steps(walk()), "bag")
    with pytest.raises(ValueError, match="/camera/color/image_raw"):
        open_recording(bag, topics=Topics(rgb="/camera/colour/image_raw"))
    (source,) = open_recording(bag, topics=Topics(rgb="/camera/color/image_raw"))
    assert set(source.cameras) == {RGB, DEPTH}


@pytest.mark.parametrize("form", ["bag", "mcap"])
def test_a_damaged_bag_is_a_named_error(tmp_path, form):
    bag = write_bag(tmp_path / "robot", steps(walk()), form)
    file = bag if form == "bag" else next(bag.glob("*.mcap"))
    whole = file.read_bytes()
    rng = np.random.default_rng(0)
    for cut in (0, 10, len(whole) // 3, len(whole) - 40):
        file.write_bytes(whole[:cut])
        with pytest.raises(ValueError, match="robot"):
            read(bag)
    for _ in range(10):  # flipped bytes: read as something, or refused by name
        damaged = bytearray(whole)
        for at in rng.integers(0, len(whole), 30):
            damaged[at] ^= 0xFF
        file.write_bytes(bytes(damaged))
        try:
            read(bag)
        except ValueError as error:
            assert "robot" in str(error)


def tum(folder: Path, made: list[dict[str, np.ndarray]], hertz: float = 10.0) -> Path:
    """The same in TUM RGB-D's form: frames at ten times the pace of the steps."""
    lists = {RGB: [], DEPTH: []}
    poses = []
    for number, step in enumerate(made):
        time = 100 + number / hertz
        for kind in (RGB, DEPTH):
            (folder / kind).mkdir(parents=True, exist_ok=True)
            picture = step[RGB][..., ::-1] if kind == RGB else np.rint(step[DEPTH][..., 0] * 5000)
            picture = picture if kind == RGB else picture.astype(np.uint16)
            cv2.imwrite(str(folder / kind / f"{time:.4f}.png"), picture)
            lists[kind].append(f"{time + (kind == DEPTH) * 0.01:.4f} {kind}/{time:.4f}.png")
        x, y, heading = step[POSE]
        # the optical axis (z) looks ahead, x to the right, y down
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


def test_frames_at_a_cameras_pace_are_thinned_to_an_agents_steps(tmp_path):
    slow = [(0.0, 0.025 * i, 0.0) for i in range(41)]  # one metre in 41 frames
    found = read(tum(tmp_path / "lab", steps(slow)), hfov=90.0)
    assert len(found.times) == 5
    assert np.allclose(np.diff(found.poses[:, 1]), 0.25, atol=0.01)
    assert np.allclose(found.poses[:, 2], 0, atol=1e-6)


def turn_poses(folder: Path, quaternion: str, numbers: Sequence[int]) -> None:
    """Give poses of a folder of TUM's form another rotation."""
    lines = (folder / "groundtruth.txt").read_text().splitlines()
    for n in numbers:  # the first line is a comment
        lines[1 + n] = " ".join([*lines[1 + n].split()[:4], quaternion])
    (folder / "groundtruth.txt").write_text("\n".join(lines))


def test_poses_of_a_robot_are_not_taken_for_those_of_a_camera(tmp_path):
    folder = tum(tmp_path / "lab", steps([(0.0, 0.25 * i, 0.0) for i in range(8)]))
    turn_poses(folder, "0 0 0.38 0.92", range(8))  # about the vertical, as x ahead has it
    with pytest.raises(ValueError, match=r"8 of 8 poses look up or down.*z ahead"):
        read(folder)


def test_a_camera_that_looks_down_for_a_moment_keeps_the_heading_between(tmp_path):
    folder = tum(tmp_path / "lab", steps([(0.0, 0.25 * i, 0.1) for i in range(8)]))
    turn_poses(folder, "1 0 0 0", [3, 4])
    (drive,) = open_recording(folder)
    assert np.allclose(drive.poses[:, 2], 0.1, atol=1e-6) and drive.dropped == 0


def test_a_list_that_names_a_file_outside_of_its_folder_is_refused(tmp_path):
    folder = tum(tmp_path / "lab", steps(walk()))
    (folder / "rgb.txt").write_text("100.0 ../../secret.png\n")
    with pytest.raises(ValueError, match="outside"):
        read(folder)


@pytest.fixture
def recorded(tmp_path):
    """A folder as ``mitigate run record=`` makes it, of one episode."""
    made = steps(walk())
    write_frames(tmp_path / "x", made, "")
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
        for i, p in enumerate(walk())
    ]
    (episode / "steps.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    copytree(episode, episode.with_name(".18.4711.tmp"))  # left by a run that was killed
    return tmp_path / "recorded"


def change_steps(recorded: Path, change: Callable[[int, dict], object]) -> None:
    """Change the lines of the episode, each of which ``change`` gets with its number."""
    file = recorded / "kitchen" / "17" / "steps.jsonl"
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    for number, line in enumerate(lines):
        change(number, line)
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))


def test_degrees_in_a_recording_are_not_taken_for_radians(recorded):
    change_steps(recorded, lambda n, line: line.update(heading=15.0 * n))
    with pytest.raises(ValueError, match=r"steps\.jsonl has headings up to 75: give radians"):
        read(recorded)


def test_poses_that_a_recording_lacks_are_counted(recorded):
    change_steps(recorded, lambda n, line: n == 2 and line.pop("heading"))
    with pytest.warns(UserWarning, match=r"lacks the pose of 1 of 6 steps.*without poses"):
        assert read(recorded).poses is None


@pytest.mark.parametrize(
    ("file", "content", "part"),
    [
        ("cameras.json", b'{"rgb": {"kind": "thermal"}}', "must say kind, rgb or depth, of rgb"),
        ("cameras.json", b'{"rgb": 90}', "must say kind, rgb or depth, of rgb, got 90"),
        ("episode.json", b'{"text": ["go"]}', "the instruction must be a text"),
    ],
)
def test_open_recording_rejects_odd_notes_of_an_episode(recorded, file, content, part):
    (recorded / "kitchen" / "17" / file).write_bytes(content)
    with pytest.raises(ValueError, match=part):
        read(recorded)


@pytest.mark.parametrize("kind", [RGB, DEPTH])
def test_open_recording_rejects_a_missing_frame_in_the_middle(recorded, kind):
    (recorded / "kitchen" / "17" / kind / "000002.png").unlink()
    with pytest.raises(ValueError, match=rf"{kind} has no frame 000002, .*not whole"):
        read(recorded)


def test_open_recording_reads_an_episode_whose_last_frame_is_missing(recorded):
    (recorded / "kitchen" / "17" / DEPTH / "000005.png").unlink()
    assert len(read(recorded).times) == 5


def test_open_recording_rejects_an_instruction_that_is_not_utf_8(folder):
    (folder / "instruction.txt").write_bytes("Gehe zur Küche.".encode("utf-16"))
    with pytest.raises(ValueError, match="must be UTF-8 text"):
        read(folder)


def test_headings_that_do_not_point_along_the_way_are_told(folder):
    way = [(0.0, 0.25 * n, 0.0) for n in range(6)]
    for heading, strange in ((0.0, False), (math.pi / 2, True)):  # of +x as ROS has it
        rows = "".join(f"{x},{y},{heading}\n" for x, y, _ in way)
        (folder / "poses.csv").write_text(rows)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            read(folder)
        assert [("5 of 5 steps that move" in str(w.message)) for w in said] == [True] * strange


def test_a_recording_of_mitigate_run_is_read_with_its_cameras(recorded):
    found = read(recorded)
    assert (found.name, found.instruction) == ("kitchen/17", "go to the sink")
    assert np.allclose(found.poses, np.array(walk()), atol=1e-6)


def test_a_square_view_of_ninety_degrees_stays_bit_for_bit():
    frame = steps(walk())[0][RGB]
    assert np.array_equal(square(frame, Lens(RGB), SIZE), frame)


def test_a_narrow_camera_leaves_black_where_it_does_not_look():
    frame = np.full((48, 64, 3), 200, np.uint8)
    lens = Lens(RGB, hfov=math.degrees(2 * math.atan(0.5)))  # half as wide as the view
    seen = square(frame, lens, 64)[..., 0]
    assert (seen[:, :15] == 0).all() and (seen[:, 49:] == 0).all()
    assert (seen[22:42, 18:46] == 200).all()
    assert abs((seen > 0).mean() - 0.5 * 0.375) < 0.03


def test_a_wide_camera_is_cut_to_the_view():
    columns = np.arange(200)
    frame = np.repeat(np.repeat(columns[None, :, None], 100, 0), 3, 2).astype(np.uint8)
    lens = Lens(RGB, hfov=math.degrees(2 * math.atan(2.0)))  # twice as wide
    seen = square(frame, lens, 50)[25, :, 0].astype(int)
    assert abs(seen[0] - 50) <= 1 and abs(seen[-1] - 149) <= 1


def test_depth_keeps_its_holes_when_it_is_resized():
    frame = np.full((64, 64), 3.0, np.float32)
    frame[::2, ::2] = 0.0
    seen = square(frame, Lens(DEPTH), 32)
    assert set(np.unique(seen)) <= {0.0, 3.0}


def test_a_panorama_needs_all_its_cameras(folder):
    (source,) = open_recording(folder)
    with pytest.raises(ValueError, match="1 rgb cameras of the 12"):
        load(source, views=12, size=SIZE, step=Step())


def test_the_world_shows_the_next_instant_whatever_the_agent_does(folder):
    world = RecordedWorld(read(folder))
    observation = world.reset(world.episode())
    seen = []
    while not world.done:
        seen.append(observation[RGB])
        observation = world.step(STOP)
    assert np.array_equal(np.stack(seen), world.recording.frames[RGB])
    with pytest.raises(RuntimeError, match="over"):
        world.step(STOP)


def test_a_turn_across_the_back_counts_as_a_small_one():
    poses = np.array([(0, 0, math.pi - 0.05), (0, 0, -math.pi + 0.2)])
    assert driven(poses).actions.tolist() == [LEFT, STOP]
    assert driven(poses).radians[0] == pytest.approx(0.25)


def test_backwards_and_sideways_are_none_of_an_agents_actions():
    poses = np.array([(0, 0, 0), (0, -0.25, 0), (0.25, -0.25, 0), (0.25, 0, 0)], float)
    done = driven(poses)
    assert done.actions.tolist() == [NONE, NONE, FORWARD, STOP]
    assert done.metres.tolist() == pytest.approx([-0.25, 0, 0.25, 0])


def test_an_arc_is_told_as_it_was():
    poses = np.array([(0, 0, 0), (-0.1, 0.4, math.radians(25))])
    done = driven(poses)
    assert done.metres[0] == pytest.approx(0.41, abs=0.01)
    assert done.radians[0] == pytest.approx(math.radians(25))


def test_the_end_of_a_drive_is_shown():
    times, poses = np.arange(10.0), np.stack([np.zeros(10), 0.1 * np.arange(10), np.zeros(10)], 1)
    assert Step().choose(times, poses).tolist() == [0, 3, 6, 9]
    assert Step().choose(times[:8], poses[:8]).tolist() == [0, 3, 7]


def test_places_are_known_between_two_poses_but_not_in_a_gap():
    table = np.array([(0, 0, 0, 0), (1, 0, 1, 0.2), (10, 0, 2, 0.4), (11, np.nan, 0, 0)])
    poses, known = placed(np.array([0.5, 5.0, 10.05, 10.5]), table)
    assert known.tolist() == [True, False, True, False]
    assert poses[0].tolist() == pytest.approx([0, 0.5, 0.1])


def test_the_lens_of_another_size_is_scaled_and_of_another_shape_refused():
    lens = Lens(RGB, focal=(64, 64), centre=(64, 48), size=(128, 96))
    assert lens.of(48, 64) == (32, 32, 32, 24)
    with pytest.raises(ValueError, match="not of the camera"):
        lens.of(64, 64)
    with pytest.raises(ValueError, match="degrees"):
        Lens(RGB, focal=(1e5, 1e5), centre=(1, 1), size=(64, 48))


def test_a_camera_that_sees_little_takes_little_memory():
    frame = np.full((2000, 3000, 3), 90, np.uint8)
    seen = square(frame, Lens(RGB, hfov=10.5), 64)
    assert seen.shape == (64, 64, 3) and 0 < (seen > 0).mean() < 0.02


def test_a_serialised_header_says_when_it_was():
    ros1 = struct.pack("<III", 7, 12, 500_000_000)
    cdr = b"\x00\x01\x00\x00" + struct.pack("<iI", 12, 500_000_000)
    assert stamp(ros1, ros2=False) == stamp(cdr, ros2=True) == 12.5
    assert stamp(b"", ros2=True) == 0.0


def test_topics_of_a_camera_that_is_called_depth_camera():
    there = {
        "/depth_camera/image_raw": IMAGES[0],
        "/depth_camera/depth/image_raw": IMAGES[0],
        "/depth_camera/camera_info": INFO,
        "/odom": "nav_msgs/msg/Odometry",
    }
    found = chosen(Path("a.bag"), there, Topics())
    assert found[RGB] == "/depth_camera/image_raw"
    assert found[DEPTH] == "/depth_camera/depth/image_raw"
    assert found["info depth"] == found["info rgb"] == "/depth_camera/camera_info"
    assert DEPTH not in chosen(Path("a.bag"), there, Topics(depth="none"))
    with pytest.raises(ValueError, match="not sensor_msgs"):
        chosen(Path("a.bag"), there, Topics(rgb="/odom"))


def test_options_without_effect_are_refused(folder, tmp_path):
    bag = write_bag(tmp_path / "robot", steps(walk()), "bag")
    with pytest.raises(ValueError, match="unit="):
        open_recording(bag, unit=0.001)
    with pytest.raises(ValueError, match="no bag"):
        open_recording(folder, topics=Topics(rgb="/a"))
    with pytest.raises(ValueError, match="step by step"):
        load(open_recording(folder)[0], views=1, size=SIZE, step=Step(metres=0.5))


def test_a_folder_of_drives_gives_all(tmp_path):
    write_bag(tmp_path / "a", steps(walk()), "mcap")
    write_frames(tmp_path / "b", steps(walk()), "go")
    assert [drive.name for drive in open_recording(tmp_path)] == ["a", "b"]


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda f: (f / "poses.csv").write_text("x,y,heading\n0,0,0\n"), "as many of each"),
        (lambda f: (f / "poses.csv").write_text("heading,x,y\n" + "90,0,0\n" * 6), "columns"),
        (lambda f: (f / "poses.csv").write_text("0,0,90\n0,0,0\n" * 3), "radians"),
        (lambda f: (f / "poses.csv").write_text("0,0\n" * 6), "line 1, is not x,y,heading"),
        (lambda f: (f / "poses.csv").write_text("x,y,heading\n\n0,0\n"), "line 3, is not"),
        (lambda f: (f / "poses.csv").write_text("x,y,heading\n0,0,a\n"), "line 2: 'a'"),
        (lambda f: (f / "poses.csv").write_text("0,0,nan\n" * 6), "no finite number"),
        (lambda f: (f / "rgb" / "000002.png").write_bytes(b"\x89PNG cut"), "000002.png"),
        (lambda f: (f / "rgb" / "000002.png").unlink(), "as many of each"),
        (lambda f: (f / "depth" / "000001.png").replace(f / "rgb" / "000001.png"), "as many"),
    ],
)
def test_a_damaged_folder_is_a_named_error(folder, spoil, says):
    spoil(folder)
    with pytest.raises(ValueError, match=says):
        read(folder)


def test_nothing_that_can_be_read_says_what_would_be(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"rgb\.txt"):
        open_recording(tmp_path)
    with pytest.raises(FileNotFoundError, match="no recording"):
        open_recording(tmp_path / "none")
    with pytest.raises(ValueError, match="field of view"):
        open_recording(tmp_path, hfov=400)
