"""Bags of ROS 1 (``.bag``), ROS 2 (a folder with ``metadata.yaml``) and MCAP, read by ``rosbags``.

Nothing of ROS need be installed. Read are images (``sensor_msgs`` Image and CompressedImage),
``CameraInfo`` and poses (``nav_msgs/Odometry``, ``geometry_msgs/PoseStamped`` and
``PoseWithCovarianceStamped``) in REP 103's axes: x ahead, z up. A text file beside the bag,
with its name and ``.txt``, may hold the words.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.worlds.recorded.messages import image, lens, place
from mitigate.worlds.recorded.source import LONGEST, SLOP, Lens, between, near, words

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO = "sensor_msgs/msg/CameraInfo"
POSES = (
    *("nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"),
    "geometry_msgs/msg/PoseWithCovarianceStamped",
)


@dataclass(frozen=True)
class Topics:
    """Names of topics; None: the only one there is that fits."""

    rgb: str | None = None
    depth: str | None = None
    pose: str | None = None
    info: str | None = None  # of the RGB camera


class Bag:
    """A drive in a bag; the rest as ``source.py`` says of a Source.

    Args: path: a file or a folder. topics: of what is read. hfov: degrees, where the bag has no
    CameraInfo. Raises ValueError for a bag that is damaged or has no such topics, and
    ModuleNotFoundError, saying what to do, without ``rosbags``.
    """

    stepped = False

    def __init__(self, path: Path, topics: Topics, hfov: float | None) -> None:
        self.path, self.name, self.instruction = path, path.stem, words(path.with_suffix(".txt"))
        with self._open() as reader:
            there = {name: info.msgtype for name, info in reader.topics.items()}
            self.images = _images(path, there, topics)
            placing = [name for name, kind in there.items() if kind in POSES]
            pose = _pick(path, "pose", topics.pose, placing, there)
            infos = [name for name, kind in there.items() if kind == INFO]
            named = topics.info
            info = {kind: _info_of(topic, infos, named) for kind, topic in self.images.items()}
            stamps, places, lenses = self._index(reader, pose, info)
        self._pair(stamps, places)
        wide = {kind: Lens(kind, 90.0 if hfov is None else hfov) for kind in self.images}
        if hfov is not None:
            lenses = {}
        elif lacking := [topic for kind, topic in self.images.items() if kind not in lenses]:
            raise ValueError(
                f"{path} has no CameraInfo for {lacking[0]}, so nobody knows how wide it sees: "
                "give hfov=69 (degrees, horizontally), or topics.info=TOPIC."
            )
        self.cameras: Mapping[str, Lens] = wide | lenses

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        wanted = {kind: {int(self.paired[kind][i]) for i in chosen} for kind in self.images}
        held: dict[str, dict[int, np.ndarray]] = {kind: {} for kind in self.images}
        waiting = list(chosen)
        with self._open() as reader:
            counts = dict.fromkeys(self.images, -1)
            for kind, _, message in self._messages(reader, dict(self.images), decode=wanted):
                counts[kind] += 1
                if message is not None:
                    held[kind][counts[kind]] = image(message, kind, self.path)
                while waiting and all(
                    int(self.paired[k][waiting[0]]) in held[k] for k in self.images
                ):
                    first = waiting.pop(0)
                    yield {k: held[k][int(self.paired[k][first])] for k in self.images}
                    self._forget(held, waiting)

    def _forget(self, held: dict[str, dict[int, np.ndarray]], waiting: Sequence[int]) -> None:
        """Drop the frames that no later instant shows."""
        for kind, frames in held.items():
            least = int(self.paired[kind][waiting[0]]) if waiting else 1 << 62
            for index in [i for i in frames if i < least]:
                del frames[index]

    # ----------------------------------------------------------------------------- reading

    @contextmanager
    def _open(self) -> Iterator[Any]:
        """An open reader; whatever it says of a file from outside is the reason."""
        try:
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore
        except ModuleNotFoundError as error:
            raise ModuleNotFoundError(
                "Bags are read by rosbags, which is not installed: pip install 'mitigate[bags]'."
            ) from error
        try:
            usual = get_typestore(Stores.ROS2_HUMBLE)
            with AnyReader([self.path], default_typestore=usual) as reader:
                yield reader
        except OSError:
            raise
        except Exception as error:
            if isinstance(error, ValueError) and str(self.path) in str(error):  # ours
                raise
            raise ValueError(f"{self.path} cannot be read as a bag: {error}.") from error

    def _messages(
        self, reader: Any, topics: Mapping[str, str], decode: Mapping[str, set[int]] | None = None
    ) -> Iterator[tuple[str, float, Any]]:
        """(kind, seconds, message) in order; of those that ``decode`` does not list, None."""
        kinds = {topic: kind for kind, topic in topics.items()}
        chosen = [c for c in reader.connections if c.topic in kinds]
        counts = dict.fromkeys(topics, -1)
        for connection, stamp, raw in reader.messages(connections=chosen):
            kind = kinds[connection.topic]
            counts[kind] += 1
            needed = decode is None or counts[kind] in decode.get(kind, ())
            message = reader.deserialize(raw, connection.msgtype) if needed else None
            yield kind, stamp / 1e9, message

    def _index(
        self, reader: Any, pose: str | None, info: Mapping[str, str | None]
    ) -> tuple[dict[str, list[float]], list[tuple[float, ...]], dict[str, Lens]]:
        """When each image was taken, (time, x, y, heading) of each pose, and the lenses."""
        topics = dict(self.images) | ({"pose": pose} if pose else {})
        topics |= {f"info {kind}": topic for kind, topic in info.items() if topic}
        stamps: dict[str, list[float]] = {kind: [] for kind in self.images}
        places: list[tuple[float, ...]] = []
        lenses: dict[str, Lens] = {}
        shared = _by_topic(topics)
        read = {kind: set(range(LONGEST)) for kind in shared if kind not in self.images}
        for name, time, message in self._messages(reader, shared, decode=read):
            if name in stamps:
                stamps[name].append(time)
                if len(stamps[name]) > LONGEST:
                    raise ValueError(f"{self.path} has more than {LONGEST} images: cut it.")
            elif name == "pose":
                places.append((time, *place(message)))
            else:
                for kind in name.removeprefix("info ").split("+"):
                    lenses.setdefault(kind, lens(kind, message, self.path))
        return stamps, places, lenses

    def _pair(self, stamps: Mapping[str, list[float]], places: Sequence[tuple[float, ...]]) -> None:
        """Set times, poses and, of each instant, the index of each camera's image."""
        for kind, found in stamps.items():
            if not found:
                raise ValueError(f"{self.path} has no message on {self.images[kind]}.")
        leading = RGB if RGB in stamps else DEPTH
        times = np.array(stamps[leading])
        kept = np.ones(len(times), bool)
        paired = {}
        for kind, found in stamps.items():
            paired[kind], away = near(times, np.array(found))
            kept &= away <= SLOP
        poses = None
        if places:
            table = np.array(sorted(places))
            kept &= near(times, table[:, 0])[1] <= SLOP
            poses = between(times, table[:, 0], table[:, 1:])[kept]
        if not kept.any():
            raise ValueError(
                f"{self.path}: no image has one of each other topic within {SLOP} s (images "
                f"{len(times)}, poses {len(places)}). Choose others: topics.rgb=, topics.depth=, "
                "topics.pose=."
            )
        self.times, self.poses = times[kept], poses
        self.paired = {kind: index[kept] for kind, index in paired.items()}


def _by_topic(topics: Mapping[str, str]) -> dict[str, str]:
    """As ``topics``, but for one CameraInfo of both cameras: "info rgb+depth"."""
    found: dict[str, str] = {}
    for kind, topic in topics.items():
        before = next((k for k, t in found.items() if t == topic and k.startswith("info")), None)
        if before:
            found[f"{before}+{kind.removeprefix('info ')}"] = found.pop(before)
        else:
            found[kind] = topic
    return found


def _images(path: Path, there: Mapping[str, str | None], topics: Topics) -> dict[str, str]:
    """The topics of RGB and depth images, those that there are."""
    listed = [name for name, kind in there.items() if kind in IMAGES]
    deep = [name for name in listed if "depth" in name.lower()]
    coloured = [name for name in listed if name not in deep and not re.search("infra|mask", name)]
    rgb = _pick(path, RGB, topics.rgb, coloured, there)
    depth = _pick(path, DEPTH, topics.depth, deep, there)
    found = {kind: name for kind, name in ((RGB, rgb), (DEPTH, depth)) if name}
    if not found:
        raise ValueError(f"{path} has no topic with images. It has {_told(there)}.")
    return found


def _pick(
    path: Path,
    what: str,
    named: str | None,
    fitting: Sequence[str],
    there: Mapping[str, str | None],
) -> str | None:
    """The topic that is named, or the only one that fits; None if none does."""
    if named is not None:
        if named not in there:
            raise ValueError(f"{path}: {unknown('topic', named, there)}")
        return named
    if len(fitting) > 1:
        raise ValueError(
            f"{path} has several topics for {what}: {', '.join(fitting)}. Choose one: "
            f"topics.{what}={fitting[0]}"
        )
    return fitting[0] if fitting else None


def _info_of(topic: str, infos: Sequence[str], named: str | None) -> str | None:
    """The CameraInfo beside an image topic, by ROS's custom ``<camera>/camera_info``."""
    if named is not None:
        return named
    while "/" in topic.strip("/"):
        topic = topic.rpartition("/")[0]
        if f"{topic}/camera_info" in infos:
            return f"{topic}/camera_info"
    return infos[0] if len(infos) == 1 else None


def _told(there: Mapping[str, str | None]) -> str:
    return ", ".join(f"{name} ({kind})" for name, kind in list(there.items())[:12]) or "no topic"
