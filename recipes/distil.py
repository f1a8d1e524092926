"""Distil a frozen teacher that sees clean frames into a student that sees corrupted frames.

``Distil`` works on episodes of any trainable agent:

    L = w_il * L_imitation + w_kl * tau^2 * KL(pi_T || pi_S)
        + w_feat * sum(MSE(f_S, f_T) / Var(f_T))

T is the teacher, S the student, and tau the temperature. The sum is over the features that the
agent returns, such as those of views and nodes.

Under corruption, the candidate actions of the student may differ from the teacher's
candidates. For example, missing depth changes the places to which the student can go. Therefore
both networks score the candidates of the student. ``DistilViews`` works on random poses. The
student's encoders learn to output, for corrupted views, the teacher's features of the clean views.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import torch
from torch import Tensor

from mitigate.core import checkpoint
from mitigate.recipes.imitate import decide, loss_weights
from mitigate.recipes.pretrain import views_to_learn
from mitigate.training.objective import check_weights
from mitigate.training.parts import load_teacher, refuse_gates, train_only
from mitigate.training.poses import OnViews, Poses
from mitigate.training.rollouts import OnEpisodes, Rollouts


class Distil(OnEpisodes):
    """Distil a teacher on rollouts. The loss combines imitation of the expert, the teacher's policy
    and the teacher's features.

    With ``w_kl = w_feat = 0``, the result is bit-identical to imitation.

    Args:
        agent: the student, which is trained in place.
        rollouts: the source of its decisions.
        teacher: weights, or "start" for a copy of ``agent`` at the start of the stage.
        train_parts: same as in ``Imitate``.
        losses: same as in ``Imitate``.
        w_il: weight of the imitation loss.
        w_kl: weight of the policy loss.
        w_feat: weight of the feature loss. Features that do not depend on a trained weight are not
            matched.
        temperature: temperature of the policy loss.

    Raises:
        FileNotFoundError: If the teacher is missing.
        ValueError: If a weight or the temperature is invalid, or if ``Imitate`` raises ValueError.
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
    ) -> None:
        super().__init__()
        check_weights(w_il=w_il, w_kl=w_kl, w_feat=w_feat)
        if not temperature > 0:
            raise ValueError(f"temperature must be above 0, such as 2, got {temperature:g}.")
        if not (w_il or w_kl or w_feat):
            raise ValueError(
                "No weight would be trained: w_il, w_kl and w_feat are 0. Set one of them above 0."
            )
        self.agent = agent
        self.loss_weights = loss_weights(agent, losses)
        self.teacher: Any = load_teacher(agent, teacher)
        train_only(agent, train_parts)
        self.w_il = w_il
        self.w_kl = w_kl
        self.w_feat = w_feat
        self.temperature = temperature
        self.rollouts = rollouts
        rollouts.keep_clean(self.teacher)

    def identity(self) -> dict[str, str]:
        return {**self.rollouts.identity(), "teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        decisions = batch["decisions"]
        out, values = decide(self.agent, decisions, self.loss_weights)
        with torch.no_grad():
            target = self.teacher.decide(decisions, clean=True)
        values["kl"] = policy_kl(out.logits, target.logits, self.temperature)
        loss = self.w_il * values["loss"]
        if self.w_kl:
            loss = loss + self.w_kl * self.temperature**2 * values["kl"]
        features = {n: f for n, f in out.features.items() if n in target.features}
        self._check(features)
        for name, feature in features.items():
            values[f"feat_{name}"] = feature_loss(feature, target.features[name])
            if self.w_feat and (feature.requires_grad or not torch.is_grad_enabled()):
                loss = loss + self.w_feat * values[f"feat_{name}"]
        return {**values, "loss": loss}

    def _check(self, features: Mapping[str, Tensor]) -> None:
        """Raise ValueError if no trained weight affects the loss."""
        learned = any(feature.requires_grad for feature in features.values())
        if torch.is_grad_enabled() and not (self.w_il or self.w_kl or learned):
            raise ValueError(
                "No weight would be trained, because w_il and w_kl are 0 and decide() of "
                f"{type(self.agent).__name__} returns no trainable features (it returns: "
                f"{', '.join(features) or 'none'}). Set w_il or w_kl above 0, or return features "
                "that depend on a trained weight in Output.features."
            )


class DistilViews(OnViews):
    """Distil a teacher's encoders on random poses.

    Args:
        agent: the student; its encoders for the sensor in ``poses`` are trained in place.
        poses: the source of views.
        teacher: weights, or "start" for a copy of ``agent`` at the start of the stage.
        w_labels: weight of the label loss.
        w_feat: weight of the feature loss.

    Attributes:
        adapters_only: whether only the agent's adapters and their gates are trained.

    Raises:
        FileNotFoundError: If the teacher is missing.
        ValueError: If the adapters have gates, or if a weight is invalid.
    """

    adapters_only: ClassVar[bool] = False

    def __init__(
        self,
        agent: Any,
        poses: Poses,
        teacher: str,
        w_labels: float = 1.0,
        w_feat: float = 1.0,
    ) -> None:
        super().__init__()
        check_weights(w_labels=w_labels, w_feat=w_feat)
        if not self.adapters_only:
            for name in agent.encoders.get(poses.sensor, ()):
                refuse_gates(agent.parts()[name])
        self.agent = agent
        self.sensor = poses.sensor
        poses.learn(**views_to_learn(agent, self.sensor, self.adapters_only))
        self.poses = poses
        self.teacher: Any = load_teacher(agent, teacher)
        self.w_labels = w_labels
        self.w_feat = w_feat

    def identity(self) -> dict[str, str]:
        return {"teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        out = self.agent.see(self.sensor, batch["frames"], batch["targets"])
        with torch.no_grad():
            target = self.teacher.see(self.sensor, batch["clean"])
        feat = feature_loss(out.features["views"], target.features["views"])
        loss = self.w_labels * out.losses["labels"] + self.w_feat * feat
        return {"loss": loss, "feat": feat, **out.losses, **out.figures}


def policy_kl(student: Tensor, teacher: Tensor, temperature: float) -> Tensor:
    """Return the batch mean of KL(pi_T || pi_S) for logits [B, n] at ``temperature``.

    Entries of -inf are excluded. They must be at the same positions in the logits of both networks.
    """
    p = (teacher / temperature).log_softmax(-1)
    q = (student / temperature).log_softmax(-1)
    each = p.exp() * (p - q).masked_fill(teacher == float("-inf"), 0.0)
    return each.sum(-1).mean()


def feature_loss(student: Tensor, teacher: Tensor) -> Tensor:
    """Return the mean squared error divided by the variance of the teacher's values.

    Therefore the overall scale of a feature does not matter, but the relative scale of its parts
    does. If a feature contains both probabilities and larger values, the probabilities contribute
    only 0.3 to 5 % of the error (measured for each encoder and corruption). For such probabilities,
    use the label loss instead.
    """
    error = (student.float() - teacher.float()).square().mean()
    return error / teacher.float().var().clamp(min=1e-6)
