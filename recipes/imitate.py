"""Imitate the expert of a world on corrupted frames, with scheduled sampling.

Every training step runs a few episodes with the current weights under the corruptions of the
schedule, and trains on all decisions of these episodes. The loss is the cross-entropy with the
expert's decisions plus the auxiliary losses of the agent. The recipes ``da_per_frame``,
``da_per_episode`` and ``da_success`` use this objective with different schedules. This objective
trains any agent with the interface of ``agents/agent.py`` in any world that has an expert.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from torch import Tensor

from mitigate.agents.agent import Decisions, Output, as_agent
from mitigate.training.objective import check_weights
from mitigate.training.parts import train_only
from mitigate.training.rollouts import OnEpisodes, Rollouts

# fraction of training during which the share of expert decisions falls (heuristic)
DECAY = 0.6


class Imitate(OnEpisodes):
    """Imitate the expert on rollouts of the agent.

    Args:
        agent: the agent, which is trained in place.
        rollouts: the source of the agent's decisions to train on.
        train_parts: names of the agent's ``parts()``, or "adapters"; other parts stay frozen.
            "policy" means all parts except the encoders. If it is None, all parts except the
            adapters are trained.
        losses: weights of auxiliary losses by name, which override the agent's defaults.

    Raises:
        ValueError: If a part is unknown, or if a weight is invalid.
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
        self.loss_weights = loss_weights(agent, losses)
        self.rollouts = rollouts

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        return decide(self.agent, batch["decisions"], self.loss_weights)[1]


def decide(
    agent: Any, decisions: Decisions, weights: Mapping[str, float]
) -> tuple[Any, dict[str, Tensor]]:
    """Return the agent's output for ``decisions``, and the result of :func:`imitation`."""
    out = agent.decide(decisions)
    if not all(hasattr(out, name) for name in ("logits", "losses", "figures")):
        raise ValueError(
            f"decide() of {type(agent).__name__} must return an Output (mitigate/agents/agent.py), "
            f"got {type(out).__name__}."
        )
    check_losses(agent, weights, out)
    return out, imitation(out, decisions, weights)


def imitation(out: Output, decisions: Decisions, weights: Mapping[str, float]) -> dict[str, Tensor]:
    """Return the imitation loss plus the weighted auxiliary losses.

    The imitation loss is the weighted cross-entropy with the expert, minus the entropy of the
    expert. ``weights`` contains the weights of auxiliary losses by name; the default weight is 1.

    Returns:
        A dict with the entry "loss" and with values that are logged.
    """
    assert out.logits is not None, "decide() gave no logits"
    logits, target = out.logits, decisions.target
    if logits.shape != target.shape or decisions.weight.shape != target.shape[:1]:
        raise ValueError(
            "decide() and join() must give logits [B, n], targets [B, n] and weights [B] for all "
            f"decisions, got {list(logits.shape)}, {list(target.shape)} and "
            f"{list(decisions.weight.shape)}."
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
    """Return the fraction of decisions at ``step`` that follow the expert.

    The fraction falls from 1 to ``least`` during the first ``DECAY`` of ``steps``.
    """
    return least + max(0.0, 1 - step / (DECAY * steps)) * (1 - least)


def loss_weights(agent: Any, weights: Mapping[str, float] | None) -> dict[str, float]:
    """Return the weights of an agent's auxiliary losses: the agent's defaults, overridden by
    ``weights``.

    Raises ValueError if ``weights`` is not a mapping, or if a weight is below 0.
    """
    if not isinstance(weights or {}, Mapping):
        raise ValueError(
            f"losses must map names of losses to weights, such as {{distance: 0.3}}, got {weights}."
        )
    check_weights(**{f"losses.{name}": value for name, value in (weights or {}).items()})
    return {**as_agent(agent).loss_weights, **(weights or {})}


def check_losses(agent: Any, weights: Mapping[str, float], out: Output) -> None:
    """Raise ValueError if ``weights`` contains a loss that ``agent`` does not have."""
    known = [*out.losses, *(n for n in as_agent(agent).loss_weights if n not in out.losses)]
    for name in weights:
        if name not in known:
            raise ValueError(
                f"losses has a weight for {name!r}, but decide() of {type(agent).__name__} "
                f"returns no such loss. Its losses are {', '.join(known) or 'none'}."
            )
