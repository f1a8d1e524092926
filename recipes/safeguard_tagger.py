"""Training of the safeguard's tagger or reader: which words of speech a plain route keeps.

Loss = cross-entropy of the acts (keep, drop, plain form) + w x that of the phrases before them
+ for a reader that of being part of an attack, all averaged over the words and marks of the step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits, cross_entropy

from mitigate.core.names import unknown
from mitigate.core.seeding import generator
from mitigate.guards.text.learning import trials
from mitigate.guards.text.learning.attacked import draw_attacked
from mitigate.guards.text.learning.lessons import draw_lesson
from mitigate.guards.text.metrics import token_f1
from mitigate.guards.text.reader import Reader
from mitigate.guards.text.tagger import Encoded, Tagger
from mitigate.training.objective import Objective, check_weights
from mitigate.training.reports.safeguard import voices

IGNORED = -100
NAMES = ("acts", "before", "attack")  # what is taught of each word
Taught = tuple[int, Encoded, tuple[list[int], ...]]  # a lesson: number, words, what is taught


class SafeguardTagger(Objective):
    """Args:
    agent: the tagger or reader, trained in place.
    texts: a step. micro_batch: of them at once, of like length. phrases: weight of their loss.
    forget: share of words that are hidden. attacked: share of lessons about attacks, with those of
    the split ``banks`` ("all" or "tune").
    """

    here = True  # a lesson is quick
    needs = ("tag", "hide", "collate")
    otherwise = "It takes a tagger or a reader in an agent's place: agent=tagger or agent=reader."

    def __init__(
        self,
        agent: Tagger | Reader,
        texts: int = 32,
        micro_batch: int = 16,
        phrases: float = 0.5,
        forget: float = 0.1,
        attacked: float = 0.0,
        banks: str = "all",
        seed: int = 0,
    ) -> None:
        super().__init__()
        if not 1 <= micro_batch <= texts or not 0 <= forget < 1 or not 0 <= attacked <= 1:
            raise ValueError(
                f"recipe.micro_batch ({micro_batch}) must be from 1 to recipe.texts ({texts}), "
                f"recipe.forget ({forget}) from 0 to below 1, recipe.attacked ({attacked}) from 0 "
                "to 1."
            )
        check_weights(phrases=phrases)
        if banks not in (*trials.SPLITS, trials.ALL):
            raise ValueError(unknown("split of the banks", banks, (*trials.SPLITS, trials.ALL)))
        if isinstance(agent, Reader):
            agent.freeze()
        self.agent, self.texts, self.micro_batch, self.phrases = agent, texts, micro_batch, phrases
        self.forget, self.attacked, self.banks, self.seed = forget, attacked, banks, seed

    def start(self) -> None:
        if isinstance(self.agent, Tagger):
            self.agent.learn_words()

    def jobs(self, step: int) -> list[int]:
        return list(range(step * self.texts, (step + 1) * self.texts))

    def work(self, job: int) -> Taught:
        about = generator(self.seed, "about", job).random() < self.attacked
        lesson = draw_attacked(self.seed, job, self.banks) if about else draw_lesson(self.seed, job)
        taught = (
            [IGNORED if e is None else e.act for e in lesson.edits],
            [IGNORED if e is None else e.before for e in lesson.edits],
            [IGNORED if a is None else int(a) for a in lesson.attack],
        )
        return job, self.agent.encode(lesson.tokens), taught

    def collate(self, step: int, pieces: list[Taught]) -> dict[str, Any]:
        rng = generator(self.seed, "forget", step)
        lessons = sorted(pieces, key=lambda piece: len(piece[2][0]))
        starts = range(0, len(lessons), self.micro_batch)
        groups = [self._group(lessons[i : i + self.micro_batch], rng) for i in starts]
        return {"groups": groups, "episode_ids": [f"lesson {number}" for number, *_ in lessons]}

    def _group(self, lessons: list[Taught], rng: np.random.Generator) -> dict[str, Tensor]:
        _, encoded, taught = zip(*lessons, strict=True)
        group = self.agent.collate(encoded)
        for name, rows in zip(NAMES, zip(*taught, strict=True), strict=True):
            group[name] = torch.full(group["plain"].shape, IGNORED)
            for row, numbers in enumerate(rows):
                group[name][row, : len(numbers)] = torch.tensor(numbers)
        self.agent.hide(group, self.forget, rng)
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
        acts, before, *attack = self.agent(group)
        found = _summed(acts, group["acts"]) / tokens
        put = _summed(before, group["before"]) / tokens
        right = (acts.argmax(-1) == group["acts"]).sum() / tokens
        out = {"acts": found, "phrases": put, "accuracy": right, "loss": found + self.phrases * put}
        if attack:
            told = group["attack"] != IGNORED
            known, wanted = attack[0][told], group["attack"][told].float()
            out["attack"] = (
                binary_cross_entropy_with_logits(known, wanted, reduction="sum") / tokens
            )
            out["attack_accuracy"] = ((known > 0) == (wanted > 0)).sum() / tokens
            out["loss"] = out["loss"] + out["attack"]
        return out

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
