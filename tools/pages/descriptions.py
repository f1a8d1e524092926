"""Read the contents of tables in the docs: what each corruption models, its formula and its
sources.

The texts are in ``descriptions.yaml``, with names of constants in braces. A name refers to a
constant of a module (``{rgb.BLUR_LENGTH:g}``) or to a value in ``DERIVED``.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import yaml

from mitigate.core.observation import HFOV_DEGREES
from mitigate.corruptions import depth, eld, masks, rgb
from mitigate.corruptions.faults import camera, motion, temporal
from mitigate.corruptions.unseen import calibration, codec, edges, light, optics, returns, signal


class Description(NamedTuple):
    """The table cells that describe a corruption in the documentation.

    Attributes:
        fails: the real failure that the corruption models.
        formula: Markdown formula with the constants of the code.
        sources: sources of the constants.
    """

    fails: str
    formula: str
    sources: str


MODULES = (
    *(depth, eld, masks, rgb, calibration, codec, edges, light, optics, returns, signal),
    *(camera, motion, temporal),
)
DERIVED = {
    "defocus_low": 1 - rgb.DEFOCUS_SPREAD,
    "defocus_high": 1 + rgb.DEFOCUS_SPREAD,
    "far_percent": 100 * depth.FAR_SHARE,
    "echo_megahertz": depth.ECHO_HERTZ / 1e6,
    "cast_stops": 0.5 * light.CAST,
    "tint_stops": 0.5 * light.CAST * light.TINT,
    "haze_correlations": ", ".join(f"{correlation:g}" for correlation, _ in light.HAZE_OCTAVES),
    "haze_weights": ", ".join(f"{weight:g}" for _, weight in light.HAZE_OCTAVES),
    "stops_low": 1 - light.STOPS_SPREAD,
    "stops_high": 1 + light.STOPS_SPREAD,
    "block_sides": ", ".join(map(str, codec.BLOCKS)),
    "wiggle_megahertz": calibration.WIGGLE_HERTZ / 1e6,
    "HFOV_DEGREES": HFOV_DEGREES,
}


def read_descriptions() -> dict[str, Description]:
    """Read the texts and insert the constants."""
    values = {module.__name__.rsplit(".", 1)[1]: module for module in MODULES} | DERIVED
    texts = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text("utf-8"))
    return {
        name: Description(**{cell: text.format(**values) for cell, text in cells.items()})
        for name, cells in texts.items()
    }


DESCRIPTIONS = read_descriptions()
