"""What may know what: read from the imports and the tree."""

from __future__ import annotations

import ast
import statistics
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
GENERAL = sorted(
    path
    for folder in ("recipes", "mitigate/training", "mitigate/evaluation", "mitigate/encoders")
    for path in (ROOT / folder).rglob("*.py")
)
CONCRETE = ("mitigate.worlds.apartments", "panda3d", "mitigate.agents.topological")
SOURCES = sorted(
    path for folder in ("mitigate", "recipes") for path in (ROOT / folder).rglob("*.py")
)


def imported(path: Path) -> set[str]:
    """Dotted names of all that a file imports, at its top or inside a function."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


@pytest.mark.parametrize("path", GENERAL, ids=lambda path: str(path.relative_to(ROOT)))
def test_recipes_training_and_evaluation_know_no_world_and_no_agent(path):
    known = [name for name in imported(path) if name.startswith(CONCRETE)]
    assert not known, f"{path.relative_to(ROOT)} imports {known}"


@pytest.mark.parametrize(
    "path", sorted((ROOT / "mitigate/core").glob("*.py")), ids=lambda p: p.name
)
def test_the_core_knows_no_package_above_it(path):
    allowed = ("mitigate.core", "mitigate.shipping.hardened", "mitigate.shipping")
    others = {name for name in imported(path) if name.startswith("mitigate")}
    assert not {name for name in others if not name.startswith(allowed) and name != "mitigate"}


def test_an_agent_knows_no_world_and_a_world_no_agent():
    for path in (ROOT / "mitigate/agents").rglob("*.py"):
        assert not [n for n in imported(path) if n.startswith("mitigate.worlds.apartments")], path
    for path in (ROOT / "mitigate/worlds").rglob("*.py"):
        assert not [n for n in imported(path) if n.startswith("mitigate.agents")], path


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
