"""Tests that severity curves show every column, even if two columns are equal."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from mitigate.evaluation import plots
from mitigate.evaluation.curves import curves
from mitigate.evaluation.report import sections
from tests.evaluation.made_rows import cell, column

NAMES = ("one", "two", "three")


def grid(*falls: tuple[int, int]):
    """Return a grid with one column per pair in ``falls``.

    In each column, 8 of 10 clean episodes succeed. The pair contains the numbers of successes under
    missing data at severity 0.3 and at severity 0.6.
    """
    output = []
    for name, at in zip(NAMES, falls, strict=False):
        settings = {"name": name, "agent": name.ljust(12, "0")}
        output += column(8, {"missing_data": at[0]}, 0.3, **settings)
        output += cell(at[1], corruption="missing_data", severity=0.6, **settings)
    return sections(output)[0].grid


def seen(picture: np.ndarray, index: int) -> int:
    """Return the number of pixels above the legend that have the colour of a column's line."""
    colour = np.round(255 * np.array(plots.LINES[index][2::-1]))
    above = picture[: int(0.8 * len(picture))].astype(int)
    return int((np.abs(above - colour).max(axis=2) < 12).sum())


@pytest.mark.parametrize("falls", [(8, 8), (6, 3)])
def test_severity_curves_show_coinciding_columns(tmp_path, falls):
    picture = cv2.imread(str(plots.severity_curves(grid(*[falls] * 3), tmp_path / "curves.png")))
    alone = cv2.imread(str(plots.severity_curves(grid(falls), tmp_path / "alone.png")))
    assert min(seen(picture, index) for index in range(3)) > 0.1 * seen(alone, 0) > 10


def test_curve_points_share_seeds_and_episodes():
    rows = column(8, {"missing_data": 6}, 0.3) + cell(3, 4, corruption="missing_data", severity=0.6)
    (curve,) = curves(sections(rows)[0].grid, "missing_data")
    assert curve.count == 4 and curve.severities == [0.0, 0.3, 0.6]
    assert [estimate.value for estimate in curve.points] == [1.0, 1.0, 0.75]


def test_curves_average_seeds_that_were_measured_at_other_severities():
    rows = []
    for seed, (at, falls) in enumerate([(0.4, 6), (0.6, 2)]):
        rows += column(8, {"missing_data": falls}, at, seed=seed)
        rows += cell(0, corruption="missing_data", severity=1.0, seed=seed)
    (curve,) = curves(sections(rows)[0].grid, "missing_data")
    assert curve.severities == [0.0, 0.4, 0.6, 1.0] and curve.count == 10
    # seed 0 has 0.8, 0.6, 0.4 and 0; seed 1 has 0.8, 0.4, 0.2 and 0
    assert [point.value for point in curve.points] == pytest.approx([0.8, 0.5, 0.3, 0.0])
