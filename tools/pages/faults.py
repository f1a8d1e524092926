"""Generate the page ``docs/faults.md`` and its pictures of temporal faults, camera faults and
motion faults.

python -m tools.pages.faults
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from matplotlib.figure import Figure

from mitigate.core.conf import load_config
from mitigate.core.files import write_bytes, write_figure
from mitigate.core.observation import DEPTH, HFOV_DEGREES, POSE, RGB, STOP
from mitigate.core.pictures import depth_picture, draw_path
from mitigate.corruptions import CLEAN, Corruption, Key, corrupt, registry
from mitigate.evaluation import config  # noqa: F401 - registers the types of conf/evaluate.yaml
from mitigate.worlds import motion
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.tasks import make_episode
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import Corrupted, World
from tools.pages.corruptions import formulas
from tools.pages.gallery import INK, PAPER

DOCS = Path(__file__).resolve().parents[2] / "docs"
# the apartment that other pages show, and the size of a view in pixels
APARTMENT, SIZE = 200021, 72
FRAMES = 12  # instants per row
SEVERITY = 0.6
CAMERA_COLUMNS = ("clean", "rendered, 0.5", "rendered, 1", "warped, 0.5", "warped, 1")
COLOURS = ("#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00")
# line styles, so that the paths can also be distinguished without colour
DASHES = ("-", "--", "-.", ":", "-", "--")
LABEL, GUTTER = 190, 3  # sizes in pixels: width of the row names, and gap between pictures
TITLE = 22  # height of the column titles in pixels
JPEG_QUALITY = 80
FONT = cv2.FONT_HERSHEY_SIMPLEX
PICTURES = {
    "temporal": "pictures/faults-temporal.jpg",
    "camera": "pictures/faults-camera.jpg",
    "motion": "pictures/faults-motion.png",
}
TEMPLATE = Path(__file__).with_suffix(".md")  # the template: names in braces are replaced by values


def write_page(folder: Path = DOCS) -> None:
    """Write the page and its pictures into ``folder``."""
    _write_picture(folder / PICTURES["temporal"], timeline())
    _write_picture(folder / PICTURES["camera"], camera_sheet())
    write_figure(folder / PICTURES["motion"], paths(), dpi=100, facecolor="white")
    text = TEMPLATE.read_text("utf-8").format(
        frames=FRAMES,
        apartment=APARTMENT,
        severity=SEVERITY,
        bias=motion.BIAS,
        **{f"{family}_picture": picture for family, picture in PICTURES.items()},
        **{family: formulas(registry.fault_names(family)) for family in PICTURES},
    )
    write_bytes(folder / "faults.md", text.encode())


def timeline() -> np.ndarray:
    """Return a picture (uint8 RGB) of the forward view at each step, without and with each temporal
    fault.
    """
    names = load_config("evaluate", ["suite=temporal"]).suite.conditions[1:]
    faults = [Corruption(name, SEVERITY) for name in names]
    depth_only = [fault for fault in faults if fault.modalities == (DEPTH,)]
    rows = [(fault, RGB) for fault in (CLEAN, *faults) if fault not in depth_only]
    rows += [(fault, DEPTH) for fault in (CLEAN, *depth_only)]
    steps = [str(step) for step in range(FRAMES)]
    return _sheet([(fault.name.split("+"), _views(fault, entry)) for fault, entry in rows], steps)


def _views(corruption: Corruption, entry: str) -> list[np.ndarray]:
    """Return the forward views of an episode in which the expert acts."""
    world = ApartmentsWorld(SIZE, views=1)
    return [_picture(obs[entry]) for obs in _walk(world, Corrupted(world, corruption, seed=0))]


def _walk(world: ApartmentsWorld, corrupted: World) -> Iterator[Any]:
    """Yield the observations while the expert takes ``FRAMES`` steps."""
    observation = corrupted.reset(make_episode(Apartment(APARTMENT), "vln", 0))
    for _ in range(FRAMES):
        yield observation
        observation = corrupted.step(world.expert().action())


def camera_sheet() -> np.ndarray:
    """Return a picture (uint8 RGB) of the forward view under each camera fault."""
    world = ApartmentsWorld(2 * SIZE, views=1)
    episode = make_episode(Apartment(APARTMENT), "vln", 0)
    clean = world.reset(episode)[RGB]
    key = Key(0, episode.episode_id)
    rows = []
    for name in registry.fault_names("camera"):
        severities = (0.5, 1.0)
        pictures = [clean]  # the columns are CAMERA_COLUMNS
        faults = [Corruption(name, severity) for severity in severities]
        pictures += [Corrupted(world, fault, 0).reset(episode)[RGB] for fault in faults]
        if name != "camera_height":
            pictures += [corrupt(clean, name, s, key=key, hfov=HFOV_DEGREES) for s in severities]
        rows.append(([name], pictures))
    return _sheet(rows, CAMERA_COLUMNS, 2 * SIZE)


def paths() -> Figure:
    """Plot the paths that the expert's commands produce, without and with each motion fault."""
    world = ApartmentsWorld(16)
    episode = make_episode(Apartment(APARTMENT), "vln", 0)
    commands = list(_commands(world, episode))
    figure = Figure(figsize=(9, 6), layout="constrained")
    axes = figure.subplots()
    names = ("clean", *registry.fault_names("motion"))
    for name, colour, dash in zip(names, COLOURS, DASHES, strict=True):
        corruption = CLEAN if name == "clean" else Corruption(name, SEVERITY)
        faulty = motion.with_motion(world, corruption, seed=0)
        poses = [faulty.reset(episode), *(faulty.step(command) for command in commands)]
        draw_path(axes, np.stack([pose[POSE][:2] for pose in poses]), colour, name, dash)
    world.draw(axes)
    axes.set_aspect("equal")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _commands(world: ApartmentsWorld, episode: Episode) -> Iterator[int]:
    """Yield the commands of the expert in an episode, without STOP."""
    world.reset(episode)
    while (action := world.expert().action()) != STOP:
        yield action
        world.step(action)


def _picture(frame: np.ndarray) -> np.ndarray:
    return frame if frame.shape[-1] == 3 else depth_picture(frame[..., 0], 6.0)


def _sheet(
    rows: Sequence[tuple[list[str], list[np.ndarray]]], titles: Sequence[str], size: int = SIZE
) -> np.ndarray:
    """Join rows of pictures under the titles of the columns, with the row names to the left."""
    side = size + GUTTER
    shape = (TITLE + side * len(rows), LABEL + side * len(titles), 3)
    sheet = np.full(shape, PAPER, np.uint8)
    for column, title in enumerate(titles):
        _write(sheet, title, LABEL + column * side, TITLE - 7)
    for row, (lines, pictures) in enumerate(rows):
        top = TITLE + row * side
        for number, line in enumerate(lines):
            _write(sheet, line, 6, top + size // 2 + 20 * number)
        for column, picture in enumerate(pictures):
            left = LABEL + column * side
            sheet[top : top + size, left : left + size] = picture
    return sheet


def _write(sheet: np.ndarray, text: str, x: int, y: int) -> None:
    cv2.putText(sheet, text, (x, y), FONT, 0.6, INK, 1, cv2.LINE_AA)


def _write_picture(path: Path, sheet: np.ndarray) -> None:
    _, encoded = cv2.imencode(".jpg", sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    write_bytes(path, encoded.tobytes())


if __name__ == "__main__":
    write_page()
    print("Wrote docs/faults.md and its pictures")
