"""Folders of recorded frames: by ``mitigate run record=``, in TUM RGB-D's form, or simply named.

* ``recording.json`` and ``<scene>/<episode>/<camera>/000000.png``: what ``mitigate run`` recorded;
* ``rgb.txt``, ``depth.txt``, ``groundtruth.txt``: the form of the TUM RGB-D benchmark (Sturm et
  al., IROS 2012), which most tools for RGB-D cameras write;
* ``rgb/`` and ``depth/`` with a file for each step, in the order of their names; with
  ``poses.csv``, a line "x,y,heading" for each (metres, radians, forward is (-sin h, cos h)).

Beside each, ``instruction.txt`` may hold the words.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import RECORDING
from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import frame_files
from mitigate.corruptions.frame_files import SUFFIXES
from mitigate.corruptions.plan import natural
from mitigate.worlds.episodes import from_vlnce
from mitigate.worlds.recorded import tum
from mitigate.worlds.recorded.source import Lens, words
from mitigate.worlds.recorded.tum import number

CAMERAS, STEPS, EPISODE, WORDS = "cameras.json", "steps.jsonl", "episode.json", "instruction.txt"


@dataclass(frozen=True)
class Frames:
    """A drive in files; ``files``: of each camera, one for each instant. ``unit``: metres of a
    count of 16-bit depth. The rest as ``source.py`` says of a Source."""

    name: str
    instruction: str
    cameras: Mapping[str, Lens]
    files: Mapping[str, Sequence[Path]]
    times: np.ndarray
    poses: np.ndarray | None
    stepped: bool
    unit: float

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        for index in chosen:
            yield {name: self._read(name, files[index]) for name, files in self.files.items()}

    def _read(self, camera: str, path: Path) -> np.ndarray:
        try:
            frame = frame_files.read(path, self.unit)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} {error}. Mend it, or take it out of the drive.") from error
        wanted = self.cameras[camera].kind
        if (frame.shape[-1] == 3) != (wanted == RGB):
            raise ValueError(f"{path} is no {wanted} frame, but lies among those of {camera!r}.")
        return np.nan_to_num(frame[..., 0], posinf=0, neginf=0) if wanted == DEPTH else frame


def open_folder(path: Path, hfov: float | None, unit: float | None) -> list[Frames]:
    """The drives in a folder; ``hfov`` (degrees) and ``unit`` (metres of a count of depth) where
    the folder does not say.

    Raises FileNotFoundError if there is none, ValueError for what is damaged or does not fit.
    """
    if (path / RECORDING).is_file():
        episodes = sorted(file.parent for file in path.glob(f"*/*/{STEPS}"))
        found = [drive for folder in episodes if (drive := _recorded(folder, path, hfov))]
    elif tum.is_one(path):
        per_count = tum.UNIT if unit is None else unit
        found = [Frames(path.name, words(path / WORDS), *tum.read(path, hfov), False, per_count)]
    elif (path / RGB).is_dir() or (path / DEPTH).is_dir():
        found = [_simple(path, hfov, unit)]
    else:
        folders = sorted(folder for folder in path.iterdir() if folder.is_dir())
        found = [drive for f in folders if _is_drive(f) for drive in open_folder(f, hfov, unit)]
    if not found:
        raise FileNotFoundError(
            f"{path} holds no drive: neither {RECORDING} (by mitigate run record=FOLDER) nor "
            f"{' and '.join(tum.LISTS)} (TUM RGB-D) nor the folders rgb/ and depth/, here or one "
            "folder below. A rosbag2 folder has metadata.yaml."
        )
    return found


def _is_drive(folder: Path) -> bool:
    return any((folder / name).exists() for name in (RECORDING, *tum.LISTS, RGB, DEPTH))


def _recorded(folder: Path, top: Path, hfov: float | None) -> Frames | None:
    """An episode that ``mitigate run`` recorded; None for one without a frame."""
    told, steps = _json(folder / EPISODE), _lines(folder / STEPS)
    listed = _json(folder / CAMERAS) if (folder / CAMERAS).is_file() else None
    names = sorted(p.name for p in folder.iterdir() if p.is_dir())
    files = {name: _ordered(folder / name) for name in names}
    files = {name: there for name, there in files.items() if there}
    if not steps or not files:
        return None
    cameras = {name: _lens(name, there[0], listed, hfov) for name, there in files.items()}
    name = folder.relative_to(top).as_posix()
    count = _one_count(name, {**{n: len(f) for n, f in files.items()}, STEPS: len(steps)})
    poses = None
    if all(_is_place(step) for step in steps):
        poses = np.array([(*from_vlnce(s["position"]), s["heading"]) for s in steps], np.float64)
    words = str(told.get("text") or told.get("category") or "")
    unit = float(_json(top / RECORDING).get("unit") or 0.001)
    return Frames(name, words, cameras, files, np.arange(count) * 1.0, poses, True, unit)


def _lens(name: str, first: Path, listed: Any, hfov: float | None) -> Lens:
    """The lens of a camera, as the recording says, or by its first frame and ``hfov``."""
    own = listed.get(name) if isinstance(listed, dict) else None
    if isinstance(own, dict) and own.get("kind") in (RGB, DEPTH):
        wide = own.get("hfov") or hfov or 90.0
        return Lens(own["kind"], float(wide), float(own.get("yaw") or 0.0))
    kind = frame_files.modality(first)
    return Lens(kind, 90.0 if hfov is None else hfov)


def _is_place(step: Any) -> bool:
    """Whether a line of steps.jsonl says where the agent was."""
    place = step.get("position") if isinstance(step, dict) else None
    if not isinstance(place, list) or len(place) != 3:
        return False
    numbers = (*place, step.get("heading"))
    return all(isinstance(number, (int, float)) and math.isfinite(number) for number in numbers)


def _simple(path: Path, hfov: float | None, unit: float | None) -> Frames:
    """``rgb/``, ``depth/`` and ``poses.csv``: each file is a step."""
    files = {kind: _ordered(path / kind) for kind in (RGB, DEPTH)}
    files = {kind: there for kind, there in files.items() if there}
    counts = {f"{kind}/": len(there) for kind, there in files.items()}
    poses = None
    if (path / "poses.csv").is_file():
        text = (path / "poses.csv").read_text(encoding="utf-8", errors="replace")
        lines = [line.split(",") for line in text.splitlines() if line.strip()]
        if lines and not _isnumber(lines[0][0]):
            lines = lines[1:]  # a heading
        counts["poses.csv"] = len(lines)
        wrong = [n for n, line in enumerate(lines, 1) if len(line) != 3]
        if wrong:
            raise ValueError(f"{path}/poses.csv, line {wrong[0]}, is not x,y,heading.")
        file = path / "poses.csv"
        poses = np.array([[number(w, file, n) for w in line] for n, line in enumerate(lines, 1)])
    count = _one_count(str(path), counts)
    cameras = {kind: Lens(kind, 90.0 if hfov is None else hfov) for kind in files}
    per_count = 0.001 if unit is None else unit
    times = np.arange(count) * 1.0
    return Frames(path.name, words(path / WORDS), cameras, files, times, poses, True, per_count)


def _isnumber(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _one_count(name: str, counts: Mapping[str, int]) -> int:
    if not counts or max(counts.values()) != min(counts.values()) or not max(counts.values()):
        told = ", ".join(f"{count} in {where}" for where, count in counts.items())
        raise ValueError(f"{name} must hold as many of each, one a step, but has {told}.")
    return next(iter(counts.values()))


def _ordered(folder: Path) -> list[Path]:
    """The frames of a folder by name, digits counting as numbers."""
    if not folder.is_dir():
        return []
    files = [p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and p.name[0] != "."]
    return sorted(files, key=lambda file: natural(file.name))


def _json(file: Path) -> dict[str, Any]:
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ValueError(f"{file} cannot be read ({error}).") from error
    if not isinstance(found, dict):
        raise ValueError(f"{file} is no JSON object.")
    return found


def _lines(file: Path) -> list[Any]:
    try:
        return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line]
    except (OSError, ValueError, RecursionError) as error:
        raise ValueError(f"{file} cannot be read ({error}).") from error
