"""Tests of reliability weights: only views with unusually small or large features lose weight."""

from __future__ import annotations

import pytest
import torch

from mitigate.agents.fusion import CAP, RATE, LearnedReliability, reliability, weigher
from mitigate.agents.topological.planner import Planner, collate
from mitigate.core import seeding
from mitigate.core.observation import VIEWS
from tests.agents.topological.test_planner import decision


def fuse(views: torch.Tensor, **how) -> tuple[torch.Tensor, torch.Tensor]:
    """Return the mean of the views weighted by reliability, and the weights."""
    weights = reliability(views, **how)
    return (views * weights.unsqueeze(-1)).sum(-2), weights


@pytest.fixture
def views() -> torch.Tensor:
    """Twelve views of one panorama with features of about the same magnitude."""
    torch.manual_seed(0)
    # views of the same room have similar features
    mixed = torch.randn(64) + 0.5 * torch.randn(12, 64)
    return torch.nn.functional.normalize(mixed, dim=-1) * 8


@pytest.mark.parametrize("factor", [0.0, 5.0])
def test_reliability_gives_outliers_the_smallest_weight(views, factor):
    damaged = views.clone()
    damaged[3] *= factor
    weights = reliability(damaged)
    others = weights[torch.arange(12) != 3]
    assert torch.isclose(weights.sum(), torch.tensor(1.0))
    size = damaged.norm(dim=-1)
    deviation = (size - size.mean()).abs() / size.mean()
    assert RATE * deviation[3] > CAP  # the view is so different that the cap limits its weight
    expected = CAP - RATE * deviation[torch.arange(12) != 3]
    assert torch.allclose(torch.log(others / weights[3]), expected, atol=1e-4)


@pytest.mark.parametrize("factor", [0.0, 5.0])
def test_reliability_fuses_closer_to_clean_than_the_mean(views, factor):
    clean, damaged = views.mean(0), views.clone()
    damaged[3] *= factor
    fused, _ = fuse(damaged)
    assert (fused - clean).norm() < (damaged.mean(0) - clean).norm()


def test_reliability_with_rate_zero_is_the_mean(views):
    fused, weights = fuse(views, rate=0.0)
    assert torch.allclose(fused, views.mean(0), atol=1e-6)
    assert torch.allclose(weights, torch.full((12,), 1 / 12))


def test_reliability_weighs_blank_views_equally():
    fused, weights = fuse(torch.zeros(2, 12, 8))
    assert torch.allclose(weights, torch.full((2, 12), 1 / 12)) and not fused.any()
    assert torch.isfinite(fused).all()


def test_reliability_gradients_are_finite_for_blank_views():
    x = torch.zeros(12, 8, requires_grad=True)
    fuse(x)[0].sum().backward()
    assert torch.isfinite(x.grad).all()


@pytest.mark.parametrize("bad", [{"rate": -1.0}, {"cap": -1.0}])
def test_reliability_rejects_negative_constants(views, bad):
    with pytest.raises(ValueError, match="must be >= 0"):
        reliability(views, **bad)


def test_learned_reliability_starts_with_equal_weights(views):
    torch.manual_seed(0)
    weights = LearnedReliability(64)(torch.stack([views, views * torch.arange(12)[:, None]]))
    assert torch.allclose(weights, torch.full((2, 12), 1 / 12))


def test_learned_reliability_learns_beyond_magnitudes():
    """If views are replaced by features of equal magnitude, the magnitude rule does not detect
    this, but a learned score does."""
    torch.manual_seed(0)
    # the features that broken views get
    marks = torch.nn.functional.normalize(torch.randn(8, 64), dim=-1)

    def draw() -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        mixed = torch.randn(32, 1, 64) + 0.5 * torch.randn(32, 12, 64)
        clean = torch.nn.functional.normalize(mixed, dim=-1)
        broken = torch.rand(32, 12) < 0.25
        observed = torch.where(broken[..., None], marks[torch.randint(8, (32, 12))], clean)
        return observed, clean.mean(1), broken

    learned = LearnedReliability(64)
    optimiser = torch.optim.Adam(learned.parameters(), lr=1e-2)
    for _ in range(150):
        observed, expected, _ = draw()
        fused = (observed * learned(observed).unsqueeze(-1)).sum(1)
        optimiser.zero_grad()
        (fused - expected).square().sum(-1).mean().backward()
        optimiser.step()
    observed, _, broken = draw()
    with torch.no_grad():
        weights, ruled = learned(observed), reliability(observed)
    assert weights[broken].mean() < 0.2 * weights[~broken].mean()
    assert ruled[broken].mean() > 0.9 * ruled[~broken].mean()
    least, most = weights.min(-1).values, weights.max(-1).values
    assert (most <= least * torch.tensor(2 * CAP).exp() * 1.001).all()


def test_weigher_rejects_rate_for_learned_reliability():
    with pytest.raises(ValueError, match="rate must be null .* got 4"):
        weigher(8, learned=True, rate=4)
    with pytest.raises(ValueError, match="must be >= 0"):
        weigher(8, learned=True, cap=-1)


def planner(fusion: dict | None) -> Planner:
    """Return an untrained planner with seeded weights, with or without fusion."""
    seeding.seed_everything(0, "planner")
    return Planner(8, 8, width=16, heads=2, text_layers=1, layers=1, fusion=fusion).eval()


@torch.no_grad()
def ghosts(fusion: dict | None, features: torch.Tensor, sightings: torch.Tensor) -> torch.Tensor:
    """Return the tokens of ghosts, which are waypoints that were seen but not visited.

    ``sightings`` [G, 4] contains the flat indices of the views that faced each ghost.
    """
    model, batch = planner(fusion), collate([decision(4)], [0], [0])
    batch.sightings[0, : len(sightings)] = sightings
    tokens = model.embed_views(features)
    weights = None if fusion is None else tokens[..., -1:]
    first = 1 + batch.nodes.shape[1]
    return model._tokens(tokens[..., :16], weights, batch)[0, first : first + len(sightings)]


@pytest.fixture
def features() -> torch.Tensor:
    """Return four panoramas in which every third view has larger features."""
    torch.manual_seed(0)
    model = torch.rand(4, VIEWS, sum(planner(None).widths))
    model[:, ::3] *= 3.0
    return model


def test_planner_with_equal_weights_takes_means(features):
    seen = torch.tensor([[0, 1, -1, -1], [14, -1, -1, -1], [3, 6, 9, 13]])
    plain = ghosts(None, features, seen)
    level = ghosts({"rate": 0.0, "cap": 3.0}, features, seen)
    assert torch.allclose(plain, level, atol=1e-5)


def test_planner_normalises_the_weights_of_ghosts(features):
    """If one view saw a ghost, it alone determines the token. If two views saw it, the more
    reliable one has more weight."""
    seen = torch.tensor([[0, -1, -1, -1], [1, -1, -1, -1], [0, 1, -1, -1]])
    plain = ghosts(None, features, seen)
    fused = ghosts({"rate": 4.0, "cap": 3.0}, features, seen)
    assert torch.allclose(fused[:2], plain[:2], atol=1e-5)
    assert not torch.allclose(fused[2], plain[2], atol=1e-3)


def test_planner_output_is_unchanged_by_untrained_reliability(features):
    """The initial values of the planner's other weights are also equal."""
    seen = torch.tensor([[0, 1, -1, -1], [14, -1, -1, -1], [3, 6, 9, 13]])
    plain, learned = planner(None), planner({"learned": True})
    others = {k: v for k, v in learned.state_dict().items() if not k.startswith("fusion.")}
    assert others.keys() == plain.state_dict().keys() and len(learned.state_dict()) > len(others)
    assert all(value.equal(others[name]) for name, value in plain.state_dict().items())
    level = ghosts({"learned": True}, features, seen)
    assert torch.allclose(ghosts(None, features, seen), level, atol=1e-5)


def test_planner_trains_its_learned_reliability():
    model, step = planner({"learned": True}), decision(3)
    looked = model.embed_views(torch.rand(3, VIEWS, sum(model.widths)))
    out = model(model.read(torch.tensor([[2, 3, 4]])), looked, collate([step], [0], [0]))
    out["nodes"].square().sum().backward()
    assert model.fusion.score.weight.grad.abs().sum() > 0


def test_planner_with_fusion_gives_finite_scores():
    model, step = planner({}), decision(3)
    tokens = torch.tensor([[2, 3, 4]])
    with torch.no_grad():
        looked = model.embed_views(torch.rand(3, VIEWS, sum(model.widths)))
        out = model(model.read(tokens), looked, collate([step], [0], [0]))
    assert looked.shape == (3, VIEWS, 17)
    assert torch.isfinite(out["logits"][0, 0]) and torch.isfinite(out["nodes"]).all()
