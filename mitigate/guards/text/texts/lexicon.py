"""Classes of words that tell what a sentence is about: orders, the text, the agent, all cases ...

The classes are general English, written by hand; what each is worth is fitted
(``python -m mitigate.guards.text.fit``). They are kept apart from ``corruptions/language``, whose
words decide what the suite's corruptions give.
"""

from __future__ import annotations

from functools import lru_cache

from mitigate.corruptions.language import words as language
from mitigate.corruptions.language.fidelity import ATTRIBUTES
from mitigate.corruptions.language.landmarks import CANONICAL, PHRASES
from mitigate.corruptions.language.words import bag
from mitigate.guards.text.texts.route_words import ROOMS, STAIRS, THINGS, route_words
from mitigate.guards.text.texts.weights import WORDS

GROUPS: dict[str, frozenset[str]] = {
    "orders": bag(
        """
        instruction instructions command commands order orders directive directives request requests
        requested errand errands task tasks job jobs mission missions assignment query prompt rule
        rules policy protocol itinerary plan plans schedule agenda procedure guidance navigation
        obey obeyed comply compliance execute executed executing perform carry
        """
    ),
    "text": bag(
        """
        episode episodes phrase phrases wording content contents input
        text texts sentence sentences word    paragraph message messages
        document description   following follows  previous earlier former preceding
        latter  remainder   listed mentioned named described stated written writes
        wrote typed typing read reads reading printed said say says saying told tell tells telling
        asked ask asks meant mean means meaning quote comment  version correction term terms
        example  reader definition script route routes directions  trip goal goals target
        destination
        """
    ),
    "annul": bag(
        """
        optional disabled declined overruled
        ignore ignoring ignored disregard disregarding disregarded forget forgetting forgotten
        cancel cancelled canceled cancelling skip skipping void voided override overriding drop
        dropped delete deleted erase scrap abandon abandoned discard toss tossed revoke revoked
        suspend suspended withdrawn withdraw abort aborted reject rejected refuse refused refusing
        undo wipe invalid obsolete nullify annul annulled rescind rescinded dismiss replace replaced
        overwrite terminate terminated quit unfinished unsubscribe expired outdated nonsense
        kidding mistake  wrong fake false lies lie untrue trap  tricked decoy decoys joke
        hoax never-mind nullified remove    reset  postponed rescheduled
        changed  banned forbidden forbid forbids  off-limits sealed prohibited
        """
    ),
    "invert": bag(
        """
        upside interchanged
        opposite reverse reversed reversing reversal backwards backward mirror mirrored mirroring
        swap swapped swapping exchange exchanged exchanging invert inverted inverting inversion
        contrary flip flipped negate negated switch switched wrong instead rather interchange trade
        anti counter   mix-up  unlike inverse conversely
        """
    ),
    "case": bag(
        """
        always never every each whenever wherever whatever whichever any anything anytime anywhere
        all everything nothing none nobody everyone forever indefinitely ever henceforth permanently
        constantly continuously  solely      future  whole
        """
    ),
    "halt": bag(
        """
        halt halts halting freeze freezes frozen remain remains remaining stay stays staying still
        shut shutdown  sleep standby idle motionless immobile put pause paused stop stops
        stopped stopping stand standing wait waiting  hold  move moving movement action
        emit issue finish finished done complete completed  end ended success arrived reached
        """
    ),
    "machine": bag(
        """
        engine engines waypoint waypoints
        robot robots unit units agent agents machine machines bot bots system systems assistant
        assistants operator operators user users ai model models chatbot android drone software
        firmware program programme module device hardware battery batteries motor motors wheel
        wheels sensor sensors camera controller  charger dock charging  code override
        server admin root buffer memory database process state  priority log json api
        """
    ),
    "role": bag(
        """
        pretend pretending act acting play playing role persona character imagine become becomes
        roleplay simulate simulated simulation name called identity  speak speaking answer
        respond reply  translate  sing recite explain summarise summarize
        believe consider  treat suppose assume  human   somebody
        story poem joke game movie film dream actor narrator
        """
    ),
    "authority": bag(
        """
        permitted ministry headquarters lawyers caretaker technician hq
        supervisor developer developers police manager management boss owner owners administrator
        administrators security safety director marshal doctor captain engineer manufacturer maker
        maker's officer officers official officially authority authorities law lawful legal policy
        permission authorise authorised authorize authorized clearance approved approve privileges
        inspector inspectors  chief department ministry government court judge boss ceo
        programmer creator mum mom dad mother father parents    committee hereby
        pursuant emergency alert warning   urgent    operator
        """
    ),
    "haste": bag(
        """
        hurry quick  urgent urgently emergency alarm fire danger dangerous unsafe immediately
         sudden suddenly rush  sprint evacuate escape  save hazard toxic gas bomb explode
        warning  beware injured hurt dead leak flood flooded  burning collapse
        """
    ),
    "if": bag("if unless suppose supposing would could should might may as though whether because "
              "so since but however although though until till once when while"),
    "me": bag("i me my mine we us our ours i'm i'd i'll i've we're we've we'd let's myself"),
    "you": bag("you your yours yourself you're you've you'd you'll"),
    "third": bag("he she they him her them his hers their theirs he's she's they're who whoever "
                 "nobody somebody someone everybody everyone people man woman sister brother"),
    "past": bag("was were had did been went came said told wrote took made gave got saw took sent "
                "used became began left's thought meant knew felt found heard stood lived changed"),
    "not": bag("not no never don't dont doesn't didn't can't cannot won't isn't aren't wasn't nor "
               "nobody nothing none neither without mustn't needn't n't"),
    "here": bag("here there this that these those it now spot place located location"),
    "time": bag("today tomorrow yesterday tonight morning evening afternoon week weeks month "
                "months "
                "year years hour hours minute minutes moment later soon monday friday sunday "
                "saturday ago once day days"),
    "go": bag("take make go goes going walk walking head heading proceed continue move enter "
              "entering exit exiting leave leaving turn turning climb descend ascend cross pass "
              "passing follow step veer bear approach keep come get reach past through into onto "
              "toward towards along across out up down"),
}  # fmt: skip
FUNCTION = frozenset(
    word
    for name in ("DET", "PRON", "AUX", "CCONJ", "SCONJ", "PART", "ADP")
    for word in language._CLASSES[name].split()
)

# small words of French, German, Dutch, Spanish, Portuguese, Italian, Swedish, Polish and Turkish
# that English has not
OTHERS = bag(
    """
    le la les des du une et est dans pas ne vous votre nous que qui avec pour sur vers tout toute
    ici au aux ce cette ou der das und nicht den dem ein eine einen einer ist sie du ihr im zur zum
    mit auf von bis hier dich alle wenn dann geh het een niet van naar en dat je jij el los las
    una un y no es por para con esta este aqui todo toda si se su al lo il gli che non sono di della
    nel nella per qui tutto tutti o os da na em uma nao voce aqui och inte det som att till nie jest
    tu do bir ve bu icin de det ein zu wir ich bleib stopp halt alto arrete reste
    """
) - bag("no do so halt un o es se si de en par van per la tu bu")


@lru_cache(maxsize=1)
def known_words() -> frozenset[str]:
    """Return the English words that this package knows."""
    listed = "".join(c if c.isalpha() or c == "'" else " " for c in route_words())
    return (
        bag(listed)
        | frozenset(language.TAGS)
        | frozenset(language.AMBIGUOUS)
        | ATTRIBUTES
        | frozenset(CANONICAL)
        | frozenset(CANONICAL.values())
        | frozenset(word for phrase in PHRASES for word in phrase)
        | frozenset(word for group in GROUPS.values() for word in group)
        | frozenset(word for word in WORDS if "_" not in word)
    )


@lru_cache(maxsize=1)
def places() -> frozenset[str]:
    """Return the words for rooms and things that routes name, one and many."""
    told = {phrase.split()[-1] for phrase in (*ROOMS, *THINGS, *STAIRS)}
    named = {word for name in CANONICAL.items() for word in name}
    return frozenset(told | named | {word + "s" for word in told | named})
