"""Train an agent's encoders on random poses with labels from the simulator.

In the apartments, RGB labels describe the middle of each view: the furniture, which furniture is
near, its colours, and the kinds of rooms. Depth labels state how far the agent can move in a
straight line in each direction. The encoders of the two sensors are independent, so each has its
own stage.
"""

from __future__ import annotations

from typing import Any

from torch import Tensor

from mitigate.agents.adapters import adapted, adapter_parameters
from mitigate.agents.agent import Seeing
from mitigate.training.parts import freeze
from mitigate.training.poses import OnViews, Poses


class Pretrain(OnViews):
    """Train encoders on labels of the world.

    Args:
        agent: the agent, whose encoders for the sensor in ``poses`` are trained in place. It must
            have a method ``see`` (``agents/agent.py``).
        poses: the source of views.
    """

    def __init__(self, agent: Any, poses: Poses) -> None:
        super().__init__()
        self.agent = agent
        self.sensor = poses.sensor
        poses.learn(**views_to_learn(agent, self.sensor))
        self.poses = poses

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        out = self.agent.see(self.sensor, batch["frames"], batch["targets"])
        return {"loss": out.losses["labels"], **out.figures}


def views_to_learn(agent: Any, modality: str, adapters_only: bool = False) -> dict[str, Any]:
    """Unfreeze the encoders of ``modality``, or only their adapters.

    For RGB, every second view is used, because neighbouring views overlap. If the agent has
    adapters, all views are used, because ring adapters read all views of a panorama.

    Returns:
        The arguments of ``Poses.learn``.

    Raises:
        ValueError: If the agent has no method ``see``, or if the modality is unknown.
    """
    if not isinstance(agent, Seeing):
        raise ValueError(
            f"{type(agent).__name__} cannot be trained on single views: it has no see(sensor, "
            "frames) (docs/bring-your-own.md). Leave out those stages (stages.NAME=null)."
        )
    if modality not in agent.encoders:
        raise ValueError(
            f"modality must be {' or '.join(map(repr, agent.encoders))}, got {modality!r}."
        )
    module: Any = agent
    module.requires_grad_(False)
    for part in (module.parts()[name] for name in module.encoders[modality]):
        for trained in adapter_parameters(part) if adapters_only else part.parameters():
            trained.requires_grad_(True)
    freeze(module)
    every = 2 if modality == "rgb" and not adapted(module) else 1
    return {"label": agent.labels[modality], "every": every}
