"""Train the classifier: ``python -m mitigate.guards.text.fit --out FOLDER``.

Reads the texts of a checkout (``tools/safeguard/data``). Each mechanism, bank and style belongs to
one of ``FOLDS`` folds. The second step is trained on scores by models that have not seen the fold,
so that it learns what new mechanisms in new styles look like.
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
from mitigate.core.seeding import generator
from mitigate.guards.text import classifier as model
from mitigate.guards.text.classifier import SIZE, Classifier
from mitigate.guards.text.decode import decode
from mitigate.guards.text.learning.lines import FOLDS, ROUTES, Line, compose, read_lines, varied
from mitigate.guards.text.pieces import clause_pieces, sentence_pieces

DATA = "tools/safeguard/data"
COMPOSED = 8000  # attacks in routes, for the second step
SEGMENTS = 18  # clauses of a text in the second step
WORDS = 6000  # common words, by which hidden text is recognised
RIDGE, STEPS, FOLD_STEPS = 2.0, 90, 50  # of the first step
WIDTH, RIDGE_2, STEPS_2 = 10, 3.0, 250  # of the second step
THRESHOLD = 0.6  # log odds of any span against none, from which it is taken out
Example = tuple[np.ndarray, np.ndarray]  # rows of the spans of a text, 1.0 for each that is right


def fit(
    folder: Path, count: int = COMPOSED, routes: int = ROUTES, log: Any = sys.stderr
) -> Classifier:
    """Return the classifier trained on the data of a folder."""
    lines = read_lines(folder, routes)
    words = common_words(lines)
    lines = varied(lines)
    folds, whole = first_step(lines, words, log)
    found = list(examples(lines, count, folds))
    print(f"second step: {len(found)} texts", file=log, flush=True)
    whole.arrays.update(second_step(found))
    return whole


def common_words(lines: Sequence[Line]) -> list[str]:
    """Return the words that occur most often in lines that hide nothing."""
    word = re.compile(r"[a-z]+(?:'[a-z]+)?")
    counts = Counter(w for line in lines for w in word.findall(line.text.lower()))
    return sorted(w for w, n in counts.most_common(WORDS) if n > 1)


def first_step(
    lines: Sequence[Line], words: list[str], log: Any
) -> tuple[list[Classifier], Classifier]:
    """Return a classifier per fold, which has not seen it, and one that has seen all lines; none of
    them has a second step yet."""
    pieces = list(_pieces(lines))
    known = frozenset(words)
    terms = [model.terms(decode(text, known), text, block) for text, block, _, _ in pieces]
    print(f"first step: {len(pieces)} pieces", file=log, flush=True)
    seen = Counter(index for found in terms for index in found)
    idf = np.zeros(SIZE, np.float32)
    for index, n in seen.items():
        idf[index] = np.log(len(terms) / n) + 1 if n > 1 else 0.0
    x = _matrix(terms, idf)
    attack = np.array([line.attack for _, _, line, _ in pieces])
    weight = np.array([weight for *_, weight in pieces])
    fold = np.array([line.fold for _, _, line, _ in pieces])
    config = {"words": words, "threshold": THRESHOLD}
    made = []
    for out in (*range(FOLDS), None):
        kept = np.ones(len(attack), bool) if out is None else fold != out
        steps = STEPS if out is None else FOLD_STEPS
        found, bias = regression(x[kept], attack[kept], weight[kept], steps)
        if not kept.all():
            right = (x[~kept] @ found + bias > 0) == attack[~kept]
            print(f"fold {out}: {100 * right.mean():.1f} % of unseen pieces", file=log, flush=True)
        made.append(Classifier({**config, "bias": bias}, {"idf": idf, "alone": found}))
    *folds, whole = made
    told = np.array([line.styled is not None for _, _, line, _ in pieces])
    styled = np.array([line.styled is True for _, _, line, _ in pieces])[told]
    found, whole.config["style_bias"] = regression(x[told], styled, weight[told], FOLD_STEPS)
    whole.arrays["style"] = found.astype(np.float32)
    return folds, whole


def _pieces(lines: Sequence[Line]) -> Iterator[tuple[str, bool, Line, float]]:
    """Yield (text, is a block, line, weight) of whole lines, their sentences and their clauses."""
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


def _matrix(found: Sequence[Mapping[int, int]], idf: np.ndarray) -> csr_matrix:
    """Return TF-IDF of the terms, rows of length 1; terms that occur once are left out."""
    rows = []
    for terms in found:
        index, value = model.weighted(terms, idf)
        index, value = index[value > 0], value[value > 0]
        rows.append((index, value / max(1e-6, float(np.linalg.norm(value)))))
    ends = np.cumsum([0, *(len(index) for index, _ in rows)])
    index = np.concatenate([index for index, _ in rows])
    value = np.concatenate([value for _, value in rows])
    return csr_matrix((value.astype(np.float64), index, ends), (len(rows), SIZE))


def regression(x: Any, y: np.ndarray, weight: np.ndarray, steps: int) -> tuple[np.ndarray, float]:
    """Return weights and bias of a logistic regression with an L2 penalty, classes balanced."""
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


def examples(lines: Sequence[Line], count: int, folds: Sequence[Classifier]) -> Iterator[Example]:
    """Yield the spans of composed texts, read by the model that has not seen their fold.

    An attack is also shown after a part of it was cut out, and after all of it was.
    """
    for number, made in enumerate(compose(lines, count)):
        reader = folds[made.fold]
        found = reader.segments(made.text)[:SEGMENTS]
        if len(found) < 2:
            continue
        first, last, rows = model.spans(found, reader.bias)
        right = np.zeros(len(first))
        for low, high in made.attacks:
            starts = np.array([s.piece.start for s in found])[first]
            ends = np.array([s.piece.end for s in found])[last]
            both = np.minimum(ends, high) - np.maximum(starts, low)
            share = both / (np.maximum(ends, high) - np.minimum(starts, low))
            if share.size and share.max() > 0.9:
                right[share.argmax()] = 1.0
        if right.any() or not made.attacks:
            yield rows, right
        if right.sum() == 1 and len(made.attacks) == 1:
            best = int(right.argmax())
            yield from _cut(found, int(first[best]), int(last[best]), number, reader.bias)


def _cut(
    found: list[model.Segment], low: int, high: int, number: int, bias: float
) -> Iterator[Example]:
    """Yield the spans that are left after all of an attack was cut out, and after a part was."""
    rest = [*found[:low], *found[high + 1 :]]
    if len(rest) > 1:
        _, _, rows = model.spans(rest, bias, {low})
        yield rows, np.zeros(len(rows))
    if high == low:
        return
    rng = generator(0, "cut", number)
    start = low if rng.random() < 0.5 else int(rng.integers(low, high + 1))
    end = int(rng.integers(start, high + (start > low)))
    rest = [*found[:start], *found[end + 1 :]]
    first, last, rows = model.spans(rest, bias, {start})
    parts = {(low, start - 1), (start, high - (end + 1 - start))}
    right = np.array([float(span in parts) for span in zip(first, last, strict=True)])
    if right.any():
        yield rows, right


def second_step(found: Sequence[Example]) -> dict[str, np.ndarray]:
    """Return weights of a small network that ranks the spans of a text, and leaving it alone at 0.

    Loss = -log(share of the right spans in the softmax over all spans and leaving the text alone).
    """
    rows = np.concatenate([rows for rows, _ in found])
    right = np.concatenate([right for _, right in found])
    sizes = np.array([len(rows) for rows, _ in found])
    starts = np.cumsum([0, *sizes[:-1]])
    nothing = np.array([not right.any() for _, right in found])
    scale = rows.std(0)
    scale[scale < 1e-6] = 1.0  # of the constant
    x = rows / scale
    f = x.shape[1]

    def unpacked(w: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        hidden = w[f : f + f * WIDTH].reshape(f, WIDTH)
        return w[:f], hidden, w[f + f * WIDTH : -WIDTH], w[-WIDTH:]

    def loss(w: np.ndarray) -> tuple[float, np.ndarray]:
        linear, hidden, shift, out = unpacked(w)
        inner = np.tanh(x @ hidden + shift)
        logit = x @ linear + inner @ out
        top = np.maximum(np.maximum.reduceat(logit, starts), 0)
        share = np.exp(logit - np.repeat(top, sizes))
        none = np.exp(-top)
        total = np.add.reduceat(share, starts) + none
        good = np.where(nothing, none, np.add.reduceat(share * right, starts))
        value = -float(np.log(good / total + 1e-30).sum())
        d = share / np.repeat(total, sizes)
        d -= share * right * np.repeat(np.where(nothing, 0, 1 / np.maximum(good, 1e-30)), sizes)
        inside = d[:, None] * out * (1 - inner**2)
        slope = np.concatenate([x.T @ d, (x.T @ inside).ravel(), inside.sum(0), inner.T @ d])
        return value + 0.5 * RIDGE_2 * float(w @ w), slope + RIDGE_2 * w

    start = generator(0, "second step").normal(0, 0.1, f + f * WIDTH + 2 * WIDTH)
    w = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": STEPS_2}).x
    linear, hidden, shift, out = unpacked(w)
    return {"linear": linear / scale, "hidden": hidden / scale[:, None], "shift": shift, "out": out}


def save(made: Classifier, folder: Path) -> None:
    """Write a classifier into a folder."""
    make_folder(folder)
    config = {**made.config, "bias": made.bias}
    write_text(folder / model.CONFIG, json.dumps(config) + "\n")
    large = ("idf", "alone", "style")
    arrays = {
        name: array.astype(np.float16 if name in large else np.float32)
        for name, array in made.arrays.items()
    }
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
