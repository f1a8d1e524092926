"""What a word is in plain words, and the phrases that an edit may put before one."""

from __future__ import annotations

from functools import lru_cache

# word of plain routes -> others for the same thing, way or motion: general English, written by hand
_SAME = {
    "couch": "sofa settee loveseat divan chesterfield",
    "couches": "sofas settees",
    "hallway": "corridor hall passage passageway",
    "hallways": "corridors halls passages passageways",
    "stairs": "staircase stairway steps",
    "elevator": "lift",
    "elevators": "lifts",
    "refrigerator": "fridge icebox",
    "refrigerators": "fridges",
    "television": "tv telly tele",
    "televisions": "tvs tellies",
    "bedroom": "bedchamber",
    "bathroom": "lavatory loo washroom restroom bog",
    "bathtub": "tub bath",
    "archway": "arch",
    "archways": "arches",
    "railing": "balustrade banister bannister",
    "stove": "cooker range hob",
    "closet": "wardrobe",
    "closets": "wardrobes",
    "painting": "artwork",
    "porch": "veranda verandah",
    "trash": "rubbish",
    "cart": "trolley",
    "carts": "trolleys",
    "counter": "worktop",
    "faucet": "tap",
    "entryway": "vestibule",
    "gray": "grey",
    "striped": "stripy stripey",
    "large": "big huge enormous massive giant",
    "small": "little tiny wee",
    "round": "circular",
    "narrow": "slender",
    "nearest": "closest",
    "main": "principal",
    "last": "final",
    "top": "summit uppermost",
    "bottom": "foot base",
    "back": "rear",
    "opening": "aperture",
    "room": "rm chamber",
    "meters": "metres m",
    "meter": "metre",
    "steps": "paces",
    "left": "leftward leftwards l",
    "right": "rightward rightwards r rite",
    "straight": "strait",
    "towards": "toward",
    "slightly": "slight",
    "through": "thru via",
    "under": "beneath underneath",
    "beside": "alongside",
    "between": "betwixt",
    "next": "adjacent",
    "two": "2 couple pair",
    "three": "3",
    "four": "4",
    "five": "5",
    "second": "2nd secondary",
    "first": "1st initial",
    "third": "3rd",
    "90": "ninety",
    "go": "proceed advance goes going gone went journey travel",
    "walk": "walks walking walked stroll strolls wander wanders saunter amble march trot",
    "turn": "turns turning turned pivot rotate veer",
    "stop": "stops stopping stopped halt halts halting",
    "wait": "waits waiting waited",
    "pass": "passes passing passed",
    "enter": "enters entering entered ingress",
    "exit": "exits exiting exited egress",
    "leave": "leaves leaving depart vacate departing",
    "cross": "crosses crossing traverse",
    "follow": "follows following followed",
    "take": "takes taking",
    "climb": "climbs climbing ascend ascending",
    "find": "finds finding locate",
    "face": "faces facing",
    "keep": "keeps keeping",
    "continue": "continues continuing",
    "ignore": "ignoring disregard",
    "start": "begin commence initiate",
    "reach": "reaches reaching",
    "open": "opens",
    "you": "ya u",
    "your": "ur",
    "are": "r",
    "and": "n &",
    "with": "w",
}
_FORM = {form: plain for plain, forms in _SAME.items() for form in forms.split()}
# what plain routes have and the same routes in speech lack, by how often (of the train voices): no
# thing, side, number or colour
_PHRASES = """
    . | the | go | turn | walk | stop | and | to | , | stop at | with | into | at | on | and
    stop | enter | leave | go up | through | past | and turn | and stop at the | around | at the
    | stop at the | of | to the | go down | exit | go through | find | , turn | take | pass | go
    through the | from | in | go to | down | and go | you are | enter the | walk past | go past
    | your | go around | do not | make | between | on the | wait | , go | not | and stop at |
    take the | then | up | towards | by | of the | go up the | with the | through the | in the |
    follow | and walk | leave the | cross | walk along | make a | slightly | and the | a | pass
    the | find a | straight | across | walk down | into the | go past the | on your | go down
    the | turn around | ignore | enter through | walk towards | along | go to the | stop outside
    | stop in front of | in front of | continue | past the | next to | face | walk to | , walk |
    facing | leave through | exit the | turn slightly | go around the | stop beside | cross the
    | go in | follow the | keeping | stop by | go into | and go past | go out | you are in |
    stop on | walk through | go between the | go straight | walk straight | wait at | walk to
    the | . go | . turn | . stop | . walk
    """
PHRASES = tuple(" ".join(phrase.split()) for phrase in _PHRASES.split("|"))


@lru_cache(maxsize=8192)
def plain_form(word: str) -> str:
    """Return the plain form of a word in lower case; itself if it has none."""
    return _FORM.get(word, word)
