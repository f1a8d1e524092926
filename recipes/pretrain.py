"""Teach an agent's encoders on random poses, by the labels that a world gives for free.

Of the apartments: which things, near things, colours and rooms show in the middle of each view
(RGB), and where the agent can go straight (depth). The encoders of a sensor are independent of the
others', so two stages teach them.
"""

from __future__ import annotations

from typing import Any

from torch import Tensor

from mitigate.agents.adapters import adapted, adapter_parameters
from mitigate.agents.agent import Seeing
from mitigate.training.parts import freeze
from mitigate.training.poses import OnViews, Poses


class Pretrain(OnViews):
    """Teach encoders the labels that a world gives.

    Args:
        agent: its encoders of the sensor of ``poses`` are trained in place; it must be able to
            ``see`` (``agents/agent.py``).
        poses: the source of views.
    """

    def __init__(self, agent: Any, poses: Poses) -> None:
        super().__init__()
        self.agent = agent
        self.modality = poses.sensor
        poses.learn(**views_to_learn(agent, self.modality))
        self.poses = poses

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        out = self.agent.see(self.modality, batch["frames"], batch["targets"])
        return {"loss": out.losses["labels"], **out.figures}


def views_to_learn(agent: Any, modality: str, adapters_only: bool = False) -> dict[str, Any]:
    """Let the encoders of ``modality`` train, or their adapters alone; return what
    ``Poses.learn`` takes for them.

    Of RGB every second view is learned from: neighbours overlap, and half of them teach as much.
    Ring adapters see all views of a panorama, so an agent with adapters gets all. Raises ValueError
    for an agent that cannot ``see`` and for an unknown modality.
    """
    if not isinstance(agent, Seeing):
        raise ValueError(
            f"{type(agent).__name__} cannot be taught on views alone: it has no see(sensor, "
            "frames) (docs/bring-your-own.md). Leave out the stages that do (stages.NAME=null)."
        )
    if modality not in agent.encoders:
        raise ValueError(
            f"modality={modality!r} is unknown; choose {' or '.join(map(repr, agent.encoders))}."
        )
    module: Any = agent
    module.requires_grad_(False)
    for part in (module.parts()[name] for name in module.encoders[modality]):
        for trained in adapter_parameters(part) if adapters_only else part.parameters():
            trained.requires_grad_(True)
    freeze(module)
    every = 2 if modality == "rgb" and not adapted(module) else 1
    return {"label": agent.labels[modality], "every": every}
