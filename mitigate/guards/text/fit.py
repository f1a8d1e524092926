"""Train the classifier: ``python -m mitigate.guards.text.fit --out checkpoints/safeguard_classifier``.

Reads the data of a checkout (``tools/safeguard/data``): attacks by mechanism, and honest text by
bank. Each mechanism and each bank belongs to one of ``FOLDS`` folds. The second step is trained on
scores by models that have not seen the mechanism, so that it learns what new mechanisms look like.
"""

from __future__ import annotations

import argparse
import base64
import codecs
import json
import re
import sys
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from mitigate.core import checksums
from mitigate.core.files import find
from mitigate.core.seeding import generator
from mitigate.corruptions.instruction import corrupt_instruction
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.prefixes import prefixes
from mitigate.corruptions.language.style import MANNERS
from mitigate.guards.text import classifier as model
from mitigate.guards.text.classifier import SIZE, Classifier
from mitigate.guards.text.decode import decode
from mitigate.guards.text.learning.routes import draw_route
from mitigate.guards.text.pieces import clause_pieces, sentence_pieces

DATA = Path("tools/safeguard/data")
FOLDS = 6
ROUTES = 1200  # drawn from templates
COMPOSED = 7000  # attacks in routes, for the second step
RIDGE, STEPS, FOLD_STEPS = 2.0, 120, 70  # of the first step
THRESHOLD = 1.0  # log odds of any span against none, from which it is taken out
SEGMENTS = 18  # clauses of a text in the second step
WORDS = 6000  # common words, by which hidden text is recognised


@dataclass(frozen=True)
class Line:
    """A text that is whole attack or whole honest; ``group``: its mechanism, bank or style.

    ``place`` of an attack: "any", "inside" a sentence, or "wrap" around the route.
    """

    text: str
    attack: bool
    group: str
    weight: float = 1.0
    place: str = "any"
    task: str = "route"
    styled: bool | None = None


def read_data(folder: Path, routes: int = ROUTES) -> list[Line]:
    """Return all lines to learn from. Raises FileNotFoundError outside a checkout."""
    if not (folder / "banks").is_dir():
        raise FileNotFoundError(
            f"There is no data in {folder}: the texts to train on come with a checkout of the "
            "repository. Run this there, or name the folder with --data."
        )
    lines = [
        Line(d["attack"], True, d["mechanism"], place=d["place"])
        for name in ("attacks", "fresh_attacks")
        for d in _json(folder / f"banks/{name}.jsonl")
    ]
    lines += [
        Line(t, True, f"lines {i % 8}", 0.7)
        for i, t in enumerate(_text(folder / "banks/fit_attacks.txt"))
    ]
    lines += [
        Line(text, True, f"prefix {family}")
        for split in ("train", "validation")
        for family, texts in prefixes(split).items()
        for text in texts
    ]
    for name in ("lookalikes", "fresh_lookalikes", "near_misses", "odd_routes"):
        lines += [
            Line(d["text"], False, f"{name} {i % 6}", 2.0)
            for i, d in enumerate(_json(folder / f"banks/{name}.jsonl"))
        ]
    lines += [
        Line(t, False, f"fit_routes {i % 4}", 1.5)
        for i, t in enumerate(_text(folder / "banks/fit_routes.txt"))
    ]
    for name in ("lies", "honest"):
        for i, d in enumerate(_json(folder / f"banks/{name}.jsonl")):
            lines += [
                Line(text, False, f"{name} {i % 4}", 0.5)
                for key, text in d.items()
                if key != "kind"
            ]
    for file in sorted((folder / "styles").glob("*.jsonl")):
        for d in _json(file):
            said = " ".join(said for said, _ in d["parts"])
            plain = " ".join(plain for _, plain in d["parts"] if plain)
            lines.append(Line(said, False, f"style {file.stem}", 1.0, task=d["task"], styled=True))
            lines.append(
                Line(plain, False, f"style {file.stem}", 0.5, task=d["task"], styled=False)
            )
    for i in range(routes):
        rng = generator(0, "fit", i)
        text = draw_route(rng)
        lines.append(Line(text, False, f"drawn {i % 8}", 0.5))
        if i % 3 == 0:
            manner = MANNERS[i // 3 % len(MANNERS)]
            lines.append(
                Line(
                    corrupt_instruction(text, manner, 1.0, Key(0, f"fit {i}"), split="train"),
                    False,
                    f"drawn {i % 8}",
                    0.5,
                )
            )
    return lines


def _json(file: Path) -> Iterator[dict[str, Any]]:
    with open(file, encoding="utf-8") as opened:
        yield from (json.loads(line) for line in opened if line.strip())


def _text(file: Path) -> list[str]:
    with open(file, encoding="utf-8") as opened:
        return [line.strip() for line in opened if line.strip() and not line.startswith("#")]


def varied(lines: Sequence[Line]) -> list[Line]:
    """Return the lines and copies as careless or hiding people write them."""
    made = list(lines)
    for number, line in enumerate(lines):
        rng = generator(0, "varied", number)
        draw = rng.random()
        if draw < 0.15:
            made.append(
                Line(
                    line.text.lower(),
                    line.attack,
                    line.group,
                    line.weight / 2,
                    line.place,
                    line.task,
                )
            )
        elif draw < 0.22:
            made.append(
                Line(
                    line.text.upper(),
                    line.attack,
                    line.group,
                    line.weight / 2,
                    line.place,
                    line.task,
                )
            )
        elif draw < 0.30:
            made.append(
                Line(
                    line.text.rstrip(".!"),
                    line.attack,
                    line.group,
                    line.weight / 2,
                    line.place,
                    line.task,
                )
            )
        elif draw < 0.36 and line.attack and "{route}" not in line.text:
            hide = HIDE[int(rng.integers(len(HIDE)))]
            made.append(Line(hide(line.text), True, line.group, line.weight / 2, line.place))
        elif draw < 0.38 and not line.attack:  # honest people write digits and odd letters as well
            made.append(
                Line(
                    _leet(line.text, "o"), False, line.group, line.weight / 2, line.place, line.task
                )
            )
    return made


def _leet(text: str, letters: str = "oieas") -> str:
    table = {"o": "0", "i": "1", "e": "3", "a": "4", "s": "5"}
    return "".join(table[c] if c in letters else c for c in text.lower())


HIDE: tuple[Callable[[str], str], ...] = (
    lambda text: base64.b64encode(text.encode()).decode(),
    lambda text: text.encode().hex(),
    lambda text: codecs.encode(text, "rot13"),
    _leet,
    lambda text: text[::-1],
    lambda text: " ".join(text),
    lambda text: "".join(chr(ord(c) + 0xFEE0) if "!" <= c <= "~" else c for c in text),
    lambda text: text.replace("a", "а").replace("e", "е").replace("o", "о"),
)


class Rows:
    """Hashed terms of many pieces, with labels, weights and folds."""

    def __init__(self, known: frozenset[str], clusters: model.Clusters) -> None:
        self.known, self.clusters = known, clusters
        self.terms: list[dict[int, float]] = []
        self.attack: list[bool] = []
        self.styled: list[bool | None] = []
        self.weight: list[float] = []
        self.fold: list[int] = []

    def add(self, text: str, block: bool, line: Line, weight: float) -> None:
        plain = decode(text, self.known)
        self.terms.append(model.terms(plain, text, block, self.clusters))
        self.styled.append(line.styled)
        self.attack.append(line.attack)
        self.weight.append(weight)
        self.fold.append(fold_of(line.group))


def fold_of(group: str) -> int:
    return zlib.crc32(f"fold {group}".encode()) % FOLDS


def pieces_of(lines: Sequence[Line], known: frozenset[str], clusters: model.Clusters) -> Rows:
    """Return whole lines, their sentences and their clauses as rows to learn from."""
    rows = Rows(known, clusters)
    for line in lines:
        for text in line.text.split("{route}"):
            sentences = sentence_pieces(text)
            if len(sentences) > 1:
                rows.add(text, False, line, 0.5 * line.weight)
            for piece in sentences:
                rows.add(piece.of(text), piece.block, line, line.weight)
                clauses = clause_pieces(text, piece)
                if len(clauses) > 1:
                    for clause in clauses:
                        rows.add(clause.of(text), clause.block, line, 0.4 * line.weight)
    return rows


def matrix(found: Sequence[dict[int, float]], idf: np.ndarray) -> csr_matrix:
    pairs = [model.weighted(terms, idf) for terms in found]
    pairs = [(index[value > 0], value[value > 0]) for index, value in pairs]
    pairs = [(index, value / max(1e-6, float(np.linalg.norm(value)))) for index, value in pairs]
    ends = np.cumsum([0, *(len(index) for index, _ in pairs)])
    index = np.concatenate([index for index, _ in pairs])
    value = np.concatenate([value for _, value in pairs])
    return csr_matrix((value.astype(np.float64), index, ends), (len(pairs), SIZE))


def regression(
    x: Any, y: np.ndarray, weight: np.ndarray, ridge: float, steps: int = 150
) -> tuple[np.ndarray, float]:
    """Return weights and bias of a logistic regression with an L2 penalty, classes balanced."""
    share = np.where(y, weight[y].sum(), weight[~y].sum())
    weight = weight / share * len(y) / 2
    sign = np.where(y, 1.0, -1.0)

    def loss(w: np.ndarray) -> tuple[float, np.ndarray]:
        margin = sign * (x @ w[:-1] + w[-1])
        slope = -sign * weight / (1 + np.exp(np.clip(margin, -30, 30)))
        value = float(weight @ np.logaddexp(0, -margin)) + 0.5 * ridge * float(w[:-1] @ w[:-1])
        return value, np.append(x.T @ slope + ridge * w[:-1], slope.sum())

    start = np.zeros(x.shape[1] + 1)
    found = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": steps}).x
    return found[:-1], float(found[-1])


def common_words(lines: Sequence[Line]) -> list[str]:
    """Return the words that occur most often in lines that hide nothing."""
    counts = Counter(
        w for line in lines for w in re.findall(r"[a-z]+(?:'[a-z]+)?", line.text.lower())
    )
    return sorted(w for w, n in counts.most_common(WORDS) if n > 1)


def composed(
    lines: Sequence[Line], count: int
) -> Iterator[tuple[str, list[tuple[int, int]], int, bool]]:
    """Yield (text, spans of attacks, fold of the attack, honest) for the second step."""
    attacks = [line for line in lines if line.attack and line.text.strip()]
    honest = [line for line in lines if not line.attack]
    # what stands beside an attack is of its fold: no model that reads it has seen either
    pools = [
        [line for line in honest if fold_of(line.group) == fold and len(line.text.split()) > 6]
        for fold in range(FOLDS)
    ]
    for line in honest:
        yield line.text, [], fold_of(line.group), True
    for number in range(count):
        rng = generator(0, "composed", number)
        attack = attacks[int(rng.integers(len(attacks)))]
        pool = pools[fold_of(attack.group)]
        route = pool[int(rng.integers(len(pool)))].text
        if attack.place == "wrap":
            before, _, after = attack.text.partition("{route}")
            text = f"{before} {route} {after}"
            spans = [(0, len(before)), (len(text) - len(after), len(text))]
            yield text, spans, fold_of(attack.group), False
            continue
        said = attack.text
        if rng.random() < 0.12:
            said = f"{said} {attacks[int(rng.integers(len(attacks)))].text}"
        pieces = sentence_pieces(route)
        short = len(said.split()) < 16
        if attack.place == "inside" or (short and rng.random() < 0.25):
            cuts = [c.start for p in pieces for c in clause_pieces(route, p)[1:]]
            at = cuts[int(rng.integers(len(cuts)))] if cuts else len(route)
            said = said.strip(" .") if rng.random() < 0.6 else said
            said = (
                said[:1].lower()
                + said[1:]
                + ("," if rng.random() < 0.6 and said[-1:].isalnum() else "")
            )
        else:
            cuts = [0, 0, len(route), len(route), *(p.start for p in pieces[1:])]
            at = cuts[int(rng.integers(len(cuts)))]
        before, after = route[:at].rstrip(), route[at:].lstrip()
        if before and before[-1].isalnum() and rng.random() < 0.5:
            before += "," if attack.place == "inside" else "."
        start = len(before) + 1 if before else 0
        text = f"{before} {said} {after}".strip()
        yield text, [(start, start + len(said))], fold_of(attack.group), False


def covered(start: int, end: int, spans: Sequence[tuple[int, int]]) -> float:
    """Return which share of a piece lies in spans."""
    inside = sum(max(0, min(end, high) - max(start, low)) for low, high in spans)
    return inside / max(1, end - start)


def fit(
    folder: Path = DATA, count: int = COMPOSED, routes: int = ROUTES, log: Any = sys.stderr
) -> Classifier:
    """Return the classifier trained on the data of a folder."""
    lines = read_data(folder, routes)
    clusters = json.loads((folder / "clusters.json").read_text(encoding="utf-8"))
    folds, whole = first_step(lines, clusters, log)
    found = list(examples(varied(lines), count, folds))
    print(f"second step: {len(found)} texts", file=log, flush=True)
    whole.arrays.update(second_step(found))
    return whole


def first_step(
    lines: Sequence[Line], clusters: model.Clusters, log: Any
) -> tuple[list[Classifier], Classifier]:
    """Return a classifier per fold, which has not seen it, and one that has seen all lines; none of
    them has a second step yet."""
    words = common_words(lines)
    rows = pieces_of(varied(lines), frozenset(words), clusters)
    print(f"first step: {len(lines)} lines, {len(rows.terms)} pieces", file=log, flush=True)
    seen = Counter(index for terms in rows.terms for index in terms)
    idf = np.zeros(SIZE, np.float32)
    for index, n in seen.items():
        idf[index] = np.log(len(rows.terms) / n) + 1 if n > 1 else 0.0
    x = matrix(rows.terms, idf)
    attack, weight, fold = np.array(rows.attack), np.array(rows.weight), np.array(rows.fold)
    config = {"words": words, "clusters": clusters, "threshold": THRESHOLD}
    made = []
    for out in (*range(FOLDS), None):
        kept = fold != out if out is not None else np.ones(len(attack), bool)
        steps = FOLD_STEPS if out is not None else STEPS
        found, bias = regression(x[kept], attack[kept], weight[kept], RIDGE, steps)
        if out is not None and not kept.all():
            right = (x[~kept] @ found + bias > 0) == attack[~kept]
            print(f"fold {out}: {100 * right.mean():.1f} % of unseen pieces", file=log, flush=True)
        made.append(Classifier({**config, "bias": bias}, {"idf": idf, "alone": found}))
    *folds, whole = made
    known = np.array([styled is not None for styled in rows.styled])
    styled = np.array([styled is True for styled in rows.styled])[known]
    found, bias = regression(x[known], styled, weight[known], RIDGE, FOLD_STEPS)
    whole.arrays["style"], whole.config["style_bias"] = found.astype(np.float32), bias
    return folds, whole


@dataclass(frozen=True)
class Example:
    """Spans of a text and which of them are attacks, none of an honest text."""

    rows: np.ndarray
    right: np.ndarray
    weight: float


def examples(lines: Sequence[Line], count: int, folds: Sequence[Classifier]) -> Iterator[Example]:
    """Yield what the second step learns from."""
    for text, attacks, fold, honest in composed(lines, count):
        found = folds[fold].segments(text)[:SEGMENTS]
        if len(found) < 2:
            continue
        first, last, rows = model.spans(found, folds[fold].bias)
        right = np.zeros(len(first))
        for low, high in attacks:
            starts = np.array([s.piece.start for s in found])[first]
            ends = np.array([s.piece.end for s in found])[last]
            both = np.minimum(ends, high) - np.maximum(starts, low)
            share = both / (np.maximum(ends, high) - np.minimum(starts, low))
            if share.size and share.max() > 0.9:
                right[share.argmax()] = 1.0
        if honest or right.any():
            yield Example(rows, right, 1.0)


def second_step(
    found: Sequence[Example], width: int = 12, ridge: float = 3.0, seed: int = 0
) -> dict[str, np.ndarray]:
    """Return weights of a small network that ranks the spans of a text, and leaving it alone at 0.

    Loss = -log(share of the right spans in the softmax over all spans and leaving the text alone).
    """
    rows = np.concatenate([e.rows for e in found])
    right = np.concatenate([e.right for e in found])
    starts = np.cumsum([0, *(len(e.rows) for e in found[:-1])])
    sizes = np.array([len(e.rows) for e in found])
    weight = np.array([e.weight for e in found])
    nothing = np.array([not e.right.any() for e in found])
    scale = np.maximum(rows.std(0), 1e-6)
    scale[rows.std(0) < 1e-6] = 1.0  # of the constant
    x = rows / scale
    f = x.shape[1]

    def unpacked(w: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        return w[:f], w[f : f + f * width].reshape(f, width), w[f + f * width : -width], w[-width:]

    def loss(w: np.ndarray) -> tuple[float, np.ndarray]:
        linear, hidden, shift, out = unpacked(w)
        inner = np.tanh(x @ hidden + shift)
        logit = x @ linear + inner @ out
        top = np.maximum(np.maximum.reduceat(logit, starts), 0)
        e = np.exp(logit - np.repeat(top, sizes))
        none = np.exp(-top)
        total = np.add.reduceat(e, starts) + none
        good = np.where(nothing, none, np.add.reduceat(e * right, starts))
        value = -float(weight @ np.log(good / total + 1e-30))
        d = e / np.repeat(total, sizes)
        d -= e * right * np.repeat(np.where(nothing, 0, 1 / np.maximum(good, 1e-30)), sizes)
        d *= np.repeat(weight, sizes)
        inside = d[:, None] * out * (1 - inner**2)
        slope = np.concatenate([x.T @ d, (x.T @ inside).ravel(), inside.sum(0), inner.T @ d])
        return value + 0.5 * ridge * float(w @ w), slope + ridge * w

    start = generator(seed, "second step").normal(0, 0.1, f + f * width + 2 * width)
    w = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": 200}).x
    linear, hidden, shift, out = unpacked(w)
    return {"linear": linear / scale, "hidden": hidden / scale[:, None], "shift": shift, "out": out}


def save(found: Classifier, folder: Path) -> None:
    """Write a classifier into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    config = {**found.config, "bias": found.bias}
    (folder / model.CONFIG).write_text(json.dumps(config) + "\n", encoding="utf-8")
    half = {name: found.arrays[name].astype(np.float16) for name in ("idf", "alone", "style")}
    arrays = {**half, **{n: a for n, a in found.arrays.items() if n not in half}}
    checksums.write(folder / model.WEIGHTS, lambda file: model.write_arrays(file, arrays))


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m mitigate.guards.text.fit", description=__doc__)
    parser.add_argument(
        "--data", type=Path, default=find(DATA), help="folder with banks and styles"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder of the new classifier")
    options = parser.parse_args(arguments)
    save(fit(options.data), options.out)
    print(f"wrote {options.out}: try it with safeguard={options.out}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")
