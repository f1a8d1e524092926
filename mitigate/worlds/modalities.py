"""Check that observations contain the frames that a schedule corrupts."""

from __future__ import annotations

from collections.abc import Container, Iterable

from mitigate.corruptions.registry import record

ENTRY_FIX = "name the entry: CorruptObservation(..., {0}=...)"


def check_available(names: Iterable[str], available: Container[str], lack: str, fix: str) -> None:
    """Raise ValueError if an observation lacks the frames that a corruption changes.

    Args:
        names: Names of the corruptions.
        available: Modalities of the observation.
        lack: Part of the error message that describes what is missing. ``{0}`` is replaced by the
            modality.
        fix: Part of the error message that explains how to add the modality. ``{0}`` is replaced
            by the modality.
    """
    names = list(names)
    missing = [name for name in names if not any(m in available for m in record(name).modalities)]
    if not missing:
        return
    needed = record(missing[0]).modalities[0]
    usable = ", ".join(name for name in names if name not in missing)
    raise ValueError(
        f"{missing[0]!r} corrupts {needed}, but {lack.format(needed)}. "
        f"{f'Sample only from names=[{usable}]' if usable else 'Choose other corruptions'}, or "
        f"{fix.format(needed)}."
    )
