"""Plan a training run: make all decisions that are needed before the first step.

:func:`check` rejects options that are invalid for every agent. :func:`plan` then decides, in
the order of the functions below:

1. It builds the agent, which inherits settings from its initial weights.
2. It skips stages that would train nothing in this agent, drops corruptions of sensors that the
   agent does not read, and displaced cameras that the world cannot render. It reports all of them.
3. It plans the objective and the trainer settings of each stage.
4. It checks that the agent, the world, the folder and the stages are compatible.
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

from mitigate.agents.agent import as_agent, stated_settings
from mitigate.agents.building import build_agent, inherit_settings
from mitigate.agents.observation import check_fits
from mitigate.core.build import build, locate, maker
from mitigate.core.conf import CONF
from mitigate.core.contracts import missing_members
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

# This is the name of a file in a stage's folder.
# It records which initial weights, settings, code and teacher the stage uses.
IDENTITY = "identity.json"
NOT_IDENTITY = ("workers", "folder")  # arguments that do not affect the result of a stage
SHIPPED = "mitigate.recipes."  # package of the objectives of this project


@dataclass(frozen=True)
class StagePlan:
    """The plan of one training stage."""

    name: str  # name of the stage and of its subfolder
    folder: Path  # folder of its checkpoints and logs
    objective: ObjectiveSpec
    trainer: dict[str, Any]  # the settings of the Trainer that the recipe or the user set
    # settings of the agent and the recipe; a run is not resumed if they differ
    identity: dict[str, Any]


@dataclass(frozen=True)
class Plan:
    """The plan of a training run."""

    config: TrainConfig  # the options, without the stages and corruptions that planning left out
    folder: Path
    agent: nn.Module  # the agent with its initial weights
    stages: list[StagePlan]
    workers: int  # number of processes that make batches


def check(config: TrainConfig) -> None:
    """Raise ValueError for options that have valid types but cannot work."""
    check_values(config)
    name, env, stages = config.name, config.env, config.active_stages
    if not stages:
        raise ValueError(f"The recipe {name} has no stages: its YAML must list at least one.")
    if env.training is None and config.report == REPORT:
        raise ValueError(
            f"The world {env.name} has no training episodes. Add an entry training to its config, "
            "such as {_target_: mitigate.worlds.episodes.ListedEpisodes, path: x.json}."
        )
    complete = [stage for stage in stages if _target_of(stages[stage])]
    absent = next((stage for stage in stages if stage not in complete), None)
    if absent is not None:
        raise ValueError(
            f"The recipe {name} has no stage {absent!r}; its stages are {', '.join(complete)}. "
            "Remove options of other stages (experiment=frozen fits only imitation and da_*, "
            "experiment=camera only ts_distill, stacked and self_distill; harden includes it)."
        )
    listed = config.report == REPORT or env.episodes
    # check this before training starts, so that mistakes are found early
    if config.evaluation.enabled and listed:
        count = config.evaluation.episodes
        episodes(env, config.evaluation.split, count if count is None else min(count, 1))
        measured = conditions(config.suite.conditions, config.severity, config.severity_depth)
        if config.report == REPORT:
            check_sensors(measured, maker(env.world)().sensors, env.name)


def _target_of(stage: StageConfig) -> str:
    return str((stage.recipe or {}).get("_target_") or "")


def plan(config: TrainConfig, ranks: Ranks) -> Plan:
    """Plan a training run from options that :func:`check` has accepted.

    Print a line for each decision that a user may not expect.

    Raises:
        ValueError: If the options, the recipe, the agent, the world and the folder are not
            compatible with each other.
        FileNotFoundError: If weights are missing.
    """
    config = copy.deepcopy(config)
    folder = Path(config.folder or "")
    # this rejects weights of a different kind of agent
    inherited = inherit_settings(config.agent, config.init)
    node = config.agent if config.init_parts else inherited
    agent = build_agent(node, weights=config.init, seed=config.seed, parts=config.init_parts)
    taught = any("teacher" in stage.recipe for stage in config.active_stages.values())
    if config.teacher is not None and not taught:
        raise ValueError(
            f"teacher={config.teacher} would have no effect: recipe={config.name} does not use a "
            "teacher. Leave it out, or choose recipe=ts_distill or stacked."
        )
    warn_unused_schedule(config)
    leave_out_stages(config, agent)
    disable_camera_share(config)
    warn_warmup(config)
    drop_unread_corruptions(config, agent)
    stages = plan_stages(config, agent, folder)
    check_fit(config, agent, stages, ranks)
    workers = min(MOST, cores()) if config.workers is None else config.workers
    return Plan(config, folder, agent, stages, workers)


def warn_unused_schedule(config: TrainConfig) -> None:
    """Warn if no stage uses the ``schedule``, or if the schedule ignores a severity option."""
    schedule = config.schedule or {}
    mode = schedule.get("mode")
    if mode is None or (mode == "clean" and not schedule.get("broad_share")):
        return
    if not _contains([s.recipe for s in config.active_stages.values()], schedule["_target_"]):
        say(
            f"the schedule (mode {mode}) has no effect: recipe={config.name} samples no "
            f"corruptions in {', '.join(config.stages)}. To train under corruptions, choose "
            "recipe=da_per_episode"
        )
        return
    default: Any = OmegaConf.load(CONF / "train.yaml")
    for key, value in (("severity", config.severity), ("severity_depth", config.severity_depth)):
        used = schedule.get(key)
        if value not in (None, default[key], used):
            text = "the value of schedule.severity" if used is None else used
            say(
                f"{key}={value:g} affects only the evaluation: recipe={config.name} trains at "
                f"schedule.{key}, which is {text}"
            )


def _contains(node: Any, target: str) -> bool:
    """Return whether ``_target_`` equals ``target`` at any depth of ``node``."""
    if isinstance(node, dict):
        return node.get("_target_") == target or _contains([*node.values()], target)
    return isinstance(node, list) and any(_contains(part, target) for part in node)


def leave_out_stages(config: TrainConfig, agent: nn.Module) -> None:
    """Replace each stage that would train no part of ``agent`` with None, and print its name.

    Raises:
        ValueError: If no stage is left. If ``agent.blind`` is set and evaluation is enabled, there
            is no error and the agent is only evaluated.
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
            f"The recipe {config.name} cannot train {type(agent).__name__}: all of its stages "
            "were skipped. Choose another recipe or agent (recipes/README.md, docs/agents.md)."
        )
    say(f"nothing is trained: the agent is evaluated with agent.blind={list(blind)}")


def nothing_to_train(recipe: Mapping[str, Any], agent: nn.Module) -> str:
    """Return why a stage would train nothing in this kind of agent, or "" if it trains something.

    Possible reasons: the agent lacks the sensor, stores no features, or can only train encoders.
    """
    sensor = recipe.get("modality")
    kind = type(agent).__name__
    encoders = as_agent(agent).encoders
    if sensor and encoders and sensor not in encoders:
        return f"{kind} has no {sensor} encoder"
    if recipe.get("variants") and missing_members(agent, ["store"]):
        return f"{kind} stores no features"
    if recipe.get("train_parts") == POLICY and encoders and not policy_parts(agent):
        return f"{kind} can only train encoders"
    return ""


def _leave_out_views(config: TrainConfig, agent: nn.Module) -> None:
    """Leave out stages on random poses that the agent or the world does not support.

    If no other stage can train the agent, these stages are kept, and :func:`plan_stages` rejects
    them.
    """
    kinds = {name: locate(_target_of(stage)) for name, stage in config.active_stages.items()}
    views = [name for name, kind in kinds.items() if is_objective(kind) and kind.needs == SEEING]
    others = [kind for name, kind in kinds.items() if name not in views]
    if all(_misfit(kind, agent) for kind in others):
        return
    for name in views:
        absent = missing_members(agent, SEEING)
        cause = f"{type(agent).__name__} has no {', '.join(absent)}" if absent else ""
        if not cause:
            world = maker(config.active_stages[name].recipe["world"])()
            if not isinstance(world, Placeable):
                cause = (
                    f"{type(world).__name__} supports no random poses (scenes, enter, point, put)"
                )
        if cause:
            config.stages[name] = None
            say(f"{name}: left out, {cause} (docs/bring-your-own.md)")


def disable_camera_share(config: TrainConfig) -> None:
    """Set ``camera_share`` to 0 in stages whose world cannot render a displaced camera.

    The names of these stages are printed.
    """
    for name, stage in config.active_stages.items():
        if not stage.recipe.get("camera_share"):
            continue
        world = maker(stage.recipe["world"])()
        if isinstance(world, Placeable) and "mount" not in signature(world.put).parameters:
            stage.recipe["camera_share"] = 0.0
            say(
                f"{name}: without displaced cameras, {type(world).__name__}.put has no argument "
                "mount (docs/faults.md)"
            )


def _misfit(kind: Any, agent: nn.Module) -> str:
    """Return why an objective cannot train ``agent``, or "" if it can.

    If ``kind`` is not a class, the result is "".
    """
    return str(kind.misfit(agent)) if is_objective(kind) else ""


def warn_warmup(config: TrainConfig) -> None:
    """Warn if a stage ends before its warm-up ends."""
    for name, stage in config.active_stages.items():
        settings = stage.settings(config.trainer)
        steps, warmup = settings.get("steps", 0), settings.get("warmup", 0)
        if 0 < steps <= warmup:
            say(
                f"{name}: it ends after {steps} steps, before the warmup of {warmup} steps is "
                "over: set trainer.warmup below trainer.steps"
            )


def drop_unread_corruptions(config: TrainConfig, agent: nn.Module) -> None:
    """Remove corruptions from the stages' schedules if ``agent`` does not read their sensors.

    Such corruptions would leave the agent's frames clean. The removed corruptions are printed.

    Raises:
        ValueError: If a schedule would contain no corruptions after the removal.
    """
    declared = as_agent(agent).sensors
    sensors = (RGB, DEPTH) if declared is None else declared
    unread = [sensor for sensor in (RGB, DEPTH) if sensor not in sensors]
    cause = f"{type(agent).__name__} reads no {' or '.join(unread)}"
    # a dict instead of a set, because it preserves the order of the corruptions
    dropped: dict[str, None] = {}
    for name, stage in config.active_stages.items() if unread else ():
        node = stage.recipe.get("schedule")
        if not isinstance(node, dict):
            continue
        schedule = build(node)
        if not isinstance(schedule, Schedule) or schedule.mode == "clean":
            continue
        remaining = [n for n in schedule.names if modality(n) not in unread]
        if not remaining:
            raise ValueError(
                f"{cause}, and the schedule of the stage {name} samples only "
                f"{', '.join(schedule.names)}: it would train on clean frames. Choose from "
                f"{', '.join(names(*sensors))} (schedule.names=[...]), or choose another agent."
            )
        if len(remaining) < len(schedule.names):
            dropped |= dict.fromkeys(n for n in schedule.names if n not in remaining)
            stage.recipe["schedule"] = {**node, "names": remaining}
    if dropped:
        say(f"{cause}: the schedule leaves out {', '.join(dropped)}")


def plan_stages(config: TrainConfig, agent: nn.Module, folder: Path) -> list[StagePlan]:
    """Return the stages that will run.

    Raises:
        ValueError: If a stage cannot train ``agent``, or if :meth:`ObjectiveSpec.of` raises
            ValueError.
    """
    stages = []
    for name, stage in config.active_stages.items():
        objective = ObjectiveSpec.of(stage.recipe)
        misfit = _misfit(locate(objective.target), agent)
        if misfit:
            raise ValueError(
                f"{type(agent).__name__} cannot be trained with recipe={config.name}, stage "
                f"{name}: {misfit}"
            )
        identity = {"agent": config.agent, "recipe": dict(_identity(stage.recipe))}
        trainer = stage.settings(config.trainer)
        stages.append(StagePlan(name, folder / name, objective, trainer, identity))
    _check_settings(config.agent, agent)
    return stages


def _identity(node: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the entries of a stage's ``recipe`` node that affect its result."""
    for name, value in node.items():
        if name not in NOT_IDENTITY:
            yield name, dict(_identity(value)) if isinstance(value, dict) else value


def _check_settings(node: Mapping[str, Any], agent: nn.Module) -> None:
    """Raise ValueError for settings of an agent that its constructor does not accept."""
    known = {*signature(locate(node["_target_"])).parameters, *map(str, node)}
    wrong = sorted(name for name in stated_settings(agent) or {} if name not in known)
    if wrong:
        raise ValueError(
            f"settings() of {type(agent).__name__} has {', '.join(wrong)}, which its constructor "
            "does not take. Return arguments of the constructor, so that the agent can be rebuilt."
        )


def check_fit(config: TrainConfig, agent: nn.Module, stages: list[StagePlan], ranks: Ranks) -> None:
    """Check before the first step that the world, the folder and the stages fit the agent.

    Raises:
        ValueError: If the number of views differs between the world and the agent, or if the folder
            contains a different run. It is also raised if there are more ``ranks`` than pieces of
            work per step.
    """
    contract = as_agent(agent)
    if contract.views is not None or contract.sensors is not None:
        check_fits(agent, maker(config.env.world)().sensors, config.env.name)
    check_folder(config, stages)
    check_stages(config.name, agent, stages, ranks)


def check_folder(config: TrainConfig, stages: list[StagePlan]) -> None:
    """Raise ValueError if the folder contains checkpoints of different stages or settings."""
    planned = {stage.name: stage for stage in stages}
    folder = Path(config.folder or "")
    for file in sorted(folder.glob(f"*/{IDENTITY}")):
        name = file.parent.name
        if not states.checkpoints(file.parent):
            continue
        if name not in config.stages:
            raise ValueError(
                f"{folder} holds a run of another recipe: it has a stage {name}, but the recipe "
                f"{config.name} has {', '.join(config.stages)}. {states.OTHER_FOLDER}"
            )
        # the trainer also compares the complete identity, but only at the start of the stage
        if name in planned:
            try:
                recorded = read_object(file, states.OTHER_FOLDER)
            except ValueError:  # damaged; the checkpoints contain the same data
                continue
            identity = states.as_json(planned[name].identity)
            states.check_same(file.parent, {key: recorded.get(key) for key in identity}, identity)


def check_stages(name: str, agent: nn.Module, stages: list[StagePlan], ranks: Ranks) -> None:
    """Build the objectives of all stages on a copy of ``agent``.

    This finds a mistake in a later stage before the first stage is trained. The check stops at an
    objective that a user wrote, because it is unknown how such an objective changes the agent.

    Raises:
        ValueError: If there are more ``ranks`` than work items per step, or if an objective
            raises ValueError.
        FileNotFoundError: If an objective raises FileNotFoundError.
    """
    if len(stages) < 2 and ranks.count == 1:  # a single stage is built immediately after this check
        return
    try:
        copied = copy.deepcopy(agent)
    # ignore any error, because an agent that cannot be copied may still be trainable
    except Exception:
        return
    for stage in stages:
        if not stage.objective.target.startswith(SHIPPED):
            return
        with redirect_stdout(StringIO()):
            pieces = stage.objective.build(copied).pieces()
        if pieces is not None:
            ranks.check(pieces, f"the stage {stage.name} of recipe={name}")


def agent_config(node: Mapping[str, Any], agent: nn.Module) -> dict[str, Any]:
    """Return the config that is saved together with the weights of ``agent``.

    The config contains the agent's ``settings()``, such as its vocabulary. It does not contain the
    class names of the agent's parts, because the program that loads the agent takes these names
    from its own config.
    """

    def data(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {k: data(v) for k, v in value.items() if not str(k).startswith("_")}
        return value

    excluded = as_agent(agent).own_config_only
    config = {name: value for name, value in data(node).items() if name not in excluded}
    return {"_target_": node["_target_"], **config, **data(stated_settings(agent) or {})}
