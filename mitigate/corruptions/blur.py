"""Compiled blurs for uint8 panoramas: a short line kernel and a Gaussian. Edges are replicated."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def _pad(view, ry, rx, out):
    """Copy uint8 [H, W, 3] into out [H + 2 ry, (W + 2 rx) * 3], replicating the edges."""
    height, width, _ = view.shape
    for y in range(height + 2 * ry):
        source = view[min(max(y - ry, 0), height - 1)]
        row = out[y]
        for x in range(rx):
            for c in range(3):
                row[3 * x + c] = source[0, c]
                row[3 * (rx + width + x) + c] = source[width - 1, c]
        middle = row[3 * rx : 3 * (rx + width)]
        flat = source.reshape(-1)
        for i in range(flat.size):
            middle[i] = flat[i]


@njit(cache=True)
def convolve_taps(views, dy, dx, weights, out):
    """Sparse convolution of uint8 [V, H, W, 3]; ``weights`` are uint32 that add up to 65536."""
    count, height, width, _ = views.shape
    ry, rx = np.max(np.abs(dy)), np.max(np.abs(dx))
    padded = np.empty((height + 2 * ry, 3 * (width + 2 * rx)), np.uint8)
    acc = np.empty(3 * width, np.uint32)
    for v in range(count):
        _pad(views[v], ry, rx, padded)
        for y in range(height):
            acc[:] = np.uint32(32768)
            for k in range(dy.size):
                start = 3 * (rx + dx[k])
                source = padded[y + ry + dy[k], start : start + 3 * width]
                weight = weights[k]
                for i in range(3 * width):
                    acc[i] += np.uint32(source[i]) * weight
            target = out[v, y].reshape(-1)
            for i in range(3 * width):
                target[i] = acc[i] >> np.uint32(16)


@njit(cache=True)
def gaussian(views, weights, out):
    """Separable convolution of uint8 [V, H, W, 3]; ``weights`` float32 [r + 1], centre first."""
    count, height, width, _ = views.shape
    r = weights.size - 1
    padded = np.empty((height + 2 * r, 3 * (width + 2 * r)), np.uint8)
    tall = np.empty(3 * (width + 2 * r), np.float32)
    acc = np.empty(3 * width, np.float32)
    for v in range(count):
        _pad(views[v], r, r, padded)
        for y in range(height):
            centre = padded[y + r]
            for i in range(tall.size):
                tall[i] = weights[0] * np.float32(centre[i])
            for k in range(1, r + 1):
                above, below, weight = padded[y + r - k], padded[y + r + k], weights[k]
                for i in range(tall.size):
                    tall[i] += weight * np.float32(np.int32(above[i]) + np.int32(below[i]))
            for i in range(3 * width):
                acc[i] = weights[0] * tall[i + 3 * r] + np.float32(0.5)
            for k in range(1, r + 1):
                left, right = tall[3 * (r - k) :], tall[3 * (r + k) :]
                weight = weights[k]
                for i in range(3 * width):
                    acc[i] += weight * (left[i] + right[i])
            target = out[v, y].reshape(-1)
            for i in range(3 * width):
                target[i] = np.uint8(np.int32(acc[i]))
