"""Fine-tune the safeguard's language model with LoRA to rewrite corrupted text as plain text.

The loss is the cross-entropy of the completions, averaged over all completion tokens in a step. The
pairs of a step are grouped by length into micro-batches.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from torch import Tensor

from mitigate.core.files import sha256
from mitigate.core.precision import to_device
from mitigate.core.seeding import generator
from mitigate.guards.text.language_models.model import LanguageModel, collate, encode_pair
from mitigate.guards.text.learning.data import Pair, draw_pair, read_chats, read_texts
from mitigate.training.objective import Objective

Encoded = tuple[int, list[int], list[int]]  # index, prompt and completion of a pair
_HELD_OUT = 10**9  # index of the first pair for evaluation


class SafeguardLora(Objective):
    """Fine-tune the language model of the safeguard.

    Args:
        agent: the language model, whose adapter is trained in place.
        pairs: number of pairs per step.
        micro_batch: number of pairs in memory at once.
        files: episode files of R2R or RxR with additional instructions to corrupt.
        chats: chat files (``messages``) with additional pairs.
        share: fraction of pairs from ``files`` and ``chats``; if both are set, each provides half
            of it.
        seed: seed of the pairs.
    """

    ahead = True
    needs = ("rewrite", "tokenizer")
    otherwise = "This recipe trains a language model: set agent=safeguard."

    def __init__(
        self,
        agent: LanguageModel,
        pairs: int = 16,
        micro_batch: int = 4,
        files: list[str] | None = None,
        chats: list[str] | None = None,
        share: float = 0.5,
        seed: int = 0,
    ) -> None:
        super().__init__()
        if not 1 <= micro_batch <= pairs:
            raise ValueError(f"micro_batch must be from 1 to pairs ({pairs}), got {micro_batch}.")
        self.agent = agent
        self.pairs = pairs
        self.micro_batch = micro_batch
        self.encode_pair = partial(encode_pair, agent.tokenizer, agent.prompt)  # without the agent
        self.texts = read_texts(files or [])
        self.chats = [pair for path in chats or [] for pair in read_chats(path)]
        self.share = share
        self.seed = seed
        self.paths = [*(files or []), *(chats or [])]
        for name, parameter in agent.named_parameters():
            parameter.requires_grad_("lora_" in name)

    def identity(self) -> dict[str, str]:
        return {path: sha256(path) for path in self.paths}

    def pair(self, index: int) -> Pair:
        """Return the pair with this index; it depends only on the seed."""
        if not self.chats:
            return draw_pair(self.seed, index, self.texts, self.share)
        rng = generator(self.seed, "chat", index)
        from_files = rng.random() < self.share
        if from_files and not (self.texts and rng.random() < 0.5):
            return self.chats[int(rng.integers(len(self.chats)))]
        return draw_pair(self.seed, index, self.texts, float(from_files))

    def jobs(self, step: int) -> list[int]:
        return list(range(step * self.pairs, (step + 1) * self.pairs))

    def work(self, job: int) -> Encoded:
        return (job, *self.encode_pair(self.pair(job)))

    def __getstate__(self) -> dict[str, Any]:
        """Return the state for pickling. Workers do not need the language model, which is large."""
        return {**self.__dict__, "_modules": {}}

    def weight(self, batch: dict[str, Any]) -> float:
        """Return the number of tokens in the completions."""
        return float(sum(int(group["completion"].sum()) for group in batch["groups"]))

    def collate(self, step: int, pieces: list[Encoded]) -> dict[str, Any]:
        encoded = sorted(pieces, key=lambda row: len(row[1]) + len(row[2]))
        pad = self.agent.tokenizer.pad_token_id
        groups = [
            encoded[i : i + self.micro_batch] for i in range(0, len(encoded), self.micro_batch)
        ]
        return {
            "groups": [collate([(p, c) for _, p, c in group], pad) for group in groups],
            "episode_ids": [f"pair {index}" for index, _, _ in encoded],
        }

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Return the micro-batches, each with the number of completion tokens in the batch."""
        tokens = self.weight(batch)
        return [{"group": group, "tokens": tokens} for group in batch["groups"]]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        loss, correct = self.agent.loss(batch["group"])
        completion_tokens, tokens = batch["group"]["completion"].sum(), batch["tokens"]
        return {
            "loss": loss / tokens,
            "accuracy": correct / tokens,
            "tokens": completion_tokens.float(),
        }

    def evaluate(self, step: int) -> dict[str, float]:
        """Return loss and accuracy on pairs that are never used in training."""
        pieces = [self.work(index) for index in range(_HELD_OUT, _HELD_OUT + 4 * self.pairs)]
        batches = self.micro_batches(self.collate(step, pieces))
        values = [self(to_device(part, self.agent.device)) for part in batches]
        return {n: float(sum(part[n] for part in values)) for n in ("loss", "accuracy")}
