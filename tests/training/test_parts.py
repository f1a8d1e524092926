"""Tests that only the chosen parts of an agent are trained, and that other parts keep their
weights."""

from __future__ import annotations

import torch
from torch import nn

from mitigate.agents.adapters import backbone_sha, insert_adapters
from mitigate.training.parts import hold_statistics


def test_hold_statistics_keeps_weightless_normalisation_in_training():
    model = nn.Sequential(
        nn.Sequential(nn.BatchNorm1d(4, affine=False), nn.ReLU()), nn.Linear(4, 2)
    )
    hold_statistics(model.train())
    assert model[0][0].training
    model.requires_grad_(False)
    hold_statistics(model.train())
    assert not model[0][0].training


def test_hold_statistics_ignores_adapters():
    block = nn.Sequential(nn.Conv2d(3, 8, 3), nn.BatchNorm2d(8, affine=False), nn.ReLU())
    model = nn.Sequential(block)
    insert_adapters(model, ["0"])
    before = backbone_sha(model)
    hold_statistics(model.train())
    model(torch.randn(2, 3, 8, 8))
    assert backbone_sha(model) == before
