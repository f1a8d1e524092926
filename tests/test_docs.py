"""What the Markdown files name is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *(p for d in ("docs", "recipes", "checkpoints") for p in (ROOT / d).rglob("*.md")),
    ]
)
LARGEST_PICTURE = 300_000  # bytes (ours)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_and_picture_is_there(page):
    for target in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (page.parent / target).exists(), f"{page.name} names {target}"


def anchors(page: Path) -> set[str]:
    """What GitHub calls the headings of a page."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    titles = re.findall(r"^#+ (.*?)\s*$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_heading_that_a_link_names_is_there(page):
    links = re.findall(r"\]\(([^)#:]*)#([^)]+)\)", page.read_text(encoding="utf-8"))
    for target, heading in links:
        assert heading in anchors(page.parent / target if target else page), f"{target}#{heading}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_source_file_named_is_there(page):
    text = page.read_text(encoding="utf-8")
    for name in re.findall(r"`((?:mitigate|recipes|conf|tests)/[\w/.]+)`", text):
        assert (ROOT / name).exists(), f"{page.name} names {name}"


def test_pictures_are_small():
    for picture in (ROOT / "docs/pictures").iterdir():
        assert picture.stat().st_size <= LARGEST_PICTURE, picture.name


def test_the_recipe_menus_list_every_recipe():
    names = [path.stem for path in (ROOT / "conf/recipe").glob("*.yaml")]
    for page in (ROOT / "README.md", ROOT / "recipes/README.md"):
        text = page.read_text(encoding="utf-8")
        assert all(f"| `{name}` |" in text for name in names)


def test_the_lines_in_the_readme_run_as_they_are(monkeypatch):
    """Those about adapters are run in ``tests/agents/test_adapters.py``."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = [b for b in re.findall(r"```python\n(.*?)```", readme, re.S) if "my-adapt" not in b]
    monkeypatch.chdir(ROOT)
    held: dict[str, object] = {}
    for block in blocks:
        exec(block, held)
    assert held["action"] in (0, 1, 2, 3) and held["corrupted"].shape == (480, 640, 3)
    assert len(blocks) == 2
