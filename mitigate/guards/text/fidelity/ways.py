"""Ways of going by a thing (towards, past, around ...), and which of them exclude each other."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

_RELATIONS = {
    "towards": "towards toward to onto", "away": "away", "near": "beside by near at with",
    "far": "distant", "into": "into inside enter in", "out": "out outside exit leave from",
    "through": "through", "past": "past", "around": "around round", "between": "between",
    "before": "before", "after": "after", "across": "across over", "under": "under beneath",
    "behind": "behind", "along": "along",
}  # fmt: skip
RELATION = {word: name for name, words in _RELATIONS.items() for word in words.split()}
OPPOSED = frozenset(
    frozenset(pair.split())
    for pair in [
        "towards away",
        "near far",
        "towards far",
        "into out",
        "through past",
        "through around",
        "past into",
        "between near",
        "before after",
        "across around",
        "through along",
        "past towards",
        "between along",
        "near away",
        "between far",
        "past out",
        "through before",
        "into before",
        "between past",
        "into around",
        "between around",
        "across past",
        "out past",
        "between through",
        "near between",
    ]
)
# words of two senses: a text that has the one sense alone may not become one that has the other
SENSES = tuple(
    (bag(one), bag(other))
    for one, other in (
        (
            "towards toward approach approaching nearer closer",
            "away off distance retreat recede back",
        ),
        (
            "slightly slight gentle gently little bit half shallow soft softly mild touch barely",
            "sharply sharp hard steep steeply tight abrupt abruptly full fully acute hairpin",
        ),
        (
            "beside by near at close nearest closest reach",
            "distant far away farthest furthest apart distance remote clear nowhere",
        ),
        ("before until short", "after beyond past behind once already following"),
        ("after beyond once already following", "before until short"),
        ("through", "around past along by skirt skirting outside"),
        ("between middle", "beside along by side outside alongside past"),
        ("around skirt", "through across over straight inside"),
        ("past by pass beyond", "into enter inside entering"),
        ("into enter inside entering", "past by beyond out outside leave"),
        ("out outside leave", "into enter inside entering"),
    )
)
AGREE = frozenset(
    frozenset(pair.split())
    for pair in [
        "towards near",
        "towards before",
        "near before",
        "into through",
        "into towards",
        "through out",
        "across through",
        "near along",
        "past along",
        "past near",
        "across past",
        "along through",
        "towards through",
        "out away",
        "under near",
        "under through",
        "across towards",
        "towards along",
        "into near",
        "out through",
        "across over",
        "behind near",
        "past after",
        "near after",
        "towards past",
        "around past",
        "along into",
        "before past",
        "under past",
        "across into",
        "out towards",
        "out into",
        "across out",
        "between through",
        "out near",
        "through near",
        "towards under",
        "after into",
        "after through",
        "after towards",
    ]
)
OPPOSITES = (("large", "small"), ("long", "short"), ("open", "closed"), ("dark", "pale"),
    ("top", "bottom"), ("near", "far"), ("inside", "outside"))  # fmt: skip
