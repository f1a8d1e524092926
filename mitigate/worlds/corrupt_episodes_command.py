"""Corrupt the instructions of a VLN-CE episode file of any size, R2R-CE, RxR-CE or our own:

``mitigate corrupt_episodes IN OUT corruption=black_box severity=0.5 [seed=0] [split=test]
[tokenizer=vocabulary|NAME] [mask_token=[MASK]] [tagger=own]``

Corruptions (docs/instructions.md): friendly, novice, professional, formal, capitalize, mask,
black_box. ``split`` is for black_box, ``mask_token`` for mask, ``tagger`` for capitalize and mask.

``instruction_text`` is changed and the old text kept as ``original_text``. Tokens are made again
for the tokenizer named (``vocabulary``: the file's own ``instruction_vocab``; else a folder or hub
name for transformers), or removed with a notice: an agent that reads stale tokens hears the clean
words. Instructions in other languages than English, and those without a word, pass through and are
counted. Beside OUT comes ``OUT.summary.json``; an OUT that is there without one is left alone.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from mitigate.core.arguments import asks_help, paths_and_options
from mitigate.corruptions.language.text import passed_through
from mitigate.worlds.corrupted_episodes import NAMES, USES, check_for_file, run

ALIAS = "family"  # of corruption=, in older command lines
OPTIONS: dict[str, Callable[[str], Any]] = {
    "corruption": str,
    ALIAS: str,
    "severity": float,
    "seed": int,
    "split": str,
    "tokenizer": str,
    "mask_token": str,
    "tagger": str,
}


def _options(given: Mapping[str, str]) -> dict[str, Any]:
    """Options in their types; ValueError names the choices, and what has no effect."""
    if ALIAS in given and "corruption" in given:
        raise ValueError(f"{ALIAS}= is another word for corruption=: give one of the two.")
    options: dict[str, Any] = {}
    for key, value in given.items():
        try:
            options["corruption" if key == ALIAS else key] = OPTIONS[key](value)
        except ValueError as error:
            kind = "a whole number" if OPTIONS[key] is int else "a number"
            raise ValueError(f"{key} must be {kind}, but {value!r} was given.") from error
    for key, example in (("corruption", "black_box"), ("severity", "0.5")):
        if key not in options:
            raise ValueError(
                f"The option {key} is missing: add {key}={example}. Corruptions: "
                f"{', '.join(NAMES)}."
            )
    name = options["corruption"]
    check_for_file(name)
    for key in options:
        users = [user for user, used in USES.items() if key in used]
        if users and name not in users:
            raise ValueError(
                f"{key}= has no effect on {name}: it is for {' and '.join(users)}. Leave it out."
            )
    return options


def notices(summary: dict[str, Any]) -> list[str]:
    """Return what a user must know of a finished file."""
    told = []
    if not summary["episodes"]:
        told.append("warning: the file holds no episode")
    if summary["skipped_languages"]:
        told.append(f"warning: {passed_through(summary['skipped_languages'])}")
    if summary["blank"]:
        told.append(
            f"warning: {summary['blank']} instructions hold no word and passed through unchanged"
        )
    removed = summary["tokens"].get("removed", 0)
    if removed:
        told.append(
            f"notice: instruction_tokens of {removed} changed instructions were removed, because "
            "they are of the clean words; an agent that reads tokens needs tokenizer=vocabulary "
            "(the file's own) or tokenizer=NAME (its own)"
        )
    cut = summary["tokens"].get("cut_short", 0)
    if cut:
        told.append(f"warning: {cut} instructions have more tokens than the file's rows; cut short")
    return told


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for a bad input)."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if asks_help(arguments):
        print(__doc__)
        return 0 if arguments else 2
    try:
        (source, out), given = paths_and_options(arguments, ("IN", "OUT"), OPTIONS)
        summary = run(source, out, **_options(given))
    except (OSError, ValueError) as error:
        print(f"corrupt_episodes: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\ninterrupted: nothing was written", file=sys.stderr)
        return 130
    print(json.dumps(summary, indent=2, ensure_ascii=False))
    print("\n".join(notices(summary)), file=sys.stderr)
    return 0
