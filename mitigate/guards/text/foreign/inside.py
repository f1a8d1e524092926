"""What inside a sentence is no part of the route, where its rest is: parts in brackets, quotes and
between commas, clauses, runs of words. What the rest depends on, or what announces it, does not go
alone.
"""

from __future__ import annotations

import re

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.foreign.judgement import (
    SURE,
    Judged,
    asked,
    leads,
    logit,
    probability,
    strangeness,
)
from mitigate.guards.text.plain.plainly_said import Tagged, Tags
from mitigate.guards.text.texts.decode import plainly
from mitigate.guards.text.texts.evidence import features, in_another_language
from mitigate.guards.text.texts.honest import belongs_inside
from mitigate.guards.text.texts.lexicon import GROUPS
from mitigate.guards.text.texts.pieces import Piece, parts
from mitigate.guards.text.texts.text import words
from mitigate.guards.text.texts.weights import PART
from mitigate.guards.text.texts.written import TITLE, quoted, with_bearer, written

PART_SURE = 0.85  # of a part of a sentence
# a run of words inside a sentence that goes: probability, words, the same of the sentence's others
SPAN_SURE, SPAN_WORDS, SPAN_REST = 0.95, 4, 0.1
# with these a part begins on which the rest of its sentence depends
CONDITIONS = bag("if unless when whenever once should whoever whichever wherever instead rather as")
_MACHINE = r"(?:ai|agent|assistant|robot|bot|model|machine|system|program(?:me)?|language model)"
_TEXT = r"(?:route|instructions?|directions|text|orders?|plan|steps|commands?)"
_OF_THE_TEXT = re.compile(  # what holds for whoever reads it, and what stands for the route
    r"(?:if|when|whenever|once|as soon as) (?:you|any(?:one|body)|whoever) (?:can |are |is )?"
    r"(?:read|reading|pars|process|hear|see)\w* (?:this|these)\W*$"
    rf"|as an? (?:\w+ )?{_MACHINE}\b|should you be an? (?:\w+ )?{_MACHINE}\b"
    rf"|should (?:the|this|these) (?:above|below|following|{_TEXT})\b"
    r"|(?:instead of|rather than) (?:obey|comply|(?:all|any) (?:of )?(?:this|that|these|it)\b)"
    r"|(?:instead of|rather than) (?:(?:following|doing|obeying) )?(?:(?:the|this|these|all) )*"
    rf"(?:(?:following|above|below|given|previous|original|entire|whole) )*{_TEXT}"
    r"(?: (?:below|above|given|here|that follows?))?\W*$",
    re.IGNORECASE,
)
# words of a lead-in that announces other orders than the route's, and of a bare heading of them
_NEW = GROUPS["authority"] | GROUPS["annul"] | bag("new updated update revised changed corrected")
_HEADING = _NEW | GROUPS["machine"] | GROUPS["orders"] | bag("message goal target of the")
_OTHERS = GROUPS["authority"] | bag("new updated revised system admin override root sudo")
_LEAD_IN = re.compile(r"([^:.!?\n]{1,60}):\s")
HEADING = 4  # words (ours)
_INSTEAD = re.compile(  # what stands behind words about the text, in its place
    r"\W*(?:and |but |so )?(?:the|your) (?:true|real|actual|correct|proper|right|new) "
    r"(?:directions?|routes?|way|path|goal|target|destination|instructions?|orders?|plan) "
    r"(?:is|are|was|lies)\b",
    re.IGNORECASE,
)
_SEMICOLON = re.compile(r";\s+")


def foreign_parts(text: str, one: Judged, tags: Tags | None = None) -> list[Piece]:
    """Return the parts inside a sentence that are no part of the route, in order."""
    found = [] if tags is None else attacked_spans(one.piece, tags.tag(text))
    read = {place for span in found for place in range(span.start, span.end)}
    for part in parts(text, one.piece):
        if part.start in read:
            continue
        said = part.of(text)
        title = quoted(said) and len(words(said)) <= TITLE
        long = len(words(said)) > 2 or plainly(said).marks or in_another_language(said)
        if long and not title:
            values = {"whole": logit(one.own), **features(said)}
            if in_another_language(said) or probability(PART, values) >= PART_SURE:
                found.append(part)
    stands = written(text)
    gone = [  # "go back the other way" is no attack
        Piece(with_bearer(text, p.start, p.end), p.end, p.block)
        for p in found
        if not any(first <= p.start and p.end <= last for first, last in stands)
        and not belongs_inside(p.of(text))
        and not (leads(p.of(text)) and gate.route_facts(p.of(text)) and not quoted(p.of(text)))
    ]
    return sorted(gone, key=lambda part: part.start)


def attacked_spans(piece: Piece, tagged: Tagged) -> list[Piece]:
    """Return the runs of words inside a piece that are surely an attack by what the network reads,
    where the others surely are not."""
    places = [i for i, t in enumerate(tagged.tokens) if piece.start <= t.start < piece.end]
    runs: list[list[int]] = []
    for i in places if tagged.attack else ():
        if tagged.attack[i] < SPAN_SURE:
            continue
        if runs and i == runs[-1][-1] + 1:
            runs[-1].append(i)
        else:
            runs.append([i])
    words_of = [[i for i in run if tagged.tokens[i].is_word] for run in (places, *runs)]
    every, runs = words_of[0], [r for r, w in zip(runs, words_of[1:], strict=True)
        if len(w) >= SPAN_WORDS]  # fmt: skip
    gone = {i for run in runs for i in run}
    rest = [tagged.attack[i] for i in every if i not in gone]
    if not runs or not rest or sum(rest) > SPAN_REST * len(rest):
        return []
    return [
        Piece(tagged.tokens[run[0]].start, tagged.tokens[run[-1]].end, piece.block) for run in runs
    ]


def route_remains(text: str, one: Judged, inside: list[Piece]) -> bool:
    """Return whether a sentence without these parts still tells the way, and begins with it."""
    ends = [one.piece.start, *(part.end for part in inside)]
    starts = [*(part.start for part in inside), one.piece.end]
    left = " ".join(text[a:b].strip() for a, b in zip(ends, starts, strict=True)).strip(" ,;:-–—")
    begins = inside[0].start > one.piece.start or left[:1].isupper() or len(inside) == 1
    return begins and bool(gate.route_facts(left)) and strangeness(left) < SURE


def _condition(part: str) -> bool:
    return any(word in CONDITIONS for word in words(part)[:1])


def leans(text: str, one: Judged, part: Piece) -> bool:
    """Return whether the rest of a sentence depends on a part of it ("If nobody answers, ...")."""
    behind = text[part.end : one.piece.end]
    return _condition(part.of(text)) and any(c.isalnum() for c in behind)


def announces(text: str, one: Judged, inside: list[Piece]) -> bool:
    """Return whether a sentence begins with what is foreign and announces the rest ("New orders:
    ..."), which then is no part of the route, whatever it tells."""
    lead_in = _LEAD_IN.match(one.text)
    if lead_in and heads(lead_in[1]):
        return True
    if not inside or any(c.isalnum() for c in text[one.piece.start : inside[0].start]):
        return False
    first = inside[0].of(text)
    news = any(word in _NEW for word in words(first))
    instead = _INSTEAD.match(text, inside[0].end, one.piece.end)
    return (news and first.rstrip().endswith(":")) or bool(_OF_THE_TEXT.match(first) or instead)


def heads(sentence: str) -> bool:
    """Return whether a sentence is but a heading of foreign orders ("# SYSTEM", "New goal:")."""
    said = words(sentence)
    known = all(word in _HEADING for word in said) and any(word in _OTHERS for word in said)
    return 0 < len(said) <= HEADING and known and not sentence.rstrip().endswith((".", "!", "?"))


def foreign_clauses(text: str, one: Judged, others: bool) -> list[Piece]:
    """Return the clauses of a sentence, parted by semicolons, that are no part of the route, if the
    rest tells the way; none where the first says who speaks: the rest is what it is for
    (``others``: other sentences tell the way)."""
    starts = [one.piece.start, *(one.piece.start + m.end() for m in _SEMICOLON.finditer(one.text))]
    ends = [*starts[1:], one.piece.end]
    made = [Piece(a, b, one.piece.block) for a, b in zip(starts, ends, strict=True)]
    foreign = [asked(piece.of(text).strip(" ;"), False) >= SURE for piece in made]
    speaks = any(word in GROUPS["authority"] for word in words(made[0].of(text)))
    if others and foreign[0] and speaks:
        return []
    rest = [piece for piece, bad in zip(made, foreign, strict=True) if not bad]
    told = all(gate.route_facts(piece.of(text)) for piece in rest)
    return [piece for piece, bad in zip(made, foreign, strict=True) if bad] if rest and told else []
