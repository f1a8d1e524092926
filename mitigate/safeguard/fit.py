"""Fit the rules' weights: ``python -m mitigate.safeguard.fit`` prints what ``weights.py`` would be.

Logistic regressions over what pieces of text are made of: sentences by themselves, sentences beside
others, parts of sentences. Attacks are the train and validation families of the prefix bank, the
tuning mechanisms of the test banks and lines of ours; the rest are routes of ours, plain, restyled
and in the tuning voices. The words that mark a style are those that restyled routes have and plain
ones lack. Run it in a checkout: the banks are not in the package.
"""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitigate.core.files import atomic_text
from mitigate.core.seeding import generator
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.corruptions.language.prefixes import prefixes
from mitigate.safeguard import gate, routes, rules, trials
from mitigate.safeguard.data import draw_pair, vary
from mitigate.safeguard.evidence import VERBS, features, in_context
from mitigate.safeguard.lexicon import GROUPS
from mitigate.safeguard.pieces import parts, sentence_pieces
from mitigate.safeguard.text import words

WEIGHTS = Path(__file__).parent / "weights.py"
PAIRS, RIDGE, ITERATIONS, FOLDS = 6000, 2.0, 30, 8
RARE, ODDS = 12, 30.0  # a style word occurs so often, and so many times as often as in plain text
TOTAL, SHARE = 2000.0, 1 / 3  # weight of all examples, and of the attacks among them (ours)


@dataclass(frozen=True)
class Example:
    """A piece of text, whether it is an attack, how much it counts, its ``group`` for the folds."""

    text: str
    markup: bool
    attack: bool
    weight: float
    group: str


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit, and print the module or write it. ``arguments``: of the command line."""
    parser = argparse.ArgumentParser(prog="python -m mitigate.safeguard.fit", description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"replace {WEIGHTS.name}")
    write = parser.parse_args(arguments).write
    text = module(fit_weights(), style_words(), common_words())
    if not write:
        print(text, end="")
        return
    with atomic_text(WEIGHTS) as file:
        file.write(text)
    print(f"wrote {WEIGHTS}", file=sys.stderr)


def module(
    fitted: dict[str, dict[str, float]], marks: Iterable[str], common: Iterable[str]
) -> str:
    """Return the text of ``weights.py``."""
    lines = [
        '"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""\n',
        "from __future__ import annotations\n",
        "from mitigate.corruptions.language.words import bag\n",
    ]
    for name, weights in fitted.items():
        lines.append(f"{name}: dict[str, float] = {{")
        lines += [f'    "{key}": {value:.3f},' for key, value in weights.items()]
        lines.append("}")
    for name, found in (("STYLE", marks), ("WORDS", common)):
        lines.append(f'{name} = bag(\n    """')
        lines += textwrap.wrap(
            " ".join(sorted(found)), 96, initial_indent="    ", subsequent_indent="    "
        )
        lines.append('    """\n)')
    return "\n".join(lines) + "\n"


def fit_weights() -> dict[str, dict[str, float]]:
    """Return name -> weights of the three regressions."""
    examples = [*_attacks(), *_routes()]
    rows = [features(e.text, e.markup) for e in examples]
    own = _regression(rows, examples)
    held = _held_out(rows, examples)
    strange = {(e.text, e.markup): p for e, p in zip(examples, held, strict=True)}
    return {"OWN": own, "CONTEXT": _context(own, strange), "PART": _part(own)}


def _attacks() -> list[Example]:
    found = [(a.mechanism, a.words, 1.0) for a in trials.attacks("tune") if a.place == "any"]
    found += [
        (family, line, 1.0)
        for split in ("train", "validation")
        for family, group in prefixes(split).items()
        for line in group
    ]
    found += [("ours", line, 1.0) for line in trials.fitting("fit_attacks")]
    rng = generator(0, "fit")
    found += [("varied", vary(rng), 0.15) for _ in range(200)]
    return [
        Example(piece.of(line), piece.markup, True, weight, group)
        for group, line, weight in found
        for piece in sentence_pieces(line)
    ]


def _routes() -> list[Example]:
    found: list[tuple[str, float]] = []
    for task in ("route", "object"):
        for told in trials.told("tune", task):
            found += [(part, 1.0) for part in told.parts] + [(told.plain, 1.0)]
    found += [(routes.draw_route(generator(0, "fit", i)), 0.5) for i in range(600)]
    found += [(line["text"], 6.0) for line in trials.half("near_misses", "tune")]
    found += [(line, 4.0) for line in trials.fitting("fit_routes")]
    for bank in ("lies", "honest"):
        for line in trials.half(bank, "tune"):
            found += [(text, 1.0) for key, text in line.items() if key != "kind"]
    return [
        Example(piece.of(text), piece.markup, False, weight, str(index % FOLDS))
        for index, (text, weight) in enumerate(found)
        for piece in sentence_pieces(text)
        if weight != 1.0 or gate.route_facts(piece.of(text))  # the others frame, and may go
    ]


def _held_out(rows: list[dict[str, float]], examples: list[Example]) -> list[float]:
    """Return each example's probability by a fit that saw no example of its group."""
    groups = sorted({e.group for e in examples if e.attack})
    fold = [groups.index(e.group) % FOLDS if e.attack else int(e.group) for e in examples]
    found = [0.0] * len(rows)
    for out in range(FOLDS):
        seen = [i for i, number in enumerate(fold) if number != out]
        fitted = _regression([rows[i] for i in seen], [examples[i] for i in seen])
        for i, number in enumerate(fold):
            if number == out:
                found[i] = rules.probability(fitted, rows[i])
    return found


def _context(own: dict[str, float], strange: dict[tuple[str, bool], float]) -> dict[str, float]:
    """Return the weights of sentences among others; attacks stand in plain and restyled routes."""
    styled, plain = trials.told("tune"), trials.plainly_told("tune")
    heard = [(told.text, "") for told in (*styled, *plain)]
    heard += [(line["text"], "") for line in trials.half("near_misses", "tune")] * 3
    heard += [(line, "") for line in trials.fitting("fit_routes")]
    found = [a for a in trials.attacks("tune") if a.place == "any"]
    for routes_ in (styled, plain):
        heard += [(text, a.words) for a, _, _, text in trials.trials(found, routes_, 1)]
    examples, rows = [], []
    for text, attack in heard:
        pieces = sentence_pieces(text)
        said = [piece.of(text) for piece in pieces]
        known = [
            strange.get((s, p.markup), rules.probability(own, features(s, p.markup)))
            for s, p in zip(said, pieces, strict=True)
        ]
        around = in_context(said, known)
        for s, p, row in zip(said, known, around, strict=True):
            foreign = bool(attack) and s in attack
            if foreign or gate.route_facts(s) or not attack:
                rows.append({"own": rules.logit(p), **row})
                examples.append(Example(s, False, foreign, 1.0, ""))
    return _regression(rows, examples)


def _part(own: dict[str, float]) -> dict[str, float]:
    """Return the weights of parts inside sentences."""
    inside = [a for a in trials.attacks("tune") if a.place == "inside"]
    styled, plain = trials.told("tune"), trials.plainly_told("tune")
    examples, rows = [], []

    def add(text: str, attack: str, weight: float) -> None:
        for piece in sentence_pieces(text):
            whole = rules.logit(rules.probability(own, features(piece.of(text), piece.markup)))
            for part in parts(text, piece):
                said = part.of(text)
                foreign = bool(attack) and (said.strip(",. ") in attack)
                rows.append({"whole": whole, **features(said)})
                examples.append(Example(said, False, foreign, weight, ""))

    for routes_ in (styled, plain):
        for attack, _, _, text in trials.trials(inside, routes_, 4):
            add(text, attack.words, 0.5)
    short = [line for line in trials.fitting("fit_attacks") if len(line.split()) < 12]
    lines = [trials.Attack("ours", "inside", line.strip(" ,.")) for line in short]
    for attack, _, _, text in trials.trials(lines, plain, 2):
        add(text, attack.words, 0.5)
    for told in (*styled, *plain):
        add(told.text, "", 1.0)
    for line in trials.half("near_misses", "tune"):
        add(line["text"], "", 6.0)
    return _regression(rows, examples)


def _regression(rows: list[dict[str, float]], examples: list[Example]) -> dict[str, float]:
    """Return bias and weights: Newton's method on the ridge-penalised log-likelihood."""
    names = list(rows[0])
    x = np.array([[1.0, *(row[name] for name in names)] for row in rows])
    y = np.array([float(e.attack) for e in examples])
    weight = np.array([e.weight for e in examples])
    weight = np.where(y == 1, SHARE * weight / weight[y == 1].sum(), weight)
    weight = np.where(y == 0, (1 - SHARE) * weight / weight[y == 0].sum(), weight) * TOTAL
    ridge = np.full(x.shape[1], RIDGE)
    ridge[0] = 1e-3
    w = np.zeros(x.shape[1])
    for _ in range(ITERATIONS):
        p = 1 / (1 + np.exp(-np.clip(x @ w, -30, 30)))
        slope = x.T @ (weight * (p - y)) + ridge * w
        curve = (x * (weight * p * (1 - p) + 1e-9)[:, None]).T @ x + np.diag(ridge)
        w -= np.linalg.solve(curve, slope)
    return dict(zip(("bias", *names), map(float, w), strict=True))


def common_words() -> frozenset[str]:
    """Return the words of all that the rules are fitted on, but for those in a code."""
    text = [line for bank in ("fit_attacks", "fit_routes") for line in trials.fitting(bank)]
    text += [a.words for a in trials.attacks("tune") if a.mechanism != "encoded"]
    text += [f"{t.text} {t.plain}" for k in ("route", "object") for t in trials.told("tune", k)]
    for bank in ("near_misses", "lies", "honest"):
        text += [value for line in trials.half(bank, "tune") for value in line.values()]
    return frozenset(word for line in text for word in words(line) if len(word) > 1)


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
        and not any(word in group for group in _CLOSED)
    )


_CLOSED = [GROUPS[name] for name in ("case", "text", "orders", "not")]


if __name__ == "__main__":
    main()
