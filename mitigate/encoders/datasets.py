"""Read the frames of a LeRobot dataset, for recipes that need only frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from mitigate.core.seeding import generator
from mitigate.corruptions.lerobot import open_dataset
from mitigate.corruptions.lerobot.dataset import TOLERANCE, rows_of
from mitigate.corruptions.lerobot.frames import read_frames
from mitigate.corruptions.lerobot.metadata import Episode
from mitigate.encoders.sources import (
    TRAIN,
    Shot,
    check_options,
    last_scenes,
    resized,
    split_single,
)


class DatasetFrames:
    """The frames of one camera of a LeRobot dataset.

    Each episode is a scene. The last scenes are held out. If there is only one episode, it is split
    into blocks of consecutive frames, and each block counts as a scene.

    Args:
        path: folder of the dataset.
        camera: name of the camera. If None, the only camera of ``sensor`` is used.
        sensor: "rgb" or "depth".
        size: side in pixels to which frames are resized. If None, frames are not resized.
        held_out: fraction of the scenes that are held out.
        episodes: numbers of the episodes to read. If None, all episodes are read.

    Raises:
        FileNotFoundError: If there is no such dataset, or a file is missing.
        ValueError: If the dataset is damaged, an argument is out of range, or several cameras
            match.
    """

    files = True

    def __init__(
        self,
        path: str | None,
        camera: str | None = None,
        sensor: str = "rgb",
        size: int | None = None,
        held_out: float = 0.2,
        episodes: Sequence[int] | None = None,
    ) -> None:
        if path is None:
            raise FileNotFoundError("env.path is not set. Name the folder of the dataset.")
        check_options(size, held_out)
        self.size, self.held_out = size, held_out
        self.dataset = open_dataset(Path(path))
        self.camera = self.dataset.choose_camera(sensor, camera, "env.camera")
        frames: dict[str, list[tuple[Episode, int]]] = {}
        self._times: dict[int, np.ndarray] = {}
        for episode, rows, _ in rows_of(self.dataset, self.dataset.choose_episodes(episodes)):
            frames[f"episode-{episode.index:06d}"] = [(episode, n) for n in range(episode.length)]
            self._times[episode.index] = rows.times
        self._frames = split_single(frames, held_out)

    def scenes(self, split: str) -> Sequence[str]:
        unseen = last_scenes(list(self._frames), self.held_out)
        if not unseen:
            raise ValueError(
                f"{self.dataset.path} has only one frame, but training frames and held-out frames "
                "must come from different scenes. Use a dataset with several episodes."
            )
        return [name for name in self._frames if (name in unseen) != (split == TRAIN)]

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        frames = self._frames[scene]
        rng = generator(seed, "encoder frames", scene)
        places = sorted(rng.permutation(len(frames))[:count])
        episode = frames[0][0]
        chosen = [frames[place][1] for place in places]
        times = self._times[episode.index][chosen].tolist()
        read = read_frames(self.dataset, episode, [self.camera], chosen, times, TOLERANCE)
        for images in read:
            frame = images[self.camera.name]
            yield Shot(resized(frame.reshape(*frame.shape[:2], -1), self.size))
