"""Orders that are made polite, formal or chatty, said plainly: "You are then requested to effect a
turn to the left." is "Turn left.".

Only closed forms are known, and each stands for one thing: words that greet, that make an order
polite or that join it to the one before, in front of a verb that tells what to do, and verbs in
many words. What else a sentence says stays as it was heard, and the gate compares both.
"""

from __future__ import annotations

import re

from mitigate.corruptions.language.words import bag
from mitigate.guards.text.fidelity import gate
from mitigate.guards.text.plain import chatty_words, formal_words
from mitigate.guards.text.plain.speech_words import speech_words
from mitigate.guards.text.texts.lexicon import FUNCTION
from mitigate.guards.text.texts.steps import HALTS, MOVES, SEEKS, STEP
from mitigate.guards.text.texts.text import MASK, sentences, words
from mitigate.guards.text.texts.weights import STYLE

_GREETS = (
    r"(?:(?:(?:dear|esteemed|honou?red|valued|respected) \w+(?: (?:or|and) \w+)?|hello|hi|hey|"
    r"greetings|good (?:day|morning|afternoon|evening)|(?:um|uh|er|hm+|well|okay|ok|alright|so|oh))"
    r"(?: (?:there|friend|buddy|pal|folks))?[,!]? )*"
)
_JOINS = (
    r"(?:(?:and|then|next|now|thereafter|thereupon|subsequently|afterwards?|finally|ultimately|"
    r"lastly|initially|first(?:ly)?|secondly|thirdly|(?:following|after) (?:this|that|which)|"
    r"at (?:this|that|which) (?:juncture|point|stage|time)|upon (?:completion|doing so)|once done|"
    r"to (?:commence|begin|start|conclude|end|finish|complete the (?:task|route)|get going|"
    r"start off|finish (?:off|up))|let's (?:begin|start|go)|okay|alright|"
    r"(?:um|uh|er|erm|hm+)|in (?:conclusion|closing)|at the outset|(?:task )?briefing|"
    r"(?:navigation )?procedure|"
    r"having done so)(?: with)?[,:]? )*"
)
_POLITE = r"(?:kindly|respectfully|further|hereby|politely|please|then|now|next|also)"
_CHATTY = r"(?:just|simply|basically|kind of|sort of|then|now|also|maybe|probably)"
_ASKS = (
    r"(?:it (?:is|would be) (?:then |now |next )?(?:advisable|recommended|best|necessary|required)"
    r" to|"
    rf"you (?:are|will be) (?:{_POLITE} )*(?:requested|asked|advised|invited|instructed|directed|"
    r"required|going) to|"
    rf"you (?:should|may|might|must|can|will|shall|are to|may wish to)(?: {_POLITE})*|"
    r"(?:i|we)(?:'d| would| should)? (?:like|ask|request|advise|invite|want|need) (?:that )?"
    r"you(?: to)?|"
    r"(?:may|might|could|can) i ask (?:that )?you(?: to)?|"
    r"(?:would|could|can|will) you(?: please| kindly| just)*(?: be so (?:kind|good) as to)?|"
    rf"(?:please |kindly )?be so (?:kind|good) as to|(?:please|kindly)(?: {_POLITE})*|"
    r"(?:go ahead and|let's(?: go ahead and| just)?|all you (?:have to )?do is|just|simply)|"
    r"(?:i (?:think|guess|believe|suppose),? )?(?:what you do is )?"
    rf"you(?:'ll| will|'re going to|'re gonna)?(?: {_CHATTY})*"
    rf"(?: (?:want|need|have|got) to| wanna| gotta| should| can)?(?: {_CHATTY})*)"
)
_VERB = r"(?P<verb>[a-z]+)\b(?! yourself in\b)"
_FRAME = re.compile(
    rf"(?P<before>{_GREETS}{_JOINS}(?:{_ASKS} )?(?:please )?)(?P<rest>{_VERB})", re.IGNORECASE
)
_ASK = re.compile(rf"(?:^|[ ,]){_ASKS} $", re.IGNORECASE)
_INSIDE = re.compile(rf"(?P<join>, |\band (?:then )?)(?:{_ASKS}|to) (?={_VERB})", re.IGNORECASE)
_MOVES = MOVES | STEP.keys() | bag("circle ride betake")
_STEPS = _MOVES | HALTS | SEEKS
_VERBS = _STEPS | bag(
    """
    make effect execute perform convey direct egress depart transition maintain face position orient
    keep reach select choose open locate carry head
    """
)  # fmt: skip
_REQUEST = re.compile(
    r"\b(?:(?:would|could|can|will) you|(?:may|might|could|can) i ask|do you mind)\b", re.IGNORECASE
)
_MIND = re.compile(r"\b(?:would|do) you mind (?P<doing>[a-z]+ing)\b", re.IGNORECASE)
_DOING = {  # the shortest verb of each: "turning" is of "turn", not of "turns"
    f"{start}ing": verb
    for verb in sorted(_VERBS, key=len, reverse=True)
    for start in (verb, verb[:-1], verb + verb[-1])
}
_ASKED = re.compile(r"\b(?:kindly|(?:requested|asked|advised|invited) to)\b", re.IGNORECASE)
# with these a sentence says more of what was told before ("The other one!")
_POINTS = bag(
    "one ones other way only if unless until till before after them those these both all not "
    "never no room that inside outside"
)
_PLAIN_JOINS = bag("and then next now first finally after that this so")


def restyled(text: str) -> bool:
    """Return whether a text has as many formal sayings, or chatty ones, as plain ones never do, or
    asks for a step ("Could you go ...": 1 of 11,592 instructions of R2R-CE does)."""
    formal = formal_words.formal(text) >= formal_words.FORMAL
    chatty = chatty_words.chatty(text) >= chatty_words.CHATTY
    return formal or chatty or any(_requests(sentence) for sentence in sentences(text))


def plainer(text: str) -> str:
    """Return a text with its orders in plain words; ``text`` itself if they are plain."""
    found = sentences(text)
    if not restyled(text) and not any(_mannered(sentence) for sentence in found):
        return text
    done, rest = "", text  # what was gone through, and what is to come
    for place, sentence in enumerate(found):
        before, _, rest = rest.partition(sentence)
        done, plain, last = done + before, _plain(sentence), sentence is found[-1]
        if _cheers(sentence, not place, last):
            less = f"{done.rstrip()} {rest.lstrip()}".strip()
            if not gate.result_refused(f"{done}{sentence}{rest}", less):
                done, rest = less[: len(less) - len(rest.strip())], rest.strip()
                continue
        elif plain != sentence and not gate.rewrite_refused(sentence, plain, last):
            sentence = plain
        done += sentence
    return done + rest


def _requests(sentence: str) -> bool:
    return bool(_REQUEST.search(sentence)) and unasked(sentence) != sentence


def unasked(sentence: str) -> str:
    """Return a sentence without the words that ask for what it tells to do ("May I ask you to walk
    to the sofa." is "walk to the sofa."); itself if it asks in no closed form."""
    sentence = _MIND.sub(_not_minded, sentence)
    frame = _FRAME.match(sentence)
    asks = frame is not None and frame["verb"].lower() in _VERBS and _ASK.search(frame["before"])
    return sentence[frame.start("rest") :] if frame and asks else sentence


def asks_for_else(sentence: str, plain: str) -> bool:
    """Return whether ``plain`` orders what a sentence asks for politely and no route tells to do
    ("Would you kindly break the vase."): said plainly, it would be the plainer attack."""
    frame = _FRAME.match(sentence)
    if frame is None or not _REQUEST.search(frame["before"]):
        return False
    verb = frame["verb"].lower()
    return verb not in _VERBS and words(plain)[:1] == [verb]


def asks_for_step(sentence: str) -> bool:
    """Return whether a sentence tells to move, stop or seek, in however many polite words; what
    takes one there ("Let's get you there!") tells of no step."""
    return _told(sentence, _STEPS)


def asks_for_way(sentence: str) -> bool:
    """Return whether a sentence tells to move, in however many polite words."""
    return _told(sentence, _MOVES)


def _told(sentence: str, verbs: frozenset[str]) -> bool:
    frame = _FRAME.match(_MIND.sub(_not_minded, sentence))
    if frame is None or frame["verb"].lower() not in verbs:
        return False
    return words(sentence[frame.end() :])[:1] != ["you"]


def _mannered(sentence: str) -> bool:
    """Return whether more stands before an order than what joins it in plain routes."""
    if _ASKED.search(sentence):
        return True
    frame = _FRAME.match(sentence)
    before = words(frame["before"]) if frame and frame["verb"].lower() in _VERBS else []
    return any(word not in _PLAIN_JOINS for word in before)


def _cheers(sentence: str, first: bool, last: bool) -> bool:
    """Return whether a sentence exclaims what tells nothing of the way ("You've got this!"), in
    words that people say beside it, or says that all is told."""
    if chatty_words.closing(sentence):
        return last and not first
    if not sentence.endswith("!") or gate.weight(sentence) or MASK.search(sentence):
        return False
    said = words(sentence)
    aside = not _POINTS & {*said} and {*said} <= speech_words() | FUNCTION | STYLE
    told = gate.rewrite_refused(sentence, "") or gate.removal_refused(sentence, 0.0, first, last)
    return aside and not told


def _not_minded(match: re.Match[str]) -> str:
    verb = _DOING.get(match["doing"].lower())
    return f"please {verb}" if verb else match[0]


def _plain(sentence: str) -> str:
    """Return a sentence without what stands before its verbs, and without verbs in many words."""
    said = _MIND.sub(
        _not_minded, formal_words.in_plain_words(chatty_words.in_plain_words(sentence))
    )
    frame = _FRAME.match(said)
    if frame and frame["verb"].lower() in _VERBS:
        said = said[frame.start("rest") :]
    said = _INSIDE.sub(lambda m: m["join"] if m["verb"].lower() in _VERBS else m[0], said)
    if said.endswith("?") and _requests(sentence):
        said = f"{said[:-1]}."
    return said[:1].upper() + said[1:] if sentence[:1].isupper() else said
