"""The RGB corruptions of the standard suite and the unseen ones, for batches of views.

Each function that is named after a corruption takes the views (uint8 [B, V, H, W, 3]) and the
parameters of each row (``Rows``), and returns a new batch. The formulas are in
``mitigate/corruptions/rgb.py`` and in the files of ``unseen``, which also sample the random numbers
per row.
"""

from __future__ import annotations

import math

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

UNIT = 32768  # opacity of 1 in the masks of the numpy suite
HAT = np.array([[0.25, 0.5, 0.25]])
# taps of a line that is shorter than one pixel
ONE_TAP = np.array([0]), np.array([0]), np.array([1])


def motion_blur(views: Tensor, rows: Rows) -> Tensor:
    """Blend views with a line blur.

    float32 is exact here, because all sums are integers below 2^24.
    """
    lines = rows.draw(rgb.blur_line, views.shape[3])
    steps = np.array([rgb.tap_step(length) for length, _ in lines])
    taps = [
        rgb.line_taps(length, angle, int(step)) if length >= 1.0 else ONE_TAP
        for (length, angle), step in zip(lines, steps, strict=True)
    ]
    down, right = (max(int(np.abs(line[axis]).max()) for line in taps) for axis in (0, 1))
    kernels = np.zeros((len(taps), 1, 2 * down + 1, 2 * right + 1), np.float32)
    for kernel, (dy, dx, shares) in zip(kernels, taps, strict=True):
        np.add.at(kernel[0], (dy + down, dx + right), shares)
    units = kernels.sum((1, 2, 3)).astype(int)
    blurred = np.rint((0.5 + 0.5 * np.array(rows.severities)) * 65536.0 / units).astype(int)

    planes = _planes(views)
    padded = functional.pad(planes, (right + 1, right + 1, down, down), mode="replicate")
    smooth = padded[..., :-2] + 2.0 * padded[..., 1:-1] + padded[..., 2:]
    smooth = (smooth.add_(2.0) * 0.25).floor_()
    every_second = _per_plane(steps == 2, views)[:, None, None]
    source = torch.where(every_second, smooth, padded[..., 1:-1])
    weights = _per_plane(kernels, views)  # each plane has its own kernel
    total = functional.conv2d(source, weights, groups=len(weights)).int()
    total *= _per_plane(blurred, views).int()[:, None, None]
    rest = _per_plane(65536 - blurred * units, views).int()[:, None, None]
    return _frames((total + planes.int() * rest + 32768) >> 16, views)


def _planes(views: Tensor) -> Tensor:
    """Return one plane per view and colour, float32 [1, B * V * 3, H, W]."""
    return views.permute(0, 1, 4, 2, 3).flatten(0, 2).float().unsqueeze(0)


def _per_plane(values: np.ndarray, views: Tensor) -> Tensor:
    """Copy one value per row [B, ...] to the device, and repeat it for each plane.

    The result is [B * V * 3, ...].
    """
    return on_device(values, views).repeat_interleave(3 * views.shape[1], 0)


def _frames(planes: Tensor, views: Tensor) -> Tensor:
    """Convert integer planes [1, B * V * 3, H, W] to a batch with the shape of ``views``."""
    apart = planes.to(torch.uint8).reshape(*views.shape[:2], 3, *views.shape[2:4])
    return apart.permute(0, 1, 3, 4, 2).contiguous()


def darkness(views: Tensor, rows: Rows) -> Tensor:
    """Return the fraction of light that is lost, float32 [B, 1, H, W]."""
    height, width = views.shape[2:4]
    terms = [masks.ramp_terms(value, height, width) for value in rows.digests("low_light")]
    down = on_device(np.stack([term[0] for term in terms]), views, 1)
    right = on_device(np.stack([term[1] for term in terms]), views).unsqueeze(1)
    ramp = down + right
    ramp = torch.where(on_device([term[2] for term in terms], views, 2), ramp.sqrt(), ramp)
    share = ramp * on_device(rows.scaled(masks.DARK_RAMP), views, 2)
    share += on_device(rows.scaled(masks.DARK_BASE), views, 2)
    return share.unsqueeze(1)


def low_light(views: Tensor, rows: Rows) -> Tensor:
    """Darken with a gradient."""
    return cover(views, per_colour(darkness(views, rows)), on_device([rgb.BLACK], views).float())


def low_light_noise(views: Tensor, rows: Rows) -> Tensor:
    """Darken and add sensor noise. The look-up tables of all severities are concatenated."""
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

    # Integers give the same signal levels as in the numpy suite.
    # A signal level that is wrong by one may change the grey level by more than one.
    light = UNIT - (darkness(views, rows) * UNIT + 0.5).clamp_(max=UNIT - 1.0).int()
    lines = torch.arange(views.shape[2], device=views.device).unsqueeze(1)
    place = shifted(view_words(rows, "row_noise", views, lines), 52)
    shift = look_up(row, place + number * (row.numel() // len(each))) + offsets
    words = pixel_words(rows, "low_light_noise", views)
    out = torch.empty_like(views)
    number = number.int()
    for colour in range(3):
        # unit: a quarter of a grey level
        level = (views[..., colour].int() * light).add_(4096) >> 13
        bits = (words >> (20 * colour)).int()
        place = ((level + number * eld.LEVELS) << eld.PHOTON_BITS) + (bits & 0xFF)
        digital = look_up(photons, place).add_(shift)
        place = ((bits >> eld.PHOTON_BITS) & 0xFFF) + number * (1 << eld.READ_BITS)
        digital += look_up(read, place)
        out[..., colour] = look_up(decode.flatten(), (digital >> 8) + number * span)
    return out


def spatter(views: Tensor, rows: Rows) -> Tensor:
    """Cover a fraction 0.45 * severity of the image with mud or water.

    A random field is highest at the covered pixels.
    """
    height, width = views.shape[2:4]
    digests = rows.digests("spatter")
    smooth, cells = fields(digests, height, width, masks.SPATTER_CORRELATION, views)
    level = levels(cells, rows.scaled(masks.SPATTER_COVER))
    share = ((smooth - level) * float(np.float32(1.0 / masks.SPATTER_EDGE))).clamp(0.0, 1.0)
    share *= on_device(0.5 + rows.scaled(0.5), views, 2)
    colours = [masks.spatter_colour(value) for value in rows.digests("spatter_colour")]
    return cover(views, per_colour(share).unsqueeze(1), on_device(colours, views).float())


def flare(views: Tensor, rows: Rows) -> Tensor:
    """Add the glow of a light to the views that show it."""
    count, height, width = views.shape[1:4]
    batch = len(views)
    scales = np.zeros((batch, count, 1, 3))  # 0 in views that do not show the light
    down = np.zeros((batch, count, height, 1), np.float32)
    right = np.zeros((batch, count, 1, width), np.float32)
    values = zip(rows.digests("flare"), rows.headings, strict=True)
    for row, (value, heading) in enumerate(values):
        centres = masks.flare_centres(value, count, height, width, heading)
        for view, centre in enumerate(centres):
            if centre is not None:
                terms = masks.glow_terms(*centre, height, width)
                down[row, view, :, 0], right[row, view, 0] = terms
                scales[row, view] = rows.severities[row] * np.array(masks.FLARE_TINT)
    table = on_device(masks.glow_table(), views)
    places = ((on_device(down, views) + on_device(right, views)).sqrt() + 0.5).int()
    glow = per_colour(look_up(table, places))
    opacity = (glow * on_device(np.tile(scales, width), views)).clamp_(max=1.0)
    return cover(views, opacity, on_device([rgb.WHITE], views).float())


def blur_kernel(sigma: float, first: int) -> np.ndarray:
    """Return the kernel of ``blur.gaussian`` along one axis, without its first smoothing levels.

    If an image was smoothed at the levels below ``first``, this kernel (float64 [n]) adds the
    remaining blur. Its taps are 2^first pixels apart, and their sum is 1.
    """
    if sigma < rgb.DEFOCUS_LEAST:
        return np.ones(1)
    half, count = rgb.gaussian_weights(sigma)
    weights = half.astype(float)
    weights[0] *= 2.0  # ``gaussian_weights`` returns half the weight of the centre tap
    taps = np.concatenate([weights[:0:-1], weights])
    kernel = np.zeros((taps.size - 1) * 2 ** (count - first) + 1)
    kernel[:: 2 ** (count - first)] = taps / taps.sum()
    for level in range(count - first):
        hat = np.zeros(2 * 2**level + 1)
        hat[:: 2**level] = HAT
        kernel = np.convolve(kernel, hat)
    return kernel


def _correlated(values: Tensor, weights: Tensor, step: int, axis: int) -> Tensor:
    """Correlate along one axis with weights [B or 1, n], whose taps are ``step`` values apart."""
    size = values.shape[axis] - step * (weights.shape[1] - 1)
    taps = weights[..., None, None, None].unbind(1)
    total = values.narrow(axis, 0, size) * taps[0]
    for number, tap in enumerate(taps[1:], start=1):
        total.addcmul_(values.narrow(axis, number * step, size), tap)
    return total


def defocus(views: Tensor, rows: Rows) -> Tensor:
    """Blur with the Gaussian kernel of the numpy filter; rounding may differ."""
    sigmas = rows.draw(rgb.defocus_sigma, *views.shape[2:4])
    first = min(0 if s < rgb.DEFOCUS_LEAST else rgb.gaussian_weights(s)[1] for s in sigmas)
    kernels = [blur_kernel(sigma, first) for sigma in sigmas]
    reach = max(kernel.size for kernel in kernels) // 2
    padded = [np.pad(kernel, reach - kernel.size // 2) for kernel in kernels]
    weights, hat = on_device(np.stack(padded), views), on_device(HAT, views)
    border = (reach + 1) * 2**first - 1
    sides = (0, 0, border, border, border, border)
    values = functional.pad(views.float(), sides, mode="replicate").flatten(3)
    for axis, values_apart in ((2, 1), (3, 3)):
        for level in range(first):
            values = _correlated(values, hat, values_apart * 2**level, axis)
        values = _correlated(values, weights, values_apart * 2**first, axis)
    return grey_levels(values).reshape(views.shape)


def foreign_object(views: Tensor, rows: Rows) -> Tensor:
    """Draw a black disk at the centre."""
    height, width = views.shape[2:4]
    spans = [masks.disk_spans(severity, height, width) for severity in rows.severities]
    first, end = on_device(3 * np.stack(spans), views, 1)[:, None].unbind(3)
    columns = torch.arange(3 * width, device=views.device)
    outside = (columns < first) | (columns >= end)
    return (views.flatten(3) * outside.to(torch.uint8)).reshape(views.shape)


def black_out(views: Tensor, rows: Rows) -> Tensor:
    """Make random views black."""
    values = rows.digests("black_out", frame=True)
    visible = [
        [uniform(scramble(value, view)) >= severity for view in range(views.shape[1])]
        for value, severity in zip(values, rows.severities, strict=True)
    ]
    return views * on_device(visible, views, 3).to(torch.uint8)


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
    noise = 255 * ((words >> torch.arange(3, device=views.device)) & 1)
    return torch.where(shifted(words, 32) < limits, noise.to(torch.uint8), views)


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
