"""Which topics of a bag are the camera, its lens and the robot's place."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO = "sensor_msgs/msg/CameraInfo"
POSES = (
    *("nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"),
    "geometry_msgs/msg/PoseWithCovarianceStamped",
)
OFF = "none"  # in place of a topic: it is not read
_DEEP = re.compile(r"(?:^|[/_])depth(?:$|/|_(?!camera))")  # /depth_camera/image_raw is in colour
_OTHER = re.compile(r"infra|mask|(?:^|[/_])ir(?:$|[/_])")


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
        return [f.name for f in fields(self) if getattr(self, f.name) is not None]


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
    for kind, option in ((RGB, "info"), (DEPTH, "depth_info")):
        if found[kind]:
            beside = _beside(str(found[kind]), infos)
            named = getattr(topics, option)
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
