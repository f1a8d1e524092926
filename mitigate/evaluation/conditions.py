"""Convert the names of corruptions in a suite to the conditions of an evaluation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from omegaconf import OmegaConf

from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB

if TYPE_CHECKING:
    from mitigate.corruptions import Corruption


def suite_of(*modalities: str) -> list[str]:
    """Resolve ``${suite:rgb,depth}`` in a config to "clean" and all corruptions of these sensors in
    the standard suite.
    """
    from mitigate.corruptions.registry import names

    return ["clean", *names(*modalities)]


def unseen_of(half: str, *modalities: str) -> list[str]:
    """Resolve ``${unseen:test,rgb,depth}`` in a config to "clean" and the unseen corruptions of
    these sensors.

    ``half`` selects the set of unseen corruptions: "validation", "test" or "both".
    """
    from mitigate.corruptions.registry import unseen_names

    return ["clean", *unseen_names(*modalities, half="" if half == "both" else half)]


OmegaConf.register_new_resolver("suite", suite_of, replace=True)
OmegaConf.register_new_resolver("unseen", unseen_of, replace=True)


def suite_conditions(suite: Mapping[str, Any]) -> list[str]:
    """Return the names of a suite's conditions; raise ValueError if the suite has no conditions."""
    if "conditions" not in suite:
        raise ValueError(
            "suite has no conditions. Add a list to its file, such as conditions: [clean, spatter]"
        )
    return list(suite["conditions"])


def conditions(names: list[str], severity: float, severity_depth: float | None) -> list:
    """Return one Corruption per name, without repetitions; a name may be a pair, and "clean" gets
    severity 0.

    Raises:
        ValueError: If there are no names, if a name is unknown, or if the corruptions of a pair
            would have different severities.
    """
    from mitigate.corruptions import CLEAN, Corruption
    from mitigate.corruptions.registry import AND, FAULTS, known, parts
    from mitigate.corruptions.suite import check_gate, check_severity

    allowed = ("clean", *known("rgb", "depth", "instruction"), *FAULTS)
    if not names:
        raise ValueError(
            "conditions must not be empty. Give a list, such as [clean,spatter], or null for the "
            "conditions of the suite."
        )
    for part in (part for name in names for part in parts(name)):
        if part not in allowed:
            raise ValueError(unknown("condition", part, allowed))
    severity = check_severity(severity)  # the check is needed even if all conditions are clean
    depth = severity if severity_depth is None else check_severity(severity_depth)
    corruptions = [
        CLEAN if name == "clean" else check_gate(Corruption(name, severity))
        for name in dict.fromkeys(names)
    ]
    for place, corruption in enumerate(corruptions):
        if corruption.modality == "depth":
            corruptions[place] = Corruption(corruption.name, depth)
        elif AND in corruption.name and "depth" in corruption.modalities and depth != severity:
            raise ValueError(
                f"Both corruptions of the pair {corruption.name} have the same severity, but "
                f"severity is {severity:g} and severity_depth is {depth:g}. Leave out "
                "severity_depth or the pair."
            )
    return corruptions


def check_sensors(met: Iterable[Corruption], sensors: Iterable[str], world: str) -> None:
    """Raise ValueError if ``met`` contains corruptions of sensors that the world lacks; ``world``
    is its name.

    A fault that affects both sensors may also be used if only one of them exists.
    """
    from mitigate.corruptions.record import ACTION
    from mitigate.corruptions.registry import record

    available = [*sensors]
    usable_parts = {*available, "instruction", ACTION}
    missing = [
        corruption.name
        for corruption in met
        if not all(usable_parts.intersection(record(p.name).modalities) for p in corruption.parts)
    ]
    if missing:
        solution = (
            f"Only frames named {RGB} and {DEPTH} are corrupted: use these names for the world's "
            "sensors (entries= of GymWorld)."
        )
        if usable := [name for name in (RGB, DEPTH) if name in available]:
            solution = f"Choose another suite, such as suite={usable[0]}."
        raise ValueError(
            f"The suite contains {', '.join(missing)}, but the world {world} has only the sensors "
            f"{', '.join(available)}. {solution}"
        )
