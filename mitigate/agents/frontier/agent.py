"""The frontier agent searches for an object: it turns around, builds a map and follows frontiers.

A frontier is the border between known and unknown space. The agent goes to the most promising
frontier until the object is found, and then to the object. The method follows VLFM, L3MVN and
WMNav. Only the RGB encoder, which recognises objects, is learned.
"""

from __future__ import annotations

import copy
import re
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents import observation as checked
from mitigate.agents import schema
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.agent import Output, SideBySide, check_started
from mitigate.agents.controller import Controller
from mitigate.agents.encoders import LABELS, SIZE, CameraRGB, see_camera
from mitigate.agents.frontier.grid import (
    CELL,
    Grid,
    Routes,
    clear_ahead,
    frontiers,
    object_cells,
    routes,
)
from mitigate.agents.text import CONCEPTS, NEAR, ROOM_NAMES, THING_NAMES
from mitigate.core.observation import (
    DEPTH,
    FORWARD,
    FORWARD_METRES,
    LEFT,
    POSE,
    RGB,
    RIGHT,
    STOP,
    TURN_DEGREES,
)

TURNS = 18  # initial turns: after 270 degrees, a 90-degree camera has seen the full circle
AGAIN = 8  # number of actions until the agent plans again
LEG = 1.5  # distance in metres that the agent goes straight before it checks its route again
STUCK = 0.05  # a forward step that moves less than this distance (metres) was blocked
# If a forward step moves less than SLID metres, the agent has slid along an obstacle.
# After BUMPS such steps on the way to the object, the agent acts as if it had arrived.
SLID, BUMPS = 0.2, 4
LAST = 400  # after this many actions, the agent goes to the most likely known place and stops
WORTH = 6.0  # weight of a frontier's value against path cost in metres (chosen on val_seen_ogn)
# The agent goes to the object if the evidence for it is at least FOUND.
# After LAST actions, the agent uses the lower threshold MAYBE instead.
FOUND, MAYBE = 4.0, 1.0
TRIES = 12  # maximum number of attempts to plan in one step
# the agent stops if the predicted probability that the object is near exceeds this
NEAR_ENOUGH = 0.4
ARRIVED = 0.9  # maximum distance in metres from the object's cells at which the agent stops
# weight of the distance from a cell to the object's centre; path cost has weight 1 (heuristic)
MIDDLE = 3.0
# objects that each room is likely to contain; L3MVN asks a language model for these
LIKELY = {
    "bedroom": ("bed", "wardrobe", "lamp", "rug"),
    "bathroom": ("toilet", "bathtub", "sink", "washing machine"),
    "kitchen": ("fridge", "stove", "sink", "cabinet", "table"),
    "living room": ("sofa", "armchair", "tv", "bookshelf", "plant", "painting", "rug", "lamp"),
    "office": ("desk", "chair", "bookshelf", "lamp"),
    "dining room": ("table", "chair", "cabinet", "painting"),
}
ROOM_SHARE = 0.3  # weight of seeing a likely room, relative to seeing the object itself (heuristic)
_ROOMS = slice(len(CONCEPTS) - len(ROOM_NAMES), len(CONCEPTS))


class FrontierAgent(SideBySide, nn.Module):
    """Search for an object by going to frontiers of a map (object-goal tasks).

    Args:
        width: features per column of the view.
        adapters: keyword arguments of ``insert_adapters``, or None for no adapters.
        blind: inputs to blank for ablations: "rgb", "depth" or "instruction".
        size: side in pixels to which frames are resized.
        eye: height of the camera above the floor in metres.

    Raises:
        ValueError: If a name in ``blind`` is unknown.
    """

    # this name is part of published fingerprints, so it must not change
    fingerprint_kind = "mitigate.agents.frontier.agent.FrontierAgent"

    run_state = ("_started", "actions")
    settings_schema = {
        **schema.ENCODERS,
        "width": schema.whole(4, 1024),
        "eye": schema.number(0.05, 5),
    }
    views, sensors = 1, (RGB, DEPTH, POSE)
    tasks = ("ogn",)
    # number of episodes at once (heuristic): a frame takes twice as long if it is encoded alone
    together = 8
    encoders = {RGB: ("rgb_encoder",)}
    labels = {RGB: LABELS[RGB]}
    grid: Grid  # set at the first observation of an episode
    _started = False

    def __init__(
        self,
        width: int = 96,
        adapters: dict[str, Any] | None = None,
        blind: tuple[str, ...] = (),
        size: int = SIZE,
        eye: float = 1.25,
    ) -> None:
        super().__init__()
        schema.check_blind(blind)
        self._settings = copy.deepcopy(
            {"width": width, "adapters": adapters, "blind": list(blind), "size": size, "eye": eye}
        )
        self.blind, self.eye = tuple(blind), eye
        self.rgb_encoder = CameraRGB(width=width, size=size)
        if adapters:
            insert_adapters(self, **{**adapters, "views": 1})

    def settings(self) -> dict[str, Any]:
        """Return the constructor's arguments."""
        return copy.deepcopy(self._settings)

    def parts(self) -> dict[str, nn.Module]:
        """Return a dict that maps the encoder's name to the encoder."""
        return {"rgb_encoder": self.rgb_encoder}

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """Return view features of RGB frames."""
        return see_camera(self.rgb_encoder, sensor, frames, truth)

    # closed loop ------------------------------------------------------------------------------

    def reset(self, instruction: str) -> None:
        """Start an episode; warn if ``instruction`` names no object that the agent knows.

        Raises:
            TypeError: If ``instruction`` is not a string.
        """
        if not isinstance(instruction, str):
            raise TypeError(f"instruction must be a string, got a {type(instruction).__name__}.")
        self.thing = None if "instruction" in self.blind else named(instruction)
        if self.thing is None and "instruction" not in self.blind:
            warnings.warn(
                f"The instruction {instruction[:60]!r} names no object that the agent knows.",
                stacklevel=2,
            )
        self._started = True
        self.controller = Controller()
        self.actions = self._planned = self._bumps = 0
        self._before: np.ndarray | None = None  # position before the last forward step

    def begin(self, instruction: str) -> FrontierAgent:
        """Return a copy that shares the weights and holds the state of one new episode."""
        runner = copy.copy(self)
        runner.reset(instruction)
        return runner

    def answers(
        self,
        observations: Sequence[Mapping[str, np.ndarray]],
        memories: Sequence[FrontierAgent],
        count: int,
    ) -> list[int]:
        concepts = self._recognise(np.stack([checked.frame(o, RGB, 1) for o in observations]))
        episodes = [*zip(memories, observations, concepts, strict=True)][:count]
        return [runner._act(observation, columns) for runner, observation, columns in episodes]

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        check_started(self._started)
        return self.answers([observation], [self], 1)[0]

    def _act(self, observation: Mapping[str, np.ndarray], concepts: np.ndarray) -> int:
        """Return an action; ``concepts`` [4, C] holds each concept's probability in each column."""
        pose = checked.pose(observation).astype(np.float64)
        self._update_map(observation, pose, concepts)
        self.actions += 1
        action = LEFT if self.actions <= TURNS else self._walk(pose)
        self._before = pose[:2] if action == FORWARD else None
        return action

    def taken(self, action: int, metres: float, radians: float) -> None:
        self._planned = 0  # plan again at the next step
        if action != FORWARD:
            self._before = None

    @property
    def aim(self) -> np.ndarray | None:  # type: ignore[override]
        """Position [x, y] in metres where the current straight part of the route ends, or None."""
        return self.controller.route[-1] if self.controller.route else None

    def _update_map(
        self, observation: Mapping[str, np.ndarray], pose: np.ndarray, concepts: np.ndarray
    ) -> None:
        """Add an observation to the map.

        If the last forward step was too short, mark the cells ahead as blocked.
        """
        if self.actions == 0:
            self.grid = Grid(pose, self.eye)
        if self._before is not None:
            moved = float(np.hypot(*(pose[:2] - self._before)))
            self._bumps += moved < SLID
            if moved < STUCK:
                self.grid.block(pose)
                self._planned = 0
        depth = checked.frame(observation, DEPTH, 1)[..., 0]
        thing = np.zeros((len(concepts), 2), np.float32)
        if self.thing is not None:
            thing = concepts[:, [self.thing, NEAR.start + self.thing]]
        depth = np.zeros_like(depth) if DEPTH in self.blind else depth
        self._near = float(thing[:, 1].max())
        self.grid.add(depth, pose, thing, worth(concepts, self.thing))

    @torch.inference_mode()
    def _recognise(self, rgb: np.ndarray) -> np.ndarray:
        """Return concept probabilities [n, 4, C] for 4 columns of each frame in [n, H, W, 3]."""
        rgb = np.zeros_like(rgb) if RGB in self.blind else rgb
        device = self.rgb_encoder.embed.weight.device
        _, logits = self.rgb_encoder(torch.from_numpy(rgb).to(device))
        return logits.float().sigmoid().cpu().numpy()

    def _walk(self, pose: np.ndarray) -> int:
        """Return the next action of the plan; plan again if needed."""
        action = self.controller.action(pose) if self._planned > 0 else None
        self._planned -= 1
        for _ in range(TRIES):  # a part of the route may end at the agent's position
            if action is not None:
                return action
            action = self._plan(pose)
        return LEFT

    def _plan(self, pose: np.ndarray) -> int | None:
        """Choose a target and return an action, or None if no action is needed to reach it."""
        ways, late = routes(self.grid, pose[:2]), self.actions > LAST
        thing = object_cells(self.grid, MAYBE if late else FOUND)
        target = self._beside(ways, thing)
        if target is not None and (self._at(target, pose) or self._bumps >= BUMPS):
            self._bumps = 0
            return STOP if late else self._check(thing, pose)
        if target is None:
            if late:
                return STOP
            self._bumps = 0
            target = self._frontier(ways)
            if target is None:
                self.actions = LAST
                return None
            if self._at(target, pose):
                # the unknown cells around this frontier cannot be observed
                self.grid.settle(target)
                return None
        step = clear_ahead(self.grid, ways.to(target), LEG)
        self.controller.follow([self.grid.place(step[None])[0]])
        self._planned = AGAIN
        return self.controller.action(pose)

    def _check(self, thing: np.ndarray, pose: np.ndarray) -> int | None:
        """Turn to the object's cells, and stop if the object is visible nearby.

        If the object is not visible, discard the evidence of these cells.
        """
        dx, dy = self.grid.place(thing).mean(0) - pose[:2]
        error = np.arctan2(-dx, dy) - pose[2]
        error = np.degrees((error + np.pi) % (2 * np.pi) - np.pi)
        if abs(error) > TURN_DEGREES / 2 + 0.1:
            return LEFT if error > 0 else RIGHT
        if self._near > NEAR_ENOUGH:
            return STOP
        self.grid.doubt(thing)
        return None

    def _at(self, target: np.ndarray, pose: np.ndarray) -> bool:
        """Return whether the agent is within one step of ``target``."""
        return bool(np.hypot(*(self.grid.place(target[None])[0] - pose[:2])) < FORWARD_METRES)

    def _beside(self, ways: Routes, thing: np.ndarray) -> np.ndarray | None:
        """Return the best cell [2] within ``ARRIVED`` of the object, or None.

        The choice balances path cost and distance to the object's centre.
        """
        reach = int(ARRIVED / CELL)
        steps = np.arange(-reach, reach + 1)
        around = np.stack(np.meshgrid(steps, steps, indexing="ij"), -1).reshape(-1, 2)
        around = around[np.hypot(around[:, 0], around[:, 1]) < reach]
        cells = np.unique((thing[:, None] + around[None]).reshape(-1, 2), axis=0)
        if not len(cells):
            return None
        evidence = self.grid.evidence[thing[:, 0], thing[:, 1]]
        centre = (thing * evidence[:, None]).sum(0) / evidence.sum()
        distance = np.hypot(*(cells - centre).T) * CELL
        cost = ways.at(cells) + MIDDLE * distance
        return cells[int(cost.argmin())] if np.isfinite(cost.min()) else None

    def _frontier(self, ways: Routes) -> np.ndarray | None:
        """Return the nearest cell [2] of the best frontier, or None if there is no frontier.

        The best frontier has the highest difference between its value and its path cost.
        """
        best, target = -np.inf, None
        for group in frontiers(self.grid):
            cost = ways.at(group)
            value = float(self.grid.value[group[:, 0], group[:, 1]].max())
            gain = WORTH * value - cost.min()  # -inf for a frontier that cannot be reached
            if gain > best:
                best, target = gain, group[int(cost.argmin())]
        return target


def named(text: str) -> int | None:
    """Return the index in ``THING_NAMES`` of the object named last in ``text``, or None.

    In a route description, the object named last is the goal. An instruction such as "find a chair"
    names only one object.
    """
    ends = [
        (match.end(), len(name), i)
        for i, name in enumerate(THING_NAMES)
        for match in re.finditer(rf"\b{re.escape(name)}s?\b", text.lower())
    ]
    return max(ends)[2] if ends else None


def worth(concepts: np.ndarray, thing: int | None) -> np.ndarray:
    """Return the likelihood [n] that the object lies in the direction of each column.

    The likelihood is high if the column shows the object. It is lower if the column only shows a
    room that is likely to contain the object.
    """
    if thing is None:
        return np.zeros(len(concepts), np.float32)
    name = THING_NAMES[thing]
    rooms = np.array([float(name in LIKELY[room]) for room in ROOM_NAMES], np.float32)
    return np.maximum(concepts[:, thing], ROOM_SHARE * (concepts[:, _ROOMS] * rooms).max(1))
