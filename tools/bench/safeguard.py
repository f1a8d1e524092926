"""Measure memory and speed of the safeguard's language model.

    python -m tools.bench.safeguard

Each precision runs in a separate process. The tool measures the resident memory after loading, the
training speed in tokens per second (steps of the recipe, without padding), and the seconds to
generate 60 tokens greedily. The baseline is transformers with PEFT as in the guides of these
libraries: the whole batch at once, logits of all positions, weights in float32, no autocast.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from typing import Any

import torch

from mitigate.core import conf
from mitigate.training import train  # noqa: F401 - registers its options

BASELINE = "transformers + PEFT, fp32"
KINDS = {  # maps a name to precision of the weights, autocast, and whether it runs as in the recipe
    BASELINE: ("fp32", False, False),
    "fp32": ("fp32", False, True),
    "fp32, bf16 autocast (default)": ("fp32", True, True),
    "bf16": ("bf16", False, True),
    "int8 (bitsandbytes)": ("int8", False, True),
}
TOKENS, STEPS = 60, 3
COLUMNS = {
    "loaded_mb": "RSS loaded, MB",
    "peak_mb": "peak RSS, MB",
    "train_tokens_s": "training tokens/s",
    "train_tokens_cpu_s": "training tokens/CPU s",
    "greedy_s": f"{TOKENS} tokens greedily, s",
    "greedy_cpu_s": f"{TOKENS} tokens greedily, CPU s",
}


def measure(kind: str, base: str) -> dict[str, float]:
    """Measure one kind in this process."""
    from mitigate.guards.text.language_models.model import LanguageModel
    from mitigate.recipes.safeguard_lora import SafeguardLora
    from mitigate.training.objective import accumulate

    precision, autocast, as_recipe = KINDS[kind]
    cfg = conf.load_config("train", ["recipe=safeguard_lora"])
    model = LanguageModel(base, precision, dict(cfg.agent.lora))
    values = {"loaded_mb": _resident_megabytes()}
    recipe = SafeguardLora(model, pairs=16, micro_batch=4 if as_recipe else 16)
    device = torch.device("cpu")
    compute_precision = "bf16" if autocast else "fp32"
    accumulate(recipe, recipe.batch(0), "fp32", device)  # warm up
    batches = [recipe.batch(step) for step in range(1, STEPS + 1)]
    tokens = sum(int(g["attention_mask"].sum()) for b in batches for g in b["groups"])
    wall = time.perf_counter()
    cpu = time.process_time()
    for batch in batches:
        if as_recipe:
            accumulate(recipe, batch, compute_precision, device)
        else:
            _baseline_step(model, batch["groups"][0])
    values["train_tokens_s"] = tokens / (time.perf_counter() - wall)
    values["train_tokens_cpu_s"] = tokens / (time.process_time() - cpu)
    values["greedy_s"], values["greedy_cpu_s"] = _time_generation(model)
    values["peak_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    return values


def _baseline_step(model: Any, group: dict[str, torch.Tensor]) -> None:
    """Compute the gradients of a batch as in the guides of transformers."""
    labels = torch.full_like(group["input_ids"], -100)
    width = group["completion"].shape[1]
    tail = labels[:, -width:]
    tail[group["completion"]] = group["input_ids"][:, -width:][group["completion"]]
    inputs = {name: group[name] for name in ("input_ids", "attention_mask", "position_ids")}
    model.network(**inputs, labels=labels).loss.backward()


@torch.no_grad()
def _time_generation(model: Any) -> tuple[float, float]:
    """Return wall and CPU seconds to generate ``TOKENS`` tokens."""
    ids = torch.tensor([model.encode("Hey there! So, stroll past the sofa, then hang a left.")])
    model.network.eval()
    wall = time.perf_counter()
    cpu = time.process_time()
    model.network.generate(
        input_ids=ids,
        attention_mask=torch.ones_like(ids),
        max_new_tokens=TOKENS,
        min_new_tokens=TOKENS,
        do_sample=False,
        pad_token_id=model.tokenizer.pad_token_id,
    )
    return time.perf_counter() - wall, time.process_time() - cpu


def _resident_megabytes() -> float:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def _format(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure every kind and print a Markdown table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--base", default="smollm2-135m", help="as agent.base")
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--one", choices=KINDS, help="measure this kind here; print JSON")
    options = parser.parse_args(arguments)
    if options.one:
        print(json.dumps(measure(options.one, options.base)))
        return
    print(f"{torch.get_num_threads()} threads\n\n| weights | {' | '.join(COLUMNS.values())} |")
    print(f"| --- |{' ---: |' * len(COLUMNS)}")
    for kind in options.kinds:
        command = [sys.executable, "-m", "tools.bench.safeguard", "--one", kind]
        done = subprocess.run([*command, "--base", options.base], capture_output=True, text=True)
        if done.returncode:
            print(f"| {kind} | {done.stderr.strip().splitlines()[-1][:120]} |", flush=True)
            continue
        values = json.loads(done.stdout.strip().splitlines()[-1])
        print(f"| {kind} | {' | '.join(_format(values[n]) for n in COLUMNS)} |", flush=True)


if __name__ == "__main__":
    main()
