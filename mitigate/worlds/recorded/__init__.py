"""Drives that were recorded, on a robot or by ``mitigate run record=``: read, and walked along."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from mitigate.worlds.recorded.bags import Bag, Topics
from mitigate.worlds.recorded.folders import Frames, is_drive, open_folder
from mitigate.worlds.recorded.recording import Driven, RecordedWorld, Recording, Step, kinds, load
from mitigate.worlds.recorded.source import NARROW, WIDE, Source

__all__ = [
    "Driven",
    "RecordedWorld",
    "Recording",
    "Source",
    "Step",
    "Topics",
    "kinds",
    "load",
    "open_recording",
]

BAGS = (".bag", ".mcap", ".db3")
PACKED = (".gz", ".zst", ".zip", ".xz", ".bz2")


def open_recording(
    path: str | Path,
    *,
    topics: Topics | None = None,
    hfov: float | None = None,
    unit: float | None = None,
    yaw: float = 0.0,
    cameras: Sequence[str] | None = None,
) -> list[Frames | Bag]:
    """The drives in a folder or a bag, without their frames; of a folder of drives, all.

    Args: topics, yaw (degrees to the right of the heading that the camera looks): of a bag. unit:
    metres of a count of 16-bit depth in a folder. hfov: of cameras in degrees, where the recording
    does not say. cameras: names of those that are read of a recording by ``mitigate run``.
    Raises FileNotFoundError if there is none, ValueError for what is damaged or does not fit.
    """
    path, topics = Path(path), topics or Topics()
    _check(path, hfov, unit)
    if _is_bag(path):
        if unit is not None or cameras:
            raise ValueError(
                f"{path} is a bag, which says its units and cameras: leave unit= and cameras= out."
            )
        return [Bag(path, topics, hfov, yaw)]
    if path.is_file():
        packed = " Unpack it first." if path.suffix in PACKED else ""
        raise ValueError(f"{path} is no bag ({', '.join(BAGS)}).{packed}")
    if not is_drive(path):
        below = [p for p in sorted(path.iterdir()) if _is_bag(p) or (p.is_dir() and is_drive(p))]
        if not below:
            raise FileNotFoundError(
                f"{path} holds no drive, here or one folder below: no bag, no recording.json (by "
                "mitigate run record=FOLDER), no rgb.txt and depth.txt (TUM RGB-D), no folders "
                "rgb/ and depth/."
            )
        again = partial(
            open_recording, topics=topics, hfov=hfov, unit=unit, yaw=yaw, cameras=cameras
        )
        return [drive for one in below for drive in again(one)]
    if topics.given or yaw:
        raise ValueError(f"{path} is no bag: leave topics.* and yaw= out.")
    return list(open_folder(path, hfov, unit, cameras))


def _is_bag(path: Path) -> bool:
    return (path.is_file() and path.suffix in BAGS) or (path / "metadata.yaml").is_file()


def _check(path: Path, hfov: float | None, unit: float | None) -> None:
    if not path.exists():
        raise FileNotFoundError(f"There is no recording {path}: name a folder or a bag.")
    if hfov is not None and not NARROW <= hfov <= WIDE:
        raise ValueError(f"hfov={hfov:g} is no field of view: give degrees from 10 to 179.")
    if unit is not None and not 0 < unit <= 1:
        raise ValueError(f"unit={unit:g} is no unit: give the metres of a count, such as 0.001.")
