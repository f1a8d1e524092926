"""Tests of the encoder recipe on tiny encoders, from the config to a folder that loads."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
import torch
from omegaconf import OmegaConf
from PIL import Image

from mitigate.agents.adapters import adapter_parameters
from mitigate.agents.building import stored_settings
from mitigate.core import conf
from mitigate.core.build import build
from mitigate.core.checkpoint import weights_sha
from mitigate.core.folders import MANIFEST
from mitigate.corruptions import Schedule
from mitigate.encoders import folder as folders
from mitigate.encoders import plain_adapters
from mitigate.encoders.model import Encoder
from mitigate.encoders.sources import FolderFrames
from mitigate.recipes.encoder import HardenEncoder, variance
from mitigate.training import train
from mitigate.training.config import read
from mitigate.training.reports.encoder import before_after
from mitigate.training.trainer import Trainer
from tests.encoders.shapes import TinyNet, tiny
from tests.tiny import assemble

TINY = ["agent=encoder", "agent.model=tests.encoders.shapes:tiny", "agent.output=pool"]


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """Write six scenes with smooth random images."""
    path, rng = tmp_path_factory.mktemp("pictures"), np.random.default_rng(0)
    for scene in range(6):
        (path / f"s{scene}").mkdir()
        for number in range(8):
            coarse = rng.integers(0, 256, (4, 4, 3), np.uint8)
            Image.fromarray(coarse).resize((32, 32), 3).save(path / f"s{scene}/{number}.png")
    return path


def result(**options) -> Encoder:
    options = {"model": "tests.encoders.shapes:tiny", "output": "pool", **options}
    torch.manual_seed(0)
    return Encoder(transform={"size": 32, "mean": [0.5] * 3, "std": [0.25] * 3}, **options)


def recipe_of(encoder: Encoder, pictures, **options) -> HardenEncoder:
    schedule = Schedule("per_frame", (0.3, 1.0))
    source = {"world": lambda: FolderFrames(str(pictures)), "schedule": schedule}
    return assemble(
        HardenEncoder, encoder, **source, frames=40, **{"batch": 12, "micro_batch": 12, **options}
    )


def config(tmp_path, pictures, *options: str):
    settings = ["recipe=encoder", "env=frames", f"env.path={pictures}", "env.size=32", *options]
    small = ["stages.encoder.recipe.frames=40", "stages.encoder.recipe.batch=8"]
    small += ["stages.encoder.recipe.micro_batch=4", "trainer.steps=2", "evaluation.episodes=1"]
    return conf.load_config("train", [*settings, *small, f"runs={tmp_path}", "workers=0"])


@pytest.mark.slow
@pytest.mark.parametrize("gate", [False, True])
def test_training_reduces_the_distance_to_clean_features(tmp_path, pictures, gate):
    encoder = result(adapters={"targets": [r"blocks\.\d"], "reduction": 1, "gate": gate})
    recipe = recipe_of(encoder, pictures)
    recipe.start()
    first = float(recipe.eval()(recipe.batch(1000))["feat"])
    before = {k: v.clone() for k, v in encoder.model.state_dict().items() if ".adapter." not in k}
    Trainer(recipe, steps=40, folder=tmp_path, lr=3e-2, precision="fp32").fit()
    after = float(recipe.eval()(recipe.batch(1000))["feat"])
    assert after < 0.8 * first
    assert all(torch.equal(encoder.model.state_dict()[k], v) for k, v in before.items())
    assert recipe.evaluate(0) == {"backbone_unchanged": 1.0}


def test_schedule_draws_only_the_modality_of_the_sensor(pictures):
    recipe = recipe_of(result(), pictures)
    assert "missing_data" not in recipe.schedule.names and "spatter" in recipe.schedule.names
    with pytest.raises(ValueError, match="must contain a corruption of rgb"):
        source = {"world": lambda: FolderFrames(str(pictures))}
        assemble(
            HardenEncoder,
            result(),
            **source,
            schedule=Schedule("per_frame", 0.6, names=("missing_data",)),
        )


def test_micro_batches_equal_one_batch(pictures):
    values = []
    for micro in (12, 5):
        recipe = recipe_of(result(), pictures, micro_batch=micro, w_gate=0.0)
        recipe.start()
        parts = [recipe(part) for part in recipe.micro_batches(recipe.batch(0))]
        values.append(float(sum(part["cosine"] for part in parts)))
    assert values[0] == pytest.approx(values[1], abs=1e-5)


@pytest.mark.slow
def test_training_writes_a_folder_for_plain_torch(tmp_path, pictures, capsys):
    cfg = config(tmp_path, pictures, *TINY)
    out = train.run(cfg)
    printed = capsys.readouterr().out
    assert (
        "own clean frame retrieved first" in printed
        and "from plain_adapters import attach" in printed
    )
    assert (out / "features.png").is_file() and folders.card(out / "agent")["sensor"] == "rgb"
    again = build(cfg.agent)
    again.load(out / "agent")
    frames = torch.randint(0, 256, (3, 32, 32, 3), dtype=torch.uint8)
    model = plain_adapters.attach(tiny().eval(), out / "agent")
    seen: list = []
    model.pool.register_forward_hook(lambda *called: seen.append(called[2]))
    model(again.transform(frames))
    with torch.no_grad():
        assert torch.equal(seen[0], again.eval()(frames))
    assert sum(p.abs().sum() for p in adapter_parameters(again.model)) > 0


@pytest.mark.slow
@pytest.mark.parametrize("tune", ["all", "adapters"])
def test_training_of_an_exported_program(tmp_path, pictures, tune):
    adapters = {"targets": [r"blocks\.\d"]} if tune == "adapters" else None
    net = str(tmp_path / "net.pt2")
    shapes = ({0: torch.export.Dim("n")},)
    frames = torch.randn(2, 3, 32, 32)
    torch.export.save(torch.export.export(tiny().eval(), (frames,), dynamic_shapes=shapes), net)
    encoder = result(model=net, tune=tune, adapters=adapters, output=None)
    before = {name: value.clone() for name, value in encoder.state_dict().items()}
    recipe = recipe_of(encoder, pictures)
    Trainer(recipe, steps=1, folder=tmp_path, lr=1e-2, precision="fp32").fit()
    assert any(not torch.equal(v, before[k]) for k, v in encoder.state_dict().items())
    frames = torch.randint(0, 256, (3, 32, 32, 3), dtype=torch.uint8)
    assert torch.equal(recipe.teacher(frames), result(model=net, tune="all", output=None)(frames))


@pytest.mark.slow
def test_report_compares_with_the_initial_encoder(tmp_path, pictures):
    own_value = ["agent=encoder", "agent.model=tests.encoders.shapes:TinyNet", "agent.output=pool"]
    # the initial weights are random, and at this learning rate training hardly changes them
    own_value += ["agent.tune=all", "trainer.lr=1e-9"]
    out = train.run(config(tmp_path, pictures, *own_value))
    rows = [json.loads(line) for line in (out / "features.jsonl").read_text().splitlines()]
    clean = next(row for row in rows if (row["measure"], row["condition"]) == ("cosine", "clean"))
    assert clean["before"][0] == pytest.approx(1) and clean["after"][0] == pytest.approx(
        1, abs=0.01
    )
    # no intervals, because only one of the six folders is held out
    assert clean["before"][1:] == [None, None]
    assert "[–] |" in (out / "features.md").read_text()


def test_report_rejects_changed_initial_weights(tmp_path, pictures, monkeypatch):
    cfg = config(tmp_path, pictures, *TINY, "agent.tune=all", "evaluation.enabled=false")
    out, trained = train.run(cfg), build(cfg.agent)
    monkeypatch.setattr("tests.encoders.shapes.tiny", lambda **_: TinyNet())
    with pytest.raises(ValueError, match="differ from those at the start of the training"):
        before_after(read(cfg), None, trained, out)


def test_resume_requires_the_same_frames(tmp_path, pictures):
    own_value = tmp_path / "own"
    shutil.copytree(pictures, own_value)
    cfg = config(tmp_path, own_value, *TINY, "evaluation.enabled=false")
    train.run(cfg)
    train.run(cfg)
    for file in own_value.glob("*/0.png"):
        Image.fromarray(np.zeros((32, 32, 3), np.uint8)).save(file)
    with pytest.raises(ValueError, match="other settings .*frames_sha256"):
        train.run(cfg)


def test_training_checks_unseen_frames_first(tmp_path, pictures):
    own_value = tmp_path / "own"
    shutil.copytree(pictures, own_value)
    last = own_value / "s5" / "0.png"
    last.write_bytes(last.read_bytes()[:200])
    with pytest.raises(ValueError, match=rf"{last} cannot be decoded.*remove it from the folder"):
        train.run(config(tmp_path, own_value, *TINY))
    assert not list(tmp_path.glob("*/encoder/step-*.pt"))


def test_training_tunes_all_weights(tmp_path, pictures):
    cfg = config(tmp_path, pictures, *TINY, "agent.tune=all")
    out = train.run(cfg)
    again = build(cfg.agent)
    before = again.model.stem.weight.clone()
    again.load(out / "agent")
    assert not torch.equal(again.model.stem.weight, before)
    plain = tiny()
    content = plain_adapters.parse((out / "agent/model.safetensors").read_bytes())
    plain.load_state_dict(content)
    assert torch.equal(plain.stem.weight, again.model.stem.weight)


@pytest.mark.slow
def test_training_of_a_depth_encoder(tmp_path):
    own_value = [
        "recipe=encoder",
        "debug=smoke",
        *TINY,
        "+agent.kwargs.channels=1",
        "agent.sensor=depth",
    ]
    own_value += [
        "agent.transform.mean=[0.0]",
        "agent.transform.std=[1.0]",
        "agent.transform.far=10",
    ]
    own_value += ["env.size=32", "stages.encoder.recipe.frames=40", f"runs={tmp_path}", "workers=0"]
    out = train.run(conf.load_config("train", own_value))
    assert "Missing data" in (out / "features.md").read_text()


def test_load_rejects_the_folder_of_another_encoder(tmp_path):
    result().save(tmp_path)
    with pytest.raises(ValueError, match="belongs to an encoder with pool='mean'"):
        result(pool="flatten").load(tmp_path)
    (tmp_path / folders.CARD).write_text('{"format": 1, "sensor": ["rgb"]}')
    with pytest.raises(ValueError, match="does not have the sha256"):
        result().load(tmp_path)
    (tmp_path / MANIFEST).unlink()  # files that no manifest lists are not compared
    with pytest.raises(ValueError, match=r"to an encoder with sensor=\['rgb'\]"):
        result().load(tmp_path)


def test_card_contains_no_import_path(tmp_path):
    result().save(tmp_path)
    text = (tmp_path / folders.CARD).read_text()
    assert "tests.encoders" not in text and "model" not in folders.card(tmp_path)
    OmegaConf.create(folders.card(tmp_path))


def test_load_takes_no_import_path_from_a_folder(tmp_path, pictures):
    """The folder contains no import path, and an import path that is added to it is rejected."""
    cfg = config(tmp_path, pictures, *TINY, "evaluation.enabled=false", "agent.tune=all")
    out = train.run(cfg) / "agent"
    assert "tests.encoders" not in (out / "config.yaml").read_text()
    assert stored_settings(cfg.agent, str(out))["sensor"] == "rgb"
    saved = OmegaConf.load(out / "config.yaml")
    saved.agent.model = "os:system"
    OmegaConf.save(saved, out / "config.yaml")
    with pytest.raises(ValueError, match="config.yaml does not have the sha256"):
        stored_settings(cfg.agent, str(out))
    (out / "manifest.json").unlink()
    with pytest.raises(ValueError, match="There is no setting of agent 'model'"):
        stored_settings(cfg.agent, str(out))


def test_loss_is_scaled_by_the_variation_of_frames():
    base = torch.randn(1, 3, 4, 4) * 100  # independent of the frame
    frames = base + torch.randn(500, 3, 4, 4) * torch.tensor([1.0, 2.0, 0.0])[:, None, None]
    each = variance(frames, per_channel=True)
    torch.testing.assert_close(each.flatten()[:2], torch.tensor([1.0, 4.0]), rtol=0.1, atol=0)
    assert each.shape == (3, 1, 1) and float(each[2]) > 0.01
    assert float(variance(frames, per_channel=False)) == pytest.approx(5 / 3, rel=0.1)
    assert variance(torch.randn(9, 5, 7), True).shape == (1, 7)
    assert variance(torch.randn(9, 7), True).shape == (7,)


def test_resume_gives_the_same_bits(tmp_path, pictures):
    class Stop(Exception):
        pass

    def trained(folder, stop: int | None = None) -> Encoder:
        recipe = recipe_of(result(), pictures)
        made_batch = recipe.batch

        def batch(step: int) -> dict:
            if step == stop:
                raise Stop
            return made_batch(step)

        recipe.batch = batch
        Trainer(recipe, steps=4, folder=folder, save_every=2, precision="fp32").fit()
        return recipe.agent

    whole = trained(tmp_path / "whole")
    with pytest.raises(Stop):
        trained(tmp_path / "parts", stop=3)
    again = trained(tmp_path / "parts")
    assert weights_sha(again) == weights_sha(whole)
