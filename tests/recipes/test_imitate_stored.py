"""Tests of training on stored features. The stored features must be the same whether or not the run
blanks a sensor."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import torch

from mitigate.agents.topological import TopologicalAgent, stored
from mitigate.core import seeding
from mitigate.corruptions import Schedule
from mitigate.recipes.imitate_stored import ImitateStored
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.tiny import assemble

SCENE = "apartments/train/000000"
SMALL = {"heads": 2, "text_layers": 1, "layers": 1}


def recipe(
    folder, blind: tuple[str, ...] = (), size: int = 64, agent_size: int = 64
) -> ImitateStored:
    seeding.seed_everything(0, "agent")
    agent = TopologicalAgent(16, SMALL, blind=blind, size=agent_size)
    world = partial(ApartmentsWorld, size, 1)
    objective = assemble(
        ImitateStored,
        agent,
        world=world,
        training=DrawnEpisodes(1),
        folder=str(folder),
        steps=2,
        episodes=2,
    )
    objective.start()
    return objective


@pytest.fixture(autouse=True, scope="module")
def few_poses():
    """Store features at only a sixteenth of the poses."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stored, "SPACING", 2.0)
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("features")


def spread(output: ImitateStored) -> tuple[float, float]:
    """Return the standard deviation over poses of the stored RGB features and of the stored depth
    features."""
    views, depth = (
        output.rollouts.store.features(SCENE).views.astype(np.float32),
        output.agent.planner.widths[-1],
    )
    return float(views[..., :-depth].std(0).mean()), float(views[..., -depth:].std(0).mean())


def test_blind_run_stores_whole_features_for_the_next(folder):
    """The run that blanks a sensor comes first and fills the cache."""
    assert spread(recipe(folder, ("rgb",)))[0] == 0.0
    seeing, deaf = recipe(folder), recipe(folder, ("instruction",))
    assert seeing.rollouts.store.folder == deaf.rollouts.store.folder and min(spread(seeing)) > 0
    assert np.array_equal(
        seeing.rollouts.store.features(SCENE).views, deaf.rollouts.store.features(SCENE).views
    )
    assert spread(recipe(folder, ("depth",)))[1] == 0.0


@pytest.mark.slow
def test_views_of_another_size_are_stored_apart(folder):
    objective = [recipe(folder, size=n, agent_size=m) for n, m in ((64, 64), (32, 64), (32, 32))]
    assert len({recipe.rollouts.store.folder for recipe in objective}) == 3


def test_batch_trains_the_planner_only(folder):
    objective = recipe(folder)
    losses = objective(objective.batch(0))
    losses["loss"].backward()
    moved = {
        n.partition(".")[0] for n, p in objective.agent.named_parameters() if p.grad is not None
    }
    assert moved == {"planner"} and torch.isfinite(losses["loss"])


@pytest.mark.slow
def test_variants_are_corrupted_scenes_beside_the_clean_one(tmp_path):
    """Each corrupted variant of a scene is stored once, with one corruption. The schedule sets the
    fraction of clean rollouts."""
    seeding.seed_everything(0, "agent")
    agent = TopologicalAgent(16, SMALL)
    schedule = Schedule("per_episode", 0.9, names=("low_light", "missing_data"), clean_share=0.5)
    stores = [
        agent.store(partial(ApartmentsWorld, 64, 1), str(tmp_path), **variants)
        for variants in ({}, {"schedule": schedule, "variants": 2, "seed": 3})
    ]
    for store in stores:
        store.build()
    clean, again = (store.features(SCENE).views for store in stores)
    assert np.array_equal(clean, again)
    output = [path for path in tmp_path.rglob("*") if path.is_dir()]
    assert (
        len({path.stat().st_mode for path in output}) == 1
    )  # all cached files have the same permissions
    variants = [stores[1].features(SCENE, v) for v in (1, 2)]
    assert all(not np.array_equal(v.views, clean) for v in variants)
    assert not np.array_equal(variants[0].views, variants[1].views)
    assert all(np.array_equal(v.seen, stores[0].features(SCENE).seen) for v in variants)
    rng = np.random.default_rng(0)
    drawn = [stores[1].draw_variant(rng) for _ in range(400)]
    assert set(drawn) == {0, 1, 2} and abs(drawn.count(0) / 400 - 0.5) < 0.1
    with pytest.raises(ValueError, match="if the schedule has no corruptions"):
        agent.store(partial(ApartmentsWorld, 64, 1), str(tmp_path), variants=2)


def test_variants_are_known_by_what_makes_their_pixels(tmp_path, monkeypatch):
    agent, world = TopologicalAgent(16, SMALL), partial(ApartmentsWorld, 64, 1)

    def folder(**options):
        schedule = Schedule("per_episode", 0.9, **{"names": ("haze", "flare"), **options})
        return agent.store(world, str(tmp_path), schedule=schedule, variants=1).corrupted

    known = folder()
    assert folder(clean_share=0.6) == known != folder(names=("flare",))
    monkeypatch.setattr(stored, "version", lambda name: {"version": "another"})
    assert folder() != known
    monkeypatch.undo()
    monkeypatch.setattr(stored, "SUITE_VERSION", "another")
    assert folder() != known


def test_flare_in_a_stored_panorama_has_any_yaw(tmp_path):
    task = stored.ScenesTask(
        TopologicalAgent(16, SMALL),
        partial(ApartmentsWorld, 64, 1),
        Schedule.always("flare", 0.9),
        0,
        "fp32",
    )
    clean = [(np.full((12, 64, 64, 3), 90, np.uint8), np.ones((12, 64, 64, 1), np.float32), None)]
    hit = np.zeros(12, int)
    with task.ready():
        for number in range(40):
            (output,) = task._corrupted(clean, f"scene-{number}")
            hit += (output[0] != clean[0][0]).any((1, 2, 3))
    assert np.all(hit > 0)
