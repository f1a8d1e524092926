"""Load the misleading sentences that an attacker puts before an instruction.

No kind of attack occurs in two splits, so a safeguard that is trained on ``train`` is tested on new
kinds. All sentences were written for this project; the kinds of attack follow NavTrust's malicious
prompts.
"""

from __future__ import annotations

from mitigate.corruptions.language.words import read_data

SPLITS = ("train", "validation", "test")
_BANK: dict[str, dict[str, list[str]]] = read_data("prefixes.json")


def prefixes(split: str) -> dict[str, tuple[str, ...]]:
    """Return the sentences of ``split`` ("train", "validation" or "test") by kind of attack.

    Raises ValueError for an unknown split.
    """
    if split not in _BANK:
        raise ValueError(
            f"split must be one of {', '.join(SPLITS)}, got {split!r}. Safeguards are trained on "
            "train and evaluated on test."
        )
    return {kind: tuple(sentences) for kind, sentences in _BANK[split].items()}
