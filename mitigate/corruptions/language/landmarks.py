"""Landmarks: which nouns name something to see, and their synonyms."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

# canonical name -> other names; a phrase of several words is joined before nouns are read
SYNONYMS: dict[str, tuple[str, ...]] = {
    "sofa": ("couch", "settee", "loveseat", "love seat", "sofas", "couches"),
    "hall": ("hallway", "corridor", "hall way", "passageway", "passage", "passage way"),
    "stairs": ("stair", "staircase", "stairway", "stairwell", "steps", "step", "stair case"),
    "door": ("doorway", "doorways", "doors", "door way"),
    "entrance": ("entry", "entryway", "entranceway", "entry way", "entrance way"),
    "fridge": ("refrigerator", "refridgerator", "icebox"),
    "tv": ("television", "televisions", "tv set", "television set", "flat screen"),
    "picture": ("painting", "artwork", "photo", "photograph", "portrait", "image", "print"),
    "living room": ("livingroom", "sitting room", "family room", "lounge", "lounge room"),
    "dining room": ("diningroom", "dining area", "dinning room", "dinning area"),
    "bathroom": ("washroom", "restroom", "lavatory", "bath room", "powder room"),
    "bedroom": ("bed room", "bed chamber", "bedchamber"),
    "office": ("study", "workroom"),
    "closet": ("wardrobe", "armoire"),
    "cabinet": ("cupboard",),
    "nightstand": ("bedside table", "night stand", "night table"),
    "rug": ("carpet", "mat"),
    "counter": ("countertop", "counter top"),
    "bathtub": ("tub", "bath tub", "bath"),
    "railing": ("banister", "bannister", "rail", "handrail", "hand rail", "balustrade"),
    "archway": ("arch",),
    "plant": ("houseplant", "potted plant", "house plant"),
    "stove": ("oven", "cooker", "range"),
    "washer": ("washing machine", "laundry machine"),
    "toilet": ("commode",),
    "lamp": ("lantern",),
    "bookshelf": ("bookcase", "book shelf", "book case", "bookshelves"),
    "shelf": ("shelving", "shelves", "shelve"),
    "garbage": ("trash", "rubbish"),
    "bin": ("can", "trashcan"),
    "window": ("windows",),
    "dresser": ("chest of drawers",),
    "mirror": ("looking glass",),
    "building": ("structure",),
    "house": ("home", "residence"),
    "elevator": ("lift",),
    "armchair": ("easy chair",),
    "statue": ("sculpture",),
    "wall": ("walls",),
    "vase": ("urn",),
    "balcony": ("terrace",),
    "couch chair": (),
    "coffee table": (),
    "ping pong": ("table tennis",),
}
# nouns that name no landmark: parts of the way, of speech, of politeness
PLAIN = bag(
    """
    way side direction front time moment end middle center centre left right hand distance
    point area place space position spot part portion piece set pair row couple number bit
    kind type sort lot foot feet meter meters metre metres yard yards inch inches pace paces
    degree degrees minute minutes second seconds turn walk stop exit path route course
    journey trip task instruction instructions step-by-step destination goal target thing
    one something anything everything line length edge view sight reach directions bearing
    heading angle look back rest move pass face head climb start beginning work wait favour
    favor friend buddy pal sir madam thanks thank welcome luck guess sense idea matter case
    order regard attention care fact least first then while location arrival completion
    entirety manner traversal passing proximity vicinity immediacy left-hand right-hand
    quarter half inside outside outer opposite following far near next other others same
    slight straight forward ahead around through past double single day job mind problem
    question word rush hurry step-through please folks mate guys hey hi hello there ok okay
    sure rotation maneuver manoeuvre orientation motion movement progress travel approach
    procedure directive bunch help fun guidance navigation permission outset juncture
    breather ascent descent leave colleague greetings cooperation gratitude kindness
    pleasure request briefing conclusion sequence plan adventure explanation everyone today
    morning requirement transit interior exterior nd rd th st
    """
)

CANONICAL = {form: name for name, forms in SYNONYMS.items() for form in forms if " " not in form}
PHRASES = {
    tuple(form.split()): name
    for name, forms in SYNONYMS.items()
    for form in (name, *forms)
    if " " in form
}
LONGEST = max(map(len, PHRASES))
_KEEP_S = ("ss", "us", "is", "as", "os")


def normal(noun: str) -> str:
    """Return the canonical name of a noun: lower case, singular, first of its synonyms."""
    word = noun.lower().removesuffix("'s").removesuffix("s'")
    if word in CANONICAL or word in SYNONYMS:
        return CANONICAL.get(word, word)
    single = _singular(word)
    return CANONICAL.get(single, single)


def _singular(word: str) -> str:
    if len(word) < 4 or not word.endswith("s") or word.endswith(_KEEP_S):
        return word
    if word.endswith("ies"):
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "sses", "xes", "zes")):
        return word[:-2]
    if word.endswith("lves"):
        return word[:-3] + "f"
    return word[:-1]
