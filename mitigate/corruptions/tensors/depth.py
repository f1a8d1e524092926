"""The depth corruptions of the standard suite and the unseen ones, for batches of views.

Each function that is named after a corruption takes the views (float32 metres [B, V, H, W]) and the
parameters of each row (``Rows``), and returns a new batch. The formulas are in
``mitigate/corruptions/depth.py`` and in the files of ``unseen``, which also sample the random
numbers per row.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

from mitigate.corruptions import depth
from mitigate.corruptions.depth_sensor import NEAREST
from mitigate.corruptions.keying import scramble, uniform
from mitigate.corruptions.tensors.draws import (
    Rows,
    fields,
    levels,
    normals,
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


def gaussian_noise(views: Tensor, rows: Rows) -> Tensor:
    """Add severity * (0.02 + 0.02 z^2) * N(0, 1) to each pixel."""
    count = views.shape[2] * views.shape[3]
    counters = torch.arange(-(-count // 4), device=views.device)  # each word gives four numbers
    words = view_words(rows, "gaussian_noise", views, counters)
    noise = normals(words, count).reshape(views.shape)
    base, square = (
        on_device(rows.scaled(factor), views, 3)
        for factor in (depth.NOISE_BASE, depth.NOISE_SQUARE)
    )
    z = views.clamp(max=rows.sensor.z_max)
    return clip_valid(views, z + (base + square * z * z) * noise, rows.sensor)


def missing_data(views: Tensor, rows: Rows) -> Tensor:
    """Replace the depth of the pixels where a random field is highest.

    These pixels are a fraction 0.5 * severity of each view. A quarter of them become z_max, and the
    others become missing.
    """
    count, height, width = views.shape[1:]
    digests = rows.digests("missing_data")
    smooth, cells = fields(digests, height, width, depth.HOLE_CORRELATION, views)
    shares = rows.scaled(depth.HOLE_SHARE)
    holes = (smooth >= levels(cells, shares)).to(torch.uint8)
    holes += smooth >= levels(cells, shares * depth.FAR_SHARE)
    streams = [depth.hole_streams(key, count).tolist() for key in rows.keys]
    down, right = (
        on_device([[scramble(s, axis) % size for s in each] for each in streams], views, 2)
        for axis, size in enumerate((height, width))
    )
    hole = rolled(holes, down, right)
    read = clip_valid(views, views, rows.sensor)
    read = torch.where(hole == 1, rows.sensor.missing, read)
    read = torch.where(hole == 2, rows.sensor.z_max, read)
    return torch.where(is_valid(views), read, views)


def multipath(views: Tensor, rows: Rows) -> Tensor:
    """Overestimate depth next to farther surfaces."""
    reach = depth.echo_reach(*views.shape[2:])
    gap = (farthest(views, reach) - views).clamp(0.0, depth.ECHO_GAP)
    polynomials = [depth.echo_polynomial(severity) for severity in rows.severities]
    share = torch.zeros_like(gap)
    for coefficient in reversed(on_device(np.stack(polynomials), views, 3).unbind(1)):
        share = share * gap + coefficient
    return clip_valid(views, views + (share * gap).clamp(min=0.0), rows.sensor)


def quantization(views: Tensor, rows: Rows) -> Tensor:
    """Round depth to multiples of 0.5 * severity metres."""
    step = on_device([depth.depth_step(severity) for severity in rows.severities], views, 3)
    return clip_valid(views, (views / step).round() * step, rows.sensor)


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
