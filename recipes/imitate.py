"""Imitation of a world's expert with scheduled sampling, on corrupted frames.

Every step rolls out a few training episodes with the current weights under the schedule's
corruptions, then trains on all their decisions. Loss = cross-entropy to the expert, plus the
agent's own auxiliary losses. The same recipe under three schedules gives ``da_per_frame``,
``da_per_episode`` and ``da_success``. It trains any agent of ``agents/agent.py`` in any world that
has an expert.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from torch import Tensor

from mitigate.agents.agent import Decisions, Output, as_agent
from mitigate.training.objective import check_weights
from mitigate.training.parts import train_only
from mitigate.training.rollouts import OnEpisodes, Rollouts

DECAY = 0.6  # share of the steps until the oracle takes follow_oracle of the decisions (ours)


class Imitate(OnEpisodes):
    """Imitate the expert on rollouts.

    Args:
        agent: trained in place.
        rollouts: the source of its decisions.
        train_parts: of the agent's ``parts()``, or "adapters"; the others stay frozen. "policy":
            all but the encoders. None: all but the adapters.
        losses: weights of the agent's auxiliary losses by name, where they differ from its own.

    Raises:
        ValueError: for an unknown part and for an invalid weight.
    """

    def __init__(
        self,
        agent: Any,
        rollouts: Rollouts,
        train_parts: Sequence[str] | str | None = None,
        losses: Mapping[str, float] | None = None,
    ) -> None:
        super().__init__()
        train_only(agent, train_parts)
        self.agent = agent
        self.losses = loss_weights(agent, losses)
        self.rollouts = rollouts

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        decisions = batch["decisions"]
        out = self.agent.decide(decisions)
        check_losses(self.agent, self.losses, out)
        return imitation(out, decisions, self.losses)


def imitation(out: Output, decisions: Decisions, weights: Mapping[str, float]) -> dict[str, Tensor]:
    """Cross-entropy of ``out`` to the expert's answers, less their entropy, averaged by weight; the
    auxiliary losses are added by ``weights``, 1 unless named.

    Returns "loss", and the parts and figures to log.
    """
    assert out.logits is not None, "decide() gave no logits"
    logits, target = masked(out.logits, out.mask), decisions.target
    if logits.shape != target.shape or decisions.weight.shape != target.shape[:1]:
        raise ValueError(
            f"decide() gave logits {list(logits.shape)} for targets {list(target.shape)} with "
            f"weights {list(decisions.weight.shape)}: they must be [B, n], [B, n] and [B], of all "
            "decisions that join() put together."
        )
    log_p = logits.log_softmax(-1).masked_fill(logits == float("-inf"), 0.0)
    entropy = -(target * target.clamp(min=1e-9).log()).sum(-1)
    each = -(target * log_p).sum(-1) - entropy
    loss = imitated = (each * decisions.weight).sum() / decisions.weight.sum()
    for name, value in out.losses.items():
        loss = loss + weights.get(name, 1.0) * value
    right = target.gather(1, logits.argmax(-1)[:, None])[:, 0] > 0.4 * target.max(1).values
    figures = {"imitation": imitated, **out.losses, "accuracy": right.float().mean(), **out.figures}
    return {"loss": loss, **figures}


def falling_share(step: int, steps: int, least: float) -> float:
    """The expert's share of the decisions at ``step``: it falls from 1 to ``least`` over the first
    ``DECAY`` of ``steps``."""
    return least + max(0.0, 1 - step / (DECAY * steps)) * (1 - least)


def masked(logits: Tensor, mask: Tensor | None) -> Tensor:
    """Logits with minus infinity for what may not be chosen."""
    return logits if mask is None else logits.masked_fill(~mask, float("-inf"))


def loss_weights(agent: Any, given: Mapping[str, float] | None) -> dict[str, float]:
    """Weights of an agent's auxiliary losses by name: its own, and in their place those given.
    Raises ValueError for one below 0, and for what is no mapping."""
    if not isinstance(given or {}, Mapping):
        raise ValueError(f"recipe.losses={given} must be weights by name, as {{distance: 0.3}}.")
    check_weights(**{f"losses.{name}": value for name, value in (given or {}).items()})
    return {**as_agent(agent).loss_weights, **(given or {})}


def check_losses(agent: Any, weights: Mapping[str, float], out: Output) -> None:
    """Raise ValueError for weights of a loss that ``agent`` neither returned in ``out`` nor names
    itself."""
    known = [*out.losses, *(n for n in as_agent(agent).loss_weights if n not in out.losses)]
    for name in weights:
        if name not in known:
            raise ValueError(
                f"recipe.losses weights {name!r}, which decide() of {type(agent).__name__} does "
                f"not return: its losses are {', '.join(known) or 'none'}."
            )
