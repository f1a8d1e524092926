"""Requests for one thing, in plain words: "Hey, could you find me a chair? Thanks!" is "Look for a
chair.".

A text is such a request only if each of its words is known to say nothing of the way, but for one
thing and what it is like, which stay as they were heard. Whatever else is told (a turn, a second
thing, where it stands, a denial, a number) leaves the text as it is.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from mitigate.corruptions.language.directions import TURN_VERBS
from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.tagger import Token, tag
from mitigate.corruptions.language.words import bag
from mitigate.safeguard import gate
from mitigate.safeguard.meaning import CATEGORIES
from mitigate.safeguard.neighbours import SEEKS, STOPS
from mitigate.safeguard.steps import MOVES
from mitigate.safeguard.text import words

LONGEST = 5  # words of a thing and what it is like ("a small round wooden side table")
_MASK = "[mask]"
# denials and conditions that are none, and other things that are said and plain requests do not say
_SAYINGS = re.compile(
    r"\b(?:if (?:you (?:could|can|would|may|please|don't mind|wouldn't mind)|possible|convenient|"
    r"that's (?:ok|okay|alright|all right)|that makes sense|it's no trouble)|"
    r"(?:there's |there is )?no (?:rush|hurry|worries|pressure|problem|trouble|idea|"
    r"need to (?:rush|hurry))|not to worry|"
    r"(?:please )?don't (?:worry|hesitate|rush|hurry|fret)|(?:i'm |i am )?not (?:\w+ )?sure|"
    r"(?:i )?don't (?:really |quite |exactly )?(?:know|mind)(?: exactly)?(?: where| which| how)?|"
    r"(?:i )?can't wait|(?:take|taking) (?:your|the) time|(?:nice and )?easy as (?:that|pie)|"
    r"as soon as (?:you can|possible)|at that point|stop for a (?:breather|rest|moment)|"
    r"at your (?:earliest |own )?convenience|(?:in|at) (?:closing|conclusion|the (?:end|outset|"
    r"beginning|first))|to (?:get going|finish(?: off| up)?|end|conclude|begin|start)|as follows|"
    r"that's (?:it|all|the one)|after (?:that|this|it)|first (?:of all|off|and foremost|things "
    r"first)|keep (?:an eye|your eyes) (?:out|open|peeled)|"
    r"(?:in|on) (?:search|pursuit|the lookout) (?:of|for)|the (?:location|whereabouts|position) of|"
    r"have a (?:look|lovely day|good day|nice day|good one|great day)|"
    r"see you (?:soon|there|later))\b"
)
# plain requests say these, too: how one stops, and where
_PLAIN_SAYINGS = re.compile(
    r"\b(?:right (?:away|now|then|there|here|over|up to)|all right|stop (?:walking|moving)|"
    r"(?:come|comes|draw|bring \w+) to (?:a |an |your )?(?:\w+ )?(?:halt|stop|standstill|rest)|"
    r"(?:in|within|around|throughout) (?:the|this|your|my|our) (?:house|home|apartment|flat|place|"
    r"building|area|premises|environment|residence|dwelling|interior)|in (?:its|the) vicinity|"
    r"(?:(?:right|directly|just|close) )?(?:beside|next to|near|nearby|by|in front of|before|at|"
    r"close to|adjacent to|facing|opposite) (?:it|one|that)|when (?:adjacent|close|there))\b"
)
_BESIDE_IT = re.compile(
    r"\b(?:(?:right|directly|just|close) )?(?:beside|next to|near|by|in front of|before|"
    r"close to|adjacent to|facing|opposite) it\b"
)
_GREETINGS = bag(
    """
    hey hi hello hiya howdy greetings welcome good morning afternoon evening day dear sir madam
    ma'am miss friend buddy pal mate champ folks there robot robo bot agent assistant operator
    unit helper
    """
)
_POLITE = bag(
    """
    please pls kindly thanks thank cheers thx ta bunch much many very so really truly greatly
    highly most ever appreciate appreciated appreciates grateful obliged cooperation assistance
    help helping helpful kind kindness mind love glad happy delighted pleasure pleased lovely
    great nice super awesome wonderful perfect amazing fantastic brilliant sweet cool fun enjoy
    luck lucky excited ready easy peasy simple simply best wishes regards sincerely respectfully
    humbly request requested requesting requests ask asked asking invited instructed advised
    directed required obligated wish desire desired would could can may might shall should must
    will ought favor favour bless esteemed colleague colleagues valued respected honoured
    honored sincere gratitude permission granted convenience good afternoon patience attention
    consideration hesitate you'd thankful gracious graciously gently carefully care hug high
    five woohoo yay teamwork proud pop rock rocking star superstar rooting believe got cheerful
    joy delight splendid marvellous marvelous invite dear heart sweetheart sweetie whenever
    million time darling honey hero legend job work well done nicely
    """
)
_TALK = bag(
    """
    um uh er erm hm hmm oh ah well ok okay alright alrighty yeah yep yes yup so like just only
    maybe perhaps probably basically actually honestly kinda sorta sort kind guess think thinks
    thought believe suppose supposed hope hopes hopefully know knows mean means say said tell
    told explain try trying tries let let's lets want wants wanna wanted need needs needed gotta
    got get gets getting have has having had do does doing did is are was were be been being am
    i'm i'd i'll i've you're you'd you'll you've we'll we're we'd we've it's it'll it'd that's
    that'll what's where's here's there's new sense makes make goes going gonna go went wonder
    wondering how what where which who when while once after before until till as soon then now
    next first firstly finally lastly ultimately eventually last end ends ending afterwards
    thereafter thereupon subsequently upon also too and or but way ahead breather break moment
    second seconds minute bit little sec quick quickly bother trouble possible able begin
    beginning initially whatever whichever else anyway anyhow though because since look looking
    looks thingy whoever together about even really literally give gives take takes taking put
    call called named sorry excuse pardon wherever ready set whereabouts situated happen happens
    hiding writing should lead off
    """
)
_ORDERS = bag(
    """
    task briefing brief procedure procedures route guidance navigation navigate navigating
    instruction instructions instructed objective objectives mission assignment order orders
    command commands execute executing execution perform performing commence commencing begin
    beginning start starting initiate initiating initiated initialise initialize conduct
    conducting carry out complete completes completed completing completion conclude concludes
    concluded concluding conclusion report reporting confirm confirmed confirming upon arrival
    arrive arrives arriving arrived reach reached reaching approach approaching acquire
    acquisition identify identified identifying identification locate located locating location
    detect detection search sweep scan scanning survey proceed proceeding following follows
    below operation destination goal goals target targets item items object objects thing
    position standby terminate termination cease over copy steps movement motion halt advance
    advancing transit relocate relocation affirm affirmative acknowledge acknowledged visual
    contact status verify verified verification ensure designated parameters primary current
    sector perimeter traverse traversal immediately promptly accordingly thereafter maintain
    hold stationary remain await category instance acceptable required requirement
    episode success successfully distance clearance minimum maximum path length optimal
    efficient efficiently autonomously autonomous perception explore exploring exploration until
    detected found seek undertake effect
    """
)
_PLACES = bag(
    """
    here there around nearby somewhere anywhere house home apartment flat place building area
    premises environment vicinity residence dwelling surroundings space household interior
    within wherever
    """
)
_SMALL = bag(
    """
    i me we us you your yourself it its this that these those them they one ones he she to for
    of at by near in on with over up about the a an my our his her any some out off away along
    down itself
    """
)
_DETERMINERS = bag(
    """
    a an the my your our his her any some this that those these another one
    """
)
_BEFORE = bag(
    """
    to for at by near towards toward upon me us out up over track find need want is are
    """
)
# what may stand between the determiner and the thing, and tells nothing of it
_EMPTY = bag(
    """
    good nice lovely suitable designated target specified requested aforementioned said
    particular desired required appropriate goal
    """
)
_ONLY = bag("first last only next same other")
_NOUNS_BEHIND = STOPS | bag(
    "unit area station object item items objects position place space sweep"
)
_SOUGHT = SEEKS | bag("locating need needs want wants require get see where")
_VERBS = _SOUGHT | (MOVES - TURN_VERBS) | bag(
    "navigate proceed approach approaching reach make betake stroll wander mosey amble advance"
)  # fmt: skip
_KNOWN = (
    _GREETINGS | _POLITE | _TALK | _ORDERS | _PLACES | _SMALL | _VERBS | STOPS | _EMPTY
    | bag("towards toward another")
)  # fmt: skip
_ASKS_FOR = _DETERMINERS | _BEFORE | _VERBS | {_MASK, ":"}  # may stand before a thing
# what a plain request does not say
_MANNERED = (
    (_GREETINGS | _POLITE | _TALK | _ORDERS)
    - (_VERBS | STOPS | _PLACES | _SMALL)
    - bag("and then or but so once until")
)
# who tells of an order and does not give it: "So, you find a bed."
_YOU = re.compile(
    r"(?:^|[.!?,:] )(?:(?:so|now|and|then),? )*you (?:\w+ly |just )?(?!are\b|can\b)\w+"
)
# what is told beside a thing: denials, conditions, where it stands, what is over or begins there
_TELLS = re.compile(
    r"\b(?:not|no|never|n't|without|except|instead|avoid|ignore|unless|if|\w+n't|look(?:ing)? at|"
    r"(?:in|on|over|up|down|out|off|along|with|within|away|around|about|of|as|like|than|till|"
    r"until|before|after|when|while|once|where|or|but) (?:it|them|that|the|an?|this|these|those|my|"
    r"your|our|his|her|any|some|another)|(?:stop|cease|quit|finish|done|terminate|end)s? \w+ing|"
    r"(?:is|are) over|(?:has|have|had) been|was|were|(?:start|begin)\w* (?:at|near))\b"
    r"|[\"“”()<>{}\[\]/\\|=#*`]"
)


def object_goal(heard: str, restyled: bool = False) -> str | None:
    """Return ``heard`` in plain words, if it asks for one thing and tells nothing else; else None.

    "Look for a chair." or "Go to the chair.", and where to stop if that is told ("and stop next to
    it."); the thing, what it is like and its determiner are as they were heard. None also for what
    is shorter already, and for what is plain: that holds no mask and no word of a manner, unless
    some went before (``restyled``).
    """
    text = heard.lower().replace("’", "'")
    if len(text) != len(heard):
        return None
    stops = "stop" in facts(heard).directions or "await" in text
    mannered = restyled or _MASK in text or bool(_SAYINGS.search(text) or _YOU.search(text))
    for sayings in (_SAYINGS, _PLAIN_SAYINGS):
        text = sayings.sub(lambda saying: " " * len(saying.group()), text)
    if _TELLS.search(text.replace(_MASK, " ")) or gate.route_turns(heard):
        return None
    found = tag(text)
    things = _things(found)
    mannered = mannered or any(token.lower in _MANNERED for token in found)
    if not mannered or not things or not any(token.lower in _VERBS for token in found):
        return None
    named = [[token.lower for token in found[thing.start : thing.stop]] for thing in things]
    longest = max(range(len(things)), key=lambda n: len(named[n]))
    if any(named[longest][-len(name) :] != name for name in named):
        return None
    thing = things[longest]
    asked = heard[found[thing.start].start : found[thing.stop - 1].end]
    before = found[thing.start - 1].lower if thing.start else ""
    seeks = SEEKS if stops else _SOUGHT  # "you need to go to the bed and stop" seeks nothing
    if any(token.lower in seeks for token in found):
        given = f"Look for {before if before in _DETERMINERS else _article(asked)} {asked}"
    else:
        given = f"Go to {before if before in _DETERMINERS else 'the'} {asked}"
    given += f" and stop{_where(heard[found[thing.stop - 1].end :])}." if stops else "."
    shorter = _MASK not in text and len(words(given)) > len(words(heard))
    if shorter or gate.result_refused(heard, given):
        return None
    return given


def _where(behind: str) -> str:
    """Return where one is told to stop, as heard ("next to it"), with a space before it."""
    told = _BESIDE_IT.search(behind.lower())
    return f" {told.group()}" if told else ""


def _things(found: Sequence[Token]) -> list[range]:
    """Return the places of what is named; none if something else is told."""
    other = [p for p, t in enumerate(found) if _is_told(t)]
    runs: list[range] = []
    for place in other:
        if runs and runs[-1].stop == place:
            runs[-1] = range(runs[-1].start, place + 1)
        else:
            runs.append(range(place, place + 1))
    return runs if all(_is_thing(found, run) for run in runs) else []


def _is_told(token: Token) -> bool:
    return token.is_word and token.lower not in _KNOWN


def _is_thing(found: Sequence[Token], run: range) -> bool:
    """Return whether the words at ``run`` can be a thing and what it is like, asked for as one."""
    last = found[run[-1]]
    thing = last.tag in ("NOUN", "PROPN") or last.lower in CATEGORIES
    if not thing or len(run) > LONGEST or any(found[p].tag == "NUM" for p in run):
        return False
    first, behind = run.start - 1, run.stop
    while first >= 0 and found[first].lower in _EMPTY:
        first -= 1
    before = found[first].lower if first >= 0 else ""
    if behind < len(found) and found[behind].lower in _NOUNS_BEHIND:
        return False
    return before in _ASKS_FOR


def _article(thing: str) -> str:
    first = thing.split()[0].lower()
    if first in _ONLY or (first.endswith("est") and len(first) > 5):  # "nearest", not "chest"
        return "the"
    return "an" if first[0] in "aeiou" else "a"
