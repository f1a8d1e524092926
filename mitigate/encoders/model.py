"""An encoder that is not ours, with its transform, the output that is its target, and adapters."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from inspect import signature
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents import adapters as inserted
from mitigate.agents.sites import choose, first, look
from mitigate.core.files import find
from mitigate.core.names import short, unknown
from mitigate.core.progress import say
from mitigate.corruptions import DepthSensor
from mitigate.encoders import folder as folders
from mitigate.encoders import loading

RESIZE = ("bilinear", "bicubic", "area", "nearest")
FROM_UINT8 = 255.0  # of RGB frames
MOST = 4096  # pixels of a side (ours)


class Transform:
    """uint8 ``[n, H, W, 3]`` or float metres ``[n, H, W, 1]`` to float32 ``[n, c, size, size]``.

    Args:
        size: pixels of a side. resize: one of ``RESIZE``; bilinear and bicubic are antialiased
            where they shrink, as in torchvision and PIL. crop: resize the shorter side and take the
            middle square (CLIP), in place of resizing both sides.
        mean, std: of each channel, after ``scale``. scale: RGB is divided by it: 255 to get 0 to 1
            (most encoders), 1 for encoders that take 0 to 255. bgr: channels in reverse.
        near, far: metres. Depth is clipped to them and becomes (depth - near) / (far - near), as in
            habitat-lab, and then meets mean and std; far null: metres as they are.
    Raises ValueError for other values, naming the option.
    """

    def __init__(
        self,
        size: int,
        resize: str = "bilinear",
        crop: bool = False,
        mean: Sequence[float] = (0.0,),
        std: Sequence[float] = (1.0,),
        scale: float = FROM_UINT8,
        bgr: bool = False,
        near: float = 0.0,
        far: float | None = None,
    ) -> None:
        _check(locals())
        self.size, self.resize, self.crop, self.bgr = size, resize, crop, bgr
        self.mean, self.std = [float(x) for x in mean], [float(x) for x in std]
        self.scale, self.near, self.far = float(scale), float(near), far

    def settings(self) -> dict:
        """The arguments, as plain data."""
        return dict(self.__dict__)

    def __call__(self, frames: Tensor) -> Tensor:
        x = frames.permute(0, 3, 1, 2)
        if frames.dtype == torch.uint8:
            x = x.float() / self.scale
        elif self.far is not None:
            x = (x.float().clamp(self.near, self.far) - self.near) / (self.far - self.near)
        x = self._resized(x.float().contiguous())
        if self.bgr:
            x = x.flip(1)
        mean = torch.tensor(self.mean, device=x.device)[:, None, None]
        return (x - mean) / torch.tensor(self.std, device=x.device)[:, None, None]

    def _resized(self, x: Tensor) -> Tensor:
        height, width = x.shape[-2:]
        if (height, width) == (self.size, self.size):
            return x
        size = (self.size, self.size)
        if self.crop:
            shorter = min(height, width)
            size = (round(self.size * height / shorter), round(self.size * width / shorter))
        smooth = self.resize in ("bilinear", "bicubic")
        kind = {"align_corners": False, "antialias": True} if smooth else {}
        x = F.interpolate(x, size, mode=self.resize, **kind)
        top, left = (size[0] - self.size) // 2, (size[1] - self.size) // 2
        return x[..., top : top + self.size, left : left + self.size]


def transform_of(given: Mapping[str, Any]) -> Transform:
    """The transform with the arguments ``given``. ValueError for a name that it does not have and
    for a value that it does not take."""
    known = [*signature(Transform).parameters]
    for name in given:
        if name not in known:
            raise ValueError(unknown("setting of agent.transform", name, known))
    return Transform(**{"size": None, **given})


def _check(given: Mapping[str, Any]) -> None:
    """Raise ValueError for the first argument of a :class:`Transform` that is none."""
    if given["resize"] not in RESIZE:
        raise ValueError(unknown("agent.transform.resize", given["resize"], RESIZE))
    size, near, far, std = (given[name] for name in ("size", "near", "far", "std"))
    whole = isinstance(size, (int, np.integer)) and type(size) is not bool
    wanted = {
        "size": (whole and 1 <= size <= MOST, f"a whole number of 1 to {MOST} pixels"),
        "crop": (type(given["crop"]) is bool, "true or false"),
        "bgr": (type(given["bgr"]) is bool, "true or false"),
        "scale": (_number(given["scale"]) and given["scale"] > 0, "a number above 0"),
        "mean": (_numbers(given["mean"]), "a list of numbers, one a channel"),
        "std": (_numbers(std) and min(std) > 0, "a list of numbers above 0, one a channel"),
        "near": (_number(near) and near >= 0, "a number of metres, at least 0"),
        "far": (far is None or _number(far), "null or a number of metres"),
    }
    for name, (good, words) in wanted.items():
        if not good:
            raise ValueError(f"agent.transform.{name}={short(given[name])} must be {words}.")
    if len(given["mean"]) != len(std):
        raise ValueError(
            f"agent.transform.mean={list(given['mean'])} and agent.transform.std={list(std)} must "
            "have as many values."
        )
    if far is not None and not near < far:
        raise ValueError(
            f"agent.transform.near={near} must be less than agent.transform.far={far}."
        )


def _number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _numbers(values: Any) -> bool:
    listed = isinstance(values, (list, tuple, np.ndarray))
    return listed and len(values) > 0 and all(map(_number, values))


TUNE = ("adapters", "all")
POOL = ("mean", "first", "flatten")
SENSORS = {"rgb": 3, "depth": 1}  # channels of a frame
AUTO, SITES = "auto", 6


class Encoder(nn.Module):
    """Frames in, features out; stands where the other recipes have an agent.

    Args:
        model, kwargs: as :func:`mitigate.encoders.loading.load_model`. weights, prefix: as
            ``load_weights`` there; None: those that the model comes with.
        sensor: "rgb" or "depth". transform: arguments of ``transform.Transform``.
        output: what is the target: None: what the model returns; a number or a name: that item of
            it (``pooler_output``); else the dotted name of a module, whose output it is.
        pool: how features become a vector for the report: the mean over places or tokens, the first
            token (CLIP's class token), or all of it. The target itself is not pooled.
        tune: "adapters", or "all" of the encoder's weights (its BatchNorms keep their statistics).
        adapters: targets ("auto", or regular expressions), sites (how many blocks "auto" takes),
            reduction, kernel, middle, gate: as ``insert_adapters``.
    Raises ValueError or FileNotFoundError for what does not fit, saying what would.
    """

    own_config_only = ("model", "kwargs", "weights", "prefix")  # core/build.py

    def __init__(
        self,
        model: str | None,
        transform: Mapping[str, Any],
        kwargs: Mapping[str, Any] | None = None,
        weights: str | None = None,
        prefix: str = "",
        sensor: str = "rgb",
        output: str | int | None = None,
        pool: str = "mean",
        tune: str = "adapters",
        adapters: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__()
        for name, value, allowed in (
            ("sensor", sensor, SENSORS),
            ("pool", pool, POOL),
            ("tune", tune, TUNE),
        ):
            if value not in allowed:
                raise ValueError(unknown(f"agent.{name}", value, list(allowed)))
        if model is None:
            raise ValueError(
                "agent.model is not set: name your encoder as agent.model=package.module:callable, "
                "or a TorchScript (.ts, .pt) or exported (.pt2) file (docs/encoder.md)."
            )
        self.given = {"model": model, "kwargs": kwargs, "weights": weights, "prefix": prefix}
        self.sensor, self.output, self.pool, self.tune = sensor, output, pool, tune
        self.transform = transform_of(transform)
        means, channels = len(self.transform.mean), SENSORS[sensor]
        if means not in (1, channels):
            raise ValueError(
                f"agent.transform.mean and std have {means} values, but {sensor} has {channels} "
                "channels. For depth as it is: agent.transform.mean=[0] agent.transform.std=[1]."
            )
        self.model = loading.load_model(model, kwargs)
        if weights is not None:
            loading.load_weights(self.model, weights, prefix)
        self._check()
        if weights is None and tune == "adapters" and not find(model).is_file():
            with torch.random.fork_rng(devices=[]):
                _check_fixed(model, self.model, loading.load_model(model, kwargs))
        if tune == "adapters":
            self.add_adapters(**(adapters or {}))
        elif not any(p.is_floating_point() for p in self.model.parameters()):
            raise ValueError(
                f"agent.tune=all, but {model} has no parameters that could train (a frozen "
                "TorchScript has none): agent.tune=adapters."
            )
        self.choose_trained()

    @property
    def wrapped(self) -> bool:
        """Whether the model is a TorchScript, whose inside no adapter reaches."""
        return isinstance(self.model, loading.Wrapped)

    def settings(self) -> dict[str, Any]:
        """What is known of it beside its config: nothing."""
        return {}

    def choose_trained(self) -> None:
        """Let the adapters train and nothing else, or all that can."""
        self.model.requires_grad_(False)
        trained = inserted.adapter_parameters(self.model)
        if self.tune == "all":
            trained = [p for p in self.model.parameters() if p.is_floating_point()]
        for parameter in trained:
            parameter.requires_grad_(True)

    def train(self, mode: bool = True) -> Encoder:
        """The encoder stays in eval mode: no dropout, and its BatchNorms keep their statistics."""
        super().train(mode)
        self.model.train(False)
        return self

    def forward(self, frames: Tensor) -> Tensor:
        """Features of uint8 ``[n, H, W, 3]`` or metres ``[n, H, W, 1]``: ``[n, C]``,
        ``[n, C, h, w]`` or ``[n, T, C]``, as the model gives them."""
        given = self.transform(frames)
        modules = dict(self.model.named_modules()) if isinstance(self.output, str) else {}
        if self.output not in modules or not self.output:
            return self._item(self.model(given))
        seen: list[Any] = []
        module = modules[self.output]
        handle = module.register_forward_hook(lambda *called: seen.append(called[2]))
        try:
            self.model(given)
        finally:
            handle.remove()
        if not seen:
            raise ValueError(f"The encoder does not call its module {self.output} (agent.output).")
        return first(seen[-1])

    def pooled(self, features: Tensor) -> Tensor:
        """Features as vectors, float32 ``[n, C]``."""
        features = features.float()
        if features.dim() <= 2 or self.pool == "flatten":
            return features.flatten(1)
        if features.dim() == 4:
            return features.mean((2, 3)) if self.pool == "mean" else features[:, :, 0, 0]
        return features.mean(1) if self.pool == "mean" else features[:, 0]

    def add_adapters(
        self,
        targets: str | Sequence[str] = AUTO,
        sites: int = SITES,
        reduction: int = 8,
        kernel: int = 3,
        middle: int | None = None,
        gate: bool = False,
    ) -> None:
        """Freeze the encoder and put adapters into it; it computes what it did before."""
        where = self.targets(targets, sites)
        names = inserted.insert_adapters(
            self.model,
            where,
            reduction=reduction,
            kernel=kernel,
            run=self._probe,
            gate=gate,
            middle=middle,
        )
        share = inserted.trainable_share(self.model)
        say(f"adapters behind {', '.join(names)}: {share:.1%} of the encoder's weights")

    def targets(self, targets: str | Sequence[str], count: int) -> list[str]:
        """Regular expressions of the modules that get adapters."""
        if targets != AUTO:
            return [targets] if isinstance(targets, str) else list(targets)
        if self.wrapped:
            return ["before", "behind"]
        chosen = choose(look(self.model, self._probe), self.model, count)
        return [re.escape(name) for name in chosen]

    def _probe(self, count: int) -> Any:
        """The model's answer to noise: to constant frames some normalisations give NaN."""
        size, channels = self.transform.size, SENSORS[self.sensor]
        noise = torch.rand(count, channels, size, size, generator=torch.Generator().manual_seed(0))
        like = next(self.model.parameters(), noise)
        return self.model(noise.to(like.device, like.dtype))

    def _item(self, output: Any) -> Tensor:
        """The target in what the model returned."""
        items: dict[Any, Any] = dict(output) if isinstance(output, Mapping) else {}
        if isinstance(output, (tuple, list)):
            items = dict(enumerate(output))
        if self.output is not None:
            chosen = items.get(self.output)
        else:
            chosen = next(iter(items.values()), None) if items else first(output)
        if isinstance(chosen, Tensor):
            return chosen
        names = [str(name) for name, value in items.items() if isinstance(value, Tensor)]
        modules = [name for name, _ in self.model.named_modules() if name]
        what = f"It returns {', '.join(names)}. " if names else ""
        raise ValueError(
            f"agent.output={self.output} is nothing that the encoder gives (it returns a "
            f"{type(output).__name__}). {what}Name one of these, or a module, such as "
            f"{', '.join(modules[-8:])}."
        )

    @torch.no_grad()
    def _check(self) -> None:
        """Run it once, so that what does not fit shows before anything is rendered."""
        self.model.requires_grad_(False)
        size, channels = self.transform.size, SENSORS[self.sensor]
        drawn = torch.rand(2, size, size, channels, generator=torch.Generator().manual_seed(0))
        frames = (255 * drawn).to(torch.uint8) if self.sensor == "rgb" else 10 * drawn  # metres
        try:
            given = self.model(self.transform(frames))
        except Exception as error:  # of any kind: it is somebody's code
            raise ValueError(
                f"The encoder {self.given['model']} does not take {self.sensor} frames [2, "
                f"{channels}, {size}, {size}] ({loading.told(error, -1)}). Set "
                "agent.transform.size to its input's pixels and agent.sensor to rgb or depth; a "
                "program traced or exported for one frame takes no two: give it a dynamic number "
                "of frames."
            ) from error
        if isinstance(given, Tensor) and self.output is not None:
            self.output = str(self.output)  # of one tensor there are no items: 3 is a module's name
        features: Any = self(frames)
        what = type(features).__name__
        if isinstance(features, Tensor):
            what = f"{str(features.dtype).removeprefix('torch.')} {tuple(features.shape)}"
            if features.is_floating_point() and features.dim() in (2, 3, 4) and len(features) == 2:
                if bool(features.isfinite().all()):
                    return
                what += " with NaN or infinity"
        raise ValueError(
            f"agent.output={self.output} gives {what} for two frames: it must be finite floats "
            "[n, C], [n, C, h, w] or [n, T, C]. Name another module or item."
        )

    def far(self) -> DepthSensor:
        """What depth corruptions must know of the sensor."""
        far = self.transform.far
        return DepthSensor() if far is None else DepthSensor(z_max=float(far))

    def save(self, folder: str | Path) -> Path:
        """Write what was trained: see ``folder.py``."""
        return folders.write(self, folder)

    def load(self, folder: str | Path) -> None:
        """Read what :meth:`save` wrote; errors as ``folder.fill``."""
        folders.fill(self, folder)


def _check_fixed(model: str, made: nn.Module, again: nn.Module) -> None:
    """Raise ValueError if what the callable ``model`` made twice has other weights each time:
    adapters fit the weights that they were trained with, and those would be lost."""
    if inserted.backbone_sha(made) == inserted.backbone_sha(again):
        return
    other = again.state_dict()
    drawn = [n for n, v in made.state_dict().items() if n in other and not v.equal(other[n])]
    raise ValueError(
        f"agent.model={model} draws {len(drawn)} of its weights at random "
        f"({', '.join(drawn[:3])}), so nothing would fit the adapters afterwards. Save its "
        "state_dict() once, or take the trained one, and name the file: agent.weights=FILE."
    )
