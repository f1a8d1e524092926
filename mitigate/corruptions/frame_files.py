"""Read and write frame files: 8-bit RGB in PNG and JPEG, depth in 16-bit PNG and in NPY.

This module also finds the frames in a folder and determines their order. Files are untrusted, so
they are decoded completely before anything is written, and are never unpickled.
"""

from __future__ import annotations

import io
import math
import os
import re
import struct
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageOps

from mitigate.core.files import lfs_problem
from mitigate.core.observation import DEPTH, RGB

SUFFIXES = (".png", ".jpg", ".jpeg", ".npy")
# how Pillow writes each format
SAVED: dict[str, dict[str, Any]] = {
    # zlib level; it takes half the time of the default level 6, and files are a few per cent larger
    "PNG": {"compress_level": 3},
    # heuristic quality, with full colour resolution; used only with format=same
    "JPEG": {"quality": 95, "subsampling": 0},
    "TIFF": {"compression": "raw"},
}
PNG_START = b"\x89PNG\r\n\x1a\n"  # PNG specification, section 5.2
COLOUR_TYPES = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with alpha", 6: "RGB with alpha"}
MAX_PIXELS = 1 << 26  # maximum pixels per frame (heuristic): 8192 x 8192
MAX_COUNT = 65534  # maximum depth value in a 16-bit PNG
# pixel value that, like 0, means "no reading"
# The 7-Scenes data set uses this value, and it also marks saturated pixels.
NO_READING = 65535
# in metres (heuristic); if all readings are below, the unit is probably wrong
CLOSEST = 0.05
SCALE_FILES = 16  # maximum number of files that ``check_scale`` reads (heuristic)
SCALE_PIXELS = 8192  # maximum number of pixels that ``check_scale`` uses per file (heuristic)


class LeftOutError(ValueError):
    """Raised for a file that cannot be corrupted; the message says why."""


def modality(path: Path) -> str:
    """Return the modality of a file, "rgb" or "depth", from its name and, for PNG, its header.

    Raises:
        LeftOutError: If the file has neither modality, or is a pipe or a device, which may never
            end.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        raise LeftOutError("is not a regular file")
    with suppress(OSError):
        if pointer := lfs_problem(path):
            raise LeftOutError(pointer)
    suffix = path.suffix.lower()
    if suffix != ".png":
        return DEPTH if suffix == ".npy" else RGB
    try:
        with open(path, "rb") as file:
            head = file.read(26)
    except OSError as error:
        raise LeftOutError(f"cannot be read: {error.strerror}") from error
    if len(head) < 26 or not head.startswith(PNG_START):
        raise LeftOutError("is not a PNG file: it is truncated or damaged")
    bits, colour = struct.unpack("BB", head[24:26])
    if (bits, colour) in ((8, 2), (16, 0)):
        return RGB if colour == 2 else DEPTH
    raise LeftOutError(
        f"is a {bits}-bit {COLOUR_TYPES.get(colour, 'unknown')} PNG: an RGB frame must be 8-bit "
        "RGB without alpha, and a depth frame must be 16-bit grey"
    )


def corrupt_file(
    path: Path,
    suffix: str,
    unit: float,
    corrupt_frame: Callable[[np.ndarray], np.ndarray],
    no_reading: int = NO_READING,
) -> bytes:
    """Corrupt the frame in the file ``path``, and return the content of the output file.

    Args:
        path: The file to read.
        suffix: Suffix of the output file, which determines its format.
        unit: Metres per count of a 16-bit PNG.
        corrupt_frame: Function that corrupts one frame: uint8 [H, W, 3], or float32 metres in the
            shape of the file. Pixels that this function does not change keep their stored values.
        no_reading: Pixel value of a 16-bit PNG that, like 0, means "no reading".

    Raises:
        LeftOutError: If the file is damaged or has an unsupported format.
    """
    if modality(path) == RGB:
        form = "PNG" if suffix.lower() == ".png" else "JPEG"
        return encode(corrupt_frame(_decode(path)), form)
    is_npy = path.suffix.lower() == ".npy"
    stored = _load(path) if is_npy else _decode(path)
    metres = _float32(stored) if is_npy else _metres(stored, unit, no_reading)
    corrupted = corrupt_frame(metres)
    same = (corrupted == metres) | (np.isnan(corrupted) & np.isnan(metres))
    new = corrupted if is_npy else counts(corrupted, unit)
    merged = np.where(same, stored, new).astype(stored.dtype)
    if not is_npy:
        return encode(merged, "PNG")
    with io.BytesIO() as file:
        np.save(file, merged)
        return file.getvalue()


def encode(pixels: np.ndarray, form: str) -> bytes:
    """Return the content of an image file of the format "PNG", "JPEG" or "TIFF"."""
    with io.BytesIO() as file:
        Image.fromarray(pixels).save(file, form, **SAVED[form])
        return file.getvalue()


def counts(metres: np.ndarray, unit: float) -> np.ndarray:
    """Convert metres to the pixel values of a 16-bit PNG: uint16 counts of ``unit`` metres.

    Missing depth becomes 0; all other depth becomes at least 1.
    """
    valid = np.isfinite(metres) & (metres > 0)
    return np.clip(np.rint(np.where(valid, metres, 0) / unit), valid, MAX_COUNT).astype(np.uint16)


def read(path: Path, unit: float) -> np.ndarray:
    """Read a frame as uint8 [H, W, 3], or as float32 metres [H, W, 1].

    Args:
        path: The file.
        unit: Metres per count of a 16-bit PNG.

    Raises:
        LeftOutError: If the file is damaged or has an unsupported format.
    """
    if modality(path) == RGB:
        return _decode(path)
    metres = _load(path) if path.suffix.lower() == ".npy" else _metres(_decode(path), unit)
    if metres.ndim < 2 or metres.shape[2:] not in ((), (1,)) or not metres.size:
        raise LeftOutError(f"has the shape {list(metres.shape)}: depth must be [H, W] or [H, W, 1]")
    return _float32(metres).reshape(*metres.shape[:2], 1)


def check_scale(paths: Sequence[Path], unit: float, z_max: float) -> None:
    """Check that the assumed unit of depth files is plausible; only a sample of the files is read.

    Args:
        paths: Depth files (16-bit PNG and NPY).
        unit: Assumed metres per count of a 16-bit PNG.
        z_max: Maximum depth of the camera in metres.

    Raises:
        ValueError: If most PNG depth values are at least ``z_max``, or all are less than
            ``CLOSEST`` (the unit is probably wrong), or if all NPY depth values are at most 1 (they
            are probably normalised).
    """
    samples: dict[str, list[np.ndarray]] = {".png": [], ".npy": []}
    for path in paths[:: -(-len(paths) // SCALE_FILES) or 1]:
        suffix = path.suffix.lower()
        with suppress(LeftOutError):  # damaged files are reported later, when they are read
            if modality(path) == DEPTH:
                stored = (_load(path) if suffix == ".npy" else _decode(path)).reshape(-1)
                readings = _float32(stored[:: stored.size // SCALE_PIXELS + 1])
                valid = np.isfinite(readings) & (readings > 0) & (readings != NO_READING)
                samples[suffix].append(readings[valid])
    counts, metres = (np.concatenate(parts or [np.zeros(0)]) for parts in samples.values())
    if len(metres) and metres.max() <= 1:
        raise ValueError(
            f"NPY depth must be in metres, but no reading exceeds {metres.max():.3g}, so it may be "
            "normalised to 0-1. Multiply it by the range of the sensor, or set unit=m if it is in "
            "metres."
        )
    if len(counts) and counts.max() * unit < CLOSEST:
        raise ValueError(
            f"The unit of depth seems wrong: with {unit:g} metres per count, the largest reading "
            f"is {counts.max() * unit:.3g} m. Set unit= to the metres per count (m if the counts "
            f"are metres), or to {unit:g} if that is right."
        )
    far = float((counts * unit >= z_max).mean()) if len(counts) else 0.0
    if far > 0.5:
        likely = "5000 counts per metre, as in TUM RGB-D, need unit=0.0002"
        if not (counts % 8).any():
            likely += "; SUN RGB-D, whose counts are multiples of 8, needs a rotation by 3 bits"
        raise ValueError(
            f"The unit of depth seems wrong: with {unit:g} metres per count, {far:.0%} of the "
            f"readings are {z_max:g} m or more (median {np.median(counts) * unit:.3g} m). "
            f"Set unit= to the metres per count ({likely}), or to {unit:g} if that is right."
        )


def _float32(numbers: np.ndarray) -> np.ndarray:
    """Convert to float32; float64 values beyond its range become infinite."""
    with np.errstate(over="ignore"):
        return numbers.astype(np.float32)


def _metres(stored: np.ndarray, unit: float, no_reading: int = NO_READING) -> np.ndarray:
    """Convert uint16 counts to float32 metres, with 0 for missing depth."""
    return np.where(stored == no_reading, 0, stored * unit).astype(np.float32)


def _decode(path: Path) -> np.ndarray:
    """Decode an image to uint8 [H, W, 3] or uint16 [H, W]; a JPEG is rotated by its EXIF data."""
    try:
        with Image.open(path, formats=("PNG", "JPEG")) as image:
            if math.prod(image.size) > MAX_PIXELS:
                raise ValueError(f"it has {image.size[0]} x {image.size[1]} pixels")
            image.load()
            mode = image.mode
            pixels = np.array(ImageOps.exif_transpose(image))
    except Exception as error:  # decoders raise many kinds of errors for untrusted files
        raise LeftOutError(f"cannot be decoded: {error}") from error
    if mode not in ("RGB", "I;16"):
        raise LeftOutError(f"has the colour mode {mode}: an RGB frame must be 8-bit RGB")
    return pixels


def _load(path: Path) -> np.ndarray:
    """Load floating-point depth from an NPY file."""
    try:
        # memory-mapped, because a wrong shape in the header could require too much memory
        stored = np.load(path, mmap_mode="r", allow_pickle=False)
        if isinstance(stored, np.ndarray):
            if stored.size > MAX_PIXELS:
                raise ValueError(f"it has {stored.shape} numbers")
            stored = np.array(stored)
    except Exception as error:  # numpy raises many kinds of errors for untrusted files
        raise LeftOutError(
            f"cannot be loaded with allow_pickle=False: {' '.join(str(error).split())[:200]}"
        ) from error
    if not isinstance(stored, np.ndarray) or stored.dtype.kind != "f":
        kind = stored.dtype if isinstance(stored, np.ndarray) else "an archive"
        raise LeftOutError(f"holds {kind}: NPY depth must be floating-point metres")
    return stored


@dataclass(frozen=True)
class Frame:
    """An input file; its episode and frame number determine its key."""

    path: Path  # relative path
    episode: str
    number: int


@dataclass
class Plan:
    """The frames of a folder in order, skipped files, and counts of other files by suffix."""

    frames: list[Frame] = field(default_factory=list)
    # maps a skipped file, or a skipped folder with a final slash, to the reason
    left_out: dict[str, str] = field(default_factory=dict)
    other_modality: int = 0
    other_files: Counter[str] = field(default_factory=Counter)  # suffix -> files

    def episodes(self) -> dict[str, list[str]]:
        """Return the names of the frames of each episode, in order."""
        names: dict[str, list[str]] = {}
        for frame in self.frames:
            names.setdefault(frame.episode, []).append(frame.path.as_posix())
        return names


def make_plan(source: Path, out: Path | None, kinds: Sequence[str], episode: str) -> Plan:
    """Find the frames of the modalities ``kinds``.

    A damaged file is skipped, but it also gets a frame number.

    Args:
        source: The folder, which is searched recursively.
        out: Folder of the results, or None. It is skipped, even if ``source`` contains a link to
            it.
        kinds: "rgb", "depth" or both; their frames are numbered separately.
        episode: "folder" (each folder is an episode) or "all" (all frames are one episode).
    """
    plan = Plan()
    counts: Counter[tuple[str, str]] = Counter()
    for path in _files(source, out and out.resolve(), plan):
        if path.suffix.lower() not in SUFFIXES:
            plan.other_files[path.suffix.lower()] += 1
            continue
        kind = kinds[0]
        try:
            kind = modality(source / path)
            if kind not in kinds:
                plan.other_modality += 1
                continue
        except LeftOutError as error:
            plan.left_out[path.as_posix()] = str(error)
        name = path.parent.as_posix() if episode == "folder" else "all"
        plan.frames.append(Frame(path, name, counts[name, kind]))
        counts[name, kind] += 1
    return plan


def count_suffixes(suffixes: Mapping[str, int]) -> str:
    """Return the number of files per suffix, most frequent first: "3 .tif, 1 .webp"."""
    ordered = sorted(suffixes, key=lambda suffix: (-suffixes[suffix], suffix))
    return ", ".join(f"{suffixes[suffix]} {suffix or 'without suffix'}" for suffix in ordered)


def _files(source: Path, out: Path | None, plan: Plan) -> Iterator[Path]:
    """Yield the relative paths of all files that are not hidden, folder by folder in natural order.

    Links to folders are followed, except to an enclosing folder or into ``out`` (a real path).
    """

    def note_unreadable(error: OSError) -> None:
        folder = Path(error.filename).relative_to(source).as_posix()
        plan.left_out[f"{folder}/"] = f"cannot be read: {error.strerror}"

    real_paths = {Path(): source.resolve()}  # maps the relative path of a folder to its real path
    for folder, folders, files in os.walk(source, onerror=note_unreadable, followlinks=True):
        relative = Path(folder).relative_to(source)
        for name in sorted((name for name in files if name[0] != "."), key=natural):
            yield relative / name
        folders[:] = sorted((name for name in folders if name[0] != "."), key=natural)
        for name in list(folders):
            inner = relative / name
            real = real_paths[relative] / name
            is_link = os.path.islink(os.path.join(folder, name))
            # only links are resolved: resolving all folders takes cubic time in the nesting depth
            if is_link:
                real = real.resolve()
            real_paths[inner] = real
            reason = ""
            if real == out or (is_link and out in real.parents):
                reason = "is the folder of the results"
            elif real in {real_paths[parent] for parent in inner.parents}:
                reason = "links back to a folder that contains it"
            if reason:
                folders.remove(name)
                plan.left_out[f"{inner.as_posix()}/"] = reason


def natural(name: str) -> tuple:
    """Return a sort key for the natural order of names, in which "9" is before "10"."""
    parts = re.split(r"([0-9]+)", name)
    return tuple(int(p) if i % 2 else p for i, p in enumerate(parts)), name
