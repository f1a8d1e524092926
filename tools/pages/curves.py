"""Measure how the effect of a corruption depends on its severity.

The effect is measured as SSIM and PSNR of RGB frames, and as the error of depth.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from mitigate.core.files import write_figure
from mitigate.corruptions.keying import Key
from mitigate.corruptions.registry import modality
from mitigate.corruptions.suite import NAMES, corrupt
from mitigate.evaluation.plots import DASHES, OKABE_ITO

GRID = np.linspace(0.0, 1.0, 101)
EPISODES = 3  # number of random keys over which a curve is averaged
OFF = 0.05  # relative change of depth above which a pixel counts as changed (heuristic)
SSIM_WINDOW, SSIM_SIGMA = 11, 1.5  # window size and sigma in pixels (Wang et al. 2004)
# maximum decrease of the effect from one severity to the next, in SSIM or in metres of depth
SLIPS = {
    "motion_blur": 0.03,
    "quantization": 0.005,
    "white_balance": 0.001,
    "hue_shift": 0.001,
    "refraction": 0.01,
    "scratches": 0.001,
    "rolling_shutter": 0.01,
    "impulse_noise": 0.002,
    "lost_slices": 0.01,
    "misalignment": 0.01,
}
SSIM_C1, SSIM_C2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2  # the same


def ssim(a: np.ndarray, b: np.ndarray) -> float:
    """Return the mean structural similarity (Wang 2004) of two uint8 views [H, W, 3] in grey."""

    def smooth(x: np.ndarray) -> np.ndarray:
        return cv2.GaussianBlur(x, (SSIM_WINDOW, SSIM_WINDOW), SSIM_SIGMA)

    x, y = a.astype(np.float64).mean(-1), b.astype(np.float64).mean(-1)
    mx, my = smooth(x), smooth(y)
    vx, vy, vxy = smooth(x * x) - mx * mx, smooth(y * y) - my * my, smooth(x * y) - mx * my
    structure = (2 * vxy + SSIM_C2) / (vx + vy + SSIM_C2)
    return float(np.mean((2 * mx * my + SSIM_C1) / (mx * mx + my * my + SSIM_C1) * structure))


def psnr(a: np.ndarray, b: np.ndarray) -> float:
    """Return the peak signal-to-noise ratio of two uint8 arrays in decibels (infinite if equal)."""
    error = np.mean((a.astype(np.float64) - b) ** 2)
    return float("inf") if error == 0 else float(10 * np.log10(255**2 / error))


def depth_error(clean: np.ndarray, corrupted: np.ndarray) -> float:
    """Return the mean absolute error in metres over the pixels that are valid in ``clean``; lost
    depth counts as 0 m.
    """
    valid = np.isfinite(clean) & (clean > 0)
    return float(np.abs(corrupted[valid].astype(np.float64) - clean[valid]).mean())


def depth_changed(clean: np.ndarray, corrupted: np.ndarray) -> float:
    """Return the fraction of valid pixels whose depth error is more than ``OFF`` times their
    depth.
    """
    valid = np.isfinite(clean) & (clean > 0)
    gap = np.abs(corrupted[valid].astype(np.float64) - clean[valid])
    return float(np.mean(gap > OFF * clean[valid]))


@dataclass(frozen=True)
class Curve:
    """Return arrays [episodes, severities]: SSIM and PSNR, or the error and the changed fraction of
    depth.
    """

    ssim: np.ndarray
    psnr: np.ndarray
    error: np.ndarray
    changed: np.ndarray

    @property
    def slip(self) -> float:
        """Return the largest change in the wrong direction from one severity to the next: an
        increase of SSIM, or a decrease of the depth error in metres.
        """
        rise = np.diff(self.ssim) if self.ssim.size else -np.diff(self.error)
        return float(max(0.0, rise.max()))


def curves(
    rgb: np.ndarray,
    depth: np.ndarray,
    grid: np.ndarray = GRID,
    names: tuple[str, ...] = NAMES,
) -> dict[str, Curve]:
    """Return the curves of corruptions by name, on views [V, H, W, 3] and depth [V, H, W, 1]."""
    by_name = {}
    for name in names:
        frame = rgb if modality(name) == "rgb" else depth
        corrupted = [
            [corrupt(frame, name, s, key=Key(0, f"curve {i}")) for s in grid]
            for i in range(EPISODES)
        ]
        none: list[list[float]] = [[]] * EPISODES
        if modality(name) == "rgb":
            likeness = [
                [np.mean([ssim(a, b) for a, b in zip(rgb, x, strict=True)]) for x in row]
                for row in corrupted
            ]
            signal = [[psnr(rgb, x) for x in row] for row in corrupted]
            by_name[name] = Curve(*(np.array(values) for values in (likeness, signal, none, none)))
        else:
            error = [[depth_error(depth, x) for x in row] for row in corrupted]
            changed = [[depth_changed(depth, x) for x in row] for row in corrupted]
            by_name[name] = Curve(*(np.array(values) for values in (none, none, error, changed)))
    return by_name


def draw(by_name: dict[str, Curve], path: Path, grid: np.ndarray = GRID) -> None:
    """Plot the SSIM and PSNR of RGB corruptions and the mean error of depth corruptions, as PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 7.8), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(2, 2).ravel()
    titles = ("RGB: SSIM to the clean frame", "RGB: PSNR in dB", "Depth: mean error in metres")
    for axis, title, kind in zip(panels, titles, ("ssim", "psnr", "error"), strict=False):
        sensor = "depth" if kind == "error" else "rgb"
        for number, name in enumerate(n for n in by_name if modality(n) == sensor):
            values = getattr(by_name[name], kind)
            # equal frames have no finite PSNR
            values = np.where(np.isfinite(values), values, np.nan)
            seen = np.isfinite(values).all(0)
            colour = OKABE_ITO[number % len(OKABE_ITO)]
            dash = DASHES[number % len(DASHES)]
            axis.plot(grid[seen], values[:, seen].mean(0), dash, c=colour, label=name)
        axis.set(title=title, xlabel="severity")
        axis.grid(alpha=0.3)
    panels[0].set_ylim(0, 1.02)
    panels[1].set_ylim(0, 55)
    panels[2].set(yscale="log")
    panels[3].axis("off")
    for axis, title, place in (
        (panels[0], "RGB", "upper left"),
        (panels[2], "Depth", "lower left"),
    ):
        handles = axis.get_lines()
        legend = panels[3].legend(handles=handles, title=title, loc=place, ncols=2, handlelength=3)
        panels[3].add_artist(legend)
    write_figure(path, figure, dpi=110)
