"""Wrap a user's encoder: transform its input, select its output and insert adapters."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents import adapters as inserted
from mitigate.agents.sites import choose, find_sites, first
from mitigate.core.files import find
from mitigate.core.names import short, unknown
from mitigate.core.progress import say
from mitigate.corruptions import DepthSensor
from mitigate.encoders import folder as folders
from mitigate.encoders import loading

RESIZE = ("bilinear", "bicubic", "area", "nearest")
FROM_UINT8 = 255.0  # maximum value of RGB frames
MOST = 4096  # maximum side in pixels (heuristic)


@dataclass
class Transform:
    """Convert frames to the encoder's input (floats ``[n, c, size, size]``).

    Frames are RGB (uint8 ``[n, H, W, 3]``) or depth (metres ``[n, H, W, 1]``).

    Args:
        size: side in pixels.
        resize: one of ``RESIZE``; bilinear and bicubic use antialiasing when frames get smaller, as
            in torchvision and PIL.
        crop: whether to resize the shorter side and crop the central square, as CLIP does. If
            false, both sides are resized.
        mean: mean of each channel after division by ``scale``.
        std: standard deviation of each channel after division by ``scale``.
        scale: divisor of RGB values. Use 255 for encoders that expect values from 0 to 1 (most
            encoders), and 1 for values from 0 to 255.
        bgr: whether to reverse the order of the colour channels.
        near: minimum depth in metres (see ``far``).
        far: maximum depth in metres. Depth is clipped to ``near`` and ``far``, scaled to (depth -
            near) / (far - near), as in habitat-lab, and then normalised by ``mean`` and ``std``. If
            it is None, depth is not scaled but stays in metres.

    Raises:
        ValueError: If an argument is invalid; the message names the option.
    """

    size: int
    resize: str = "bilinear"
    crop: bool = False
    bgr: bool = False
    mean: Sequence[float] = (0.0,)
    std: Sequence[float] = (1.0,)
    scale: float = FROM_UINT8
    near: float = 0.0
    far: float | None = None

    def __post_init__(self) -> None:
        _check(vars(self))
        self.mean = [float(value) for value in self.mean]
        self.std = [float(value) for value in self.std]
        self.scale = float(self.scale)
        self.near = float(self.near)
        self.far = None if self.far is None else float(self.far)

    def settings(self) -> dict:
        """Return the arguments as plain data."""
        return dict(vars(self))

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


def transform_of(options: Mapping[str, Any]) -> Transform:
    """Return a transform with the arguments ``options``.

    Raises:
        ValueError: If an argument is unknown or invalid.
    """
    known = [field.name for field in fields(Transform)]
    for name in options:
        if name not in known:
            raise ValueError(unknown("setting of agent.transform", name, known))
    return Transform(**{"size": None, **options})


def _check(options: Mapping[str, Any]) -> None:
    """Raise ValueError for the first invalid argument of a :class:`Transform`."""
    if options["resize"] not in RESIZE:
        raise ValueError(unknown("agent.transform.resize", options["resize"], RESIZE))
    size, near, far, std = (options[name] for name in ("size", "near", "far", "std"))
    whole = isinstance(size, (int, np.integer)) and type(size) is not bool
    rules = {
        "size": (whole and 1 <= size <= MOST, f"a whole number of 1 to {MOST} pixels"),
        "crop": (type(options["crop"]) is bool, "true or false"),
        "bgr": (type(options["bgr"]) is bool, "true or false"),
        "scale": (_number(options["scale"]) and options["scale"] > 0, "a number above 0"),
        "mean": (_numbers(options["mean"]), "a list of numbers, one per channel"),
        "std": (_numbers(std) and min(std) > 0, "a list of numbers above 0, one per channel"),
        "near": (_number(near) and near >= 0, "a number of metres, at least 0"),
        "far": (far is None or _number(far), "null or a number of metres"),
    }
    for name, (valid, words) in rules.items():
        if not valid:
            raise ValueError(f"agent.transform.{name} must be {words}, got {short(options[name])}.")
    if len(options["mean"]) != len(std):
        raise ValueError(
            "agent.transform.mean and agent.transform.std must have the same length, got "
            f"{list(options['mean'])} and {list(std)}."
        )
    if far is not None and not near < far:
        raise ValueError(
            f"agent.transform.near must be less than agent.transform.far, got {near} and {far}."
        )


def _number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _numbers(values: Any) -> bool:
    listed = isinstance(values, (list, tuple, np.ndarray))
    return listed and len(values) > 0 and all(map(_number, values))


TUNE = ("adapters", "all")
POOL = ("mean", "first", "flatten")
SENSORS = {"rgb": 3, "depth": 1}  # number of channels per frame
AUTO, SITES = "auto", 6


class Encoder(nn.Module):
    """Module that maps frames to features; the recipe for encoders trains it instead of an agent.

    Args:
        model: same as in :func:`mitigate.encoders.loading.load_model`.
        transform: arguments of :class:`Transform`.
        kwargs: arguments of ``model``.
        weights: same as in :func:`mitigate.encoders.loading.load_weights`. If None, the weights of
            the model are not changed.
        prefix: same as in :func:`mitigate.encoders.loading.load_weights`.
        sensor: "rgb" or "depth".
        output: which features are trained. None means the output of the model. A number or a name
            selects an item of this output (such as ``pooler_output``). Any other text is the dotted
            name of a module.
        pool: how the report converts features to a vector: "mean" (over positions or tokens),
            "first" (the first token, which is CLIP's class token) or "flatten". In training,
            features are not pooled.
        tune: "adapters" to train only the adapters, or "all" to train all weights of the encoder.
            BatchNorm statistics stay fixed in both cases.
        adapters: a mapping with the keys targets ("auto", or regular expressions), sites (number of
            blocks for "auto"), and reduction, kernel, middle and gate (as in ``insert_adapters``).

    Raises:
        ValueError, FileNotFoundError: If an argument is invalid; the message lists valid values.
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
        choices = {"sensor": (sensor, SENSORS), "pool": (pool, POOL), "tune": (tune, TUNE)}
        for name, (value, allowed) in choices.items():
            if value not in allowed:
                raise ValueError(unknown(f"agent.{name}", value, allowed))
        if model is None:
            raise ValueError(
                "agent.model is not set. Set it to your encoder: package.module:callable, or an "
                "exported file (.pt2, docs/encoder.md)."
            )
        self.given = {"model": model, "kwargs": kwargs, "weights": weights, "prefix": prefix}
        self.sensor, self.output, self.pool, self.tune = sensor, output, pool, tune
        self.transform = transform_of(transform)
        means = len(self.transform.mean)
        channels = SENSORS[sensor]
        if means not in (1, channels):
            raise ValueError(
                f"agent.transform.mean and std have {means} values, but {sensor} has {channels} "
                "channels. Without normalisation, set agent.transform.mean=[0] and std=[1]."
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
                f"agent.tune=all, but {model} has no trainable parameters. Set agent.tune=adapters."
            )
        self.choose_trained()

    def settings(self) -> dict[str, Any]:
        """Return an empty dict, because the config contains all settings."""
        return {}

    def choose_trained(self) -> None:
        """Make the adapters trainable, or all weights if ``tune`` is "all"; freeze all others."""
        trained = {*inserted.adapter_parameters(self.model)}
        for parameter in self.model.parameters():
            chosen = self.tune == "all" or parameter in trained
            parameter.requires_grad_(chosen and parameter.is_floating_point())

    def train(self, mode: bool = True) -> Encoder:
        """Keep the encoder in eval mode, without dropout and with fixed BatchNorm statistics."""
        super().train(mode)
        self.model.train(False)
        return self

    def forward(self, frames: Tensor) -> Tensor:
        """Return features ``[n, C]``, ``[n, C, h, w]`` or ``[n, T, C]``, as the model returns them.

        ``frames`` are RGB (uint8 ``[n, H, W, 3]``) or depth (metres ``[n, H, W, 1]``).
        """
        inputs = self.transform(frames)
        modules = dict(self.model.named_modules()) if isinstance(self.output, str) else {}
        if self.output not in modules or not self.output:
            return self._item(self.model(inputs))
        outputs: list[Any] = []
        module = modules[self.output]
        with module.register_forward_hook(lambda *call: outputs.append(call[2])):
            self.model(inputs)
        if not outputs:
            raise ValueError(
                f"agent.output must name a module that the encoder calls, got {self.output}. "
                "Choose another one."
            )
        return first(outputs[-1])

    def pooled(self, features: Tensor) -> Tensor:
        """Return features as vectors, float32 ``[n, C]``."""
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
        **options: Any,
    ) -> None:
        """Freeze the encoder and insert adapters, which change its output only after training."""
        if targets == AUTO:
            chosen = choose(find_sites(self.model, self._probe), self.model, sites)
            targets = [re.escape(name) for name in chosen]
        targets = [targets] if isinstance(targets, str) else targets
        names = inserted.insert_adapters(self.model, targets, run=self._probe, **options)
        share = inserted.trainable_share(self.model)
        say(f"adapters after {', '.join(names)}: {share:.1%} of the encoder's weights")

    def _probe(self, count: int) -> Any:
        """Return the output for random frames.

        For constant frames, some normalisations would give NaN.
        """
        size, channels = self.transform.size, SENSORS[self.sensor]
        noise = torch.rand(count, channels, size, size, generator=torch.Generator().manual_seed(0))
        like = next(self.model.parameters(), noise)
        return self.model(noise.to(like.device, like.dtype))

    def _item(self, output: Any) -> Tensor:
        """Return the features in the model's ``output`` that ``agent.output`` selects."""
        items: dict[Any, Any] = dict(output) if isinstance(output, Mapping) else {}
        if isinstance(output, (tuple, list)):
            items = dict(enumerate(output))
        first_item = next(iter(items.values()), output)
        chosen = first_item if self.output is None else items.get(self.output)
        if isinstance(chosen, Tensor):
            return chosen
        names = [str(name) for name, value in items.items() if isinstance(value, Tensor)]
        modules = [name for name, _ in self.model.named_modules() if name]
        raise ValueError(
            "agent.output must name an item of the encoder's output or a module, got "
            f"{self.output}. The encoder returns a {type(output).__name__}, items "
            f"{', '.join(names) or 'none'}; modules are, for example, {', '.join(modules[-8:])}."
        )

    @torch.no_grad()
    def _check(self) -> None:
        """Run the model once, so that errors are raised before frames are rendered."""
        self.model.requires_grad_(False)
        size, channels = self.transform.size, SENSORS[self.sensor]
        noise = torch.rand(2, size, size, channels, generator=torch.Generator().manual_seed(0))
        frames = (255 * noise).to(torch.uint8) if self.sensor == "rgb" else 10 * noise  # metres
        try:
            output = self.model(self.transform(frames))
        except Exception as error:  # the user's code may raise any error
            raise ValueError(
                f"The encoder {self.given['model']} failed for {self.sensor} frames [2, "
                f"{channels}, {size}, {size}] ({loading.describe(error, -1)}). Set agent.sensor "
                "and agent.transform.size, and export programs with a dynamic number of frames."
            ) from error
        if isinstance(output, Tensor) and self.output is not None:
            # the model returns a single tensor, so a number names a module instead of an item
            self.output = str(self.output)
        features: Any = self(frames)
        result = type(features).__name__
        if isinstance(features, Tensor):
            result = f"{str(features.dtype).removeprefix('torch.')} {tuple(features.shape)}"
            if features.is_floating_point() and features.dim() in (2, 3, 4) and len(features) == 2:
                if bool(features.isfinite().all()):
                    return
                result += " with NaN or infinity"
        raise ValueError(
            f"agent.output={self.output} must select finite floats [n, C], [n, C, h, w] "
            f"or [n, T, C], got {result} for two frames. Choose another module or item."
        )

    def far(self) -> DepthSensor:
        """Return the depth range of the encoder, which depth corruptions need."""
        far = self.transform.far
        return DepthSensor() if far is None else DepthSensor(z_max=float(far))

    def save(self, folder: str | Path) -> Path:
        """Write the trained weights; see ``folder.py``."""
        return folders.write(self, folder)

    def load(self, folder: str | Path) -> None:
        """Load weights that :meth:`save` wrote; raises the same errors as ``folder.fill``."""
        folders.fill(self, folder)


def _check_fixed(model: str, first_model: nn.Module, second_model: nn.Module) -> None:
    """Raise ValueError if two calls of ``model`` give different weights.

    Adapters work only with the weights that they were trained with. Random weights would be lost
    after training, because only the adapters are saved.
    """
    if inserted.backbone_sha(first_model) == inserted.backbone_sha(second_model):
        return
    other = second_model.state_dict()
    state = first_model.state_dict()
    random = [n for n, v in state.items() if n in other and not v.equal(other[n])]
    raise ValueError(
        f"agent.model={model} initialises {len(random)} of its weights at random "
        f"({', '.join(random[:3])}). Save its state_dict() once, or use trained weights, and set "
        "agent.weights to the file."
    )
