"""Zero-initialised residual adapters for any frozen torch encoder.

``insert_adapters(model, target_modules=...)`` adds a residual layer ``x + up(act(down(x)))`` after
named modules, as PEFT does for attention layers. Inserting adapters changes neither the names and
values of the backbone's weights nor its ``forward``. The output of the backbone stays the same
until ``up`` is trained. Each adapter is a child of its module and is called by a forward hook.
``adapter_layers.py`` defines the layers. Modules that return maps get convolutional adapters, and
modules that return tokens get linear adapters. *Ring* adapters also read the neighbours of each
view of a panorama. *Gates* restrict the correction to frames that they classify as corrupted.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents.adapter_layers import (
    Adapter,
    ConvAdapter,
    FrameGate,
    RingAdapter,
    TokenAdapter,
)
from mitigate.agents.sites import MAP, Run, channels_of, find_sites, first, inputs_of, listed, named
from mitigate.core import checkpoint
from mitigate.core.files import write_json
from mitigate.core.folders import problem, write_folder
from mitigate.core.json_files import read_json
from mitigate.core.names import escaped, short
from mitigate.core.observation import VIEWS

WEIGHTS, SETTINGS = "adapters.safetensors", "adapters.json"
NAME = checkpoint.ADAPTER.strip(".")  # name of the submodule that is added to a target module
_STATISTICS = "_statistics_before_adapters"


def insert_adapters(
    model: nn.Module,
    target_modules: Iterable[str] = (),
    *,
    reduction: int = 8,
    kernel: int = 3,
    ring: Iterable[str] = (),
    ring_reduction: int = 4,
    gates: Iterable[str] = (),
    views: int = VIEWS,
    run: Run | None = None,
    gate: bool = False,
    middle: int | None = None,
) -> list[str]:
    r"""Freeze ``model`` and add an adapter to every module that a target pattern matches.

    Keep the backbone in eval mode during training. In training mode, batches change the running
    statistics of BatchNorm layers, even of frozen layers. The adapters then no longer fit the saved
    backbone, and ``save_adapters`` warns.

    Args:
        model: any torch module. Without ``run``, each target must return one tensor ``[n, C, h,
            w]``. With ``run``, a target may also return tokens or a vector, alone or as the first
            item of a tuple or list.
        target_modules: regular expressions. Each must match the dotted name of a module, or its
            last parts: ``"stages\.[01]"`` matches ``rgb_encoder.stages.0``.
        reduction: the width of a bottleneck is the number of channels divided by this number.
        kernel: kernel size of convolutional and ring adapters.
        ring: regular expressions of modules that get a :class:`RingAdapter`. The views of a
            panorama must be consecutive in the batch (n = P * views).
        ring_reduction: the value of ``reduction`` for ring adapters.
        gates: targets that get a :class:`FrameGate` on their input, such as an encoder's first
            module. A gate controls the convolutional and ring adapters of its encoder. The encoder
            is the innermost module that contains the gate and at least one such adapter.
        views: number of views per panorama. If it is 1, targets in ``ring`` get a
            :class:`ConvAdapter`.
        run: function that calls the model on n frames, such as ``lambda n: model(frames[:n])``. The
            shapes of the targets' outputs determine the kind of adapter; tokens get a
            :class:`TokenAdapter`.
        gate: whether each adapter learns to scale its correction per frame.
        middle: channels of the bottlenecks; overrides ``reduction``.

    Returns:
        The names of the adapted modules, in the order in which they occur in the model.

    Raises:
        TypeError: If the targets are a single string instead of a list.
        ValueError: If there are no targets, or a target is not a regular expression or matches no
            module. Also if the channels of a module are unknown, or it has an attribute "adapter".
            Also if a gate controls no adapter, or the model already has adapters. The model is
            never changed if an error is raised.
    """
    reject_adapted(model)
    target_modules, ring = listed("target_modules", target_modules), listed("ring", ring)
    gated = named(model, listed("gates", gates))
    if not target_modules + ring:
        raise ValueError("target_modules names no module: give at least one, such as 'layer[1-4]'.")
    plain, ringed = named(model, target_modules), named(model, ring)
    sites = None if run is None else find_sites(model, run)
    adapters: dict[str, Adapter] = {}
    for name, module in model.named_modules():
        if name in gated:
            adapters[name] = FrameGate(inputs_of(name, module), views=views if ringed else 1)
        elif name in ringed and views > 1:
            channels = channels_of(name, module)
            adapters[name] = RingAdapter(channels, ring_reduction, kernel, views)
        elif name in ringed or (name in plain and sites is None):
            narrower = ring_reduction if name in ringed else reduction
            channels = channels_of(name, module)
            adapters[name] = ConvAdapter(channels, narrower, kernel, gate, middle)
        elif name in plain and sites is not None:
            site = sites.get(name, "the encoder does not call it")
            if isinstance(site, str):
                raise ValueError(
                    f"No adapter fits the output of {name}: {site}. Choose another module."
                )
            adapters[name] = (
                ConvAdapter(site.channels, reduction, kernel, gate, middle)
                if site.kind == MAP
                else TokenAdapter(site.channels, reduction, site.batch, gate, middle)
            )
    attach_all(model, adapters)
    return list(adapters)


def remove_adapters(model: nn.Module) -> None:
    """Remove all adapters and their hooks, which restores the original output of the backbone.

    The backbone stays frozen; ``model.requires_grad_(True)`` makes it trainable again.
    """
    for name, adapter in adapted(model).items():
        if adapter.hook is not None:
            adapter.hook.remove()
            adapter.hook = None
        delattr(model.get_submodule(name), NAME)


def adapter_parameters(model: nn.Module) -> list[nn.Parameter]:
    """Return the parameters of the adapters."""
    return [p for adapter in adapters_of(model) for p in adapter.parameters()]


def scale_adapters(model: nn.Module, strength: float) -> None:
    """Scale the corrections of all adapters in ``model`` by ``strength``.

    A strength of 1 keeps the corrections. With a strength of 0, the output equals the output of the
    model without adapters. A value between 0 and 1 gives up some robustness for more success on
    clean frames. The weights of the adapters change in place, so a checkpoint that is saved
    afterwards contains the scaled adapters.

    Source: The method follows WiSE-FT (Wortsman et al., "Robust fine-tuning of zero-shot models",
    CVPR 2022), which interpolates all weights between their values before and after training. For
    adapters, it is sufficient to scale the layers that were initialised to zero.

    Raises:
        ValueError: If ``strength`` is outside [0, 1], or the model has no adapters.
    """
    if not 0 <= strength <= 1:
        raise ValueError(f"strength must be from 0 to 1, got {strength}.")
    if not adapted(model):
        raise ValueError("There are no adapters to scale: call insert_adapters(model, ...) first.")
    layers = [a.get_submodule(name) for a in adapters_of(model) for name in a.corrects]
    with torch.no_grad():
        for parameter in (p for layer in layers for p in layer.parameters()):
            parameter.mul_(strength)


def trainable_share(model: nn.Module) -> float:
    """Return the number of parameters of the adapters, divided by that of the backbone."""
    count = sum(p.numel() for p in adapter_parameters(model))
    return count / max(1, sum(p.numel() for p in model.parameters()) - count)


def save_adapters(model: nn.Module, folder: str | Path) -> Path:
    """Write the adapters, without the backbone, and return the folder.

    ``adapters.safetensors`` holds the weights; ``adapters.json`` holds module names, settings and
    the sha256 of the backbone. A warning is issued if the backbone's running statistics changed
    after the adapters were inserted.

    Raises:
        ValueError: If the model has no adapters.
    """
    with write_folder(folder, "adapters") as draft:
        write_adapters(model, draft)
    return Path(folder)


def write_adapters(model: nn.Module, draft: Path) -> None:
    """Write the files of :func:`save_adapters` into ``draft``, without a manifest."""
    adapters = adapted(model)
    if not adapters:
        raise ValueError("There are no adapters to save: call insert_adapters(model, ...) first.")
    before = vars(model).get(_STATISTICS, {})
    now = _statistics(model)
    # the model may have moved to another device or dtype
    if any(not v.float().cpu().equal(before.get(n, v).float().cpu()) for n, v in now.items()):
        warnings.warn(
            "The backbone's running statistics (BatchNorm) have changed, and the adapters fit only "
            "this backbone: save it, too, or train with it in eval mode, model.eval().",
            stacklevel=3,
        )
    modules = nn.ModuleDict({_key(name): adapter for name, adapter in adapters.items()})
    checkpoint.write_tensors(modules, draft / WEIGHTS)
    settings = {
        "backbone_sha256": backbone_sha(model),
        "adapters": {name: adapter.settings for name, adapter in adapters.items()},
    }
    write_json(draft / SETTINGS, settings, indent=2)


def load_adapters(model: nn.Module, folder: str | Path) -> list[str]:
    """Insert the adapters that ``save_adapters`` wrote and return the names of their modules.

    Each adapter moves to its module's device and dtype. The files are compared with the manifest,
    if there is one.

    Raises:
        FileNotFoundError: If a file is missing.
        ValueError: If a file is damaged; if the model already has adapters, or lacks a module that
            the file names; or if the adapters were trained on a different backbone or dtype.
    """
    folder = Path(folder)
    reject_adapted(model)
    for file in (folder / WEIGHTS, folder / SETTINGS):
        if not file.is_file():
            raise FileNotFoundError(f"No adapters were found in {folder}: {file.name} is missing.")
    try:
        if wrong := problem(folder / SETTINGS):
            raise ValueError(f"{SETTINGS} {wrong}")
        settings = read_json(folder / SETTINGS, "Fetch the folder again.")
        tensors = checkpoint.load_tensors(folder / WEIGHTS)
        shapes = {name: dict(shape) for name, shape in settings["adapters"].items()}
        expected = settings["backbone_sha256"]
        if not shapes:
            raise ValueError("it lists no adapters")
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"The adapters in {folder} are truncated or damaged ({error}).") from error
    sha = backbone_sha(model)
    if sha != expected:
        raise ValueError(
            f"The adapters in {folder} were trained on a backbone with sha256 "
            f"{escaped(str(expected))}, but this one has {sha}. Load the backbone's weights first, "
            "and convert it to the dtype used in training."
        )
    missing = sorted(set(shapes) - {name for name, _ in model.named_modules()})
    if missing:
        raise ValueError(f"This model has no module called {escaped(', '.join(missing))}.")
    weights: dict[str, dict[str, Tensor]] = {_key(name): {} for name in shapes}
    try:
        for name, tensor in tensors.items():
            owner, _, part = name.partition(".")
            if owner not in weights:
                raise ValueError(f"no adapter has the tensor {short(name)}")
            weights[owner][part] = tensor
        adapters = {name: _build_adapter(s, weights[_key(name)]) for name, s in shapes.items()}
    except (RuntimeError, TypeError, ValueError, ArithmeticError) as error:
        cause = " ".join(str(error).split())[:300]
        raise ValueError(f"The adapters in {folder} are damaged ({cause}).") from error
    checkpoint.check_finite(nn.ModuleList(adapters.values()), f"The adapters in {folder}")
    attach_all(model, adapters)
    return list(shapes)


def _build_adapter(settings: dict[str, Any], tensors: dict[str, Tensor]) -> Adapter:
    """Return an adapter that has the given ``settings`` and the weights ``tensors``.

    Raises TypeError or RuntimeError if the settings and the tensors do not match.
    """
    arguments = {name: value for name, value in settings.items() if name != "kind"}
    shape = RingAdapter if "views" in settings else ConvAdapter
    kind = {"tokens": TokenAdapter, "gate": FrameGate}.get(str(settings.get("kind")), shape)
    # checked on the meta device, so that a damaged file cannot cause a large memory allocation
    with torch.device("meta"):
        empty: Any = kind(**arguments)
    if json.dumps(empty.settings, sort_keys=True) != json.dumps(settings, sort_keys=True):
        raise TypeError(f"an adapter with {empty.settings} does not have the settings {settings}")
    expected = {name: value.shape for name, value in empty.state_dict().items()}
    if expected != {name: value.shape for name, value in tensors.items()}:
        raise TypeError(f"the tensors do not have the shapes in {SETTINGS}")
    if not all(value.is_floating_point() for value in tensors.values()):
        raise TypeError("the tensors are not all floats")
    adapter = kind(**arguments)
    adapter.load_state_dict(tensors)
    return adapter


def backbone_sha(model: nn.Module) -> str:
    """Return the content hash (``checkpoint.weights_sha``) of the model without its adapters."""
    return checkpoint.weights_sha(model, leave_out=checkpoint.ADAPTER)


def _key(name: str) -> str:
    """Return a module's name as a key of a ModuleDict, whose keys must not contain a dot."""
    return name.replace(".", "/")


def adapters_of(model: nn.Module) -> list[Adapter]:
    """Return the adapters and gates of ``model``, in the order in which they occur in it."""
    return [*adapted(model).values()]


def adapted(model: nn.Module) -> dict[str, Adapter]:
    """Return the adapters and gates of ``model`` by the names of their modules."""
    return {
        name: child
        for name, module in model.named_modules()
        for child_name, child in module.named_children()
        if child_name == NAME and isinstance(child, Adapter)
    }


def reject_adapted(model: nn.Module) -> None:
    """Raise ValueError if ``model`` has adapters."""
    if adapted(model):
        raise ValueError("This model has adapters already; remove_adapters(model) takes them out.")


def attach_all(model: nn.Module, adapters: dict[str, Adapter]) -> None:
    """Freeze ``model`` and attach all ``adapters``, or none if one of them does not fit."""
    gates = _gates_of(adapters)
    judges = {name for name, adapter in adapters.items() if isinstance(adapter, FrameGate)}
    if idle := sorted(judges - {*gates.values()}):
        raise ValueError(
            f"The gate at {idle[0]} controls no adapter, because its encoder has no adapter for "
            "feature maps. Remove the gate from gates, or choose other target modules."
        )
    # an existing attribute with this name may be a module, a parameter or a method
    conflicts = [name for name in adapters if hasattr(model.get_submodule(name), NAME)]
    if conflicts:
        raise ValueError(
            f"{', '.join(conflicts)} already has an attribute {NAME!r}. Choose other modules."
        )
    model.requires_grad_(False)
    usual = next(model.parameters(), torch.zeros(()))
    for name, adapter in adapters.items():
        module = model.get_submodule(name)
        like = next(module.parameters(), usual)
        module.add_module(NAME, adapter.to(like.device, like.dtype))
        if isinstance(adapter, FrameGate):
            adapter.hook = module.register_forward_pre_hook(_judge_input)
        elif type(module).forward is not nn.Sequential.forward:  # nn.Sequential calls its new child
            adapter.hook = module.register_forward_hook(_adapt)
    for name, gate in gates.items():
        adapters[name].gates = [adapters[gate]]
    setattr(model, _STATISTICS, _statistics(model))


def _adapt(module: nn.Module, inputs: Any, output: Any) -> Any:
    """Apply the adapter of ``module`` to its output, or to the first item of a tuple or list."""
    adapter = module.get_submodule(NAME)
    if isinstance(output, (tuple, list)):
        rest = (adapter(first(output)), *output[1:])
        # a named tuple (recognised by _make) takes one constructor argument per item
        return output._make(rest) if hasattr(output, "_make") else type(output)(rest)
    return adapter(output)


def _judge_input(module: nn.Module, inputs: Any) -> None:
    """Apply the gate of ``module`` to its input (forward pre-hook)."""
    gate: Any = module.get_submodule(NAME)
    gate.classify(inputs[0])


def _gates_of(adapters: dict[str, Adapter]) -> dict[str, str]:
    """Map each adapter's name to the name of the nearest gate in its encoder."""
    controllable = [n for n, m in adapters.items() if isinstance(m, (ConvAdapter, RingAdapter))]
    # adapter name: (name of the module that encloses the adapter and its gate, name of the gate)
    gates: dict[str, tuple[str, str]] = {}
    for name, gate in adapters.items():
        if not isinstance(gate, FrameGate):
            continue
        parent = name
        controlled: list[str] = []
        while parent and not controlled:
            parent = parent.rpartition(".")[0]
            controlled = [n for n in controllable if not parent or n.startswith(f"{parent}.")]
        for n in controlled:
            if n not in gates or len(parent) > len(gates[n][0]):
                gates[n] = (parent, name)
    return {name: gate for name, (_, gate) in gates.items()}


def _statistics(model: nn.Module) -> dict[str, Tensor]:
    """Return copies of the running means and variances of the model's normalisation layers."""
    buffers = dict(model.named_buffers())
    running = [name for name in buffers if name.rpartition(".")[2].startswith("running_")]
    return {name: buffers[name].clone() for name in running}
