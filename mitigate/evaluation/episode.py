"""One episode in the simulator: what the agent hears and sees, and how well it walked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Protocol

import numpy as np

from mitigate.core.memory import Memory
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.corruptions import (
    Corruption,
    Key,
    NotApplicable,
    corrupt_instruction,
    corrupt_observation,
    inject_system_prompt,
)
from mitigate.evaluation import metrics
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import SUCCESS_METRES, from_vlnce
from mitigate.worlds.episodes import Episode

FRAMES = 1 << 26  # bytes of rendered frames kept for the conditions of an episode (ours)


class Agent(Protocol):
    """What can be evaluated: any object that turns observations into low-level actions.

    An agent that works with a prompt has it in an attribute ``system_prompt``, read at ``reset``.
    """

    def reset(self, instruction: str) -> None: ...
    def act(self, observation: Mapping[str, np.ndarray]) -> int: ...


class LazyObservation(Mapping[str, np.ndarray]):
    """An observation whose frames are rendered and corrupted only if the agent reads them."""

    def __init__(self, pose: np.ndarray, frames: Callable[[], dict[str, np.ndarray]]) -> None:
        self._values: dict[str, np.ndarray] = {POSE: pose}
        self._frames = frames

    def __getitem__(self, name: str) -> np.ndarray:
        if name in (RGB, DEPTH) and name not in self._values:
            self._values |= self._frames()
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter((POSE, RGB, DEPTH))

    def __len__(self) -> int:
        return 3


def run_episode(
    agent: Agent,
    simulator: Simulator,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    repaired: Mapping[str, str] | None = None,
    rendered: Memory | None = None,
) -> dict[str, Any]:
    """Run one episode to STOP or the step limit and return its measures.

    ``repaired``: what a safeguard makes of instructions; one that is not in it stays as it is.
    ``rendered``: keeps clean frames of this simulator, so that a pose met again is not rendered
    again; the measures do not depend on it.
    """
    rendered = Memory(0) if rendered is None else rendered
    simulator.reset(episode)
    with _instructed(agent, episode, corruption, seed, repaired or {}):
        return _walk(agent, simulator, episode, corruption, seed, rendered)


def instruction(episode: Episode, corruption: Corruption, seed: int) -> str:
    """Return the words of ``episode`` as ``corruption`` leaves them."""
    text = episode.instruction.text
    if corruption.modality != "instruction" or corruption.name == "white_box":
        return text
    key = Key(seed, episode.episode_id)
    return corrupt_instruction(text, corruption.name, corruption.severity, key)


@contextmanager
def _instructed(
    agent: Agent, episode: Episode, corruption: Corruption, seed: int, repaired: Mapping[str, str]
) -> Iterator[None]:
    """Reset the agent with the instruction, and the prompt, that the corruption leaves it."""
    text, key = instruction(episode, corruption, seed), Key(seed, episode.episode_id)
    prompt = getattr(agent, "system_prompt", None)
    try:
        if corruption.name == "white_box":
            injected = inject_system_prompt(prompt, corruption.severity, key)
            if isinstance(injected, NotApplicable):
                raise ValueError(f"{corruption.name!r} is not applicable: {injected.reason}.")
            agent.system_prompt = injected  # type: ignore[attr-defined]
        agent.reset(repaired.get(text, text))
        yield
    finally:
        if prompt is not None:
            agent.system_prompt = prompt  # type: ignore[attr-defined]


def _walk(
    agent: Agent,
    simulator: Simulator,
    episode: Episode,
    corruption: Corruption,
    seed: int,
    rendered: Memory,
) -> dict[str, Any]:
    looks = 0

    def frames() -> dict[str, np.ndarray]:
        nonlocal looks
        looks += 1
        clean = _clean(simulator, rendered)
        return corrupt_observation(clean, corruption, Key(seed, episode.episode_id, looks - 1))

    while not simulator.done:
        simulator.step(agent.act(LazyObservation(simulator.odometry()[POSE], frames)))
    return _measures(simulator, episode, looks)


def _clean(simulator: Simulator, rendered: Memory) -> dict[str, np.ndarray]:
    """The observation at the simulator's pose, as ``Simulator.observe`` gives it: copies of what is
    kept, so that an agent may write into its frames."""

    def render() -> tuple[np.ndarray, np.ndarray]:
        seen = simulator.observe()
        return seen[RGB], seen[DEPTH]

    pose = (float(simulator.xy[0]), float(simulator.xy[1]), float(simulator.heading))
    rgb, depth = rendered.recall((simulator.episode.scene_id, *pose), render)
    return {RGB: rgb.copy(), DEPTH: depth.copy(), **simulator.odometry()}


def _measures(simulator: Simulator, episode: Episode, decisions: int) -> dict[str, Any]:
    walked = np.array(simulator.path)
    length = metrics.path_length(walked)
    left = simulator.distance_to_goal()
    reference = np.stack([from_vlnce(p) for p in episode.reference_path])
    geodesic = float(episode.geodesic_distance or simulator.distance_to_goal(reference[0]))
    won = metrics.success(left, simulator.stopped, threshold=SUCCESS_METRES)
    return {
        "success": int(won),
        "spl": round(metrics.spl(won, geodesic, length), 6),
        "path_length": round(length, 4),
        "geodesic_distance": geodesic,
        "distance_to_goal": round(left, 4),
        "ndtw": round(metrics.ndtw(walked, reference, threshold=SUCCESS_METRES), 6),
        "collisions": int(simulator.collisions),
        "decisions": decisions,
        "steps": simulator.steps,
    }
