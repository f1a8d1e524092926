"""Check that an observation has the frames that a schedule corrupts."""

from __future__ import annotations

from collections.abc import Container, Iterable

from mitigate.corruptions.registry import record

ENTRY_FIX = "name the entry: CorruptObservation(..., {0}=...)"


def check_available(names: Iterable[str], available: Container[str], lack: str, fix: str) -> None:
    """Check that the modality of every corruption is available.

    Args:
        names: Names of the corruptions.
        available: Modalities of the observation.
        lack: Text on the missing part for the message; ``{0}`` becomes the modality.
        fix: Alternative to leaving corruptions out; ``{0}`` becomes the modality.

    Raises:
        ValueError: A modality is missing.
    """
    names = list(names)
    missing = [name for name in names if not any(m in available for m in record(name).modalities)]
    if not missing:
        return
    needed = record(missing[0]).modalities[0]
    usable = ", ".join(name for name in names if name not in missing)
    raise ValueError(
        f"{missing[0]!r} corrupts {needed}, but {lack.format(needed)}. "
        f"{f'Draw only from names=[{usable}]' if usable else 'Choose other corruptions'}, or "
        f"{fix.format(needed)}."
    )
