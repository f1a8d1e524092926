"""Ring adapters: a view takes from its neighbours on the panorama what it has itself lost.

The views of a panorama share one centre and overlap, so a neighbour shows the same surfaces where
a known rotation puts them. A ring adapter turns the neighbours' feature maps into the view's own
frame first, and only then compares them.
"""

from __future__ import annotations

import math

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.gate import FrameGate, through
from mitigate.core.observation import HFOV_DEGREES, VIEWS


class RingAdapter(nn.Module):
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

    corrects = ("share", "up")  # as in ``ConvAdapter``, but that a share goes through its tanh

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
        self.gates: list[FrameGate] = []  # the encoder's own, if it has one (``adapters.py``)
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
