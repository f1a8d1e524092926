"""Build the objects that configs describe; only this module instantiates ``_target_`` nodes.

Only configs in this checkout and in the user's ``--config-dir`` are ever built. A config that came
with downloaded weights is only read as data, because a ``_target_`` in it could run any code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from inspect import signature
from typing import Any

from hydra.errors import InstantiationException
from hydra.utils import get_object, instantiate
from omegaconf import OmegaConf

from mitigate.core.names import unknown

NOT_LOADED = "Error loading"  # start of Hydra's message for a _target_ that cannot be imported
PARTIAL = "_partial_"  # with this key, Hydra returns a function that constructs the object
COLLECT = "builtins.dict"  # a _target_ that only returns the built arguments


def build(node: Mapping[str, Any], **arguments: Any) -> Any:
    """Return the object that ``node`` describes.

    The constructor receives nested lists and mappings as plain lists and dicts. The constructor
    receives an entry with ``_partial_: true`` as a :class:`Maker`.

    Args:
        node: a mapping with ``_target_`` and the arguments of the target.
        arguments: additional keyword arguments.

    Raises:
        ValueError, FileNotFoundError: If the constructor raises ValueError or FileNotFoundError.
    """
    config = plain(node)
    makers = {k: Maker(v) for k, v in config.items() if isinstance(v, dict) and v.get(PARTIAL)}
    rest = OmegaConf.create({k: v for k, v in config.items() if k not in makers})
    try:
        make = instantiate(rest, _partial_=True, _convert_="all")
        _check_arguments(config, (*config, *arguments))
        return make(**makers, **arguments)  # instantiate would copy these arguments
    except InstantiationException as error:
        cause = error.__cause__
        while isinstance(cause, InstantiationException):
            cause = cause.__cause__
        if isinstance(cause, (ValueError, FileNotFoundError)):
            raise cause from error
        if str(cause).startswith(NOT_LOADED):
            raise ValueError(_not_loaded(cause)) from error
        raise


def arguments_of(node: Mapping[str, Any]) -> dict[str, Any]:
    """Build each argument in ``node`` with :func:`build` and return the arguments."""
    return dict(build({**node, "_target_": COLLECT}))


def argument_names(kind: Any) -> list[str]:
    """Return the names of the arguments that a config may set for ``kind``.

    A class with ``sources`` (``mitigate.training.objective``) also accepts the arguments of its
    source classes. A config cannot set the source objects themselves.
    """
    # other classes and functions have no ``sources``
    sources: Mapping[str, Any] = getattr(kind, "sources", {})
    names = [name for name in signature(kind).parameters if name not in sources]
    for source in sources.values():
        names += [name for name in signature(source).parameters if name not in names]
    return names


def _check_arguments(node: Mapping[str, Any], names: Iterable[str]) -> None:
    """Raise ValueError for arguments that the class or function of ``node`` does not accept."""
    target = str(node["_target_"])
    try:
        parameters = signature(get_object(target)).parameters
    except (ValueError, TypeError):  # callables written in C may have no signature
        return
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters.values()):
        return
    for name in names:
        if not name.startswith("_") and name not in parameters:
            raise ValueError(f"{target}: {unknown('argument', name, [*parameters])}")


class Maker:
    """Function object that constructs a new object from a config at each call.

    A Maker can be pickled, so that worker processes can construct their own objects.
    """

    def __init__(self, node: Mapping[str, Any]) -> None:
        self.node = {name: value for name, value in node.items() if name != PARTIAL}

    def __call__(self) -> Any:
        return build(self.node)


def plain(node: Any) -> dict[str, Any]:
    """Convert a node of a config to plain data, with references resolved."""
    if OmegaConf.is_config(node):
        data = OmegaConf.to_container(node, resolve=True)
        assert isinstance(data, dict)
    else:
        data = dict(node)
    return {str(name): value for name, value in data.items()}


def locate(target: str) -> Any:
    """Import and return the object that ``target`` names (``module.Name``).

    Raises:
        ValueError: If there is no such object.
    """
    try:
        return get_object(target)
    except ImportError as error:
        raise ValueError(_not_loaded(error)) from error


def imported(name: str | None, option: str) -> Callable[..., Any]:
    """Import and return the callable that an option names as ``module:callable``.

    Raises:
        ValueError: If the module cannot be imported, or has no such callable.
    """
    module_name, _, attribute = (name or "").partition(":")
    if not (module_name and attribute):
        raise ValueError(
            f"{option} must be module:callable, such as my_policy:make_{option}, got {name!r:.200}."
        )
    try:
        module = import_module(module_name)
    except ImportError as error:
        raise ValueError(
            f"{option}={name} cannot be imported: {error}. Run the command in the folder of the "
            "module, or install its package."
        ) from error
    if not hasattr(module, attribute):
        callables = [n for n, v in vars(module).items() if callable(v) and not n.startswith("_")]
        raise ValueError(f"{option}={name}: {unknown('callable', attribute, callables)}")
    target = getattr(module, attribute)
    if not callable(target):
        raise ValueError(f"{option}={name} must be callable, got type {type(target).__name__}.")
    return target


def _not_loaded(error: object) -> str:
    return (
        f"{' '.join(str(error).split())} A _target_ must be module.Name. The module must be "
        "installed, in the current folder, or on PYTHONPATH."
    )


def maker(node: Mapping[str, Any]) -> Maker:
    """Return a function that constructs the object that ``node`` of a config describes."""
    return Maker(plain(node))
