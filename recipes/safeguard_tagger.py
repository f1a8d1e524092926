"""Training of the safeguard's tagger: which words of speech a plain route keeps.

Loss = cross-entropy of the acts (keep, drop, plain form) + w x that of the phrases before them,
both averaged over the words and marks of the step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import cross_entropy

from mitigate.core.seeding import generator
from mitigate.safeguard.lessons import draw_lesson
from mitigate.safeguard.metrics import token_f1
from mitigate.safeguard.report import voices
from mitigate.safeguard.tagger import Encoded, Tagger, collate, encode
from mitigate.training.recipe import Recipe

IGNORED = -100
Taught = tuple[int, Encoded, list[int], list[int]]  # a lesson: number, words, acts, phrases


class SafeguardTagger(Recipe):
    """Args:
    agent: the tagger, trained in place.
    texts: a step. micro_batch: of them at once, of like length. phrases: weight of their loss.
    forget: share of words whose vector, and of those whose spelling, is hidden.
    """

    here = True  # a lesson is quick

    def __init__(
        self,
        agent: Tagger,
        texts: int = 32,
        micro_batch: int = 16,
        phrases: float = 0.5,
        forget: float = 0.1,
        seed: int = 0,
    ) -> None:
        super().__init__()
        if not 1 <= micro_batch <= texts or not 0 <= forget < 1:
            raise ValueError(
                f"recipe.micro_batch ({micro_batch}) must be from 1 to recipe.texts ({texts}), "
                f"recipe.forget ({forget}) from 0 to below 1."
            )
        self.agent, self.texts, self.micro_batch, self.phrases = agent, texts, micro_batch, phrases
        self.forget, self.seed = forget, seed

    def start(self) -> None:
        self.agent.learn_words()

    def jobs(self, step: int) -> list[int]:
        return list(range(step * self.texts, (step + 1) * self.texts))

    def work(self, job: int) -> Taught:
        found, edits = draw_lesson(self.seed, job)
        return job, encode(found), [e.act for e in edits], [e.before for e in edits]

    def collate(self, step: int, pieces: list[Taught]) -> dict[str, Any]:
        rng = generator(self.seed, "forget", step)
        lessons = sorted(pieces, key=lambda piece: len(piece[2]))
        starts = range(0, len(lessons), self.micro_batch)
        groups = [self._group(lessons[i : i + self.micro_batch], rng) for i in starts]
        return {"groups": groups, "episode_ids": [f"lesson {number}" for number, *_ in lessons]}

    def _group(self, lessons: list[Taught], rng: np.random.Generator) -> dict[str, Tensor]:
        _, encoded, acts, before = zip(*lessons, strict=True)
        group = collate(encoded)
        size = group["words"].shape
        for name, rows in (("acts", acts), ("before", before)):
            group[name] = torch.full(size, IGNORED)
            for row, numbers in enumerate(rows):
                group[name][row, : len(numbers)] = torch.tensor(numbers)
        for name in ("words", "pieces"):
            group[name][torch.from_numpy(rng.random(tuple(size)) < self.forget)] = 0
        return group

    def weight(self, batch: dict[str, Any]) -> float:
        """Words and marks of the step."""
        return float(sum(int(group["length"].sum()) for group in batch["groups"]))

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Texts of like length, with their share of the step's words."""
        tokens = self.weight(batch)
        return [{"group": group, "tokens": tokens} for group in batch["groups"]]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        group, tokens = batch["group"], batch["tokens"]
        acts, before = self.agent(group)
        found = _summed(acts, group["acts"]) / tokens
        put = _summed(before, group["before"]) / tokens
        right = (acts.argmax(-1) == group["acts"]).sum() / tokens
        return {
            "loss": found + self.phrases * put, "acts": found, "phrases": put, "accuracy": right,
        }  # fmt: skip

    def evaluate(self, step: int) -> dict[str, float]:
        """F1 of the words of the validation voices, by the tagger alone and before it, over 30
        texts."""
        heard = voices("validation", 30)
        said = [token_f1(r.clean, self.agent.alone(r.heard)) for r in heard]
        before = [token_f1(r.clean, r.heard) for r in heard]
        return {"f1": sum(said) / len(said), "f1_before": sum(before) / len(before)}


def _summed(logits: Tensor, wanted: Tensor) -> Tensor:
    flat = logits.flatten(0, 1).float()
    return cross_entropy(flat, wanted.flatten(), ignore_index=IGNORED, reduction="sum")
