"""From a config to objects: the only place that instantiates ``_target_`` nodes.

Only configs of this checkout and of the user's own (``--config-dir``) are ever built; one that came
with downloaded weights is read as data, because a ``_target_`` in it could run anything.
"""

from __future__ import annotations

from collections.abc import Iterable
from inspect import signature
from typing import Any

from hydra.errors import InstantiationException
from hydra.utils import get_object, instantiate
from omegaconf import DictConfig, OmegaConf

from mitigate.core.names import unknown

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
