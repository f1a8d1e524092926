"""Build the agent of a run from its config and the settings stored with its initial weights.

``loading.py`` loads agents from folders without a config; that module needs neither Hydra nor
OmegaConf.
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
from mitigate.core import checkpoint, folders, seeding, settings
from mitigate.core.build import build, locate, plain
from mitigate.core.contracts import read
from mitigate.core.files import find
from mitigate.core.names import unknown
from mitigate.core.options import values
from mitigate.core.pretrained import PEFT_WEIGHTS


def build_agent(
    node: Mapping[str, Any], *, weights: str | None, seed: int, parts: Sequence[str] | None = None
) -> nn.Module:
    """Build the agent that ``node`` describes.

    Args:
        node: the config of the agent, with ``_target_``.
        weights: file or folder of the initial weights; None initialises them randomly with
            ``seed``.
        seed: seed of random initial weights.
        parts: names of the agent's ``parts()`` to load; None loads all.
    """
    weights = None if weights is None else str(find(weights))
    # Invalid settings are rejected before the agent is built.
    # A huge width would exhaust the memory, and some patterns take too long to match.
    if node["_target_"] in schema.KINDS:
        config = plain(node)
        known = schema.schema_of(config["_target_"])
        config = {name: value for name, value in config.items() if name in known}
        # the agent's class rejects unknown settings
        again = "Give it such a value, or leave it out."
        schema.check(config, known, "The options", again)
    seeding.seed_everything(seed, "agent")
    agent = build(node)
    if weights is not None and not hasattr(agent, "state_dict"):  # the config may name any class
        raise ValueError(
            f"A {type(agent).__name__} is not a torch.nn.Module, so weights cannot be loaded into "
            f"it. Leave out {weights}, and let the agent read its weights."
        )
    if stated_settings(agent) is None:  # the fingerprint then uses the settings of the config
        arguments = {k: v for k, v in plain(node).items() if k != "_target_"}
        try:
            agent.settings = partial(dict, arguments)
        except (AttributeError, TypeError) as error:  # the class has slots or is frozen
            raise ValueError(
                f"{type(agent).__name__} accepts no attribute `settings` ({error}). Give it a "
                "method settings() that returns its constructor's arguments."
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
    """Return ``node`` with the settings stored with ``weights`` (:func:`stored_settings`).

    Args:
        node: the config of the agent.
        weights: file or folder of the weights.
        overrides: options of the command line (``agent.blind=[rgb]``); these options take
            precedence.
    """
    keys = [override.lstrip("+").partition("=")[0].split(".") for override in overrides]
    overridden = {key[1] for key in keys if key[0] == "agent" and len(key) > 1}
    config = plain(node)
    merged = plain(OmegaConf.merge(config, stored_settings(node, weights)))
    for setting in overridden:
        merged[setting] = config[setting]
    return merged


def inherit_settings(node: Mapping[str, Any], weights: str | None) -> Mapping[str, Any]:
    """Return ``node``; settings that are null or missing are taken from ``weights``.

    Examples of such settings are the adapters and the vocabulary. If ``weights`` is None, ``node``
    is returned unchanged. Raises the same errors as :func:`stored_settings`.
    """
    if weights is None:
        return node
    inherited = {k: v for k, v in stored_settings(node, weights).items() if node.get(k) is None}
    return plain(OmegaConf.merge(plain(node), inherited))


def stored_settings(node: Mapping[str, Any], weights: str) -> dict[str, Any]:
    """Return the agent settings stored in ``config.yaml`` next to ``weights``, read as plain data.

    If the file does not exist, the result is empty.

    Raises:
        ValueError: If the file was changed, if the weights belong to a different kind of agent than
            ``node``, or if the file holds a value that the agent does not accept.
    """
    place = find(weights)
    if (place / PEFT_WEIGHTS).is_file() and not hasattr(locate(node["_target_"]), "act"):
        return {}  # the safeguard's language model checks the LoRA adapter in its load()
    file = loading.config_of(place)
    if not file.is_file():
        return {}
    if problem := folders.problem(file):
        raise ValueError(f"{file} {problem}. {folders.AGAIN}")
    if node["_target_"] in schema.KINDS:
        return loading.agent_settings(file, node["_target_"])
    constructor = locate(node["_target_"])
    names = {*signature(constructor).parameters, *map(str, node)} - {"_target_"}
    names -= {*read(constructor, "own_config_only", default=())}
    return settings.read_agent(file, node["_target_"], names)


def agent_option(options: Sequence[str], weights: str) -> list[str]:
    """Return ``["agent=NAME"]`` for the kind of agent to which ``weights`` belong.

    This agent config also sets the world options that the agent needs. The result is empty if
    ``options`` already choose an agent, or if the kind of agent is the default kind, not shipped,
    or unknown.
    """
    if any(option.lstrip("+~").partition("=")[0] == "agent" for option in options):
        return []
    try:
        kind = loading.kind_of(loading.config_of(find(weights)))
    except (OSError, ValueError):  # the error is raised again when the weights are loaded
        return []
    name = "" if kind == loading.TARGET else settings.named(kind)
    return [f"agent={name}"] if name else []


def with_kind(options: Sequence[str]) -> list[str]:
    """Return ``options`` with the ``agent=`` option that fits the weights in ``checkpoint=``."""
    weights = values(options, "checkpoint")
    added = agent_option(options, weights[0]) if len(weights) == 1 else []
    return [*options, *added]
