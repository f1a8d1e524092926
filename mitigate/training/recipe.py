"""Deprecated name of :mod:`mitigate.training.objective`, kept for users' subclasses."""

from __future__ import annotations

import warnings
from typing import Any

from mitigate.training.objective import Objective


def __getattr__(name: str) -> Any:
    if name != "Recipe":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn(
        "mitigate.training.recipe.Recipe is deprecated: import Objective from "
        "mitigate.training.objective.",
        DeprecationWarning,
        stacklevel=2,
    )
    return Objective
