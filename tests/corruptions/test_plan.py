"""Test which files in a folder count as frames: links to files and folders are followed."""

import os
import shutil
import time

import numpy as np
import pytest
from PIL import Image

from mitigate.core.output import FolderLostError
from mitigate.corruptions import folders
from mitigate.corruptions.folders import Settings, run
from mitigate.corruptions.frame_files import make_plan


@pytest.fixture
def walk(tmp_path):
    """Write a folder ``in`` with links to its subfolder ``a``, itself, ``elsewhere`` and ``out``.

    The folder ``elsewhere`` contains a link to itself.
    """
    for number, path in enumerate(("in/a/0", "in/a/1", "in/b/0", "elsewhere/0", "elsewhere/c/0")):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        frame = np.full((8, 8, 3), 20 * number, np.uint8)
        Image.fromarray(frame).save(tmp_path / f"{path}.png")
    (tmp_path / "out").mkdir()
    for link, target in (
        ("in/linked", "elsewhere"),
        ("in/again", "in/a"),
        ("in/b/up", "in"),
        ("elsewhere/c/round", "elsewhere"),
        ("in/results", "out"),
    ):
        (tmp_path / link).symlink_to(tmp_path / target, target_is_directory=True)
    return tmp_path


def test_links_are_followed_except_cycles_and_results(walk):
    # ``in/results`` links to the output folder, which contains files in the second run
    for saved in (7, 0):
        matches = run(walk / "in", walk / "out", Settings("spatter", 0.6))
        assert matches["written"] == saved and matches["there"] == 7 - saved
        assert {name: e["frames"] for name, e in matches["episodes"].items()} == {
            "a": 2, "again": 2, "b": 1, "linked": 1, "linked/c": 1,
        }  # fmt: skip
        assert {e["file"]: e["reason"] for e in matches["left_out"]} == {
            "b/up/": "links back to a folder that contains it",
            "linked/c/round/": "links back to a folder that contains it",
            "results/": "is the folder of the results",
        }
    assert (walk / "out/linked/c/0.png").is_file() and not (walk / "out/linked").is_symlink()


def test_pipe_is_skipped_with_a_reason(walk):
    for name in ("0.5.png", "2.jpg", "3.npy"):
        os.mkfifo(walk / "in/a" / name)
    matches = run(walk / "in/a", walk / "out", Settings("spatter", 0.6))
    assert matches["written"] == 2
    left_out = {e["file"]: e["reason"] for e in matches["left_out"]}
    assert left_out == dict.fromkeys(("0.5.png", "2.jpg", "3.npy"), "is not a regular file")


@pytest.mark.parametrize("lost", ["out", "out/a"])
def test_run_notices_a_lost_folder(walk, monkeypatch, lost):
    write, saved = folders.write_bytes, []

    def write_and_lose(path, data):
        if path.name == "0.png" and path.parent.name == "b":
            shutil.rmtree(walk / lost)
        write(path, data)
        saved.append(path)

    monkeypatch.setattr(folders, "write_bytes", write_and_lose)
    with pytest.raises(FolderLostError, match="removed or replaced .* run the same command again"):
        run(walk / "in", walk / "out", Settings("spatter", 0.6))
    assert not (walk / lost).exists()


def test_run_rejects_a_link_among_its_results(walk):
    (walk / "out/a").symlink_to(walk / "elsewhere")
    saved = (walk / "elsewhere/0.png").read_bytes()
    with pytest.raises(
        ValueError, match="out/a must be a folder|must be empty or contain corrupt.json"
    ):
        run(walk / "in", walk / "out", Settings("spatter", 0.6))
    assert (walk / "elsewhere/0.png").read_bytes() == saved


def test_plan_of_nested_folders_takes_no_cubic_time(tmp_path):
    """Issue T2, item 9."""
    (tmp_path / "in").mkdir()
    here = os.open(tmp_path / "in", os.O_RDONLY)
    for _ in range(500):
        os.mkdir("d", dir_fd=here)
        inner = os.open("d", os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = inner
    os.close(here)
    began = time.monotonic()
    assert make_plan(tmp_path / "in", None, ["rgb"], "folder").frames == []
    assert time.monotonic() - began < 10
