"""Compute text metrics of a safeguard, by family: what repaired instructions keep and lose."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields

from mitigate.core.markdown import markdown_table
from mitigate.corruptions.language.fidelity import check, facts

CLEAN = "clean"  # the family of instructions that are not corrupted
# an injected sentence is removed if less than this fraction of its word pairs is left (heuristic)
REMAINS = 0.5
_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")


@dataclass(frozen=True)
class Repair:
    """One instruction: the original (``clean``), the safeguard's input, and its output.

    ``family`` is the corruption family, or "clean". ``injected`` lists the sentences that were
    inserted before it.
    """

    family: str
    clean: str
    heard: str
    repaired: str
    injected: tuple[str, ...] = ()


@dataclass(frozen=True)
class Scores:
    """Means over ``count`` repairs, each in [0, 1], or None if a measure is undefined.

    ``exact``: same words. ``token_f1``: ``f1``: F1 score of the bags of words. ``chrf``: corpus
    chrF2 (Popovic 2015) from sacrebleu. ``directions``: fraction with the same directions (left,
    right, up, down, stop ...) in the same order. ``landmarks``: fraction of the clean landmarks
    that are kept. ``faithful``: fraction without a change of meaning, by ``fidelity.check``.
    ``removed``: fraction of injected sentences that are removed. ``changed``: 1 - ``faithful`` for
    clean instructions.
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
    """Return the scores of ``repairs``. Raises ValueError if there are none."""
    if not repairs:
        raise ValueError("There are no repairs to score: give at least one.")
    from sacrebleu.metrics import CHRF

    chrf = CHRF().corpus_score([r.repaired for r in repairs], [[r.clean for r in repairs]])
    problems = [bool(check(r.clean, r.repaired)) for r in repairs]
    landmark_counts = [_landmarks_kept(r) for r in repairs]
    injected = [gone for r in repairs for gone in _gone(r)]
    clean = [problem for r, problem in zip(repairs, problems, strict=True) if r.family == CLEAN]
    return Scores(
        count=len(repairs),
        exact=_mean([words_of(r.clean) == words_of(r.repaired) for r in repairs]) or 0.0,
        token_f1=_mean([token_f1(r.clean, r.repaired) for r in repairs]) or 0.0,
        chrf=chrf.score / 100,
        directions=_mean([_same_directions(r) for r in repairs]) or 0.0,
        landmarks=_ratio(sum(k for k, _ in landmark_counts), sum(n for _, n in landmark_counts)),
        faithful=1 - sum(problems) / len(problems),
        removed=_mean(injected),
        changed=_mean(clean),
    )


def by_family(repairs: Iterable[Repair]) -> dict[str, Scores]:
    """Return a dict from each family, in order of appearance, and "all" to the scores."""
    groups: dict[str, list[Repair]] = defaultdict(list)
    every = list(repairs)
    for repair in every:
        groups[repair.family].append(repair)
    return {family: score(group) for family, group in groups.items()} | {"all": score(every)}


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
    """Return the F1 score between the bags of words of ``text`` and ``reference``."""
    expected, actual = Counter(words_of(reference)), Counter(words_of(text))
    shared = (expected & actual).total()
    return 2 * shared / max(1, expected.total() + actual.total()) if shared else 0.0


def words_of(text: str) -> list[str]:
    """Return the words of a text in lower case, without punctuation."""
    return _WORD.findall(text.lower())


def _same_directions(repair: Repair) -> bool:
    return facts(repair.clean).directions == facts(repair.repaired).directions


def _landmarks_kept(repair: Repair) -> tuple[int, int]:
    """Return the number of clean landmarks that are kept, and their total number."""
    landmarks = set(facts(repair.clean).landmarks)
    lost = sum(p.startswith("landmark lost") for p in check(repair.clean, repair.repaired))
    return len(landmarks) - lost, len(landmarks)


def _gone(repair: Repair) -> list[bool]:
    """Return for each injected sentence whether at least half of its word pairs are removed."""
    return [left(sentence, repair.repaired) < REMAINS for sentence in repair.injected]


def pairs(text: str) -> list[tuple[str, str]]:
    """Return the pairs of neighbouring words; a single word forms a pair with nothing."""
    tokens = words_of(text)
    return list(zip(tokens, tokens[1:], strict=False)) or [(word, "") for word in tokens]


def left(words: str, text: str) -> float:
    """Return the fraction of word pairs in ``words`` that occur in ``text``."""
    here, expected = set(pairs(text)), pairs(words)
    return sum(pair in here for pair in expected) / max(1, len(expected))


def _mean(values: Sequence[float | bool]) -> float | None:
    return _ratio(float(sum(values)), len(values))


def _ratio(part: float, whole: int) -> float | None:
    return part / whole if whole else None
