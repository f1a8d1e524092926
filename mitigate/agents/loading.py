"""The agent in a folder, whatever wrote it: an export, a training, or this project.

Which kind it is stands, as data, in ``config.yaml``; only kinds of ours are built, and nothing else
in the folder is run.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

import torch
from omegaconf import OmegaConf
from torch import nn

from mitigate.agents import given, hardened
from mitigate.core import checkpoint, seeding, settings
from mitigate.core.build import build, located, plain
from mitigate.core.files import find
from mitigate.core.names import unknown
from mitigate.core.options import values

# attribute of an agent's class: arguments that name code or files, which no config that came with
# weights may set
OWN_CONFIG_ONLY = "own_config_only"
LORA = "adapter_model.safetensors"  # PEFT's name for it
# By package, the page on what is trained there: its folder `agent` is used as it is.
PAGES = {
    "mitigate.encoders": "docs/encoder.md",
    "mitigate.guards.frames": "docs/restoration.md",
    "mitigate.guards.text": "docs/safeguard.md",
}
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


def refuse_what_ships_as_it_is(run: Path) -> None:
    """Raise ValueError for the run, or its folder ``agent``, of what is no navigation agent."""
    config = run / hardened.CONFIG
    held = settings.read(config).get("agent") if config.is_file() else None
    target = str(held.get("_target_")) if isinstance(held, dict) else ""
    page = next((page for start, page in PAGES.items() if target.startswith(f"{start}.")), "")
    if page:
        made = run / "agent" if (run / "agent").is_dir() else run
        raise ValueError(
            f"{run} holds no agent that walks but a {target.rpartition('.')[2]}, which needs no "
            f"export: {made} ships as it is. {page} says how it is used."
        )


def settings_of(
    node: Mapping[str, Any], weights: str, overrides: Sequence[str] = ()
) -> dict[str, Any]:
    """Return ``node`` with the settings that ``weights`` carry (:func:`carried`, errors too).

    What the command line sets counts more (``overrides``: ``agent.blind=[rgb]``); ``agent=mine``
    names the class, and what the weights do not say.
    """
    keys = [override.lstrip("+").partition("=")[0].split(".") for override in overrides]
    named = {key[1] for key in keys if key[0] == "agent" and len(key) > 1}
    found = plain(OmegaConf.merge(plain(node), carried(node, weights)))
    given = plain(node)
    for setting in named:
        found[setting] = given[setting]
    return found


def begun_from(node: Mapping[str, Any], weights: str | None) -> Mapping[str, Any]:
    """Return ``node`` with the settings that it leaves open (null, or not named: adapters, the
    vocabulary) as in the ``weights`` that a training begins from; None: as it is. Errors as of
    :func:`carried`."""
    if weights is None:
        return node
    open_ = {k: v for k, v in carried(node, weights).items() if node.get(k) is None}
    return plain(OmegaConf.merge(plain(node), open_))


def carried(node: Mapping[str, Any], weights: str) -> dict[str, Any]:
    """Return the settings of the agent that ``weights`` belong to, none if they do not say.

    They come, as data, from ``config.yaml`` beside the weights. Raises ValueError if the weights
    are those of another kind of agent than ``node``, or if the file holds anything but plain data
    that the agent takes (:func:`mitigate.core.settings.read_agent`).
    """
    weights = str(find(weights))
    if (Path(weights) / LORA).is_file() and hasattr(located(node["_target_"]), "load"):
        return {}  # a language model says itself whose adapter it takes
    file = hardened.config_of(Path(weights))
    if not file.is_file():
        return {}
    if hardened.is_ours(node["_target_"]):
        return hardened.agent_settings(file, node["_target_"])
    made = located(node["_target_"])
    names = {*signature(made).parameters, *map(str, node)} - {"_target_"}
    names -= set(getattr(made, OWN_CONFIG_ONLY, ()))
    return settings.read_agent(file, node["_target_"], names)


def agent_option(options: Sequence[str], weights: str) -> list[str]:
    """The option ``agent=`` of the kind of agent that ``weights`` are of, with which what it asks
    of the world comes. None where ``options`` choose one, and where that kind is the usual one,
    none of ours, or not to be known."""
    if any(option.lstrip("+~").partition("=")[0] == "agent" for option in options):
        return []
    try:
        kind = hardened.kind_of(hardened.config_of(find(weights)))
    except (OSError, ValueError):  # told where they are loaded
        return []
    name = "" if kind == hardened.TARGET else settings.named(kind)
    return [f"agent={name}"] if name else []


def with_kind(options: Sequence[str]) -> list[str]:
    """The ``options`` of an evaluation, with the kind of agent that its ``checkpoint=`` is of."""
    weights = values(options, "checkpoint")
    own = agent_option(options, weights[0]) if len(weights) == 1 else []
    return [*options, *own]


def build_agent(
    node: Mapping[str, Any], *, weights: str | None, seed: int, parts: Sequence[str] | None = None
) -> nn.Module:
    """Return the agent of ``node``, its first weights drawn from ``seed`` or read from a file;
    ``parts``: of its ``parts()``, those that are read; None: all."""
    weights = None if weights is None else str(find(weights))
    if hardened.is_ours(node["_target_"]):  # numbers that would take all memory, patterns for ever
        hardened.check_own(plain(node))
    seeding.seed_everything(seed, "agent")
    agent = build(node)
    if weights is not None and not hasattr(agent, "state_dict"):
        raise ValueError(
            f"A {type(agent).__name__} is no torch.nn.Module, which weights could fill: leave out "
            f"{weights}, and let it read them itself."
        )
    if not hasattr(agent, "settings"):  # those of its config are what is known of it
        known = {k: v for k, v in plain(node).items() if k != "_target_"}
        try:
            agent.settings = partial(dict, known)
        except (AttributeError, TypeError) as error:  # of a class with slots, or one that is frozen
            raise ValueError(
                f"{type(agent).__name__} takes no attribute settings ({error}): give it a method "
                "settings() that returns its constructor's arguments."
            ) from error
    if weights is not None and parts:
        for name in parts:
            if name not in agent.parts():
                raise ValueError(unknown("part of the agent", name, agent.parts()))
            checkpoint.load_part(agent.parts()[name], name, weights)
    elif weights is not None and hardened.is_hardened(weights):
        hardened.fill(agent, weights)
    elif weights is not None:
        checkpoint.load_agent(agent, weights)
    return agent
