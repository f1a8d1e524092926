"""Rewrite the README of hardened folders from their cards: python tools/renew_cards.py DIR...

This is for folders that an older version exported. Each folder is checked first. A copy with the
new README and a manifest replaces the folder. Other files do not change, except that ``--rows
FILE...`` adds the agent of these rows to a card, if the rows belong to its weights.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from mitigate.agents import loading
from mitigate.core import folders, older_folders
from mitigate.core.errors import error_message
from mitigate.core.files import put_folder
from mitigate.evaluation.rows import Row, gather
from mitigate.shipping.card import readme, rows_agent


def renew(folder: Path, rows: Sequence[Row] = ()) -> None:
    """Rewrite ``folder``.

    Raises:
        FileNotFoundError: A file is missing (the folder is not changed).
        ValueError: A file is damaged (the folder is not changed).
    """
    card = loading.check_hardened(folder)
    agent = rows_agent(rows, {card["agent"], card["run_agent"]})
    if agent:
        card["rows_agent"] = agent
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as temporary:
        draft = Path(shutil.copytree(folder, Path(temporary) / folder.name))
        page = draft / loading.README
        card = {**older_folders.without_sums(card), "format": loading.FORMAT}
        page.write_text(readme(card), encoding="utf-8")
        text = json.dumps(card, indent=2, allow_nan=False) + "\n"
        (draft / loading.CARD).write_text(text, encoding="utf-8")
        folders.seal(draft, "hardened")
        loading.check_hardened(draft)
        put_folder(draft, folder, Path(temporary) / "old")


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="+", type=Path, help="hardened folders")
    parser.add_argument("--rows", nargs="+", default=[], help="row files of their evaluations")
    arguments = parser.parse_intermixed_args()
    try:
        rows = gather(arguments.rows) if arguments.rows else []
        for folder in arguments.folders:
            renew(folder.resolve(), rows)
            print(f"wrote {folder / loading.README}")
    except (OSError, ValueError) as error:
        sys.exit(f"error: {error_message(error)}")


if __name__ == "__main__":
    main()
