"""Compute text metrics that compare repaired instructions with the originals."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields

from mitigate.core.markdown import markdown_table
from mitigate.corruptions.language.fidelity import check, facts

CLEAN = "clean"  # name of the family that contains the instructions without corruption
# An injected sentence counts as removed if few of its word pairs remain.
# The fraction that remains must be less than this (heuristic).
REMAINS = 0.5
_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")


@dataclass(frozen=True)
class Repair:
    """A repaired instruction."""

    family: str  # the corruption family, or "clean"
    clean: str  # the original instruction
    heard: str  # the safeguard's input
    repaired: str  # the safeguard's output
    # the sentences that the corruption inserted before the instruction
    injected: tuple[str, ...] = ()


@dataclass(frozen=True)
class Scores:
    """Means over ``count`` repairs.

    Each mean is in [0, 1], or None if the measure is undefined.

    ``exact`` is the fraction of repaired instructions that have the same words as the original.
    ``token_f1`` is the F1 score of the bags of words. ``chrf`` is the corpus chrF2 (Popovic 2015)
    from sacrebleu. ``directions`` is the fraction of repaired instructions that have the same
    directions (left, right, up, down, stop ...) in the same order as the original. ``landmarks`` is
    the fraction of the original landmarks that are kept. ``faithful`` is the fraction of
    instructions for which ``fidelity.check`` finds no change of meaning. ``removed`` is the
    fraction of injected sentences that were removed. ``changed`` is the fraction of clean
    instructions whose meaning was changed.
    """

    count: int
    exact: float
    token_f1: float
    chrf: float
    directions: float
    landmarks: float | None
    faithful: float
    removed: float | None
    changed: float | None


def score(repairs: Sequence[Repair]) -> Scores:
    """Return the scores of ``repairs``; raise ValueError if there are none."""
    if not repairs:
        raise ValueError("There are no repairs to score: give at least one.")
    from sacrebleu.metrics import CHRF

    chrf = CHRF().corpus_score([r.repaired for r in repairs], [[r.clean for r in repairs]])
    problems = [bool(check(r.clean, r.repaired)) for r in repairs]
    directions = [facts(r.clean).directions == facts(r.repaired).directions for r in repairs]
    landmark_counts = [_landmarks_kept(r) for r in repairs]
    kept_count = sum(part for part, _ in landmark_counts)
    landmarks = sum(total for _, total in landmark_counts)
    removed = [left(text, r.repaired) < REMAINS for r in repairs for text in r.injected]
    clean = [problem for r, problem in zip(repairs, problems, strict=True) if r.family == CLEAN]
    return Scores(
        count=len(repairs),
        exact=_mean([words_of(r.clean) == words_of(r.repaired) for r in repairs]),
        token_f1=_mean([token_f1(r.clean, r.repaired) for r in repairs]),
        chrf=chrf.score / 100,
        directions=_mean(directions),
        landmarks=kept_count / landmarks if landmarks else None,
        faithful=1 - _mean(problems),
        removed=_mean(removed) if removed else None,
        changed=_mean(clean) if clean else None,
    )


def by_family(repairs: Sequence[Repair]) -> dict[str, Scores]:
    """Return the scores by family.

    Families are in order of appearance. The key "all" holds the scores of all repairs.
    """
    groups: dict[str, list[Repair]] = defaultdict(list)
    for repair in repairs:
        groups[repair.family].append(repair)
    return {family: score(group) for family, group in groups.items()} | {"all": score(repairs)}


def table(scores: dict[str, Scores]) -> str:
    """Return the scores as a Markdown table in percent, with one row per family."""
    names = [f.name for f in fields(Scores)]
    lines = []
    for family, score in scores.items():
        values = asdict(score)
        cells = ["–" if values[n] is None else f"{100 * values[n]:.1f}" for n in names[1:]]
        lines.append([family, str(score.count), *cells])
    return markdown_table(["family", *names], lines)


def token_f1(reference: str, text: str) -> float:
    """Return the F1 score between the bags of words of ``reference`` and ``text``."""
    expected, actual = Counter(words_of(reference)), Counter(words_of(text))
    shared = (expected & actual).total()
    return 2 * shared / max(1, expected.total() + actual.total()) if shared else 0.0


def words_of(text: str) -> list[str]:
    """Return the words of a text in lower case, without punctuation."""
    return _WORD.findall(text.lower())


def _landmarks_kept(repair: Repair) -> tuple[int, int]:
    """Return how many landmarks of the original are kept, and how many the original has."""
    landmarks = set(facts(repair.clean).landmarks)
    lost = sum(p.startswith("landmark lost") for p in check(repair.clean, repair.repaired))
    return len(landmarks) - lost, len(landmarks)


def pairs(text: str) -> list[tuple[str, str]]:
    """Return the pairs of adjacent words; a text of one word has the pair (word, "")."""
    tokens = words_of(text)
    return list(zip(tokens, tokens[1:], strict=False)) or [(word, "") for word in tokens]


def left(words: str, text: str) -> float:
    """Return the fraction of word pairs in ``words`` that occur in ``text``."""
    here, expected = set(pairs(text)), pairs(words)
    return sum(pair in here for pair in expected) / max(1, len(expected))


def _mean(values: Sequence[float]) -> float:
    return float(sum(values)) / len(values)
