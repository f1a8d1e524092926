"""Tests that restorers are trained on random poses or on the frames in a folder, and that
thresholds are set."""

from __future__ import annotations

import pickle
from functools import partial

import numpy as np
import pytest
import torch
from PIL import Image

from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import Schedule
from mitigate.encoders.sources import FolderFrames
from mitigate.guards.frames.restorer import Restorer
from mitigate.recipes.restore import Restore
from mitigate.recipes.restore_gate import GateSamples, RestoreGate
from mitigate.training.trainer import Trainer
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.tiny import assemble


def recipe_of(sensor: str = RGB, names=("foreign_object", "missing_data"), **options) -> Restore:
    torch.manual_seed(0)
    restorer = Restorer(width=4, depth_width=4)
    how = {"panoramas": 1, **options}
    schedule = Schedule("per_episode", (0.4, 0.8), names=names, clean_share=0.3)
    world = {"world": partial(ApartmentsWorld, 16, 2), "training": DrawnEpisodes(2)}
    return assemble(Restore, restorer, **world, modality=sensor, schedule=schedule, **how)


@pytest.mark.slow
@pytest.mark.parametrize(("sensor", "left"), [(RGB, 0.8), (DEPTH, 0.6)])
def test_training_takes_a_corruption_away(tmp_path, sensor, left):
    recipe = recipe_of(sensor, panoramas=2, single=0.0)
    Trainer(recipe, steps=30, lr=2e-3, folder=tmp_path, precision="fp32", log_every=0).fit()
    with torch.no_grad():
        matches = [recipe.eval()(recipe.batch(step)) for step in range(100, 104)]
    before, after = (sum(float(each[name]) for each in matches) for name in ("before", "after"))
    assert after < left * before
    others = [p for name, net in recipe.agent.parts().items() if name != sensor
              for p in net.parameters()]  # fmt: skip
    assert not any(p.requires_grad for p in others)


def test_restore_batch_is_a_function_of_the_step():
    recipe, again = recipe_of(single=0.5), recipe_of(single=0.5)
    recipe.start(), again.start()
    views = []
    for step in range(8):
        one, two = recipe.batch(step), again.batch(step)
        assert torch.equal(one["frames"], two["frames"]) and one["views"] == two["views"]
        views.append(one["views"])
    assert set(views) == {1, 12}


@pytest.mark.slow
def test_gate_trains_and_sets_its_threshold(tmp_path):
    arguments = recipe_of(names=("low_light", "foreign_object"), panoramas=2, single=0.0)
    Trainer(arguments, steps=40, lr=2e-3, folder=tmp_path / "first", precision="fp32").fit()
    schedule = Schedule("per_episode", (0.4, 0.8), names=("low_light", "foreign_object"))
    world = {"world": partial(ApartmentsWorld, 16, 2), "training": DrawnEpisodes(2)}
    recipe = assemble(RestoreGate, arguments.agent, **world, modality=RGB, schedule=schedule,
        instants=24, held=10, batch=16, touched=0.1,
    )  # fmt: skip
    before = {name: p.clone() for name, p in arguments.agent.named_parameters()}
    Trainer(
        recipe,
        steps=40,
        lr=5e-3,
        folder=tmp_path / "gate",
        precision="fp32",
        log_every=0,
        eval_every=40,
    ).fit()
    records = recipe.evaluate(40)
    assert records["threshold"] == recipe.net.threshold != 0
    assert records["helped_found"] > 0.7 > 0.4 > records["clean_touched"]
    changed = [n for n, p in arguments.agent.named_parameters() if not torch.equal(p, before[n])]
    assert changed and all(name.startswith("nets.rgb.gate.") for name in changed)


def test_gate_target_rejects_blurred_right_pixels():
    nothing = torch.zeros(5, 1, 1)
    before, after = (
        torch.tensor([0.2, 0.2, 0.2, 0.0, 0.2]),
        torch.tensor([0.1, 0.1, 0.19, 0.1, 0.3]),
    )
    spent = torch.tensor([0.0, 0.5, 0.0, 0.5, 0.0])
    hit, counted = GateSamples(nothing, nothing, before, after, spent).labels
    assert hit.tolist() == [True, False, False, False, False]
    assert counted.tolist() == [True, True, False, True, True]


def test_restore_loss_prefers_fewer_wrong_pixels():
    recipe = recipe_of(w_grad=0.0)
    expected = torch.full((1, 3, 8, 8), 0.5)
    valid = torch.ones(1, 1, 8, 8)
    few, all_ = expected.clone(), expected + 0.4 / 16
    few[:, :, 2:4, 2:4] += 0.4
    few, all_ = (float(recipe._error(out, expected, valid)) for out in (few, all_))
    assert few < all_ and float(recipe._error(expected, expected, valid)) == 0


def test_depth_loss_weighs_too_far_more_than_too_near():
    recipe = recipe_of(w_grad=0.0, w_right=0.0, w_far=3.0)
    expected, valid = torch.full((1, 1, 8, 8), 0.5), torch.ones(1, 1, 8, 8)
    far, near = (float(recipe._error(expected + off, expected, valid)) for off in (0.1, -0.1))
    assert far == pytest.approx(3 * near)


def test_folder_of_frames_can_be_the_source(tmp_path):
    rng = np.random.default_rng(0)
    for scene in range(3):
        (tmp_path / f"s{scene}").mkdir()
        for number in range(4):
            coarse = rng.integers(0, 256, (4, 4, 3), np.uint8)
            Image.fromarray(coarse).resize((24, 24), 3).save(tmp_path / f"s{scene}/{number}.png")
    recipe = _of_folder(tmp_path)
    recipe.start()
    batch = recipe.batch(0)
    assert batch["frames"].shape == batch["clean"].shape == (1, 12, 24, 24, 3)
    there = pickle.loads(
        pickle.dumps(recipe)
    )  # as in a worker, which receives only the frames of its jobs
    assert there.pairs.frames is None
    sent = pickle.loads(pickle.dumps(recipe.jobs(0)))
    again = there.collate(0, [there.work(job) for job in sent])
    assert torch.equal(again["frames"], batch["frames"])
    assert batch["views"] == 1 and recipe(batch)["loss"].item() > 0


def _of_folder(path) -> Restore:
    world = partial(FolderFrames, str(path))
    schedule = Schedule("per_episode", 0.6, clean_share=0.0)
    return assemble(
        Restore,
        Restorer([RGB], width=4),
        world=world,
        training=None,
        modality=RGB,
        schedule=schedule,
        panoramas=1,
        frames=8,
    )


def test_folder_depth_uses_the_range_of_the_restorer(tmp_path):
    """With the default range, all depth beyond ten metres would become ten metres in the training
    targets."""
    for scene in range(3):
        (tmp_path / f"s{scene}").mkdir()
        metres = np.full((24, 24), 21 + scene, np.float32)
        np.save(tmp_path / f"s{scene}/0.npy", metres)
    agent = Restorer([DEPTH], depth_width=4, far=40.0)
    world = partial(FolderFrames, str(tmp_path), sensor=DEPTH)
    schedule = Schedule("per_episode", 0.6, clean_share=0.0, names=("gaussian_noise",))
    objective = assemble(
        Restore,
        agent,
        world=world,
        training=None,
        modality=DEPTH,
        schedule=schedule,
        panoramas=1,
        frames=3,
    )
    objective.start()
    batch = objective.batch(0)
    assert batch["frames"].mean() > 18 and batch["clean"].min() >= 21


def test_schedule_without_the_sensor_is_rejected():
    with pytest.raises(ValueError, match="must contain a depth corruption"):
        recipe_of(DEPTH, names=("flare",))


def test_folder_with_other_frames_is_another_run(tmp_path):
    for scene in range(4):
        (tmp_path / f"s{scene}").mkdir()
        Image.new("RGB", (24, 24), "navy").save(tmp_path / f"s{scene}/0.png")
    before = _of_folder(tmp_path).identity()
    for file in tmp_path.glob("*/0.png"):
        Image.new("RGB", (24, 24), "white").save(file)
    assert before.keys() == {"frames_sha256"} and _of_folder(tmp_path).identity() != before
    assert recipe_of().identity() == {}


def test_restore_rejects_success_schedules(tmp_path):
    source = {"world": partial(FolderFrames, str(tmp_path)), "training": None, "modality": RGB}
    schedule = Schedule("success_distributed", 0.6)
    for kind in (Restore, RestoreGate):
        with pytest.raises(ValueError, match="which this recipe does not measure"):
            assemble(kind, Restorer([RGB], width=4), **source, schedule=schedule)
