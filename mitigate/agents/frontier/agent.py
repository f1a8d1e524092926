"""The frontier agent: look around, map, go to the most promising frontier, walk up to the object.

It stands where VLFM, L3MVN and WMNav do: nothing of it is learned but what recognises objects, its
RGB encoder. ``reset(instruction)`` starts an episode; ``act(observation)`` returns one low-level
action. ``begin`` and ``act_all`` do the same for several episodes side by side.
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
from mitigate.agents.encoders import CAMERA_ENCODERS, CAMERA_LABELS, SIZE, CameraRGB, see_camera
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
from mitigate.core.names import unknown
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

TURNS = 18  # at the start: 270 degrees, with a view of 90 all around
AGAIN = 8  # actions until it plans anew
LEG = 1.5  # metres that it goes straight before it looks at its route again
STUCK = 0.05  # metres of a step forward below which something is in the way
SLID, BUMPS = 0.2, 4  # metres of a step that slid along something; so many end the way to an object
LAST = 400  # actions until it goes to the likeliest place that it knows and stops
WORTH = 6.0  # metres of way that a frontier of value 1 is worth (chosen on val_seen_ogn)
FOUND, MAYBE = 4.0, 1.0  # evidence for the object to go there, and to go there in the end
TRIES = 12  # plans in one instant
NEAR_ENOUGH = 0.4  # probability that the object is near, at which it stops in front of it
ARRIVED = 0.9  # metres from the object's cells within which it stops
MIDDLE = 3.0  # metres of way that a metre nearer to the object's middle is worth (ours)
# the agent's common sense: in which rooms a thing is likely. L3MVN asks a language model for it.
LIKELY = {
    "bedroom": ("bed", "wardrobe", "lamp", "rug"),
    "bathroom": ("toilet", "bathtub", "sink", "washing machine"),
    "kitchen": ("fridge", "stove", "sink", "cabinet", "table"),
    "living room": ("sofa", "armchair", "tv", "bookshelf", "plant", "painting", "rug", "lamp"),
    "office": ("desk", "chair", "bookshelf", "lamp"),
    "dining room": ("table", "chair", "cabinet", "painting"),
}
ROOM_SHARE = 0.3  # what a likely room counts against the object itself (ours)
_ROOMS = slice(len(CONCEPTS) - len(ROOM_NAMES), len(CONCEPTS))


class FrontierAgent(SideBySide, nn.Module):
    """Args: width: of the features of a column of the view. adapters: keyword arguments of
    ``insert_adapters``, for an encoder with adapters. blind: of "rgb", "depth" and "instruction",
    what is blanked before it enters (the ablations). size: pixels of a square view that it works
    on. eye: metres of the camera above the floor.

    Raises ValueError for an unknown name in ``blind``.
    """

    fingerprint_kind = "mitigate.agents.frontier.agent.FrontierAgent"  # in published fingerprints

    run_state = ("_started", "actions")
    settings_schema = schema.Schema(
        {**schema.ENCODERS, "width": schema.whole(4, 1024), "eye": schema.number(0.05, 5)}
    )
    views, sensors = 1, (RGB, DEPTH, POSE)
    tasks = ("ogn",)  # it finds objects, it follows no routes
    together = 8  # episodes side by side (ours): encoding one frame alone takes twice as long
    encoders = {RGB: CAMERA_ENCODERS[RGB]}
    labels = {RGB: CAMERA_LABELS[RGB]}
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
        for name in blind:
            if name not in schema.SENSES:
                raise ValueError(unknown("sense to blank (agent.blind)", name, schema.SENSES))
        self._settings = copy.deepcopy(
            {"width": width, "adapters": adapters, "blind": list(blind), "size": size, "eye": eye}
        )
        self.blind, self.eye = tuple(blind), eye
        self.rgb_encoder = CameraRGB(width=width, size=size)
        if adapters:
            insert_adapters(self, **{**adapters, "views": 1})

    def settings(self) -> dict[str, Any]:
        """All that makes it besides weights: what its config must say."""
        return copy.deepcopy(self._settings)

    def parts(self) -> dict[str, nn.Module]:
        """Its encoder by name."""
        return {"rgb_encoder": self.rgb_encoder}

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """View features of RGB frames."""
        return see_camera(self.rgb_encoder, sensor, frames, truth)

    # closed loop ------------------------------------------------------------------------------

    def reset(self, instruction: str) -> None:
        """Start an episode. Raises TypeError if ``instruction`` is no string; warns if it names
        nothing that the agent knows."""
        if not isinstance(instruction, str):
            raise TypeError(f"An instruction is a string, not {type(instruction).__name__}.")
        self.thing = None if "instruction" in self.blind else named(instruction)
        if self.thing is None and "instruction" not in self.blind:
            warnings.warn(
                f"The instruction {instruction[:60]!r} names no object that the agent knows, so it "
                "explores until nothing is left.",
                stacklevel=2,
            )
        self._started = True
        self.grid: Grid | None = None
        self.controller = Controller()
        self.actions = self._planned = self._bumps = 0
        self._before: np.ndarray | None = None  # where the last step forward began

    def begin(self, instruction: str) -> FrontierAgent:
        """An episode of its own: a copy that shares the weights. As :meth:`reset`."""
        walker = copy.copy(self)
        walker.reset(instruction)
        return walker

    def answers(
        self,
        observations: Sequence[Mapping[str, np.ndarray]],
        memories: Sequence[FrontierAgent],
        count: int,
    ) -> list[int]:
        """One low-level action of each of the first ``count`` episodes; frames are encoded at
        once."""
        known = self._recognise(np.stack([checked.frame(seen, RGB, 1) for seen in observations]))
        walking = [*zip(memories, observations, known, strict=True)][:count]
        return [walker._act(seen, concepts) for walker, seen, concepts in walking]

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """One low-level action. Raises RuntimeError before the first ``reset``, and what
        ``agents/observation.py`` refuses."""
        check_started(self._started)
        return self.answers([observation], [self], 1)[0]

    def _act(self, observation: Mapping[str, np.ndarray], concepts: np.ndarray) -> int:
        """``concepts`` [4, C]: probabilities of what the columns of the frame show."""
        pose = checked.pose(observation).astype(np.float64)
        self._look(observation, pose, concepts)
        self.actions += 1
        action = LEFT if self.actions <= TURNS else self._walk(pose)
        self._before = pose[:2] if action == FORWARD else None
        return action

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Somebody else drives: forget the route, and plan anew at the next step."""
        self._planned = 0
        if action != FORWARD:
            self._before = None

    @property
    def aim(self) -> np.ndarray | None:  # type: ignore[override]
        """Where the leg that it walks ends, plan metres [2], or None."""
        return self.controller.route[-1] if self.controller.route else None

    def _look(
        self, observation: Mapping[str, np.ndarray], pose: np.ndarray, concepts: np.ndarray
    ) -> None:
        """Lay what is seen over the map."""
        if self.grid is None:
            self.grid = Grid(pose, self.eye)
        if self._before is not None:
            self._bump(pose, float(np.hypot(*(pose[:2] - self._before))))
        depth = checked.frame(observation, DEPTH, 1)[..., 0]
        thing = np.zeros((len(concepts), 2), np.float32)
        if self.thing is not None:
            thing = shows(concepts, self.thing)
        depth = np.zeros_like(depth) if DEPTH in self.blind else depth
        self._near = float(thing[:, 1].max())
        self.grid.add(depth, pose, thing, worth(concepts, self.thing))

    def _bump(self, pose: np.ndarray, gone: float) -> None:
        """Take note of a step forward of ``gone`` metres: was something in the way?"""
        assert self.grid is not None
        self._bumps += gone < SLID
        if gone < STUCK:
            self.grid.block(pose)
            self._planned = 0

    @torch.inference_mode()
    def _recognise(self, rgb: np.ndarray) -> np.ndarray:
        """Probabilities [n, 4, C] of what the columns of frames [n, H, W, 3] show."""
        rgb = np.zeros_like(rgb) if RGB in self.blind else rgb
        device = self.rgb_encoder.embed.weight.device
        _, logits = self.rgb_encoder(torch.from_numpy(rgb).to(device))
        return logits.float().sigmoid().cpu().numpy()

    def _walk(self, pose: np.ndarray) -> int:
        """The next action towards where it is worth going."""
        action = self.controller.action(pose) if self._planned > 0 else None
        self._planned -= 1
        for _ in range(TRIES):  # a leg may end where the agent stands
            if action is not None:
                return action
            action = self._plan(pose)
        return LEFT

    def _plan(self, pose: np.ndarray) -> int | None:
        """Choose where to go, and return an action, or None if there is nothing to do there."""
        assert self.grid is not None
        ways, late = routes(self.grid, pose[:2]), self.actions > LAST
        thing = object_cells(self.grid, MAYBE if late else FOUND)
        target = self._beside(ways, thing)
        if target is not None and (self._at(target, pose) or self._bumps >= BUMPS):
            self._bumps = 0
            return STOP if late else self._check(thing, pose)
        if target is None and not late:
            self._bumps = 0
            target = self._frontier(ways)
            if target is not None and self._at(target, pose):
                self.grid.settle(target)  # what is unknown there cannot be seen
                return None
        if target is None and not late:
            self.actions = LAST
            return None
        if target is None:
            return STOP
        step = clear_ahead(self.grid, ways.to(target), LEG)
        self.controller.follow([self.grid.place(step[None])[0]])
        self._planned = AGAIN
        return self.controller.action(pose)

    def _check(self, thing: np.ndarray, pose: np.ndarray) -> int | None:
        """Standing at the object's cells: face them, and stop if it is seen near there; if not,
        they are forgotten."""
        assert self.grid is not None
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
        """Whether the agent stands at ``target``, as near as its steps allow."""
        assert self.grid is not None
        return bool(np.hypot(*(self.grid.place(target[None])[0] - pose[:2])) < FORWARD_METRES)

    def _beside(self, ways: Routes, thing: np.ndarray) -> np.ndarray | None:
        """The cell [2] within ``ARRIVED`` of the object that is cheap to reach and near its middle;
        None if there is none."""
        assert self.grid is not None
        reach = int(ARRIVED / CELL)
        steps = np.arange(-reach, reach + 1)
        around = np.stack(np.meshgrid(steps, steps, indexing="ij"), -1).reshape(-1, 2)
        around = around[np.hypot(around[:, 0], around[:, 1]) < reach]
        cells = np.unique((thing[:, None] + around[None]).reshape(-1, 2), axis=0)
        if not len(cells):
            return None
        sure = self.grid.evidence[thing[:, 0], thing[:, 1]]
        middle = (thing * sure[:, None]).sum(0) / sure.sum()
        away = np.hypot(*(cells - middle).T) * CELL
        cost = ways.at(cells) + MIDDLE * away
        return cells[int(cost.argmin())] if np.isfinite(cost.min()) else None

    def _frontier(self, ways: Routes) -> np.ndarray | None:
        """The cell [2] of the frontier that is worth most, less the way there."""
        assert self.grid is not None
        best, found = -np.inf, None
        for group in frontiers(self.grid):
            cost = ways.at(group)
            nearest = int(cost.argmin())
            value = float(self.grid.value[group[:, 0], group[:, 1]].max())
            if np.isfinite(cost[nearest]) and WORTH * value - cost[nearest] > best:
                best, found = WORTH * value - cost[nearest], group[nearest]
        return found


def named(text: str) -> int | None:
    """The index of the thing that is named last in ``text``, of ``THING_NAMES``; None if none is.
    A route ends at what is named last; a plain "find a chair" names one thing alone."""
    ends = [
        (match.end(), len(name), i)
        for i, name in enumerate(THING_NAMES)
        for match in _finds(name, text)
    ]
    return max(ends)[2] if ends else None


def _finds(name: str, text: str) -> list[re.Match]:
    return list(re.finditer(rf"\b{re.escape(name)}s?\b", text.lower()))


def shows(concepts: np.ndarray, thing: int) -> np.ndarray:
    """Of the probabilities [n, C] of what columns show, those of ``thing`` and of it near."""
    return concepts[:, [thing, NEAR.start + thing]]


def worth(concepts: np.ndarray, thing: int | None) -> np.ndarray:
    """How likely the thing is where columns look: [n], from it and from the rooms that show."""
    if thing is None:
        return np.zeros(len(concepts), np.float32)
    name = THING_NAMES[thing]
    rooms = np.array([float(name in LIKELY[room]) for room in ROOM_NAMES], np.float32)
    return np.maximum(concepts[:, thing], ROOM_SHARE * (concepts[:, _ROOMS] * rooms).max(1))
