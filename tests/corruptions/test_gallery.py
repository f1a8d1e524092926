"""The contact sheet."""

import cv2
import numpy as np
import pytest

from tools.pages import gallery


@pytest.mark.parametrize("suffix", [".png", ".JPEG"])
def test_sheet_has_twelve_rows_and_a_column_per_severity(suffix, tmp_path, scene, capfd):
    rgb, depth = scene.draw(24, 32)
    path = tmp_path / "deep" / f"sheet{suffix}"
    sheet = gallery.contact_sheet(rgb, depth[..., None], path)
    assert sheet.shape == (24 + 12 * 28, 150 + 5 * 36, 3)
    assert (sheet[24 : 24 + 24, 150 : 150 + 32] == rgb).all()
    written = cv2.imread(str(path))[..., ::-1]
    assert written.shape == sheet.shape and (suffix != ".png" or (written == sheet).all())
    assert "key" not in capfd.readouterr().err


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
