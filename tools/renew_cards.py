"""Write the README of hardened folders again from their cards: python tools/renew_cards.py DIR...

For folders that an older version exported. Each folder is checked first; the new one replaces it
by a rename. The card gets the new sum of the README and loses that of a missing ``program.pt2``.
``--rows FILE...`` adds the agent of those rows to the card, if they are of its weights.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from mitigate.agents import hardened
from mitigate.core.errors import said
from mitigate.core.files import put_folder, sha256
from mitigate.evaluation.rows import Row, gather
from mitigate.shipping.card import readme, rows_agent


def renew(folder: Path, rows: Sequence[Row] = ()) -> None:
    """Rewrite ``folder``. Raises FileNotFoundError or ValueError if it is not whole; it is then as
    it was."""
    card = hardened.check(folder)
    named = rows_agent(rows, {card["agent"], card["run_agent"]})
    if named:
        card["rows_agent"] = named
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as aside:
        draft = Path(shutil.copytree(folder, Path(aside) / folder.name))
        page = draft / hardened.README
        page.write_text(readme(card), encoding="utf-8")
        card["files"][hardened.README] = sha256(page)
        if not (draft / hardened.PROGRAM).exists():
            card["files"].pop(hardened.PROGRAM, None)
        card["sha256"] = hardened.card_sha(card)
        text = json.dumps(card, indent=2, allow_nan=False) + "\n"
        (draft / hardened.CARD).write_text(text, encoding="utf-8")
        hardened.check(draft)
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
            print(f"wrote {folder / hardened.README}")
    except (OSError, ValueError) as error:
        sys.exit(f"error: {said(error)}")


if __name__ == "__main__":
    main()
