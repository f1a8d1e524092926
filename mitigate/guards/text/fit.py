"""Train the classifier: ``python -m mitigate.guards.text.fit --out FOLDER``.

The command needs a checkout of the repository, because it reads the texts in
``tools/safeguard/data``. First, two logistic regressions are trained: one predicts whether a
sentence or clause belongs to an attack, and the other whether it is in an unusual style. Then a
network is trained to find where an attack begins and ends. It is trained on benign texts, most of
which contain an inserted attack. The regression scores of a training text come from regressions
that were trained without the text's fold. Otherwise, the scores would be more accurate than the
scores of new texts, and the network would rely on them too much.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from safetensors.numpy import save_file
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from mitigate.core import folders
from mitigate.core.errors import error_message
from mitigate.core.files import find, write_json
from mitigate.core.progress import say
from mitigate.guards.text import classifier as model
from mitigate.guards.text.classifier import SIZE, Classifier
from mitigate.guards.text.decode import decode
from mitigate.guards.text.features import features
from mitigate.guards.text.learning.lines import ROUTES, Line, read_frames, read_lines, varied
from mitigate.guards.text.learning.segmentation import LONGEST, Example, train
from mitigate.guards.text.learning.splices import FOLDS, SPLICES, Splice, fold_of, splices
from mitigate.guards.text.pieces import clause_pieces, sentence_pieces
from mitigate.guards.text.segmenter import NAMES

DATA = "tools/safeguard/data"
# maximum number of common words; hidden text is recognised with the help of these words
WORDS = 6000
BACKWARDS = 50  # a word counts as written backwards if its reversal is this many times as frequent
RIDGE = 2.0  # weight of the L2 penalty
STEPS, STYLE_STEPS = 90, 50
FOLD_STEPS = 40  # number of training steps when the attack regression is fitted without one fold
NETWORKS = 4  # number of networks, whose scores are averaged
Weights = tuple[np.ndarray, float]
Pair = tuple[Weights, Weights]


@dataclass(frozen=True)
class Regressions:
    """The two regressions on TF-IDF values, for attacks and for styles.

    A regression is a pair (weights [SIZE], bias). ``complete`` contains the regressions that were
    trained on all texts. ``folds[i]`` contains the regressions that were trained without fold i.
    """

    words: list[str]
    idf: np.ndarray
    complete: Pair
    folds: tuple[Pair, ...]

    def classifier(
        self, fold: int | None = None, network: Mapping[str, np.ndarray] | None = None
    ) -> Classifier:
        """Return the classifier that was trained on all texts, or on all texts outside ``fold``."""
        pair = self.complete if fold is None else self.folds[fold]
        (alone, bias), (style, style_bias) = pair
        config = {"words": self.words, "bias": bias, "style_bias": style_bias}
        # terms that occur only in the left-out fold have the weight 0 and are treated as unknown
        idf = np.where(alone == 0, 0, self.idf)
        return Classifier(
            config, {"idf": idf, "alone": alone, "style": style} | dict(network or {})
        )


def fit(
    folder: Path, routes: int = ROUTES, texts: int = SPLICES, networks: int = NETWORKS
) -> Classifier:
    """Train a classifier on the data in a folder; each network gets its own training texts."""
    lines, frames = read_lines(folder, routes), read_frames(folder)
    regressions = regress(lines)
    classifiers = [regressions.classifier(fold) for fold in range(FOLDS)]
    trained = []
    for seed in range(networks):
        say(f"training network {seed + 1} of {networks}")
        examples = [
            example
            for splice in splices(lines, frames, texts, seed)
            if (example := _example(splice, classifiers[splice.fold]))
        ]
        trained.append(train(examples, seed))
    network = {name: np.concatenate([arrays[name] for arrays in trained]) for name in NAMES}
    return regressions.classifier(network=network)


def regress(lines: Sequence[Line]) -> Regressions:
    """Train the logistic regressions on sentences and clauses."""
    words = common_words(lines)
    pieces = list(_pieces(varied(lines)))
    known = frozenset(words)
    terms = [model.terms(decode(text, known), text, block) for text, block, _, _ in pieces]
    say(f"training on {len(pieces)} pieces of text")
    seen = Counter(index for term_counts in terms for index in term_counts)
    idf = np.zeros(SIZE, np.float32)
    for index, n in seen.items():
        idf[index] = np.log(len(terms) / n) + 1 if n > 1 else 0.0
    x = _matrix(terms, idf)
    used = np.unique(x.indices)
    x = x[:, used].tocsr()
    weight = np.array([weight for *_, weight in pieces])
    attack = np.array([line.attack for _, _, line, _ in pieces])
    fold = np.array([fold_of(line) for _, _, line, _ in pieces])

    def regressed(rows: np.ndarray, y: np.ndarray, steps: int) -> Weights:
        few, bias = regression(x[rows], y[rows], weight[rows], steps)
        weights = np.zeros(SIZE, np.float32)
        weights[used] = few
        return weights, bias

    known_style = np.array([line.styled is not None for _, _, line, _ in pieces])
    styled = np.array([line.styled is True for _, _, line, _ in pieces])

    def both(rows: np.ndarray, steps: int) -> Pair:
        return regressed(rows, attack, steps), regressed(rows & known_style, styled, STYLE_STEPS)

    folds = tuple(both(fold != number, FOLD_STEPS) for number in range(FOLDS))
    for number, ((weights, bias), _) in enumerate(folds):
        rows = fold == number
        right = (x[rows] @ weights[used] + bias > 0) == attack[rows]
        say(f"fold {number + 1}: {100 * right.mean():.1f} % of unseen pieces are recognised")
    return Regressions(words, idf, both(np.ones(len(pieces), bool), STEPS), folds)


def _example(splice: Splice, classifier: Classifier) -> Example | None:
    """Return the features of a training text, or None if it has no clauses or too many."""
    clauses = classifier.clauses(splice.text)
    if not 0 < len(clauses) <= LONGEST:
        return None
    attack = [
        any(
            2 * (min(clause.piece.end, end) - max(clause.piece.start, start))
            > clause.piece.end - clause.piece.start
            for start, end in splice.attacks
        )
        for clause in clauses
    ]
    return Example(features(splice.text, clauses, classifier), np.array(attack))


def common_words(lines: Sequence[Line]) -> list[str]:
    """Return the most frequent words in ``lines``, except words that are written backwards."""
    word = re.compile(r"[a-z]+(?:'[a-z]+)?")
    counts = Counter(w for line in lines for w in word.findall(line.text.lower()))
    common = counts.most_common(WORDS)
    return sorted(w for w, n in common if n > 1 and counts[w[::-1]] < BACKWARDS * n)


def _pieces(lines: Sequence[Line]) -> Iterator[tuple[str, bool, Line, float]]:
    """Yield (text, is_block, line, weight) for each line, sentence and clause.

    ``is_block`` says whether the text is between delimiters.
    """
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
    """Return the TF-IDF matrix of the terms, with rows normalised to unit norm.

    Terms that occur only once are omitted; their entry in ``idf`` is 0.
    """
    rows = []
    for terms in term_counts:
        index, value = model.weighted(terms, idf)
        index, value = index[value > 0], value[value > 0]
        rows.append((index, value / max(1e-6, float(np.linalg.norm(value)))))
    ends = np.cumsum([0, *(len(index) for index, _ in rows)])
    index = np.concatenate([index for index, _ in rows])
    value = np.concatenate([value for _, value in rows])
    return csr_matrix((value.astype(np.float32), index, ends), (len(rows), SIZE))


def regression(x: Any, y: np.ndarray, weight: np.ndarray, steps: int) -> Weights:
    """Fit a logistic regression with an L2 penalty and balanced classes."""
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
    arrays = {
        name: array.astype(np.float16 if name in model.ARRAYS else np.float32)
        for name, array in trained.arrays.items()
    }
    with folders.write_folder(folder, "safeguard") as draft:
        write_json(draft / model.CONFIG, trained.config)
        save_file(arrays, draft / model.WEIGHTS)


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
        sys.exit(f"error: {error_message(error)}")
