"""Teacher-student distillation: a frozen teacher sees the clean frames of what the student sees.

Two recipes, one teacher. ``ViewDistillation`` works on random poses: the student's encoders learn
to give for a corrupted view what the teacher's give for the clean one. ``TeacherStudent`` works on
rolled-out episodes:

    L = w_il CE(oracle) + w_kl T^2 KL(pi_T || pi_S) + w_feat MSE(f_S, f_T)

Under depth corruption the student finds other ghosts than the teacher would. Both therefore answer
over the same candidates, the student's: the teacher gets the student's map, and its own, clean,
features of the views that the map's nodes and ghosts were seen in.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch import Tensor

from mitigate.agents.adapters import remove_adapters
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological.rendered import RenderedWorld
from mitigate.core import checkpoint
from mitigate.core.observation import CLEAN_DEPTH, CLEAN_RGB
from mitigate.shipping import hardened
from mitigate.training.recipe import Recipe
from recipes.imitation import ImitationRecipe
from recipes.perception import PerceptionRecipe

if TYPE_CHECKING:
    from typing_extensions import Self

FEATURES = ("views", "nodes")


class Taught(Recipe):
    """What recipes with a teacher share: it stays in eval mode, and its sha256 is recorded."""

    def take_teacher(self, agent: TopologicalAgent, weights: str) -> None:
        """Load the teacher; see :func:`load_teacher`."""
        self.teacher = load_teacher(agent, weights)
        self.teacher_sha = checkpoint.weights_sha(self.teacher)

    def identity(self) -> dict[str, str]:
        return {**super().identity(), "teacher_sha256": self.teacher_sha}

    def train(self, mode: bool = True) -> Self:
        super().train(mode)
        self.teacher.eval()
        return self


class ViewDistillation(Taught, PerceptionRecipe):
    """Args: as ``PerceptionRecipe``; teacher: weights, or "start" for ``agent`` as it is now;
    w_labels, w_feat: weights of the labels' loss and of the features'.

    Raises FileNotFoundError for a missing teacher.
    """

    def __init__(
        self,
        agent: TopologicalAgent,
        modality: str,
        teacher: str,
        w_labels: float = 1.0,
        w_feat: float = 1.0,
        **others: Any,
    ) -> None:
        super().__init__(agent, modality, **others)
        self.take_teacher(agent, teacher)
        self.w_labels, self.w_feat = w_labels, w_feat

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        features, logits = self.see(self.agent, batch["frames"])
        with torch.no_grad():
            wanted, _ = self.see(self.teacher, batch["clean"])
        values = self.label_losses(logits, batch["targets"])
        feat = feature_loss(features, wanted)
        loss = self.w_labels * values["loss"] + self.w_feat * feat
        return {**values, "feat": feat, "loss": loss}


class TeacherStudent(Taught, ImitationRecipe):
    """Args: as ``ImitationRecipe``; teacher: as for ``ViewDistillation``; w_il, w_kl, w_feat,
    temperature: of the loss above; match: which features are matched, of ``FEATURES``; "views" only
    while the perception trains.

    With ``w_kl = w_feat = 0`` this is imitation, bit for bit.
    Raises FileNotFoundError for a missing teacher, ValueError for an unknown feature.
    """

    def __init__(
        self,
        agent: TopologicalAgent,
        teacher: str,
        w_il: float = 1.0,
        w_kl: float = 1.0,
        w_feat: float = 1.0,
        temperature: float = 2.0,
        match: tuple[str, ...] = FEATURES,
        **others: Any,
    ) -> None:
        super().__init__(agent, **others)
        unknown = sorted(set(match) - set(FEATURES))
        if unknown:
            raise ValueError(f"match={unknown} is unknown; choose from {', '.join(FEATURES)}.")
        self.take_teacher(agent, teacher)
        self.w_il, self.w_kl, self.w_feat = w_il, w_kl, w_feat
        self.temperature = temperature
        self.match = tuple(name for name in match if name != "views" or self.trains_perception)

    def look(self, worlds: list[RenderedWorld]) -> list[tuple[np.ndarray, np.ndarray]]:
        found = super().look(worlds)
        rgb, depth = (
            torch.from_numpy(np.stack([w.looks[-1][name] for w in worlds])).to(self.teacher.device)
            for name in (CLEAN_RGB, CLEAN_DEPTH)
        )
        views, _, _ = self.teacher.perceive(rgb, depth)
        for world, clean in zip(worlds, views.float().cpu(), strict=True):
            world.looks[-1]["clean_views"] = clean.numpy()
        return found

    def entries(self) -> tuple[str, ...]:
        return (*super().entries(), "clean_views")

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        views, values = self.perception(batch)
        out = self.plan(self.agent, batch, views)
        losses = self.planner_losses(batch, out)
        with torch.no_grad():
            wanted = self.plan(self.teacher, batch, batch["clean_views"])
        losses["kl"] = policy_kl(out["logits"], wanted["logits"], self.temperature)
        losses["feat_views"] = feature_loss(views, batch["clean_views"])
        losses["feat_nodes"] = masked_mse(out["nodes"], wanted["nodes"], batch["decisions"].valid)
        loss = self.w_il * losses["loss"]
        for name in ("concepts", "waypoints") if values else ():
            loss = loss + self.weights[name] * values[name]
        if self.w_kl:
            loss = loss + self.w_kl * self.temperature**2 * losses["kl"]
        for name in self.match if self.w_feat else ():
            loss = loss + self.w_feat * losses[f"feat_{name}"]
        return {**losses, **values, "loss": loss}


def load_teacher(agent: TopologicalAgent, weights: str) -> TopologicalAgent:
    """A frozen agent of the same size, without adapters and with plain means over views.

    ``weights``: a file or folder; "start": those of ``agent`` as it is now.
    """
    if hardened.adapters_only(weights):
        raise ValueError(
            f"{weights} holds adapters alone, and a teacher needs whole weights: name a folder "
            f"with {checkpoint.WEIGHTS}, such as checkpoints/teacher."
        )
    teacher = copy.deepcopy(agent)
    remove_adapters(teacher)
    teacher.planner.fusion = None
    if weights != "start":
        try:
            checkpoint.load_weights(teacher, weights)
        except FileNotFoundError as error:
            raise FileNotFoundError(
                f"There is no teacher at {weights}. Train one with `make train "
                "RECIPE=da_per_episode` and name its folder "
                "(stages.views_rgb.recipe.teacher=runs/.../agent: the other stages follow)."
            ) from error
    return teacher.requires_grad_(False).eval()


def policy_kl(student: Tensor, teacher: Tensor, temperature: float) -> Tensor:
    """KL(pi_T || pi_S) of logits [B, n] at ``temperature``, mean over the batch; -inf is no
    candidate, and must be so in both."""
    p = (teacher / temperature).log_softmax(-1)
    q = (student / temperature).log_softmax(-1)
    possible = torch.isfinite(teacher)
    each = p.exp() * (p - q).masked_fill(~possible, 0.0)
    return each.sum(-1).mean()


def feature_loss(student: Tensor, teacher: Tensor) -> Tensor:
    """Mean squared error in units of the teacher's variance, so that scales do not matter."""
    error = (student.float() - teacher.float()).square().mean()
    return error / teacher.float().var().clamp(min=1e-6)


def masked_mse(student: Tensor, teacher: Tensor, valid: Tensor) -> Tensor:
    """``feature_loss`` over the valid tokens of ``[B, n, width]``."""
    return feature_loss(student[valid], teacher[valid])
