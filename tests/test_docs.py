"""Tests of links, names and examples in the documentation."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from mitigate import cli

ROOT = Path(__file__).parent.parent
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *(p for d in ("docs", "recipes", "checkpoints") for p in (ROOT / d).rglob("*.md")),
    ]
)
LARGEST_PICTURE = 300_000  # bytes (ours)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_and_picture_exists(page):
    for target in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (page.parent / target).exists(), f"{page.name} names {target}"


def anchors(page: Path) -> set[str]:
    """Return the anchors that GitHub assigns to the headings of a page."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    titles = re.findall(r"^#+ (.*?)\s*$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_linked_heading_exists(page):
    links = re.findall(r"\]\(([^)#:]*)#([^)]+)\)", page.read_text(encoding="utf-8"))
    for target, heading in links:
        assert heading in anchors(page.parent / target if target else page), f"{target}#{heading}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_named_source_file_exists(page):
    text = page.read_text(encoding="utf-8")
    for name in re.findall(r"`((?:mitigate|recipes|conf|tests)/[\w/.]+)`", text):
        assert (ROOT / name).exists(), f"{page.name} names {name}"


def test_pictures_are_small():
    for picture in (ROOT / "docs/pictures").iterdir():
        assert picture.stat().st_size <= LARGEST_PICTURE, picture.name


def test_recipes_page_lists_every_recipe():
    names = [path.stem for path in (ROOT / "conf/recipe").glob("*.yaml")]
    text = (ROOT / "recipes/README.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` |" in text for name in names)


def python_blocks(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.S)


def shell_lines(page: Path) -> list[str]:
    blocks = re.findall(r"```bash\n(.*?)```", page.read_text(encoding="utf-8"), re.S)
    return [line.split("#")[0].strip() for block in blocks for line in block.splitlines()]


def test_readme_has_at_most_900_words():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= 900


@pytest.mark.slow
def test_readme_python_examples_run(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "checkpoints").symlink_to(ROOT / "checkpoints")
    first, second = python_blocks(ROOT / "README.md")
    exec(first, {})
    assert (tmp_path / "spatter.png").stat().st_size > 10_000
    exec(second, {})
    assert (tmp_path / "runs/first/rows.jsonl").exists()


@pytest.fixture
def mitigate(monkeypatch, capsys):
    """Run a ``mitigate`` command in this process and return its output."""
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "argv", ["mitigate"])
    monkeypatch.setattr(sys, "path", [*sys.path])

    def run(*options: str) -> str:
        with pytest.raises(SystemExit) as stop:
            cli.main(options)
        assert not stop.value.code
        return capsys.readouterr().out

    return run


@pytest.mark.slow
def test_readme_evaluation_runs(mitigate, tmp_path):
    line = next(line for line in shell_lines(ROOT / "README.md") if " evaluate " in line)
    options = line.removeprefix("mitigate ").replace("episodes=10", "episodes=1").split()
    assert "PRS-SR (Depth)" in mitigate(*options, f"out={tmp_path}")


@pytest.mark.slow
def test_readme_program_runs_and_loses_success(mitigate, tmp_path):
    line = next(line for line in shell_lines(ROOT / "README.md") if " run " in line)
    options = [f"out={tmp_path}", *shlex.split(line.removeprefix("mitigate run "))]
    options = [sys.executable if option == "python" else option for option in options]
    output = mitigate("run", *options)
    assert "| Clean SR | 100.0" in output and "| Missing data | 0.0" in output


@pytest.mark.slow
def test_habitat_tutorial_gives_its_table(mitigate, tmp_path):
    page = ROOT / "docs/tutorials/measure_a_habitat_agent.md"
    line = next(line for line in shell_lines(page) if " run " in line)
    options = [f"out={tmp_path}", *shlex.split(line.removeprefix("mitigate run "))]
    options = [sys.executable if option == "python" else option for option in options]
    output = mitigate("run", *options)
    table = re.findall(r"^\| [CLM].*\|$", page.read_text(encoding="utf-8"), re.M)
    assert len(table) == 4 and all(f"{row}\n" in output for row in table)


def test_corrupt_frames_tutorial_prints_what_it_shows(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs/tutorials/corrupt_frames.md"
    names: dict[str, object] = {}
    for block in python_blocks(page):
        exec(block, names)
    printed = re.search(r"```text\n(.*?)\n```", page.read_text(encoding="utf-8"), re.S)
    assert capsys.readouterr().out.strip() == printed[1]


@pytest.mark.parametrize(
    ("page", "script"),
    [("measure_a_program", "my_program"), ("measure_a_habitat_agent", "habitat_agent")],
)
def test_tutorial_shows_the_whole_program(page, script):
    folder = ROOT / "docs/tutorials"
    blocks = python_blocks(folder / f"{page}.md")
    assert blocks[0] == (folder / f"{script}.py").read_text(encoding="utf-8")


TUTORIALS = sorted(ROOT.glob("docs/tutorials/*.py"))


@pytest.mark.slow
@pytest.mark.parametrize("script", TUTORIALS, ids=lambda script: script.stem)
def test_tutorial_runs(script, tmp_path):
    bin_folder = Path(sys.executable).parent
    environment = {
        **os.environ,
        "PATH": f"{bin_folder}:{os.environ['PATH']}",
        "OMP_NUM_THREADS": "1",
    }
    environment["PYTHONPATH"] = str(ROOT)
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
