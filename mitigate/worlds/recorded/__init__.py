"""Read recorded drives (folders of frames, ROS bags, LeRobot datasets), replay them as worlds."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from mitigate.corruptions.lerobot import is_dataset
from mitigate.worlds.recorded.bags import Bag, Topics
from mitigate.worlds.recorded.folders import Frames, is_drive, open_folder
from mitigate.worlds.recorded.lerobot import LerobotEpisode, open_episodes
from mitigate.worlds.recorded.recording import Driven, RecordedWorld, Recording, Step, kinds, load
from mitigate.worlds.recorded.source import MAX_HFOV, MIN_HFOV, Source

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
COMPRESSED = (".gz", ".zst", ".zip", ".xz", ".bz2")


def open_recording(
    path: str | Path,
    *,
    topics: Topics | None = None,
    hfov: float | None = None,
    unit: float | None = None,
    yaw: float = 0.0,
    cameras: Sequence[str] | None = None,
    episodes: Sequence[int] | None = None,
    tolerance: float | None = None,
) -> list[Frames | Bag | LerobotEpisode]:
    """Open the drives of a bag, a folder, a LeRobot dataset, or a folder of drives.

    Times and poses are read immediately; frames are read later by :func:`load`.

    Args:
        path: A bag, a folder of frames, a dataset, or a folder with several drives.
        topics: Topics of a bag; None uses the only suitable ones.
        hfov: Horizontal field of view in degrees, if the recording does not contain it.
        unit: Metres per count of 16-bit depth in a folder of frames.
        yaw: Direction of a bag's cameras in degrees to the right of the heading.
        cameras: Cameras to read from a recording by ``mitigate run`` or from a dataset; None: all.
        episodes: Numbers of the episodes of a dataset; None: all.
        tolerance: Maximum seconds between a row of a dataset and its video frame; None: 0.0001.

    Returns:
        The drives.

    Raises:
        FileNotFoundError: ``path`` does not exist or contains no drive.
        ValueError: A drive is damaged, or an option does not apply to it.
    """
    path = Path(path)
    topics = topics or Topics()
    _check_options(path, hfov, unit)
    if is_dataset(path):
        if unit is not None or topics.set_options or yaw:
            raise ValueError(
                f"unit=, topics.* and yaw= do not apply to {path}, which is a LeRobot dataset. "
                "Remove them."
            )
        return [*open_episodes(path, hfov, cameras, episodes, tolerance)]
    if _is_bag(path):
        if unit is not None or cameras:
            raise ValueError(
                f"{path} is a bag, which contains its units and cameras. Remove unit= and cameras=."
            )
        _check_dataset_options(path, episodes, tolerance)
        return [Bag(path, topics, hfov, yaw)]
    if path.is_file():
        hint = " Unpack it first." if path.suffix in COMPRESSED else ""
        raise ValueError(f"{path} must be a folder or a bag ({', '.join(BAGS)}).{hint}")
    if not is_drive(path):
        drives = [p for p in sorted(path.iterdir()) if _is_drive(p)]
        if not drives:
            raise FileNotFoundError(
                f"{path} and its folders contain no drive. A drive is a bag, or a folder with "
                "recording.json (from mitigate run record=FOLDER), with rgb.txt and depth.txt (TUM "
                "RGB-D), with the folders rgb/ and depth/, or with meta/info.json (a LeRobot "
                "dataset)."
            )
        open_drive = partial(
            open_recording,
            topics=topics,
            hfov=hfov,
            unit=unit,
            yaw=yaw,
            cameras=cameras,
            episodes=episodes,
            tolerance=tolerance,
        )
        return [source for drive in drives for source in open_drive(drive)]
    if topics.set_options or yaw:
        raise ValueError(
            f"topics.* and yaw= apply only to a bag, which {path} is not. Remove them."
        )
    _check_dataset_options(path, episodes, tolerance)
    return list(open_folder(path, hfov, unit, cameras))


def _is_drive(path: Path) -> bool:
    return _is_bag(path) or (path.is_dir() and (is_drive(path) or is_dataset(path)))


def _check_dataset_options(path: Path, *options: object) -> None:
    if any(option is not None for option in options):
        raise ValueError(
            f"episodes= and tolerance= apply only to a LeRobot dataset, which {path} is not. "
            "Remove them."
        )


def _is_bag(path: Path) -> bool:
    return (path.is_file() and path.suffix in BAGS) or (path / "metadata.yaml").is_file()


def _check_options(path: Path, hfov: float | None, unit: float | None) -> None:
    if not path.exists():
        raise FileNotFoundError(f"There is no recording {path}. Give a folder or a bag.")
    if hfov is not None and not MIN_HFOV <= hfov <= MAX_HFOV:
        raise ValueError(
            f"hfov must be a field of view of {MIN_HFOV:g} to {MAX_HFOV:g} degrees, got {hfov:g}."
        )
    if unit is not None and not 0 < unit <= 1:
        raise ValueError(
            f"unit= must be above 0 and at most 1 metre per count, such as 0.001, got {unit:g}."
        )
