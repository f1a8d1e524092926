"""Tests that the metrics equal the metrics of VLN-CE, and that PRS equals the numbers in the
paper's table."""

from __future__ import annotations

import gzip
import json
import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitigate.evaluation.metrics import prs
from mitigate.worlds.episodes import read_episodes
from mitigate.worlds.measures import RULES, Rule, dtw, ndtw, path_length, spl
from tests.r2r_ce import FOLDER, needs_r2r_ce

success = RULES["vln_ce"].met

LINE = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)]


def recursive_dtw(path, reference):
    """Compute DTW recursively by its definition: add each distance to the cheapest of three
    predecessors."""

    @cache
    def cost(i, j):
        if i < 0 or j < 0:
            return 0.0 if i == j == -1 else math.inf
        before = min(cost(i - 1, j - 1), cost(i - 1, j), cost(i, j - 1))
        return math.dist(path[i], reference[j]) + before

    return cost(len(path) - 1, len(reference) - 1)


def every_alignment(path, reference, i=0, j=0):
    """Yield the cost of each monotone alignment of two paths."""
    here = math.dist(path[i], reference[j])
    if (i, j) == (len(path) - 1, len(reference) - 1):
        yield here
    for a, b in ((i + 1, j), (i, j + 1), (i + 1, j + 1)):
        if a < len(path) and b < len(reference):
            yield from (here + rest for rest in every_alignment(path, reference, a, b))


def vlnce_ndtw(path, reference, threshold=3.0):
    """Compute nDTW as VLN-CE does, without recording repeated positions."""
    recorded = [path[0]] + [b for a, b in pairwise(path) if tuple(a) != tuple(b)]
    recorded, reference = [tuple(map(tuple, points)) for points in (recorded, reference)]
    return math.exp(-recursive_dtw(recorded, reference) / (len(reference) * threshold))


def walked(path):
    return sum(math.dist(a, b) for a, b in pairwise(path))


@pytest.mark.parametrize(
    ("distance", "stopped", "expected"),
    [(2.999, True, True), (3.0, True, False), (0.0, False, False), (math.inf, True, False)],
)
def test_success_is_stop_strictly_within_the_threshold(distance, stopped, expected):
    assert success(distance, stopped) is expected


def test_ndtw_threshold_scales():
    assert not Rule("vln", 2).met(2.5, True)
    assert str(Rule("vln", 2)) == "vln: STOP and geodesic < 2.0 m"
    with pytest.raises(ValueError, match="got nan"):
        success(math.nan, True)


def test_spl_divides_by_the_longer_length():
    assert spl(True, 10.0, 12.5) == pytest.approx(0.8)
    # a path on the grid may be shorter than the stored geodesic distance
    assert spl(True, 10.0, 9.0) == 1.0
    assert spl(False, 10.0, 10.0) == 0.0
    assert spl(True, 0.0, 0.0) == 1.0
    for wrong in (math.nan, math.inf, -1.0):
        with pytest.raises(ValueError, match="geodesic distance of SPL must be finite"):
            spl(True, wrong, 1.0)


def test_path_length_is_the_sum_of_its_steps():
    assert path_length([(0, 0), (3, 4), (3, 4), (3, 5)]) == 6.0
    assert path_length([(1, 2, 3)]) == 0.0


def test_dtw_of_a_shifted_line_is_the_shift():
    shifted = np.array(LINE) + (0.0, 0.5)
    assert dtw(shifted, LINE) == pytest.approx(4 * 0.5)
    assert ndtw(shifted, LINE) == pytest.approx(math.exp(-2.0 / (4 * 3.0)))
    assert ndtw(shifted, LINE, threshold=2.0) == pytest.approx(math.exp(-2.0 / (4 * 2.0)))


points = st.lists(st.tuples(*[st.integers(-5, 5).map(float)] * 2), min_size=1, max_size=5)


@settings(max_examples=60, deadline=None)
@given(points, points)
def test_dtw_is_the_cheapest_of_all_alignments(path, reference):
    assert dtw(path, reference) == pytest.approx(min(every_alignment(path, reference)))


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (1, 9), (9, 1), (40, 23), (23, 40)])
def test_dtw_is_exact_on_long_paths(rows, columns):
    generator = np.random.default_rng(rows)
    a, b = (tuple(map(tuple, generator.normal(size=(n, 3)))) for n in (rows, columns))
    assert dtw(a, b) == pytest.approx(recursive_dtw(a, b), rel=1e-12)
    assert dtw(a, b) == pytest.approx(dtw(b, a), rel=1e-12)


def test_turning_in_place_costs_nothing():
    turning = [LINE[0], LINE[0], *LINE[1:], LINE[-1], LINE[-1]]
    assert ndtw(turning, LINE) == 1.0
    aside = [(0.0, 1.0), *LINE]
    assert ndtw([aside[0], *aside], LINE) == ndtw(aside, LINE) < 1.0


def test_paths_that_cannot_be_compared_are_refused():
    with pytest.raises(ValueError, match=r"with N > 0, got \(0,\)"):
        dtw([], LINE)
    with pytest.raises(ValueError, match="must have 2 or 3 coordinates, got 2 and 3"):
        dtw(LINE, [(0, 0, 0)])
    with pytest.raises(ValueError, match="got NaN"):
        path_length([(0, math.nan)])


# Table II of the paper: success rates (%) of the mitigation strategies, and their published PRS-SR
TABLE_II = {
    "Adap.": ((16, 22, 30, 16, 24, 14, 21, 26), 0.33, (55, 54, 62, 60), 0.89),
    "DA PF (0.6)": ((52, 62, 58, 59, 62, 51, 59, 58), 0.89, (33, 51, 31, 59), 0.67),
    "DA PE (0.6)": ((66, 62, 55, 62, 60, 60, 60, 52), 0.92, (59, 25, 43, 61), 0.72),
    "DA SD (0.6)": ((60, 59, 64, 58, 64, 61, 59, 59), 0.93, (38, 32, 56, 63), 0.73),
    "DA PE (0.9/0.8)": ((66, 62, 60, 55, 63, 62, 62, 57), 0.94, (42, 29, 62, 63), 0.75),
    "T-S distil.": ((62, 61, 55, 66, 56, 59, 61, 61), 0.93, (42, 66, 61, 52), 0.85),
}
CLEAN_SR = 65  # SR of ETPNav on R2R without corruption, from the paper's results on quantization


@pytest.mark.parametrize("strategy", TABLE_II)
def test_prs_reproduces_the_papers_table(strategy):
    rgb, prs_rgb, depth, prs_depth = TABLE_II[strategy]
    assert prs(CLEAN_SR, rgb) == pytest.approx(prs_rgb, abs=0.00501)  # printed to two digits
    assert prs(CLEAN_SR, depth) == pytest.approx(prs_depth, abs=0.00501)


def test_prs_is_not_clipped():
    assert prs(0.5, [0.6, 0.6]) == pytest.approx(1.2)
    assert math.isnan(prs(0.0, [0.0, 0.0]))
    with pytest.raises(ValueError, match="one value per corruption"):
        prs(0.5, [])


@pytest.fixture(scope="module")
def real_paths():
    with gzip.open(FOLDER / "val_seen_gt.json.gz") as file:
        truths = json.load(file)
    return [
        (e, np.array(truths[e.episode_id]["locations"]))
        for e in read_episodes(FOLDER / "val_seen.json.gz")
    ]


@needs_r2r_ce
def test_real_ground_truth_paths_score_as_vlnce_defines(real_paths):
    for episode, path in real_paths:
        assert ndtw(path, path) == 1.0
        # the last 0.5 m of these paths have no stairs
        left = math.dist(path[-1], episode.goals[0].position)
        won = success(left, True)
        assert won and not success(left, False)
        longest = max(episode.geodesic_distance, walked(path))
        assert path_length(path) == pytest.approx(walked(path), rel=1e-12)
        expected = episode.geodesic_distance / longest
        assert spl(won, episode.geodesic_distance, path_length(path)) == pytest.approx(expected)


def perturbed(path, kind, generator):
    """Return a variant of ``path`` that an agent might take, such as a noisy one."""
    if kind == "noisy":
        return path + generator.normal(0, 0.3, path.shape) * (1, 0, 1)
    if kind == "turning":
        return np.repeat(path, generator.integers(1, 5, len(path)), axis=0)
    if kind == "stopped early":
        return path[: max(1, len(path) // 2)]
    if kind == "beside":
        return path + (0.0, 0.0, 1.0)
    if kind == "there and back":
        return np.concatenate([path, path[-2::-1]])
    detour = np.linspace(path[-1], path[-1] + (2.0, 0.0, 0.0), 9)
    return np.concatenate([path, detour, detour[::-1]])


@needs_r2r_ce
@pytest.mark.parametrize(
    "kind", ["noisy", "turning", "stopped early", "beside", "there and back", "detour"]
)
def test_perturbed_real_paths_score_what_vlnces_formulas_give(real_paths, kind):
    generator = np.random.default_rng(0)
    for episode, path in real_paths[::60]:
        agent = perturbed(path, kind, generator)
        assert ndtw(agent, path) == pytest.approx(vlnce_ndtw(agent, path), rel=1e-9)
        left = math.dist(agent[-1], episode.goals[0].position)
        won = success(left, True)
        assert won == (left < 3.0)
        geodesic = episode.geodesic_distance
        expected = float(won) * geodesic / max(geodesic, walked(agent))
        assert spl(won, geodesic, path_length(agent)) == pytest.approx(expected)
        if kind == "turning":
            assert ndtw(agent, path) == 1.0 and won
        if kind == "detour":
            assert won and expected == pytest.approx(
                min(1.0, geodesic / max(geodesic, walked(path) + 4.0))
            )
        if kind == "there and back":
            assert won == (math.dist(path[0], episode.goals[0].position) < 3.0)


@needs_r2r_ce
def test_ndtw_falls_with_distance_from_the_route(real_paths):
    for _, path in real_paths[::20]:
        scores = [ndtw(path + (0.0, 0.0, shift), path) for shift in (0.0, 0.5, 1.0, 2.0, 4.0)]
        assert scores[0] == 1.0
        assert all(a > b for a, b in pairwise(scores))
