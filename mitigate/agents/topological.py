"""The reference agent: perceive, extend the topological map, choose, walk.

``reset(instruction)`` starts an episode; ``act(observation)`` returns one low-level action. The
agent reads ``observation["rgb"]`` and ``["depth"]`` only when it takes a decision, so a lazy
observation renders nothing in between.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents import observation as checked
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.controller import Controller
from mitigate.agents.encoders import SIZE, DepthEncoder, RGBEncoder
from mitigate.agents.mapping import TopologicalMap
from mitigate.agents.planner import Planner, collate
from mitigate.agents.text import encode, pad
from mitigate.agents.waypoints import WaypointHead, select
from mitigate.keys import STOP, VIEWS

MAX_DECISIONS = 15  # ETPNav: 15 in R2R-CE
SENSORS = ("rgb", "depth", "instruction")


class TopologicalAgent(nn.Module):
    """ETPNav's structure with about 2.5 M parameters.

    Args:
        width: of view features of each sensor. planner: keyword arguments of ``Planner``.
        adapters: keyword arguments of ``insert_adapters``, for an agent with adapters.
        blind: sensors that are blanked before they enter (the ablations): of ``SENSORS``.
        size: pixels of a square view that it works on; frames of another size are resized.
    Raises ValueError for an unknown name in ``blind`` and a size that is no multiple of 16.
    """

    def __init__(
        self,
        width: int = 128,
        planner: dict[str, Any] | None = None,
        blind: tuple[str, ...] = (),
        adapters: dict[str, Any] | None = None,
        size: int = SIZE,
    ) -> None:
        super().__init__()
        unknown = set(blind) - set(SENSORS)
        if unknown:
            raise ValueError(
                f"blind={sorted(unknown)} is unknown; choose from {', '.join(SENSORS)}."
            )
        self.blind = tuple(blind)
        self.rgb_encoder = RGBEncoder(width=width, size=size)
        self.depth_encoder = DepthEncoder(width=width, size=size)
        self.waypoint_head = WaypointHead(width)
        self.planner = Planner(width, width, **(planner or {}))
        if adapters:
            insert_adapters(self, **adapters)

    @property
    def device(self) -> torch.device:
        return self.planner.places.weight.device

    # features: what recipes train and distil -------------------------------------------------

    def perceive(self, rgb: Tensor, depth: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Frames of P panoramas to named features.

        Args: rgb uint8 [P, 12, H, W, 3]; depth float32 metres [P, 12, H, W, 1].
        Returns views [P, 12, rgb + concepts + depth] (concepts as probabilities), concept logits
        [P, 12, C], waypoint logits [P, 120, 12].
        """
        rgb = torch.zeros_like(rgb) if "rgb" in self.blind else rgb
        depth = torch.zeros_like(depth) if "depth" in self.blind else depth
        return self.encode(rgb, depth)

    def encode(self, rgb: Tensor, depth: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """As :meth:`perceive`, whatever the agent is blind to."""
        rgb_features, concepts = self.rgb_encoder(rgb.flatten(0, 1))
        depth_features = self.depth_encoder(depth.flatten(0, 1)).unflatten(0, (-1, VIEWS))
        concepts = concepts.unflatten(0, (-1, VIEWS))
        views = torch.cat(
            [rgb_features.unflatten(0, (-1, VIEWS)), concepts.sigmoid(), depth_features], -1
        )
        return views, concepts, self.waypoint_head(depth_features)

    def tokens(self, instructions: list[str]) -> Tensor:
        """Instructions to padded token ids int64 [E, L]."""
        rows = [[1] if "instruction" in self.blind else encode(text) for text in instructions]
        return pad(rows).to(self.device)

    # closed loop ------------------------------------------------------------------------------

    def reset(self, instruction: str) -> None:
        """Start an episode. Raises TypeError if ``instruction`` is no string; warns if the agent
        knows none of its words."""
        checked.instruction(instruction)
        self.map, self.controller = TopologicalMap(), Controller()
        self.decisions = 0
        self._views: list[Tensor] = []
        self._stop_scores: list[tuple[float, int]] = []
        self._final = False
        with torch.no_grad():
            self._text = self.planner.read(self.tokens([instruction]))

    @torch.no_grad()
    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """One low-level action. Reads frames only when a decision is due.

        Raises RuntimeError before the first ``reset``, and what ``agents/observation.py`` refuses:
        KeyError, TypeError or ValueError for a missing entry, a wrong dtype, shape or unit.
        """
        if not hasattr(self, "controller"):
            raise RuntimeError("Start the episode first: agent.reset(instruction).")
        action = self.controller.action(checked.pose(observation))
        while action is None:
            if self._final or not self._decide(observation):
                return STOP
            action = self.controller.action(checked.pose(observation))
        return action

    def _decide(self, observation: Mapping[str, np.ndarray]) -> bool:
        """Take one decision: start a route and return True, or return False to stop."""
        rgb, depth = (
            torch.from_numpy(frame)[None].to(self.device) for frame in checked.frames(observation)
        )
        views, _, waypoints = self.perceive(rgb, depth)
        self._views.append(self.planner.look(views))
        pose = checked.pose(observation).astype(np.float64)
        self.map.add(pose, select(waypoints[0].float().cpu().numpy()))
        decision = self.map.decision(pose)
        logits = self.planner(
            self._text, torch.cat(self._views), collate([decision], [0], [0]).to(self.device)
        )["logits"][0]
        self.decisions += 1
        self._stop_scores.append((float(logits.softmax(0)[0]), self.map.current))
        best = int(logits.argmax())
        if best == 0 or not decision.ghosts:
            return False
        if self.decisions >= MAX_DECISIONS:
            return self._give_up()
        ghost = decision.ghosts[best - 1 - len(decision.nodes)]
        self.controller.follow(self.map.route(ghost))
        self.map.arrive(ghost)
        return True

    def _give_up(self) -> bool:
        """At the limit: walk to the visited node with the best stop score (as ETPNav) and stop."""
        self._final = True
        node = max(self._stop_scores)[1]
        self.controller.follow(self.map.route_to_node(node))
        return True
