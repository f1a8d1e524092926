"""Tests that the image encoder of a vision-language agent learns clean image tokens."""

from __future__ import annotations

import sys
from functools import cache

import pytest
import torch

from mitigate.agents.vlm import VLMAgent
from mitigate.core import checkpoint
from mitigate.core.seeding import seed_everything
from mitigate.corruptions import Schedule
from mitigate.recipes.distil_images import DistilImages
from mitigate.training import train
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.agents.vlm.tiny_models import ARCHITECTURES, write_model
from tests.tiny import assemble, fit

LORA = {"r": 4, "alpha": 4, "language": ["q_proj"], "vision": "all-linear"}


@pytest.fixture(scope="module")
def folder_of(tmp_path_factory):
    """A function that takes an architecture and returns the folder of its tiny model."""
    folder = tmp_path_factory.mktemp("vlm")
    return cache(lambda name: write_model(folder / name, name))


def build(model: str, lora=LORA, **settings) -> VLMAgent:
    seed_everything(0, "vlm")
    return VLMAgent(model, lora=lora, history=1, **settings).eval()


def world():
    return ApartmentsWorld(28, layouts=2, views=1)


def objective(agent, **arguments):
    return assemble(
        DistilImages,
        agent,
        world=world,
        training=DrawnEpisodes(layouts=2),
        schedule=Schedule("per_episode", 0.8, clean_share=0.0, names=("low_light",)),
        modality="rgb",
        panoramas=1,
        **arguments,
    )


def train_images(agent, folder, steps: int, stop: int | None = None):
    return fit(objective(agent), folder, steps, stop=stop, lr=5e-3)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n != "idefics3")) for n in ARCHITECTURES]
)
def test_corrupted_views_come_closer_to_the_clean_image_tokens(folder_of, name, tmp_path):
    agent = build(folder_of(name))
    before = {n: p.detach().clone() for n, p in agent.named_parameters()}
    unseen = objective(agent).batch(1000)
    with torch.no_grad():
        (part,) = objective(agent).micro_batches(unseen)
        first = objective(agent)(part)["loss"]
    assert first > 0  # the teacher sees clean views, and the student corrupted ones
    train_images(agent, tmp_path, 12)
    moved = {n for n, p in agent.named_parameters() if not torch.equal(p, before[n])}
    images = {id(p) for p in agent.image_lora()}
    assert moved and moved <= {n for n, p in agent.named_parameters() if id(p) in images}
    with torch.no_grad():
        clean = build(folder_of(name))
        target = clean.image_tokens(unseen["clean"][0])
        after = (agent.image_tokens(unseen["frames"][0]) - target).square().mean() / target.var()
    assert after < first


def test_image_tokens_are_those_that_the_language_model_receives(folder_of, monkeypatch):
    agent = build(folder_of("idefics3"))
    frames = torch.randint(0, 256, (2, 28, 28, 3), dtype=torch.uint8)
    received = []
    decoder = agent.network.get_decoder()
    decoder.register_forward_pre_hook(
        lambda _, args, kwargs: received.append(kwargs["inputs_embeds"]), with_kwargs=True
    )
    with torch.no_grad():
        inputs = agent._inputs("Go.", None, list(frames.numpy()))
        agent.network(**inputs)
        tokens = agent.image_tokens(frames)
    images = inputs["input_ids"] == agent.network.config.image_token_id
    assert torch.equal(received[0][images], tokens)


@pytest.mark.slow
def test_resumed_training_gives_the_same_bits(folder_of, tmp_path):
    model = folder_of("idefics3")
    whole = train_images(build(model), tmp_path / "whole", 2)
    train_images(build(model), tmp_path / "parts", 2, stop=1)
    resumed = train_images(build(model), tmp_path / "parts", 2)
    assert checkpoint.weights_sha(resumed) == checkpoint.weights_sha(whole)


def test_missing_lora_weights_and_other_agents_are_rejected(folder_of):
    agent = build(folder_of("idefics3"), lora={**LORA, "vision": []})
    with pytest.raises(ValueError, match="agent.lora.vision=all-linear"):
        objective(agent)
    assert "recipe=harden" in DistilImages.misfit(torch.nn.Linear(1, 1))


@pytest.mark.slow
def test_harden_vlm_trains_and_its_folder_starts_self_distillation(
    folder_of, monkeypatch, tmp_path
):
    model = folder_of("idefics3")
    first = ["recipe=harden_vlm", f"agent.model={model}", f"folder={tmp_path / 'harden'}"]
    first += ["stages.images.recipe.panoramas=1"]
    second = ["recipe=self_distill", "agent=vlm", f"agent.model={model}", "rollouts=1"]
    second += [f"init={tmp_path / 'harden/agent'}", f"folder={tmp_path / 'self'}"]
    second += ["agent.lora.vision=all-linear"]
    small = ["debug=smoke", "env.size=28", "workers=0", "agent.lora.r=2", "agent.history=1"]
    small += ["evaluation.enabled=false", "trainer.steps=1"]
    for options in (first, second):
        monkeypatch.setattr(sys, "argv", ["mitigate", *options, *small])
        train.main()
    for folder in ("harden", "self"):
        files = {file.name for file in (tmp_path / folder / "agent").iterdir()}
        assert files >= {"adapter_config.json", "adapter_model.safetensors"}
