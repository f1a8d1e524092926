"""Corrupt instructions before an episode begins.

There are five families of corruptions, as in NavTrust: (1) four styles, (2) capitals, (3) masks,
(4) misleading sentences before the instruction (black box), (5) misleading sentences in the agent's
system prompt (white box). Each family is a pure function of (text, severity, key). Severity 0
changes nothing. Words that change at one severity also change at every higher severity.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from mitigate.corruptions.keying import Key, as_key, digest, uniform
from mitigate.corruptions.language import words
from mitigate.corruptions.language.style import MANNERS, Rewrite, restyle
from mitigate.corruptions.language.tagger import Token, named
from mitigate.corruptions.language.text import check_text
from mitigate.corruptions.suite import INSTRUCTION, check_name, check_severity

# part-of-speech tags of words that "capitalize" may change
SPOKEN = words.bag("NOUN PROPN VERB ADP")
# part-of-speech tags of words that "mask" may hide
SLIGHT = words.bag("DET AUX CCONJ SCONJ PRON ADJ ADV PART ADP INTJ")
# Misleading sentences by split and kind of attack. No kind of attack occurs in two splits, so a
# safeguard that is trained on "train" is tested on new kinds. All sentences were written for this
# project; the kinds of attack follow NavTrust's malicious prompts.
SPLITS = ("train", "validation", "test")
_BANK: dict[str, dict[str, list[str]]] = words.read_data("prefixes.json")
_SLOT = re.compile(
    r"\{\{?\s*(?:instruction|task|goal|command|query|input)\s*\}?\}|<task>|<instruction>",
    re.IGNORECASE,
)


def prefixes(split: str) -> dict[str, tuple[str, ...]]:
    """Return the misleading sentences of ``split`` (one of ``SPLITS``) by kind of attack.

    Raises:
        ValueError: If ``split`` is unknown.
    """
    if split not in _BANK:
        raise ValueError(
            f"split must be one of {', '.join(SPLITS)}, got {split!r}. Safeguards are trained on "
            "train and evaluated on test."
        )
    return {kind: tuple(sentences) for kind, sentences in _BANK[split].items()}


@dataclass(frozen=True)
class NotApplicable:
    """The result if a corruption cannot be applied to an agent."""

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
    """Corrupt one instruction.

    Args:
        text: the instruction, in English.
        name: one of INSTRUCTION, except "white_box", which corrupts a system prompt
            (``inject_system_prompt``).
        severity: number from 0 to 1. It is the probability of a rewrite (styles), the fraction of
            eligible words that change (capitals, masks), or the fraction of the sampled attack
            sentences that are used (black box). If it is 0, ``text`` is returned.
        key: determines the random numbers; its frame has no effect. An integer sets only the seed,
            and a string sets only the episode.
        split: split of the attack sentences: "train", "validation" or "test".
        mask_token: text that replaces a hidden word.
        rewrite: function (text, style) -> text that replaces the rules for styles, for example a
            language model.
        tagger: tagger that finds the eligible words: "own" or "spacy".

    Raises:
        ValueError: If an argument is invalid, or the text is empty.
    """
    check_name(name, INSTRUCTION)
    severity = check_severity(severity)
    key = as_key(key)
    check_options(split, mask_token, tagger)
    if name == "white_box":
        raise ValueError(
            "'white_box' changes the agent's system prompt, not the instruction: "
            "call inject_system_prompt(prompt, severity, key). It does not apply to an agent "
            "without a prompt: there, 'black_box' puts the same sentences before the instruction."
        )
    check_text(text)
    if severity == 0.0:
        return text
    if name in MANNERS:
        rewritten = is_rewritten(name, severity, key)
        return restyle(text, name, key, rewrite).text if rewritten else text
    if name in ("capitalize", "mask"):
        change = str.upper if name == "capitalize" else lambda _: mask_token
        return _replaced(text, _eligible(text, name, tagger), severity, digest(key, name), change)
    return " ".join((*stacked(severity, key, split), text))


def check_options(split: str, mask_token: str, tagger: str) -> None:
    """Raise ValueError for an invalid split, mask token or tagger."""
    prefixes(split)
    if not isinstance(mask_token, str) or not mask_token.strip():
        raise ValueError(
            "mask_token must not be empty. Use the mask token of the agent's tokenizer, such as "
            "[MASK] (BERT) or <mask> (RoBERTa). A tokenizer without a mask token reads the default "
            "'[MASK]' as plain text."
        )
    named(tagger)


def is_rewritten(manner: str, severity: float, key: Key) -> bool:
    """Return whether this episode's instruction is rewritten, with probability ``severity``."""
    return uniform(digest(key, manner)) < severity


def inject_system_prompt(
    prompt: str | None, severity: float, key: Key | int | str
) -> str | NotApplicable:
    """Insert misleading sentences into a system prompt.

    The sentences are put before the placeholder for the task, or at the end of a prompt without a
    placeholder. The placeholder is the first ``{instruction}``, ``{task}`` or similar. The
    sentences and ``severity`` are those of "black_box". If ``prompt`` is None or empty, the result
    is NotApplicable.

    Raises:
        ValueError: If the severity or key is invalid.
    """
    severity, key = check_severity(severity), as_key(key)
    if not prompt:
        return NotApplicable("white_box", "the agent has no system prompt")
    if severity == 0.0:
        return prompt
    added = " ".join(stacked(severity, key, "test"))
    slot = _SLOT.search(prompt)
    if slot is None:
        return f"{prompt.rstrip()}\n{added}"
    return f"{prompt[: slot.start()]}{added}\n{prompt[slot.start() :]}"


def stacked(severity: float, key: Key, split: str) -> list[str]:
    """Sample a misleading sentence per kind of attack; return a fraction ``severity`` of them."""
    bank, stream = prefixes(split), digest(key, "prefixes")
    drawn = [
        sentences[int(uniform(stream, index) * len(sentences))]
        for index, sentences in enumerate(bank.values())
    ]
    order = sorted(range(len(drawn)), key=lambda i: uniform(stream, len(drawn) + i))
    count = max(1, math.ceil(severity * len(drawn) - 1e-9))
    return [drawn[i] for i in order[:count]]


def _eligible(text: str, name: str, tagger: str) -> list[Token]:
    """Return the tokens that the corruption ``name`` (capitals or masks) may change."""
    candidates = [token for token in named(tagger)(text) if token.is_word]
    if name == "capitalize":
        return [token for token in candidates if token.tag in SPOKEN]
    return [t for t in candidates if t.tag in SLIGHT and not words.is_kept(t.lower)]


def _replaced(
    text: str, eligible: list[Token], severity: float, stream: int, change: Callable[[str], str]
) -> str:
    """Change a fraction ``severity`` of the eligible words, and return the new text."""
    order = sorted(range(len(eligible)), key=lambda i: (uniform(stream, i), i))
    chosen = order[: math.floor(severity * len(eligible) + 0.5)]
    for place in sorted(chosen, reverse=True):
        token = eligible[place]
        text = text[: token.start] + change(token.text) + text[token.end :]
    return text
