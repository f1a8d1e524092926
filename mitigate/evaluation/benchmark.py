"""Define ``mitigate.benchmark(agent)``, which evaluates an agent under the suite in one call."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from types import EllipsisType
from typing import Any

from mitigate.agents.agent import as_agent
from mitigate.agents.building import agent_option
from mitigate.agents.networks import in_eval_mode
from mitigate.agents.observation import check_fits
from mitigate.agents.policies.module import Forward
from mitigate.agents.policies.wrapping import as_policy, is_policy
from mitigate.cluster.launcher import count
from mitigate.core import conf, seeding
from mitigate.core.build import locate, maker
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted, file_name
from mitigate.core.observation import DEPTH, RGB, sensor_lines
from mitigate.core.options import without_config_folder
from mitigate.core.progress import duration, say
from mitigate.core.workers import ALONE, packed
from mitigate.corruptions import CLEAN, Corruption, registry
from mitigate.evaluation import evaluate as evaluation
from mitigate.evaluation import provenance
from mitigate.evaluation.comparison import RANDOM, Comparison, RandomPolicy, compare
from mitigate.evaluation.config import EvaluateConfig, read
from mitigate.evaluation.critical import check_losses, first_conditions, search
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.episode_lists import (
    check_count,
    check_episodes,
    episode_list,
    spread,
    training_episodes,
)
from mitigate.evaluation.evaluator import LOCAL, WORTH, evaluate
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry, check_texts
from mitigate.evaluation.leaderboard.figures import entry_of
from mitigate.evaluation.provenance import Known
from mitigate.evaluation.rows import ROWS
from mitigate.guards.guard import Guard
from mitigate.guards.opening import labels, open_guards
from mitigate.worlds.episodes import Episode, read_episodes
from mitigate.worlds.seeded import RETURN
from mitigate.worlds.world import Corrupted, World

# default number of episodes (heuristic); a success rate then has an error of about 17 points
EPISODES = 20
OUT = Path("runs/benchmark")
# number of clean episodes that are run first (heuristic); the last one is timed for the estimate
TIMED = 2
# options that the argument ``options`` may contain
OPTION = re.compile(r"[+~]*(agent|env)[.=]|--config-dir\b")


def benchmark(
    agent: Any,
    *,
    forward: Forward | None = None,
    recurrent: bool = False,
    name: str | None = None,
    version: str | None = None,
    split: str | None = None,
    episodes: int | EllipsisType | None = ...,
    suite: str | Sequence[str] = "full",
    severity: float = 0.6,
    critical: Sequence[float] | None = None,
    seed: int = 0,
    safeguard: str | None = None,
    restore: str | None = None,
    adapt: str | Guard | None = None,
    workers: int | None = 1,
    options: Sequence[str] = (),
    world: Callable[[], World] | None = None,
    listed: Sequence[Episode] | Path | str | None = None,
    training_data: str = "",
    link: str = "",
    out: Path | str | None = None,
) -> LeaderboardEntry | Comparison:
    """Evaluate ``agent`` on clean frames and under a suite of corruptions; return its leaderboard
    entry.

    The function first prints how long the evaluation will take. It writes the result rows to
    ``out``; if it is interrupted, the same call continues from these rows.

    Args:
        agent: an object with the interface in ``mitigate/agents/agent.py``, the path of a file or
            folder with weights, or a policy of a supported library (``mitigate/agents/policies/``).
        forward: function that calls an ``nn.Module``
            (:class:`~mitigate.agents.policies.module.ModulePolicy`).
        recurrent: whether ``agent`` is an ``nn.Module`` that keeps state between steps.
        name: heading of the leaderboard entry; the default is the name of the folder with the
            weights, or of the agent's class.
        version: label for state of the agent that mitigate cannot inspect, such as hooks. Choose a
            new one whenever this state changes. Without a version, rows of such an agent are not
            reused.
        split: name of an episode list of the world. The default is the world's usual list. If you
            pass your own world, this is only a label for the episodes in ``listed``; the default is
            the name of the world's class.
        episodes: number of episodes, which are spread evenly over the list. None means all
            episodes, as for the leaderboard. The default is 20 episodes of a split, or all episodes
            in ``listed``.
        suite: a name in ``conf/suite`` or a list of corruptions.
        severity: severity of the corruptions, from 0 to 1.
        critical: fractions of the clean success rate, such as (0.1, 0.5). The call then also
            searches for the severities at which these fractions are lost. It prints the severities
            and writes them to ``critical.md`` in ``out``. The search needs more episodes than the
            printed estimate says.
        seed: corruption seed.
        safeguard: input guard for instructions, such as "classifier" or "http://host/v1@model".
        restore: input guard for frames, such as "checkpoints/restorer" or "module:callable".
        adapt: test-time adaptation: "norm", "tent" or "recentre", or a guard
            (``mitigate/guards/adaptation``). With the suffix ":never", the adaptation is never
            reset between episodes.
        workers: number of processes. None means one per core if there is enough work. With more
            than one worker, the call must be under ``if __name__ == "__main__":``, because each
            process imports the script.
        options: options of the agent and the world, such as "agent=recurrent", "env.views=1" and
            "--config-dir=mine".
        world: function that creates your world, which replaces the world in ``options``. If your
            world has a different class, ``listed`` is required.
        listed: the episodes, or the path of an episode file.
        training_data: text about the agent's training data, shown in the leaderboard entry.
        link: URL of the weights or the paper, shown in the leaderboard entry.
        out: folder for the rows; None means a folder in runs/benchmark.

    Returns:
        The leaderboard entry. If the world's score is "return", the result is instead a Comparison,
        which lists the returns and the fraction of the clean return that the agent keeps.

    Raises:
        ValueError: If the agent, an option or a text for the entry is invalid, or ``out`` contains
            rows of a different world.
        FileNotFoundError: If weights are missing.
    """
    config, met = _conditions(agent, suite, severity, seed, options)
    losses = None if critical is None else check_losses(critical)
    texts = {"training_data": training_data, "link": link}
    make_world = world or maker(config.env.world)
    first, made_by = checked_world(make_world, [] if isinstance(suite, str) else met, version)
    if isinstance(suite, str):
        met = _visible(met, first, suite)
    if losses is not None:
        met = first_conditions(met, first.rule)
    if forward is not None or recurrent or is_policy(agent):
        agent = as_policy(agent, first, forward=forward, recurrent=recurrent)
        name, version = name or agent.name, version or agent.version
    usual = type(agent).__name__
    if isinstance(agent, (str, Path)):
        usual = evaluation.name_of(str(agent))
        agent = evaluation.load(config.agent, str(agent), seed)
    evaluation.check_walks(agent)
    name = "+".join([name or usual, *labels(safeguard, restore, adapt)])
    check_texts(name=name, **texts)
    check_fits(agent, first.sensors, type(first).__name__)
    own_world = world is not None and _is_own(first, config)
    split, chosen = _episodes(first, config, split, episodes, listed, own_world)
    file = Path(out or OUT / f"{file_name(name)}-{split}-s{severity:g}") / ROWS
    guards = open_guards(safeguard, restore, first.sensors, adapt=adapt)
    training = None if own_world else config.env.training
    guards.calibrate(agent, first, training_episodes(first, training))
    known = Known(agent, first, guards.fingerprint(), version).check(file, name)
    measure = partial(evaluate, world=make_world, episodes=chosen, out=file, split=split, seed=seed)
    with known:
        _print_estimate(agent, first, make_world, chosen, met, workers)
        with FolderLock(file.parent) as lock:
            lock.expect(file, provenance.keep(file.parent, first, made_by, split, chosen))
            under = partial(measure, agent, name=name, known=known, workers=workers, guards=guards)
            rows = under(conditions=met) if losses is None else search(under, met, losses)
            if first.rule == RETURN:
                if first.action_space is None:
                    raise ValueError(
                        f"{type(first).__name__} must have the attribute action_space "
                        "(mitigate.core.spaces), because its returns are compared with the return "
                        "of random actions. Add this attribute to its class."
                    )
                random = RandomPolicy(first.action_space, seed)
                return compare([*rows, *measure(random, conditions=[CLEAN], name=RANDOM)])
    if losses is not None:
        evaluation.write_critical(rows, losses, file.parent)
    texts["file"] = "" if file.is_absolute() else file.as_posix()
    sensors = sensor_lines(first.sensors, as_agent(agent).sensors)
    return entry_of(rows, name, severity=severity, sensors=sensors, **texts)


def _conditions(
    agent: Any, suite: str | Sequence[str], severity: float, seed: int, options: Sequence[str]
) -> tuple[EvaluateConfig, list[Corruption]]:
    """Return the config of an evaluation, and the conditions of the suite with "clean" first."""
    seeding.check(seed)
    if isinstance(options, str) or not all(isinstance(one, str) for one in options or ()):
        raise ValueError(
            f"options must be a list of strings such as ['env=mine'], got {options!r:.80}."
        )
    options = [*(options or ())]
    folder = conf.config_folder(options)
    if folder is not None and not folder.is_dir():
        raise ValueError(f"--config-dir must name a folder, got {folder}, which does not exist.")
    for option in without_config_folder(options)[1]:
        if not OPTION.match(option):
            raise ValueError(
                f"{option} has no effect here: options= sets only the agent and its world (agent=, "
                "agent.size=, env=, env.views=, --config-dir=). Other settings are arguments, "
                'such as benchmark(agent, severity=0.3, suite="quick").'
            )
    if isinstance(agent, (str, Path)):
        options = [*options, *agent_option(options, str(agent))]
    options += [f"suite={suite}"] if isinstance(suite, str) else []
    config = read(conf.composed("evaluate", options))
    names = list(config.suite.conditions) if isinstance(suite, str) else list(suite)
    met = evaluation.conditions(["clean", *names], severity, None)
    if all(corruption.severity == 0 for corruption in met):
        raise ValueError(
            f"suite={suite!r} at severity {severity:g} has no effect. Name a suite or corruptions, "
            "and a severity above 0."
        )
    return config, met


def _visible(met: Sequence[Corruption], world: World, suite: str) -> list[Corruption]:
    """Return the conditions of a suite, except corruptions of sensors that the world lacks."""
    unseen = {RGB, DEPTH} - {*world.sensors}
    left_out = [
        one.name
        for one in met
        if any({*registry.record(part.name).modalities} <= unseen for part in one.parts)
    ]
    conditions = [one for one in met if one.name not in left_out]
    if all(one.severity == 0 for one in conditions):
        raise ValueError(
            f"suite={suite} must corrupt a sensor of the world, got {', '.join(world.sensors)}. "
            "Name another suite, such as rgb or depth, or a list of corruptions."
        )
    if left_out:
        say(f"benchmark: the world has no {' or '.join(unseen)}: left out {', '.join(left_out)}")
    return conditions


def checked_world(
    make_world: Any, met: Sequence[Corruption], version: str | None = None
) -> tuple[World, dict[str, str]]:
    """Construct a world; return it with a description of how it was constructed
    (``provenance.first_world``).

    Raises:
        ValueError: If ``make_world`` does not return a world, or if the world lacks a sensor that a
            condition corrupts.
    """
    if not callable(make_world):
        raise ValueError(
            f"world must be a function that creates a world, got a {type(make_world).__name__}. "
            "Each process creates its own world."
        )
    world, made_by = provenance.first_world(make_world, version)
    if not hasattr(world, "sensors"):  # the user may have passed any object by mistake
        kind = type(world).__name__
        raise ValueError(
            f"A {kind} is not a world: it has no sensors (docs/bring-your-own.md). Give "
            f"world=lambda: GymWorld({kind}(...), success=...) for a gymnasium environment "
            "(mitigate.worlds.gym), or EnvWorld for a torchrl one (mitigate.worlds.tensordict)."
        )
    cls = type(world)
    lacking = [
        name
        for name in ("reset", "step", "measures")
        if getattr(cls, name, getattr(world, name, None)) in (None, getattr(World, name))
    ]
    if lacking := lacking + ["rule"] * (not hasattr(world, "rule")):
        raise ValueError(
            f"{cls.__name__} must define {', '.join(lacking)} (docs/bring-your-own.md)."
        )
    evaluation.check_sensors(met, world.sensors, cls.__name__)
    return world, made_by


def _is_own(world: World, config: EvaluateConfig) -> bool:
    """Return whether the class of the world differs from the class in the config."""
    node = config.env.world
    target = locate(node["_target_"])
    # the target may be a function instead of a class
    kind = target if isinstance(target, type) else type(maker(node)())
    return not isinstance(world, kind)


def _episodes(
    world: World,
    config: EvaluateConfig,
    split: str | None,
    count: int | EllipsisType | None,
    listed: Sequence[Episode] | Path | str | None,
    is_own: bool,
) -> tuple[str, list[Episode]]:
    """Return the split and the episodes to run; ``is_own`` is the result of :func:`_is_own`."""
    split = split or (provenance.name_of(world) if is_own else config.split)
    if listed is None and is_own:
        raise ValueError(
            f"The episodes of {config.env.name} cannot run in {provenance.name_of(world)}. Pass "
            'episodes of your world: listed="mine.json", or a list of Episode (docs/bring-your-own'
            ".md). Episodes of gymnasium and torchrl are seeds: listed=seeded_episodes(range(20))."
        )
    if listed is None:
        return split, evaluation.episodes(config.env, split, EPISODES if count is ... else count)
    count = None if count is ... else count
    check_count(count)
    if isinstance(listed, Episode) or not isinstance(listed, (str, Path, Iterable)):
        raise ValueError(
            f"listed must be a list of episodes or the path of an episode file, got {listed!r:.80}."
        )
    source = read_episodes(listed) if isinstance(listed, (str, Path)) else listed
    entries = episode_list("listed", source)
    check_episodes("listed", entries)
    return split, spread(entries, count)


def seconds_per_episode(agent: Any, world: World, episodes: Sequence[Episode]) -> float:
    """Run ``TIMED`` clean episodes and return the seconds of the last one, because the first one
    also loads libraries.
    """
    with in_eval_mode(agent):
        for episode in episodes[:TIMED]:
            started = time.monotonic()
            run_episode(agent, world, episode, CLEAN, 0)
    return time.monotonic() - started


def _print_estimate(
    agent: Any,
    world: World,
    make_world: Callable[[], World],
    episodes: Sequence[Episode],
    conditions: Sequence[Corruption],
    workers: int | None,
) -> None:
    """Print the number of rollouts and a time estimate, measured on a few clean episodes."""
    total = len(episodes) * len(conditions)
    processes = min(count(LOCAL, workers, total, WORTH), len(episodes))
    if processes > 1:  # checked here, so that an error is raised before the timed episodes
        packed((agent, make_world), "The agent or its world", ALONE)
    for condition in conditions:  # this compiles the corruptions
        dict(Corrupted(world, condition, 0).reset(episodes[0]))
    each = seconds_per_episode(agent, world, episodes)
    grid = f"{counted(len(episodes), 'episode')} x {counted(len(conditions), 'condition')}"
    print(
        f"benchmark: {grid} = {counted(total, 'episode')} of about "
        f"{each:.2g} s on {processes} process{'es' * (processes > 1)}: about "
        f"{duration(each * total / processes)}",
        flush=True,
    )
