"""Corruptions of author C, who took the view of a sensor engineer.

``episode=`` and ``frame=`` say which random values stay constant in an episode and which ones are
sampled for each frame.
"""

from __future__ import annotations

from functools import partial

import cv2
import numpy as np

from .corruption import Z_MAX, Z_MIN, corruption, enlarged_noise, to_depth, to_uint8

rgb = partial(corruption, "c", "rgb")
depth = partial(corruption, "c", "depth")

AMPLIFIER_GLOW = (1.0, 0.45, 0.95)
SENSOR_NOISE = (0.9, 0.7, 1.3)  # by colour channel
TORCH_RADIUS = 0.42  # of the hot spot, as a fraction of a view
PROFILE_END = 9  # squared distance from the spot at which the table of its brightness ends
DROPS = 11  # per view


def _field(rng, views, cells):
    """Return a smooth random field with a standard deviation of about 1, float32 [V, H, W]."""
    return enlarged_noise(rng, views, cells) * 1.25


def _blocks(grid, height, width):
    """Enlarge a grid [V, rows, columns] to [V, H, W] without interpolation."""
    rows = np.arange(height) * grid.shape[1] // height
    columns = np.arange(width) * grid.shape[2] // width
    return grid[:, rows][:, :, columns]


@rgb("share of wrong rows, saturation", episode="error of the row length, share of luma rows")
def nv12_stride(views, severity, episode, frame):
    """The driver reads the colour plane of an NV12 image with a wrong row length and start.

    From some row on, colours shear away from the brightness. The last rows show luma bytes.
    """
    count, height, width, _ = views.shape
    image = np.ascontiguousarray(views).reshape(count * height, width, 3)
    image = cv2.cvtColor(image, cv2.COLOR_RGB2YCrCb).reshape(views.shape)
    chroma = image[:, ::2, ::2, 1:]
    rows, columns = chroma.shape[1:3]
    step = int(episode.integers(2, 6)) * (1 if episode.random() < 0.5 else -1)
    luma_share = 0.35 + 0.25 * episode.random()
    first = min(int(rows * (1.0 - severity) ** 1.5), rows - 1)
    wrong = np.arange(first, rows)
    start = wrong * columns + step * (wrong - first + columns // 6)
    source = (start[:, None] + np.arange(columns)[None, :]) % (rows * columns)
    read = chroma.copy()
    # the two colour differences are exchanged too
    read[:, first:] = chroma.reshape(count, rows * columns, 2)[:, source][..., ::-1]
    luma_rows = int(round((rows - first) * luma_share))
    if luma_rows:
        luma = image[:, :luma_rows, :, 0]
        read[:, rows - luma_rows :, :, 0] = luma[:, :, ::2]
        read[:, rows - luma_rows :, : width // 2, 1] = luma[:, :, 1::2]
    saturation = 1.0 + 0.6 * severity
    read = to_uint8((read.astype(np.float32) - 128.0) * saturation + 128.0)
    read = np.repeat(np.repeat(read, 2, 1), 2, 2)[:, :height, :width]
    out = np.concatenate([image[..., :1], read], -1).reshape(count * height, width, 3)
    return cv2.cvtColor(out, cv2.COLOR_YCrCb2RGB).reshape(views.shape)


@rgb("share of broken rows, and size of the errors", episode="quality of the link", frame="errors")
def mjpeg_slice_drift(views, severity, episode, frame):
    """A JPEG stream loses bits: a row of blocks slips, and its colour drifts until the row ends."""
    count, height, width, _ = views.shape
    block = 8 if height < 128 else 16
    rows = -(-height // block)
    columns = -(-width // block)
    weakness = 0.75 + 0.25 * episode.random()
    broken = frame.random((count, rows)) < 0.9 * severity * weakness
    start = (frame.random((count, rows)) * columns * (1.0 - 0.6 * severity)).astype(int)
    lost = np.round((1 + frame.random((count, rows)) * 5) * severity).astype(int)
    walk = frame.standard_normal((count, rows, columns, 3)).astype(np.float32)
    walk *= np.float32([1.0, 0.8, 0.8])
    wrong = broken[:, :, None] & (np.arange(columns)[None, None] >= start[:, :, None])
    drift = np.cumsum(walk * wrong[..., None], 2) * (30.0 * severity)
    luma, red, blue = np.moveaxis(drift, -1, 0)
    green = luma - 0.71 * red - 0.34 * blue
    colour = np.stack([luma + 1.4 * red, green, luma + 1.77 * blue], -1)
    colour = np.clip(colour, -200, 200).astype(np.int16)
    out = views.copy()
    x = np.arange(width)
    for view, row in zip(*np.nonzero(broken), strict=True):
        lines = slice(row * block, (row + 1) * block)
        slip = lost[view, row] * block * (x >= start[view, row] * block)
        moved = views[view, lines][:, (x + slip) % width]
        out[view, lines] = np.clip(moved + colour[view, row][x // block], 0, 255)
    return out


@rgb("gain and black level", episode="gain and black level, by colour", frame="exposure")
def gain_wrap(views, severity, episode, frame):
    """The image processor does not saturate: highlights become dark, and shadows become bright."""
    gain = 1.0 + severity * episode.uniform(0.55, 1.1, 3)
    black = severity * episode.uniform(25, 45, 3)
    gain = gain * (1.0 + 0.05 * severity * frame.standard_normal())
    levels = np.floor(np.arange(256)[:, None] * gain - black).astype(int) & 255
    table = levels.astype(np.uint8)
    return np.stack([table[:, c][views[..., c]] for c in range(3)], -1)


@rgb(
    "differences between columns, row noise, glow",
    episode="offsets and gains of the columns, corner of the glow",
    frame="row noise",
)
def column_adc_glow(views, severity, episode, frame):
    """The column converters of a hot sensor differ, rows are noisy, and an amplifier glows."""
    count, height, width, _ = views.shape
    lanes = int(episode.choice([4, 6, 8]))
    lane_offset = episode.uniform(-1, 1, (count, lanes))
    lane_gain = episode.uniform(-1, 1, (count, lanes))
    banks = episode.uniform(-1, 1, (count, 7))
    corner = episode.integers(0, 2, (count, 2))
    rows = frame.standard_normal((count, height))
    x = np.arange(width)
    offset = 55 * lane_offset[:, x % lanes] + 45 * banks[:, x * 7 // width]
    gain = 1.0 + 0.5 * severity * lane_gain[:, x % lanes]
    dy = np.abs(corner[:, :1] - np.linspace(0, 1, height)[None])
    dx = np.abs(corner[:, 1:] - np.linspace(0, 1, width)[None])
    glow = 230 * np.exp(-np.hypot(dy[:, :, None], dx[:, None, :]) / 0.38)
    glow = (severity * glow).astype(np.float32)
    added = (severity * (offset[:, None, :] + 22 * rows[:, :, None])).astype(np.float32)
    out = views.astype(np.float32) * gain[:, None, :, None].astype(np.float32)
    out += added[..., None]
    for channel, tint in enumerate(AMPLIFIER_GLOW):
        out[..., channel] += glow * np.float32(tint)
    return to_uint8(out)


@rgb(
    "contrast of the bands",
    episode="number of bands, on-time, shift of the colours",
    frame="position of the bands, by view",
)
def led_pwm_bands(views, severity, episode, frame):
    """Dimmed colour LEDs pulse while the rows are read: coloured bands."""
    count, height = views.shape[:2]
    bands = episode.uniform(2.5, 6.0)
    duty = episode.uniform(0.30, 0.50)
    green = episode.uniform(0.12, 0.35)
    blue = -episode.uniform(0.12, 0.35)
    phase = frame.random(count)
    time = (np.arange(height) / height * bands)[None, :, None] + phase[:, None, None]
    time = time + np.array([0.0, green, blue])
    distance = np.abs((time % 1.0) - 0.5) * 2.0  # 0 in the middle of the on-time
    light = np.clip((duty - distance) / 0.12 + 0.5, 0, 1)
    gain = 1.0 - severity * 0.97 * (1.0 - light) + 0.35 * severity * light
    return to_uint8(views.astype(np.float32) * gain[:, :, None, :].astype(np.float32))


@rgb("darkness of the room", episode="direction and colour of the torch", frame="shake, noise")
def torch_only(views, severity, episode, frame):
    """The lights are out, and a warm torch shines: a ringed spot, and noise in the dark."""
    count, height, width, _ = views.shape
    # in views from the left; a pair or a single camera is lit near the middle
    torch = episode.random() * count if count > 2 else count / 2 + episode.uniform(-0.2, 0.2)
    green = 1.0 - 0.25 * severity * episode.random()
    warm = np.float32([1.0, green, 1.0 - 0.55 * severity])
    shake_x, shake_y = frame.normal(0, 0.05, 2)
    ambient = 0.03 + 0.97 * (1.0 - severity) ** 1.5
    x = (np.arange(count)[:, None] + (np.arange(width)[None] + 0.5) / width).astype(np.float32)
    dx = np.abs(x - np.float32(torch + shake_x))
    if count > 2:
        dx = np.minimum(dx, count - dx)
    dy = ((np.arange(height) + 0.5) / height - 0.58 - shake_y).astype(np.float32)
    radius = np.float32(TORCH_RADIUS)
    square = (dx / radius)[:, None, :] ** 2 + (dy / radius)[None, :, None] ** 2
    spill = np.exp(-((dx / np.float32(max(1.0, count / 4)))[:, None, :] ** 2))
    profile = np.linspace(0, PROFILE_END, 256, dtype=np.float32)
    beam = severity * 1.6 * np.exp(-profile * profile * 0.6)
    beam = beam * (1 + 0.25 * np.cos(9 * np.sqrt(profile)))
    place = np.minimum(square * np.float32(255 / PROFILE_END), 255).astype(np.uint8)
    gain = beam.astype(np.float32)[place]
    gain += np.float32(0.10 * severity) * spill
    gain += np.float32(ambient)
    noise = frame.standard_normal((count, height, width), dtype=np.float32)
    noise = noise * np.float32(11 * severity)
    out = np.empty_like(views)
    for channel, strength in enumerate(SENSOR_NOISE):
        image = views[..., channel] * (gain * warm[channel]) + noise * np.float32(strength)
        out[..., channel] = np.clip(image, 0, 255)
    return out


@rgb("number and size of the drops", episode="the drops", frame="small vertical motion")
def droplets(views, severity, episode, frame):
    """Drops of water on the lens show the whole view upside down, with a dark and bright rim."""
    count, height, width, _ = views.shape
    shape = (count, DROPS)
    centre_x = episode.random(shape) * width
    centre_y = episode.random(shape) * height
    radius = episode.uniform(0.10, 0.22, shape) * width
    tall = episode.uniform(0.8, 1.5, shape)
    centre_y = centre_y + frame.normal(0, 0.004 * height, shape)
    radius = radius * (0.6 + 0.5 * severity)
    visible = int(np.ceil(DROPS * severity))
    out = np.empty_like(views)
    for i, view in enumerate(views):
        x = np.arange(width, dtype=np.float32)
        map_x, map_y = np.meshgrid(x, np.arange(height, dtype=np.float32))
        shade = np.zeros((height, width), np.float32)
        alpha = np.zeros((height, width), np.float32)
        for j in range(visible):
            half_width = radius[i, j]
            half_height = half_width * tall[i, j]
            x0 = max(0, int(centre_x[i, j] - half_width))
            x1 = min(width, int(centre_x[i, j] + half_width) + 1)
            y0 = max(0, int(centre_y[i, j] - half_height))
            y1 = min(height, int(centre_y[i, j] + half_height) + 1)
            if x1 <= x0 or y1 <= y0:
                continue
            box = (slice(y0, y1), slice(x0, x1))
            dx = ((np.arange(x0, x1) - centre_x[i, j]) / half_width).astype(np.float32)[None, :]
            dy = ((np.arange(y0, y1) - centre_y[i, j]) / half_height).astype(np.float32)[:, None]
            square = dx * dx + dy * dy
            inside = square < 1
            map_x[box] = np.where(inside, width * (0.5 - 0.5 * dx), map_x[box])
            map_y[box] = np.where(inside, height * (0.5 - 0.5 * dy), map_y[box])
            alpha[box] = np.maximum(alpha[box], np.clip((1 - square) * 5, 0, 1))
            rim = -90 * square * square + 110 * np.maximum(0, -dy - 0.35)
            shade[box] = np.where(inside, rim, shade[box])
        border = cv2.BORDER_REFLECT
        bent = cv2.blur(view, (3, 3))
        bent = cv2.remap(bent, map_x, map_y, cv2.INTER_LINEAR, borderMode=border)
        bent = bent.astype(np.float32) + shade[..., None]
        clean = view.astype(np.float32)
        out[i] = to_uint8(clean + alpha[..., None] * (bent - clean))
    return out


@rgb(
    "opacity of the reflection and of the veil",
    episode="reflected view, shift and colour of the reflection",
    frame="brightness of the reflection",
)
def dome_ghost(views, severity, episode, frame):
    """The protective dome reflects another view upside down, and its glare veils the image."""
    count, height, width, _ = views.shape
    opposite = int(episode.integers(0, max(1, count // 2))) + count // 2
    shift_x, shift_y = episode.uniform(-0.15, 0.15, 2)
    tint = np.float32(episode.uniform(0.7, 1.1, 3))
    flicker = 1.0 + 0.05 * frame.standard_normal()
    turned = np.float32([[-0.8, 0, width * (0.9 + shift_x)], [0, -0.8, height * (0.9 + shift_y)]])
    size = (width, height)
    blur = max(3, (width // 24) | 1)
    out = np.empty_like(views)
    for i, view in enumerate(views):
        ghost = cv2.blur(views[(i + opposite) % count], (blur, blur))
        ghost = cv2.warpAffine(ghost, turned, size, borderMode=cv2.BORDER_REFLECT)
        ghost = ghost.astype(np.float32) * tint
        veil = cv2.resize(view, (6, 6), interpolation=cv2.INTER_AREA).astype(np.float32)
        veil = 255.0 * (veil / 255.0) ** 0.6
        veil = cv2.resize(veil, size, interpolation=cv2.INTER_LINEAR)
        clean = (1 - 0.68 * severity) * view.astype(np.float32)
        out[i] = to_uint8(clean + severity * (0.55 * flicker * ghost + 0.32 * veil))
    return out


@depth("decrease of the ambiguity range, noise", episode="ambiguity range", frame="noise")
def tof_phase_wrap(views, severity, episode, frame):
    """The modulation of a time-of-flight camera is too fast: far surfaces appear near."""
    ambiguity = 10.0 * 0.15**severity
    ambiguity = ambiguity * (1.0 + 0.06 * episode.uniform(-1, 1) * severity)
    noise = frame.standard_normal(views.shape, dtype=np.float32)
    z = views + noise * views * np.float32(0.025 * severity)
    z = np.mod(z, np.float32(ambiguity))
    return to_depth(z, (views <= 0) | (z < Z_MIN))


@depth("weakness of the echo, flying pixels", episode="reflectivity of the surfaces", frame="noise")
def grazing_dropout(views, severity, episode, frame):
    """The echo is weak in bright light: far, slanted and dark surfaces are missing.

    At edges, flying pixels lie between near and far.
    """
    width = views.shape[2]
    reflectivity = _field(episode, views, 6)
    noise = frame.standard_normal(views.shape, dtype=np.float32)
    slope_y = np.zeros_like(views)
    slope_x = np.zeros_like(views)
    slope_y[:, 1:-1] = (views[:, 2:] - views[:, :-2]) * 0.5
    slope_x[:, :, 1:-1] = (views[:, :, 2:] - views[:, :, :-2]) * 0.5
    square = np.maximum(views, Z_MIN) ** 2
    tangent = (slope_x * slope_x + slope_y * slope_y) * np.float32(width * width / 4) / square
    # logarithm of squared depth over the cosine of the angle of incidence
    loss = np.float32(0.5) * np.log(square * square * (1 + tangent))
    loss += np.float32(0.55) * reflectivity + np.float32(0.3) * noise
    lost = loss > 5.2 - 4.6 * severity
    flying = (tangent > 16) & ~lost
    size = 3 if width < 128 else 5
    mixed = np.stack([cv2.blur(view, (size, size)) for view in np.ascontiguousarray(views)])
    out = np.where(flying, (1 - severity) * views + severity * mixed, views)
    return to_depth(out, (views <= 0) | lost)


@depth(
    "area and size of the errors, size of the depth steps",
    episode="size of the depth steps, area of the errors",
    frame="the errors, their area",
)
def projector_crosstalk(views, severity, episode, frame):
    """The dots of another robot's projector confuse a stereo camera: false blocks and holes."""
    count, height, width = views.shape
    step = (0.03 + 0.01 * episode.random()) * severity  # 1/m
    area = 0.5 * _field(episode, views, 4) + 0.9 * _field(frame, views, 9)
    jump = frame.uniform(-0.5, 1.3, (count, 16, 16)).astype(np.float32)
    hole = frame.random((count, 24, 24)).astype(np.float32)
    wrong = area > 1.5 - 1.7 * severity
    disparity = 1.0 / np.maximum(views, Z_MIN)
    disparity = np.maximum(np.round(disparity / step), 0) * step
    disparity = np.where(wrong, disparity + _blocks(jump, height, width) * severity, disparity)
    missing = (views <= 0) | (wrong & (_blocks(hole, height, width) < 0.4))
    return to_depth(1.0 / np.maximum(disparity, 1 / Z_MAX), missing)


@depth("share of wrong pixels", episode="rows per packet", frame="the packets, and from where")
def byte_slip(views, severity, episode, frame):
    """A packet of the 16-bit depth stream loses a byte: high and low bytes change roles."""
    count, height, width = views.shape
    rows = max(1, int(round(height / 32 * episode.uniform(0.7, 1.4))))
    packets = -(-height // rows)
    broken = frame.random((count, packets)) < 0.85 * severity
    start = frame.random((count, packets)) * width * (1.0 - 0.7 * severity)
    packet = np.arange(height) // rows
    wrong = broken[:, packet, None] & (np.arange(width) >= start[:, packet, None])
    millimetres = np.round(views * 1000).astype(np.uint16)
    following = np.roll(millimetres, -1, 2)
    read = ((millimetres >> 8) | ((following & 255) << 8)) & 0x3FFF
    out = np.where(wrong, read.astype(np.float32) / 1000, views)
    return to_depth(out, out <= 0)


@depth("error of the disparity", episode="offset, tilt and bow, by view", frame="small change")
def thermal_bow(views, severity, episode, frame):
    """Heat bends the modules of a stereo camera: the disparity has an offset, a tilt and a bow."""
    count, height, width = views.shape
    sign = 1.0 if episode.random() < 0.6 else -1.0
    offset = sign * episode.uniform(0.20, 0.38, count)  # 1/m
    bow = episode.uniform(-0.30, 0.30, count)[:, None, None]
    tilt = episode.uniform(-0.25, 0.25, (count, 2))[..., None, None]
    offset = (offset * (1 + 0.03 * frame.standard_normal(count)))[:, None, None]
    y = np.linspace(-1, 1, height)[:, None]
    x = np.linspace(-1, 1, width)[None]
    error = offset + bow * (x * x + y * y - 0.6) + tilt[:, 0] * x + tilt[:, 1] * y
    disparity = 1.0 / np.maximum(views, Z_MIN) + (severity * error).astype(np.float32)
    return to_depth(1.0 / np.maximum(disparity, 1 / Z_MAX), views <= 0)


@depth("area and strength of the smears", episode="the smears, their distance", frame="noise")
def cover_smudge(views, severity, episode, frame):
    """Grease on the cover glass scatters the light: a false surface at about 0.2 metres."""
    smears = _field(episode, views, 5)
    near = 0.22 + 0.06 * _field(episode, views, 4)
    noise = frame.standard_normal(views.shape, dtype=np.float32)
    share = np.clip((smears + 0.12 * noise - (1.5 - 2.1 * severity)) / 0.7, 0, 1)  # of the echo
    share = np.where(views <= 0, (share > 0.5) * 1.0, share).astype(np.float32)
    z = views * (1 - share) + np.maximum(near + 0.01 * noise, Z_MIN) * share
    return to_depth(z, (views <= 0) & (share == 0))
