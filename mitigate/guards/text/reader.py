"""A small language model that reads an instruction both ways and says of each word what becomes of
it: keep, drop or plain form, the phrase before it, and whether it is part of an attack.

all-MiniLM-L6-v2 (:mod:`minilm`) stays frozen; LoRA in all its layers and three heads are learned. A
head sees the first and the last piece of a word, and what the safeguard's word classes say of it
(as the :mod:`tagger` does, whose place it takes).
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.core.checkpoint import WEIGHTS, load_tensors, load_weights
from mitigate.core.precision import to_device
from mitigate.core.public_weights import borrow
from mitigate.corruptions.language.tagger import Token
from mitigate.guards.text.choices import not_in
from mitigate.guards.text.language_models import minilm
from mitigate.guards.text.plain import edits
from mitigate.guards.text.plain.plainly_said import Tagged
from mitigate.guards.text.tagger import (
    FLAGS,
    Encoded,
    Tagger,
    flags,
    only_with_plain_form,
    open_tagger,
    tagged,
)
from mitigate.guards.text.texts.plain_words import PHRASES

LONGEST = 250  # words and marks that are read at once; a longer text in pieces (512 positions)
# mean probability of dropping a word from which a text counts as speech, and how much more if each
# clause begins as a route's does: 0.1 % of R2R-CE's train texts do, 94 % of the validation voices'
SPEECH, LED = 0.38, 0.2
LAYERS = ("query", "key", "value", "dense")
KEPT = 512  # texts whose tags are remembered


class Reader(nn.Module):
    """Args: rank: of the LoRA. width: of a word before the heads. dropout: while training.

    Raises FileNotFoundError without the package of MiniLM, ValueError if it holds other weights.
    """

    def __init__(self, rank: int = 16, width: int = 256, dropout: float = 0.1) -> None:
        logging.getLogger("bitsandbytes").setLevel(logging.ERROR)  # peft loads it; not used here
        from peft import LoraConfig, inject_adapter_in_model

        super().__init__()
        config = LoraConfig(r=rank, lora_alpha=2 * rank, target_modules=list(LAYERS))
        self.encoder = inject_adapter_in_model(config, minilm.network(dropout))
        borrowed = {n for n in self.state_dict() if "lora_" not in n}
        borrow(self, tuple(borrowed), minilm.SHA256, "an all-MiniLM-L6-v2")
        self.mix = nn.Sequential(
            nn.Dropout(dropout),
            nn.Linear(2 * minilm.WIDTH + len(FLAGS), width),
            nn.GELU(),
            nn.Dropout(dropout),
        )
        self.act = nn.Linear(width, 3)
        self.before = nn.Linear(width, 1 + len(PHRASES))
        self.attack = nn.Linear(width, 1)
        self._known: dict[str, Tagged] = {}

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, Tensor, Tensor]:
        """Return logits of the acts [B, T, 3], of the phrases [B, T, 1 + P] and of an attack
        [B, T].

        ``batch``: ``pieces`` int64 [B, L], ``read`` bool [B, L] (a piece, no padding), ``ends``
        int64 [B, T, 2] (first and last piece of a word), ``flags`` float [B, T, F], ``plain`` bool
        [B, T] (the token has a plain form), ``length`` int64 [B].
        """
        hidden = self.encoder(
            input_ids=batch["pieces"], attention_mask=batch["read"].long()
        ).last_hidden_state
        shape = batch["ends"].shape[:2]
        at = batch["ends"].flatten(1)[..., None].expand(-1, -1, hidden.shape[-1])
        ends = hidden.gather(1, at).view(*shape, -1)
        seen = self.mix(torch.cat([ends, batch["flags"].to(ends.dtype)], -1))
        acts = only_with_plain_form(self.act(seen).float(), batch["plain"])
        return acts, self.before(seen).float(), self.attack(seen)[..., 0].float()

    def freeze(self) -> None:
        """Leave the public weights as they are in a training."""
        for name, parameter in self.encoder.named_parameters():
            parameter.requires_grad_("lora_" in name)

    @torch.no_grad()
    def tag(self, text: str) -> Tagged:
        """Return what becomes of each word of a text, and how probably it is part of an attack;
        the same text always gets the same."""
        if text not in self._known:
            while len(self._known) >= KEPT:
                self._known.pop(next(iter(self._known)))
            self._known[text] = self._tag(text)
        return self._known[text]

    def _tag(self, text: str) -> Tagged:
        found = tuple(edits.tokens(text))
        if not found:
            return Tagged((), (), ())
        self.eval()
        parts = [found[i : i + LONGEST] for i in range(0, len(found), LONGEST)]
        read = [
            to_device(self.collate([self.encode(part)]), self.act.weight.device) for part in parts
        ]
        logits = [[part[0].cpu() for part in self(batch)] for batch in read]
        acts, before, attack = (torch.cat(part) for part in zip(*logits, strict=True))
        return tagged(found, acts, before, attack.sigmoid().tolist(), SPEECH, LED)

    def train(self, mode: bool = True) -> Reader:
        """As ever; what was remembered of texts is forgotten when the weights may change."""
        if mode:
            self._known.clear()
        return super().train(mode)

    def encode(self, found: Sequence[Token]) -> Encoded:
        """Return what the network reads of the tokens of a text."""
        read = minilm.tokenizer().encode([t.text for t in found], is_pretokenized=True)
        ends = [[0, 0] for _ in found]  # of a token without a piece: the text's beginning
        for place, word in enumerate(read.word_ids):
            if word is not None:
                ends[word] = [ends[word][0] or place, place]
        return {"pieces": read.ids, "ends": ends, **flags(found)}

    def collate(self, rows: Sequence[Encoded]) -> dict[str, Tensor]:
        """Return a batch of :meth:`encode`'s rows, padded at the end."""
        lengths = [len(row["ends"]) for row in rows]
        pieces, words = max(len(row["pieces"]) for row in rows), max(lengths)
        batch = {
            "pieces": torch.zeros(len(rows), pieces, dtype=torch.long),
            "read": torch.zeros(len(rows), pieces, dtype=torch.bool),
            "ends": torch.zeros(len(rows), words, 2, dtype=torch.long),
            "flags": torch.zeros(len(rows), words, len(FLAGS)),
            "plain": torch.zeros(len(rows), words, dtype=torch.bool),
            "length": torch.tensor(lengths),
        }
        for i, row in enumerate(rows):
            batch["read"][i, : len(row["pieces"])] = True
            for name in ("pieces", "ends", "flags", "plain"):
                values = torch.tensor(row[name])
                batch[name][i, : len(values)] = values.to(batch[name].dtype)
        return batch

    def hide(self, batch: dict[str, Tensor], share: float, rng: np.random.Generator) -> None:
        """Hide a share of the words of a batch: their pieces become one that means nothing."""
        chosen = torch.from_numpy(rng.random(tuple(batch["plain"].shape)) < share)
        unknown = minilm.tokenizer().token_to_id("[MASK]")
        places = torch.arange(batch["pieces"].shape[1])
        for row, word in chosen.nonzero().tolist():
            first, last = batch["ends"][row, word].tolist()
            if first:
                batch["pieces"][row, (places >= first) & (places <= last)] = unknown

    def alone(self, text: str) -> str:
        """Return ``text`` after all edits, without rules and gate."""
        return self.tag(text).all_edits(text)


def open_tags(folder: str | Path) -> Reader | Tagger:
    """Return the reader or tagger of a folder, told apart by the names of its weights; a
    ``config.yaml`` beside them is not read, as both are built with the sizes they have by default.
    Raises FileNotFoundError or ValueError, naming the file."""
    file = Path(folder) / WEIGHTS
    if not file.is_file():
        raise FileNotFoundError(not_in(folder))
    names = load_tensors(file).keys()
    if "public" not in names:
        if "keys" not in names:
            raise ValueError(f"{file} holds weights of another network. {not_in(folder)}")
        return open_tagger(folder)
    reader = Reader()
    load_weights(reader, folder)
    return reader.eval()
