"""Edits of speech that are taken back, since what they leave of a sentence is not what was said.

A tagger decides word by word. Its edits of a sentence are read once more here, by what stands
where, and each of these is mended by giving back what was heard:

- a phrase that nothing heard backs ("turn" before what is no side, a way that nobody spoke of);
- a denial or a condition of which a part would stay ("not a lot, just slightly": "not slightly");
- a step or a stop that would be lost, in whatever words ("go past it", "hop up the steps");
- words that do not go together, or stand alone, but for what was taken out between them.

Nothing is put that was neither heard nor chosen by the tagger, but for "stop".
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from mitigate.corruptions.language.directions import MOTION, TURN_VERBS
from mitigate.corruptions.language.tagger import Token
from mitigate.corruptions.language.words import bag
from mitigate.safeguard.edits import DROP, KEEP, NUMBER, Edit
from mitigate.safeguard.lexicon import FUNCTION
from mitigate.safeguard.plain_words import PHRASES, plain_form
from mitigate.safeguard.speech import STOP

# verbs by which one goes by a thing -> the way; and the words for it behind any verb of motion
_STEPS = {
    "through": "traverse", "past": "pass passes passing bypass bypassing skirt skirting",
    "into": "enter enters entering access accessing",
    "out": "exit exits exiting leave leaves leaving quit depart departing vacate evacuate egress",
    "up": "climb climbs climbing ascend ascending mount", "down": "descend descending",
    "across": "cross crosses crossing", "along": "follow follows following",
    "towards": "approach approaching", "around": "circle circling",
}  # fmt: skip
_WAYS = {
    "through": "through thru via", "past": "past beyond by", "into": "into inside in",
    "out": "out outside from", "up": "up upstairs upwards upward",
    "down": "down downstairs downwards downward", "around": "around round", "across": "across over",
    "along": "along", "between": "between", "under": "under beneath underneath",
    "behind": "behind", "onto": "onto",
}  # fmt: skip
STEP = {word: way for way, words in _STEPS.items() for word in words.split()}
WAY = {word: way for way, words in _WAYS.items() for word in words.split()} | STEP
# ways of which one may be said for the other
_SAME = frozenset(
    frozenset(pair.split())
    for pair in (
        "up along", "down along", "onto into", "onto up", "onto across", "onto out", "into through",
        "across through", "along through",
    )
)  # fmt: skip
_AT = bag("in inside outside by from")  # where a thing is, unless a verb of motion stands before
_MOVES = (
    MOTION
    | TURN_VERBS
    | bag(
        """
        hop get gets getting slip duck trot dash scoot stride pace march amble saunter meander
        wandering mosey coming venture journey travel relocate roll drive run jog tiptoe squeeze
        nip cut zip pad aim return progress strolling stepping moves goes walks heads heading
        maneuver manoeuvre transit back backing swing ease edge zoom dart breeze
        """
    )
) - STEP.keys()
_TURNS = TURN_VERBS | bag(
    "take taking make making go going head heading cut curve bend round move walk step face facing "
    "keep rotation turn-off angle orient reorient spin spinning execute perform effect"
)
_SIDES = bag("left right around round back leftward rightward leftwards rightwards about")
_BEFORE_SIDE = bag(
    "to the your a sharp sharply slight slightly hard immediately immediate first second third next "
    "another all way completely fully ninety 90 degrees degree degress quarter gentle gently once"
)
_DOORS = bag(
    "door doors doorway doorways archway arch gate entrance opening exit entry doorframe threshold "
    "passage passageway hallway hall corridor"
)
_OTHERS = bag("i he she they people somebody someone who which that anybody everyone we'd it")
_PRONOUNS = bag("it them that those these this there one ones both")
_DENIALS = bag(
    "not never don't dont doesn't didn't can't cannot won't isn't aren't wasn't shouldn't mustn't "
    "needn't n't forget avoid ignore disregard skip without unless if instead rather except nor "
    "neither attention alone"
)
_NO_DENIAL = re.compile(
    r"(?:do not|don't|never|not to) (?:forget|worry|hesitate|mind|fret|panic)|if (?:you|i) (?:will|would|"
    r"please|may|might|could|don't|do not|like|wish|can)\b|if (?:needed|possible|necessary|that)|"
    r"not (?:far|long|only|yet|at all|too|very|quite|sure)|can't miss|don't you\b|not a problem"
)
_STOPS = bag(
    "stop stops stopping halt halts halting wait waits waiting pause pauses pausing rest remain "
    "remaining stay stand hold await awaiting finish cease terminate park"
)
_QUOTES = frozenset("'\"“”‘’`")
_DIRECTION = re.compile(r"(?<![^ ])in the direction of(?= )")
_MARKS = frozenset(".,;:!?-–—()\"“”")
_DANGLING = bag(
    "the a an your and or of with into from not towards between my its to is are this they we i "
    "beside near for"
)
_DETERMINERS = bag("the a an your my its")
_OF = bag("in of at with")
_SUBJECTS = bag("you they we i")
_TO = bag("to towards toward for")
_TURN_OF = bag("next second third fourth last other opposite first")
_ROOMS = _DOORS | bag("room rooms bedroom bathroom floor level one stairs landing")
_PLACES = bag("on at to it's is")
_SEEKS = bag(
    "track tracking hunt hunting localize localise detect identify acquire discover seek spot look "
    "looking search searching find finding fetch locate where's"
)
_MANNER = bag("direction order front manner line way parallel")  # "in this manner" leads nowhere
_EXITS = bag("exit egress entrance entry end")
_SOON = bag("immediately slightly sharply directly")
_HALVES = bag("living dining laundry")  # of the names of rooms
_BARE = bag("go walk turn stop wait continue proceed move head")  # what takes no thing
_VERBS = _MOVES | _TURNS | STEP.keys() | _STOPS | bag(
    "find locate look search reach see keep face stay ignore avoid use open spot seek fetch start "
    "begin have let watch meet hang aim be"
)  # fmt: skip
_GOALS = _STOPS | bag("find locate look search seek spot fetch face")
_ROUNDS = 24  # each gives something back, so there is an end anyway


@dataclass
class _Sentence:
    """A sentence's tokens and what becomes of them."""

    found: Sequence[Token]
    acts: list[int]
    before: list[int]

    def give_back(self, places: Iterable[int]) -> bool:
        """Keep what stands at ``places``, without phrases; return whether anything changed."""
        changed = False
        for place in places:
            if self.acts[place] == DROP or self.before[place]:
                changed = True
                self.before[place] = 0
                if self.acts[place] == DROP:
                    self.acts[place] = KEEP
        return changed

    def kept(self, place: int) -> bool:
        return self.acts[place] != DROP

    def said(self) -> list[tuple[str, int, bool]]:
        """Return the words and marks that would be given on, the token's place (a phrase's: that of
        the token it stands before), and whether it is a phrase's word."""
        made: list[tuple[str, int, bool]] = []
        for place, token in enumerate(self.found):
            if self.before[place]:
                phrase = PHRASES[self.before[place] - 1].split()
                if phrase[-1] != plain_form(token.lower):
                    made += [(word, place, True) for word in phrase]
            if self.kept(place):
                made.append((token.lower, place, False))
        return made

    def end_of_clause(self, place: int) -> int:
        """Return the place of the next mark, or the sentence's end."""
        while place < len(self.found) and self.found[place].lower not in _MARKS:
            place += 1
        return place


def taken_back(found: Sequence[Token], edits: Sequence[Edit]) -> list[Edit]:
    """Return the ``edits`` of a sentence's tokens less those that would harm what it says."""
    made = _Sentence(found, [edit.act for edit in edits], [edit.before for edit in edits])
    if any(made.kept(place) and found[place].is_word for place in range(len(found))) or any(
        made.before
    ):
        _towards(made)
        for _ in range(_ROUNDS):
            if not any([_phrases(made), _denials(made), _steps(made), _stops(made), _pairs(made)]):
                break
        _marks(made)
    return [Edit(act, phrase) for act, phrase in zip(made.acts, made.before, strict=True)]


def _phrases(made: _Sentence) -> bool:
    """Take back phrases that nothing heard backs."""
    heard = {way for _, _, way in _told(made.found)}
    heard |= {WAY[t.lower] for t in made.found if t.lower in WAY}
    changed = False
    for place, number in enumerate(made.before):
        if number and not _backed(made, place, PHRASES[number - 1].split(), heard):
            made.before[place], changed = 0, True
    return changed


def _backed(made: _Sentence, place: int, phrase: Sequence[str], heard: set[str]) -> bool:
    following = [t.lower for p, t in enumerate(made.found) if p >= place and made.kept(p)]
    if "turn" in phrase or phrase[-2:] == ["make", "a"]:
        turning = any(token.lower in _TURNS for token in made.found)
        side = "around" in phrase or _side_first(following)
        if not (turning and side):
            return False
    for word in phrase:
        way = WAY.get(word)
        if way is None or word in ("in", "from", "by"):
            continue
        doors = way in ("through", "into", "out") and set(following[:4]) & _DOORS
        if way not in heard and not doors:
            return False
    return True


def _marks(made: _Sentence) -> None:
    """Keep the hyphen of a word of which both parts are kept ("180-degree"), no other, and no single
    quote."""
    quotes = [p for p, t in enumerate(made.found) if t.text in _QUOTES and made.kept(p)]
    if len(quotes) % 2:
        for place in quotes:
            made.acts[place] = DROP
    for place in range(1, len(made.found) - 1):
        one, mark, other = made.found[place - 1 : place + 2]
        if mark.text == "-" and one.end == mark.start and mark.end == other.start:
            whole = made.kept(place - 1) and made.kept(place + 1)
            made.acts[place], made.before[place] = KEEP if whole else DROP, 0


def _towards(made: _Sentence) -> bool:
    """Say "towards" for "in the direction of"."""
    text, places = _spelled(made.found)
    for match in _DIRECTION.finditer(text):
        first = places[match.start()]
        behind = first + 4
        if behind < len(made.found) and any(made.kept(p) for p in range(behind, made.end_of_clause(behind))):
            made.acts[first:behind], made.before[first:behind] = [DROP] * 4, [0] * 4
            made.before[behind] = NUMBER["towards"]
    return False


def _side_first(words: Sequence[str]) -> bool:
    """Return whether a side comes before anything else that is turned to."""
    for word in words:
        if word in _SIDES:
            return True
        if word not in _BEFORE_SIDE:
            return False
    return False


def _denials(made: _Sentence) -> bool:
    """Give back denials and conditions of which a part is left."""
    changed = False
    text, places = _spelled(made.found)
    excused = {places[m.start()] for m in _NO_DENIAL.finditer(text) if m.start() in places}
    for place, token in enumerate(made.found):
        if token.lower not in _DENIALS or place in excused:
            continue
        first = place
        if token.lower in ("if", "unless"):  # what is so on a condition goes or stays with it
            while first and made.found[first - 1].lower not in _MARKS:
                first -= 1
        elif token.lower in ("attention", "alone"):  # pay no ..., leave that ...
            first = max(0, place - 2)
        last = made.end_of_clause(place)
        if first == place and token.lower in ("if", "unless") and last < len(made.found) - 1:
            last = made.end_of_clause(last + 1)  # what is so then
        scope = range(first, last)
        told = [p for p in scope if p == place or made.found[p].lower not in FUNCTION]
        if len({made.kept(p) for p in told}) > 1:
            changed |= made.give_back(scope)
    return changed


def _spelled(found: Sequence[Token]) -> tuple[str, dict[int, int]]:
    """Return the tokens in lower case with a space between them, and where each begins."""
    text, places = "", {}
    for place, token in enumerate(found):
        places[len(text)] = place
        text += token.lower + " "
    return text, places


def _told(found: Sequence[Token]) -> Iterator[tuple[int, int, str]]:
    """Yield (first place, last place, way) of each step that a sentence tells the agent."""
    for place, token in enumerate(found):
        before = [t.lower for t in found[max(0, place - 2) : place]]
        if before and (before[-1] in _OTHERS or (before[0] in _OTHERS and before[-1] in FUNCTION
                and before[-1] not in ("you", "and", "to"))):  # fmt: skip
            continue
        behind = [t.lower for t in found[place + 1 : place + 4]]
        if token.lower == "following" and behind[:1] and behind[0] in _MARKS | _PRONOUNS:
            continue
        if token.lower in _EXITS and "of" in behind[:2]:
            yield place, place + 1 + behind.index("of"), "end"
        elif token.lower in STEP and (not before or before[-1] not in _DETERMINERS):
            yield place, place, STEP[token.lower]
        elif token.lower in _MOVES and (not before or before[-1] not in _DETERMINERS):
            for at in range(place + 1, min(place + 5, len(found))):
                word = found[at].lower
                if word in _MARKS or word in _MOVES or word in STEP:
                    break
                next_words = [t.lower for t in found[at + 1 : at + 4]]
                if word == "there" or word in _TO and next_words[:1] and next_words[0] in _PRONOUNS:
                    yield place, at + (word != "there"), "there"
                    break
                if word in WAY and word != "from" and not (word == "in" and _MANNER & {*next_words}):
                    yield place, at + (next_words[:1] != [] and next_words[0] in _PRONOUNS), WAY[word]
                    break


def _ordinals(found: Sequence[Token]) -> Iterator[tuple[int, int, str]]:
    """Yield (first place, last place, "which") of each place that is told from others by its turn."""
    for place, token in enumerate(found[:-1]):
        if token.lower in _TURN_OF and found[place + 1].lower in _ROOMS:
            before = [t.lower for t in found[max(0, place - 2) : place]]
            lead = sum(word in _DETERMINERS or word in WAY or word in _PLACES for word in before)
            yield place - lead, place + 1, "which"


def _steps(made: _Sentence) -> bool:
    """Give back steps whose way is not said."""
    told = [*_told(made.found), *_ordinals(made.found)]
    own = {place for first, last, _ in told for place in range(first, last + 1)}
    free = [
        WAY[word]
        for word, place, phrase in made.said()
        if word in WAY and (phrase or (place not in own and word not in _AT))
    ]
    changed = False
    for first, last, way in told:
        span = range(first, last + 1)
        if way == "which" and any(made.kept(p) for p in span):
            continue
        if any(made.kept(p) and WAY.get(made.found[p].lower) == way for p in span):
            changed |= made.found[last].lower in _PRONOUNS and made.give_back(span)
            continue
        match = next((w for w in free if w == way or frozenset((w, way)) in _SAME), None)
        if match is not None:
            free.remove(match)
        else:
            changed |= made.give_back(span)
    return changed


def _stops(made: _Sentence) -> bool:
    """Say "stop" where that is said in other words, or a stop would be lost."""
    if any(word in _STOPS for word, _, _ in made.said()):
        return False
    text, places = _spelled(made.found)
    for match in STOP.finditer(text):
        first = places.get(match.start())
        if first is None or not any(made.kept(p) for p in range(len(made.found))):
            continue
        last = first + match.group().strip().count(" ")
        for place in range(first, min(last + 1, len(made.found))):
            made.acts[place], made.before[place] = DROP, 0
        if last + 1 >= len(made.found):
            return made.give_back(range(first, last + 1))
        made.before[last + 1] = NUMBER["stop"]
        return True
    return False


def _pairs(made: _Sentence) -> bool:
    """Give back what was taken out between words that do not go together without it."""
    said = made.said()
    for (word, place, phrase), (after, behind, other) in zip(said, said[1:], strict=False):
        if place == behind and phrase == other:
            continue
        if behind == place + 1 and not (phrase or other):
            continue  # so it was heard
        if not _clash(made, word, place, phrase, after, behind, other):
            continue
        ahead = behind - 1
        if phrase and ahead >= 0 and made.found[ahead].tag == "ADP" and not made.kept(ahead):
            made.acts[ahead], number = KEEP, made.before[place]
            made.before[place] = 0
            made.before[min(place, ahead)] = number
            return True
        if phrase or other:
            made.before[place if phrase else behind] = 0
            return True
        if made.give_back(range(place + 1, behind)):
            return True
    return _end(made, said)


def _clash(
    made: _Sentence, word: str, place: int, phrase: bool, after: str, behind: int, other: bool
) -> bool:
    """Return whether two words cannot stand side by side."""
    noun = made.found[behind].tag in ("NOUN", "PROPN") and not other
    kind = "" if phrase else made.found[place].tag
    gap = behind - place
    if word in _SIDES and noun or kind == "NOUN" and after in _DETERMINERS and gap <= 3:
        return True
    if kind == "ADJ" and word not in _SIDES and (after in _MARKS or after in _OF or after in WAY):
        return True
    if word in _HALVES and (after in _MARKS or after in FUNCTION):
        return True
    if word in _OF and (plain_form(after) in _BARE or after in STEP or after in _MARKS or after == "straight"):
        return True
    if (phrase or other) and (
        (word in WAY and after in WAY) or (word in _BARE and (after in STEP or after in _MOVES))
    ):
        return True
    if word in _MOVES and after in _MARKS:
        return True
    if after in _SUBJECTS and kind == "NOUN" and _next(made, behind)[:1] in ([], ["."]):
        return True
    if phrase and word == "to" and (after in STEP or after in _MOVES):
        return True
    if word in _SOON and after in _DETERMINERS and _side_first([after, *_next(made, behind)]):
        return True
    word = plain_form(word)
    if word in _DETERMINERS:
        return after in _MARKS or after in FUNCTION and after not in ("other", "same", "next")
    if word in _BARE:
        if plain_form(after) in _BARE:
            return True
        thing = after in _DETERMINERS or (noun and after not in _SIDES)
        return thing
    return word in _DANGLING and after in _MARKS


def _goal(made: _Sentence, words: Sequence[tuple[str, int, bool]]) -> bool:
    """Say "find" where a thing alone is left of what is to be found."""
    sought = [p for p, t in enumerate(made.found) if t.lower in _SEEKS]
    things = [p for _, p, phrase in words if not phrase and made.found[p].tag == "NOUN"]
    if not sought or not things or any(plain_form(w) in _VERBS for w, _, _ in words):
        return False
    first = things[0]
    while first and made.kept(first - 1) and made.found[first - 1].tag in ("DET", "ADJ"):
        first -= 1
    for place in range(first):
        made.acts[place], made.before[place] = DROP, 0
    made.before[first] = NUMBER["find"]
    return True


def _next(made: _Sentence, place: int) -> list[str]:
    return [t.lower for p, t in enumerate(made.found) if p > place and made.kept(p)]


def _end(made: _Sentence, said: Sequence[tuple[str, int, bool]]) -> bool:
    """Give back how a sentence ends, and its verbs if none is left."""
    words = [entry for entry in said if entry[0] not in _MARKS]
    if not words:
        return False
    word, place, phrase = words[0]
    if word in ("of", "than", "which") and place and not phrase and made.give_back(range(place)):
        return True
    if _goal(made, words):
        return True
    word, place, phrase = words[-1]
    if word in _DANGLING and made.give_back(range(place + (not phrase), made.end_of_clause(place + 1))):
        return True
    if words[0][0] in WAY or any(plain_form(w) in _VERBS for w, _, _ in words):
        return False
    steps = [range(first, last + 1) for first, last, _ in _told(made.found)]
    verbs = [[p] for p, t in enumerate(made.found) if t.lower in _GOALS and t.tag != "NOUN"]
    return made.give_back(next(iter([*steps, *verbs]), []))
