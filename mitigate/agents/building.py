"""Agents for a run: built from its config, with the settings of the weights that it begins from.

Agents from folders alone are in ``loading.py``, which needs neither Hydra nor OmegaConf.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from inspect import signature
from typing import Any

from omegaconf import OmegaConf
from torch import nn

from mitigate.agents import loading, schema
from mitigate.agents.agent import stated_settings
from mitigate.core import checkpoint, seeding, settings
from mitigate.core.build import build, located, plain
from mitigate.core.contracts import read
from mitigate.core.files import find
from mitigate.core.names import unknown
from mitigate.core.options import values

LORA = "adapter_model.safetensors"  # PEFT's name


def build_agent(
    node: Mapping[str, Any], *, weights: str | None, seed: int, parts: Sequence[str] | None = None
) -> nn.Module:
    """Return the agent of ``node``, its first weights drawn from ``seed`` or read from a file;
    ``parts``: of its ``parts()``, those that are read; None: all."""
    weights = None if weights is None else str(find(weights))
    if loading.is_ours(node["_target_"]):  # numbers that would take all memory, patterns for ever
        _check_own(plain(node))
    seeding.seed_everything(seed, "agent")
    agent = build(node)
    if weights is not None and not hasattr(agent, "state_dict"):  # any class of a config
        raise ValueError(
            f"A {type(agent).__name__} is no torch.nn.Module, which weights could fill: leave out "
            f"{weights}, and let it read them itself."
        )
    if stated_settings(agent) is None:  # those of its config are what is known of it
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
    elif weights is not None and loading.is_hardened(weights):
        loading.fill(agent, weights)
    elif weights is not None:
        checkpoint.load_agent(agent, weights)
    return agent


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

    They come, as data, from ``config.yaml`` beside the weights.

    Raises:
        ValueError: The weights are those of another kind of agent than ``node``, or the file holds
            anything but plain data that the agent takes.
    """
    place = find(weights)
    if (place / LORA).is_file() and hasattr(located(node["_target_"]), "load"):
        return {}  # only language models have load(), and say themselves whose adapter they take
    file = loading.config_of(place)
    if not file.is_file():
        return {}
    if loading.is_ours(node["_target_"]):
        return loading.agent_settings(file, node["_target_"])
    made = located(node["_target_"])
    names = {*signature(made).parameters, *map(str, node)} - {"_target_"}
    names -= {*read(made, "own_config_only", default=())}
    return settings.read_agent(file, node["_target_"], names)


def agent_option(options: Sequence[str], weights: str) -> list[str]:
    """The option ``agent=`` of the kind of agent that ``weights`` are of, with which what it asks
    of the world comes. None where ``options`` choose one, and where that kind is the usual one,
    none of ours, or not to be known."""
    if any(option.lstrip("+~").partition("=")[0] == "agent" for option in options):
        return []
    try:
        kind = loading.kind_of(loading.config_of(find(weights)))
    except (OSError, ValueError):  # reported where they are loaded
        return []
    name = "" if kind == loading.TARGET else settings.named(kind)
    return [f"agent={name}"] if name else []


def with_kind(options: Sequence[str]) -> list[str]:
    """The ``options`` of an evaluation, with the kind of agent that its ``checkpoint=`` is of."""
    weights = values(options, "checkpoint")
    own = agent_option(options, weights[0]) if len(weights) == 1 else []
    return [*options, *own]


def _check_own(held: dict[str, Any]) -> None:
    """Raise ValueError if a user's own config ``held`` sets an agent of ours to an invalid value;
    settings that are not in its schema are for its class to reject."""
    target = held["_target_"]
    given = {k: v for k, v in held.items() if k in schema.schema_of(target).settings}
    schema.check(given, "The options", target, "Give it such a value, or leave it out.")
