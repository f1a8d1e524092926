"""Corruptions of author A, who took the view of a field engineer.

``episode=`` and ``frame=`` say which random values stay constant in an episode and which ones are
sampled for each frame.
"""

from __future__ import annotations

import math
from functools import partial

import cv2
import numpy as np

from .corruption import Z_MAX, corruption, enlarged_noise, to_depth, to_uint8

rgb = partial(corruption, "a", "rgb")
depth = partial(corruption, "a", "depth")

SUNLIGHT = (1.0, 0.90, 0.68)
LED_COLOURS = ((0.1, 0.9, 1.0), (0.2, 1.0, 0.3), (1.0, 0.35, 0.1))
INFRARED = (1.0, 0.62, 0.86)  # red and blue filters pass more near infrared than green ones
AMPLIFIER_GLOW = (1.0, 0.45, 0.95)
NIGHT_VISION = (0.80, 1.0, 0.86)  # in the dark, colours fade but green stays
DROP_MAPS = 3  # patterns of drops; each view gets one of them, or its mirror image
DROPS = 22
FEWEST_DROPS = 3
BURSTS = 12  # per view
DARKEST_LEVELS = 14  # number of grey levels at severity 1
BLUR_CELLS = 24  # grid on which stray light is blurred


def _coordinates(height, width):
    """Return pixel centres in [-1, 1], y [H, 1] and x [1, W]."""
    y = ((np.arange(height, dtype=np.float32) + 0.5) / height * 2 - 1)[:, None]
    x = ((np.arange(width, dtype=np.float32) + 0.5) / width * 2 - 1)[None, :]
    return y, x


def _patches(rng, views, cells):
    """Return a smooth random field that is roughly uniform in (0, 1), float32 [V, H, W]."""
    return 1.0 / (1.0 + np.exp(-2.3 * enlarged_noise(rng, views, cells)))


def _views_between(first, second, count):
    distance = abs(first - second)
    return min(distance, count - distance)


@rgb(
    "light of the sun, and how much the exposure is reduced",
    episode="camera, place of the sun, spikes, ghosts",
    frame="small shift of the sun",
)
def low_sun_flare(views, severity, episode, frame):
    """The low sun shines into one camera: glare, spikes and lens ghosts.

    Stray light reaches the other cameras. The exposure control darkens the panorama.
    """
    count, height, width, _ = views.shape
    sunny = int(episode.integers(count))
    sun_x = episode.uniform(-0.7, 0.7)
    sun_y = episode.uniform(-0.75, -0.1)
    angle = episode.uniform(0, np.pi)
    ghosts = episode.uniform(size=(6, 3))
    sun_x = sun_x + frame.normal(0, 0.03)
    sun_y = sun_y + frame.normal(0, 0.02)
    tint = np.array(SUNLIGHT, np.float32)

    y, x = _coordinates(height, width)
    dx = x - sun_x
    dy = y - sun_y
    radius = np.sqrt(dx * dx + dy * dy) + 1e-3
    direction = np.arctan2(dy, dx) - angle
    spikes = np.abs(np.cos(3 * direction)) ** 60 * np.exp(-1.2 * radius)
    core = np.exp(-((radius / (0.10 + 0.18 * severity)) ** 2)) * 3.0
    veil = 0.16 / (radius + 0.12)
    flare = (core + veil + 0.8 * spikes)[..., None] * tint
    for place, size, hue in ghosts:
        scale = 0.2 - 1.8 * place  # ghosts are on the line through the sun and the image centre
        distance = np.sqrt((x - sun_x * scale) ** 2 + (y - sun_y * scale) ** 2)
        distance = distance / (0.08 + 0.2 * size)
        ring = np.clip(4 * (1.1 - distance), 0, 1) * (0.35 + 0.65 * np.clip(distance, 0, 1))
        colour = [0.5 + 0.5 * np.cos(6.28 * (hue + channel / 3)) for channel in range(3)]
        flare = flare + 0.45 * ring[..., None] * np.array(colour, np.float32)

    out = np.empty_like(views)
    for i in range(count):
        apart = _views_between(i, sunny, count)
        image = views[i].astype(np.float32) * (1 - severity * (0.52 + 0.25 * np.exp(-apart)))
        if apart == 0:
            image += (255 * severity) * flare
        else:
            side = 1.0 if (i - sunny) % count <= count // 2 else -1.0
            stray = np.exp(-0.9 * (apart - 1)) * (0.55 - 0.3 * side * x + 0 * y)
            image += (190 * severity) * stray[..., None] * tint
        out[i] = to_uint8(image)
    return out


@rgb(
    "contrast of the bands",
    episode="number of bands, on-time, colours",
    frame="position of the bands, by view",
)
def lamp_pwm_bands(views, severity, episode, frame):
    """Dimmed LED lamps pulse while the rows are read: dark and bright bands."""
    count, height = views.shape[:2]
    bands = episode.uniform(2.2, 5.5)
    duty = episode.uniform(0.4, 0.6)
    lag = episode.uniform(-0.05, 0.05, size=3)  # of the phosphor, by colour
    shift = frame.uniform(0, 1) + frame.normal(0, 0.12, size=count)
    rows = np.arange(height, dtype=np.float32) / height * bands
    phase = rows[None, :, None] + shift[:, None, None] + lag[None, None, :]
    wave = np.cos(2 * np.pi * phase)
    light = 1 / (1 + np.exp(-7 * (wave - np.cos(np.pi * duty))))
    gain = (1 + severity * (0.75 * light - 0.93 * (1 - light))).astype(np.float32)
    gain = np.maximum(gain, 0.0) ** (1 / 2.2)  # from linear light to grey levels
    return to_uint8(views * gain.astype(np.float32)[:, :, None, :])


def _drop_map(drops, severity, height, width, run):
    """Return source x, source y, shade and glint of each pixel behind a lens with drops."""
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    map_x = x.copy()
    map_y = y.copy()
    shade = np.ones((height, width), np.float32)
    glint = np.zeros((height, width), np.float32)
    visible = math.ceil(FEWEST_DROPS + severity * (DROPS - FEWEST_DROPS))
    for place_x, place_y, size, stretch in drops[:visible]:
        radius = (0.05 + 0.15 * size * size) * width * (0.55 + 0.6 * severity)
        centre_x = place_x * width
        centre_y = place_y * height + run
        tall = 1.0 + 0.5 * stretch
        x0 = max(int(centre_x - radius), 0)
        x1 = min(int(centre_x + radius) + 2, width)
        y0 = max(int(centre_y - radius * tall), 0)
        y1 = min(int(centre_y + radius * tall) + 2, height)
        if x1 <= x0 or y1 <= y0:
            continue
        box = (slice(y0, y1), slice(x0, x1))
        dx = (x[box] - centre_x) / radius
        dy = (y[box] - centre_y) / (radius * tall)
        square = dx * dx + dy * dy
        inside = square < 1
        pull = 0.25 + 0.35 * square  # a wide-angle picture, upside down
        np.copyto(map_x[box], centre_x - dx * pull * width, where=inside)
        np.copyto(map_y[box], centre_y - dy * pull * height, where=inside)
        np.copyto(shade[box], 1.0 - 0.6 * square * square, where=inside)
        bright = 170 * np.exp(-((dx + 0.35) ** 2 + (dy + 0.4) ** 2) * 14)
        np.copyto(glint[box], bright, where=inside)
    return map_x, map_y, cv2.merge([shade] * 3), cv2.merge([to_uint8(glint)] * 3)


@rgb("number and size of the drops", episode="the drops", frame="how far they have run down")
def splash_drops(views, severity, episode, frame):
    """Drops of mop water on the lens show small pictures upside down."""
    count, height, width, _ = views.shape
    drops = episode.uniform(size=(DROP_MAPS, DROPS, 4))
    choice = episode.integers(0, DROP_MAPS, size=count)
    mirrored = episode.integers(0, 2, size=count)
    run = frame.uniform(-0.01, 0.03) * height
    maps = [_drop_map(drops[k], severity, height, width, run) for k in range(DROP_MAPS)]
    out = np.empty_like(views)
    for i in range(count):
        map_x, map_y, shade, glint = maps[choice[i]]
        step = -1 if mirrored[i] else 1
        image = np.ascontiguousarray(views[i][:, ::step])
        border = cv2.BORDER_REFLECT_101
        image = cv2.remap(image, map_x, map_y, cv2.INTER_LINEAR, borderMode=border)
        image = cv2.add(cv2.multiply(image, shade, dtype=cv2.CV_8U), glint)
        out[i] = image[:, ::step]
    return out


@rgb(
    "opacity of the reflection, brightness of the LED ring",
    episode="shift of the second image, place and colour of the ring",
    frame="brightness of the ring",
)
def cover_glass_ghost(views, severity, episode, frame):
    """The cover dome reflects the opposite view, twice, and the ring of the status LED."""
    count, height, width, _ = views.shape
    shift = episode.uniform(0.04, 0.10) * width * (1 if episode.uniform() < 0.5 else -1)
    led_x = episode.uniform(-0.8, 0.8)
    led_y = episode.uniform(0.35, 0.85)
    colour = np.array(LED_COLOURS[episode.integers(3)], np.float32)
    pulse = 0.7 + 0.3 * np.sin(frame.uniform(0, 2 * np.pi))
    y, x = _coordinates(height, width)
    led = 0
    for offset in (0.0, 0.16):  # the two faces of the glass
        radius = np.sqrt((x - led_x - offset) ** 2 + ((y - led_y + 0.4 * offset) * 1.8) ** 2)
        led = led + np.exp(-(((radius - 0.28) / 0.07) ** 2))
    led = (led * 190 * pulse * severity)[..., None].astype(np.float32) * colour
    second = np.float32([[1, 0, shift], [0, 1, -0.3 * abs(shift)]])
    size = (width, height)
    out = np.empty_like(views)
    for i in range(count):
        ghost = np.ascontiguousarray(views[(i + count // 2) % count][:, ::-1])
        moved = cv2.warpAffine(ghost, second, size, borderMode=cv2.BORDER_REFLECT_101)
        ghost = cv2.addWeighted(ghost, 0.6, moved, 0.4, 0)
        share = 1 - 0.55 * severity
        image = cv2.addWeighted(views[i], share, ghost, 0.85 * severity, 0, dtype=cv2.CV_32F)
        out[i] = to_uint8(image + led)
    return out


@rgb(
    "share of infrared light",
    episode="brightness of the dyes in infrared, dots of the projector",
    frame="brightness of the dots",
)
def ircut_filter_stuck(views, severity, episode, frame):
    """The infrared filter is stuck open: pale magenta, and dots of the depth projector."""
    _, height, width, _ = views.shape
    dyes = episode.uniform(0.1, 0.9, size=3)
    dots = episode.uniform(size=(height, width)).astype(np.float32)
    flicker = frame.uniform(0.8, 1.2)
    dots = np.maximum(dots - 0.975, 0) * (40 * 70)
    dots = cv2.GaussianBlur(dots, (3, 3), 0.7) * (1.6 * flicker)
    tint = np.array(INFRARED, np.float32)
    out = np.empty_like(views)
    for i, view in enumerate(views):
        image = view.astype(np.float32)
        red, green, blue = np.moveaxis(image, -1, 0)
        most = image.max(-1)
        least = image.min(-1)
        grey = (red + green + blue) * (1 / 3)
        dye = (red - least) * dyes[0] + (green - least) * dyes[1] + (blue - least) * dyes[2]
        # dark cloth and dyed surfaces become pale
        infrared = 70 + 0.40 * grey + 0.9 * dye + 0.25 * (most - least) + dots
        image = image * (1 - 0.85 * severity) + (0.95 * severity) * infrared[..., None] * tint
        out[i] = to_uint8(image)
    return out


@rgb(
    "number and length of the bursts",
    episode="loose byte and bit, quality of each cable",
    frame="the bursts",
)
def ribbon_cable_slip(views, severity, episode, frame):
    """A loose camera cable loses bytes: bursts of rows are displaced and have wrong colours."""
    count, height, width, _ = views.shape
    loose_byte = int(episode.integers(1, 3))
    loose_bit = int(episode.integers(5, 8))
    cables = episode.uniform(0.75, 1.25, size=count)
    shape = (count, BURSTS)
    start = frame.uniform(0, 1, shape)
    length = frame.uniform(0.03, 0.14, shape)
    chance = frame.uniform(size=shape)
    amount = frame.normal(0, 0.22, shape)
    kind = frame.uniform(size=shape)
    active = chance < np.clip(0.85 * severity * cables[:, None], 0, 1)
    row = (np.arange(height) / height)[None, None, :]
    end = start + length * (0.6 + 0.5 * severity)
    inside = (row >= start[..., None]) & (row < end[..., None]) & active[..., None]
    slip = np.rint(amount * width).astype(np.int64) * 3
    slip = np.where(kind < 0.65, slip + loose_byte, slip)  # part of a pixel: the channels rotate
    shift = (inside * slip[..., None]).sum(1)
    flipped = (inside & (kind > 0.5)[..., None]).any(1)

    place = np.arange(3 * width)
    lines = views.reshape(count, height, 3 * width)
    out = lines.copy()
    view, row = np.nonzero((shift != 0) | flipped)
    if len(view):
        source = (place[None, :] - shift[view, row][:, None]) % (3 * width)
        moved = lines[view[:, None], row[:, None], source]
        hit = flipped[view, row][:, None] & (place[None, :] % 3 == loose_byte)
        out[view, row] = np.where(hit, moved ^ np.uint8(1 << loose_bit), moved)
    return out.reshape(views.shape)


@rgb(
    "brightness of columns, glow and hot pixels",
    episode="columns, corner of the glow, hot pixels",
    frame="strength, by view",
)
def overheated_sensor(views, severity, episode, frame):
    """A hot sensor adds column patterns, the glow of an amplifier in a corner, and hot pixels."""
    count, height, width, _ = views.shape
    columns = episode.standard_normal((count, 1, width, 1)).astype(np.float32)
    groups = episode.standard_normal((count, 1, 8, 3)).astype(np.float32)  # columns of a converter
    columns = 30 * columns + 34 * np.repeat(groups, -(-width // 8), axis=2)[:, :, :width]
    corner = episode.integers(0, 2, size=(count, 2)) * 2 - 1
    hot = episode.uniform(size=(height, width, 3)).astype(np.float32)
    hot = np.where(hot > 0.985, (hot - 0.985) * (300 / 0.015), 0)
    strength = frame.normal(1, 0.08, size=count)
    y, x = _coordinates(height, width)
    tint = np.array(AMPLIFIER_GLOW, np.float32)
    out = np.empty_like(views)
    for i in range(count):
        corner_y, corner_x = corner[i]
        square = (x - corner_x) ** 2 + (y - corner_y) ** 2
        glow = (150 * np.exp(-square / 0.7) + 35).astype(np.float32)[..., None] * tint
        added = columns[i] + glow + hot[::corner_y, ::corner_x]
        added = severity * np.float32(strength[i]) * added
        out[i] = to_uint8(views[i] * np.float32(1 - 0.35 * severity) + added)
    return out


@rgb(
    "darkness of the room",
    episode="camera with the lamp, place and size of the spot",
    frame="voltage of the battery, noise",
)
def night_headlamp(views, severity, episode, frame):
    """At night, only the robot's lamp shines: a burnt-out spot, and few grey levels elsewhere."""
    count, height, width, _ = views.shape
    front = int(episode.integers(count))
    spot_x = episode.uniform(-0.3, 0.3)
    spot_y = episode.uniform(0.0, 0.4)
    radius = episode.uniform(0.45, 0.7)
    battery = 1 + frame.normal(0, 0.05)
    y, x = _coordinates(height, width)
    square = ((x - spot_x) ** 2 + ((y - spot_y) * 1.2) ** 2) / radius**2
    spot = np.exp(-(square**1.5)).astype(np.float32)
    levels = 256 ** (1 - severity) * DARKEST_LEVELS**severity
    ambient = (1 - severity) ** 2.2 * 0.965 + 0.035
    linear = (np.arange(256, dtype=np.float32) / 255) ** 2.0
    tint = np.array(NIGHT_VISION, np.float32) ** np.float32(severity)
    noise = frame.integers(-2, 3, size=(height, width)).astype(np.float32)
    noise = cv2.merge([noise * (0.25 * severity) + 0.5] * 3)
    fade = (np.eye(3) * (1 - 0.7 * severity) + 0.7 * severity / 3) * tint[:, None]
    out = np.empty_like(views)
    for i in range(count):
        apart = _views_between(i, front, count)
        light = cv2.LUT(views[i], linear)
        if apart == 0:
            gain = (ambient + 1.9 * severity * battery * spot)[..., None].astype(np.float32)
            light = cv2.transform(light, fade) * gain
        else:
            light = cv2.transform(light, fade * (ambient + 0.10 * severity * np.exp(-apart)))
        coded = np.floor(np.sqrt(np.minimum(light, 1.0)) * np.float32(levels) + noise)
        out[i] = to_uint8(coded * np.float32(255 / levels))
    return out


@depth(
    "share of wrong pixels",
    episode="ambiguity distance, materials, direction of the jumps",
    frame="edges of the patches",
)
def tof_unwrap_error(views, severity, episode, frame):
    """A time-of-flight camera cannot unwrap the phase of some materials.

    Their depth is wrong by multiples of the ambiguity distance.
    """
    ambiguity = episode.uniform(2.2, 3.4)
    material = _patches(episode, views, 6)
    patches = 0.65 * material + 0.35 * _patches(frame, views, 9)
    farther = _patches(episode, views, 4) < 0.5
    wrong = patches < 0.08 + 0.72 * severity
    turns = np.floor(views / ambiguity)
    jumped = np.where(farther, views + ambiguity, views)
    jumped = np.where(turns > 0, views - turns * ambiguity, jumped)
    return to_depth(np.where(wrong & (views > 0), jumped, views), views <= 0)


@depth("share of the floor that reflects", episode="wet patches", frame="edges of the patches")
def polished_floor_mirror(views, severity, episode, frame):
    """A polished or wet floor reflects the room: the depth of the reflected wall or ceiling."""
    count, height, width = views.shape
    wet = _patches(episode, views, 5)
    grain = frame.uniform(-0.08, 0.08, size=views.shape).astype(np.float32)
    y, _ = _coordinates(height, width)
    mirror = views[:, ::-1]  # the reflected ray has the same length as the ray upwards
    # on the floor, depth grows upwards in the image; on walls and furniture it does not
    step = max(2, height // 32)
    above = np.concatenate([views[:, :1].repeat(step, 1), views[:, :-step]], 1)
    below = np.concatenate([views[:, step:], views[:, -1:].repeat(step, 1)], 1)
    floor = (above > 1.01 * below) & (below > 0)
    wrong = (wet + grain < severity * (1.25 - 0.35 * np.clip(y, 0, 1))) & (y > 0)
    wrong = wrong & (views > 0) & floor
    out = np.where(wrong & (mirror > views), mirror, views)
    # a dark reflection gives a depth that is too large
    out = np.where(wrong & (mirror <= views), views * (1 + 0.6 * severity), out)
    return to_depth(out, views <= 0)


@depth(
    "error of the disparity",
    episode="offset and tilt, by view",
    frame="temperature, offsets of the rows",
)
def bumped_stereo_rig(views, severity, episode, frame):
    """A collision has bent the stereo rig: the disparity has an offset and a tilt."""
    count, height, width = views.shape
    sign = 1.0 if episode.uniform() < 0.5 else -1.0
    bend = episode.normal(0, 1, size=(count, 3)).astype(np.float32)[..., None, None]
    temperature = 1 + frame.normal(0, 0.05)
    y, x = _coordinates(height, width)
    plane = sign * (1 + 0.2 * bend[:, 0]) + 0.45 * bend[:, 1] * x + 0.35 * bend[:, 2] * y
    rows = frame.normal(0, 0.25, size=(count, height, 1)).astype(np.float32)
    error = np.float32(0.22 * severity * temperature) * (plane + rows)
    disparity = 1.0 / np.maximum(views, 0.05) + error
    return to_depth(1.0 / np.maximum(disparity, 1.0 / Z_MAX), views <= 0)


@depth("density of the dust", episode="density, by view", frame="the clouds")
def brush_dust_phantoms(views, severity, episode, frame):
    """The emitter lights dust from the brushes: grainy clouds within two metres."""
    count, height, width = views.shape
    side = episode.uniform(0.6, 1.3, size=(count, 1, 1)).astype(np.float32)
    cloud = _patches(frame, views, 7)
    grain = frame.uniform(0, 1, size=(count, -(-height // 2), -(-width // 2))).astype(np.float32)
    grain = grain.repeat(2, 1).repeat(2, 2)[:, :height, :width]
    phantom = 0.15 + 1.3 * _patches(frame, views, 10) * (0.4 + 0.8 * grain)
    y, _ = _coordinates(height, width)
    density = np.clip(1.5 * cloud - 0.25, 0, 1) * (0.8 + 0.3 * y) * side
    hit = grain < 0.95 * severity * density
    near = np.where(views > 0, np.minimum(views, phantom), phantom)
    return to_depth(np.where(hit, near, views), (views <= 0) & ~hit)


@depth(
    "amount of stray light",
    episode="smears, distance and place of the robot's lip",
    frame="strength",
)
def tof_stray_light(views, severity, episode, frame):
    """Light scatters in the smeared window of a time-of-flight camera.

    Light from near objects and from the robot's own lip makes far surfaces appear nearer.
    """
    count, height, width = views.shape
    smears = _patches(episode, views, 4) * 0.8 + 0.6
    lip = episode.uniform(0.25, 0.45)  # metres
    lip_x = episode.uniform(-0.8, 0.8, size=count)
    strength = 1 + frame.normal(0, 0.06)
    valid = views > 0
    amplitude = np.where(valid, 1.0 / np.maximum(views, 0.25) ** 2, 0).astype(np.float32)
    y, x = _coordinates(height, width)

    def spread(image):
        image = cv2.resize(image, (BLUR_CELLS, BLUR_CELLS), interpolation=cv2.INTER_AREA)
        image = cv2.GaussianBlur(image, (0, 0), 4.0)
        return cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)

    out = np.empty_like(views)
    for i in range(count):
        direct = amplitude[i] * views[i]
        stray = spread(amplitude[i])
        stray_depth = spread(direct)
        own = 0.30 * np.exp(-((x - lip_x[i]) ** 2 / 0.8 + (y - 1.1) ** 2 / 1.2)).astype(np.float32)
        gain = (0.9 * severity**1.5 * strength) * smears[i]
        weighted = direct + gain * (stray_depth + own * lip)
        out[i] = weighted / np.maximum(amplitude[i] + gain * (stray + own), 1e-6)
    return to_depth(out, ~valid)


@depth(
    "width of the growth, and size of the depth steps",
    episode="texture of the walls",
    frame="ragged edges",
)
def matcher_fattening(views, severity, episode, frame):
    """A stereo matcher lacks texture: near objects grow, doorways close, and depth has steps."""
    width = views.shape[2]
    texture = 0.6 * _patches(episode, views, 6) + 0.4 * _patches(frame, views, 14)
    far = np.where(views > 0, views, np.float32(2 * Z_MAX)).astype(np.float32)

    def grown(reach):
        side = 2 * int(round(reach * severity * width)) + 1
        return np.stack([cv2.erode(view, np.ones((side, side), np.uint8)) for view in far])

    near = np.where(texture < 0.5, grown(0.115), grown(0.045))
    step = np.float32(0.01 + 0.09 * severity)
    disparity = np.ceil(1.0 / np.maximum(near, 0.05) / step) * step
    return to_depth(1.0 / disparity, near > Z_MAX * 1.5)
