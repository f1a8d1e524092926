"""Which files of a folder are frames, in which order, and which are left out and why."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from mitigate.corruptions import frame_files
from mitigate.corruptions.frame_files import SUFFIXES, LeftOutError


@dataclass(frozen=True)
class Frame:
    """One input file, by its path inside the folder, and the key of its draw."""

    path: Path
    episode: str
    number: int


@dataclass
class Plan:
    """What a folder holds: frames in order, files left out, and how many others there are."""

    frames: list[Frame] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)  # file -> reason
    other_modality: int = 0
    other_files: int = 0

    def episodes(self) -> dict[str, list[str]]:
        """The names of the frames of each episode, in order."""
        names: dict[str, list[str]] = {}
        for frame in self.frames:
            names.setdefault(frame.episode, []).append(frame.path.as_posix())
        return names


def make_plan(source: Path, wanted: str, episode: str) -> Plan:
    """Find the frames of a modality. A file that is neither takes part as a bad frame."""
    plan = Plan()
    counts: dict[str, int] = {}
    for path in _files(source, plan):
        if path.suffix.lower() not in SUFFIXES:
            plan.other_files += 1
            continue
        try:
            if frame_files.modality(source / path) != wanted:
                plan.other_modality += 1
                continue
        except LeftOutError as error:
            plan.left_out[path.as_posix()] = str(error)
        name = path.parent.as_posix() if episode == "folder" else "all"
        plan.frames.append(Frame(path, name, counts.get(name, 0)))
        counts[name] = counts.get(name, 0) + 1
    return plan


def _files(source: Path, plan: Plan) -> Iterator[Path]:
    """Relative paths, folder by folder in natural order; hidden files and folders are passed by."""

    def complain(error: OSError) -> None:
        folder = Path(error.filename).relative_to(source).as_posix()
        plan.left_out[f"{folder}/"] = f"cannot be read: {error.strerror}"

    for folder, folders, files in os.walk(source, onerror=complain):
        folders[:] = sorted((name for name in folders if name[0] != "."), key=_natural)
        for name in sorted((name for name in files if name[0] != "."), key=_natural):
            yield Path(folder, name).relative_to(source)


def _natural(name: str) -> tuple:
    parts = re.split(r"([0-9]+)", name)
    return tuple(int(p) if i % 2 else p for i, p in enumerate(parts)), name
