"""Take agents along recorded drives: ``mitigate replay DRIVE agents=[checkpoints/recurrent/base]``.

DRIVE is a folder of frames or a bag of ROS 1, ROS 2 or MCAP; several may be given. Each agent sees
the drive as it was and under each corruption, and says at each step what it would do. Written are
every decision (``decisions.jsonl``), how many of them a corruption changes (``table.md``,
``changes.png``), and pictures of some that it changed.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import hydra
from omegaconf import MISSING, DictConfig

from mitigate.core import conf
from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_json
from mitigate.core.locks import FolderLock
from mitigate.core.names import name_of, short
from mitigate.core.options import paths_and_overrides
from mitigate.core.output import is_regular
from mitigate.evaluation.conditions import conditions, suite_conditions
from mitigate.guards.guard import NO_GUARDS, Guards

DECISIONS, TABLE, SETTINGS = "decisions.jsonl", "table.md", "replay.json"
UNSAVED = ("out", "runs", "suite")  # options that change no result


@dataclass
class TopicsConfig:
    """As ``worlds/recorded/topics.py`` has it."""

    rgb: str | None = None
    depth: str | None = None
    pose: str | None = None
    info: str | None = None
    depth_info: str | None = None


@dataclass
class StepConfig:
    """As ``worlds/recorded/steps.py`` has it."""

    metres: float = 0.25
    degrees: float = 15.0
    seconds: float = 0.5


@dataclass
class ReplayConfig:
    """Types of ``conf/replay.yaml``; the meaning of each entry is written there."""

    agents: list[str] = MISSING
    instruction: str | None = None
    conditions: list[str] | None = None
    restore: str | None = None
    severity: float = 0.6
    severity_depth: float | None = None
    seed: int = 0
    size: int = 64
    hfov: float | None = None
    unit: float | None = None
    yaw: float = 0.0
    cameras: list[str] | None = None
    step: StepConfig = field(default_factory=StepConfig)
    topics: TopicsConfig = field(default_factory=TopicsConfig)
    out: str | None = None
    runs: str = "runs"
    suite: Any = MISSING

    @property
    def names(self) -> list[str]:
        """The conditions that are asked for, by name."""
        return suite_conditions(self.suite) if self.conditions is None else self.conditions


conf.register("replay", ReplayConfig)


def run(config: ReplayConfig, paths: Sequence[str]) -> Path:
    """Take agents along the drives at ``paths``; return the folder of the report.

    Raises ValueError and FileNotFoundError for what is missing, damaged or does not fit.
    """
    from mitigate.guards.opening import open_guards

    check_options(config, paths)
    names = [name for name in config.names if name != "clean"]
    met = conditions(["clean", *names], config.severity, config.severity_depth)
    guards = open_guards(None, config.restore)
    agents = load_agents(config.agents)
    out = Path(config.out or f"{config.runs}/replay/{_name(paths)}-s{config.severity:g}")
    settings = _settings(config, paths, agents)
    settings["restorer"] = guards.frames_hash()
    _check_earlier(out, settings)
    views = {agent.views for agent in agents.values()}
    recordings = load_recordings(config, paths, views, guards)
    with FolderLock(out) as lock:
        lock.expect(out / SETTINGS, out / DECISIONS, out / TABLE)
        for name, corruption in product(agents, met):  # of an earlier run
            _picture_file(out, name, corruption.name).unlink(missing_ok=True)
        with atomic_text(out / SETTINGS) as file:
            json.dump(settings, file, indent=1)
        return replay(
            agents,
            recordings,
            met,
            out,
            severity=config.severity,
            seed=config.seed,
            guards=guards,
        )


def check_options(config: ReplayConfig, paths: Sequence[str]) -> None:
    """Raise ValueError for options that make no sense, and without a drive."""
    if not paths:
        raise ValueError(
            "No drive is given: mitigate replay FOLDER_OR_BAG agents=[checkpoints/recurrent/base]"
        )
    if not config.agents:
        raise ValueError("agents=[] are none: name folders of weights.")
    if not 16 <= config.size <= 1024:
        raise ValueError(f"size={config.size} must be 16 to 1024 pixels.")
    if not {*config.names} - {"clean"} or config.severity == 0:
        raise ValueError("Clean walks alone have nothing to compare: name a corruption.")


def load_agents(weights: Sequence[str]) -> dict[str, Any]:
    """The agents of folders of weights, by names that differ."""
    from mitigate.agents.loading import load

    if len(set(weights)) < len(weights):
        raise ValueError(f"agents=[{','.join(weights)}] names one folder twice.")
    names = [name_of(folder) for folder in weights]
    if len(set(names)) < len(names):
        names = [folder.rstrip("/") for folder in weights]
    return {name: load(folder) for name, folder in zip(names, weights, strict=True)}


def load_recordings(
    config: ReplayConfig, paths: Sequence[str], views: set[int], guards: Guards = NO_GUARDS
) -> dict[int, list[Any]]:
    """Every drive, for agents with a panorama (12) and for those with one camera (1). Raises
    ValueError for a drive of which ``guards`` change no frame, before any frame is read."""
    from mitigate.worlds.recorded import Step, Topics, kinds, load, open_recording

    step = Step(**vars(config.step))
    open_drives = partial(
        open_recording,
        topics=Topics(**vars(config.topics)),
        hfov=config.hfov,
        unit=config.unit,
        yaw=config.yaw,
        cameras=config.cameras,
    )
    found: dict[int, list[Any]] = {count: [] for count in views}
    sources = [source for path in paths for source in open_drives(path)]
    for source, count in product(sources if guards else [], views):
        guards.check_shown(kinds(source, count), source.name)
    for source, count in product(sources, views):
        drive = load(source, views=count, size=config.size, step=step)
        words = config.instruction or drive.instruction
        if not words:
            raise ValueError(
                f"{drive.name} says no instruction: give instruction='\"walk to the door\"'."
            )
        found[count].append(replace(drive, instruction=words))
    for drives in found.values():
        twice = {drive.name for drive in drives if sum(d.name == drive.name for d in drives) > 1}
        if twice:
            raise ValueError(f"Two drives are called {twice.pop()!r}: rename one.")
    return found


def _name(paths: Sequence[str]) -> str:
    """A name for the drives: of the first, and how many more."""
    first = Path(paths[0])
    more = f"+{len(paths) - 1}" if len(paths) > 1 else ""
    return (first.stem if first.is_file() else first.name) + more


def _settings(
    config: ReplayConfig, paths: Sequence[str], agents: Mapping[str, Any]
) -> dict[str, Any]:
    """What makes the report what it is, as data."""
    from mitigate.core.checkpoint import weights_sha

    kept = {key: value for key, value in asdict(config).items() if key not in UNSAVED}
    kept["conditions"] = config.conditions or suite_conditions(config.suite)
    shas = {name: weights_sha(agent) for name, agent in agents.items()}
    return {**kept, "drives": [str(Path(path).resolve()) for path in paths], "weights": shas}


def _check_earlier(out: Path, settings: dict[str, Any]) -> None:
    """Raise ValueError if ``out`` is no folder, or holds another report."""
    again = "Name another folder (out=...), or delete this one."
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is no folder, in which a replay is written. {again}")
    if not is_regular(out / SETTINGS):
        other_files = [out / name for name in (DECISIONS, TABLE) if (out / name).exists()]
        if other_files:
            raise ValueError(f"{other_files[0]} was not written by a replay. {again}")
        return
    held = read_json(out / SETTINGS, again)
    if not isinstance(held, dict):
        raise ValueError(f"{out / SETTINGS} is not what a replay writes. {again}")
    other = [name for name, value in settings.items() if held.get(name) != value]
    if other:
        raise ValueError(
            f"{out} holds a replay with another {other[0]} ({short(held.get(other[0]))}). {again}"
        )


def replay(
    agents: Mapping[str, Any],
    recordings: Mapping[int, Sequence[Any]],
    met: Sequence[Any],
    out: Path,
    *,
    severity: float,
    seed: int,
    guards: Guards = NO_GUARDS,
) -> Path:
    """Walk ``agents`` (by name) along ``recordings`` (by their number of views) under the
    corruptions ``met``, clean first, behind ``guards`` if there are any; write the report into
    ``out`` and return it."""
    from mitigate.core.progress import Progress
    from mitigate.replay import report
    from mitigate.replay.walk import Answers, Changes, compare, lines, walk

    found: dict[str, dict[str, Changes]] = {}
    pictures: list[Path] = []
    steps = [len(drive.times) for drive in next(iter(recordings.values()))]
    total = len(agents) * len(met) * len(steps)
    with Progress("replay", total, unit="walk") as progress, atomic_text(out / DECISIONS) as file:
        for name, agent in agents.items():
            drives = recordings[agent.views]
            answers: dict[str, dict[str, Answers]] = {}
            for corruption in met:
                reason = inapplicable(corruption, agent, drives)
                if reason:
                    progress.advance(len(drives))
                    progress.say(f"{name}, {corruption.name}: not applicable, {reason}")
                    continue
                here = answers.setdefault(corruption.name, {})
                for drive in drives:
                    clean = answers["clean"].get(drive.name)
                    here[drive.name] = walk(
                        agent, drive, corruption, seed, clean=clean, guards=guards
                    )
                    told = {"agent": name, "condition": corruption.name}
                    told |= {"severity": corruption.severity, "seed": seed}
                    made = lines(told, drive, answers["clean"][drive.name], here[drive.name])
                    file.writelines(json.dumps(line) + "\n" for line in made)
                    progress.advance(note=f"{name}, {corruption.name}")
            known = answers["clean"]
            found[name] = {n: compare(drives, known, a) for n, a in answers.items()}
            pictures += _picture(name, agent, drives, met, found[name], answers, seed, out, guards)
    text = report.table(found, severity, sum(steps), len(steps), guards)
    with atomic_text(out / TABLE) as table:
        table.write(text)
    print(text.partition("\nFalse stops")[0])
    pictures.insert(0, report.heatmap(found, severity, out / "changes.png"))
    print("\n".join(f"wrote {path}" for path in (out / DECISIONS, out / TABLE, *pictures)))
    return out


def inapplicable(corruption: Any, agent: Any, drives: Sequence[Any]) -> str:
    """Why a corruption cannot be met here; empty if it can."""
    from mitigate.agents.agent import as_agent
    from mitigate.corruptions.registry import parts

    lacking = [
        (part, drive.name)
        for drive in drives
        for part in corruption.modalities
        if part in ("rgb", "depth") and part not in drive.frames
    ]
    if lacking:
        return f"{lacking[0][1]} has no {lacking[0][0]} frames"
    if "white_box" in parts(corruption.name) and not as_agent(agent).system_prompt:
        return "the agent has no system prompt"
    return ""


def _picture(
    name: str,
    agent: Any,
    drives: Sequence[Any],
    met: Sequence[Any],
    found: Mapping[str, Any],
    answers: Mapping[str, Mapping[str, Any]],
    seed: int,
    out: Path,
    guards: Guards,
) -> list[Path]:
    """A picture of decisions that the worst corruption of frames changed, if it changed any."""
    from mitigate.replay import report
    from mitigate.replay.walk import walk

    seen = [c for c in met if c.name in found and {"rgb", "depth"} & set(c.modalities)]
    if not seen:
        return []
    worst = max(seen, key=lambda c: found[c.name].changed.value)
    differs = {
        drive.name: answers["clean"][drive.name].actions != answers[worst.name][drive.name].actions
        for drive in drives
    }
    drive = max(drives, key=lambda d: int(differs[d.name].sum()))
    steps = report.spread([int(i) for i in differs[drive.name].nonzero()[0]])
    if not steps:
        return []
    clean = answers["clean"][drive.name]
    again = walk(agent, drive, worst, seed, keep=steps, clean=clean, guards=guards)
    path = _picture_file(out, name, worst.name)
    return [report.picture(drive, worst, clean, again, path)]


def _picture_file(out: Path, name: str, condition: str) -> Path:
    return out / f"{name.replace('/', '-')}-{condition}.png"


_paths: list[str] = []  # the drives of the command line


@hydra.main(version_base="1.3", config_path=str(conf.CONF), config_name="replay")
def hydra_main(cfg: DictConfig) -> None:
    """Hydra's entry."""
    config = conf.typed(cfg, "replay")
    assert isinstance(config, ReplayConfig)
    run(config, _paths)


def main() -> None:
    """Run from the command line."""
    arguments = sys.argv[1:]
    if not arguments or {"--help", "-h"} & set(arguments):
        print(f"{__doc__}\nOptions, with what they are if nothing is said:\n")
        print(conf.options_text("replay"))
        sys.exit(0 if arguments else 2)
    _paths[:], sys.argv[1:] = paths_and_overrides(arguments)
    conf.main(hydra_main, "replay", behind=_paths, again="To run it again")
