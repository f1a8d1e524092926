"""Read frames from a world that can render from arbitrary poses, or from a folder of files.

A source has two disjoint sets of scenes, ``TRAIN`` and ``UNSEEN``, and reads a given number of
frames from each scene.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar, runtime_checkable

import cv2
import numpy as np

from mitigate.agents.observation import FARTHEST
from mitigate.core.files import RECORDING, find
from mitigate.core.names import short, unknown
from mitigate.core.observation import POSE, VIEW_STEP_DEGREES, VIEWS
from mitigate.core.progress import Progress, say
from mitigate.core.seeding import generator
from mitigate.corruptions import Corruption, DepthSensor, Key, corrupt_observation, frame_files
from mitigate.corruptions.frame_files import count_suffixes, make_plan
from mitigate.corruptions.lerobot import is_dataset
from mitigate.worlds.episodes import read_episodes
from mitigate.worlds.world import Placeable

TRAIN, UNSEEN = "train", "unseen"
# maximum number of frames per block if all frames are in one folder or episode (heuristic)
BLOCK = 50
# This is the minimum number of held-out blocks if all frames are in one folder (heuristic).
# The bootstrap for confidence intervals resamples these blocks instead of scenes.
FEWEST_UNSEEN = 5
# minimum fraction of valid depth that must be nearer than ``FARTHEST`` metres (heuristic)
NEAR = 0.05
# at least a fraction ``NEAR`` of the valid depth must exceed this many metres (heuristic)
NEAREST = 0.02
EVERY = 2  # only every second view of a panorama is used
LARGEST = 4096  # maximum side in pixels (heuristic)


@dataclass(frozen=True)
class Shot:
    """One frame."""

    frame: np.ndarray  # uint8 [H, W, 3] or float32 metres [H, W, 1]
    heading: float | None = None  # direction of the camera in radians (``core/observation.py``)
    labels: np.ndarray | None = None  # [L] in {0, 1}


@runtime_checkable
class Source(Protocol):
    """A source of frames; ``files`` is true if it reads files, which may be damaged or change."""

    files: bool

    def scenes(self, split: str) -> Sequence[str]:
        """Return the names of the scenes in a split."""

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        """Yield up to ``count`` frames of a scene; the same arguments give the same frames."""


class WorldFrames:
    """Source of single views from random poses in a world, which also returns ground-truth labels.

    Args:
        world: a ``Placeable`` world (``worlds/world.py``); its ``scenes`` are used for training.
        sensor: "rgb" or "depth".
        unseen: an episode list, whose scenes are the unseen scenes.
        label: name of an entry of the ground truth ([views, L] or [L], with values 0 and 1), or
            None for no labels.

    Raises:
        ValueError: If the world cannot render from arbitrary poses or lacks the sensor, or if a
            scene is in both splits.
    """

    files = False

    def __init__(
        self, world: Any, sensor: str, unseen: str, label: str | None = "concepts"
    ) -> None:
        if not isinstance(world, Placeable):
            raise ValueError(
                f"{type(world).__name__} must be able to render from arbitrary poses. Define its "
                "members scenes, enter, point and put (mitigate/worlds/world.py), or save its "
                "frames as PNG and use env=frames env.path=FOLDER."
            )
        if sensor not in world.sensors:
            raise ValueError(
                f"{type(world).__name__} has no sensor {sensor}, only {', '.join(world.sensors)}. "
                "Set agent.sensor, or choose another world (env=...)."
            )
        self.world, self.sensor, self.label = world, sensor, label
        train = list(world.scenes)
        unseen_scenes = sorted({episode.scene_id for episode in read_episodes(find(unseen))})
        both = sorted(set(train) & set(unseen_scenes))
        if both:
            raise ValueError(
                f"The scenes {', '.join(both[:3])} are used for training, but {unseen} also lists "
                "them, and the report needs unseen scenes. Name another list "
                "(evaluation.split=...)."
            )
        self._scenes = {TRAIN: train, UNSEEN: unseen_scenes}

    def scenes(self, split: str) -> Sequence[str]:
        return self._scenes[split]

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        rng = generator(seed, "encoder frames", scene)
        self.world.enter(scene)
        shape = self.world.sensors[self.sensor].shape
        views = shape[0] if len(shape) == 4 else 1
        step = min(EVERY, views)
        while count > 0:
            heading = float(rng.uniform(-np.pi, np.pi))
            chosen = list(range(int(rng.integers(step)), views, step))[:count]
            xy = self.world.point(rng)
            entries, truth = self.world.put(xy, heading, views=chosen, rgb=self.sensor == "rgb")
            frames = entries[self.sensor].reshape(views, *shape[-3:])
            labels = None if self.label is None else truth[self.label]
            for view in chosen:
                view_labels = labels if labels is None or labels.ndim == 1 else labels[view]
                yaw = np.radians(VIEW_STEP_DEGREES) * view if views == VIEWS else 0.0
                yield Shot(frames[view].copy(), heading - yaw, view_labels)
            count -= len(chosen)


class FolderFrames:
    """Source of frames from the PNG, JPEG and NPY files of a folder and its subfolders.

    Each folder with frames is a scene. If ``mitigate run`` recorded the folder, the recorded scenes
    are used instead. If all frames are in one folder, they are split into blocks of consecutive
    frames, and each block counts as a scene. Files that cannot be used are reported. Depth that is
    not a positive number becomes 0.

    Args:
        path: the folder.
        sensor: "rgb" or "depth".
        size: side in pixels to which frames are resized. If it is None, frames are not resized, and
            all frames must have the same size.
        held_out: fraction of the scenes that are unseen. It has no effect if the paths of some
            scenes begin with "val" or "test": then exactly these scenes are unseen.
        unit: metres per count of a 16-bit PNG.

    Raises:
        FileNotFoundError: If the folder does not exist or contains no frame.
        ValueError: If an argument is out of range; if there are too few frames; or if a file is
            unreadable, does not hold depth in metres, or differs in size from the first file.
    """

    files = True

    def __init__(
        self,
        path: str | None,
        sensor: str = "rgb",
        size: int | None = None,
        held_out: float = 0.2,
        unit: float = 0.001,
    ) -> None:
        if path is None:
            raise FileNotFoundError("env.path is not set. Name the folder of the frames.")
        check_options(size, held_out, unit)
        self.path, self.sensor, self.size, self.unit = Path(path), sensor, size, unit
        self.held_out = held_out
        self._first: tuple[Path, tuple[int, ...]] | None = None  # path and shape of the first frame
        if not self.path.is_dir():
            raise FileNotFoundError(
                f"There is no folder {path}. Name the folder of the frames: env.path=FOLDER."
            )
        if is_dataset(path):
            raise ValueError(
                f"{path} is a LeRobot dataset: env=lerobot env.path={path} reads its frames."
            )
        self._files = self._find_files()

    def scenes(self, split: str) -> Sequence[str]:
        files = self._files
        unseen = [name for name in files if name.lower().startswith(("val", "test"))]
        unseen = unseen or last_scenes(list(files), self.held_out)
        train = [name for name in files if name not in unseen]
        if not unseen or not train:
            raise ValueError(
                f"{self.path} has {len(files)} scenes (frames: {sum(map(len, files.values()))}, "
                f"{self.left_out}), but training frames and unseen frames must come from different "
                "scenes. Make one subfolder per scene (a name that begins with val or test marks "
                "an unseen scene), or add more frames."
            )
        return train if split == TRAIN else unseen

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        files = self._files[scene]
        rng = generator(seed, "encoder frames", scene)
        chosen = sorted(rng.permutation(len(files))[:count])
        for index in chosen:
            yield Shot(self._read(files[index]))

    def _find_files(self) -> dict[str, list[Path]]:
        """Return the files of each scene, sorted by name."""
        plan = make_plan(self.path, None, (self.sensor,), "folder")
        recorded = (self.path / RECORDING).is_file()  # <scene>/<episode>/<camera>/000000.png
        scenes: dict[str, list[Path]] = {}
        for frame in plan.frames:
            if frame.path.as_posix() not in plan.left_out:
                scene = frame.path.parts[0] if recorded else frame.episode
                scenes.setdefault(scene, []).append(self.path / frame.path)
        self.left_out = _left_out(plan.left_out)
        if not scenes:
            other = count_suffixes(plan.other_files) or "none"
            raise FileNotFoundError(
                f"{self.path} contains no {self.sensor} frames (frames of the other sensor: "
                f"{plan.other_modality}; {self.left_out}; other files: {other}). docs/encoder.md "
                "lists the formats."
            )
        if plan.left_out:
            say(f"{self.path}: {self.left_out}")
        return split_single(scenes, self.held_out)

    def _read(self, path: Path) -> np.ndarray:
        try:
            frame = frame_files.read(path, self.unit)
            if self.sensor == frame_files.DEPTH:
                frame = _metres(frame)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} {error}. Fix it, or remove it from the folder.") from error
        frame = resized(frame, self.size)
        self._first = self._first or (path, frame.shape)
        first, shape = self._first
        if frame.shape != shape:
            raise ValueError(
                f"{path} has {frame.shape[0]} x {frame.shape[1]} pixels, but {first} has "
                f"{shape[0]} x {shape[1]}. Set env.size=PIXELS to resize all frames."
            )
        return frame


Item = TypeVar("Item")


def last_scenes(names: Sequence[str], held_out: float) -> list[str]:
    """Return the last scenes: a fraction ``held_out`` of all scenes, but at least one.

    If there is only one scene, the list is empty.
    """
    count = max(1, round(held_out * len(names)))
    return list(names)[-count:] if len(names) > 1 else []


def split_single(scenes: Mapping[str, list[Item]], held_out: float) -> dict[str, list[Item]]:
    """Split a single scene into blocks of consecutive frames; return several scenes unchanged.

    A block has at most ``BLOCK`` frames, or fewer if otherwise fewer than ``FEWEST_UNSEEN`` blocks
    would be held out.

    Args:
        scenes: frames of each scene.
        held_out: fraction of the blocks that are held out.
    """
    if len(scenes) > 1:
        return dict(scenes)
    ((name, frames),) = scenes.items()
    size = max(1, min(BLOCK, int(len(frames) * held_out / FEWEST_UNSEEN)))
    starts = range(0, len(frames), size)
    return {f"{name}#{at // size:04d}": frames[at : at + size] for at in starts}


def resized(frame: np.ndarray, size: int | None) -> np.ndarray:
    """Resize a frame to [size, size, C]; if ``size`` is None, keep its size."""
    if size is not None and frame.shape[:2] != (size, size):
        shrinks = size < max(frame.shape[:2])
        kind = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
        kind = cv2.INTER_NEAREST if frame.shape[-1] == 1 else kind  # keeps holes in depth
        frame = cv2.resize(frame, (size, size), interpolation=kind)
    return frame.reshape(*frame.shape[:2], -1)


def check_options(size: int | None, held_out: float, unit: float = 1.0) -> None:
    """Raise ValueError for the first invalid option."""
    for name, value, valid, words in (
        ("size", size, size is None or _is_side(size), f"1 to {LARGEST} pixels or null"),
        ("unit", unit, _is_between(unit, np.inf), "metres per count, such as 0.001 (mm)"),
        ("world.held_out", held_out, _is_between(held_out, 1), "a share above 0 and below 1"),
    ):
        if not valid:
            raise ValueError(f"env.{name} must be {words}, got {short(value)}.")


def _is_side(value: object) -> bool:
    return type(value) is int and 1 <= value <= LARGEST


def _is_between(value: object, below: float) -> bool:
    return isinstance(value, (int, float)) and 0 < value < below


def _metres(depth: np.ndarray) -> np.ndarray:
    """Set invalid depth to 0; raise ValueError if the other values are not plausible as metres.

    The message begins with a verb, because the caller puts the path of the file before it.
    """
    metres = np.where(np.isfinite(depth) & (depth > 0), depth, 0)
    known = metres[metres > 0]
    if len(known):
        low, high = np.quantile(known, (NEAR, 1 - NEAR))
        if low > FARTHEST or high < NEAREST:
            side = f"farther than {FARTHEST:g}" if low > FARTHEST else f"nearer than {NEAREST:g}"
            raise ValueError(
                f"must contain depth in metres, but most of it is {side} (median "
                f"{np.median(known):g}). For PNG, set env.unit to the metres per count (0.001 for "
                "millimetres). Convert NPY to metres"
            )
    return metres


def _left_out(files: Mapping[str, str]) -> str:
    """Return a message with the number of skipped files and one example per reason."""
    first = {why: name for name, why in reversed([*files.items()])}
    counted = Counter(files.values()).most_common(3)
    reasons = [f"{count} as {first[why]}, which {why}" for why, count in counted]
    return f"{len(files)} left out" + (f" ({'; '.join(reasons)})" if reasons else "")


def source_of(
    world: Callable[[], Any],
    sensor: str,
    episodes: Mapping[str, str] | None,
    split: str,
    label: str | None,
) -> Source:
    """Return the source of frames that an ``env`` config describes.

    If ``world()`` returns a source, such as a folder of frames, it is used. If it returns a world,
    frames are rendered from random poses in this world, and the scenes of the episode list
    ``split`` are the unseen scenes.

    Raises:
        ValueError: If the episode list does not exist, or the source cannot be used.
    """
    result = world()
    if isinstance(result, Source):
        return result
    if split not in (episodes or {}):
        raise ValueError(unknown("split", split, episodes or {}))
    return WorldFrames(result, sensor, (episodes or {})[split], label)


MOST_BYTES = 6 << 30  # maximum size of frames in memory (heuristic)


@dataclass
class Frames:
    """All frames of a split, which are kept in memory."""

    frames: np.ndarray  # uint8 [N, H, W, 3] or float32 metres [N, H, W, 1]
    headings: list[float | None]  # direction of each frame in radians, if it is known
    labels: np.ndarray | None  # [N, L] in {0, 1}
    scene: np.ndarray  # for each frame, the index of its scene in ``names``
    names: list[str]

    def __len__(self) -> int:
        return len(self.frames)

    def some(self, chosen: np.ndarray) -> Frames:
        """Return the frames with the indices ``chosen``, in that order."""
        labels = None if self.labels is None else self.labels[chosen]
        headings = [self.headings[index] for index in chosen]
        return Frames(self.frames[chosen], headings, labels, self.scene[chosen], self.names)

    def sha256(self) -> str:
        """Return 12 hex digits of the sha256 of all pixels."""
        return hashlib.sha256(np.ascontiguousarray(self.frames).data).hexdigest()[:12]


def corrupted(
    frames: Frames, index: int, corruption: Corruption, key: Key, sensor: DepthSensor
) -> np.ndarray:
    """Corrupt frame number ``index`` as if it were a single observation."""
    name = "depth" if frames.frames.dtype == np.float32 else "rgb"
    heading = frames.headings[index]
    pose = {} if heading is None else {POSE: np.array([0, 0, heading], np.float32)}
    observation = {name: frames.frames[index], **pose}
    return corrupt_observation(observation, corruption, key, sensor)[name]


def collect(source: Source, split: str, count: int, seed: int) -> Frames:
    """Return about ``count`` frames of a split, with the same number from each scene.

    A smaller ``count`` gives a subset of these frames.

    Raises:
        ValueError: If the frames differ in size, need too much memory, or are all black.
    """
    scenes = list(source.scenes(split))
    order = generator(seed, "encoder scenes", split).permutation(len(scenes))
    used = sorted(order[:count])
    each = [len(part) for part in np.array_split(np.arange(count), len(used))]
    shots: list[Shot] = []
    scene: list[int] = []
    with Progress(f"{split} frames", len(used), unit="scene") as progress:
        for index, number in zip(used, each, strict=True):
            shots += source.shots(scenes[index], number, seed)
            _check_sizes(shots, count)
            scene += [int(index)] * (len(shots) - len(scene))
            progress.advance()
    if not any(shot.frame.any() for shot in shots):
        raise ValueError(
            f"All {len(shots)} {split} frames are 0 in all pixels: they are black, or depth "
            "without valid pixels. Check the files, or the world's sensors."
        )
    labels = None if shots[0].labels is None else np.stack([s.labels for s in shots])  # type: ignore[misc]
    return Frames(
        np.stack([shot.frame for shot in shots]),
        [shot.heading for shot in shots],
        labels,
        np.array(scene),
        scenes,
    )


def _check_sizes(shots: list[Shot], count: int) -> None:
    """Raise ValueError if frames differ in size, or if they need too much memory."""
    sizes = {shot.frame.shape for shot in shots}
    if len(sizes) > 1:
        raise ValueError(
            f"The frames have several sizes ({', '.join(map(str, sorted(sizes)[:3]))}). Set "
            "env.size=PIXELS to resize all frames."
        )
    if shots and shots[0].frame.nbytes * count > MOST_BYTES:
        raise ValueError(
            f"{count} frames of {shots[0].frame.shape} need more than {MOST_BYTES >> 30} GB of "
            "memory. Set env.size=PIXELS, or use fewer frames "
            "(stages.encoder.recipe.frames=...)."
        )
