"""What each corruption is, in words: the table of ``python -m mitigate.corrupt --list``."""

from __future__ import annotations

from dataclasses import astuple, dataclass

from mitigate.corruptions.suite import DEPTH, NAMES, RGB


@dataclass(frozen=True)
class Entry:
    """One corruption: what severity s in [0, 1] sets, what is drawn once an episode and what anew
    for each frame ("-" for nothing), and where its form or constants come from."""

    severity: str
    episode: str
    frame: str
    source: str


CATALOGUE = {
    "motion_blur": Entry(
        "line of 0.10 s of the width, blended 0.5 + 0.5 s", "direction", "-", "ImageNet-C, NavTrust"
    ),
    "low_light": Entry(
        "loses s (0.60 to 0.97) of the light", "gradient", "-", "NavTrust, RobustNav, 3DCC"
    ),
    "low_light_noise": Entry(
        "low_light, then light / 300^s and gain", "gradient", "noise", "ELD, TPAMI 2021"
    ),
    "spatter": Entry(
        "covers 0.45 s of the frame, opacity 0.5 + 0.5 s", "mask, mud or water", "-", "ImageNet-C"
    ),
    "flare": Entry("brightness of the glow", "place, at a world yaw", "-", "NavTrust"),
    "defocus": Entry(
        "Gaussian, sigma 5 s px at 224 px", "width, +- 20 %", "-", "NavTrust, ImageNet-C"
    ),
    "foreign_object": Entry("disk of radius 0.5 s of the short side", "-", "-", "NavTrust"),
    "black_out": Entry("probability that a view is black", "-", "which views", "NavTrust"),
    "gaussian_noise": Entry("sd s (0.02 + 0.02 z^2) metres", "-", "noise", "D435 error model"),
    "missing_data": Entry(
        "loses 0.5 s of the pixels, a quarter reads far",
        "field",
        "offset, every 5 frames",
        "NavTrust, Zhang & Funkhouser 2018",
    ),
    "multipath": Entry(
        "strength 0.9 s of the echo beside edges", "-", "-", "Fuchs 2010, Jimenez 2014"
    ),
    "quantization": Entry("steps of 0.5 s metres", "-", "-", "NavTrust, Ideses 2007, Wei 2013"),
}
HEAD = ("name", "hurts", "severity s", "kept in an episode", "drawn each frame", "source")


def modality(name: str) -> str:
    """What the corruption ``name`` hurts: "rgb" or "depth"."""
    return "rgb" if name in RGB else "depth"


def table() -> str:
    """The catalogue as lines of aligned columns, a heading first."""
    rows = [HEAD, *((name, modality(name), *astuple(CATALOGUE[name])) for name in RGB + DEPTH)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
    return "\n".join(lines)


assert tuple(CATALOGUE) == NAMES
