"""Verbs and prepositions in formal words, and what they are in plain ones: "execute a left turn" is
"turn left", "ascend the stairs" is "go up the stairs"."""

from __future__ import annotations

import re
from collections.abc import Sequence

FORMAL = 2  # different formal sayings from which a text counts as restyled (ours)
_ENDS = r"(?= ?(?:[.,;:!?]|$)| (?:and|then|at|before|after|when|once|into|through|past|as|until)\b)"
# in front of a way: "proceed" {past}
BEFORE_WAY = (
    r"(?= (?:to|towards?|into|in|past|through|along|down|up|across|around|round|out|over|onto|"
    r"beyond|between|straight|forwards?|ahead|inside|outside|beneath|under|via|by)\b)"
)
_ADVERBS = {"slight": "slightly ", "sharp": "sharply ", "hard": "sharply ", "": "",
    "90-degree": "90 degrees ", "90 degree": "90 degrees "}  # fmt: skip
_TURN = re.compile(
    r"\b(?P<verb>make|effect|execute|perform|complete|undertake|take) an? "
    r"(?:(?P<how>slight|sharp|hard|90[- ]degree) )?"
    r"(?P<side>left|right)(?:-hand)? turn\b",
    re.IGNORECASE,
)
_TO_SIDE = r"(?:to|towards?) (?:the|your) (left|right)"
_PLACE = (
    r"(?= (?:at|by|near|beside|next to|adjacent to|in front of|before|in|inside|on|under|when|"
    r"once)\b)"
)
_ROUTE = (
    r"(?:(?:all|your|the|any) )?(?:movement|motion|navigation|route|journey|progress|transit|walk)"
)
_USE_STAIRS = (
    r"(?:utilize|utilise|employ|use) (the|those|these) (stairs|staircase|stairway|steps|elevator|"
    r"lift)"
)
_VERBS_ING = {
    "ascending": "going up", "descending": "going down", "proceeding": "going",
    "advancing": "going", "bypassing": "passing", "traversing": "going through",
    "maintaining": "keeping",
}  # fmt: skip
_DONE = {
    "ascending": "go up", "descending": "go down", "proceeding": "go", "advancing": "go",
    "moving": "move", "walking": "walk", "turning": "turn", "exiting": "exit", "leaving": "leave",
    "entering": "enter", "passing": "pass", "going": "go", "facing": "face", "departing": "leave",
}  # fmt: skip
# formal alone: two of them tell that a text is restyled
_FORMAL = (
    (rf"(?:effect|execute|perform) a turn {_TO_SIDE}\b", r"turn \1"),
    (r"(?:betake yourself|convey yourself|direct yourself|advance|navigate|transition|journey)"
     rf"{BEFORE_WAY}", "go"),
    (r"(?:egress|depart) (?:through|via|by)\b", "go out through"),
    (r"egress from\b", "go out of"),
    (r"(?:egress|depart(?: from)?|vacate)(?= (?:the|this|your|that)\b)", "leave"),
    (r"traverse(?= (?:the|this|that)\b(?! (?:\w+ )?(?:stairs?|staircase|steps)\b))", "go through"),
    (r"circumnavigate(?= (?:the|this|that)\b)", "go around"),
    (rf"{_USE_STAIRS} to (?:ascend|go up)\b", r"go up \1 \2"),
    (rf"{_USE_STAIRS} to (?:descend|go down)\b", r"go down \1 \2"),
    (r"ascend(?= (?:the|this|that|those|a|one|two)\b)", "go up"),
    (r"maintain (?:a|your) (?:course|heading) (?=straight|ahead|forward)", "go "),
    (r"maintaining (?=(?:it|the [\w ]+?) (?:on|to) your)", "keeping "),
    (rf"(?:cease|terminate|conclude|discontinue|end) {_ROUTE}(?: and (?:halt|stop))?\b", "stop"),
    (rf"(?:conclude|terminate){_PLACE}", "stop"),
    (r"(?:finalize|finalise|hold|maintain|assume|take up) (?:your |a )?position"
     rf"{_PLACE}", "stop"),
    (rf"position yourself{_PLACE}", "stop"),
    (r"(?:the|your) (?:end ?point|final (?:location|position|destination)) is(?= (?:the|a|an|at|"
     r"beside|by|near|next to|in front of)\b)(?: at\b)?", "stop at"),
    (r"(?:the|your) route (?:concludes|ends|terminates|finishes)(?= (?:at|by|near|beside)\b)",
     "stop"),
    (r"halt\b(?! (?:sign|line))", "stop"),
    (r"prior to(?= (?:the|a|an|reaching|entering|passing|that|it)\b)", "before"),
    (r"adjacent to\b", "next to"),
    (rf"proceed{BEFORE_WAY}", "go"),
    (r"approximately\b", "about"),
    (r"(?:subsequently|thereafter|thereupon),?(?= [a-z])", "then"),
    (r"(?:upon|on) (?:reaching|arriv(?:al|ing) at)(?= (?:the|a|an|that|this)\b)", "at"),
)  # fmt: skip
# that plain routes say, too
_COMMON = (
    (rf"make a turn {_TO_SIDE}\b", r"turn \1"),
    (rf"(?:turn|reorient|pivot|rotate)(?: yourself)? {_TO_SIDE}{_ENDS}", r"turn \1"),
    (rf"reverse (?:your |the )?(?:course|direction){_ENDS}", "turn around"),
    (r"turn (?:fully|completely|entirely|all the way) around\b", "turn around"),
    (rf"(?:make your way|take yourself){BEFORE_WAY}", "go"),
    (r"descend(?= (?:the|this|that|those|a|one|two)\b)", "go down"),
    (r"enter into\b", "enter"),
    (r"continue on your way\b", "continue"),
    (r"carry on(?= (?:straight|past|along|through|into|down|up|ahead|forward)\b)", "continue"),
    (r"(?:come|draw) to an? (?:(?:complete|full|gentle) )?(?:halt|stop|standstill)\b", "stop"),
    (r"(?:washroom|restroom|lavatory)\b", "bathroom"),
    (r"sitting room\b", "living room"),
    (r"settee\b", "sofa"),
)  # fmt: skip


def compiled(sayings: Sequence[tuple[str, str]]) -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return patterns and what is said in their place, to be found from a word's begin on."""
    return tuple(
        (re.compile(rf"\b(?:{pattern})", re.IGNORECASE), said) for pattern, said in sayings
    )


_MARKS = compiled(_FORMAL)
_SAYINGS = (*_MARKS, *compiled(_COMMON))
_BEGINS = re.compile(
    r"\b(?:initiate (?:movement|motion|navigation)|commence|begin|start) by (?P<verb>[a-z]+ing)\b",
    re.IGNORECASE,
)
# of what one does, not of what a thing is ("the ascending escalator")
_GERUND = re.compile(
    rf"(?<!\bthe )(?<!\ban )(?<!\ba )(?<!\bthis )(?<!\bthat )\b(?:{'|'.join(_VERBS_ING)})\b"
    r"(?:(?= (?:the|a|an|this|that|these|those|your|it|them|both|all|one|two|three|until|when|"
    rf"while|and|or|then)\b)|{BEFORE_WAY}|(?=[.,;:!?]|$))",
    re.IGNORECASE,
)


def formal(text: str) -> int:
    """Return how many different formal sayings there are in ``text``."""
    turns = any(m["verb"].lower() in ("effect", "execute", "perform") for m in _TURN.finditer(text))
    begins = any(
        m.group().lower().startswith(("initiate", "commence")) for m in _BEGINS.finditer(text)
    )
    return sum(bool(pattern.search(text)) for pattern, _ in _MARKS) + turns + begins


def in_plain_words(sentence: str) -> str:
    """Return a sentence with its formal sayings in plain words."""
    said = _TURN.sub(lambda m: f"turn {_ADVERBS[(m['how'] or '').lower()]}{m['side']}", sentence)
    said = _BEGINS.sub(lambda m: _DONE.get(m["verb"].lower(), m.group()), said)
    for pattern, plain in _SAYINGS:
        said = pattern.sub(plain, said)
    return _GERUND.sub(lambda m: _VERBS_ING[m.group().lower()], said)
