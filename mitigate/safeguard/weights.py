"""Weights of the rules, written by ``python -m mitigate.safeguard.fit --write``."""

from __future__ import annotations

from mitigate.corruptions.language.words import bag

BIAS = -2.845
WEIGHTS: dict[str, float] = {
    "universal": 2.891,
    "text": 1.940,
    "person": 0.072,
    "modal": 0.505,
    "negation": 0.289,
    "style": -0.226,
    "unknown": 3.642,
    "late_verb": 0.358,
    "no_verb": 0.379,
    "landmarks": 0.298,
    "no_landmark": 1.407,
    "directions": -1.021,
    "commas": -0.094,
}
STYLE = bag(
    """
    advisable appreciated ask betake breather briefing bunch closing colleague commence complete
    completion conclude conclusion cooperation course cruise day dear depart direction do easy
    effect egress esteemed execute explain finally finish for friend fully fun goes good got
    greetings guess happy have hello help hey hi hiya hm i'm initially juncture kind kindly let
    let's like lovely madam meet mosey navigation need new nice off okay or outset perform
    permission please procedure requested reverse scoot sincere strolling subsequently thanks
    that's thereafter think this transit transition try u ultimately um upon vacate want what
    withdraw you'll you've
    """
)
