"""Where frames come from: a world that can look from anywhere, or a folder of files.

A source knows scenes in two splits that share none, ``TRAIN`` and ``UNSEEN``, and reads a number of
frames of each scene.
"""

from __future__ import annotations

import hashlib
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

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
from mitigate.worlds.episodes import read_episodes
from mitigate.worlds.world import Placeable

TRAIN, UNSEEN = "train", "unseen"
FEWEST_UNSEEN = 5  # blocks of a single folder, so that they show how much scenes differ (ours)
NEAR = 0.05  # share of a frame's depth that is nearer than ``FARTHEST``, if it is metres (ours)
NEAREST = 0.02  # metres; of a frame in metres more than a share ``NEAR`` is farther (ours)
LARGEST = 4096  # pixels of a side (ours)


@dataclass(frozen=True)
class Shot:
    """One frame, uint8 [H, W, 3] or float32 metres [H, W, 1]; the direction it looks in, in radians
    as ``core/observation.py`` has it, or None; labels in {0, 1} [L], or None."""

    frame: np.ndarray
    heading: float | None = None
    labels: np.ndarray | None = None


@runtime_checkable
class Source(Protocol):
    """Where frames come from; ``files``: from files, which may be damaged, or change."""

    files: bool

    def scenes(self, split: str) -> Sequence[str]:
        """Names of the scenes of a split."""

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        """Up to ``count`` frames of a scene: a function of the arguments."""


class WorldFrames:
    """Single views of random poses of a world, with the labels that it gives.

    Args:
        made: the world (``worlds/world.py``, Placeable); its ``scenes`` are trained in. sensor:
        "rgb" or "depth". unseen: an episode list whose scenes are the unseen ones. label: the entry
        of the truth, [views, L] or [L] in {0, 1}, None: no labels. every: of a panorama's views.
    Raises ValueError for a world that cannot look from anywhere or has no such sensor, and for
    scenes in both splits.
    """

    files = False

    def __init__(
        self, made: Any, sensor: str, unseen: str, label: str | None = "concepts", every: int = 2
    ) -> None:
        if not isinstance(made, Placeable):
            raise ValueError(
                f"{type(made).__name__} cannot look from anywhere (scenes, enter, point, put), so "
                "it gives no frames of random poses. Save frames of it as PNG and use env=frames "
                "env.path=FOLDER, or give the world these (docs/bring-your-own.md)."
            )
        if sensor not in made.sensors:
            raise ValueError(
                f"{type(made).__name__} shows no {sensor}, only {', '.join(made.sensors)}: set "
                "agent.sensor, or take another world (env=...)."
            )
        self.world, self.sensor, self.label, self.every = made, sensor, label, every
        train = list(made.scenes)
        held = sorted({episode.scene_id for episode in read_episodes(find(unseen))})
        both = sorted(set(train) & set(held))
        if both:
            raise ValueError(
                f"The scenes {', '.join(both[:3])} are trained in and listed in {unseen}: the "
                "report is of unseen scenes. Name another list (evaluation.split=...)."
            )
        self._scenes = {TRAIN: train, UNSEEN: held}

    def scenes(self, split: str) -> Sequence[str]:
        return self._scenes[split]

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        rng = generator(seed, "encoder frames", scene)
        self.world.enter(scene)
        shape = self.world.sensors[self.sensor].shape
        views = shape[0] if len(shape) == 4 else 1
        step = min(self.every, views)
        while count > 0:
            heading = float(rng.uniform(-np.pi, np.pi))
            shown = list(range(int(rng.integers(step)), views, step))[:count]
            xy = self.world.point(rng)
            looked, truth = self.world.put(xy, heading, views=shown, rgb=self.sensor == "rgb")
            frames = looked[self.sensor].reshape(views, *shape[-3:])
            labels = None if self.label is None else truth[self.label]
            for view in shown:
                own = labels if labels is None or labels.ndim == 1 else labels[view]
                yaw = np.radians(VIEW_STEP_DEGREES) * view if views == VIEWS else 0.0
                yield Shot(frames[view].copy(), heading - yaw, own)
            count -= len(shown)


class FolderFrames:
    """The PNG (and JPEG, and NPY depth) files of a folder and the folders in it.

    Args:
        path: the folder. sensor: "rgb" or "depth". Each folder with frames in it is a scene (of a
            recording by ``mitigate run``, each of its scenes); of a single one, each ``block``
            frames in the order of their names are, or fewer, so that five blocks are unseen.
        held_out: share of the scenes that are unseen; one whose path begins with "val" or "test"
            is, if there is one, and then no other.
        size: pixels of a side to which all are resized when they are read; None: as they are, which
            must then be one size. unit: metres of one count of a 16-bit PNG.
    Says which files are left out. Pixels of depth that are not above 0 or no number become 0.
    Raises FileNotFoundError if there is no folder or no frame, ValueError for other numbers than
    these can be, for too few frames, and for a file that cannot be read, holds no depth in metres
    or, with size None, has another size than the first one that was read.
    """

    files = True

    def __init__(
        self,
        path: str | None,
        sensor: str = "rgb",
        size: int | None = None,
        held_out: float = 0.2,
        block: int = 50,
        unit: float = 0.001,
    ) -> None:
        if path is None:
            raise FileNotFoundError("Name the folder that holds the frames: env.path=FOLDER.")
        _check(size, held_out, block, unit)
        self.path, self.sensor, self.size, self.unit = Path(path), sensor, size, unit
        self.held_out, self.block = held_out, block
        self._first: tuple[Path, tuple[int, ...]] | None = None  # that was read, and its shape
        if not self.path.is_dir():
            raise FileNotFoundError(
                f"There is no folder {path}: name the one that holds the frames, env.path=FOLDER."
            )
        self._files = self._found()

    def scenes(self, split: str) -> Sequence[str]:
        files = self._files
        named = [name for name in files if name.lower().startswith(("val", "test"))]
        if not named:
            count = max(1, round(self.held_out * len(files)))
            named = list(files)[-count:] if len(files) > 1 else []
        train = [name for name in files if name not in named]
        if not named or not train:
            raise ValueError(
                f"{self.path} has {len(files)} scenes (frames: {sum(map(len, files.values()))}, "
                f"{self.left_out}), and training and unseen frames must come from different ones: "
                "make folders in it, one a place (those called val... or test... are the unseen "
                "ones), or put more frames into it."
            )
        return train if split == TRAIN else named

    def shots(self, scene: str, count: int, seed: int) -> Iterator[Shot]:
        files = self._files[scene]
        rng = generator(seed, "encoder frames", scene)
        chosen = sorted(rng.permutation(len(files))[:count])
        for index in chosen:
            yield Shot(self._read(files[index]))

    def _found(self) -> dict[str, list[Path]]:
        """The files of each scene, in the order of their names."""
        plan = make_plan(self.path, None, self.sensor, "folder")
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
                f"{self.path} holds no {self.sensor} frames: {plan.other_modality} of the other "
                f"sensor, {self.left_out}, other files {other}. RGB is 8-bit RGB in PNG or JPEG, "
                "depth 16-bit grey PNG or NPY metres (agent.sensor=depth)."
            )
        if plan.left_out:
            say(f"{self.path}: {self.left_out}")
        if len(scenes) > 1:
            return scenes
        ((name, files),) = scenes.items()
        size = max(1, min(self.block, int(len(files) * self.held_out / FEWEST_UNSEEN)))
        starts = range(0, len(files), size)
        return {f"{name}#{at // size:04d}": files[at : at + size] for at in starts}

    def _read(self, path: Path) -> np.ndarray:
        try:
            frame = frame_files.read(path, self.unit)
            if self.sensor == frame_files.DEPTH:
                frame = _metres(frame)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} {error}. Mend it, or take it out of the folder.") from error
        if self.size is not None and frame.shape[:2] != (self.size, self.size):
            shrinks = self.size < max(frame.shape[:2])
            kind = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
            kind = cv2.INTER_NEAREST if frame.shape[-1] == 1 else kind  # holes stay holes
            frame = cv2.resize(frame, (self.size, self.size), interpolation=kind)
        frame = frame.reshape(*frame.shape[:2], -1)
        self._first = self._first or (path, frame.shape)
        first, shape = self._first
        if frame.shape != shape:
            raise ValueError(
                f"{path} has {frame.shape[0]} x {frame.shape[1]} pixels, but {first} has "
                f"{shape[0]} x {shape[1]}: set env.size=PIXELS, to which all are resized."
            )
        return frame


def _check(size: int | None, held_out: float, block: int, unit: float) -> None:
    """Raise ValueError for what no folder can be read with."""
    for name, value, good, words in (
        ("size", size, size is None or _is_whole(size, LARGEST), f"1 to {LARGEST} pixels or null"),
        ("unit", unit, _is_between(unit, np.inf), "metres of one count, such as 0.001 (mm)"),
        ("world.held_out", held_out, _is_between(held_out, 1), "a share above 0 and below 1"),
        ("world.block", block, _is_whole(block, sys.maxsize), "a number of frames from 1 on"),
    ):
        if not good:
            raise ValueError(f"env.{name}={short(value)} must be {words}.")


def _is_whole(value: object, most: int) -> bool:
    return type(value) is int and 1 <= value <= most


def _is_between(value: object, below: float) -> bool:
    return isinstance(value, (int, float)) and 0 < value < below


def _metres(depth: np.ndarray) -> np.ndarray:
    """Depth with holes as 0. Raises ValueError, the reason, for what cannot be metres."""
    held = np.where(np.isfinite(depth) & (depth > 0), depth, 0)
    known = held[held > 0]
    if len(known) and np.quantile(known, NEAR) > FARTHEST:
        raise ValueError(
            f"is no depth in metres: most of it is farther away than {FARTHEST:g}, the middle "
            f"{np.median(known):g}. Divide NPY by 1000 if it is millimetres; env.unit is the "
            "metres of one count of a PNG"
        )
    if len(known) and np.quantile(known, 1 - NEAR) < NEAREST:
        raise ValueError(
            f"is no depth in metres: most of it is nearer than {NEAREST:g}, the middle "
            f"{np.median(known):g}. env.unit is the metres of one count of a PNG, 0.001 if these "
            "are millimetres"
        )
    return held


def _left_out(files: Mapping[str, str]) -> str:
    """In words how many files are left out, each reason with the first of them."""
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
    """The source of an ``env`` config: what its ``world`` makes, if that is a source (a folder of
    frames), or the random poses of a world, with the scenes of its list ``split`` as the unseen
    ones. Raises ValueError for a list that there is not, and as these do."""
    made = world()
    if isinstance(made, Source):
        return made
    if split not in (episodes or {}):
        raise ValueError(unknown("split", split, episodes or {}))
    return WorldFrames(made, sensor, (episodes or {})[split], label)


MOST_BYTES = 6 << 30  # of frames in memory (ours)


@dataclass
class Frames:
    """frames uint8 [N, H, W, 3] or float32 [N, H, W, 1]; headings and labels or None; scene: of
    each frame, a number; names: the scenes."""

    frames: np.ndarray
    headings: list[float | None]
    labels: np.ndarray | None
    scene: np.ndarray
    names: list[str]

    def __len__(self) -> int:
        return len(self.frames)

    def some(self, chosen: np.ndarray) -> Frames:
        """Those of the numbers ``chosen``, in their order."""
        labels = None if self.labels is None else self.labels[chosen]
        headings = [self.headings[index] for index in chosen]
        return Frames(self.frames[chosen], headings, labels, self.scene[chosen], self.names)

    def sha256(self) -> str:
        """The first 12 hex digits of the sha256 of all pixels."""
        return hashlib.sha256(np.ascontiguousarray(self.frames).data).hexdigest()[:12]


def corrupted(
    frames: Frames, index: int, corruption: Corruption, key: Key, sensor: DepthSensor
) -> np.ndarray:
    """Frame ``index`` under a corruption, an instant of its own."""
    name = "depth" if frames.frames.dtype == np.float32 else "rgb"
    heading = frames.headings[index]
    pose = {} if heading is None else {POSE: np.array([0, 0, heading], np.float32)}
    shot = {name: frames.frames[index], **pose}
    return corrupt_observation(shot, corruption, key, sensor)[name]


def collect(source: Source, split: str, count: int, seed: int) -> Frames:
    """About ``count`` frames of a split, as many from each scene; fewer frames are some of these.
    Raises ValueError for frames of several sizes, too many for the memory, or all black."""
    scenes = list(source.scenes(split))
    order = generator(seed, "encoder scenes", split).permutation(len(scenes))
    used = sorted(order[:count])
    each = [len(part) for part in np.array_split(np.arange(count), len(used))]
    shots: list[Shot] = []
    scene: list[int] = []
    with Progress(f"{split} frames", len(used), unit="scene") as progress:
        for index, number in zip(used, each, strict=True):
            found = list(source.shots(scenes[index], number, seed))
            _check_found(found, shots, count)
            shots += found
            scene += [int(index)] * len(found)
            progress.advance()
    if not any(shot.frame.any() for shot in shots):
        raise ValueError(
            f"All of the {len(shots)} {split} frames are 0 everywhere: black, or depth without a "
            "pixel that is a number of metres. Look at the files, or at the world's sensors."
        )
    labels = None if shots[0].labels is None else np.stack([s.labels for s in shots])  # type: ignore[misc]
    return Frames(
        np.stack([shot.frame for shot in shots]),
        [shot.heading for shot in shots],
        labels,
        np.array(scene),
        scenes,
    )


def _check_found(found: list[Shot], shots: list[Shot], count: int) -> None:
    sizes = {shot.frame.shape for shot in (*shots[:1], *found)}
    if len(sizes) > 1:
        raise ValueError(
            f"The frames have several sizes ({', '.join(map(str, sorted(sizes)[:3]))}): set "
            "env.size=PIXELS, to which all are resized."
        )
    if found and found[0].frame.nbytes * count > MOST_BYTES:
        raise ValueError(
            f"{count} frames of {found[0].frame.shape} need more than {MOST_BYTES >> 30} GB of "
            "memory: set env.size=PIXELS, or fewer frames (stages.encoder.recipe.frames=...)."
        )
