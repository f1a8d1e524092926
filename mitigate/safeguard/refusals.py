"""Why a language model's answer may not stand for a passage."""

from __future__ import annotations

from mitigate.corruptions.language.fidelity import facts
from mitigate.safeguard import gate, masks
from mitigate.safeguard.text import MASK, words


def refusal(passage: str, answer: str | None, last: bool = False) -> str:
    """Return why ``answer`` may not stand for ``passage``, the ``last`` of its text or another;
    empty if it may."""
    if answer is None:
        return "no answer in time"
    if MASK.search(passage):
        return _refused_filling(passage, answer)
    if len(words(answer)) > len(words(passage)) + 3:
        return "longer than what it replaces"
    return gate.rewrite_refused(passage, answer, last)


def _refused_filling(passage: str, answer: str) -> str:
    """Return why ``answer`` may not fill the masks of ``passage``: only small words are hidden, so
    what stands for one must not say where to go, what is there or what it is like."""
    found = masks.filled(passage, answer)
    if found is None:
        return "other words than the masks changed"
    said = facts(", ".join(word for word in found if word))
    added = (*said.landmarks, *said.numbers, *said.compass, *said.attributes)
    if added:
        return f"invented: {', '.join(added)}"
    if said.denials or facts(answer).directions != facts(masks.fill(passage)).directions:
        return "directions changed by a hidden word"
    return ""
