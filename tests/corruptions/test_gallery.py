"""The contact sheet."""

import cv2
import numpy as np
import pytest

from tools.pages import gallery


def test_sheet_has_twelve_rows_and_a_column_per_severity(tmp_path, scene):
    rgb, depth = scene.panorama_of(3, 24, 32)
    path = tmp_path / "deep" / "sheet.png"
    sheet = gallery.contact_sheet(rgb, depth, path, (0.0, 0.6), views=(0, 2))
    assert sheet.shape == (24 + 12 * 28, 150 + 2 * 68, 3)
    assert (cv2.imread(str(path))[..., ::-1] == sheet).all()
    first = sheet[24 : 24 + 24, 150 : 150 + 64]
    assert (first == np.hstack(rgb[[0, 2]])).all()


def test_gallery_command_reads_files(tmp_path, scene, capsys):
    rgb, depth = scene.draw(24, 32)
    cv2.imwrite(str(tmp_path / "rgb.png"), rgb)
    np.save(tmp_path / "depth.npy", depth)
    files = ["--rgb", str(tmp_path / "rgb.png"), "--depth", str(tmp_path / "depth.npy")]
    gallery.main(["--out", str(tmp_path / "sheet.png"), *files])
    assert "Wrote" in capsys.readouterr().out and (tmp_path / "sheet.png").is_file()


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".JPEG"])
def test_sheet_is_written_without_a_warning(suffix, tmp_path, scene, capfd):
    gallery.contact_sheet(*scene.draw(24, 32), tmp_path / f"sheet{suffix}", (0.0,))
    assert (tmp_path / f"sheet{suffix}").is_file() and "key" not in capfd.readouterr().err


@pytest.mark.parametrize(
    ("depth", "out", "part"),
    [
        ("rgb.png", "sheet.png", "rgb.png is not a complete .npy file"),
        ("empty.npy", "sheet.png", "empty.npy is not a complete .npy file"),
        ("gone.npy", "sheet.png", "There is no file"),
        ("mm.npy", "sheet.png", "If it is in millimetres"),
        ("depth.npy", "sheet.gif", "must end in .png"),
    ],
)
def test_gallery_error_ends_in_one_line(depth, out, part, tmp_path, scene, capsys):
    rgb, metres = scene.draw(24, 32)
    cv2.imwrite(str(tmp_path / "rgb.png"), rgb)
    np.save(tmp_path / "depth.npy", metres)
    np.save(tmp_path / "mm.npy", 1000 * metres)
    (tmp_path / "empty.npy").touch()
    files = ["--rgb", str(tmp_path / "rgb.png"), "--depth", str(tmp_path / depth)]
    with pytest.raises(SystemExit) as stop:
        gallery.main(["--out", str(tmp_path / out), *files])
    text = capsys.readouterr().err
    assert stop.value.code == 2 and text.startswith("error: ") and text.count("\n") == 1
    assert part in text and not (tmp_path / out).exists()


def test_bad_files_are_named(tmp_path, scene):
    with pytest.raises(FileNotFoundError, match=r"no file .*rgb\.png"):
        gallery.read_frame(tmp_path / "rgb.png", tmp_path / "depth.npy")
    rgb, depth = scene.draw(24, 32)
    with pytest.raises(ValueError, match="must have the same number of views"):
        gallery.contact_sheet(rgb, depth[:-1], tmp_path / "sheet.png")
    with pytest.raises(SystemExit):
        gallery.main(["--out", "x.png", "--rgb", "only.png"])
    for name in ("sheet", "sheet.gif", "sheet.bmp"):
        with pytest.raises(ValueError, match=r"must end in \.png or \.jpg or \.jpeg"):
            gallery.contact_sheet(rgb, depth, tmp_path / name)
    cv2.imwrite(str(tmp_path / "rgb.png"), rgb)
    np.save(tmp_path / "depth.npy", (1000 * depth).astype(np.uint16))
    with pytest.raises(ValueError, match="uint16, not metres"):
        gallery.read_frame(tmp_path / "rgb.png", tmp_path / "depth.npy")


@pytest.mark.slow
def test_page_holds_every_corruption_and_its_pictures(tmp_path, monkeypatch):
    monkeypatch.setattr(gallery, "PAGE_SIZE", 32)
    gallery.write_page(tmp_path, np.array([0.0, 0.5, 1.0]))
    text = (tmp_path / "corruptions.md").read_text()
    assert all(text.count(f"| `{name}` |") == 2 for name in gallery.NAMES)
    unseen = (tmp_path / "unseen-corruptions.md").read_text()
    assert all(unseen.count(f"| `{name}` |") == 2 for name in gallery.SHEETS["unseen"])
    for picture in (
        *("corruptions.jpg", "severity-curves.png"),
        *("unseen-validation.jpg", "unseen-test.jpg", "unseen-curves.png"),
    ):
        assert f"pictures/{picture}" in text + unseen
        assert cv2.imread(str(tmp_path / "pictures" / picture)) is not None


def test_sheet_of_unseen_corruptions_has_a_row_for_each(tmp_path, scene, monkeypatch):
    frames = tuple(np.stack([frame]) for frame in scene.draw(24, 32))
    monkeypatch.setattr(
        gallery, "rendered_frame", lambda seed, size: (frames[0], frames[1][..., None])
    )
    assert set(gallery.SHEETS["unseen"]) == {
        *gallery.SHEETS["unseen_val"],
        *gallery.SHEETS["unseen_test"],
    }
    for suite in ("full", "unseen_val"):
        gallery.main(["--out", str(tmp_path / f"{suite}.png"), "--suite", suite])
        height = cv2.imread(str(tmp_path / f"{suite}.png")).shape[0]
        assert height == 24 + 28 * len(gallery.SHEETS[suite])


def test_documented_formulas_match_the_code():
    """After changing a constant: ``python -m tools.pages.gallery --page``."""
    text = (gallery.DOCS / "corruptions.md").read_text()
    assert gallery.page.formulas() in text and gallery.page.suites() in text
    text = (gallery.DOCS / "unseen-corruptions.md").read_text()
    assert all(gallery.unseen_page.table(half) in text for half in gallery.unseen_page.PICTURES)
