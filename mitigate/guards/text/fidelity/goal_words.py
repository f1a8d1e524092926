"""Words and sayings around a thing to be found that tell nothing of it."""

from __future__ import annotations

import re

from mitigate.corruptions.language.directions import TURN_VERBS
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.plain_words import plain_form
from mitigate.guards.text.texts.steps import HALTS, MOVES, SEEKS
from mitigate.guards.text.texts.text import words

# denials and conditions that are none, and other things that are said and plain requests do not say
SAYINGS = re.compile(
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
    r"pretty please|dear all|(?:many )?thanks in advance|"
    r"have a (?:look|lovely day|good day|nice day|good one|great day)|"
    r"see you (?:soon|there|later))\b"
)
# plain requests say these, too: how one stops, and where
PLAIN_SAYINGS = re.compile(
    r"\b(?:right (?:away|now|then|there|here|over|up to)|all right|stop (?:walking|moving)|"
    r"(?:stay|remain|stand|wait) (?:right |just )?there|hold (?:your |that |the )?position|"
    r"(?:come|comes|draw|bring \w+) to (?:a |an |your )?(?:\w+ )?(?:halt|stop|standstill|rest)|"
    r"(?:in|within|around|throughout) (?:the|this|your|my|our) (?:house|home|apartment|flat|place|"
    r"building|area|premises|environment|residence|dwelling|interior)|in (?:its|the) vicinity|"
    r"(?:(?:right|directly|just|close) )?(?:beside|next to|near|nearby|by|in front of|before|at|"
    r"close to|adjacent to|facing|opposite) (?:it|one|that)|when (?:adjacent|close|there))\b"
)
# that one is to stop, said in other words
STAYS = re.compile(r"\b(?:await|stay|remain|stand|hold (?:your |that |the )?position)\b")
GREETINGS = bag(
    """
    hey hi hello hiya howdy greetings welcome good morning afternoon evening day dear sir madam
    ma'am miss friend buddy pal mate champ folks there robot robo bot agent assistant operator
    unit helper
    """
)
POLITE = bag(
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
TALK = bag(
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
    hiding writing should lead off honestly dude bro man haha lol omg plz
    """
)
ORDERS = bag(
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
PLACES = bag(
    """
    here there around nearby somewhere anywhere house home apartment flat place building area
    premises environment vicinity residence dwelling surroundings space household interior
    within wherever
    """
)
SMALL = bag(
    """
    i me we us you your yourself it its this that these those them they one ones he she to for
    of at by near in on with over up about the a an my our his her any some out off away along
    down itself
    """
)
# what may stand between the determiner and the thing, and tells nothing of it
TELLS_NOTHING = bag(
    """
    good nice lovely suitable designated target specified requested aforementioned said
    particular desired required appropriate goal
    """
)
VERBS = (
    SEEKS
    | (MOVES - TURN_VERBS)
    | bag(
        """
        locating need needs want wants require get see where navigate proceed approach approaching
        reach make betake stroll wander mosey amble advance
        """
    )
)
# what one may be told to do with the thing, or afterwards
ACTS = bag(
    "get give take put hold call report come go look return bring carry home have stay leave"
)
KNOWN = (
    GREETINGS | POLITE | TALK | ORDERS | PLACES | SMALL | VERBS | HALTS | TELLS_NOTHING
    | bag("towards toward another")
)  # fmt: skip
# what a plain request does not say
MANNERED = (
    (GREETINGS | POLITE | TALK | ORDERS)
    - (VERBS | HALTS | PLACES | SMALL)
    - bag("and then or but so once until")
)
# which of several things, when, and what not
_WHICH = bag(
    """
    or not no never except unless if only then until till before after first instead either neither
    nor whichever than
    """
)


def told_of_goal(text: str) -> list[str]:
    """Return the words of a request for a thing, in plain form, that are not known to tell nothing
    of it: what it is and is like, what else is to be done, which of several, when, what not."""
    said = SAYINGS.sub(" ", text.lower().replace("’", "'"))
    return [
        plain_form(word)
        for word in words(said)
        if word in _WHICH or word in ACTS or word not in KNOWN or word.endswith("n't")
    ]
