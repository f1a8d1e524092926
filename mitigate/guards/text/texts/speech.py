"""How people say more than they mean: corrections, emphasis, marks of a list, talk of themselves.

:func:`meant` takes such words out of a text before its meaning is read. It is for comparing texts,
never for giving one on: what it leaves is no good English.
"""

from __future__ import annotations

import re

_SIDES = "left|right"
# said to take back what was said last
_BACK = (
    r"(?:no,? (?:wait|sorry|not that|hang on|hold on|rather)|no|sorry|pardon(?: me)?|excuse me|"
    r"i meant?|(?:or )?rather|correction|make that|make it|scratch that|hang on|hold on|wait|oops|"
    r"whoops|that is(?: to say)?|my mistake|i tell a lie|strike that|actually)"
)
_SOUNDS = r"(?:,? (?:er|erm|um|uh|hmm|oh|ah|well|like)\b,?)"
_NUMBER = (
    r"(?:\d{1,2}(?:st|nd|rd|th)?|one|two|three|four|five|six|seven|eight|nine|ten|first(?:ly)?|"
    r"second(?:ly)?|third(?:ly)?|fourth(?:ly)?|fifth(?:ly)?|sixth(?:ly)?|last(?:ly)?|final(?:ly)?)"
)
_SELF = r"(?:i|we|he|she|they|nobody|everybody|everyone|people)"
# words before "right" where it is a side
_BEFORE_SIDE = """
    turn turning turned take taking make the your a to on go going bear veer head keep hard slight
    slightly sharp sharply gently gentle little bit immediate immediately first second third far and
    then left angle degrees 90 ninety pivot rotate swing hang
    """
_NO_TURN = "".join(f"(?<!{word} )" for word in _BEFORE_SIDE.split())
# a stop in many words
STOP = re.compile(
    r"\b(?:"
    r"(?:come|comes|coming|draw|roll|slow|bring|bringing|get)"
    r"(?: (?:yourself|all|your|its|the|motion|movement|travel))* to (?:(?:a|an|your|its|full|"
    r"complete|gentle|final) )*(?:rest|halt|standstill|stop|zero)|"
    r"(?:conclude|terminate|end|finish|complete|cease|discontinue|arrest|halt|stop)s? "
    r"(?:(?:your|the|its|all|any|forward|further) )*(?:journey|transit|movement|motion|moving|"
    r"travels?|travelling|progress|progression|walk|walking|advance|route|navigation|traversal|"
    r"locomotion|maneuver|manoeuvre)|"
    r"(?:motion|movement|travel|progress|advance|walking|journey) (?:is|should|shall|must|may|"
    r"will|can|has|have|are)(?: to)?(?: be)? (?:discontinue|cease|stop|halt|terminate|end|arrest|"
    r"conclude)(?:d|ped|ed)?|"
    r"freeze(?= (?:right|there|here|by|at|in|next|near|beside|before)\b)|"
    r"(?:hang|sit|hold) tight|stay put|stand still|stand ?by|call it a day|"
    r"(?:plant|rest) your feet|(?:park|plant|station) yourself|"
    r"(?:hang|hold) on(?= (?:right |just )?(?:there|here|by|at|in|next|near|beside|outside|inside|"
    r"under|until))|sit (?:down|still)|wait (?:up|around)(?= (?:by|at|in|near|here|there))|"
    r"hang (?:out|around)(?= (?:right |just )?(?:there|here|by|at|in|next|near|beside))|"
    r"chill(?: out)?(?= (?:there|here|by|at|in|next|right|beside|near))|"
    r"(?:tarry|loiter|linger|idle)(?= (?:there|here|by|at|in|next|beside|near|outside|under|for))|"
    r"(?:hold|maintain|assume|take up|adopt|secure|establish|acquire)(?: \w+){0,3} "
    r"(?:position|posture|station)|assume(?: \w+){0,2} (?:waiting|standby|idle) state|"
    r"await(?:ing)? further \w+|"
    r"(?:finish|wrap|pull) up(?= (?:just |right )?(?:at|by|in|on|to|near|next|beside|there|outside|"
    r"inside|under|between|before|when|where|once|as soon))|"
    r"take (?:a|your) (?:breather|break|rest)|"
    r"(?:terminate|cease)(?= (?:there|here|at|by|in|on|within|beside|near|upon|once|when|"
    r"adjacent))"
    r")\b"
)
# a side taken back, up to the one that is meant
SIDE_BACK = re.compile(
    rf"\b(?:{_SIDES})\b[,.;:!? –—-]+(?:(?:er|erm|um|uh|hmm|oh|ah|well)[,.;:!? –—-]+)*"
    rf"(?:{_BACK}[,.;:!? –—-]+)+(?:(?:it's|it is|the|a|to the|"
    rf"turn|go|on the|your) )*(?=(?:{_SIDES})\b)"
)
_REMOVED = tuple(
    (re.compile(pattern), said)
    for pattern, said in (
        (_SOUNDS, " "),
        # marks of a list: "2.", "Step 2:", "(two)", "Third and last,"
        (
            rf"(?:(?<=[.!?;:,|\n] )|^)\(?(?:(?:step|move|line|point|item|phase|leg|stage|part|task|"
            rf"number|no\.?|stop)(?: the)? )?{_NUMBER}(?: and last)?(?:[.:)|]+|,| [-–—>|]+)\s+",
            "",
        ),
        (r"\b(?:first|last) (?:of all|thing)\b|\bto (?:begin|start) with\b", " "),
        # a side taken back, a side that is not meant
        (SIDE_BACK.pattern, ""),
        (rf",? ?\b(?:and |but )?(?:not|never)(?: to| at| on| in| the| your| towards)* (?:{_SIDES})"
         r"(?:[- ]hand)?(?: one| side)?\b", " "),
        # a number taken back
        (rf"\b{_NUMBER},? (?:{_BACK},? )+(?={_NUMBER}\b)", ""),
        (STOP.pattern, "stop"),
        # "up" that leads nowhere
        (r"\bfirst up\b|(?<=\bend) up\b|(?<=\bends) up\b|(?<=\bending) up\b|\b(?:heads|hurry|cheer|"
         r"listen|wake|giv(?:e|ing)|look|sign|catch|set|pick|wind|speed|buckle) up\b", " "),
        # emphasis and agreement
        (r"\bright(?=[?])|(?:(?<=[.!?;] )|^)(?:all )?right[,.!:;]\s+(?!right|left)|, right(?=[,?])|"
         r"\b(?:all|that's|you're|be|it's all|quite) right(?=[.!?,])", " "),
        (rf"{_NO_TURN}\bright (?=(?:after|before|at|by|next|there|here|now|away|up|beside|in front|"
         r"under|behind|outside|inside|past|beyond|against|between|near|round|around|through|along|"
         r"down|over|on|to the end)\b)", ""),
        (r"\bright (?=with (?:you|me)\b|back\b)", ""),
        # what somebody left is no side
        (r"\b(?:i|he|she|they|we|who|somebody|someone|nobody|people|'ve|has|had|have|been|was|were|"
         r"is|are|gets?|being)(?:'ve|'d|'s)? left (?!side|hand|of|turn|at|and|then|into|past|"
         r"through)(?=\w)", " "),
        # what is so with others is no denial of a way
        (rf"\b{_SELF}(?:'(?:m|s|re|ve|d|ll))?(?: (?:is|are|was|were|am|do|does|did|has|have|had|"
         r"can|could|will|would|should|may|might|just|really|simply))?"
         r"(?: not|n't| never)\b(?! to\b)", " "),
        (rf"\b{_SELF} (?:isn't|aren't|wasn't|weren't|don't|doesn't|didn't|hasn't|haven't|hadn't|"
         r"can't|cannot|couldn't|won't|wouldn't|ain't)\b", " "),
        (r"\b(?:don't|do not|never) (?:you )?(?:worry|mind|ask|panic|fret|be (?:shy|nervous|scared|"
         r"afraid)|forget|know|think|care|be fooled|look at me|laugh)\b|\b(?:isn't|aren't|doesn't|"
         r"don't|won't|wasn't|can't) (?:it|that|they|you|she|he|there|we|i)\b|\bwhy don't you\b|"
         r"\bnot (?:far|long|quite|yet|only|really|sure|too|so|very|exactly|a problem|bad|much|"
         r"many|all)\b|\bnot at all\b|\bif not\b|\bno (?:more|less|fewer|farther|further|longer|"
         r"later|problem|doubt|idea|need|hurry|rush|worries|one|joke|kidding|questions?|thanks?)\b|"
         r"\bno[,.!?;:—–]|\bno (?=(?:wait|sorry|hang|hold)\b)|\bno(?=$)", " "),
    )
)  # fmt: skip


def meant(text: str) -> str:
    """Return ``text`` in lower case without what is said and not meant."""
    left = " ".join(text.lower().replace("’", "'").split())
    for pattern, said in _REMOVED:
        left = pattern.sub(said, left)
    return " ".join(left.split())
