"""Drives that were recorded, on a robot or by ``mitigate run record=``: read, and walked along."""

from __future__ import annotations

from pathlib import Path

from mitigate.worlds.recorded.bags import Bag, Topics
from mitigate.worlds.recorded.folders import Frames, open_folder
from mitigate.worlds.recorded.recording import RecordedWorld, Recording, load
from mitigate.worlds.recorded.source import Source, Step

__all__ = ["RecordedWorld", "Recording", "Source", "Step", "Topics", "load", "open_recording"]

BAGS = (".bag", ".mcap", ".db3")


def open_recording(
    path: str | Path,
    *,
    topics: Topics | None = None,
    hfov: float | None = None,
    unit: float | None = None,
) -> list[Frames] | list[Bag]:
    """The drives in a folder or a bag, without their frames.

    Args: topics: of a bag. hfov: of the cameras, in degrees, where the recording does not say.
    unit: metres of a count of 16-bit depth in a folder, where it does not say.
    Raises FileNotFoundError if there is none, ValueError for what is damaged or does not fit.
    """
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"There is no recording {path}: name a folder or a bag.")
    if hfov is not None and not 10 <= hfov < 180:
        raise ValueError(f"hfov={hfov:g} is no field of view: give degrees from 10 to 179.")
    if unit is not None and not 0 < unit <= 1:
        raise ValueError(f"unit={unit:g} is no unit: give the metres of a count, such as 0.001.")
    if path.is_file() and path.suffix not in BAGS:
        raise ValueError(f"{path} is no bag ({', '.join(BAGS)}): name a folder or a bag.")
    if path.is_file() or (path / "metadata.yaml").is_file():
        return [Bag(path, topics or Topics(), hfov)]
    return open_folder(path, hfov, unit)
