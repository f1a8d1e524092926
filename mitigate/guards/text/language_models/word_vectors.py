"""Word vectors of a language model's own table of tokens, made small: 48 numbers of 8 bits a word.

Words that are used alike lie near each other in it, so that the tagger knows something of words
that no voice of the training says. The table of the default base is under Apache-2.0.
"""

from __future__ import annotations

import re
import zlib

import numpy as np
import torch
from torch import Tensor

from mitigate.guards.text.language_models.base import SMOLLM2, load_base

__all__ = ["SCALE", "SIZE", "SMOLLM2", "VECTORS", "word_key", "word_vectors"]
VECTORS, SIZE = 20000, 48  # words, the commonest first, and numbers of each (ours)
SCALE = 32.0  # of a standard deviation in 8 bits (ours)
FITTED = 12000  # commonest words, by which the directions are chosen (ours)
_WORD = re.compile(r"[\u0120\u2581]([a-z]+)")  # as tokenizers mark the beginning of a word


def word_key(word: str) -> int:
    """Return the number under which a word in lower case is kept."""
    return zlib.crc32(word.encode())


def word_vectors(base: str) -> tuple[Tensor, Tensor]:
    """Return keys int64 [V] in order and vectors int8 [V, SIZE] of the words that are tokens of
    ``base``, by principal components of the tokens' directions. Raises as :func:`load_base`."""
    tokenizer, network = load_base(base, "fp32")
    table = network.get_input_embeddings().weight.detach().float().numpy()  # type: ignore[operator]
    number = {
        match[1]: index
        for token, index in sorted(tokenizer.get_vocab().items(), key=lambda held: held[1])
        if index < len(table) and (match := _WORD.fullmatch(token))
    }
    words = list({word_key(word): word for word in reversed(number)}.values())[::-1][:VECTORS]
    keys = np.full(VECTORS, np.iinfo(np.int64).max)
    vectors = np.zeros((VECTORS, SIZE), np.int8)
    if words:
        found = _components(table[[number[word] for word in words]])
        order = np.argsort([word_key(word) for word in words])
        keys[: len(words)] = [word_key(words[i]) for i in order]
        small = np.clip(np.round(found[order] * SCALE), -127, 127)
        vectors[: len(words), : small.shape[1]] = small.astype(np.int8)
    return torch.from_numpy(keys), torch.from_numpy(vectors)


def _components(table: np.ndarray) -> np.ndarray:
    """Return the first components float32 [V, at most SIZE] of the rows' directions."""
    rows = table - table.mean(0)
    rows /= np.linalg.norm(rows, axis=1, keepdims=True) + 1e-9
    _, directions = np.linalg.eigh(rows[:FITTED].T @ rows[:FITTED])
    found = rows @ directions[:, ::-1][:, :SIZE]
    return found / (found.std() + 1e-9)
