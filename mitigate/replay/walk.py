"""An agent taken along a recorded drive: what it would do at each step, whoever drives."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.agents.agent import Agent, as_agent
from mitigate.core.observation import FORWARD, LEFT, RIGHT, STOP
from mitigate.corruptions import Corruption
from mitigate.evaluation.episode import action_of, instructed
from mitigate.guards.guard import NO_GUARDS, Guards, guarded
from mitigate.worlds.recorded import RecordedWorld, Recording
from mitigate.worlds.recorded.recording import answered
from mitigate.worlds.world import Corrupted

ACTIONS = {STOP: "stop", FORWARD: "forward", LEFT: "left", RIGHT: "right"}


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
