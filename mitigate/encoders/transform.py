"""From frames as a world gives them to what an encoder takes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from inspect import signature
from numbers import Real
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.names import short, unknown

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
