"""A recorded drive that is stored as one file per frame, and functions that read the lists next to
the frames.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import frame_files
from mitigate.worlds.recorded.source import (
    MAX_INSTANTS,
    SET_UNIT,
    Lens,
    Source,
    clean_depth,
    read_text,
)

INSTRUCTION = "instruction.txt"


@dataclass(kw_only=True)
class Frames(Source):
    """A recorded drive with one frame file per camera and time step.

    ``unit`` is the number of metres per integer step of 16-bit depth. If ``unit_given`` is false,
    neither the user nor the recording states a unit, and ``unit`` holds the default value.
    """

    files: Mapping[str, Sequence[Path]]
    unit: float
    unit_given: bool = True

    def __post_init__(self) -> None:
        assumed = "" if self.unit_given else " (assumed)"
        counted = f"16-bit PNG, {self.unit:g} metres per count{assumed}"
        self.formats = {}
        for name, files in self.files.items():
            suffix = files[0].suffix[1:].upper()
            if self.cameras[name].kind == DEPTH and suffix != "NPY":
                self.formats[name] = f"{name}, {counted}"
                self.depth_advice = SET_UNIT
            else:
                self.formats[name] = f"{name}, {suffix}"

    def frames(self, chosen: Sequence[int]) -> Iterator[dict[str, np.ndarray]]:
        for index in chosen:
            yield {name: self._read(name, files[index]) for name, files in self.files.items()}

    def _read(self, camera: str, path: Path) -> np.ndarray:
        try:
            frame = frame_files.read(path, self.unit)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} {error}. Fix it, or remove it from the drive.") from error
        kind = self.cameras[camera].kind
        if (frame.shape[-1] == 3) != (kind == RGB):
            raise ValueError(
                f"{path} must be a {kind} frame, like the other frames of camera {camera!r}. "
                "Replace it."
            )
        return frame if kind == RGB else clean_depth(frame[..., 0])


def assumed_lens(kind: str, hfov: float | None, default: float = 90.0) -> Lens:
    """Return a lens with the field of view that the user set, or with a default."""
    return Lens(kind, default if hfov is None else hfov, assumed=hfov is None)


def read_rows(
    file: Path, columns: int, separator: str | None = None
) -> Iterator[tuple[int, list[str]]]:
    """Yield the line number and the words of each line that is not a comment.

    A line may have more than ``columns`` words if ``separator`` is None.
    """
    if not file.is_file():
        return
    for line_number, line in enumerate(read_text(file).splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        row = [word.strip() for word in line.split(separator)]
        if len(row) < columns or (separator and len(row) > columns):
            raise ValueError(
                f"{file}, line {line_number}, must have {columns} words, got {len(row)}."
            )
        if line_number > MAX_INSTANTS:
            raise ValueError(
                f"{file} must have at most {MAX_INSTANTS} lines. Shorten or split the recording."
            )
        yield line_number, row


def number(word: str, file: Path, line: int) -> float:
    """Parse a finite number. Raise ValueError with the file and the line if it is invalid."""
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{file}, line {line}: must be a finite number, got {word[:40]!r}.")
    return value
