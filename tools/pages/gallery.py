"""Create a contact sheet of the corruptions, and write the pages of the documentation.

    python -m tools.pages.gallery --out sheet.png [--rgb FRAME.png --depth FRAME.npy]
    python -m tools.pages.gallery --out sheet.png --suite unseen
    python -m tools.pages.gallery --page

The sheet shows every corruption at several severities on one frame. Without files, the frame is
rendered from an apartment. ``--page`` writes ``docs/corruptions.md`` and
``docs/unseen-corruptions.md`` with their pictures.
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
SUFFIXES = (".png", ".jpg", ".jpeg")  # file formats of a sheet
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


def _cell(rgb: np.ndarray, depth: np.ndarray, name: str, severity: float, key: Key, views):
    """Corrupt the requested views; return them side by side as uint8 RGB."""
    if registry.modality(name) == "rgb":
        return np.hstack(list(corrupt(rgb, name, severity, key=key)[list(views)]))
    corrupted = corrupt(depth, name, severity, key=key)[list(views)]
    metres = depth[list(views)]
    far = float(np.max(metres, initial=0.0, where=np.isfinite(metres))) or Z_MAX
    return np.hstack([depth_picture(view[..., 0], far) for view in corrupted])


def _write(sheet: np.ndarray, text: str, x: int, y: int) -> None:
    cv2.putText(sheet, text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 0.45, INK, 1, cv2.LINE_AA)


def contact_sheet(
    rgb: np.ndarray,
    depth: np.ndarray,
    path: str | Path,
    severities: tuple[float, ...] = SEVERITIES,
    *,
    key: Key | None = None,
    views: tuple[int, ...] = (0,),
    names: tuple[str, ...] = NAMES,
) -> np.ndarray:
    """Write a picture with corruptions as rows and ``severities`` as columns.

    Args:
        rgb: RGB frame of one view or of V views, uint8 [H, W, 3] or [V, H, W, 3].
        depth: Depth of the same views in metres, float32 [H, W], [H, W, 1] or [V, H, W, 1].
        path: File of the picture (.png, .jpg, .jpeg). Missing parent folders are created.
        severities: Severities of the columns.
        key: Random key of the sheet. Repeated names get different keys, so that their rows differ.
        views: Views of a panorama that each cell shows, from left to right.
        names: Corruptions of the rows.

    The result is the picture, uint8 RGB. Raises ValueError if the frames do not match or ``path``
    has an unsupported suffix.
    """
    rgb = rgb if rgb.ndim == 4 else rgb[None]
    depth = depth.reshape(*rgb.shape[:3], 1) if depth.size == rgb.size // 3 else depth
    if depth.shape != (*rgb.shape[:3], 1):
        raise ValueError(
            f"RGB {rgb.shape} and depth {depth.shape} must have the same number of views and the "
            "same size. Pass [V, H, W, 3] with [V, H, W, 1], or one view [H, W, 3] with [H, W]."
        )
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise ValueError(f"Cannot write {path}: its name must end in {' or '.join(SUFFIXES)}.")
    key = key or Key(0, "contact sheet")
    high, wide = rgb.shape[1] + GUTTER, rgb.shape[2] * len(views) + GUTTER
    shape = (TITLE + high * len(names), LABEL + wide * len(severities), 3)
    sheet = np.full(shape, PAPER, np.uint8)
    for column, severity in enumerate(severities):
        _write(sheet, f"s = {severity:g}", LABEL + column * wide, TITLE - 8)
    for row, name in enumerate(names):
        top, again = TITLE + row * high, names[:row].count(name)
        drawn = replace(key, episode=f"{key.episode} {again}") if again else key
        lines = [name, *primitives(name, drawn)] if name in registry.BROAD else [name]
        for place, line in enumerate(lines):
            _write(sheet, line, 6, top + high // 2 + LINE * place - LINE * (len(lines) - 1) // 2)
        for column, severity in enumerate(severities):
            cell = _cell(rgb, depth, name, severity, drawn, views)
            left = LABEL + column * wide
            sheet[top : top + cell.shape[0], left : left + cell.shape[1]] = cell
    png = path.suffix.lower() == ".png"
    quality = [] if png else [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
    _, encoded = cv2.imencode(path.suffix.lower(), sheet[..., ::-1], quality)
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


def read_frame(rgb: Path, depth: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read RGB from a picture file and depth in metres from a .npy file.

    Raises FileNotFoundError if a file is missing, and ValueError if a file cannot be used.
    """
    for path in (rgb, depth):
        if not path.is_file():
            raise FileNotFoundError(
                f"There is no file {path}. Pass --rgb PICTURE and --depth ARRAY.npy (float32 "
                "metres, same height and width), or neither to render a frame."
            )
    picture = cv2.imread(str(rgb), cv2.IMREAD_COLOR)
    if picture is None:
        raise ValueError(f"{rgb} is not a picture that OpenCV can read: use PNG or JPEG.")
    try:
        metres = np.lib.format.open_memmap(depth, mode="r")
    except ValueError as error:
        raise ValueError(
            f"{depth} is not a complete .npy file ({error}). Save depth in metres with np.save."
        ) from error
    if metres.dtype.kind != "f":
        raise ValueError(
            f"{depth} holds {metres.dtype}, not metres as floating-point numbers. Divide counts by "
            "the sensor's counts per metre first (millimetres: 1000)."
        )
    return np.ascontiguousarray(picture[..., ::-1]), np.array(metres, np.float32)


def main(arguments: list[str] | None = None) -> None:
    """Run from the command line (see the module's docstring).

    If the input is invalid, print one line and exit with status 2.
    """
    parser = argparse.ArgumentParser(prog="tools.pages.gallery", description=__doc__)
    parser.add_argument("--out", type=Path, help="picture to write: .png, .jpg or .jpeg")
    parser.add_argument("--rgb", type=Path, help="picture of one view")
    parser.add_argument("--depth", type=Path, help=".npy with float32 metres, same size")
    parser.add_argument("--seed", type=int, default=7, help="apartment to render (default 7)")
    parser.add_argument("--size", type=int, default=160, help="rendered view size (default 160)")
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
    if (options.rgb is None) != (options.depth is None):
        parser.error("--rgb and --depth go together: pass both, or neither to render a frame.")
    try:
        _write_sheet(options)
    except (OSError, ValueError) as error:
        parser.exit(2, f"error: {error}\n")
    print(f"Wrote {options.out}")


def _write_sheet(options: argparse.Namespace) -> None:
    if options.rgb is None:
        rgb, depth = rendered_frame(options.seed, options.size)
        view = varied_view(depth) if options.view is None else options.view % len(rgb)
        rgb, depth = rgb[view], depth[view]
    else:
        rgb, depth = read_frame(options.rgb, options.depth)
    contact_sheet(rgb, depth, options.out, names=SHEETS[options.suite])


if __name__ == "__main__":
    main()
