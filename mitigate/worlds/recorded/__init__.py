"""Read recorded drives (folders of frames, ROS bags, LeRobot datasets), replay them as worlds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path

from mitigate.core.names import unknown
from mitigate.corruptions.lerobot import is_dataset
from mitigate.worlds.recorded.bags import Bag
from mitigate.worlds.recorded.drive_files import Frames
from mitigate.worlds.recorded.folders import is_drive, open_folder
from mitigate.worlds.recorded.lerobot import LerobotEpisode, open_episodes
from mitigate.worlds.recorded.recording import Driven, RecordedWorld, Recording, Step, kinds, load
from mitigate.worlds.recorded.source import MAX_HFOV, MIN_HFOV, Source
from mitigate.worlds.recorded.topics import Topics
from mitigate.worlds.recorded.tum import is_tum

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
    instruction: str | None = None,
    topics: Topics | Mapping[str, str] | None = None,
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
        instruction: Instruction for the agents; None uses the instruction of each drive.
        topics: Topics of a bag, as a mapping such as ``{"rgb": "/front/image_raw"}``; None uses
            the only suitable ones.
        hfov: Horizontal field of view in degrees, if the recording does not contain it.
        unit: Metres per count of depth in a bag, or of 16-bit PNG in a folder of frames.
        yaw: Direction of a bag's cameras in degrees to the right of the heading.
        cameras: Cameras to read from a recording by ``mitigate run`` or from a dataset; None: all.
        episodes: Numbers of the episodes of a dataset; None: all.
        tolerance: Maximum seconds between the messages of a time step of a bag or TUM folder (None:
            0.1), or between a row of a dataset and its video frame (None: 0.0001).

    Returns:
        The drives.

    Raises:
        FileNotFoundError: ``path`` does not exist or contains no drive.
        ValueError: A drive is damaged, or an option does not apply to it.
    """
    path = Path(path)
    topics = _as_topics(topics)
    _check_options(path, hfov, unit, tolerance)
    sources = _open_sources(path, topics, hfov, unit, yaw, cameras, episodes, tolerance)
    if instruction is not None:
        for source in sources:
            source.instruction = instruction
    return sources


def _as_topics(topics: Topics | Mapping[str, str] | None) -> Topics:
    if not isinstance(topics, Mapping):
        return topics or Topics()
    allowed = [field.name for field in fields(Topics)]
    for name in topics:
        if name not in allowed:
            raise ValueError(unknown("entry of topics", name, allowed))
    return Topics(**topics)


def _open_sources(
    path: Path,
    topics: Topics,
    hfov: float | None,
    unit: float | None,
    yaw: float,
    cameras: Sequence[str] | None,
    episodes: Sequence[int] | None,
    tolerance: float | None,
) -> list[Frames | Bag | LerobotEpisode]:
    """Open the drives at ``path``; the arguments are those of :func:`open_recording`."""
    if is_dataset(path):
        if unit is not None or topics.set_options or yaw:
            raise ValueError(
                f"unit=, topics.* and yaw= do not apply to {path}, which is a LeRobot dataset. "
                "Remove them."
            )
        return [*open_episodes(path, hfov, cameras, episodes, tolerance)]
    if _is_bag(path):
        if cameras:
            raise ValueError(
                f"cameras= does not apply to {path}, which is a bag. Choose topics.rgb= and "
                "topics.depth= instead."
            )
        _check_dataset_options(path, episodes)
        return [Bag(path, topics, hfov, yaw, unit, tolerance)]
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
        return [
            source
            for drive in drives
            for source in _open_sources(
                drive, topics, hfov, unit, yaw, cameras, episodes, tolerance
            )
        ]
    if topics.set_options or yaw:
        raise ValueError(
            f"topics.* and yaw= apply only to a bag, which {path} is not. Remove them."
        )
    _check_dataset_options(path, episodes)
    if tolerance is not None and not is_tum(path):
        raise ValueError(
            f"tolerance= does not apply to {path}, whose frames have no times. Remove it."
        )
    return list(open_folder(path, hfov, unit, cameras, tolerance))


def _is_drive(path: Path) -> bool:
    return _is_bag(path) or (path.is_dir() and (is_drive(path) or is_dataset(path)))


def _check_dataset_options(path: Path, episodes: object) -> None:
    if episodes is not None:
        raise ValueError(
            f"episodes= applies only to a LeRobot dataset, which {path} is not. Remove it."
        )


def _is_bag(path: Path) -> bool:
    return (path.is_file() and path.suffix in BAGS) or (path / "metadata.yaml").is_file()


def _check_options(
    path: Path, hfov: float | None, unit: float | None, tolerance: float | None
) -> None:
    if not path.exists():
        raise FileNotFoundError(f"There is no recording {path}. Give a folder or a bag.")
    if hfov is not None and not MIN_HFOV <= hfov <= MAX_HFOV:
        raise ValueError(
            f"hfov must be a field of view of {MIN_HFOV:g} to {MAX_HFOV:g} degrees, got {hfov:g}."
        )
    if tolerance is not None and not tolerance >= 0:
        raise ValueError(f"tolerance must be at least 0 seconds, got {tolerance:g}.")
    if unit is not None and not 0 < unit <= 1:
        raise ValueError(
            f"unit= must be above 0 and at most 1 metre per count, such as 0.001, got {unit:g}."
        )
