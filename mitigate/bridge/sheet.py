"""Draws what an agent would see at its first frame: a row for clean and each corruption."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import cv2
import numpy as np

from mitigate.bridge.cameras import Group, Rig, corrupted
from mitigate.core.observation import DEPTH
from mitigate.core.pictures import depth_picture
from mitigate.corruptions import Corruption, Key

SHOWN = 4  # cameras of a panorama in a row of the sheet
SIDE, LABEL, LINE = 160, 190, 20  # pixels: height of a picture, width of the names, of their lines
FONT, WIDE = cv2.FONT_HERSHEY_SIMPLEX, 22  # characters of a line of the names
HEADING = "heading"  # beside the cameras in the file of the first frames
TRIED = 40  # calls, until one is taken in which a corruption acts: some come and go (ours)


def of(camera: str) -> str:
    """Return the name of a camera's frame in the file: none that `numpy.savez` takes itself."""
    return f"camera {camera}"


def sheet(
    rig: Rig,
    frames: Mapping[str, np.ndarray],
    corruptions: Sequence[Corruption],
    first: Mapping[str, Any],
    seed: int,
) -> np.ndarray:
    """Return uint8 RGB: a row for clean and each corruption, with the cameras of its modality that
    are most; a corruption that comes and goes is drawn at a call in which it acts."""
    scene = str(first.get("scene", "")).rpartition("/")[2]
    episode = f"{scene}/{first.get('episode', '')}"
    heading = float(frames[HEADING][0]) if frames[HEADING].size else None
    by_kind = {group.cameras[0].kind: group for group in reversed(rig.groups)}
    clean = {kind: _views(group, frames) for kind, group in by_kind.items()}
    drawn = [_row([f"clean {kind}"], by_kind[kind], views) for kind, views in clean.items()]
    for corruption in corruptions:
        group, before = by_kind[corruption.modality], clean[corruption.modality]
        for call in range(TRIED):
            key = Key(seed, episode, call)
            views = corrupted(group, before.copy(), corruption, key, heading)
            if not np.array_equal(views, before, equal_nan=True):
                break
        acts = f"at call {call}" if call else ""
        if np.array_equal(views, before, equal_nan=True):
            acts = f"no change in {TRIED} calls"
        drawn.append(_row([corruption.name, acts], group, views))
    wide = max(row.shape[1] for row in drawn)
    return np.vstack(
        [
            np.pad(row, ((0, 4), (0, wide - row.shape[1]), (0, 0)), constant_values=255)
            for row in drawn
        ]
    )


def _views(group: Group, frames: Mapping[str, np.ndarray]) -> np.ndarray:
    views = np.zeros(group.shape, group.cameras[0].dtype)
    for camera, view in zip(group.cameras, group.views, strict=True):
        views[view] = frames[of(camera.name)]
    return views


def _row(names: Sequence[str], group: Group, views: np.ndarray) -> np.ndarray:
    """The names, below them the entries that are drawn, and beside them their pictures."""
    cells = [np.full((SIDE, LABEL, 3), 255, np.uint8)]
    shown = list(zip(group.cameras, group.views, strict=True))[:SHOWN]
    entries = ", ".join(camera.name for camera, _ in shown)
    lines = [*filter(None, names), *_broken(entries)]
    for number, line in enumerate(lines[: SIDE // LINE - 1]):
        place = (6, 2 * LINE + LINE * number)
        grey = 0 if number == 0 else 110
        cv2.putText(cells[0], line, place, FONT, 0.45, (grey,) * 3, 1, cv2.LINE_AA)
    for camera, view in shown:
        frame = views[view]
        if camera.kind == DEPTH:
            metres = camera.metres(frame.reshape(frame.shape[:2]).astype(np.float32))
            frame = depth_picture(metres, camera.sensor.z_max)
        scale = SIDE / frame.shape[0]
        size = (max(1, round(frame.shape[1] * scale)), SIDE)
        cells.append(cv2.resize(frame, size, interpolation=cv2.INTER_AREA))
    return np.hstack(cells)


def _broken(text: str) -> Iterator[str]:
    """``text`` in lines of ``WIDE`` characters."""
    for at in range(0, len(text), WIDE):
        yield text[at : at + WIDE].strip()
