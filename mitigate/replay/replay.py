"""Run agents on recorded drives: ``mitigate replay DRIVE agents=[checkpoints/recurrent/base]``.

DRIVE is a folder of frames, a ROS 1 bag, a ROS 2 bag (also MCAP), or a LeRobot dataset. Several
drives are allowed. An agent is a folder of weights, or module:callable for your own code. Each
agent receives the frames of the drive without corruption and under each corruption. At each step,
the agent decides what it would do. The output consists of all decisions (``decisions.jsonl``), the
fraction of decisions that each corruption changes (``table.md``, ``changes.png``), and pictures of
some changed decisions.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from omegaconf import MISSING
from omegaconf.errors import OmegaConfBaseException

from mitigate.core import conf
from mitigate.core.files import atomic_text, write_json, write_text
from mitigate.core.json_files import read_json
from mitigate.core.locks import FolderLock
from mitigate.core.names import short
from mitigate.core.options import paths_and_overrides
from mitigate.core.output import is_regular
from mitigate.evaluation.conditions import conditions, suite_conditions
from mitigate.guards.guard import Guards
from mitigate.replay.inputs import check_drives, load_agents, load_drives, open_drives, views_of

DECISIONS, TABLE, SETTINGS = "decisions.jsonl", "table.md", "replay.json"
# the stored settings omit these options, because they do not affect results
UNSAVED = ("out", "runs", "suite", "check")


@dataclass
class TopicsConfig:
    """Options ``topics.*``, see :class:`mitigate.worlds.recorded.Topics`."""

    rgb: str | None = None
    depth: str | None = None
    pose: str | None = None
    info: str | None = None
    depth_info: str | None = None


@dataclass
class StepConfig:
    """Options ``step.*``, see :class:`mitigate.worlds.recorded.Step`."""

    metres: float = 0.25
    degrees: float = 15.0
    seconds: float = 0.5


@dataclass
class ReplayConfig:
    """Types of the options in ``conf/replay.yaml``, which documents each of them."""

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
    crop: bool = False
    cameras: list[str] | None = None
    episodes: list[int] | None = None
    tolerance: float | None = None
    step: StepConfig = field(default_factory=StepConfig)
    topics: TopicsConfig = field(default_factory=TopicsConfig)
    check: bool = False
    out: str | None = None
    runs: str = "runs"
    suite: Any = MISSING

    @property
    def names(self) -> list[str]:
        """Names of the conditions to run."""
        return suite_conditions(self.suite) if self.conditions is None else self.conditions


# suite=clean is rejected, because without a corruption there is nothing to compare
conf.register("replay", ReplayConfig, rejected={"suite": ["clean"]})


def replay_recordings(
    agents: Any,
    recordings: str | Path | Sequence[str | Path],
    *,
    suite: str = "full",
    **options: Any,
) -> Path:
    """Run agents on recorded drives, print the table, and write the report.

    The function does the same as the command ``mitigate replay``, but also accepts agents as
    objects.

    Args:
        agents: An agent (an object with ``reset`` and ``act``), a folder of weights, or the
            ``module:callable`` of a function that returns an agent. Several agents are given as a
            list, or as a mapping from names to agents.
        recordings: The path of one or several drives: bags, folders, or LeRobot datasets.
        suite: Name of the suite of corruptions.
        options: Other options of ``mitigate replay --help``, such as ``conditions=["flare"]``,
            ``instruction="..."``, ``topics={"rgb": "/front/image_raw"}`` or ``out="report"``.

    Returns:
        The folder of the report, with ``table.md`` and ``decisions.jsonl``.

    Raises:
        FileNotFoundError: If a drive or an agent's folder does not exist.
        ValueError: If an option is invalid, or a drive is damaged or lacks inputs of an agent.
    """
    loaded = load_agents(agents)
    paths = [recordings] if isinstance(recordings, (str, Path)) else recordings
    if "out" in options:
        options["out"] = str(options["out"])
    cfg = conf.load_config("replay", [f"suite={suite}"])
    try:
        cfg.merge_with({**options, "agents": [*loaded]})
    except OmegaConfBaseException as error:
        raise ValueError(conf.explain(error, "replay")) from error
    config = conf.typed(cfg, "replay")
    return run(config, [*map(str, paths)], loaded)


def run(
    config: ReplayConfig, paths: Sequence[str], agents: Mapping[str, Any] | None = None
) -> Path:
    """Run agents on the drives at ``paths``.

    Args:
        config: The options.
        paths: The drives.
        agents: Agents by name. The default is the agents that ``config`` names.

    Returns:
        The folder of the report, which is not written if ``config.check`` is set.

    Raises:
        FileNotFoundError: If a drive or an agent's folder does not exist.
        ValueError: If an option is invalid, or a drive is damaged or lacks inputs of an agent.
    """
    from mitigate.guards.opening import open_guards

    check_options(config, paths)
    out = Path(config.out or f"{config.runs}/replay/{_name(paths)}-s{config.severity:g}")
    if config.check:
        load_drives(config, open_drives(config, paths), [1])
        return out
    names = [name for name in config.names if name != "clean"]
    corruptions = conditions(["clean", *names], config.severity, config.severity_depth)
    guards = open_guards(None, config.restore)
    if agents is None:
        agents = load_agents(list(config.agents))
    settings = {**_settings(config, paths, agents), "restorer": guards.frames_hash()}
    _check_earlier(out, settings)
    sources = open_drives(config, paths)
    check_drives(sources, agents, guards)
    recordings = load_drives(config, sources, {views_of(agent) for agent in agents.values()})
    with FolderLock(out) as lock:
        lock.expect(out / SETTINGS, out / DECISIONS, out / TABLE)
        for name, corruption in product(agents, corruptions):  # delete pictures of an earlier run
            _picture_file(out, name, corruption.name).unlink(missing_ok=True)
        write_json(out / SETTINGS, settings, indent=1)
        return replay(config, agents, recordings, corruptions, guards, out)


def check_options(config: ReplayConfig, paths: Sequence[str]) -> None:
    """Raise ValueError if an option is invalid or no drive is given."""
    if not paths:
        raise ValueError(
            "A drive is missing: mitigate replay FOLDER_OR_BAG agents=[checkpoints/recurrent/base]"
        )
    if not 16 <= config.size <= 1024:
        raise ValueError(f"size must be 16 to 1024 pixels, got {config.size}.")
    if not {*config.names} - {"clean"} or config.severity == 0:
        raise ValueError(
            "Without a corruption there is nothing to compare. Add a corruption to conditions=, "
            "with a severity above 0."
        )


def _name(paths: Sequence[str]) -> str:
    """Return a name for the drives: the name of the first drive and the number of the others."""
    first = Path(paths[0])
    more = f"+{len(paths) - 1}" if len(paths) > 1 else ""
    return (first.stem if first.is_file() else first.name) + more


def _settings(
    config: ReplayConfig, paths: Sequence[str], agents: Mapping[str, Any]
) -> dict[str, Any]:
    """Return all settings that determine the report, as JSON data."""
    from torch import nn

    from mitigate.core.checkpoint import weights_sha

    settings = {key: value for key, value in asdict(config).items() if key not in UNSAVED}
    settings["conditions"] = config.conditions or suite_conditions(config.suite)
    shas = {
        name: weights_sha(agent) if isinstance(agent, nn.Module) else type(agent).__qualname__
        for name, agent in agents.items()
    }
    return {**settings, "drives": [str(Path(path).resolve()) for path in paths], "weights": shas}


def _check_earlier(out: Path, settings: dict[str, Any]) -> None:
    """Raise ValueError if ``out`` is a file, or contains a report with different settings."""
    fix = "Name another folder (out=...), or delete this one."
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} must be a folder, because a replay writes several files. {fix}")
    if not is_regular(out / SETTINGS):
        for file in (out / DECISIONS, out / TABLE):
            if file.exists():
                raise ValueError(f"{file} was not written by a replay. {fix}")
        return
    earlier = read_json(out / SETTINGS, fix)
    if not isinstance(earlier, dict):
        raise ValueError(f"{out / SETTINGS} was not written by a replay. {fix}")
    for name, value in settings.items():
        if earlier.get(name) != value:
            raise ValueError(
                f"{out} contains a replay with {name}={short(earlier.get(name))}, but this "
                f"command has {name}={short(value)}. {fix}"
            )


def replay(
    config: ReplayConfig,
    agents: Mapping[str, Any],
    recordings: Mapping[int, Sequence[Any]],
    corruptions: Sequence[Any],
    guards: Guards,
    out: Path,
) -> Path:
    """Run agents on recordings under corruptions and write the report.

    Args:
        config: The options.
        agents: Agents by name.
        recordings: The recordings for each number of views.
        corruptions: Corruptions, clean first.
        guards: Guards between the drives and the agents.
        out: Folder of the report.

    Returns:
        ``out``.
    """
    from mitigate.core.progress import Progress
    from mitigate.replay import report, walk

    seed, severity = config.seed, config.severity
    changes: dict[str, dict[str, walk.Changes]] = {}
    pictures: list[Path] = []
    steps = [len(drive.times) for drive in next(iter(recordings.values()))]
    total = len(agents) * len(corruptions) * len(steps)
    notes: list[str] = []
    with Progress("replay", total, unit="run") as progress, atomic_text(out / DECISIONS) as file:
        for name, agent in agents.items():
            drives = recordings[views_of(agent)]
            answers: dict[str, dict[str, walk.Answers]] = {}
            for corruption in corruptions:
                reason = inapplicable(corruption, agent, drives)
                if reason:
                    progress.advance(len(drives))
                    progress.say(f"{name}, {corruption.name}: not applicable, {reason}")
                    continue
                labels = {
                    "agent": name,
                    "condition": corruption.name,
                    "severity": corruption.severity,
                    "seed": seed,
                }
                corrupted = answers.setdefault(corruption.name, {})
                for drive in drives:
                    before = answers["clean"].get(drive.name)
                    answer = walk.walk(agent, drive, corruption, seed, clean=before, guards=guards)
                    corrupted[drive.name] = answer
                    lines = walk.decision_lines(labels, drive, before or answer, answer)
                    file.writelines(json.dumps(line) + "\n" for line in lines)
                    progress.advance(note=f"{name}, {corruption.name}")
                is_clean = corruption.name == "clean"
                if is_clean and (rare := walk.neglected_actions(drives, corrupted)):
                    notes.append(
                        f"{name} rarely chooses {' or '.join(rare)} on clean frames, but the "
                        "driver often does. The agent may not fit this camera or drive: few "
                        "changed decisions then do not mean that it is robust."
                    )
                    progress.say(f"Warning: {notes[-1]}")
            clean = answers["clean"]
            changes[name] = {n: walk.compare(drives, clean, a) for n, a in answers.items()}
            worst = _worst(corruptions, changes[name])
            if worst is not None:
                draw = partial(walk.walk, agent, corruption=worst, seed=seed, guards=guards)
                path = _picture_file(out, name, worst.name)
                pictures += _draw(drives, worst, answers, draw, path)
    drives = next(iter(recordings.values()))
    text = report.table(changes, severity, sum(steps), len(steps), guards, notes)
    write_text(out / TABLE, text + report.summaries(drives))
    print(text.partition("\nFalse stops")[0])
    pictures.insert(0, report.heatmap(changes, severity, out / "changes.png"))
    print("\n".join(f"wrote {path}" for path in (out / DECISIONS, out / TABLE, *pictures)))
    return out


def inapplicable(corruption: Any, agent: Any, drives: Sequence[Any]) -> str:
    """Return the reason why a corruption cannot reach an agent on these drives, or "" if it can."""
    from mitigate.agents.agent import as_agent
    from mitigate.corruptions.registry import parts, record

    if any(record(part.name).modality == "action" for part in corruption.parts):
        return "the recording decides how the robot moves"
    read = as_agent(agent).sensors
    needs = [{"rgb", "depth"} & {*record(part.name).modalities} for part in corruption.parts]
    if read is not None and needs and all(need and not need & {*read} for need in needs):
        return f"the agent does not read {_either(set.union(*needs))} frames"
    for drive in drives:
        for need in needs:
            if need and not need & {*drive.frames}:
                return f"{drive.name} has no {_either(need)} frames"
    if "white_box" in parts(corruption.name) and not as_agent(agent).system_prompt:
        return "the agent has no system prompt"
    return ""


def _either(names: Iterable[str]) -> str:
    return " or ".join(sorted(names))


def _worst(corruptions: Sequence[Any], changes: Mapping[str, Any]) -> Any:
    """Return the frame corruption that changed the most decisions, or None if none was run."""
    of_frames = [c for c in corruptions if c.name in changes and {"rgb", "depth"} & {*c.modalities}]
    return max(of_frames, key=lambda c: changes[c.name].changed.value, default=None)


def _draw(
    drives: Sequence[Any],
    corruption: Any,
    answers: Mapping[str, Mapping[str, Any]],
    rerun: Callable[..., Any],
    path: Path,
) -> list[Path]:
    """Plot some changed decisions, from the drive on which a corruption changed the most."""
    from mitigate.replay import report
    from mitigate.replay.walk import changed_steps

    clean, corrupted = answers["clean"], answers[corruption.name]
    differs = {name: changed_steps(clean[name], corrupted[name]) for name in clean}
    drive = max(drives, key=lambda d: int(differs[d.name].sum()))
    steps = report.spread(differs[drive.name].nonzero()[0].tolist())
    if not steps:
        return []
    answer = rerun(drive, keep=steps, clean=clean[drive.name])
    return [report.picture(drive, corruption, clean[drive.name], answer, path)]


def _picture_file(out: Path, name: str, condition: str) -> Path:
    return out / f"{re.sub('[/:]', '-', name)}-{condition}.png"


def main() -> None:
    """Run from the command line."""
    if len(sys.argv) == 1:
        print(conf.help_text(__doc__ or "", "replay"))
        sys.exit(2)
    paths, sys.argv[1:] = paths_and_overrides(sys.argv[1:])
    program = conf.hydra_program("replay", lambda cfg: run(conf.typed(cfg, "replay"), paths))
    conf.main(program, "replay", behind=paths, again="To run it again")
