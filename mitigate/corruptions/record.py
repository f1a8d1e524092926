"""Define the record of a corruption, which holds its function and its description.

A package can add a corruption by a record in the entry point group ``mitigate.corruptions``
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
# modality of faults that change RGB and depth; one of the two sensors is enough
FRAMES = "rgb+depth"
ACTION = "action"  # modality of motion faults
OF_NO_FRAME = ("instruction", ACTION)  # modalities of corruptions that do not change frames
TEMPORAL, CAMERA, MOTION = "temporal", "camera", "motion"
FAMILIES = (TEMPORAL, CAMERA, MOTION)  # families of faults; each has a suite of the same name
VALIDATION, TEST = "validation", "test"  # the two sets of unseen corruptions


@dataclass(frozen=True)
class Record:
    """A corruption.

    Attributes:
        name: Name in lower case with underscores.
        modality: What the corruption changes: one of ``MODALITIES``, ``FRAMES`` or ``ACTION``.
        apply: A pure function. For RGB, its arguments are views (uint8 [V, H, W, 3]), severity in
            (0, 1], key, and heading or None. For depth, they are views (float32 metres [V, H, W]),
            severity, key, and a DepthSensor. It returns a new array of the same shape as the views.
            The value is None for instruction corruptions, which ``corrupt_instruction``
            applies, and for faults with ``draw``.
        severity: What the severity (called s) controls, in a few words.
        label: Title in tables; by default, it is made from ``name``.
        source: Sources of the constants, in one or two words.
        episode: Which random values are sampled once per episode.
        frame: Which random values are sampled for each frame.
        version: Version of a corruption that is not in the standard suite; result rows of another
            version are not reused. Corruptions in the suite have the version of the suite.
        half: The set to which an unseen corruption belongs: ``VALIDATION`` or ``TEST``. Only the
            validation set may be used to choose methods.
        family: Family of a fault (one of ``FAMILIES``), or "" for other corruptions.
        draw: Pure function of (severity, key) that returns what a fault does in one time step
            (``mitigate/corruptions/faults``).

    Raises:
        ValueError: If the name, modality, half or function is invalid.
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
    def of(
        cls,
        modality: str,
        apply: Callable[..., np.ndarray],
        severity: str,
        source: str,
        **fields: Any,
    ) -> Record:
        """Return the record of a corruption, named after its function ``apply``."""
        return cls(apply.__name__, modality, apply, severity, source=source, **fields)

    @classmethod
    def drawn(
        cls,
        family: str,
        modality: str,
        draw: Callable[[float, Key], Any],
        severity: str,
        source: str = "heuristic",
        **fields: Any,
    ) -> Record:
        """Return the record of a fault, named after its function ``draw``."""
        more = {"source": source, "version": "1", "family": family, "draw": draw, **fields}
        return cls(draw.__name__, modality, None, severity, **more)

    @property
    def modalities(self) -> tuple[str, ...]:
        """The corrupted modalities; a fault of both sensors also works if only one is present."""
        return tuple(self.modality.split("+"))

    @property
    def title(self) -> str:
        """Title in tables."""
        return self.label or self.name.replace("_", " ").capitalize()
