"""Tests that each package imports only packages of lower layers; the tests read the source."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
LINE = re.search(r"^`core` < .*$", PAGE, re.M)
assert LINE, "the page lacks the line that orders the packages"
LAYERS = [re.findall(r"`(\w+)`", layer) for layer in LINE[0].split("<")]
RANK = {package: rank for rank, layer in enumerate(LAYERS) for package in layer}
SOURCES = sorted(
    path
    for folder in ("mitigate", "recipes")
    for path in (ROOT / folder).rglob("*.py")
    if path.name != "__main__.py" or path.parent.name != "mitigate"
)


def package_of(module: str) -> str:
    """Return the package of a dotted module name: "core" for ``mitigate.core.names``."""
    parts = module.split(".")
    return parts[1] if parts[0] == "mitigate" and len(parts) > 1 else parts[0]


def module_of(path: Path) -> str:
    """Return the dotted module name of a file; files in ``recipes`` belong to
    ``mitigate.recipes``."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    parts = parts[1:] if parts[:2] == ("mitigate", "recipes") else parts
    return ".".join(("mitigate", *parts) if parts[0] == "recipes" else parts)


def imported(source: str) -> set[str]:
    """Return the dotted names of everything that ``source`` imports, including imports in
    functions."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.module and not node.level, "relative imports are not followed"
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def climbing(module: str, names: set[str]) -> set[str]:
    """Return the imported ``names`` whose packages are in the layer of ``module`` or in a higher
    layer."""
    own_value = package_of(module)
    others = {name for name in names if package_of(name) in RANK and package_of(name) != own_value}
    return {name for name in others if RANK[package_of(name)] >= RANK[own_value]}


def test_layers_name_every_package():
    folders = {path.parent.name for path in (ROOT / "mitigate").glob("*/__init__.py")}
    assert {*RANK} == (folders | {"cli"}), "the line on the page must name every package"


@pytest.mark.parametrize("package", [name for name in RANK if name != "cli"])
def test_package_imports_only_lower_packages(package):
    files = [path for path in SOURCES if package_of(module_of(path)) == package]
    assert files
    wrong = {
        str(path.relative_to(ROOT)): names
        for path in files
        if (names := climbing(module_of(path), imported(path.read_text(encoding="utf-8"))))
    }
    assert not wrong


def test_climbing_finds_an_upward_import():
    source = "def load():\n    from mitigate.training import trainer\n"
    assert climbing("mitigate.core.names", imported(source)) == {
        "mitigate.training",
        "mitigate.training.trainer",
    }
    assert not climbing("mitigate.training.train", {"mitigate.core.names"})


def test_package_names_no_concrete_agent_or_world():
    concrete = re.compile(r"mitigate\.worlds\.(apartments|habitat_world|recorded)\b")
    agents = re.compile(r"mitigate\.agents\.(topological|recurrent|frontier)\b")
    for path in SOURCES:
        module = module_of(path)
        names = imported(path.read_text(encoding="utf-8"))
        if package_of(module) == "agents":
            assert not [name for name in names if concrete.match(name)], path
        if package_of(module) == "worlds":
            assert not [name for name in names if agents.match(name)], path


def test_root_of_the_package_holds_few_modules():
    loose = [p.name for p in (ROOT / "mitigate").glob("*.py") if not p.name.startswith("__")]
    assert len(loose) <= 3, loose
