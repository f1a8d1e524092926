"""Score the clauses of an instruction with logistic regressions on TF-IDF features.

The terms are words, pairs of words, and groups of letters. The scores are input features of the
network in :mod:`segmenter`. Inference needs only numpy; :mod:`fit` trains the weights.
"""

from __future__ import annotations

import math
import re
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file

from mitigate.core import folders
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.guards.text.decode import Decoded, decode
from mitigate.guards.text.features import features
from mitigate.guards.text.pieces import Piece, clause_pieces, script, sentence_pieces
from mitigate.guards.text.segmenter import NAMES, Segmenter

BITS = 18
SIZE = 1 << BITS  # length of the weight arrays; terms are hashed to indices below this number
CONFIG, WEIGHTS = "classifier.json", "classifier.safetensors"
EMPTY = 1e-3  # if the sum of squared TF-IDF values is below this, the text contains no known term
ARRAYS = ("idf", "alone", "style")
_TOKEN = re.compile(r"[a-z]+(?:['’][a-z]+)?|\d+|[^\w\s]|[^\W\d_]+")
_CAPITALS = re.compile(r"\b[A-Z]{2,}\b")
_SIGNS = re.compile(r"[<>{}\[\]|=_\\`#]|//|\(\)")


def terms(clause: Decoded, original: str, block: bool) -> Counter[int]:
    """Return the counts of a clause's hashed terms.

    Terms are words, pairs of words, groups of letters, punctuation, and marks of hidden text.
    """
    lower = clause.text.lower().replace("’", "'")
    tokens = [
        t if not t.isdigit() else ("#" if len(t) < 3 else "###") for t in _TOKEN.findall(lower)
    ]
    words = [t for t in tokens if t[0].isalnum() or t[0] == "#"]
    names = [f"p {a} {b}" for a, b in zip(["^", *words], [*words, "$"], strict=True)]
    names += [f"s {a} {c}" for a, c in zip(words, words[2:], strict=False)]
    names += [f"m {t}" for t in tokens if not t[0].isalnum()]
    names += [f"= {mark}" for mark in clause.marks]
    if block:
        names.append("= block")
    if len(_CAPITALS.findall(original)) > 1:
        names.append("= capitals")
    if _SIGNS.search(original):
        names.append("= signs")
    if script(original) == "other":
        names.append("= script")
    counts = Counter(map(_hashed, names))
    for word in words:
        counts.update(_word_terms(word))
    return counts


def _hashed(name: str) -> int:
    return zlib.crc32(name.encode()) & (SIZE - 1)


@lru_cache(maxsize=20_000)
def _word_terms(word: str) -> tuple[int, ...]:
    """Return the hashed terms of a word and of its groups of three to five letters."""
    edged = f"<{word}>"
    groups = [f"c{edged[i : i + n]}" for n in (3, 4, 5) for i in range(len(edged) - n + 1)]
    return tuple(map(_hashed, [f"w {word}", *groups]))


@dataclass(frozen=True)
class Clause:
    """A clause of an instruction with its features."""

    piece: Piece  # position of the clause in the text
    sentence: int  # index of the sentence that contains the clause
    words: int  # number of words
    letters: int  # number of letters; a Chinese, Japanese or Korean character counts as three
    script: str  # "latin", "other", or "" if the clause has no letters
    index: np.ndarray  # int64, indices of its terms
    value: np.ndarray  # float32, TF-IDF values of its terms
    product: float  # sum of the products of the clause's TF-IDF values and the attack weights
    square: float  # sum of the clause's squared TF-IDF values
    style: float  # log odds that the clause is in an unusual style


class Classifier:
    """The trained weights, and methods that score texts with them.

    Args:
        config: The list of common words, and the biases of the two regressions.
        arrays: ``idf``, the attack weights ``alone`` and the style weights ``style``, each of shape
            [SIZE]. The weights of the networks (:class:`Segmenter`) are also included, except while
            a classifier is trained.
    """

    def __init__(self, config: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
        self.config = config
        self.known = frozenset(config["words"])
        self.bias = float(config["bias"])
        self.style_bias = float(config["style_bias"])
        self.arrays = {name: arrays[name].astype(np.float32) for name in ARRAYS}
        self.idf = self.arrays["idf"]
        if NAMES[0] in arrays:
            self.segmenter = Segmenter(arrays)
            self.arrays |= self.segmenter.arrays

    def clauses(self, text: str) -> list[Clause]:
        """Split a text into clauses, and return them with their features."""
        results = []
        for number, sentence in enumerate(sentence_pieces(text)):
            for piece in clause_pieces(text, sentence):
                raw = piece.of(text)
                plain = decode(raw, self.known)
                index, value = weighted(terms(plain, raw, piece.block), self.idf)
                square = float(value @ value)
                style = float(self.arrays["style"][index] @ value) / (math.sqrt(square) + 1e-6)
                clause = Clause(
                    piece,
                    number,
                    len(raw.split()),
                    sum(1 + 2 * ("\u3000" <= c <= "\ud7ff") for c in raw if c.isalpha()),
                    script(raw),
                    index,
                    value,
                    float(self.arrays["alone"][index] @ value),
                    square,
                    style + self.style_bias,
                )
                results.append(clause)
        return results

    def score(self, clauses: Sequence[Clause]) -> float:
        """Return the log odds that the text formed by ``clauses`` is an attack."""
        product = sum(clause.product for clause in clauses)
        return float(self.log_odds(product, sum(clause.square for clause in clauses)))

    def log_odds(self, product: Any, square: Any) -> np.ndarray:
        """Return the log odds of an attack, or 0 for an empty text.

        ``product`` and ``square`` are sums of these attributes over the clauses of the text.
        """
        odds = product / np.sqrt(np.maximum(square, EMPTY)) + self.bias
        return np.where(np.asarray(square) > EMPTY, odds, 0.0)

    def attack(self, text: str, clauses: Sequence[Clause], bonus: float) -> tuple[float, int, int]:
        """Return the log odds that a text contains an attack, and the position of the attack.

        The position consists of the indices of the first and the last clause of the attack. A
        larger ``bonus`` favours longer attacks (:meth:`Segmenter.attack`).
        """
        return self.segmenter.attack(features(text, clauses, self), bonus)

    def styled(self, text: str) -> bool:
        """Return whether the style of a sentence differs from plain route instructions."""
        index, value = weighted(terms(decode(text, self.known), text, False), self.idf)
        norm = math.sqrt(float(value @ value)) + 1e-6
        return float(self.arrays["style"][index] @ value) / norm + self.style_bias > 0


def weighted(counts: Mapping[int, int], idf: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the indices of the terms in ``counts`` and their TF-IDF values."""
    index = np.fromiter(counts, np.int64, len(counts))
    count = np.fromiter(counts.values(), np.float32, len(counts))
    return index, (1 + np.log(count)) * idf[index] if len(index) else count


@lru_cache(maxsize=4)
def load(folder: str | Path) -> Classifier:
    """Load the classifier in a folder.

    Raises FileNotFoundError if a file is missing, and ValueError if a file is damaged.
    """
    config_file = Path(folder) / CONFIG
    file = Path(folder) / WEIGHTS
    for needed in (config_file, file):
        if not needed.is_file():
            raise FileNotFoundError(
                f"There is no classifier in {folder}: {needed.name} is missing. {_AGAIN}"
            )
    folders.check(folder, again=_AGAIN)
    try:
        config, arrays = read_json(config_file, _AGAIN), load_file(file)
        classifier = Classifier(config, {name: arrays[name] for name in (*ARRAYS, *NAMES)})
        numbers = [*classifier.arrays.values(), classifier.bias, classifier.style_bias]
        if any(classifier.arrays[name].shape != (SIZE,) for name in ARRAYS):
            problem = "has arrays of another shape"
        elif not all(np.isfinite(np.asarray(number)).all() for number in numbers):
            problem = "has values that are not finite"
        else:
            clauses = classifier.clauses(_TRIAL)  # fails if arrays of the networks do not fit
            if math.isfinite(classifier.attack(_TRIAL, clauses, 0.0)[0]):
                return classifier
            problem = "gives scores that are not finite"
    except (*_INVALID, SafetensorError) as error:
        problem = f"cannot be read ({short(str(error), 120)})"
    raise ValueError(f"The classifier in {folder} is damaged: {file.name} {problem}. {_AGAIN}")


_TRIAL = "Turn left at the lamp. Stop."  # a classifier is tried on this text when it is loaded
_INVALID = (ValueError, KeyError, TypeError, IndexError, OverflowError)
_AGAIN = "Fetch the folder again, or train a classifier with `python -m mitigate.guards.text.fit`."
