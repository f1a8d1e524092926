"""Tests of ``python -m mitigate.corrupt``, which corrupts folders of frames."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mitigate.core import files
from mitigate.corruptions import DepthSensor, Key, corrupt, folders, registry
from mitigate.corruptions import frames_command as program

ROOT = Path(__file__).parents[2]
SPATTER = ("corruption=spatter", "severity=0.6")
rng = np.random.default_rng(0)
RGB = [rng.integers(0, 255, (24, 32, 3), dtype=np.uint8) for _ in range(12)]
COUNTS = [rng.integers(400, 9000, (24, 32), dtype=np.uint16) for _ in range(3)]
for counts in COUNTS:
    counts[:4, :4] = 0


def save(path: Path, pixels: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".npy":
        np.save(path, pixels)
    else:
        Image.fromarray(pixels).save(path)


def read(path: Path) -> np.ndarray:
    if path.suffix == ".npy":
        return np.load(path)
    with Image.open(path) as image:
        return np.array(image)


@pytest.fixture
def run(tmp_path, capsys):
    """Call the program on tmp_path/in and tmp_path/out; return (status, stdout, stderr)."""

    def call(*options, source="in", out="out"):
        status = program.main([str(tmp_path / source), str(tmp_path / out), *options])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return call


@pytest.fixture
def walk(tmp_path):
    """Write two folders of RGB PNG files; the names in the first are not padded with zeros."""
    for number in range(12):
        save(tmp_path / f"in/a/frame{number}.png", RGB[number])
    save(tmp_path / "in/b/c/0.png", RGB[0])
    return tmp_path


def complaint(result) -> str:
    status, out, err = result
    assert status == 2 and out == "" and err.startswith("corrupt: ") and err.count("\n") == 1
    return err


def summary(folder: Path) -> dict:
    return json.loads((folder / "corrupt.json").read_text())


def test_every_frame_equals_the_suites_output(run, walk):
    status, out, err = run("corruption=low_light_noise", "severity=0.7", "seed=3")
    assert status == 0 and "13 frames written" in out
    # frames are numbered in natural order, so frame10 is number 10 and not 2
    for number in range(12):
        key = Key(3, "a", number)
        expected = corrupt(RGB[number], "low_light_noise", 0.7, key=key)
        assert np.array_equal(read(walk / f"out/a/frame{number}.png"), expected)
    expected = corrupt(RGB[0], "low_light_noise", 0.7, key=Key(3, "b/c", 0))
    assert np.array_equal(read(walk / "out/b/c/0.png"), expected)
    matches = summary(walk / "out")
    assert matches["written"] == 13 and matches["left_out"] == []
    assert (
        matches["settings"]["corruption"] == "low_light_noise" and matches["settings"]["seed"] == 3
    )
    assert matches["episodes"]["a"]["frames"] == 12


def test_all_frames_can_be_one_episode(run, walk):
    assert run("corruption=low_light_noise", "severity=0.7", "episode=all")[0] == 0
    expected = corrupt(RGB[0], "low_light_noise", 0.7, key=Key(0, "all", 12))
    assert np.array_equal(read(walk / "out/b/c/0.png"), expected)


def test_same_command_resumes_and_appends_new_frames(run, walk):
    run(*SPATTER)
    again = walk / "out/b/c/0.png"
    whole = again.read_bytes()
    again.unlink()
    save(walk / "in/a/frame12.png", RGB[3])
    status, out, _ = run(*SPATTER)
    assert status == 0 and "2 frames written" in out and "12 already existed" in out
    assert again.read_bytes() == whole
    expected = corrupt(RGB[3], "spatter", 0.6, key=Key(0, "a", 12))
    assert np.array_equal(read(walk / "out/a/frame12.png"), expected)


def test_other_settings_or_frames_in_a_folder_are_rejected(run, walk):
    run(*SPATTER)
    text = complaint(run("corruption=spatter", "severity=0.5"))
    assert "severity=0.6 there, severity=0.5 now" in text and "Name another folder" in text
    save(walk / "in/a/frame1b.png", RGB[3])
    assert "among the first 12 frames of episode 'a'" in complaint(run(*SPATTER))
    (walk / "in/a/frame1b.png").unlink()
    assert run(*SPATTER)[0] == 0
    (walk / "out/corrupt.json").write_text('{"settings": 3}')
    assert "corrupt.json is damaged" in complaint(run(*SPATTER))
    (walk / "out/corrupt.json").unlink()
    assert "must be empty or contain corrupt.json, which this program writes" in complaint(
        run(*SPATTER)
    )


def test_16_bit_depth_is_in_millimetres_unless_said_otherwise(run, tmp_path):
    for number, counts in enumerate(COUNTS):
        save(tmp_path / f"in/{number}.png", counts)
    assert run("corruption=gaussian_noise", "severity=0.8")[0] == 0
    for number, counts in enumerate(COUNTS):
        out = read(tmp_path / f"out/{number}.png")
        metres = (counts * 0.001).astype(np.float32)
        expected = corrupt(metres, "gaussian_noise", 0.8, key=Key(0, ".", number))
        assert out.dtype == np.uint16 and out.shape == counts.shape
        assert (out[counts == 0] == 0).all() and (out[counts > 0] > 0).all()
        np.testing.assert_allclose(out * 0.001, expected, atol=0.00051)
        assert not np.array_equal(out, counts)
    assert run("corruption=quantization", "severity=1", "unit=0.00025", out="fine")[0] == 0
    assert set(np.unique(read(tmp_path / "fine/0.png"))) <= {0, 4} | {2000 * n for n in range(9)}


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, ">f4"])
def test_npy_depth_is_in_metres_and_keeps_its_kind(run, tmp_path, dtype):
    depth = (COUNTS[0][..., None] / 1000.0).astype(dtype)
    depth[0, :5, 0] = np.nan, np.inf, -np.inf, -1.0, 0.0
    save(tmp_path / "in/x.npy", depth)
    assert run("corruption=missing_data", "severity=1", "missing=10", "z_max=9.5")[0] == 0
    out = read(tmp_path / "out/x.npy")
    sensor = DepthSensor(z_max=9.5, missing=10.0)
    metres = depth.astype(np.float32)
    expected = corrupt(metres, "missing_data", 1.0, key=Key(0, ".", 0), sensor=sensor)
    assert out.dtype == depth.dtype and out.shape == depth.shape
    assert np.array_equal(out.astype(np.float32), expected, equal_nan=True)
    assert out[0, :5].tobytes() == depth[0, :5].tobytes()
    assert np.array_equal(out[expected == metres], depth[expected == metres])


def test_jpeg_becomes_png_or_stays_jpeg(run, tmp_path):
    save(tmp_path / "in/x.JPG", RGB[0])
    decoded = read(tmp_path / "in/x.JPG")
    expected = corrupt(decoded, "spatter", 0.6, key=Key(0, ".", 0))
    assert run(*SPATTER)[0] == 0
    assert np.array_equal(read(tmp_path / "out/x.png"), expected)
    assert run(*SPATTER, "format=same", out="same")[0] == 0
    with Image.open(tmp_path / "same/x.JPG") as image:
        assert image.format == "JPEG"
        assert np.abs(np.array(image).astype(int) - expected).mean() < 8


def test_jpeg_is_rotated_by_its_exif_data(run, tmp_path):
    (tmp_path / "in").mkdir()
    exif = Image.Exif()
    exif[0x0112] = 6  # the image is rotated by 90 degrees
    Image.fromarray(RGB[0]).save(tmp_path / "in/x.jpg", exif=exif)
    assert run("corruption=spatter", "severity=0")[0] == 0
    decoded = read(tmp_path / "in/x.jpg")
    assert np.array_equal(read(tmp_path / "out/x.png"), np.rot90(decoded, -1))


def test_two_files_never_share_an_output(run, tmp_path):
    save(tmp_path / "in/x.png", RGB[0])
    save(tmp_path / "in/x.jpg", RGB[1])
    status, _, err = run(*SPATTER)
    assert status == 1 and "left out: x.jpg would become x.png" in err
    assert np.array_equal(
        read(tmp_path / "out/x.png"), corrupt(RGB[0], "spatter", 0.6, key=Key(0, ".", 1))
    )


def test_corrupt_reports_a_png_added_next_to_a_jpeg(run, tmp_path):
    save(tmp_path / "in/x.jpg", RGB[1])
    run(*SPATTER)
    save(tmp_path / "in/x.png", RGB[0])
    status, _, err = run(*SPATTER)
    assert status == 1 and "x.jpg would become x.png, which exists" in err
    assert "1 frames differed from the results of this command" in err


def test_files_that_are_left_alone_are_counted_by_suffix(run, walk):
    for name in ("y.webp", "x.TIF", "x.tif", "LICENSE"):
        (walk / "in/a" / name).write_bytes(b"x")
    status, out, _ = run(*SPATTER)
    assert status == 0 and "other files not read: 2 .tif, 1 without suffix, 1 .webp" in out
    save(walk / "scans/0.tif", RGB[0])
    text = complaint(run(*SPATTER, source="scans", out="new"))
    assert "no rgb frame" in text and "not read: 1 .tif" in text and "PNG or JPEG" in text


def test_bad_files_are_skipped_and_keep_their_number(run, tmp_path):
    folder = tmp_path / "in"
    save(folder / "0.png", RGB[0])
    save(folder / "1.png", RGB[1])
    os.truncate(folder / "1.png", 900)
    save(folder / "2.png", np.dstack([RGB[0], RGB[0][..., :1]]))
    save(folder / "3.jpg", RGB[0])
    os.truncate(folder / "3.jpg", 700)
    save(folder / "4.png", RGB[0][..., 0])
    (folder / "5.png").write_bytes(b"")
    save(folder / "6.jpg", RGB[0][..., 0])
    save(folder / "7.png", RGB[7])
    (folder / "8.png").symlink_to(folder / "gone.png")
    save(folder / "depth.png", COUNTS[0])
    (folder / ".hidden.png").write_bytes(b"x")
    (folder / "notes.txt").write_text("x")
    status, out, err = run("corruption=low_light_noise", "severity=0.5")
    assert status == 1 and "2 frames written" in out and "1 of the other modality" in out
    assert "7 files left out" in err
    matches = summary(tmp_path / "out")
    reasons = {entry["file"]: entry["reason"] for entry in matches["left_out"]}
    for name, part in {
        "1.png": "cannot be decoded",
        "2.png": "8-bit RGB with alpha PNG: an RGB frame must be 8-bit RGB without",
        "3.jpg": "cannot be decoded",
        "4.png": "8-bit grey PNG",
        "5.png": "truncated",
        "6.jpg": "has the colour mode L",
        "8.png": "cannot be read",
    }.items():
        assert part in reasons.pop(name)
    assert not reasons and matches["other_modality"] == 1 and matches["other_files"] == {".txt": 1}
    expected = corrupt(RGB[7], "low_light_noise", 0.5, key=Key(0, ".", 7))
    assert np.array_equal(read(tmp_path / "out/7.png"), expected)
    output = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert output == ["0.png", "7.png", "corrupt.json"]


def test_bad_depth_is_left_out_and_never_unpickled(run, tmp_path):
    folder = tmp_path / "in"
    save(folder / "0.npy", np.full((8, 8), 2, np.float32))
    np.save(folder / "1.npy", np.array([print], object), allow_pickle=True)
    save(folder / "2.npy", np.ones((8, 8), np.uint16))
    save(folder / "3.npy", np.ones(8, np.float32))
    save(folder / "4.npy", np.ones((8, 8), np.float32))
    os.truncate(folder / "4.npy", 200)
    save(folder / "5.npy", np.full((8, 8), np.nan, np.float32))
    assert run("corruption=multipath", "severity=0.5")[0] == 1
    reasons = {e["file"]: e["reason"] for e in summary(tmp_path / "out")["left_out"]}
    assert list(reasons) == ["1.npy", "2.npy", "3.npy", "4.npy"]
    assert "allow_pickle" in reasons["1.npy"] and "must be floating-point" in reasons["2.npy"]
    assert "Depth must be [H, W]" in reasons["3.npy"] and "cannot be loaded" in reasons["4.npy"]
    assert np.isnan(read(tmp_path / "out/5.npy")).all()


def test_depth_in_another_unit_is_left_out(run, tmp_path):
    save(tmp_path / "in/0.png", COUNTS[0])
    save(tmp_path / "in/1.npy", np.full((8, 8), 2500, np.float32))
    save(tmp_path / "in/2.npy", np.full((8, 8), 2.5, np.float32))
    status, out, err = run("corruption=missing_data", "severity=0.6", "unit=m")
    assert status == 1 and "1 frames written" in out and "unit=mm" in err
    reasons = {e["file"]: e["reason"] for e in summary(tmp_path / "out")["left_out"]}
    assert list(reasons) == ["0.png", "1.npy"] and "median 2500" in reasons["1.npy"]
    assert not (tmp_path / "out/0.png").exists()


def test_interrupted_run_leaves_whole_files_only(run, walk, monkeypatch):
    real, calls = os.replace, []

    def full(source, target):
        calls.append(target)
        if len(calls) > 4:
            raise OSError(28, "No space left on device")
        real(source, target)

    monkeypatch.setattr(files.os, "replace", full)
    text = complaint(run(*SPATTER))
    assert "Cannot write" in text and "No space left on device" in text
    left = sorted(path.name for path in (walk / "out").rglob("*") if path.is_file())
    assert left == ["corrupt.json", "frame0.png", "frame1.png", "frame2.png"]
    monkeypatch.undo()
    status, out, _ = run(*SPATTER)
    assert status == 0 and "10 frames written" in out and "3 already existed" in out


def test_folders_that_cannot_work_are_explained(run, walk):
    (walk / "file").write_text("x")
    (walk / "empty").mkdir()
    assert "There is no folder" in complaint(run(*SPATTER, source="gone"))
    assert "must be a folder, got a file" in complaint(run(*SPATTER, source="file"))
    assert "is a file" in complaint(run(*SPATTER, out="file"))
    assert "Cannot write" in complaint(run(*SPATTER, out="file/under"))
    for source, out in (("in", "in"), ("in", "in/out"), ("in/a", "in"), ("in", "empty/../in/x")):
        text = complaint(run(*SPATTER, source=source, out=out))
        assert "neither may contain the other" in text
    assert "There is no rgb frame" in complaint(run(*SPATTER, source="empty"))
    text = complaint(run("corruption=multipath", "severity=1"))
    assert "There is no depth frame" in text and "13 frames are of the other modality" in text
    assert not (walk / "out").exists()


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (("corruption=spater", "severity=0.5"), "Did you mean spatter"),
        (
            ("corruption=mask", "severity=0.5"),
            "Corrupt instructions with mitigate corrupt_episodes",
        ),
        ((*SPATTER, "missing=-7"), "missing must be 0 (no reading) or a depth in metres, got -7"),
        ((*SPATTER, "missing=nan"), "0 (no reading) or a depth"),
        (("corruption=spatter", "severity=1.2"), "from 0 (clean) to 1 (worst), got 1.2"),
        (("corruption=spatter", "severity=much"), "severity must be a number, got much"),
        (("corruption=spatter", "severity=nan"), "from 0 (clean) to 1"),
        (("corruption=spatter",), "option severity= is missing"),
        (("severity=0.5",), "option corruption= is missing"),
        ((*SPATTER, "sed=3"), "Did you mean seed?"),
        ((*SPATTER, "seed=1.5"), "seed must be a whole number"),
        ((*SPATTER, "unit=inch"), "a number or one of mm, cm, m"),
        ((*SPATTER, "unit=-1"), "metres per count"),
        ((*SPATTER, "episode=frame"), "episode must be one of folder, all"),
        ((*SPATTER, "format=jpg"), "format must be one of png, same"),
        ((*SPATTER, "z_max=0"), "must be 0 <= z_min < z_max"),
        ((*SPATTER, "--seed=3"), "There is no option --seed=3"),
        ((*SPATTER, "third"), "got 3"),
    ],
    ids=str,
)
def test_wrong_options_are_explained(run, walk, options, part):
    assert part in complaint(run(*options))
    assert not (walk / "out").exists()


def test_unit_too_small_for_the_range_is_rejected(run, tmp_path):
    save(tmp_path / "in/0.png", COUNTS[0])
    text = complaint(run("corruption=multipath", "severity=1", "unit=0.0001"))
    assert "to fit into a 16-bit PNG" in text and "z_max=6.5534" in text


def test_list_names_every_corruption(capsys):
    assert program.main(["--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    listed = [*registry.known("rgb", "depth"), *registry.fault_names("temporal", "camera")]
    assert [line.split()[0] for line in lines[1:]] == listed
    assert not [line for line in lines if len(line) > 180]


def test_help_names_every_option(capsys):
    assert program.main(["--help"]) == 0
    out = capsys.readouterr().out
    for name in program.Settings.__dataclass_fields__:
        assert f"\n  {name} " in out
    assert program.main([]) == 2


def test_corrupt_starts_without_torch():
    code = (
        "import sys, mitigate.corruptions.frames_command as c; c.main(['--list']); "
        "sys.exit(any(m in sys.modules for m in ('torch', 'hydra', 'torchrl')))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, check=False)
    assert run.returncode == 0, run.stderr


def test_corrupt_rejects_a_fifo_in_place_of_its_summary(run, walk):
    (walk / "out").mkdir()
    os.mkfifo(walk / "out" / "corrupt.json")
    message = complaint(run("corruption=spatter", "severity=0.5"))
    assert "corrupt.json must be a regular file, got a FIFO" in message


def damage_by_truncation(walk: Path) -> None:
    os.truncate(walk / "out/a/frame3.png", 100)


def damage_by_emptying(walk: Path) -> None:
    (walk / "out/a/frame3.png").write_bytes(b"")


def damage_by_swapping(walk: Path) -> None:
    one, other = walk / "out/a/frame3.png", walk / "out/a/frame4.png"
    first, second = one.read_bytes(), other.read_bytes()
    one.write_bytes(second)
    other.write_bytes(first)


def damage_by_a_clean_copy(walk: Path) -> None:
    (walk / "out/a/frame3.png").write_bytes((walk / "in/a/frame3.png").read_bytes())


DAMAGES = [
    damage_by_truncation,
    damage_by_emptying,
    damage_by_swapping,
    damage_by_a_clean_copy,
]


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*.png")}


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_corrupt_writes_changed_output_frames_again(run, walk, damage):
    run(*SPATTER)
    whole = contents(walk / "out")
    damage(walk)
    count = 2 if damage is damage_by_swapping else 1
    status, out, err = run(*SPATTER)
    assert status == 0 and contents(walk / "out") == whole
    assert f"{count} frames written" in out and f"{13 - count} already existed" in out
    assert f"{count} frames differed from the results of this command" in err
    assert "a/frame3.png" in err
    matches = summary(walk / "out")
    assert len(matches["replaced"]) == count and len(matches["checksums"]) == 13
    assert run(*SPATTER)[1].startswith("0 frames written")


def test_corrupt_writes_a_frame_again_whose_input_changed(run, walk):
    run(*SPATTER)
    save(walk / "in/a/frame3.png", RGB[7])
    assert "1 frames written" in run(*SPATTER)[1]
    expected = corrupt(RGB[7], "spatter", 0.6, key=Key(0, "a", 3))
    assert np.array_equal(read(walk / "out/a/frame3.png"), expected)


def test_corrupt_keeps_the_checksums_of_an_interrupted_run(run, walk, monkeypatch):
    real, calls = folders.write_bytes, []

    def interrupt(path, data):
        calls.append(path)
        if len(calls) == 4:
            raise KeyboardInterrupt
        real(path, data)

    monkeypatch.setattr(folders, "write_bytes", interrupt)
    assert run(*SPATTER)[0] == 130
    monkeypatch.undo()
    assert len(summary(walk / "out")["checksums"]) == 3
    status, out, _ = run(*SPATTER)
    assert status == 0 and "10 frames written" in out and "3 already existed" in out


def test_corrupt_rejects_checksums_of_another_form(run, walk):
    run(*SPATTER)
    content = summary(walk / "out")
    (walk / "out/corrupt.json").write_text(json.dumps({**content, "checksums": ["x"]}))
    assert "corrupt.json is damaged" in complaint(run(*SPATTER))


def test_corrupt_rejects_a_fifo_in_place_of_a_frame(run, walk):
    run(*SPATTER)
    (walk / "out/a/frame3.png").unlink()
    os.mkfifo(walk / "out/a/frame3.png")
    assert "frame3.png must be a regular file, got a FIFO" in complaint(run(*SPATTER))


def test_depth_that_is_too_close_is_reported(run, tmp_path):
    save(tmp_path / "in/0.png", np.full((24, 32), 3, np.uint16))
    status, _, err = run("corruption=missing_data", "severity=0.5")
    assert status == 2 and "the largest reading is 0.003 m. Set unit=" in err
    assert run("corruption=missing_data", "severity=0.5", "unit=m")[0] == 0
