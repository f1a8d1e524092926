"""Memory and speed of the safeguard's language model: ``python -m tools.bench.safeguard``.

Each precision runs in a process of its own: resident memory once loaded, tokens a second of
training (the recipe's own steps; prompts and completions counted, padding not), seconds to write 60
tokens greedily. The public baseline is transformers with PEFT as their guides have it: the whole
batch at once, logits of all positions, weights in float32, no autocast.
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
KINDS = {  # name -> precision of the weights, autocast, as the recipe does
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
    "train_tokens_cpu_s": "the same a CPU second",
    "greedy_s": f"{TOKENS} tokens greedily, s",
    "greedy_cpu_s": "the same, CPU s",
}


def measure(kind: str, base: str) -> dict[str, float]:
    """Return the figures of one kind, measured in this process."""
    from mitigate.guards.text.language_models.model import LanguageModel
    from mitigate.recipes.safeguard_lora import SafeguardLora
    from mitigate.training.objective import accumulate

    precision, autocast, ours = KINDS[kind]
    cfg = conf.load_config("train", ["recipe=safeguard_lora"])
    model = LanguageModel(base, precision, dict(cfg.agent.lora))
    found = {"loaded_mb": _resident()}
    recipe = SafeguardLora(model, pairs=16, micro_batch=4 if ours else 16)
    cpu_device, computed = torch.device("cpu"), "bf16" if autocast else "fp32"
    accumulate(recipe, recipe.batch(0), "fp32", cpu_device)  # warm
    batches = [recipe.batch(step) for step in range(1, STEPS + 1)]
    tokens = sum(int(g["attention_mask"].sum()) for b in batches for g in b["groups"])
    began, cpu = time.perf_counter(), time.process_time()
    for batch in batches:
        if ours:
            accumulate(recipe, batch, computed, cpu_device)
        else:
            _plain_step(model, batch["groups"][0])
    found["train_tokens_s"] = tokens / (time.perf_counter() - began)
    found["train_tokens_cpu_s"] = tokens / (time.process_time() - cpu)
    found["greedy_s"], found["greedy_cpu_s"] = _greedy(model)
    found["peak_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    return found


def _plain_step(model: Any, group: dict[str, torch.Tensor]) -> None:
    labels = torch.full_like(group["input_ids"], -100)
    width = group["completion"].shape[1]
    tail = labels[:, -width:]
    tail[group["completion"]] = group["input_ids"][:, -width:][group["completion"]]
    given = {name: group[name] for name in ("input_ids", "attention_mask", "position_ids")}
    model.network(**given, labels=labels).loss.backward()


@torch.no_grad()
def _greedy(model: Any) -> tuple[float, float]:
    ids = torch.tensor([model.encode("Hey there! So, stroll past the sofa, then hang a left.")])
    model.network.eval()
    began, cpu = time.perf_counter(), time.process_time()
    model.network.generate(
        input_ids=ids,
        attention_mask=torch.ones_like(ids),
        max_new_tokens=TOKENS,
        min_new_tokens=TOKENS,
        do_sample=False,
        pad_token_id=model.tokenizer.pad_token_id,
    )
    return time.perf_counter() - began, time.process_time() - cpu


def _resident() -> float:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def _shown(value: float) -> str:
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
        found = json.loads(done.stdout.strip().splitlines()[-1])
        print(f"| {kind} | {' | '.join(_shown(found[n]) for n in COLUMNS)} |", flush=True)


if __name__ == "__main__":
    main()
