"""Clean instructions to learn from: many manners of describing a walk through a building.

All text is ours. No sentence holds a phrase of the apartments' validation templates, so that a
safeguard trained on it meets those for the first time in evaluation.
"""

from __future__ import annotations

import re
from functools import lru_cache

import numpy as np

from mitigate.worlds.apartments.instructions import TEMPLATES


def _listed(text: str) -> tuple[str, ...]:
    return tuple(text.split(";"))


ROOMS = _listed(
    "bedroom;bathroom;kitchen;living room;dining room;hallway;office;closet;laundry room;foyer;"
    "lobby;lounge;garage;pantry;balcony;patio;den;study;library;game room;gym;spa;sauna;entryway;"
    "corridor;utility room;guest room;master bedroom;nursery;theater room;wine cellar;attic;porch;"
    "sun room;family room;mud room;conference room;reception;waiting area;bar area;breakfast nook"
)
THINGS = _listed(
    "bed;sofa;couch;table;dining table;coffee table;desk;chair;armchair;stool;bench;dresser;"
    "wardrobe;cabinet;bookshelf;bookcase;shelf;lamp;chandelier;mirror;painting;picture;plant;"
    "potted plant;fireplace;piano;tv;television;fridge;refrigerator;stove;oven;sink;counter;"
    "kitchen island;toilet;bathtub;shower;washer;towel rack;rug;carpet;window;curtain;statue;vase;"
    "clock;pool table;ottoman;nightstand;washing machine;fish tank;pillar;column;railing;archway;"
    "sculpture;trash can;water cooler;microwave;dishwasher;bar stools;set of chairs;computer;"
    "coat rack;umbrella stand;grandfather clock;treadmill;exercise bike;hot tub;grill;swing;"
    "display case;wine rack;jacuzzi;tapestry;candle holder;reception desk;vanity;glass table"
)
LOOKS = _listed(
    "red;blue;green;yellow;white;black;brown;gray;grey;purple;pink;orange;tan;wooden;glass;leather;"
    "marble;large;small;big;long;round;tall;striped;square;metal;open;wicker;stone;oval"
)
STAIRS = ("stairs", "steps", "staircase", "stairway")
DOORS = _listed(
    "door;doorway;double doors;glass door;sliding doors;french doors;wooden door;archway;"
    "open door;front door;first door;second door;next door"
)
PLACES = _listed("end of the hall;top of the {stairs};bottom of the {stairs};corner;"
    "end of the {room};"
    "other side of the room;middle of the {room};first step;landing;other end of the {room};"
    "entrance to the {room};foot of the bed;edge of the {a}")  # fmt: skip

# {a} a thing, {aa} another, {room}, {door}, {stairs}, {place}, {side} left or right, {n} a number
OPEN = (
    "walk out of the {room}|exit the {room}|leave the {room}|go out of the {room}|"
    "step out of the {room}|exit the {room} through the {door}|"
    "walk out of the {room} and into the {aroom}|with the {a} behind you, walk forward a little|"
    "turn around and leave the {room}|turn around|face the {a}|facing the {a}, turn {side}|"
    "start by walking past the {a}|walk across the {room}|cross the {room}|head out of the {room}|"
    "go out the {door}|starting at the {a}, walk to the {aa}|exit the room using the {door}|"
    "begin by facing the {a}|you are in the {room}, go to the {door}|go down the hall|"
    "get out of the {room}|walk away from the {a}|from the {a}, head to the {door}|"
    "stand with your back to the {a}|walk straight out of the {room}|"
    "leave the {room} by way of the {door}|move away from the {a} and toward the {door}"
)
MIDDLE = (
    "turn {side}|take a {side}|go {side}|turn {side} at the {a}|take a {side} at the {a}|"
    "turn {side} after the {a}|make a {side} turn|take a slight {side}|make a sharp {side}|"
    "veer {side}|bear {side}|take the {ordinal} {side}|turn to the {side}|"
    "hang a {side} past the {a}|"
    "walk past the {a}|pass the {a}|go past the {a} on the {side}|pass the {a} on your {side}|"
    "walk between the {a} and the {aa}|go around the {a}|walk around the {look} {a}|"
    "go straight past the {a} and the {aa}|go through the {door}|walk through the {door}|"
    "go through the {door} on the {side}|enter the {room}|enter the {room} on the {side}|"
    "walk into the {room}|go into the {room}|step into the {room}|walk through the {room}|"
    "go straight through the {room}|walk down the hallway|continue down the hall|"
    "go down the {stairs}|walk up the {stairs}|climb the {stairs}|descend the {stairs}|"
    "go up the {stairs} on the {side}|go up {n} {stairs}|walk straight|go straight|"
    "walk straight down the hall|keep going straight until you reach the {a}|"
    "walk until you get to the {a}|continue until you see a {look} {a}|walk towards the {a}|"
    "head towards the {door}|go toward the {look} {a}|walk along the {a}|follow the hallway|"
    "follow the {a} around to the {side}|keep the {a} to your {side}|cross the {room}|"
    "once you pass the {a}, turn {side}|when you reach the {a}, turn {side}|"
    "when you get to the {door}, go {side}|after the {a}, take a {side}|"
    "at the {place}, turn {side}|"
    "at the {a}, go {side}|go {side} at the {place}|you will see a {look} {a} on your {side}|"
    "there is a {a} on the {side}|walk by the {a} and the {aa}|pass {n} {a}s on the {side}|"
    "go {side} around the {a}|make a {side} just before the {door}|"
    "walk straight between the {a} and the {aa}|go all the way to the {place}|"
    "continue to the {place}|enter the door on the {side}|take the door on your {side}|"
    "take the {ordinal} door on the {side}|walk alongside the {a}|proceed past the {a}|"
    "proceed to the {door}|step over the threshold and into the {room}|"
    "walk a few feet to the {place}|as soon as you enter the {room}, turn {side}|"
    "walk past the {a} so that it is on your {side}|turn slightly {side} and walk to the {door}|"
    "keep walking past the {a}|go by the {look} {a}|move toward the {place}|"
    "turn {side} into the {room}|make a {side} into the {room}|cross over to the {aa}|go outside|"
    "walk inside|go back inside through the {door}"
)
CLOSE = (
    "stop at the {a}|stop in front of the {a}|stop next to the {a}|stop beside the {a}|"
    "wait by the {a}|wait at the {a}|wait near the {look} {a}|wait there|stop there|stop|"
    "stop when you get to the {a}|stop once you reach the {a}|stop just inside the {room}|"
    "stop at the {place}|wait at the {place}|stop on the {a}|stop between the {a} and the {aa}|"
    "stop in the doorway|wait in the doorway of the {room}|stop right before the {stairs}|"
    "wait just outside the {room}|stop when you are in the {room}|wait in the {room}|"
    "stop in front of the {door}|stand next to the {a}|stop to the {side} of the {a}|"
    "walk to the {a} and stop|go to the {look} {a} and wait|enter the {room} and wait|"
    "stop a couple of feet from the {a}|come to a stop behind the {a}|wait by the {a} and the {aa}|"
    "you are done once you are by the {a}|stop with the {a} on your {side}|that is where you stop|"
    "wait next to the {door}|stop facing the {a}|stop under the {a}|stop on the {n} step"
)
ASIDES = ("you should see a {look} {a} ahead of you", "the {a} will be on your {side}",
    "you are now in a {room}", "there will be a {a} in front of you",
    "on the {side} there is a {a}",
    "you will be facing a {look} {a}", "it is the {room} with the {look} {a}",
    "you are standing in front of a {a}", "you should be next to a {look} {a}")  # fmt: skip
JOINS = (". ", ". ", ". ", ", ", " and ", " then ", ", then ", " and then ", ". Then ", ", and ")
_FIELDS = {"open": OPEN.split("|"), "middle": MIDDLE.split("|"), "close": CLOSE.split("|")}


def draw_route(rng: np.random.Generator, longest: int = 7) -> str:
    """Return one instruction of at most ``longest`` clauses, a few of them verbose or careless."""
    while True:
        text = _careless(_joined(_clauses(rng, longest), rng), rng)
        if not overlaps_validation(text):
            return text


@lru_cache(maxsize=1)
def _validation() -> re.Pattern[str]:
    phrases = [p for s in ("val_seen", "val_unseen") for k, group in TEMPLATES[s].items()
        if k != "join" for p in group]  # fmt: skip
    bodies = [re.sub(r"\\\{\w+\\\}", r"(?:[a-z]+ ?){1,3}?", re.escape(p)) for p in set(phrases)]
    return re.compile(r"\b(?:" + "|".join(sorted(bodies, key=len, reverse=True)) + r")\b")


def overlaps_validation(text: str) -> bool:
    """Return whether ``text`` holds a filled phrase of the apartments' validation templates."""
    return _validation().search(re.sub(r"[^a-z]+", " ", text.lower())) is not None


def _clauses(rng: np.random.Generator, longest: int) -> list[str]:
    count = int(rng.integers(1, longest + 1))
    kinds = ["middle"] * count
    if rng.random() < 0.7:
        kinds[0] = "open"
    if count > 1 and rng.random() < 0.85:
        kinds[-1] = "close"
    verbose = rng.random() < 0.2
    found: list[str] = []
    for kind in kinds:
        found.append(_fill(_pick(_FIELDS[kind], rng), rng))
        if verbose and rng.random() < 0.4:
            found.append(_fill(_pick(ASIDES, rng), rng))
    return found


def _fill(template: str, rng: np.random.Generator) -> str:
    template = template.replace("{place}", _pick(PLACES, rng))
    thing, other = _thing(rng), _thing(rng)
    text = template.format(
        a=thing.removeprefix("set of ") if "{look} {a}" in template else thing,
        aa=other, room=_pick(ROOMS, rng), aroom=_pick(ROOMS, rng), door=_pick(DOORS, rng),
        stairs=_pick(STAIRS, rng), side=_pick(("left", "right"), rng), look=_pick(LOOKS, rng),
        n=_pick(("two", "three", "four", "five", "2", "3"), rng),
        ordinal=_pick(("first", "second", "third", "next", "last"), rng),
    )  # fmt: skip
    return re.sub(r"\ba (?=[aeiou])", "an ", text)


def _thing(rng: np.random.Generator) -> str:
    thing, look = _pick(THINGS, rng), _pick(LOOKS, rng)
    return f"{look} {thing}" if rng.random() < 0.25 and " " not in thing else thing


def _joined(clauses: list[str], rng: np.random.Generator) -> str:
    few = [_pick(JOINS, rng) for _ in range(2)]  # a writer keeps to one or two ways
    text = clauses[0]
    for clause in clauses[1:]:
        aside = clause.startswith(("you ", "the ", "there ", "on the ", "it is "))
        text += ". " + clause if aside else _pick(few, rng) + clause
    return ". ".join(part[0].upper() + part[1:] for part in text.split(". ")) + "."


def _careless(text: str, rng: np.random.Generator) -> str:
    """Leave marks of real writers: no capitals, no full stop, double spaces."""
    draw = rng.random(4)
    if draw[0] < 0.12:
        text = text.lower()
    if draw[1] < 0.12:
        text = text.rstrip(".")
    if draw[2] < 0.08:
        text = text.replace(". ", ".  ")
    return text.replace(", ", " , ") if draw[3] < 0.03 else text


def _pick(options, rng: np.random.Generator) -> str:
    return options[int(rng.integers(len(options)))]
