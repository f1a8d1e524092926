"""In the severity curves every column is seen, also where another is the same."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from mitigate.evaluation import plots
from mitigate.evaluation.report import sections
from tests.evaluation.made_rows import cell, column

NAMES = ("one", "two", "three")


def grid(*falls: tuple[int, int]):
    """A column for each of ``falls``: of 10 episodes 8 are won clean, so many under missing data
    at 0.3 and at 0.6."""
    made = []
    for name, at in zip(NAMES, falls, strict=False):
        own = {"name": name, "agent": name.ljust(12, "0")}
        made += column(8, {"missing_data": at[0]}, 0.3, **own)
        made += cell(at[1], corruption="missing_data", severity=0.6, **own)
    return sections(made)[0].grid


def seen(picture: np.ndarray, index: int) -> int:
    """How many pixels have the colour of a column's line, above the legend."""
    colour = np.round(255 * np.array(plots.LINES[index][2::-1]))
    above = picture[: int(0.8 * len(picture))].astype(int)
    return int((np.abs(above - colour).max(axis=2) < 12).sum())


@pytest.mark.parametrize("falls", [(8, 8), (6, 3)])
def test_columns_that_are_the_same_are_all_seen(tmp_path, falls):
    picture = cv2.imread(str(plots.severity_curves(grid(*[falls] * 3), tmp_path / "curves.png")))
    found = [seen(picture, index) for index in range(3)]
    alone = cv2.imread(str(plots.severity_curves(grid(falls), tmp_path / "alone.png")))
    assert min(found) > 0.6 * seen(alone, 0) > 100


def wide(grid, monkeypatch) -> list[tuple[list[float], float]]:
    """Severities and width of what is drawn wider than a line is."""
    monkeypatch.setattr(plots, "_save", lambda figure, _: figure)
    lines = plots.severity_curves(grid, "").axes[0].get_lines()
    return [
        (list(line.get_xdata()), line.get_linewidth())
        for line in lines
        if line.get_linewidth() > plots.WIDTH
    ]


def test_only_the_piece_that_coincides_is_wider(monkeypatch):
    assert wide(grid((6, 3), (5, 2)), monkeypatch) == []
    found = wide(grid((6, 3), (6, 1)), monkeypatch)
    assert found == [([0.0, 0.3], plots.WIDTH + plots.RIM)]


def test_each_of_three_is_wider_than_what_lies_on_it(monkeypatch):
    found = wide(grid((6, 3), (6, 3), (6, 3)), monkeypatch)
    widths = [width for _, width in found]
    assert widths == [plots.WIDTH + k * plots.RIM for k in (2, 2, 1, 1)]
