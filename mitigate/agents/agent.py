"""What evaluation and recipes ask of an agent.

An agent hears an instruction and acts on observations; it knows no world. A *trainable* agent also
says what its decisions are made of, and recipes train it from that alone. How to bring one:
``docs/bring-your-own.md``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
import torch
from torch import Tensor, nn

if TYPE_CHECKING:
    from mitigate.worlds.episodes import Episode
    from mitigate.worlds.world import World


class Agent(Protocol):
    """What can be evaluated: any object that turns observations into low-level actions.

    An agent that works with a prompt has it in an attribute ``system_prompt``, read at ``reset``.
    ``views`` (attribute, optional): 12 for a panorama, 1 for a camera ahead; worlds that show
    another number are refused.
    ``tasks`` (attribute, optional): of what episode lists call ``info["task"]`` ("vln", a route;
    "ogn", an object), those that it can do; an evaluation warns of others. Without it, all.
    ``taken(action, metres, radians)`` (optional): somebody else drives; since the agent's last
    answer that took it ``metres`` ahead and ``radians`` to the left, which is most like ``action``
    (-1: like none). What the agent planned is forgotten.
    ``aim`` (attribute, optional): the point [2] of the plan that it is walking to, or None.
    """

    def reset(self, instruction: str) -> None: ...
    def act(self, observation: Mapping[str, np.ndarray]) -> int: ...


@runtime_checkable
class SideBySide(Protocol):
    """An agent that can walk several episodes at once, which costs less than one after the other.

    together: how many, at most. ``begin(instruction)`` returns what it must remember of an episode;
    ``act_all`` answers an observation of each of n episodes, n actions, and changes their memories.
    No answer depends on the other episodes, nor on how many there are.
    """

    together: int

    def begin(self, instruction: str) -> Any: ...
    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Any]
    ) -> list[int]: ...


@dataclass
class Output:
    """What an agent makes of B decisions.

    logits: [B, n] over the candidates of each, or None where nothing is decided. mask: bool [B, n],
    what may be chosen; None: all. features: what a student's are compared with a teacher's by, by
    name. losses: the agent's own auxiliary losses, scalars by name. figures: more scalars to log.
    """

    logits: Tensor | None = None
    mask: Tensor | None = None
    features: dict[str, Tensor] = field(default_factory=dict)
    losses: dict[str, Tensor] = field(default_factory=dict)
    figures: dict[str, Tensor] = field(default_factory=dict)


def check_logits(logits: Tensor, agent: Any) -> Tensor:
    """Return ``logits`` [..., n], in which -inf is what may not be chosen.

    Raises ValueError, naming the kind of ``agent``, for NaN, for infinity, and where nothing may be
    chosen: the likeliest action would be the first, STOP.
    """
    chosen = torch.isfinite(logits.amax(-1))
    if not chosen.all():
        shown = logits[~chosen][0] if logits.ndim > 1 else logits
        numbers = ", ".join(f"{value:g}" for value in shown.flatten()[:8].tolist())
        raise ValueError(
            f"{type(agent).__name__} gave logits that choose no action ({numbers}): of what may be "
            "chosen all must be finite, and the rest -inf. Look for NaN in what it computes."
        )
    return logits


class Decisions(Protocol):
    """A batch of B decisions with the expert's answers; what else it holds is the agent's affair.

    target: [B, n], a distribution over the candidates of each decision that adds up to 1. weight:
    [B], how much each counts. episode_ids: list of str, named when the loss is not finite.
    """

    target: Tensor
    weight: Tensor
    episode_ids: list[str]

    def to(self, device: Any) -> Any: ...


@runtime_checkable
class Trainable(Protocol):
    """An ``nn.Module`` that the recipes train, beside :class:`Agent`.

    ``loss_weights`` (attribute, optional): of its auxiliary losses by name; 1 where it names none.
    ``sensors`` (attribute, optional): the entries of observations that it reads; a training draws
    no corruption of frames that are not among them. Without it, it may read all.
    ``frozen`` (attribute, optional): names of modules that never train, such as a borrowed
    backbone; adapters in them do.
    ``plain_walks`` (attribute, optional): False if what :meth:`collect` returns is no plain data
    (dicts, lists, texts, numbers and tensors), which DAgger keeps on disk.
    ``precompute(piece, *, clean)`` (optional): the piece with what no trained weight changes
    computed, called on worker processes; ``clean`` asks for what ``decide(clean=True)`` needs.
    ``as_teacher()`` (optional): a copy without what was added to make it robust; by default a copy
    without its adapters.
    """

    def parts(self) -> dict[str, nn.Module]:
        """What may be frozen, trained and adapted, by name; together all parameters."""

    def collect(
        self,
        worlds: Sequence[World],
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
        clean: bool = False,
    ) -> Any:
        """Walk ``episodes[i]`` in ``worlds[i]`` and return the decisions, picklable, with the
        expert's answer to each.

        Called in eval mode without gradients. ``expert_share``: of the steps taken as the expert
        would, the others as the agent's own policy samples them (DAgger). ``rngs[i]`` gives all
        that is random in episode i, so that it does not depend on the others. ``clean``: keep the
        observations before their corruption, too (``observation.clean``).
        """

    def join(self, pieces: Sequence[Any]) -> Decisions:
        """One batch of what several calls of :meth:`collect` returned."""

    def decide(self, decisions: Any, *, clean: bool = False) -> Output:
        """The agent's answer to decisions; ``clean``: seen without corruption, over the same
        candidates."""


@runtime_checkable
class Seeing(Protocol):
    """A trainable agent whose encoders can be taught on single observations, without episodes.

    encoders: names of the parts that read a sensor. labels: what they are taught by a world's
    ``truth()``, by sensor.
    """

    encoders: Mapping[str, tuple[str, ...]]
    labels: Mapping[str, str]

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """Features "views" [P, V, F] of frames [P, V, H, W, c], and with the truth the loss
        "labels"."""
