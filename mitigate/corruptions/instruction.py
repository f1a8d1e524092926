"""Corrupt instructions before an episode begins.

There are five families, as in NavTrust: four styles, capitals, masks, and misleading sentences
before the instruction (black box) or in the agent's system prompt (white box). Each family is a
pure function of (text, severity, key). Severity 0 changes nothing. A higher severity changes all
words that a lower one changes.
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

# part-of-speech tags of words that the family "capitals" may change
SPOKEN = words.bag("NOUN PROPN VERB ADP")
SLIGHT = words.bag(
    "DET AUX CCONJ SCONJ PRON ADJ ADV PART ADP INTJ"
)  # part-of-speech tags of words that the family "masks" may hide
_SLOT = re.compile(
    r"\{\{?\s*(?:instruction|task|goal|command|query|input)\s*\}?\}|<task>|<instruction>",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class NotApplicable:
    """Result of a corruption that does not apply to an agent."""

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
        name: one of INSTRUCTION, except "white_box", which corrupts a system prompt
            (``inject_system_prompt``).
        severity: s in [0, 1]: the probability of a rewrite (styles), the fraction of eligible words
            (capitals, masks), or the fraction of the sampled attack sentences (black box); 0
            returns ``text``.
        key: determines the random numbers; its frame is not used. An integer is used as the seed, a
            string as the episode.
        split: split of the attack sentences: "train", "validation" or "test".
        mask_token: text that replaces a hidden word.
        rewrite: function (text, style) -> text, such as a language model, that replaces the rules
            for styles.
        tagger: method that finds the eligible words: "own" or "spacy".

    Raises:
        ValueError: An argument is invalid, or the text is empty.
    """
    check_name(name, INSTRUCTION)
    severity = check_severity(severity)
    key = as_key(key)
    check_options(split, mask_token, tagger)
    if name == "white_box":
        raise ValueError(
            "'white_box' changes the agent's system prompt, not the instruction: "
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
    """Raise ValueError for an invalid split, mask token or tagger."""
    prefixes(split)
    if not isinstance(mask_token, str) or not mask_token.strip():
        raise ValueError(
            "The mask token is empty: give the agent tokenizer's own, such as [MASK] (BERT) or "
            "<mask> (RoBERTa). A tokenizer that has none takes the default '[MASK]' as text."
        )
    named(tagger)


def is_rewritten(manner: str, severity: float, key: Key) -> bool:
    """Return whether the instruction of this episode is rewritten, with probability s."""
    return uniform(digest(key, manner)) < severity


def inject_system_prompt(
    prompt: str | None, severity: float, key: Key | int | str, split: str = "test"
) -> str | NotApplicable:
    """Insert misleading sentences into ``prompt``, before the placeholder for the task or at the
    end.

    The placeholder is the first ``{instruction}``, ``{task}`` or similar. Severity is the same as
    for "black_box". Without a prompt (None or empty) the result is NotApplicable.

    Raises:
        ValueError: The severity, key or split is invalid.
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
    """Sample one misleading sentence per kind, and return the fraction ``severity`` of them."""
    bank, stream = prefixes(split), digest(key, "prefixes")
    drawn = [
        sentences[int(uniform(stream, index) * len(sentences))]
        for index, sentences in enumerate(bank.values())
    ]
    order = sorted(range(len(drawn)), key=lambda i: uniform(stream, len(drawn) + i))
    count = max(1, math.ceil(severity * len(drawn) - 1e-9))
    return [drawn[i] for i in order[:count]]


def _eligible(text: str, name: str, tagger: str) -> list[Token]:
    """Return the tokens that the family "capitals" (or "masks") may change."""
    candidates = [token for token in named(tagger)(text) if token.is_word]
    if name == "capitalize":
        return [token for token in candidates if token.tag in SPOKEN]
    return [t for t in candidates if t.tag in SLIGHT and not words.is_kept(t.lower)]


def _replaced(
    text: str, eligible: list[Token], severity: float, stream: int, change: Callable[[str], str]
) -> str:
    """Return ``text`` with the fraction ``severity`` of the eligible words changed."""
    order = sorted(range(len(eligible)), key=lambda i: (uniform(stream, i), i))
    chosen = order[: math.floor(severity * len(eligible) + 0.5)]
    for place in sorted(chosen, reverse=True):
        token = eligible[place]
        text = text[: token.start] + change(token.text) + text[token.end :]
    return text
