"""Run episodes in a world, with corruptions and guards, and return their measures."""

from __future__ import annotations

import operator
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from mitigate.agents.agent import Agent, as_agent
from mitigate.core.contracts import missing_members
from mitigate.core.errors import error_message, own_place
from mitigate.core.seeding import seeded
from mitigate.core.spaces import ActionSpace
from mitigate.corruptions import (
    Corruption,
    Key,
    NotApplicable,
    corrupt_instruction,
    inject_system_prompt,
)
from mitigate.corruptions.language.text import is_english
from mitigate.corruptions.registry import parts
from mitigate.evaluation.rows import MEASURES
from mitigate.guards.guard import NO_GUARDS, EpisodeStart, Guards, guarded
from mitigate.worlds.episodes import Episode
from mitigate.worlds.motion import with_motion
from mitigate.worlds.world import Corrupted, World

Run = tuple[Episode, Corruption, int]  # the episode, the corruption and the corruption seed
MOST_STEPS = 100_000  # maximum steps of an episode (heuristic: 200 times VLN-CE's limit of 500)


def run_episode(
    agent: Agent,
    world: World,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    guards: Guards = NO_GUARDS,
) -> dict[str, Any]:
    """Run one episode with ``guards`` and return its measures.

    The measure ``decisions`` is the number of observations that the agent read. The global random
    generators are set from the seed and the episode id, so an agent or a world that uses them gives
    the same measures in any process, and under every corruption it draws the same numbers.

    Raises:
        ValueError: If a step failed, if an action is not an integer, or if the agent or the world
            raised SystemExit. The message names the episode, the condition and the step.
    """
    run = episode, corruption, seed
    with _no_exit(_name(run)), seeded(seed, "episode", episode.episode_id):
        rollout = _Rollout(world, run, guards)
        with instructed(agent, *run, guards), rollout.errors_named():
            while not rollout.done:
                rollout.step(agent.act(rollout.observation), agent)
        return {**rollout.measures(), **as_agent(agent).episode_figures(None)}


def _name(run: Run) -> str:
    return f"Episode {run[0].episode_id}, {run[1].name}"


@contextmanager
def _no_exit(name: str) -> Iterator[None]:
    """Raise ValueError instead of SystemExit, which would look like a finished evaluation."""
    try:
        yield
    except SystemExit as error:
        place = own_place(error)
        raise ValueError(
            f"{name}: the agent or the world raised SystemExit({error.code!r})"
            f"{f' in {place}' if place else ''}. Raise another error, or end the episode."
        ) from error


def action_of(answer: Any, agent: Any, space: ActionSpace | None = None) -> Any:
    """Convert ``answer``, the return value of ``agent.act``, to an action in ``space``.

    If ``space`` is None, actions are integers.

    Raises:
        ValueError: If the answer is not an action of the space.
    """
    if space is not None:
        try:
            return space.check(answer)
        except ValueError as error:
            raise ValueError(f"act() of {type(agent).__name__}: {error_message(error)}") from None
    try:
        return operator.index(answer)
    except TypeError:
        text = " ".join(repr(answer).split())[:80]
        raise ValueError(
            f"act() of {type(agent).__name__} must return a whole number, got {text} "
            f"({type(answer).__name__}). Return, for example, int(logits.argmax())."
        ) from None


def run_side_by_side(
    agent: Agent,
    worlds: Sequence[World],
    runs: Sequence[Run],
    guards: Guards = NO_GUARDS,
) -> Iterator[dict[str, Any]]:
    """Run the episodes, and yield their measures in order.

    The number of episodes that run at once equals the number of worlds. The measures equal
    the measures of :func:`run_episode`. ``guards`` must not contain guards that change the agent.
    """
    waiting, free = deque(enumerate(runs)), list(worlds)
    running: dict[int, tuple[_Rollout, World, Any]] = {}
    measured: dict[int, dict[str, Any]] = {}
    for number in range(len(runs)):
        while number not in measured:
            while waiting and free:
                started, run = waiting.popleft()
                world = free.pop()
                with _no_exit(_name(run)):
                    memory = agent.begin(guards.begin(start_of(agent, *run)))
                    running[started] = _Rollout(world, run, guards), world, memory
            ended = [key for key, (rollout, _, _) in running.items() if rollout.done]
            for key in ended:
                rollout, world, memory = running.pop(key)
                with _no_exit(rollout.name):
                    figures = as_agent(agent).episode_figures(memory)
                    measured[key] = {**rollout.measures(), **figures}
                free.append(world)
            if not ended:
                rollouts, _, memories = zip(*running.values(), strict=True)
                with _no_exit(" and ".join(rollout.name for rollout in rollouts)):
                    actions = agent.act_all([r.observation for r in rollouts], memories)
                for rollout, action in zip(rollouts, actions, strict=True):
                    with _no_exit(rollout.name), rollout.errors_named():
                        rollout.step(action, agent)
        yield measured.pop(number)


class _Rollout:
    """A running episode; ``observation`` is the agent's current observation."""

    def __init__(self, world: World, run: Run, guards: Guards) -> None:
        episode, corruption, seed = run
        self.name = _name(run)
        self.steps = 0
        self.corrupted = Corrupted(with_motion(world, corruption, seed), corruption, seed)
        space = self.corrupted.action_space
        self.space = space if isinstance(space, ActionSpace) else None
        self.guarded = guarded(self.corrupted, guards)
        self.observation = self.guarded.reset(episode)

    @property
    def done(self) -> bool:
        return self.corrupted.done

    def step(self, answer: Any, agent: Agent) -> None:
        """Take the step that ``agent`` chose. Raises ValueError after :data:`MOST_STEPS` steps."""
        action = action_of(answer, agent, self.space)
        if self.steps >= MOST_STEPS:
            raise ValueError(
                f"the world has not ended the episode after {MOST_STEPS:,} steps. Let its task end "
                "it (gymnasium: max_episode_steps=), or set limit=."
            )
        self.observation = self.guarded.step(action)
        self.steps += 1

    @contextmanager
    def errors_named(self) -> Iterator[None]:
        """Add the episode, the condition and the step to the message of a ValueError."""
        try:
            yield
        except ValueError as error:
            text = f"{self.name}, step {self.steps + 1}: {error_message(error)}"
            raise ValueError(text) from error

    def measures(self) -> dict[str, Any]:
        """Return the measures as plain numbers, in the order of ``MEASURES``."""
        frames_read = self.corrupted.frames_read
        values: dict[str, Any] = {**self.corrupted.measures(), "decisions": frames_read}
        # NumPy scalars and arrays have the method ``item``, which returns a plain number.
        plain = {n: v if missing_members(v, ("item",)) else v.item() for n, v in values.items()}
        values = {n: int(v) if isinstance(v, bool) else v for n, v in plain.items()}
        if values.get("success", 0) not in (0, 1):
            raise ValueError(
                f"{self.name}: measures() of the world must return success 0 or 1, got "
                f"{values['success']!r:.40}."
            )
        return {name: values.pop(name) for name in MEASURES if name in values} | values


def instruction(episode: Episode, corruption: Corruption, seed: int) -> str:
    """Return the instruction of ``episode`` under ``corruption``.

    Instructions in other languages are not corrupted.
    """
    text, key = episode.instruction.text, Key(seed, episode.episode_id)
    for part in corruption.parts if is_english(episode.instruction.language, text) else ():
        if part.modality == "instruction" and part.name != "white_box":
            text = corrupt_instruction(text, part.name, part.severity, key)
    return text


def start_of(agent: Agent, episode: Episode, corruption: Corruption, seed: int) -> EpisodeStart:
    """Return what guards receive before an episode: the corrupted instruction and prompt.

    Raises:
        ValueError: If "white_box" is used with an agent that has no system prompt.
    """
    key = Key(seed, episode.episode_id)
    prompt = as_agent(agent).system_prompt
    if "white_box" in parts(corruption.name):
        injected = inject_system_prompt(prompt, corruption.severity, key)
        if isinstance(injected, NotApplicable):
            raise ValueError(f"'white_box' is not applicable: {injected.reason}.")
        prompt = injected
    return EpisodeStart(key, instruction(episode, corruption, seed), prompt)


@contextmanager
def instructed(
    agent: Agent,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    guards: Guards = NO_GUARDS,
) -> Iterator[None]:
    """Reset the agent with the instruction that was corrupted and then filtered by the guards.

    Inside the ``with`` block, the agent has the corrupted prompt, and guards are attached to it.
    """
    contract = as_agent(agent)
    prompt = contract.system_prompt
    start = start_of(agent, episode, corruption, seed)
    try:
        if start.system_prompt != prompt:
            contract.system_prompt = start.system_prompt
        with guards.attach(agent):
            agent.reset(guards.begin(start))
            yield
    finally:
        if prompt is not None:
            contract.system_prompt = prompt
