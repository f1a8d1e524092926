"""Define words and phrases of routes in buildings: rooms, things, doors and clause templates.

All are ours. In a template, {a} is a thing and {aa} a different thing. Further fields are {room},
{door}, {stairs}, {place}, {side} (left or right) and {n} (a number). ``learning/routes.py``
composes whole instructions from them.
"""

from __future__ import annotations


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


def route_words() -> str:
    """Return all these words in one text, with template fields in braces."""
    listed = (*ASIDES, *ROOMS, *THINGS, *LOOKS, *STAIRS, *DOORS, *PLACES)
    return " ".join((OPEN, MIDDLE, CLOSE, *listed))
