"""Zero-initialised residual adapters for any frozen torch encoder.

``insert_adapters(model, target_modules=...)`` puts ``x + up(act(down(x)))`` behind named modules,
as PEFT does for attention: the backbone's own weights keep their names and values, and nothing
changes until ``up`` has learned. Behind a module that gives maps it is convolutional, behind one
that gives tokens (``tokens.py``) it is linear. A *ring* adapter (``ring.py``) also sees the
neighbours of each view of a panorama, so that what one view has lost can come from the views that
overlap it. A *gate* (``gate.py``) lets the adapters of an encoder correct only the frames that it
takes for corrupted.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents import attachment
from mitigate.agents.attachment import NAME, adapted, adapters_of
from mitigate.agents.conv import ConvAdapter
from mitigate.agents.gate import FrameGate
from mitigate.agents.ring import RingAdapter
from mitigate.agents.sites import MAP, Run, Site, channels_of, inputs_of, listed, look, named
from mitigate.agents.tokens import TokenAdapter
from mitigate.core import checkpoint
from mitigate.core.files import atomic_text, make_folder
from mitigate.core.json_files import read_json
from mitigate.core.names import short
from mitigate.core.observation import HFOV_DEGREES, VIEWS

WEIGHTS, SETTINGS = "adapters.safetensors", "adapters.json"


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
    attachment.refuse_adapted(model)
    target_modules, ring = listed("target_modules", target_modules), listed("ring", ring)
    gated = named(model, listed("gates", gates))
    if not target_modules + ring:
        raise ValueError("target_modules names no module: give at least one, such as 'layer[1-4]'.")
    plain, ringed = named(model, target_modules), named(model, ring)
    sites = None if run is None else look(model, run)
    made: dict[str, nn.Module] = {}
    for name, module in model.named_modules():
        if name in gated:
            made[name] = FrameGate(inputs_of(name, module), views=views if ringed else 1)
        elif name in ringed and views == 1:  # no neighbours
            made[name] = _plain(name, module, None, ring_reduction, kernel, gate, middle)
        elif name in ringed:
            made[name] = RingAdapter(channels_of(name, module), ring_reduction, kernel, views, hfov)
        elif name in plain:
            made[name] = _plain(name, module, sites, reduction, kernel, gate, middle)
    attachment.check_gates(made)
    attachment.attach_all(model, made)
    return list(made)


def _plain(
    name: str,
    module: nn.Module,
    sites: dict[str, Site | str] | None,
    reduction: int,
    kernel: int,
    gate: bool,
    middle: int | None,
) -> nn.Module:
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
    attachment.detach_all(model)


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
    layers = [getattr(a, name) for a in adapters_of(model) for name in getattr(a, "corrects", ())]
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
    names, folder = adapted(model), Path(folder)
    if not names:
        raise ValueError("There are no adapters to save: call insert_adapters(model, ...) first.")
    if attachment.moved_statistics(model):
        warnings.warn(
            "The backbone's running statistics (BatchNorm) have changed since the adapters were "
            "inserted, so these adapters fit this backbone only: save it, too. To keep them, train "
            "with the backbone in eval mode, model.eval().",
            stacklevel=2,
        )
    make_folder(folder)
    modules = nn.ModuleDict({_key(n): getattr(model.get_submodule(n), NAME) for n in names})
    checkpoint.save_weights(modules, folder / WEIGHTS)
    settings = {
        "backbone_sha256": backbone_sha(model),
        "adapters": {n: getattr(model.get_submodule(n), NAME).settings for n in names},
    }
    with atomic_text(folder / SETTINGS) as file:
        json.dump(settings, file, indent=2)
    return folder


def load_adapters(model: nn.Module, folder: str | Path) -> list[str]:
    """Insert the adapters that ``save_adapters`` wrote; returns the adapted modules' names.

    Each goes to its module's device and dtype. The sha256 beside the file is compared if there is
    one (that of a shipped folder is in its card). Raises FileNotFoundError if a file is missing;
    ValueError for a damaged file, for a model that has adapters already, for adapters trained on
    another backbone (or this one in another dtype), or for modules that ``model`` does not have.
    """
    folder = Path(folder)
    attachment.refuse_adapted(model)
    for file in (folder / WEIGHTS, folder / SETTINGS):
        if not file.is_file():
            raise FileNotFoundError(f"There are no adapters in {folder}: {file.name} is missing.")
    try:
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
    made: dict[str, nn.Module] = {}
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
    attachment.attach_all(model, made)
    return list(shapes)


def _made(settings: dict[str, Any], tensors: dict[str, Tensor]) -> nn.Module:
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
