"""Hooks for MkDocs: add generated reference pages and pages from outside ``docs/``; fix links."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from mkdocs.structure.files import File, Files

from mitigate.cli import COMMANDS

ROOT = Path(__file__).resolve().parents[2]
PAGES = {  # page of the site: file in the checkout
    "changelog.md": "CHANGELOG.md",
    "checkpoints.md": "checkpoints/README.md",
    "contributing.md": "CONTRIBUTING.md",
    "recipes.md": "recipes/README.md",
    "security.md": "SECURITY.md",
}
CONFIGS = ("train", "evaluate", "run", "replay", "sweep", "table1", "table2", "export_drive")
ROLE = re.compile(r":(?:attr|class|data|func|meth|mod):<code>(?:~[\w.]*\.)?")  # of docstrings
CODE = re.compile(
    r"<pre.*?</pre>|<code.*?</code>|<span class=\"doc doc-object-name.*?</span>", re.S
)
BREAK = re.compile(r"([_./=,:(\[]+)(?=\w)")  # characters after which a long name may be broken
NAME = re.compile(r"(?<![&\w])[^\s<>&]{16,}")  # long names that are not in a tag or an HTML entity
CELL = re.compile(r"<td([^>]*)>(.*?)</td>", re.S)
# a line of a help text: name and meaning
OPTION = re.compile(r"^ {0,4}(\S+(?: \S+)*)(?: {2,}(.*))?$")
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!\w+:|#)([^)#\s]+)(#[^)\s]*)?\)")


def on_files(files: Files, config) -> Files:
    """Add the pages from outside ``docs/`` and the generated pages."""
    for page, source in PAGES.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=_relink(text, source, page)))
    style = (ROOT / "tools/site/site.css").read_text(encoding="utf-8")
    files.append(File.generated(config, "site.css", content=style))
    files.append(File.generated(config, "reference/commands.md", content=commands_page()))
    files.append(File.generated(config, "reference/configuration.md", content=configs_page()))
    return files


def on_page_markdown(markdown: str, page, config, files: Files) -> str:
    """Rewrite links of pages in ``docs/`` that point to other files of the checkout."""
    if page.file.generated_by:
        return markdown
    return _relink(markdown, f"docs/{page.file.src_uri}", page.file.src_uri)


def on_page_content(html: str, page, config, files: Files) -> str:
    """Render Sphinx roles in docstrings as code, and let long names and table cells fit on a
    phone.
    """
    html = ROLE.sub("<code>", html)
    return CELL.sub(_mark_long_cell, CODE.sub(_allow_breaks, html))


def _mark_long_cell(cell: re.Match) -> str:
    """Give long table cells a class for which the style sheet sets a minimum width."""
    text = re.sub(r"<[^>]*>", "", cell[2])
    return f'<td class="long"{cell[1]}>{cell[2]}</td>' if len(text) > 60 else cell[0]


def _allow_breaks(code: re.Match) -> str:
    """Let a browser break long names after punctuation; code blocks stay unchanged."""
    if code[0].startswith("<pre"):
        return code[0]
    parts = re.split(r"(<[^>]*>)", code[0])
    for i in range(0, len(parts), 2):  # the text between the tags
        parts[i] = NAME.sub(lambda name: BREAK.sub(r"\1<wbr>", name[0]), parts[i])
    return "".join(parts)


def _relink(text: str, source: str, page: str) -> str:
    """Make the links in ``source`` valid on ``page``; a link to a file without a page becomes plain
    text.
    """
    pages = {file: name for name, file in PAGES.items()}

    def replace(match: re.Match) -> str:
        image, label, path, anchor = match.groups(default="")
        target = os.path.normpath(os.path.join(os.path.dirname(source), path))
        if target == "README.md":
            name, anchor = "index.md", ""
        elif target in pages:
            name = pages[target]
        elif target.startswith("docs/") and not target.startswith("docs/leaderboard/"):
            name = target.removeprefix("docs/")
        else:
            return label
        return f"{image}[{label}]({os.path.relpath(name, os.path.dirname(page) or '.')}{anchor})"

    return LINK.sub(replace, text)


def commands_page() -> str:
    """Return the page that lists each command with its help."""
    parts = [
        "# Commands",
        "",
        "`mitigate COMMAND [OPTIONS]`. Each command prints its help with `--help`.",
    ]
    for name, command in COMMANDS.items():
        help_text = subprocess.run(
            [sys.executable, "-c", "from mitigate.cli import main; main()", name, "--help"],
            capture_output=True,
            text=True,
            cwd=ROOT,
            check=True,
        ).stdout
        parts += ["", f"## {name}", "", f"{command.about[0].upper()}{command.about[1:]}.", ""]
        parts += _help(help_text)
    return "\n".join(parts)


def _help(text: str) -> list[str]:
    """Return the help of a command as Markdown: paragraphs, commands, options and tables."""
    parts: list[str] = []
    previous = ""
    for block in text.strip().split("\n\n"):
        lines = block.splitlines()
        if block.startswith("usage:"):
            parts += ["```text", " ".join(block.split()), "```", ""]
        elif all(line.lstrip().startswith("mitigate ") for line in lines):
            parts += ["```bash", *(line.strip() for line in lines), "```", ""]
        elif previous.endswith("defaults:"):
            parts += ["```yaml", block, "```", ""]
        elif re.match(r".*:\n {2,}\S", block):  # a section such as "options:" in argparse's help
            parts += [lines[0].capitalize(), "", *_option_table(lines[1:]), ""]
        elif re.match(r" {2,}\S|\S+ {2,}", block):
            parts += [*_option_table(lines), ""]
        else:
            parts += [block.replace("``", "`"), ""]
        previous = block
    return parts


def _option_table(lines: list[str]) -> list[str]:
    """Return a table of names and meanings; a line with a larger indentation continues the meaning
    above.
    """
    rows: list[list[str]] = []
    for line in lines:
        match = OPTION.match(line)
        if match:
            rows.append([match[1], match[2] or ""])
        else:
            rows[-1][1] += f" {line.strip()}"
    table = [f"| `{name}` | {meaning.strip()} |" for name, meaning in rows]
    return ["| Name | Meaning |", "|---|---|", *table]


def configs_page() -> str:
    """Return the page of all options of the Hydra commands: their config files with comments."""
    parts = [
        "# Configuration",
        "",
        "Every option of a command is an entry of its file in `conf/`. Set it as `name=value`, and",
        "nested entries with dots: `trainer.lr=1e-4`.",
    ]
    groups = ("agent", "env", "schedule", "suite", "launcher", "experiment", "debug", "recipe")
    for name in CONFIGS:
        parts += _yaml(f"{name}.yaml")
    for group in groups:
        for path in sorted((ROOT / "conf" / group).glob("*.yaml")):
            parts += _yaml(f"{group}/{path.name}")
    return "\n".join(parts)


def _yaml(name: str) -> list[str]:
    text = (ROOT / "conf" / name).read_text(encoding="utf-8").strip()
    return ["", f"## `{name}`", "", "```yaml", text, "```"]
