"""The convolutional adapter, behind modules that give maps."""

from __future__ import annotations

import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.gate import FrameGate, through
from mitigate.agents.tokens import Gate, further


class ConvAdapter(nn.Module):
    """``x + up(gelu(down(x)))`` on maps ``[n, C, h, w]``; ``up`` starts at zero.

    Args:
        channels: C. reduction: the bottleneck has ``max(4, C // reduction)`` channels.
        kernel: of the spatial convolution, odd. gate: see ``tokens.Gate``.
        middle: channels of the bottleneck, in place of ``reduction``.

    Source: bottleneck and zero start after Houlsby et al. 2019, as the paper's section on adapters
    asks; reduction and kernel are ours, chosen for 1-4 % of the weights.
    """

    corrects = ("up",)  # the layers that the correction is proportional to (``scale_adapters``)

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
        self.gates: list[FrameGate] = []  # the encoder's own, if it has one (``adapters.py``)
        for parameter in self.up.parameters():
            nn.init.zeros_(parameter)

    def forward(self, x: Tensor) -> Tensor:
        y = F.gelu(self.down(x))
        z = self.up(y)
        if self.gate is not None:
            z = z * self.gate(y, (2, 3)).sigmoid()[:, None, None, None]
        return through(self.gates, x, x + z)
