"""Choose the topics of a bag: RGB and depth images, poses, and the CameraInfo of the cameras."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os.path import commonprefix
from pathlib import Path

from mitigate.core.names import escaped, unknown
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.worlds.recorded.messages import kind_of

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO = "sensor_msgs/msg/CameraInfo"
POSES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
)
INFO_OPTIONS = {"info": RGB, "depth_info": DEPTH}  # options of INFO topics, and their cameras
OFF = "none"  # value of a topic option that disables the topic
# matches topics whose name contains the word "depth", but not /depth_camera/image_raw
_DEPTH_TOPIC = re.compile(r"(?:^|[/_])depth(?:$|/|_(?!camera))")
# matches the topic names of infrared images and masks
_OTHER_IMAGES = re.compile(r"infra|mask|(?:^|[/_])ir(?:$|[/_])")
# matches the names of pose topics that do not contain the robot's position
_OTHER_POSES = re.compile(r"goal|target|waypoint|initial_?pose")

# image_transport appends these suffixes to the name of a topic
COMPRESSED = ("/compressed", "/compressedDepth")


@dataclass(frozen=True)
class Topics:
    """The names of the topics to read from a bag.

    ``rgb`` and ``depth`` contain images, and ``pose`` contains poses of the robot. ``info`` and
    ``depth_info`` contain the CameraInfo of the RGB and the depth camera. If a name is None, the
    only suitable topic is read. If it is "none", no topic is read.
    """

    rgb: str | None = None
    depth: str | None = None
    pose: str | None = None
    info: str | None = None
    depth_info: str | None = None


def choose_topics(
    path: Path,
    available: Mapping[str, str | None],
    topics: Topics,
    counts: Mapping[str, int] | None = None,
    encodings: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """Choose the topics of the sensors "rgb", "depth", "pose", "info" and "depth_info".

    Args:
        path: Path of the bag, for error messages.
        available: Message type of each topic in the bag.
        topics: The topics that the user chose.
        counts: Number of messages of each topic, if known. A pose topic with a single message does
            not count as a trajectory if an image topic has several messages.
        encodings: Encoding of the first image of each topic, if known. If it is unknown, the name
            of the topic decides whether the topic contains depth.

    Returns:
        The chosen topics by name. Names for which the bag has no topic are absent.

    Raises:
        ValueError: If a chosen topic is missing or has the wrong type, if several topics are
            suitable, or if the bag contains no images.
    """
    counts = counts or {}
    images = [n for n, kind in available.items() if kind in IMAGES and not _OTHER_IMAGES.search(n)]
    # compressed copies of topics that have messages
    copies = {raw + suffix for raw in images if counts.get(raw, 1) for suffix in COMPRESSED}
    originals = [name for name in images if name not in copies]
    rgb, depth = _sort_images(originals, topics, encodings or {})
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
    candidates = {
        RGB: _candidates(path, RGB, topics.rgb, rgb, available, IMAGES),
        DEPTH: _candidates(path, DEPTH, topics.depth, depth, available, IMAGES),
        POSE: _candidates(path, POSE, topics.pose, poses, available, POSES),
    }
    if not (candidates[RGB] or candidates[DEPTH]):
        some = list(available.items())[:12]
        listed = ", ".join(f"{name} ({escaped(str(kind))})" for name, kind in some)
        raise ValueError(
            f"{path} has no topic with images. Its topics are {listed or 'none'}. Record a topic "
            f"of type {' or '.join(IMAGES)}."
        )
    infos = [name for name, kind in available.items() if kind == INFO]
    for option, kind in INFO_OPTIONS.items():
        if candidates[kind]:
            fitting = _infos_of(candidates[kind][0], infos)
            named = vars(topics)[option]
            candidates[option] = _candidates(path, option, named, fitting, available, (INFO,))
    open_choices = {option: names for option, names in candidates.items() if len(names) > 1}
    if open_choices:
        listed = "; ".join(f"{option}: {', '.join(n)}" for option, n in open_choices.items())
        choice = " ".join(f"topics.{option}={n[0]}" for option, n in open_choices.items())
        raise ValueError(
            f"{path} has several topics for {listed}. Choose one for each, for example with "
            f"{choice} (or {OFF} to leave out this sensor)."
        )
    return {name: names[0] for name, names in candidates.items() if names}


def _sort_images(
    images: Sequence[str], topics: Topics, encodings: Mapping[str, str]
) -> tuple[list[str], list[str]]:
    """Return the topics that contain RGB images and the topics that contain depth images.

    The encoding decides the kind of a topic. If the encoding allows both kinds, the name decides.
    If several topics of one kind have a suitable encoding, topics with a suitable name are
    preferred. For example, ``/camera/depth/colored`` is RGB only if there is no other RGB topic.
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
    """Return the topic that the user named, or all suitable topics."""
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


def _infos_of(topic: str, infos: Sequence[str]) -> list[str]:
    """Return the CameraInfo topics of an image topic.

    In ROS, the name is ``<camera>/camera_info``. If that topic is missing, return the topics that
    start with the same namespace and share the most words with the image topic.
    """
    namespace = topic
    while "/" in namespace.strip("/"):
        namespace = namespace.rpartition("/")[0]
        if f"{namespace}/camera_info" in infos:
            return [f"{namespace}/camera_info"]
    camera = "/" + topic.strip("/").partition("/")[0] + "/"
    words = re.split("[/_]", topic)
    shared = {
        info: len(commonprefix([words, re.split("[/_]", info)]))
        for info in infos
        if info.startswith(camera)
    }
    return [info for info, count in shared.items() if count == max(shared.values())]
