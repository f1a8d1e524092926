"""Define the record of a corruption: its function, and its description for tables and suites.

A package can add a corruption with a record in the entry point group ``mitigate.corruptions``
(``docs/bring-your-own.md``). The records of this project are at the end of ``rgb.py``,
``depth.py``, ``registry.py``, ``broad/__init__.py`` and the files of ``unseen`` and ``faults``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.corruptions.keying import Key

MODALITIES = ("rgb", "depth", "instruction")
FRAMES = "rgb+depth"  # modality of a fault of both sensors, or of the only one
ACTION = "action"  # modality of a fault of motion
TEMPORAL, CAMERA, MOTION = "temporal", "camera", "motion"
FAMILIES = (TEMPORAL, CAMERA, MOTION)  # of faults, each with a suite of this name
VALIDATION, TEST = "validation", "test"  # the two halves of the unseen corruptions


@dataclass(frozen=True)
class Record:
    """A corruption.

    Attributes:
        name: Lower case with underscores.
        modality: What it corrupts, one of ``MODALITIES``, ``FRAMES`` or ``ACTION``.
        apply: A pure function. For RGB: (views uint8 [V, H, W, 3], severity in (0, 1], key, heading
            or None) -> new array of the same shape. For depth: (views float32 metres [V, H, W],
            severity, key, DepthSensor) -> new array of the same shape. None for instructions, which
            ``corrupt_instruction`` changes, and for faults with ``draw``.
        severity: What the severity s controls, in a few words.
        label: Title in tables; by default the name in words.
        source: Sources of the constants, in a word or two.
        episode: What is drawn once per episode.
        frame: Which random values are drawn for each frame.
        version: Version of a corruption outside the suite; rows of another version are not reused.
            Those of the suite have the version of the suite.
        half: The half to which an unseen corruption belongs: ``VALIDATION`` or ``TEST``. Methods
            may be chosen on the validation half only.
        family: Family of a fault, one of ``FAMILIES``.
        draw: What a fault does at an instant, a pure function of (severity, key)
            (``mitigate/corruptions/faults``).

    Raises:
        ValueError: The name, modality, half or function is invalid.
    """

    name: str
    modality: str
    apply: Callable[..., np.ndarray] | None
    severity: str
    label: str = ""
    source: str = ""
    episode: str = "-"
    frame: str = "-"
    version: str = ""
    half: str = ""
    family: str = ""
    draw: Callable[[float, Key], Any] | None = None

    def __post_init__(self) -> None:
        if self.modality not in (*MODALITIES, FRAMES, ACTION):
            raise ValueError(
                f"The modality of corruption {self.name!r} must be one of "
                f"{', '.join(MODALITIES)}, got {self.modality!r}."
            )
        if not self.name.replace("_", "").isalnum() or self.name != self.name.lower():
            raise ValueError(
                "The name of a corruption must be lower case letters, digits and underscores, got "
                f"{self.name!r}."
            )
        if self.half not in ("", VALIDATION, TEST):
            raise ValueError(f"half must be {VALIDATION!r} or {TEST!r}, got {self.half!r}.")
        if self.modality != "instruction" and not callable(self.apply or self.draw):
            raise ValueError(
                f"apply of corruption {self.name!r} must be a function, got {self.apply!r}."
            )

    @classmethod
    def of(cls, modality: str, apply: Callable[..., np.ndarray], **fields: Any) -> Record:
        """Return the record of a function, with the name of the function."""
        return cls(apply.__name__, modality, apply, **fields)

    @property
    def modalities(self) -> tuple[str, ...]:
        """The modalities that it corrupts; a fault of both sensors corrupts those available."""
        return tuple(self.modality.split("+"))

    @property
    def title(self) -> str:
        """Title in tables."""
        return self.label or self.name.replace("_", " ").capitalize()
