"""Tests of bags as robots record them: camera shapes, encodings, topics, times and damaged
files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.replay.export_drive import messages, write_bag
from mitigate.worlds.recorded import Step, load, open_recording
from mitigate.worlds.recorded.source import Lens
from mitigate.worlds.recorded.views import covered_tangent

COUNT = 6
HEIGHT, WIDTH = 24, 32  # 4:3, as most cameras
STORE = get_typestore(Stores.ROS1_NOETIC)
TYPES = STORE.types
RAW = "/camera/color/image_raw"
STEREO = "/camera/depth/image_raw"
INFO = "/camera/color/camera_info"


def colour(number: int) -> np.ndarray:
    return np.random.default_rng(number).integers(1, 255, (HEIGHT, WIDTH, 3), np.uint8)


def image(array: np.ndarray, encoding: str) -> dict:
    """Return the fields of an Image with the pixels of ``array``."""
    height, width = array.shape[:2]
    data = np.frombuffer(array.tobytes(), np.uint8)
    return {
        "height": height,
        "width": width,
        "encoding": encoding,
        "is_bigendian": 0,
        "step": len(data) // height,
        "data": data,
    }


def jpeg(number: int) -> dict:
    encoded = cv2.imencode(".jpg", colour(number))[1].ravel()
    return {"format": "rgb8; jpeg compressed bgr8", "data": encoded}


def rgb(number: int) -> dict:
    return image(colour(number), "rgb8")


def depth(number: int, metres: float = 2.0, unit: float = 0.001) -> dict:
    return image(np.full((HEIGHT, WIDTH), round(metres / unit), np.uint16), "16UC1")


def header(number: int, shift: float = 0.0) -> object:
    nanoseconds = round((10 + number + shift) * 1e9)
    time = TYPES["builtin_interfaces/msg/Time"](nanoseconds // 10**9, nanoseconds % 10**9)
    return TYPES["std_msgs/msg/Header"](seq=number, stamp=time, frame_id="camera")


def write(
    path: Path,
    images: Mapping[str, list[dict]],
    infos: tuple[str, ...] = (INFO,),
    poses: tuple[str, ...] = ("/odom",),
    shifts: Mapping[str, float] | None = None,
    focal: float = WIDTH / 2,
) -> Path:
    """Write a ROS 1 bag whose robot drives 0.25 m per second.

    Args:
        path: Path of the bag.
        images: For each topic, the fields of its image messages, one message per second.
        infos: Topics of CameraInfo.
        poses: Topics of odometry.
        shifts: Seconds that are added to the header times of a topic.
        focal: Focal length in pixels.
    """
    connections: dict[str, object] = {}
    with Writer(path) as writer:

        def add(topic: str, message: object, number: int) -> None:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            raw = STORE.serialize_ros1(message, kind)
            writer.write(connections[topic], (1000 + number) * 10**9, raw)

        for number in range(COUNT):
            frame = {
                RGB: np.zeros((HEIGHT, WIDTH, 3), np.uint8),
                DEPTH: np.zeros((HEIGHT, WIDTH, 1), np.float32),
                POSE: np.array([0, 0.25 * number, 0]),
            }
            standard = dict(messages(STORE, frame, number, True))
            k = np.array([focal, 0, WIDTH / 2, 0, focal, HEIGHT / 2, 0, 0, 1])
            for topic in infos:
                add(topic, replace(standard["info"], header=header(number), K=k), number)
            for topic in poses:
                shift = (shifts or {}).get(topic, 0.0)
                add(topic, replace(standard[POSE], header=header(number, shift)), number)
            for topic, fields in images.items():
                kind = "CompressedImage" if "format" in fields[number] else "Image"
                stamp = header(number, (shifts or {}).get(topic, 0.0))
                message = TYPES[f"sensor_msgs/msg/{kind}"](header=stamp, **fields[number])
                add(topic, message, number)
    path.with_suffix(".txt").write_text("go to the door")
    return path


def each(make, **options) -> list[dict]:
    return [make(number, **options) for number in range(COUNT)]


def read(path: Path, size: int = 16, crop: bool = False, **options):
    (source,) = open_recording(path, **options)
    return load(source, views=1, size=size, step=Step(), crop=crop)


def summary(path: Path, **options) -> str:
    return "\n".join(read(path, **options).summary)


# --------------------------------------------------------------------- views and their summary


def test_load_reports_and_warns_about_the_border_of_a_camera(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb)})
    with pytest.warns(UserWarning, match=r"robot: 25 % of each view is a border.*crop=true"):
        text = summary(bag)
    assert (
        f"rgb: {RAW}, rgb8, 32 x 24, 90 x 74 degrees, seen as 90 x 90; "
        "25 % of each view is a black border"
    ) in text
    assert "robot: 6 steps, one per 0.25 m or 15 degrees, from 5.0 s with 1 frames per" in text
    assert "pose: /odom, 1.2 m driven" in text and 'instruction: "go to the door"' in text


@pytest.mark.filterwarnings("error")
def test_load_accepts_a_small_border_without_a_warning(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb)}, focal=HEIGHT / 2)
    assert "border" not in summary(bag)


@pytest.mark.filterwarnings("error")
def test_crop_fills_the_view_with_the_field_that_all_cameras_cover(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb), STEREO: each(depth)}, (INFO,))
    drive = read(bag, size=HEIGHT, crop=True, topics={"depth_info": INFO})
    middle = slice((WIDTH - HEIGHT) // 2, (WIDTH + HEIGHT) // 2)
    assert np.array_equal(drive.frames[RGB][2], colour(2)[:, middle])
    assert (drive.frames[DEPTH] > 0).all()
    assert drive.sensors[RGB].hfov == pytest.approx(73.74, abs=0.01)
    assert "seen as 74 x 74" in drive.summary[1] and "border" not in "".join(drive.summary)


def test_crop_rejects_a_principal_point_outside_of_the_image():
    lens = Lens(RGB, focal=(16, 16), centre=(40, 12), size=(WIDTH, HEIGHT))
    with pytest.raises(ValueError, match="crop=true needs cameras"):
        covered_tangent([(lens, (HEIGHT, WIDTH))])


def test_load_reports_that_poses_are_missing(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb)}, poses=(), focal=HEIGHT / 2)
    text = summary(bag)
    assert "one per 0.5 s" in text and "pose: none, so agents receive the motion of" in text


def test_open_recording_takes_an_instruction_and_load_warns_without_one(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb)}, focal=HEIGHT / 2)
    assert read(bag, instruction="turn left").instruction == "turn left"
    with pytest.warns(UserWarning, match="robot has no instruction"):
        assert read(bag, instruction="").summary[-1] == "instruction: none"


# --------------------------------------------------------------------------- scale of depth


def test_load_reports_the_assumed_unit_and_the_range_of_depth(tmp_path):
    images = each(depth)
    images[0] = image(np.zeros((HEIGHT, WIDTH), np.uint16), "16UC1")
    text = summary(write(tmp_path / "robot.bag", {STEREO: images}, focal=HEIGHT / 2))
    assert f"depth: {STEREO}, 16UC1, 0.001 metres per count (assumed)" in text
    assert "median 2 m, maximum 2 m, 17 % without reading inside the image" in text


def test_unit_scales_the_depth_of_a_bag(tmp_path):
    bag = write(tmp_path / "robot.bag", {STEREO: each(depth, unit=0.0001)}, focal=HEIGHT / 2)
    with pytest.warns(UserWarning, match=r"median depth is 20 m.*Set unit="):
        assert np.allclose(read(bag).frames[DEPTH], 20)
    drive = read(bag, unit=0.0001)
    assert np.allclose(drive.frames[DEPTH], 2)
    assert "0.0001 metres per count;" not in drive.summary[1]
    assert "0.0001 metres per count, 32 x 24" in drive.summary[1]


def test_unit_scales_floats_in_millimetres(tmp_path):
    millimetres = image(np.full((HEIGHT, WIDTH), 2000, np.float32), "32FC1")
    bag = write(tmp_path / "robot.bag", {STEREO: [millimetres] * COUNT}, focal=HEIGHT / 2)
    with pytest.raises(ValueError, match=r"not in metres. Set unit= \(metres per count\)"):
        read(bag)
    assert np.allclose(read(bag, unit=0.001).frames[DEPTH], 2)


def test_unit_is_rejected_without_depth(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb)})
    with pytest.raises(ValueError, match="read without depth. Remove unit="):
        open_recording(bag, unit=0.001)


# ----------------------------------------------------------------------------------- topics


def test_open_recording_takes_topics_as_a_mapping(tmp_path):
    bag = write(tmp_path / "robot.bag", {RAW: each(rgb), "/rear": each(rgb)})
    (source,) = open_recording(bag, topics={"rgb": RAW})
    assert source.topics[RGB] == RAW
    with pytest.raises(ValueError, match=r"no entry of topics 'color'.*rgb, depth, pose"):
        open_recording(bag, topics={"color": RAW})


def test_bag_passes_errors_of_other_code_on(tmp_path, monkeypatch):
    def broken(*_):
        raise AttributeError("a mistake in our code")

    bag = write(tmp_path / "robot.bag", {RAW: each(rgb)})
    monkeypatch.setattr("mitigate.worlds.recorded.bags.choose_topics", broken)
    with pytest.raises(AttributeError, match="a mistake in our code"):
        open_recording(bag)


def test_bag_recognises_depth_by_its_encoding(tmp_path):
    images = {"/front/rgb": each(rgb), "/front/stereo": each(depth)}
    infos = ("/front/rgb_info", "/front/stereo_info")
    (source,) = open_recording(write(tmp_path / "robot.bag", images, infos))
    assert source.topics == {
        RGB: "/front/rgb",
        DEPTH: "/front/stereo",
        POSE: "/odom",
        "info": "/front/rgb_info",
        "depth_info": "/front/stereo_info",
    }


def test_bag_reads_a_colour_image_of_depth_only_if_it_is_the_only_colour(tmp_path):
    colored = "/camera/depth/colored"
    images = {RAW: each(rgb), STEREO: each(depth), colored: each(rgb)}
    (source,) = open_recording(write(tmp_path / "robot.bag", images, ("/camera/camera_info",)))
    assert (source.topics[RGB], source.topics[DEPTH]) == (RAW, STEREO)
    images.pop(RAW)
    (source,) = open_recording(write(tmp_path / "b.bag", images, ("/camera/camera_info",)))
    assert (source.topics[RGB], source.topics[DEPTH]) == (colored, STEREO)


def test_bag_prefers_raw_images_to_their_compressed_copies(tmp_path):
    images = {f"{RAW}/compressed": each(jpeg), RAW: each(rgb)}
    (source,) = open_recording(write(tmp_path / "robot.bag", images))
    assert source.topics[RGB] == RAW and source.formats[RGB] == f"{RAW}, rgb8"
    (source,) = open_recording(
        tmp_path / "robot.bag", topics={"rgb": f"{RAW}/compressed", "info": INFO}
    )
    assert source.topics[RGB] == f"{RAW}/compressed"


def test_bag_names_all_choices_at_once(tmp_path):
    images = {"/left/rgb": each(rgb), "/right/rgb": each(rgb), "/a": each(depth), "/b": each(depth)}
    infos = ("/left/info_1", "/left/info_2")
    bag = write(tmp_path / "robot.bag", images, infos, ("/odom", "/map"))
    with pytest.raises(ValueError, match="several topics") as error:
        open_recording(bag)
    assert "topics.rgb=/left/rgb topics.depth=/a topics.pose=/map topics.info=/left/info_1" in str(
        error.value
    )


# ------------------------------------------------------------------------- times and damage


def test_bag_names_the_topic_whose_times_differ(tmp_path):
    images = {RAW: each(rgb), STEREO: each(depth)}
    bag = write(tmp_path / "robot.bag", images, shifts={STEREO: 0.3})
    topics = {"depth_info": INFO}
    with pytest.raises(
        ValueError, match=rf"at most 0.1 s apart.*{STEREO} by 0.3 s and /odom by 0 s"
    ):
        open_recording(bag, topics=topics)
    (source,) = open_recording(bag, topics=topics, tolerance=0.35)
    assert len(source.times) == COUNT


def test_load_skips_and_counts_damaged_images(tmp_path):
    images = each(jpeg)
    images[2] = {**images[2], "data": images[2]["data"][:20]}
    bag = write(tmp_path / "robot.bag", {RAW: images}, focal=HEIGHT / 2)
    drive = read(bag)
    assert drive.times.tolist() == [0, 1, 3, 4, 5]
    assert len(drive.frames[RGB]) == len(drive.poses) == len(drive.driven.actions) == 5
    assert "1 damaged image left out" in drive.summary[0]


def test_load_rejects_a_drive_with_mostly_damaged_images(tmp_path):
    images = [{**jpeg(n), "data": jpeg(n)["data"][: 20 if n else None]} for n in range(COUNT)]
    bag = write(tmp_path / "robot.bag", {RAW: images})
    message = rf"5 of 6 steps with damaged images, the first because message 1 on {RAW}, 1.0 s"
    with pytest.raises(ValueError, match=message):
        read(bag)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.bag", b"", "is empty. Copy it again."),
        ("a.bag", b"drive to the door", "is not a .bag file"),
        ("a.bag", b"#ROSBAG V2.0\n\x45", "repair a copy with `rosbag reindex`"),
        ("a.mcap", b"\x89MCAP0\r\n", "repair a copy with `mcap recover`"),
        ("a.db3", b"SQLite format 3\0" + bytes(50), "sqlite3 OLD.db3 .recover"),
    ],
)
def test_damaged_bag_names_the_repair_for_its_format(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match="a") as error:
        open_recording(tmp_path / name)
    text = str(error.value)
    assert message in text and text.count("`") <= 2 and ".. " not in text


def test_damaged_folder_names_the_repair_of_its_metadata(tmp_path):
    frames = [
        {RGB: colour(n)[:, :HEIGHT], DEPTH: np.ones((HEIGHT, HEIGHT, 1)), POSE: np.zeros(3)}
        for n in range(2)
    ]
    bag = write_bag(tmp_path / "robot", frames, "mcap")
    (bag / "metadata.yaml").write_text("")
    with pytest.raises(ValueError, match="`ros2 bag reindex` writes metadata.yaml again"):
        open_recording(bag)
