"""Where adapters can go: what each module of an encoder really returns, seen on probe frames."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents.networks import in_eval_mode

Run = Callable[[int], Any]  # runs the encoder on so many frames
MAP, TOKENS = "map", "tokens"


@dataclass(frozen=True)
class Site:
    """What a module returns. kind: "map" ``[n, C, h, w]``, or "tokens": the last axis is C, and
    there may be none between it and the frames (a vector). batch: the axis of the frames. shape:
    for two frames. order: of its call among all modules'. calls: in one forward pass."""

    kind: str
    channels: int
    batch: int
    shape: tuple[int, ...]
    order: int
    calls: int


def first(output: Any) -> Any:
    """A module's output, or the first item of a tuple or list, as HF's blocks return."""
    return output[0] if isinstance(output, (tuple, list)) and len(output) else output


@torch.no_grad()
def look(model: nn.Module, run: Run) -> dict[str, Site | str]:
    """What every module of ``model`` that ``run`` calls returns, by name: a :class:`Site`, or in
    words why no adapter fits behind it.

    ``run(2)`` and ``run(3)`` are called: the axis that grows is that of the frames.
    """
    with in_eval_mode(model):
        two, three = _shapes(model, run, 2), _shapes(model, run, 3)
    found: dict[str, Site | str] = {}
    for order, (name, (shape, calls)) in enumerate(two.items()):
        found[name] = _site(shape, three.get(name, (None, 0))[0], order, calls)
    return found


def _shapes(model: nn.Module, run: Run, count: int) -> dict[str, tuple[Any, int]]:
    """Shape of the first output (or its type's name) and number of calls, in order of return."""
    seen: dict[str, tuple[Any, int]] = {}

    def watch(name: str) -> Callable:
        def hook(module: nn.Module, inputs: Any, output: Any) -> None:
            value = first(output)
            float_tensor = isinstance(value, Tensor) and value.is_floating_point()
            shape = tuple(value.shape) if float_tensor else type(value).__name__
            seen[name] = (shape, seen.get(name, (None, 0))[1] + 1)

        return hook

    handles = []
    try:
        for name, module in model.named_modules():
            if name and not isinstance(module, torch.jit.ScriptModule):
                handles.append(module.register_forward_hook(watch(name)))
        run(count)
    finally:
        for handle in handles:
            handle.remove()
    return seen


def _site(two: Any, three: Any, order: int, calls: int) -> Site | str:
    if not isinstance(two, tuple) or not isinstance(three, tuple) or len(two) != len(three):
        return f"it returns {two}"
    grows = [axis for axis, (a, b) in enumerate(zip(two, three, strict=True)) if (a, b) == (2, 3)]
    if len(grows) != 1 or any(
        a != b for i, (a, b) in enumerate(zip(two, three, strict=True)) if i not in grows
    ):
        return f"no axis of what it returns is that of the frames: {two} for two, {three} for three"
    batch, dims = grows[0], len(two)
    if dims == 4 and batch == 0:
        last = two[1] == two[2] != two[3]  # square frames: the equal axes are those of the map
        kind, channels = (TOKENS, two[3]) if last else (MAP, two[1])
    elif dims in (2, 3) and batch in (0, 1) and batch < dims - 1:
        kind, channels = TOKENS, two[-1]
    else:
        return f"it returns {two} for two frames: neither a map, nor tokens, nor a vector"
    return Site(kind, channels, batch, two, order, calls)


def choose(found: dict[str, Site | str], model: nn.Module, count: int) -> list[str]:
    """The names of up to ``count`` blocks, spread evenly from the first to the last.

    A block is a numbered item of a list (``layers.3``) that has modules of its own and returns a
    map or tokens once a pass. Of lists within lists the outermost with at least four blocks in all
    counts: the stages of a ResNet are few, its blocks many. Raises ValueError if there are none.
    """
    levels: dict[int, list[str]] = {}
    modules = dict(model.named_modules())
    for name, site in found.items():
        *above, last = name.split(".")
        block = isinstance(site, Site) and site.calls == 1 and len(site.shape) > 2
        if block and last.isdigit() and any(True for _ in modules[name].children()):
            levels.setdefault(sum(part.isdigit() for part in above), []).append(name)
    for _, names in sorted(levels.items()):
        if len(names) >= 4:
            steps = max(1, count - 1)
            at = {round(i * (len(names) - 1) / steps) for i in range(count)}
            return [name for i, name in enumerate(names) if i in at]
    usable = [name for name, site in found.items() if isinstance(site, Site)]
    raise ValueError(
        "No list of at least four blocks was found in the encoder, so where adapters go must be "
        "told: agent.adapters.targets=[...], regular expressions for the names of modules that "
        f"return maps or tokens. There are {', '.join(usable[:24]) or 'none'}."
    )


def listed(what: str, targets: Iterable[str]) -> list[str]:
    """``targets`` as a list. Raises TypeError for a single text."""
    if isinstance(targets, str):
        raise TypeError(f"{what} is a list of names or regular expressions: [{targets!r}].")
    return list(targets)


def named(model: nn.Module, targets: Iterable[str]) -> set[str]:
    """Names of the modules that ``targets`` (ends of names, or regular expressions) mean. Raises
    ValueError for one that matches none."""
    names = [name for name, _ in model.named_modules() if name]
    found: set[str] = set()
    for target in targets:
        try:
            pattern = re.compile(rf"(?:.*\.)?(?:{target})")
        except re.error as error:
            raise ValueError(
                f"target module {target!r} is no regular expression: {error}."
            ) from error
        hits = {name for name in names if pattern.fullmatch(name)}
        if not hits:
            raise ValueError(
                f"target module {target!r} matches none of the model's {len(names)} modules, such "
                f"as {', '.join(names[:12])}. Give the end of a dotted name, or a regular "
                "expression for it."
            )
        found |= hits
    return found


def channels_of(name: str, module: nn.Module) -> int:
    """Channels of the module's output: those of its last convolution or normalisation."""
    channels = 0
    for part in module.modules():
        if isinstance(part, nn.Conv2d):
            channels = part.out_channels
        elif isinstance(part, nn.GroupNorm):
            channels = part.num_channels
        elif isinstance(part, nn.BatchNorm2d):
            channels = part.num_features
    if not channels:
        raise ValueError(
            f"The channels of {name} cannot be told: it holds no Conv2d, GroupNorm or BatchNorm2d. "
            "Choose a module that ends in one."
        )
    return channels


def inputs_of(name: str, module: nn.Module) -> int:
    """Channels of what goes into the module: into its first convolution."""
    for part in module.modules():
        if isinstance(part, nn.Conv2d):
            return part.in_channels
    raise ValueError(
        f"What goes into {name} cannot be told: it holds no Conv2d. Choose a module that begins "
        "with one, such as the stem."
    )
