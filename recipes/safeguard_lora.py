"""LoRA fine-tuning of the safeguard's language model: corrupted text in, plain text out.

Loss = cross-entropy on the completion alone, averaged over its tokens in the whole step. A step's
pairs are grouped by length into micro-batches.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from torch import Tensor

from mitigate.core.files import sha256
from mitigate.core.precision import to_device
from mitigate.core.seeding import generator
from mitigate.guards.text.language_models.model import LanguageModel
from mitigate.guards.text.language_models.tokens import collate, encode_pair
from mitigate.guards.text.learning.data import Pair, draw_pair, read_chats, read_texts
from mitigate.training.objective import Objective

Encoded = tuple[int, list[int], list[int]]  # of a pair: its number, prompt and completion
_HELD = 10**9  # pairs from here on are for evaluation


class SafeguardLora(Objective):
    """Args:
    agent: the language model; its adapter is trained in place.
    pairs: a step. micro_batch: pairs at once in memory.
    files: episode files of R2R or RxR whose instructions are corrupted as well as our own.
    chats: chat files (``messages``) of further pairs.
    share: of a step's pairs that come from either, from both alike if both are given.
    """

    ahead = True
    needs = ("rewrite", "tokenizer")
    otherwise = "It takes a language model in an agent's place: agent=safeguard."

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
            raise ValueError(
                f"recipe.micro_batch ({micro_batch}) must be from 1 to recipe.pairs ({pairs})."
            )
        self.agent, self.pairs, self.micro_batch = agent, pairs, micro_batch
        self.encode_pair = partial(encode_pair, agent.tokenizer, agent.prompt)  # without the agent
        self.texts = read_texts(files or [])
        self.chats = [pair for path in chats or [] for pair in read_chats(path)]
        self.share, self.seed = share, seed
        self.read = [*(files or []), *(chats or [])]
        for name, parameter in agent.named_parameters():
            parameter.requires_grad_("lora_" in name)

    def identity(self) -> dict[str, str]:
        return {path: sha256(path) for path in self.read}

    def pair(self, index: int) -> Pair:
        """Return the pair ``index``, a function of the seed."""
        if not self.chats:
            return draw_pair(self.seed, index, self.texts, self.share)
        rng = generator(self.seed, "chat", index)
        given = rng.random() < self.share
        if given and not (self.texts and rng.random() < 0.5):
            return self.chats[int(rng.integers(len(self.chats)))]
        return draw_pair(self.seed, index, self.texts, float(given))

    def jobs(self, step: int) -> list[int]:
        return list(range(step * self.pairs, (step + 1) * self.pairs))

    def work(self, job: int) -> Encoded:
        return (job, *self.encode_pair(self.pair(job)))

    def __getstate__(self) -> dict[str, Any]:
        """What workers need: all but the language model, which is large."""
        return {**self.__dict__, "_modules": {}}

    def collate(self, step: int, pieces: list[Encoded]) -> dict[str, Any]:
        return self._batch(pieces)

    def weight(self, batch: dict[str, Any]) -> float:
        """Tokens of the completions."""
        return float(sum(int(group["completion"].sum()) for group in batch["groups"]))

    def _batch(self, pieces: list[Encoded]) -> dict[str, Any]:
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
        """One group each, with its share of the step's tokens."""
        tokens = self.weight(batch)
        return [{"group": group, "tokens": tokens} for group in batch["groups"]]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        loss, correct = self.agent.loss(batch["group"])
        own, tokens = batch["group"]["completion"].sum(), batch["tokens"]
        return {"loss": loss / tokens, "accuracy": correct / tokens, "tokens": own.float()}

    def evaluate(self, step: int) -> dict[str, float]:
        """Loss and accuracy on pairs that training never draws."""
        pieces = [self.work(index) for index in range(_HELD, _HELD + 4 * self.pairs)]
        held = self.micro_batches(self._batch(pieces))
        values = [self(to_device(part, self.agent.device)) for part in held]
        return {n: float(sum(part[n] for part in values)) for n in ("loss", "accuracy")}
