"""Define the interface of guards, which change the inputs of an agent at run time.

A guard may change the instruction of an episode (``begin``), the frames of an observation
(``observe``), or the agent itself while an episode runs (``attach``). The default implementation of
each method changes nothing. Examples of guards are the safeguard (for text), the restorer (for
frames), users' callables, and the methods of test-time adaptation. ``opening.py`` builds them from
the options ``safeguard=``, ``restore=`` and ``adapt=``.

This module does not need torch.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from mitigate.core.observation import DEPTH, RGB, Observation
from mitigate.corruptions import Key
from mitigate.worlds.world import World, WorldWrapper

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mitigate.worlds.episodes import Episode

RESTORER = "restorer-"  # prefix of the fingerprints of guards from ``restore=``


@dataclass(frozen=True)
class EpisodeStart:
    """The information that a guard receives when an episode begins."""

    key: Key  # seed and episode id, for random numbers
    instruction: str  # the instruction after corruption
    system_prompt: str | None = None  # the agent's system prompt after corruption, or None


class Guard:
    """Base class of guards; its methods change nothing unless a subclass overrides them.

    An episode's result must not depend on other episodes or on their order. So a guard that
    remembers earlier frames must override ``for_episode``. A guard that overrides ``attach`` may
    keep state in the agent; with such a guard, episodes run one after the other.

    Attributes:
        label: part of a table's column name.
        frames: names of the sensors whose frames ``observe`` reads or changes.
        version: text that identifies state which :meth:`fingerprint` cannot read, such as weights
            in a file.
        continual: whether ``attach`` uses state from earlier episodes. With a continual guard, the
            episodes of a condition run in order in one process.
    """

    label: str = ""
    frames: Sequence[str] = (RGB, DEPTH)
    version: str | None = None
    continual: bool = False

    def begin(self, episode: EpisodeStart) -> str:
        """Return the instruction that the agent receives."""
        return episode.instruction

    def begin_all(self, episodes: Sequence[EpisodeStart]) -> list[str]:
        """Return the instruction for each episode; a subclass may process them as one batch."""
        return [self.begin(episode) for episode in episodes]

    def observe(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the observation that the agent receives.

        Only frames may differ from ``observation``. The arrays in ``observation`` must not be
        changed in place.
        """
        return observation

    def for_episode(self) -> Guard:
        """Return the guard for one episode.

        A guard that remembers earlier frames must override this method, and return a new guard that
        remembers nothing yet. The method ``observe`` of such a guard is called at every step, even
        if the agent does not read the frames.
        """
        return self

    def attach(self, agent: Any) -> AbstractContextManager:
        """Return a context manager that adapts ``agent`` for one episode.

        When the context ends, the changes to the agent must be undone.
        """
        return nullcontext()

    def restart(self) -> None:
        """Forget all earlier episodes. Continual guards are restarted before each condition."""

    def calibrate(self, agent: Any, world: World, episode: Callable[[int], Episode]) -> None:
        """Measure properties of the agent that the guard needs; called before the evaluation.

        Args:
            agent: the agent.
            world: a world, without corruptions.
            episode: function that returns a training episode, given its number.
        """

    def check_agent(self, agent: Any) -> None:
        """Raise ValueError if the guard cannot adapt ``agent``."""

    def prepared(self, episodes: Sequence[EpisodeStart]) -> Guard:
        """Return the guard to send to the worker processes that run these episodes.

        A guard with a large model can compute all its answers here, so that workers need no model.
        """
        return self

    def fingerprint(self) -> str:
        """Return a content hash that identifies this guard in rows.

        The hash covers the class, the weights, ``settings()`` and ``version``. For a user's class,
        it also covers the code. If the class does not define ``settings()`` itself, the hash also
        covers the attributes.

        Raises:
            ValueError: If the hash cannot cover all of the guard, and ``version`` is None.
        """
        from mitigate.agents.fingerprint import contents, hash_of

        content = contents(self, self.version)
        kind = type(self).__name__
        if content.unreadable:
            raise ValueError(
                f"The fingerprint of a {kind} must cover all of it, but {content.explain()} cannot "
                "be read. Give the guard a `version` attribute, and change it whenever the guard's "
                "behaviour changes."
            )
        return f"{kind}-{hash_of(content.parts, {})}"

    def check_shown(self, sensors: Collection[str], where: str) -> None:
        """Raise ValueError if ``sensors`` has none of the ``frames`` that this guard changes."""
        if overrides(self, "observe") and not set(self.frames) & {*sensors}:
            raise ValueError(
                f"The guard {self.label or type(self).__name__} is for {', '.join(self.frames)}, "
                f"but {where} shows {', '.join(sensors) or 'no frames'}: omit restore=."
            )


def overrides(guard: Guard, method: str) -> bool:
    """Return whether the class of ``guard`` overrides ``method``."""
    return getattr(type(guard), method) is not getattr(Guard, method)


class Guards(Guard):
    """A chain of guards, in which each guard receives the result of the previous one."""

    def __init__(self, guards: Iterable[Guard] = ()) -> None:
        self.guards = tuple(guards)
        self.label = "+".join(guard.label for guard in self.guards if guard.label)

    def __bool__(self) -> bool:
        return bool(self.guards)

    def _overriding(self, method: str) -> list[Guard]:
        return [guard for guard in self.guards if overrides(guard, method)]

    @property
    def frames(self) -> tuple[str, ...]:  # type: ignore[override]
        """The sensors whose frames at least one guard reads or changes."""
        names = (name for guard in self._overriding("observe") for name in guard.frames)
        return tuple(dict.fromkeys(names))

    @property
    def adapts(self) -> bool:
        """Whether at least one guard changes the agent."""
        return bool(self._overriding("attach"))

    def begin(self, episode: EpisodeStart) -> str:
        return self.begin_all([episode])[0]

    def begin_all(self, episodes: Sequence[EpisodeStart]) -> list[str]:
        for guard in self.guards:
            episodes = _with(episodes, guard.begin_all(episodes))
        return [episode.instruction for episode in episodes]

    def observe(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        for guard in self.guards:
            observation = guard.observe(observation)
        return observation

    @property
    def remembers(self) -> bool:
        """Whether a guard remembers earlier frames of the episode."""
        return bool(self._overriding("for_episode"))

    def for_episode(self) -> Guards:
        if not self.remembers:
            return self
        return Guards(guard.for_episode() for guard in self.guards)

    @property
    def continual(self) -> bool:  # type: ignore[override]
        """Whether at least one guard uses state from earlier episodes."""
        return any(guard.continual for guard in self.guards)

    @contextmanager
    def attach(self, agent: Any) -> Iterator[None]:
        with ExitStack() as stack:
            for guard in self.guards:
                stack.enter_context(guard.attach(agent))
            yield

    def restart(self) -> None:
        for guard in self.guards:
            guard.restart()

    def calibrate(self, agent: Any, world: World, episode: Callable[[int], Episode]) -> None:
        for guard in self.guards:
            guard.calibrate(agent, world, episode)

    def check_agent(self, agent: Any) -> None:
        for guard in self.guards:
            guard.check_agent(agent)

    def prepared(self, episodes: Sequence[EpisodeStart]) -> Guards:
        guards = []
        for guard in self.guards:
            guards.append(guard.prepared(episodes))
            episodes = _with(episodes, guards[-1].begin_all(episodes))
        return Guards(guards)

    def fingerprint(self) -> str:
        """Return the fingerprints of all guards, joined by "+".

        If no guard changes the instruction, the text starts with "none". If there are no guards at
        all, the text is only "none".
        """
        words = [] if self._overriding("begin") else ["none"]
        return "+".join([*words, *(guard.fingerprint() for guard in self.guards)])

    def frames_hash(self) -> str | None:
        """Return the fingerprints of all guards that change frames, joined by "+".

        The prefix of a restorer's fingerprint is removed. If no guard changes frames, return None.
        """
        fingerprints = [guard.fingerprint() for guard in self._overriding("observe")]
        return "+".join(part.removeprefix(RESTORER) for part in fingerprints) or None

    def check_shown(self, sensors: Collection[str], where: str) -> None:
        for guard in self.guards:
            guard.check_shown(sensors, where)


def _with(episodes: Sequence[EpisodeStart], instructions: Sequence[str]) -> list[EpisodeStart]:
    """Return copies of ``episodes`` with other instructions."""
    pairs = zip(episodes, instructions, strict=True)
    return [replace(episode, instruction=instruction) for episode, instruction in pairs]


NO_GUARDS = Guards()


class Guarded(WorldWrapper):
    """World wrapper in which guards change the frames.

    The guard runs only when the agent reads a frame, so frames that are not read cost nothing. A
    guard that remembers frames receives all of them. ``observation.clean`` does not change.
    """

    def __init__(self, world: World, guards: Guards) -> None:
        super().__init__(world)
        self.guards = guards
        self.episode_guards = guards  # :meth:`Guard.for_episode` of the current episode

    def reset(self, episode: Episode) -> Observation:
        self.episode_guards = self.guards.for_episode()
        return super().reset(episode)

    def _observe(self, observation: Observation) -> Observation:
        @cache
        def guarded_frames() -> dict[str, Any]:
            changed = self.episode_guards.observe(dict(observation))
            return {name: changed[name] for name in observation.frames}

        if self.guards.remembers:
            guarded_frames()  # even if the agent reads no frame in this step
        ready, names = observation.ready, observation.frames
        return Observation(ready, guarded_frames, names, clean=observation.clean)


def guarded(world: World, guards: Guards) -> World:
    """Wrap ``world`` so that ``guards`` change its frames; if no guard does, return ``world``."""
    return Guarded(world, guards) if guards.frames else world
