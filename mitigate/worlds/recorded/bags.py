"""Read drives from bags of ROS 1 (``.bag``), ROS 2 (a folder with ``metadata.yaml``) and MCAP.

Bags are read with the package ``rosbags``, without an installation of ROS. The supported messages
are images (``sensor_msgs`` Image and CompressedImage), ``CameraInfo`` and poses
(``nav_msgs/Odometry``, ``geometry_msgs/PoseStamped`` and ``PoseWithCovarianceStamped``). Poses use
the axes of REP 103: x forward, y left, z up. Times are read from the message headers. If messages
have no headers, the times of receipt are used. The instruction may be in a text file next to the
bag. The name of this file is the name of the bag with the suffix ``.txt``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import lfs_problem
from mitigate.core.names import escaped
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.worlds.recorded.messages import (
    DamagedImage,
    camera_matrix,
    depth_unit,
    encoding_of,
    read_image,
    read_lens,
    read_pose,
    read_stamp,
)
from mitigate.worlds.recorded.options import Options
from mitigate.worlds.recorded.source import (
    MAX_INSTANTS,
    SET_UNIT,
    Lens,
    Source,
    match_times,
    read_instruction,
)
from mitigate.worlds.recorded.topics import IMAGES, INFO, INFO_OPTIONS, POSES, choose_topics
from mitigate.worlds.recorded.unpacking import bounded

# the first bytes of each file format, and a program that repairs such files
FORMATS = {
    ".bag": (b"#ROSBAG V", "`rosbag reindex`"),
    ".mcap": (b"\x89MCAP0\r\n", "`mcap recover`"),
    ".db3": (b"SQLite format 3\0", "`sqlite3 OLD.db3 .recover | sqlite3 NEW.db3`"),
}

KINDS = (RGB, DEPTH)
# The limits below are heuristic.
# maximum number of poses per drive; this is enough for poses at 480 Hz with images at 30 Hz
MAX_POSES = 16 * MAX_INSTANTS
# maximum size in bytes of buffered images that wait for an image of another topic
MAX_BUFFER_BYTES = 1 << 30


class Bag(Source):
    """A recorded drive that is stored in a bag, which is a file or a folder.

    Raises:
        ValueError: If the bag is damaged or lacks a topic, or ``rosbags`` is not installed.
    """

    def __init__(self, path: Path, options: Options) -> None:
        resolved = path.resolve()  # resolve first, because the path `.` has an empty name
        self.path = path
        self.unit = options.unit  # if None, 0.001 for integer depth and 1 for 32FC1
        self.tolerance = options.frame_gap
        self.signals = {}
        self.damaged = []
        self.depth_advice = SET_UNIT
        self.name = resolved.name if path.is_dir() else path.stem
        self.instruction = read_instruction(resolved.parent / f"{self.name}.txt")
        with self._open() as reader:
            # topics whose names need escaping are ignored, because error messages list the names
            listed = {n: info for n, info in reader.topics.items() if n == escaped(n)}
            available = {name: info.msgtype for name, info in listed.items()}
            counts = {name: info.msgcount for name, info in listed.items()}
            encodings = self._read_encodings(reader)
            self.topics = choose_topics(path, available, options.topics, counts, encodings)
            self.kinds = [kind for kind in KINDS if kind in self.topics]
            stamps, poses, lenses = self._index(reader, options.hfov)
        if options.hfov is not None and all(kind in lenses for kind in self.kinds):
            raise ValueError(f"{path} contains the field of view of its cameras. Remove hfov=.")
        if self.unit is not None and DEPTH not in self.kinds:
            raise ValueError(f"{path} is read without depth. Remove unit=, or set topics.depth=.")
        self._match(stamps, poses, options.yaw)
        for option, kind in INFO_OPTIONS.items():
            if kind in self.kinds and kind not in lenses and options.hfov is None:
                raise ValueError(
                    f"{path} has no CameraInfo for {self.topics[kind]}, so its field of view is "
                    f"unknown. Set hfov=69 (degrees, horizontal), or topics.{option}=TOPIC."
                )
        self.cameras = {k: lenses.get(k) or Lens(k, options.hfov or 0.0) for k in self.kinds}
        self.formats = self._describe(encodings)

    def _describe(self, encodings: Mapping[str, str]) -> dict[str, str]:
        """Describe each sensor by its topic, its image encoding and the unit of its depth."""
        formats = {POSE: self.topics[POSE]} if POSE in self.topics else {}
        for kind in self.kinds:
            topic = self.topics[kind]
            formats[kind] = f"{topic}, {encodings.get(topic, '')}"
        if DEPTH in formats:
            unit = self.unit or depth_unit(encodings.get(self.topics[DEPTH], ""))
            assumed = " (assumed)" if self.unit is None else ""
            formats[DEPTH] += f", {unit:g} metres per count{assumed}"
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
                            f"{self.path}: images with the same timestamp must be close together "
                            f"in the bag, but more than {MAX_BUFFER_BYTES >> 30} GiB of other "
                            "images lie between them. Rewrite the bag in the order of time, or "
                            "leave out one topic (topics.depth=none)."
                        )
                while done < len(chosen) and all(indices[k][done] in buffer[k] for k in self.kinds):
                    step = {k: buffer[k][indices[k][done]] for k in self.kinds}
                    images = {k: image for k, image in step.items() if image is not None}
                    yield images if len(images) == len(step) else {}
                    done += 1
                    for k in self.kinds:  # discard images that no later time step uses
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
        try:
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore
        except ModuleNotFoundError as error:
            raise ValueError(
                "Bags need the package rosbags. Run pip install -e '.[bags]'."
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
        """Turn errors caused by the content of the bag into a ValueError that names the bag."""
        try:
            yield
        except OSError:
            raise
        except Exception as error:
            if self.path.is_file() and (pointer := lfs_problem(self.path)):
                raise ValueError(f"{self.path} {pointer}.") from error
            if isinstance(error, ValueError) and str(self.path) in str(error):
                raise  # this package raised the error, so its message already names the bag
            reason = " ".join(str(error).split())[:300].rstrip(".")
            raise ValueError(
                f"{self.path} cannot be read as a bag: {reason}. {_repair_advice(self.path)}"
            ) from error

    def _read_encodings(self, reader: Any) -> dict[str, str]:
        """Return the encoding of the first image of each image topic."""
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
        """Yield the messages of some topics in the order in which the bag stores them.

        Args:
            reader: The open reader.
            names: Keys of ``self.topics``.
            decode: Indices of the messages to decode for each name. For a name that has no entry,
                all messages are decoded.

        Yields:
            The name, the two timestamps in seconds (from the header, and on receipt), and the
            message. The message is None if it was not decoded.
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
        """Return the times of the images, the poses as (time, x, y, heading), and the lenses."""
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
                        "Shorten or split the recording."
                    )
            with self._explained():
                if name == POSE:
                    poses.append(read_pose(message))
                elif name in INFO_OPTIONS:
                    kind = INFO_OPTIONS[name]
                    usable = hfov is None or bool((camera_matrix(message)[:1] > 0).any())
                    if kind not in lenses and usable:
                        lenses[kind] = read_lens(kind, message, self.path)
        seconds = {name: _choose_clock(pairs) for name, pairs in stamps.items()}
        timed = zip(seconds.pop(POSE), poses, strict=True)
        return seconds, [(time, *pose) for time, pose in timed], lenses

    def _match(
        self, stamps: Mapping[str, list[float]], table: Sequence[tuple[float, ...]], yaw: float
    ) -> None:
        """Set the time, the pose and the image index of each camera for all time steps."""
        records: dict[str, Sequence] = {**stamps, **({POSE: table} if POSE in self.topics else {})}
        for name, messages in records.items():
            if not messages:
                raise ValueError(
                    f"{self.path} has no message on {self.topics[name]}. Set topics.{name}=none."
                )
        known = np.array(table) if table else None
        instants = match_times(self.path, stamps, known, self.tolerance, self.topics)
        self.times = instants.times
        self.poses = instants.poses
        if self.poses is not None:
            self.poses[:, 2] -= math.radians(yaw)
        self.dropped = instants.dropped
        self._image_numbers = instants.frames


def _repair_advice(path: Path) -> str:
    """Return advice on how to repair a bag that cannot be read."""
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
        return f"{metadata}If {file.name} is truncated or damaged, repair a copy with {program}."
    return "Copy the folder again: it has no file with messages."


def _open_part(part: Any, open_: Callable[[], None]) -> None:
    """Open a reader that parses only the definitions of the supported message types.

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
    """Return the times in the headers. If no header has a time, return the times of receipt."""
    has_header = any(header for header, _ in stamps)
    return [header if has_header else received for header, received in stamps]
