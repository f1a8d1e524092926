"""What the four manners say: clause patterns, the templates for each, frames, openers, nouns.

Templates begin with a bare verb, so that a frame such as "you'll want to {}" fits each of them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from mitigate.corruptions.language.clauses import COMMANDS

BARE_VERB = (
    rf"(?:just |simply |slowly |carefully |immediately |directly )?(?:{COMMANDS}|execute|perform|"
    r"effect|pop|hop|scoot|stroll|wander|cruise|mosey|depart|vacate|withdraw|cease|maintain|transit|"
    r"egress|transition|reorient|reverse|betake|carry)\b"
)
_WALK = (
    r"(?:walk|go|head|proceed|continue|move|travel|advance|come|run|step|keep (?:going|walking)|"
    r"make your way|continue (?:walking|going))"
)
_TAIL = (
    r"(?P<rest>|,.*|\s(?:at|into|onto|in|and|through|toward|towards|to|before|after|when|once|past|"
    r"down|up|by|on|out|from|around|again|then|there|until|along|as|just|immediately|across|onto|"
    r"next|where|so|for|between|behind|under|over)\b.*)$"
)


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(text, re.IGNORECASE | re.DOTALL)


PATTERNS = {
    "around": _pattern(
        r"^(?:turn(?: all the way| completely)? (?:around|back the other way|back)|make a u-turn|"
        r"make a full turn and go back|make a turn and go back|turn 180 degrees|do a 180|"
        r"go back the other way)" + _TAIL.replace("to|", "").replace("into|", "")
    ),
    "turn": _pattern(
        r"^(?:turn|take|make|bear|veer|go|head|hang|walk|move)(?: your)?(?: an?)?"
        r"(?: (?P<how>slight|slightly|sharp|sharply|hard|immediate|quick))?"
        r"(?: turn)?(?: to)?(?: the| your)? (?P<side>left|right)(?: turn)?" + _TAIL
    ),
    "climb": _pattern(
        rf"^(?:{_WALK}|climb) up (?P<thing>(?:the |a |these |those |this )?(?:[\w-]+ ){{0,3}}"
        r"(?:stairs|steps|staircase|stairway))(?P<rest>\b.*)$"
    ),
    "descend": _pattern(
        rf"^(?:{_WALK}|climb) down (?P<thing>(?:the |a |these |those |this )?(?:[\w-]+ ){{0,3}}"
        r"(?:stairs|steps|staircase|stairway))(?P<rest>\b.*)$"
    ),
    "past": _pattern(rf"^(?:{_WALK} (?:right )?past|pass(?: by)?) (?P<rest>(?!through)\S.*)$"),
    "through_to": _pattern(rf"^{_WALK} through to (?P<rest>\S.*)$"),
    "through": _pattern(rf"^(?:{_WALK}|pass) through (?P<rest>(?!to\b)\S.*)$"),
    "enter": _pattern(rf"^(?:enter|{_WALK} (?:into|inside)) (?P<rest>(?!(?:and|to|then)\b)\S.*)$"),
    "exit_by": _pattern(
        rf"^(?:exit|leave|{_WALK} out|{_WALK} outside) (?P<by>through|via|from|by|onto|into|to|"
        r"towards?) (?P<rest>\S.*)$"
    ),
    "exit": _pattern(
        rf"^(?:exit|leave|{_WALK} out of) "
        r"(?P<rest>(?!(?:and|to|through|via|from|out|then|by|onto|into|towards?|at|on|in|when)\b)(?!.*\bout\b)\S.*)$"
    ),
    "ahead": _pattern(
        rf"^{_WALK} (?P<straight>straight ahead|straight forward|straight|forward|ahead)" + _TAIL
    ),
    "toward": _pattern(
        rf"^{_WALK} (?:over |all the way )?(?P<to>to|towards|toward) "
        r"(?P<rest>(?!your|the left|the right)\S.*)$"
    ),
    "along": _pattern(
        rf"^{_WALK} (?P<along>along|across|down|around|between|up|onto|over|beside|behind|under|"
        r"out|in) (?P<rest>\S.*)$"
    ),
    "stop": _pattern(r"^(?:stop|wait|halt|pause)(?: there| here)?(?P<rest>|[ ,].*)$"),
}


@dataclass(frozen=True)
class Voice:
    """How one manner speaks: templates by kind of clause, frames by place, openers and closers."""

    openers: tuple[str, ...]
    frames: dict[str, tuple[str, ...]]
    commands: dict[str, tuple[str, ...]]
    closers: tuple[str, ...]
    nouns: dict[str, str]


def swap_nouns(text: str, nouns: dict[str, str]) -> str:
    """Return ``text`` with the nouns of a manner in place of their synonyms."""
    names = sorted(nouns, key=len, reverse=True)
    return re.sub(rf"\b({'|'.join(names)})\b", lambda m: nouns[m.group()], text)


VOICES = {
    "friendly": Voice(
        openers=("Hey there!", "Hi friend!", "Hello hello!", "Okay, let's get you there!",
            "Hey, happy to help!", "Hiya, lovely to meet you!"),
        frames={
            "first": ("So, {}", "Go ahead and {}", "To get going, {}", "You'll want to {}",
                "Just {}", "Let's begin: {}"),
            "middle": ("Then {}", "After that, {}", "Now {}", "And then just {}",
                "From there, {}", "You'll want to {}", "Okay, now {}", "Then go ahead and {}"),
            "last": ("And finally, {}", "Then {}, and that's it!", "Now {}, easy as that!",
                "To finish off, {}", "And then {}, if you would"),
            "when": ("just {}", "go ahead and {}", "you can {}", "{}"),
        },
        commands={
            "around": ("swing all the way around{rest}", "turn yourself around{rest}",
                "spin around{rest}"),
            "turn": ("swing {how} to your {side}{rest}", "hang a {how} {side}{rest}",
                "take a nice {how} {side}{rest}", "scoot {how} to the {side}{rest}"),
            "climb": ("pop up {thing}{rest}", "hop on up {thing}{rest}", "scoot up {thing}{rest}"),
            "descend": ("pop down {thing}{rest}", "wander down {thing}{rest}",
                "scoot down {thing}{rest}"),
            "past": ("stroll past {rest}", "wander on past {rest}", "cruise past {rest}"),
            "through": ("pop through {rest}", "stroll through {rest}", "wander through {rest}"),
            "through_to": ("pop through to {rest}", "stroll through to {rest}"),
            "exit_by": ("pop out {by} {rest}", "wander out {by} {rest}"),
            "enter": ("pop into {rest}", "stroll into {rest}", "come on into {rest}"),
            "exit": ("pop out of {rest}", "stroll out of {rest}", "wander out of {rest}"),
            "ahead": ("keep on strolling {straight}{rest}", "wander {straight}{rest}",
                "stroll {straight}{rest}"),
            "toward": ("mosey over {to} {rest}", "stroll over {to} {rest}", "wander {to} {rest}"),
            "along": ("stroll {along} {rest}", "wander {along} {rest}", "cruise {along} {rest}"),
            "stop": ("wait for me{rest}", "stop for a breather{rest}", "stop right there{rest}"),
        },
        closers=("You've got this!", "See you soon!", "Have fun!", "Thanks a bunch!", "", ""),
        nouns={"sofa": "couch", "refrigerator": "fridge", "television": "tv",
            "corridor": "hallway", "staircase": "stairs", "settee": "couch"},
    ),
    "novice": Voice(
        openers=("Okay so, I'm new at this.", "Um, let me try to explain.", "So,", "",
            "Hm, I think it goes like this.", "Let me try to help."),
        frames={
            "first": ("You {}", "I think you {}", "You just {}", "What you do is you {}"),
            "middle": ("Then you {}", "Next you kind of {}", "And then, um, you {}",
                "After that you {}", "Then I guess you {}", "Then you need to {}"),
            "last": ("And then you {}", "Then you {}, I think", "And to finish, you {}",
                "Then you just {}"),
            "when": ("you {}", "you just {}", "you need to {}", "I guess you {}"),
        },
        commands={
            "around": ("turn all the way around{rest}", "turn yourself around{rest}"),
            "turn": ("go {how} to the {side}{rest}", "turn {how} to the {side} side{rest}",
                "make a {how} {side}{rest}"),
            "climb": ("go up {thing}{rest}", "walk up {thing}{rest}"),
            "descend": ("go down {thing}{rest}", "walk down {thing}{rest}"),
            "past": ("go past {rest}", "walk by and get past {rest}", "keep going past {rest}"),
            "through": ("go through {rest}", "walk through {rest}"),
            "through_to": ("go through to {rest}", "walk through to {rest}"),
            "exit_by": ("go out {by} {rest}", "get out {by} {rest}"),
            "enter": ("go into {rest}", "get into {rest}", "go inside {rest}"),
            "exit": ("go out of {rest}", "get out of {rest}", "walk out of {rest}"),
            "ahead": ("go {straight}{rest}", "keep going {straight}{rest}",
                "walk {straight}{rest}"),
            "toward": ("go over {to} {rest}", "walk {to} {rest}", "get {to} {rest}"),
            "along": ("go {along} {rest}", "walk {along} {rest}"),
            "stop": ("stop{rest}", "stop there{rest}", "stop walking{rest}"),
        },
        closers=("That should be it.", "I hope that makes sense.", "", "", "I think that's all."),
        nouns={"sofa": "couch", "refrigerator": "fridge", "television": "tv",
            "corridor": "hallway", "staircase": "stairs", "settee": "couch"},
    ),
    "professional": Voice(
        openers=("Navigation procedure:", "Route guidance as follows.", "Commence navigation.",
            "Task briefing:", "Please execute the route below.", ""),
        frames={
            "first": ("Initially, {}", "To commence, {}", "{}", "At the outset, {}"),
            "middle": ("Subsequently, {}", "Thereafter, {}", "{}", "Upon completion, {}",
                "Following this, {}", "At that juncture, {}"),
            "last": ("In conclusion, {}", "Finally, {}", "To complete the task, {}",
                "Ultimately, {}"),
            "when": ("{}",),
        },
        commands={
            "around": ("execute a full turn{rest}", "reverse course{rest}",
                "perform a u-turn{rest}"),
            "turn": ("execute a {how} {side} turn{rest}", "perform a {how} {side} turn{rest}",
                "reorient {how} to the {side}{rest}"),
            "climb": ("ascend {thing}{rest}", "proceed up {thing}{rest}"),
            "descend": ("descend {thing}{rest}", "proceed down {thing}{rest}"),
            "past": ("proceed past {rest}", "advance past {rest}", "navigate past {rest}"),
            "through": ("traverse {rest}", "transit through {rest}", "proceed through {rest}"),
            "through_to": ("proceed through to {rest}", "advance through to {rest}"),
            "exit_by": ("exit {by} {rest}", "egress {by} {rest}"),
            "enter": ("proceed into {rest}", "transition into {rest}", "move into {rest}"),
            "exit": ("depart {rest}", "vacate {rest}", "egress from {rest}"),
            "ahead": ("advance {straight}{rest}", "maintain a course {straight}{rest}",
                "proceed {straight}{rest}"),
            "toward": ("navigate {to} {rest}", "advance {to} {rest}", "proceed {to} {rest}"),
            "along": ("navigate {along} {rest}", "advance {along} {rest}",
                "proceed {along} {rest}"),
            "stop": ("halt{rest}", "cease movement and halt{rest}", "come to a halt{rest}"),
        },
        closers=("", "", "End of procedure.", "End of briefing."),
        nouns={"hallway": "corridor", "hall": "corridor", "fridge": "refrigerator",
            "tv": "television", "TV": "television", "bathroom": "restroom", "couch": "sofa",
            "bookshelf": "bookcase"},
    ),
    "formal": Voice(
        openers=("Good day.", "Dear Sir or Madam,", "Esteemed colleague,", "", "Greetings.",
            "With your permission, the route is as follows."),
        frames={
            "first": ("Kindly {}", "You are kindly requested to {}", "May I ask you to {}",
                "Please be so good as to {}"),
            "middle": ("Next, please {}", "You are then requested to {}",
                "Thereafter, kindly {}", "After this, please {}", "You should then {}",
                "It is then advisable to {}"),
            "last": ("In closing, you may {}", "Finally, you are requested to {}",
                "To conclude, kindly {}", "To end, please be so kind as to {}"),
            "when": ("kindly {}", "please {}", "you are requested to {}", "you should {}"),
        },
        commands={
            "around": ("turn fully around{rest}", "reverse your course{rest}"),
            "turn": ("turn {how} towards the {side}{rest}",
                "effect a {how} turn to the {side}{rest}",
                "make a {how} turn to your {side}{rest}"),
            "climb": ("ascend {thing}{rest}", "make your ascent of {thing}{rest}"),
            "descend": ("descend {thing}{rest}", "make your way down {thing}{rest}"),
            "past": ("proceed past {rest}", "continue on your way past {rest}"),
            "through": ("pass through {rest}", "make your way through {rest}"),
            "through_to": ("make your way through to {rest}", "proceed through to {rest}"),
            "exit_by": ("make your way out {by} {rest}", "depart {by} {rest}"),
            "enter": ("enter into {rest}", "make your way into {rest}", "proceed into {rest}"),
            "exit": ("depart from {rest}", "take your leave of {rest}", "withdraw from {rest}"),
            "ahead": ("proceed {straight}{rest}", "carry on {straight}{rest}"),
            "toward": ("make your way {to} {rest}", "betake yourself {to} {rest}",
                "proceed {to} {rest}"),
            "along": ("make your way {along} {rest}", "proceed {along} {rest}"),
            "stop": ("come to a halt{rest}", "stop and wait{rest}", "halt{rest}"),
        },
        closers=("Your cooperation is appreciated.", "With sincere thanks.", "", ""),
        nouns={"hallway": "corridor", "hall": "corridor", "fridge": "refrigerator",
            "tv": "television", "TV": "television", "sofa": "settee", "couch": "settee",
            "living room": "sitting room", "bathroom": "washroom"},
    ),
}  # fmt: skip
