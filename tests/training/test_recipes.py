"""Tests that every recipe in conf/recipe trains two steps per stage and gives an agent that
loads."""

from __future__ import annotations

import pytest
import torch
from omegaconf import OmegaConf

from mitigate.agents.building import stored_settings
from mitigate.agents.topological import stored
from mitigate.core import checkpoint, conf
from mitigate.core.build import build
from mitigate.core.checkpoint import load_tensors
from mitigate.core.pretrained import PEFT_WEIGHTS
from mitigate.training import states, train
from mitigate.worlds.apartments import simulator
from tests.guards.text.conftest import write_tiny_model

TINY_ENCODER = {"model": "tests.encoders.shapes:tiny", "weights": None, "output": "pool"}
OTHERS = (  # other kinds of agent: kind, recipe, and shipped weights
    ("recurrent", "da_per_episode", "recurrent/base"),
    ("recurrent_rgb", "ts_distill", "recurrent_rgb/base"),
    ("frontier", "conv_adapter", "frontier/base"),
    ("topological", "da_per_episode", "hardened/harden"),
)
LITTLE = {  # sizes that make the training data of a stage small
    "batch": 8,
    "frames": 48,
    "held": 2,
    "instants": 4,
    "micro_batch": 4,
    "pairs": 4,
    "panoramas": 4,
    "texts": 8,
    "variants": 1,
}
RECIPES = sorted(path.stem for path in (conf.CONF / "recipe").rglob("*.yaml"))
RECIPES.remove("conversations")  # it needs recorded data: tests/agents/vlm/test_conversations.py
RECIPES.remove("harden_vlm")  # it needs a model: tests/agents/vlm/test_distil_images.py
QUICK = ("ts_distill",)  # testing all other recipes takes a long time


def some_slow(names, quick):
    return [name if name in quick else pytest.param(name, marks=pytest.mark.slow) for name in names]


@pytest.mark.parametrize("name", some_slow(RECIPES, QUICK))
def test_every_recipe_trains_two_steps(tmp_path, name, monkeypatch):
    monkeypatch.setattr(stored, "SPACING", 2.0)  # fewer poses, so that fewer features are stored
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)  # episodes for measuring success
    options = [f"recipe={name}", "debug=smoke", "evaluation.enabled=false", f"runs={tmp_path}"]
    options.append("workers=0")  # starting two workers per stage takes longer than the computation
    cfg = conf.load_config("train", options)
    # a tiny language model, because the real one takes half a minute to load
    if "base" in cfg.agent:
        cfg.agent.base = str(write_tiny_model(tmp_path / "tiny-llama"))
    if cfg.agent.get("encoder", "own") != "own":  # other encoders need an extra and are slow
        cfg.agent.encoder, cfg.agent.size, cfg.env.size = "own", 64, 64
    if "adapters" in cfg.agent and "model" in cfg.agent:  # the default encoder needs an extra
        cfg.agent = OmegaConf.merge(cfg.agent, TINY_ENCODER)
        cfg.agent.kwargs = {}
    if "size" in cfg.agent and "size" in cfg.env:
        cfg.agent.size = cfg.env.size = 32
    cfg.rollouts, cfg.schedule.names = 2, ["low_light", "spatter", "missing_data"]
    for stage in filter(None, cfg.stages.values()):
        stage.recipe.update({k: v for k, v in LITTLE.items() if k in stage.recipe})
    folder = train.run(cfg)
    for stage in (name for name, settings in cfg.stages.items() if settings):
        assert states.checkpoints(folder / stage)[-1].name == "step-00000002.pt"
    checkpoint.load_agent(build(cfg.agent), folder / "agent")


@pytest.mark.slow
def test_int8_language_model_trains_without_log_spam(tmp_path, capfd):
    pytest.importorskip("bitsandbytes")
    base = write_tiny_model(tmp_path / "tiny-llama")
    options = ["recipe=safeguard_lora", "debug=smoke", "evaluation.enabled=false", "workers=0"]
    options += [f"runs={tmp_path}", f"agent.base={base}", "agent.precision=int8"]
    cfg = conf.load_config("train", [*options, "trainer.eval_every=1"])
    folder = train.run(cfg)
    printed = "".join(capfd.readouterr())
    assert "evaluated at step 2" in printed and "MatMul8bitLt" not in printed
    checkpoint.load_agent(build(cfg.agent), folder / "agent")


@pytest.mark.slow
def test_language_model_resumes_from_an_adapter(tmp_path):
    base = write_tiny_model(tmp_path / "tiny-llama")
    options = ["recipe=safeguard_lora", "debug=smoke", "evaluation.enabled=false", "workers=1"]
    options += [f"agent.base={base}", "agent.lora.dropout=0"]
    first = train.run(conf.load_config("train", [*options, f"runs={tmp_path}/first"]))
    options += [f"init={first}/agent", "trainer.lr=1e-12", f"runs={tmp_path}/second"]
    second = train.run(conf.load_config("train", options))
    one, two = (load_tensors(folder / "agent" / PEFT_WEIGHTS) for folder in (first, second))
    assert one.keys() == two.keys()
    assert all(torch.allclose(one[name], two[name], atol=1e-9) for name in one)
    assert any(value.any() for name, value in one.items() if "lora_B" in name)  # it had learned
    with pytest.raises(ValueError, match=r"agent\.lora\.r"):
        train.run(conf.load_config("train", [*options, "agent.lora.r=4"]))


@pytest.mark.slow
@pytest.mark.parametrize("agent,recipe,weights", OTHERS)
def test_training_inherits_vocabulary_and_adapters(tmp_path, agent, recipe, weights):
    options = [f"agent={agent}", f"recipe={recipe}", "debug=smoke", "workers=0", "env.size=32"]
    options.append(f"init=checkpoints/{weights}")
    cfg = conf.load_config("train", [*options, "evaluation.enabled=false", f"runs={tmp_path}"])
    cfg.agent.size, cfg.rollouts = 32, 1
    for stage in cfg.stages.values():
        stage.trainer.steps = 1
    folder = train.run(cfg)
    before, after = (
        stored_settings(cfg.agent, w) for w in (f"checkpoints/{weights}", folder / "agent")
    )
    assert before.get("vocabulary") in (None, after.get("vocabulary"))
    assert recipe == "conv_adapter" or after["adapters"] == before["adapters"]
