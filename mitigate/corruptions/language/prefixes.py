"""The prefix bank: misleading sentences that an attacker puts in front of an instruction.

Kinds of attack never occur in two splits, so a safeguard trained on ``train`` is tested on kinds
that it never saw. This project wrote all sentences; the kinds follow SUITE's list for NavTrust's
malicious prompts.
"""

from __future__ import annotations

from mitigate.corruptions.language.words import read_data

SPLITS = ("train", "validation", "test")
_BANK: dict[str, dict[str, list[str]]] = read_data("prefixes.json")


def prefixes(split: str) -> dict[str, tuple[str, ...]]:
    """Return the sentences of ``split`` ("train", "validation" or "test") by kind of attack.

    Raises ValueError for another split.
    """
    if split not in _BANK:
        raise ValueError(
            f"The prefix bank has no split {split!r}. Choose one of: {', '.join(SPLITS)}; a "
            "safeguard learns from train and is judged on test."
        )
    return {kind: tuple(sentences) for kind, sentences in _BANK[split].items()}
