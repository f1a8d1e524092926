"""Run an agent on a recorded drive, and compare its decisions with those on clean frames.

The recording decides where the robot moves; the agent only decides what it would do at each step.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.agents.agent import Agent, as_agent
from mitigate.core.contracts import read
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.corruptions import Corruption
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.episode import action_of, instructed
from mitigate.guards.guard import NO_GUARDS, Guards, guarded
from mitigate.worlds.recorded import RecordedWorld, Recording
from mitigate.worlds.recorded.recording import NO_ACTION, movements
from mitigate.worlds.world import Corrupted

ACTIONS = {STOP: "stop", FORWARD: "forward", LEFT: "left", RIGHT: "right"}
# Heuristic limits.
# a target position counts as changed if it moved by more than this (metres; two steps)
MIN_AIM_SHIFT = 0.5
# a continuous action counts as changed if a component changes by this fraction of its range
MIN_ACTION_SHIFT = 0.1
ROUNDING = 1e-6  # tolerance for rounding errors when continuous actions are compared
OFTEN = 0.2  # an action is frequent if the driver takes it in at least this fraction of the steps
# an action is rare if the agent's frequency is below this fraction of the driver's frequency
RARELY = 0.1
MIN_BLOCKS = 8  # minimum number of blocks of steps for a bootstrap interval
# number of steps per block; consecutive steps are correlated, so a block is resampled as a unit
BLOCK_STEPS = 10


@dataclass(frozen=True)
class Answers:
    """The decisions of an agent on a drive of T steps.

    Attributes:
        actions: int [T], or float [T, A] for continuous actions.
        aims: array of the positions to which the agent wants to move, on the floor plan in metres,
            float [T, 2]. A position is NaN if the agent has no target.
        seen: The frames that the agent received at some steps, by step and sensor.
    """

    actions: np.ndarray
    aims: np.ndarray
    seen: dict[int, dict[str, np.ndarray]] = field(default_factory=dict)


def walk(
    agent: Agent,
    recording: Recording,
    corruption: Corruption,
    seed: int,
    keep: Collection[int] = (),
    clean: Answers | None = None,
    guards: Guards = NO_GUARDS,
) -> Answers:
    """Run ``agent`` on a recorded drive under ``corruption`` and return its decisions.

    After each step, the agent receives the driver's motion (``Agent.taken``). If the motion is
    unknown and actions are discrete, the agent receives the motion of the action that it chose for
    the clean frames. So runs under different corruptions differ only in frames and instructions.

    Args:
        agent: The agent.
        recording: The drive.
        corruption: Corruption of frames and instruction; ``CLEAN`` for the reference run.
        seed: Corruption seed.
        keep: Steps whose frames are returned in ``Answers.seen``.
        clean: Decisions on clean frames, or None if this is the clean run.
        guards: Guards between the drive and the agent.

    Returns:
        The decisions of the agent.

    Raises:
        ValueError: If the drive lacks a sensor that the agent reads.
    """
    world = RecordedWorld(recording)
    corrupted_world = guarded(Corrupted(world, corruption, seed), guards)
    driven = recording.driven
    if driven is None and clean is not None and clean.actions.ndim == 1:
        driven = movements(clean.actions)
    episode = world.episode()
    observation = corrupted_world.reset(episode)
    actions: list[int | np.ndarray] = []
    aims = []
    seen = {}
    contract = as_agent(agent)
    with instructed(agent, episode, corruption, seed, guards):
        for step in range(len(recording.times)):
            try:
                action = _decision(agent.act(observation), agent)
            except KeyError as error:
                raise ValueError(
                    f"{recording.name} lacks an input of {type(agent).__name__}: {error.args[0]}"
                ) from error
            if actions and np.shape(action) != np.shape(actions[0]):
                raise ValueError(
                    f"act() of {type(agent).__name__} must return actions of one shape, got "
                    f"{list(np.shape(actions[0]))} and {list(np.shape(action))}."
                )
            actions.append(action)
            aim = contract.aim
            aims.append((np.nan, np.nan) if aim is None else tuple(aim))
            if step in keep:
                seen[step] = {name: np.asarray(observation[name]) for name in recording.frames}
            if driven is not None:
                contract.taken(
                    int(driven.actions[step]),
                    float(driven.metres[step]),
                    float(driven.radians[step]),
                )
            observation = corrupted_world.step(action)
    return Answers(np.array(actions), np.array(aims, np.float64), seen)


def _decision(answer: Any, agent: Agent) -> int | np.ndarray:
    """Return the answer of an agent as a whole number, or as an array float [A] if continuous."""
    if isinstance(answer, (list, tuple)) or read(answer, "shape"):
        values = np.asarray(answer)
        if values.dtype.kind == "f" and values.size and np.isfinite(values).all():
            return values.astype(np.float64).reshape(-1)
    return action_of(answer, agent)


def named_action(action: Any) -> str | list[float]:
    """Return the name of a discrete action, or the rounded numbers of a continuous action."""
    if np.ndim(action):
        return [round(float(value), 4) for value in action]
    return ACTIONS.get(int(action), str(action))


def changed_steps(clean: Answers, corrupted: Answers) -> np.ndarray:
    """Return for each of the T steps whether the decision changed.

    A continuous action counts as changed if any of its components changes by more than
    ``MIN_ACTION_SHIFT`` times the range of that component. The range is taken over all steps on
    clean frames.
    """
    if clean.actions.ndim == 1:
        return clean.actions != corrupted.actions
    limit = MIN_ACTION_SHIFT * np.ptp(clean.actions, axis=0)
    return (np.abs(corrupted.actions - clean.actions) > limit + ROUNDING).any(1)


def neglected_actions(recordings: Sequence[Recording], clean: Mapping[str, Answers]) -> list[str]:
    """Return the actions that the driver takes often and that the agent rarely takes.

    Only the agent's actions on clean frames count. See ``OFTEN`` and ``RARELY`` for the limits.
    """
    drives = [r for r in recordings if r.driven is not None and clean[r.name].actions.ndim == 1]
    if not drives:
        return []
    driven = np.concatenate([r.driven.actions for r in drives if r.driven is not None])
    chosen = np.concatenate([clean[r.name].actions for r in drives])
    return [
        name
        for action, name in ACTIONS.items()
        if (driven == action).mean() >= OFTEN
        and (chosen == action).mean() < RARELY * (driven == action).mean()
    ]


def decision_lines(
    labels: dict[str, Any], recording: Recording, clean: Answers, corrupted: Answers
) -> list[dict[str, Any]]:
    """Return one JSON object per step.

    Each object contains ``labels`` and the decision with and without corruption.
    """
    lines = []
    for step, action in enumerate(corrupted.actions):
        aim = corrupted.aims[step]
        line = {
            **labels,
            "recording": recording.name,
            "step": step,
            "time": round(float(recording.times[step]), 3),
            "action": named_action(action),
            "clean": named_action(clean.actions[step]),
        }
        if recording.driven is not None:
            line["driver"] = ACTIONS.get(int(recording.driven.actions[step]), "other")
        if np.isfinite(aim).all():
            line["aim"] = [round(float(value), 3) for value in aim]
        lines.append(line)
    return lines


@dataclass(frozen=True)
class Changes:
    """Changes of an agent's decisions under one condition, over all drives.

    Attributes:
        changed: Fraction of steps at which the action differs from the action on clean frames
            (:func:`changed_steps`).
        stops: Number of steps with STOP under this condition but not on clean frames.
        missed: Number of steps with STOP on clean frames but not under this condition.
        aim: Fraction of steps at which the target position moved by more than ``MIN_AIM_SHIFT``, or
            None if the agent has no target position.
        agreement: Fraction of steps at which the agent chooses the driver's action. Steps at which
            no action matches the driver's motion are left out. The value is None if the driver's
            actions are unknown, or if the agent's actions are continuous.
        distance: Mean Euclidean distance of continuous actions from the actions on clean frames, or
            None if actions are discrete.
    """

    changed: Estimate
    stops: int
    missed: int
    aim: Estimate | None
    agreement: Estimate | None
    distance: Estimate | None = None


def compare(
    recordings: Sequence[Recording], clean: Mapping[str, Answers], corrupted: Mapping[str, Answers]
) -> Changes:
    """Compare decisions under corruption with those on clean frames; the keys are drive names."""
    pairs = [(clean[r.name], corrupted[r.name]) for r in recordings]
    changed = [changed_steps(a, b) for a, b in pairs]
    if pairs[0][0].actions.ndim == 2:
        gaps = [np.linalg.norm(b.actions - a.actions, axis=1) for a, b in pairs]
        return Changes(_share(changed), 0, 0, None, None, _mean(gaps))
    stops = sum(int(((b.actions == STOP) & (a.actions != STOP)).sum()) for a, b in pairs)
    missed = sum(int(((a.actions == STOP) & (b.actions != STOP)).sum()) for a, b in pairs)
    moved = [np.hypot(*(b.aims - a.aims).T) for a, b in pairs]
    moved = [part[np.isfinite(part)] > MIN_AIM_SHIFT for part in moved if np.isfinite(part).any()]
    agrees = []
    for recording in recordings:
        if recording.driven is not None:
            driver = recording.driven.actions
            same = corrupted[recording.name].actions == driver
            if (driver != NO_ACTION).any():
                agrees.append(same[driver != NO_ACTION])
    aim = _share(moved) if moved else None
    return Changes(_share(changed), stops, missed, aim, _share(agrees) if agrees else None)


def _share(drives: Sequence[np.ndarray]) -> Estimate:
    """Estimate the fraction of steps at which a drive of ``drives``, bool [T], is True.

    Where :func:`_mean` has no interval, Wilson's score interval is used; each block counts as one
    observation.
    """
    estimate = _mean(drives)
    if not np.isnan(estimate.low):
        return estimate
    count = sum(len(_blocks(drive)) for drive in drives)
    return Estimate(estimate.value, *bootstrap.wilson(estimate.value, count))


def _mean(drives: Sequence[np.ndarray]) -> Estimate:
    """Estimate the mean over all steps of the drives [T]; the bootstrap resamples blocks of steps.

    The interval is NaN if there are fewer than ``MIN_BLOCKS`` blocks, or if all blocks have equal
    means.
    """
    blocks = [block for drive in drives for block in _blocks(drive)]
    sums = np.array([block.sum() for block in blocks])
    steps = np.array([len(block) for block in blocks])
    if len(blocks) >= MIN_BLOCKS and np.ptp(sums / steps) > 0:
        return bootstrap.prs(steps, sums)  # sum(sums) / sum(steps)
    return Estimate(float(sums.sum() / steps.sum()), np.nan, np.nan)


def _blocks(drive: np.ndarray) -> list[np.ndarray]:
    """Split a drive into blocks of nearly equal length, with about ``BLOCK_STEPS`` steps each."""
    return np.array_split(drive.astype(float), max(1, round(len(drive) / BLOCK_STEPS)))
