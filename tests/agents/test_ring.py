"""Tests of ring adapters: neighbouring views are warped by the rotation of the camera."""

from __future__ import annotations

import pytest
import torch

from mitigate.agents.adapter_layers import RingAdapter, neighbour_grid
from mitigate.core.observation import HFOV_DEGREES, VIEW_STEP_DEGREES, VIEWS
from mitigate.worlds.apartments.renderer import Renderer
from mitigate.worlds.apartments.simulator import apartment_of


@pytest.fixture(scope="module")
def panorama():
    """Return the RGB of a rendered panorama, float [12, 3, 64, 64]."""
    apartment = apartment_of("apartments/train/000003")
    renderer = Renderer(64)
    renderer.load(apartment)
    x, y = apartment.space.centre(len(apartment.space.cells) // 2)
    rgb, _, _ = renderer.render(float(x), float(y), 0.3)
    return torch.from_numpy(rgb).permute(0, 3, 1, 2).float()


def test_aligned_warps_neighbours_into_the_view(panorama):
    grid = neighbour_grid(64, 64, VIEW_STEP_DEGREES, HFOV_DEGREES)
    seen = (grid.abs() <= 1).all(-1)
    aligned = RingAdapter(3).aligned(panorama, grid)
    for side in (0, 1):
        error = (aligned[side + 1] - panorama).abs().mean(1)[:, seen[side]]
        plain = (panorama.roll(1 - 2 * side, 0) - panorama).abs().mean(1)[:, seen[side]]
        assert error.median() < 2 and error.mean() < 0.25 * plain.mean()
        # neighbouring views overlap by 60 of 90 degrees, except in the corners
        assert 0.5 < seen[side].float().mean() < 0.7


def test_ring_keeps_cells_that_no_neighbour_sees():
    torch.manual_seed(0)
    # views of 90 degrees that are 120 degrees apart do not overlap
    adapter = RingAdapter(8, views=3)
    torch.nn.init.constant_(adapter.share.bias, 3.0)  # use the full budget
    x = torch.randn(6, 8, 4, 4)
    assert torch.allclose(adapter(x), x, atol=1e-6)


def test_ring_restores_a_lost_view(panorama):
    """If the score ignores black cells, the neighbours of a black view must restore it."""
    adapter = RingAdapter(3, reduction=1)
    with torch.no_grad():
        adapter.down.weight.zero_()
        adapter.down.weight[0, :, 0, 0] = 1.0
        adapter.score.weight[0, 0] = 1.0
        adapter.share.bias.fill_(10.0)
    lost = panorama.clone()
    lost[4] = 0
    matches = adapter(lost)[4]
    known = (neighbour_grid(64, 64, VIEW_STEP_DEGREES, HFOV_DEGREES).abs() <= 1).all(-1).any(0)
    error = (matches - panorama[4]).abs().mean(0)[known]
    assert error.median() < 3 and error.mean() < 0.2 * panorama[4].mean()


@pytest.mark.parametrize("wrong", [{"views": 2}, {"kernel": 2}, {"hfov": 180}, {"reduction": 0}])
def test_ring_rejects_invalid_arguments(wrong):
    with pytest.raises(ValueError, match="of a ring adapter must be"):
        RingAdapter(8, **wrong)


def test_ring_rejects_another_number_of_views():
    adapter = RingAdapter(8)
    with pytest.raises(RuntimeError):
        adapter(torch.zeros(VIEWS + 1, 8, 4, 4))
