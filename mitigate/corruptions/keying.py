"""Keyed random numbers, which depend only on seed, episode, corruption, frame, view and pixel.

The parts of a key are hashed to a 64-bit blake2b digest. An integer hash (splitmix64, Steele et al.
2014) of the digest and a counter gives the random numbers. Global state, Python's ``hash()`` and
stateful generators are not used. Therefore the pixels of a frame do not depend on its batch, on the
process, or on the order in which frames are corrupted. A resumed run gives the same pixels.

Tables and masks are computed in float64 and then rounded to fixed point or float32. Kernels use
only basic arithmetic. Therefore pixels do not depend on the last bit of functions such as ``exp``,
which differs between machines.

After editing ``mix``, delete ``__pycache__``. Numba does not notice changes to functions that are
inlined into other files.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, wraps
from hashlib import blake2b
from operator import index
from statistics import NormalDist
from typing import ParamSpec, TypeVar

import numpy as np
from numba import njit

from mitigate.core.memory import Memory

# cache size per process in bytes (heuristic), enough for 20 masks of 1080p frames
MAX_CACHE_BYTES = 256 << 20

P = ParamSpec("P")
T = TypeVar("T")
_memory = Memory(MAX_CACHE_BYTES)


def cached(function: Callable[P, T]) -> Callable[P, T]:
    """Cache the results (arrays or tuples of arrays) of a pure function with hashable arguments."""

    @wraps(function)
    def lookup(*args: P.args, **kwargs: P.kwargs) -> T:
        key = (function, args, *kwargs.items())
        return _memory.recall(key, lambda: function(*args, **kwargs))

    return lookup


GOLDEN = 0x9E3779B97F4A7C15  # splitmix64 increment
MIX_A, MIX_B = 0xBF58476D1CE4E5B9, 0x94D049BB133111EB  # splitmix64 multipliers
MASK = (1 << 64) - 1
# This is log2 of the size of the table of normal quantiles, which covers +-3.7.
# The table takes 16 KB, so it fits into the L1 cache.
NORMAL_BITS = 12
FIELD_SIDE = 128  # number of cells along the shorter side of a random field, for all frame sizes
# maximum number of cells along the longer side; for aspect ratios above 32:1, cells are not square
FIELD_LONGEST = 32 * FIELD_SIDE

_U = np.uint64
_GOLDEN, _A, _B = _U(GOLDEN), _U(MIX_A), _U(MIX_B)
_S30, _S27, _S31 = _U(30), _U(27), _U(31)


@dataclass(frozen=True)
class Key:
    """The key of a time step; it determines all random numbers of the step.

    Lens dirt, flare position and similar properties depend on seed and episode; pixel noise also
    depends on the frame. A schedule with the mode ``per_frame`` uses a new ``episode`` for every
    frame.

    Attributes:
        seed: Corruption seed.
        episode: Name of the episode.
        frame: Number of the frame in the episode.

    Raises:
        ValueError: If seed or frame is not an integer.
    """

    seed: int
    episode: str
    frame: int = 0

    def __post_init__(self) -> None:
        try:
            index(self.seed), index(self.frame)
        except TypeError:
            raise ValueError(
                f"The seed and the frame of a key must be whole numbers, got seed={self.seed!r}, "
                f"frame={self.frame!r}. Write for example Key(0, '17', frame=3)."
            ) from None


def as_key(key: Key | int | str) -> Key:
    """Convert ``key`` to a Key: an int n becomes Key(n, "0"), and a str t becomes Key(0, t).

    Raises:
        ValueError: If ``key`` is not a Key, an int or a str.
    """
    if isinstance(key, Key):
        return key
    if isinstance(key, str):
        return Key(0, key)
    if isinstance(key, int | np.integer) and not isinstance(key, bool):
        return Key(int(key), "0")
    raise ValueError(
        "key must be a Key(seed, episode, frame), a whole number (the seed) or a text (the "
        f"episode), got {key!r}. Equal keys give equal pixels."
    )


@lru_cache(maxsize=256)
def _episode_hash(seed: int, episode: str, name: str) -> tuple:
    """Hash seed, episode and name; return the state of the hash function and the 64-bit digest.

    The state is cached, so callers must copy it before they add the frame.
    """
    text = "".join(f"{len(part)}:{part}" for part in (str(seed), episode, name))
    state = blake2b(text.encode("utf-8", "surrogatepass"), digest_size=8, person=b"mitigate")
    return state, int.from_bytes(state.digest(), "little")


def digest(key: Key, name: str, *, frame: bool = False) -> int:
    """Return the 64-bit digest that seeds the random stream ``name``.

    The digest differs between episodes; with ``frame=True``, it also differs between frames. View
    number k of a frame uses ``scramble(digest, k)``.
    """
    state, value = _episode_hash(int(key.seed), str(key.episode), name)
    if not frame:
        return value
    state, part = state.copy(), str(int(key.frame))
    state.update(f"{len(part)}:{part}".encode())
    return int.from_bytes(state.digest(), "little")


def scramble(value: int, counter: int) -> int:
    """Return output number ``counter`` of a splitmix64 generator that is seeded with ``value``.

    This version uses Python integers; ``mix`` is the compiled version.
    """
    z = (value + (counter + 1) * GOLDEN) & MASK
    z = ((z ^ (z >> 30)) * MIX_A) & MASK
    z = ((z ^ (z >> 27)) * MIX_B) & MASK
    return z ^ (z >> 31)


def uniform(value: int, counter: int = 0) -> float:
    """Convert ``scramble(value, counter)`` to a uniform random number in [0, 1) with 53 bits."""
    return (scramble(value, counter) >> 11) * 2.0**-53


def sign(key: Key, name: str) -> float:
    """Return a random sign, 1 or -1, of the stream ``name``; it is constant in an episode."""
    return 1.0 if uniform(digest(key, name)) < 0.5 else -1.0


@njit(inline="always")
def mix(value, counter):
    """Compute ``scramble`` in compiled code; arguments and result are uint64."""
    z = value + (counter + _U(1)) * _GOLDEN
    z = (z ^ (z >> _S30)) * _A
    z = (z ^ (z >> _S27)) * _B
    return z ^ (z >> _S31)


@njit(cache=True)
def _fill_streams(value, out):
    for view in range(out.size):
        out[view] = mix(value, _U(view))


def view_streams(key: Key, name: str, views: int) -> np.ndarray:
    """Return one seed per view of a frame for the random stream ``name``, uint64 [views]."""
    out = np.empty(views, np.uint64)
    _fill_streams(_U(digest(key, name, frame=True)), out)
    return out


def unit_normals(bits: int) -> np.ndarray:
    """Return the standard normal quantiles at the centres of 2^bits equally likely bins, float64.

    The quantiles are scaled to unit variance.
    """
    count = 1 << bits
    half = np.array([NormalDist().inv_cdf((i + 0.5) / count) for i in range(count // 2)])
    table = np.concatenate([half, -half[::-1]])
    return table / np.sqrt(np.mean(table**2))


@lru_cache(maxsize=1)
def normal_table() -> np.ndarray:
    """Return the table of normal quantiles that pixel noise uses, float32 [4096]."""
    return unit_normals(NORMAL_BITS).astype(np.float32)


@njit(cache=True)
def _fill_normals(value, table, out):
    for i in range(out.size):
        word = mix(value, _U(i >> 2))
        out[i] = table[(word >> _U(((i & 3) << 4) + 4)) & _U(0xFFF)]


def normals(value: int, count: int) -> np.ndarray:
    """Return ``count`` standard normal numbers, float32 [count]; ``value`` is the seed."""
    out = np.empty(count, np.float32)
    _fill_normals(_U(value), normal_table(), out)
    return out


@njit(cache=True)
def _blur_torus(noise, weights):
    rows, cols = noise.shape
    radius = weights.size // 2
    tall = np.zeros((rows, cols + 2 * radius), np.float32)
    out = np.zeros((rows, cols), np.float32)
    for y in range(rows):
        for k in range(weights.size):
            source = (y + k - radius) % rows
            for x in range(cols):
                tall[y, radius + x] += weights[k] * noise[source, x]
        for x in range(radius):
            tall[y, x] = tall[y, cols + x]
            tall[y, cols + radius + x] = tall[y, radius + x]
        for k in range(weights.size):
            for x in range(cols):
                out[y, x] += weights[k] * tall[y, x + k]
    return out


@njit(cache=True)
def _between(a, b, share, out):
    for x in range(out.size):
        out[x] = a[x] + share * (b[x] - a[x])


@njit(cache=True)
def _resize_torus(cells, height, width):
    rows, cols = cells.shape
    out = np.empty((height, width), np.float32)
    left, share = np.empty(width, np.uint32), np.empty(width, np.float32)
    for x in range(width):
        u = (x + 0.5) * cols / width - 0.5 + cols
        left[x] = int(u) % cols
        share[x] = u - int(u)
    line = np.empty(cols + 1, np.float32)
    for y in range(height):
        v = (y + 0.5) * rows / height - 0.5 + rows
        above = int(v)
        _between(cells[above % rows], cells[(above + 1) % rows], np.float32(v - above), line[:cols])
        line[cols] = line[0]
        row = out[y]
        for x in range(width):
            i = left[x]
            row[x] = line[i] + share[x] * (line[i + np.uint32(1)] - line[i])
    return out


def field_grid(height: int, width: int) -> tuple[int, int]:
    """Return the numbers of rows and columns of a random field's grid."""
    scale = FIELD_SIDE / min(height, width)
    rows, cols = (min(round(side * scale), FIELD_LONGEST) for side in (height, width))
    return rows, cols


def field_weights(correlation: float) -> np.ndarray:
    """Return the smoothing kernel of a random field, float32 [2 * radius + 1], with norm 1."""
    sigma = correlation * FIELD_SIDE
    radius = int(np.ceil(3.0 * sigma))
    weights = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    return (weights / np.sqrt(np.sum(weights**2))).astype(np.float32)


@cached
def field(value: int, height: int, width: int, correlation: float) -> tuple:
    """Sample a Gaussian random field on a torus.

    The field is sampled on a grid whose shorter side has ``FIELD_SIDE`` cells, and then resampled.
    Therefore a frame and a copy of half its size get the same pattern. If the aspect ratio of a
    frame exceeds 32:1, the cells are not square.

    Args:
        value: Seed of the random numbers.
        height: Height of the frame in pixels.
        width: Width of the frame in pixels.
        correlation: Standard deviation of the smoothing kernel as a fraction of the shorter side.

    Returns:
        The field (float32 [height, width]), which has unit standard deviation, and the cells before
        resampling (float32 [cells]).
    """
    rows, cols = field_grid(height, width)
    noise = normals(value, rows * cols).reshape(rows, cols)
    cells = _blur_torus(noise, field_weights(correlation))
    smooth = _resize_torus(cells, height, width)
    smooth.flags.writeable = cells.flags.writeable = False
    return smooth, cells.ravel()


def top_place(cells: int, share: float) -> int:
    """Return the index at which the highest fraction ``share`` of sorted cells begins.

    The cells are sorted in ascending order; ``cells`` is their number.
    """
    return cells - round(share * cells)


def top_share(cells: np.ndarray, share: float) -> float:
    """Return the threshold that a fraction ``share`` of the cells reaches.

    The threshold is infinity if ``share`` is 0.
    """
    place = top_place(cells.size, share)
    return float("inf") if place == cells.size else float(np.partition(cells, place)[place])
