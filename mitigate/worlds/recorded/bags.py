"""Read drives from bags of ROS 1 (``.bag``), ROS 2 (a folder with ``metadata.yaml``) and MCAP.

The package ``rosbags`` reads them; ROS need not be installed. Images (``sensor_msgs`` Image and
CompressedImage), ``CameraInfo`` and poses (``nav_msgs/Odometry``, ``geometry_msgs/PoseStamped`` and
``PoseWithCovarianceStamped``) are read. Poses use the axes of REP 103: x forward, y left, z up.
Times are read from the headers of the messages, if they have headers. A text file next to the bag,
with its name and ``.txt``, may contain the instruction.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import lfs_problem
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.worlds.recorded.messages import (
    DamagedImage,
    camera_matrix,
    depth_unit,
    encoding_of,
    kind_of,
    read_image,
    read_lens,
    read_pose,
    read_stamp,
)
from mitigate.worlds.recorded.source import (
    MAX_FRAME_GAP,
    MAX_INSTANTS,
    Lens,
    Source,
    match_times,
    read_instruction,
)
from mitigate.worlds.recorded.unpacking import bounded

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO = "sensor_msgs/msg/CameraInfo"
POSES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
)
OFF = "none"  # value of a topic option that disables the topic
# this pattern does not match /depth_camera/image_raw
_DEPTH_TOPIC = re.compile(r"(?:^|[/_])depth(?:$|/|_(?!camera))")
# names of infrared images and masks
_OTHER_IMAGES = re.compile(r"infra|mask|(?:^|[/_])ir(?:$|[/_])")
# names of poses that are not the robot's position
_OTHER_POSES = re.compile(r"goal|target|waypoint|initial_?pose")

COMPRESSED = ("/compressed", "/compressedDepth")  # image_transport appends these to a topic
# the first bytes of each format, and a program that repairs it
FORMATS = {
    ".bag": (b"#ROSBAG V", "`rosbag reindex`"),
    ".mcap": (b"\x89MCAP0\r\n", "`mcap recover`"),
    ".db3": (b"SQLite format 3\0", "`sqlite3 OLD.db3 .recover | sqlite3 NEW.db3`"),
}

KINDS = (RGB, DEPTH)
# Heuristic limits.
MAX_POSES = 16 * MAX_INSTANTS  # maximum poses per drive: 500 Hz for images at 30 Hz
MAX_BUFFER_BYTES = 1 << 30  # maximum bytes of images that wait for images of another topic


class Bag(Source):
    """A drive in a bag.

    Args:
        path: Path of the bag, a file or a folder.
        topics: Topics to read.
        hfov: Horizontal field of view in degrees of cameras without CameraInfo.
        yaw: Direction of the cameras in degrees to the right of the robot's heading.
        unit: Metres per count of depth; None: 0.001 for whole numbers, 1 for 32FC1.
        tolerance: Maximum seconds between the messages of a time step; None: 0.1.

    Raises:
        ValueError: The bag is damaged or lacks a topic, or ``rosbags`` is not installed.
    """

    stepped = False

    def __init__(
        self,
        path: Path,
        topics: Topics,
        hfov: float | None,
        yaw: float = 0.0,
        unit: float | None = None,
        tolerance: float | None = None,
    ) -> None:
        resolved = path.resolve()  # resolved, because `.` has no name
        self.path = path
        self.unit = unit
        self.tolerance = MAX_FRAME_GAP if tolerance is None else tolerance
        self.signals = {}
        self.damaged = []
        self.name = resolved.name if path.is_dir() else path.stem
        self.instruction = read_instruction(resolved.parent / f"{self.name}.txt")
        with self._open() as reader:
            available = {name: info.msgtype for name, info in reader.topics.items()}
            counts = {name: info.msgcount for name, info in reader.topics.items()}
            encodings = self._read_encodings(reader)
            self.topics = choose_topics(path, available, topics, counts, encodings)
            self.kinds = [kind for kind in KINDS if kind in self.topics]
            stamps, poses, lenses = self._index(reader, hfov)
        if hfov is not None and all(kind in lenses for kind in self.kinds):
            raise ValueError(f"{path} contains the field of view of its cameras. Remove hfov=.")
        if unit is not None and DEPTH not in self.kinds:
            raise ValueError(f"{path} is read without depth. Remove unit=, or set topics.depth=.")
        self._match(stamps, poses, yaw)
        self.cameras = {
            kind: lenses[kind] if kind in lenses else self._lens_without_info(kind, hfov)
            for kind in self.kinds
        }
        self.formats = self._describe(encodings)

    def depth_advice(self) -> str:
        return "Set unit= (metres per count), such as unit=0.0001."

    def _describe(self, encodings: Mapping[str, str]) -> dict[str, str]:
        """Return the topic of each sensor, with the encoding of images and the unit of depth."""
        formats = {POSE: self.topics[POSE]} if POSE in self.topics else {}
        for kind in self.kinds:
            topic = self.topics[kind]
            encoding = encodings.get(topic, "")
            formats[kind] = f"{topic}, {encoding}"
            if kind == DEPTH:
                unit = depth_unit(encoding) if self.unit is None else self.unit
                assumed = " (assumed)" if self.unit is None else ""
                formats[kind] += f", {unit:g} metres per count{assumed}"
        return formats

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        indices = {kind: [int(self._image_numbers[kind][i]) for i in chosen] for kind in self.kinds}
        last_use = {kind: {n: at for at, n in enumerate(w)} for kind, w in indices.items()}
        buffer: dict[str, dict[int, np.ndarray | None]] = {kind: {} for kind in self.kinds}
        done = 0
        counts = dict.fromkeys(self.kinds, -1)
        self.damaged = []
        with self._open() as reader:
            decode = {kind: set(numbers) for kind, numbers in indices.items()}
            for kind, times, message in self._messages(reader, self.kinds, decode):
                counts[kind] += 1
                if message is not None:
                    buffer[kind][counts[kind]] = self._read_image(
                        message, kind, counts[kind], times
                    )
                    waiting = [image for images in buffer.values() for image in images.values()]
                    if sum(i.nbytes for i in waiting if i is not None) > MAX_BUFFER_BYTES:
                        raise ValueError(
                            f"{self.path}: images of the same time must be close together in the "
                            f"bag, but over {MAX_BUFFER_BYTES >> 30} GiB of others lie between "
                            "them. Write the bag again in the order of time, or leave one topic "
                            "out (topics.depth=none)."
                        )
                while done < len(chosen) and all(indices[k][done] in buffer[k] for k in self.kinds):
                    step = {k: buffer[k][indices[k][done]] for k in self.kinds}
                    images = {k: image for k, image in step.items() if image is not None}
                    yield images if len(images) == len(step) else {}
                    done += 1
                    for k in self.kinds:  # discards images that no later time step uses
                        buffer[k] = {n: f for n, f in buffer[k].items() if last_use[k][n] >= done}

    def _read_image(
        self, message: Any, kind: str, number: int, times: tuple[float, float]
    ) -> np.ndarray | None:
        """Return the image of a message, or None if it is damaged."""
        try:
            with self._explained():
                return read_image(message, kind, self.path, self.unit)
        except DamagedImage as error:
            seconds = (times[0] or times[1]) - self.times[0]
            self.damaged.append(
                f"message {number} on {self.topics[kind]}, {seconds:.1f} s after the start, is "
                f"damaged ({str(error).removeprefix(f'{self.path}: ').rstrip('.')})"
            )
            return None

    # ----------------------------------------------------------------------------- reading

    @contextmanager
    def _open(self) -> Iterator[Any]:
        """Open a reader."""
        try:
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore
        except ModuleNotFoundError as error:
            raise ValueError(
                "Bags need the package rosbags, which is not installed. Run pip install -e "
                "'.[bags]'."
            ) from error
        with ExitStack() as stack:
            with self._explained():
                default_types = get_typestore(Stores.ROS2_HUMBLE)
                stack.enter_context(bounded(self.path))
                reader: Any = AnyReader([self.path], default_typestore=default_types)
                for part in reader.readers:
                    part.open = partial(_open_part, part, part.open)
                stack.enter_context(reader)
            yield reader

    @contextmanager
    def _explained(self) -> Iterator[None]:
        """Convert errors caused by the content of the bag to a ValueError that names the bag."""
        try:
            yield
        except OSError:
            raise
        except Exception as error:
            if self.path.is_file() and (pointer := lfs_problem(self.path)):
                raise ValueError(f"{self.path} {pointer}.") from error
            if isinstance(error, ValueError) and str(self.path) in str(error):
                raise  # raised by this package, so it already names the bag
            reason = " ".join(str(error).split())[:300].rstrip(".")
            raise ValueError(
                f"{self.path} cannot be read as a bag: {reason}. {_repair_advice(self.path)}"
            ) from error

    def _read_encodings(self, reader: Any) -> dict[str, str]:
        """Return the encoding of the first image on each image topic."""
        encodings: dict[str, str] = {}
        for connection in reader.connections:
            if connection.msgtype in IMAGES and connection.topic not in encodings:
                with self._explained():
                    for _, _, raw in reader.messages(connections=[connection]):
                        message = reader.deserialize(raw, connection.msgtype)
                        encodings[connection.topic] = encoding_of(message)
                        break
        return encodings

    def _messages(
        self, reader: Any, names: Sequence[str], decode: Mapping[str, set[int]]
    ) -> Iterator[tuple[str, tuple[float, float], Any]]:
        """Yield the messages of some topics in their order in the bag.

        Args:
            reader: The open reader.
            names: Keys of ``self.topics``.
            decode: Indices of the messages to decode, by name; if a name has no entry, all are
                decoded.

        Yields:
            The name, the seconds (from the header, and as received), and the message or None.
        """
        by_topic: dict[str, list[str]] = {}
        for name in names:
            by_topic.setdefault(self.topics[name], []).append(name)
        connections = [c for c in reader.connections if c.topic in by_topic]
        counts = dict.fromkeys(names, -1)
        with self._explained():
            for connection, received, raw in reader.messages(connections=connections):
                times = read_stamp(raw, reader.is2), received / 1e9
                for name in by_topic[connection.topic]:
                    counts[name] += 1
                    needed = name not in decode or counts[name] in decode[name]
                    message = reader.deserialize(raw, connection.msgtype) if needed else None
                    yield name, times, message

    def _index(
        self, reader: Any, hfov: float | None
    ) -> tuple[dict[str, list[float]], list[tuple[float, ...]], dict[str, Lens]]:
        """Return the times of images, the poses (time, x, y, heading), and the lenses."""
        stamps: dict[str, list[tuple[float, float]]] = {name: [] for name in (*self.kinds, POSE)}
        poses: list[tuple[float, ...]] = []
        lenses: dict[str, Lens] = {}
        images: dict[str, set[int]] = {kind: set() for kind in self.kinds}
        for name, times, message in self._messages(reader, list(self.topics), images):
            if name in stamps:
                stamps[name].append(times)
                limit = MAX_POSES if name == POSE else MAX_INSTANTS
                if len(stamps[name]) > limit:
                    raise ValueError(
                        f"{self.path} must have at most {limit} messages on {self.topics[name]}. "
                        "Cut the recording."
                    )
            with self._explained():
                if name == POSE:
                    poses.append(read_pose(message))
                elif name not in self.kinds:
                    kind = name.removeprefix("info ")
                    usable = hfov is None or bool((camera_matrix(message)[:1] > 0).any())
                    if kind not in lenses and usable:
                        lenses[kind] = read_lens(kind, message, self.path)
        seconds = {name: _choose_clock(pairs) for name, pairs in stamps.items()}
        timed = zip(seconds.pop(POSE), poses, strict=True)
        return seconds, [(time, *pose) for time, pose in timed], lenses

    def _lens_without_info(self, kind: str, hfov: float | None) -> Lens:
        if hfov is None:
            option = "info" if kind == RGB else "depth_info"
            raise ValueError(
                f"{self.path} has no CameraInfo for {self.topics[kind]}, so its field of view is "
                f"unknown. Set hfov=69 (degrees, horizontal), or topics.{option}=TOPIC."
            )
        return Lens(kind, hfov)

    def _match(
        self, stamps: Mapping[str, list[float]], table: Sequence[tuple[float, ...]], yaw: float
    ) -> None:
        """For each time step, set the time, the pose and the index of each camera's image."""
        records: dict[str, Sequence] = {**stamps, **({POSE: table} if POSE in self.topics else {})}
        for name, messages in records.items():
            if not messages:
                raise ValueError(
                    f"{self.path} has no message on {self.topics[name]}. Set topics.{name}=none to "
                    "leave it out."
                )
        instants = match_times(stamps, np.array(table) if table else None, self.tolerance)
        if not len(instants.times):
            raise ValueError(f"{self.path}: {instants.mismatch(self.tolerance, self.topics)}")
        self.times = instants.times
        self.poses = instants.poses
        if self.poses is not None:
            self.poses[:, 2] -= math.radians(yaw)
        self.dropped = instants.dropped
        self._image_numbers = instants.frames


def _repair_advice(path: Path) -> str:
    """Return how to repair a bag that cannot be read."""
    files = [path] if path.is_file() else [f for f in path.iterdir() if f.suffix in FORMATS]
    for file in files:
        start, program = FORMATS.get(file.suffix, (b"", ""))
        with open(file, "rb") as stream:
            first = stream.read(len(start))
        if not first:
            return f"{file} is empty. Copy it again."
        if first != start:
            return f"{file} is not a {file.suffix} file: it starts with {first!r}. Copy it again."
        metadata = "" if path.is_file() else "`ros2 bag reindex` writes metadata.yaml again. "
        return f"{metadata}If {file.name} is cut short or damaged, repair a copy with {program}."
    return "Copy the folder again: it has no file with messages."


def _open_part(part: Any, open_: Callable[[], None]) -> None:
    """Open a reader of ``rosbags`` that parses only the definitions of the types that are read.

    Otherwise, one definition that ``rosbags`` cannot parse, such as a service event, would make the
    whole bag unreadable.
    """
    from rosbags.interfaces import MessageDefinition, MessageDefinitionFormat

    open_()
    none = MessageDefinition(MessageDefinitionFormat.NONE, "")
    part.connections[:] = [
        connection
        if connection.msgtype in (*IMAGES, INFO, *POSES)
        else connection._replace(msgdef=none)
        for connection in part.connections
    ]


def _choose_clock(stamps: Sequence[tuple[float, float]]) -> list[float]:
    """Return the times of the headers if any header has one, otherwise the times of receipt."""
    has_header = any(header for header, _ in stamps)
    return [header if has_header else received for header, received in stamps]


@dataclass(frozen=True)
class Topics:
    """The names of the topics in a bag. None means the only suitable topic, and "none" means that
    the topic is not read.

    Attributes:
        rgb: Images of the RGB camera.
        depth: Images of the depth camera.
        pose: Poses of the robot.
        info: CameraInfo of the RGB camera.
        depth_info: CameraInfo of the depth camera.
    """

    rgb: str | None = None
    depth: str | None = None
    pose: str | None = None
    info: str | None = None
    depth_info: str | None = None

    @property
    def set_options(self) -> list[str]:
        """The names of the topics that are not None."""
        return [name for name, topic in vars(self).items() if topic is not None]


def choose_topics(
    path: Path,
    available: Mapping[str, str | None],
    topics: Topics,
    counts: Mapping[str, int] | None = None,
    encodings: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """Choose the topics "rgb", "depth", "pose", "info rgb" and "info depth".

    Args:
        path: Path of the bag, for error messages.
        available: Message type of each topic in the bag.
        topics: The user's choice.
        counts: Number of messages of each topic, if known. If there is one message but several
            images, the topic contains no trajectory.
        encodings: Encoding of the first image of each topic, if known. Topics without a known
            encoding count as depth if their names say so.

    Returns:
        The topics by name, without topics that the bag lacks.

    Raises:
        ValueError: A chosen topic is missing or has a wrong type, several topics are suitable, or
            the bag contains no images.
    """
    counts = counts or {}
    images = [
        name
        for name, kind in available.items()
        if kind in IMAGES and not _OTHER_IMAGES.search(name)
    ]
    rgb, depth = _sort_images(_drop_copies(images, counts), topics, encodings or {})
    several = max((counts.get(name, 0) for name in images), default=0) > 1
    typed = [name for name, kind in available.items() if kind in POSES]
    others = [n for n in typed if _OTHER_POSES.search(n) or (several and counts.get(n) == 1)]
    poses = [name for name in typed if name not in others]
    if others and not poses and topics.pose is None:
        warnings.warn(
            f"{path} is read without poses: {', '.join(others)} seems to hold goals or single "
            f"poses, not the path of the robot. If it does, set topics.pose={others[0]}.",
            stacklevel=3,
        )
    found = {
        RGB: _candidates(path, RGB, topics.rgb, rgb, available, IMAGES),
        DEPTH: _candidates(path, DEPTH, topics.depth, depth, available, IMAGES),
        POSE: _candidates(path, POSE, topics.pose, poses, available, POSES),
    }
    if not (found[RGB] or found[DEPTH]):
        listed = ", ".join(f"{name} ({kind})" for name, kind in list(available.items())[:12])
        raise ValueError(
            f"{path} has no topic with images. Its topics are {listed or 'none'}. Record a topic "
            f"of {' or '.join(IMAGES)}."
        )
    infos = [name for name, kind in available.items() if kind == INFO]
    for kind, option, named in (
        (RGB, "info", topics.info),
        (DEPTH, "depth_info", topics.depth_info),
    ):
        fitting = _infos_of(found[kind][0], infos) if found[kind] else []
        found[option] = _candidates(path, option, named, fitting, available, (INFO,))
    _check_single(path, found)
    found["info rgb"] = found.pop("info")
    found["info depth"] = found.pop("depth_info") if found[DEPTH] else []
    return {name: candidates[0] for name, candidates in found.items() if candidates}


def _drop_copies(images: Sequence[str], counts: Mapping[str, int]) -> list[str]:
    """Return the image topics without compressed copies of other topics that have messages."""
    copies = {raw + suffix for raw in images if counts.get(raw, 1) for suffix in COMPRESSED}
    return [name for name in images if name not in copies]


def _sort_images(
    images: Sequence[str], topics: Topics, encodings: Mapping[str, str]
) -> tuple[list[str], list[str]]:
    """Return the topics with RGB images and those with depth images.

    The encoding decides, and the name if the encoding does not show it. If several topics of one
    kind have a fitting encoding, those with a fitting name come first: a topic such as
    ``/camera/depth/colored`` is RGB only if there is no other RGB topic.
    """
    named_depth = [name for name in images if _DEPTH_TOPIC.search(name)]
    depth = []
    for name in images:
        kind = kind_of(encodings.get(name, "")) or (DEPTH if name in named_depth else RGB)
        if kind == DEPTH and name != topics.rgb:
            depth.append(name)
    rgb = [name for name in images if name not in depth and name != topics.depth]
    return (
        [name for name in rgb if name not in named_depth] or rgb,
        [name for name in depth if name in named_depth] or depth,
    )


def _candidates(
    path: Path,
    option: str,
    named: str | None,
    fitting: Sequence[str],
    available: Mapping[str, str | None],
    kinds: Sequence[str],
) -> list[str]:
    """Return the topic that the user named, or the fitting topics."""
    if named is None:
        return list(fitting)
    if named == OFF:
        return []
    if named not in available:
        raise ValueError(f"{path}: {unknown('topic', named, available)}")
    if available[named] not in kinds:
        raise ValueError(
            f"{path}: topics.{option} must be a topic of {' or '.join(kinds)}, got {named}, "
            f"which is {available[named]}."
        )
    return [named]


def _check_single(path: Path, found: Mapping[str, Sequence[str]]) -> None:
    """Raise ValueError if several topics fit an option."""
    open_choices = {option: names for option, names in found.items() if len(names) > 1}
    if open_choices:
        listed = "; ".join(f"{option}: {', '.join(n)}" for option, n in open_choices.items())
        choice = " ".join(f"topics.{option}={n[0]}" for option, n in open_choices.items())
        raise ValueError(
            f"{path} has several topics for {listed}. Choose one each, for example with {choice} "
            f"({OFF}: do not read this sensor)."
        )


def _infos_of(topic: str, infos: Sequence[str]) -> list[str]:
    """Return the CameraInfo topics of an image topic.

    In ROS, the name is ``<camera>/camera_info``. If that is missing, return the topics with the
    same first name that share most of the further words.
    """
    namespace = topic
    while "/" in namespace.strip("/"):
        namespace = namespace.rpartition("/")[0]
        if f"{namespace}/camera_info" in infos:
            return [f"{namespace}/camera_info"]
    camera = "/" + topic.strip("/").partition("/")[0] + "/"
    shared = {info: _shared_words(topic, info) for info in infos if info.startswith(camera)}
    return [info for info, count in shared.items() if count == max(shared.values())]


def _shared_words(topic: str, other: str) -> int:
    """Return how many words at the start of two topics are equal; / and _ separate words."""
    pairs = zip(re.split("[/_]", topic), re.split("[/_]", other), strict=False)
    return len([*takewhile(lambda pair: pair[0] == pair[1], pairs)])
