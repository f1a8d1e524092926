"""What an evaluation asks for by name: the conditions of a suite, as corruptions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from omegaconf import OmegaConf

from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB

if TYPE_CHECKING:
    from mitigate.corruptions import Corruption


def suite_of(*modalities: str) -> list[str]:
    """What ``${suite:rgb,depth}`` is in a config: clean, and the suite's corruptions of these."""
    from mitigate.corruptions.registry import names

    return ["clean", *names(*modalities)]


def unseen_of(half: str, *modalities: str) -> list[str]:
    """What ``${unseen:test,rgb,depth}`` is in a config: clean, and the unseen corruptions of these,
    of the half "validation" or "test", or of "both"."""
    from mitigate.corruptions.registry import unseen_names

    return ["clean", *unseen_names(*modalities, half="" if half == "both" else half)]


OmegaConf.register_new_resolver("suite", suite_of, replace=True)
OmegaConf.register_new_resolver("unseen", unseen_of, replace=True)


def suite_conditions(suite: Mapping[str, Any]) -> list[str]:
    """Return the names of a suite's conditions. Raises ValueError for a suite without them."""
    if "conditions" not in suite:
        raise ValueError("suite has no conditions. List them in its file: conditions: [clean, ...]")
    return list(suite["conditions"])


def conditions(names: list[str], severity: float, severity_depth: float | None) -> list:
    """Return one Corruption for each name or pair of names, once; ``clean`` has severity 0.

    Raises ValueError for no name, an unknown one, and two severities of a pair.
    """
    from mitigate.corruptions import CLEAN, Corruption
    from mitigate.corruptions.registry import known, parts
    from mitigate.corruptions.suite import check_severity

    allowed = ("clean", *known("rgb", "depth", "instruction"))
    if not names:
        raise ValueError(
            "conditions=[] names none: give some, such as [clean,spatter], or null for the suite's."
        )
    for part in (part for name in names for part in parts(name)):
        if part not in allowed:
            raise ValueError(unknown("condition", part, allowed))
    severity = check_severity(severity)  # also where all conditions are clean
    depth = severity if severity_depth is None else check_severity(severity_depth)
    found = [
        CLEAN if name == "clean" else Corruption(name, severity) for name in dict.fromkeys(names)
    ]
    for place, corruption in enumerate(found):
        if corruption.modality == "depth":
            found[place] = Corruption(corruption.name, depth)
        elif "depth" in corruption.modalities and depth != severity:
            raise ValueError(
                f"The pair {corruption.name} has one severity, but severity is {severity:g} and "
                f"severity_depth {depth:g}. Leave severity_depth out, or the pair."
            )
    return found


def check_sensors(met: Iterable[Corruption], sensors: Iterable[str], world: str) -> None:
    """Raise ValueError for corruptions of what the world named ``world`` does not show."""
    shown = [*sensors]
    lost = [c.name for c in met if not {*c.modalities} <= {*shown, "instruction"}]
    if lost:
        able = [name for name in (RGB, DEPTH) if name in shown]
        other = (
            f"Choose another, such as suite={able[0]}."
            if able
            else f"Frames that are to be corrupted are called {RGB} and {DEPTH}: name them so in "
            "the world's sensors (of GymWorld: entries=)."
        )
        raise ValueError(
            f"The suite has {', '.join(lost)}, but the world {world} shows only "
            f"{', '.join(shown)}. {other}"
        )
