"""A gate that an encoder's adapters share: frames that nothing has happened to pass as they are."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn


class Judged:
    """What a gate said of the last batch: logits ``[n]``, above 0 where it is open."""

    logits: Tensor

    def __getstate__(self) -> dict[str, Tensor]:
        """A copy begins anew: what was said belongs to a forward pass, with its gradients."""
        return {}


class FrameGate(nn.Module):
    """Says of each frame, from the map ``[n, C, h, w]`` behind an encoder's stem, whether it is
    corrupted; the map passes as it is.

    The adapters behind it in the same encoder correct only the frames for which it is open
    (:func:`through`), so what it takes for clean gets the features of the encoder without adapters,
    bit for bit. Reads the mean, the standard deviation and the maximum of two convolutions.

    Args: channels: C. middle: channels of the convolutions.

    Source: ours; a threshold on learned statistics in place of the paper's rule of feature
    magnitudes.
    """

    def __init__(self, channels: int, middle: int = 16) -> None:
        super().__init__()
        if channels < 1 or middle < 1:
            raise ValueError(f"A gate needs channels ({channels}) and middle ({middle}) >= 1.")
        self.settings = {"kind": "gate", "channels": channels, "middle": middle}
        self.first = nn.Conv2d(channels, middle, 3, padding=1)
        self.second = nn.Conv2d(middle, middle, 3, stride=2, padding=1)
        self.judge = nn.Linear(3 * middle, 1)
        self.judged = Judged()

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.second(F.gelu(self.first(x)))).flatten(2)
        spread = (y.var(2, correction=0) + 1e-6).sqrt()
        self.judged.logits = self.judge(torch.cat([y.mean(2), spread, y.amax(2)], 1))[:, 0]
        return x


def through(gates: list[FrameGate], x: Tensor, corrected: Tensor) -> Tensor:
    """``corrected`` for the frames for which the gate is open, ``x`` for the others; a blend while
    it trains. ``gates``: of the adapter, one or none; none is always open."""
    if not gates:
        return corrected
    logits = gates[0].judged.logits.view(-1, *[1] * (x.dim() - 1))
    if gates[0].training:
        return x + logits.sigmoid() * (corrected - x)
    return torch.where(logits > 0, corrected, x)
