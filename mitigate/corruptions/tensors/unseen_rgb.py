"""The unseen RGB corruptions for uint8 batches [B, V, H, W, 3].

Functions have the same arguments and results as in ``rgb.py`` of this package. The formulas are in
``light``, ``optics``, ``signal`` and ``codec`` of ``mitigate/corruptions/unseen``.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from mitigate.corruptions.keying import scramble
from mitigate.corruptions.tensors.draws import Rows, fields, on_device, pixel_words, shifted
from mitigate.corruptions.tensors.pixels import (
    colour_rows,
    cover,
    displaced,
    grey_levels,
    look_up,
    moved,
    per_colour,
    rolled,
)
from mitigate.corruptions.unseen import codec, light, optics, signal


def _by_tables(views: Tensor, tables: list[list[np.ndarray]]) -> Tensor:
    """Map each colour channel of each row by its own table of 256 grey levels."""
    first = torch.arange(0, 768 * len(views), 256, dtype=torch.int32, device=views.device)
    places = views.flatten(3).int() + colour_rows(first.reshape(-1, 3), views.shape[3])
    return look_up(on_device(np.array(tables), views).flatten(), places).reshape(views.shape)


def white_balance(views: Tensor, rows: Rows) -> Tensor:
    """Multiply red, green and blue by different gains."""
    return _by_tables(views, rows.draw(light.balance_tables))


def overexposure(views: Tensor, rows: Rows) -> Tensor:
    """Multiply light by a factor, and clip it at white."""
    return _by_tables(views, rows.draw(light.exposure_tables))


def haze(views: Tensor, rows: Rows) -> Tensor:
    """Blend each view with haze."""
    count, height, width = views.shape[1:4]
    total = torch.zeros((), device=views.device)
    for octave, (correlation, weight) in enumerate(light.HAZE_OCTAVES):
        values = [scramble(value, octave) for value in rows.digests("haze")]
        total = total + weight * fields(values, height, width, correlation, views)[0]
    spread = light.HAZE_UNEVEN / math.hypot(*(weight for _, weight in light.HAZE_OCTAVES))
    density = (1.0 + spread * total).clamp(light.HAZE_THIN, light.HAZE_THICK)
    strength = on_device([-light.HAZE_DEPTH * severity for severity in rows.severities], views, 2)
    opacity = 1.0 - (strength * density).exp()
    offsets = [[-light.haze_offset(key, view, width) for view in range(count)] for key in rows.keys]
    right = on_device(offsets, views, 2)
    opacity = per_colour(rolled(opacity, torch.zeros_like(right), right))
    return cover(views, opacity, on_device([light.HAZE_COLOUR], views).float())


def hue_shift(views: Tensor, rows: Rows) -> Tensor:
    """Rotate all hues."""
    matrices = [light.hue_matrix(degrees) for degrees in rows.draw(light.hue_degrees)]
    source = views.int()
    rotated = torch.full_like(source, 2048)
    columns = on_device(np.stack(matrices), views)[:, None, None, None].unbind(-1)
    for colour, column in enumerate(columns):
        rotated += source[..., colour : colour + 1] * column
    return (rotated >> 12).clamp(0, 255).to(torch.uint8)


def ghosting(views: Tensor, rows: Rows) -> Tensor:
    """Blend each view with a shifted copy of itself."""
    offsets = [optics.ghost_offset(key, *views.shape[2:4]) for key in rows.keys]
    down, right = on_device(offsets, views, 3).unbind(1)
    weight = on_device([optics.ghost_weight(severity) for severity in rows.severities], views, 4)
    gap = moved(views, down, right).int() - views
    return (views + ((gap * weight + 32768) >> 16)).to(torch.uint8)


def refraction(views: Tensor, rows: Rows) -> Tensor:
    """Displace pixels by the slope of a wet pane's surface."""
    height, width = views.shape[2:4]
    surface = fields(rows.digests("refraction"), height, width, optics.DROPS, views)[0]
    slopes = torch.stack([surface.roll(-1, axis) - surface.roll(1, axis) for axis in (1, 2)])
    rms = slopes.square().sum(0).mean((1, 2), keepdim=True).sqrt()
    reach = on_device([optics.BEND * s * min(height, width) for s in rows.severities], views, 2)
    down, right = (slopes / rms.clamp(min=1e-9) * reach).unsqueeze(2)
    return displaced(views, down, right)


def scratches(views: Tensor, rows: Rows) -> Tensor:
    """Draw bright lines with a glow."""
    height, width = views.shape[2:4]
    side = min(height, width)
    values = rows.digests("scratches")
    y = (torch.arange(height, device=views.device) + 0.5).reshape(-1, 1) / side
    x = (torch.arange(width, device=views.device) + 0.5) / side
    clear = torch.ones((len(views), height, width), device=views.device)
    for number in range(optics.SCRATCHES):
        strengths = [optics.scratch_strength(severity, number) for severity in rows.severities]
        if max(strengths) == 0.0:
            break
        lines = np.array([optics.scratch_line(value, number) for value in values])
        row, column, _, half = on_device(lines, views, 2).unbind(1)
        cosine, sine = (on_device(f(lines[:, 2]), views, 2) for f in (np.cos, np.sin))
        down, right = y - row * (height / side), x - column * (width / side)
        beyond = ((right * cosine + down * sine).abs() - half).clamp(min=0.0)
        squared = (down * cosine - right * sine).square() + beyond.square()
        for reach, most in optics.SCRATCH_PARTS:
            strength = on_device(np.array(strengths) * most, views, 2)
            clear *= 1.0 - strength * (squared * (-0.5 / reach**2)).exp()
    opacity = per_colour(1.0 - clear).unsqueeze(1)
    return cover(views, opacity, on_device([optics.SCRATCH_COLOUR], views).float())


def rolling_shutter(views: Tensor, rows: Rows) -> Tensor:
    """Shift each image row sideways."""
    shifts = rows.draw(signal.wobble, *views.shape[2:4])
    right = on_device(np.stack(shifts), views, 1)[:, None]
    return displaced(views, torch.zeros_like(right), right)


def flicker_bands(views: Tensor, rows: Rows) -> Tensor:
    """Scale the brightness of each image row."""
    gains = rows.draw(signal.band_gains, *views.shape[1:3])
    scaled = (views.int() * on_device(np.stack(gains), views, 2) + 2048) >> 12
    return scaled.clamp(max=255).to(torch.uint8)


def impulse_noise(views: Tensor, rows: Rows) -> Tensor:
    """Set the colours of random pixels to 0 or 255."""
    words = pixel_words(rows, "impulse_noise", views).unsqueeze(-1)
    limits = on_device([signal.impulse_limit(severity) for severity in rows.severities], views, 4)
    levels = 255 * ((words >> torch.arange(3, device=views.device)) & 1)
    return torch.where(shifted(words, 32) < limits, levels.to(torch.uint8), views)


def compression(views: Tensor, rows: Rows) -> Tensor:
    """Set small DCT coefficients of image blocks to 0."""
    batch, count, height, width, _ = views.shape
    side = codec.block_side(height, width)
    colours = on_device(codec.opponents(), views)
    matrix = on_device(codec.cosines(side), views)
    planes = (views.float() @ colours.T).permute(0, 1, 4, 2, 3).flatten(0, 1)
    padded = functional.pad(planes, (0, -width % side, 0, -height % side), mode="replicate")
    blocks = padded.unflatten(3, (-1, side)).unflatten(2, (-1, side)).transpose(3, 4)
    cells = (matrix @ blocks @ matrix.T).unflatten(0, (batch, count))
    zones = [codec.dead_zones(severity, side) for severity in rows.severities]
    least = on_device(np.stack(zones), views, 4)[:, None]
    strong = torch.where(cells.abs() >= least, cells, 0.0)
    strong[..., 0, 0] = cells[..., 0, 0]
    decoded = (matrix.T @ strong @ matrix).transpose(4, 5).flatten(5, 6).flatten(3, 4)
    decoded = decoded[..., :height, :width].permute(0, 1, 3, 4, 2) @ colours
    return grey_levels(decoded.clamp(0.0, 255.0))


def lost_slices(views: Tensor, rows: Rows) -> Tensor:
    """Replace parts of image rows by grey."""
    width = views.shape[3]
    first = np.full(views.shape[:3], width)
    for starts, parts in zip(first, rows.draw(codec.lost_parts, *views.shape[1:4]), strict=True):
        for view, lines, start in parts:
            starts[view, lines] = start
    lost = torch.arange(width, device=views.device) >= on_device(first, views, 1)
    return views.flatten(3).masked_fill(per_colour(lost), codec.NOTHING).reshape(views.shape)
