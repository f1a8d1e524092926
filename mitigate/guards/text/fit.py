"""Fit the rules' weights: ``python -m mitigate.guards.text.fit`` prints ``weights.json``.

Logistic regressions over what pieces of text are made of: sentences by themselves, sentences beside
others, parts of sentences. Attacks are the train and validation families of the prefix bank (never
the test families, which the suite speaks), the test banks and lines of ours; the rest are routes of
ours, plain, restyled and in voices. The words that mark a style are those that restyled routes have
and plain ones lack. Run it in a checkout: the banks are not in the package.

What is shipped is fitted on the whole of the banks. Their test part is reported on by weights that
have not seen it: ``fit --split tune > tune.json``, then ``MITIGATE_RULES=tune.json python -m
mitigate.guards.text.banks --split test``.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitigate.core.files import atomic_text
from mitigate.core.seeding import generator
from mitigate.corruptions.language.landmarks import CANONICAL
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.foreign import front, judgement
from mitigate.guards.text.learning import routes, trials
from mitigate.guards.text.learning.data import draw_pair, vary
from mitigate.guards.text.texts import weights
from mitigate.guards.text.texts.evidence import HIDDEN, VERBS, composition, in_context, terms, worth
from mitigate.guards.text.texts.lexicon import GROUPS
from mitigate.guards.text.texts.pieces import parts, sentence_pieces
from mitigate.guards.text.texts.text import words

PAIRS, RIDGE, ITERATIONS, FOLDS = 6000, 2.0, 30, 8
RARE, ODDS = 12, 30.0  # a style word occurs so often, and so many times as often as in plain text
ASIDE = 0.3  # weight of what a voice says beside the route
PRIOR = 0.5  # of a word, in the weight of examples
TOTAL, SHARE = 2000.0, 0.25  # weight of all examples, and of the attacks among them (ours)


@dataclass(frozen=True)
class Example:
    """A piece of text, whether it is an attack, how much it counts, its ``fold``."""

    text: str
    markup: bool
    attack: bool
    weight: float
    fold: int


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit, and print the weights or write them. ``arguments``: of the command line."""
    parser = argparse.ArgumentParser(prog="python -m mitigate.guards.text.fit", description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"replace {weights.FILE.name}")
    parser.add_argument("--split", choices=("tune", trials.ALL), default=trials.ALL,
                        help="part of the banks to fit on")  # fmt: skip
    parser.add_argument("--front", action="store_true", help="fit FRONT alone; keep the others")
    options = parser.parse_args(arguments)
    if options.front:
        fitted = json.loads(weights.FILE.read_text(encoding="utf-8"))
        fitted["front"] = _rounded(front_weights(examples(options.split)), 3)
    else:
        fitted = fit(options.split)
    text = json.dumps(fitted, indent=1) + "\n"
    if not options.write:
        print(text, end="")
        return
    with atomic_text(weights.FILE) as file:
        file.write(text)
    print(f"wrote {weights.FILE}", file=sys.stderr)


def fit(split: str) -> dict[str, Any]:
    """Return what ``weights.json`` holds, fitted on a split of the banks."""
    found, table = fit_weights(split)
    regressions = {name: _rounded(weight, 3) for name, weight in found.items()}
    return {
        **regressions,
        "style": style_words(),
        "words": _rounded(dict(sorted(table.items())), 2),
    }


def _rounded(found: Mapping[str, float], digits: int) -> dict[str, float]:
    return {name: round(value, digits) for name, value in found.items()}


def fit_weights(split: str) -> tuple[dict[str, dict[str, float]], dict[str, float]]:
    """Return name -> weights of the regressions, and what words are worth."""
    found = examples(split)
    whole = word_table(found)
    tables = [word_table([e for e in found if e.fold != out]) for out in range(FOLDS)]
    rows = [composition(e.text, e.markup) | worth(e.text, tables[e.fold]) for e in found]
    own = _regression(rows, [e.attack for e in found], [e.weight for e in found])
    strange = {}
    for out in range(FOLDS):
        seen = [i for i, e in enumerate(found) if e.fold != out]
        fitted = _regression(
            [rows[i] for i in seen],
            [found[i].attack for i in seen],
            [found[i].weight for i in seen],
        )
        for e, row in zip(found, rows, strict=True):
            if e.fold == out:
                strange[e.text, e.markup] = judgement.probability(fitted, row)
    context, part = _context(split, own, whole, strange), _part(split, own, tables)
    return {"own": own, "context": context, "part": part, "front": front_weights(found)}, whole


def examples(split: str) -> list[Example]:
    """Return the pieces of text to fit on."""
    return [*_attacks(split), *_routes(split)]


def front_weights(examples: Sequence[Example]) -> dict[str, float]:
    """Return the weights of the few counts of ``front.py``, by the same examples as the others."""
    rows = [front.counts(e.text) for e in examples]
    return _regression(rows, [e.attack for e in examples], [e.weight for e in examples])


def word_table(examples: Sequence[Example]) -> dict[str, float]:
    """Return word or pair of words -> log odds of attacks against routes, at most 2 either way;
    pairs that are rare are left out."""
    weights = _balanced([e.attack for e in examples], [e.weight for e in examples])
    seen: Counter[str] = Counter()
    mass: tuple[Counter[str], Counter[str]] = (Counter(), Counter())
    for e, weight in zip(examples, weights, strict=True):
        for term in terms(e.text):
            seen[term] += 1
            mass[e.attack][term] += weight
    attack, route = TOTAL * SHARE, TOTAL * (1 - SHARE)
    odds = {
        term: math.log((mass[1][term] + PRIOR * SHARE) / attack)
        - math.log((mass[0][term] + PRIOR * (1 - SHARE)) / route)
        for term, count in seen.items()
        if count > 2 or "_" not in term
    }
    return {term: max(-2.0, min(2.0, value)) for term, value in odds.items()}


def _attacks(split: str) -> list[Example]:
    found = [(a.mechanism, a.words, 1.0) for a in trials.attacks(split) if a.place == "any"]
    found += [(family, line, 1.0) for family, line in trials.learned_prefixes()]
    found += [(f"ours {i % 8}", line, 1.0) for i, line in enumerate(trials.fitting("fit_attacks"))]
    rng = generator(0, "fit")
    found += [("varied", vary(rng), 0.15) for _ in range(200)]
    found += [(f"aside {voice}", said, ASIDE) for voice, said in trials.asides(split)]
    groups = sorted({group for group, _, _ in found})
    return [
        Example(piece.of(line), bool(piece.block), True, weight, groups.index(group) % FOLDS)
        for group, line, weight in found
        for piece in sentence_pieces(line)
        if not piece.tag
    ]


def _routes(split: str) -> list[Example]:
    found: list[tuple[str, float, int]] = []
    voices = trials.voices(split)
    for task in ("route", "object"):
        for told in trials.told(split, task):
            fold = voices.index(told.voice) % FOLDS
            found += [(part, 1.0, fold) for part in told.parts] + [(told.plain, 1.0, fold)]
    lines = [(routes.draw_route(generator(0, "fit", i)), 1.5) for i in range(600)]
    for bank in ("near_misses", "odd_routes"):
        lines += [(line["text"], 6.0) for line in trials.half(bank, split)]
    lines += [(line, 4.0) for line in trials.fitting("fit_routes")]
    for bank in ("lies", "honest"):
        for line in trials.half(bank, split):
            lines += [(text, 1.0) for key, text in line.items() if key != "kind"]
    found += [(text, weight, index % FOLDS) for index, (text, weight) in enumerate(lines)]
    return [
        Example(piece.of(text), bool(piece.block), False, weight, fold)
        for text, weight, fold in found
        for piece in sentence_pieces(text)
        if weight != 1.0 or gate.route_facts(piece.of(text))  # the others frame, and may go
    ]


def _context(
    split: str,
    own: Mapping[str, float],
    table: Mapping[str, float],
    strange: Mapping[tuple[str, bool], float],
) -> dict[str, float]:
    """Return the weights of sentences among others; attacks stand in plain and restyled routes.

    ``strange``: probabilities by fits that had not seen the sentence, where there are such.
    """
    styled, plain = trials.told(split), trials.plainly_told(split)
    heard = [(told.text, "") for told in (*styled, *plain)]
    heard += [(line["text"], "") for line in trials.half("near_misses", split)] * 3
    heard += [(line, "") for line in trials.fitting("fit_routes")]
    found = [a for a in trials.attacks(split) if a.place == "any"]
    found += [trials.Attack("ours", "any", line) for line in trials.fitting("fit_attacks")]
    for told in (styled, plain):
        heard += [(text, a.words) for a, _, _, text in trials.trials(found, told, 1)]
    rows, attacks = [], []
    for text, attack in heard:
        pieces = sentence_pieces(text)
        said = [piece.of(text) for piece in pieces]
        known = []
        for s, piece in zip(said, pieces, strict=True):
            p = strange.get((s, bool(piece.block)))
            row = composition(s, bool(piece.block)) | worth(s, table)
            known.append(judgement.probability(own, row) if p is None else p)
        for s, p, row in zip(said, known, in_context(said, known), strict=True):
            foreign = bool(attack) and s in attack
            if foreign or gate.route_facts(s) or not attack:
                rows.append({"own": judgement.logit(p), **row})
                attacks.append(foreign)
    return _regression(rows, attacks, [1.0] * len(rows))


def _part(
    split: str, own: Mapping[str, float], tables: Sequence[Mapping[str, float]]
) -> dict[str, float]:
    """Return the weights of parts inside sentences."""
    styled, plain = trials.told(split), trials.plainly_told(split)
    inside = [a for a in trials.attacks(split) if a.place == "inside"]
    short = [line for line in trials.fitting("fit_attacks") if len(line.split()) < 12]
    ours = [trials.Attack("ours", "inside", line.strip(" ,.")) for line in short]
    heard = [(t, a.words, 0.5) for told in (styled, plain)
        for a, _, _, t in trials.trials(inside, told, 4)]  # fmt: skip
    heard += [(t, a.words, 0.5) for a, _, _, t in trials.trials(ours, plain, 2)]
    heard += [(told.text, "", 1.0) for told in (*styled, *plain)]
    heard += [(line["text"], "", 6.0) for line in trials.half("near_misses", split)]
    rows, attacks, weights = [], [], []
    for index, (text, attack, weight) in enumerate(heard):
        table = tables[index % FOLDS]
        for piece in sentence_pieces(text):
            whole = piece.of(text)
            row = composition(whole, bool(piece.block)) | worth(whole, table)
            p = judgement.probability(own, row)
            for part in parts(text, piece):
                said = part.of(text)
                evidence = {**composition(said), **worth(said, table)}
                rows.append({"whole": judgement.logit(p), **evidence})
                attacks.append(bool(attack) and said.strip(",. ") in attack)
                weights.append(weight)
    return _regression(rows, attacks, weights)


def _balanced(attacks: Sequence[bool], weights: Sequence[float]) -> np.ndarray:
    """Return the weights, of which attacks have the share ``SHARE`` of ``TOTAL``."""
    y, weight = np.array(attacks), np.array(weights)
    attack, route = SHARE / weight[y].sum(), (1 - SHARE) / weight[~y].sum()
    return TOTAL * weight * np.where(y, attack, route)


def _regression(
    rows: Sequence[Mapping[str, float]], attacks: Sequence[bool], weights: Sequence[float]
) -> dict[str, float]:
    """Return bias and weights: Newton's method on the ridge-penalised log-likelihood."""
    names = list(rows[0])
    x = np.array([[1.0, *(row[name] for name in names)] for row in rows])
    y, weight = np.array(attacks, float), _balanced(attacks, weights)
    ridge = np.array([1e-3, *(RIDGE * (0.1 if name in HIDDEN else 1.0) for name in names)])
    w = np.zeros(x.shape[1])
    for _ in range(ITERATIONS):
        p = 1 / (1 + np.exp(-np.clip(x @ w, -30, 30)))
        slope = x.T @ (weight * (p - y)) + ridge * w
        curve = (x * (weight * p * (1 - p) + 1e-9)[:, None]).T @ x + np.diag(ridge)
        w -= np.linalg.solve(curve, slope)
    return dict(zip(("bias", *names), map(float, w), strict=True))


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
