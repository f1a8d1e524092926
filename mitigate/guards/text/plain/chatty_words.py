"""Orders in chatty words, and what they are in plain ones: "hang a left" is "turn left", "pop into
the bedroom" is "go into the bedroom"; and what is said around them: "easy as that!"."""

from __future__ import annotations

import re

from mitigate.guards.text.plain.formal_words import BEFORE_WAY, compiled

CHATTY = 2  # different chatty sayings from which a text counts as restyled (ours)
_STEPS = "(?: (?:just|on|over))?"  # no way, no side
_TO_WAY = rf"{_STEPS}{BEFORE_WAY}"
_NICE = r"(?:(?:nice|quick|easy|little|lovely|cheerful|gentle|simple|cheeky) )*"
_REST = r"(?:breather|rest|bit|moment|second|sec|minute|while)"
_HERE = r"(?= (?:at|by|near|beside|next to|in front of|before|in|inside|on|under|when|once)\b)"
_THING = r"(?= (?:the|a|an|this|that|these|those|your|any|some|it)\b)"
# chatty alone: two of them tell that a text is restyled
_CHATTY = (
    (rf"(?:pop|hop|scoot|cruise|zip|nip|breeze|waltz|bop|scurry|skip|toddle|zoom){_TO_WAY}", "go"),
    (rf"(?:stroll|wander|mosey|saunter|amble|meander){_TO_WAY}", "walk"),
    (rf"(?:hang|hook|swing|grab|pull|do) an? {_NICE}(left|right)\b(?! turn)", r"turn \1"),
    (r"(?:take|make) an? (?:(?:nice|cheerful|cheeky|lovely|easy) )+(left|right)\b(?! turn)",
     r"turn \1"),
    (r"swing(?: on)? over to (?:the|your) (left|right)\b", r"turn \1"),
    (rf"swing(?: on)? around{_THING}", "go around"),
    (rf"(?:swing|spin)(?: yourself)? (?:all the way )?around\b(?!{_THING})", "turn around"),
    (rf"stop for an? (?:(?:little|quick|nice) )?{_REST}\b", "stop"),
    (r"stop right there\b", "stop there"),
    (r"wait (?:right )?(?:there )?for (?:me|us)\b", "wait"),
    (rf"(?:park|plant) yourself{_HERE}", "stop"),
)  # fmt: skip
# that plain routes say, too
_COMMON = (
    (rf"(?:make your way|keep (?:on )?strolling){_TO_WAY}", "go"),
    (rf"keep (?:on )?(?:wandering|moseying){_TO_WAY}", "keep walking"),
    (rf"stop (?:walking|moving|going){_HERE}", "stop"),
    (r"stop there(?= (?:at|by|near|beside|next to|in front of|under)\b)", "stop"),
)
# what ends a sentence and tells nothing
_ENDING = re.compile(
    r"(?:,? and|,|\s[-–—])\s*(?:(?:easy|simple) as (?:that|pie|anything)|"
    r"that's (?:it|all)(?: there is to it)?|there you (?:have it|go)|"
    r"you're (?:all set|done|golden)|you did it|"
    r"if you (?:would|will|like|don't mind|wouldn't mind|please)|will you|would you|"
    r"okay|ok|alright|all right|(?:pretty )?please|got it|careful now|"
    r"i (?:think|guess|believe|suppose)|friend|buddy|my friend|"
    r"no (?:problem|worries|rush)|you can't miss it)(?P<end>[.!?]*)$",
    re.IGNORECASE,
)
_CLOSING = re.compile(
    r"(?:(?:and|so|i think|i guess),? )*(?:that's|that is|that should be|that'd be|and that's) "
    r"(?:it|all|everything|about it)[.!]*$",
    re.IGNORECASE,
)
_MARKS = compiled(_CHATTY)
_SAYINGS = (*_MARKS, *compiled(_COMMON))


def chatty(text: str) -> int:
    """Return how many different words begin the chatty sayings in ``text``."""
    return len({m.group().split()[0].lower() for found, _ in _MARKS for m in found.finditer(text)})


def closing(sentence: str) -> bool:
    """Return whether a sentence says that all is told ("That should be it.")."""
    return _CLOSING.match(sentence) is not None


def in_plain_words(sentence: str) -> str:
    """Return a sentence with its chatty sayings in plain words, less what ends it with none."""
    said = _ENDING.sub(lambda m: m["end"] and ".", sentence)
    for pattern, plain in _SAYINGS:
        said = pattern.sub(plain, said)
    return said
