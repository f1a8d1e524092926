"""Residual adapters in a frozen agent, taught to give for corrupted frames what the untouched agent
gives for the clean ones.

The backbone stays as it is, bit for bit; only the adapters learn. Where they sit is the agent's
setting (``agents/adapters.py`` puts them behind any module that gives a map). ``Adapt`` works on
rolled-out episodes of any trainable agent, ``AdaptViews`` on random poses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from torch import nn

from mitigate.agents.adapters import adapted, backbone_sha, trainable_share
from mitigate.core.progress import say
from mitigate.corruptions import Schedule
from mitigate.recipes.distil import Distil, DistilViews
from mitigate.training.parts import ADAPTERS, START
from mitigate.worlds.world import TrainingEpisodes, World


class Adapt(Distil):
    """Args: as ``Distil``, whose teacher is the agent itself without its adapters; by default the
    features alone are matched: w_il and w_kl are 0.

    Raises ValueError for an agent that has no adapters.
    """

    def __init__(
        self,
        agent: Any,
        world: Callable[[], World],
        training: TrainingEpisodes,
        schedule: Schedule,
        episodes: int = 3,
        follow_oracle: float = 0.5,
        seed: int = 0,
        losses: Mapping[str, float] | None = None,
        w_il: float = 0.0,
        w_kl: float = 0.0,
        w_feat: float = 1.0,
        temperature: float = 2.0,
        match: Sequence[str] | None = None,
    ) -> None:
        has_adapters(agent)
        super().__init__(
            agent,
            world,
            training,
            schedule,
            START,
            (ADAPTERS,),
            episodes,
            follow_oracle,
            seed,
            losses,
            w_il,
            w_kl,
            w_feat,
            temperature,
            match,
        )
        self.backbone = backbone_sha(agent)

    def evaluate(self, step: int) -> dict[str, float]:
        """1 if the backbone is what it was when the adapters came in."""
        return {"backbone_unchanged": float(backbone_sha(self.agent) == self.backbone)}


class AdaptViews(DistilViews):
    """Args: as ``DistilViews``; its teacher is the agent itself without its adapters.

    Raises ValueError for an agent that has no adapters in the encoders of ``modality``.
    """

    def __init__(
        self,
        agent: Any,
        world: Callable[[], World],
        training: TrainingEpisodes,
        modality: str,
        schedule: Schedule,
        panoramas: int = 12,
        seed: int = 0,
        w_labels: float = 1.0,
        w_feat: float = 1.0,
        refresh_episodes: int = 8,
    ) -> None:
        super().__init__(
            agent,
            world,
            training,
            modality,
            START,
            schedule,
            panoramas,
            seed,
            w_labels,
            w_feat,
            refresh_episodes,
            adapters_only=True,
        )
        parts = agent.parts()
        has_adapters(agent, *(parts[name] for name in agent.encoders[modality]))
        self.backbone = backbone_sha(agent)

    def evaluate(self, step: int) -> dict[str, float]:
        """1 if the backbone is what it was when the adapters came in."""
        return {"backbone_unchanged": float(backbone_sha(self.agent) == self.backbone)}


def has_adapters(agent: nn.Module, *modules: nn.Module) -> None:
    """Raise ValueError unless one of ``modules`` (none: the agent) has adapters; say how large."""
    if not any(adapted(module) for module in modules or (agent,)):
        raise ValueError(
            "The agent has no adapters there: give agent.adapters a target in its encoders, as "
            "conf/recipe/conv_adapter.yaml does, or call insert_adapters(agent, targets)."
        )
    say(f"adapters: {trainable_share(agent):.1%} of the backbone's weights")
