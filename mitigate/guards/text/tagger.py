"""A small network that edits speech into plain words: for each word or mark keep, drop or plain
form, and the phrase before it.

A word is read as its vector (of a language model's own table), its letters (hashed pieces of 3 to
5) and what the safeguard's word classes say of it, so none is unknown; five dilated convolutions
see 62 words to each side. It writes nothing of its own but the closed phrases
(:mod:`plain_words`), and cannot end too soon.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.core.checkpoint import load_weights
from mitigate.core.precision import to_device
from mitigate.corruptions.language.fidelity import ATTRIBUTES, COLOURS
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.tagger import Token
from mitigate.guards.text.fidelity.ways import RELATION
from mitigate.guards.text.language_models.word_vectors import (
    SCALE,
    SIZE,
    SMOLLM2,
    VECTORS,
    word_key,
    word_vectors,
)
from mitigate.guards.text.plain import edits
from mitigate.guards.text.plain.edits import DROP, KEEP, PLAIN, Edit
from mitigate.guards.text.plain.plainly_said import SPEECH, Tagged
from mitigate.guards.text.texts.evidence import LANDMARKS, VERBS
from mitigate.guards.text.texts.lexicon import FUNCTION, GROUPS
from mitigate.guards.text.texts.plain_words import PHRASES, plain_form

PIECES = 8192  # hashed pieces of words; 0 is none
LONGEST_WORD = 14  # pieces of a word that are read
TAGS = ("NOUN", "PROPN", "VERB", "ADJ", "ADV", "DET", "PRON", "AUX", "ADP", "PART", "CCONJ",
    "SCONJ", "NUM", "PUNCT", "X", "INTJ")  # fmt: skip
NO_PHRASE = 0.5  # from this probability on no phrase is put
Encoded = dict[str, list[Any]]
KNOWN = LANDMARKS | frozenset(CANONICAL)
SIDES = frozenset({"left", "right", "up", "down", "around", "straight", "back"})


class Block(nn.Module):
    """A residual convolution over the words, then one of each word."""

    def __init__(self, width: int, dilation: int, dropout: float) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(width)
        self.near = nn.Conv1d(width, width, 5, padding=2 * dilation, dilation=dilation)
        self.own = nn.Linear(width, width)
        self.dropout = nn.Dropout(dropout)

    def forward(self, seen: Tensor, mask: Tensor) -> Tensor:
        near = self.near((self.norm(seen) * mask).transpose(1, 2)).transpose(1, 2)
        return seen + self.dropout(self.own(nn.functional.gelu(near)))


class Tagger(nn.Module):
    """Args: base: language model whose word vectors are taken where a training begins without.
    width: of a word inside. spelling: of its letters. dropout: while training."""

    keys: Tensor
    vectors: Tensor

    def __init__(
        self, base: str = SMOLLM2, width: int = 112, spelling: int = 32, dropout: float = 0.2
    ) -> None:
        super().__init__()
        self.base = base
        self.register_buffer("keys", torch.zeros(VECTORS, dtype=torch.int64))
        self.register_buffer("vectors", torch.zeros(VECTORS, SIZE, dtype=torch.int8))
        self.pieces = nn.EmbeddingBag(PIECES, spelling, mode="mean", padding_idx=0)
        self.first = nn.Linear(SIZE + spelling + len(FLAGS), width)
        self.dropout = nn.Dropout(dropout)
        self.blocks = nn.ModuleList(Block(width, 2**i, dropout) for i in range(5))
        self.norm = nn.LayerNorm(width)
        self.act = nn.Linear(width, 3)
        self.before = nn.Linear(width, 1 + len(PHRASES))

    def learn_words(self) -> None:
        """Take the word vectors of the base, if there are none yet. Raises as ``load_base``."""
        if not self.keys.any():
            keys, vectors = word_vectors(self.base)
            self.keys.copy_(keys)
            self.vectors.copy_(vectors)

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, Tensor]:
        """Return logits of the acts [B, T, 3] and of the phrases [B, T, 1 + P].

        ``batch``: ``words`` int64 [B, T], ``pieces`` int64 [B, T, L], ``flags`` float [B, T, F],
        ``plain`` bool [B, T] (the token has a plain form), ``length`` int64 [B].
        """
        shape = batch["words"].shape
        spelled = self.pieces(batch["pieces"].flatten(0, 1)).view(*shape, -1)
        keys = batch["words"]
        at = torch.searchsorted(self.keys, keys).clamp(max=len(self.keys) - 1)
        vector = self.vectors[at].float() / SCALE * (self.keys[at] == keys)[..., None]
        seen = self.first(self.dropout(torch.cat([vector, spelled, batch["flags"]], -1)))
        places = torch.arange(shape[1], device=keys.device)
        mask = (places < batch["length"][:, None])[..., None].float()
        for block in self.blocks:
            seen = block(seen, mask)
        found = self.norm(seen)
        return only_with_plain_form(self.act(found), batch["plain"]), self.before(found)

    @torch.no_grad()
    def tag(self, text: str) -> Tagged:
        """Return the edits of a text and how probably each of its words goes; the same text always
        gets the same ones."""
        found = tuple(edits.tokens(text))
        if not found:
            return Tagged((), (), ())
        self.eval()
        read = self.collate([self.encode(found)])
        acts, before = (part[0].cpu() for part in self(to_device(read, self.act.weight.device)))
        return tagged(found, acts, before)

    def encode(self, found: Sequence[Token]) -> Encoded:
        """Return what the network reads of the tokens of a text."""
        pairs = [spelled(token.lower) for token in found]
        words, pieces = zip(*pairs, strict=True)
        return {"words": list(words), "pieces": list(pieces), **flags(found)}

    def collate(self, rows: Sequence[Encoded]) -> dict[str, Tensor]:
        """Return a batch of ``encode``'s rows, padded at the end."""
        lengths = [len(row["words"]) for row in rows]
        width = max(lengths)
        longest = max(len(p) for row in rows for p in row["pieces"])
        size = (len(rows), width)
        batch = {
            "words": torch.zeros(size, dtype=torch.long),
            "pieces": torch.zeros(*size, longest, dtype=torch.long),
            "flags": torch.zeros(*size, len(FLAGS)),
            "plain": torch.zeros(size, dtype=torch.bool),
            "length": torch.tensor(lengths),
        }
        for i, row in enumerate(rows):
            n = lengths[i]
            batch["words"][i, :n] = torch.tensor(row["words"])
            batch["flags"][i, :n] = torch.tensor(row["flags"])
            batch["plain"][i, :n] = torch.tensor(row["plain"])
            padded = [(*p, *[0] * (longest - len(p))) for p in row["pieces"]]
            batch["pieces"][i, :n] = torch.tensor(padded)
        return batch

    def hide(self, batch: dict[str, Tensor], share: float, rng: np.random.Generator) -> None:
        """Hide the vectors of a share of the words of a batch, and the letters of as many."""
        for name in ("words", "pieces"):
            chosen = rng.random(tuple(batch["plain"].shape)) < share
            batch[name][torch.from_numpy(chosen)] = 0

    def alone(self, text: str) -> str:
        """Return ``text`` after all edits, without rules and gate."""
        return self.tag(text).all_edits(text)


def open_tagger(folder: str | Path) -> Tagger:
    """Return the tagger of a folder; a ``config.yaml`` beside its weights is not read, as it is
    built with the sizes it has by default. Raises FileNotFoundError or ValueError, naming the file.
    """
    tagger = Tagger()
    load_weights(tagger, folder)
    return tagger.eval()


def only_with_plain_form(acts: Tensor, plain: Tensor) -> Tensor:
    """Return logits of the acts [B, T, 3] that say a word plainly only if it has a plain form."""
    barred = (torch.arange(3, device=plain.device) == PLAIN) & ~plain[..., None]
    return acts.masked_fill(barred, -30.0)


def tagged(
    found: tuple[Token, ...],
    acts: Tensor,
    before: Tensor,
    attack: Sequence[float] = (),
    least: float = SPEECH,
    more: float = 0.0,
) -> Tagged:
    """Return the tags of a text's tokens by logits of acts [T, 3] and phrases [T, 1 + P]."""
    acts, before = acts.softmax(-1), before.softmax(-1)
    phrase = before[:, 1:].argmax(-1) + 1
    phrase[before[:, 0] >= NO_PHRASE] = 0
    plain = acts[:, PLAIN] > acts[:, KEEP]
    made = [Edit(int(act), int(n)) for act, n in zip(plain * PLAIN, phrase, strict=True)]
    return Tagged(found, tuple(made), tuple(acts[:, DROP].tolist()), tuple(attack), least, more)


def _hash(text: str, size: int) -> int:
    return 1 + zlib.crc32(text.encode()) % (size - 1)


@lru_cache(maxsize=65536)
def spelled(word: str) -> tuple[int, tuple[int, ...]]:
    """Return a word's number and those of its pieces."""
    held = f"<{word}>"
    found = [held[i : i + n] for n in (3, 4, 5) for i in range(len(held) - n + 1)]
    pieces = [_hash(piece, PIECES) for piece in found[: 2 * LONGEST_WORD]] or [_hash(held, PIECES)]
    return word_key(word), tuple(pieces)


FLAGS = (
    *TAGS, *GROUPS,
    "function", "verb", "landmark", "relation", "side", "attribute", "colour", "digit",
    "first", "capital", "shout", "after mark", "before mark", "plain", "said before", "said after",
    "start", "end",
)  # fmt: skip


@lru_cache(maxsize=65536)
def _classes(word: str) -> tuple[float, ...]:
    return (
        *(float(word in group) for group in GROUPS.values()),
        *(float(word in group) for group in (FUNCTION, VERBS, KNOWN, RELATION, SIDES)),
        *(float(word in group) for group in (ATTRIBUTES, COLOURS)), float(word.isdigit()),
    )  # fmt: skip


def flags(found: Sequence[Token]) -> Encoded:
    """Return what the word classes, the letters and the places of the tokens say of them
    ("flags"), and whether each has a plain form ("plain")."""
    lower = [t.lower for t in found]
    last = {w: i for i, w in enumerate(lower)}
    first: dict[str, int] = {}
    rows: Encoded = {"flags": [], "plain": []}
    for i, token in enumerate(found):
        seen = first.setdefault(token.lower, i)
        has = plain_form(token.lower) != token.lower or token.text in edits.ENDS | edits.PAUSES
        rows["plain"].append(has)
        content = token.is_word and token.lower not in FUNCTION
        rows["flags"].append(
            (
                *(float(token.tag == name) for name in TAGS),
                *_classes(token.lower),
                float(i == 0 or found[i - 1].text in ".!?\n"),
                float(token.text[:1].isupper()),
                float(token.text.isupper() and len(token.text) > 1),
                float(i > 0 and not found[i - 1].is_word),
                float(i + 1 < len(found) and not found[i + 1].is_word),
                float(has),
                float(content and seen < i),
                float(content and last[token.lower] > i),
                1.0 - min(1.0, i / 40),
                1.0 - min(1.0, (len(found) - 1 - i) / 40),
            )
        )
    return rows
