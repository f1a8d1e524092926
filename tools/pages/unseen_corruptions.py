"""The page ``docs/unseen-corruptions.md``: formulas, halves, and strength beside the suite's."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mitigate.core.markdown import markdown_table
from mitigate.core.observation import HFOV_DEGREES
from mitigate.corruptions import registry
from mitigate.corruptions.record import TEST, VALIDATION
from mitigate.corruptions.suite import DEPTH, RGB
from tools.pages.corruptions import formulas
from tools.pages.curves import EPISODES, OFF, Curve

SEVERITY = 0.6  # at which the page compares them with the suite
PICTURES = {VALIDATION: "pictures/unseen-validation.jpg", TEST: "pictures/unseen-test.jpg"}
CURVES = "pictures/unseen-curves.png"
TEXT = """# Unseen corruptions

An agent is trained on what is on its list, and measured on the same list. A robot meets what is on
no list. These {rgb} corruptions of RGB and {depth} of depth differ in mechanism from the [twelve of
the suite](corruptions.md); no recipe and no schedule draws them unless one is named
(`schedule.names=[haze]`), though random compositions (`schedule.broad_share`) [come close to
some](broad-augmentation.md#how-unseen-are-the-unseen-ones). `suite=full` and `suite=all` do without
them. They keep the suite's
[rules](corruptions.md#rules): keyed draws, s = 0 changes no bit, more s never changes less, lengths
are shares of the frame, invalid depth comes back as it was.

```
make evaluate ARGS="checkpoint=checkpoints/base suite=unseen_val"   # to choose by
make evaluate ARGS="checkpoint=checkpoints/base suite=unseen_test"  # to report
```

300 episodes of a half take 7 to 15 minutes on one core. `suite=unseen` has both halves,
`suite=unseen_rgb` and `suite=unseen_depth` one modality. **Nothing is chosen by the test half**:
who does so has trained on it. Each family of mechanisms (a file of `mitigate/corruptions/unseen`)
has corruptions in both halves, and which of the first 22 is in which
was settled before any hardened agent had met one.
Results stand in a table of their own, with the blocks "unseen RGB" and "unseen depth" and,
where both halves are measured, a PRS of each; they enter no figure of the suite. Every row says the
version of its corruption.

This page and its pictures are written by `python -m tools.pages.gallery --page`.

## The validation half

![Unseen corruptions, validation half, at severities 0, 0.25, 0.5, 0.75 and 1]({validation_picture})

{validation}
## The test half

![Unseen corruptions, test half, at severities 0, 0.25, 0.5, 0.75 and 1]({test_picture})

{test}
One view of apartment {seed}, one random draw for each sheet. W and H are a view's width and height,
side = min(H, W), x a pixel, z its depth in metres, U uniform; a random field is that of the suite.
The numbers are read from the code.

## How much they corrupt

![SSIM and PSNR of RGB, mean error of depth, against severity]({curves})

Four views of the same apartment, mean over {episodes} random draws, at s = {severity:g}, with the
suite's beside them. {ranges}

*Changed*: share of the pixels whose depth is off by more than {off:.0f} %; a lost reading counts as
0 m. *Slip* is the largest step against "more s never changes less" between
neighbours on 101 severities; PSNR and depth error never slip by more than rounding.

{strengths}

Speed: 0.03 to 1.5 ms a panorama of 12 x 64 x 64 at s = 0.6, on one thread of a busy 2-core machine;
`make bench` measures each.

## Limits

- Not all are equally far from the suite. Nearest are `flicker_bands` and `overexposure` (light, as
  `low_light`), `flying_pixels` (beside edges, as `multipath`), and `edge_shadow` and
  `range_limit`, which lose readings as `missing_data` does and write `DepthSensor.missing`.
- `haze` and `refraction` know no depth: a corruption of RGB sees RGB alone. `haze` shows each view
  another part of one cloud, which does not drift.
- `compression` has no motion compensation and `lost_slices` no earlier picture: a corruption is a
  function of one frame. A whole frame that comes too late is not among them, for the same reason.
- `glossy_floor` takes the camera for level and the ceiling for twice as high; `edge_shadow` takes
  the field of view for {hfov:g} degrees.
- `misalignment` and `rolling_shutter` move the picture: on a regular pattern, more can look like
  less. On the chequered scene of the tests SSIM rises by less than {slip:g} between neighbours.

## Pairs

Two corruptions at once are written `first+second`: the first is applied first, both at one
severity, and each draws what it draws alone, so that the dirt of `spatter+missing_data` is that of
`spatter`.

```
make evaluate ARGS="suite=pairs"
make evaluate ARGS="conditions=[clean,low_light+missing_data,haze+range_limit,spatter+mask]"
```

Any two of the suite, the unseen ones, the instruction families and those of other packages make a
pair. `suite=pairs` holds eight of the suite's. Their rows, table and pictures are as those of
single corruptions, in a table of their own; `mitigate run` takes them, too. In code:
`corrupt_observation(obs, Corruption("low_light+missing_data", 0.6), key)`. Schedules draw single
ones.
"""


def page(
    found: Mapping[str, Curve], suite: Mapping[str, Curve], grid: np.ndarray, seed: int
) -> str:
    """The page as Markdown; ``found`` and ``suite`` are the curves on ``grid`` of severities, and
    ``seed`` names the apartment shown."""
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
        ranges=_ranges(suite, found, int(np.abs(grid - SEVERITY).argmin())),
        strengths=_strengths({**suite, **found}, int(np.abs(grid - SEVERITY).argmin())),
        hfov=HFOV_DEGREES,
        slip=registry.record("rolling_shutter").slip,
    )


def table(half: str) -> str:
    """The table of the formulas of one half."""
    return formulas(registry.unseen_names("rgb", "depth", half=half))


def _ranges(suite: Mapping[str, Curve], found: Mapping[str, Curve], at: int) -> str:
    """A sentence on how strong the weakest and the strongest of each are."""
    said = []
    for curves in (suite, found):
        psnr = [curve.psnr[:, at].mean() for curve in curves.values() if curve.psnr.size]
        error = [curve.error[:, at].mean() for curve in curves.values() if curve.error.size]
        said.append(
            f"from {min(psnr):.0f} to {max(psnr):.0f} dB and from {min(error):.2f} to "
            f"{max(error):.2f} m"
        )
    return f"The suite's lie {said[0]}, these {said[1]}."


def _strengths(found: Mapping[str, Curve], at: int) -> str:
    """Two tables, the suite's corruptions first in each."""
    frames, depths = [], []
    for name in (*RGB, *registry.unseen_names("rgb")):
        curve = found[name]
        values = [f"{curve.psnr[:, at].mean():.1f}", f"{curve.ssim[:, at].mean():.2f}"]
        frames.append([f"`{name}`", _whose(name), *values, f"{curve.slip:.1g}"])
    for name in (*DEPTH, *registry.unseen_names("depth")):
        curve = found[name]
        values = [f"{curve.error[:, at].mean():.2f}"]
        values += [f"{100 * curve.changed[:, at].mean():.0f} %"]
        depths.append([f"`{name}`", _whose(name), *values, f"{curve.slip:.1g}"])
    of_rgb = markdown_table(("RGB", "", "PSNR (dB)", "SSIM", "slip"), frames, words=2)
    of_depth = markdown_table(("depth", "", "mean error (m)", "changed", "slip"), depths, words=2)
    return f"{of_rgb}\n\n{of_depth}"


def _whose(name: str) -> str:
    return registry.record(name).half or "suite"
