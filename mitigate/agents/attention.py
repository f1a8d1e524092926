"""Attention, transformer layers, and the instruction encoder of the planner and the policy."""

from __future__ import annotations

from torch import Tensor, nn

from mitigate.agents.text import MAX_WORDS, NEAR, PAD, THINGS, Vocabulary


class Attention(nn.Module):
    """Multi-head attention; ``mask`` is bool, True where attention is allowed.

    PyTorch's fused kernel is not used, because it took four times as long on a CPU for these short
    sequences (torch 2.13).
    """

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads, self.scale = heads, (width // heads) ** -0.5
        self.q = nn.Linear(width, width)
        self.kv = nn.Linear(width, 2 * width)
        self.out = nn.Linear(width, width)

    def forward(
        self, x: Tensor, memory: Tensor, mask: Tensor | None, rows: Tensor | None = None
    ) -> Tensor:
        """Apply attention with queries from x [B, n, width] and keys and values from memory.

        ``memory`` has the shape [B, m, width]. If ``rows`` is set, it uses ``memory[rows]``.
        """

        def split(t: Tensor) -> Tensor:
            return t.unflatten(-1, (self.heads, -1)).transpose(-2, -3)

        pairs = self.kv(memory) if rows is None else self.kv(memory)[rows]
        k, v = pairs.chunk(2, -1)
        scores = split(self.q(x)) @ split(k).transpose(-1, -2) * self.scale
        if mask is not None:
            scores = scores.masked_fill(~mask[:, None, None, :], -1e4)
        return self.out((scores.softmax(-1).to(v.dtype) @ split(v)).transpose(-2, -3).flatten(-2))


class Layer(nn.Module):
    """Pre-norm transformer layer: optional cross-attention, self-attention and feed-forward."""

    def __init__(self, width: int, heads: int, cross: bool, dropout: float) -> None:
        super().__init__()
        self.cross = Attention(width, heads) if cross else None
        self.cross_norm = nn.LayerNorm(width) if cross else None
        self.self_norm, self.ff_norm = nn.LayerNorm(width), nn.LayerNorm(width)
        self.attention = Attention(width, heads)
        self.ff = nn.Sequential(nn.Linear(width, 3 * width), nn.GELU(), nn.Linear(3 * width, width))
        self.dropout = nn.Dropout(dropout)

    def forward(
        self, x: Tensor, mask: Tensor | None, text: tuple[Tensor, Tensor, Tensor] | None = None
    ) -> Tensor:
        """Apply the layer.

        Args:
            x: [B, n, width].
            mask: bool [B, n], True where attention is allowed; None allows it everywhere.
            text: text features [E, L, width], their mask [B, L], and for each row of x the index of
                its text (int [B]).
        """
        if self.cross is not None and self.cross_norm is not None and text is not None:
            x = x + self.cross(self.cross_norm(x), *text)
        y = self.self_norm(x)
        x = x + self.attention(y, y, mask)
        return x + self.dropout(self.ff(self.ff_norm(x)))


class TextReader(nn.Module):
    """Base class of networks that read an instruction with a small transformer.

    Args:
        vocabulary: words of the instructions.
        width: width of all layers.
        heads: attention heads.
        layers: transformer layers over the text.
        dropout: dropout rate.
    """

    concept_words: Tensor
    seen: nn.Linear  # layers of :meth:`concept_features`, which a subclass creates
    close: nn.Linear
    kinds: nn.Linear

    def __init__(
        self, vocabulary: Vocabulary, width: int, heads: int, layers: int, dropout: float
    ) -> None:
        super().__init__()
        if width % heads:
            raise ValueError(f"width ({width}) must be a multiple of heads ({heads}).")
        self.words = nn.Embedding(len(vocabulary), width, padding_idx=PAD)
        nn.init.normal_(self.words.weight, std=0.5)
        self.places = nn.Embedding(MAX_WORDS, width)
        nn.init.normal_(self.places.weight, std=0.1)
        self.register_buffer("concept_words", vocabulary.concept_words(), persistent=False)
        self.text = nn.ModuleList([Layer(width, heads, False, dropout) for _ in range(layers)])
        self.text_norm = nn.LayerNorm(width)

    def concept_features(self, concepts: Tensor) -> list[Tensor]:
        """Return three features [..., width]: for objects, near objects and other concepts.

        ``concepts`` [..., C] holds the probability of each concept.
        """
        meaning = self.concept_words @ self.words.weight  # [concepts, width]
        parts = ((self.seen, THINGS), (self.close, NEAR), (self.kinds, slice(NEAR.stop, None)))
        return [layer(concepts[..., part] @ meaning[part]) for layer, part in parts]

    def read(self, tokens: Tensor) -> tuple[Tensor, ...]:
        """Return text features [E, L, width] and mask [E, L] of token ids [E, L]."""
        mask = tokens != PAD
        x = self.words(tokens) + self.places.weight[: tokens.shape[1]]
        for layer in self.text:
            x = layer(x, mask)
        return self.text_norm(x), mask
