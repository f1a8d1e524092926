"""Tests of corrupted copies of LeRobot datasets: frames, metadata, codecs, resuming and damaged
files."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from mitigate.corruptions import DepthSensor, Key, corrupt
from mitigate.corruptions.folders import Settings
from mitigate.corruptions.frames_command import main
from mitigate.corruptions.lerobot import copying, open_dataset, videos
from mitigate.corruptions.lerobot.dataset import rows_of
from mitigate.corruptions.lerobot.frames import read_frames
from mitigate.corruptions.lerobot.metadata import VIDEO
from tests.lerobot_files import DEPTH, FRONT, LENGTHS, WRIST, depth, rgb, write_dataset

pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")
import pyarrow.parquet as pq

SPATTER = Settings("spatter", 0.6, seed=3)
HOLES = Settings("missing_data", 0.6, seed=3)
META = ["meta/tasks.parquet", "meta/stats.json", "meta/episodes/chunk-000/file-000.parquet"]


@pytest.fixture(scope="module", params=["video", "image"])
def original(request, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp(request.param) / "cups"
    return write_dataset(folder, with_depth=True, stored=request.param)


@pytest.fixture(scope="module")
def film(tmp_path_factory) -> Path:
    return write_dataset(tmp_path_factory.mktemp("film") / "cups", cameras=(FRONT,))


def frames_of(folder: Path, camera: str) -> dict[tuple[int, int], np.ndarray]:
    """Return every frame of a camera, keyed by (episode, frame number)."""
    dataset = open_dataset(folder)
    frames = {}
    for episode, rows, _ in rows_of(dataset, list(dataset.episodes.values())):
        chosen = range(episode.length)
        cameras = [dataset.cameras[camera]]
        read = read_frames(dataset, episode, cameras, chosen, rows.times.tolist(), 1e-4)
        for number, frame in enumerate(read):
            frames[episode.index, number] = frame[camera]
    return frames


def test_read_frames_returns_the_original_pixels(original):
    frames = frames_of(original, WRIST)
    assert len(frames) == sum(LENGTHS)
    assert all(np.array_equal(frame, rgb(WRIST, *name)) for name, frame in frames.items())
    for name, metres in frames_of(original, DEPTH).items():
        millimetres = depth(*name)
        assert np.allclose(metres, millimetres / 1000, atol=2e-3)
        assert (metres[millimetres == 0] == 0).all()


def test_a_copy_holds_exactly_the_corrupted_pixels_of_every_rgb_camera(original, tmp_path):
    summary = copying.run(original, tmp_path / "out", SPATTER)
    assert summary["frames"] == 2 * sum(LENGTHS)
    for camera in (FRONT, WRIST):
        for (episode, number), frame in frames_of(tmp_path / "out", camera).items():
            key = Key(3, f"episode-{episode:06d}", number)
            clean = rgb(camera, episode, number)
            assert np.array_equal(frame, corrupt(clean, "spatter", 0.6, key=key))
    before, after = frames_of(original, DEPTH), frames_of(tmp_path / "out", DEPTH)
    assert all(np.array_equal(before[name], after[name]) for name in before)


def test_a_copy_of_depth_differs_only_where_the_corruption_changes_it(original, tmp_path):
    copying.run(original, tmp_path / "out", HOLES)
    clean = frames_of(original, DEPTH)
    tolerance = 2e-3 if open_dataset(original).cameras[DEPTH].stored == VIDEO else 1e-3
    for (episode, number), metres in frames_of(tmp_path / "out", DEPTH).items():
        before = clean[episode, number]
        key = Key(3, f"episode-{episode:06d}", number)
        expected = corrupt(before, "missing_data", 0.6, key=key, sensor=DepthSensor())
        assert np.array_equal(metres[expected == before], before[expected == before])
        assert np.allclose(metres, expected, atol=tolerance) and (expected != before).any()


def test_a_copy_keeps_metadata_and_rows(original, tmp_path):
    out = tmp_path / "out"
    copying.run(original, out, SPATTER)
    for file in (*META, "README.md"):
        assert (out / file).read_bytes() == (original / file).read_bytes()
    before, after = (json.loads((p / "meta/info.json").read_text()) for p in (original, out))
    for camera in (FRONT, WRIST):
        info = after["features"][camera].pop("info", None)
        stored = before["features"][camera]["dtype"]
        assert info == (
            {"video.codec": "h264", "video.pix_fmt": "gbrp"} if stored == VIDEO else None
        )
    assert after == before
    for number in (0, 1):
        tables = [
            pq.ParquetFile(p / f"data/chunk-000/file-00{number}.parquet") for p in (original, out)
        ]
        assert tables[0].schema_arrow.equals(tables[1].schema_arrow, check_metadata=True)
        assert tables[0].num_row_groups == tables[1].num_row_groups
        columns = ["action", "timestamp", "index", "task_index"]
        assert tables[0].read(columns).equals(tables[1].read(columns))


def test_videos_keep_the_times_of_their_frames(film, tmp_path):
    copying.run(film, tmp_path / "out", SPATTER)
    name = f"videos/{FRONT}/chunk-000/file-000.mp4"
    camera = open_dataset(film).cameras[FRONT]
    times = []
    for folder in (film, tmp_path / "out"):
        with videos.open_video(folder / name, camera) as (container, stream):
            times.append([frame.pts * stream.time_base for frame in container.decode(stream)])
            rate = stream.average_rate
            assert rate == 10
    assert times[0] == times[1] and len(times[0]) == LENGTHS[0] + LENGTHS[1]


def test_format_same_keeps_the_codec(tmp_path):
    source = write_dataset(tmp_path / "in", cameras=(FRONT,), codec="libsvtav1")
    summary = copying.run(source, tmp_path / "out", Settings("low_light", 0.6, format="same"))
    assert summary["videos"] == {FRONT: "av1 yuv420p"}
    info = json.loads((tmp_path / "out/meta/info.json").read_text())["features"][FRONT]["info"]
    assert info == {"video.codec": "av1", "video.pix_fmt": "yuv420p"}
    clean, dark = frames_of(source, FRONT), frames_of(tmp_path / "out", FRONT)
    assert all(dark[name].mean() < 0.8 * clean[name].mean() for name in clean)


def test_jpeg_becomes_png_unless_the_format_is_kept(tmp_path):
    source = write_dataset(tmp_path / "in", cameras=(FRONT,), stored="image", image_format="JPEG")
    starts = {}
    for form in ("png", "same"):
        copying.run(source, tmp_path / form, Settings("low_light", 0.6, format=form))
        table = pq.read_table(tmp_path / form / "data/chunk-000/file-000.parquet")
        starts[form] = table.column(FRONT)[0].as_py()["bytes"][:3]
    assert starts == {"png": b"\x89PN", "same": b"\xff\xd8\xff"}


def test_only_the_named_cameras_are_corrupted(original, tmp_path):
    copying.run(original, tmp_path / "out", SPATTER, [WRIST])
    frames = frames_of(tmp_path / "out", FRONT)
    assert all(np.array_equal(frame, rgb(FRONT, *name)) for name, frame in frames.items())
    changed = frames_of(tmp_path / "out", WRIST)
    assert any(not np.array_equal(frame, rgb(WRIST, *name)) for name, frame in changed.items())


def test_a_second_run_writes_only_what_is_missing_or_changed(film, tmp_path):
    out = tmp_path / "out"
    first = copying.run(film, out, SPATTER)
    (out / f"videos/{FRONT}/chunk-000/file-001.mp4").unlink()
    (out / "meta/stats.json").write_text("{}")
    second = copying.run(film, out, SPATTER)
    assert first["there"] == 0 and second["written"] == 2
    assert second["replaced"] == ["meta/stats.json"]
    assert second["there"] == first["written"] - 2
    third = copying.run(film, out, SPATTER)
    assert third["written"] == 0 and len(frames_of(out, FRONT)) == sum(LENGTHS)


def test_an_interrupted_copy_is_no_dataset_and_continues(film, tmp_path, monkeypatch):
    out = tmp_path / "out"
    second = f"videos/{FRONT}/chunk-000/file-001.mp4"
    write = copying._corrupt_video

    def stop(work, name, *rest):
        if name == second:
            raise KeyboardInterrupt
        write(work, name, *rest)

    monkeypatch.setattr(copying, "_corrupt_video", stop)
    with pytest.raises(KeyboardInterrupt):
        copying.run(film, out, SPATTER)
    assert not (out / "meta/info.json").exists()
    monkeypatch.undo()
    summary = copying.run(film, out, SPATTER)
    assert summary["written"] == 2 and len(frames_of(out, FRONT)) == sum(LENGTHS)


def test_a_folder_with_other_settings_or_content_is_rejected(film, tmp_path):
    out = tmp_path / "out"
    copying.run(film, out, SPATTER)
    with pytest.raises(ValueError, match="made with other settings: seed=3 there, seed=4 now"):
        copying.run(film, out, Settings("spatter", 0.6, seed=4))
    (tmp_path / "full").mkdir()
    (tmp_path / "full/notes.txt").write_text("mine")
    with pytest.raises(ValueError, match="must be empty or contain corrupt.json"):
        copying.run(film, tmp_path / "full", SPATTER)
    with pytest.raises(ValueError, match="must be different folders"):
        copying.run(film, film / "out", SPATTER)


@pytest.mark.parametrize(
    ("settings", "cameras", "message"),
    [
        (HOLES, None, f"missing_data corrupts depth. .* it has {FRONT} .rgb."),
        (HOLES, [FRONT], "missing_data corrupts depth"),
        (SPATTER, ["top"], f"no camera 'top'.*{FRONT}"),
        (Settings("spatter", 0.6, episode="all"), None, "episode= does not apply to the LeRobot"),
    ],
)
def test_options_that_do_not_fit_are_rejected(film, tmp_path, settings, cameras, message):
    with pytest.raises(ValueError, match=message):
        copying.run(film, tmp_path / "out", settings, cameras)
    assert not (tmp_path / "out").exists()


def test_a_video_whose_times_are_off_is_rejected_unless_the_tolerance_allows_it(film, tmp_path):
    folder = Path(copytree(film, tmp_path / "in"))
    file = folder / "meta/episodes/chunk-000/file-000.parquet"
    table = pq.read_table(file)
    name = f"videos/{FRONT}/from_timestamp"
    index = table.column_names.index(name)
    late = [value + 0.01 for value in table.column(name).to_pylist()]
    pq.write_table(table.set_column(index, name, [late]), file)
    with pytest.raises(ValueError, match=r"within 0.0001 s of 0.010000 s, for frame 0 "):
        copying.run(folder, tmp_path / "out", SPATTER)
    with pytest.raises(ValueError, match=r"frame at 0.01\d* s, .*0.01\d* s away.*tolerance="):
        frames_of(folder, FRONT)
    copying.run(folder, tmp_path / "other", SPATTER, tolerance=0.02)


@pytest.mark.parametrize("damage", ["cut", "empty", "playlist", "missing", "size"])
def test_a_damaged_video_is_named_and_nothing_half_written_stays(film, tmp_path, damage):
    folder, name = Path(copytree(film, tmp_path / "in")), f"videos/{FRONT}/chunk-000/file-000.mp4"
    file = folder / name
    if damage == "cut":
        file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    elif damage == "empty":
        file.write_bytes(b"")
    elif damage == "playlist":  # FFmpeg would open the files that the playlist names
        file.write_text(f"#EXTM3U\n#EXTINF:1,\n{film / name}\n#EXT-X-ENDLIST\n")
    elif damage == "missing":
        file.unlink()
    else:
        info = folder / "meta/info.json"
        info.write_text(info.read_text().replace("[32, 48, 3]", "[32, 64, 3]"))
    words = {"missing": "lacks the file", "size": "must have 64 x 32 pixels.*got 48 x 32"}
    with pytest.raises((ValueError, FileNotFoundError), match=words.get(damage, "cannot be decod")):
        copying.run(folder, tmp_path / "out", SPATTER)
    assert not (tmp_path / "out" / name).exists() and not (tmp_path / "out/meta/info.json").exists()


def test_an_image_that_is_not_stored_in_its_row_is_rejected(tmp_path):
    folder = write_dataset(tmp_path / "in", cameras=(FRONT,), stored="image")
    file = folder / "data/chunk-000/file-000.parquet"
    table = pq.read_table(file)
    rows = table.column(FRONT).to_pylist()
    rows[3] = {"bytes": None, "path": "/etc/passwd"}
    index = table.column_names.index(FRONT)
    pq.write_table(table.set_column(index, FRONT, [rows]), file)
    with pytest.raises(ValueError, match=f"{FRONT} of frame 3 must contain the bytes of an image"):
        copying.run(folder, tmp_path / "out", SPATTER)


def test_command_corrupts_a_dataset(film, tmp_path, capsys):
    words = [str(film), str(tmp_path / "out"), "corruption=spatter", "severity=0.6", "seed=3"]
    assert main([*words, f"cameras={FRONT}"]) == 0
    assert f"video of {FRONT}: h264 gbrp, lossless" in capsys.readouterr().out
    assert main([*words, "tolerance=high"]) == 2
    assert "tolerance must be a number" in capsys.readouterr().err


def test_command_rejects_options_of_datasets_for_a_folder_of_frames(tmp_path, capsys):
    words = [str(tmp_path), str(tmp_path / "out"), "corruption=spatter", "severity=0.6"]
    assert main([*words, "cameras=front"]) == 2
    assert "cameras applies only to a LeRobot dataset" in capsys.readouterr().err


def test_a_missing_package_is_named(film, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    with pytest.raises(ValueError, match=r"need av, which is not installed: pip install -e"):
        copying.run(film, tmp_path / "out", SPATTER)
