"""Train the image encoder of a vision-language agent so that corrupted views give the same image
tokens as clean views.

Only LoRA weights of the image encoder and the projector are trained. The language model does not
run. Neither an expert nor labels are used.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from mitigate.core import checkpoint
from mitigate.recipes.distil import feature_loss
from mitigate.training.parts import START, load_teacher
from mitigate.training.poses import OnViews, Poses


class DistilImages(OnViews):
    """Distil a teacher's image tokens on views of random poses.

    The loss is the mean over panoramas of MSE(f_S, f_T) / Var(f_T). f_T are the teacher's tokens
    of the clean views, f_S the student's tokens of the corrupted views, both after the projector.
    With a single camera, the views of one position count as a panorama.

    Args:
        agent: a vision-language agent (``agents/vlm``), which is trained in place.
        poses: the source of views.
        teacher: weights, or "start" for a copy of ``agent`` at the start of the stage, with its
            LoRA weights.

    Raises:
        FileNotFoundError: If the teacher is missing.
        ValueError: If the agent has no LoRA weights in its image encoder.
    """

    needs = ("image_tokens", "image_lora")
    otherwise = "Only agent=vlm has them. For other agents, choose recipe=harden."

    def __init__(self, agent: Any, poses: Poses, teacher: str = START) -> None:
        super().__init__()
        trained = agent.image_lora()
        if not trained:
            raise ValueError(
                "The image encoder has no LoRA weights. Set agent.lora.vision=all-linear, or list "
                "names of its linear modules."
            )
        agent.requires_grad_(False)
        for parameter in trained:
            parameter.requires_grad_(True)
        self.agent = agent
        self.poses = poses
        self.teacher: Any = load_teacher(agent, teacher)

    def identity(self) -> dict[str, str]:
        return {"teacher_sha256": checkpoint.weights_sha(self.teacher)}

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Return one part per panorama, with the number of panoramas in the batch."""
        pairs = zip(batch["frames"], batch["clean"], strict=True)
        count = len(batch["frames"])
        return [{"frames": frames, "clean": clean, "count": count} for frames, clean in pairs]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        with torch.no_grad():
            target = self.teacher.image_tokens(batch["clean"])
        tokens = self.agent.image_tokens(batch["frames"])
        return {"loss": feature_loss(tokens, target) / batch["count"]}
