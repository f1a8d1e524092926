"""Adapters for blocks that give tokens or a vector, and the gate that any adapter may have."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn


class Gate(nn.Module):
    """How much of its adapter's correction a frame gets: ``[n]`` logits from the bottleneck.

    Reads the mean and the root mean square of each of its ``middle`` channels over a frame. On
    frames that nothing has happened to it should be shut, so that clean features stay as they were;
    a recipe may teach it that (``recipes/encoder.py``), and it learns with the rest in any case.
    """

    def __init__(self, middle: int) -> None:
        super().__init__()
        self.read = nn.Linear(2 * middle, 1)

    def forward(self, y: Tensor, over: tuple[int, ...]) -> Tensor:
        """``over``: the axes of ``y`` that are neither frames nor channels; none for vectors."""
        if over:
            mean, power = y.mean(over), (y * y).mean(over)
        else:
            mean, power = y, y * y
        return self.read(torch.cat([mean, (power + 1e-6).sqrt()], 1))[:, 0]


class TokenAdapter(nn.Module):
    """``x + up(gelu(down(norm(x))))`` on the last axis of ``[n, T, C]``, ``[T, n, C]``, ``[n, C]``
    or ``[n, h, w, C]``; ``up`` starts at zero.

    Args:
        channels: C. reduction: the bottleneck has ``max(4, C // reduction)`` channels.
        batch: the axis of the frames, 0 or 1 (as in OpenAI's CLIP). gate: see :class:`Gate`.
        middle: of the bottleneck, in place of ``reduction``.

    ``norm`` is a layer norm without weights: residual streams of transformers have a few channels
    far larger than the rest. Source: as ``ConvAdapter``.
    """

    corrects = ("up",)  # as in ``ConvAdapter``

    def __init__(
        self,
        channels: int,
        reduction: int = 8,
        batch: int = 0,
        gate: bool = False,
        middle: int | None = None,
    ) -> None:
        super().__init__()
        if (
            channels < 1
            or reduction < 1
            or batch not in (0, 1)
            or (middle is not None and middle < 1)
        ):
            raise ValueError(
                f"A token adapter needs channels ({channels}), reduction ({reduction}) and middle "
                f"({middle}) of at least 1, and its frames on axis 0 or 1 ({batch})."
            )
        self.settings = {"kind": "tokens", "channels": channels, "reduction": reduction}
        self.settings |= {"batch": batch, **further(gate, middle)}
        middle = middle or max(4, channels // reduction)
        self.batch, self.channels = batch, channels
        self.down, self.up = nn.Linear(channels, middle), nn.Linear(middle, channels)
        self.gate = Gate(middle) if gate else None
        for parameter in self.up.parameters():
            nn.init.zeros_(parameter)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(F.layer_norm(x, (self.channels,))))
        z = self.up(y)
        if self.gate is not None:
            over = tuple(axis for axis in range(x.dim() - 1) if axis != self.batch)
            shape = [1] * x.dim()
            shape[self.batch] = -1
            z = z * self.gate(y, over).sigmoid().view(shape)
        return x + z


def further(gate: bool, middle: int | None) -> dict[str, bool | int]:
    """The settings that an adapter names only if it has them."""
    return {**({"gate": True} if gate else {}), **({"middle": middle} if middle else {})}
