"""Train the classifier: ``python -m mitigate.guards.text.fit --out FOLDER``.

The command reads the texts of a checkout (``tools/safeguard/data``). One logistic regression learns
whether a sentence or clause belongs to an attack, and a second one whether it is in an unusual
style.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from safetensors.numpy import save_file
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from mitigate.core import checksums
from mitigate.core.files import find, make_folder, write_text
from mitigate.guards.text import classifier as model
from mitigate.guards.text.classifier import SIZE, Classifier
from mitigate.guards.text.decode import decode
from mitigate.guards.text.learning.lines import ROUTES, Line, read_lines, varied
from mitigate.guards.text.pieces import clause_pieces, sentence_pieces

DATA = "tools/safeguard/data"
WORDS = 6000  # number of common words, which are used to recognise hidden text
RIDGE = 2.0  # penalty
STEPS, STYLE_STEPS = 90, 50


def fit(folder: Path, routes: int = ROUTES, log: Any = sys.stderr) -> Classifier:
    """Train a classifier on the data in a folder."""
    lines = read_lines(folder, routes)
    words = common_words(lines)
    pieces = list(_pieces(varied(lines)))
    known = frozenset(words)
    terms = [model.terms(decode(text, known), text, block) for text, block, _, _ in pieces]
    print(f"training on {len(pieces)} pieces of text", file=log, flush=True)
    seen = Counter(index for term_counts in terms for index in term_counts)
    idf = np.zeros(SIZE, np.float32)
    for index, n in seen.items():
        idf[index] = np.log(len(terms) / n) + 1 if n > 1 else 0.0
    x = _matrix(terms, idf)
    weight = np.array([weight for *_, weight in pieces])
    attack = np.array([line.attack for _, _, line, _ in pieces])
    alone, bias = regression(x, attack, weight, STEPS)
    right = (x @ alone + bias > 0) == attack
    print(f"{100 * right.mean():.1f} % of them are recognised", file=log, flush=True)
    known_style = np.array([line.styled is not None for _, _, line, _ in pieces])
    styled = np.array([line.styled is True for _, _, line, _ in pieces])[known_style]
    style, style_bias = regression(x[known_style], styled, weight[known_style], STYLE_STEPS)
    config = {"words": words, "bias": bias, "style_bias": style_bias}
    return Classifier(config, {"idf": idf, "alone": alone, "style": style})


def common_words(lines: Sequence[Line]) -> list[str]:
    """Return the most frequent words in lines without hidden text."""
    word = re.compile(r"[a-z]+(?:'[a-z]+)?")
    counts = Counter(w for line in lines for w in word.findall(line.text.lower()))
    return sorted(w for w, n in counts.most_common(WORDS) if n > 1)


def _pieces(lines: Sequence[Line]) -> Iterator[tuple[str, bool, Line, float]]:
    """Yield (text, is a block, line, weight) for whole lines, their sentences and their clauses."""
    for line in lines:
        for text in line.text.split("{route}"):
            sentences = sentence_pieces(text)
            if len(sentences) > 1:
                yield text, False, line, 0.5 * line.weight
            for piece in sentences:
                yield piece.of(text), piece.block, line, line.weight
                clauses = clause_pieces(text, piece)
                for clause in clauses if len(clauses) > 1 else ():
                    yield clause.of(text), clause.block, line, 0.4 * line.weight


def _matrix(term_counts: Sequence[Mapping[int, int]], idf: np.ndarray) -> csr_matrix:
    """Return the TF-IDF of terms, with rows of length 1; terms that occur once are omitted."""
    rows = []
    for terms in term_counts:
        index, value = model.weighted(terms, idf)
        index, value = index[value > 0], value[value > 0]
        rows.append((index, value / max(1e-6, float(np.linalg.norm(value)))))
    ends = np.cumsum([0, *(len(index) for index, _ in rows)])
    index = np.concatenate([index for index, _ in rows])
    value = np.concatenate([value for _, value in rows])
    return csr_matrix((value.astype(np.float64), index, ends), (len(rows), SIZE))


def regression(x: Any, y: np.ndarray, weight: np.ndarray, steps: int) -> tuple[np.ndarray, float]:
    """Fit a logistic regression with an L2 penalty and balanced classes; return weights and
    bias.
    """
    weight = weight / np.where(y, weight[y].sum(), weight[~y].sum()) * len(y) / 2
    sign = np.where(y, 1.0, -1.0)

    def loss(w: np.ndarray) -> tuple[float, np.ndarray]:
        margin = sign * (x @ w[:-1] + w[-1])
        slope = -sign * weight / (1 + np.exp(np.clip(margin, -30, 30)))
        value = float(weight @ np.logaddexp(0, -margin)) + 0.5 * RIDGE * float(w[:-1] @ w[:-1])
        return value, np.append(x.T @ slope + RIDGE * w[:-1], slope.sum())

    start = np.zeros(x.shape[1] + 1)
    w = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": steps}).x
    return w[:-1], float(w[-1])


def save(trained: Classifier, folder: Path) -> None:
    """Write a classifier into a folder."""
    make_folder(folder)
    write_text(folder / model.CONFIG, json.dumps(trained.config) + "\n")
    arrays = {name: array.astype(np.float16) for name, array in trained.arrays.items()}
    checksums.write(folder / model.WEIGHTS, lambda file: save_file(arrays, file))


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m mitigate.guards.text.fit", description=__doc__)
    parser.add_argument("--data", type=Path, default=find(DATA), help="banks and styles")
    parser.add_argument("--out", type=Path, required=True, help="folder of the new classifier")
    options = parser.parse_args(arguments)
    save(fit(options.data), options.out)
    print(f"wrote {options.out}: try it with safeguard={options.out}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")
