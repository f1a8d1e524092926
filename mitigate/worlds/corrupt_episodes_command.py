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
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tqdm import tqdm

from mitigate.core.files import atomic_text, read_regular, sha256
from mitigate.core.options import asks_help, paths_and_options
from mitigate.corruptions.instruction import check_options, corrupt_instruction, is_rewritten
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.style import MANNERS, Rewrite, restyle
from mitigate.corruptions.language.text import has_word, is_english, passed_through
from mitigate.corruptions.language.tokens import VOCABULARY, Tokenizer, tokenizer_for
from mitigate.corruptions.suite import INSTRUCTION, SUITE_VERSION, check_name, check_severity
from mitigate.worlds.episodes import Episode, read_episodes, read_extras, write_episodes

ORIGINAL = "original_text"  # key of the clean text
STALE = ("timed_instruction",)  # RxR: the clean words with their times
SUMMARY = ".summary.json"  # suffix of the name of the output file
NAMES = tuple(name for name in INSTRUCTION if name != "white_box")
USES = {"black_box": ("split",), "mask": ("mask_token", "tagger"), "capitalize": ("tagger",)}


@dataclass
class Counts:
    """What happened to the episodes of a file."""

    episodes: int = 0
    changed: int = 0
    blank: int = 0
    skipped_languages: Counter = field(default_factory=Counter)
    tokens: Counter = field(default_factory=Counter)
    gate: Counter = field(default_factory=Counter)


def run(
    source: Path | str,
    out: Path | str,
    corruption: str,
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

    The summary records the options that the corruption uses (``USES``).

    Args:
        source: a VLN-CE episode file.
        out: the file to write.
        corruption: one of ``NAMES``.
        severity: s in [0, 1].
        seed: together with the episode id, the key of each random draw, as in an evaluation.
        split: see ``corrupt_instruction``.
        tokenizer: "vocabulary" for the vocabulary of the file, or a folder or hub name for
            transformers. None removes the tokens of changed instructions.
        mask_token: the default is the mask token of the tokenizer, else "[MASK]".
        tagger: see ``corrupt_instruction``.
        rewrite: see ``corrupt_instruction``.

    Raises:
        ValueError, FileNotFoundError: An option or file is invalid, or ``out`` exists and this
            function did not write it. ``out`` is then unchanged.
    """
    check_for_file(corruption)
    severity = check_severity(severity)
    Key(seed, "0")  # raises ValueError for an invalid seed
    check_options(split, "[MASK]" if mask_token is None else mask_token, tagger)
    _check_target(source, out)
    extras = read_extras(source)
    words = tokenizer_for(tokenizer, extras) if tokenizer else None
    mask = mask_token if mask_token is not None else (words and words.mask_token) or "[MASK]"
    options = {"split": split, "mask_token": mask, "tagger": tagger}
    counts = Counts()

    def corrupted(episode: Episode) -> str:
        key, text = Key(seed, episode.episode_id), episode.instruction.text
        if corruption in MANNERS:
            return _restyled(text, corruption, severity, key, rewrite, counts.gate)
        return corrupt_instruction(
            text, corruption, severity, key, split=split, mask_token=mask, tagger=tagger
        )

    episodes = tqdm(read_episodes(source, hidden_goals=True), unit="episode", disable=None)
    other_words = words is not None and tokenizer != VOCABULARY
    write_episodes(out, _changed(episodes, corrupted, words, counts, other_words), extras)
    settings = {
        "source": str(source),
        "corruption": corruption,
        "severity": severity,
        "seed": seed,
        "suite": SUITE_VERSION,
        "tokenizer": tokenizer,
        **{name: options[name] for name in USES.get(corruption, ())},
    }
    return _summarised(settings, counts, out)


def check_for_file(corruption: str) -> None:
    """Raise ValueError unless ``corruption`` is one of ``NAMES``."""
    if corruption == "white_box":
        raise ValueError(
            "corruption=white_box is not applicable to a file: it corrupts the system prompt of an "
            "agent, which no episode holds. Evaluate an agent that has one, or use "
            "corruption=black_box."
        )
    check_name(corruption, NAMES)


def _check_target(source: Path | str, out: Path | str) -> None:
    if Path(out).resolve() == Path(source).resolve():
        raise ValueError(f"{out} is the file that is read: give the corrupted one another name.")
    if Path(out).is_dir():
        raise ValueError(f"{out} is a folder: name the file to write in it.")
    summary = Path(f"{out}{SUMMARY}")
    if summary.resolve() == Path(source).resolve():
        raise ValueError(f"{summary} is the file that is read, and the summary's name: rename it.")
    if summary.exists() and not Path(out).exists():
        raise ValueError(f"{summary} is there already, without {out}: move it away first.")
    if Path(out).exists():
        _check_own(Path(out), summary)


def _check_own(out: Path, summary: Path) -> None:
    """Raise ValueError unless :func:`run` wrote ``out`` and it has not changed since."""
    move = "Give another name, or move the file away first."
    if not summary.is_file():
        raise ValueError(
            f"{out} is there already and no file of corrupt_episodes: {summary} is not beside it. "
            f"{move}"
        )
    try:
        earlier = json.loads(read_regular(summary))
        episodes, recorded = int(earlier["episodes"]), earlier.get("sha256")
        earlier["corruption"], earlier["severity"], earlier["seed"], earlier["suite"]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise ValueError(
            f"{out} is there already and no file of corrupt_episodes: {summary} beside it holds "
            f"other things. {move}"
        ) from None
    if recorded is None:  # summaries of earlier versions have no checksum
        try:
            same = sum(1 for _ in read_episodes(out, hidden_goals=True)) == episodes
        except (ValueError, OSError):
            same = False
    else:
        same = recorded == sha256(out)
    if not same:
        raise ValueError(f"{out} was changed after corrupt_episodes wrote it. {move}")


def _summarised(settings: dict[str, Any], counts: Counts, out: Path | str) -> dict[str, Any]:
    """Write the summary beside ``out`` and return it."""
    summary = {
        **settings,
        "episodes": counts.episodes,
        "changed": counts.changed,
        "blank": counts.blank,
        "skipped_languages": dict(counts.skipped_languages),
        "tokens": dict(counts.tokens),
        "sha256": sha256(out),
    }
    if settings["corruption"] in MANNERS:
        summary["gate"] = _rates(counts.gate)
    with atomic_text(f"{out}{SUMMARY}") as file:
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

    With ``every``, unchanged instructions also get tokens of ``words``, because its vocabulary is
    not that of the file.
    """

    def unchanged(episode: Episode) -> Episode:
        if not every:
            return episode
        original = episode.instruction
        tokens = _tokens(original.text, original.tokens, words, counts.tokens)
        return replace(episode, instruction=replace(original, tokens=tokens))

    for episode in episodes:
        counts.episodes += 1
        instruction = episode.instruction
        if not is_english(instruction.language):
            counts.skipped_languages[instruction.language] += 1
            yield unchanged(episode)
            continue
        if not has_word(instruction.text):
            counts.blank += 1
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
    """Return new tokens of ``text``, padded or cut to the old length; None without ``words``."""
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
    result = restyle(text, manner, key, rewrite)
    gate["rewrites"] += 1
    gate["passed_at_once"] += result.passed and result.tries == 1
    gate["passed"] += result.passed
    gate["clauses"] += result.clauses
    gate["clauses_kept"] += result.plain
    return result.text


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


ALIAS = "family"  # former name of the option corruption=
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
    """Parse the options; raise ValueError for invalid ones and those without effect."""
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
    """Return the warnings and notices about a finished file."""
    lines = []
    if not summary["episodes"]:
        lines.append("warning: the file holds no episode")
    if summary["skipped_languages"]:
        lines.append(f"warning: {passed_through(summary['skipped_languages'])}")
    if summary["blank"]:
        lines.append(
            f"warning: {summary['blank']} instructions hold no word and passed through unchanged"
        )
    removed = summary["tokens"].get("removed", 0)
    if removed:
        lines.append(
            f"notice: instruction_tokens of {removed} changed instructions were removed, because "
            "they are of the clean words; an agent that reads tokens needs tokenizer=vocabulary "
            "(the file's own) or tokenizer=NAME (its own)"
        )
    cut = summary["tokens"].get("cut_short", 0)
    if cut:
        lines.append(
            f"warning: {cut} instructions have more tokens than the file's rows; cut short"
        )
    return lines


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for a bad input)."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if asks_help(arguments):
        print(__doc__)
        return 0 if arguments else 2
    try:
        (source, out), options = paths_and_options(arguments, ("IN", "OUT"), OPTIONS)
        summary = run(source, out, **_options(options))
    except (OSError, ValueError) as error:
        print(f"corrupt_episodes: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\ninterrupted: nothing was written", file=sys.stderr)
        return 130
    print(json.dumps(summary, indent=2, ensure_ascii=False))
    print("\n".join(notices(summary)), file=sys.stderr)
    return 0
