"""Read recorded drives and replay them as worlds.

Folders of frames, ROS bags and LeRobot datasets are supported.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from mitigate.core.files import RECORDING
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions.lerobot import is_dataset
from mitigate.worlds.recorded.bags import Bag
from mitigate.worlds.recorded.folders import read_frames, read_run
from mitigate.worlds.recorded.lerobot import open_episodes
from mitigate.worlds.recorded.options import BAG, DATASET, FRAMES, RUN, TUM, Options
from mitigate.worlds.recorded.recording import RecordedWorld, Recording, Step, kinds, load
from mitigate.worlds.recorded.source import Source
from mitigate.worlds.recorded.topics import Topics
from mitigate.worlds.recorded.tum import is_tum, read_tum

__all__ = ["RecordedWorld", "Recording", "Source", "Step", "kinds", "load", "open_recording"]

OPEN: dict[str, Callable[[Path, Options], Sequence[Source]]] = {
    DATASET: open_episodes,
    BAG: lambda path, options: [Bag(path, options)],
    RUN: read_run,
    TUM: read_tum,
    FRAMES: read_frames,
}
BAGS = (".bag", ".mcap", ".db3")
COMPRESSED = (".gz", ".zst", ".zip", ".xz", ".bz2")


def open_recording(
    path: str | Path,
    *,
    instruction: str | None = None,
    topics: Mapping[str, str] | None = None,
    **options: Any,
) -> list[Source]:
    """Open all recorded drives of a bag, a folder of frames, a LeRobot dataset, or a folder of
    drives.

    This function reads times and poses. Frames are read later by :func:`load`.

    Args:
        path: A bag, a folder of frames, a dataset, or a folder with several drives.
        instruction: Instruction for the agents. If None, each drive keeps its recorded instruction.
        topics: Topics to read from a bag, as a mapping such as ``{"rgb": "/front/image_raw"}``. A
            sensor without an entry uses the only suitable topic.
        options: Other attributes of :class:`mitigate.worlds.recorded.options.Options`, such as
            ``hfov``.

    Returns:
        The drives.

    Raises:
        FileNotFoundError: If ``path`` does not exist or contains no drive.
        ValueError: If a drive is damaged, or an option does not apply to it.
    """
    path = Path(path)
    allowed = [field.name for field in fields(Topics)]
    for name in topics or ():
        if name not in allowed:
            raise ValueError(unknown("entry of topics", name, allowed))
    chosen = Options(Topics(**(topics or {})), **options)
    if not path.exists():
        raise FileNotFoundError(f"There is no recording {path}. Give a folder or a bag.")
    inside = not _kind_of(path)
    if inside and path.is_file():
        hint = " Unpack it first." if path.suffix in COMPRESSED else ""
        raise ValueError(f"{path} must be a folder or a bag ({', '.join(BAGS)}).{hint}")
    places = sorted(path.iterdir()) if inside else [path]
    drives = {place: kind for place in places if (kind := _kind_of(place))}
    if not drives:
        raise FileNotFoundError(
            f"{path} and its folders contain no drive. A drive is a bag, or a folder with "
            "recording.json (from mitigate run record=FOLDER), with rgb.txt and depth.txt (TUM "
            "RGB-D), with the folders rgb/ and depth/, or with meta/info.json (a LeRobot dataset)."
        )
    sources: list[Source] = []
    for drive, kind in drives.items():
        chosen.check(drive, kind)
        sources += OPEN[kind](drive, chosen)
    if instruction is not None:
        for source in sources:
            source.instruction = instruction
    return sources


def _kind_of(path: Path) -> str | None:
    """Return the kind of the recording at ``path``, or None if it is not a recording."""
    if is_dataset(path):
        return DATASET
    if (path.is_file() and path.suffix in BAGS) or (path / "metadata.yaml").is_file():
        return BAG
    if (path / RECORDING).is_file():
        return RUN
    if is_tum(path):
        return TUM
    return FRAMES if (path / RGB).exists() or (path / DEPTH).exists() else None
