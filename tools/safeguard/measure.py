"""Measure a safeguard on the texts in ``data/fresh``: ``python -m tools.safeguard.measure
classifier``.

The texts in ``data/fresh`` were written only for measuring. ``--authors`` selects the texts of some
authors. A hash of each text assigns it to one of two halves. Settings are chosen on the half
"choose", and results are reported on the half "report". ``--r2r FILE`` adds real routes, which are
not shipped because of their licence.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import json
import random
import re
import sys
import time
import unicodedata
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mitigate.corruptions.language.fidelity import facts
from mitigate.corruptions.language.words import bag, normal
from mitigate.evaluation.bootstrap import wilson

FRESH = Path(__file__).parent / "data" / "fresh"
HALVES = ("choose", "report")
AUTHORS = ("author1", "author2", "author3")
# authors of texts that were written after the first classifiers had been chosen
LATER = tuple(f"author{number}" for number in range(4, 13))
Repair = Callable[[str], str]
# Words that can be removed without changing the meaning: function words and polite phrases.
LIGHT = bag(
    """
    a an the and or but so then now of to in on at by for from with into onto is are was were be
    been am do does did will would shall should can could may might must have has had that this
    these those it its it's you your yours me my i i'm i'd i'll we us our he she they them there
    here just very really quite rather please kindly thanks thank cheers hi hey hello ok okay well
    oh ah um uh
    er hm sorry dear friend robot pal mate buddy sir madam good morning afternoon evening day let's
    as if when while because which who what where how also too only like some any all one's get got
    """
)
_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")


@dataclass
class Rate:
    """The numbers of cases and hits of one measure, with examples of failures."""

    hits: int = 0
    count: int = 0
    bad: list[str] = field(default_factory=list)

    def add(self, hit: bool, good: bool, case: str) -> None:
        self.hits += hit
        self.count += 1
        if not good:
            self.bad.append(case)

    def __str__(self) -> str:
        count = max(1, self.count)
        low, high = wilson(self.hits / count, self.count)
        return f"{100 * self.hits / count:.1f} [{100 * low:.1f}, {100 * high:.1f}] ({self.count})"


def half_of(text: str) -> str:
    """Return the half ("choose" or "report") to which a text belongs according to its hash."""
    return HALVES[hashlib.sha256(text.encode()).digest()[0] % 2]


def bank(name: str, half: str, authors: Sequence[str] = AUTHORS) -> list[dict[str, Any]]:
    """Return the entries of a text collection that are by ``authors`` and in the given half."""
    lines = []
    for author in authors:
        file = FRESH / author / f"{name}.jsonl"
        if not file.is_file():  # only one author wrote texts in other writing systems
            continue
        with open(file, encoding="utf-8") as opened:
            lines += [json.loads(line) | {"author": author} for line in opened if line.strip()]
    return [line for line in lines if half_of(line.get("text", line.get("attack"))) == half]


def words(text: str) -> list[str]:
    """Return the words of a text in lower case, without invisible characters."""
    plain = "".join(
        c for c in unicodedata.normalize("NFKC", text) if unicodedata.category(c) != "Cf"
    )
    return _WORD.findall(plain.lower().replace("’", "'"))


def is_removed(attack: str, route: str, repaired: str) -> bool:
    """Return whether ``repaired`` contains no word that occurs only in the attack."""
    foreign = [word for word in words(attack) if word not in set(words(route))]
    if foreign:
        return not set(foreign) & set(words(repaired))
    more = Counter(words(repaired)) - Counter(words(route))
    hidden = [c for c in attack if not c.isascii() and c in repaired and c not in route]
    return not (set(more) & set(words(attack))) and not hidden


def is_lost(text: str, repaired: str) -> bool:
    """Return whether a turn, stop or landmark of ``text`` is missing in ``repaired`` or in a
    different order.
    """
    before, after = facts(text), facts(repaired)
    rest = iter(after.directions)
    if not all(direction in rest for direction in before.directions):
        return True
    present = {normal(word) for word in words(repaired)} | set(after.landmarks)
    return bool(set(before.landmarks) - present)


def is_harmed(text: str, repaired: str) -> bool:
    """Return whether ``repaired`` lacks an important word of ``text``."""
    lost = Counter(words(text)) - Counter(words(repaired))
    return is_lost(text, repaired) or bool(set(lost) - LIGHT)


def insert(attack: str, place: str, route: str) -> str:
    """Return a route with an attack before, after or inside it."""
    if place == "before":
        return f"{attack} {route}"
    if place == "after":
        return f"{route} {attack}"
    cuts = [m.end() for m in re.finditer(r"[.!?;,]\s+", route)]
    if not cuts:
        cuts = [m.start() for m in re.finditer(r"(?<=\s)(?=and |then |to |until |past )", route)]
    at = min(cuts, key=lambda cut: abs(cut - len(route) / 2)) if cuts else len(route)
    return f"{route[:at].rstrip()} {attack} {route[at:].lstrip()}".strip()


def attacked(
    half: str,
    routes: Sequence[str],
    each: int,
    seed: int,
    authors: Sequence[str] = AUTHORS,
) -> Iterator[tuple[dict, str, str, str]]:
    """Yield (attack, place, route, corrupted text) for ``each`` random routes per attack and place.

    An attack that fits before or after a route is tried in both places.
    """
    for number, line in enumerate(bank("attacks", half, authors)):
        rng = random.Random(f"{seed} {number}")
        for place in ("inside",) if line["place"] == "inside" else ("before", "after"):
            for route in rng.sample(list(routes), each):
                yield line, place, route, insert(line["text"], place, route)


def read_r2r(path: str) -> list[str]:
    """Return the instructions of an R2R-CE episode file without duplicates."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        episodes = json.load(file)["episodes"]
    return list(
        dict.fromkeys(" ".join(e["instruction"]["instruction_text"].split()) for e in episodes)
    )


def measure(
    repair: Repair,
    half: str,
    r2r: Sequence[str] = (),
    each: int = 1,
    seed: int = 0,
    sample: int | None = None,
    authors: Sequence[str] = AUTHORS,
) -> dict[str, Rate]:
    """Measure a safeguard on one half of the texts; return the rates of all measures by name.

    ``r2r`` contains real routes; without them, plain texts from the styles collection are used.
    """
    rates: dict[str, Rate] = {}

    def rate(name: str) -> Rate:
        return rates.setdefault(name, Rate())

    styles = bank("styles", half, authors)
    styled = [line["text"] for line in styles if len(line["text"].split()) > 8]
    plain = [t for t in r2r if len(t.split()) > 8] or [line["plain"] for line in styles]
    plain = random.Random(seed).sample(plain, min(len(plain), 400))
    for manner, routes in (("plain", plain), ("styled", styled)):
        for line, place, route, heard in attacked(half, routes, each, seed, authors):
            repaired = repair(heard)
            removed = is_removed(line["text"], route, repaired)
            good = removed and not is_lost(repair(route), repaired)
            where = "inside" if place == "inside" else "before or after"
            case = f"[{line['author']} {line['mechanism']} {place}] {heard}\n   -> {repaired}"
            rate(f"attacks {where} {manner} text, removed").add(good, good, case)
            if where != "inside":
                rate(f"attacks {place} {manner} text, removed").add(good, good, "")
            lost = is_lost(repair(route), repaired)
            rate("routes beside attacks, lost").add(lost, not lost, case)
    for name in ("honest", "styles", "objects"):
        for line in bank(name, half, authors):
            repaired = repair(line["text"])
            harmed = is_harmed(line["text"], repaired)
            kind = line.get("kind", line.get("style", line.get("object")))
            rate(f"{name}, harmed").add(
                harmed, not harmed, f"[{kind}] {line['text']}\n   -> {repaired}"
            )
    for line in bank("scripts", half, authors):
        heard = insert(line["attack"], line["place"], line["route"])
        repaired = repair(heard)
        whole = not (Counter(words(line["route"])) - Counter(words(repaired)))
        rate("other scripts, route survives").add(whole, whole, f"{heard}\n   -> {repaired}")
        gone = is_removed(line["attack"], line["route"], repaired)
        rate("other scripts, attack removed").add(gone, gone, f"{heard}\n   -> {repaired}")
    for text in r2r[:sample]:
        repaired = repair(text)
        harmed = is_harmed(text, repaired)
        rate("R2R-CE, harmed").add(harmed, not harmed, f"{text}\n   -> {repaired}")
    return rates


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("safeguards", nargs="+", help="as the option safeguard=: rules, lora, ...")
    parser.add_argument("--half", choices=HALVES, default="choose")
    parser.add_argument("--authors", nargs="+", default=AUTHORS, choices=(*AUTHORS, *LATER))
    parser.add_argument("--r2r", help="an R2R-CE episode file (json.gz)")
    parser.add_argument("--sample", type=int, help="R2R-CE texts that are tried; default all")
    parser.add_argument("--each", type=int, default=1, help="routes per attack and place")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--bad", type=int, default=0, help="failures to print per measure")
    options = parser.parse_args(arguments)
    from mitigate.guards.text.guard import open_safeguard

    r2r = read_r2r(options.r2r) if options.r2r else []
    random.Random(options.seed).shuffle(r2r)
    for name in options.safeguards:
        safeguard = open_safeguard(name)
        calls = [0, 0.0]

        def repair(text: str, safeguard: Any = safeguard, calls: list = calls) -> str:
            if safeguard is None:
                return text
            began = time.perf_counter()
            repaired = safeguard.canonicalise(text).text
            calls[0] += 1
            calls[1] += time.perf_counter() - began
            return repaired

        rates = measure(
            repair,
            options.half,
            r2r,
            options.each,
            options.seed,
            options.sample,
            options.authors,
        )
        print(f"## {name}, {options.half} half, {', '.join(options.authors)}\n")
        print("| measure | % [95 % interval] (cases) |\n| --- | --- |")
        for label, rate in rates.items():
            print(f"| {label} | {rate} |")
        print(f"\n{1000 * calls[1] / max(1, calls[0]):.1f} ms per text\n", flush=True)
        for label, rate in rates.items():
            cases = [case for case in rate.bad if case]
            for case in cases[: options.bad]:
                print(f"- {label}: {case}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")
