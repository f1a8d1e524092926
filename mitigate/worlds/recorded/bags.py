"""Bags of ROS 1 (``.bag``), ROS 2 (a folder with ``metadata.yaml``) and MCAP, read by ``rosbags``.

Nothing of ROS need be installed. Read are images (``sensor_msgs`` Image and CompressedImage),
``CameraInfo`` and poses (``nav_msgs/Odometry``, ``geometry_msgs/PoseStamped`` and
``PoseWithCovarianceStamped``) in REP 103's axes: x ahead, y to the left, z up. Times are those of
the messages' headers, where they have one. A text file beside the bag, with its name and ``.txt``,
may hold the words.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.worlds.recorded.messages import camera_matrix, image, lens, place, stamp
from mitigate.worlds.recorded.source import LONGEST, SLOP, Lens, near, placed, words
from mitigate.worlds.recorded.unpacking import bounded

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO = "sensor_msgs/msg/CameraInfo"
POSES = (
    *("nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"),
    "geometry_msgs/msg/PoseWithCovarianceStamped",
)
OFF = "none"  # in place of a topic: it is not read
_DEEP = re.compile(r"(?:^|[/_])depth(?:$|/|_(?!camera))")  # /depth_camera/image_raw is in colour
_OTHER = re.compile(r"infra|mask|(?:^|[/_])ir(?:$|[/_])")

KINDS = (RGB, DEPTH)
MOST_POSES = 16 * LONGEST  # of a drive (ours): 500 Hz beside images at 30 Hz
LARGEST_HELD = 1 << 30  # bytes of images that wait for those of another topic (ours)


class Bag:
    """A drive in a bag; the rest as ``source.py`` says of a Source.

    Args: path: a file or a folder. topics: of what is read. hfov: degrees, of cameras without
    CameraInfo. yaw: degrees to the right of the robot's heading that its cameras look.
    Raises ValueError for a bag that is damaged or has no such topics, and without ``rosbags``.
    """

    stepped = False

    def __init__(self, path: Path, topics: Topics, hfov: float | None, yaw: float = 0.0) -> None:
        place = path.resolve()  # of `.`, too
        self.path, self.name = path, place.name if path.is_dir() else path.stem
        self.instruction = words(place.parent / f"{self.name}.txt")
        with self._open() as reader:
            there = {name: info.msgtype for name, info in reader.topics.items()}
            self.topics = chosen(path, there, topics)
            self.kinds = [kind for kind in KINDS if kind in self.topics]
            stamps, places, lenses = self._index(reader, hfov)
        if hfov is not None and all(kind in lenses for kind in self.kinds):
            raise ValueError(f"{path} says how wide its cameras see: leave hfov= out.")
        self._pair(stamps, places, yaw)
        self.cameras: Mapping[str, Lens] = {
            kind: lenses[kind] if kind in lenses else self._wide(kind, hfov) for kind in self.kinds
        }

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        wanted = {kind: [int(self.paired[kind][i]) for i in chosen] for kind in self.kinds}
        last = {kind: {n: at for at, n in enumerate(w)} for kind, w in wanted.items()}
        held: dict[str, dict[int, np.ndarray]] = {kind: {} for kind in self.kinds}
        given, counts = 0, dict.fromkeys(self.kinds, -1)
        with self._open() as reader:
            decode = {kind: set(numbers) for kind, numbers in wanted.items()}
            for kind, _, message in self._messages(reader, self.kinds, decode):
                counts[kind] += 1
                if message is not None:
                    held[kind][counts[kind]] = image(message, kind, self.path)
                    self._check_held(held)
                while given < len(chosen) and all(wanted[k][given] in held[k] for k in self.kinds):
                    yield {k: held[k][wanted[k][given]] for k in self.kinds}
                    given += 1
                    for k in self.kinds:  # drop what no later instant shows
                        held[k] = {n: f for n, f in held[k].items() if last[k][n] >= given}

    def _check_held(self, held: Mapping[str, dict[int, np.ndarray]]) -> None:
        if sum(frame.nbytes for there in held.values() for frame in there.values()) > LARGEST_HELD:
            raise ValueError(
                f"{self.path}: images of one instant lie too far apart in the bag (over "
                f"{LARGEST_HELD >> 30} GiB of others are between them). Write it anew in the order "
                "of time, or leave one out (topics.depth=none)."
            )

    # ----------------------------------------------------------------------------- reading

    @contextmanager
    def _open(self) -> Iterator[Any]:
        """An open reader; whatever it says of a file from outside is the reason."""
        try:
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore
        except ModuleNotFoundError as error:
            raise ValueError(
                "Bags are read by rosbags, which is not installed: pip install -e '.[bags]'."
            ) from error
        try:
            usual = get_typestore(Stores.ROS2_HUMBLE)
            with (
                bounded(self.path),
                AnyReader([self.path], default_typestore=usual) as reader,
            ):
                yield reader
        except OSError:
            raise
        except Exception as error:
            if isinstance(error, ValueError) and str(self.path) in str(error):  # ours
                raise
            said = " ".join(str(error).split())[:300]
            raise ValueError(
                f"{self.path} cannot be read as a bag: {said}. One whose end is missing is "
                "mended by `rosbag reindex` (ROS 1), `ros2 bag reindex` or `mcap recover`."
            ) from error

    def _messages(
        self, reader: Any, names: Sequence[str], decode: Mapping[str, set[int]]
    ) -> Iterator[tuple[str, tuple[float, float], Any]]:
        """(name, seconds, message) of these topics in the order of the bag. seconds: by the header
        and as received. ``decode``: which of a name's messages are wanted, counted from 0; the
        others are None; names not in it: all."""
        by_topic: dict[str, list[str]] = {}
        for name in names:
            by_topic.setdefault(self.topics[name], []).append(name)
        connections = [c for c in reader.connections if c.topic in by_topic]
        counts = dict.fromkeys(names, -1)
        for connection, received, raw in reader.messages(connections=connections):
            times = stamp(raw, reader.is2), received / 1e9
            for name in by_topic[connection.topic]:
                counts[name] += 1
                needed = name not in decode or counts[name] in decode[name]
                message = reader.deserialize(raw, connection.msgtype) if needed else None
                yield name, times, message

    def _index(
        self, reader: Any, hfov: float | None
    ) -> tuple[dict[str, list[float]], list[tuple[float, ...]], dict[str, Lens]]:
        """When each image was taken, (time, x, y, heading) of each pose, and the lenses."""
        stamps: dict[str, list[tuple[float, float]]] = {name: [] for name in (*self.kinds, POSE)}
        places: list[tuple[float, ...]] = []
        lenses: dict[str, Lens] = {}
        images: dict[str, set[int]] = {kind: set() for kind in self.kinds}
        for name, times, message in self._messages(reader, list(self.topics), images):
            if name in stamps:
                stamps[name].append(times)
            if name in self.kinds and len(stamps[name]) > LONGEST:
                raise ValueError(f"{self.path} has more than {LONGEST} images: cut it.")
            if name == POSE:
                places.append(place(message))
                if len(places) > MOST_POSES:
                    raise ValueError(f"{self.path} has more than {MOST_POSES} poses: cut it.")
            elif name not in self.kinds:
                kind = name.removeprefix("info ")
                unusable = kind not in lenses and hfov is not None and not message_focal(message)
                if kind not in lenses and not unusable:
                    lenses[kind] = lens(kind, message, self.path)
        taken = {name: _times(listed) for name, listed in stamps.items()}
        timed = zip(taken.pop(POSE), places, strict=True)
        return taken, [(time, *where) for time, where in timed], lenses

    def _wide(self, kind: str, hfov: float | None) -> Lens:
        if hfov is None:
            option = "info" if kind == RGB else "depth_info"
            raise ValueError(
                f"{self.path} has no CameraInfo for {self.topics[kind]}, so nobody knows how wide "
                f"it sees: give hfov=69 (degrees, horizontally), or topics.{option}=TOPIC."
            )
        return Lens(kind, hfov)

    def _pair(
        self, stamps: Mapping[str, list[float]], places: Sequence[tuple[float, ...]], yaw: float
    ) -> None:
        """Set times, poses and, of each instant, the index of each camera's image."""
        for kind, found in stamps.items():
            if not found:
                raise ValueError(
                    f"{self.path} has no message on {self.topics[kind]}; topics.{kind}=none leaves "
                    "it out."
                )
        if POSE in self.topics and not places:
            raise ValueError(
                f"{self.path} has no message on {self.topics[POSE]}; topics.pose=none goes without."
            )
        order = {kind: np.argsort(found, kind="stable") for kind, found in stamps.items()}
        times = np.sort(stamps[self.kinds[0]])
        kept = np.ones(len(times), bool)
        paired = {}
        for kind, found in stamps.items():
            nearest, away = near(times, np.sort(found))
            paired[kind] = order[kind][nearest]
            kept &= away <= SLOP
        poses = None
        if places:
            poses, known = placed(times, np.array(places))
            poses[:, 2] -= math.radians(yaw)
            kept &= known
        if not kept.any():
            raise ValueError(
                f"{self.path}: no image has one of each other topic near it in time (images "
                f"{len(times)}, poses {len(places)}). Choose others: topics.rgb=, topics.depth=, "
                "topics.pose=."
            )
        self.times, self.poses = times[kept], None if poses is None else poses[kept]
        self.paired = {kind: index[kept] for kind, index in paired.items()}
        self.dropped = int((~kept).sum())


def _times(stamps: Sequence[tuple[float, float]]) -> list[float]:
    """Of a topic's messages (by the header, as received): by the header, if one says a time."""
    said = any(header for header, _ in stamps)
    return [header if said else received for header, received in stamps]


def message_focal(message: Any) -> bool:
    """Whether a CameraInfo states a focal length."""
    matrix = camera_matrix(message)
    return len(matrix) == 9 and bool(matrix[0] > 0)


@dataclass(frozen=True)
class Topics:
    """Names of topics; None: the only one there is that fits; "none": it is not read.

    info, depth_info: CameraInfo of the RGB and of the depth camera.
    """

    rgb: str | None = None
    depth: str | None = None
    pose: str | None = None
    info: str | None = None
    depth_info: str | None = None

    @property
    def given(self) -> list[str]:
        """The options that are set."""
        return [name for name, topic in vars(self).items() if topic is not None]


def chosen(path: Path, there: Mapping[str, str | None], topics: Topics) -> dict[str, str]:
    """The topic of each of "rgb", "depth", "pose", "info rgb" and "info depth" that there is.

    ``there``: the type of each topic. Raises ValueError for names that are not there or of another
    type, where several fit, and without images.
    """
    images = [name for name, kind in there.items() if kind in IMAGES and not _OTHER.search(name)]
    deep = [n for n in images if _DEEP.search(n) and n != topics.rgb]
    coloured = [n for n in images if n not in deep and n != topics.depth]
    placing = [name for name, kind in there.items() if kind in POSES]
    found = {
        RGB: _pick(path, RGB, topics.rgb, coloured, there, IMAGES),
        DEPTH: _pick(path, DEPTH, topics.depth, deep, there, IMAGES),
        POSE: _pick(path, POSE, topics.pose, placing, there, POSES),
    }
    if not (found[RGB] or found[DEPTH]):
        told = ", ".join(f"{name} ({kind})" for name, kind in list(there.items())[:12])
        raise ValueError(f"{path} has no topic with images. It has {told or 'no topic'}.")
    infos = [name for name, kind in there.items() if kind == INFO]
    for kind, option, named in (
        (RGB, "info", topics.info),
        (DEPTH, "depth_info", topics.depth_info),
    ):
        if found[kind]:
            beside = _beside(str(found[kind]), infos)
            found[f"info {kind}"] = _pick(path, option, named, beside, there, (INFO,))
    return {name: topic for name, topic in found.items() if topic}


def _pick(
    path: Path,
    option: str,
    named: str | None,
    fitting: Sequence[str],
    there: Mapping[str, str | None],
    kinds: Sequence[str],
) -> str | None:
    """The topic that is named, or the only one that fits; None if none does."""
    if named == OFF:
        return None
    if named is not None:
        if named not in there:
            raise ValueError(f"{path}: {unknown('topic', named, there)}")
        if there[named] not in kinds:
            raise ValueError(
                f"{path}: topics.{option}={named} is a {there[named]}, not {' or '.join(kinds)}."
            )
        return named
    if len(fitting) > 1:
        raise ValueError(
            f"{path} has several topics for {option}: {', '.join(fitting)}. Choose one: "
            f"topics.{option}={fitting[0]} (or {OFF})"
        )
    return fitting[0] if fitting else None


def _beside(topic: str, infos: Sequence[str]) -> list[str]:
    """The CameraInfo beside an image topic, by ROS's custom ``<camera>/camera_info``, or the only
    one below the same first name."""
    above = topic
    while "/" in above.strip("/"):
        above = above.rpartition("/")[0]
        if f"{above}/camera_info" in infos:
            return [f"{above}/camera_info"]
    camera = "/" + topic.strip("/").partition("/")[0] + "/"
    return [info for info in infos if info.startswith(camera)][:2]
