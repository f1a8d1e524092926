"""Zero-initialised ConvAdapters in frozen encoders, taught on random corrupted views.

The backbone, the waypoint head and the planner stay as they are; only the adapters learn to give
back, for a corrupted view, what the untouched encoders give for the clean one. Where the adapters
sit is the agent's setting (``agent.adapters``).
"""

from __future__ import annotations

from typing import Any

from mitigate.agents.adapters import adapted, backbone_sha, trainable_share
from mitigate.agents.topological import TopologicalAgent
from recipes.ts_distill import ViewDistillation

MODALITIES = ("rgb", "depth")


class ConvAdapterRecipe(ViewDistillation):
    """Args: as ``ViewDistillation``; its teacher is the agent itself without its adapters.

    Raises ValueError for an agent that has no adapters in the encoder of ``modality``.
    """

    def __init__(self, agent: TopologicalAgent, modality: str, **others: Any) -> None:
        super().__init__(agent, modality, teacher="start", adapters_only=True, **others)
        if not adapted(agent.get_submodule(f"{modality}_encoder")):
            raise ValueError(
                f"The agent has no adapters in its {modality} encoder: give agent.adapters a "
                "target there, as conf/recipe/conv_adapter.yaml does."
            )
        self.backbone = backbone_sha(agent)
        print(f"adapters: {trainable_share(agent):.1%} of the backbone's weights", flush=True)

    def evaluate(self, step: int) -> dict[str, float]:
        """1 if the backbone is what it was when the adapters came in."""
        return {"backbone_unchanged": float(backbone_sha(self.agent) == self.backbone)}
