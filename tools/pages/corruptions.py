"""Generate the page ``docs/corruptions.md`` with formulas, scopes and limits."""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

from mitigate.core.files import PACKAGE
from mitigate.core.markdown import markdown_table
from mitigate.corruptions import eld, keying
from mitigate.corruptions.registry import record
from mitigate.corruptions.suite import DEPTH, NAMES, RGB, SUITE_VERSION
from tools.pages.curves import EPISODES, GRID, SLIPS, Curve
from tools.pages.descriptions import DESCRIPTIONS

TEMPLATE = Path(__file__).with_suffix(".md")  # the template: names in braces are replaced by values
COLUMNS = (
    "name",
    "what fails",
    "formula",
    "source of constants",
    "constant in an episode",
    "sampled for each frame",
)


def page(curves: dict[str, Curve], seed: int) -> str:
    """Return the page as Markdown; ``curves`` are the measured curves, and ``seed`` selects the
    apartment in the pictures.
    """
    return TEMPLATE.read_text("utf-8").format(
        version=SUITE_VERSION,
        seed=seed,
        formulas=formulas(),
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


def suites() -> str:
    """Return a table with the name and the first comment of each file in ``conf/suite``."""
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
    cells = (*DESCRIPTIONS[name], *scopes)
    return (f"`{name}`", *(cell.replace("|", "\\|") for cell in cells))


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
