"""The contract of agents: what evaluation and training expect of one.

An agent receives an instruction and acts on observations; it is independent of worlds. A
*trainable* agent also exposes its decisions as batches, and objectives train it from these alone.
How to bring one: ``docs/bring-your-own.md``.

A class that builds on :class:`Agent` inherits the defaults of everything optional. An object of any
other class works, too: :func:`as_agent` fills in what it lacks.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents.adapters import remove_adapters
from mitigate.core.contracts import lacking, read, take_over

if TYPE_CHECKING:
    from mitigate.worlds.episodes import Episode
    from mitigate.worlds.world import World


class Agent:
    """Base class of agents. A subclass defines ``reset`` and ``act``; the rest has defaults.

    Attributes:
        views: 12 for a panorama, 1 for a camera ahead; worlds with another number are rejected.
            None: any number.
        sensors: the entries of observations that it reads; a training draws no corruption of frames
            that are not among them. None: it may read all.
        tasks: which episodes it can do, by ``info["task"]`` of episode lists ("vln": a route,
            "ogn": an object); an evaluation warns of others. None: all.
        system_prompt: of an agent that works with a prompt, which it reads at ``reset``.
        aim: the point [2] of the plan that it is walking to, or None.
        together: how many episodes it can walk at once; more than 1 needs ``begin`` and
            ``act_all``.
        encoders: names of the parts that read a sensor, by sensor. labels: what they are taught by
            a world's ``truth()``, by sensor. Both belong to ``see`` (:class:`Seeing`).
        loss_weights: of its auxiliary losses by name; 1 where it names none.
        frozen: names of modules that never train, such as a borrowed backbone; adapters in them do.
        plain_walks: whether what ``collect`` returns is plain data (dicts, lists, texts, numbers
            and tensors), which DAgger keeps on disk.
        run_state: attributes that change while it runs, for a shipped kind: its fingerprint leaves
            them out, and all attributes that a new agent lacks.
        own_config_only: constructor arguments that name code or files, which no config that came
            with weights may set.
    """

    views: int | None = None
    sensors: Sequence[str] | None = None
    tasks: Sequence[str] | None = None
    system_prompt: str | None = None
    aim: np.ndarray | None = None
    together: int = 1
    encoders: Mapping[str, tuple[str, ...]] = {}
    labels: Mapping[str, str] = {}
    loss_weights: Mapping[str, float] = {}
    frozen: Sequence[str] = ()
    plain_walks: bool = True
    run_state: Sequence[str] = ()
    own_config_only: Sequence[str] = ()

    def reset(self, instruction: str) -> None:
        """Start an episode."""
        raise NotImplementedError(f"{type(self).__name__} defines no reset(instruction)")

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """Return the next low-level action."""
        raise NotImplementedError(f"{type(self).__name__} defines no act(observation)")

    def begin(self, instruction: str) -> Any:
        """Return what it must remember of an episode, of up to ``together`` at once."""
        raise NotImplementedError(f"{type(self).__name__} defines no begin(instruction)")

    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Any]
    ) -> list[int]:
        """Return an action for the observation of each of n episodes, and change their memories.

        No answer depends on the other episodes, nor on how many there are.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no act_all(...)")

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Learn that another driver acts: since the agent's last answer the driver moved ``metres``
        ahead and ``radians`` to the left, which is most like ``action`` (-1: like none). What the
        agent planned is forgotten."""

    def remembering(self) -> AbstractContextManager:
        """A context within which equal frames are encoded once; no action depends on it."""
        return nullcontext()

    def precompute(self, piece: Any, *, clean: bool) -> Any:
        """Return a piece of ``collect`` with what no trained weight changes computed; worker
        processes call it. ``clean`` asks for what ``decide(clean=True)`` needs."""
        return piece

    def as_teacher(self) -> Any:
        """Return a copy without what was added to make it robust: its adapters."""
        return _without_adapters(self)


class SideBySide(Agent):
    """Base class of agents that run ``together`` episodes at once. A subclass defines ``begin`` and
    ``answers``."""

    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Any]
    ) -> list[int]:
        """Return an action for each of up to ``together`` episodes. Raises what
        ``agents/observation.py`` rejects."""
        spare = self.together - len(memories)  # filled up, so that sums round as in a full batch
        observations = [*observations, *[observations[-1]] * spare]
        return self.answers(observations, [*memories, *[memories[-1]] * spare], len(memories))

    def answers(
        self,
        observations: Sequence[Mapping[str, np.ndarray]],
        memories: Sequence[Any],
        count: int,
    ) -> list[int]:
        """Return the actions of the first ``count`` episodes, whose memories change."""
        raise NotImplementedError(f"{type(self).__name__} defines no answers(...)")


def check_started(started: bool) -> None:
    """Raise RuntimeError before the first ``reset``."""
    if not started:
        raise RuntimeError("Start the episode first: agent.reset(instruction).")


# what :func:`as_agent` takes over from an object once; ``system_prompt`` and ``aim`` may change
OPTIONAL = (
    *("views", "sensors", "tasks", "together", "encoders", "labels", "loss_weights", "frozen"),
    *("plain_walks", "own_config_only", "begin", "act_all", "taken", "remembering", "precompute"),
    "as_teacher",
)


def as_agent(agent: Any) -> Agent:
    """Return ``agent``, or a view of it with the defaults of :class:`Agent` if its class does not
    build on that. The agent itself is not changed, and is what a fingerprint is taken of."""
    return agent if isinstance(agent, Agent) else _AgentView(agent)


class _AgentView(Agent):
    """An object of a user's class as an :class:`Agent`."""

    def __init__(self, agent: Any) -> None:
        self._agent = agent
        take_over(self, agent, OPTIONAL)
        if lacking(agent, ("begin", "act_all")):
            self.together = 1

    @property
    def system_prompt(self) -> str | None:
        return read(self._agent, "system_prompt")  # may be set later

    @system_prompt.setter
    def system_prompt(self, text: str | None) -> None:
        self._agent.system_prompt = text

    @property
    def aim(self) -> np.ndarray | None:  # type: ignore[override]
        return read(self._agent, "aim")  # changes from step to step

    def reset(self, instruction: str) -> None:
        self._agent.reset(instruction)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        return self._agent.act(observation)

    def as_teacher(self) -> Any:
        return _without_adapters(self._agent)


def stated_settings(agent: Any) -> dict[str, Any] | None:
    """Return what ``settings``, a method or a mapping, says of ``agent``; None if it has none."""
    settings = read(agent, "settings")
    return None if settings is None else dict(settings() if callable(settings) else settings)


def _without_adapters(agent: Any) -> Any:
    copied = copy.deepcopy(agent)
    remove_adapters(copied)
    return copied


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
    """An ``nn.Module`` that objectives train, beside :class:`Agent`."""

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
