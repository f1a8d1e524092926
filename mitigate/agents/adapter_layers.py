"""The layers of adapters: for maps, for tokens, for the views of a ring, and gates.

Every adapter is residual, ``x + up(act(down(x)))``, and ``up`` starts at zero: a fresh adapter
changes nothing until it has learned.
"""

from __future__ import annotations

import math
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn
from torch.utils.hooks import RemovableHandle

from mitigate.core.observation import HFOV_DEGREES, VIEWS

FLAT = (1e-3, 1e-2)  # second differences that count as none, of values about 1 apart (ours)
TEXTURES = 4 + 4 * (3 + len(FLAT))  # numbers of :func:`textures` for each channel
HIDDEN = 32  # width of the layer that judges (ours)


class Adapter(nn.Module):
    """Base class of all adapters and gates.

    Attributes:
        settings: constructor arguments as plain data.
        corrects: names of the layers that the correction is proportional to (``scale_adapters``).
        gates: the gate of the encoder, if there is one (``insert_adapters``).
        hook: calls the adapter behind its module; None where ``nn.Sequential`` does.
    """

    settings: dict[str, Any]
    corrects: tuple[str, ...] = ()
    gates: list[Adapter]
    hook: RemovableHandle | None = None


class Judged:
    """What a gate said of the last batch: logits ``[n]``, above 0 where it is open."""

    logits: Tensor

    def __getstate__(self) -> dict[str, Tensor]:
        """A copy begins anew: what was said belongs to a forward pass, with its gradients."""
        return {}


class FrameGate(Adapter):
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


def through(gates: list[Adapter], x: Tensor, corrected: Tensor) -> Tensor:
    """``corrected`` for the frames for which the gate is open, ``x`` for the others; ``corrected``
    for all while it trains. ``gates``: of the adapter, one or none; none is always open."""
    if not gates or gates[0].training:
        return corrected
    gate = gates[0]
    assert isinstance(gate, FrameGate)
    logits = gate.judged.logits.view(-1, *[1] * (x.dim() - 1))
    return torch.where(logits > 0, corrected, x)


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


class TokenAdapter(Adapter):
    """``x + up(gelu(down(norm(x))))`` on the last axis of ``[n, T, C]``, ``[T, n, C]``, ``[n, C]``
    or ``[n, h, w, C]``; ``up`` starts at zero.

    Args:
        channels: C. reduction: the bottleneck has ``max(4, C // reduction)`` channels.
        batch: the axis of the frames, 0 or 1 (as in OpenAI's CLIP). gate: see :class:`Gate`.
        middle: of the bottleneck, in place of ``reduction``.

    ``norm`` is a layer norm without weights: residual streams of transformers have a few channels
    far larger than the rest. Source: as ``ConvAdapter``.
    """

    corrects = ("up",)

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


class ConvAdapter(Adapter):
    """``x + up(gelu(down(x)))`` on maps ``[n, C, h, w]``; ``up`` starts at zero.

    Args:
        channels: C. reduction: the bottleneck has ``max(4, C // reduction)`` channels.
        kernel: of the spatial convolution, odd. gate: see :class:`Gate`.
        middle: channels of the bottleneck, in place of ``reduction``.

    Source: bottleneck and zero start after Houlsby et al. 2019, as the paper's section on adapters
    asks; reduction and kernel are ours, chosen for 1-4 % of the weights.
    """

    corrects = ("up",)

    def __init__(
        self,
        channels: int,
        reduction: int = 8,
        kernel: int = 3,
        gate: bool = False,
        middle: int | None = None,
    ) -> None:
        super().__init__()
        if channels < 1 or reduction < 1 or kernel % 2 == 0 or (middle is not None and middle < 1):
            raise ValueError(
                f"An adapter needs channels ({channels}), reduction ({reduction}) and middle "
                f"({middle}) of at least 1 and an odd kernel ({kernel})."
            )
        self.settings = {"channels": channels, "reduction": reduction, "kernel": kernel}
        self.settings |= further(gate, middle)
        middle = middle or max(4, channels // reduction)
        self.down = nn.Conv2d(channels, middle, kernel, padding=kernel // 2)
        self.up = nn.Conv2d(middle, channels, 1)
        self.gate = Gate(middle) if gate else None
        self.gates = []
        for parameter in self.up.parameters():
            nn.init.zeros_(parameter)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(x))
        z = self.up(y)
        if self.gate is not None:
            z = z * self.gate(y, (2, 3)).sigmoid()[:, None, None, None]
        return through(self.gates, x, x + z)


class RingAdapter(Adapter):
    """Zero-initialised residual adapter over a panorama's views: maps ``[P * views, C, h, w]``.

    With y = gelu(down(x)), and ``aligned`` bringing a map's two neighbours into its own frame:

        w = softmax(score(aligned(y)))            over the view and the neighbours that see a cell
        z = gelu(mix([y, sum w aligned(y)]))
        out = x + tanh(share(z)) * (sum w aligned(x) - x) + up(z)

    ``up`` and ``share`` start at zero: nothing changes until they have learned. ``up`` corrects, as
    in any adapter; ``share`` says how much of a cell's features comes from the neighbours, all
    channels at once and without a bottleneck.

    Args: channels: C. reduction: the bottleneck y has ``max(4, C // reduction)`` channels. kernel:
    of ``mix``, odd. views: of a panorama, at least 3. hfov: of a view, in degrees.
    Raises ValueError for other numbers.

    Source: ours; the paper's adapters (its section on adapters) see one view at a time.
    """

    corrects = ("share", "up")  # the correction of a share goes through tanh

    def __init__(
        self,
        channels: int,
        reduction: int = 4,
        kernel: int = 3,
        views: int = VIEWS,
        hfov: float = HFOV_DEGREES,
    ) -> None:
        super().__init__()
        if channels < 1 or reduction < 1 or kernel % 2 == 0 or views < 3 or not 0 < hfov < 180:
            raise ValueError(
                f"A ring adapter needs channels ({channels}) and reduction ({reduction}) of at "
                f"least 1, an odd kernel ({kernel}), at least 3 views ({views}) and a field of "
                f"view between 0 and 180 degrees ({hfov})."
            )
        middle = max(4, channels // reduction)
        self.settings = {
            "channels": channels,
            "reduction": reduction,
            "kernel": kernel,
            "views": views,
            "hfov": hfov,
        }
        self.views, self.hfov = views, hfov
        self.gates = []
        self.down = nn.Conv2d(channels, middle, 1)
        self.score = nn.Conv2d(middle, 1, 1)
        self.mix = nn.Conv2d(2 * middle, middle, kernel, padding=kernel // 2)
        self.share, self.up = nn.Conv2d(middle, 1, 1), nn.Conv2d(middle, channels, 1)
        for parameter in (*self.share.parameters(), *self.up.parameters()):
            nn.init.zeros_(parameter)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(x))
        parts = [x, y, self.score(y)]
        grid = neighbour_grid(x.shape[-2], x.shape[-1], 360 / self.views, self.hfov).to(x.device)
        maps = self.aligned(torch.cat([part.float() for part in parts], 1), grid)
        unseen = (grid.abs() > 1).any(-1)  # [2, h, w]; a view sees all of itself
        scores = torch.stack([each[:, -1] for each in maps], 1)
        scores = scores.masked_fill(F.pad(unseen, (0, 0, 0, 0, 1, 0)), -math.inf)
        weights = scores.softmax(1).unsqueeze(2).unbind(1)
        fused = maps[0] * weights[0]
        for each, weight in zip(maps[1:], weights[1:], strict=True):
            fused = torch.addcmul(fused, each, weight)
        around, y_around, _ = fused.to(x.dtype).split([part.shape[1] for part in parts], 1)
        z = F.gelu(self.mix(torch.cat([y, y_around], 1)))
        return through(self.gates, x, x + self.share(z).tanh() * (around - x) + self.up(z))

    def aligned(self, maps: Tensor, grid: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Each map ``[P * views, C, h, w]``, the one to its left and the one to its right, turned
        into its own frame; zero where a neighbour does not see, and fading to it within half a cell
        of the neighbour's border."""
        ring = maps.unflatten(0, (-1, self.views))
        left, right = (
            F.grid_sample(
                ring.roll(shift, 1).flatten(0, 1),
                turned.expand(maps.shape[0], -1, -1, -1),
                align_corners=False,
            )
            for shift, turned in zip((1, -1), grid, strict=True)
        )
        return maps, left, right


def neighbour_grid(height: int, width: int, step: float, hfov: float) -> Tensor:
    """Where the cells of a view lie in its left and right neighbour.

    Args: height, width: of the map. step: degrees from a view to the next, which is to its right
    (``mitigate/core/observation.py``). hfov: of a view, in degrees; views are as wide as high.
    Returns float32 ``[2, h, w, 2]``, (x, y) in the form of ``grid_sample`` (``align_corners``
    false): inside [-1, 1] where the neighbour sees the cell.
    """
    half = math.tan(math.radians(hfov) / 2)
    x = ((torch.arange(width) + 0.5) / width * 2 - 1) * half
    y = ((torch.arange(height) + 0.5) / height * 2 - 1) * half
    y, x = torch.meshgrid(y, x, indexing="ij")
    sides = []
    for degrees in (-step, step):
        sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        ahead = x * sine + cosine  # the cell's direction (x, y, 1) along the neighbour's axis
        place = torch.stack([(x * cosine - sine) / ahead, y / ahead], -1) / half
        sides.append(torch.where(ahead[..., None] > 1e-3, place, torch.full_like(place, 2.0)))
    return torch.stack(sides)
