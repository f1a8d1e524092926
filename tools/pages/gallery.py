"""Create a contact sheet of the corruptions, and write the pages of the documentation.

    python -m tools.pages.gallery --out sheet.png
    python -m tools.pages.gallery --out sheet.png --suite unseen
    python -m tools.pages.gallery --page

The sheet shows every corruption at several severities on one frame, which is rendered from an
apartment. ``--page`` writes ``docs/corruptions.md`` and ``docs/unseen-corruptions.md`` with their
pictures.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from mitigate.core.files import write_bytes
from mitigate.core.observation import DEPTH, Z_MAX
from mitigate.core.observation import RGB as RGB_ENTRY
from mitigate.core.pictures import depth_picture
from mitigate.corruptions import registry
from mitigate.corruptions.broad import composition
from mitigate.corruptions.broad import depth as broad_depth
from mitigate.corruptions.broad import rgb as broad_rgb
from mitigate.corruptions.keying import Key
from mitigate.corruptions.record import TEST, VALIDATION
from mitigate.corruptions.suite import NAMES, corrupt
from tools.pages import corruptions as page
from tools.pages import curves
from tools.pages import unseen_corruptions as unseen_page

SEVERITIES = (0.0, 0.25, 0.5, 0.75, 1.0)
GUTTER, TITLE, LABEL = 4, 24, 150  # sizes in pixels: gap between cells, column titles, row labels
LINE = 16  # line height of a label in pixels
JPEG_QUALITY = 88
# a dark sheet suits the light and the dark mode of the site
PAPER, INK = (33, 37, 43), (235, 235, 235)
DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE_SEED, PAGE_SIZE = 200021, 112  # the apartment and the view size in pixels for the page
CURVE_VIEWS = slice(0, 12, 3)  # views of the panorama that are used for the curves
BOTH = ("rgb", "depth")
SHEETS = {  # the corruptions on the sheet of each suite
    "full": NAMES,
    "unseen": registry.unseen_names(*BOTH),
    "unseen_val": registry.unseen_names(*BOTH, half=VALIDATION),
    "unseen_test": registry.unseen_names(*BOTH, half=TEST),
    "broad": tuple(name for name in registry.BROAD for _ in range(8)),  # samples of each
}


def _cell(rgb: np.ndarray, depth: np.ndarray, name: str, severity: float, key: Key) -> np.ndarray:
    """Return the corrupted view as uint8 RGB."""
    if registry.modality(name) == "rgb":
        return corrupt(rgb[None], name, severity, key=key)[0]
    far = float(np.max(depth, initial=0.0, where=np.isfinite(depth))) or Z_MAX
    return depth_picture(corrupt(depth[None], name, severity, key=key)[0, ..., 0], far)


def _write(sheet: np.ndarray, text: str, x: int, y: int) -> None:
    cv2.putText(sheet, text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 0.45, INK, 1, cv2.LINE_AA)


def contact_sheet(
    rgb: np.ndarray, depth: np.ndarray, path: Path, names: tuple[str, ...] = NAMES
) -> np.ndarray:
    """Write a picture with corruptions as rows and ``SEVERITIES`` as columns.

    Args:
        rgb: RGB frame of one view, uint8 [H, W, 3].
        depth: Depth of the same view in metres, float32 [H, W, 1].
        path: File of the picture (.png, .jpg, .jpeg). Missing parent folders are created.
        names: Corruptions of the rows. Repeated names get different keys, so that their rows
            differ.

    Returns:
        The picture, uint8 RGB.
    """
    key = Key(0, "contact sheet")
    high, wide = rgb.shape[0] + GUTTER, rgb.shape[1] + GUTTER
    shape = (TITLE + high * len(names), LABEL + wide * len(SEVERITIES), 3)
    sheet = np.full(shape, PAPER, np.uint8)
    for column, severity in enumerate(SEVERITIES):
        _write(sheet, f"s = {severity:g}", LABEL + column * wide, TITLE - 8)
    for row, name in enumerate(names):
        top, again = TITLE + row * high, names[:row].count(name)
        drawn = replace(key, episode=f"{key.episode} {again}") if again else key
        lines = [name, *primitives(name, drawn)] if name in registry.BROAD else [name]
        for place, line in enumerate(lines):
            _write(sheet, line, 6, top + high // 2 + LINE * place - LINE * (len(lines) - 1) // 2)
        for column, severity in enumerate(SEVERITIES):
            cell = _cell(rgb, depth, name, severity, drawn)
            left = LABEL + column * wide
            sheet[top : top + cell.shape[0], left : left + cell.shape[1]] = cell
    suffix = path.suffix.lower()
    quality = [] if suffix == ".png" else [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
    _, encoded = cv2.imencode(suffix, sheet[..., ::-1], quality)
    write_bytes(path, encoded.tobytes())
    return sheet


def primitives(name: str, key: Key) -> list[str]:
    """Return the primitives that ``broad_rgb`` or ``broad_depth`` applies in this episode."""
    module = {"broad_rgb": broad_rgb, "broad_depth": broad_depth}[name]
    chosen, _ = composition.drawn(key, name, module.PRIMITIVES)
    return [primitive.__name__.replace("_", " ") for primitive in chosen]


def rendered_frame(seed: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return RGB [12, H, W, 3] and depth [12, H, W, 1] at the start of an episode in apartment
    ``seed``.
    """
    from mitigate.worlds.apartments.apartment import Apartment
    from mitigate.worlds.apartments.simulator import Simulator
    from mitigate.worlds.apartments.tasks import make_episode

    simulator = Simulator(size=size)
    simulator.reset(make_episode(Apartment(seed), "vln", 0))
    observation = simulator.observe()
    return observation[RGB_ENTRY], observation[DEPTH]


def write_page(folder: Path = DOCS, grid: np.ndarray = curves.GRID) -> None:
    """Write the two pages of the corruptions, with their pictures, into ``folder``."""
    rgb, depth = rendered_frame(PAGE_SEED, PAGE_SIZE)
    view = varied_view(depth)
    contact_sheet(rgb[view], depth[view], folder / "pictures" / "corruptions.jpg")
    suite = curves.curves(rgb[CURVE_VIEWS], depth[CURVE_VIEWS], grid)
    curves.draw(suite, folder / "pictures" / "severity-curves.png", grid)
    write_bytes(folder / "corruptions.md", page.page(suite, PAGE_SEED).encode())
    for half, picture in unseen_page.PICTURES.items():
        names = registry.unseen_names(*BOTH, half=half)
        contact_sheet(rgb[view], depth[view], folder / picture, names=names)
    unseen = curves.curves(rgb[CURVE_VIEWS], depth[CURVE_VIEWS], grid, SHEETS["unseen"])
    curves.draw(unseen, folder / unseen_page.CURVES, grid)
    text = unseen_page.page(unseen, suite, grid, PAGE_SEED)
    write_bytes(folder / "unseen-corruptions.md", text.encode())


def varied_view(depth: np.ndarray) -> int:
    """Return the index of the view in ``depth`` [V, H, W, 1] whose depth varies most."""
    return int(depth.std(axis=(1, 2, 3)).argmax())


def main(arguments: list[str] | None = None) -> None:
    """Run from the command line (see the module's docstring)."""
    parser = argparse.ArgumentParser(prog="tools.pages.gallery", description=__doc__)
    parser.add_argument("--out", type=Path, help="picture to write: .png, .jpg or .jpeg")
    parser.add_argument("--seed", type=int, default=7, help="apartment to render (default 7)")
    parser.add_argument("--size", type=int, default=160, help="view size in pixels (default 160)")
    parser.add_argument("--view", type=int, help="rendered view (default: the most varied depth)")
    parser.add_argument(
        "--suite", choices=SHEETS, default="full", help="suite that the sheet shows"
    )
    parser.add_argument("--page", action="store_true", help="write the pages in docs instead")
    options = parser.parse_args(arguments)
    if options.page:
        write_page()
        print("Wrote docs/corruptions.md, docs/unseen-corruptions.md and their pictures")
        return
    if options.out is None:
        parser.error("name the picture to write: --out sheet.png (or pass --page).")
    rgb, depth = rendered_frame(options.seed, options.size)
    view = varied_view(depth) if options.view is None else options.view % len(rgb)
    contact_sheet(rgb[view], depth[view], options.out, SHEETS[options.suite])
    print(f"Wrote {options.out}")


if __name__ == "__main__":
    main()
