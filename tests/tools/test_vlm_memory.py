"""Tests of the memory estimate of vision-language agents."""

from __future__ import annotations

import pytest

from tools import vlm_memory


@pytest.mark.slow
def test_estimate_counts_weights_lora_and_what_autograd_keeps(monkeypatch, capsys):
    layers, hidden, vocabulary, rank = 2, 64, 500, 4
    monkeypatch.setattr(
        vlm_memory, "MODELS", {"tiny": (layers, hidden, 96, 4, 2, vocabulary, 1000.0)}
    )
    bf16 = vlm_memory.estimate("tiny", "bf16", 200, rank)
    attention = 2 * hidden * hidden + 2 * hidden * hidden // 2 + hidden + 2 * hidden // 2
    norms = (2 * layers + 1) * hidden
    weights = layers * (attention + 3 * hidden * 96) + norms + vocabulary * hidden + 1000
    assert bf16["weights"] * vlm_memory.GIB == pytest.approx(2 * weights)
    lora = layers * rank * (4 * 2 * hidden - 2 * hidden // 2)
    assert bf16["lora"] * vlm_memory.GIB == pytest.approx(16 * lora)
    assert bf16["decision"] < vlm_memory.estimate("tiny", "bf16", 400, rank)["decision"]
    assert vlm_memory.estimate("tiny", "nf4", 200, rank)["weights"] < bf16["weights"]
    vlm_memory.main(["--prompt", "50"])
    assert capsys.readouterr().out.count("| tiny |") == 2
