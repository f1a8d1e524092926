"""The agent in a folder, whatever wrote it: an export, a training, or this project.

Which kind it is stands, as data, in ``config.yaml``; only kinds of ours are built, and nothing else
in the folder is run.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import torch

from mitigate.core import checkpoint
from mitigate.core.files import find
from mitigate.shipping import given, hardened
from mitigate.shipping.finished import refuse_what_ships_as_it_is

_AGAIN = "Name the folder `agent` of a run."


def load(folder: str | Path, *, agent: Any = None) -> Any:
    """Return the agent in ``folder`` on the CPU, in eval mode, ready for ``reset``.

    Args:
        folder: a hardened one (as :func:`hardened.load_hardened`), shipped weights
            (``checkpoints/recurrent/base``), or the folder ``agent`` of a run; looked for from
            here, then in this project.
        agent: an agent of a class of your own, with the settings of the one that was trained, to be
            filled in place; None: one of ours, built here.
    Raises FileNotFoundError or ValueError, naming the file, for weights that are missing, damaged
    or do not say what agent they are of, and for an agent that is not ours and not given, or is
    not the one given; TypeError for a folder that is no path or an agent without weights.
    """
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(
            f"folder must be the path of an agent's weights, not {folder!r:.60}: name one, such as "
            "checkpoints/base."
        )
    place = find(folder)
    if (place / hardened.CARD).is_file():
        return hardened.load_hardened(place, agent=agent)
    refuse_what_ships_as_it_is(place)
    if (place / "agent").is_dir():
        raise ValueError(f"{folder} is the folder of a run: name its agent, {place / 'agent'}.")
    config = hardened.config_of(place)
    if agent is not None:
        return _filled(agent, place, config)
    if not config.is_file():
        raise FileNotFoundError(f"{config} is missing, so nobody knows what agent {folder} is of.")
    with torch.random.fork_rng(devices=[]):  # the caller's random numbers stay as they are
        agent = hardened.build(config)
    checkpoint.load_agent(agent, place)
    return agent.eval()


def _filled(agent: Any, place: Path, config: Path) -> Any:
    """``agent`` in eval mode with the weights of ``place``, whose settings, if it has any, must not
    be others."""
    given.check_fillable(agent)
    said = config.is_file()
    if said:
        given.check_same(agent, config, _AGAIN)
    checkpoint.load_agent(agent, place)
    if said:
        given.give_settings(agent, config, _AGAIN)
    return agent.eval()
