"""Planner training on stored features: what is stored does not depend on who is blind."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import torch

from mitigate.agents.topological import TopologicalAgent
from mitigate.core import seeding
from mitigate.recipes.imitate_stored import ImitateStored
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld

SCENE = "apartments/train/000000"
SMALL = {"heads": 2, "text_layers": 1, "layers": 1}


def recipe(folder, blind: tuple[str, ...] = (), size: int = 64, own: int = 64) -> ImitateStored:
    seeding.seed_everything(0, "agent")
    agent = TopologicalAgent(16, SMALL, blind=blind, size=own)
    world = partial(ApartmentsWorld, size, 1)
    made = ImitateStored(agent, world, DrawnEpisodes(1), str(folder), steps=2, episodes=2)
    made.start()
    return made


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("features")


def spread(made: ImitateStored) -> tuple[float, float]:
    """How much the RGB and the depth features of the stored poses differ."""
    views, depth = (
        made.store.features(SCENE).views.astype(np.float32),
        made.agent.planner.widths[-1],
    )
    return float(views[..., :-depth].std(0).mean()), float(views[..., -depth:].std(0).mean())


def test_a_blind_run_leaves_whole_features_to_the_next(folder):
    """The blind one comes first and fills the cache."""
    assert spread(recipe(folder, ("rgb",)))[0] == 0.0
    seeing, deaf = recipe(folder), recipe(folder, ("instruction",))
    assert seeing.store.folder == deaf.store.folder and min(spread(seeing)) > 0
    assert np.array_equal(seeing.store.features(SCENE).views, deaf.store.features(SCENE).views)
    assert spread(recipe(folder, ("depth",)))[1] == 0.0


def test_views_of_another_size_are_stored_apart(folder):
    made = [recipe(folder, size=n, own=own) for n, own in ((64, 64), (32, 64), (32, 32))]
    assert len({recipe.store.folder for recipe in made}) == 3


def test_a_batch_trains_the_planner_alone(folder):
    made = recipe(folder)
    losses = made(made.batch(0))
    losses["loss"].backward()
    moved = {n.partition(".")[0] for n, p in made.agent.named_parameters() if p.grad is not None}
    assert moved == {"planner"} and torch.isfinite(losses["loss"])
