"""From frames as a world gives them to what an encoder takes."""

from __future__ import annotations

from collections.abc import Sequence

import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.names import unknown

RESIZE = ("bilinear", "bicubic", "area", "nearest")
FROM_UINT8 = 255.0  # of RGB frames


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
    Raises ValueError for other values.
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
        if resize not in RESIZE:
            raise ValueError(unknown("agent.transform.resize", resize, RESIZE))
        if size < 1 or scale <= 0 or min(std) <= 0 or len(mean) != len(std):
            raise ValueError(
                f"agent.transform needs a size ({size}) of at least 1, a scale ({scale}) and std "
                f"({list(std)}) above 0, and as many means ({list(mean)}) as std."
            )
        if far is not None and not near < far:
            raise ValueError(f"agent.transform: near ({near}) must be less than far ({far}).")
        self.size, self.resize, self.crop, self.bgr = size, resize, crop, bgr
        self.mean, self.std, self.scale, self.near, self.far = mean, std, scale, near, far

    def settings(self) -> dict:
        """The arguments, as plain data."""
        lists = {"mean": list(self.mean), "std": list(self.std)}
        return {**self.__dict__, **lists}

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
