"""Estimate the peak memory and the speed of training a vision-language agent.

    python -m tools.vlm_cost

The language model is built on torch's meta device, which needs no memory for weights, and processes
one decision. The tensors that autograd keeps for the backward pass, and the floating-point
operations of the forward and the backward pass, are counted exactly. The image encoder is frozen,
so autograd keeps none of its tensors; its weights are counted, and two operations per weight and
image patch. The estimate excludes the CUDA context, temporary tensors, and memory lost to
fragmentation. The speed is that of a device which sustains ``--tflops``. Nothing is measured on a
GPU.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import torch
from torch import nn
from torch.utils.flop_counter import FlopCounterMode

from mitigate.agents.vlm.agent import likelihoods

# published sizes of the language models; the other weights (image encoder, projector) are rounded
MODELS = {
    # Each model has: layers, hidden size, intermediate size, heads and key-value heads.
    # The vocabulary size, the number of other weights and the image patches per token follow.
    "SmolVLM-256M": (30, 576, 1536, 9, 3, 49280, 93e6 + 7e6, 16),
    "LLaVA-OneVision-0.5B": (24, 896, 4864, 14, 2, 152000, 400e6, 1),
    "Qwen2.5-VL-3B": (36, 2048, 11008, 16, 2, 151936, 668e6, 4),
    "Qwen2.5-VL-7B": (28, 3584, 18944, 28, 4, 152064, 676e6, 4),
}
BYTES = {"fp32": 4.0, "bf16": 2.0, "int8": 1.0, "nf4": 0.53}  # bytes per weight of a linear layer
GIB = 2**30
ANSWERS, LENGTH = 10, 7  # allowed answers, and tokens of the longest one
TARGETS = ["q_proj", "k_proj", "v_proj", "o_proj"]


def language_model(name: str, rank: int) -> nn.Module:
    """Return the language model called ``name`` with LoRA, on the meta device."""
    from peft import LoraConfig, get_peft_model
    from transformers import Qwen2Config, Qwen2ForCausalLM

    layers, hidden, intermediate, heads, kv_heads, vocabulary, *_ = MODELS[name]
    config = Qwen2Config(
        num_hidden_layers=layers,
        hidden_size=hidden,
        intermediate_size=intermediate,
        num_attention_heads=heads,
        num_key_value_heads=kv_heads,
        vocab_size=vocabulary,
        tie_word_embeddings=True,
    )
    with torch.device("meta"):
        network = Qwen2ForCausalLM(config).to(torch.bfloat16).requires_grad_(False)
        return get_peft_model(network, LoraConfig(r=rank, target_modules=TARGETS))


def kept_bytes(network: nn.Module, prompt: int) -> int:
    """Return the bytes that autograd keeps for one decision.

    Args:
        network: a language model on the meta device.
        prompt: number of tokens of the prompt, with images.
    """
    weights = {parameter.untyped_storage()._cdata for parameter in network.parameters()}
    storages: dict[int, torch.UntypedStorage] = {}

    def count(tensor: torch.Tensor) -> torch.Tensor:
        storage = tensor.untyped_storage()
        if storage._cdata not in weights:
            # a reference is kept, so that no later storage gets the same key
            storages[storage._cdata] = storage
        return tensor

    with torch.autograd.graph.saved_tensors_hooks(count, lambda tensor: tensor):
        _decide(network, prompt)
    return sum(storage.nbytes() for storage in storages.values())


def operations(name: str, network: nn.Module, prompt: int) -> tuple[float, float]:
    """Return the floating-point operations of one decision: to evaluate, and to train.

    Training includes the second forward pass of ``agent.checkpointing=true``. All tokens of the
    prompt count as image tokens for the image encoder.
    """
    *_, others, patches = MODELS[name]
    encoder = 2.0 * others * patches * prompt
    with FlopCounterMode(display=False) as forward:
        decision = _decide(network, prompt)
    with FlopCounterMode(display=False) as backward:
        decision.sum().backward()
    once = forward.get_total_flops() + encoder
    return once, 2 * once + backward.get_total_flops()


def _decide(network: nn.Module, prompt: int) -> torch.Tensor:
    ids = torch.zeros(1, prompt, dtype=torch.long, device="meta")
    texts = torch.zeros(ANSWERS, LENGTH, dtype=torch.long, device="meta")
    mask = torch.ones(ANSWERS, LENGTH, dtype=torch.bool, device="meta")
    return likelihoods(network, {"input_ids": ids}, texts, mask)


def estimate(name: str, precision: str, prompt: int, rank: int = 16) -> dict[str, float]:
    """Return the estimated memory in GiB by part."""
    network = language_model(name, rank)
    lora = sum(p.numel() for p in network.parameters() if p.requires_grad)
    tables = network.get_input_embeddings().weight.numel()
    linear = sum(p.numel() for p in network.parameters()) - lora - tables + MODELS[name][-2]
    wide = max(2.0, BYTES[precision]) if precision != "fp32" else 4.0
    activations = kept_bytes(network, prompt)
    if precision == "fp32":
        activations *= 2
    parts = {
        "weights": linear * BYTES[precision] + tables * wide,
        # bytes per weight in fp32: the weight, its gradient and two moments of AdamW
        "lora": lora * 16.0,
        "decision": float(activations),
    }
    return {part: size / GIB for part, size in parts.items()}


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables of docs/vlm.md."""
    parser = argparse.ArgumentParser(description="Estimate the cost of training agent=vlm.")
    parser.add_argument("--prompt", type=int, default=1600, help="tokens of a prompt with images")
    parser.add_argument("--tflops", type=float, default=200.0, help="sustained TFLOP/s")
    options = parser.parse_args(arguments)
    print("| Model | Weights in | Weights | LoRA, AdamW | One decision | Sum |")
    print("|---|---|---|---|---|---|")
    for name in MODELS:
        for precision in ("bf16", "nf4"):
            parts = estimate(name, precision, options.prompt)
            cells = " | ".join(f"{size:.1f}" for size in (*parts.values(), sum(parts.values())))
            print(f"| {name} | {precision} | {cells} |")
    print(
        "\n| Model | TFLOP per decision, evaluation | Training "
        "| Decisions per second, evaluation | Training |"
    )
    print("|---|---|---|---|---|")
    for name in MODELS:
        counts = operations(name, language_model(name, 16), options.prompt)
        work = " | ".join(f"{count / 1e12:.1f}" for count in counts)
        speed = " | ".join(f"{options.tflops * 1e12 / count:.0f}" for count in counts)
        print(f"| {name} | {work} | {speed} |")


if __name__ == "__main__":
    main()
