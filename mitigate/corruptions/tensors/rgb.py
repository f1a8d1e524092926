"""The eight RGB corruptions of the standard suite for batches uint8 [B, V, H, W, 3].

Every function of ``FUNCTIONS`` takes the views and what corrupts their rows, and returns a new
batch. ``mitigate/corruptions/rgb.py`` has the formulas, and draws what a row needs.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from mitigate.corruptions import eld, masks, rgb
from mitigate.corruptions.keying import scramble, uniform
from mitigate.corruptions.tensors.draws import (
    Rows,
    fields,
    levels,
    on_device,
    pixel_words,
    shifted,
    view_words,
)
from mitigate.corruptions.tensors.pixels import cover, look_up, opacity, per_colour

UNIT = 32768.0  # an opacity of 1 in ``cover``
ONE_TAP = np.array([0]), np.array([0]), np.array([1])  # a line that is shorter than a pixel


def motion_blur(views: Tensor, rows: Rows) -> Tensor:
    """Blend with a line blur. Sums of integers below 2^24 are exact in float32."""
    lines = rows.draw(rgb.blur_line, views.shape[3])
    steps = np.array([rgb.tap_step(length) for length, _ in lines])
    taps = [
        rgb.line_taps(length, angle, int(step)) if length >= 1.0 else ONE_TAP
        for (length, angle), step in zip(lines, steps, strict=True)
    ]
    down, right = (max(int(np.abs(line[axis]).max()) for line in taps) for axis in (0, 1))
    kernels = np.zeros((len(taps), 1, 2 * down + 1, 2 * right + 1), np.float32)
    for kernel, (dy, dx, weights) in zip(kernels, taps, strict=True):
        np.add.at(kernel[0], (dy + down, dx + right), weights)
    units = kernels.sum((1, 2, 3)).astype(int)
    blurred = np.rint((0.5 + 0.5 * np.array(rows.severities)) * 65536.0 / units).astype(int)

    planes = _planes(views)
    padded = functional.pad(planes, (right + 1, right + 1, down, down), mode="replicate")
    smooth = padded[..., :-2] + 2.0 * padded[..., 1:-1] + padded[..., 2:]
    smooth = (smooth.add_(2.0) * 0.25).floor_()
    every_second = _per_plane(steps == 2, views)[:, None, None]
    source = torch.where(every_second, smooth, padded[..., 1:-1])
    total = _filtered(source, _per_plane(kernels, views)).int()
    total *= _per_plane(blurred, views).int()[:, None, None]
    rest = _per_plane(65536 - blurred * units, views).int()[:, None, None]
    return _frames((total + planes.int() * rest + 32768) >> 16, views)


def _planes(views: Tensor) -> Tensor:
    """Return the colours of RGB as channels, float32 [1, B V 3, H, W]."""
    return views.permute(0, 1, 4, 2, 3).flatten(0, 2).float().unsqueeze(0)


def _per_plane(values: np.ndarray, views: Tensor) -> Tensor:
    """Copy values of rows [B, ...] to the device, once for each plane, [B V 3, ...]."""
    return on_device(values, views).repeat_interleave(3 * views.shape[1], 0)


def _frames(planes: Tensor, views: Tensor) -> Tensor:
    """Return integer planes [1, B V 3, H, W] as a batch of the shape of ``views``."""
    apart = planes.to(torch.uint8).reshape(*views.shape[:2], 3, *views.shape[2:4])
    return apart.permute(0, 1, 3, 4, 2).contiguous()


def _filtered(planes: Tensor, kernels: Tensor) -> Tensor:
    """Correlate each plane of [1, n, h, w] with its kernel of [n, 1, y, x]."""
    return functional.conv2d(planes, kernels, groups=len(kernels))


def darkness(views: Tensor, rows: Rows) -> Tensor:
    """Return the opacity of ``masks.low_light_mask``, int32 [B, 1, H, W]."""
    height, width = views.shape[2:4]
    terms = [masks.ramp_terms(value, height, width) for value in rows.digests("low_light")]
    down = on_device(np.stack([term[0] for term in terms]), views, 1)
    right = on_device(np.stack([term[1] for term in terms]), views).unsqueeze(1)
    ramp = down + right
    ramp = torch.where(on_device([term[2] for term in terms], views, 2), ramp.sqrt(), ramp)
    share = ramp * on_device(rows.scaled(masks.DARK_RAMP), views, 2)
    share += on_device(rows.scaled(masks.DARK_BASE), views, 2)
    return opacity(share, UNIT).unsqueeze(1)


def low_light(views: Tensor, rows: Rows) -> Tensor:
    """Darken with a gradient."""
    return cover(views, per_colour(darkness(views, rows)), on_device([rgb.BLACK], views).int())


def low_light_noise(views: Tensor, rows: Rows) -> Tensor:
    """Darken and add sensor noise. The tables of all severities are joined."""
    each = sorted(set(rows.severities))
    tables = [eld.tables(severity) for severity in each]
    number = on_device([each.index(severity) for severity in rows.severities], views, 3)
    photons, read, row = (
        on_device(np.concatenate([getattr(table, part) for table in tables]), views)
        for part in ("photons", "read", "row")
    )
    span = max(table.decode.size for table in tables)
    decode = on_device([np.pad(t.decode, (0, span - t.decode.size)) for t in tables], views)
    offsets = on_device([256 * table.offset + 128 for table in tables], views).int()[number]

    light = 32768 - darkness(views, rows)
    lines = torch.arange(views.shape[2], device=views.device).unsqueeze(1)
    place = shifted(view_words(rows, "row_noise", views, lines), 52)
    shift = look_up(row, place + number * (row.numel() // len(each))) + offsets
    words = pixel_words(rows, "low_light_noise", views)
    out = torch.empty_like(views)
    number = number.int()
    for colour in range(3):
        level = (views[..., colour].int() * light).add_(4096) >> 13  # in quarters of a grey level
        bits = (words >> (20 * colour)).int()
        place = ((level + number * eld.LEVELS) << eld.PHOTON_BITS) + (bits & 0xFF)
        digital = look_up(photons, place).add_(shift)
        place = ((bits >> eld.PHOTON_BITS) & 0xFFF) + number * (1 << eld.READ_BITS)
        digital += look_up(read, place)
        out[..., colour] = look_up(decode.flatten(), (digital >> 8) + number * span)
    return out


def spatter(views: Tensor, rows: Rows) -> Tensor:
    """Cover the image with mud or water where a random field is in its top 0.45 s."""
    height, width = views.shape[2:4]
    digests = rows.digests("spatter")
    smooth, cells = fields(digests, height, width, masks.SPATTER_CORRELATION, views)
    level = levels(cells, rows.scaled(masks.SPATTER_COVER))
    share = ((smooth - level) * float(np.float32(1.0 / masks.SPATTER_EDGE))).clamp(0.0, 1.0)
    alpha = opacity(share, on_device([UNIT * (0.5 + 0.5 * s) for s in rows.severities], views, 2))
    colours = [masks.spatter_colour(value) for value in rows.digests("spatter_colour")]
    return cover(views, per_colour(alpha).unsqueeze(1), on_device(colours, views).int())


def flare(views: Tensor, rows: Rows) -> Tensor:
    """Add a glow to the views that see the light."""
    count, height, width = views.shape[1:4]
    batch = len(views)
    scales = np.zeros((batch, count, 1, 3))  # 0 in views that do not see the light
    down = np.zeros((batch, count, height, 1), np.float32)
    right = np.zeros((batch, count, 1, width), np.float32)
    values = zip(rows.digests("flare"), rows.headings, strict=True)
    for row, (value, heading) in enumerate(values):
        centres = masks.flare_centres(value, count, height, width, heading)
        for view, centre in enumerate(centres):
            if centre is not None:
                terms = masks.glow_terms(*centre, height, width)
                down[row, view, :, 0], right[row, view, 0] = terms
                scales[row, view] = UNIT * rows.severities[row] * np.array(masks.FLARE_TINT)
    table = on_device(masks.glow_table(), views)
    places = ((on_device(down, views) + on_device(right, views)).sqrt() + 0.5).int()
    glow = per_colour(look_up(table, places))
    alpha = opacity(glow, on_device(np.tile(scales, width), views))
    return cover(views, alpha, on_device([rgb.WHITE], views).int())


def blur_kernel(sigma: float) -> np.ndarray:
    """Return the kernel of ``blur.gaussian`` along one axis, float64 [n] with a sum of 1."""
    if sigma < rgb.DEFOCUS_LEAST:
        return np.ones(1)
    half, level_count = rgb.gaussian_weights(sigma)
    weights = half.astype(float)
    weights[0] *= 2.0  # the table has half of the centre weight
    taps = np.concatenate([weights[:0:-1], weights])
    kernel = np.zeros((taps.size - 1) * 2**level_count + 1)
    kernel[:: 2**level_count] = taps / taps.sum()
    for level in range(level_count):
        hat = np.zeros(2 * 2**level + 1)
        hat[[0, 2**level, -1]] = 0.25, 0.5, 0.25
        kernel = np.convolve(kernel, hat)
    return kernel


def defocus(views: Tensor, rows: Rows) -> Tensor:
    """Blur with a Gaussian kernel, which is that of the numpy filter; rounding may differ."""
    kernels = [blur_kernel(sigma) for sigma in rows.draw(rgb.defocus_sigma, *views.shape[2:4])]
    reach = max(kernel.size for kernel in kernels) // 2
    padded = [np.pad(kernel, reach - kernel.size // 2) for kernel in kernels]
    weights = _per_plane(np.stack(padded), views).unsqueeze(1)
    planes = functional.pad(_planes(views), (reach,) * 4, mode="replicate")
    blurred = _filtered(_filtered(planes, weights[..., None]), weights[:, :, None])
    return _frames((blurred + 0.5).clamp(0.0, 255.0), views)


def foreign_object(views: Tensor, rows: Rows) -> Tensor:
    """Draw a black disk at the centre."""
    height, width = views.shape[2:4]
    spans = [masks.disk_spans(severity, height, width) for severity in rows.severities]
    first, end = on_device(np.stack(spans), views, 1)[:, None].unbind(3)
    columns = torch.arange(width, device=views.device)
    outside = (columns < first) | (columns >= end)
    return (views.flatten(3) * per_colour(outside).to(torch.uint8)).reshape(views.shape)


def black_out(views: Tensor, rows: Rows) -> Tensor:
    """Make views black."""
    values = rows.digests("black_out", frame=True)
    visible = [
        [uniform(scramble(value, view)) >= severity for view in range(views.shape[1])]
        for value, severity in zip(values, rows.severities, strict=True)
    ]
    return views * on_device(visible, views, 3).to(torch.uint8)


FUNCTIONS = (
    motion_blur,
    low_light,
    low_light_noise,
    spatter,
    flare,
    defocus,
    foreign_object,
    black_out,
)
