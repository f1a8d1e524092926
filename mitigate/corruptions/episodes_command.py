"""Corrupt the instructions of a VLN-CE episode file of any size, R2R-CE, RxR-CE or our own:

``mitigate corrupt_episodes IN OUT family=black_box severity=0.5 [seed=0] [split=test]
[tokenizer=vocabulary|NAME] [mask_token=[MASK]] [tagger=own]``

Families (docs/instructions.md): friendly, novice, professional, formal, capitalize, mask, black_box

``instruction_text`` is changed and the old text kept as ``original_text``. Tokens are made again
for the tokenizer named (``vocabulary``: the file's own ``instruction_vocab``; else a folder or hub
name for transformers), or removed with a notice: an agent that reads stale tokens hears the clean
words. Instructions in other languages than English pass through and are counted. Beside OUT comes
``OUT.summary.json``.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tqdm import tqdm

from mitigate.core.arguments import asks_help, paths_and_options
from mitigate.core.files import atomic_text
from mitigate.corruptions import INSTRUCTION, SUITE_VERSION, Key, corrupt_instruction
from mitigate.corruptions.instruction import check_text, is_rewritten
from mitigate.corruptions.language.english import is_english, passed_through
from mitigate.corruptions.language.style import MANNERS, Rewrite, restyle
from mitigate.corruptions.language.tokens import VOCABULARY, Tokenizer, tokenizer_for
from mitigate.corruptions.suite import check_name, check_severity
from mitigate.worlds.episodes import Episode, read_episodes, read_extras, write_episodes

ORIGINAL = "original_text"  # where the clean text is kept
STALE = ("timed_instruction",)  # RxR: the clean words again, with their times
OPTIONS: dict[str, Callable[[str], Any]] = {
    "family": str,
    "severity": float,
    "seed": int,
    "split": str,
    "tokenizer": str,
    "mask_token": str,
    "tagger": str,
}


@dataclass
class Counts:
    """What happened to the episodes of a file."""

    episodes: int = 0
    changed: int = 0
    skipped_languages: Counter = field(default_factory=Counter)
    tokens: Counter = field(default_factory=Counter)
    gate: Counter = field(default_factory=Counter)


def run(
    source: Path | str,
    out: Path | str,
    family: str,
    severity: float,
    *,
    seed: int = 0,
    split: str = "test",
    tokenizer: str | None = None,
    mask_token: str | None = None,
    tagger: str = "own",
    rewrite: Rewrite | None = None,
) -> dict[str, Any]:
    """Corrupt the file ``source`` into ``out`` and return the summary that is written beside it.

    Args: family: one of INSTRUCTION but "white_box". seed: with the episode id, the key of each
    draw, as in an evaluation. tokenizer: see above. The others are those of
    ``corrupt_instruction``; the mask token is by default the tokenizer's own, else "[MASK]".

    Raises ValueError or FileNotFoundError for wrong options or files; then ``out`` is untouched.
    """
    check_name(family, INSTRUCTION)
    severity = check_severity(severity)
    if family == "white_box":
        raise ValueError(
            "family=white_box is not applicable to a file: it corrupts the system prompt of an "
            "agent, which no episode holds. Evaluate an agent that has one, or use "
            "family=black_box."
        )
    _check_target(source, out)
    extras = read_extras(source)
    words = tokenizer_for(tokenizer, extras) if tokenizer else None
    mask = mask_token if mask_token is not None else (words and words.mask_token) or "[MASK]"
    counts = Counts()

    def corrupted(episode: Episode) -> str:
        key, text = Key(seed, episode.episode_id), episode.instruction.text
        if family in MANNERS:
            check_text(text)
            return _restyled(text, family, severity, key, rewrite, counts.gate)
        return corrupt_instruction(
            text, family, severity, key, split=split, mask_token=mask, tagger=tagger
        )

    episodes = tqdm(read_episodes(source, hidden_goals=True), unit="episode", disable=None)
    other_words = words is not None and tokenizer != VOCABULARY
    write_episodes(out, _changed(episodes, corrupted, words, counts, other_words), extras)
    settings = {
        "source": str(source),
        "family": family,
        "severity": severity,
        "seed": seed,
        "split": split,
        "suite": SUITE_VERSION,
        "tokenizer": tokenizer,
        "mask_token": mask,
        "tagger": tagger,
    }
    return _summarised(settings, counts, out)


def _check_target(source: Path | str, out: Path | str) -> None:
    if Path(out).resolve() == Path(source).resolve():
        raise ValueError(f"{out} is the file that is read: give the corrupted one another name.")
    if Path(out).is_dir():
        raise ValueError(f"{out} is a folder: name the file to write in it.")


def _summarised(settings: dict[str, Any], counts: Counts, out: Path | str) -> dict[str, Any]:
    """Write the summary of what was done beside ``out``, and return it."""
    summary = {
        **settings,
        "episodes": counts.episodes,
        "changed": counts.changed,
        "skipped_languages": dict(counts.skipped_languages),
        "tokens": dict(counts.tokens),
    }
    if settings["family"] in MANNERS:
        summary["gate"] = _rates(counts.gate)
    with atomic_text(f"{out}.summary.json") as file:
        json.dump(summary, file, indent=2, ensure_ascii=False)
        file.write("\n")
    return summary


def _changed(
    episodes: Iterator[Episode],
    corrupted: Callable[[Episode], str],
    words: Tokenizer | None,
    counts: Counts,
    every: bool,
) -> Iterator[Episode]:
    """Yield the episodes with their instructions corrupted, one at a time.

    ``every``: also instructions that stay as they are get the tokens of ``words``, whose
    vocabulary is not the file's.
    """

    def unchanged(episode: Episode) -> Episode:
        if not every:
            return episode
        said = episode.instruction
        tokens = _tokens(said.text, said.tokens, words, counts.tokens)
        return replace(episode, instruction=replace(said, tokens=tokens))

    for episode in episodes:
        counts.episodes += 1
        instruction = episode.instruction
        if not is_english(instruction.language):
            counts.skipped_languages[instruction.language] += 1
            yield unchanged(episode)
            continue
        try:
            text = corrupted(episode)
        except ValueError as error:
            raise ValueError(f"Episode {episode.episode_id}: {error}") from error
        if text == instruction.text:
            yield unchanged(episode)
            continue
        counts.changed += 1
        tokens = _tokens(text, instruction.tokens, words, counts.tokens)
        extra = {key: value for key, value in instruction.extra.items() if key not in STALE}
        counts.tokens["timed_instruction_removed"] += len(instruction.extra) - len(extra)
        extra.setdefault(ORIGINAL, instruction.text)
        yield replace(
            episode, instruction=replace(instruction, text=text, tokens=tokens, extra=extra)
        )


def _tokens(
    text: str, old: Sequence[int] | None, words: Tokenizer | None, counts: Counter
) -> tuple[int, ...] | None:
    """Return the tokens of ``text``, as many as the file had, or None; never those it had."""
    if words is None:
        counts["removed"] += old is not None
        return None
    tokens, cut = words.encode(text, len(old) if old else None)
    counts["remade"] += 1
    counts["cut_short"] += cut
    return tokens


def _restyled(
    text: str, manner: str, severity: float, key: Key, rewrite: Rewrite | None, gate: Counter
) -> str:
    if not is_rewritten(manner, severity, key):
        return text
    found = restyle(text, manner, key, rewrite)
    gate["rewrites"] += 1
    gate["passed_at_once"] += found.passed and found.tries == 1
    gate["passed"] += found.passed
    gate["clauses"] += found.clauses
    gate["clauses_kept"] += found.plain
    return found.text


def _rates(gate: Counter) -> dict[str, Any]:
    rewrites = gate["rewrites"]
    return {
        "rewrites": rewrites,
        "kept_original": rewrites - gate["passed"],
        "pass_rate_first": round(gate["passed_at_once"] / rewrites, 4) if rewrites else None,
        "pass_rate": round(gate["passed"] / rewrites, 4) if rewrites else None,
        "clauses": gate["clauses"],
        "clauses_kept": gate["clauses_kept"],
    }


def _options(given: Mapping[str, str]) -> dict[str, Any]:
    """Options in their types; ValueError names the choices."""
    options: dict[str, Any] = {}
    for key, value in given.items():
        try:
            options[key] = OPTIONS[key](value)
        except ValueError as error:
            raise ValueError(f"{key} must be a number, but {value!r} was given.") from error
    for key, example in (("family", "black_box"), ("severity", "0.5")):
        if key not in options:
            families = ", ".join(name for name in INSTRUCTION if name != "white_box")
            raise ValueError(
                f"The option {key} is missing: add {key}={example}. Families: {families}."
            )
    return options


def notices(summary: dict[str, Any]) -> list[str]:
    """Return what a user must know of a finished file."""
    told = []
    skipped = summary["skipped_languages"]
    if skipped:
        told.append(f"warning: {passed_through(skipped)}")
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
    print(json.dumps(summary, indent=2, ensure_ascii=False))
    print("\n".join(notices(summary)), file=sys.stderr)
    return 0
