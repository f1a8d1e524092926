"""The four depth corruptions of the standard suite for batches [B, V, H, W] in float32 metres.

Each function that is named after a corruption maps the views and the parameters of each row
(``Rows``) to a new batch. ``mitigate/corruptions/depth.py`` has the formulas and samples the random
numbers per row.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from mitigate.corruptions import depth
from mitigate.corruptions.keying import scramble
from mitigate.corruptions.tensors.draws import Rows, fields, levels, normals, on_device, view_words
from mitigate.corruptions.tensors.pixels import clip_valid, farthest, is_valid, rolled


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
    """Remove depth, or set it to z_max, in the pixels where a random field is highest."""
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
