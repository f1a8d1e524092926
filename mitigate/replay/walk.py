"""An agent taken along a recorded drive: what it would do at each step, whoever drives.

How much a corruption changes of its decisions is compared with intervals.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.agents.agent import Agent, as_agent
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.corruptions import Corruption
from mitigate.evaluation import bootstrap
from mitigate.evaluation.bootstrap import Estimate
from mitigate.evaluation.episode import action_of, instructed
from mitigate.guards.guard import NO_GUARDS, Guards, guarded
from mitigate.worlds.recorded import RecordedWorld, Recording
from mitigate.worlds.recorded.recording import NONE, answered
from mitigate.worlds.world import Corrupted

ACTIONS = {STOP: "stop", FORWARD: "forward", LEFT: "left", RIGHT: "right"}
FAR = 0.5  # metres, two steps (ours)
FEW = 8  # runs of steps that are too few to be resampled (ours)
BLOCK = 10  # consecutive steps that are drawn as one: neighbours are alike (ours)


@dataclass(frozen=True)
class Answers:
    """What an agent answered along a drive of T steps.

    actions: int [T]. aims: float [T, 2], plan metres that it is walking to, NaN where it has none.
    seen: the frames of some steps as it saw them.
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
    """Show ``agent`` the drive under ``corruption`` and return its answers.

    After each it is told what the driver did (``taken``, ``agents/agent.py``). Where that is not
    known, it is told what it answered on clean frames (``clean``; None: this is that walk), so that
    nothing but frames and words differs. ``keep``: steps whose frames are returned.
    ``guards``: in front of the agent. Raises ValueError if the drive lacks what the agent reads.
    """
    world = RecordedWorld(recording)
    met = guarded(Corrupted(world, corruption, seed), guards)
    done = recording.driven if clean is None else recording.driven or answered(clean.actions)
    episode = world.episode()
    observation = met.reset(episode)
    actions, aims, seen = [], [], {}
    contract = as_agent(agent)
    with instructed(agent, episode, corruption, seed, guards):
        for step in range(len(recording.times)):
            try:
                action = action_of(agent.act(observation), agent)
            except KeyError as error:
                raise ValueError(
                    f"{recording.name} does not fit {type(agent).__name__}: {error.args[0]}"
                ) from error
            actions.append(action)
            aim = contract.aim
            aims.append((np.nan, np.nan) if aim is None else tuple(aim))
            if step in keep:
                seen[step] = {name: np.asarray(observation[name]) for name in recording.frames}
            if done is not None:
                here = done.actions[step], done.metres[step], done.radians[step]
                contract.taken(int(here[0]), float(here[1]), float(here[2]))
            observation = met.step(action)
    return Answers(np.array(actions), np.array(aims, np.float64), seen)


def lines(
    told: dict[str, Any], recording: Recording, clean: Answers, found: Answers
) -> list[dict[str, Any]]:
    """One entry a step: ``told``, and what the agent answered, on clean frames too."""
    made = []
    for step, action in enumerate(found.actions):
        aim = found.aims[step]
        line = {
            **told,
            "recording": recording.name,
            "step": step,
            "time": round(float(recording.times[step]), 3),
            "action": ACTIONS.get(int(action), str(action)),
            "clean": ACTIONS.get(int(clean.actions[step]), str(clean.actions[step])),
        }
        if recording.driven is not None:
            line["driver"] = ACTIONS.get(int(recording.driven.actions[step]), "other")
        if np.isfinite(aim).all():
            line["aim"] = [round(float(value), 3) for value in aim]
        made.append(line)
    return made


@dataclass(frozen=True)
class Changes:
    """Of an agent under one condition, over all drives.

    changed: share of the steps whose action differs from that on clean frames. stops, missed: steps
    at which it stops and did not, and the other way round. aim: share of the steps at which the
    point that it walks to moved by more than ``FAR``, None if it has none. agreement: share of the
    steps at which it does what the driver did, of those that one of its actions can name, or None
    where that is not known. steps: how many.
    """

    changed: Estimate
    stops: int
    missed: int
    aim: Estimate | None
    agreement: Estimate | None
    steps: int


def compare(
    recordings: Sequence[Recording], clean: Mapping[str, Answers], found: Mapping[str, Answers]
) -> Changes:
    """Compare answers with those on clean frames, by the drives' names."""
    pairs = [(clean[r.name], found[r.name]) for r in recordings]
    changed = [a.actions != b.actions for a, b in pairs]
    stops = sum(int(((b.actions == STOP) & (a.actions != STOP)).sum()) for a, b in pairs)
    missed = sum(int(((a.actions == STOP) & (b.actions != STOP)).sum()) for a, b in pairs)
    moved = [np.hypot(*(b.aims - a.aims).T) for a, b in pairs]
    moved = [part[np.isfinite(part)] > FAR for part in moved if np.isfinite(part).any()]
    known = [(r.driven.actions, found[r.name].actions) for r in recordings if r.driven is not None]
    agrees = [(mine == his)[his != NONE] for his, mine in known if (his != NONE).any()]
    return Changes(
        _share(changed),
        stops,
        missed,
        _share(moved) if moved else None,
        _share(agrees) if agrees else None,
        sum(map(len, changed)),
    )


def _share(walks: Sequence[np.ndarray]) -> Estimate:
    """The share of true steps with its interval: by resampling runs of ``BLOCK`` steps, or, of
    fewer than ``FEW`` runs or runs that are alike, Wilson's score interval, each run counting
    once."""
    blocks = [part for walk in walks for part in _blocks(walk)]
    true, steps = (np.array([measure(part) for part in blocks]) for measure in (np.sum, len))
    value = float(true.sum() / steps.sum())
    if len(blocks) >= FEW and np.ptp(true / steps) > 0:
        return bootstrap.ratio(true, steps)
    n, z = len(blocks), bootstrap.Z
    middle = (value + z * z / (2 * n)) / (1 + z * z / n)
    half = z * np.sqrt(value * (1 - value) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return Estimate(value, max(0.0, float(middle - half)), min(1.0, float(middle + half)))


def _blocks(walk: np.ndarray) -> list[np.ndarray]:
    """Runs of about ``BLOCK`` steps, alike in length."""
    return np.array_split(walk.astype(float), max(1, round(len(walk) / BLOCK)))
