"""Corruptions of author B, who took the view of a vision researcher.

The panorama [H, V * W] is the views side by side. ``episode=`` and ``frame=`` say which random
values stay constant in an episode and which ones are sampled for each frame.
"""

from __future__ import annotations

from functools import partial

import cv2
import numpy as np

from .corruption import Z_MAX, Z_MIN, corruption, to_depth

rgb = partial(corruption, "b", "rgb")
depth = partial(corruption, "b", "depth")

CELLS = 64  # rows and columns of the checkerboard, which repeats itself
BLOCK_NOISE = (26.0, 22.0, 22.0)  # drift of the mean in luma and two chroma directions
CHROMA_TO_RGB = ((1, 1, 1), (1.4, -0.7, 0), (0, -0.35, 1.8))
SUNLIGHT = (1.0, 0.93, 0.78)


def _panorama(views):
    """Return views [V, H, W, ...] side by side, [H, V * W, ...]."""
    count, height, width = views.shape[:3]
    rows = np.ascontiguousarray(views.swapaxes(0, 1))
    return rows.reshape(height, count * width, *views.shape[3:])


def _views(panorama, shape):
    """Divide a panorama [H, V * W, ...] into views [V, H, W, ...]."""
    count, height, width = shape[:3]
    rows = panorama.reshape(height, count, width, *panorama.shape[2:])
    return np.ascontiguousarray(rows.swapaxes(0, 1))


def _coordinates(shape):
    """Return the pixel coordinates x and y in the panorama, float32 [H, V * W]."""
    count, height, width = shape[:3]
    x = np.arange(count * width, dtype=np.float32)
    return np.meshgrid(x, np.arange(height, dtype=np.float32))


def _field(rng, shape, cell):
    """Return a smooth random field over the panorama, float32 [H, V * W].

    Its mean is about 0, its standard deviation about 1, and its blobs have ``cell`` pixels.
    """
    height = shape[1]
    width = shape[0] * shape[2]
    rows = max(2, int(round(height / cell)) + 2)
    columns = max(2, int(round(width / cell)) + 2)
    grid = rng.standard_normal((rows, columns, 1)).astype(np.float32)
    grid -= grid.mean((0, 1))
    grid /= grid.std((0, 1)) + 1e-6
    return cv2.resize(grid, (width, height), interpolation=cv2.INTER_CUBIC) * np.float32(1.25)


def _fractal(rng, shape, octaves, decay, channels=1):
    """Return a sum of random fields over the panorama, whose blobs become smaller by half.

    The largest blobs have half the height of a view; ``decay`` is the ratio of the amplitudes of
    successive fields.
    """
    height = shape[1]
    width = shape[0] * shape[2]
    total = None
    amplitude = 1.0
    power = 0.0
    for octave in range(octaves):
        cell = max(height / (2.0 * 2**octave), 1.5)
        rows = max(3, int(round(height / cell)) + 2)
        columns = max(3, int(round(width / cell)) + 2)
        grid = rng.standard_normal((rows, columns, channels), dtype=np.float32)
        grid = (grid - grid.mean((0, 1))) / (grid.std((0, 1)) + np.float32(1e-6))
        grid = grid * np.float32(amplitude)
        if total is not None:
            finer = cv2.resize(total, (columns, rows), interpolation=cv2.INTER_CUBIC)
            grid = finer.reshape(grid.shape) + grid
        total = grid
        power += amplitude * amplitude
        amplitude *= decay
    interpolation = cv2.INTER_LINEAR if cell < 4 else cv2.INTER_CUBIC
    total = total * np.float32(1.25 / np.sqrt(power))
    return cv2.resize(total, (width, height), interpolation=interpolation)


def _warp(panorama, map_x, map_y, shape):
    """Resample the panorama; no view reads pixels of its neighbour."""
    count, _, width = shape[:3]
    left = np.repeat(np.arange(count, dtype=np.float32) * width, width)[None]
    map_x = np.minimum(np.maximum(map_x, left), left + np.float32(width - 1))
    border = cv2.BORDER_REFLECT_101
    return cv2.remap(panorama, map_x, map_y, cv2.INTER_LINEAR, borderMode=border)


def _truncated(values):
    """Convert grey levels to uint8 without rounding; ``values`` are clipped in place."""
    return np.clip(values, 0, 255, out=values).astype(np.uint8)


@rgb(
    "displacement, and brightness of the lines",
    episode="two wave fields, colour",
    frame="phase of the waves",
)
def caustic_refraction(views, severity, episode, frame):
    """Waves of water bend the light: a net of bright lines over a distorted, dimmed image."""
    height = views.shape[1]
    first = _field(episode, views.shape, height / 5.0)
    second = _field(episode, views.shape, height / 5.0)
    phase = episode.uniform(0, 2 * np.pi) + frame.normal(0, 0.5)
    cosine = np.float32(np.cos(phase))
    sine = np.float32(np.sin(phase))
    wave_x = first * cosine + second * sine
    wave_y = second * cosine - first * sine
    x, y = _coordinates(views.shape)
    reach = np.float32(0.035 * severity * height)
    image = _warp(_panorama(views), x + reach * wave_x, y + reach * wave_y, views.shape)
    net = np.maximum(1 - np.abs(wave_x) * np.float32(2.6), 0)
    net = net + np.maximum(1 - np.abs(wave_y) * np.float32(2.6), 0)
    net = np.minimum(net * net * np.float32(225 * severity), 255).astype(np.uint8)
    tint = np.array([0.85, 1.0, 0.95]) + episode.uniform(-0.1, 0.1, 3)
    light = np.minimum(np.arange(256)[:, None] * tint, 255).astype(np.uint8)[net]
    return _views(cv2.addWeighted(image, 1 - 0.6 * severity, light, 1.0, 0), views.shape)


@rgb("amplitude of the waves", episode="centres, period, colours", frame="phase")
def cocentric_sine_waves(views, severity, episode, frame):
    """Interference adds coloured rings around one point per view."""
    count, height, width, _ = views.shape
    centre = episode.uniform(-0.2, 1.2, (count, 2, 1, 1))
    period = episode.uniform(0.09, 0.15) * height
    colours = episode.uniform(0, 2 * np.pi, 3)
    phase = frame.uniform(0, 2 * np.pi)
    x = np.arange(width, dtype=np.float32)[None, None]
    y = np.arange(height, dtype=np.float32)[None, :, None]
    dx = x - (centre[:, 0] * width).astype(np.float32)
    dy = y - (centre[:, 1] * height).astype(np.float32)
    radius = np.sqrt(dx**2 + dy**2) * np.float32(2 * np.pi / period)
    sine = np.sin(radius)
    cosine = np.cos(radius)
    out = views.astype(np.float32)
    amplitude = 140 * severity
    for channel in range(3):
        shift = colours[channel] * 0.5 + phase
        sine_part = sine * np.float32(amplitude * np.cos(shift))
        out[..., channel] += sine_part + cosine * np.float32(amplitude * np.sin(shift))
    return _truncated(out)


@rgb("amplitude", episode="roughness, saturation", frame="the clouds")
def plasma_noise(views, severity, episode, frame):
    """Interference adds coloured fractal clouds, which change with each frame."""
    decay = episode.uniform(0.6, 0.8)
    common = episode.uniform(0.3, 0.6)
    clouds = _fractal(frame, views.shape, 5, decay, channels=3)
    clouds += clouds.mean(-1, keepdims=True) * np.float32(common)
    image = _panorama(views).astype(np.float32)
    image += clouds * np.float32(95 * severity)
    return _views(_truncated(image), views.shape)


@rgb(
    "share of replaced cells",
    episode="angle, cell size, offset, order and colours of the cells",
    frame="small shift",
)
def checkerboard_cutout(views, severity, episode, frame):
    """Flat colours replace cells of a tilted checkerboard; every second cell comes first."""
    angle = episode.uniform(0, np.pi / 2)
    cell = views.shape[1] / episode.uniform(7, 11)
    offset = episode.uniform(0, 64, 2) + frame.uniform(0, 0.5, 2)
    threshold = episode.random((CELLS, CELLS))
    second = np.add.outer(np.arange(CELLS), np.arange(CELLS)) % 2
    threshold = np.where(second, threshold / 1.4, 1.0 / 2.2 + threshold * 1.2)
    colours = episode.uniform(20, 235, (CELLS, CELLS, 1))
    colours = colours + episode.uniform(-25, 25, (CELLS, CELLS, 3))
    colours = np.clip(colours, 0, 255).astype(np.uint8).reshape(-1, 3)
    x, y = _coordinates(views.shape)
    cosine = np.float32(np.cos(angle) / cell)
    sine = np.float32(np.sin(angle) / cell)
    i = np.floor(x * cosine + y * sine + np.float32(offset[0])).astype(np.int32) % CELLS
    j = np.floor(y * cosine - x * sine + np.float32(offset[1] + 4096)).astype(np.int32) % CELLS
    place = i * CELLS + j
    replaced = (threshold.ravel() < severity)[place]
    image = _panorama(views).copy()
    image[replaced] = colours[place[replaced]]
    return _views(image, views.shape)


@rgb("strength of the ribs", episode="angle, width and shape of the ribs", frame="small shift")
def fluted_glass(views, severity, episode, frame):
    """The camera looks through ribbed glass, whose ribs squeeze and flip the image."""
    height = views.shape[1]
    angle = episode.uniform(-0.6, 0.6) + (np.pi / 2 if episode.random() < 0.3 else 0.0)
    period = height / episode.uniform(7, 10)
    offset = episode.uniform(0, 1) + frame.normal(0, 0.05)
    uneven = _field(episode, views.shape, height / 4.0)
    x, y = _coordinates(views.shape)
    cosine = np.float32(np.cos(angle))
    sine = np.float32(np.sin(angle))
    ribs = (x * cosine + y * sine) / np.float32(period)
    ribs = ribs + uneven * np.float32(0.15) + np.float32(offset)
    place = ribs - np.floor(ribs) - np.float32(0.5)  # from -0.5 to 0.5 within a rib
    across = place * np.float32(-4.2 * severity * period)
    along = uneven * np.float32(0.02 * severity * height)
    map_x = x + across * cosine - along * sine
    map_y = y + across * sine + along * cosine
    image = _warp(_panorama(views), map_x, map_y, views.shape)
    shade = 1 - np.float32(0.9 * severity) * (np.float32(4) * place * place) ** 2  # dark seams
    return _views(_truncated(image.astype(np.float32) * shade[..., None]), views.shape)


@rgb("share and size of the errors", episode="size of the blocks", frame="the errors")
def stream_bit_error(views, severity, episode, frame):
    """A bit error breaks a slice of the video from some block on.

    Blocks are displaced, lose their detail, and their colours drift.
    """
    count, height, width, _ = views.shape
    block = max(4, int(round(height / episode.integers(10, 15))))
    rows = -(-height // block)
    columns = -(-width // block)
    shape = (count, rows, columns)
    broken = frame.random((count, rows)) < 0.95 * severity
    start = (frame.random((count, rows)) * (1.05 - 0.6 * severity) * columns).astype(int)
    wrong = broken[..., None] & (np.arange(columns) >= start[..., None])
    shift = frame.integers(-columns, columns, shape) * block
    same = frame.random(shape) < 0.75  # most blocks repeat the motion vector of their left one
    source = np.maximum.accumulate(np.where(same, 0, np.arange(columns)), -1)
    shift = np.take_along_axis(shift, source, -1) * wrong
    drift = np.cumsum(frame.normal(0, 1, (*shape, 3)), 2) * np.array(BLOCK_NOISE)
    drift = drift + frame.normal(0, 35, (count, rows, 1, 3))
    drift = drift * (wrong[..., None] * (0.4 + 0.6 * severity))
    colour = np.round(drift @ np.array(CHROMA_TO_RGB)).clip(-2000, 2000).astype(np.int16)
    flat = wrong & (frame.random(shape) < 0.45 * severity)

    view = np.arange(count)[:, None, None]
    y = np.arange(height)[:, None]
    x = np.arange(width)
    place = (view * rows + y // block) * columns + x // block  # block of each pixel
    source = (x + shift.ravel()[place] + 4 * width) % width + (view * height + y) * width
    size = (count * columns, rows)
    means = cv2.resize(_panorama(views), size, interpolation=cv2.INTER_AREA)
    means = means.reshape(rows, count, columns, 3).swapaxes(0, 1)
    # pixels of flat blocks read the means, which follow all pixels in the palette
    palette = np.concatenate([views.reshape(-1, 3), means.reshape(-1, 3)])
    source = np.where(flat.ravel()[place], place + count * height * width, source)
    out = palette[source].astype(np.int16)
    out += colour.reshape(-1, 3)[place]
    return _truncated(out)


@rgb(
    "opacity of the film",
    episode="thickness, number and phase of the fringes",
    frame="small change of the phase",
)
def iridescent_film(views, severity, episode, frame):
    """Interference in a thin film: brightness and thickness become false colours."""
    thickness = _fractal(episode, views.shape, 2, 0.5)
    gain = episode.uniform(1.3, 1.9)
    offset = episode.uniform(0, 256) + frame.normal(0, 10)
    phases = np.array([0.0, 0.3, 0.62]) + episode.uniform(0, 0.2, 3)
    fringes = np.array([1, 1, 2] if episode.random() < 0.5 else [2, 1, 1])  # per colour channel
    levels = fringes * np.arange(256)[:, None] / 256.0 + phases
    table = (127.5 - 127.5 * np.cos(2 * np.pi * levels)).astype(np.uint8)
    image = _panorama(views)
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY).astype(np.float32)
    phase = grey * np.float32(gain) + thickness * np.float32(75) + np.float32(offset + 2560)
    film = table[phase.astype(np.int32) & 255]
    share = min(1.0, 1.1 * severity)
    return _views(cv2.addWeighted(image, 1 - share, film, share, 0), views.shape)


@rgb(
    "darkness of the shadows, brightness of the sun",
    episode="the leaves, colour of the sun",
    frame="small motion of the leaves",
)
def gobo_shadow(views, severity, episode, frame):
    """The sun shines through leaves: hard shadows beside burnt-out patches."""
    leaves = _fractal(episode, views.shape, 4, 0.7)
    leaves = leaves + np.float32(0.25) * _field(frame, views.shape, views.shape[1] / 4.0)
    light = np.clip((leaves - np.float32(0.1)) * np.float32(9), 0, 1)
    warm = (np.array(SUNLIGHT) + episode.uniform(-0.05, 0.05, 3)).astype(np.float32)
    dark = np.float32(0.06 ** (severity**1.3))
    bright = np.float32(1 + 0.6 * severity)
    image = _panorama(views).astype(np.float32)
    image *= (dark + (bright - dark) * light)[..., None]
    image += light[..., None] * (warm * np.float32(45 * severity))
    return _views(_truncated(image), views.shape)


@depth("size of the islands", episode="ambiguity distance, islands", frame="edges of the islands")
def phase_unwrap_islands(views, severity, episode, frame):
    """A time-of-flight camera unwraps the phase wrongly.

    In islands, the depth is wrong by multiples of the ambiguity distance.
    """
    ambiguity = episode.uniform(2.2, 3.0)
    islands = _fractal(episode, views.shape, 4, 0.6)
    islands = islands + np.float32(0.5) * _field(frame, views.shape, views.shape[1] / 6.0)
    z = _panorama(views)
    wrong = islands > np.float32(1.5 - 2.2 * severity)
    jumped = np.where(z > 2 * ambiguity, z - np.float32(2 * ambiguity), z - np.float32(ambiguity))
    jumped = np.where(z > ambiguity, jumped, z + np.float32(ambiguity))
    return _views(to_depth(np.where(wrong, jumped, z), z <= 0), views.shape)


@depth("size of the mirrors", episode="two mirrors per view", frame="wavy edges")
def mirror_room(views, severity, episode, frame):
    """Mirrors hang on the walls, and the camera measures the reflected room behind them."""
    count, height, width = views.shape
    mirrors = 2
    shape = (mirrors, count, 1, 1)
    x = np.arange(width, dtype=np.float32)[None, None]
    y = np.arange(height, dtype=np.float32)[None, :, None]
    centre_x = episode.uniform(0.1, 0.9, shape) * width
    centre_y = episode.uniform(0.3, 0.7, shape) * height
    half_width = episode.uniform(0.22, 0.36, shape) * width * severity
    half_height = episode.uniform(0.4, 0.6, shape) * height * severity
    skew = episode.uniform(-0.25, 0.25, shape)
    wave = cv2.blur(frame.normal(0, 0.02 * height, (height, mirrors * count)), (1, 5)).T
    wave = wave.reshape(mirrors, count, height, 1)
    dx = x - centre_x
    inside = np.abs(dx + wave) < half_width
    inside = inside & (np.abs(y - centre_y + skew * dx + wave) < half_height)
    behind = views + np.float32(0.9) * views[:, :, ::-1] + np.float32(0.4)
    return to_depth(np.where(inside.any(0), behind, views), views <= 0)


@depth(
    "baseline, and width of the growth",
    episode="side of the second camera, baseline",
    frame="ragged edges",
)
def stereo_fattening_shadow(views, severity, episode, frame):
    """A stereo matcher lets near objects grow, and has no depth beside them.

    The second camera does not see the area on one side of a near object.
    """
    _, height, width = views.shape
    side = 1 if episode.random() < 0.5 else -1
    baseline = episode.uniform(0.28, 0.40) * severity * width  # shift in pixels at 1 metre
    valid = views > 0
    z = np.where(valid, views, np.float32(Z_MAX))
    disparity = (np.float32(1) / np.maximum(z, np.float32(0.35)))[:, :, ::side]
    hidden = np.zeros(z.shape, bool)
    step = 1 if width < 128 else 2
    for k in range(1, max(2, int(0.22 * severity * width) + 1), step):
        nearer = disparity[:, :, k:] - disparity[:, :, :-k]
        hidden[:, :, :-k] |= nearer > np.float32((k + 0.5) / max(baseline, 1e-3))
    noise = _field(frame, views.shape, max(2.0, height / 24.0))

    def grown(reach):
        size = 2 * int(np.floor(reach * severity * height + 0.5)) + 1
        return _panorama(np.stack([cv2.erode(view, np.ones((size, size), np.uint8)) for view in z]))

    out = _views(np.where(noise > 0, grown(0.12), grown(0.04)), views.shape)
    return to_depth(out, ~valid | hidden[:, :, ::side])


@depth("size of the error", episode="error field, bowl or dome", frame="small change of the field")
def thermal_bias_field(views, severity, episode, frame):
    """Heat spoils the calibration: a smooth relative error, with a bowl or dome in each view."""
    count, height, width = views.shape
    sign = 1.0 if episode.random() < 0.5 else -1.0
    error = _field(episode, views.shape, height / 2.2) * np.float32(0.42)
    error += _field(frame, views.shape, height / 1.5) * np.float32(0.08)
    y = np.linspace(-1, 1, height, dtype=np.float32)[:, None]
    x = np.tile(np.linspace(-1, 1, width, dtype=np.float32), count)[None]
    error += np.float32(sign * 0.40) * (x * x + y * y - np.float32(0.67))
    z = _panorama(views)
    out = z * np.exp(error * np.float32(1.25 * severity))
    return _views(to_depth(out, z <= 0), views.shape)


@depth("size of the steps", episode="offset, shape of the edges", frame="shape of the edges")
def disparity_staircase(views, severity, episode, frame):
    """A stereo matcher has few disparities: the room becomes layers with wavy edges."""
    height = views.shape[1]
    step = np.float32(0.36 * severity)  # 1/m
    offset = np.float32(episode.uniform(0.25, 0.75))
    z = _panorama(views)
    disparity = np.float32(1) / np.maximum(z, np.float32(Z_MIN))
    edges = _field(frame, views.shape, max(2.0, height / 16.0)) * np.float32(0.22)
    edges = edges + _field(episode, views.shape, height / 3.0) * np.float32(0.25)
    level = np.floor(disparity / step + edges + np.float32(0.5))
    level = level + (offset - np.float32(0.5)) * np.float32(0.5)
    out = np.float32(1) / np.maximum(level * step, np.float32(1 / Z_MAX))
    return _views(to_depth(out, z <= 0), views.shape)


@depth(
    "area of the stripes, and noise beside them",
    episode="angles and periods of the two patterns",
    frame="phases of the patterns, noise",
)
def moire_crosstalk_holes(views, severity, episode, frame):
    """A second projector shines on the scene: moire stripes of missing and noisy depth."""
    angle = episode.uniform(0, np.pi)
    frequency = 2 * np.pi / (views.shape[1] * episode.uniform(0.055, 0.075))
    other_angle = angle + episode.uniform(0.12, 0.3)
    other_frequency = frequency * episode.uniform(1.08, 1.25)
    phases = episode.uniform(0, 2 * np.pi, 2) + frame.normal(0, 0.8, 2)
    x, y = _coordinates(views.shape)
    z = _panorama(views)

    def pattern(angle, frequency, phase):
        wave_x = x * np.float32(frequency * np.cos(angle))
        return wave_x + y * np.float32(frequency * np.sin(angle)) + np.float32(phase)

    first = pattern(angle, frequency, phases[0])
    second = pattern(other_angle, other_frequency, phases[1])
    second = second + np.float32(3.0) / np.maximum(z, np.float32(0.5))  # parallax
    light = np.cos(first) + np.cos(second) + np.float32(1.3) * np.cos(first - second)
    levels = np.sort(light[::3, ::3], axis=None)

    def brightest(share):
        place = int((1 - share) * len(levels))
        return light > levels[min(len(levels) - 1, max(0, place))]

    hole = brightest(0.72 * severity)
    noisy = brightest(min(0.97, 0.95 * severity))
    noise = frame.standard_normal(light.shape, dtype=np.float32)
    out = np.where(noisy, z * np.exp(noise * np.float32(0.35 * severity)), z)
    return _views(to_depth(out, (z <= 0) | hole), views.shape)
