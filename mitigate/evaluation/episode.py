"""Episodes in a world: what the agent hears and sees, and how well it went."""

from __future__ import annotations

import operator
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from mitigate.agents.agent import Agent, as_agent
from mitigate.core.contracts import lacking
from mitigate.core.errors import own_place, said
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
from mitigate.worlds.world import Corrupted, World

MOST_STEPS = 100_000  # of an episode (heuristic: 200 times the 500 of VLN-CE)


def run_episode(
    agent: Agent,
    world: World,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    guards: Guards = NO_GUARDS,
) -> dict[str, Any]:
    """Run one episode behind ``guards`` to its end and return its measures, with ``decisions``: how
    many observations the agent read.

    A ValueError out of a step names the episode, the condition and the step; one is raised for an
    action that is no whole number, and for a SystemExit of the agent or the world.
    """
    with _no_exit(_name(episode, corruption)):
        walk = _Walk(world, episode, corruption, seed, guards)
        with instructed(agent, episode, corruption, seed, guards):
            try:
                while not walk.done:
                    walk.step(action_of(agent.act(walk.observation), agent))
            except ValueError as error:
                raise walk.failed(error) from error
        return walk.measures()


def _name(episode: Episode, corruption: Corruption) -> str:
    return f"Episode {episode.episode_id}, {corruption.name}"


@contextmanager
def _no_exit(name: str) -> Iterator[None]:
    """Raise ValueError in place of a SystemExit, which would end the evaluation as if it were
    finished."""
    try:
        yield
    except SystemExit as error:
        place = own_place(error)
        raise ValueError(
            f"{name}: the agent or the world ended the program by SystemExit({error.code!r})"
            f"{f' (raised in {place})' if place else ''}, and the evaluation is not finished. "
            "Raise an error in its place, or end the episode."
        ) from error


def action_of(answer: Any, agent: Any) -> int:
    """What ``agent`` answered as an action. Raises ValueError for what is no whole number."""
    try:
        return operator.index(answer)
    except TypeError:
        shown = " ".join(repr(answer).split())[:80]
        raise ValueError(
            f"act() of {type(agent).__name__} returned {shown} ({type(answer).__name__}), which is "
            "no action: return a whole number, such as int(logits.argmax())."
        ) from None


def run_side_by_side(
    agent: Agent,
    worlds: Sequence[World],
    jobs: Sequence[tuple[Episode, Corruption, int]],
    guards: Guards = NO_GUARDS,
) -> Iterator[dict[str, Any]]:
    """Run (episode, corruption, seed) of each job, as many at a time as there are worlds, and yield
    their measures in order, as :func:`run_episode` gives them. No guard may change the agent."""
    waiting, free = deque(enumerate(jobs)), list(worlds)
    under_way: dict[int, tuple[_Walk, World, Any]] = {}
    measured: dict[int, dict[str, Any]] = {}
    for number in range(len(jobs)):
        while number not in measured:
            while waiting and free:
                begun, job = waiting.popleft()
                world = free.pop()
                with _no_exit(_name(*job[:2])):
                    memory = agent.begin(guards.begin(start_of(agent, *job)))
                    under_way[begun] = _Walk(world, *job, guards), world, memory
            ended = [key for key, (walk, _, _) in under_way.items() if walk.done]
            for key in ended:
                walk, world, _ = under_way.pop(key)
                with _no_exit(walk.name):
                    measured[key] = walk.measures()
                free.append(world)
            if not ended:
                walks, _, memories = zip(*under_way.values(), strict=True)
                with _no_exit(" and ".join(walk.name for walk in walks)):
                    actions = agent.act_all([walk.observation for walk in walks], memories)
                for walk, action in zip(walks, actions, strict=True):
                    with _no_exit(walk.name):
                        try:
                            walk.step(action_of(action, agent))
                        except ValueError as error:
                            raise walk.failed(error) from error
        yield measured.pop(number)


class _Walk:
    """An episode under way, and what the agent sees of it: ``observation``."""

    def __init__(
        self,
        world: World,
        episode: Episode,
        corruption: Corruption,
        seed: int,
        guards: Guards,
    ) -> None:
        self.name, self.steps = _name(episode, corruption), 0
        self.met = Corrupted(world, corruption, seed)
        self.shown = guarded(self.met, guards)
        self.observation = self.shown.reset(episode)

    @property
    def done(self) -> bool:
        return self.met.done

    def step(self, action: int) -> None:
        """Take a step. Raises ValueError after :data:`MOST_STEPS` steps."""
        if self.steps >= MOST_STEPS:
            raise ValueError(
                f"the world has not ended the episode after {MOST_STEPS:,} steps. Let its own task "
                "end it (gymnasium: max_episode_steps=), or give limit=, which cuts episodes and "
                "counts them."
            )
        self.observation = self.shown.step(action)
        self.steps += 1

    def failed(self, error: ValueError) -> ValueError:
        """What is raised in place of an ``error`` of the agent or the world: it says where."""
        return ValueError(f"{self.name}, step {self.steps + 1}: {said(error)}")

    def measures(self) -> dict[str, Any]:
        found: dict[str, Any] = {**self.met.measures(), "decisions": self.met.frames_read}
        plain = {n: v if lacking(v, ("item",)) else v.item() for n, v in found.items()}  # arrays
        found = {n: int(v) if isinstance(v, bool) else v for n, v in plain.items()}
        return {name: found.pop(name) for name in MEASURES if name in found} | found


def instruction(episode: Episode, corruption: Corruption, seed: int) -> str:
    """Return the words of ``episode`` as ``corruption`` leaves them; those of another language than
    English stay."""
    text, key = episode.instruction.text, Key(seed, episode.episode_id)
    for part in corruption.parts if is_english(episode.instruction.language) else ():
        if part.modality == "instruction" and part.name != "white_box":
            text = corrupt_instruction(text, part.name, part.severity, key)
    return text


def start_of(agent: Agent, episode: Episode, corruption: Corruption, seed: int) -> EpisodeStart:
    """Return what guards know of an episode: its instruction, and the agent's prompt, as the
    corruption leaves them. Raises ValueError for "white_box" without a prompt."""
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
    """Reset the agent with the instruction that the corruption and ``guards`` leave it. Within the
    block it has the corrupted prompt, and guards are attached to it."""
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
