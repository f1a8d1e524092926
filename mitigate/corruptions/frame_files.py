"""Frames in files: 8-bit RGB in PNG and JPEG, depth in 16-bit PNG and in NPY.

Also which files of a folder are frames, and in which order.

Files are untrusted: they are decoded in full before anything is written, and never unpickled.
"""

from __future__ import annotations

import io
import math
import os
import re
import struct
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps

from mitigate.core.observation import DEPTH, RGB

SUFFIXES = (".png", ".jpg", ".jpeg", ".npy")
JPEG_QUALITY = 95  # (ours) with full colour resolution; used with format=same alone
PNG_LEVEL = 3  # of zlib (ours): half the time of the default 6 for a few per cent more bytes
PNG_START = b"\x89PNG\r\n\x1a\n"  # PNG specification, section 5.2
COLOUR_TYPES = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with alpha", 6: "RGB with alpha"}
MOST_PIXELS = 1 << 26  # of a frame (ours): 8192 x 8192
MOST = 65535  # counts of a 16-bit PNG


class LeftOutError(ValueError):
    """A file that cannot be corrupted; the message is the reason."""


def modality(path: Path) -> str:
    """What a file holds, "rgb" or "depth": by its name and, for PNG, the header.

    Raises LeftOutError if it is neither, or a pipe or device, which may never end.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        raise LeftOutError("is no regular file")
    suffix = path.suffix.lower()
    if suffix != ".png":
        return DEPTH if suffix == ".npy" else RGB
    try:
        with open(path, "rb") as file:
            head = file.read(26)
    except OSError as error:
        raise LeftOutError(f"cannot be read: {error.strerror}") from error
    if len(head) < 26 or not head.startswith(PNG_START):
        raise LeftOutError("is no PNG file: it is cut short or damaged")
    bits, colour = struct.unpack("BB", head[24:26])
    if (bits, colour) in ((8, 2), (16, 0)):
        return RGB if colour == 2 else DEPTH
    raise LeftOutError(
        f"is a {bits}-bit {COLOUR_TYPES.get(colour, 'unknown')} PNG: RGB must be 8-bit RGB without "
        "alpha, depth 16-bit grey"
    )


def corrupted(
    path: Path, suffix: str, unit: float, corrupt_frame: Callable[[np.ndarray], np.ndarray]
) -> bytes:
    """The bytes of a file of the kind ``suffix`` with the corrupted frame of ``path``.

    ``corrupt_frame`` gets uint8 [H, W, 3] or float32 metres, the shape of the file; ``unit`` is
    the metres of one count of a 16-bit PNG. Pixels that it leaves alone are written as they were.
    Raises LeftOutError for a file that is damaged or of another kind.
    """
    what = modality(path)
    if what == RGB:
        return _encode(Image.fromarray(corrupt_frame(_decode(path))), suffix)
    if path.suffix.lower() == ".npy":
        stored = _load(path)
        metres = stored.astype(np.float32)
        after = corrupt_frame(metres)
        with io.BytesIO() as file:
            written = np.where(_same(after, metres), stored, after).astype(stored.dtype)
            np.save(file, written)
            return file.getvalue()
    stored = _decode(path)
    metres = (stored * unit).astype(np.float32)
    after = corrupt_frame(metres)
    written = np.where(_same(after, metres), stored, counts(after, unit))
    return _encode(Image.fromarray(written), suffix)


def counts(metres: np.ndarray, unit: float) -> np.ndarray:
    """Metres as uint16 counts of ``unit`` metres, as a 16-bit PNG holds them: 0 where nothing is
    read, 1 or more elsewhere."""
    valid = np.isfinite(metres) & (metres > 0)
    return np.clip(np.rint(np.where(valid, metres, 0) / unit), valid, MOST).astype(np.uint16)


def read(path: Path, unit: float) -> np.ndarray:
    """The frame in a file: uint8 [H, W, 3], or float32 metres [H, W, 1]; ``unit`` and errors as
    :func:`corrupted`."""
    if modality(path) == RGB:
        return _decode(path)
    metres = _load(path) if path.suffix.lower() == ".npy" else _decode(path) * unit
    if metres.ndim < 2 or metres.shape[2:] not in ((), (1,)) or not metres.size:
        raise LeftOutError(f"has the shape {list(metres.shape)}: depth is [H, W] or [H, W, 1]")
    with np.errstate(over="ignore"):  # becomes infinite
        return metres.astype(np.float32).reshape(*metres.shape[:2], 1)


def _decode(path: Path) -> np.ndarray:
    """uint8 [H, W, 3] or uint16 [H, W]; a JPEG is turned upright as its EXIF data say."""
    try:
        with Image.open(path, formats=("PNG", "JPEG")) as image:
            if math.prod(image.size) > MOST_PIXELS:
                raise ValueError(f"it has {image.size[0]} x {image.size[1]} pixels")
            image.load()
            mode = image.mode
            pixels = np.array(ImageOps.exif_transpose(image))
    except Exception as error:  # whatever a decoder says of an untrusted file is the reason
        raise LeftOutError(f"cannot be decoded: {error}") from error
    if mode not in ("RGB", "I;16"):
        raise LeftOutError(f"has the colours {mode}: RGB must be 8-bit RGB")
    return pixels


def _load(path: Path) -> np.ndarray:
    try:
        mapped = np.load(path, mmap_mode="r", allow_pickle=False)  # no more than the file has
        if isinstance(mapped, np.ndarray) and mapped.size > MOST_PIXELS:
            raise ValueError(f"it has {mapped.shape} numbers")
        stored = np.array(mapped) if isinstance(mapped, np.ndarray) else mapped
    except Exception as error:  # as above
        raise LeftOutError(
            f"cannot be loaded with allow_pickle=False: {' '.join(str(error).split())[:200]}"
        ) from error
    if not isinstance(stored, np.ndarray) or stored.dtype.kind != "f":
        kind = stored.dtype if isinstance(stored, np.ndarray) else "an archive"
        raise LeftOutError(f"holds {kind}: NPY depth must be floating-point metres")
    return stored


def _same(after: np.ndarray, metres: np.ndarray) -> np.ndarray:
    return (after == metres) | (np.isnan(after) & np.isnan(metres))


def _encode(image: Image.Image, suffix: str) -> bytes:
    with io.BytesIO() as file:
        if suffix.lower() == ".png":
            image.save(file, "PNG", compress_level=PNG_LEVEL)
        else:
            image.save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0)
        return file.getvalue()


@dataclass(frozen=True)
class Frame:
    """One input file, by its path inside the folder, and the key of its draw."""

    path: Path
    episode: str
    number: int


@dataclass
class Plan:
    """What a folder holds: frames in order, what is left out, and the suffixes of other files."""

    frames: list[Frame] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)  # file, or folder/ -> reason
    other_modality: int = 0
    other_files: Counter[str] = field(default_factory=Counter)  # suffix -> files

    def episodes(self) -> dict[str, list[str]]:
        """The names of the frames of each episode, in order."""
        names: dict[str, list[str]] = {}
        for frame in self.frames:
            names.setdefault(frame.episode, []).append(frame.path.as_posix())
        return names


def make_plan(source: Path, out: Path | None, wanted: str, episode: str) -> Plan:
    """Find the frames of a modality. A file that is neither takes part as a bad frame.

    ``out``, where the results go (None: nowhere), is no part of ``source``, even if a link leads
    there.
    """
    plan = Plan()
    counts: dict[str, int] = {}
    for path in _files(source, out and out.resolve(), plan):
        if path.suffix.lower() not in SUFFIXES:
            plan.other_files[path.suffix.lower()] += 1
            continue
        try:
            if modality(source / path) != wanted:
                plan.other_modality += 1
                continue
        except LeftOutError as error:
            plan.left_out[path.as_posix()] = str(error)
        name = path.parent.as_posix() if episode == "folder" else "all"
        plan.frames.append(Frame(path, name, counts.get(name, 0)))
        counts[name] = counts.get(name, 0) + 1
    return plan


def told(suffixes: Mapping[str, int]) -> str:
    """Counts of files by suffix, the most frequent first: "3 .tif, 1 .webp"."""
    most = sorted(suffixes, key=lambda suffix: (-suffixes[suffix], suffix))
    return ", ".join(f"{suffixes[suffix]} {suffix or 'without suffix'}" for suffix in most)


def _files(source: Path, out: Path | None, plan: Plan) -> Iterator[Path]:
    """Relative paths, folder by folder in natural order; hidden files and folders are passed by.

    Links to folders are followed, but not in a circle and not into the real path ``out``.
    """

    def complain(error: OSError) -> None:
        folder = Path(error.filename).relative_to(source).as_posix()
        plan.left_out[f"{folder}/"] = f"cannot be read: {error.strerror}"

    for folder, folders, files in os.walk(source, onerror=complain, followlinks=True):
        here = Path(folder).relative_to(source)
        for name in sorted((name for name in files if name[0] != "."), key=natural):
            yield here / name
        seen = sorted((name for name in folders if name[0] != "."), key=natural)
        barred = {name: _barred(source, here / name, out) for name in seen}
        plan.left_out |= {f"{(here / n).as_posix()}/": why for n, why in barred.items() if why}
        folders[:] = [name for name in seen if not barred[name]]


def _barred(source: Path, folder: Path, out: Path | None) -> str:
    """Why a folder must not be entered; empty if it may be."""
    real = (source / folder).resolve()
    if out in (real, *real.parents):
        return "is where the results go"
    around = {(source / parent).resolve() for parent in folder.parents}
    return "leads back to a folder that it lies in" if real in around else ""


def natural(name: str) -> tuple:
    parts = re.split(r"([0-9]+)", name)
    return tuple(int(p) if i % 2 else p for i, p in enumerate(parts)), name
