"""Give an agent's weights the words of a new one: tools/widen_vocabulary.py FOLDER OUT KIND

    python tools/widen_vocabulary.py checkpoints/teacher runs/teacher topological

Words that the agent knows keep their embedding; a new word starts as the mean of the words that
``LIKE`` names for it, of all words if it names none, and is to be trained. Nothing else changes.
"""

from __future__ import annotations

import sys
from pathlib import Path

import torch
from omegaconf import OmegaConf
from torch import Tensor, nn

from mitigate.agents import loading
from mitigate.agents.text import SPECIAL, WORDS
from mitigate.core import checkpoint, conf
from mitigate.core.files import atomic_text
from mitigate.evaluation.evaluate import load
from mitigate.training.plan import agent_config

LIKE = {  # words of much the same use, where the first edition of the texts had some
    "after": "then next", "an": "a", "bear": "turn", "beside": "near by", "beyond": "past",
    "carry": "keep", "completely": "full", "cross": "go pass", "face": "look", "inside": "into",
    "locate": "find", "nearest": "near", "once": "when", "out": "exit leave",
    "proceed": "go continue", "search": "look find", "stand": "wait stop", "step": "walk go",
    "swing": "turn", "that": "the it", "towards": "to",
}  # fmt: skip


def widened(table: Tensor, known: list[str], words: tuple[str, ...]) -> Tensor:
    """Embeddings float32 [special and ``words``, width] of a ``table`` [special and ``known``,
    width]."""
    row = {word: index for index, word in enumerate((*SPECIAL, *known))}
    every = table[len(SPECIAL) :].mean(0)
    out = [table[: len(SPECIAL)]]
    for word in words:
        like = [row[w] for w in LIKE.get(word, "").split() if w in row]
        start = table[like].mean(0) if like else every
        out.append((table[row[word]] if word in row else start)[None])
    return torch.cat(out)


def main() -> None:
    """Run from the command line."""
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    source, folder, kind = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    node = conf.load_config("train", [f"agent={kind}"]).agent
    old = load(node, source)
    known = list(old.vocabulary.words)
    new = loading.build_agent(node, weights=None, seed=0)
    state, wanted = old.state_dict(), new.state_dict()
    for name, module in old.named_modules():
        if isinstance(module, nn.Embedding) and len(module.weight) == len(old.vocabulary):
            state[f"{name}.weight"] = widened(module.weight.data, known, WORDS)
    new.load_state_dict({name: state[name] for name in wanted})
    file = checkpoint.save_weights(new, folder, half=True)
    with atomic_text(folder / "config.yaml") as text:
        text.write(OmegaConf.to_yaml({"agent": agent_config(node, new)}))
    print(f"wrote {file}: {len(WORDS)} words, {len({*WORDS} - {*known})} of them new")


if __name__ == "__main__":
    main()
