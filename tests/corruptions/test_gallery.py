"""The contact sheet."""

import cv2
import numpy as np
import pytest

from mitigate.corruptions import gallery


def test_a_sheet_shows_twelve_rows_and_a_column_for_each_severity(tmp_path, scene):
    rgb, depth = scene.panorama_of(3, 24, 32)
    path = tmp_path / "deep" / "sheet.png"
    sheet = gallery.contact_sheet(rgb, depth, path, (0.0, 0.6), views=(0, 2))
    assert sheet.shape == (24 + 12 * 28, 150 + 2 * 68, 3)
    assert (cv2.imread(str(path))[..., ::-1] == sheet).all()
    first = sheet[24 : 24 + 24, 150 : 150 + 64]
    assert (first == np.hstack(rgb[[0, 2]])).all()


def test_the_command_reads_files(tmp_path, scene, capsys):
    rgb, depth = scene.draw(24, 32)
    cv2.imwrite(str(tmp_path / "rgb.png"), rgb)
    np.save(tmp_path / "depth.npy", depth)
    files = ["--rgb", str(tmp_path / "rgb.png"), "--depth", str(tmp_path / "depth.npy")]
    gallery.main(["--out", str(tmp_path / "sheet.png"), *files])
    assert "Wrote" in capsys.readouterr().out and (tmp_path / "sheet.png").is_file()


def test_bad_files_are_named(tmp_path, scene):
    with pytest.raises(FileNotFoundError, match=r"no file .*rgb\.png"):
        gallery.read_frame(tmp_path / "rgb.png", tmp_path / "depth.npy")
    rgb, depth = scene.draw(24, 32)
    with pytest.raises(ValueError, match="not of the same instant"):
        gallery.contact_sheet(rgb, depth[:-1], tmp_path / "sheet.png")
    with pytest.raises(SystemExit):
        gallery.main(["--out", "x.png", "--rgb", "only.png"])
