"""Generate the page ``docs/corruptions.md`` with formulas, scopes and limits."""

from __future__ import annotations

from itertools import takewhile

from mitigate.core.files import PACKAGE
from mitigate.core.markdown import markdown_table
from mitigate.corruptions import eld, keying
from mitigate.corruptions.registry import record
from mitigate.corruptions.suite import DEPTH, NAMES, RGB, SUITE_VERSION
from tools.pages.curves import EPISODES, GRID, SLIPS, Curve
from tools.pages.descriptions import DESCRIPTIONS

HEAD = """# The corruption suite

The standard suite has twelve corruptions of RGB-D cameras, each with a severity s from 0 to 1.
This is version {version} (`SUITE_VERSION`). The version changes when a pixel of any
valid frame changes, and every result row records it.

![The 12 corruptions at severities 0, 0.25, 0.5, 0.75 and 1](pictures/corruptions.jpg)

Apartment {seed}, one random draw: each row shows the same dirt, light or noise at growing
severity. In depth images, near is bright and missing depth is white.
`python -m tools.pages.gallery --page` writes this page and its pictures.

Related pages: [corruptions that no recipe trains on, and pairs](unseen-corruptions.md);
[corruptions of instructions](instructions.md); [how to apply them](corruption-entry-points.md).

## Formulas

W and H are the width and height of a view, side = min(H, W), x a pixel, z its depth in metres, U
the uniform and N the normal distribution. The values are read from the code.

"""
COLUMNS = (
    "name",
    "what fails",
    "formula",
    "source of constants",
    "constant in an episode",
    "sampled for each frame",
)
TEXT = """
**ELD** (Wei et al., TPAMI 2021) models a camera with little light. The image is linearised with
exponent {gamma:g} and darkened by {darkest:g}^s. Photon noise is Poisson, read noise is
Tukey-lambda, row noise is normal and common to the three channels of a row. The result is rounded
and brightened again, with a gain that grows with s. Samples come from tables ({levels} signal
levels of {photons} quantiles, {reads} quantiles of read noise), indexed by a hash of the pixel.
Tests compare them with a slow direct sampler.

A **random field** is white noise on a grid of {side} cells along the shorter side, smoothed by a
Gaussian with the given correlation length and resampled to the frame.

Code: `mitigate/corruptions/rgb.py`, `mitigate/corruptions/masks.py`,
`mitigate/corruptions/depth.py`, `mitigate/corruptions/eld.py`.

## Suites

`suite=NAME` selects the conditions of `mitigate evaluate`, `mitigate run` and the comparison
after a training. The files are in `conf/suite`. `conditions=[clean,flare]` lists conditions
directly.

{suites}

`white_box` needs an agent with a system prompt. Without it, `suite=all` has twelve corruptions of
frames and seven of instructions, 19 in total.

## Strength

![SSIM and PSNR of RGB, mean error of depth, against severity](pictures/severity-curves.png)

Four views of the same apartment, mean over {episodes} random draws. SSIM and PSNR compare with
the clean frame. Missing depth counts as 0 m. *Slip* is the largest decrease of the effect between
neighbours on a grid of {steps} severities; 0 means that the effect never decreases.

{table}

## Rules

- **Severity.** s = 0 returns a bit-exact copy. For a given draw, the effect never decreases at s
  = 0.1, 0.2, ... 1 (measured as SSIM and PSNR of RGB, mean absolute error of depth). Exception:
  `quantization` follows this rule on average only. Over 300 views of `val_unseen`, its mean error
  rises at each step, from 0.012 m at 0.1 to 0.126 m at 1, but 45 % of the views decrease at some
  step, by 0.015 m on average and 0.11 m at most.
- **Keys.** Every draw is a function of seed, episode, corruption, frame, view and pixel. A frame
  gets the same pixels in any batch, process or order, in training and in evaluation.
- **Panoramas.** The 12 views share lens and light. A flare appears only in views that face it.
  View k is assumed to look at yaw -30 k degrees, level. With 36 views in three elevations, the
  light has the same height in all three.
- **Size.** Lengths are fractions of the frame, so frames of different sizes are corrupted alike.
- **Invalid depth** (0, negative, NaN, infinite) is returned unchanged and does not affect its
  neighbours. Other depth is clipped to 0.001 m ... z_max.
- **Types.** RGB must be uint8. Float frames raise an error that names the conversion.

## Limits

- **ELD** approximates sRGB by exponent {gamma:g}, samples noise per channel and has no Bayer
  pattern. Clipping at 0 brightens dark areas, as in real cameras: the mean equals the mean of
  `low_light` within 1 % up to s = 0.6, and at 1 the view above is as bright as at 0.8.
- **Motion blur**: on a fine regular pattern, a longer line can have a smaller effect. On a fine
  grid SSIM rises by less than {blur_most:g} between neighbours on the chequered scene of the
  tests, and by at most {blur_slip} on the view above. A line below 1 px changes nothing.
- **Quantization**: depth that is a multiple of a coarse step does not change, although a finer
  step changes it. On a fine grid the mean error falls by less than {step_most:g} m between
  neighbours on the scene of the tests, and by at most {step_slip} m on the view above.
- **Missing data** writes `DepthSensor.missing` (0 m by default) into three quarters of the holes
  and z_max into the rest. Agents interpret 0 differently: R2R-CE agents as a hole, VLFM as far,
  L3MVN as the column's maximum. Set the value that your agent expects.
- **Defocus and motion blur** use fixed-point filters. Their mean error against exact filters is
  below 0.4 grey levels, most of it rounding.
- **Spatter** is opaque dirt without refraction. **Flare** is one glow without ghosts or streaks.
  **Multipath** searches for the farther surface in the image only.

## Use

```python
import numpy as np
from mitigate.corruptions import Key, corrupt

frame = np.zeros((480, 640, 3), np.uint8)
corrupted = corrupt(frame, "spatter", 0.6, key=Key(seed=0, episode="17", frame=3))
```

`corrupt_observation(obs, Corruption("missing_data", 0.6), key)` corrupts a dict with `rgb`,
`depth` and `pose`. Files, gymnasium, torchrl and Habitat: [Corrupt
data](corruption-entry-points.md).

In training, a `mitigate.corruptions.Schedule` selects the corruption of each frame: `clean`,
`per_frame` (a new draw for every frame), `per_episode`, or `success_distributed`. The paper
evaluates R2R at s = 0.6, RxR and HM3D at 0.5, and trains at 0.6, or at 0.9 (RGB) with 0.8
(depth).
"""


def page(curves: dict[str, Curve], seed: int) -> str:
    """Return the page as Markdown, with ``curves`` and the seed of the apartment in its
    pictures."""
    text = TEXT.format(
        gamma=eld.GAMMA,
        darkest=eld.DARKEST,
        levels=eld.LEVELS,
        photons=1 << eld.PHOTON_BITS,
        reads=1 << eld.READ_BITS,
        side=keying.FIELD_SIDE,
        episodes=EPISODES,
        steps=len(GRID),
        table=_strengths(curves),
        suites=suites(),
        blur_most=SLIPS["motion_blur"],
        step_most=SLIPS["quantization"],
        blur_slip=f"{curves['motion_blur'].slip:.1g}",
        step_slip=f"{curves['quantization'].slip:.1g}",
    )
    return HEAD.format(version=SUITE_VERSION, seed=seed) + formulas() + text


def suites() -> str:
    """Return a table of ``conf/suite`` with the name and first comment of each file."""
    rows = []
    for file in sorted((PACKAGE / "conf" / "suite").glob("*.yaml")):
        head = takewhile(lambda line: line.startswith("#"), file.read_text("utf-8").splitlines())
        rows.append([f"`{file.stem}`", " ".join(line[1:].strip() for line in head)])
    return markdown_table(["`suite=`", ""], rows, words=2)


def formulas(names: tuple[str, ...] = NAMES) -> str:
    """Return a table of the formulas of corruptions."""
    return markdown_table(COLUMNS, map(_cells, names), words=len(COLUMNS)) + "\n"


def _cells(name: str) -> tuple[str, ...]:
    entry = record(name)
    scopes = (scope if scope != "-" else "" for scope in (entry.episode, entry.frame))
    return (f"`{name}`", *DESCRIPTIONS[name], *scopes)


def _strengths(curves: dict[str, Curve]) -> str:
    rows = []
    for name in RGB:
        curve = curves[name]
        ssim, psnr = curve.ssim.mean(0), curve.psnr.mean(0)
        values = (f"{ssim[i]:.3f} / {psnr[i]:.1f}" for i in (len(psnr) // 2, -1))
        rows.append([f"`{name}`", "SSIM / PSNR (dB)", *values, f"{curve.slip:.1g}"])
    for name in DEPTH:
        error = curves[name].error.mean(0)
        values = (f"{error[i]:.3f}" for i in (len(error) // 2, -1))
        rows.append([f"`{name}`", "mean error (m)", *values, f"{curves[name].slip:.1g}"])
    return markdown_table(["corruption", "measure", "s = 0.5", "s = 1", "slip"], rows, words=2)
