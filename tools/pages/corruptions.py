"""The page ``docs/corruptions.md``: formulas with the constants of the code, scopes, limits."""

from __future__ import annotations

from itertools import takewhile

from mitigate.core.files import PACKAGE
from mitigate.core.markdown import markdown_table
from mitigate.corruptions import eld, keying
from mitigate.corruptions.registry import record
from mitigate.corruptions.suite import DEPTH, NAMES, RGB, SUITE_VERSION
from tools.pages.curves import EPISODES, GRID, Curve

HEAD = """# The corruption suite

Twelve ways in which an RGB-D camera fails, each with a severity s from 0 to 1. Version {version}
(`SUITE_VERSION`; it changes when any pixel of a frame within the rules below changes, and every
result row carries it).

![The 12 corruptions at severities 0, 0.25, 0.5, 0.75 and 1](pictures/corruptions.jpg)

One view of apartment {seed}, one random draw for the whole sheet: every row is the same dirt, light
or noise at growing strength. Depth: near is bright, no reading is white. This page and its pictures
are written by `python -m tools.pages.gallery --page`.

Agents are also measured under corruptions that no recipe trains on, and under two at once:
[unseen-corruptions.md](unseen-corruptions.md).

## Formulas

W and H are a view's width and height, side = min(H, W), x a pixel, z its depth in metres, U
uniform, N normal. The numbers are read from the code.

"""
COLUMNS = (
    "name",
    "what fails",
    "formula",
    "constants from",
    "kept through an episode",
    "drawn for each frame",
)
TEXT = """
**ELD** (Wei et al., TPAMI 2021): light is linearised by a power of {gamma:g} and cut by
{darkest:g}^s; photons are Poisson, read noise Tukey-lambda, row noise normal and common to a
row's three channels, and the result is rounded and brightened back. The camera's gain rises with
s. Samples come from tables ({levels} signal levels of {photons} quantiles, {reads} quantiles of
read noise) that a hash of the pixel indexes; tests hold them against a slow direct sampler.

A random field is white noise on a grid of {side} cells along the shorter side, smoothed by a
Gaussian of the stated correlation and resampled to the frame. Constants of our own stand in the
code with the rest: `mitigate/corruptions/rgb.py`, `mitigate/corruptions/masks.py`,
`mitigate/corruptions/depth.py`, `mitigate/corruptions/eld.py`.

## Suites

`suite=NAME` of an evaluation, a training's comparison or `mitigate run` says which conditions are
met (`conf/suite`); `conditions=[clean,flare]` names them one by one.

{suites}

Of the eight conditions of instructions `white_box` is for agents with a system prompt, so tables of
ours have twelve corruptions of frames and seven of instructions, 19 in all.

## How much it corrupts

![SSIM and PSNR of RGB, mean error of depth, against severity](pictures/severity-curves.png)

Four views of the same apartment, mean over {episodes} random draws. SSIM and PSNR compare with
the clean frame; the depth error counts a lost reading as 0 m. *Slip* is the largest step against
the rule "more s never changes less" between neighbours on the fine grid of {steps} severities.

{table}

## Rules

- s = 0 returns a bit-exact copy; on one draw, s = 0.1, 0.2, ... 1 never changes less (SSIM and PSNR
  of RGB, mean absolute error of depth). Between them, see *slip* above. `quantization` keeps this
  rule on average alone: over 300 views of `val_unseen` the mean error rises at each of these steps,
  from 0.012 m at 0.1 to 0.126 m at 1, and 45 % of the views fall at one or more of them, by 0.015 m
  in the mean and 0.11 m at most.
- Every draw is a function of (seed, episode, corruption, frame, view, pixel): the same frame gets
  the same pixels in any batch, process or order, in training and in evaluation.
- The 12 views of a panorama share lens and light; only the views that face a flare show it. View k
  of any number is taken to look at yaw -30 k degrees and level: of 36 views in three elevations the
  light stands at the same height in all three.
- Lengths are shares of the frame, so a frame and its half-size copy are corrupted alike.
- Invalid depth (0, negative, NaN, infinite) comes back as it was and takes no part in a
  neighbourhood; other depth is clipped to 0.001 m ... z_max.
- RGB must be uint8: float frames are refused with the conversion to use.

## Known limits

- **ELD** treats sRGB as a power of {gamma:g}, draws noise for each channel and knows no Bayer
  pattern. Clipping at 0 brightens deep shadows, as real cameras do: the mean is that of
  `low_light` within 1 % up to s = 0.6, and at 1 the view above is as bright as at 0.8.
- **Motion blur**: the response of a line to a fine regular pattern has side lobes, so that a longer
  line can change it less. On a fine grid SSIM rises by less than {blur_most:g} between neighbours
  on the chequered scene of the tests, and by at most {blur_slip} on the view above. A line under
  1 px changes nothing.
- **Quantization**: depth at a multiple of a coarse step is not changed by it, though it was by a
  finer one. On a fine grid the mean error falls by less than {step_most:g} m between neighbours
  on the scene of the tests, and by at most {step_slip} m on the view above.
- **Missing data** writes `DepthSensor.missing`, 0 m by default, into three quarters of the holes
  and z_max into the rest. Agents disagree on 0: R2R-CE agents take it for a hole, VLFM for far,
  L3MVN for the column's maximum. Set the sentinel that the agent knows.
- **Defocus and motion blur** are fixed-point filters; their mean error against exact ones is
  under 0.4 grey levels, most of it rounding.
- **Spatter** is opaque dirt without refraction; **flare** is one glow without ghosts or streaks;
  **multipath** looks for the farther surface in the image alone.

## Use

```python
import numpy as np
from mitigate.corruptions import Key, corrupt

frame = np.zeros((480, 640, 3), np.uint8)
corrupted = corrupt(frame, "spatter", 0.6, key=Key(seed=0, episode="17", frame=3))
```

Folders of files, gymnasium, torchrl and Habitat:
[corruption-entry-points.md](corruption-entry-points.md).

`corrupt_observation(obs, Corruption("missing_data", 0.6), key)` does the same to a dict with
`rgb`, `depth` and `pose`. Which frame meets which corruption during training is a
`mitigate.corruptions.Schedule`: `clean`, `per_frame` (a new episode key for every frame),
`per_episode`, or `success_distributed`. The paper evaluates R2R at s = 0.6, RxR and HM3D at 0.5,
and trains at 0.6 or at 0.9 (RGB) with 0.8 (depth).
"""


def page(found: dict[str, Curve], seed: int) -> str:
    """The page as Markdown; ``found`` are the curves, ``seed`` names the apartment shown."""
    text = TEXT.format(
        gamma=eld.GAMMA,
        darkest=eld.DARKEST,
        levels=eld.LEVELS,
        photons=1 << eld.PHOTON_BITS,
        reads=1 << eld.READ_BITS,
        side=keying.FIELD_SIDE,
        episodes=EPISODES,
        steps=len(GRID),
        table=_strengths(found),
        suites=suites(),
        blur_most=record("motion_blur").slip,
        step_most=record("quantization").slip,
        blur_slip=f"{found['motion_blur'].slip:.1g}",
        step_slip=f"{found['quantization'].slip:.1g}",
    )
    return HEAD.format(version=SUITE_VERSION, seed=seed) + formulas() + text


def suites() -> str:
    """A table of ``conf/suite``: the name of each file and the comment at its head."""
    rows = []
    for file in sorted((PACKAGE / "conf" / "suite").glob("*.yaml")):
        head = takewhile(lambda line: line.startswith("#"), file.read_text("utf-8").splitlines())
        rows.append([f"`{file.stem}`", " ".join(line[1:].strip() for line in head)])
    return markdown_table(["`suite=`", ""], rows, words=2)


def formulas(names: tuple[str, ...] = NAMES) -> str:
    """A table of the formulas of corruptions."""
    return markdown_table(COLUMNS, map(_cells, names), words=len(COLUMNS)) + "\n"


def _cells(name: str) -> tuple[str, ...]:
    entry = record(name)
    scopes = (scope if scope != "-" else "" for scope in (entry.episode, entry.frame))
    return (f"`{name}`", entry.fails, entry.formula, entry.sources, *scopes)


def _strengths(found: dict[str, Curve]) -> str:
    rows = []
    for name in RGB:
        curve = found[name]
        ssim, psnr = curve.ssim.mean(0), curve.psnr.mean(0)
        values = (f"{ssim[i]:.3f} / {psnr[i]:.1f}" for i in (len(psnr) // 2, -1))
        rows.append([f"`{name}`", "SSIM / PSNR (dB)", *values, f"{curve.slip:.1g}"])
    for name in DEPTH:
        error = found[name].error.mean(0)
        values = (f"{error[i]:.3f}" for i in (len(error) // 2, -1))
        rows.append([f"`{name}`", "mean error (m)", *values, f"{found[name].slip:.1g}"])
    return markdown_table(["corruption", "measure", "s = 0.5", "s = 1", "slip"], rows, words=2)
