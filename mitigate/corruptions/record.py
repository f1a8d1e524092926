"""Define the record of a corruption: its function, and its description for tables and suites.

A package can add a corruption with a record in the entry point group ``mitigate.corruptions``
(``docs/bring-your-own.md``). The records of this project are at the end of ``rgb.py``,
``depth.py``, ``registry.py``, ``broad/__init__.py`` and the files of ``unseen``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

MODALITIES = ("rgb", "depth", "instruction")
VALIDATION, TEST = "validation", "test"  # the two halves of the unseen corruptions


@dataclass(frozen=True)
class Record:
    """A corruption.

    Attributes:
        name: Name in lower case with underscores.
        modality: What the corruption changes, one of ``MODALITIES``.
        apply: A pure function. For RGB: For RGB: function (views uint8 [V, H, W, 3], severity in
            (0, 1], key, heading or None) -> new array of the same shape. For depth: (views float32
            metres [V, H, W], severity, key, DepthSensor) -> new array of the same shape. For
            instructions it is None, because ``corrupt_instruction`` changes these.
        severity: A few words on what the severity s controls.
        label: Title in tables; by default the name with spaces.
        source: One or two words on the sources of the constants.
        episode: The properties that are sampled once per episode.
        frame: The properties that are sampled for each frame.
        version: Version of a corruption outside the suite; rows of a different version are not
            reused. Corruptions of the suite have the version of the suite.
        half: Half of an unseen corruption, ``VALIDATION`` or ``TEST``. Methods may be chosen only
            on the validation half.

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

    def __post_init__(self) -> None:
        if self.modality not in MODALITIES:
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
        if self.modality != "instruction" and not callable(self.apply):
            raise ValueError(
                f"apply of corruption {self.name!r} must be a function, got {self.apply!r}."
            )

    @classmethod
    def of(cls, modality: str, apply: Callable[..., np.ndarray], **fields: Any) -> Record:
        """Return the record of a function, with the name of the function."""
        return cls(apply.__name__, modality, apply, **fields)

    @property
    def title(self) -> str:
        """Title in tables."""
        return self.label or self.name.replace("_", " ").capitalize()
