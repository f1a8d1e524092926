"""The plan of a training: everything that is decided before the first step.

:func:`check` rejects options that make no sense whatever the agent. :func:`plan` then decides, in
this order, as the functions below stand:

1. It builds the agent, with the settings that it inherits from the weights it starts from.
2. It leaves out stages that have nothing to train in this agent, and corruptions that it does not
   read, and says so.
3. It plans each stage: the objective with its arguments, and the settings of the trainer.
4. It checks that agent, world, folder and stages fit together.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass
from inspect import signature
from io import StringIO
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf
from torch import nn

from mitigate.agents.agent import as_agent
from mitigate.agents.building import build_agent, inherit_settings
from mitigate.agents.observation import check_fits
from mitigate.core.build import build, located, maker
from mitigate.core.conf import CONF
from mitigate.core.contracts import lacking
from mitigate.core.json_files import read_object
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.progress import say
from mitigate.core.workers import cores
from mitigate.corruptions import Schedule
from mitigate.corruptions.registry import modality, names
from mitigate.evaluation.conditions import check_sensors, conditions
from mitigate.evaluation.config import REPORT
from mitigate.evaluation.episode_lists import episodes
from mitigate.training import states
from mitigate.training.config import StageConfig, TrainConfig, check_values
from mitigate.training.objective import ObjectiveSpec, is_objective
from mitigate.training.parts import POLICY, SEEING, policy_parts
from mitigate.training.ranks import Ranks
from mitigate.training.workers import MOST
from mitigate.worlds.world import Placeable

IDENTITY = "identity.json"  # in a stage's folder: its start, settings, code and teacher
NOT_IDENTITY = ("workers", "folder")  # arguments that do not change what a stage trains
OURS = "mitigate.recipes."


@dataclass(frozen=True)
class StagePlan:
    """One stage that will run.

    Attributes:
        name: of the stage, and of its subfolder.
        folder: its checkpoints and logs.
        objective: what to train, with its arguments.
        trainer: the settings of the Trainer that are set.
        identity: the settings part of the stage's fingerprint; a run is not resumed under another.
    """

    name: str
    folder: Path
    objective: ObjectiveSpec
    trainer: dict[str, Any]
    identity: dict[str, Any]


@dataclass(frozen=True)
class Plan:
    """A training, decided.

    Attributes:
        config: the options, with what this plan changed in them.
        folder: of the run.
        agent: to train, with its first weights.
        stages: in order.
        workers: processes that make batches.
    """

    config: TrainConfig
    folder: Path
    agent: nn.Module
    stages: list[StagePlan]
    workers: int


def check(config: TrainConfig) -> None:
    """Raise ValueError for options that are well typed but make no sense."""
    check_values(config)
    name, env, stages = config.name, config.env, config.active_stages
    if not stages:
        raise ValueError(f"The recipe {name} has no stages: its YAML must list at least one.")
    if env.training is None and config.report == REPORT:
        raise ValueError(
            f"The world {env.name} has no training episodes: give its config an entry "
            "training, such as {_target_: mitigate.worlds.episodes.ListedEpisodes, path: x.json}."
        )
    complete = [stage for stage in stages if _target_of(stages[stage])]
    other = next((stage for stage in stages if stage not in complete), None)
    if other is not None:
        raise ValueError(
            f"The recipe {name} has no stage {other!r}: its stages are {', '.join(complete)}. "
            "Leave out what sets another one (experiment=frozen fits imitation and da_* only)."
        )
    listed = config.report == REPORT or env.episodes
    if config.evaluation.enabled and listed:  # a mistake must not show only after the training
        count = config.evaluation.episodes
        episodes(env, config.evaluation.split, count if count is None else min(count, 1))
        measured = conditions(config.suite.conditions, config.severity, config.severity_depth)
        if config.report == REPORT:
            check_sensors(measured, maker(env.world)().sensors, env.name)


def _target_of(stage: StageConfig) -> str:
    return str((stage.recipe or {}).get("_target_") or "")


def plan(config: TrainConfig, ranks: Ranks) -> Plan:
    """Decide everything about a training of checked options (:func:`check`).

    Prints a line for each decision that a user may not expect.

    Raises:
        ValueError: for options, a recipe, an agent, a world or a folder that do not fit together.
        FileNotFoundError: for missing weights.
    """
    config = copy.deepcopy(config)
    folder = Path(config.folder or "")
    inherited = inherit_settings(config.agent, config.init)  # rejects the weights of another kind
    node = config.agent if config.init_parts else inherited
    agent = build_agent(node, weights=config.init, seed=config.seed, parts=config.init_parts)
    check_teacher(config)
    warn_unused_schedule(config)
    leave_out_stages(config, agent)
    warn_warmup(config)
    drop_unread_corruptions(config, agent)
    stages = plan_stages(config, agent, folder)
    check_fit(config, agent, stages, ranks)
    workers = min(MOST, cores()) if config.workers is None else config.workers
    return Plan(config, folder, agent, stages, workers)


def check_teacher(config: TrainConfig) -> None:
    """Raise ValueError for a teacher that no stage learns from."""
    taught = any("teacher" in stage.recipe for stage in config.active_stages.values())
    if config.teacher is not None and not taught:
        raise ValueError(
            f"teacher={config.teacher} would have no effect: recipe={config.name} does not distil. "
            "Leave it out, or choose recipe=ts_distill or stacked."
        )


def warn_unused_schedule(config: TrainConfig) -> None:
    """Say so if no stage draws from the ``schedule``, or if a severity option does not reach it."""
    schedule = config.schedule or {}
    mode = schedule.get("mode")
    if mode is None or (mode == "clean" and not schedule.get("broad_share")):
        return
    if not _contains([s.recipe for s in config.active_stages.values()], schedule["_target_"]):
        say(
            f"the schedule (mode {mode}) has no effect: recipe={config.name} draws no corruptions "
            f"in {', '.join(config.stages)}. One that trains under corruptions is "
            "recipe=da_per_episode"
        )
        return
    default: Any = OmegaConf.load(CONF / "train.yaml")
    for key, asked in (("severity", config.severity), ("severity_depth", config.severity_depth)):
        drawn = schedule.get(key)
        if asked not in (None, default[key], drawn):
            whole = "as schedule.severity" if drawn is None else drawn
            say(
                f"{key}={asked:g} is of the evaluation alone: recipe={config.name} trains at "
                f"schedule.{key}, which is {whole}"
            )


def _contains(node: Any, target: str) -> bool:
    """Return whether a config names the class ``target`` somewhere in ``node``."""
    if isinstance(node, dict):
        return node.get("_target_") == target or _contains([*node.values()], target)
    return isinstance(node, list) and any(_contains(part, target) for part in node)


def leave_out_stages(config: TrainConfig, agent: nn.Module) -> None:
    """Set the stages that have nothing to train in ``agent`` to None, and say so.

    Raises:
        ValueError: if no stage is left, except for a blinded agent that is evaluated as it is.
    """
    for name, stage in config.active_stages.items():
        reason = nothing_to_train(stage.recipe, agent)
        if reason:
            config.stages[name] = None
            say(f"{name}: left out, {reason}")
    _leave_out_views(config, agent)
    if config.active_stages:
        return
    blind = config.agent.get("blind")
    if not (config.evaluation.enabled and blind):
        raise ValueError(
            f"Nothing of {type(agent).__name__} would be trained: the recipe {config.name} has no "
            "other stages than those that were left out. Choose another recipe or agent "
            "(recipes/README.md, docs/agents.md)."
        )
    say(f"nothing is trained: the agent is evaluated with agent.blind={list(blind)}")


def nothing_to_train(recipe: Mapping[str, Any], agent: nn.Module) -> str | None:
    """Return why a stage has nothing to train in this kind of agent, or None.

    The agent lacks the sensor, stores no features, or learns nothing but encoders.
    """
    sensor = recipe.get("modality")
    kind = type(agent).__name__
    encoders = as_agent(agent).encoders
    if sensor and encoders and sensor not in encoders:
        return f"{kind} has no {sensor} encoder"
    if recipe.get("variants") and lacking(agent, ["store"]):
        return f"{kind} stores no features"
    if recipe.get("train_parts") == POLICY and encoders and not policy_parts(agent):
        return f"nothing but encoders is learned in {kind}"
    return None


def _leave_out_views(config: TrainConfig, agent: nn.Module) -> None:
    """Set stages that learn on random poses to None where the agent or the world lacks something.

    Where no other stage could train the agent they stay, and :func:`check_fit` rejects them.
    """
    kinds = {name: located(_target_of(stage)) for name, stage in config.active_stages.items()}
    views = [name for name, kind in kinds.items() if is_objective(kind) and kind.needs == SEEING]
    others = [kind for name, kind in kinds.items() if name not in views]
    if all(_misfit(kind, agent) for kind in others):
        return
    for name in views:
        absent = lacking(agent, SEEING)
        cause = f"{type(agent).__name__} has no {', '.join(absent)}" if absent else ""
        if not cause:
            world = maker(config.active_stages[name].recipe["world"])()
            if not isinstance(world, Placeable):
                cause = f"{type(world).__name__} has no random poses (scenes, enter, point, put)"
        if cause:
            config.stages[name] = None
            say(f"{name}: left out, {cause} (docs/bring-your-own.md)")


def _misfit(kind: Any, agent: nn.Module) -> str:
    """Return why an objective cannot train ``agent``; "" for what is no class of an objective."""
    return str(kind.misfit(agent)) if is_objective(kind) else ""


def warn_warmup(config: TrainConfig) -> None:
    """Say so if a stage ends before its learning rate has risen to its value."""
    for name, stage in config.active_stages.items():
        settings = stage.settings(config.trainer)
        steps, warmup = settings.get("steps", 0), settings.get("warmup", 0)
        if 0 < steps <= warmup:
            say(
                f"{name}: its {steps} steps are over before the learning rate has risen, for which "
                f"it takes {warmup}: set trainer.warmup below trainer.steps"
            )


def drop_unread_corruptions(config: TrainConfig, agent: nn.Module) -> None:
    """Take corruptions of frames that ``agent`` does not read out of the stages' schedules.

    In their place it would train on clean frames. Prints which are dropped.

    Raises:
        ValueError: if a schedule draws no others.
    """
    declared = as_agent(agent).sensors
    sensors = (RGB, DEPTH) if declared is None else declared
    unread = [sensor for sensor in (RGB, DEPTH) if sensor not in sensors]
    cause = f"{type(agent).__name__} reads no {' or '.join(unread)}"
    dropped: dict[str, None] = {}  # in the schedules' order
    for name, stage in config.active_stages.items() if unread else ():
        node = stage.recipe.get("schedule")
        if not isinstance(node, dict):
            continue
        schedule = build(node)
        if not isinstance(schedule, Schedule) or schedule.mode == "clean":
            continue
        kept = [n for n in schedule.names if modality(n) not in unread]
        if not kept:
            raise ValueError(
                f"{cause}, and the schedule of the stage {name} draws only "
                f"{', '.join(schedule.names)}: it would train on clean frames. Name corruptions of "
                f"what it reads, of {', '.join(names(*sensors))} (schedule.names=[...]), or choose "
                "another agent (docs/agents.md)."
            )
        if len(kept) < len(schedule.names):
            dropped |= dict.fromkeys(n for n in schedule.names if n not in kept)
            stage.recipe["schedule"] = {**node, "names": kept}
    if dropped:
        say(f"{cause}: the schedule leaves out {', '.join(dropped)}")


def plan_stages(config: TrainConfig, agent: nn.Module, folder: Path) -> list[StagePlan]:
    """Return the stages that will run.

    Raises:
        ValueError: for a stage that cannot train ``agent``, and as :meth:`ObjectiveSpec.of` does.
    """
    _check_settings(config.agent, agent)
    stages = []
    for name, stage in config.active_stages.items():
        objective = ObjectiveSpec.of(stage.recipe)
        misfit = _misfit(located(objective.target), agent)
        if misfit:
            raise ValueError(
                f"{type(agent).__name__} cannot be trained by the stage {name} of recipe="
                f"{config.name}: {misfit}"
            )
        identity = {"agent": config.agent, "recipe": dict(_identity(stage.recipe))}
        trainer = stage.settings(config.trainer)
        stages.append(StagePlan(name, folder / name, objective, trainer, identity))
    return stages


def _identity(node: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in node.items():
        if name not in NOT_IDENTITY:
            yield name, dict(_identity(value)) if isinstance(value, dict) else value


def _check_settings(node: Mapping[str, Any], agent: nn.Module) -> None:
    """Raise ValueError for settings of an agent that its constructor does not take."""
    known = {*signature(located(node["_target_"])).parameters, *map(str, node)}
    wrong = sorted(name for name in _settings_of(agent) if name not in known)
    if wrong:
        raise ValueError(
            f"settings() of {type(agent).__name__} names {', '.join(wrong)}, which its constructor "
            "does not take: return its arguments, so that the agent can be built again."
        )


def _settings_of(agent: Any) -> dict[str, Any]:
    """Return the settings of an agent; those of users need not have ``settings()``."""
    return dict(getattr(agent, "settings", dict)())


def check_fit(config: TrainConfig, agent: nn.Module, stages: list[StagePlan], ranks: Ranks) -> None:
    """Check world, folder and stages against the agent before a step is taken.

    Raises:
        ValueError: for a world that shows another number of views, for a folder with another run,
            and for more ``ranks`` than a step has pieces.
    """
    contract = as_agent(agent)
    if contract.views is not None or contract.sensors is not None:
        check_fits(agent, maker(config.env.world)().sensors, config.env.name)
    check_folder(config, stages)
    check_stages(config.name, agent, stages, ranks)


def check_folder(config: TrainConfig, stages: list[StagePlan]) -> None:
    """Raise ValueError if the folder holds checkpoints of other stages, or of other settings."""
    planned = {stage.name: stage for stage in stages}
    folder = Path(config.folder or "")
    for file in sorted(folder.glob(f"*/{IDENTITY}")):
        name = file.parent.name
        if not states.checkpoints(file.parent):
            continue
        if name not in config.stages:
            raise ValueError(
                f"{folder} holds a run of another recipe: it has trained a stage {name}, and the "
                f"recipe {config.name} has {', '.join(config.stages)}. {states.OTHER_FOLDER}"
            )
        if name in planned:  # the trainer compares all of it, but only when its stage begins
            try:
                recorded = read_object(file, states.OTHER_FOLDER)
            except ValueError:  # damaged: the checkpoints hold it too
                continue
            identity = states.as_json(planned[name].identity)
            states.check_same(file.parent, {key: recorded.get(key) for key in identity}, identity)


def check_stages(name: str, agent: nn.Module, stages: list[StagePlan], ranks: Ranks) -> None:
    """Build the objectives of all stages on a copy of ``agent``, up to the first of a user.

    A mistake in the last stage must not show only after the others have trained. What a user's
    stage leaves, and what later stages need of that, is unknown before.

    Raises:
        ValueError: for more ``ranks`` than pieces, and as the objectives do.
        FileNotFoundError: as the objectives do.
    """
    if len(stages) < 2 and ranks.count == 1:  # the first one is built next
        return
    try:
        copied = copy.deepcopy(agent)
    except Exception:  # of any kind: an agent that cannot be copied may still be trained
        return
    for stage in stages:
        if not stage.objective.target.startswith(OURS):
            return
        with redirect_stdout(StringIO()):
            pieces = stage.objective.build(copied).pieces()
        if pieces is not None:
            ranks.check(pieces, f"the stage {stage.name} of recipe={name}")


def agent_config(node: Mapping[str, Any], agent: nn.Module) -> dict[str, Any]:
    """Return the config that is written beside the weights of ``agent``.

    It holds the agent's own ``settings()``, such as its vocabulary. Which classes are inside is for
    the reader's own config to say.
    """

    def data(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {k: data(v) for k, v in value.items() if not str(k).startswith("_")}
        return value

    barred = as_agent(agent).own_config_only
    config = {name: value for name, value in data(node).items() if name not in barred}
    return {"_target_": node["_target_"], **config, **data(_settings_of(agent))}
