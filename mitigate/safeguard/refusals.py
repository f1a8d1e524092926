"""Why a language model's answer may not stand for a passage."""

from __future__ import annotations

from mitigate.corruptions.language.fidelity import ATTRIBUTES, facts
from mitigate.safeguard import gate, masks
from mitigate.safeguard.plain_words import plain_form
from mitigate.safeguard.plainly_said import Said
from mitigate.safeguard.text import MASK, words


def refusal(part: Said, answer: str | None, last: bool = False, spoken: bool = False) -> str:
    """Return why ``answer`` may not stand for ``part``, the ``last`` of its text or another; empty
    if it may. What a tagger takes for speech (``spoken``) passes as its edits do."""
    if answer is None:
        return "no answer in time"
    if MASK.search(part.heard):
        return _refused_filling(part.heard, answer)
    if len(words(answer)) > len(words(part.heard)) + 3:
        return "longer than what it replaces"
    if not spoken:
        return gate.rewrite_refused(part.heard, answer, last) or _plainer(part.heard, answer)
    if part.said and not answer:
        return "the tagger would keep some of it"
    return gate.edit_refused(part.heard, answer, part.aside)


def _plainer(heard: str, said: str) -> str:
    """Return what of a thing ``heard`` tells and ``said`` does not: small, open, wooden ..."""
    old, new = ({plain_form(word) for word in words(text)} & ATTRIBUTES for text in (heard, said))
    lost = old - new
    return f"attributes: {', '.join(sorted(lost))} less" if lost else ""


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
