"""Tests that frames from a world or a folder are reproducible and form two disjoint splits."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from mitigate.corruptions import Corruption, DepthSensor, Key
from mitigate.encoders import sources
from mitigate.encoders.sources import (
    TRAIN,
    UNSEEN,
    FolderFrames,
    WorldFrames,
    collect,
    corrupted,
    source_of,
)
from mitigate.worlds.apartments.world import ApartmentsWorld

LIST = "mitigate/worlds/apartments/episodes/val_unseen_vln.json.gz"


@pytest.fixture(scope="module")
def world() -> WorldFrames:
    return source_of(lambda: ApartmentsWorld(24, layouts=3), "rgb", {"a": LIST}, "a", "concepts")


def write(folder, name: str, seed: int, size: int = 12) -> None:
    pixels = np.random.default_rng(seed).integers(0, 256, (size, size, 3), np.uint8)
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(pixels).save(folder / name)


def test_world_frames_are_reproducible_with_labels(world):
    one, two = (collect(world, TRAIN, 10, 0) for _ in range(2))
    assert np.array_equal(one.frames, two.frames) and one.headings == two.headings
    assert one.frames.shape == (10, 24, 24, 3) and set(one.scene) == {0, 1, 2}
    assert one.labels is not None and one.labels.shape[0] == 10
    assert not np.array_equal(collect(world, TRAIN, 10, 1).frames, one.frames)


def test_world_frames_take_unseen_scenes_from_the_list(world):
    assert not set(world.scenes(TRAIN)) & set(world.scenes(UNSEEN))
    assert all("/val_unseen/" in name for name in world.scenes(UNSEEN))
    result = ApartmentsWorld(24, layouts=1)
    result.__class__ = type("Both", (ApartmentsWorld,), {"scenes": property(lambda s: [seen])})
    seen = world.scenes(UNSEEN)[0]
    with pytest.raises(ValueError, match="the report needs unseen scenes"):
        WorldFrames(result, "rgb", LIST)


def test_world_frames_give_metres():
    source = source_of(lambda: ApartmentsWorld(24, layouts=1), "depth", {"a": LIST}, "a", None)
    frames = collect(source, TRAIN, 4, 0)
    assert frames.frames.shape == (4, 24, 24, 1) and frames.frames.dtype == np.float32
    assert 0.1 < frames.frames.max() < 30 and frames.labels is None


def test_corrupted_treats_a_frame_as_an_observation(world):
    frames = collect(world, TRAIN, 6, 0)
    key = Key(0, "a")
    for index in (0, 5):
        seen = corrupted(frames, index, Corruption("low_light", 0.6), key, DepthSensor())
        assert (
            seen.shape == frames.frames[index].shape and seen.mean() < frames.frames[index].mean()
        )


def test_folder_frames_hold_out_the_last_scenes(tmp_path):
    for scene in range(5):
        for number in range(3):
            write(tmp_path, f"house{scene}/{number}.png", 10 * scene + number)
    source = source_of(lambda: FolderFrames(str(tmp_path)), "rgb", None, "unseen", None)
    assert list(source.scenes(UNSEEN)) == ["house4"] and len(source.scenes(TRAIN)) == 4
    frames = collect(source, TRAIN, 8, 0)
    assert len(frames) == 8 and frames.labels is None and frames.headings[0] is None


def test_folder_frames_hold_out_val_folders(tmp_path):
    for scene in ("train/a", "train/b", "val/c"):
        write(tmp_path, f"{scene}/0.png", 0)
    source = FolderFrames(str(tmp_path))
    assert list(source.scenes(UNSEEN)) == ["val/c"]


def test_folder_frames_split_a_single_folder(tmp_path, monkeypatch):
    for number in range(100):
        write(tmp_path, f"{number}.png", number, 2)
    few = FolderFrames(str(tmp_path))  # with blocks of 50 frames, only one block would be held out
    assert len(few.scenes(TRAIN)) == 20 and len(few.scenes(UNSEEN)) == 5
    monkeypatch.setattr(sources, "BLOCK", 3)
    source = FolderFrames(str(tmp_path))
    assert len(source.scenes(TRAIN)) == 27 and len(source.scenes(UNSEEN)) == 7
    first = list(source.shots(source.scenes(TRAIN)[0], 3, 0))
    assert len(first) == 3


def test_collect_requires_one_size(tmp_path):
    for number in range(4):
        write(tmp_path, f"a{number}/0.png", number, 12 + number % 2)
    with pytest.raises(ValueError, match=r"env.size=PIXELS"):
        collect(FolderFrames(str(tmp_path), held_out=0.25), TRAIN, 3, 0)
    frames = collect(FolderFrames(str(tmp_path), size=8, held_out=0.25), TRAIN, 3, 0)
    assert frames.frames.shape == (3, 8, 8, 3)


def test_folder_frames_name_a_file_of_another_size(tmp_path):
    for number in range(4):
        write(tmp_path, f"a{number}/0.png", number, 13 if number == 3 else 12)
    source = FolderFrames(str(tmp_path))
    collect(source, TRAIN, 3, 0)
    with pytest.raises(ValueError, match=r"a3/0.png has 13 x 13 .*a0/0.png has 12 x 12.*env.size"):
        collect(source, UNSEEN, 1, 0)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("size", [0, -3, 2.5, True, "64", 10**6]),
        ("unit", [0, -1.0, np.nan, np.inf, "mm"]),
        ("held_out", [0, 1, -1, np.nan, "half"]),
    ],
)
def test_folder_frames_reject_invalid_options(tmp_path, name, values):
    for value in values:
        with pytest.raises(ValueError, match=rf"env\.(world\.)?{name} must be "):
            FolderFrames(str(tmp_path), **{name: value})


def test_folder_frames_reject_too_small_units(tmp_path):
    for number in range(2):
        (tmp_path / f"s{number}").mkdir()
        Image.fromarray(np.full((6, 6), 1500, np.uint16)).save(tmp_path / f"s{number}/0.png")
    with pytest.raises(ValueError, match=r"0\.png must contain depth in metres.*nearer.*env\.unit"):
        collect(FolderFrames(str(tmp_path), "depth", unit=1e-6), TRAIN, 1, 0)
    near = FolderFrames(str(tmp_path), "depth", unit=1e-4)
    # the frames show a wall at a distance of 15 cm
    assert collect(near, TRAIN, 1, 0).frames.max() == np.float32(0.15)


def test_folder_frames_read_depth_in_metres(tmp_path):
    for number in range(2):
        (tmp_path / f"s{number}").mkdir()
        Image.fromarray(np.full((6, 6), 1500, np.uint16)).save(tmp_path / f"s{number}/0.png")
        np.save(tmp_path / f"s{number}/1.npy", np.full((6, 6), 2.5, np.float32))
    frames = collect(FolderFrames(str(tmp_path), "depth"), TRAIN, 2, 0)
    assert sorted(frames.frames[:, 0, 0, 0].tolist()) == [1.5, 2.5]


HOLES = np.array([[np.nan, np.inf, -np.inf], [-1, 0, 2.5]], np.float32)


def test_folder_frames_replace_invalid_depth(tmp_path):
    for number in range(2):
        (tmp_path / f"s{number}").mkdir()
        np.save(tmp_path / f"s{number}/0.npy", HOLES)
    frames = collect(FolderFrames(str(tmp_path), "depth"), TRAIN, 1, 0)
    assert frames.frames[0, ..., 0].tolist() == [[0, 0, 0], [0, 0, 2.5]]


@pytest.mark.parametrize(
    ("depth", "says"),
    [
        (np.full((6, 6), 1500.0), "must contain depth in metres.* .median 1500"),
        (np.linspace(0, 5000, 900).reshape(30, 30), "must contain depth in metres"),
        (np.ones((6, 6, 3)), r"has the shape \[6, 6, 3\]"),
        (np.ones(6), r"has the shape \[6\]"),
        (np.ones((0, 0)), r"has the shape \[0, 0\]"),
        (np.ones((6, 6), np.uint16), "holds uint16"),
    ],
)
def test_folder_frames_name_a_file_without_depth(tmp_path, depth, says):
    for number in range(2):
        (tmp_path / f"s{number}").mkdir()
        np.save(tmp_path / f"s{number}/0.npy", depth)
    with pytest.raises(ValueError, match=f"s0/0.npy {says}.*remove it from the folder"):
        collect(FolderFrames(str(tmp_path), "depth", size=4), TRAIN, 1, 0)


def test_collect_rejects_black_frames(tmp_path):
    for number in range(2):
        (tmp_path / f"s{number}").mkdir()
        np.save(tmp_path / f"s{number}/0.npy", np.full((6, 6), 1e300))
    with pytest.raises(ValueError, match="All 1 train frames are 0 in all pixels"):
        collect(FolderFrames(str(tmp_path), "depth"), TRAIN, 1, 0)


def test_folder_frames_report_ignored_files(tmp_path, capsys):
    for number in range(5):
        write(tmp_path, f"s{number}/a.png", number)
        Image.new("RGBA", (12, 12)).save(tmp_path / f"s{number}/b.png")
    (tmp_path / "s0/c.png").write_bytes(b"x")
    FolderFrames(str(tmp_path))
    message = " ".join(capsys.readouterr().out.split())
    assert "6 left out (5 as s0/b.png, which is a 8-bit RGB with alpha PNG" in message
    assert "1 as s0/c.png, which is not a PNG file" in message
    for file in tmp_path.glob("s*/a.png"):
        file.unlink()
    with pytest.raises(FileNotFoundError, match=r"6 left out \(5 as s0/b.png"):
        FolderFrames(str(tmp_path))
    write(tmp_path, "s0/a.png", 0)
    with pytest.raises(ValueError, match=r"has 1 scenes \(frames: 1, 6 left out \(5 as s0/b.png"):
        FolderFrames(str(tmp_path)).scenes(TRAIN)


@pytest.mark.parametrize("spoil", ["grey", "cut"])
def test_folder_frames_name_an_unreadable_picture(tmp_path, spoil):
    for number in range(2):
        write(tmp_path, f"s{number}/0.jpg", number)
    file = tmp_path / "s0/0.jpg"
    if spoil == "grey":
        Image.new("L", (12, 12)).save(file)
    else:
        file.write_bytes(file.read_bytes()[:-200])
    says = "has the colour mode L" if spoil == "grey" else "cannot be decoded"
    with pytest.raises(ValueError, match=f"{file} {says}.*remove it from the folder"):
        collect(FolderFrames(str(tmp_path)), TRAIN, 1, 0)


def test_collect_selects_a_subset(tmp_path):
    for scene in range(7):
        for number in range(1 + scene % 3):
            write(tmp_path, f"s{scene}/{number}.png", 10 * scene + number)
    source = FolderFrames(str(tmp_path))
    more = {frame.tobytes() for frame in collect(source, TRAIN, 9, 0).frames}
    for count in range(1, 9):
        assert {frame.tobytes() for frame in collect(source, TRAIN, count, 0).frames} <= more


def test_folder_frames_explain_an_empty_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match="There is no folder"):
        FolderFrames(str(tmp_path / "none"))
    (tmp_path / "notes.txt").write_text("x")
    with pytest.raises(FileNotFoundError, match="contains no rgb frames .*other files: 1 .txt"):
        FolderFrames(str(tmp_path))
    write(tmp_path, "0.png", 0)
    with pytest.raises(ValueError, match="must come from different scenes"):
        FolderFrames(str(tmp_path)).scenes(TRAIN)


def test_source_of_requires_a_placeable_world():
    with pytest.raises(ValueError, match="its frames as PNG and use env=frames"):
        source_of(object, "rgb", {"a": LIST}, "a", None)
