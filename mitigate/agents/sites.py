"""Find where adapters fit: run an encoder on probe frames and record what each module returns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents.networks import in_eval_mode

Run = Callable[[int], Any]  # runs the encoder on the given number of frames
MAP, TOKENS = "map", "tokens"


@dataclass(frozen=True)
class Site:
    """Describes the output of a module."""

    kind: str  # MAP for [n, C, h, w], or TOKENS if C is the last axis (including vectors)
    channels: int
    batch: int  # axis along which the frames of a batch lie
    shape: tuple[int, ...]  # shape of the output for a batch of two frames
    calls: int  # number of calls of the module in one forward pass


def first(output: Any) -> Any:
    """Return the first item of a tuple or list (as Hugging Face blocks return), or ``output``."""
    return output[0] if isinstance(output, (tuple, list)) and len(output) else output


@torch.no_grad()
def find_sites(model: nn.Module, run: Run) -> dict[str, Site | str]:
    """Return a description of the output of every module that ``run`` calls, by the module's name.

    The description is a :class:`Site`, or a text that explains why no adapter fits. To find the
    axis of the frames, the encoder runs on two frames and on three: this axis grows from 2 to 3.
    """
    with in_eval_mode(model):
        two, three = _shapes(model, run, 2), _shapes(model, run, 3)
    return {
        name: _site(shape, three.get(name, (None, 0))[0], calls)
        for name, (shape, calls) in two.items()
    }


def _shapes(model: nn.Module, run: Run, count: int) -> dict[str, tuple[Any, int]]:
    """Return each module's output shape (or type name) and number of calls, in call order."""
    seen: dict[str, tuple[Any, int]] = {}

    def watch(name: str) -> Callable:
        def hook(module: nn.Module, inputs: Any, output: Any) -> None:
            value = first(output)
            float_tensor = isinstance(value, Tensor) and value.is_floating_point()
            shape = tuple(value.shape) if float_tensor else type(value).__name__
            seen[name] = (shape, seen.get(name, (None, 0))[1] + 1)

        return hook

    with ExitStack() as hooks:
        for name, module in model.named_modules():
            if name:
                hooks.enter_context(module.register_forward_hook(watch(name)))
        run(count)
    return seen


def _site(two: Any, three: Any, calls: int) -> Site | str:
    if not isinstance(two, tuple) or not isinstance(three, tuple) or len(two) != len(three):
        return f"it returns {two}"
    changed = [axis for axis, (a, b) in enumerate(zip(two, three, strict=True)) if a != b]
    if len(changed) != 1 or (two[changed[0]], three[changed[0]]) != (2, 3):
        return f"no axis of its output holds the frames: {two} for two frames, {three} for three"
    batch, dims = changed[0], len(two)
    if dims == 4 and batch == 0:
        last = two[1] == two[2] != two[3]  # frames are square, so the equal axes are h and w
        kind, channels = (TOKENS, two[3]) if last else (MAP, two[1])
    elif dims in (2, 3) and batch in (0, 1) and batch < dims - 1:
        kind, channels = TOKENS, two[-1]
    else:
        return f"it returns {two} for two frames: neither a map, nor tokens, nor a vector"
    return Site(kind, channels, batch, two, calls)


def choose(sites: dict[str, Site | str], model: nn.Module, count: int) -> list[str]:
    """Return the names of up to ``count`` blocks, spread evenly from the first to the last.

    A block is a numbered item of a list (``layers.3``) that contains modules and returns a map or
    tokens once per forward pass. If lists are nested, the outermost list with at least four blocks
    is used. A ResNet, for example, has four stages in one list, and each stage is a list of blocks.

    Raises:
        ValueError: If the encoder has no list of at least four blocks.
    """
    levels: dict[int, list[str]] = {}
    modules = dict(model.named_modules())
    for name, site in sites.items():
        *above, last = name.split(".")
        block = isinstance(site, Site) and site.calls == 1 and len(site.shape) > 2
        if block and last.isdigit() and any(True for _ in modules[name].children()):
            levels.setdefault(sum(part.isdigit() for part in above), []).append(name)
    for _, names in sorted(levels.items()):
        if len(names) >= 4:
            steps = max(1, count - 1)
            at = {round(i * (len(names) - 1) / steps) for i in range(count)}
            return [name for i, name in enumerate(names) if i in at]
    usable = [name for name, site in sites.items() if isinstance(site, Site)]
    raise ValueError(
        "The encoder has no list of at least four blocks. Name the modules to adapt: "
        f"agent.adapters.targets=[...]. Possible modules: {', '.join(usable[:24]) or 'none'}."
    )


def listed(what: str, targets: Iterable[str]) -> list[str]:
    """Return the targets as a list. Raises TypeError for a single string."""
    if isinstance(targets, str):
        raise TypeError(
            f"{what} must be a list of names or regular expressions, got a string. Write "
            f"[{targets!r}]."
        )
    return list(targets)


def named(model: nn.Module, targets: Iterable[str]) -> set[str]:
    """Return the names of the modules that match ``targets``.

    A target is a regular expression that must match a dotted name or its last parts.

    Raises:
        ValueError: If a target matches no module or is not a regular expression.
    """
    names = [name for name, _ in model.named_modules() if name]
    matches: set[str] = set()
    for target in targets:
        try:
            pattern = re.compile(rf"(?:.*\.)?(?:{target})")
        except re.error as error:
            raise ValueError(
                f"target module must be a regular expression, got {target!r} ({error})."
            ) from error
        hits = {name for name in names if pattern.fullmatch(name)}
        if not hits:
            raise ValueError(
                f"target module {target!r} matches none of the model's {len(names)} modules (for "
                f"example {', '.join(names[:12])}). Give a regular expression that matches a "
                "module's name or its last parts."
            )
        matches |= hits
    return matches


def channels_of(name: str, module: nn.Module) -> int:
    """Return the output channels of a module, from its last convolution or normalisation."""
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
            f"The output channels of {name} are unknown: it has no Conv2d, GroupNorm or "
            "BatchNorm2d. Choose a module that ends in one."
        )
    return channels


def inputs_of(name: str, module: nn.Module) -> int:
    """Return the number of input channels of a module, from its first convolution."""
    for part in module.modules():
        if isinstance(part, nn.Conv2d):
            return part.in_channels
    raise ValueError(
        f"The input channels of {name} are unknown: it has no Conv2d. Choose a module that begins "
        "with one, such as the stem."
    )
