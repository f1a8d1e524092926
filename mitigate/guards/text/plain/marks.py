"""Which marks of a sentence stay after its edits: hyphens inside words, quotes and brackets in
pairs, and what parts two clauses of which something stays."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.plain.edits import DROP, KEEP, Edited
from mitigate.guards.text.texts.steps import HALTS, MOVES, STEP

_BRACKETS = frozenset("()[]")
_QUOTES = frozenset("'\"“”‘’`")
_PARTING = frozenset(",;:–—")
_JOINS = bag("and then or but")
_BEGINS = (
    MOVES
    | STEP.keys()
    | HALTS
    | bag("face keep start turn left right after before when once until")
)


def marks_kept(made: Edited) -> None:
    """Keep and drop marks in place."""
    _parting(made)
    for pair in (_QUOTES, _BRACKETS):
        kept = [p for p, t in enumerate(made.found) if t.text in pair and made.kept(p)]
        for place in kept if len(kept) % 2 else ():
            made.acts[place] = DROP
    for place in range(1, len(made.found) - 1):
        one, mark, other = made.found[place - 1 : place + 2]
        if mark.text == "-" and one.end == mark.start and mark.end == other.start:
            whole = made.kept(place - 1) and made.kept(place + 1)
            made.acts[place], made.before[place] = KEEP if whole else DROP, 0


def _parting(made: Edited) -> None:
    """Give back a mark between two words that stay, where nothing else parts them: the only one
    there, or the last before a word that begins a clause (others stood around what was aside)."""
    before = None  # place of the last word that stays
    for place, token in enumerate(made.found):
        if not (token.is_word and made.kept(place)):
            continue
        between = range(0 if before is None else before + 1, place)
        parted = any(made.kept(p) or made.before[p] for p in between) or made.before[place]
        parted = parted or before is None or made.found[before].lower in _JOINS
        marks = [p for p in between if made.found[p].text in _PARTING]
        begins = len(marks) == 1 or token.lower in _BEGINS
        if marks and begins and not parted and token.lower not in _JOINS:
            made.acts[marks[-1]] = KEEP
        before = place
