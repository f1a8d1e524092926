"""A gate that an encoder's adapters share: frames that nothing has happened to pass as they are."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

FLAT = (1e-3, 1e-2)  # second differences that count as none, of values about 1 apart (ours)
TEXTURES = 4 + 4 * (3 + len(FLAT))  # numbers of :func:`textures` for each channel
HIDDEN = 32  # width of the layer that judges (ours)


class Judged:
    """What a gate said of the last batch: logits ``[n]``, above 0 where it is open."""

    logits: Tensor

    def __getstate__(self) -> dict[str, Tensor]:
        """A copy begins anew: what was said belongs to a forward pass, with its gradients."""
        return {}


class FrameGate(nn.Module):
    """Says of each frame ``[n, C, h, w]`` that goes into a module whether it is corrupted.

    The adapters behind it in the same encoder correct only the frames for which it is open
    (:func:`through`), so what it takes for clean gets the features of the encoder without adapters,
    bit for bit. Reads the mean, the standard deviation and the maximum of two convolutions, and
    :func:`textures`; of a panorama also their mean over its views. While the adapters train it is
    always open: they learn from all frames, and it learns beside them.

    Args: channels: C. middle: channels of the convolutions. views: of a panorama, which follow one
    another in the batch; 1: each frame is judged by itself. ``threshold`` is taken from the logits:
    ``calibrate`` sets it.

    Source: ours; learned statistics and a threshold on clean frames in place of the paper's rule of
    feature magnitudes.
    """

    threshold: Tensor

    def __init__(self, channels: int, middle: int = 16, views: int = 1) -> None:
        super().__init__()
        if channels < 1 or middle < 1 or views < 1:
            raise ValueError(
                f"A gate needs channels ({channels}), middle ({middle}) and views ({views}) >= 1."
            )
        self.settings = {"kind": "gate", "channels": channels, "middle": middle, "views": views}
        self.views = views
        self.first = nn.Conv2d(channels, middle, 3, padding=1)
        self.second = nn.Conv2d(middle, middle, 3, stride=2, padding=1)
        read = 3 * middle + TEXTURES * channels
        self.hidden = nn.Linear(read * (1 if views == 1 else 2), HIDDEN)
        self.judge = nn.Linear(HIDDEN, 1)
        self.register_buffer("threshold", torch.zeros(()))
        self.judged = Judged()

    def forward(self, x: Tensor) -> Tensor:
        """``x`` as it is: a gate in an ``nn.Sequential`` changes nothing."""
        return x

    def look(self, x: Tensor) -> None:
        """Judge frames ``[n, C, h, w]``."""
        x = x.detach().float()
        y = F.gelu(self.second(F.gelu(self.first(x)))).flatten(2)
        spread = (y.var(2, correction=0) + 1e-6).sqrt()
        own = torch.cat([y.mean(2), spread, y.amax(2), textures(x)], 1)
        if self.views > 1:
            ring = own.unflatten(0, (-1, self.views))
            own = torch.cat([ring, ring.mean(1, keepdim=True).expand_as(ring)], 2).flatten(0, 1)
        self.judged.logits = self.judge(F.gelu(self.hidden(own)))[:, 0] - self.threshold

    def calibrate(self, logits: Tensor, touched: float) -> None:
        """Move the threshold so that it opens for a share ``touched`` of the clean frames of which
        it said ``logits`` [n]."""
        self.threshold += logits.float().quantile(1 - touched).to(self.threshold.dtype)


def textures(x: Tensor) -> Tensor:
    """What tells noise, blur, steps, dark and holes from a clean frame: float32 [n, C * TEXTURES]
    of frames ``[n, C, h, w]``, each channel in values about 1 apart. Sizes as logarithms."""
    found = [x.mean((2, 3)), x.std((2, 3)), *((x.flatten(2).amin(2)), (x.flatten(2).amax(2)))]
    for level in (x, F.avg_pool2d(x, 2)):
        for axis in (2, 3):
            bend = level.diff(n=2, dim=axis).abs()
            sizes = [level.diff(dim=axis).abs().mean((2, 3)), bend.mean((2, 3))]
            sizes.append(bend.square().mean((2, 3)))
            found += [(size + 1e-4).log() / 3 + 1 for size in sizes]
            found += [(bend < flat).float().mean((2, 3)) for flat in FLAT]
    return torch.cat(found, 1)


def through(gates: list[FrameGate], x: Tensor, corrected: Tensor) -> Tensor:
    """``corrected`` for the frames for which the gate is open, ``x`` for the others; ``corrected``
    for all while it trains. ``gates``: of the adapter, one or none; none is always open."""
    if not gates or gates[0].training:
        return corrected
    logits = gates[0].judged.logits.view(-1, *[1] * (x.dim() - 1))
    return torch.where(logits > 0, corrected, x)
