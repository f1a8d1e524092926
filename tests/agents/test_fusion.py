"""Reliability weights: a view that is blank or inflated loses its say, and nothing else does."""

from __future__ import annotations

import pytest
import torch

from mitigate.agents.fusion import CAP, RATE, fuse, reliability


@pytest.fixture
def views() -> torch.Tensor:
    """Twelve views of one panorama with features of about the same magnitude."""
    torch.manual_seed(0)
    mixed = torch.randn(64) + 0.5 * torch.randn(12, 64)  # the views of one room have much in common
    return torch.nn.functional.normalize(mixed, dim=-1) * 8


@pytest.mark.parametrize("factor", [0.0, 5.0])
def test_a_blanked_or_inflated_view_falls_to_the_cap(views, factor):
    hurt = views.clone()
    hurt[3] *= factor
    weights = reliability(hurt)
    others = weights[torch.arange(12) != 3]
    assert weights[3] < others.min() and torch.isclose(weights.sum(), torch.tensor(1.0))
    exponent = -torch.log(weights[3] / others.mean()) + RATE * 0  # relative to a typical view
    assert exponent <= CAP + 1e-4


@pytest.mark.parametrize("factor", [0.0, 5.0])
def test_the_fused_vector_stays_closer_to_the_clean_one_than_the_mean(views, factor):
    clean, hurt = views.mean(0), views.clone()
    hurt[3] *= factor
    fused, _ = fuse(hurt)
    assert (fused - clean).norm() < (hurt.mean(0) - clean).norm()


def test_rate_zero_is_the_plain_mean(views):
    fused, weights = fuse(views, rate=0.0)
    assert torch.allclose(fused, views.mean(0), atol=1e-6)
    assert torch.allclose(weights, torch.full((12,), 1 / 12))


def test_views_that_are_all_blank_weigh_the_same():
    fused, weights = fuse(torch.zeros(2, 12, 8))
    assert torch.allclose(weights, torch.full((2, 12), 1 / 12)) and not fused.any()
    assert torch.isfinite(fused).all()


def test_views_that_are_not_valid_do_not_count(views):
    valid = torch.arange(12) < 4
    fused, weights = fuse(views, valid=valid)
    alone, _ = fuse(views[:4])
    assert torch.allclose(fused, alone, atol=1e-5) and not weights[4:].any()
    nothing = reliability(views, valid=torch.zeros(12, dtype=torch.bool))
    assert torch.allclose(nothing.sum(), torch.tensor(1.0))


def test_gradients_are_finite_for_blank_views():
    x = torch.zeros(12, 8, requires_grad=True)
    fuse(x)[0].sum().backward()
    assert torch.isfinite(x.grad).all()


@pytest.mark.parametrize("bad", [{"rate": -1.0}, {"cap": -1.0}])
def test_negative_constants_are_refused(views, bad):
    with pytest.raises(ValueError, match="at least 0"):
        reliability(views, **bad)
