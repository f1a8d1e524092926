"""Evaluate agents in closed loop, all on the same episodes with the same random keys.

The result of an episode does not depend on other episodes. Each row is written as
soon as it is computed, and an interrupted evaluation resumes where it stopped. All conditions of an
episode run in one process, which caches renderings and features. Identical frames give identical
features, so the cache does not change results. An agent with ``together`` > 1 (``agents/agent.py``)
runs several episodes at once.
"""

from __future__ import annotations

import multiprocessing
import time
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

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
from mitigate.corruptions import SUITE_VERSION, Corruption, registry
from mitigate.corruptions.language.text import UNMARKED, is_english, passed_through
from mitigate.evaluation import rows
from mitigate.evaluation.episode import Run, run_episode, run_side_by_side, start_of
from mitigate.evaluation.provenance import Known, check_classes
from mitigate.guards.guard import NO_GUARDS, Guards
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, as_world

WORTH = 40  # minimum number of episodes per process (heuristic); at 0.1 s per episode they take 4 s
LOCAL = LauncherConfig()  # the default launcher: worker processes on this machine
_PAUSE = 1.0  # minimum seconds between two writes


class EpisodeJob(NamedTuple):
    """An episode to run under one condition.

    Attributes:
        episode: the episode.
        condition: the corruption.
        label: the entries of the result row, except the measures.
    """

    episode: Episode
    condition: Corruption
    label: rows.Row


@dataclass
class EpisodeTask:
    """A task for ``mitigate/core/workers.py`` that runs jobs and yields their result rows.

    Each process calls ``make_world``. The label of each job has the key "seed". ``classes`` is the
    hash ``Known.classes``, which each worker process compares with the hash of the classes that
    it loads. If a guard is continual, ``streams`` holds all jobs of each condition in order. For
    such a guard, finished episodes also run again, and their new results are discarded.
    """

    agent: Any
    make_world: Callable[[], World]
    guards: Guards = NO_GUARDS
    world: World | None = None
    classes: str = ""
    streams: dict[Corruption, list[EpisodeJob]] = field(default_factory=dict)
    preload: ClassVar[str] = "mitigate.evaluation.evaluator"

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "world": None}

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Use one torch thread, fp32 and eval mode inside the context.

        So the results do not depend on the number of processes or on the precision of a training
        run that calls the evaluation. Afterwards, the previous modes of the networks are restored.
        """
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        self.world = self.world or self.make_world()
        if self.classes and multiprocessing.parent_process() is not None:
            check_classes(self.agent, self.world, self.classes)
        parameters = (p for net in networks(self.agent).values() for p in net.parameters())
        device = next((p.device for p in parameters), torch.device("cpu"))
        try:
            with computing("fp32", device), in_eval_mode(self.agent):
                yield
        finally:
            torch.set_num_threads(threads)

    def work(self, jobs: Sequence[EpisodeJob]) -> Iterator[dict[str, Any]]:
        """Yield the rows of ``jobs``.

        The jobs should belong to one episode, because frames of an episode are cached.
        """
        assert self.world is not None, "work() is called while ready()"
        # a guard that adapts the agent makes cached features invalid
        agent_memory = nullcontext() if self.guards.adapts else as_agent(self.agent).remembering()
        repeated: Sequence[EpisodeJob] = ()
        if self.guards.continual:
            self.guards.restart()
            stream = self.streams[jobs[0].condition]
            unfinished = {rows.identity(job.label) for job in jobs}
            repeated = [job for job in stream if rows.identity(job.label) not in unfinished]
            jobs = stream
        with agent_memory, as_world(self.world).remembering():
            runs = [(job.episode, job.condition, job.label["seed"]) for job in jobs]
            measured = self._measures(self.world, runs)
            for job, measures in zip(jobs, measured, strict=True):
                if job not in repeated:
                    yield {**job.label, **measures}

    def _measures(self, world: Any, runs: Sequence[Run]) -> Iterator[rows.Row]:
        """Yield the measures of each (episode, corruption, seed), in order.

        Episodes run one after the other if a corruption changes the agent's prompt or a guard
        changes the agent.
        """
        at_once = _together(self.agent, world)
        prompted = any("white_box" in registry.parts(corruption.name) for _, corruption, _ in runs)
        if at_once > 1 and not prompted and not self.guards.adapts:
            worlds = [world, *(world.beside() for _ in range(at_once - 1))]
            return run_side_by_side(self.agent, worlds, runs, self.guards)
        return (run_episode(self.agent, world, *run, self.guards) for run in runs)

    def name(self, job: EpisodeJob) -> str:
        """Return a text that names the episode and its condition."""
        return f"episode {job.episode.episode_id}, {job.condition.name}"


def _together(agent: Any, world: Any) -> int:
    """Return how many episodes the agent can run at once in worlds of this kind."""
    # an inherited ``beside()`` may return worlds of another class, so it is not used
    defined = "beside" in vars(type(world))
    return as_agent(agent).together if defined else 1


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
    """Evaluate an agent, write its rows to the file ``out``, and return them.

    The entry ``agent`` in a row is the fingerprint of the agent, including its sensors and guards.
    Rows do not depend on ``workers`` or ``launcher``.

    Args:
        agent: any object with the interface in ``agents/agent.py``.
        world: function that constructs a world in each process.
        episodes: the episodes.
        conditions: the corruptions, including ``CLEAN`` for the PRS. "white_box" is skipped with a
            warning if the agent has no ``system_prompt``.
        name: column of the table.
        out: file of the rows.
        split: name of the split in the rows.
        seed: corruption seed.
        workers: number of processes; None means one per core if there is enough work.
        launcher: where the workers run (``cluster/launcher.py``).
        guards: guards between the world and the agent (``guards/guard.py``).
        version: string that the user chooses for an agent whose state cannot be read completely.
            Rows with the same string are reused (``agents/fingerprint.py``).
        known: the agent's fingerprint, if it was computed earlier.

    Raises:
        ValueError: If ``out`` already holds rows of this fingerprint, but the agent's state cannot
            be read completely.
        WorkersDied: If worker processes died more than once; ``out`` holds the finished rows.
    """
    conditions = _applicable(agent, conditions, name)
    if isinstance(agent, torch.nn.Module):
        check_finite(agent, f"The weights of {name}")
    first = world()
    check_fits(agent, first.sensors, type(first).__name__)
    guards.check_agent(agent)
    if known is None:
        known = Known(agent, first, guards.fingerprint(), version).check(out, name)
    label = label_of(known.hash, name, split, seed, first)
    if isinstance(agent, torch.nn.Module):
        label["weights"] = weights_sha(agent)
    task = EpisodeTask(agent, world, guards, world=first, classes=known.classes)
    jobs = jobs_of(episodes, conditions, label)
    with known:
        measured = run_missing(task, jobs, out, f"{name}, {split}", workers, launcher)
    if cut := rows.cuts(measured):
        print(f"{name}: {cut}", flush=True)
    return measured


def run_missing(
    task: EpisodeTask,
    jobs: list[EpisodeJob],
    out: Path,
    title: str,
    workers: int | None = 1,
    launcher: LauncherConfig = LOCAL,
) -> list[dict[str, Any]]:
    """Run the jobs without a row in ``out`` and append their rows; return the rows of all jobs.

    The world of ``task`` must already be constructed. Each group of jobs runs in one process.
    Raises as :func:`evaluate`.
    """
    identities = [rows.identity(job.label) for job in jobs]
    finished = {rows.identity(row) for row in rows.read(out)} if out.exists() else set()
    todo = [job for job, identity in zip(jobs, identities, strict=True) if identity not in finished]
    _warn_of_languages(todo)
    if task.guards:
        task.guards = task.guards.prepared(
            [start_of(task.agent, job.episode, job.condition, job.label["seed"]) for job in todo]
        )
    if not todo:
        print(f"{title}: {counted(len(jobs), 'episode')}, all already done, in {out}", flush=True)
        return _in_order(out, identities)
    at_once = _together(task.agent, task.world)
    if task.guards.continual:
        task.streams = _by_condition(jobs)
        groups = [*_by_condition(todo).values()]
    else:
        groups = _groups(todo, 4 * at_once if at_once > 1 else 1)
    started = min(count(launcher, workers, len(todo), WORTH), len(groups))
    with Progress(title, len(jobs), unit="episode", start=len(jobs) - len(todo)) as progress:
        if started > 1:
            progress.say(f"{title}: {started} {launcher.name} workers")
        try:
            _write(results(launcher, task, groups, started, progress), out, progress)
        except processes.WorkersDied as error:
            raise processes.WorkersDied(
                f"{error} The finished rows are in {out}. Run the same command again to continue."
            ) from None
    return _in_order(out, identities)


def label_of(agent: str, name: str, split: str, seed: int, world: World) -> rows.Row:
    """Return the entries that all rows of an agent share; ``agent`` is its hash."""
    ids = {"agent": agent, "name": name, "split": split, "seed": seed}
    return {**ids, "suite": SUITE_VERSION, "rule": world.rule}


def jobs_of(
    episodes: list[Episode], conditions: list[Corruption], label: dict[str, Any]
) -> list[EpisodeJob]:
    """Return all jobs in the order of episodes.

    Each job contains the entries of its row, except the measures.
    """

    def row(episode: Episode, condition: Corruption) -> rows.Row:
        applied = {"corruption": condition.name, "severity": condition.severity}
        versions = registry.version(condition.name)
        return {**label, **applied, **rows.of_episode(episode), **versions}

    return [
        EpisodeJob(episode, condition, row(episode, condition))
        for episode in episodes
        for condition in conditions
    ]


def _applicable(agent: Any, conditions: list[Corruption], name: str) -> list[Corruption]:
    """Return the conditions that apply to the agent, and warn about other conditions."""
    prompted = as_agent(agent).system_prompt
    applicable = [
        condition
        for condition in conditions
        if prompted or "white_box" not in registry.parts(condition.name)
    ]
    if len(applicable) < len(conditions):
        warnings.warn(
            f"white_box is not applicable to {name}, which has no system prompt: it gets no rows.",
            stacklevel=3,
        )
    return applicable


def _warn_of_languages(jobs: list[EpisodeJob]) -> None:
    """Warn about instructions that should be corrupted but are not in English."""
    languages = {
        job.episode.episode_id: job.episode.instruction.language or UNMARKED
        for job in jobs
        if "instruction" in job.condition.modalities
        and not is_english(job.episode.instruction.language, job.episode.instruction.text)
    }
    if languages:
        warnings.warn(passed_through(Counter(map(str, languages.values()))), stacklevel=3)


def _by_condition(jobs: list[EpisodeJob]) -> dict[Corruption, list[EpisodeJob]]:
    """Return the jobs of each condition, in the order of ``jobs``."""
    streams: dict[Corruption, list[EpisodeJob]] = defaultdict(list)
    for job in jobs:
        streams[job.condition].append(job)
    return streams


def _groups(jobs: list[EpisodeJob], least: int) -> list[list[EpisodeJob]]:
    """Return groups of at least ``least`` jobs. The jobs of an episode are in the same group."""
    groups: list[list[EpisodeJob]] = []
    for _, group in groupby(jobs, lambda job: job.episode.episode_id):
        if groups and len(groups[-1]) < least:
            groups[-1] += group
        else:
            groups.append(list(group))
    return groups


def _write(items: Iterable[tuple[int, Any] | None], out: Path, progress: Progress) -> None:
    """Append rows to ``out`` every ``_PAUSE`` seconds and at the end, even after an error."""
    pending: list[dict[str, Any]] = []
    last_write = time.monotonic()
    try:
        for item in items:
            if item is not None:
                _, row = item
                pending.append(row)
                progress.advance()
            if pending and time.monotonic() - last_write >= _PAUSE:
                # reset before the write, so that ``finally`` does not repeat a failed write
                done, pending = pending, []
                last_write = time.monotonic()
                rows.append(out, done)
    finally:
        if pending:
            rows.append(out, pending)


def _in_order(out: Path, identities: list[tuple]) -> list[dict[str, Any]]:
    """Rewrite ``out`` so that its rows with these ``identities`` are in the order of
    ``identities``; return these rows (``rows.unique``).

    As a result, the order of rows in the file does not depend on the number of processes. All other
    rows keep their positions in the file.

    Raises:
        FolderLostError: If rows are missing.
    """
    order = {identity: number for number, identity in enumerate(identities)}
    stored = rows.read(out) if output.is_regular(out) else []
    missing = len(order.keys() - {rows.identity(row) for row in stored})
    if missing:
        raise FolderLostError(
            f"{out} holds {len(order) - missing} of the {counted(len(order), 'row')} that were "
            "measured: another program removed or replaced the file. Run the same command again."
        )
    ours = [row for row in stored if rows.identity(row) in order]
    ordered = sorted(ours, key=lambda row: order[rows.identity(row)])
    if ordered != ours:
        following = iter(ordered)
        merged = [next(following) if rows.identity(row) in order else row for row in stored]
        rows.write(out, merged)
    return rows.unique(ordered)
