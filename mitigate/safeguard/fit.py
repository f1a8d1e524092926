"""Fit the rules' weights: ``python -m mitigate.safeguard.fit`` prints what ``weights.py`` would be.

Logistic regression: sentences of the train split's attacks against sentences of our routes, plain
and restyled. The words that mark a style are those that restyled routes have and plain ones lack.
"""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mitigate.core.files import atomic_text
from mitigate.core.seeding import generator
from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.prefixes import prefixes
from mitigate.safeguard import routes
from mitigate.safeguard.data import draw_pair, vary
from mitigate.safeguard.rules import CLOSED, VERBS, features
from mitigate.safeguard.text import sentences, words

WEIGHTS = Path(__file__).parent / "weights.py"
PAIRS, RIDGE, ITERATIONS = 6000, 3.0, 30
RARE, ODDS = 12, 30.0  # a style word occurs so often, and so many times as often as in plain text


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit, and print the module or write it. ``arguments``: of the command line."""
    parser = argparse.ArgumentParser(prog="python -m mitigate.safeguard.fit", description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"replace {WEIGHTS.name}")
    write = parser.parse_args(arguments).write
    marks = style_words()
    text = module(*fit_weights(frozenset(marks)), marks)
    if not write:
        print(text, end="")
        return
    with atomic_text(WEIGHTS) as file:
        file.write(text)
    print(f"wrote {WEIGHTS}", file=sys.stderr)


def module(bias: float, weights: dict[str, float], marks: list[str]) -> str:
    """Return the text of ``weights.py``."""
    lines = [
        '"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""\n',
        "from __future__ import annotations\n",
        "from mitigate.corruptions.language.words import bag\n",
        f"BIAS = {bias:.3f}",
        "WEIGHTS: dict[str, float] = {",
        *(f'    "{name}": {value:.3f},' for name, value in weights.items()),
        '}\nSTYLE = bag(\n    """',
        *textwrap.wrap(" ".join(marks), 96, initial_indent="    ", subsequent_indent="    "),
        '    """\n)\n',
    ]
    return "\n".join(lines)


def fit_weights(marks: frozenset[str]) -> tuple[float, dict[str, float]]:
    """Return bias and weights: Newton's method on the ridge-penalised log-likelihood."""
    rng = generator(0, "fit")
    attacks = [s for group in prefixes("train").values() for s in group] * 4
    attacks += [vary(rng) for _ in range(300)]
    clean = [s for i in range(800) for s in sentences(routes.draw_route(generator(0, "fit", i)))]
    pairs = [draw_pair(2, i) for i in range(PAIRS // 4)]
    styled = [s for pair in pairs if pair.kind == "style" for s in sentences(pair.source)]
    clean += [s for s in styled if facts(s).landmarks]  # the others frame, and may go too
    rows = [features(s, marks) for s in (*attacks, *clean)]
    names = list(rows[0])
    x = np.array([[1.0, *(row[name] for name in names)] for row in rows])
    y = np.array([1.0] * len(attacks) + [0.0] * len(clean))
    balance = np.where(y == 1, 1.0, len(attacks) / len(clean))
    w = np.zeros(x.shape[1])
    for _ in range(ITERATIONS):
        p = 1 / (1 + np.exp(-np.clip(x @ w, -30, 30)))
        slope = x.T @ (balance * (p - y)) + RIDGE * w
        curve = (x * (balance * p * (1 - p) + 1e-6)[:, None]).T @ x + RIDGE * np.eye(len(w))
        w -= np.linalg.solve(curve, slope)
    return float(w[0]), {name: float(value) for name, value in zip(names, w[1:], strict=True)}


def style_words() -> list[str]:
    """Return the words that mark a manner of speaking."""
    styled: Counter[str] = Counter()
    plain: Counter[str] = Counter()
    for index in range(PAIRS):
        pair = draw_pair(1, index)
        if pair.kind == "style":
            styled.update(words(pair.source))
            plain.update(words(pair.target))
        elif pair.kind == "identity":
            plain.update(words(pair.source))
    scale = sum(plain.values()) / sum(styled.values())
    return sorted(
        word
        for word, count in styled.items()
        if count >= RARE
        and count * scale >= ODDS * max(plain[word], 0.3)
        and word not in CANONICAL
        and word not in VERBS
        and not any(word in group for group in CLOSED.values())
    )


if __name__ == "__main__":
    main()
