"""Closed-loop evaluation: every agent meets the same episodes and the same random keys.

An episode is run alone, so its result does not depend on how many run beside it; rows are appended
as they come, and an interrupted evaluation continues where it stopped.
"""

from __future__ import annotations

import multiprocessing
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from tqdm import tqdm

from mitigate.checkpoint import weights_sha
from mitigate.corruptions import (
    SUITE_VERSION,
    Corruption,
    Key,
    NotApplicable,
    corrupt_instruction,
    corrupt_observation,
    inject_system_prompt,
)
from mitigate.envs.apartments.simulator import Simulator
from mitigate.envs.apartments.tasks import SUCCESS_METRES, from_vlnce
from mitigate.envs.episodes import Episode
from mitigate.evaluation import metrics, rows
from mitigate.keys import DEPTH, POSE, RGB
from mitigate.safeguard.guard import Safeguard

_FLUSH = 20  # rows between two writes


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
) -> dict[str, Any]:
    """Run one episode to STOP or the step limit and return its measures.

    ``repaired``: what a safeguard makes of instructions; one that is not in it stays as it is.
    """
    simulator.reset(episode)
    with _instructed(agent, episode, corruption, seed, repaired or {}):
        return _walk(agent, simulator, episode, corruption, seed)


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
    agent: Agent, simulator: Simulator, episode: Episode, corruption: Corruption, seed: int
) -> dict[str, Any]:
    looks = 0

    def frames() -> dict[str, np.ndarray]:
        nonlocal looks
        looks += 1
        return corrupt_observation(
            simulator.observe(), corruption, Key(seed, episode.episode_id, looks - 1)
        )

    while not simulator.done:
        simulator.step(agent.act(LazyObservation(simulator.odometry()[POSE], frames)))
    return _measures(simulator, episode, looks)


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


def evaluate(
    agent: torch.nn.Module,
    episodes: list[Episode],
    conditions: list[Corruption],
    *,
    name: str,
    out: Path,
    split: str,
    seed: int = 0,
    workers: int = 1,
    size: int = 64,
    safeguard: Safeguard | None = None,
) -> list[dict[str, Any]]:
    """Evaluate an agent and return its rows, which are also in the file ``out``.

    Args: conditions: corruptions to meet, ``CLEAN`` among them for PRS; "white_box" is left out
    with a warning if the agent has no ``system_prompt``. name: the table's column.
    split: what the rows say. seed: of the corruptions' keys. workers: processes; the rows do not
    depend on it. size: pixels of a view. safeguard: repairs each instruction, once, before the
    agent hears it; ``name`` should say so.
    """
    conditions = _applicable(agent, conditions, name)
    known = {rows.identity(row) for row in rows.read(out)} if Path(out).exists() else set()
    label = {
        "agent": weights_sha(agent)[:12],
        "name": name,
        "split": split,
        "seed": seed,
        "suite": SUITE_VERSION,
        "rule": metrics.rule(SUCCESS_METRES),
    }
    jobs = [
        (
            episode,
            condition,
            {
                **label,
                "corruption": condition.name,
                "severity": condition.severity,
                "episode_id": episode.episode_id,
            },
        )
        for episode in episodes
        for condition in conditions
    ]
    todo = [job for job in jobs if rows.identity(job[2]) not in known]
    heard = [instruction(episode, condition, seed) for episode, condition, _ in todo]
    decided = [] if safeguard is None else safeguard.canonicalise_all(heard)
    repaired = {decision.original: decision.text for decision in decided}
    _run_all(agent, todo, repaired, Path(out), workers, size, f"{name} {split}")
    wanted = {rows.identity(job[2]) for job in jobs}
    return [row for row in rows.read(out) if rows.identity(row) in wanted]


def _applicable(agent: Any, conditions: list[Corruption], name: str) -> list[Corruption]:
    """Return the conditions that the agent can meet, and warn of the others."""
    if getattr(agent, "system_prompt", None):
        return conditions
    kept = [condition for condition in conditions if condition.name != "white_box"]
    if len(kept) < len(conditions):
        warnings.warn(
            f"white_box is not applicable to {name}: the agent has no system prompt to inject "
            "into. No rows are written for it, and it is no part of the PRS.",
            stacklevel=3,
        )
    return kept


def _run_all(
    agent: torch.nn.Module,
    jobs: list[tuple],
    repaired: dict[str, str],
    out: Path,
    workers: int,
    size: int,
    title: str,
) -> None:
    """Run the jobs in order of episode and append their rows to ``out`` as they come."""
    if workers > 1 and len(jobs) > workers:
        context = multiprocessing.get_context("spawn")
        with context.Pool(workers, _start_worker, (agent, repaired, size)) as pool:
            _collect(pool.imap(_work, jobs, chunksize=13), len(jobs), out, title)
    elif jobs:
        threads = torch.get_num_threads()
        _start_worker(agent, repaired, size)
        _collect(map(_work, jobs), len(jobs), out, title)
        torch.set_num_threads(threads)


def _collect(results: Any, total: int, out: Path, title: str) -> None:
    fresh: list[dict[str, Any]] = []
    with tqdm(total=total, desc=title, unit="episode", disable=None) as bar:
        for row in results:
            fresh.append(row)
            bar.update()
            if len(fresh) >= _FLUSH:
                rows.append(out, fresh)
                fresh = []
    if fresh:
        rows.append(out, fresh)


_WORKER: dict[str, Any] = {}


def _start_worker(agent: torch.nn.Module, repaired: dict[str, str], size: int) -> None:
    torch.set_num_threads(1)  # sums in the same order in any number of processes
    _WORKER.update(agent=agent.eval(), repaired=repaired, simulator=Simulator(size))


def _work(job: tuple[Episode, Corruption, dict[str, Any]]) -> dict[str, Any]:
    episode, condition, label = job
    agent, simulator = _WORKER["agent"], _WORKER["simulator"]
    measures = run_episode(agent, simulator, episode, condition, label["seed"], _WORKER["repaired"])
    return {**label, **measures}
