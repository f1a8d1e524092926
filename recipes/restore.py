"""Train a restorer on pairs of corrupted and clean frames, without an agent, labels or actions.

    L = mean_scales(|out - clean|)
        + w_grad * |gradient(out) - gradient(clean)|
        + w_right * mean_pixels(e / (e + TOLERANCE)), where e = |out - clean|

The last term counts wrong pixels instead of measuring their error. It keeps the restorer from
changing correct pixels next to drops, stripes or noise. In the first term, the error is multiplied
by ``w_far`` where the restored depth is too large. Overestimated depth can make an episode fail,
because it shows free paths that do not exist. Underestimated depth only makes the agent take a
detour. RGB is in [0, 1], and depth is divided by its range. Pixels without a valid clean depth are
ignored. Because no agent is used in training, one restorer works with all agents. The restorer's
gate is trained afterwards on fixed maps (``restore_gate.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.core.pictures import side_by_side
from mitigate.core.seeding import generator
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.frames.sensor import TOLERANCE, SensorRestorer
from mitigate.training.objective import Objective, check_share, check_weights
from mitigate.training.restoration_pairs import Pairs, pairs_of

SCALES = (1, 4)  # pooling sizes in pixels: 1 compares edges, 4 compares surfaces (heuristic)
RESTORER = "This recipe trains a restorer: set agent=restorer (docs/restoration.md)."


class Restore(Objective):
    """Trains a restorer on pairs of corrupted and clean frames.

    Args:
        agent: the restorer; its network for the sensor in ``pairs`` is trained in place.
        pairs: the source of frames.
        single: fraction of steps that process each view separately.
        seed: seed for choosing these steps.
        w_grad: weight of the error of image gradients.
        w_right: weight of the fraction of wrong pixels.
        w_far: factor by which the error of overestimated depth is multiplied.

    Raises:
        ValueError: If a number is invalid.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"pairs": pairs_of}
    ahead = True
    needs = ("restore", "doubt", "parts")
    otherwise = RESTORER

    def __init__(
        self,
        agent: Restorer,
        pairs: Pairs,
        single: float = 0.25,
        seed: int = 0,
        w_grad: float = 0.5,
        w_right: float = 0.05,
        w_far: float = 1.0,
    ) -> None:
        super().__init__()
        check_share("single", single)
        check_weights(w_grad=w_grad, w_right=w_right, w_far=w_far)
        self.agent = agent
        self.single = single
        self.seed = seed
        self.w_grad = w_grad
        self.w_right = w_right
        self.w_far = w_far
        agent.requires_grad_(False)
        self.net: SensorRestorer = agent.parts()[pairs.sensor].requires_grad_(True)
        self.net.gate.requires_grad_(False)
        self.pairs = pairs
        self._shown: np.ndarray | None = None

    def identity(self) -> dict[str, str]:
        return self.pairs.identity()

    def start(self) -> None:
        self.pairs.start()

    def jobs(self, step: int) -> list[Any]:
        return self.pairs.jobs(step)

    def work(self, job: Any) -> Any:
        return self.pairs.work(job)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        batch = self.pairs.collate(pieces)
        alone = generator(self.seed, "restore views", step).random() < self.single
        views = batch["frames"].shape[1] if self.pairs.ring and not alone else 1
        return {**batch, "views": views}

    def weight(self, batch: dict[str, Any]) -> float:
        """Return the number of views."""
        return float(batch["frames"].shape[0] * batch["frames"].shape[1])

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        views = batch["views"]
        frames, clean = batch["frames"].flatten(0, 1), batch["clean"].flatten(0, 1)
        restored = self.net(frames, views)
        with torch.autocast(frames.device.type, enabled=False):
            target, valid = self.net.scaled(clean)
            seen, _ = self.net.scaled(frames)
            loss = self._error(restored, target, valid)
            before, after = (((x - target).abs() * valid).mean() for x in (seen, restored.detach()))
        self._keep(frames, restored, clean)
        return {"loss": loss, "before": before, "after": after}

    def _error(self, out: Tensor, target: Tensor, valid: Tensor) -> Tensor:
        """Return the L1 error averaged over scales, the L1 error of gradients, and the fraction of
        wrong pixels.
        """
        total = out.new_zeros(())
        difference = (out - target) * valid
        charged = torch.where(difference > 0, self.w_far * difference, difference)
        for scale in SCALES:
            total = total + F.avg_pool2d(charged, scale).abs().mean() / len(SCALES)
        for axis in (2, 3):
            near = valid.narrow(axis, 1, valid.shape[axis] - 1) * valid.narrow(
                axis, 0, valid.shape[axis] - 1
            )
            total = total + self.w_grad * (difference.diff(dim=axis) * near).abs().mean()
        wrong = difference.abs().mean(1)
        return total + self.w_right * (wrong / (wrong + TOLERANCE)).mean()

    def _keep(self, frames: Tensor, out: Tensor, clean: Tensor) -> None:
        if not self.training:
            return
        restored = self.net.unscaled(out.detach()).to(frames.dtype)
        rows = [part[:: max(1, len(part) // 12)][:12].cpu() for part in (frames, restored, clean)]
        self._shown = np.concatenate([side_by_side(row.numpy()) for row in rows])

    def figures(self, step: int) -> dict[str, np.ndarray]:
        """Return corrupted, restored and clean views of the last batch."""
        return {} if self._shown is None else {"restored": self._shown}
