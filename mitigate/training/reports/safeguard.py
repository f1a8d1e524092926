"""Measure how well safeguards repair corrupted instructions.

    python -m mitigate.training.reports.safeguard classifier lora --texts FILE --out report

Every instruction is corrupted by every family of corruptions, repaired, and compared with the
original. A name that ends in ``-alone`` selects the language model without the classifier and the
gate.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from torch import nn

from mitigate.core.addresses import check_choice
from mitigate.core.errors import error_message
from mitigate.core.files import atomic_text, find, open_text, write_text
from mitigate.core.markdown import markdown_table
from mitigate.core.options import positive
from mitigate.corruptions.instruction import corrupt_instruction
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.style import MANNERS
from mitigate.guards.text.guard import Rewriter, Safeguard, open_safeguard, passages
from mitigate.guards.text.learning.data import read_texts
from mitigate.guards.text.metrics import CLEAN, Repair, Scores, by_family, table
from mitigate.guards.text.pieces import sentences
from mitigate.worlds.episodes import read_episodes

FAMILIES = (CLEAN, *MANNERS, "capitalize", "mask", "black_box")
ALONE = "-alone"
Repairer = Callable[[list[str]], list[str]]


def corrupted(texts: Sequence[str], severity: float, split: str, seed: int = 0) -> list[Repair]:
    """Corrupt every text with every family.

    The results are not repaired: ``repaired`` equals ``heard``.
    """
    repairs = []
    for family in FAMILIES:
        for index, clean in enumerate(texts):
            heard = clean
            if family != CLEAN:
                key = Key(seed, f"text {index}")
                heard = corrupt_instruction(clean, family, severity, key, split=split)
            attack = heard[: -len(clean)] if family == "black_box" else ""
            repairs.append(Repair(family, clean, heard, heard, tuple(sentences(attack))))
    return repairs


def repaired(repairs: Sequence[Repair], repairer: Repairer) -> list[Repair]:
    """Return a copy of ``repairs`` in which ``repairer`` has repaired the texts."""
    heard = list(dict.fromkeys(r.heard for r in repairs))
    answers = dict(zip(heard, repairer(heard), strict=True))
    return [Repair(r.family, r.clean, r.heard, answers[r.heard], r.injected) for r in repairs]


def alone(rewriter: Rewriter) -> Repairer:
    """Return a function that repairs instructions with a language model.

    The function uses neither the classifier nor the gate.
    """

    def repair(texts: list[str]) -> list[str]:
        parts = [passages(text) for text in texts]
        pieces = list(dict.fromkeys(part for text_parts in parts for part in text_parts))
        rewritten = dict(zip(pieces, rewriter.rewrite(pieces), strict=True))
        return [
            " ".join(rewritten[part] or "" for part in text_parts).strip() for text_parts in parts
        ]

    return repair


def guarded(safeguard: Safeguard) -> Repairer:
    """Return a function that repairs instructions with a safeguard."""
    return lambda texts: [decision.text for decision in safeguard.canonicalise_all(texts)]


def choose(name: str) -> Repairer:
    """Return the repair function for a name that was given on the command line."""
    if name == "none":
        return list
    check_choice(name)
    safeguard = open_safeguard(name.removesuffix(ALONE))
    if safeguard is not None and not name.endswith(ALONE):
        return guarded(safeguard)
    if safeguard is None or safeguard.rewriter is None:
        raise ValueError(
            f"{name} must be a safeguard with a language model, which {ALONE} uses without the "
            f"classifier. Choose lora{ALONE} or prompted{ALONE}."
        )
    return alone(safeguard.rewriter)


def before_after(cfg: Any, before: Any, trained: nn.Module, folder: Path) -> None:
    """Print and write text metrics of a language model before and after fine-tuning.

    For comparison, also report the metrics of the classifier and the metrics without a safeguard.
    ``cfg`` is the config of the training run. The first ``evaluation.episodes`` instructions of
    ``evaluation.split`` are used, and each is corrupted by one family of corruptions. The attacks
    come from the test split. ``before`` is not used. For the metrics before fine-tuning, the
    adapter of the trained model is disabled, and an explanatory prompt is used instead.
    """
    quick = cfg.evaluation
    listed = islice(read_episodes(find(cfg.env.episodes[quick.split])), quick.episodes)
    texts = [episode.instruction.text for episode in listed]
    every = corrupted(texts, cfg.severity, "test", cfg.seed)
    chosen = [
        r for i, r in enumerate(every) if i % len(FAMILIES) == (i // len(texts)) % len(FAMILIES)
    ]
    with trained.untuned() as untuned:  # type: ignore[operator]
        before_alone = repaired(chosen, alone(untuned))
    results = {
        "none": chosen,
        "classifier": repaired(chosen, guarded(Safeguard())),
        "before, alone": before_alone,
        "after, alone": repaired(chosen, alone(trained)),  # type: ignore[arg-type]
        "after, guarded": repaired(chosen, guarded(Safeguard(trained))),  # type: ignore[arg-type]
    }
    write(results, folder, f"{quick.split}, severity {cfg.severity:g}, unseen attacks")


def write(results: dict[str, list[Repair]], folder: Path, title: str) -> None:
    """Write ``text.md`` and ``repairs.jsonl`` into ``folder`` and print the tables."""
    parts = [f"# Text metrics: {title}\n\nValues are percentages, except the count.\n"]
    parts.append(summary({name: by_family(repairs) for name, repairs in results.items()}))
    for name, repairs in results.items():
        parts.append(f"\n## {name}\n\n{table(by_family(repairs))}\n")
    write_text(folder / "text.md", "\n".join(parts))
    with atomic_text(folder / "repairs.jsonl") as file:
        for name, repairs in results.items():
            for r in repairs:
                line = {"safeguard": name, "family": r.family, "clean": r.clean}
                file.write(json.dumps({**line, "heard": r.heard, "repaired": r.repaired}) + "\n")
    print("\n".join(parts), flush=True)
    print(f"wrote {folder / 'text.md'}\nwrote {folder / 'repairs.jsonl'}", flush=True)


def summary(scores: dict[str, dict[str, Scores]]) -> str:
    """Return one Markdown row per safeguard, with means over the corrupted families."""
    head = ["safeguard", "directions", "landmarks", "token F1", "attacks removed", "clean changed"]
    lines = []
    for name, families in scores.items():
        corrupted_families = {f: s for f, s in families.items() if f not in (CLEAN, "all")}
        count = sum(s.count for s in corrupted_families.values())
        means = [
            sum(s.count * (vars(s)[field] or 0.0) for s in corrupted_families.values()) / count
            if count
            else None
            for field in ("directions", "landmarks", "token_f1")
        ]
        removed, clean = families["all"].removed, families["all"].changed
        cells = [*means, removed, clean]
        lines.append([name, *("–" if c is None else f"{100 * c:.1f}" for c in cells)])
    return markdown_table(head, lines)


def read_lines(path: str, count: int | None) -> list[str]:
    """Return the instructions of an episode file, or the lines of a text file."""
    if path.endswith((".json", ".json.gz")):
        return read_texts([path])[:count]
    with open_text(path) as file:
        lines = [line.strip() for line in file if line.strip() and not line.startswith("#")]
    return lines[:count]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("safeguards", nargs="+", help="none, classifier, lora-alone, a folder, ...")
    parser.add_argument(
        "--texts", required=True, help="episode file, or text file with one per line"
    )
    parser.add_argument("--count", type=positive, help="number of texts; default all")
    parser.add_argument("--severity", type=float, default=1.0)
    parser.add_argument("--split", default="test", help="attacks: train, validation, test")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("runs/safeguard-text"))
    options = parser.parse_args(arguments)
    texts = read_lines(options.texts, options.count)
    if not texts:
        raise ValueError(f"There are no instructions in {options.texts}.")
    changed = corrupted(texts, options.severity, options.split, options.seed)
    results = {}
    for name in options.safeguards:
        began = time.monotonic()
        results[name] = repaired(changed, choose(name))
        spent = (time.monotonic() - began) / len(changed)
        print(f"{name}: {1000 * spent:.1f} ms per instruction, in batches", flush=True)
    about = f"{len(texts)} texts, severity {options.severity:g}, {options.split} attacks"
    write(results, options.out, f"{Path(options.texts).name}, {about}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error_message(error)}")
