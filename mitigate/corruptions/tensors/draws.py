"""Generate keyed random numbers on a device, with the same bits as ``corruptions/keying.py``.

There are few random numbers per row or view, such as angles and offsets, so the functions of the
numpy suite sample them on the host. Random numbers per pixel are computed on the device with an
integer hash. Devices have no unsigned 64-bit integers, so a word is stored as an int64 with the
same bits. Sums and products wrap around like unsigned integers. A right shift would copy the sign
bit, so ``shifted`` sets the new bits to 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
import torch
from torch import Tensor

from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.keying import (
    GOLDEN,
    MIX_A,
    MIX_B,
    Key,
    digest,
    field_grid,
    field_weights,
    normal_table,
    top_place,
    view_streams,
)

T = TypeVar("T")


@dataclass(frozen=True)
class Rows:
    """The parameters of one corruption for each row of a batch."""

    severities: Sequence[float]  # in (0, 1]
    keys: Sequence[Key]
    headings: Sequence[float | None]  # in radians, or None if unknown
    sensor: DepthSensor

    def only(self, chosen: Sequence[int]) -> Rows:
        """Return the rows whose indices are in ``chosen``."""
        return Rows(
            [self.severities[row] for row in chosen],
            [self.keys[row] for row in chosen],
            [self.headings[row] for row in chosen],
            self.sensor,
        )

    def draw(self, function: Callable[..., T], *size: int) -> list[T]:
        """Return ``function(severity, key, *size)`` for each row."""
        pairs = zip(self.severities, self.keys, strict=True)
        return [function(severity, key, *size) for severity, key in pairs]

    def scaled(self, factor: float) -> np.ndarray:
        """Return the severities multiplied by ``factor``, float64 [B]."""
        return np.array(self.severities) * factor

    def digests(self, name: str, *, frame: bool = False) -> list[int]:
        """Return, for each row, the digest that seeds the random stream ``name``."""
        return [digest(key, name, frame=frame) for key in self.keys]


def signed(value: int) -> int:
    """Return the signed integer with the same 64 bits as ``value``."""
    return value - (1 << 64) if value >= 1 << 63 else value


def shifted(word: Tensor, bits: int) -> Tensor:
    """Shift words to the right by ``bits`` bits; the new high bits are 0 (logical shift)."""
    return (word >> bits) & ((1 << (64 - bits)) - 1)


def mix(streams: Tensor, counters: Tensor) -> Tensor:
    """Compute ``keying.mix`` for int64 tensors, which are broadcast."""
    word = streams + (counters + 1) * signed(GOLDEN)
    word = (word ^ shifted(word, 30)) * signed(MIX_A)
    word = (word ^ shifted(word, 27)) * signed(MIX_B)
    return word ^ shifted(word, 31)


def on_device(values: Sequence | np.ndarray, like: Tensor, trailing: int = 0) -> Tensor:
    """Copy numbers to the device of ``like``.

    Args:
        values: One number per row, or one array per row; all arrays have the same shape. float64
            becomes float32, and uint64 becomes int64 with the same bits.
        like: A tensor on the device.
        trailing: Number of axes of length 1 that are appended, for broadcasting.
    """
    array = np.asarray(values)
    if array.dtype == np.uint64:
        array = array.view(np.int64)
    elif array.dtype == np.float64:
        array = array.astype(np.float32)
    tensor = torch.from_numpy(np.ascontiguousarray(array)).to(like.device)
    return tensor.reshape(*array.shape, *(1,) * trailing)


def view_words(rows: Rows, name: str, views: Tensor, counters: Tensor) -> Tensor:
    """Return the 64-bit words of the random stream ``name`` for each view.

    There is one word per counter; the result is int64 [B, V, *counters.shape].
    """
    streams = np.stack([view_streams(key, name, views.shape[1]) for key in rows.keys])
    return mix(on_device(streams, views, counters.dim()), counters)


def pixel_words(rows: Rows, name: str, views: Tensor) -> Tensor:
    """Return one random word per pixel, int64 [B, V, H, W]; the pixel index is the counter."""
    size = views.shape[2:4]
    counters = torch.arange(size.numel(), device=views.device).reshape(size)
    return view_words(rows, name, views, counters)


@lru_cache(maxsize=8)
def _normal_table(device: torch.device) -> Tensor:
    return torch.from_numpy(normal_table().copy()).to(device)


def normals(words: Tensor, count: int) -> Tensor:
    """Convert random words to ``count`` standard normal numbers, float32 [..., count].

    Each word (int64) gives four numbers.
    """
    quarters = words.view(torch.int16)[..., :count].int()  # the lowest 16 bits of a word come first
    places = (quarters >> 4) & 0xFFF
    return _normal_table(words.device).index_select(0, places.flatten()).reshape(places.shape)


@lru_cache(maxsize=32)
def _smoothing(cells: int, correlation: float, device: torch.device) -> Tensor:
    """Return the matrix that smooths a torus along one axis, float32 [cells, cells]."""
    weights = field_weights(correlation)
    matrix = np.zeros((cells, cells), np.float32)
    for offset, weight in enumerate(weights, start=-(weights.size // 2)):
        matrix[np.arange(cells), (np.arange(cells) + offset) % cells] += weight
    return torch.from_numpy(matrix).to(device)


@lru_cache(maxsize=32)
def _resizing(cells: int, pixels: int, device: torch.device) -> Tensor:
    """Return the matrix of linear interpolation along a torus axis, float32 [pixels, cells]."""
    place = (np.arange(pixels) + 0.5) * cells / pixels - 0.5 + cells
    first = place.astype(int)
    share = (place - first).astype(np.float32)
    matrix = np.zeros((pixels, cells), np.float32)
    np.add.at(matrix, (np.arange(pixels), first % cells), np.float32(1.0) - share)
    np.add.at(matrix, (np.arange(pixels), (first + 1) % cells), share)
    return torch.from_numpy(matrix).to(device)


def fields(
    values: Sequence[int], height: int, width: int, correlation: float, like: Tensor
) -> tuple[Tensor, Tensor]:
    """Compute ``keying.field`` for each row.

    Returns:
        The fields (float32 [B, H, W]), and their cells in ascending order (float32 [B, n]).
    """
    rows, columns = field_grid(height, width)
    streams = on_device(np.array(values, np.uint64), like, 1)
    words = mix(streams, torch.arange(-(-rows * columns // 4), device=like.device))
    noise = normals(words, rows * columns).reshape(-1, rows, columns)
    down = _smoothing(rows, correlation, like.device)
    right = _smoothing(columns, correlation, like.device)
    cells = down @ noise @ right.T
    smooth = _resizing(rows, height, like.device) @ cells
    return smooth @ _resizing(columns, width, like.device).T, cells.flatten(1).sort(dim=1).values


def levels(cells: Tensor, shares: Sequence[float] | np.ndarray) -> Tensor:
    """Compute ``keying.top_share`` for each row of sorted cells [B, n], float32 [B, 1, 1]."""
    count = cells.shape[1]
    places = [top_place(count, share) for share in shares]
    reached = cells.gather(1, on_device(np.minimum(places, count - 1), cells, 1))
    is_empty = on_device(np.array(places) == count, cells, 1)
    return reached.masked_fill(is_empty, torch.inf).unsqueeze(-1)
