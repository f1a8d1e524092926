"""Corrupt the instructions of a VLN-CE episode file (R2R-CE, RxR-CE or apartments) of any size.

``mitigate corrupt_episodes IN OUT corruption=black_box severity=0.5 [seed=0] [split=test]
[tokenizer=vocabulary|NAME] [mask_token=[MASK]] [tagger=own]``

Corruptions (docs/instructions.md): friendly, novice, professional, formal, capitalize, mask,
black_box. The option ``split`` applies only to black_box, ``mask_token`` only to mask, and
``tagger`` only to capitalize and mask.

The clean text is kept as ``original_text``. ``tokenizer`` computes the tokens of the new text:
``vocabulary`` uses the ``instruction_vocab`` of the file, and NAME is the folder or the hub name of
a Hugging Face tokenizer. Without the option ``tokenizer``, the tokens of changed instructions are
removed, because they encode the clean text. Instructions that are not in English or contain no word
are copied unchanged, and the command reports their number. The command also writes
``OUT.summary.json``. It overwrites an existing OUT only if it wrote that file and the file has not
changed since.
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

from mitigate.core.errors import command
from mitigate.core.files import sha256, write_json
from mitigate.core.json_files import LARGEST_LIST, read_json
from mitigate.core.names import printable
from mitigate.core.options import asks_help, paths_and_options
from mitigate.corruptions.instruction import check_options, corrupt_instruction, is_rewritten
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.style import MANNERS, Rewrite, restyle
from mitigate.corruptions.language.text import UNMARKED, has_word, is_english, passed_through
from mitigate.corruptions.language.tokens import VOCABULARY, Tokenizer, tokenizer_for
from mitigate.corruptions.suite import INSTRUCTION, SUITE_VERSION, check_name, check_severity
from mitigate.worlds.episodes import Episode, read_episodes, read_extras, write_episodes

ORIGINAL = "original_text"  # key under which the output file stores the clean text
STALE = ("timed_instruction",)  # key in RxR files that stores the clean words and their times
SUMMARY = ".summary.json"  # suffix of the summary; OUT is summarised in OUT.summary.json
NAMES = tuple(name for name in INSTRUCTION if name != "white_box")
USES = {"black_box": ("split",), "mask": ("mask_token", "tagger"), "capitalize": ("tagger",)}


@dataclass
class Counts:
    """Numbers of episodes that were changed, skipped or otherwise processed."""

    episodes: int = 0
    changed: int = 0
    blank: int = 0
    skipped_languages: Counter = field(default_factory=Counter)
    tokens: Counter = field(default_factory=Counter)


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
    """Corrupt the instructions of the file ``source``, write the result to ``out``, and write and
    return a summary.

    The summary records only options that the corruption uses (``USES``).

    Args:
        source: A VLN-CE episode file.
        out: The output file.
        corruption: One of ``NAMES``.
        severity: Severity in [0, 1].
        seed: Seed of the corruption. The seed and the episode id form the random key, as in an
            evaluation.
        split: See ``corrupt_instruction``.
        tokenizer: "vocabulary" to use the vocabulary that ``source`` contains, or the folder or hub
            name of a Hugging Face tokenizer. If None, the tokens of changed instructions are
            removed.
        mask_token: Text that replaces a word. If None, it is the mask token of the tokenizer, or
            "[MASK]" if the tokenizer has no mask token.
        tagger: See ``corrupt_instruction``.
        rewrite: See ``corrupt_instruction``.

    Raises:
        ValueError, FileNotFoundError: If an option or file is invalid, or if ``out`` exists and
            this function did not write it. ``out`` is then unchanged.
    """
    check_for_file(corruption)
    severity = check_severity(severity)
    Key(seed, "0")  # this raises ValueError for an invalid seed
    check_options(split, "[MASK]" if mask_token is None else mask_token, tagger)
    _check_target(Path(source), Path(out))
    extras = read_extras(source)
    words = tokenizer_for(tokenizer, extras) if tokenizer else None
    mask = mask_token if mask_token is not None else (words and words.mask_token) or "[MASK]"
    options = {"split": split, "mask_token": mask, "tagger": tagger}
    counts = Counts()
    gate: Counter = Counter()

    def corrupted(episode: Episode) -> str:
        key, text = Key(seed, episode.episode_id), episode.instruction.text
        if corruption in MANNERS:
            return _restyled(text, corruption, severity, key, rewrite, gate)
        return corrupt_instruction(
            text, corruption, severity, key, split=split, mask_token=mask, tagger=tagger
        )

    episodes = tqdm(read_episodes(source, hidden_goals=True), unit="episode", disable=None)
    other_words = words is not None and tokenizer != VOCABULARY
    write_episodes(out, _changed(episodes, corrupted, words, counts, other_words), extras)
    summary = {
        "source": str(source),
        "corruption": corruption,
        "severity": severity,
        "seed": seed,
        "suite": SUITE_VERSION,
        "tokenizer": tokenizer,
        **{name: options[name] for name in USES.get(corruption, ())},
        **vars(counts),
        "sha256": sha256(out),
    }
    if corruption in MANNERS:
        summary["gate"] = _rates(gate)
    write_json(f"{out}{SUMMARY}", summary, indent=2, ensure_ascii=False)
    return summary


def check_for_file(corruption: str) -> None:
    """Raise ValueError unless ``corruption`` is one of ``NAMES``."""
    if corruption == "white_box":
        raise ValueError(
            "corruption=white_box is not applicable to a file, because it corrupts the system "
            "prompt of an agent. Evaluate such an agent, or use corruption=black_box."
        )
    check_name(corruption, NAMES)


def _check_target(source: Path, out: Path) -> None:
    """Raise ValueError if :func:`run` must not write to ``out``.

    An existing file may be replaced only if :func:`run` wrote it and it has not changed since.
    """
    fix = "Give another name, or move the file away first."
    summary = Path(f"{out}{SUMMARY}")
    if source.resolve() in (out.resolve(), summary.resolve()):
        raise ValueError(f"OUT and its summary {summary} must not be the file IN. {fix}")
    if out.is_dir():
        raise ValueError(f"OUT must be a file, got the folder {out}. Name a file in it.")
    if (out.exists() or summary.exists()) and not _is_unchanged(out, summary):
        raise ValueError(
            f"{out} or {summary} was not written by corrupt_episodes, or has changed since. {fix}"
        )


def _is_unchanged(out: Path, summary: Path) -> bool:
    """Return whether the content of ``out`` matches its summary."""
    try:
        return read_json(summary, "", LARGEST_LIST)["sha256"] == sha256(out)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return False


def _changed(
    episodes: Iterator[Episode],
    corrupted: Callable[[Episode], str],
    words: Tokenizer | None,
    counts: Counts,
    every: bool,
) -> Iterator[Episode]:
    """Yield the episodes with corrupted instructions, one at a time.

    If ``every`` is true, unchanged instructions are also tokenized, because ``words`` is not the
    vocabulary of the file.
    """
    for episode in episodes:
        counts.episodes += 1
        clean = episode.instruction
        text, tokens, extra = clean.text, clean.tokens, clean.extra
        if not is_english(clean.language, text):
            counts.skipped_languages[clean.language or UNMARKED] += 1
        elif not has_word(text):
            counts.blank += 1
        else:
            try:
                text = corrupted(episode)
            except ValueError as error:
                raise ValueError(f"Episode {episode.episode_id}: {error}") from error
        if every or text != clean.text:
            tokens = _tokens(text, tokens, words, counts.tokens)
        if text != clean.text:
            counts.changed += 1
            extra = {key: value for key, value in extra.items() if key not in STALE}
            counts.tokens["timed_instruction_removed"] += len(clean.extra) - len(extra)
            extra.setdefault(ORIGINAL, clean.text)
        instruction = replace(clean, text=text, tokens=tokens, extra=extra)
        yield replace(episode, instruction=instruction)


def _tokens(
    text: str, old: Sequence[int] | None, words: Tokenizer | None, counts: Counter
) -> tuple[int, ...] | None:
    """Return the tokens of ``text``, padded or cut to the old length.

    Return None if ``words`` is None.
    """
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


OPTIONS = ("corruption", "severity", "seed", "split", "tokenizer", "mask_token", "tagger")


def _options(words: Mapping[str, str]) -> dict[str, Any]:
    """Parse the options. Raise ValueError if an option is invalid or has no effect."""
    options: dict[str, Any] = dict(words)
    for name, example in (("corruption", "black_box"), ("severity", "0.5")):
        if name not in options:
            raise ValueError(
                f"The option {name} is missing. Add {name}={example}. Corruptions: "
                f"{', '.join(NAMES)}."
            )
    for name, kind, text in (("severity", float, "a number"), ("seed", int, "a whole number")):
        try:
            options[name] = kind(options.get(name, 0))
        except ValueError as error:
            raise ValueError(f"{name} must be {text}, got {options[name]!r}.") from error
    corruption = options["corruption"]
    check_for_file(corruption)
    for name in options:
        users = [user for user, used in USES.items() if name in used]
        if users and corruption not in users:
            raise ValueError(
                f"{name}= has no effect on {corruption}, only on {' and '.join(users)}. Leave it "
                "out."
            )
    return options


def notices(summary: dict[str, Any]) -> list[str]:
    """Return the warnings and notices about a finished output file."""
    lines = []
    if not summary["episodes"]:
        lines.append("warning: the file has no episodes")
    if summary["skipped_languages"]:
        lines.append(f"warning: {passed_through(summary['skipped_languages'])}")
    if summary["blank"]:
        lines.append(
            f"warning: {summary['blank']} instructions have no word and were copied unchanged"
        )
    if removed := summary["tokens"].get("removed"):
        lines.append(
            f"notice: instruction_tokens of {removed} changed instructions were removed, because "
            "they encode the clean text. For an agent that reads tokens set tokenizer=vocabulary "
            "(of the file) or tokenizer=NAME (of the agent)"
        )
    if cut := summary["tokens"].get("cut_short"):
        lines.append(f"warning: {cut} instructions have more tokens than before and were truncated")
    return lines


@command("corrupt_episodes")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for invalid input)."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if asks_help(arguments):
        print(__doc__)
        return 0 if arguments else 2
    try:
        (source, out), options = paths_and_options(arguments, ("IN", "OUT"), OPTIONS)
        summary = run(source, out, **_options(options))
    except KeyboardInterrupt:
        print("\ninterrupted: nothing was written", file=sys.stderr)
        return 130
    print(printable(json.dumps(summary, indent=2, ensure_ascii=False)))
    print(printable("\n".join(notices(summary))), file=sys.stderr)
    return 0
