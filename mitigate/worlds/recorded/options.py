"""Define the kinds of recordings, and the options for opening them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mitigate.worlds.recorded.source import MAX_FRAME_GAP, MAX_HFOV, MIN_HFOV
from mitigate.worlds.recorded.topics import Topics

BAG = "a bag"
DATASET = "a LeRobot dataset"
RUN = "a recording by mitigate run"
TUM = "a folder of TUM RGB-D"
FRAMES = "a folder of frames"
# the kinds of recordings to which each option applies; hfov= applies to all kinds
KINDS = {
    "topics": (BAG,),
    "yaw": (BAG,),
    "unit": (BAG, TUM, FRAMES),
    "cameras": (RUN, DATASET),
    "episodes": (DATASET,),
    "tolerance": (BAG, DATASET, TUM),
}


@dataclass(frozen=True)
class Options:
    """Options of :func:`mitigate.worlds.recorded.open_recording`.

    Attributes:
        topics: Topics to read from a bag.
        hfov: Horizontal field of view in degrees, if the recording does not contain it.
        unit: Metres per integer step of depth values, in a bag or in the 16-bit PNG files of a
            folder.
        yaw: Direction of a bag's cameras in degrees to the right of the heading.
        cameras: Names of the cameras to read from a dataset or a recording of ``mitigate run``. If
            None, all are read.
        episodes: Numbers of the episodes to read from a dataset. If None, all are read.
        tolerance: Maximum time difference in seconds between the messages of a time step in a bag
            or TUM folder (default 0.1), or between a row of a dataset and its video frame (default
            0.0001).

    Raises:
        ValueError: If a value is out of range.
    """

    topics: Topics = Topics()
    hfov: float | None = None
    unit: float | None = None
    yaw: float = 0.0
    cameras: Sequence[str] | None = None
    episodes: Sequence[int] | None = None
    tolerance: float | None = None

    def __post_init__(self) -> None:
        if self.hfov is not None and not MIN_HFOV <= self.hfov <= MAX_HFOV:
            raise ValueError(
                f"hfov must be a field of view of {MIN_HFOV:g} to {MAX_HFOV:g} degrees, got "
                f"{self.hfov:g}."
            )
        if self.tolerance is not None and not self.tolerance >= 0:
            raise ValueError(f"tolerance must be at least 0 seconds, got {self.tolerance:g}.")
        if self.unit is not None and not 0 < self.unit <= 1:
            raise ValueError(
                f"unit= must be above 0 and at most 1 metre per count, got {self.unit:g}."
            )

    @property
    def frame_gap(self) -> float:
        """Maximum time difference in seconds between the frames of one time step."""
        return MAX_FRAME_GAP if self.tolerance is None else self.tolerance

    def check(self, path: Path, kind: str) -> None:
        """Raise ValueError if an option is set that does not apply to recordings of ``kind``."""
        for name, kinds in KINDS.items():
            if kind not in kinds and vars(self)[name] != vars(Options())[name]:
                advice = f"Remove {name}=."
                if name == "cameras" and kind == BAG:
                    advice = "Choose topics.rgb= and topics.depth= instead."
                raise ValueError(
                    f"{name}= applies only to {' or '.join(kinds)}, but {path} is {kind}. {advice}"
                )
