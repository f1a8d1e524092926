"""What a text that was made by taking words out of another does not tell any more, fact by fact."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from mitigate.corruptions.language.landmarks import normal
from mitigate.corruptions.language.words import bag
from mitigate.safeguard.meaning import Meaning, meaning, missing, moved
from mitigate.safeguard.plain_words import plain_form

# words that may carry a turn, a climb or a stop
_CARRY = {
    "left": "left leftward leftwards leftmost l port",
    "right": "right rightward rightwards rightmost r starboard",
    "around": "around round about back 180 reverse rotate full u",
    "stop": "stop stops stopping stopped wait waits waiting halt halts halting pause stay stays "
    "remain remains hold holds stand stands standing rest end ends done arrived",
    "up": "up upstairs upward upwards climb climbs climbing ascend ascends ascending mount",
    "down": "down downstairs downward downwards descend descends descending",
}
_ENDS = bag(
    "remain remains rest rests hold await destination goal target arrive arrives arrived reached "
    "done finish finished concluded conclude halt stand stay stays park"
)
_CARRIERS = {name: frozenset(words.split()) for name, words in _CARRY.items()}


def unproven(heard: str, said: str, aside: Iterable[str]) -> str:
    """Return a fact of ``heard`` that is not in ``said`` though no word of it is ``aside`` (words
    in lower case that are surely no part of the way), or one of ``said`` that was not heard; ""
    if there is none."""
    old, new = meaning(heard), meaning(said)
    gone = Counter(aside)
    named = {normal(plain_form(word)) for word in gone}
    problem = _turns(old, new, gone) or _counted(old, new, gone)
    if problem:
        return problem
    for name in missing(old, new, speech=True):
        if name not in named:
            return f"landmark lost: {name}"
    added = next(iter(missing(new, old, every=True)), "")
    return f"landmark invented: {added}" if added else moved(old, new)


def _turns(old: Meaning, new: Meaning, gone: Counter[str]) -> str:
    before, after = (Counter([d for d, _ in m.turns] + list(m.levels)) for m in (old, new))
    for name, count in (after - before).items():
        if name != "stop" or not before["stop"] and not _ends(old):
            return f"directions: {count} {name} more"
    for name, count in (before - after).items():
        if name == "stop" and after["stop"]:
            continue
        if sum(gone[word] for word in _CARRIERS[name]) < count:
            return f"directions: {count} {name} less"
    if old.sharpness and new.sharpness and old.sharpness != new.sharpness:
        return "sharpness changed"
    return ""


def _ends(old: Meaning) -> bool:
    """Return whether a text may mean to stop without saying so."""
    return bool(old.words & _ENDS)


def _counted(old: Meaning, new: Meaning, gone: Counter[str]) -> str:
    if new.denied and not old.denied:
        return "a denial more"
    if old.denied and not new.denied:  # what is left may be the contrary, however sure
        return "a denial less"
    for kind in ("numbers", "colours", "compass"):
        before, after = (Counter(set(getattr(m, kind))) for m in (old, new))
        if after - before:
            return f"{kind}: {', '.join(after - before)} more"
        known = {plain_form(word) for word in gone} | set(gone)
        for name in before - after:
            if name not in known:
                return f"{kind}: {name} less"
    return ""
