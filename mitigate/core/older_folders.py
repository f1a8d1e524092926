"""Read folders of earlier versions; only ``core/folders.py`` uses this module.

- For weights, adapters, encoders, restorers and safeguards, each file had a sidecar
  ``<file>.sha256`` (``core/checksums.py``) or no checksum.
- The ``card.json`` of a hardened folder contained the sha256 of every file and of the card itself.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from mitigate.core.json_files import read_object
from mitigate.core.names import short

CARD = "card.json"
FORMAT = 1


def card_files(folder: Path, again: str) -> dict[str, Any] | None:
    """Return the sha256 of every file, by name, from the card of a hardened folder.

    Returns None for any other folder.

    Raises:
        ValueError: If the card is invalid. The message ends with the text ``again``, which says
            how to continue.
    """
    file = folder / CARD
    card = read_object(file, again) if file.is_file() else {}
    if "sha256" not in card:
        return None
    if card.get("format") != FORMAT:
        raise ValueError(
            f"{file} must be a card of format {FORMAT}, got {short(card.get('format'))}. {again}"
        )
    if card["sha256"] != card_sha(card):
        raise ValueError(f"{file} does not have the sha256 that it states: it was changed. {again}")
    if not isinstance(card.get("files"), dict):
        raise ValueError(f"{file} has no list of files. {again}")
    return dict(card["files"])


def card_sha(card: dict[str, Any]) -> str:
    """Return the sha256 of a card: of all its entries except "sha256", as sorted JSON."""
    entries = {name: value for name, value in card.items() if name != "sha256"}
    return hashlib.sha256(json.dumps(entries, sort_keys=True).encode()).hexdigest()


def without_sums(card: dict[str, Any]) -> dict[str, Any]:
    """Return a card without its checksums, which are now stored in the manifest."""
    return {name: value for name, value in card.items() if name not in ("sha256", "files")}
