"""Closed-loop evaluation: every agent meets the same episodes and the same random keys.

An episode is run alone, so its result does not depend on how many run beside it; rows are written
as they come, and an interrupted evaluation continues where it stopped. The conditions of an episode
run in one process, which keeps what it rendered and what the agent encoded: equal frames give equal
features, so no row depends on what was kept. An agent that can (``together``, ``agents/agent.py``)
walks several at once.
"""

from __future__ import annotations

import multiprocessing
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar

import torch

from mitigate.agents.agent import Agent, as_agent
from mitigate.agents.networks import in_eval_mode, networks
from mitigate.agents.observation import check_fits
from mitigate.cluster.launcher import LauncherConfig, count, results
from mitigate.core import output
from mitigate.core import workers as processes
from mitigate.core.checkpoint import check_finite, weights_sha
from mitigate.core.names import counted
from mitigate.core.output import FolderLostError
from mitigate.core.precision import computing
from mitigate.core.progress import Progress
from mitigate.corruptions import SUITE_VERSION, Corruption
from mitigate.corruptions.language.text import is_english, passed_through
from mitigate.corruptions.registry import parts, version
from mitigate.evaluation import rows
from mitigate.evaluation.episode import run_episode, run_side_by_side, start_of
from mitigate.evaluation.provenance import Known, check_classes
from mitigate.guards.guard import NO_GUARDS, Guards
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, as_world

WORTH = 40  # episodes that make a process worth its start (ours): 4 s of 0.1 s each
LOCAL = LauncherConfig()  # workers of this machine
_PAUSE = 1.0  # seconds between two writes, at least

Job = tuple[Episode, Corruption, dict[str, Any]]  # the last: what the row says besides measures


@dataclass
class EpisodeTask:
    """Runs jobs (``mitigate/core/workers.py``): each one's result is its label with its measures.

    make_world: each process makes one. A label holds "seed". classes: of ``Known``, which a worker
    process compares with its own.
    """

    agent: Any
    make_world: Callable[[], World]
    guards: Guards = NO_GUARDS
    world: World | None = None
    classes: str = ""
    preload: ClassVar[str] = "mitigate.evaluation.evaluator"

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "world": None}

    @contextmanager
    def ready(self) -> Iterator[None]:
        """One thread for torch, and fp32 whoever calls: results are then the same in any number of
        processes, and inside a training in bf16. The agent's networks are in eval mode, and as they
        were afterwards."""
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        self.world = self.world or self.make_world()
        if self.classes and multiprocessing.parent_process() is not None:
            check_classes(self.agent, self.world, self.classes)
        device = next((p.device for p in _parameters(self.agent)), torch.device("cpu"))
        try:
            with computing("fp32", device), in_eval_mode(self.agent):
                yield
        finally:
            torch.set_num_threads(threads)

    def work(self, jobs: Sequence[Job]) -> Iterator[dict[str, Any]]:
        """Rows of ``jobs``, which should be of one episode: frames and features are kept."""
        assert self.world is not None, "work() is called while ready()"
        with as_agent(self.agent).remembering(), as_world(self.world).remembering():
            told = [(episode, condition, label["seed"]) for episode, condition, label in jobs]
            measured = self._measures(self.world, told)
            for (_, _, label), measures in zip(jobs, measured, strict=True):
                yield {**label, **measures}

    def _measures(
        self, world: Any, told: Sequence[tuple[Episode, Corruption, int]]
    ) -> Iterator[dict[str, Any]]:
        """Of (episode, corruption, seed) each, in order; one after the other if what all its walks
        share is changed: the agent's prompt by a corruption, or the agent by a guard."""
        count = _together(self.agent, world)
        prompted = any("white_box" in parts(corruption.name) for _, corruption, _ in told)
        if count > 1 and not prompted and not self.guards.adapts:
            worlds = [world, *(world.beside() for _ in range(count - 1))]
            yield from run_side_by_side(self.agent, worlds, told, self.guards)
            return
        for job in told:
            yield run_episode(self.agent, world, *job, self.guards)

    def name(self, job: Job) -> str:
        """The episode and its condition."""
        return f"episode {job[0].episode_id}, {job[1].name}"


def _together(agent: Any, world: Any) -> int:
    """How many episodes the agent walks at once in such worlds."""
    # one that a class inherits, or that is passed on from a world inside, may make other worlds
    own = "beside" in vars(type(world))
    return as_agent(agent).together if own else 1


def _parameters(agent: Any) -> Iterator[torch.nn.Parameter]:
    return (parameter for net in networks(agent) for parameter in net.parameters())


def evaluate(
    agent: Agent | torch.nn.Module,
    world: Callable[[], World],
    episodes: list[Episode],
    conditions: list[Corruption],
    *,
    name: str,
    out: Path,
    split: str,
    seed: int = 0,
    workers: int | None = 1,
    launcher: LauncherConfig = LOCAL,
    guards: Guards = NO_GUARDS,
    version: str | None = None,
    known: Known | None = None,
) -> list[dict[str, Any]]:
    """Evaluate an agent and return its rows, which are also in the file ``out``.

    Args: world: makes a world, in each process. conditions: corruptions to meet, ``CLEAN`` among
    them for PRS; "white_box" is left out with a warning if the agent has no ``system_prompt``.
    name: the table's column. split: what the rows say. seed: of the corruptions' keys. workers:
    processes, None: one a core if there is work for them; the rows do not depend on it, nor on the
    launcher, which says on which machines (``cluster/launcher.py``). guards: between the world and
    the agent (``guards/guard.py``). version: names what cannot be read of the agent, so that its
    rows can be reused (``agents/fingerprint.py``). known: the agent's fingerprint, if it was taken
    before. A row's ``agent`` is the fingerprint of the agent behind the sensors and guards.

    Raises ValueError if ``out`` holds rows of this fingerprint and the agent cannot be read
    completely; WorkersDied if worker processes die more than once; the rows so far are in ``out``.
    """
    out = Path(out)
    conditions = _applicable(agent, conditions, name)
    if isinstance(agent, torch.nn.Module):
        check_finite(agent, f"The weights of {name}")
    made = world()
    check_fits(agent, made.sensors, type(made).__name__)
    if known is None:
        known = Known(agent, made, guards.fingerprint(), version).check(out, name)
    label = {
        "agent": known.hash,
        "name": name,
        "split": split,
        "seed": seed,
        "suite": SUITE_VERSION,
        "rule": made.rule,
        **({"weights": weights_sha(agent)} if isinstance(agent, torch.nn.Module) else {}),
    }
    task = EpisodeTask(agent, world, guards, classes=known.classes)
    jobs = _jobs(episodes, conditions, label)
    with known:
        _run_missing(task, made, jobs, out, workers, launcher, f"{name}, {split}")
    found = _in_order(out, [rows.identity(job[2]) for job in jobs])
    if cut := rows.cuts(found):
        print(f"{name}: {cut}", flush=True)
    return found


def _run_missing(
    task: EpisodeTask,
    world: World,
    jobs: list[Job],
    out: Path,
    workers: int | None,
    launcher: LauncherConfig,
    title: str,
) -> None:
    """Run the jobs that have no row in ``out``, a group's in one process, and append their rows as
    they come."""
    finished = {rows.identity(row) for row in rows.read(out)} if out.exists() else set()
    todo = [job for job in jobs if rows.identity(job[2]) not in finished]
    _warn_of_languages(todo)
    if task.guards:
        task.guards = task.guards.prepared(
            [start_of(task.agent, episode, met, label["seed"]) for episode, met, label in todo]
        )
    if not todo:
        print(f"{title}: {counted(len(jobs), 'walk')}, all done before, in {out}", flush=True)
        return
    at_once = _together(task.agent, world)
    groups = _groups(todo, 4 * at_once if at_once > 1 else 1)
    started = min(count(launcher, workers, len(todo), WORTH), len(groups))
    with Progress(title, len(jobs), unit="walk", start=len(jobs) - len(todo)) as progress:
        if started > 1:
            progress.say(f"{title}: {started} {launcher.name} workers")
        try:
            _write(results(launcher, task, groups, started, progress), out, progress)
        except processes.WorkersDied as error:
            raise processes.WorkersDied(
                f"{error} The finished rows are in {out}: the same command goes on from there."
            ) from None


def _jobs(
    episodes: list[Episode], conditions: list[Corruption], label: dict[str, Any]
) -> list[Job]:
    """All jobs, episode by episode, each with what its row says besides the measures."""
    return [
        (
            episode,
            condition,
            {
                **label,
                "corruption": condition.name,
                "severity": condition.severity,
                **rows.of_episode(episode),
                **version(condition.name),
            },
        )
        for episode in episodes
        for condition in conditions
    ]


def _applicable(agent: Any, conditions: list[Corruption], name: str) -> list[Corruption]:
    """Return the conditions that the agent can meet, and warn of the others."""
    if as_agent(agent).system_prompt:
        return conditions
    kept = [condition for condition in conditions if "white_box" not in parts(condition.name)]
    if len(kept) < len(conditions):
        warnings.warn(
            f"white_box is not applicable to {name}: the agent has no system prompt to inject "
            "into. No rows are written for it, and it is no part of the PRS.",
            stacklevel=3,
        )
    return kept


def _warn_of_languages(jobs: list[Job]) -> None:
    """Warn of episodes whose instructions are to be corrupted and are not in English."""
    found = {
        episode.episode_id: episode.instruction.language
        for episode, condition, _ in jobs
        if "instruction" in condition.modalities and not is_english(episode.instruction.language)
    }
    if found:
        warnings.warn(passed_through(Counter(map(str, found.values()))), stacklevel=3)


def _groups(jobs: list[Job], least: int) -> list[list[Job]]:
    """The jobs of each episode, or of so many of them that they are ``least`` or more."""
    groups: list[list[Job]] = []
    for _, group in groupby(jobs, lambda job: job[0].episode_id):
        if groups and len(groups[-1]) < least:
            groups[-1] += group
        else:
            groups.append(list(group))
    return groups


def _write(found: Iterable[tuple[int, Any] | None], out: Path, progress: Progress) -> None:
    """Append rows to ``out`` every ``_PAUSE`` seconds, and whatever happens at the end."""
    fresh: list[dict[str, Any]] = []
    written = time.monotonic()
    try:
        for item in found:
            if item is not None:
                fresh.append(item[1])
                progress.advance()
            if fresh and time.monotonic() - written >= _PAUSE:
                done, fresh, written = fresh, [], time.monotonic()
                rows.append(out, done)
    finally:
        if fresh:
            rows.append(out, fresh)


def _in_order(out: Path, wanted: list[tuple]) -> list[dict[str, Any]]:
    """Return the ``wanted`` rows of ``out`` in that order, one per identity (``rows.unique``), and
    put them into it in the file, each in the place of one of them: the file is then the same for
    any number of processes. Raises FolderLostError if rows are missing."""
    if not wanted:
        return []
    order = {identity: number for number, identity in enumerate(wanted)}
    held = rows.read(out) if output.is_regular(out) else []
    missing = len(order.keys() - {rows.identity(row) for row in held})
    if missing:
        raise FolderLostError(
            f"{out} holds {len(order) - missing} of the {counted(len(order), 'row')} that were "
            "measured: another program removed or replaced the file during the evaluation. Run "
            "the same command again: it measures what is missing."
        )
    places = [place for place, row in enumerate(held) if rows.identity(row) in order]
    found = sorted((held[place] for place in places), key=lambda row: order[rows.identity(row)])
    if found != [held[place] for place in places]:
        for place, row in zip(places, found, strict=True):
            held[place] = row
        rows.write(out, held)
    return rows.unique(found)
