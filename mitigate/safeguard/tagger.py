"""A small network that edits speech into plain words: for each word or mark keep, drop or plain
form, and the phrase before it.

A word is read as its letters (hashed pieces of 3 to 5) and as what the safeguard's word classes say
of it, so none is unknown; two layers of bidirectional GRU read the text. It writes nothing of its
own but the closed phrases (:mod:`plain_words`), and cannot end too soon.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from functools import lru_cache

import torch
from torch import Tensor, nn

from mitigate.corruptions.language.fidelity import ATTRIBUTES, COLOURS
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.tagger import Token
from mitigate.safeguard import edits
from mitigate.safeguard.edits import DROP, KEEP, Edit
from mitigate.safeguard.evidence import LANDMARKS, VERBS
from mitigate.safeguard.lexicon import FUNCTION, GROUPS
from mitigate.safeguard.plain_words import PHRASES, plain_form
from mitigate.safeguard.ways import RELATION

PIECES = 8192  # hashed pieces of words; 0 is none
VECTORS, SIZE = 21530, 48
LONGEST_WORD = 14  # pieces of a word that are read
TAGS = ("NOUN", "PROPN", "VERB", "ADJ", "ADV", "DET", "PRON", "AUX", "ADP", "PART", "CCONJ",
    "SCONJ", "NUM", "PUNCT", "X", "INTJ")  # fmt: skip
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
    """Args: width: of a word. hidden: of each direction of the GRU. dropout: while training."""

    def __init__(self, width: int = 112, spelling: int = 32, dropout: float = 0.2, vectors=VECTORS, size=SIZE) -> None:
        super().__init__()
        self.register_buffer("keys", torch.zeros(vectors, dtype=torch.int64))
        self.register_buffer("vectors", torch.zeros(vectors, size, dtype=torch.int8))
        self.pieces = nn.EmbeddingBag(PIECES, spelling, mode="mean", padding_idx=0)
        self.first = nn.Linear(size + spelling + len(FLAGS), width)
        self.dropout = nn.Dropout(dropout)
        self.blocks = nn.ModuleList(Block(width, 2**i, dropout) for i in range(5))
        self.norm = nn.LayerNorm(width)
        self.act = nn.Linear(width, 3)
        self.before = nn.Linear(width, 1 + len(PHRASES))

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, Tensor]:
        """Return logits of the acts [B, T, 3] and of the phrases [B, T, 1 + P].

        ``batch``: ``words`` int64 [B, T], ``pieces`` int64 [B, T, L], ``flags`` float [B, T, F],
        ``plain`` bool [B, T] (the token has a plain form), ``length`` int64 [B].
        """
        shape = batch["words"].shape
        spelled = self.pieces(batch["pieces"].flatten(0, 1)).view(*shape, -1)
        keys = batch["words"]
        at = torch.searchsorted(self.keys, keys).clamp(max=len(self.keys) - 1)
        vector = self.vectors[at].float() / 32 * (self.keys[at] == keys)[..., None]
        seen = self.first(self.dropout(torch.cat([vector, spelled, batch["flags"]], -1)))
        mask = (torch.arange(shape[1]) < batch["length"][:, None])[..., None].float()
        for block in self.blocks:
            seen = block(seen, mask)
        found = self.norm(seen)
        acts = self.act(found)
        plain = nn.functional.one_hot(torch.tensor(2), 3).bool() & ~batch["plain"][..., None]
        return acts.masked_fill(plain, -30.0), self.before(found)

    @torch.no_grad()
    def edit(self, texts: Sequence[str], keep: float = 0.5, add: float = 0.5) -> list[str]:
        return [edits.edited(t, e) for t, e in zip(texts, self.edits(texts, keep, add))]

    @torch.no_grad()
    def edits(self, texts: Sequence[str], keep: float = 0.5, add: float = 0.5) -> list[list[Edit]]:
        """Return the edits of each text."""
        self.eval()
        out = []
        for text in texts:
            found = edits.tokens(text)
            acts, before = self(collate([encode(found)]))
            p = acts[0].softmax(-1)
            q = before[0].softmax(-1)
            q0 = q[:, 0]
            row = []
            for i in range(len(found)):
                act = DROP if p[i, 1] > keep else (2 if p[i, 2] > p[i, 0] else KEEP)
                n = int(q[i, 1:].argmax()) + 1 if q0[i] < 1 - add else 0
                row.append(Edit(act, n))
            out.append(row)
        return out


def _hash(text: str, size: int) -> int:
    return 1 + zlib.crc32(text.encode()) % (size - 1)


@lru_cache(maxsize=65536)
def spelled(word: str) -> tuple[int, tuple[int, ...]]:
    """Return a word's number and those of its pieces."""
    held = f"<{word}>"
    found = [held[i : i + n] for n in (3, 4, 5) for i in range(len(held) - n + 1)]
    pieces = [_hash(piece, PIECES) for piece in found[: 2 * LONGEST_WORD]] or [_hash(held, PIECES)]
    return zlib.crc32(word.encode()), tuple(pieces)


FLAGS = (
    *TAGS,
    *GROUPS,
    "function", "verb", "landmark", "relation", "side", "attribute", "colour", "digit",
    "first", "capital", "shout", "after mark", "before mark", "plain", "said before", "said after", "start", "end"
)  # fmt: skip


@lru_cache(maxsize=65536)
def _classes(word: str) -> tuple[float, ...]:
    return (
        *(float(word in group) for group in GROUPS.values()),
        float(word in FUNCTION), float(word in VERBS), float(word in LANDMARKS or word in CANONICAL),
        float(word in RELATION), float(word in SIDES), float(word in ATTRIBUTES),
        float(word in COLOURS), float(word.isdigit()),
    )  # fmt: skip


def encode(found: Sequence[Token]) -> dict[str, list]:
    """Return what the network reads of the tokens of a text."""
    lower = [t.lower for t in found]
    last = {w: i for i, w in enumerate(lower)}
    first: dict[str, int] = {}
    rows: dict[str, list] = {"words": [], "pieces": [], "flags": [], "plain": []}
    for i, token in enumerate(found):
        seen = first.setdefault(token.lower, i)
        word, pieces = spelled(token.lower)
        rows["words"].append(word)
        rows["pieces"].append(pieces)
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


def collate(rows: Sequence[dict[str, list]]) -> dict[str, Tensor]:
    """Return a batch of :func:`encode`'s rows, padded at the end."""
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
