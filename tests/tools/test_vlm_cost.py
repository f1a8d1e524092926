"""Tests of the estimated cost of vision-language agents."""

from __future__ import annotations

import pytest

from tools import vlm_cost


@pytest.mark.slow
def test_estimate_counts_weights_lora_and_what_autograd_keeps(monkeypatch, capsys):
    layers, hidden, vocabulary, rank = 2, 64, 500, 4
    monkeypatch.setattr(
        vlm_cost, "MODELS", {"tiny": (layers, hidden, 96, 4, 2, vocabulary, 1000.0, 4)}
    )
    bf16 = vlm_cost.estimate("tiny", "bf16", 200, rank)
    attention = 2 * hidden * hidden + 2 * hidden * hidden // 2 + hidden + 2 * hidden // 2
    norms = (2 * layers + 1) * hidden
    weights = layers * (attention + 3 * hidden * 96) + norms + vocabulary * hidden + 1000
    assert bf16["weights"] * vlm_cost.GIB == pytest.approx(2 * weights)
    lora = layers * rank * (4 * 2 * hidden - 2 * hidden // 2)
    assert bf16["lora"] * vlm_cost.GIB == pytest.approx(16 * lora)
    assert bf16["decision"] < vlm_cost.estimate("tiny", "bf16", 400, rank)["decision"]
    assert vlm_cost.estimate("tiny", "nf4", 200, rank)["weights"] < bf16["weights"]
    vlm_cost.main(["--prompt", "50"])
    assert capsys.readouterr().out.count("| tiny |") == 3


@pytest.mark.slow
def test_operations_follow_from_the_sizes_of_the_matrices(monkeypatch):
    layers, hidden, inner, vocabulary, prompt = 2, 256, 384, 500, 50
    monkeypatch.setattr(
        vlm_cost, "MODELS", {"tiny": (layers, hidden, inner, 4, 2, vocabulary, 1000.0, 4)}
    )
    network = vlm_cost.language_model("tiny", 4)
    once, training = vlm_cost.operations("tiny", network, prompt)
    tokens = prompt + vlm_cost.ANSWERS * (vlm_cost.LENGTH - 1)
    weights = layers * (3 * hidden * hidden + 3 * hidden * inner)
    matrices = 2 * tokens * weights + 2 * 1000 * 4 * prompt
    # attention, LoRA and the output layer add to the products with the weights
    assert matrices < once < 1.3 * matrices
    assert 2.8 * once < training < 3.4 * once
