"""What may know what: read from the imports and the tree."""

from __future__ import annotations

import ast
import re
import statistics
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MAP = (ROOT / "docs/where-does-my-line-go.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `(\w+)` \| ([`\w ]*)\|", MAP.partition("What may import what")[2], re.M)
ALLOWED = {package: set(re.findall(r"\w+", others)) for package, others in ROWS}
CONCRETE = re.compile(
    r"mitigate\.(worlds\.(apartments|habitat_world|recorded)|agents\.(topological|recurrent|frontier))\b"
)
NAMES_ONE = {  # packages and files that may name a world or an agent
    "mitigate/worlds", "mitigate/agents", "mitigate/shipping", "mitigate/replay", "mitigate/bench",
    "mitigate/corruptions/gallery.py", "mitigate/safeguard/learning/routes.py",
}  # fmt: skip
SOURCES = sorted(
    path for folder in ("mitigate", "recipes") for path in (ROOT / folder).rglob("*.py")
)


def imported(path: Path) -> set[str]:
    """Dotted names of all that a file imports, at its top or inside a function."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.module and not node.level, f"{path}: relative imports are not followed"
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


def package_of(path: Path) -> str:
    """The package of a file below ``mitigate``, or recipes; empty for what lies loose."""
    parts = path.relative_to(ROOT).parts
    return "recipes" if "recipes" in parts[:2] else parts[1] if len(parts) > 2 else ""


def strangers(package: str, names: set[str]) -> set[str]:
    """Of the imported ``names`` those of packages that the map does not allow."""
    others = {name.split(".")[1] for name in names if name.startswith("mitigate.")}
    known = {*ALLOWED[package], package, *(name for name in others if name not in ALLOWED)}
    return set() if "all" in known else others - known


def test_the_map_names_every_package():
    folders = {p.name for p in (ROOT / "mitigate").iterdir() if (p / "__init__.py").is_file()}
    assert folders <= {*ALLOWED} and {*ALLOWED} - folders <= {"commands"}


@pytest.mark.parametrize("package", ALLOWED)
def test_a_package_imports_what_the_map_allows(package):
    files = [path for path in SOURCES if package_of(path) == package]
    found = {str(path): strangers(package, imported(path)) for path in files}
    assert files and not {path: names for path, names in found.items() if names}


def test_packages_of_the_safeguard_know_those_before_them():
    listed = re.search(r"^Inside `safeguard` .* before it: ([^;]*);", MAP, re.M)
    layers = re.findall(r"\w+", listed[1]) if listed else []
    for place, layer in enumerate(layers):
        later = tuple(f"mitigate.safeguard.{name}." for name in layers[place + 1 :])
        for path in (ROOT / "mitigate/safeguard" / layer).glob("*.py"):
            found = [name for name in imported(path) if f"{name}.".startswith(later)]
            assert not found, path
    folders = {p.parent.name for p in (ROOT / "mitigate/safeguard").glob("*/__init__.py")}
    assert folders - {*layers} == {"language_models"}


def test_an_import_that_the_map_does_not_allow_is_found():
    assert strangers("core", {"mitigate.core.names", "mitigate.training.train"}) == {"training"}
    assert strangers("scale", {"mitigate.worlds"}) == {"worlds"}


def test_worlds_and_agents_are_named_by_their_own_packages_alone():
    for path in SOURCES:
        own = str(path.relative_to(ROOT))
        named = [name for name in imported(path) if CONCRETE.match(name)]
        assert not named or own.startswith(tuple(NAMES_ONE)), f"{own} imports {named}"


def test_an_agent_names_no_world_and_a_world_no_agent():
    for path in SOURCES:
        if package_of(path) == "agents":
            found = [n for n in imported(path) if CONCRETE.match(n) and ".worlds." in n]
            assert not found, path


def test_few_modules_lie_loose_at_the_root():
    loose = [p.name for p in (ROOT / "mitigate").glob("*.py") if not p.name.startswith("__")]
    assert len(loose) <= 3, loose


def test_files_and_functions_are_short():
    lengths = [len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES]
    assert statistics.median(lengths) <= 130
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                long = (node.end_lineno or 0) - node.lineno + 1
                assert long <= 60, f"{path.relative_to(ROOT)}: {node.name} has {long} lines"
