"""Define the answers that a vision-language agent may give, and read them from text.

An answer such as "forward 75 cm" is executed as several equal low-level actions, as in NaVid (Zhang
et al., RSS 2024). The step sizes are the same as in VLN-CE: 25 cm and 15 degrees.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from mitigate.core.names import unknown
from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, STOP, TURN_DEGREES

MOST = 3  # maximum number of low-level actions in an answer: 75 cm or 45 degrees, as in NaVid
# number of characters of an answer that are read (heuristic); the longest answer has 22
LONGEST = 200


class Answer(NamedTuple):
    """An allowed answer of the model."""

    text: str  # such as "forward 75 cm"
    action: int  # the low-level action that the answer stands for
    repeats: int  # how often the action is taken


def _amounts(words: str, action: int, step: float, unit: str) -> list[Answer]:
    counts = range(1, MOST + 1)
    return [Answer(f"{words} {round(step * count)} {unit}", action, count) for count in counts]


ANSWERS: dict[str, tuple[Answer, ...]] = {
    "actions": (
        Answer("stop", STOP, 1),
        Answer("forward", FORWARD, 1),
        Answer("left", LEFT, 1),
        Answer("right", RIGHT, 1),
    ),
    "navid": (
        Answer("stop", STOP, 1),
        *_amounts("forward", FORWARD, 100 * FORWARD_METRES, "cm"),
        *_amounts("turn left", LEFT, TURN_DEGREES, "degrees"),
        *_amounts("turn right", RIGHT, TURN_DEGREES, "degrees"),
    ),
}


def answers_of(style: str) -> tuple[Answer, ...]:
    """Return the answers of ``style``; the first answer is "stop".

    Raises ValueError for an unknown style.
    """
    if style not in ANSWERS:
        raise ValueError(unknown("style of answers (agent.answers)", style, ANSWERS))
    return ANSWERS[style]


def read_answer(text: str, answers: tuple[Answer, ...]) -> Answer | None:
    """Return the answer whose text is exactly ``text``, or None if there is no such answer.

    Case, spaces, and a full stop at the end do not matter. An answer within a longer
    text does not count.
    """
    words = re.sub(r"(?<=\d)(?=[a-z])", " ", text.lower().strip().removesuffix("."))  # "75cm"
    return {answer.text: answer for answer in answers}.get(" ".join(words.split()))


def answer_for(action: int, repeats: int, answers: tuple[Answer, ...]) -> int:
    """Return the index of the answer that repeats ``action`` most, up to ``repeats`` times."""
    fitting = [i for i, a in enumerate(answers) if a.action == action and a.repeats <= repeats]
    return max(fitting, key=lambda index: answers[index].repeats)
