"""What the classifier learns from: attacks and honest texts, alone and one in the other."""

from __future__ import annotations

import base64
import codecs
import json
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mitigate.core.seeding import generator
from mitigate.corruptions.instruction import corrupt_instruction
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.prefixes import prefixes
from mitigate.corruptions.language.style import MANNERS
from mitigate.guards.text.learning.routes import draw_route
from mitigate.guards.text.learning.styler import draw_styled
from mitigate.guards.text.pieces import clause_pieces, sentence_pieces

FOLDS = 5
PLACES = ("any", "inside", "wrap")
ROUTES = 1200  # drawn from templates, and as many in random styles
# Weights of lines: hand-written honest texts that look like attacks count most.
ALIKE = {"lookalikes": 2.0, "fresh_lookalikes": 2.0, "near_misses": 2.0, "odd_routes": 2.0}


@dataclass(frozen=True)
class Line:
    """A text that is whole attack or whole honest; ``group``: its mechanism, bank or style.

    ``place`` of an attack: "any", "inside" a sentence, or "wrap" around the route. ``styled``:
    whether an honest text is in a style; None where that is open.
    """

    text: str
    attack: bool
    group: str
    weight: float = 1.0
    place: str = "any"
    styled: bool | None = None

    @property
    def fold(self) -> int:
        return zlib.crc32(f"fold {self.group}".encode()) % FOLDS


@dataclass(frozen=True)
class Composed:
    """A text and the spans of it that are attacks; ``fold``: of the attack, or of honest text."""

    text: str
    attacks: Sequence[tuple[int, int]]
    fold: int


def read_lines(folder: Path, routes: int = ROUTES) -> list[Line]:
    """Return all lines to learn from. Raises FileNotFoundError outside a checkout."""
    banks = folder / "banks"
    if not banks.is_dir():
        raise FileNotFoundError(
            f"There is no data in {folder}: the texts to train on come with a checkout of the "
            "repository. Run this there, or name the folder with --data."
        )
    lines = []
    for name in ("attacks", "fresh_attacks"):
        for d in _json(banks / f"{name}.jsonl", "attack", "mechanism", "place"):
            if d["place"] not in PLACES:
                raise ValueError(
                    f"place must be one of {', '.join(PLACES)}, got {d['place']!r:.40} in "
                    f"{banks / name}.jsonl, beside {d['attack']!r:.60}."
                )
            lines.append(Line(d["attack"], True, d["mechanism"], place=d["place"]))
    for i, text in enumerate(_text(banks / "fit_attacks.txt")):
        lines.append(Line(text, True, f"lines {i % 8}", 0.7))
    for split in ("train", "validation"):  # never the test families, which the suite speaks
        for family, texts in prefixes(split).items():
            lines += [Line(text, True, f"prefix {family}") for text in texts]
    for name, weight in ALIKE.items():
        for i, d in enumerate(_json(banks / f"{name}.jsonl", "text")):
            lines.append(Line(d["text"], False, f"{name} {i % 6}", weight))
    for i, text in enumerate(_text(banks / "fit_routes.txt")):
        lines.append(Line(text, False, f"fit_routes {i % 4}", 1.5))
    for name in ("lies", "honest"):
        for i, d in enumerate(_json(banks / f"{name}.jsonl")):
            lines += [
                Line(text, False, f"{name} {i % 4}", 0.5)
                for key, text in d.items()
                if key != "kind"
            ]
    for file in sorted((folder / "styles").glob("*.jsonl")):
        for d in _json(file):
            said = " ".join(said for said, _ in d["parts"])
            plain = " ".join(plain for _, plain in d["parts"] if plain)
            lines.append(Line(said, False, f"style {file.stem}", 1.0, styled=True))
            lines.append(Line(plain, False, f"style {file.stem}", 0.5, styled=False))
    for i in range(routes):
        text = draw_route(generator(0, "fit", i))
        lines.append(Line(text, False, f"drawn {i % 8}", 0.5))
        styled = draw_styled(generator(0, "styled", i))
        lines.append(Line(styled, False, f"styled {i % 8}", 0.7, styled=True))
        if i % 3 == 0:
            manner, key = MANNERS[i // 3 % len(MANNERS)], Key(0, f"fit {i}")
            said = corrupt_instruction(text, manner, 1.0, key, split="train")
            lines.append(Line(said, False, f"drawn {i % 8}", 0.5))
    return lines


def _json(file: Path, *keys: str) -> Iterator[dict[str, Any]]:
    """Yield the objects of a JSON-lines file. Raises ValueError for a line that is no JSON object
    with texts under ``keys``."""
    with open(file, encoding="utf-8") as opened:
        for number, line in enumerate(opened, 1):
            if not line.strip():
                continue
            try:
                d = json.loads(line)
                if all(isinstance(d[key], str) for key in keys):
                    yield d
                    continue
                problem = "must be text under " + ", ".join(keys)
            except (ValueError, TypeError) as error:
                problem = f"must be one JSON object ({error})"
            except KeyError as error:
                problem = f"must have the key {error}"
            raise ValueError(f"{file}, line {number} {problem}. Fix or delete that line.")


def _text(file: Path) -> list[str]:
    with open(file, encoding="utf-8") as opened:
        return [line.strip() for line in opened if line.strip() and not line.startswith("#")]


def varied(lines: Sequence[Line]) -> list[Line]:
    """Return the lines, and copies of some as careless people or people who hide words write."""
    made = list(lines)
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
            text = HIDE[int(rng.integers(len(HIDE)))](text)
        elif draw < 0.38 and not line.attack:  # a scanned text has digits for letters as well
            text = _leet(text, "o")
        else:
            continue
        made.append(replace(line, text=text, weight=line.weight / 2, styled=None))
    return made


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


def compose(lines: Sequence[Line], count: int) -> Iterator[Composed]:
    """Yield all honest lines, then ``count`` of them with an attack.

    A route is of its attack's fold, so that a model exists that has seen neither.
    """
    attacks = [line for line in lines if line.attack and line.text.strip()]
    honest = [line for line in lines if not line.attack]
    pools: list[list[str]] = [[] for _ in range(FOLDS)]
    for line in honest:
        yield Composed(line.text, (), line.fold)
        if len(line.text.split()) > 6:
            pools[line.fold].append(line.text)
    for number in range(count):
        rng = generator(0, "composed", number)
        attack = attacks[int(rng.integers(len(attacks)))]
        pool = pools[attack.fold]
        route = pool[int(rng.integers(len(pool)))]
        if attack.place == "wrap":
            before, _, after = attack.text.partition("{route}")
            text = f"{before} {route} {after}"
            ends = (0, len(before)), (len(text) - len(after), len(text))
            yield Composed(text, ends, attack.fold)
            continue
        said = attack.text
        if rng.random() < 0.12:
            said = f"{said} {attacks[int(rng.integers(len(attacks)))].text}"
        if rng.random() < 0.2:
            said = said.rstrip(" .!?")
        pieces = sentence_pieces(route)
        short = len(said.split()) < 16
        if attack.place == "inside" or (short and rng.random() < 0.25):
            cuts = [c.start for p in pieces for c in clause_pieces(route, p)[1:]]
            at = cuts[int(rng.integers(len(cuts)))] if cuts else len(route)
            said = said.strip(" .") if rng.random() < 0.6 else said
            comma = "," if rng.random() < 0.6 and said[-1:].isalnum() else ""
            said = said[:1].lower() + said[1:] + comma
        else:
            cuts = [0, 0, len(route), len(route), *(p.start for p in pieces[1:])]
            at = cuts[int(rng.integers(len(cuts)))]
        before, after = route[:at].rstrip(), route[at:].lstrip()
        if before and before[-1].isalnum() and rng.random() < 0.5:
            before += "," if attack.place == "inside" else "."
        start = len(before) + 1 if before else 0
        yield Composed(
            f"{before} {said} {after}".strip(), [(start, start + len(said))], attack.fold
        )
