"""Zero-initialised residual adapters for any frozen torch encoder.

``insert_adapters(model, target_modules=...)`` puts ``x + up(act(down(x)))`` behind named modules,
as PEFT does for attention: the backbone's own weights keep their names and values, its ``forward``
is not touched, and nothing changes until ``up`` has learned. Each adapter is a child of its module,
called by a forward hook. The layers are in ``adapter_layers.py``: convolutional behind a module
that returns maps, linear behind one that returns tokens, a *ring* adapter that also sees the
neighbours of each view of a panorama, and a *gate* that lets the adapters of an encoder correct
only the frames that it judges to be corrupted.
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
from mitigate.agents.sites import MAP, Run, Site, channels_of, first, inputs_of, listed, look, named
from mitigate.core import checkpoint
from mitigate.core.files import write_text
from mitigate.core.folders import problem, write_folder
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.core.observation import HFOV_DEGREES, VIEWS

WEIGHTS, SETTINGS = "adapters.safetensors", "adapters.json"
NAME = checkpoint.ADAPTER.strip(".")  # of the submodule that a target module gets
_STATISTICS = "_statistics_before_adapters"


def insert_adapters(
    model: nn.Module,
    target_modules: Iterable[str],
    *,
    reduction: int = 8,
    kernel: int = 3,
    ring: Iterable[str] = (),
    ring_reduction: int = 4,
    gates: Iterable[str] = (),
    views: int = VIEWS,
    hfov: float = HFOV_DEGREES,
    run: Run | None = None,
    gate: bool = False,
    middle: int | None = None,
) -> list[str]:
    """Freeze ``model`` and give an adapter to every module that a target names.

    Args:
        model: any module tree; the targets must return one tensor ``[n, C, h, w]``, or with ``run``
            one that an adapter fits behind, alone or as the first item of a tuple or list.
        run: calls the model on so many frames, such as ``lambda n: model(frames[:n])``; what the
            targets return then is looked at, and tokens get a :class:`TokenAdapter`.
        gate: adapters that say for each frame how much they correct. middle: channels of the
            bottlenecks, in place of ``reduction``.
        target_modules: regular expressions, each matched against the whole dotted name of a module
            or its end (``"stages\\.[01]"`` finds ``rgb_encoder.stages.0``). reduction, kernel: of
            each adapter. ring: targets of the same form that get a :class:`RingAdapter` over
            ``views`` views of ``hfov`` degrees, which follow one another in the batch (n = P *
            views), with ``ring_reduction`` in place of ``reduction``, ``gate`` and ``middle``; of 1
            view, a plain one. A module found by both gets this one. gates: targets that get a
            :class:`FrameGate`, which looks at what goes into them, in place of an adapter, such as
            an encoder's first; it counts for adapters of maps in the nearest module that has some.
    Train with the backbone in eval mode: batches move the running statistics of a BatchNorm that
    trains, frozen or not, and the adapters then fit no backbone on file (``save_adapters`` warns).
    Returns the names of the adapted modules, in the model's order.
    Raises TypeError for targets that are one string; ValueError for none at all, for one that
    matches nothing (with the names there are) or is no regular expression, a module whose channels
    cannot be told or that has a child called "adapter", a gate that nothing follows, or a model
    that has adapters; the model is then as it was.
    """
    refuse_adapted(model)
    target_modules, ring = listed("target_modules", target_modules), listed("ring", ring)
    gated = named(model, listed("gates", gates))
    if not target_modules + ring:
        raise ValueError("target_modules names no module: give at least one, such as 'layer[1-4]'.")
    plain, ringed = named(model, target_modules), named(model, ring)
    sites = None if run is None else look(model, run)
    made: dict[str, Adapter] = {}
    for name, module in model.named_modules():
        if name in gated:
            made[name] = FrameGate(inputs_of(name, module), views=views if ringed else 1)
        elif name in ringed and views == 1:  # no neighbours
            made[name] = _plain(name, module, None, ring_reduction, kernel, gate, middle)
        elif name in ringed:
            made[name] = RingAdapter(channels_of(name, module), ring_reduction, kernel, views, hfov)
        elif name in plain:
            made[name] = _plain(name, module, sites, reduction, kernel, gate, middle)
    check_gates(made)
    attach_all(model, made)
    return list(made)


def _plain(
    name: str,
    module: nn.Module,
    sites: dict[str, Site | str] | None,
    reduction: int,
    kernel: int,
    gate: bool,
    middle: int | None,
) -> Adapter:
    """The adapter that fits behind a module."""
    if sites is None:
        return ConvAdapter(channels_of(name, module), reduction, kernel, gate, middle)
    site = sites.get(name, "the encoder does not call it")
    if isinstance(site, str):
        raise ValueError(f"No adapter fits behind {name}: {site}. Choose another target module.")
    if site.kind == MAP:
        return ConvAdapter(site.channels, reduction, kernel, gate, middle)
    return TokenAdapter(site.channels, reduction, site.batch, gate, middle)


def remove_adapters(model: nn.Module) -> None:
    """Take all adapters out; the backbone computes what it did before they came in. It stays
    frozen: ``model.requires_grad_(True)`` lets it train again."""
    detach_all(model)


def adapter_parameters(model: nn.Module) -> list[nn.Parameter]:
    """The parameters of the adapters alone."""
    return [p for adapter in adapters_of(model) for p in adapter.parameters()]


def scale_adapters(model: nn.Module, strength: float) -> None:
    """Have the adapters of ``model`` make a share ``strength`` of the correction that they make
    now: 1 all of it; 0 none, so that the model computes what it did without them, bit for bit.
    Their weights change, so whatever is saved afterwards holds it.

    Between the two lie models that are nearer to the clean success of the backbone and keep less of
    what the adapters win. Source: WiSE-FT (Wortsman et al., "Robust fine-tuning of zero-shot
    models", CVPR 2022), which interpolates all weights between before and after a training; of
    adapters the layers that start at zero are enough.
    Raises ValueError for a strength beyond 0 to 1, and for a model without adapters.
    """
    if not 0 <= strength <= 1:
        raise ValueError(f"strength={strength} is a share of the adapters' correction: 0 to 1.")
    if not adapted(model):
        raise ValueError("There are no adapters to scale: call insert_adapters(model, ...) first.")
    layers = [a.get_submodule(name) for a in adapters_of(model) for name in a.corrects]
    with torch.no_grad():
        for parameter in (p for layer in layers for p in layer.parameters()):
            parameter.mul_(strength)


def trainable_share(model: nn.Module) -> float:
    """Adapter parameters as a share of the backbone's own, in [0, 1]."""
    own = sum(p.numel() for p in adapter_parameters(model))
    return own / max(1, sum(p.numel() for p in model.parameters()) - own)


def save_adapters(model: nn.Module, folder: str | Path) -> Path:
    """Write the adapters alone: ``adapters.safetensors`` and ``adapters.json`` (names, shapes of
    the bottlenecks, sha256 of the backbone). Returns the folder. Raises ValueError if there are
    none; warns if the backbone's running statistics are not those of when they were inserted."""
    with write_folder(folder, "adapters") as draft:
        write_adapters(model, draft)
    return Path(folder)


def write_adapters(model: nn.Module, draft: Path) -> None:
    """Write the files of :func:`save_adapters` into ``draft``, without a manifest."""
    adapters = _attached(model)
    if not adapters:
        raise ValueError("There are no adapters to save: call insert_adapters(model, ...) first.")
    if moved_statistics(model):
        warnings.warn(
            "The backbone's running statistics (BatchNorm) have changed since the adapters were "
            "inserted, so these adapters fit this backbone only: save it, too. To keep them, train "
            "with the backbone in eval mode, model.eval().",
            stacklevel=3,
        )
    modules = nn.ModuleDict({_key(name): adapter for name, adapter in adapters.items()})
    checkpoint.write_tensors(modules, draft / WEIGHTS)
    settings = {
        "backbone_sha256": backbone_sha(model),
        "adapters": {name: adapter.settings for name, adapter in adapters.items()},
    }
    write_text(draft / SETTINGS, json.dumps(settings, indent=2))


def load_adapters(model: nn.Module, folder: str | Path) -> list[str]:
    """Insert the adapters that ``save_adapters`` wrote; returns the adapted modules' names.

    Each goes to its module's device and dtype. The files are compared with the manifest, if there
    is one. Raises FileNotFoundError if a file is missing;
    ValueError for a damaged file, for a model that has adapters already, for adapters trained on
    another backbone (or this one in another dtype), or for modules that ``model`` does not have.
    """
    folder = Path(folder)
    refuse_adapted(model)
    for file in (folder / WEIGHTS, folder / SETTINGS):
        if not file.is_file():
            raise FileNotFoundError(f"There are no adapters in {folder}: {file.name} is missing.")
    try:
        if wrong := problem(folder / SETTINGS):
            raise ValueError(f"{SETTINGS} {wrong}")
        settings = read_json(folder / SETTINGS, "Fetch the folder again.")
        tensors = checkpoint.load_tensors(folder / WEIGHTS)
        shapes = {name: dict(shape) for name, shape in settings["adapters"].items()}
        wanted = settings["backbone_sha256"]
        if not shapes:
            raise ValueError("it names none")
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"The adapters in {folder} are cut short or damaged ({error}).") from error
    found = backbone_sha(model)
    if found != wanted:
        raise ValueError(
            f"The adapters in {folder} were trained on a backbone with sha256 {wanted}, but this "
            f"one has {found}. Load the weights they were trained on first; to run in another "
            "dtype, convert the model afterwards."
        )
    missing = sorted(set(shapes) - {name for name, _ in model.named_modules()})
    if missing:
        raise ValueError(f"This model has no module called {', '.join(missing)}.")
    made: dict[str, Adapter] = {}
    try:
        owners = tuple(f"{_key(name)}." for name in shapes)
        for name in tensors:
            if not name.startswith(owners):
                raise ValueError(f"no adapter has the tensor {short(name)}")
        for name, shape in shapes.items():
            prefix = f"{_key(name)}."
            own = {k.removeprefix(prefix): v for k, v in tensors.items() if k.startswith(prefix)}
            made[name] = _made(shape, own)
    except (RuntimeError, TypeError, ValueError, ArithmeticError) as error:
        cause = " ".join(str(error).split())[:300]
        raise ValueError(f"The adapters in {folder} are damaged ({cause}).") from error
    checkpoint.check_finite(nn.ModuleList(made.values()), f"The adapters in {folder}")
    attach_all(model, made)
    return list(shapes)


def _made(settings: dict[str, Any], tensors: dict[str, Tensor]) -> Adapter:
    """Return the adapter of ``settings`` with the weights ``tensors``. Raises TypeError or
    RuntimeError if they do not fit, or are not as an adapter of that kind writes them; no memory is
    taken for what does not."""
    given = {name: value for name, value in settings.items() if name != "kind"}
    shape = RingAdapter if "views" in settings else ConvAdapter
    kind = {"tokens": TokenAdapter, "gate": FrameGate}.get(str(settings.get("kind")), shape)
    with torch.device("meta"):
        empty: Any = kind(**given)
    if json.dumps(empty.settings, sort_keys=True) != json.dumps(settings, sort_keys=True):
        raise TypeError(f"an adapter with {empty.settings} does not have the settings {settings}")
    wanted = {name: value.shape for name, value in empty.state_dict().items()}
    if wanted != {name: value.shape for name, value in tensors.items()}:
        raise TypeError(f"the tensors are not of the shapes that {SETTINGS} says")
    if not all(value.is_floating_point() for value in tensors.values()):
        raise TypeError("the tensors are not all floats")
    adapter = kind(**given)
    adapter.load_state_dict(tensors)
    return adapter


def backbone_sha(model: nn.Module) -> str:
    """``checkpoint.weights_sha`` of everything but the adapters."""
    return checkpoint.weights_sha(model, leave_out=checkpoint.ADAPTER)


def _key(name: str) -> str:
    """A module's name as a ModuleDict's key, which may hold no dot."""
    return name.replace(".", "/")


def adapted(model: nn.Module) -> list[str]:
    """Names of the modules of ``model`` that have an adapter."""
    return [*_attached(model)]


def adapters_of(model: nn.Module) -> list[Adapter]:
    """The adapters and gates themselves, in the model's order."""
    return [*_attached(model).values()]


def _attached(model: nn.Module) -> dict[str, Adapter]:
    """Adapters by the name of the module that has them."""
    return {
        name: child
        for name, module in model.named_modules()
        for own, child in module.named_children()
        if own == NAME and isinstance(child, Adapter)
    }


def refuse_adapted(model: nn.Module) -> None:
    if adapted(model):
        raise ValueError("This model has adapters already; remove_adapters(model) takes them out.")


def attach_all(model: nn.Module, made: dict[str, Adapter]) -> None:
    """Freeze ``model`` and attach ``made``, all or none."""
    # anything may have that name: a module, a parameter, a method
    taken = [name for name in made if hasattr(model.get_submodule(name), NAME)]
    if taken:
        raise ValueError(
            f"{', '.join(taken)} has something called {NAME!r} of its own, the name that an "
            "adapter takes. Choose other target modules."
        )
    model.requires_grad_(False)
    like = next(model.parameters(), torch.zeros(()))
    for name, adapter in made.items():
        _attach(model.get_submodule(name), adapter, like)
    _follow(made)
    setattr(model, _STATISTICS, _statistics(model))


def detach_all(model: nn.Module) -> None:
    """Take all adapters out, and their hooks."""
    for name, adapter in _attached(model).items():
        if adapter.hook is not None:
            adapter.hook.remove()
            adapter.hook = None
        delattr(model.get_submodule(name), NAME)


def moved_statistics(model: nn.Module) -> bool:
    """Whether the backbone's running statistics are other ones than when adapters came in."""
    held = vars(model).get(_STATISTICS, {})
    return any(not v.equal(held.get(name, v)) for name, v in _statistics(model).items())


def _adapter_of(module: nn.Module) -> Adapter:
    adapter = module.get_submodule(NAME)
    assert isinstance(adapter, Adapter)
    return adapter


def _attach(module: nn.Module, adapter: Adapter, usual: Tensor) -> None:
    """``usual``: whose device and dtype it gets where ``module`` has no weights."""
    like = next(module.parameters(), usual)
    module.add_module(NAME, adapter.to(like.device, like.dtype))
    if isinstance(adapter, FrameGate):
        adapter.hook = module.register_forward_pre_hook(_look)
    elif type(module).forward is not nn.Sequential.forward:  # that runs its new child by itself
        adapter.hook = module.register_forward_hook(_adapt)


def _adapt(module: nn.Module, inputs: Any, output: Any) -> Any:
    """Forward hook: the adapter of ``module`` on its output, or on the first item of it."""
    adapter = _adapter_of(module)
    if isinstance(output, (tuple, list)):
        rest = (adapter(first(output)), *output[1:])
        # a named tuple, which alone has _make, takes its parts one by one
        return output._make(rest) if hasattr(output, "_make") else type(output)(rest)
    return adapter(output)


def _look(module: nn.Module, inputs: Any) -> None:
    """Forward pre-hook: the gate of ``module`` on what goes into it."""
    gate = _adapter_of(module)
    assert isinstance(gate, FrameGate)
    gate.look(inputs[0])


def _follow(made: dict[str, Adapter]) -> None:
    """Tell each adapter of the gate in front of it."""
    for name, gate in _gates_of(made).items():
        made[name].gates = [made[gate]]


def check_gates(made: dict[str, Adapter]) -> None:
    """Raise ValueError for a gate that would open and close for nothing."""
    used = set(_gates_of(made).values())
    idle = [name for name, m in made.items() if isinstance(m, FrameGate) and name not in used]
    if idle:
        raise ValueError(
            f"The gate at {idle[0]} has no adapter of maps behind it to open for (those of tokens "
            "take none). Leave it out of gates, or choose other target modules."
        )


def _gates_of(made: dict[str, Adapter]) -> dict[str, str]:
    """By adapter, the gate in front of it: the one in the same encoder."""
    corrects = [n for n, m in made.items() if isinstance(m, (ConvAdapter, RingAdapter))]
    held: dict[str, tuple[str, str]] = {}  # by adapter: the module around both, and the gate
    for name, gate in made.items():
        if not isinstance(gate, FrameGate):
            continue
        around, behind = name, list[str]()
        while around and not behind:
            around = around.rpartition(".")[0]
            behind = [n for n in corrects if not around or n.startswith(f"{around}.")]
        for n in behind:
            if n not in held or len(around) > len(held[n][0]):
                held[n] = (around, name)
    return {name: gate for name, (_, gate) in held.items()}


def _statistics(model: nn.Module) -> dict[str, Tensor]:
    """Copies of the running means and variances of the backbone's normalisations."""
    found = {n: b for n, b in model.named_buffers() if n.rpartition(".")[2].startswith("running_")}
    return {name: torch.clone(buffer).float().cpu() for name, buffer in found.items()}
