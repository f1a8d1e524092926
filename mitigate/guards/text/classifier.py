"""Which clauses of an instruction do not belong to it: logistic regression and a small network.

First step: a logistic regression over TF-IDF of words, word pairs and letter groups of a clause.
Second step: a network compares every run of clauses (a span) with the rest of the text. Inference
needs numpy alone; :mod:`fit` makes the weights.
"""

from __future__ import annotations

import math
import re
import zlib
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file

from mitigate.core import checksums
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.guards.text.decode import Decoded, decode
from mitigate.guards.text.pieces import Piece, clause_pieces, script, sentence_pieces

BITS = 18
SIZE = 1 << BITS  # of the table of hashed features
CONFIG, WEIGHTS = "classifier.json", "classifier.safetensors"
_TOKEN = re.compile(r"[a-z]+(?:['’][a-z]+)?|\d+|[^\w\s]|[^\W\d_]+")
_CAPITALS = re.compile(r"\b[A-Z]{2,}\b")
_SIGNS = re.compile(r"[<>{}\[\]|=_\\`#]|//|\(\)")
LIMIT = 8.0  # of a score that goes into the second step


def terms(said: Decoded, original: str, block: bool) -> Counter[int]:
    """Return hashed term -> count of a piece: words, pairs, letter groups, marks."""
    lower = said.text.lower().replace("’", "'")
    tokens = [
        t if not t.isdigit() else ("#" if len(t) < 3 else "###") for t in _TOKEN.findall(lower)
    ]
    words = [t for t in tokens if t[0].isalnum() or t[0] == "#"]
    names = [f"p {a} {b}" for a, b in zip(["^", *words], [*words, "$"], strict=True)]
    names += [f"s {a} {c}" for a, c in zip(words, words[2:], strict=False)]
    names += [f"m {t}" for t in tokens if not t[0].isalnum()]
    names += [f"= {mark}" for mark in said.marks]
    if block:
        names.append("= block")
    if len(_CAPITALS.findall(original)) > 1:
        names.append("= capitals")
    if _SIGNS.search(original):
        names.append("= signs")
    if script(original) == "other":
        names.append("= script")
    found = Counter(map(_hashed, names))
    for word in words:
        found.update(_word_terms(word))
    return found


def _hashed(name: str) -> int:
    return zlib.crc32(name.encode()) & (SIZE - 1)


@lru_cache(maxsize=20_000)
def _word_terms(word: str) -> tuple[int, ...]:
    """Return the terms of a word and of its groups of three to five letters."""
    edged = f"<{word}>"
    groups = [f"c{edged[i : i + n]}" for n in (3, 4, 5) for i in range(len(edged) - n + 1)]
    return tuple(map(_hashed, [f"w {word}", *groups]))


@dataclass(frozen=True)
class Segment:
    """A clause that was read. ``sentence``: number of its sentence. ``letters``: a sign of Chinese,
    Japanese or Korean counts as three. ``product``, ``style``: weights
    of attacks and of styles times its TF-IDF values. ``square``: sum of the squared values."""

    piece: Piece
    sentence: int
    words: int
    letters: int
    script: str
    hidden: bool
    product: float
    style: float
    square: float
    index: np.ndarray
    value: np.ndarray


FEATURES = (
    "cut", "whole", "rest", "evidence", "route evidence in it", "evidence in the rest",
    "lowest", "highest", "highest of the rest", "first part", "last part", "before", "after",
    "at the start", "at the end", "starts in a sentence", "ends in a sentence",
    "share of words", "words", "words of the rest", "block", "hidden", "hidden in the rest",
    "other script", "other script in the rest", "like the rest", "one part", "lowest sentence",
    "difference", "beside a cut", "whole beside a cut",
)  # fmt: skip


class Classifier:
    """Args:
    config: bias of the first step, common words, threshold.
    arrays: ``idf`` and ``alone`` [SIZE]; of the second step ``hidden`` [F, H], ``shift`` [H],
        ``out`` [H] and ``linear`` [F].
    """

    def __init__(self, config: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
        self.config = config
        self.known = frozenset(config["words"])
        self.bias = float(config["bias"])
        self.arrays = {name: array.astype(np.float32) for name, array in arrays.items()}
        self.idf, self.alone = self.arrays["idf"], self.arrays["alone"]
        self.threshold = float(config.get("threshold", 0.0))

    def segments(self, text: str) -> list[Segment]:
        """Return the clauses of a text, read one by one."""
        found = []
        style = self.arrays.get("style")
        for number, sentence in enumerate(sentence_pieces(text)):
            for piece in clause_pieces(text, sentence):
                said = piece.of(text)
                plain = decode(said, self.known)
                index, value = weighted(terms(plain, said, piece.block), self.idf)
                product = float(self.alone[index] @ value)
                square = float(value @ value)
                found.append(
                    Segment(
                        piece,
                        number,
                        len(said.split()),
                        sum(1 + 2 * ("\u3000" <= c <= "\ud7ff") for c in said if c.isalpha()),
                        script(said),
                        bool(plain.marks),
                        product,
                        float(style[index] @ value) if style is not None else 0.0,
                        square,
                        index,
                        value,
                    )
                )
        return found

    def styled(self, text: str) -> bool:
        """Return whether a sentence is in a style, not in the words of a plain route."""
        index, value = weighted(terms(decode(text, self.known), text, False), self.idf)
        norm = math.sqrt(float(value @ value)) + 1e-6
        product = float(self.arrays["style"][index] @ value)
        return product / norm + float(self.config["style_bias"]) > 0

    def logits(self, rows: np.ndarray) -> np.ndarray:
        """Return the score of every span, float [N]; that of leaving all as it is would be 0."""
        inner = np.tanh(rows @ self.arrays["hidden"] + self.arrays["shift"])
        return rows @ self.arrays["linear"] + inner @ self.arrays["out"]


def weighted(found: Mapping[int, int], idf: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return indices and TF-IDF values of terms."""
    index = np.fromiter(found, np.int64, len(found))
    count = np.fromiter(found.values(), np.float32, len(found))
    return index, (1 + np.log(count)) * idf[index] if len(index) else count


def spans(
    found: Sequence[Segment], bias: float, cuts: Collection[int] = ()
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return first and last segment of every span that may be cut, and its features [N, F].

    ``cuts``: places between the segments where something was cut out before.
    """
    n = len(found)
    first, last = np.triu_indices(n)
    keep = ~((first == 0) & (last == n - 1))
    first, last = first[keep], last[keep]

    def total(values: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        sums = np.concatenate([[0.0], np.cumsum(np.asarray(values, float))])
        inside = sums[last + 1] - sums[first]
        return inside, sums[-1] - inside

    product, product_rest = total([s.product for s in found])
    square, square_rest = total([s.square for s in found])
    whole = _clip(product / np.sqrt(square + 1e-6) + bias)
    rest = _clip(product_rest / np.sqrt(square_rest + 1e-6) + bias)
    score = _clip(np.array([s.product / math.sqrt(s.square + 1e-6) for s in found]) + bias)
    words, words_rest = total([s.words for s in found])
    sizes = np.array([s.words for s in found], float)
    for_route = np.maximum(-score, 0) * np.sqrt(sizes)
    for_attack = np.maximum(score, 0) * np.sqrt(sizes)
    evidence, evidence_rest = total(for_attack)
    route, _ = total(for_route)
    lowest, highest = _ranges(score, np.minimum), _ranges(score, np.maximum)
    head, tail = np.maximum.accumulate(score), np.maximum.accumulate(score[::-1])[::-1]
    below = np.concatenate([[-LIMIT], head])[first]
    above = np.concatenate([tail, [-LIMIT]])[last + 1]
    number = np.array([s.sentence for s in found])
    by_sentence = np.array([_sentence_score(found, k, bias) for k in range(number[-1] + 1)])[number]
    padded = np.concatenate([[0.0], score, [0.0]])
    edges = np.concatenate([[-1], number, [-1]])
    hidden, hidden_rest = total([float(s.hidden) for s in found])
    other, other_rest = total([s.words * (s.script == "other") for s in found])
    block, _ = total([float(s.piece.block) for s in found])
    beside = np.isin(first, list(cuts)) | np.isin(last + 1, list(cuts))
    table = np.stack(
        [
            np.ones(len(first)), whole, rest,
            np.log1p(evidence), np.log1p(route), np.log1p(evidence_rest),
            lowest[first, last], highest[first, last], np.maximum(below, above),
            score[first], score[last], padded[first], padded[last + 2],
            first == 0, last == n - 1,
            edges[first] == number[first], edges[last + 2] == number[last],
            words / np.maximum(words + words_rest, 1), np.log1p(words), np.log1p(words_rest),
            block > 0, hidden > 0, hidden_rest > 0,
            other / np.maximum(words, 1), other_rest / np.maximum(words_rest, 1),
            _likeness(found, first, last), first == last,
            _ranges(by_sentence, np.minimum)[first, last], whole - rest,
            beside, whole * beside,
        ],
        axis=1,
    )  # fmt: skip
    return first, last, table.astype(float)


def _sentence_score(found: Sequence[Segment], number: int, bias: float) -> float:
    parts = [s for s in found if s.sentence == number]
    product, square = sum(s.product for s in parts), sum(s.square for s in parts)
    return float(_clip(np.array(product / math.sqrt(square + 1e-6) + bias)))


def _likeness(found: Sequence[Segment], first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Return the cosine of every span to the rest of the text, of the whole words they share."""
    every = np.unique(np.concatenate([s.index for s in found]))
    table = np.zeros((len(found) + 1, len(every)), np.float32)
    for row, s in enumerate(found, 1):
        table[row, np.searchsorted(every, s.index)] = s.value
    sums = np.cumsum(table, axis=0)
    gram = sums @ sums.T
    a, b, n = first, last + 1, len(found)
    inside = gram[b, b] - 2 * gram[a, b] + gram[a, a]
    both = gram[b, n] - gram[a, n]
    rest = gram[n, n] - 2 * both + inside
    return (both - inside) / np.sqrt(np.maximum(inside * rest, 1e-6))


def _ranges(values: np.ndarray, reduce: np.ufunc) -> np.ndarray:
    """Return the reduction of ``values[i:j + 1]`` at [i, j]."""
    table = np.zeros((len(values), len(values)))
    for i in range(len(values)):
        table[i, i:] = reduce.accumulate(values[i:])
    return table


def _clip(score: np.ndarray) -> np.ndarray:
    return np.clip(score, -LIMIT, LIMIT)


@lru_cache(maxsize=4)
def load(folder: str | Path) -> Classifier:
    """Return the classifier of a folder. Raises FileNotFoundError if there is none, ValueError for
    damaged files."""
    config_file, file = Path(folder) / CONFIG, Path(folder) / WEIGHTS
    for needed in (config_file, file):
        if not needed.is_file():
            raise FileNotFoundError(
                f"There is no classifier in {folder}: {needed.name} is missing. {_AGAIN}"
            )
    problem = checksums.problem(file)
    try:
        config = read_json(config_file, _AGAIN)
        if not problem:
            classifier = Classifier(config, load_file(file))
            if classifier.idf.shape == classifier.alone.shape == (SIZE,):
                return classifier
            problem = "has arrays of another shape"
    except (ValueError, KeyError, TypeError, IndexError, SafetensorError) as error:
        problem = f"cannot be read ({short(str(error), 120)})"
    raise ValueError(f"The classifier in {folder} is damaged: {file.name} {problem}. {_AGAIN}")


_AGAIN = "Fetch the folder again, or train a classifier with `python -m mitigate.guards.text.fit`."
