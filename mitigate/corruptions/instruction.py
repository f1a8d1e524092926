"""Instruction corruptions: what can happen to the words before an episode begins.

Five families after NavTrust: style (four manners), capitals, masks, misleading prefixes in front of
the instruction (black box) and in the agent's system prompt (white box). Each is a pure function of
(text, severity, key). Severity 0 changes nothing; what one severity changes, a higher one does too.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from mitigate.corruptions.keying import Key, as_key, digest, uniform
from mitigate.corruptions.language import words
from mitigate.corruptions.language.prefixes import prefixes
from mitigate.corruptions.language.style import MANNERS, Rewrite, restyle
from mitigate.corruptions.language.tagger import Token, named
from mitigate.corruptions.language.text import check_text
from mitigate.corruptions.suite import INSTRUCTION, check_name, check_severity

SPOKEN = words.bag("NOUN PROPN VERB ADP")  # what capitals stress
SLIGHT = words.bag("DET AUX CCONJ SCONJ PRON ADJ ADV PART ADP INTJ")  # what masks may hide
_SLOT = re.compile(
    r"\{\{?\s*(?:instruction|task|goal|command|query|input)\s*\}?\}|<task>|<instruction>",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class NotApplicable:
    """What a corruption that an agent cannot suffer gives instead of a result."""

    name: str
    reason: str


def corrupt_instruction(
    text: str,
    name: str,
    severity: float,
    key: Key | int | str,
    *,
    split: str = "test",
    mask_token: str = "[MASK]",
    rewrite: Rewrite | None = None,
    tagger: str = "own",
) -> str:
    """Corrupt the words of one instruction.

    Args:
        text: the instruction, in English.
        name: one of INSTRUCTION but "white_box", which corrupts a prompt: ``inject_system_prompt``.
        severity: s in [0, 1]: the probability of a rewrite (styles), the share of eligible words
            (capitals, masks), the share of the prefix bank (black box); 0 returns ``text``.
        key: names the random draw; its frame is not used. A whole number is a seed, a text an
            episode.
        split: of the prefix bank: "train", "validation" or "test".
        mask_token: what stands for a hidden word.
        rewrite: (text, manner) -> text, a language model in place of the rules for styles.
        tagger: what finds the eligible words, "own" or "spacy".

    Raises ValueError for a wrong name, severity, key, split, mask token or tagger, and for an empty
    text.
    """
    check_name(name, INSTRUCTION)
    severity = check_severity(severity)
    key = as_key(key)
    check_options(split, mask_token, tagger)
    if name == "white_box":
        raise ValueError(
            "'white_box' leaves the instruction as it is and corrupts the agent's system prompt: "
            "call inject_system_prompt(prompt, severity, key). For an agent without a prompt it is "
            "not applicable; 'black_box' puts the same sentences in front of the instruction."
        )
    check_text(text)
    if severity == 0.0:
        return text
    if name in MANNERS:
        rewritten = is_rewritten(name, severity, key)
        return restyle(text, name, key, rewrite).text if rewritten else text
    if name == "capitalize":
        return _replaced(
            text, _eligible(text, name, tagger), severity, digest(key, name), str.upper
        )
    if name == "mask":
        return _replaced(
            text, _eligible(text, name, tagger), severity, digest(key, name), lambda _: mask_token
        )
    return " ".join((*stacked(severity, key, split), text))


def check_options(split: str, mask_token: str, tagger: str) -> None:
    """Raise ValueError for a split, a mask token or a tagger that is none."""
    prefixes(split)
    if not isinstance(mask_token, str) or not mask_token.strip():
        raise ValueError(
            "The mask token is empty: give the agent tokenizer's own, such as [MASK] (BERT) or "
            "<mask> (RoBERTa). A tokenizer that has none takes the default '[MASK]' as text."
        )
    named(tagger)


def is_rewritten(manner: str, severity: float, key: Key) -> bool:
    """Return whether the episode of ``key`` is among the share ``severity`` said in a manner."""
    return uniform(digest(key, manner)) < severity


def inject_system_prompt(
    prompt: str | None, severity: float, key: Key | int | str, split: str = "test"
) -> str | NotApplicable:
    """Return ``prompt`` with misleading sentences in front of its task slot, or at its end.

    The slot is the first ``{instruction}``, ``{task}`` or the like. Severity is as for "black_box".
    An agent without a prompt (None or empty) gives NotApplicable, never a clean result.
    Raises ValueError for a wrong severity, key or split.
    """
    severity, key = check_severity(severity), as_key(key)
    if not prompt:
        return NotApplicable("white_box", "the agent has no system prompt")
    if severity == 0.0:
        return prompt
    added = " ".join(stacked(severity, key, split))
    slot = _SLOT.search(prompt)
    if slot is None:
        return f"{prompt.rstrip()}\n{added}"
    return f"{prompt[: slot.start()]}{added}\n{prompt[slot.start() :]}"


def stacked(severity: float, key: Key, split: str) -> list[str]:
    """Return the sentences in front: of each kind one, drawn by key; the share ``severity``."""
    bank, stream = prefixes(split), digest(key, "prefixes")
    drawn = [
        sentences[int(uniform(stream, index) * len(sentences))]
        for index, sentences in enumerate(bank.values())
    ]
    order = sorted(range(len(drawn)), key=lambda i: uniform(stream, len(drawn) + i))
    count = max(1, math.ceil(severity * len(drawn) - 1e-9))
    return [drawn[i] for i in order[:count]]


def _eligible(text: str, name: str, tagger: str) -> list[Token]:
    """Return the tokens that capitals or masks may change."""
    found = [token for token in named(tagger)(text) if token.is_word]
    if name == "capitalize":
        return [token for token in found if token.tag in SPOKEN]
    return [t for t in found if t.tag in SLIGHT and not words.is_kept(t.lower)]


def _replaced(
    text: str, eligible: list[Token], severity: float, stream: int, change: Callable[[str], str]
) -> str:
    """Return ``text`` with the share ``severity`` of the eligible words changed."""
    order = sorted(range(len(eligible)), key=lambda i: (uniform(stream, i), i))
    chosen = order[: math.floor(severity * len(eligible) + 0.5)]
    for place in sorted(chosen, reverse=True):
        token = eligible[place]
        text = text[: token.start] + change(token.text) + text[token.end :]
    return text
