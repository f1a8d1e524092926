"""Whether a recipe, an agent, a world and a run's folder fit together, asked before the first step.

One recipe serves agents of many kinds: a stage that has nothing to train in one is left out, and a
corruption of what one does not read is not drawn.
"""

from __future__ import annotations

import copy
import json
from contextlib import redirect_stdout
from inspect import signature
from io import StringIO
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf, open_dict
from torch import nn

from mitigate.agents.agent import as_agent
from mitigate.agents.observation import check_fits
from mitigate.core.build import build, located, maker, plain
from mitigate.core.conf import CONF
from mitigate.core.contracts import lacking
from mitigate.core.json_files import read_object
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.progress import say
from mitigate.corruptions import Schedule
from mitigate.corruptions.registry import modality, names
from mitigate.training import states
from mitigate.training.parts import POLICY, SEEING, policy_parts
from mitigate.training.ranks import Ranks
from mitigate.training.recipe import Recipe
from mitigate.training.stages import (
    IDENTITY,
    named,
    not_a_recipe,
    recipe_of,
    trainer_settings,
)
from mitigate.worlds.world import Placeable

OURS = "mitigate.recipes."
OTHER_FOLDER = "Choose another folder (folder=...), or delete this one."


def leave_out(cfg: DictConfig, agent: nn.Module) -> None:
    """Set the stages of ``cfg`` that have nothing to train in ``agent`` to None, and say so.

    Raises ValueError if none is left, but for an agent that is blinded and evaluated: that tells
    something of it as it is.
    """
    for name, stage in cfg.stages.items():
        idle = None if stage is None else nothing_to_do(stage, agent)
        if idle:
            cfg.stages[name] = None
            say(f"{name}: left out, {idle}")
    _leave_out_views(cfg, agent)
    if any(cfg.stages.values()):
        return
    if not (cfg.evaluation.enabled and cfg.agent.get("blind")):
        raise ValueError(
            f"Nothing of {type(agent).__name__} would be trained: the recipe {cfg.name} has no "
            "other stages than those that were left out. Choose another recipe or agent "
            "(recipes/README.md, docs/agents.md)."
        )
    say(f"nothing is trained: the agent is evaluated with agent.blind={list(cfg.agent.blind)}")


def nothing_to_do(stage: DictConfig, agent: nn.Module) -> str | None:
    """Why a stage has nothing to train in this kind of agent, or None: it sees no such sensor,
    stores no features, or is nothing but encoders."""
    sensor, parts, variants = (
        OmegaConf.select(stage, f"recipe.{key}") for key in ("modality", "train_parts", "variants")
    )
    kind, encoders = type(agent).__name__, as_agent(agent).encoders
    if sensor and encoders and sensor not in encoders:
        return f"{kind} has no {sensor} encoder"
    if variants and not hasattr(agent, "store"):
        return f"{kind} stores no features"
    if parts == POLICY and encoders and not policy_parts(agent):
        return f"nothing but encoders is learned in {kind}"
    return None


def _leave_out_views(cfg: DictConfig, agent: nn.Module) -> None:
    """Set the stages that teach encoders on random poses to None where ``agent`` or the world lacks
    what that takes, and say so. Where no other stage could train the agent they stay, and are
    refused (:func:`check`)."""
    held = {name: stage for name, stage in cfg.stages.items() if stage is not None}
    kinds = {name: located(stage.recipe._target_) for name, stage in held.items()}
    views = [name for name, kind in kinds.items() if getattr(kind, "needs", ()) == SEEING]
    others = [kind for name, kind in kinds.items() if name not in views]
    if all(getattr(kind, "misfit", lambda _: "")(agent) for kind in others):
        return
    for name in views:
        absent = lacking(agent, SEEING)
        cause = f"{type(agent).__name__} has no {', '.join(absent)}" if absent else ""
        if not cause and not isinstance(world := maker(held[name].recipe.world)(), Placeable):
            cause = f"{type(world).__name__} has no random poses (scenes, enter, point, put)"
        if cause:
            cfg.stages[name] = None
            say(f"{name}: left out, {cause} (docs/bring-your-own.md)")


def tell_of_schedule(cfg: DictConfig) -> None:
    """Say so if there is a ``schedule`` of corruptions, and no stage draws any of it, or if a
    severity that was asked for does not reach it."""
    mode = OmegaConf.select(cfg, "schedule.mode")
    if mode is None or (mode == "clean" and not cfg.schedule.get("broad_share")):
        return
    if _holds(plain(cfg.stages), cfg.schedule._target_):
        usual = OmegaConf.load(CONF / "train.yaml")
        for key in ("severity", "severity_depth"):
            asked, drawn = (OmegaConf.select(cfg, name) for name in (key, f"schedule.{key}"))
            if asked not in (None, OmegaConf.select(usual, key), drawn):
                whole = "as schedule.severity" if drawn is None else drawn
                say(
                    f"{key}={asked:g} is of the evaluation alone: recipe={cfg.name} trains at "
                    f"schedule.{key}, which is {whole}"
                )
        return
    say(
        f"the schedule (mode {mode}) has no effect: recipe={cfg.name} draws no corruptions in "
        f"{', '.join(cfg.stages)}. One that trains under corruptions is recipe=da_per_episode"
    )


def check_teacher(cfg: DictConfig) -> None:
    """Raise ValueError for a teacher of which no stage would learn."""
    taught = any(stage is not None and "teacher" in stage.recipe for stage in cfg.stages.values())
    if cfg.get("teacher") is not None and not taught:
        raise ValueError(
            f"teacher={cfg.teacher} would have no effect: recipe={cfg.name} does not distil. "
            "Leave it out, or choose recipe=ts_distill or stacked."
        )


def tell_of_warmup(cfg: DictConfig) -> None:
    """Say so if a stage ends before its learning rate has risen to what it is set to."""
    for name, stage in cfg.stages.items():
        settings = {} if stage is None else trainer_settings(cfg, stage)
        steps, warmup = settings.get("steps", 0), settings.get("warmup", 0)
        if 0 < steps <= warmup:
            say(
                f"{name}: its {steps} steps are over before the learning rate has risen, for which "
                f"it takes {warmup}: set trainer.warmup below trainer.steps"
            )


def _holds(node: Any, target: str) -> bool:
    """Whether a config is built of the class ``target`` somewhere in ``node``."""
    if isinstance(node, dict):
        return node.get("_target_") == target or _holds([*node.values()], target)
    return isinstance(node, list) and any(_holds(part, target) for part in node)


def draw_what_is_read(cfg: DictConfig, agent: nn.Module) -> None:
    """Take the corruptions of frames that ``agent`` does not read out of the stages' schedules, and
    say so: in their place it would train on clean frames.

    Raises ValueError if a schedule draws no others.
    """
    sensors = as_agent(agent).sensors
    own = (RGB, DEPTH) if sensors is None else sensors
    unread = [sensor for sensor in (RGB, DEPTH) if sensor not in own]
    cause = f"{type(agent).__name__} reads no {' or '.join(unread)}"
    undrawn: dict[str, None] = {}  # in the schedules' order
    for name, stage in cfg.stages.items() if unread else ():
        node = None if stage is None else OmegaConf.select(stage, "recipe.schedule")
        if not isinstance(node, DictConfig):
            continue
        schedule = build(node)
        if not isinstance(schedule, Schedule) or schedule.mode == "clean":
            continue
        kept = [n for n in schedule.names if modality(n) not in unread]
        if not kept:
            raise ValueError(
                f"{cause}, and the schedule of the stage {name} draws only "
                f"{', '.join(schedule.names)}: it would train on clean frames. Name corruptions of "
                f"what it reads, of {', '.join(names(*own))} (schedule.names=[...]), or choose "
                "another agent (docs/agents.md)."
            )
        if len(kept) < len(schedule.names):
            undrawn |= dict.fromkeys(n for n in schedule.names if n not in kept)
            with open_dict(node):
                node.names = kept
    if undrawn:
        say(f"{cause}: the schedule leaves out {', '.join(undrawn)}")


def check(cfg: DictConfig, agent: nn.Module, folder: Path, ranks: Ranks | None = None) -> None:
    """Raise ValueError, before a step is taken, for a stage that cannot train ``agent``, for a
    world that shows it another number of views, for a ``folder`` with another run, and for more
    ``ranks`` than a step has pieces."""
    _check_settings(cfg.agent, agent)
    for name, stage in cfg.stages.items():
        recipe = None if stage is None else located(stage.recipe._target_)
        _check_kind(recipe, stage)
        misfit = getattr(recipe, "misfit", lambda _: "")(agent)
        if misfit:
            raise ValueError(
                f"{type(agent).__name__} cannot be trained by the stage {name} of recipe="
                f"{cfg.name}: {misfit}"
            )
    contract = as_agent(agent)
    if contract.views is not None or contract.sensors is not None:
        check_fits(agent, maker(cfg.env.world)().sensors, cfg.env.name)
    _check_folder(cfg, folder)
    _check_stages(cfg, agent, ranks or Ranks())


def _check_kind(recipe: Any, stage: DictConfig | None) -> None:
    """Raise ValueError for a class that is no recipe, or takes no agent."""
    if not isinstance(recipe, type) or stage is None:
        return
    if not issubclass(recipe, Recipe):
        raise ValueError(not_a_recipe(stage.recipe._target_))
    taken = signature(recipe).parameters
    if "agent" not in taken and not any(p.kind is p.VAR_KEYWORD for p in taken.values()):
        raise ValueError(
            f"{stage.recipe._target_} takes no agent: give its constructor a parameter agent, the "
            "module that it trains."
        )


def _check_stages(cfg: DictConfig, agent: nn.Module, ranks: Ranks) -> None:
    """Build the recipes of all stages on a copy of ``agent``, up to the first that is not ours: a
    mistake in the last one must not show only after the others have trained. What a user's leaves,
    and what the stages behind it need of that, is not known before.

    Raises ValueError or FileNotFoundError as they do, and for more ``ranks`` than pieces.
    """
    stages = {name: stage for name, stage in cfg.stages.items() if stage is not None}
    if len(stages) < 2 and ranks.count == 1:  # the first one is built next
        return
    try:
        copied = copy.deepcopy(agent)
    except Exception:  # of any kind: what cannot be copied may still be trained
        return
    for name, stage in stages.items():
        if not stage.recipe._target_.startswith(OURS):
            return
        with redirect_stdout(StringIO()):
            pieces = recipe_of(stage, copied).pieces()
        if pieces is not None:
            ranks.check(pieces, f"the stage {name} of recipe={cfg.name}")


def _check_settings(node: DictConfig, agent: nn.Module) -> None:
    """Raise ValueError for settings of an agent that could not be given back to its class."""
    known = {*signature(located(node._target_)).parameters, *map(str, node)}
    own: dict[str, Any] = getattr(agent, "settings", dict)()
    wrong = sorted(name for name in own if name not in known)
    if wrong:
        raise ValueError(
            f"settings() of {type(agent).__name__} names {', '.join(wrong)}, which its constructor "
            "does not take: return its arguments, so that the agent can be built again."
        )


def _check_folder(cfg: DictConfig, folder: Path) -> None:
    """Raise ValueError if checkpoints in ``folder`` are of other stages, or of other settings."""
    for file in sorted(folder.glob(f"*/{IDENTITY}")):
        name = file.parent.name
        if not states.checkpoints(file.parent):
            continue
        if name not in cfg.stages:
            raise ValueError(
                f"{folder} holds a run of another recipe: it has trained a stage {name}, and the "
                f"recipe {cfg.name} has {', '.join(map(str, cfg.stages))}. {OTHER_FOLDER}"
            )
        if cfg.stages[name] is not None:
            _check_same(file, json.loads(json.dumps(named(cfg, cfg.stages[name]))))


def _check_same(file: Path, now: dict[str, Any]) -> None:
    """Raise ValueError if the identity in ``file`` names other settings than ``now``; the trainer
    compares all of it, but only when its stage begins."""
    try:
        held = read_object(file, OTHER_FOLDER)
    except ValueError:  # damaged: the checkpoints have it, too
        return
    different = states.differences({key: held.get(key) for key in now}, now)
    if different:
        raise ValueError(
            f"{file.parent} holds a run with other settings ({'; '.join(different[:6])}). Use the "
            f"old settings to resume it. {OTHER_FOLDER}"
        )
