"""Teach an agent's encoders on random poses, by the labels that a world gives for free.

Of the apartments: which things, near things, colours and rooms show in the middle of each view
(RGB), and where the agent can go straight (depth). The encoders of a sensor are independent of the
others', so two stages teach them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from torch import Tensor

from mitigate.agents.adapters import adapted, adapter_parameters
from mitigate.agents.agent import Seeing
from mitigate.corruptions import Schedule
from mitigate.training.parts import OWN, SEEING, freeze
from mitigate.training.poses import Poses
from mitigate.training.recipe import Recipe
from mitigate.worlds.world import TrainingEpisodes, World

VIEWS_ALONE = (
    f"This stage teaches encoders on views alone. {OWN} Of the recipes, imitation, da_per_frame, "
    "da_per_episode, da_success and ts_distill do without, for agents that learn on episodes; so "
    "does one of your own with recipes/adapt.py (Adapt)."
)


class Pretrain(Recipe):
    """Args: agent: its encoders of ``modality`` ("rgb" or "depth") are trained in place; it must be
    able to ``see`` (``agents/agent.py``). world, training, panoramas, refresh_episodes: as
    ``Poses``. schedule: which panorama is corrupted by what, None: none.
    """

    ahead = True
    needs = SEEING
    otherwise = VIEWS_ALONE

    def __init__(
        self,
        agent: Any,
        world: Callable[[], World],
        training: TrainingEpisodes,
        modality: str,
        schedule: Schedule | None = None,
        panoramas: int = 12,
        seed: int = 0,
        refresh_episodes: int = 8,
    ) -> None:
        super().__init__()
        self.agent, self.modality = agent, modality
        self.poses = Poses(
            agent,
            world,
            training,
            schedule or Schedule("clean", 0.0),
            panoramas=panoramas,
            seed=seed,
            refresh_episodes=refresh_episodes,
            **views_to_learn(agent, modality),
        )

    def jobs(self, step: int) -> list[tuple]:
        return self.poses.jobs(step, self.workers)

    def pieces(self) -> int:
        return self.poses.pieces

    def work(self, job: tuple) -> Any:
        return self.poses.work(job)

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        return self.poses.collate(pieces)

    def weight(self, batch: dict[str, Any]) -> float:
        """Panoramas, or views of one camera."""
        return float(len(batch["frames"]))

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        out = self.agent.see(self.modality, batch["frames"], batch["targets"])
        return {"loss": out.losses["labels"], **out.figures}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return self.poses.figures()

    def get_extra_state(self) -> dict[str, Any]:
        return {"schedule": self.poses.schedule.state_dict()}

    def set_extra_state(self, state: dict[str, Any]) -> None:
        self.poses.schedule.load_state_dict(state["schedule"])


def views_to_learn(agent: Any, modality: str, adapters_only: bool = False) -> dict[str, Any]:
    """Let the encoders of ``modality`` train, or their adapters alone, and return the settings of
    ``Poses`` for them.

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
    return {"sensor": modality, "label": agent.labels[modality], "every": every}
