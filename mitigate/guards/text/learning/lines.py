"""Load the training texts of the classifier: attacks and benign texts."""

from __future__ import annotations

import base64
import codecs
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mitigate.core.seeding import generator, pick
from mitigate.corruptions.instruction import corrupt_instruction, prefixes
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.style import MANNERS
from mitigate.guards.text.learning.routes import draw_route
from mitigate.guards.text.learning.styler import draw_styled

ROUTES = 1200  # number of routes from templates; the same number is added in random styles
BLOCK = 20  # in files without named groups, this many consecutive lines form a group
# Hand-written benign texts that look like attacks have the highest weight in training.
ALIKE = {"lookalikes": 2.0, "fresh_lookalikes": 2.0, "near_misses": 2.0, "odd_routes": 2.0}


@dataclass(frozen=True)
class Line:
    """A training text that is either entirely an attack or entirely benign."""

    text: str  # with the placeholder "{route}" if an attack surrounds the route
    attack: bool
    group: str  # mechanism, style or source; texts of one group resemble each other
    weight: float = 1.0
    styled: bool | None = None  # whether a benign text is in an unusual style, if this is known


def read_lines(folder: Path, routes: int = ROUTES) -> list[Line]:
    """Return all training texts.

    Raises FileNotFoundError outside a checkout of the repository.
    """
    banks = folder / "banks"
    if not banks.is_dir():
        raise FileNotFoundError(
            f"There is no data in {folder}: the texts to train on come with a checkout of the "
            "repository. Run this there, or name the folder with --data."
        )
    lines = []
    for name in ("attacks", "fresh_attacks"):
        attacks = _json(banks / f"{name}.jsonl", "attack")
        lines += [Line(d["attack"], True, str(d.get("mechanism", name))) for d in attacks]
    fit_attacks = enumerate(_text(banks / "fit_attacks.txt"))
    lines += [Line(text, True, f"fit_attacks {i // BLOCK}", 0.7) for i, text in fit_attacks]
    # the test families are left out, because the corruption suite uses them
    for split in ("train", "validation"):
        for family, texts in prefixes(split).items():
            lines += [Line(text, True, family) for text in texts]
    for name, weight in ALIKE.items():
        for i, d in enumerate(_json(banks / f"{name}.jsonl", "text")):
            lines.append(Line(d["text"], False, f"{name} {i // BLOCK}", weight))
    fit_routes = enumerate(_text(banks / "fit_routes.txt"))
    lines += [Line(text, False, f"fit_routes {i // BLOCK}", 1.5) for i, text in fit_routes]
    for name in ("lies", "honest"):
        for i, d in enumerate(_json(banks / f"{name}.jsonl")):
            group = f"{name} {i // BLOCK}"
            lines += [Line(text, False, group, 0.5) for key, text in d.items() if key != "kind"]
    for d in _json(banks / "voices.jsonl", "voice", "text"):
        lines.append(Line(d["text"], False, f"voice_{d['voice']}", 1.0, styled=True))
    for file in sorted((folder / "styles").glob("*.jsonl")):
        for d in _json(file):
            styled_text = " ".join(styled_text for styled_text, _ in d["parts"])
            plain = " ".join(plain for _, plain in d["parts"] if plain)
            lines.append(Line(styled_text, False, file.stem, 1.0, styled=True))
            lines.append(Line(plain, False, file.stem, 0.5, styled=False))
    for i in range(routes):
        group = f"generated {i // BLOCK}"
        text = draw_route(generator(0, "fit", i))
        styled = draw_styled(generator(0, "styled", i))
        lines.append(Line(text, False, group, 0.5))
        lines.append(Line(styled, False, group, 0.7, styled=True))
        if i % 3 == 0:
            manner, key = MANNERS[i // 3 % len(MANNERS)], Key(0, f"fit {i}")
            corrupted = corrupt_instruction(text, manner, 1.0, key, split="train")
            lines.append(Line(corrupted, False, group, 0.5))
    return lines


def read_frames(folder: Path) -> tuple[list[str], list[str]]:
    """Return short sentences to put before an attack, and short sentences to put after it."""
    texts = (folder / "banks/frames.txt").read_text(encoding="utf-8").split("\n\n")
    before, after = (part.splitlines() for part in texts)
    return [line for line in before if not line.startswith("# ")], after


def _json(file: Path, *keys: str) -> Iterator[dict[str, Any]]:
    """Yield the objects in a JSON-lines file.

    Raises ValueError if a line is not a JSON object, or if the value of one of ``keys`` is not
    text.
    """
    with open(file, encoding="utf-8") as opened:
        for number, line in enumerate(opened, 1):
            if not line.strip():
                continue
            try:
                d = json.loads(line)
                valid = all(isinstance(d[key], str) for key in keys)
            except (ValueError, TypeError, KeyError):
                valid = False
            if not valid:
                raise ValueError(
                    f"{file}, line {number} must be one JSON object with text under "
                    f"{', '.join(keys)}. Fix or delete that line."
                )
            yield d


def _text(file: Path) -> list[str]:
    with open(file, encoding="utf-8") as opened:
        return [line.strip() for line in opened if line.strip() and not line.startswith("#")]


def varied(lines: Sequence[Line]) -> list[Line]:
    """Return all texts, and additional changed copies of some texts.

    The copies imitate careless writing, such as missing capitals, or hide the words of an attack.
    """
    results = list(lines)
    for number, line in enumerate(lines):
        rng = generator(0, "varied", number)
        draw, text = rng.random(), line.text
        if draw < 0.15:
            text = text.lower()
        elif draw < 0.22:
            text = text.upper()
        elif draw < 0.30:
            text = text.rstrip(".!")
        elif draw < 0.36 and line.attack and "{route}" not in text:
            text = pick(HIDE, rng)(text)
        # benign text may also have digits instead of letters, for example if it was scanned
        elif draw < 0.38 and not line.attack:
            text = _leet(text, "o")
        else:
            continue
        results.append(replace(line, text=text, weight=line.weight / 2, styled=None))
    return results


def _leet(text: str, letters: str = "oieas") -> str:
    table = {"o": "0", "i": "1", "e": "3", "a": "4", "s": "5"}
    return "".join(table[c] if c in letters else c for c in text.lower())


HIDE: tuple[Callable[[str], str], ...] = (
    lambda text: base64.b64encode(text.encode()).decode(),
    lambda text: text.encode().hex(),
    lambda text: codecs.encode(text, "rot13"),
    _leet,
    lambda text: text[::-1],
    lambda text: " ".join(text),
    lambda text: "".join(chr(ord(c) + 0xFEE0) if "!" <= c <= "~" else c for c in text),
    lambda text: text.replace("a", "а").replace("e", "е").replace("o", "о"),
)
