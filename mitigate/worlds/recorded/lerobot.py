"""Read recorded drives from LeRobot datasets. Each episode is one drive.

The task of the first frame is the instruction. LeRobot defines no format for poses and lenses.
Therefore these drives have no poses, and all cameras are assumed to face forward.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions.lerobot import Camera, Dataset, Episode, open_dataset
from mitigate.corruptions.lerobot.dataset import TOLERANCE, rows_of
from mitigate.corruptions.lerobot.frames import read_frames
from mitigate.worlds.recorded.drive_files import assumed_lens
from mitigate.worlds.recorded.options import Options
from mitigate.worlds.recorded.source import MAX_INSTANTS, Source


@dataclass(kw_only=True)
class LerobotEpisode(Source):
    """An episode of a dataset.

    ``read`` holds the cameras to read. ``tolerance`` is the maximum time difference in seconds
    between a row and its video frame.
    """

    dataset: Dataset
    episode: Episode
    read: Sequence[Camera]
    tolerance: float

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        times = [float(self.times[index]) for index in chosen]
        return read_frames(self.dataset, self.episode, self.read, chosen, times, self.tolerance)


def open_episodes(path: Path, options: Options) -> list[LerobotEpisode]:
    """Open the episodes of a dataset. Their frames are read later.

    Raises:
        FileNotFoundError: If a file is missing.
        ValueError: If the dataset is damaged, or if an option names an unknown camera or episode.
            If no camera can be read, or if several cameras of one kind can be read. If an episode
            is too long or has an unknown task.
    """
    dataset = open_dataset(path)
    chosen = []
    for kind in (RGB, DEPTH):
        fitting = dataset.choose_cameras(kind, options.cameras)
        if len(fitting) > 1:
            names = ", ".join(camera.name for camera in fitting)
            raise ValueError(
                f"{path} has {len(fitting)} {kind} cameras: {names}. Choose one, for example "
                f"cameras=[{fitting[0].name}]."
            )
        chosen += fitting
    if not chosen:
        reasons = [f"{name} {reason}" for name, reason in dataset.other_cameras.items()]
        raise ValueError(f"{path} has no camera that can be read. {'; '.join(reasons)}".strip())
    drives = []
    signals: dict[str, dict[str, np.ndarray]] = {}
    for episode, rows, mine in rows_of(dataset, dataset.choose_episodes(options.episodes)):
        name = f"{path.resolve().name}/episode-{episode.index:06d}"
        if episode.length > MAX_INSTANTS:
            raise ValueError(
                f"{name} must have at most {MAX_INSTANTS} frames. Exclude this episode (episodes=)."
            )
        if episode.data not in signals:
            signals = {episode.data: dataset.read_signals(episode.data)}
        drives.append(
            LerobotEpisode(
                name=name,
                instruction=dataset.instruction(rows, name),
                cameras={camera.name: assumed_lens(camera.kind, options.hfov) for camera in chosen},
                times=rows.times,
                signals={n: values[mine] for n, values in signals[episode.data].items()},
                dataset=dataset,
                episode=episode,
                read=chosen,
                tolerance=TOLERANCE if options.tolerance is None else options.tolerance,
            )
        )
    return drives
