"""Teacher-student distillation: a frozen teacher sees clean what the student sees corrupted.

``Distil`` works on rolled-out episodes of any trainable agent:

    L = w_il L_imitation + w_kl T^2 KL(pi_T || pi_S) + w_feat sum of MSE(f_S, f_T)

Under corruption the student may have other candidates than the teacher would (with depth gone it
finds other places to go to). Both therefore answer over the same ones, the student's.
``DistilViews`` works on random poses: the student's encoders learn to give for a corrupted view
what the teacher's give for the clean one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import torch
from torch import Tensor

from mitigate.core import checkpoint
from mitigate.recipes.imitate import check_losses, imitation, loss_weights, masked
from mitigate.recipes.pretrain import views_to_learn
from mitigate.training.objective import check_weights
from mitigate.training.parts import load_teacher, refuse_gates, train_only
from mitigate.training.poses import OnViews, Poses
from mitigate.training.rollouts import OnEpisodes, Rollouts


class Distil(OnEpisodes):
    """Distil a teacher on rollouts: imitation, the teacher's policy and its features.

    With ``w_kl = w_feat = 0`` this is imitation, bit for bit.

    Args:
        agent: the student, trained in place.
        rollouts: the source of its decisions.
        teacher: weights, or "start" for ``agent`` as it is now.
        train_parts: as ``recipes/imitate.py``.
        losses: as ``recipes/imitate.py``.
        w_il: weight of the imitation loss.
        w_kl: weight of the policy loss.
        w_feat: weight of the feature loss.
        temperature: of the policy loss.
        match: which of the agent's features are matched; None: all. A feature that no trained
            weight makes is not matched.

    Raises:
        FileNotFoundError: for a missing teacher.
        ValueError: as imitation does, and for an invalid weight or temperature.
    """

    def __init__(
        self,
        agent: Any,
        rollouts: Rollouts,
        teacher: str,
        train_parts: Sequence[str] | str | None = None,
        losses: Mapping[str, float] | None = None,
        w_il: float = 1.0,
        w_kl: float = 1.0,
        w_feat: float = 1.0,
        temperature: float = 2.0,
        match: Sequence[str] | None = None,
    ) -> None:
        super().__init__()
        check_weights(w_il=w_il, w_kl=w_kl, w_feat=w_feat)
        if not temperature > 0:
            raise ValueError(f"recipe.temperature={temperature:g} must be above 0, as 2.")
        if not (w_il or w_kl or w_feat):
            raise ValueError(
                "Nothing would be learned: w_il, w_kl and w_feat are 0. Set one of them above 0."
            )
        self.agent = agent
        self.losses = loss_weights(agent, losses)
        self.teacher: Any = load_teacher(agent, teacher)
        train_only(agent, train_parts)
        self.w_il = w_il
        self.w_kl = w_kl
        self.w_feat = w_feat
        self.temperature = temperature
        self.match = match
        self.rollouts = rollouts
        rollouts.keep_clean(self.teacher)

    def identity(self) -> dict[str, str]:
        return {**self.rollouts.identity(), "teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def train(self, mode: bool = True) -> Any:
        super().train(mode)
        self.teacher.eval()
        return self

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        decisions = batch["decisions"]
        out = self.agent.decide(decisions)
        check_losses(self.agent, self.losses, out)
        values = imitation(out, decisions, self.losses)
        with torch.no_grad():
            wanted = self.teacher.decide(decisions, clean=True)
        student, taught = (masked(x.logits, out.mask) for x in (out, wanted))
        values["kl"] = policy_kl(student, taught, self.temperature)
        loss = self.w_il * values["loss"]
        if self.w_kl:
            loss = loss + self.w_kl * self.temperature**2 * values["kl"]
        features = {n: f for n, f in out.features.items() if n in wanted.features}
        features = matched(features, self.match)
        self._check(features)
        for name, feature in features.items():
            values[f"feat_{name}"] = feature_loss(feature, wanted.features[name])
            if self.w_feat and (feature.requires_grad or not torch.is_grad_enabled()):
                loss = loss + self.w_feat * values[f"feat_{name}"]
        return {**values, "loss": loss}

    def _check(self, features: Mapping[str, Tensor]) -> None:
        """Raise ValueError if nothing of the loss depends on a trained weight."""
        learned = any(feature.requires_grad for feature in features.values())
        if torch.is_grad_enabled() and not (self.w_il or self.w_kl or learned):
            raise ValueError(
                f"Nothing would be learned: decide() of {type(self.agent).__name__} returns no "
                "features to match that a trained weight makes (it has "
                f"{', '.join(features) or 'none'}), and w_il and w_kl are 0. Name them in "
                "Output.features, or set w_il."
            )


class DistilViews(OnViews):
    """Distil a teacher's encoders on random poses.

    Args:
        agent: the student; its encoders of the sensor of ``poses`` are trained in place.
        poses: the source of views.
        teacher: weights, or "start" for ``agent`` as it is now.
        w_labels: weight of the labels' loss.
        w_feat: weight of the features' loss.
        adapters_only: train the agent's adapters and nothing else.

    Raises:
        FileNotFoundError: for a missing teacher.
        ValueError: for adapters with gates, and for an invalid weight.
    """

    teaches_gates: ClassVar[bool] = False

    def __init__(
        self,
        agent: Any,
        poses: Poses,
        teacher: str,
        w_labels: float = 1.0,
        w_feat: float = 1.0,
        adapters_only: bool = False,
    ) -> None:
        super().__init__()
        check_weights(w_labels=w_labels, w_feat=w_feat)
        if not self.teaches_gates:
            for name in agent.encoders.get(poses.sensor, ()):
                refuse_gates(agent.parts()[name])
        self.agent = agent
        self.modality = poses.sensor
        poses.learn(**views_to_learn(agent, self.modality, adapters_only))
        self.poses = poses
        self.teacher: Any = load_teacher(agent, teacher)
        self.w_labels = w_labels
        self.w_feat = w_feat

    def identity(self) -> dict[str, str]:
        return {"teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def train(self, mode: bool = True) -> Any:
        super().train(mode)
        self.teacher.eval()
        return self

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        out = self.agent.see(self.modality, batch["frames"], batch["targets"])
        with torch.no_grad():
            wanted = self.teacher.see(self.modality, batch["clean"])
        feat = feature_loss(out.features["views"], wanted.features["views"])
        loss = self.w_labels * out.losses["labels"] + self.w_feat * feat
        return {"loss": loss, "feat": feat, **out.losses, **out.figures}


def matched(features: Mapping[str, Tensor], names: Sequence[str] | None) -> dict[str, Tensor]:
    """The features of ``names``, None: all. Raises ValueError for one that the agent has not."""
    unknown = sorted(set(names or ()) - set(features))
    if unknown:
        raise ValueError(f"match={unknown} is unknown; choose from {', '.join(features)}.")
    return {n: f for n, f in features.items() if names is None or n in names}


def policy_kl(student: Tensor, teacher: Tensor, temperature: float) -> Tensor:
    """KL(pi_T || pi_S) of logits [B, n] at ``temperature``, mean over the batch; -inf is no
    candidate, and must be so in both."""
    p = (teacher / temperature).log_softmax(-1)
    q = (student / temperature).log_softmax(-1)
    each = p.exp() * (p - q).masked_fill(teacher == float("-inf"), 0.0)
    return each.sum(-1).mean()


def feature_loss(student: Tensor, teacher: Tensor) -> Tensor:
    """Mean squared error in units of the teacher's variance over all numbers. So the scale of the
    whole does not matter; that of a part does: probabilities beside larger features weigh little
    (0.3 to 5 % of the error, by encoder and corruption), and are taught by labels."""
    error = (student.float() - teacher.float()).square().mean()
    return error / teacher.float().var().clamp(min=1e-6)
