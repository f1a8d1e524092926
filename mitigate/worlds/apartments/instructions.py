"""Generate instructions that describe paths.

Every split has its own templates (``templates.json``). All words of the validation splits occur in
the training templates, so an agent meets new sentences but no new words in validation.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mitigate.worlds.apartments.layout import CATALOGUE, gap_to

# imported only for type checking, because this module is also used without the simulator
if TYPE_CHECKING:
    from mitigate.worlds.apartments.apartment import Apartment

_FILE = Path(__file__).with_name("templates.json")
TEMPLATES: dict[str, dict[str, list[str]]] = json.loads(_FILE.read_text(encoding="utf-8"))
# probability that a training text mentions a turn too early, before the doorway (heuristic)
SAID_BEFORE = 0.25
# maximum metres between a doorway and a turn that is described together with it (heuristic)
_BESIDE = 1.6
_NEAR_PATH = 1.3  # maximum distance in metres from the path to a mentioned landmark


@dataclass(frozen=True)
class Event:
    """An event that an instruction can mention, ``at`` metres from the start of the path."""

    at: float
    kind: str
    room: int = -1
    thing: int = -1


def name_of(apartment: Apartment, instance: int) -> str:
    """Return the name by which instructions call a piece of furniture, for example "red sofa"."""
    piece = apartment.furniture[instance]
    return f"{piece.colour} {piece.category}" if piece.colour else piece.category


def describe(
    apartment: Apartment, path: np.ndarray, heading: float, target: int, rng: np.random.Generator
) -> str:
    """Return an instruction for a path (float [n, 2], metres) to the furniture ``target``."""
    events = _events(apartment, path, heading, target, rng)
    clauses = [_clause(apartment, event, rng) for event in events]
    words = TEMPLATES[apartment.split]
    final = "stop_room" if rng.random() < 0.6 else "stop"
    room = apartment.rooms[apartment.furniture[target].room].kind
    clauses.append(_pick(words[final], rng).format(thing=name_of(apartment, target), room=room))
    return _sentence(clauses, words["join"], rng)


def find(apartment: Apartment, category: str, rng: np.random.Generator) -> str:
    """Return an object-goal instruction: "find a <category>"."""
    article = "an" if category[0] in "aeiou" else "a"
    text = _pick(TEMPLATES[apartment.split]["find"], rng).format(a=article, thing=category)
    return text[0].upper() + text[1:] + "."


def _pick(options: Sequence[str], rng: np.random.Generator) -> str:
    return options[int(rng.integers(len(options)))]


def _sentence(clauses: list[str], joins: Sequence[str], rng: np.random.Generator) -> str:
    text = clauses[0]
    for clause in clauses[1:]:
        text += _pick(joins, rng) + clause
    sentences = [part.strip() for part in text.split(". ")]
    return ". ".join(part[0].upper() + part[1:] for part in sentences if part) + "."


def _clause(apartment: Apartment, event: Event, rng: np.random.Generator) -> str:
    words = TEMPLATES[apartment.split]
    text = _pick(words[event.kind], rng)
    if event.kind in ("ahead", "left", "right", "around"):
        return text
    if event.kind in ("door", "enter"):
        rooms = apartment.rooms
        return text.format(room=rooms[event.room].kind, here=rooms[event.thing].kind)
    return text.format(thing=name_of(apartment, event.thing))


def _events(
    apartment: Apartment, path: np.ndarray, heading: float, target: int, rng: np.random.Generator
) -> list[Event]:
    """Return the turns, changes of room and up to two landmarks of a path, in order."""
    steps = np.hypot(*np.diff(path, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    events = [Event(0.0, turn_word(_direction(path, along, 0.0), heading))]
    rooms = [apartment.room_at(p) for p in path]
    changes = [i for i in range(1, len(path)) if rooms[i] != rooms[i - 1]]
    for i in changes:
        kind = "enter" if rng.random() < 0.7 else "door"
        events.append(Event(along[i], kind, rooms[i], rooms[i - 1]))
        turn = _turn_beside(path, along, along[i])
        if turn is None:
            continue
        behind = turn.at > along[i] and not (
            apartment.split == "train" and rng.random() < SAID_BEFORE
        )
        at = along[i] + 0.05 if behind else along[i] - 0.1
        events.append(Event(at, turn.kind))
    events += _landmarks(apartment, path, along, target, rng)
    return sorted(events, key=lambda event: event.at)


def _turn_beside(path: np.ndarray, along: np.ndarray, door: float) -> Event | None:
    """Return the left or right turn of a path at a doorway, ``door`` metres from its start.

    The event is located where the path has completed half of the turn. Return None if the path does
    not turn there, or if the doorway is near the start of the path.
    """
    if door <= _BESIDE:
        return None
    before, after = (_direction(path, along, at) for at in (door - _BESIDE, door))
    kind = turn_word(after, before)
    if kind not in ("left", "right"):
        return None
    half = abs(_angle(after, before)) / 2
    for at in np.arange(door - _BESIDE, door + _BESIDE, 0.1):
        if abs(_angle(_direction(path, along, at, span=0.6), before)) >= half:
            return Event(float(at) + 0.3, kind)
    return Event(door, kind)


def _direction(path: np.ndarray, along: np.ndarray, at: float, span: float = 1.2) -> float:
    """Return the heading (radians) of the path section from ``at`` to ``at + span`` metres."""
    i = int(np.searchsorted(along, max(at, 0.0)))
    j = int(np.searchsorted(along, max(at, 0.0) + span))
    i, j = min(i, len(path) - 2), min(max(j, i + 1), len(path) - 1)
    dx, dy = path[j] - path[i]
    return float(np.arctan2(-dx, dy))


def turn_word(to: float, heading: float) -> str:
    """Return a word for the turn from one heading to another, both in counter-clockwise radians."""
    angle = np.degrees(_angle(to, heading))
    if abs(angle) < 35:
        return "ahead"
    if abs(angle) > 135:
        return "around"
    return "left" if angle > 0 else "right"


def _angle(to: float, heading: float) -> float:
    """Return the angle from one heading to another, in radians in [-pi, pi)."""
    return (to - heading + np.pi) % (2 * np.pi) - np.pi


def _landmarks(
    apartment: Apartment, path: np.ndarray, along: np.ndarray, target: int, rng: np.random.Generator
) -> list[Event]:
    events = []
    for instance, piece in enumerate(apartment.furniture):
        if instance == target:
            continue
        gap = gap_to(piece.rect, path)
        i = int(gap.argmin())
        same_room = apartment.room_at(path[i]) == piece.room
        if gap[i] < _NEAR_PATH and same_room and 0.8 < along[i] < along[-1] - 1.5:
            solid = CATALOGUE[piece.category].solid
            kind = _side(path, i, piece.centre, rng) if solid else "past"
            events.append(Event(float(along[i]), kind, thing=instance))
    selected = rng.permutation(len(events))[: int(rng.integers(0, 3))]
    return [events[k] for k in selected]


def _side(path: np.ndarray, i: int, centre: tuple[float, float], rng: np.random.Generator) -> str:
    if rng.random() < 0.5:
        return "past"
    forward = path[min(i + 4, len(path) - 1)] - path[max(i - 4, 0)]
    offset = np.array(centre) - path[i]
    return "pass_left" if forward[0] * offset[1] - forward[1] * offset[0] > 0 else "pass_right"
