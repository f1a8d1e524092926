"""Load pretrained networks in Hugging Face's format, optionally in 8 or 4 bits.

A folder or hub id may come from an untrusted source, so its code is never run, and its weights must
be safetensors files.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from torch import nn

PRECISIONS = ("fp32", "bf16", "int8", "nf4")
LORA = "lora_"  # the name of every LoRA tensor of PEFT contains this text
# The chat templates of Llama 3 put today's date into the prompt unless they receive a date.
# This is the date in Llama 3.2's template, which it uses if the clock is not available.
TEMPLATE_DATE = "26 Jul 2024"
PEFT_WEIGHTS = "adapter_model.safetensors"  # name of PEFT's file with LoRA weights


def load_network(auto: Any, place: str, precision: str, **options: Any) -> Any:
    """Return the network at ``place``, built by a class such as ``AutoModelForCausalLM``.

    Args:
        auto: the Auto class of the library transformers that loads the network.
        place: a local folder, or the id of a model on the Hugging Face Hub.
        precision: precision of the weights: "fp32", "bf16", "int8" (bitsandbytes LLM.int8) or
            "nf4" (bitsandbytes, 4-bit NormalFloat, computed in bf16).
        options: additional arguments of ``from_pretrained``.
    """
    dtype = torch.bfloat16 if precision in ("bf16", "nf4") else torch.float32
    if precision in ("int8", "nf4"):
        from transformers import BitsAndBytesConfig

        # hide the warning that products are computed in float16; each product would repeat it
        logging.getLogger("bitsandbytes").setLevel(logging.ERROR)
        quantised: dict[str, Any] = {"load_in_8bit": True}
        if precision == "nf4":
            quantised = {"load_in_4bit": True, "bnb_4bit_quant_type": "nf4",
                         "bnb_4bit_compute_dtype": torch.bfloat16}  # fmt: skip
        options["quantization_config"] = BitsAndBytesConfig(**quantised)
    safe = {"use_safetensors": True, "trust_remote_code": False}
    network = auto.from_pretrained(place, dtype=dtype, **{**safe, **options})
    for module in network.modules():
        # On CPUs with AVX512-BF16, bitsandbytes repacks 4-bit weights in eval mode, and such layers
        # give no gradients in training.
        if "support_avx512bf16_for_cpu" in vars(module):
            module.support_avx512bf16_for_cpu = False
    return network


def check_place(base: str, example: str) -> None:
    """Raise FileNotFoundError unless ``base`` is a folder or has the form of a hub id."""
    if not Path(base).is_dir() and (base.count("/") != 1 or base.startswith((".", "/", "~"))):
        raise FileNotFoundError(
            f"There is no model folder {base}. Name {example}, a folder that holds config.json, "
            "tokenizer and *.safetensors, or a hub id such as meta-llama/Llama-3.2-1B-Instruct."
        )


def local_folder(base: str) -> str:
    """Return the folder of a model; for a hub id, download the files first, except pickles."""
    if Path(base).is_dir():
        return base
    from huggingface_hub import snapshot_download

    return snapshot_download(
        base, allow_patterns=["*.json", "*.jinja", "*.txt", "*.model", "*.safetensors"]
    )


@contextmanager
def explained(base: str, precision: str, install: str) -> Iterator[None]:
    """Convert errors of transformers to errors with a one-paragraph message.

    Args:
        base: name of the model.
        precision: precision of its weights.
        install: command that installs missing packages.
    """
    try:
        yield
    except ImportError as error:
        cause = str(error).strip().splitlines()[0]
        raise ValueError(
            f"Loading {base} in {precision} needs a package that is not installed ({cause}): run "
            f"{install}."
        ) from error
    except (OSError, ValueError) as error:
        cause = " ".join(str(error).split())[:300]
        fix = "Check the name and the connection, or download it and name the folder."
        if any(word in cause.lower() for word in ("gated", "401", "403")):
            fix = "Accept its licence on the hub and give your token: `hf auth login`."
        raise ValueError(f"The model {base} cannot be loaded: {cause} {fix}") from error


def files_sha256(place: str, pattern: str = "*.safetensors") -> str:
    """Return one sha256 over the contents of all weight files in a folder, sorted by name.

    For a hub id, return the sha256 of the id itself.
    """
    files = sorted(Path(place).glob(pattern))
    sha = hashlib.sha256()
    for file in files:
        with open(file, "rb") as opened:
            while chunk := opened.read(1 << 22):
                sha.update(chunk)
    return sha.hexdigest() if files else hashlib.sha256(place.encode()).hexdigest()


def keep_lora_only(module: nn.Module) -> None:
    """Exclude the frozen base weights in ``module.network`` from the state dicts of ``module``."""
    module.register_state_dict_post_hook(_keep_lora)
    module.register_load_state_dict_post_hook(_allow_missing_base)


def _keep_lora(module: nn.Module, state: dict, prefix: str, _: Any) -> None:
    for name in [n for n in state if n.startswith(prefix + "network.") and LORA not in n]:
        del state[name]


def _allow_missing_base(module: nn.Module, keys: Any) -> None:
    keys.missing_keys[:] = [n for n in keys.missing_keys if "network." not in n or LORA in n]
