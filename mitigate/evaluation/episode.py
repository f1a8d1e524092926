"""Episodes in a world: what the agent hears and sees, and how well it went."""

from __future__ import annotations

import operator
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from mitigate.agents.agent import Agent, as_agent
from mitigate.core.errors import said
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
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.frames.world import Restored
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import Corrupted, World

MOST_STEPS = 100_000  # of an episode (heuristic: 200 times the 500 of VLN-CE)


def run_episode(
    agent: Agent,
    world: World,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    repaired: Mapping[str, str] | None = None,
    restorer: Restorer | None = None,
) -> dict[str, Any]:
    """Run one episode to its end and return its measures, with ``decisions``: how often the agent
    looked.

    ``repaired``: what a safeguard makes of instructions; one that is not in it stays as it is.
    ``restorer``: goes over the frames before the agent reads them. A ValueError out of a step names
    the episode, the condition and the step; one is raised for an action that is no whole number.
    """
    walk = _Walk(world, episode, corruption, seed, restorer)
    with instructed(agent, episode, corruption, seed, repaired):
        try:
            while not walk.done:
                walk.step(action_of(agent.act(walk.observation), agent))
        except ValueError as error:
            raise walk.failed(error) from error
    return walk.measures()


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
    repaired: Mapping[str, str] | None = None,
    restorer: Restorer | None = None,
) -> Iterator[dict[str, Any]]:
    """Run (episode, corruption, seed) of each job, as many at a time as there are worlds, and yield
    their measures in order, as :func:`run_episode` gives them."""
    waiting, free = deque(enumerate(jobs)), list(worlds)
    under_way: dict[int, tuple[_Walk, World, Any]] = {}
    measured: dict[int, dict[str, Any]] = {}
    for number in range(len(jobs)):
        while number not in measured:
            while waiting and free:
                begun, job = waiting.popleft()
                world, text = free.pop(), instruction(*job)
                memory = agent.begin((repaired or {}).get(text, text))
                under_way[begun] = _Walk(world, *job, restorer), world, memory
            ended = [key for key, (walk, _, _) in under_way.items() if walk.done]
            for key in ended:
                walk, world, _ = under_way.pop(key)
                measured[key] = walk.measures()
                free.append(world)
            if not ended:
                walks, _, memories = zip(*under_way.values(), strict=True)
                actions = agent.act_all([walk.observation for walk in walks], memories)
                for walk, action in zip(walks, actions, strict=True):
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
        restorer: Restorer | None,
    ) -> None:
        self.name, self.steps = f"Episode {episode.episode_id}, {corruption.name}", 0
        self.met = Corrupted(world, corruption, seed)
        self.shown: World = self.met if restorer is None else Restored(self.met, restorer)
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
        found = {**self.met.measures(), "decisions": self.met.looks}
        plain = {n: v.item() if hasattr(v, "item") else v for n, v in found.items()}  # arrays
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


@contextmanager
def instructed(
    agent: Agent,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    repaired: Mapping[str, str] | None = None,
) -> Iterator[None]:
    """Reset the agent with the instruction, and the prompt, that the corruption leaves it; within
    the block it has that prompt. ``repaired`` as :func:`run_episode`."""
    text, key = instruction(episode, corruption, seed), Key(seed, episode.episode_id)
    contract = as_agent(agent)
    prompt = contract.system_prompt
    try:
        if "white_box" in parts(corruption.name):
            injected = inject_system_prompt(prompt, corruption.severity, key)
            if isinstance(injected, NotApplicable):
                raise ValueError(f"'white_box' is not applicable: {injected.reason}.")
            contract.system_prompt = injected
        agent.reset((repaired or {}).get(text, text))
        yield
    finally:
        if prompt is not None:
            contract.system_prompt = prompt
