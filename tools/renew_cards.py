"""Write the README of hardened folders anew from their cards: python tools/renew_cards.py DIR...

For folders that an older version exported. Each is checked first; the new one is made aside and
renamed into place, with the README's new sum in the card. Nothing else in it changes.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path

from mitigate.core.conf import said
from mitigate.core.files import put_folder, sha256
from mitigate.shipping import hardened
from mitigate.shipping.card import readme


def renew(folder: Path) -> None:
    """Rewrite ``folder``. Raises FileNotFoundError or ValueError if it is not whole; it is then as
    it was."""
    card = hardened.check(folder)
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as aside:
        draft = Path(shutil.copytree(folder, Path(aside) / folder.name))
        page = draft / hardened.README
        page.write_text(readme(card), encoding="utf-8")
        card["files"][hardened.README] = sha256(page)
        card["sha256"] = hardened.card_sha(card)
        text = json.dumps(card, indent=2, allow_nan=False) + "\n"
        (draft / hardened.CARD).write_text(text, encoding="utf-8")
        hardened.check(draft)
        put_folder(draft, folder, Path(aside) / "old")


def main() -> None:
    """Read the command line."""
    folders = [Path(name).resolve() for name in sys.argv[1:]]
    if not folders:
        sys.exit(__doc__)
    for folder in folders:
        try:
            renew(folder)
        except (OSError, ValueError) as error:
            sys.exit(f"error: {said(error)}")
        print(f"wrote {folder / hardened.README}")


if __name__ == "__main__":
    main()
