"""Tests of all methods: one test checks the defining property of each method.

The methods are: augmentation per frame, per episode and by success rate; distillation with a KL
loss on policies and an MSE loss on features; zero-initialised residual ConvAdapters; panorama
fusion weighted by reliability; LoRA fine-tuning of an 8-bit Llama; a Hydra multirun; export.
"""

from __future__ import annotations

import sys
from collections import Counter
from functools import partial
from pathlib import Path

import pytest
import torch
from torch import nn

import mitigate
from mitigate.agents.adapters import ConvAdapter, adapter_parameters, adapters_of, insert_adapters
from mitigate.agents.building import agent_option
from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.fusion import reliability
from mitigate.corruptions import Schedule
from mitigate.recipes.distil import feature_loss, policy_kl
from mitigate.shipping import export, export_command
from mitigate.shipping.export import finished
from mitigate.training import train
from tests.agents.rooms import Brief

ROOT = Path(__file__).parent.parent
NAMES = ("low_light", "spatter", "flare", "defocus")
FRAMES = 4000


def draws(schedule: Schedule, episodes: int, frames: int) -> list[list[str]]:
    """Return, for each episode, the names of the corruptions of its frames."""
    return [
        [schedule.draw(0, str(episode), frame)[0].name for frame in range(frames)]
        for episode in range(episodes)
    ]


def shares(names: list[str]) -> dict[str, float]:
    return {name: count / len(names) for name, count in Counter(names).items()}


def test_per_frame_schedule_draws_each_frame_separately():
    schedule = Schedule("per_frame", 0.6, clean_share=0.25, names=NAMES)
    (names,) = draws(schedule, 1, FRAMES)
    expected = {"clean": 0.25, **dict.fromkeys(NAMES, 0.75 / 4)}
    assert shares(names) == pytest.approx(expected, abs=0.03)
    repeated = sum(a == b for a, b in zip(names, names[1:], strict=False)) / FRAMES
    assert repeated == pytest.approx(sum(p**2 for p in expected.values()), abs=0.03)


def test_per_episode_schedule_keeps_one_corruption_for_the_episode():
    schedule = Schedule("per_episode", 0.6, clean_share=0.25, names=NAMES)
    episodes = draws(schedule, FRAMES, 2)
    assert all(len(set(names)) == 1 for names in episodes)
    expected = {"clean": 0.25, **dict.fromkeys(NAMES, 0.75 / 4)}
    assert shares([names[0] for names in episodes]) == pytest.approx(expected, abs=0.03)


def test_success_distributed_schedule_draws_harder_corruptions_more_often():
    success = {"low_light": 0.1, "spatter": 0.4, "flare": 0.7, "defocus": 0.9}
    schedule = Schedule(
        "success_distributed", 0.6, clean_share=0.0, names=NAMES, floor=0.0, success=success
    )
    result = shares([names[0] for names in draws(schedule, FRAMES, 1)])
    total = sum(1 - rate for rate in success.values())
    assert result == pytest.approx({n: (1 - s) / total for n, s in success.items()}, abs=0.03)
    assert sorted(result, key=success.__getitem__) == sorted(result, key=lambda name: -result[name])


def test_policy_kl_is_zero_for_equal_policies_only():
    logits = torch.randn(64, 5, generator=torch.Generator().manual_seed(0))
    assert float(policy_kl(logits, logits.clone(), 2.0)) == pytest.approx(0, abs=1e-6)
    assert float(policy_kl(logits.flip(0), logits, 2.0)) > 0.01


def test_feature_mse_is_zero_for_equal_features_only():
    features = torch.randn(64, 12, generator=torch.Generator().manual_seed(0))
    assert float(feature_loss(features, features.clone())) == 0
    assert float(feature_loss(features + 0.1, features)) > 0


def test_fresh_conv_adapter_changes_no_bit_and_has_gradients():
    torch.manual_seed(0)
    encoder = nn.Sequential(nn.Conv2d(3, 8, 3), nn.ReLU(), nn.Conv2d(8, 8, 3))
    frames = torch.randn(2, 3, 16, 16)
    before = encoder(frames)
    insert_adapters(encoder, ["0", "2"])
    assert all(isinstance(adapter, ConvAdapter) for adapter in adapters_of(encoder))
    after = encoder(frames)
    assert torch.equal(after, before)
    after.square().sum().backward()
    ups = [p for adapter in adapters_of(encoder) for p in adapter.up.parameters()]
    assert ups and all(p.grad is not None and p.grad.abs().sum() > 0 for p in ups)
    trained = {id(p) for p in encoder.parameters() if p.requires_grad}
    assert trained == {id(p) for p in adapter_parameters(encoder)}


@pytest.mark.parametrize("factor", [0.0, 3.0])
def test_fusion_weights_sum_to_one_and_follow_reliability(factor):
    views = torch.randn(4, 12, 32, generator=torch.Generator().manual_seed(0))
    views = views / views.norm(dim=-1, keepdim=True)
    views[:, 5] *= factor  # like a blank view or an overexposed view
    weights = reliability(views)
    torch.testing.assert_close(weights.sum(-1), torch.ones(4))
    others_ = torch.cat([weights[:, :5], weights[:, 6:]], 1)
    assert (weights[:, 5] < others_.min(1).values).all()


def test_lora_on_8_bit_llama_trains_only_the_adapter(tmp_path):
    pytest.importorskip("bitsandbytes", reason="needs bitsandbytes: pip install -e '.[safeguard]'")
    from mitigate.guards.text.language_models.model import LanguageModel
    from mitigate.recipes.safeguard_lora import SafeguardLora
    from mitigate.training.trainer import Trainer
    from tests.guards.text.conftest import LORA, write_tiny_model

    model = LanguageModel(str(write_tiny_model(tmp_path / "base")), "int8", LORA)
    before = {name: p.detach().clone() for name, p in model.named_parameters()}
    assert any(p.dtype == torch.int8 for p in before.values())
    recipe = SafeguardLora(model, pairs=4, micro_batch=2)
    Trainer(recipe, steps=2, folder=tmp_path / "run", lr=1e-2, save_every=2, device="cpu").fit()
    moved = {n for n, p in model.named_parameters() if not torch.equal(p, before[n])}
    assert moved and all("lora_" in name for name in moved)


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> list[Path]:
    """Two tiny training runs of one Hydra multirun."""
    folder = tmp_path_factory.mktemp("multirun")
    options = ["recipe=imitation", "debug=smoke", "agent=frontier", "stages.imitation=null"]
    options += ["agent.size=16", "agent.width=8", "env.size=16", "init=null", "workers=0"]
    options += ["stages.perception_depth=null", "stages.perception_rgb.recipe.panoramas=2"]
    options += ["evaluation.enabled=false", f"runs={folder}", "seed=0,1"]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        patch.setattr(sys, "argv", ["mitigate train", "--multirun", *options])
        train.main()
    return sorted(path for path in folder.iterdir() if path.is_dir())


def test_multirun_trains_one_run_per_combination(runs):
    assert ["-seed0-" in runs[0].name, "-seed1-" in runs[1].name] == [True, True]
    weights = [(run / "agent/model.safetensors").read_bytes() for run in runs]
    assert len(weights) == 2 and weights[0] != weights[1]


def test_export_reloads_to_the_same_outputs(runs, tmp_path, monkeypatch):
    monkeypatch.setattr(export, "WALKS", 1)
    (option,) = agent_option([], str(runs[0] / "agent"))  # the command's default
    assert option == "agent=frontier"
    with pytest.raises(ValueError, match=option):
        export.export(runs[0], "tiny", out=tmp_path)
    walks = export_command._walks_of(runs[0], [option, "env.size=16"], None)
    walks.make_world = partial(Brief, 16, views=1)
    folder = export.export(runs[0], "tiny", out=tmp_path, walks=walks)
    assert f'load_hardened("{tmp_path}/tiny")' in (folder / "README.md").read_text()
    loaded, trained = mitigate.load_hardened(folder), finished(runs[0], walks)[1].eval()
    assert isinstance(loaded, FrontierAgent)
    rng = torch.Generator().manual_seed(0)
    frames = torch.randint(0, 256, (2, 16, 16, 3), generator=rng).to(torch.uint8)
    with torch.no_grad():
        for first, second in zip(
            trained.rgb_encoder(frames), loaded.rgb_encoder(frames), strict=True
        ):
            assert torch.equal(first, second)
