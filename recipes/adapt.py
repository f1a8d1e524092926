"""Train residual adapters in a frozen agent, so that corrupted frames give the same features as
clean frames.

Only the adapters are trained; the backbone stays bit-identical. A setting of the agent inserts
adapters after any module that returns a feature map (``agents/adapters.py``). ``Adapt`` trains any
trainable agent on episodes, and ``AdaptViews`` trains encoders on random poses.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.adapter_layers import FrameGate
from mitigate.agents.adapters import adapted, backbone_sha, scale_adapters, trainable_share
from mitigate.core.progress import say
from mitigate.recipes.distil import Distil, DistilViews
from mitigate.training.objective import check_weights
from mitigate.training.parts import ADAPTERS, START
from mitigate.training.poses import Poses
from mitigate.training.rollouts import Rollouts

# step numbers beyond the end of training, so that training never uses the same views
HELD, FRESH = 1_000_000, 2_000_000


class Adapt(Distil):
    """Train adapters on rollouts. The teacher is the agent without its adapters.

    The arguments are the same as for ``Distil``. By default, ``w_il`` and ``w_kl`` are 0, so only
    the teacher's features are matched.

    Raises:
        ValueError: If the agent has no adapters.
    """

    def __init__(
        self,
        agent: Any,
        rollouts: Rollouts,
        losses: Mapping[str, float] | None = None,
        w_il: float = 0.0,
        w_kl: float = 0.0,
        w_feat: float = 1.0,
        temperature: float = 2.0,
    ) -> None:
        require_adapters(agent)
        super().__init__(
            agent,
            rollouts,
            teacher=START,
            train_parts=(ADAPTERS,),
            losses=losses,
            w_il=w_il,
            w_kl=w_kl,
            w_feat=w_feat,
            temperature=temperature,
        )
        self.backbone = backbone_sha(agent)

    def finish(self) -> None:
        """Raise ValueError if the backbone has changed."""
        check_backbone(self.agent, self.backbone)


class AdaptViews(DistilViews):
    """Train adapters on random poses. The teacher is the agent without its adapters.

    ``finish`` sets the thresholds of gates, if the encoders have any, and scales the adapters.

    Args:
        agent: the agent. Only the adapters in the encoders of the sensor that ``poses`` renders are
            trained, in place.
        poses: the source of views.
        w_labels: same as in ``DistilViews``.
        w_feat: same as in ``DistilViews``.
        w_gate: weight of the gate loss, the cross-entropy of predicting whether a view is
            corrupted.
        touched: fraction of clean views for which a gate may open after training.
        held: number of held-out clean panoramas with which the thresholds are set.
        strength: fraction of the learned correction that the adapters apply after training
            (``agents.adapters.scale_adapters``).

    Raises:
        ValueError: If the encoders have no adapters, or if a number is invalid.
    """

    adapters_only = True

    def __init__(
        self,
        agent: Any,
        poses: Poses,
        w_labels: float = 1.0,
        w_feat: float = 1.0,
        w_gate: float = 1.0,
        touched: float = 0.01,
        held: int = 120,
        strength: float = 1.0,
    ) -> None:
        if not 0 < touched < 1 or not 0 < strength <= 1 or held < 1:
            raise ValueError(
                f"touched must be above 0 and below 1, got {touched}; strength must be above 0 and "
                f"at most 1, got {strength}; held must be >= 1, got {held}."
            )
        check_weights(w_gate=w_gate)
        super().__init__(agent, poses, teacher=START, w_labels=w_labels, w_feat=w_feat)
        encoders = [agent.parts()[name] for name in agent.encoders[self.sensor]]
        require_adapters(agent, *encoders)
        self.w_gate = w_gate
        self.touched = touched
        self.held = held
        self.strength = strength
        self.backbone = backbone_sha(agent)
        modules = (module for encoder in encoders for module in encoder.modules())
        self.gates = [module for module in modules if isinstance(module, FrameGate)]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        values = super().forward(batch)
        for gate in self.gates:
            corrupted = changed_views(batch["frames"], batch["clean"])
            logits = gate.judged.logits.float() + gate.threshold
            loss = F.binary_cross_entropy_with_logits(logits, corrupted.float())
            opened = (logits > 0).float()
            values |= {
                "loss": values["loss"] + self.w_gate * loss,
                "gate": loss,
                "opened_corrupted": mean_where(opened, corrupted),
                "opened_clean": mean_where(opened, ~corrupted),
            }
        return values

    def finish(self) -> None:
        """Set the strength of the adapters and the thresholds of the gates.

        Raises ValueError if the backbone has changed.
        """
        check_backbone(self.agent, self.backbone)
        for name in self.agent.encoders[self.sensor]:
            encoder = self.agent.parts()[name]
            if adapted(encoder):
                scale_adapters(encoder, self.strength)
        for gate in self.gates:
            gate.calibrate(self._judged(gate, HELD, self.held, clean=True)[0], self.touched)

    def evaluate(self, step: int) -> dict[str, float]:
        """Return how often the gates open.

        "clean_opened" and "corrupted_opened" are the fractions of clean and of corrupted views for
        which the gates open. These views differ from the views with which :meth:`finish` sets the
        thresholds at the end of training.
        """
        values: dict[str, float] = {}
        for gate in self.gates:
            few = -(-self.held // 3)
            logits, _ = self._judged(gate, FRESH, few, clean=True)
            values["clean_opened"] = float((logits > 0).float().mean())
            logits, hit = self._judged(gate, FRESH, few, clean=False)
            values["corrupted_opened"] = float(mean_where((logits > 0).float(), hit))
        return values

    def _judged(self, gate: FrameGate, step: int, count: int, clean: bool) -> tuple[Tensor, Tensor]:
        """Return a gate's logits for the views of ``count`` panoramas, and a mask of the corrupted
        views.
        """
        poses = copy.copy(self.poses)
        poses.panoramas = count
        logits, corrupted = [], []
        for job in poses.jobs(step):
            batch = poses.collate([poses.work(job)])
            images = batch["clean" if clean else "frames"].to(gate.threshold.device)
            self.agent.see(self.sensor, images)
            logits.append(gate.judged.logits.float())
            corrupted.append(changed_views(images, batch["clean"].to(images.device)))
        return torch.cat(logits), torch.cat(corrupted)


def changed_views(frames: Tensor, clean: Tensor) -> Tensor:
    """Return a bool mask [P * V] of the views that differ between two batches of shape [P, V, H, W,
    c].
    """
    other = (frames != clean) & ~(frames.isnan() & clean.isnan())
    return other.flatten(0, 1).flatten(1).any(1)


def mean_where(values: Tensor, where: Tensor) -> Tensor:
    """Return the mean of those ``values`` [n] for which the mask ``where`` [n] is true. Return 0 if
    the mask is false everywhere.
    """
    return (values * where).sum() / where.sum().clamp(min=1)


def check_backbone(agent: nn.Module, expected: str) -> None:
    """Raise ValueError if the sha256 of ``agent`` without its adapters is not ``expected``."""
    if backbone_sha(agent) != expected:
        raise ValueError(
            f"The backbone of {type(agent).__name__} has changed, although only its adapters "
            "train. Do not update a counter or a running mean in it while its weights are frozen "
            "(requires_grad is False), and train again in another folder (folder=...)."
        )


def require_adapters(agent: nn.Module, *modules: nn.Module) -> None:
    """Raise ValueError if none of ``modules`` (default: the whole agent) has adapters.

    If there are adapters, print their size as a fraction of the backbone.
    """
    if not any(adapted(module) for module in modules or (agent,)):
        raise ValueError(
            "The encoders of the agent have no adapters. Set targets in agent.adapters, as "
            "conf/recipe/conv_adapter.yaml does, or call insert_adapters(agent, targets)."
        )
    say(f"adapters: {trainable_share(agent):.1%} of the backbone's weights")
