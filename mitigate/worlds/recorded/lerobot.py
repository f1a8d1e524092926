"""Read drives from LeRobot datasets: each episode is a drive.

The task of the first frame is the instruction. LeRobot has no standard for poses and lenses, so a
drive has no poses, and all its cameras face forward.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions.lerobot import Camera, Dataset, Episode, open_dataset
from mitigate.corruptions.lerobot.dataset import TOLERANCE, Rows, rows_of
from mitigate.corruptions.lerobot.frames import read_frames
from mitigate.worlds.recorded.source import MAX_INSTANTS, Lens, Source


class LerobotEpisode(Source):
    """An episode of a dataset.

    Args:
        dataset: The dataset.
        episode: The episode.
        rows: Its rows.
        signals: Numbers of each row by feature, float64 [N, size].
        cameras: Cameras to read.
        hfov: Horizontal field of view in degrees; None: 90.
        tolerance: Maximum seconds between a row and its video frame.

    Raises:
        ValueError: The episode is too long, or its task is unknown.
    """

    def __init__(
        self,
        dataset: Dataset,
        episode: Episode,
        rows: Rows,
        signals: dict[str, np.ndarray],
        cameras: Sequence[Camera],
        hfov: float | None,
        tolerance: float,
    ) -> None:
        name = f"{dataset.path.resolve().name}/episode-{episode.index:06d}"
        if episode.length > MAX_INSTANTS:
            raise ValueError(
                f"{name} must have at most {MAX_INSTANTS} frames, got {episode.length}. Leave it "
                "out (episodes=)."
            )
        super().__init__(
            name=name,
            instruction=_instruction(dataset, rows, name),
            cameras={
                camera.name: Lens(camera.kind, 90.0 if hfov is None else hfov, assumed=hfov is None)
                for camera in cameras
            },
            times=rows.times,
            poses=None,
            stepped=False,
            dropped=0,
            signals=signals,
        )
        self.dataset = dataset
        self.episode = episode
        self.tolerance = tolerance
        self._read = list(cameras)

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        times = [float(self.times[index]) for index in chosen]
        return read_frames(self.dataset, self.episode, self._read, chosen, times, self.tolerance)


def _instruction(dataset: Dataset, rows: Rows, name: str) -> str:
    first = int(rows.tasks[0])
    if first not in dataset.tasks:
        raise ValueError(
            f"{name} has the task {first}, which meta/tasks.parquet lacks. Copy the dataset again."
        )
    count = len(np.unique(rows.tasks))
    if count > 1:
        warnings.warn(
            f"{name} has {count} tasks. The instruction is the first: {dataset.tasks[first]!r}.",
            stacklevel=2,
        )
    return dataset.tasks[first]


def open_episodes(
    path: Path,
    hfov: float | None,
    cameras: Sequence[str] | None,
    episodes: Sequence[int] | None,
    tolerance: float | None = None,
) -> list[LerobotEpisode]:
    """Open the episodes of a dataset.

    Args:
        path: The folder of the dataset.
        hfov: Horizontal field of view of the cameras in degrees; None: 90.
        cameras: Names of at most one RGB and one depth camera; None: the only ones.
        episodes: Numbers of episodes; None: all.
        tolerance: Maximum time in seconds between a row and its video frame; None: 0.0001, as
            in lerobot.

    Returns:
        The episodes, without their frames.

    Raises:
        FileNotFoundError: A file is missing.
        ValueError: The dataset is damaged, several cameras fit, or a name or number is unknown.
    """
    dataset = open_dataset(path)
    chosen = []
    for kind in (RGB, DEPTH):
        fitting = dataset.choose_cameras(kind, cameras)
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
    for episode, rows, mine in rows_of(dataset, dataset.choose_episodes(episodes)):
        if episode.data not in signals:
            signals = {episode.data: dataset.read_signals(episode.data)}
        observations = {name: values[mine] for name, values in signals[episode.data].items()}
        drives.append(
            LerobotEpisode(
                dataset,
                episode,
                rows,
                observations,
                chosen,
                hfov,
                TOLERANCE if tolerance is None else tolerance,
            )
        )
    return drives
