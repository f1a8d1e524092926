"""Write episodes of a LeRobot dataset as conversations with images.

The format of the conversations is that of LLaVA and NaVid.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from mitigate.agents.vlm.conversation import TASK
from mitigate.agents.vlm.dataset import write_conversations
from mitigate.core.names import short
from mitigate.core.observation import FORWARD, LEFT, RGB, RIGHT, STOP, Observation
from mitigate.corruptions.lerobot import Camera, Dataset, open_dataset
from mitigate.corruptions.lerobot import Episode as DatasetEpisode
from mitigate.corruptions.lerobot.dataset import TOLERANCE, rows_of
from mitigate.corruptions.lerobot.frames import read_frames
from mitigate.corruptions.lerobot.tables import FIX
from mitigate.worlds.episodes import Episode, placeless_episode
from mitigate.worlds.world import Expert, World

ACTION = "action"  # lerobot's name of the feature
ALLOWED = f"{STOP} (stop), {FORWARD} (forward), {LEFT} (left), {RIGHT} (right)"
Convert = Callable[[np.ndarray], Sequence[int | None]]


def write_lerobot_conversations(
    dataset: str | Path,
    folder: str | Path,
    *,
    camera: str | None = None,
    actions: Convert | None = None,
    size: int = 224,
    tolerance: float = TOLERANCE,
    answers: str = "navid",
    history: int = 4,
    task: str = TASK,
) -> int:
    """Write one JSON line per decision in a dataset, in the format of ``write_conversations``.

    The task of an episode is the instruction. Consecutive equal actions are merged into answers
    such as "forward 75 cm". A low-level action is a step of 25 cm or 15 degrees.

    Args:
        dataset: folder of a LeRobot dataset of version 3.
        folder: the output folder, see ``write_conversations``.
        camera: name of an RGB camera. If None, the dataset must have only one.
        actions: function that converts the recorded actions of an episode, float64 [rows, values],
            to one item per row: 0 (stop), 1 (forward), 2 (left), 3 (right), or None to skip the
            row. If None, each recorded action must be one of these integers.
        size: side in pixels to which the central square of each frame is resized.
        tolerance: maximum time in seconds between a row and its video frame.
        answers: style of the answers, see ``AnsweringAgent``.
        history: maximum number of earlier frames.
        task: text of the question.

    Returns:
        The number of lines.

    Raises:
        FileNotFoundError: If there is no such dataset, or a file is missing.
        ValueError: If the dataset is damaged, or an argument is invalid. If the recorded actions
            need ``actions``, or the robot moves after a stop.
    """
    if size < 1:
        raise ValueError(f"size must be >= 1, got {size}.")
    opened = open_dataset(dataset)
    chosen = opened.choose_camera(RGB, camera, "camera")
    drives = _read_drives(opened, actions or _check_integers(opened))
    if not any(STOP in drive.actions for drive in drives.values()):
        warnings.warn(
            f"No episode of {dataset} has a stop, so an agent cannot learn from it where to stop. "
            f"Let actions= return {STOP} for the last row.",
            stacklevel=2,
        )
    world = _RecordedWorld(opened, chosen, drives, size, tolerance)
    return write_conversations(
        world,
        [placeless_episode(name, drive.instruction) for name, drive in drives.items()],
        folder,
        answers=answers,
        history=history,
        task=task,
        limit=max(len(drive.actions) for drive in drives.values()),
    )


class _Drive(NamedTuple):
    """The rows of an episode that have a low-level action."""

    episode: DatasetEpisode
    instruction: str
    rows: list[int]  # indices of the rows
    times: list[float]  # seconds since the start of the episode, for each row
    actions: list[int]  # the low-level action of each row


@dataclass(eq=False)
class _RecordedWorld(World, Expert):
    """World that replays drives. Its expert takes the recorded actions.

    Each step goes to the next row, independent of the action.
    """

    dataset: Dataset
    camera: Camera
    drives: Mapping[str, _Drive]
    size: int
    tolerance: float

    def reset(self, episode: Episode) -> Observation:
        drive = self.drives[episode.episode_id]
        frames = read_frames(
            self.dataset, drive.episode, [self.camera], drive.rows, drive.times, self.tolerance
        )
        self._steps = zip(drive.actions, frames, strict=True)
        return self._next()

    def step(self, action: int) -> Observation:
        return self._next()

    def expert(self) -> Expert:
        return self

    def action(self) -> int:
        return self._action

    def _next(self) -> Observation:
        step = next(self._steps, None)
        self.done = step is None
        if step is None:
            return Observation({})
        self._action, images = step
        frame = images[self.camera.name]
        return Observation({}, lambda: {RGB: _square(frame, self.size)}, (RGB,))


def _check_integers(dataset: Dataset) -> Convert:
    """Return a function for actions that are integers; raise ValueError for other actions."""
    feature = dataset.features.get(ACTION)
    kind = f"{feature['dtype']} {short(feature['shape'])}" if feature else "no such feature"
    if "int" not in kind or dataset.signals.get(ACTION) != 1:
        raise ValueError(
            f"Without actions=, the feature {ACTION!r} of {dataset.path} must be one integer: "
            f"{ALLOWED}, got {kind}. Pass actions=, a function that converts the recorded actions "
            "of an episode, [rows, values], to one of these integers or None per row."
        )
    return lambda recorded: recorded[:, 0].tolist()


def _read_drives(dataset: Dataset, convert: Convert) -> dict[str, _Drive]:
    """Return the episodes that have low-level actions, by name."""
    drives = {}
    recorded: dict[str, np.ndarray] = {}
    for episode, rows, mine in rows_of(dataset, dataset.choose_episodes(None)):
        if episode.data not in recorded:  # only one file is kept in memory
            signals = dataset.read_signals(episode.data)
            if ACTION not in signals:
                raise ValueError(
                    f"{dataset.path / episode.data} must have the column {ACTION!r} with numbers. "
                    f"{FIX}"
                )
            recorded = {episode.data: signals[ACTION]}
        name = f"{dataset.path.resolve().name}/episode-{episode.index:06d}"
        actions = _low_level(name, recorded[episode.data][mine], convert)
        if actions:
            times = [float(rows.times[row]) for row in actions]
            instruction = dataset.instruction(rows, name)
            drives[name] = _Drive(episode, instruction, [*actions], times, [*actions.values()])
    if not drives:
        raise ValueError(f"{dataset.path} has no low-level action: actions= returned only None.")
    return drives


def _low_level(name: str, recorded: np.ndarray, convert: Convert) -> dict[int, int]:
    """Return the low-level actions of an episode up to its stop, by row."""
    actions = list(convert(recorded))
    if len(actions) != len(recorded):
        raise ValueError(
            f"{name}: actions= must return one item per row, got {len(actions)} items for "
            f"{len(recorded)} rows."
        )
    for row, action in enumerate(actions):
        is_known = np.isscalar(action) and action in (STOP, FORWARD, LEFT, RIGHT)
        if not (is_known or action is None):
            raise ValueError(
                f"{name}, row {row}: a low-level action must be {ALLOWED} or None, got "
                f"{short(action)}. Pass another function as actions=."
            )
    end = actions.index(STOP) + 1 if STOP in actions else len(actions)
    if any(actions[end:]):
        raise ValueError(
            f"{name} moves after the stop in row {end - 1}, but the stop of an agent ends its "
            "episode. Let actions= return None for pauses."
        )
    return {row: int(a) for row, a in enumerate(actions[:end]) if a is not None}


def _square(frame: np.ndarray, size: int) -> np.ndarray:
    """Return the central square of a frame, resized to [size, size, 3]."""
    height, width = frame.shape[:2]
    side = min(height, width)
    top = (height - side) // 2
    left = (width - side) // 2
    method = cv2.INTER_AREA if size < side else cv2.INTER_LINEAR
    return cv2.resize(
        frame[top : top + side, left : left + side], (size, size), interpolation=method
    )
