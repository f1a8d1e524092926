"""Define the interface that evaluation and training expect from an agent.

An agent receives an instruction and acts on observations. It does not depend on a particular world.
A *trainable* agent also returns its decisions as batches, and objectives train the agent with these
batches only. ``docs/bring-your-own.md`` shows how to add an agent.

A subclass of :class:`Agent` inherits defaults for all optional members. Objects of other classes
also work: :func:`as_agent` adds the defaults.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents.adapters import remove_adapters
from mitigate.core.contracts import missing_members, read, take_over
from mitigate.core.observation import STOP

if TYPE_CHECKING:
    from mitigate.worlds.episodes import Episode
    from mitigate.worlds.world import World


class Agent:
    """Base class of agents. A subclass must define ``reset`` and ``act``; all other members have
    defaults.

    Attributes:
        views: 12 for a panorama, 1 for a forward camera; worlds with a different number are
            rejected. If None, any number is accepted.
        sensors: the entries of observations that the agent reads. Training corrupts only the frames
            of these entries. If None, the agent may read all entries.
        tasks: the values of an episode's ``info["task"]`` that the agent supports ("vln": follow a
            route, "ogn": find an object). Evaluation warns about other tasks. If None, the agent
            supports all tasks.
        system_prompt: the prompt that the agent reads at ``reset``, or None.
        aim: position [x, y] in metres that the agent is moving to, or None.
        together: number of episodes that the agent can run at once; more than 1 requires ``begin``
            and ``act_all``.
        encoders: maps a sensor to the names of the parts that read it; used by ``see``
            (:class:`Seeing`).
        labels: maps a sensor to the entry of a world's ``truth()`` that holds the labels for
            training these parts.
        loss_weights: weights of the auxiliary losses by name; 1 by default.
        frozen: names of modules that are never trained, such as a pretrained backbone; adapters
            inside them are trained.
        plain_walks: whether ``collect`` returns plain data (dicts, lists, strings, numbers and
            tensors), which DAgger stores on disk.
        run_state: attributes of a shipped agent that change while it runs. The fingerprint excludes
            these attributes, and all attributes that a newly built agent does not have.
        own_config_only: constructor arguments that name code or files. A config that comes with
            weights must not set these arguments.
        brings_weights: whether the constructor loads pretrained weights, so that the agent can be
            evaluated without a checkpoint.
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
    brings_weights: bool = False

    def reset(self, instruction: str) -> None:
        """Start an episode.

        Shipped agents raise TypeError if ``instruction`` is not a string.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no reset(instruction)")

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """Return the next low-level action.

        Shipped agents raise RuntimeError if ``reset`` was not called first. They raise KeyError,
        TypeError or ValueError if the observation is invalid (``agents/observation.py``).
        """
        raise NotImplementedError(f"{type(self).__name__} defines no act(observation)")

    def begin(self, instruction: str) -> Any:
        """Return the memory of a new episode; at most ``together`` episodes run in parallel."""
        raise NotImplementedError(f"{type(self).__name__} defines no begin(instruction)")

    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Any]
    ) -> list[int]:
        """Return one action per episode, and update the memories of the episodes.

        The action for one episode must not depend on the other episodes or on their number.

        Args:
            observations: the current observation of each of n episodes, where n is at most
                ``together``.
            memories: the memory of each episode, from :meth:`begin`.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no act_all(...)")

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Update the agent's state after a motion that the agent did not choose itself.

        The agent drops its plan.

        Args:
            action: the action that is most similar to the motion, or -1 if no action is similar.
            metres: distance moved forward.
            radians: angle turned to the left.
        """

    def episode_figures(self, memory: Any) -> Mapping[str, float]:
        """Return additional numbers by name, for the result row of a finished episode.

        Args:
            memory: the memory that ``begin`` returned, or None if the episode was started with
                ``reset``.
        """
        return {}

    def remembering(self) -> AbstractContextManager:
        """Return a context in which identical frames are encoded only once.

        The context does not change any action.
        """
        return nullcontext()

    def precompute(self, piece: Any, *, clean: bool) -> Any:
        """Return ``piece``, a result of ``collect``, with precomputed outputs of frozen layers.

        Worker processes call this method. With ``clean``, also precompute the values that
        ``decide(clean=True)`` needs.
        """
        return piece

    def as_teacher(self) -> Any:
        """Return a copy of the agent without its adapters."""
        teacher = copy.deepcopy(self)
        remove_adapters(teacher)  # type: ignore[arg-type]
        return teacher


class SideBySide(Agent):
    """Base class of agents that can run several episodes at once (``together``).

    A subclass defines ``begin`` and ``answers``.
    """

    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Any]
    ) -> list[int]:
        # the batch is always filled up to ``together``, so that sums are rounded identically
        padding = self.together - len(memories)
        observations = [*observations, *[observations[-1]] * padding]
        return self.answers(observations, [*memories, *[memories[-1]] * padding], len(memories))

    def answers(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Any], count: int
    ) -> list[int]:
        """Return the actions of the first ``count`` episodes and update their memories."""
        raise NotImplementedError(f"{type(self).__name__} defines no answers(...)")


def check_started(started: bool) -> None:
    """Raise RuntimeError if ``reset`` has not been called yet."""
    if not started:
        raise RuntimeError("Start the episode first: agent.reset(instruction).")


# members that :class:`_AgentView` looks up at each access, because their values may change
_READ_LATER = ("reset", "act", "system_prompt", "aim")
OPTIONAL = [name for name in vars(Agent) if not name.startswith("_") and name not in _READ_LATER]


def as_agent(agent: Any) -> Agent:
    """Return ``agent`` if it is an :class:`Agent`, otherwise a wrapper that adds the defaults.

    The agent itself is not changed. Fingerprints are computed from the agent, not from the wrapper.
    """
    return agent if isinstance(agent, Agent) else _AgentView(agent)


class _AgentView(Agent):
    """Wrapper that turns an object of any class into an :class:`Agent`."""

    def __init__(self, agent: Any) -> None:
        self._agent = agent
        take_over(self, agent, OPTIONAL)
        if missing_members(agent, ("begin", "act_all")):
            self.together = 1

    @property
    def system_prompt(self) -> str | None:
        return read(self._agent, "system_prompt")  # the attribute may be set later

    @system_prompt.setter
    def system_prompt(self, text: str | None) -> None:
        self._agent.system_prompt = text

    @property
    def aim(self) -> np.ndarray | None:  # type: ignore[override]
        return read(self._agent, "aim")  # the value changes from step to step

    def reset(self, instruction: str) -> None:
        self._agent.reset(instruction)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        return self._agent.act(observation)

    def as_teacher(self) -> Any:
        return Agent.as_teacher(self._agent)


def stated_settings(agent: Any) -> dict[str, Any] | None:
    """Return the settings of ``agent`` as a dict, or None if the agent has no settings.

    The member ``settings`` of an agent may be a method or a mapping.
    """
    settings = read(agent, "settings")
    return None if settings is None else dict(settings() if callable(settings) else settings)


@dataclass
class Output:
    """The output of an agent for B decisions.

    Attributes:
        logits: [B, n], one logit per candidate of each decision, or None if there are no decisions.
            Candidates that must not be chosen have -inf.
        features: features by name, which distillation compares between student and teacher.
        losses: auxiliary losses of the agent, as scalars by name.
        figures: additional scalars to log, by name.
    """

    logits: Tensor | None = None
    features: dict[str, Tensor] = field(default_factory=dict)
    losses: dict[str, Tensor] = field(default_factory=dict)
    figures: dict[str, Tensor] = field(default_factory=dict)


def check_logits(logits: Tensor, agent: Any) -> Tensor:
    """Return ``logits`` [..., n] if an action can be chosen from them; -inf marks forbidden
    actions.

    Without this check, argmax would silently return the first action, STOP.

    Raises:
        ValueError: If a logit is NaN or +inf, or no action is allowed.
    """
    valid = torch.isfinite(logits.amax(-1))
    if not valid.all():
        first_invalid = logits[~valid][0] if logits.ndim > 1 else logits
        numbers = ", ".join(f"{value:g}" for value in first_invalid.flatten()[:8].tolist())
        raise ValueError(
            f"Logits of {type(agent).__name__} must be finite for allowed actions and -inf for "
            f"the others, got {numbers}. Check its outputs for NaN."
        )
    return logits


def entropy_of(logits: Tensor) -> Tensor:
    """Return the entropy of the distribution with ``logits`` [n]; -inf marks forbidden actions."""
    chances = logits[torch.isfinite(logits)].log_softmax(-1)
    return -(chances.exp() * chances).sum()


def stop_figures(logits: Tensor, target: Tensor) -> dict[str, Tensor]:
    """Return the recall of STOP and the rate of false STOPs; ``target`` is as in ``Decisions``."""
    stop = target[:, STOP] > 0
    chosen = logits.argmax(-1) == STOP
    return {
        "stop_recall": (chosen & stop).sum() / stop.sum().clamp(min=1),
        "false_stop": (chosen & ~stop).sum() / (~stop).sum().clamp(min=1),
    }


def sample(probabilities: np.ndarray, rng: np.random.Generator) -> int:
    """Return a random index with probabilities proportional to ``probabilities`` [n]."""
    total = np.cumsum(probabilities.astype(np.float64))
    return int(min(np.searchsorted(total, rng.random() * total[-1], side="right"), len(total) - 1))


class Decisions(Protocol):
    """A batch of B decisions with the expert's answers; each agent adds its own fields.

    Attributes:
        target: [B, n], a distribution over the candidates of each decision, summing to 1.
        weight: [B], the weight of each decision.
        episode_ids: the episode of each decision, for the error message if a loss is not finite.
    """

    target: Tensor
    weight: Tensor
    episode_ids: list[str]

    def to(self, device: Any) -> Any: ...


@dataclass
class Batch:
    """Base class of batches of decisions.

    A subclass is a dataclass whose fields are tensors, dicts of tensors, or plain data.
    """

    def to(self, device: Any) -> Any:
        """Return a copy of the batch with all tensors on ``device``.

        This includes tensors in dicts.
        """

        def moved(value: Any) -> Any:
            if isinstance(value, dict):
                return type(value)({name: moved(item) for name, item in value.items()})
            return value.to(device) if isinstance(value, Tensor) else value

        return replace(self, **{name: moved(value) for name, value in vars(self).items()})


@runtime_checkable
class Trainable(Protocol):
    """The interface of an agent that objectives can train.

    Such an agent is an :class:`Agent` and an ``nn.Module``.
    """

    def parts(self) -> dict[str, nn.Module]:
        """Return the modules that can be frozen, trained and adapted, by name.

        Together, the modules hold all parameters of the agent.
        """

    def collect(
        self,
        worlds: Sequence[World],
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
        clean: bool = False,
    ) -> Any:
        """Run ``episodes[i]`` in ``worlds[i]`` and return the decisions with the expert's answers.

        The method is called in eval mode without gradients. The result must be picklable.

        Args:
            worlds: one world per episode.
            episodes: the episodes.
            expert_share: fraction of steps that take the expert's action; the other actions are
                sampled from the agent's policy (DAgger).
            rngs: one random generator per episode, so that an episode does not depend on the
                others.
            clean: also keep the observations before corruption (``observation.clean``).
        """

    def join(self, pieces: Sequence[Any]) -> Decisions:
        """Join the results of several calls of :meth:`collect` into one batch."""

    def decide(self, decisions: Any, *, clean: bool = False) -> Output:
        """Return the agent's output for ``decisions``.

        With ``clean``, the inputs are the observations before corruption. The candidate actions are
        the same as without ``clean``.
        """


@runtime_checkable
class KnowsEntropy(Protocol):
    """An agent that can compute the entropy of its decisions, which test-time adaptation lowers."""

    def entropy(self, observation: Mapping[str, np.ndarray]) -> Tensor | None:
        """Return the entropy of the last decision, computed again with gradients.

        Args:
            observation: the argument of the last ``act``.

        Returns:
            A scalar in nats; None if the last ``act`` made no decision.
        """


@runtime_checkable
class Seeing(Protocol):
    """A trainable agent whose encoders can be trained on single observations, without episodes.

    Attributes:
        encoders: maps a sensor to the names of the parts that read it.
        labels: maps a sensor to the entry of a world's ``truth()`` that holds the training labels.
    """

    encoders: Mapping[str, tuple[str, ...]]
    labels: Mapping[str, str]

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """Return the features "views" [P, V, F] of frames [P, V, H, W, c].

        If ``truth`` is given, also return the loss "labels".
        """
