"""Which files of a folder are frames, in which order, and which are left out and why."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping
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
    """What a folder holds: frames in order, what is left out, and the suffixes of other files."""

    frames: list[Frame] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)  # file, or folder/ -> reason
    other_modality: int = 0
    other_files: Counter[str] = field(default_factory=Counter)  # suffix -> files

    def episodes(self) -> dict[str, list[str]]:
        """The names of the frames of each episode, in order."""
        names: dict[str, list[str]] = {}
        for frame in self.frames:
            names.setdefault(frame.episode, []).append(frame.path.as_posix())
        return names


def make_plan(source: Path, out: Path | None, wanted: str, episode: str) -> Plan:
    """Find the frames of a modality. A file that is neither takes part as a bad frame.

    ``out``, where the results go (None: nowhere), is no part of ``source``, even if a link leads
    there.
    """
    plan = Plan()
    counts: dict[str, int] = {}
    for path in _files(source, out and out.resolve(), plan):
        if path.suffix.lower() not in SUFFIXES:
            plan.other_files[path.suffix.lower()] += 1
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


def told(suffixes: Mapping[str, int]) -> str:
    """Counts of files by suffix, the most frequent first: "3 .tif, 1 .webp"."""
    most = sorted(suffixes, key=lambda suffix: (-suffixes[suffix], suffix))
    return ", ".join(f"{suffixes[suffix]} {suffix or 'without suffix'}" for suffix in most)


def _files(source: Path, out: Path | None, plan: Plan) -> Iterator[Path]:
    """Relative paths, folder by folder in natural order; hidden files and folders are passed by.

    Links to folders are followed, but not in a circle and not into the real path ``out``.
    """

    def complain(error: OSError) -> None:
        folder = Path(error.filename).relative_to(source).as_posix()
        plan.left_out[f"{folder}/"] = f"cannot be read: {error.strerror}"

    for folder, folders, files in os.walk(source, onerror=complain, followlinks=True):
        here = Path(folder).relative_to(source)
        for name in sorted((name for name in files if name[0] != "."), key=natural):
            yield here / name
        seen = sorted((name for name in folders if name[0] != "."), key=natural)
        barred = {name: _barred(source, here / name, out) for name in seen}
        plan.left_out |= {f"{(here / n).as_posix()}/": why for n, why in barred.items() if why}
        folders[:] = [name for name in seen if not barred[name]]


def _barred(source: Path, folder: Path, out: Path | None) -> str:
    """Why a folder must not be entered; empty if it may be."""
    real = (source / folder).resolve()
    if out in (real, *real.parents):
        return "is where the results go"
    around = {(source / parent).resolve() for parent in folder.parents}
    return "leads back to a folder that it lies in" if real in around else ""


def natural(name: str) -> tuple:
    parts = re.split(r"([0-9]+)", name)
    return tuple(int(p) if i % 2 else p for i, p in enumerate(parts)), name
