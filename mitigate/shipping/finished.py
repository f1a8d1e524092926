"""The run that is exported: its config and its agent, and what is said of a folder that is none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch

from mitigate.agents import hardened
from mitigate.agents.loading import refuse_what_ships_as_it_is
from mitigate.core import checkpoint, settings
from mitigate.shipping.others import Walks

_TRAIN = "Run `make train` to the end, then name its folder (runs/...)."


def finished(run: Path, walks: Walks | None = None) -> tuple[dict[str, Any], Any]:
    """Return the config and the agent of the finished run in the folder ``run``.

    Raises FileNotFoundError if there is none, ValueError for a run of what ships as it is, of a
    kind of agent that needs ``walks``, and for weights that do not fit float16.
    """
    weights, config = run / "agent" / checkpoint.WEIGHTS, run / hardened.CONFIG
    refuse_what_ships_as_it_is(run)
    if not (weights.is_file() and config.is_file()):
        inside = run.name == "agent" and (run / checkpoint.WEIGHTS).is_file()
        raise FileNotFoundError(
            f"{run} holds no finished run: it needs config.yaml and agent/{checkpoint.WEIGHTS}. "
            + (f"Name the run: {run.parent}." if inside else _TRAIN)
        )
    kind = hardened.kind_of(config)
    if walks is None and kind != hardened.TARGET:
        raise ValueError(
            f"{run} holds a {kind.rpartition('.')[2]}, of which a folder without programs is "
            "written: give walks to check it by (on the command line: "
            f"agent={settings.named(kind)})."
        )
    agent = hardened.build(config) if walks is None else walks.make_agent()
    checkpoint.load_weights(agent, weights)
    if walks is None and not all(
        torch.isfinite(value.half()).all() for value in agent.state_dict().values()
    ):
        raise ValueError(f"{weights} holds numbers that are not finite in float16.")
    return settings.read(config), agent.eval()
