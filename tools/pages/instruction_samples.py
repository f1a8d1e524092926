"""Measure instruction corruptions: ``python -m tools.pages.instruction_samples FILE``.

Print, as Markdown, how often rewrites pass the fidelity gate, the time per corruption, the fraction
of known wrong rewrites that the gate rejects, and random examples.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path

from mitigate.core.markdown import markdown_table
from mitigate.corruptions.instruction import corrupt_instruction
from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.language.fidelity import check
from mitigate.corruptions.language.style import MANNERS, restyle
from mitigate.corruptions.language.text import has_word
from mitigate.worlds.corrupt_episodes_command import NAMES
from mitigate.worlds.episodes import read_episodes

OTHER = {"left": "right", "right": "left"}


def instructions(path: Path, count: int | None) -> list[tuple[str, str]]:
    """Return (id, text) of the first ``count`` instructions of an episode file or a text file.

    A text file has one instruction per line. Texts without a word and lines that begin with # are
    skipped.
    """
    if path.suffix == ".txt":
        lines = path.read_text(encoding="utf-8").splitlines()
        texts = [line.strip() for line in lines if has_word(line) and not line.startswith("#")]
        return [(str(index), text) for index, text in enumerate(texts[:count])]
    pairs = ((e.episode_id, e.instruction.text) for e in read_episodes(path))
    return list(islice((pair for pair in pairs if has_word(pair[1])), count))


def gate(pairs: list[tuple[str, str]], seed: int) -> Iterator[list[str]]:
    """Yield one table row per style, with the fractions that passed the gate and were reworded."""
    for manner in MANNERS:
        outputs = [restyle(text, manner, Key(seed, name)) for name, text in pairs]
        clauses = sum(one.clauses for one in outputs)
        yield [
            manner,
            f"{100 * sum(one.passed and one.tries == 1 for one in outputs) / len(outputs):.1f} %",
            f"{100 * sum(one.passed for one in outputs) / len(outputs):.1f} %",
            f"{100 * (1 - sum(one.plain for one in outputs) / clauses):.1f} %",
        ]


def cost(pairs: list[tuple[str, str]], seed: int) -> Iterator[list[str]]:
    """Yield one table row per corruption at severity 1: milliseconds and words per instruction."""
    for name in NAMES:
        start = time.process_time()
        outputs = [corrupt_instruction(text, name, 1.0, Key(seed, key)) for key, text in pairs]
        spent = time.process_time() - start
        words = [
            sum(len(text.split()) for text in texts) for texts in (outputs, dict(pairs).values())
        ]
        yield [name, f"{1000 * spent / len(pairs):.2f}", f"{words[0] / words[1]:.2f}"]


def lies(pairs: list[tuple[str, str]]) -> Iterator[list[str]]:
    """Yield one table row per kind of wrong rewrite, with their number and the rejected
    fraction."""
    for name, edit in _LIES.items():
        changed = [(text, lie) for _, text in pairs for lie in edit(text)]
        caught = sum(bool(check(text, lie)) for text, lie in changed)
        share = f"{100 * caught / len(changed):.1f} %" if changed else "–"
        yield [name, str(len(changed)), share]


def _flips(text: str) -> Iterator[str]:
    for match in re.finditer(r"\b(?:left|right)\b", text):
        yield text[: match.start()] + OTHER[match.group()] + text[match.end() :]


def _without_a_sentence(text: str) -> Iterator[str]:
    sentences = re.split(r"(?<=[.!?])\s+", text.strip())
    for index in range(len(sentences) if len(sentences) > 1 else 0):
        yield " ".join(sentences[:index] + sentences[index + 1 :])


_LIES: dict[str, Callable[[str], Iterator[str]]] = {
    "one left or right flipped": _flips,
    "one sentence left out": _without_a_sentence,
    '"past" made "into"': lambda text: iter(
        [re.sub(r"\bpast\b", "into", text)] if re.search(r"\bpast\b", text) else []
    ),
    "a distance added": lambda text: iter([f"{text.strip()} Go on for 3 metres."]),
    "a compass word added": lambda text: iter([f"Head north. {text}"]),
    "a landmark added": lambda text: iter([f"{text.strip()} The trombone is there."]),
}


def examples(pairs: list[tuple[str, str]], count: int, seed: int) -> Iterator[str]:
    """Yield ``count`` random instructions (by ``seed``) with the result of each corruption."""
    stream = digest(Key(seed, "samples"), "samples")
    order = sorted(range(len(pairs)), key=lambda index: uniform(stream, index))
    for index in order[:count]:
        name, text = pairs[index]
        yield f"> {text.strip()}\n"
        for corruption in NAMES:
            severity = 1.0 if corruption in MANNERS else 0.5
            output = corrupt_instruction(text, corruption, severity, Key(seed, name)).strip()
            yield f"- `{corruption}` {severity:g}: {output}"
        yield ""


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status (2 for invalid input)."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.pages.instruction_samples", description=__doc__
    )
    parser.add_argument("file", type=Path, help="episode file, or .txt with one text per line")
    parser.add_argument("--count", type=int, help="first instructions to measure (default all)")
    parser.add_argument("--show", type=int, default=0, help="examples to print (default 0)")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(argv)
    try:
        pairs = instructions(options.file, options.count)
        if not pairs:
            raise ValueError(f"{options.file} holds no instruction.")
        print(f"{len(pairs)} instructions\n")
        tables = {
            ("manner", "passed at once", "passed", "clauses reworded"): gate(pairs, options.seed),
            ("corruption", "ms", "words against clean"): cost(pairs, options.seed),
            ("lie", "cases", "caught"): lies(pairs),
        }
        for head, rows in tables.items():
            print(f"{markdown_table(head, rows)}\n")
        print("\n".join(examples(pairs, options.show, options.seed)))
    except (FileNotFoundError, ValueError) as error:
        print(f"samples: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
