"""From a config to objects: the only place that instantiates ``_target_`` nodes.

Only configs of this checkout and of the user's own (``--config-dir``) are ever built; one that came
with downloaded weights is read as data, because a ``_target_`` in it could run anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydra.errors import InstantiationException
from hydra.utils import get_object, instantiate
from omegaconf import DictConfig, OmegaConf

from mitigate.core import seeding, settings
from mitigate.core.files import find
from mitigate.core.names import unknown
from mitigate.core.options import values

if TYPE_CHECKING:  # slow to import: only what makes an agent does
    from torch import nn

# attribute of an agent's class: arguments that name code or files, which no config that came with
# weights may set
OWN_CONFIG_ONLY = "own_config_only"
LORA = "adapter_model.safetensors"  # PEFT's name for it
NOT_LOADED = "Error loading"  # so begins what Hydra says of a _target_ that it cannot import
PARTIAL = "_partial_"  # Hydra's mark: give a function that makes this


def build(node: DictConfig, **given: Any) -> Any:
    """Return the object that ``node`` describes; ``given`` are further keyword arguments.

    Lists and mappings inside arrive as plain lists and dicts, and an entry with ``_partial_: true``
    as a :class:`Maker`. The ValueError or FileNotFoundError of a constructor reaches the user as
    it was raised.
    """
    try:
        held = plain(node)
        makers = {k: Maker(v) for k, v in held.items() if isinstance(v, dict) and v.get(PARTIAL)}
        rest = OmegaConf.create({k: v for k, v in held.items() if k not in makers})
        make = instantiate(rest, _partial_=True, _convert_="all")
        _check_arguments(held, (*held, *given))
        return make(**makers, **given)  # not through instantiate, which would copy what is given
    except InstantiationException as error:
        cause = error.__cause__
        while isinstance(cause, InstantiationException):
            cause = cause.__cause__
        if isinstance(cause, (ValueError, FileNotFoundError)):
            raise cause from error
        if str(cause).startswith(NOT_LOADED):
            raise ValueError(_not_loaded(cause)) from error
        raise


def _check_arguments(node: dict[str, Any], names: Iterable[str]) -> None:
    """Raise ValueError for arguments that the class or function of ``node`` does not take."""
    target = str(node["_target_"])
    try:
        taken = signature(get_object(target)).parameters
    except (ValueError, TypeError):  # of C, of which nobody knows
        return
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in taken.values()):
        return
    for name in names:
        if not name.startswith("_") and name not in taken:
            raise ValueError(f"{target}: {unknown('argument', name, [*taken])}")


class Maker:
    """Makes what a config describes, anew each time and with all that is inside it; it can be
    pickled, so that worker processes make their own."""

    def __init__(self, node: dict[str, Any]) -> None:
        self.node = {name: value for name, value in node.items() if name != PARTIAL}

    def __call__(self) -> Any:
        return build(OmegaConf.create(self.node))


def plain(node: DictConfig) -> dict[str, Any]:
    """A node of a config as plain data."""
    held = OmegaConf.to_container(node, resolve=True)
    assert isinstance(held, dict)
    return {str(name): value for name, value in held.items()}


def located(target: str) -> Any:
    """Return what ``target`` names (``module.Name``). Raises ValueError if nothing is there."""
    try:
        return get_object(target)
    except ImportError as error:
        raise ValueError(_not_loaded(error)) from error


def _not_loaded(error: object) -> str:
    return (
        f"{' '.join(str(error).split())} A _target_ is module.Name, of a module that is installed, "
        "in the folder you are in, or on PYTHONPATH."
    )


def maker(node: DictConfig) -> Maker:
    """Return a function that makes what ``node`` describes."""
    return Maker(plain(node))


def settings_of(node: DictConfig, weights: str, overrides: Sequence[str] = ()) -> DictConfig:
    """Return ``node`` with the settings that ``weights`` carry (:func:`carried`, errors too).

    What the command line sets counts more (``overrides``: ``agent.blind=[rgb]``); ``agent=mine``
    names the class, and what the weights do not say.
    """
    keys = [override.lstrip("+").partition("=")[0].split(".") for override in overrides]
    named = {key[1] for key in keys if key[0] == "agent" and len(key) > 1}
    known = OmegaConf.create(OmegaConf.to_container(node, resolve=True))  # open to further settings
    found = OmegaConf.merge(known, carried(node, weights))
    assert isinstance(found, DictConfig)
    for setting in named:
        found[setting] = node[setting]
    return found


def begun_from(node: DictConfig, weights: str | None) -> DictConfig:
    """Return ``node`` with the settings that it leaves open (null, or not named: adapters, the
    vocabulary) as in the ``weights`` that a training begins from; None: as it is. Errors as of
    :func:`carried`."""
    if weights is None:
        return node
    open_ = {k: v for k, v in carried(node, weights).items() if node.get(k) is None}
    merged = OmegaConf.merge(OmegaConf.create(plain(node)), open_)
    assert isinstance(merged, DictConfig)
    return merged


def carried(node: DictConfig, weights: str) -> dict[str, Any]:
    """Return the settings of the agent that ``weights`` belong to, none if they do not say.

    They come, as data, from ``config.yaml`` beside the weights. Raises ValueError if the weights
    are those of another kind of agent than ``node``, or if the file holds anything but plain data
    that the agent takes (:func:`mitigate.core.settings.read_agent`).
    """
    from mitigate.shipping import hardened

    weights = str(find(weights))
    if (Path(weights) / LORA).is_file() and hasattr(located(node._target_), "load"):
        return {}  # a language model says itself whose adapter it takes
    file = hardened.config_of(Path(weights))
    if not file.is_file():
        return {}
    if hardened.is_ours(node._target_):
        return hardened.agent_settings(file, node._target_)
    made = located(node._target_)
    names = {*signature(made).parameters, *map(str, node)} - {"_target_"}
    names -= set(getattr(made, OWN_CONFIG_ONLY, ()))
    return settings.read_agent(file, node._target_, names)


def agent_option(options: Sequence[str], weights: str) -> list[str]:
    """The option ``agent=`` of the kind of agent that ``weights`` are of, with which what it asks
    of the world comes. None where ``options`` choose one, and where that kind is the usual one,
    none of ours, or not to be known."""
    if any(option.lstrip("+~").partition("=")[0] == "agent" for option in options):
        return []
    from mitigate.shipping import hardened

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
    node: DictConfig, *, weights: str | None, seed: int, parts: Sequence[str] | None = None
) -> nn.Module:
    """Return the agent of ``node``, its first weights drawn from ``seed`` or read from a file;
    ``parts``: of its ``parts()``, those that are read; None: all."""
    from mitigate.core import checkpoint
    from mitigate.shipping import hardened

    weights = None if weights is None else str(find(weights))
    if hardened.is_ours(node._target_):  # numbers that would take all memory, patterns for ever
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
