"""Words of navigation: classes, synonyms of landmarks, and what must never be masked.

All lists are ours, written with the vocabulary of indoor instructions in mind.
"""

from __future__ import annotations


def bag(text: str) -> frozenset[str]:
    """Return the words of ``text``."""
    return frozenset(text.split())


_CLASSES: dict[str, str] = {
    "DET": """
        the a an another each every either neither some any no both all
    """,
    "PRON": """
        you it he she they we i me them him us itself yourself there's it's you're you'll
        you've you'd they're yours mine there which who what something anything everything
        nothing someone anyone i'll i'd let's its their his her our my your whose that's
    """,
    "AUX": """
        is are was were be been being am will would shall should can could may might must
        has have had having do does did can't won't isn't aren't don't doesn't cannot
    """,
    "CCONJ": """
        and or but nor
    """,
    "SCONJ": """
        if because while whereas until till once when where unless so as whether although
        than whenever though how
    """,
    "PART": """
        not n't
    """,
    "ADP": """
        at into onto of from towards toward with without via within between among behind
        beside besides beneath underneath above over under near against during for upon in
        on past passed through across along around by beyond below off after before inside
        outside opposite out up down about alongside amid next till per like except front
    """,
    "ADV": """
        then now here not also just again back away ahead forward forwards backward
        backwards straight directly immediately slightly together too very almost only still
        even never always finally afterwards afterward first quickly slowly halfway upstairs
        downstairs upwards downwards upward downward sharply clockwise counterclockwise
        diagonally perpendicular aside soon further farther far maybe perhaps please instead
        once twice thereafter indoors outdoors okay ok well kindly carefully otherwise
        already apart really later anymore rather quite alright hiya yeah yep um hm uh hence
        thence henceforth subsequently hey hi hello oh so everywhere anywhere north south
        east west northward southward eastward westward
    """,
    "NUM": """
        two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen
        sixteen seventeen eighteen nineteen twenty thirty forty fifty sixty ninety hundred
        eighty half
    """,
    "ADJ": """
        second third fourth fifth sixth seventh eighth ninth tenth last next other same own
        large small big little long short tall wide narrow huge tiny giant high low deep
        thin thick heavy slight sharp hard immediate left-hand right-hand far near nearest
        closest farthest furthest adjacent nearby main central final entire whole full empty
        single double triple round square rectangular circular oval arched curved spiral
        triangular octagonal diagonal straight parallel perpendicular red blue green yellow
        orange white black brown grey gray purple pink beige tan gold golden silver maroon
        violet turquoise teal navy cream burgundy dark bright lit pale colourful colorful
        wooden metallic woven marble leather wicker tiled carpeted striped checkered floral
        ornate fancy decorative abstract modern old new antique potted framed painted
        mounted hanging sliding swinging folding open opened closed shut glass outer inner
        upper lower middle front rear outdoor indoor exterior interior upstairs many few
        several more most much less enough different similar opposite first such able clear
        visible safe sure good great nice fine easy simple careful ready happy certain
        possible necessary advisable kind grateful dear esteemed sincere available following
        preceding designated respective appropriate relevant prompt due unable plain solid
        soft stuffed stacked covered draped upholstered cushioned padded carpet-covered
        unfinished leading leftmost rightmost very formal fake grand massive enormous bare
        modest frosted transparent wet dry hot cold warm cool clean dirty shiny dim dead
        live wrought french oriental victorian asian european american persian chinese
        japanese public private master walk-in spare extra stainless rustic plush cosy cozy
        lush lovely quiet raised sunken recessed enclosed adjoining neighboring neighbouring
        connecting attached built-in overhead wood-panelled panelled paneled vaulted
        horizontal vertical alternate previous
    """,
    "VERB": """
        carry go goes going went gone walk walking walks walked proceed proceeds proceeding
        continue continues continuing continued head move moves moving moved enter enters
        entering entered exit exits exiting exited leave leaves leaving leads leading lead
        led reach reaches reaching reached stop stops stopping stopped wait waits waiting
        waited take takes taking took make makes making made keep keeps keeping kept follow
        follows following followed stay stays staying climb climbs climbing climbed descend
        descends descending descended ascend ascends ascending ascended stand stands
        standing turn turns turning turned veer veers veering bear bears bearing face faces
        facing faced pass passes passing cross crosses crossing crossed step stepping steps
        stepped get gets getting got come comes coming came look looks looking see sees
        seeing seen begin begins beginning start starts starting find finds finding hit hits
        hang let need needs want wants use uses using pivot rotate rotates rotating spin
        swing curve curves approach approaches approaching arrive arrives arriving advance
        advancing halt pause remain remains remaining position navigate navigating travel
        traveling travelling go-ahead locate located ensure execute perform traverse
        traversing depart departing circle circling run jump pick put open close push pull
        sit sits sitting lie lies lying ends ending end finish hug hugging stick drop bring
        know think try notice remember forget ignore disregard treat overlook overlooking
        surround surrounding contain contains containing hold holds hanging line lining
        separate separates separating belong appear appears appearing orient orienting
        complete completing transition conclude observe maintain avoid skip return returning
        re-enter reenter march stroll wander hike cut round squeeze slip sneak swerve aim
        point pointing touch connect connects connecting divide divides dividing meet meets
        meeting are's request requested asked required advised instructed kindly be scoot
        scooting pop popping mosey cruise cruising hop strolling wandering swinging commence
        gain effect undertake vacate egress reorient reoriented betake withdraw await cease
        reverse ask hope thank appreciate appreciated explain guide show tell believe
        suppose please help helping enjoy
    """,
}
# words of two classes; which of them is decided by the neighbours
_TWO: dict[str, str] = {
    "VERB NOUN": """
        turn walk stop exit face head stand step steps pass climb place look end work move
        rest wait start set turns entrance approach point circle line curve hand room bar
        light run jump cross drop corner mirror travel advance swing bear hold stick need
        stops exits
    """,
    "ADJ NOUN": """
        glass wood marble leather metal brick stone tile concrete front middle far wicker
        dining living sitting laundry massage coffee pool bath kitchen bed orange second
        grey cement granite iron steel plastic cloth carpet floor bottom top inside outside
        side american square round oval high low other double following opposite
    """,
    "ADJ VERB": """
        open closed lit covered raised hanging facing leading sliding standing adjoining
        following connecting mounted painted carpeted framed arched tiled lined swinging
        separate clear clean
    """,
    "ADP ADV": """
        in on up down over across past through by along around inside outside off out under
        above below behind before after opposite near beyond underneath
    """,
    "DET PRON": """
        that this these those one
    """,
    "ADJ ADV": """
        straight far right left next close
        first
    """,
    "PART ADP": """
        to
    """,
}

AMBIGUOUS: dict[str, tuple[str, str]] = {
    word: (pair.split()[0], pair.split()[1]) for pair, text in _TWO.items() for word in text.split()
}
TAGS = {word: name for name, text in reversed(_CLASSES.items()) for word in text.split()}
VERBS = bag(_CLASSES["VERB"])
AMBIGUOUS_NOUNS = frozenset(word for word, pair in AMBIGUOUS.items() if "NOUN" in pair)
POSSESSORS = bag("the your a an this that my his her its their our first second next")
# what general taggers misread in instructions (turn, exit, left ...): our tag is kept there
OVERRIDES = bag("left right turn exit head face stop stand past through walk pass straight forward")

# never masked: words that say where, which way or which one, or that deny (and all in n't)
SPATIAL = (bag(_CLASSES["ADP"]) - bag("of for with like per about during")) | bag(
    """
    left right straight forward forwards ahead back backward backwards up down upstairs downstairs
    upward upwards downward downwards around away here there north south east west northern southern
    eastern western left-hand right-hand leftmost rightmost first second third fourth fifth sixth
    seventh eighth ninth tenth last next other opposite far near nearest closest farthest furthest
    nearby adjacent middle front rear top bottom upper lower inner outer halfway directly
    immediately slightly slight sharp sharply hard diagonally diagonal clockwise counterclockwise
    northward southward eastward westward same previous preceding following only
    perpendicular parallel to until till once before after when where not never cannot no neither
    nor nothing none nobody without further farther beyond again twice indoors outdoors inside
    outside half both
    all each every another between side end long entire whole full off facing leading central
    immediate
    """
)


def is_kept(word: str) -> bool:
    """Return whether masks never hide ``word``, in lower case with a straight apostrophe."""
    return word in SPATIAL or word.endswith("n't")
