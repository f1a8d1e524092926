"""Adapter layers for feature maps, for tokens and for the views of a panorama, and their gates.

Every adapter is residual, ``x + up(act(down(x)))``, and ``up`` is initialised to zero. A new
adapter therefore changes nothing until it is trained.
"""

from __future__ import annotations

import math
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn
from torch.utils.hooks import RemovableHandle

from mitigate.core.observation import HFOV_DEGREES, VIEWS

# absolute second differences below these count as 0 (heuristic, for a value range of about 1)
FLAT = (1e-3, 1e-2)
TEXTURES = 4 + 4 * (3 + len(FLAT))  # number of outputs of :func:`textures` per channel
HIDDEN = 32  # width of a gate's hidden layer (heuristic)


class Adapter(nn.Module):
    """Base class of all adapters and gates.

    Attributes:
        settings: constructor arguments as plain data.
        corrects: names of the layers that ``scale_adapters`` scales.
        gates: list with the gate of the encoder, empty if the encoder has no gate
            (``insert_adapters``). It is a list because a module that is assigned to an attribute
            becomes a submodule, and the gate's weights would be stored once per adapter.
        hook: handle of the hook that calls the adapter after its module, or None if
            ``nn.Sequential`` calls it.
    """

    settings: dict[str, Any]
    corrects: tuple[str, ...] = ()
    gates: list[Adapter]
    hook: RemovableHandle | None = None


def check_sizes(owner: str, kernel: int = 1, **sizes: int | None) -> None:
    """Raise ValueError if a size is below 1 or the kernel is even; sizes of None are skipped."""
    for name, size in sizes.items():
        if size is not None and size < 1:
            raise ValueError(f"{name} of a {owner} must be >= 1, got {size}.")
    if kernel % 2 == 0:
        raise ValueError(f"kernel of a {owner} must be odd, got {kernel}.")


def set_to_zero(*layers: nn.Module) -> None:
    """Set all weights and biases of ``layers`` to zero."""
    for parameter in nn.ModuleList(layers).parameters():
        nn.init.zeros_(parameter)


class GateLogits:
    """The logits ``[n]`` of a gate for the last batch; a gate is open for logits above 0."""

    logits: Tensor

    def __getstate__(self) -> dict[str, Tensor]:
        return {}  # not copied, because the logits belong to one forward pass and its gradients


class FrameGate(Adapter):
    """Classify each frame ``[n, C, h, w]`` that enters a module as clean or corrupted.

    If the gate is closed for a frame, the adapters that follow in the same encoder do not correct
    this frame (:func:`through`). For a frame that is classified as clean, the encoder's output
    equals its output without adapters. The gate reads the mean, the standard deviation and the
    maximum of two convolutions, and :func:`textures`; for a panorama, it also reads the means of
    these features over all views. During training, the gate is always open, so that the adapters
    learn from all frames. The gate is trained together with the adapters.

    Args:
        channels: number of input channels.
        middle: channels of the convolutions.
        views: number of views per panorama, which must be consecutive in the batch; if it is 1,
            each frame is classified separately.

    ``threshold`` is subtracted from the logits. The method ``calibrate`` sets it.

    Source: this project. The NavTrust paper uses a rule on feature magnitudes instead. This gate
    learns which statistics to use, and its threshold is set on clean frames.
    """

    threshold: Tensor

    def __init__(self, channels: int, middle: int = 16, views: int = 1) -> None:
        super().__init__()
        check_sizes("gate", channels=channels, middle=middle, views=views)
        self.settings = {"kind": "gate", "channels": channels, "middle": middle, "views": views}
        self.views = views
        self.first = nn.Conv2d(channels, middle, 3, padding=1)
        self.second = nn.Conv2d(middle, middle, 3, stride=2, padding=1)
        read = 3 * middle + TEXTURES * channels
        self.hidden = nn.Linear(read * (1 if views == 1 else 2), HIDDEN)
        self.judge = nn.Linear(HIDDEN, 1)
        self.register_buffer("threshold", torch.zeros(()))
        self.judged = GateLogits()

    def forward(self, x: Tensor) -> Tensor:
        """Return ``x`` unchanged, so that a gate in an ``nn.Sequential`` has no effect."""
        return x

    def classify(self, x: Tensor) -> None:
        """Compute and keep the logits of frames ``[n, C, h, w]``."""
        x = x.detach().float()
        y = F.gelu(self.second(F.gelu(self.first(x)))).flatten(2)
        spread = (y.var(2, correction=0) + 1e-6).sqrt()
        statistics = torch.cat([y.mean(2), spread, y.amax(2), textures(x)], 1)
        if self.views > 1:
            ring = statistics.unflatten(0, (-1, self.views))
            mean = ring.mean(1, keepdim=True).expand_as(ring)
            statistics = torch.cat([ring, mean], 2).flatten(0, 1)
        self.judged.logits = self.judge(F.gelu(self.hidden(statistics)))[:, 0] - self.threshold

    def calibrate(self, logits: Tensor, touched: float) -> None:
        """Set the threshold so that the gate is open for a given fraction of clean frames.

        Args:
            logits: the gate's logits [n] of clean frames.
            touched: fraction of clean frames for which the gate is open, in [0, 1].
        """
        self.threshold += logits.float().quantile(1 - touched).to(self.threshold.dtype)


def textures(x: Tensor) -> Tensor:
    """Return statistics that distinguish clean frames from corrupted frames.

    The corruptions are noise, blur, quantisation, darkness and holes.

    Args:
        x: frames ``[n, C, h, w]`` whose values have a range of about 1.

    Returns:
        float32 [n, C * TEXTURES]. Magnitudes are returned as logarithms.
    """
    features = [x.mean((2, 3)), x.std((2, 3)), x.flatten(2).amin(2), x.flatten(2).amax(2)]
    for level in (x, F.avg_pool2d(x, 2)):
        for axis in (2, 3):
            bend = level.diff(n=2, dim=axis).abs()
            sizes = [level.diff(dim=axis).abs().mean((2, 3)), bend.mean((2, 3))]
            sizes.append(bend.square().mean((2, 3)))
            features += [(size + 1e-4).log() / 3 + 1 for size in sizes]
            features += [(bend < flat).float().mean((2, 3)) for flat in FLAT]
    return torch.cat(features, 1)


def through(gates: list[Adapter], x: Tensor, corrected: Tensor) -> Tensor:
    """Return ``corrected`` for frames whose gate is open, and ``x`` for all other frames.

    If there is no gate, or during training, all frames are corrected.

    Args:
        gates: the gate of the adapter; an empty list means no gate.
        x: the input of the adapter.
        corrected: output of the layer, of the same shape.
    """
    if not gates or gates[0].training:
        return corrected
    gate: Any = gates[0]
    logits = gate.judged.logits.view(-1, *[1] * (x.dim() - 1))
    return torch.where(logits > 0, corrected, x)


class Gate(nn.Module):
    """Compute one logit per frame; its sigmoid scales the adapter's correction.

    The logit is computed from the adapter's bottleneck: the mean and the root mean square of each
    of its ``middle`` channels over the frame. The gate should be closed for clean frames, so that
    their features do not change. A recipe may add a loss for this purpose (``recipes/encoder.py``).
    The gate is always trained together with the adapter.
    """

    def __init__(self, middle: int) -> None:
        super().__init__()
        self.read = nn.Linear(2 * middle, 1)

    def forward(self, y: Tensor, over: tuple[int, ...]) -> Tensor:
        """Return logits [n]; ``over`` are the axes of ``y`` other than frames and channels."""
        mean, power = (y.mean(over), (y * y).mean(over)) if over else (y, y * y)
        return self.read(torch.cat([mean, (power + 1e-6).sqrt()], 1))[:, 0]


class TokenAdapter(Adapter):
    """Adapter ``x + up(gelu(down(norm(x))))`` on the last axis of ``[n, T, C]``, ``[T, n, C]``,
    ``[n, C]`` or ``[n, h, w, C]``.

    Args:
        channels: number of channels C.
        reduction: the bottleneck has ``max(4, C // reduction)`` channels.
        batch: the axis of the frames, 0 or 1 (as in OpenAI's CLIP).
        gate: whether to add a :class:`Gate`.
        middle: channels of the bottleneck; overrides ``reduction``.

    ``norm`` is a layer norm without weights. It is needed because in transformers a few channels of
    the residual stream are far larger than the others. The source is the same as for
    ``ConvAdapter``.
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
        check_sizes("token adapter", channels=channels, reduction=reduction, middle=middle)
        if batch not in (0, 1):
            raise ValueError(f"batch of a token adapter must be 0 or 1, got {batch}.")
        self.settings = {"kind": "tokens", "channels": channels, "reduction": reduction}
        self.settings |= {"batch": batch, **optional_settings(gate, middle)}
        middle = middle or max(4, channels // reduction)
        self.batch, self.channels = batch, channels
        self.down, self.up = nn.Linear(channels, middle), nn.Linear(middle, channels)
        self.gate = Gate(middle) if gate else None
        set_to_zero(self.up)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(F.layer_norm(x, (self.channels,))))
        z = self.up(y)
        if self.gate is not None:
            over = tuple(axis for axis in range(x.dim() - 1) if axis != self.batch)
            shape = [1] * x.dim()
            shape[self.batch] = -1
            z = z * self.gate(y, over).sigmoid().view(shape)
        return x + z


def optional_settings(gate: bool, middle: int | None) -> dict[str, bool | int]:
    """Return the optional settings that are set; only these are stored."""
    return {name: value for name, value in (("gate", gate), ("middle", middle)) if value}


class ConvAdapter(Adapter):
    """Adapter ``x + up(gelu(down(x)))`` for feature maps ``[n, C, h, w]``.

    Args:
        channels: number of channels C.
        reduction: the bottleneck has ``max(4, C // reduction)`` channels.
        kernel: size of the spatial convolution, which must be odd.
        gate: whether to add a :class:`Gate`.
        middle: channels of the bottleneck; overrides ``reduction``.

    The bottleneck and the zero initialisation follow Houlsby et al. 2019, as in the NavTrust paper.
    The defaults of ``reduction`` and ``kernel`` were chosen so that adapters add 1 to 4 % to the
    number of weights.
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
        sizes = {"channels": channels, "reduction": reduction, "middle": middle}
        check_sizes("convolutional adapter", kernel, **sizes)
        self.settings = {"channels": channels, "reduction": reduction, "kernel": kernel}
        self.settings |= optional_settings(gate, middle)
        middle = middle or max(4, channels // reduction)
        self.down = nn.Conv2d(channels, middle, kernel, padding=kernel // 2)
        self.up = nn.Conv2d(middle, channels, 1)
        self.gate = Gate(middle) if gate else None
        self.gates = []
        set_to_zero(self.up)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(x))
        z = self.up(y)
        if self.gate is not None:
            z = z * self.gate(y, (2, 3)).sigmoid()[:, None, None, None]
        return through(self.gates, x, x + z)


class RingAdapter(Adapter):
    """Zero-initialised residual adapter that combines neighbouring views of a panorama.

    The input x has the shape ``[P * views, C, h, w]``. In the formulas below, y = gelu(down(x)),
    and ``aligned`` warps the maps of the two neighbouring views into each view:

        w = softmax(score(aligned(y)))            over the view and the neighbours that see a cell
        z = gelu(mix([y, sum w aligned(y)]))
        out = x + tanh(share(z)) * (sum w aligned(x) - x) + up(z)

    ``up`` and ``share`` are initialised to zero, so the output equals the input before training.
    ``up`` computes the correction, as in any adapter. ``share`` sets which fraction of a cell's
    features comes from the neighbouring views. This fraction is the same for all channels, and the
    features of the neighbouring views do not pass through the bottleneck.

    Args:
        channels: number of channels C.
        reduction: the bottleneck y has ``max(4, C // reduction)`` channels.
        kernel: size of the convolution ``mix``, which must be odd.
        views: number of views per panorama, at least 3.
        hfov: horizontal field of view in degrees.

    Raises:
        ValueError: If an argument is out of range.

    Source: this project. The adapters of the NavTrust paper read one view at a time.
    """

    # the output of ``share`` passes through tanh, so its effect is scaled only approximately
    corrects = ("share", "up")

    def __init__(
        self,
        channels: int,
        reduction: int = 4,
        kernel: int = 3,
        views: int = VIEWS,
        hfov: float = HFOV_DEGREES,
    ) -> None:
        super().__init__()
        check_sizes("ring adapter", kernel, channels=channels, reduction=reduction)
        if views < 3 or not 0 < hfov < 180:
            raise ValueError(
                f"views of a ring adapter must be >= 3, got {views}; hfov must be between 0 and "
                f"180 degrees, got {hfov}."
            )
        middle = max(4, channels // reduction)
        self.settings = {"channels": channels, "reduction": reduction, "kernel": kernel}
        self.settings |= {"views": views, "hfov": hfov}
        self.views, self.hfov = views, hfov
        self.gates = []
        self.down = nn.Conv2d(channels, middle, 1)
        self.score = nn.Conv2d(middle, 1, 1)
        self.mix = nn.Conv2d(2 * middle, middle, kernel, padding=kernel // 2)
        self.share, self.up = nn.Conv2d(middle, 1, 1), nn.Conv2d(middle, channels, 1)
        set_to_zero(self.share, self.up)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(x))
        parts = [x, y, self.score(y)]
        grid = neighbour_grid(x.shape[-2], x.shape[-1], 360 / self.views, self.hfov).to(x.device)
        maps = self.aligned(torch.cat([part.float() for part in parts], 1), grid)
        # bool [2, h, w]: whether a cell is outside the left or the right neighbour's field of view
        unseen = (grid.abs() > 1).any(-1)
        scores = torch.stack([each[:, -1] for each in maps], 1)
        # the padding adds an entry for the view itself, in which all cells are visible
        scores = scores.masked_fill(F.pad(unseen, (0, 0, 0, 0, 1, 0)), -math.inf)
        weights = scores.softmax(1).unsqueeze(2).unbind(1)
        fused = maps[0] * weights[0]
        for each, weight in zip(maps[1:], weights[1:], strict=True):
            fused = torch.addcmul(fused, each, weight)
        around, y_around, _ = fused.to(x.dtype).split([part.shape[1] for part in parts], 1)
        z = F.gelu(self.mix(torch.cat([y, y_around], 1)))
        return through(self.gates, x, x + self.share(z).tanh() * (around - x) + self.up(z))

    def aligned(self, maps: Tensor, grid: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Return the maps, and the neighbours of each map warped into its view.

        Args:
            maps: ``[P * views, C, h, w]``.
            grid: result of :func:`neighbour_grid`.

        Returns:
            Maps, left neighbours and right neighbours, each with the shape of ``maps``.
            A warped neighbour is zero in cells that the neighbouring view does not see. It fades to
            zero within half a cell of its border.
        """
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
    """Return the positions of a view's cells in the left and the right neighbouring view.

    Args:
        height: rows of the map.
        width: columns of the map.
        step: angle in degrees from a view to the next view on its right
            (``mitigate/core/observation.py``).
        hfov: horizontal field of view in degrees; views are square.

    Returns:
        float32 ``[2, h, w, 2]``: (x, y) in the coordinates of ``grid_sample`` with
        ``align_corners=False``;
        values are inside [-1, 1] for cells that the neighbouring view sees.
    """
    half = math.tan(math.radians(hfov) / 2)
    x = ((torch.arange(width) + 0.5) / width * 2 - 1) * half
    y = ((torch.arange(height) + 0.5) / height * 2 - 1) * half
    y, x = torch.meshgrid(y, x, indexing="ij")
    sides = []
    for degrees in (-step, step):
        sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        # component of the cell's direction (x, y, 1) along the neighbour's optical axis
        ahead = x * sine + cosine
        place = torch.stack([(x * cosine - sine) / ahead, y / ahead], -1) / half
        sides.append(torch.where(ahead[..., None] > 1e-3, place, torch.full_like(place, 2.0)))
    return torch.stack(sides)
