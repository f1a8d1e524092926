"""Repairs that need no language model: odd capitals, and what does not belong to a route.

A text is cut into pieces; each is judged by what it says (:mod:`evidence`) and then by what stands
around it. What seems to be no part of the route goes, if the gate lets it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.foreign.courtesy import framing
from mitigate.guards.text.foreign.front import in_front
from mitigate.guards.text.foreign.harmless import harmless
from mitigate.guards.text.foreign.inside import (
    announces,
    foreign_clauses,
    foreign_parts,
    heads,
    leans,
    route_remains,
)
from mitigate.guards.text.foreign.judgement import (
    PLAIN,
    SURE,
    Judged,
    asked,
    judged,
    leads,
    wrapped,
)
from mitigate.guards.text.plain.manners import asks_for_way, unasked
from mitigate.guards.text.plain.plainly_said import Tags, judging
from mitigate.guards.text.texts.honest import attacks, belongs
from mitigate.guards.text.texts.lexicon import known_words
from mitigate.guards.text.texts.pieces import Piece, sentence_pieces, without
from mitigate.guards.text.texts.short_steps import goes_on
from mitigate.guards.text.texts.text import words
from mitigate.guards.text.texts.weights import STYLE

# probabilities from which a piece goes: one that tells nothing, one that names things, one that
# tells the way (chosen on the tuning parts of the banks)
LEAST = (0.5, 0.7, 0.85)
PLAIN_LEAST = (0.45, 0.6, 0.7)  # where the rest is surely a route, in plain words
AHEAD = 0.4  # strangeness of what goes in front of such a rest
ASK = 0.10  # from here on a language model is asked about a piece
KEPT_CAPITALS = bag("TV TVS DVD BBQ AC PC")
# known words in capitals, and their share, from which all are lowered; some may be on a sign (ours)
SHOUTS, SHOUTED = 2, 0.15
_COUNT = re.compile(r"\(?\d{1,2}[.)]?")  # of a list
_SHOUT = re.compile(r"(?<![\[<])\b[A-Z][A-Z'’]+\b")


@dataclass(frozen=True)
class Repaired:
    """``text`` after the rules, what they took out, and what they did and could not, in words.

    ``marks``: how many words of the rest, and of greetings that went, belong to a manner of
    speaking.
    """

    text: str
    removed: tuple[str, ...]
    reasons: tuple[str, ...]
    marks: int


def doubtful(text: str, tags: Tags | None = None) -> list[str]:
    """Return the sentences that a language model should judge: neither plain nor surely foreign,
    and beside a surely foreign one whatever is not."""
    found = judged(text, tags)
    if len(found) < 2:
        return []
    least = 0.0 if any(j.foreign >= SURE for j in found) else ASK
    return [j.text for j in found if least <= j.foreign < SURE and not _refused(found, j)]


def injected(
    text: str, judge: Callable[[str], bool] | None = None, tags: Tags | None = None
) -> list[Judged]:
    """Return the sentences of ``text`` that are no part of the route; never all of them.

    ``judge`` (a language model) decides on the ``doubtful`` ones.
    """
    found = judged(text, tags)
    asked = set() if judge is None else set(doubtful(text, tags))
    rest = [one.own for one in found if one.foreign < SURE]
    least = PLAIN_LEAST if sum(rest) < PLAIN * len(rest) else LEAST
    ahead = ahead_of_plain(text, tags)
    chosen = []
    for one in found:
        sure = one.foreign >= least[gate.weight(one.text)] or one.piece in ahead
        if sure or (judge is not None and one.text in asked and judge(one.text)):
            chosen.append(one)
    return chosen


@lru_cache(maxsize=512)
def ahead_of_plain(text: str, tags: Tags | None = None) -> frozenset[Piece]:
    """Return the sentences in front of what is surely a plain route that are no part of it
    (:mod:`front`), but for those that seem to be by what they say."""
    found, front = judged(text, tags), set(in_front(text))
    rest = [one.own for one in found if one.text not in front]
    if not front or not rest or sum(rest) >= PLAIN * len(rest):
        return frozenset()
    return frozenset(one.piece for one in found if one.text in front and one.own >= AHEAD)


def style_marks(text: str) -> int:
    """Return how many words of ``text`` belong to a manner of speaking, not to plain routes."""
    return sum(word in STYLE for word in words(text))


def lower_capitals(text: str) -> str:
    """Return ``text`` with shouted words in lower case, but for a sentence's first letter."""
    shouted = [m.group().lower() for m in _SHOUT.finditer(text) if m.group() not in KEPT_CAPITALS]
    known = sum(word in known_words() for word in shouted)
    if known < max(SHOUTS, SHOUTED * len(text.split())):
        return text

    def quiet(match: re.Match[str]) -> str:
        word = match.group()
        if word in KEPT_CAPITALS:
            return word
        before = text[: match.start()].rstrip()
        first = not before or before[-1] in ".!?"
        return word.capitalize() if first else word.lower()

    return _SHOUT.sub(quiet, text)


def repair(
    text: str, judge: Callable[[str], bool] | None = None, tags: Tags | None = None
) -> Repaired:
    """Return ``text`` with capitals lowered and what is foreign taken out; ``judge``: a language
    model that is asked about a sentence, ``tags``: a network that reads the text as well."""
    tags = judging(tags, text)
    reasons: list[str] = []
    quiet = lower_capitals(text)
    if quiet != text:
        reasons.append("capitals lowered")
    out, refused = _chosen(quiet, judge, tags)
    reasons += refused
    out, undone = _allowed(quiet, out, tags)
    reasons += undone
    removed = tuple(piece.of(quiet) for piece in out)
    if removed:
        reasons.append(f"removed: {'; '.join(repr(s[:60]) for s in removed)}")
    left = without(quiet, out)
    framed = sum(style_marks(s) for s in removed if framing(s))
    return Repaired(left, removed, tuple(reasons), style_marks(left) + framed)


def repaired_sections(parts: Sequence[str]) -> list[str]:
    """Return consecutive sections of a text after the rules; one that tells nothing of the way is
    read beside a sentence of another one that does, as it would be in the whole text."""
    told = [_plainly_told(part) for part in parts]
    beside = next(filter(None, told), "")
    done = []
    for place, (part, own) in enumerate(zip(parts, told, strict=True)):
        if own or not beside:
            done.append(repair(part).text)
            continue
        read = f"{beside} {part}" if place else f"{part.rstrip()} {beside}"
        given = repair(read).text
        if given == read:
            done.append(part)
        elif place and given.startswith(beside):
            done.append(given.removeprefix(beside).lstrip())
        elif not place and given.endswith(beside):
            done.append(given.removesuffix(beside).rstrip())
        else:
            done.append(repair(part).text)
    return done


def _plainly_told(part: str) -> str:
    """Return the first sentence of a section that surely leads one on a plain way, or ""."""
    said = (piece.of(part) for piece in sentence_pieces(part) if not piece.block)
    return next(
        (s for s in said if leads(s) and gate.route_facts(s) and asked(s, False) < PLAIN), ""
    )


def _chosen(
    text: str, judge: Callable[[str], bool] | None, tags: Tags | None
) -> tuple[list[Piece], list[str]]:
    """Return what should go and the gate lets go, and what it refused."""
    out: list[Piece] = []
    reasons = []
    foreign = {one.piece for one in injected(text, judge, tags)}
    found = judged(text, tags)
    wraps = wrapped(text, [one.piece for one in found])
    ends = {found[0].piece, found[-1].piece} if len(found) > 1 else set()
    tell = sum(bool(gate.route_facts(one.text)) for one in found)
    for one in found:
        block = one.piece.block
        if _COUNT.fullmatch(one.text):
            continue
        if one.piece.tag or (block and block not in wraps and not _told(text, found, one)):
            out.append(one.piece)
            continue
        others = tell > bool(gate.route_facts(one.text))
        inside = foreign_parts(text, one, tags)
        announced = others and (announces(text, one, inside) or _headed(found, one))
        inside = [part for part in inside if not leans(text, one, part)]
        if announced:
            out.append(one.piece)
        elif inside and route_remains(text, one, inside):
            out += inside
        elif one.piece in foreign:
            problem, some = _refused(found, one), foreign_clauses(text, one, others)
            if some:
                out += some
            elif problem:
                reasons.append(f"kept {one.text[:40]!r}: {problem}")
            else:
                out.append(one.piece)
        elif one.piece in ends and framing(one.text) and not _refused(found, one):
            out.append(one.piece)
    return out, reasons


def _told(text: str, found: Sequence[Judged], one: Judged) -> bool:
    """Return whether a sentence behind a mark of a heading or a comment tells the way and is no
    attack by itself. What stands between tags is none: nobody writes routes there."""
    own = [other for other in found if other.piece.block == one.piece.block]
    if any(other.piece.tag for other in own) or text[own[0].piece.start] not in "#/":
        return False
    tells = gate.route_facts(one.text) and leads(one.text)
    return bool(tells) and asked(one.text, False) < gate.ATTACK


def _headed(found: Sequence[Judged], one: Judged) -> bool:
    """Return whether a sentence stands behind one that is but a heading of an attack ("SYSTEM")."""
    place = next(n for n, other in enumerate(found) if other is one)
    before = found[place - 1] if place else None
    return before is not None and not before.piece.tag and heads(before.text)


def _refused(found: Sequence[Judged], one: Judged) -> str:
    """Return why one of the sentences may not be taken out."""
    place = next(n for n, other in enumerate(found) if other is one)
    behind = found[place + 1 :]  # nothing but thanks
    last = all(framing(other.text) for other in behind) and not any(
        other.foreign >= SURE for other in found[max(place - 1, 0) : place]
    )
    others = [other.text for other in found if other is not one]
    first = one is found[0]
    if last and goes_on(one.text) and _ended(found[:place]):
        return ""
    refused = (
        harmless(one.text, others, first, last)
        or gate.removal_refused(unasked(one.text), one.own, first, last)
        or belongs(unasked(one.text), first, last)
    )
    ends = last and not first and one.own < gate.ATTACK and not attacks(one.text.lower())
    goal = ends and asks_for_way(one.text) and gate.mentioned(one.text)
    return refused or ("it may tell where the way ends" if goal else "")


def _ended(before: Sequence[Judged]) -> bool:
    """Return whether the last sentence that is no attack stops, or tells what to find."""
    said = next((one.text for one in reversed(before) if one.foreign < SURE), "")
    return "stop" in facts(said).directions or bool(gate.sought(said, hunted=True))


def _allowed(text: str, out: list[Piece], tags: Tags | None) -> tuple[list[Piece], list[str]]:
    """Return what may go so that the rest passes the gate: what is least foreign stays first."""
    reasons = []
    strange = {one.piece: one.foreign for one in judged(text, tags)}
    out = list(out)
    while out:
        problem = gate.result_refused(text, without(text, out))
        if not problem:
            break
        back = min(
            out, key=lambda p: (not gate.route_facts(p.of(text)), strange.get(p, 1.0), p.start)
        )
        out.remove(back)
        reasons.append(f"kept {back.of(text)[:40]!r}: {problem}")
    return out, reasons
