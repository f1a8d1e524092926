"""Generate the page ``docs/unseen-corruptions.md`` with formulas, halves and strengths."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mitigate.core.markdown import markdown_table
from mitigate.core.observation import HFOV_DEGREES
from mitigate.corruptions import registry
from mitigate.corruptions.record import TEST, VALIDATION
from mitigate.corruptions.suite import DEPTH, RGB
from tools.pages.corruptions import formulas
from tools.pages.curves import EPISODES, OFF, SLIPS, Curve

SEVERITY = 0.6  # severity of the comparison with the suite
PICTURES = {VALIDATION: "pictures/unseen-validation.jpg", TEST: "pictures/unseen-test.jpg"}
CURVES = "pictures/unseen-curves.png"
TEXT = """# Unseen corruptions

A robot meets failures that no training anticipated. These {rgb} corruptions of RGB and {depth} of
depth measure that. Their mechanisms differ from the [standard suite](corruptions.md), and no
recipe trains on them, unless you name one in `schedule.names`. [Random
compositions](broad-augmentation.md#how-unseen-are-the-unseen-ones) come close to some of them.

They follow the [rules](corruptions.md#rules) of the suite and are not part of `suite=full` or
`suite=all`.

```bash
make evaluate ARGS="checkpoint=checkpoints/base suite=unseen_val"   # to choose methods and settings
make evaluate ARGS="checkpoint=checkpoints/base suite=unseen_test"  # to report
```

- They have a validation half and a test half. **Never choose a method or setting by the test
  half.** The halves of the first 22 were fixed before any hardened agent was evaluated on them.
  Each family of mechanisms (a file in `mitigate/corruptions/unseen`) has corruptions in both
  halves.
- `suite=unseen` has both halves, `suite=unseen_rgb` and `suite=unseen_depth` one sensor. 300
  episodes of a half take 7 to 15 minutes on one core.
- Results appear in a separate table with the blocks "unseen RGB" and "unseen depth", and a PRS
  per half if both are measured. They do not affect the figures of the standard suite. Each row
  records the version of its corruption.

`python -m tools.pages.gallery --page` writes this page and its pictures.

## The validation half

![Unseen corruptions, validation half, at severities 0, 0.25, 0.5, 0.75 and 1]({validation_picture})

{validation}
## The test half

![Unseen corruptions, test half, at severities 0, 0.25, 0.5, 0.75 and 1]({test_picture})

{test}
The pictures show one view of apartment {seed}, with one random draw per sheet. W and H are the
width and height of a view, side = min(H, W), x a pixel, z its depth in metres, U the uniform
distribution; a random field is defined [here](corruptions.md#formulas). The values are read from
the code.

## Strength

![SSIM and PSNR of RGB, mean error of depth, against severity]({curves})

Four views of the same apartment, mean over {episodes} random draws, at s = {severity:g}, compared
with the standard suite.
{ranges}

*Changed* is the share of pixels whose depth changes by more than {off:.0f} %; missing depth
counts as 0 m. *Slip* is the largest decrease of the effect between neighbours on 101 severities.
PSNR and depth error decrease only by rounding.

{strengths}

One panorama of 12 x 64 x 64 takes 0.03 to 1.5 ms at s = 0.6, on one thread of a busy 2-core
machine. `make bench` measures each corruption.

## Limits

- Some are similar to corruptions of the suite: `flicker_bands` and `overexposure` to `low_light`,
  `flying_pixels` to `multipath`, `edge_shadow` and `range_limit` to `missing_data`. The last two
  write `DepthSensor.missing`.
- `haze` and `refraction` do not use depth, because a corruption of RGB receives RGB only. `haze`
  shows each view another part of one cloud, which does not move.
- A corruption is a function of one frame. So `compression` has no motion compensation,
  `lost_slices` has no earlier picture, and delayed frames are not included.
- `glossy_floor` assumes a level camera and a ceiling twice as high as the camera. `edge_shadow`
  assumes a field of view of {hfov:g} degrees.
- `misalignment` and `rolling_shutter` move the picture. On a regular pattern, a larger shift can
  change less. On the chequered scene of the tests SSIM rises by less than {slip:g} between
  neighbours.

## Pairs

`first+second` applies two corruptions in this order at the same severity. Each has the same
random draw as alone: `spatter+missing_data` has the same dirt as `spatter`.

```bash
make evaluate ARGS="suite=pairs"
make evaluate ARGS="conditions=[clean,low_light+missing_data,haze+range_limit,spatter+mask]"
```

Any two corruptions can form a pair: standard, unseen, of instructions, or from other packages.
`suite=pairs` contains eight pairs of the standard suite. Pairs have a separate table.
`mitigate run` supports them too. In Python:
`corrupt_observation(obs, Corruption("low_light+missing_data", 0.6), key)`. Training schedules
draw single corruptions only.
"""


def page(
    unseen: Mapping[str, Curve], suite: Mapping[str, Curve], grid: np.ndarray, seed: int
) -> str:
    """Return the page as Markdown. ``unseen`` and ``suite`` are the curves on the ``grid`` of
    severities, and ``seed`` is the apartment in the pictures."""
    return TEXT.format(
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
    """Return the table of formulas of one half."""
    return formulas(registry.unseen_names("rgb", "depth", half=half))


def _ranges(suite: Mapping[str, Curve], unseen: Mapping[str, Curve], at: int) -> str:
    """Return a sentence on the weakest and the strongest corruption of each set."""
    ranges = []
    for curves in (suite, unseen):
        psnr = [curve.psnr[:, at].mean() for curve in curves.values() if curve.psnr.size]
        error = [curve.error[:, at].mean() for curve in curves.values() if curve.error.size]
        ranges.append(
            f"{min(psnr):.0f} to {max(psnr):.0f} dB (RGB) and {min(error):.2f} to "
            f"{max(error):.2f} m (depth)"
        )
    return f"The suite has {ranges[0]}, the unseen corruptions {ranges[1]}."


def _strengths(curves: Mapping[str, Curve], at: int) -> str:
    """Return two tables, each starting with the suite's corruptions."""
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
