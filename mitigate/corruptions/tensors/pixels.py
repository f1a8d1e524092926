"""Pixel operations on batches of views, which several corruptions use.

RGB is uint8 [B, V, H, W, 3], and depth is float32 metres [B, V, H, W]. Several functions work on
image rows of 3 * W colour values, because broadcasting over a last axis of size 3 is slow.
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional

from mitigate.corruptions.depth_sensor import NEAREST, DepthSensor


def per_colour(pixels: Tensor) -> Tensor:
    """Repeat the value of each pixel [..., W] for its three colours, [..., 3 W]."""
    return pixels.repeat_interleave(3, -1)


def colour_rows(colours: Tensor, width: int) -> Tensor:
    """Repeat each of B colours ([B, 3]) for ``width`` pixels; return [B, 1, 1, 3 * width]."""
    return colours.repeat(1, width)[:, None, None]


def grey_levels(values: Tensor) -> Tensor:
    """Round values in [0, 255] to the nearest grey levels, uint8."""
    return (values + 0.5).to(torch.uint8)


def cover(views: Tensor, opacity: Tensor, colours: Tensor) -> Tensor:
    """Blend RGB with a colour, as in ``masks.cover``.

    Args:
        views: uint8 [B, V, H, W, 3].
        opacity: Opacity in [0, 1], float32 [B, V or 1, H, 3 W].
        colours: float32 [B or 1, 3].
    """
    source = views.flatten(3).float()
    blend = torch.lerp(source, colour_rows(colours, views.shape[3]), opacity)
    return grey_levels(blend).reshape(views.shape)


def look_up(table: Tensor, places: Tensor) -> Tensor:
    """Return the entries of a table [n] at ``places`` (integers of any shape)."""
    return table.index_select(0, places.flatten()).reshape(places.shape)


def at(views: Tensor, rows: Tensor, columns: Tensor) -> Tensor:
    """Return the pixels of ``views`` [B, V, H, W, ...] at ``rows`` and ``columns``.

    ``rows`` and ``columns`` are broadcast to [B, V, h, w].
    """
    batch, count = views.shape[:2]
    row = torch.arange(batch, device=views.device).reshape(-1, 1, 1, 1)
    view = torch.arange(count, device=views.device).reshape(1, -1, 1, 1)
    return views[row, view, rows, columns]


def moved(views: Tensor, down: Tensor, right: Tensor) -> Tensor:
    """Return, for each pixel (y, x), the pixel at (y + down, x + right); edges are repeated.

    ``views`` is [B, V, H, W, ...]; ``down`` and ``right`` are int64 [B, 1, 1, 1].
    """
    height, width = views.shape[2:4]
    rows = torch.arange(height, device=views.device).reshape(-1, 1) + down
    columns = torch.arange(width, device=views.device) + right
    return at(views, rows.clamp(0, height - 1), columns.clamp(0, width - 1))


def rolled(maps: Tensor, down: Tensor, right: Tensor) -> Tensor:
    """Return ``maps``, shifted on a torus separately for each view, as [B, V, H, W].

    The value at (y, x) of a view is the value of ``maps`` [B, H, W] at (y + down, x + right).
    ``down`` and ``right`` are int64 [B, V, 1, 1].
    """
    batch, height, width = maps.shape
    rows = (torch.arange(height, device=maps.device).reshape(-1, 1) + down) % height
    columns = (torch.arange(width, device=maps.device) + right) % width
    row = torch.arange(batch, device=maps.device).reshape(-1, 1, 1, 1)
    return maps[row, rows, columns]


def displaced(views: Tensor, down: Tensor, right: Tensor) -> Tensor:
    """Return, for each pixel (y, x), the RGB value at (y + down, x + right).

    Values are interpolated bilinearly, as in ``unseen.optics.displaced``. ``down`` and ``right``
    are float32, in pixels, and are broadcast to [B, V, H, W].
    """
    height, width = views.shape[2:4]
    y = 256 * torch.arange(height, device=views.device).reshape(-1, 1)
    x = 256 * torch.arange(width, device=views.device)
    v = (y + (down * 256).floor().long()).clamp(0, (height - 1) * 256)
    u = (x + (right * 256).floor().long()).clamp(0, (width - 1) * 256)
    top, left = v >> 8, u >> 8
    below, beside = (top + 1).clamp(max=height - 1), (left + 1).clamp(max=width - 1)
    b, a = (v & 255).int().unsqueeze(-1), (u & 255).int().unsqueeze(-1)
    upper = at(views, top, left) * (256 - a) + at(views, top, beside) * a
    lower = at(views, below, left) * (256 - a) + at(views, below, beside) * a
    return ((upper * (256 - b) + lower * b + 32768) >> 16).to(torch.uint8)


def is_valid(depth: Tensor) -> Tensor:
    """Return a mask of valid depth: positive and finite."""
    return (depth > 0) & (depth < torch.inf)


def clip_valid(views: Tensor, changed: Tensor, sensor: DepthSensor) -> Tensor:
    """Clip ``changed`` to the sensor's range, and keep the invalid pixels of ``views``."""
    return torch.where(is_valid(views), changed.clamp(float(NEAREST), sensor.z_max), views)


def farthest(views: Tensor, reach: int) -> Tensor:
    """Return the maximum of valid depth in the square of side 2 * reach + 1 around each pixel.

    The result is -inf if no depth in the square is valid.
    """
    return _largest(views.masked_fill(~is_valid(views), -torch.inf), reach)


def nearest(views: Tensor, reach: int) -> Tensor:
    """Return the minimum of valid depth in the square of side 2 * reach + 1 around each pixel.

    The result is inf if no depth in the square is valid.
    """
    return -_largest((-views).masked_fill(~is_valid(views), -torch.inf), reach)


def _largest(values: Tensor, reach: int) -> Tensor:
    """Return the maximum in the square of side 2 * reach + 1, doubling the window repeatedly."""
    values = functional.pad(values, (reach,) * 4, value=-torch.inf)
    for axis in (2, 3):
        window = 1
        while window <= 2 * reach:
            step = min(window, 2 * reach + 1 - window)
            size = values.shape[axis] - step
            first, second = (values.narrow(axis, start, size) for start in (0, step))
            values = torch.maximum(first, second)
            window += step
    return values
