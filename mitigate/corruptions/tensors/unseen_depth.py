"""The unseen depth corruptions for batches [B, V, H, W] in float32 metres.

Functions have the same arguments and results as in ``depth.py`` of this package. The formulas are
in ``calibration``, ``edges`` and ``returns`` of ``mitigate/corruptions/unseen``.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from mitigate.corruptions.depth_sensor import NEAREST
from mitigate.corruptions.keying import uniform
from mitigate.corruptions.tensors.draws import (
    Rows,
    fields,
    levels,
    on_device,
    pixel_words,
    shifted,
    view_words,
)
from mitigate.corruptions.tensors.pixels import (
    clip_valid,
    farthest,
    is_valid,
    moved,
    nearest,
    rolled,
)
from mitigate.corruptions.unseen import calibration, edges, returns


def scale_error(views: Tensor, rows: Rows) -> Tensor:
    """Multiply depth by a wrong factor."""
    factors = on_device(rows.draw(calibration.scale_factor), views, 3)
    return clip_valid(views, views * factors, rows.sensor)


def misalignment(views: Tensor, rows: Rows) -> Tensor:
    """Shift depth; pixels whose source is invalid keep their depth."""
    offsets = on_device(rows.draw(calibration.depth_offset, views.shape[3]), views, 3)
    source = moved(views, *offsets.unbind(1))
    return clip_valid(views, torch.where(is_valid(source), source, views), rows.sensor)


def wiggling(views: Tensor, rows: Rows) -> Tensor:
    """Add a sine of depth, for the nearest depth in the table of the numpy version."""
    phases = on_device([uniform(value) for value in rows.digests("wiggling")], views, 3)
    amplitudes = on_device(rows.scaled(calibration.WIGGLE), views, 3)
    clean = views.clamp(0.0, rows.sensor.z_max)
    metres = rows.sensor.z_max / calibration.WIGGLE_CELLS  # per cell
    cell = (clean * (1.0 / metres) + 0.5).floor()
    turns = cell * (metres / calibration.WIGGLE_PERIOD) + phases
    return clip_valid(views, clean + amplitudes * (2.0 * math.pi * turns).sin(), rows.sensor)


def fattening(views: Tensor, rows: Rows) -> Tensor:
    """Set each pixel to the smallest depth nearby; rows are computed one at a time."""
    smallest = torch.empty_like(views)
    for row, severity in enumerate(rows.severities):
        reach = edges.FATTENING * severity * min(views.shape[2:])
        whole = math.floor(reach)
        near, nearer = (nearest(views[row : row + 1], whole + more) for more in (0, 1))
        smallest[row] = (near + (reach - whole) * (nearer - near))[0]
    return clip_valid(views, smallest, rows.sensor)


def edge_shadow(views: Tensor, rows: Rows) -> Tensor:
    """Remove pixels that no projector ray reaches."""
    width = views.shape[3]
    rays = rows.draw(edges.projector, width)
    offset = on_device([ray[0] for ray in rays], views, 3)
    to_left = on_device([ray[1] < 0 for ray in rays], views, 3)
    scanned = torch.where(to_left, views.flip(3), views)
    columns = torch.arange(width, device=views.device)
    places = columns + offset / scanned.clamp(min=float(NEAREST))
    places = places.masked_fill(~is_valid(scanned), -torch.inf)
    reached = places.cummax(3).values[..., :-1]
    lit = torch.ones_like(scanned, dtype=torch.bool)
    lit[..., 1:] = places[..., 1:] > reached
    lit = torch.where(to_left, lit.flip(3), lit)
    removed = is_valid(views) & ~lit
    return clip_valid(views, views, rows.sensor).masked_fill(removed, rows.sensor.missing)


def flying_pixels(views: Tensor, rows: Rows) -> Tensor:
    """Set random pixels to a depth between the nearest and farthest depth around them."""
    reach = edges.footprint(*views.shape[2:])
    words = pixel_words(rows, "flying_pixels", views)
    near, far = nearest(views, reach), farthest(views, reach)
    mixed = near + shifted(words, 48).float() * 2.0**-16 * (far - near)
    limits = on_device([round(severity * 2**32) for severity in rows.severities], views, 3)
    return clip_valid(views, torch.where((words & 0xFFFFFFFF) < limits, mixed, views), rows.sensor)


def ripple(views: Tensor, rows: Rows) -> Tensor:
    """Add a random field to depth, which makes walls look wavy."""
    count, height, width = views.shape[1:]
    digests = rows.digests("ripple")
    waves = fields(digests, height, width, returns.RIPPLE_CORRELATION, views)[0]
    offsets = [returns.ripple_offsets(key, count, height, width) for key in rows.keys]
    down, right = on_device(offsets, views, 2).unbind(2)
    strength = on_device(rows.scaled(returns.RIPPLE), views, 3)
    z = views.clamp(max=rows.sensor.z_max)
    return clip_valid(views, z + strength * z * z * rolled(waves, -down, -right), rows.sensor)


def range_limit(views: Tensor, rows: Rows) -> Tensor:
    """Remove depth beyond a maximum range."""
    limits = [rows.sensor.z_max * returns.RANGE_LEFT**severity for severity in rows.severities]
    near = clip_valid(views, views, rows.sensor)
    removed = is_valid(views) & (near > on_device(limits, views, 3))
    return near.masked_fill(removed, rows.sensor.missing)


def mismatches(views: Tensor, rows: Rows) -> Tensor:
    """Set random patches of pixels to random depths."""
    height, width = views.shape[2:]
    side = returns.speckle_side(height, width)
    down, right = (torch.arange(size, device=views.device) // side for size in (height, width))
    words = view_words(rows, "mismatches", views, 65536 * down.unsqueeze(1) + right)
    wrong = (shifted(words, 40) + 1).float() * 2.0**-24 * rows.sensor.z_max
    limits = [round(returns.WRONG * severity * 2**32) for severity in rows.severities]
    read = torch.where((words & 0xFFFFFFFF) < on_device(limits, views, 3), wrong, views)
    return clip_valid(views, read, rows.sensor)


def glossy_floor(views: Tensor, rows: Rows) -> Tensor:
    """Set the depth of parts of the floor to the depth of the reflected scene."""
    count, height, width = views.shape[1:]
    digests = rows.digests("glossy_floor")
    smooth, cells = fields(digests, height, width, returns.GLOSS_CORRELATION, views)
    offsets = [
        [-returns.gloss_offset(key, view, width) for view in range(count)] for key in rows.keys
    ]
    right = on_device(offsets, views, 2)
    gloss = rolled(smooth >= levels(cells, rows.severities), torch.zeros_like(right), right)
    clean = clip_valid(views, views, rows.sensor)
    lines = torch.arange(height, device=views.device).unsqueeze(1)
    slope = (lines + 0.5 - 0.5 * height) / (0.5 * width)
    below = views.masked_fill(~is_valid(views), 0.0) * slope
    floor = (below > 0) & (below >= returns.FLOOR * below.amax((2, 3), keepdim=True)) & gloss
    wall = clean.masked_fill(~is_valid(clean), 0.0).amax(2, keepdim=True)
    mirrored = torch.minimum(returns.UPSIDE_DOWN * clean, wall)
    return torch.where(floor & (mirrored > clean), mirrored, clean)
