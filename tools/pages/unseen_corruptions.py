"""Generate the page ``docs/unseen-corruptions.md``.

The page states the formula and the strength of each corruption, and whether it is for validation or
for test.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mitigate.core.markdown import markdown_table
from mitigate.core.observation import HFOV_DEGREES
from mitigate.corruptions import registry
from mitigate.corruptions.record import TEST, VALIDATION
from mitigate.corruptions.suite import DEPTH, RGB
from tools.pages.corruptions import formulas
from tools.pages.curves import EPISODES, OFF, SLIPS, Curve

SEVERITY = 0.6  # severity at which the corruptions are compared with the suite
PICTURES = {VALIDATION: "pictures/unseen-validation.jpg", TEST: "pictures/unseen-test.jpg"}
CURVES = "pictures/unseen-curves.png"
TEMPLATE = Path(__file__).with_suffix(".md")  # the template: names in braces are replaced by values


def page(
    unseen: Mapping[str, Curve], suite: Mapping[str, Curve], grid: np.ndarray, seed: int
) -> str:
    """Return the page as Markdown. ``unseen`` and ``suite`` are the curves on the ``grid`` of
    severities, and ``seed`` selects the apartment in the pictures."""
    return TEMPLATE.read_text("utf-8").format(
        rgb=len(registry.unseen_names("rgb")),
        depth=len(registry.unseen_names("depth")),
        validation=table(VALIDATION),
        test=table(TEST),
        validation_picture=PICTURES[VALIDATION],
        test_picture=PICTURES[TEST],
        curves=CURVES,
        seed=seed,
        episodes=EPISODES,
        severity=SEVERITY,
        off=100 * OFF,
        ranges=_ranges(suite, unseen, int(np.abs(grid - SEVERITY).argmin())),
        strengths=_strengths({**suite, **unseen}, int(np.abs(grid - SEVERITY).argmin())),
        hfov=HFOV_DEGREES,
        slip=SLIPS["rolling_shutter"],
    )


def table(half: str) -> str:
    """Return the formulas of the unseen corruptions in one half (VALIDATION or TEST) as a table."""
    return formulas(registry.unseen_names("rgb", "depth", half=half))


def _ranges(suite: Mapping[str, Curve], unseen: Mapping[str, Curve], at: int) -> str:
    """Return two sentences with the effects of the weakest and the strongest corruption.

    The first sentence describes the suite, and the second describes the unseen corruptions.
    """
    ranges = []
    for curves in (suite, unseen):
        psnr = [curve.psnr[:, at].mean() for curve in curves.values() if curve.psnr.size]
        error = [curve.error[:, at].mean() for curve in curves.values() if curve.error.size]
        ranges.append(
            f"the PSNR of RGB is {min(psnr):.0f} to {max(psnr):.0f} dB, and the mean error of "
            f"depth is {min(error):.2f} to {max(error):.2f} m."
        )
    return f"For the standard suite, {ranges[0]} For the unseen corruptions, {ranges[1]}"


def _strengths(curves: Mapping[str, Curve], at: int) -> str:
    """Return two tables, for RGB and depth; each begins with the corruptions of the suite."""
    frames, depths = [], []
    for name in (*RGB, *registry.unseen_names("rgb")):
        curve = curves[name]
        values = [f"{curve.psnr[:, at].mean():.1f}", f"{curve.ssim[:, at].mean():.2f}"]
        frames.append([f"`{name}`", _whose(name), *values, f"{curve.slip:.1g}"])
    for name in (*DEPTH, *registry.unseen_names("depth")):
        curve = curves[name]
        values = [f"{curve.error[:, at].mean():.2f}"]
        values += [f"{100 * curve.changed[:, at].mean():.0f} %"]
        depths.append([f"`{name}`", _whose(name), *values, f"{curve.slip:.1g}"])
    of_rgb = markdown_table(("RGB", "", "PSNR (dB)", "SSIM", "slip"), frames, words=2)
    of_depth = markdown_table(("depth", "", "mean error (m)", "changed", "slip"), depths, words=2)
    return f"{of_rgb}\n\n{of_depth}"


def _whose(name: str) -> str:
    return registry.record(name).half or "suite"
