"""Write the README of hardened folders anew from their cards: python tools/renew_cards.py DIR...

For folders that an older version exported. Each is checked first; the new one is made aside and
renamed into place, with a manifest. Nothing else in it changes, but that
``--rows FILE...`` adds to a card which agent those rows are of, where they are of its weights.
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
from mitigate.core.errors import said
from mitigate.core.files import put_folder
from mitigate.evaluation.rows import Row, gather
from mitigate.shipping.card import readme, rows_agent


def renew(folder: Path, rows: Sequence[Row] = ()) -> None:
    """Rewrite ``folder``. Raises FileNotFoundError or ValueError if it is not whole; it is then as
    it was."""
    card = loading.check_hardened(folder)
    named = rows_agent(rows, {card["agent"], card["run_agent"]})
    if named:
        card["rows_agent"] = named
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as aside:
        draft = Path(shutil.copytree(folder, Path(aside) / folder.name))
        page = draft / loading.README
        card = {**older_folders.without_sums(card), "format": loading.FORMAT}
        page.write_text(readme(card), encoding="utf-8")
        text = json.dumps(card, indent=2, allow_nan=False) + "\n"
        (draft / loading.CARD).write_text(text, encoding="utf-8")
        folders.seal(draft, "hardened")
        loading.check_hardened(draft)
        put_folder(draft, folder, Path(aside) / "old")


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="+", type=Path, help="hardened folders")
    parser.add_argument("--rows", nargs="+", default=[], help="row files of their evaluations")
    given = parser.parse_intermixed_args()
    try:
        rows = gather(given.rows) if given.rows else []
        for folder in given.folders:
            renew(folder.resolve(), rows)
            print(f"wrote {folder / loading.README}")
    except (OSError, ValueError) as error:
        sys.exit(f"error: {said(error)}")


if __name__ == "__main__":
    main()
