"""Compiled motion and Gaussian blur for uint8 panoramas. Edges are replicated.

All arithmetic works on whole rows of 16-bit integers. Every intermediate value is cast back to 16
bits, so that LLVM uses full-width vector instructions. This is about three times as fast as 32-bit
arithmetic.
"""

from __future__ import annotations

import numpy as np
from numba import njit

# maximum sum of the weights in a group of line taps; 256 * 255 still fits into 16 bits
LINE_UNITS = 256

_I16, _I32 = np.int16, np.int32


@njit(cache=True)
def _pad(view, y, rx, scale, row):
    """Write row y of ``view``, multiplied by ``scale``, to ``row``, and repeat the edge pixels.

    ``view`` is uint8 [H, W, 3], and ``row`` has 3 (W + 2 rx) entries.
    """
    height, width, _ = view.shape
    source = view[min(max(y, 0), height - 1)].reshape(-1)
    middle = row[3 * rx : 3 * (rx + width)]
    for i in range(source.size):
        middle[i] = _I16(source[i]) * scale
    for x in range(rx):
        for c in range(3):
            row[3 * x + c] = middle[c]
            row[3 * (rx + width + x) + c] = middle[3 * width - 3 + c]


@njit(cache=True)
def _hat(row, out):
    """Smooth a row per colour: out = (left + 2 centre + right) / 4, rounded.

    ``out`` is 6 entries shorter than ``row``.
    """
    left, centre, right = row, row[3:], row[6:]
    for i in range(out.size):
        outer = _I16(_I16(left[i]) + _I16(right[i]))
        out[i] = _I16(_I16(outer + _I16(2 * _I16(centre[i]))) + 2) >> 2


@njit(cache=True)
def _add_taps(total, a, b, c, d, wa, wb, wc, wd):
    for i in range(total.size):
        part = _I16(total[i] + _I16(_I16(a[i]) * wa))
        part = _I16(part + _I16(_I16(b[i]) * wb))
        part = _I16(part + _I16(_I16(c[i]) * wc))
        total[i] = _I16(part + _I16(_I16(d[i]) * wd))


@njit(cache=True)
def _mix(total, blurred, source, remainder, target):
    """Compute target = (total * blurred + source * remainder) / 65536, rounded.

    Then set ``total`` to zero.
    """
    for i in range(target.size):
        mean = _I32(_I32(total[i]) * blurred)
        target[i] = _I32(_I32(mean + _I32(_I32(source[i]) * remainder)) + _I32(32768)) >> 16
        total[i] = 0


@njit(cache=True)
def line(views, dy, dx, weights, step, strength, out):
    """Blur views (uint8 [V, H, W, 3]) along a line and blend the result with the original views:
    out = (1 - strength) * views + strength * (weighted mean of the taps).

    ``dy`` and ``dx`` (int64 [4 n]) are offsets in pixels. ``weights`` int16 [4 n] are small
    integers; the weights of each group of four taps sum to at most LINE_UNITS. If ``step`` is 2,
    the taps in a row are 2 px apart. The image is then first smoothed along x by (1 2 1)/4, so that
    the pixels between the taps also contribute.
    """
    count, height, width, _ = views.shape
    ry, rx = np.max(np.abs(dy)), np.max(np.abs(dx))
    padded = np.empty((height + 2 * ry, 3 * (width + 2 * rx)), np.uint8)
    wide = np.empty(padded.shape[1] + 6, np.uint8)
    part, total = np.zeros(3 * width, np.int16), np.zeros(3 * width, np.int32)
    sums = part.view(np.uint16)  # the sums are never negative and may exceed the int16 range
    # at the marked taps, the 16-bit sums are added to total and reset before they overflow
    full = np.zeros(dy.size, np.bool_)
    used = 0
    for k in range(0, dy.size, 4):
        four = np.sum(weights[k : k + 4])
        full[k] = used + four > LINE_UNITS
        used = four if full[k] else used + four
    units = np.sum(weights)
    blurred = _I32(round(strength * 65536.0 / units))
    remainder = _I32(65536 - blurred * units)
    long = np.any(full)
    for v in range(count):
        for y in range(height + 2 * ry):
            if step == 2:
                _pad(views[v], y - ry, rx + 1, _I16(1), wide)
                _hat(wide, padded[y])
            else:
                _pad(views[v], y - ry, rx, _I16(1), padded[y])
        for y in range(height):
            for k in range(0, dy.size, 4):
                if full[k]:
                    for i in range(part.size):
                        total[i] += sums[i]
                        part[i] = 0
                a = padded[y + ry + dy[k]][3 * (rx + dx[k]) :]
                b = padded[y + ry + dy[k + 1]][3 * (rx + dx[k + 1]) :]
                c = padded[y + ry + dy[k + 2]][3 * (rx + dx[k + 2]) :]
                d = padded[y + ry + dy[k + 3]][3 * (rx + dx[k + 3]) :]
                w = weights[k : k + 4]
                _add_taps(part, a, b, c, d, w[0], w[1], w[2], w[3])
            source, target = views[v, y].reshape(-1), out[v, y].reshape(-1)
            if long:
                for i in range(part.size):
                    total[i] += sums[i]
                    part[i] = 0
                _mix(total, blurred, source, remainder, target)
            else:
                _mix(sums, blurred, source, remainder, target)


@njit(cache=True)
def _smooth(row, near, far):
    """Compute row = (row + 2 near + far) / 4 in place, for int16 values in [0, 2^14].

    ``row`` must not overlap the other two arrays.
    """
    for i in range(near.size):
        outer = _I16(_I16(row[i] + far[i]) >> _I16(1))
        row[i] = _I16(_I16(_I16(outer + near[i]) + _I16(1)) >> _I16(1))


@njit(cache=True)
def _add_pairs(total, a, b, wa, c, d, wc):
    for i in range(total.size):
        near = _I16((_I32(_I16(a[i] + b[i])) * _I32(wa)) >> _I32(16))
        far = _I16((_I32(_I16(c[i] + d[i])) * _I32(wc)) >> _I32(16))
        total[i] = _I16(_I16(total[i] + near) + far)


@njit(cache=True)
def _weigh(values, centre, step, weights, rounding, total):
    """Write to ``total`` the weighted sum of ``values`` (int16) around the index ``centre``.

    Neighbouring taps are ``step`` values apart.
    """
    middle = values[centre:]
    for i in range(total.size):
        twice = _I16(middle[i] + middle[i])
        total[i] = _I16(rounding + _I16((_I32(twice) * _I32(weights[0])) >> _I32(16)))
    for k in range(1, weights.size, 2):
        one, two = k * step, (k + 1) * step
        a, b = values[centre - one :], values[centre + one :]
        c, d = values[centre - two :], values[centre + two :]
        _add_pairs(total, a, b, weights[k], c, d, weights[k + 1])


@njit(cache=True)
def gaussian(views, weights, levels, out):
    """Convolve views (uint8 [V, H, W, 3]) with a separable symmetric kernel.

    ``weights`` int16 [r + 1] (r is even) are in units of 1/65536. The first weight is half the
    weight of the centre tap. Neighbouring taps are 2^levels pixels apart. Therefore the image is
    first smoothed by (1 2 1)/4 with steps of 1, 2, ... 2^(levels - 1) pixels, so that the pixels
    between the taps also contribute (the "a trous" algorithm).
    """
    count, height, width, _ = views.shape
    r, step = weights.size - 1, 1 << levels
    reach, size = r * step + step - 1, 3 * width
    padded = np.empty((height + 2 * reach, 3 * (width + 2 * reach)), np.int16)
    tall, spare = np.empty(padded.shape[1], np.int16), np.empty(padded.shape[1], np.int16)
    total = np.empty(size, np.int16)
    # compensates for truncated products, which lose half a unit each on average
    rounding = _I16((r + 1) // 2)
    for v in range(count):
        rows = height + 2 * reach
        for y in range(rows):
            _pad(views[v], y - reach, reach, _I16(64), padded[y])
        for level in range(levels):
            gap = 1 << level
            rows -= 2 * gap
            for y in range(rows):
                _smooth(padded[y], padded[y + gap], padded[y + 2 * gap])
        for y in range(height):
            length = tall.size
            centre = (y + r * step) * length
            _weigh(padded.reshape(-1), centre, step * length, weights, rounding, tall)
            for level in range(levels):
                gap = 3 << level
                length -= 2 * gap
                for i in range(tall.size):
                    spare[i] = tall[i]
                _smooth(tall, spare[gap : gap + length], spare[2 * gap :])
            half = _I16(rounding + 32)
            _weigh(tall, 3 * r * step, 3 * step, weights, half, total)
            target = out[v, y].reshape(-1)
            for i in range(size):
                target[i] = min(max(total[i], _I16(0)), _I16(16320)) >> 6
