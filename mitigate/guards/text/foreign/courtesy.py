"""Sentences at the ends of a text that greet, thank or say that a route follows, and tell nothing
of the way: "Hello there, dear friend!", "Please execute the route below."

Each word of such a sentence is known to tell nothing, unless the speaker tells of themself. What
asks for a step, in however polite words, is none: "Please get off."
"""

from __future__ import annotations

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.fidelity.goal_words import GREETINGS, POLITE, TALK
from mitigate.guards.text.plain.manners import asks_for_step
from mitigate.guards.text.texts.evidence import VERBS, tells_where
from mitigate.guards.text.texts.honest import shows_place
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.text import words
from mitigate.guards.text.texts.weights import STYLE

_SPEAKER = bag("i i'm i've i'd i'll we we're we've we'd we'll my")
# what is said of a text that tells a route, and small words
_BRIEFING = bag(
    """
    task tasks route navigation guidance procedure instruction instructions directions execute
    execution follows following below again to that always never here
    """
)
_TELL_NOTHING = FUNCTION | STYLE | GREETINGS | POLITE | TALK | _BRIEFING


def framing(sentence: str) -> bool:
    """Return whether a sentence greets or thanks and tells nothing about the way."""
    found = words(sentence)
    told = gate.route_facts(sentence) or any(w in VERBS for w in found) or tells_where(sentence)
    if told or shows_place(sentence) or asks_for_step(sentence):
        return False
    known = found[:1] and found[0] in _SPEAKER or all(word in _TELL_NOTHING for word in found)
    return bool(known) and any(word in STYLE for word in found)
