"""One episode in a world: what the agent hears and sees, and how well it went."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from mitigate.agents.agent import Agent
from mitigate.corruptions import (
    Corruption,
    Key,
    NotApplicable,
    corrupt_instruction,
    inject_system_prompt,
)
from mitigate.corruptions.registry import parts
from mitigate.evaluation.rows import MEASURES
from mitigate.restoration.restorer import Restorer
from mitigate.restoration.world import Restored
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import Corrupted, World


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
    ``restorer``: goes over the frames before the agent reads them.
    """
    met = Corrupted(world, corruption, seed)
    shown: World = met if restorer is None else Restored(met, restorer)
    observation = shown.reset(episode)
    with instructed(agent, episode, corruption, seed, repaired):
        while not met.done:
            observation = shown.step(agent.act(observation))
    found = {**met.measures(), "decisions": met.looks}
    return {name: found.pop(name) for name in MEASURES if name in found} | found


def instruction(episode: Episode, corruption: Corruption, seed: int) -> str:
    """Return the words of ``episode`` as ``corruption`` leaves them."""
    text, key = episode.instruction.text, Key(seed, episode.episode_id)
    for part in corruption.parts:
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
    prompt = getattr(agent, "system_prompt", None)
    try:
        if "white_box" in parts(corruption.name):
            injected = inject_system_prompt(prompt, corruption.severity, key)
            if isinstance(injected, NotApplicable):
                raise ValueError(f"'white_box' is not applicable: {injected.reason}.")
            agent.system_prompt = injected  # type: ignore[attr-defined]
        agent.reset((repaired or {}).get(text, text))
        yield
    finally:
        if prompt is not None:
            agent.system_prompt = prompt  # type: ignore[attr-defined]
