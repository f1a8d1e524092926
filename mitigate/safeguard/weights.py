"""Weights of the rules, written by ``python -m mitigate.safeguard.fit``."""

from __future__ import annotations

BIAS = -2.363
WEIGHTS: dict[str, float] = {
    "universal": 2.251,
    "text": 2.404,
    "person": 0.310,
    "modal": 0.677,
    "negation": 0.226,
    "unknown": 3.693,
    "late_verb": 0.666,
    "no_verb": 0.289,
    "landmarks": -0.073,
    "no_landmark": 0.485,
    "directions": -1.376,
    "commas": 0.043,
}
STYLE = frozenset(
    """
    advisable appreciated ask below betake breather briefing bunch but closing colleague commence
    complete completion conclude conclusion cooperation course cruise day dear depart direction
    do easy effect egress esteemed execute explain finally finish following follows for friend
    fully fun goes good got greetings guess guidance happy have hello help here hey hi hm i i'm
    if initially juncture kind kindly let let's like madam may me mosey navigation need new nice
    okay or outset patiently perform permission please pop procedure reorient requested reverse
    route scoot sincere sir stroll subsequently task thanks that's thereafter think this transit
    transition try ultimately um upon vacate wander want what withdraw would you'll you've
    yourself
    """.split()
)
