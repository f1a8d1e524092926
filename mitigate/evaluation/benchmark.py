"""``mitigate.benchmark(agent)``: an agent under the suite, in one call; returns its entry."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from types import EllipsisType
from typing import Any

from hydra.errors import HydraException
from omegaconf.errors import OmegaConfBaseException

from mitigate.agents.agent import as_agent
from mitigate.agents.building import agent_option
from mitigate.agents.networks import in_eval_mode
from mitigate.agents.observation import check_fits
from mitigate.cluster.launcher import count
from mitigate.core import conf, seeding
from mitigate.core.build import located, maker
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted
from mitigate.core.observation import sensor_lines
from mitigate.core.options import without_config_folder
from mitigate.core.progress import duration
from mitigate.core.workers import packed
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import evaluate as evaluation
from mitigate.evaluation import provenance
from mitigate.evaluation.config import EvaluateConfig, read
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.episode_lists import check_count, check_episodes, spread
from mitigate.evaluation.evaluator import LOCAL, WORTH, evaluate
from mitigate.evaluation.leaderboard.entry import LeaderboardEntry, check_texts
from mitigate.evaluation.leaderboard.figures import entry_of
from mitigate.evaluation.provenance import Known
from mitigate.evaluation.rows import ROWS
from mitigate.guards.opening import labels, open_guards
from mitigate.worlds.episodes import Episode, read_episodes
from mitigate.worlds.world import Corrupted, World

EPISODES = 20  # of a first look (ours): an SR is then known to about 17 points
OUT = Path("runs/benchmark")
TIMED = 2  # clean walks, by the last of which the time is told (ours)
OPTION = re.compile(r"[+~]*(agent|env)[.=]|--config-dir\b")  # what options= may name


def benchmark(
    agent: Any,
    *,
    name: str | None = None,
    version: str | None = None,
    split: str | None = None,
    episodes: int | EllipsisType | None = ...,
    suite: str | Sequence[str] = "full",
    severity: float = 0.6,
    seed: int = 0,
    safeguard: str | None = None,
    restore: str | None = None,
    workers: int | None = 1,
    options: Sequence[str] = (),
    world: Callable[[], World] | None = None,
    listed: Sequence[Episode] | Path | str | None = None,
    training_data: str = "",
    link: str = "",
    out: Path | str | None = None,
) -> LeaderboardEntry:
    """Evaluate ``agent`` clean and under a suite of corruptions, and return its entry.

    It says first how long that takes. The rows are in ``out``; the same call goes on with them.

    Args:
        agent: any object of the contract (``mitigate/agents/agent.py``), or a path of weights.
        name: heading of the entry; None: of the weights' folder, or the agent's class. version:
            names what cannot be read of the agent (hooks); without it its rows are not reused.
        split: list of episodes of the world; None: its own first, or the name of your own world.
            episodes: how many, spread over the list; None: all, as entries have; unless told, 20 of
            a split's, and all that are ``listed``.
        suite: a name of ``conf/suite`` or a list of corruptions. severity: from 0 to 1. seed: of
            the corruptions. workers: processes; None: one a core if there is work. More than one
            read the script again, which keeps its call under ``if __name__ == "__main__":``.
        safeguard, restore: guards in front of the agent: "rules", "checkpoints/restorer",
            "module:callable".
        options: of its kind and the world: "agent=recurrent", "env.views=1", "--config-dir=mine".
        world, listed: makes a world of your own, and its episodes (or their file), in place of
            those of ``options``; a world of another class than theirs needs both.
        training_data, link: for the entry. out: folder of the rows; None: one in runs/benchmark.
    Raises ValueError for no agent, what there is not, texts that an entry cannot hold and a folder
    with rows of another world, FileNotFoundError for missing weights.
    """
    config, met = _conditions(agent, suite, severity, seed, options)
    told = {"training_data": training_data, "link": link}
    agent, name = _agent(agent, name, config, seed, labels(safeguard, restore))
    check_texts(name=name, **told)
    made = world or maker(config.env.world)
    first, made_by = _first_world(made, met, agent, version)
    split, chosen = _episodes(first, config, split, episodes, listed, world is not None)
    file = Path(out or OUT / f"{_plain(name)}-{split}-s{severity:g}") / ROWS
    guards = open_guards(safeguard, restore, first.sensors)
    known = Known(agent, first, guards.fingerprint(), version).check(file, name)
    label: dict[str, Any] = {"name": name, "split": split, "seed": seed, "known": known}
    with known:
        _tell(agent, made, chosen, met, workers)
        with FolderLock(file.parent) as lock:
            provenance.keep(file.parent, first, made_by, split, chosen)
            lock.expect(file, *provenance.notes(file.parent, split))
            rows = evaluate(
                agent, made, chosen, met, out=file, workers=workers, guards=guards, **label
            )
    told["file"] = "" if file.is_absolute() else file.as_posix()
    shown = sensor_lines(first.sensors, as_agent(agent).sensors)
    return entry_of(rows, name, severity=severity, sensors=shown, **told)


def _conditions(
    agent: Any, suite: str | Sequence[str], severity: float, seed: int, options: Sequence[str]
) -> tuple[EvaluateConfig, list[Corruption]]:
    """Return the config of an evaluation, for the kind of agent that a path of weights is of, and
    the conditions of the suite, clean first."""
    seeding.check(seed)
    if isinstance(options, str) or not all(isinstance(one, str) for one in options or ()):
        raise ValueError(f"options is a list of options ['env=mine'], not {options!r:.80}.")
    options = [*(options or ())]
    folder = conf.config_folder(options)
    if folder is not None and not folder.is_dir():
        raise ValueError(f"There is no folder {folder}, which --config-dir names.")
    for option in without_config_folder(options)[1]:
        if not OPTION.match(option):
            raise ValueError(
                f"{option} has no effect here: options= are those of the agent and its world "
                "(agent=..., agent.size=..., env=..., env.views=1, --config-dir=...). All else is "
                'an argument of benchmark, such as severity=0.3, suite="quick" or '
                'restore="checkpoints/restorer".'
            )
    if isinstance(agent, (str, Path)):
        options = [*options, *agent_option(options, str(agent))]
    named = [f"suite={suite}"] if isinstance(suite, str) else []
    try:
        config = read(conf.load_config("evaluate", [*options, *named]))
    except (HydraException, OmegaConfBaseException) as error:
        raise ValueError(conf.explain(error, "evaluate", [*options, *named])) from None
    names = list(config.suite.conditions) if isinstance(suite, str) else list(suite)
    met = evaluation.conditions(list(dict.fromkeys(["clean", *names])), severity, None)
    if all(corruption.severity == 0 for corruption in met):
        raise ValueError(
            f"suite={suite!r} at severity {severity:g} corrupts nothing: name a suite or "
            "corruptions, and a severity above 0."
        )
    return config, met


def _agent(
    agent: Any, name: str | None, config: EvaluateConfig, seed: int, guards: Sequence[str]
) -> tuple[Any, str]:
    """Return the agent, loaded if it is a path, and its heading with the labels ``guards``."""
    usual = type(agent).__name__
    if isinstance(agent, (str, Path)):
        usual = evaluation.name_of(str(agent))
        agent = evaluation.load(config.agent, str(agent), seed)
    evaluation.check_walks(agent)
    return agent, "+".join([name or usual, *guards])


def _plain(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9.@+-]+", "-", name)


def _first_world(
    make_world: Any, met: Sequence[Corruption], agent: Any, version: str | None
) -> tuple[World, dict[str, str]]:
    """Return a world and what it was made by; raise ValueError if it is not made anew, shows too
    little, or shows another number of views than the agent says."""
    if not callable(make_world):
        raise ValueError(
            f"world is a {type(make_world).__name__}: give what makes one, such as a function, "
            "since each process has its own."
        )
    world, made_by = provenance.first_world(make_world, version)
    if not hasattr(world, "sensors"):  # any object of the user may be given by mistake
        kind = type(world).__name__
        raise ValueError(
            f"A {kind} is no world: it has no sensors (docs/bring-your-own.md). If it is a "
            f"gymnasium environment, give world=lambda: GymWorld({kind}(...), success=...) "
            "(mitigate.worlds.gym); if it is one of torchrl, EnvWorld "
            "(mitigate.worlds.tensordict)."
        )
    evaluation.check_sensors(met, world.sensors, type(world).__name__)
    check_fits(agent, world.sensors, type(world).__name__)
    return world, made_by


def _is_own(world: World, config: EvaluateConfig) -> bool:
    """Whether the world is none of the config's, whose lists of episodes mean nothing in it."""
    node = config.env.world
    usual = located(node["_target_"])
    kind = usual if isinstance(usual, type) else type(maker(node)())  # a function makes it
    return not isinstance(world, kind)


def _episodes(
    world: World,
    config: EvaluateConfig,
    split: str | None,
    count: int | EllipsisType | None,
    listed: Sequence[Episode] | Path | str | None,
    given: bool,
) -> tuple[str, list[Episode]]:
    """Return the split and the episodes to walk; raise ValueError for none, and for a world that
    was ``given``, of another class than the config's, without a list of its own."""
    own = given and _is_own(world, config)
    split = split or (provenance.name_of(world) if own else config.split)
    if listed is None and own:
        raise ValueError(
            f"The episodes of {config.env.name} are none of {provenance.name_of(world)}: give its "
            'own, listed="mine.json", or a list of Episode (mitigate.worlds.episodes, '
            "docs/bring-your-own.md). Of a gymnasium or torchrl environment they are seeds: "
            "listed=seeded_episodes(range(20)) (mitigate.worlds.seeded)."
        )
    if listed is None:
        return split, evaluation.episodes(config.env, split, EPISODES if count is ... else count)
    check_count(None if count is ... else count)
    if isinstance(listed, Episode) or not isinstance(listed, (str, Path, Iterable)):
        raise ValueError(f"listed={listed!r:.80} is no list of episodes, nor the file of one.")
    found = list(read_episodes(listed) if isinstance(listed, (str, Path)) else listed)
    for entry in found:
        if not isinstance(entry, Episode):
            raise ValueError(
                f"listed has {entry!r:.80} in it, which is no Episode. Of seeds, give "
                "listed=seeded_episodes([1, 2, 3]) (mitigate.worlds.seeded)."
            )
    check_episodes("listed", found)
    return split, spread(found, None if count is ... else count)


def _check_copies(*things: Any) -> None:
    """Raise ValueError for what other processes cannot be given."""
    main = Path(vars(sys.modules["__main__"]).get("__file__") or "")
    typed = [thing for thing in things if type(thing).__module__ == "__main__"]
    own = "give workers=1, or define them at the head of a module"
    if typed and not main.is_file():
        raise ValueError(
            f"A {type(typed[0]).__name__} was typed in, and is in no file that other processes "
            f"could read: {own}."
        )
    packed(things, "The agent or its world", own)


def _tell(
    agent: Any,
    make_world: Callable[[], World],
    episodes: Sequence[Episode],
    conditions: Sequence[Corruption],
    workers: int | None,
) -> None:
    """Print how much there is to walk, and about how long it takes, from a few clean walks."""
    total = len(episodes) * len(conditions)
    processes = min(count(LOCAL, workers, total, WORTH), len(episodes))
    if processes > 1:
        _check_copies(agent, make_world)
    world = make_world()
    for condition in conditions:  # compiles what corrupts
        dict(Corrupted(world, condition, 0).reset(episodes[0]))
    with in_eval_mode(agent):
        for episode in episodes[:TIMED]:  # the first one loads what is needed
            started = time.monotonic()
            run_episode(agent, world, episode, CLEAN, 0)
            each = time.monotonic() - started
    grid = f"{counted(len(episodes), 'episode')} x {counted(len(conditions), 'condition')}"
    print(
        f"benchmark: {grid} = {counted(total, 'walk')} of about "
        f"{each:.2g} s on {processes} process{'es' * (processes > 1)}: about "
        f"{duration(each * total / processes)}",
        flush=True,
    )
