"""Ways to say the same in an instruction, so that two texts can be compared word by word."""

from __future__ import annotations

import re

from mitigate.corruptions.language.landmarks import PHRASES

# pattern, read from a word's beginning -> what stands for it; in this order
_EQUAL = tuple(
    (re.compile(rf"\b(?:{pattern})", re.IGNORECASE), said)
    for pattern, said in (
        (r"in front of", "before"),
        (
            r"leaving (the [\w ]{3,20}?) to one side|(?:until|till) (the [\w ]{3,20}?) is "
            r"behind you",
            r"past \1\2",
        ),
        (r"(?:have )?left (the [\w ]{3,20}?) behind", r"out of \1"),
        (r"indoors", "inside"),
        (r"com(?:e|es|ing) (?:across|upon)\b|(?:run|runs|bump|bumps) into\b", "reach"),
        (r"outdoors", "outside"),
        (r"(?:i am|i'm) looking for|look(?:ing)? for|locate\b|search for|hunt for", "find"),
        (
            r"(?:turn|turning|keep|have|face|facing|with) (?:your )?back (?:to|on|"
            r"towards?)\b",
            "away from",
        ),
        (
            r"your back (?:to|on)\b|(?:off|far away|clear|a (?:long|good) way(?: off)?) "
            r"from\b|back away from|facing away from|face away from|turn to face away from|"
            r"step away from",
            "away from",
        ),
        (r"turn (?:around )?(?:so that|until) (?=the [\w ]{3,20} is behind you)", "with "),
        (
            r"in the direction of|head(?:ing)? (?:for|to)\b|make for|making for|aim for|on "
            r"toward|(?:turn to )?fac(?:e|ing)(?= the| a)",
            "towards",
        ),
        (
            r"(?:a )?(?:slight(?:ly)?|gentl[ey]|half|little|bit|tiny bit|smidge)(?: "
            r"turn)?(?: to (?:the|your))? (?=left|right)",
            "slightly ",
        ),
        (
            r"(left|right) (?:just )?(?:a |slightly )?(?:little|bit|slightly|touch)\b",
            r"slightly \1",
        ),
        (
            r"(?:a )?(?:sharp(?:ly)?|hard|steep(?:ly)?|tight|abrupt(?:ly)?)(?: turn)?(?: to "
            r"(?:the|your))? (?=left|right)",
            "sharply ",
        ),
        (r"hard to the (?=left|right)", "sharply "),
        (r"(?:a )?(?:bit|little)(?: way)?\b", ""),
        (r"ninety degrees|90 ?(?:degrees|°)|a quarter turn", ""),
        (
            r"come(?:s)? to (?:a |rest )?(?:stop|halt|standstill|rest)?|you(?:'re| are| "
            r"will be) (?:done|there|finished)(?: once| when| as soon as)?|you (?:will "
            r")?have arrived(?: once| when)?|take a seat|stay(?: there)?(?! (?:on|to) the "
            r"(?:left|right)| left| right)|stand(?= (?:by|at|in|on|near|next|beside|between|"
            r"close|there|under|a long|far|behind))|end(?:s)? (?=at|by|in)|remain\b|"
            r"halt(?:s|ing)?|do your waiting|hold\b|your stop is|that's your stop",
            "stop",
        ),
        (
            r"(?:the place to|place where you) (?:wait|stop|halt)|where you (?:wait|stop|"
            r"halt)",
            "stop",
        ),
        (r"without stopping", "not stop"),
        (
            r"without (?:going|stepping|getting) (?:in|through|inside)|without enter(?:ing)?",
            "not enter",
        ),
        (r"without\b", "not"),
        (r"(?:ignore|skip|disregard|overlook|pay no attention to|leave out)\b", "past"),
        (r"a couple of|a pair of|both(?: sets of)?", "two"),
        (r"first (?=two|three|four)", ""),
        (r"prior to|ahead of|just short of|short of", "before"),
        (
            r"(?:once|when|as soon as|after) you(?:'ve| have|'re| are)? (?:just "
            r")?(?:pass(?:ed)?|gone past|crossed|left|past|been through|come through|gone "
            r"through)",
            "after",
        ),
        (r"(?:once|when)(?= (?:the|past|through)\b)", "after"),
        (r"(?:passing|pass|passes) (?=through|between|under|beside|over|in front)", "go "),
        (
            r"(?:go|going|goes|walk|walking|keep|stroll|move)(?: on)? by(?= the| a| two| "
            r"three)|pass(?:ing|es)?\b",
            "past",
        ),
        (r"by way of|via|using|use\b|by means of", "through"),
        (
            r"(?:along|at) the (?:side|outside|edge) of|alongside|by the side of|to the "
            r"side of|keep to the side of|next to|close to|within (?:arm's )?reach of|"
            r"adjacent to|near enough to",
            "beside",
        ),
        (r"nearest(?: to)?|closest(?: to)?", "beside"),
        (
            r"farthest(?: from)?|furthest(?: from)?|nowhere near|many steps away from|"
            r"across the room from|a long way from|far from|away from(?= the wall)|clear of|"
            r"at a distance from",
            "distant",
        ),
        (
            r"in(?:side)? the (?:gap|space) between|through the (?:gap|space) between|"
            r"(?:through|down) the middle of",
            "between",
        ),
        (r"(?:circle|circling|rounding|round) (?:around )?(?=the|a |two|it)", "around "),
        (r"(?:left|right) round\b", "left around"),
        (r"(?:the )?(?:foot|base|lowest part) of|lowest", "bottom "),
        (r"highest", "top"),
        (
            r"(?:walk|go|step|cut|straight|cross|head)?(?:ing)? ?(?:straight )?(?:across|"
            r"over)(?= the| a)|cross(?:ing)?(?= the| a)",
            " across",
        ),
        (
            r"(?:exit|leave|leaving|go out|get out|walk out|come out|head out|out)(?= (?:by|"
            r"through|from the \w+ by)\b)",
            "out",
        ),
        (r"(?:get|step|come|climb) off(?: of)?", "out of"),
        (
            r"(?:exit|leave|leaving|exiting|depart(?:ing)?|vacate)(?= (?:the|a|your|this))",
            "out of",
        ),
        (
            r"(?:enter|entering|enters|inside|go in|walk in|step in|get in|come in)(?= the| "
            r"a)|in(?:to)? (?:the )?inside of|make your way in\b",
            "into",
        ),
        (r"going down|go downstairs|down the steps? of", "down"),
    )
)


def in_equal_words(text: str) -> str:
    """Return ``text`` in lower case with what says the same in the same words."""
    equal = " ".join(text.lower().replace("’", "'").split())
    for phrase, name in PHRASES.items():
        spoken = " ".join(phrase)
        if spoken in equal:
            equal = re.sub(rf"\b{re.escape(spoken)}(?=s?\b)", name.replace(" ", ""), equal)
    for pattern, said in _EQUAL:
        equal = pattern.sub(said, equal)
    return " ".join(equal.split())
