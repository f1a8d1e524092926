"""Corrupt, mitigate, measure and ship hardened navigation agents."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mitigate.hardened import load_hardened

__all__ = ["load_hardened"]


def __getattr__(name: str) -> Any:
    """Import ``load_hardened``, and torch with it, when it is first asked for."""
    if name in __all__:
        from mitigate import hardened

        return getattr(hardened, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
