"""One record a corruption: all that tables, pages, suites and benchmarks say of it.

A corruption of your own is such a record, found by the entry point group ``mitigate.corruptions``
(``docs/bring-your-own.md``); ours stand at the end of ``rgb.py``, ``eld.py``,
``depth.py``, ``registry.py``, ``broad/__init__.py`` and the files of ``unseen``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

MODALITIES = ("rgb", "depth", "instruction")
VALIDATION, TEST = "validation", "test"  # halves of the unseen corruptions


@dataclass(frozen=True)
class Record:
    """name: lower case with underscores. modality: what it corrupts, of ``MODALITIES``.

    apply: for RGB (views uint8 [V, H, W, 3], severity in (0, 1], key, heading or None) -> a new
    array of the same shape; for depth (views float32 metres [V, H, W], severity, key, DepthSensor)
    -> the same; it must be a pure function of these. None of an instruction's, which
    ``corrupt_instruction`` changes.
    severity: what s sets, in a few words. place: in tables, ascending. label: in tables, by default
    the name in words. fails: what goes wrong in the world. formula: Markdown with the constants of
    the code. sources: of the constants; source: the same in a word or two. episode, frame: what is
    drawn once an episode, and anew for each frame. slip: how far it may change less at the next of
    100 severities (SSIM, or metres). bars: milliseconds to stay under at 480x640 and 224x224;
    reason: where the time goes. version: of an unseen or further one, whose rows are measured anew
    when it changes; those of the suite have the suite's. half: of an unseen one, ``VALIDATION`` or
    ``TEST``; methods may be chosen by the first, never by the second.
    """

    name: str
    modality: str
    apply: Callable[..., np.ndarray] | None
    severity: str
    place: int = 1000
    label: str = ""
    fails: str = ""
    formula: str = ""
    sources: str = ""
    source: str = ""
    episode: str = "-"
    frame: str = "-"
    slip: float = 0.0
    bars: tuple[float, float] | None = None
    reason: str = ""
    version: str = ""
    half: str = ""

    def __post_init__(self) -> None:
        if self.modality not in MODALITIES:
            raise ValueError(
                f"The corruption {self.name!r} has the modality {self.modality!r}, which must be "
                f"one of {', '.join(MODALITIES)}."
            )
        if not self.name.replace("_", "").isalnum() or self.name != self.name.lower():
            raise ValueError(
                f"A corruption's name is lower case with underscores, not {self.name!r}."
            )
        if self.half not in ("", VALIDATION, TEST):
            raise ValueError(f"A half is {VALIDATION!r} or {TEST!r}, not {self.half!r}.")
        if self.modality != "instruction" and not callable(self.apply):
            raise ValueError(f"The corruption {self.name!r} needs a function that applies it.")

    @classmethod
    def of(cls, modality: str, apply: Callable[..., np.ndarray], **fields: Any) -> Record:
        """Return the record of a function, by its name."""
        return cls(apply.__name__, modality, apply, **fields)

    @property
    def title(self) -> str:
        """Its name in tables."""
        return self.label or self.name.replace("_", " ").capitalize()
