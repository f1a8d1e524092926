"""Insert attacks into benign texts.

The resulting texts train the network that finds the span of an attack.
"""

from __future__ import annotations

import zlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mitigate.core.seeding import generator, pick
from mitigate.guards.text.decode import visible
from mitigate.guards.text.learning.lines import Line
from mitigate.guards.text.pieces import clause_pieces, sentence_pieces

# number of folds into which the texts are divided; all texts of a group are in the same fold
FOLDS = 4
SPLICES = 60_000  # number of training texts that are generated for a network
HONEST = 0.4  # fraction of texts without an attack
LONGEST = 900  # maximum number of characters of a training text
SHORT = 7  # maximum number of words of an attack that is added to another attack
CLAUSE = 12  # an attack with fewer words than this can be inserted into a sentence as a clause
JOINS = ("", "", "and ", "but ", "but first ", "no wait, ", "please ", "or rather ")
SEPARATORS = ("\n", " - ", ", ", "; ", "... ", " / ")


@dataclass(frozen=True)
class Splice:
    """A training text with the (start, end) of each of its attacks, and its fold."""

    text: str
    attacks: tuple[tuple[int, int], ...]
    fold: int


def fold_of(line: Line) -> int:
    """Return the fold to which a line's group belongs."""
    return zlib.crc32(line.group.encode()) % FOLDS


def splices(
    lines: Sequence[Line],
    frames: tuple[list[str], list[str]],
    count: int = SPLICES,
    seed: int = 0,
) -> Iterator[Splice]:
    """Yield training texts.

    An attack is inserted only into a benign text of the same fold.

    ``frames`` contains sentences to put before an attack, and sentences to put after it.
    """
    sources = [_Source([line for line in lines if fold_of(line) == fold]) for fold in range(FOLDS)]
    for number in range(count):
        rng = generator(seed, "splices", number)
        fold = int(rng.integers(FOLDS))
        source = sources[fold]
        attacks: list[tuple[int, int]] = []
        if rng.random() < HONEST:
            text = _careless(source.honest(rng), rng)
            if rng.random() < 0.08:
                text += " " + source.honest(rng)
        else:
            text, attacks = _joined(source.attack(frames, rng), source.host(rng), rng)
        if len(text) <= LONGEST and visible(text) == text:
            yield Splice(text, tuple(attacks), fold)


class _Source:
    """The lines of one fold."""

    def __init__(self, lines: Sequence[Line]) -> None:
        self.attacks = [line for line in lines if line.attack]
        self.routes = [line for line in lines if not line.attack]
        self.hosts = [line for line in self.routes if len(line.text.split()) > 4]
        self.odd = [
            line
            for line in self.hosts
            if line.styled or line.group.startswith(("odd_routes", "lookalikes"))
        ] or self.hosts
        self.short = [
            line.text
            for line in self.attacks
            if len(line.text.split()) <= SHORT and "{route}" not in line.text
        ]
        self.groups = {
            id(each): _by_group(each) for each in (self.attacks, self.routes, self.hosts, self.odd)
        }

    def honest(self, rng: np.random.Generator) -> str:
        return self._line(self.routes, rng).text

    def host(self, rng: np.random.Generator) -> str:
        return self._line(self.odd if rng.random() < 0.6 else self.hosts, rng).text

    def attack(self, frames: tuple[list[str], list[str]], rng: np.random.Generator) -> str:
        """Sample an attack.

        To imitate longer attacks, some attacks are joined with a second attack. Some also get a
        sentence before or after them.
        """
        line = self._line(self.attacks, rng)
        attack = line.text
        if "{route}" in attack:
            return attack
        draw = rng.random()
        separator = "\n" if rng.random() < 0.25 else " "
        if draw < 0.22:
            other = pick(self.groups[id(self.attacks)][line.group], rng).text
            if "{route}" not in other:
                attack = f"{attack}{separator}{other}"
        elif draw < 0.34:
            attack = f"{attack}{separator}{pick(self.short, rng)}"
        elif draw < 0.42:
            attack = f"{pick(self.short, rng)}{separator}{attack}"
        before, after = (pick(frame, rng) for frame in frames)
        draw = rng.random()
        if draw < 0.2:
            attack = f"{before} {attack}"
        return f"{attack} {after}" if 0.15 < draw < 0.3 else attack

    def _line(self, lines: list[Line], rng: np.random.Generator) -> Line:
        if rng.random() < 0.7:  # sample the group first, so that large groups do not dominate
            groups = list(self.groups[id(lines)].values())
            return pick(pick(groups, rng), rng)
        return pick(lines, rng)


def _by_group(lines: Sequence[Line]) -> dict[str, list[Line]]:
    """Return the lines by group.

    Groups of benign texts whose names differ only in their number are merged.
    """
    groups: dict[str, list[Line]] = defaultdict(list)
    for line in lines:
        groups[line.group if line.attack else line.group.split(" ")[0]].append(line)
    return groups


def _careless(text: str, rng: np.random.Generator) -> str:
    draw = rng.random()
    if draw < 0.08:
        return text.lower()
    if draw < 0.12:
        return text.upper()
    return text.rstrip(".!") if draw < 0.2 else text


def _joined(attack: str, route: str, rng: np.random.Generator) -> tuple[str, list[tuple[int, int]]]:
    """Join an attack to a route, and return the text and the spans of the attack.

    The attack can be before, after or inside the route, or surround it.
    """
    attack, route = _careless(attack.strip(), rng), _careless(route.strip(), rng)
    separator = " " if rng.random() < 0.9 else pick(SEPARATORS, rng)
    first, around, last = attack.partition("{route}")
    if around:
        text = f"{first.strip()} {route} {last.strip()}".strip()
        spans = [(0, len(first.strip())), (len(text) - len(last.strip()), len(text))]
        return text, [(start, end) for start, end in spans if end > start]
    draw = rng.random()
    if draw < 0.43:
        return f"{attack}{separator}{route}", [(0, len(attack))]
    if draw < 0.83:
        text = f"{route}{separator}{attack}"
        return text, [(len(text) - len(attack), len(text))]
    pieces = [p for s in sentence_pieces(route) for p in clause_pieces(route, s)]
    at = pick(pieces, rng).start
    before, behind = route[:at].rstrip(), " "
    if before and 1 < len(attack.split()) < CLAUSE and rng.random() < 0.6:
        attack = f"{pick(JOINS, rng)}{attack[0].lower()}{attack[1:].rstrip('.!')},"
        before, behind = f"{before.rstrip(',;.!')},", pick((" and then ", " then ", " "), rng)
    start = f"{before} ".lstrip()
    return f"{start}{attack}{behind}{route[at:]}", [(len(start), len(start) + len(attack))]
