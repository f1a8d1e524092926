"""The reference agent extends its topological map at each decision and goes to a ghost node.

The agent reads ``observation["rgb"]`` and ``["depth"]`` only when it decides, so that a lazy
observation renders frames only for decisions.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents import observation as checked
from mitigate.agents import schema
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.agent import (
    Agent,
    Output,
    check_logits,
    check_started,
    entropy_of,
    stop_figures,
)
from mitigate.agents.controller import Controller
from mitigate.agents.encoders import (
    LABELS,
    SIZE,
    DepthEncoder,
    RGBEncoder,
    agreement,
    f1,
    free_loss,
    label_output,
    presence_loss,
)
from mitigate.agents.text import THINGS, Vocabulary
from mitigate.agents.topological.mapping import Decision, TopologicalMap
from mitigate.agents.topological.perception import ImageNetEncoder, WaypointHead, select
from mitigate.agents.topological.planner import Planner, collate
from mitigate.agents.topological.rollout import LiveWalk, MapDecisions, Piece, join, roll_out
from mitigate.core import names
from mitigate.core.memory import Memory
from mitigate.core.observation import CLEAN_DEPTH, CLEAN_RGB, DEPTH, POSE, RGB, STOP, VIEWS
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

# only for type checkers, because the module imports tensordict, whose import is as slow as torch's
if TYPE_CHECKING:
    from mitigate.agents.topological.stored import Store

MAX_DECISIONS = 15  # maximum number of decisions; ETPNav uses 15 in R2R-CE
PERCEPTION = ("rgb_encoder", "depth_encoder", "waypoint_head")
_SCALE = 5.0  # the planner predicts distances in metres divided by this number
OWN, IMAGENET = RGB_ENCODERS = ("own", "efficientnet_lite0")
# names of the frozen modules of the ImageNet encoder
BORROWED = ("rgb_encoder.stem", "rgb_encoder.stages")
FEATURES = 1 << 25  # maximum size of cached features in bytes (heuristic): about 900 panoramas

PLANNER = {  # allowed values of the keyword arguments of ``Planner``
    "width": schema.whole(4, 1024),
    "heads": schema.whole(1, 64),
    "text_layers": schema.whole(0, 32),
    "layers": schema.whole(0, 32),
    "dropout": schema.number(0, 1),
    "fusion": {
        "learned": schema.TRUTH,
        "rate": schema.number(0, 1e6),
        "cap": schema.number(0, 1e6),
    },
}


class TopologicalAgent(Agent, nn.Module):
    """Agent with the structure of ETPNav and about 2.5 M parameters.

    Args:
        width: number of view features for each sensor.
        planner: keyword arguments of ``Planner``.
        blind: inputs to blank for ablations, from ``schema.SENSES``.
        adapters: keyword arguments of ``insert_adapters``, or None for no adapters.
        size: side in pixels to which frames are resized.
        vocabulary: the words that the agent knows, or None for the words of the shipped agents.
        encoder: the RGB encoder: "own", or "efficientnet_lite0" (``perception.py``). The pretrained
            layers of that encoder are frozen; only adapters and the layers after them are trained.
            With that encoder, ``size`` applies only to RGB, and depth stays at 64 pixels.

    Raises:
        ValueError: If a name in ``blind`` is unknown, or ``size`` is not a multiple of 16.
    """

    # this name is part of published fingerprints, so it must not change
    fingerprint_kind = "mitigate.agents.topological.agent.TopologicalAgent"

    run_state = ("_memory", "_started")
    settings_schema = {
        **schema.ENCODERS,
        "width": schema.whole(4, 1024),
        "planner": PLANNER,
        "vocabulary": schema.VOCABULARY,
        "encoder": schema.one_of(RGB_ENCODERS),
    }
    views, sensors = VIEWS, (RGB, DEPTH, POSE)
    rgb_encoder: RGBEncoder
    _started = False

    def __init__(
        self,
        width: int = 128,
        planner: dict[str, Any] | None = None,
        blind: tuple[str, ...] = (),
        adapters: dict[str, Any] | None = None,
        size: int = SIZE,
        vocabulary: list[str] | None = None,
        encoder: str = OWN,
    ) -> None:
        super().__init__()
        if encoder not in RGB_ENCODERS:
            raise ValueError(names.unknown("encoder", encoder, RGB_ENCODERS))
        schema.check_blind(blind)
        self.blind = tuple(blind)
        self._settings: dict[str, Any] = copy.deepcopy(
            {
                "width": width,
                "planner": planner,
                "blind": list(blind),
                "adapters": adapters,
                "size": size,
            }
        )
        if encoder != OWN:
            self._settings["encoder"] = encoder
        self._memory: Memory | None = None
        if encoder == IMAGENET:
            self.rgb_encoder, self.frozen = ImageNetEncoder(width, size), BORROWED
            size = SIZE  # use the same depth encoder as the base agent
        else:
            self.rgb_encoder = RGBEncoder(width=width, size=size)
        self.depth_encoder = DepthEncoder(width=width, size=size)
        self.waypoint_head = WaypointHead(width)
        self.vocabulary = Vocabulary(vocabulary)
        self.planner = Planner(width, width, vocabulary=self.vocabulary, **(planner or {}))
        if adapters:
            insert_adapters(self, **adapters)

    def settings(self) -> dict[str, Any]:
        """Return the constructor's arguments."""
        return {**self._settings, "vocabulary": list(self.vocabulary.words)}

    @property
    def device(self) -> torch.device:
        return self.planner.places.weight.device

    # features, which training recipes use ----------------------------------------------------

    def perceive(self, rgb: Tensor, depth: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Encode P panoramas; inputs in ``blind`` are blanked.

        Args:
            rgb: uint8 [P, 12, H, W, 3].
            depth: float32 metres [P, 12, H, W, 1].

        Returns:
            View features [P, 12, rgb + concepts + depth], which contain the probabilities of
            concepts; the concept logits [P, 12, C]; and the waypoint logits [P, 120, 12].
        """
        rgb = torch.zeros_like(rgb) if "rgb" in self.blind else rgb
        depth = torch.zeros_like(depth) if "depth" in self.blind else depth
        features, concepts = self.encode_rgb(rgb)
        depth_features, waypoints = self.encode_depth(depth)
        return torch.cat([features, concepts.sigmoid(), depth_features], -1), concepts, waypoints

    def encode_rgb(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        """Return features [P, 12, width] and concept logits [P, 12, C]."""
        features, concepts = self.rgb_encoder(rgb.flatten(0, 1))
        views = rgb.shape[1]
        return features.unflatten(0, (-1, views)), concepts.unflatten(0, (-1, views))

    def encode_depth(self, depth: Tensor) -> tuple[Tensor, Tensor]:
        """Return features [P, 12, width] and waypoint logits [P, 120, 12]."""
        features = self.depth_encoder(depth.flatten(0, 1)).unflatten(0, (-1, VIEWS))
        return features, self.waypoint_head(features)

    def tokens(self, instructions: list[str]) -> Tensor:
        """Return padded token ids int64 [E, L] of instructions."""
        return self.vocabulary.batch(instructions, "instruction" in self.blind).to(self.device)

    # training ---------------------------------------------------------------------------------

    # These are the weights of the auxiliary losses, chosen for the shipped agents.
    # The planner predicts the distance to the goal.
    # It also predicts the views that show the goal's landmark ("grounding").
    # Perception predicts the concepts in each view, and free space (the loss called "waypoints").
    loss_weights = {"distance": 0.3, "grounding": 0.3, "concepts": 2.0, "waypoints": 2.0}
    encoders = {RGB: ("rgb_encoder",), DEPTH: ("depth_encoder", "waypoint_head")}
    labels = LABELS
    plain_walks = False
    stored_parts = ("planner",)  # modules that can be trained on stored features

    def store(self, world: Callable[[], Any], folder: str, **variants: Any) -> Store:
        """Return stored features of all scenes of a world, for training without rendering."""
        from mitigate.agents.topological.stored import Store

        return Store(self, world, folder, **variants)

    def parts(self) -> dict[str, nn.Module]:
        """Return the two encoders, the waypoint head and the planner by name."""
        return dict(self.named_children())

    def as_teacher(self) -> TopologicalAgent:
        """Return a copy without adapters that averages views with equal weights."""
        teacher = super().as_teacher()
        teacher.planner.fusion = None
        return teacher

    def collect(
        self,
        worlds: Sequence[World],
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
        clean: bool = False,
    ) -> Piece:
        """Run episodes and return the decisions with the oracle's answers (``agents/agent.py``).

        If the perception is frozen, the result holds features instead of frames.
        """
        weights = self.named_parameters()
        trains = any(p.requires_grad for name, p in weights if name.startswith(PERCEPTION))
        labels = ("concepts", "free", "goal") if trains else ("goal",)
        walks = [LiveWalk(w, e, labels, clean) for w, e in zip(worlds, episodes, strict=True)]

        def perceive(running: list[LiveWalk]) -> list[tuple[np.ndarray, np.ndarray]]:
            for walk in running:
                walk.record()
            newest = [walk.records[-1] for walk in running]
            frames = (np.stack([record[name] for record in newest]) for name in (RGB, DEPTH))
            views, waypoints = self._encode_arrays(*frames)
            return [(v, select(w)) for v, w in zip(views, waypoints, strict=True)]

        traces = roll_out(
            self.planner,
            self.tokens([e.instruction.text for e in episodes]),
            walks,
            perceive,
            expert_share=expert_share,
            rngs=rngs,
        )
        records = [record for walk in walks for record in walk.records]
        names = [name for name in records[0] if trains or name not in (RGB, DEPTH)]
        seen = {name: np.stack([record[name] for record in records]) for name in names}
        if not trains:
            seen["views"] = np.stack([view for trace in traces for view in trace.views])
        return Piece(traces, seen)

    def precompute(self, piece: Piece, *, clean: bool) -> Piece:
        """If ``clean`` is true, replace the clean frames by their features."""
        if clean and CLEAN_RGB in piece.seen:
            views, _ = self._encode_arrays(piece.seen.pop(CLEAN_RGB), piece.seen.pop(CLEAN_DEPTH))
            piece.seen["clean_views"] = views
        return piece

    def join(self, pieces: Sequence[Piece]) -> MapDecisions:
        """Join the results of :meth:`collect` into one padded batch."""
        return join(pieces, self.tokens)

    def decide(self, decisions: MapDecisions, *, clean: bool = False) -> Output:
        """Return the logits over [stop] and ghost nodes, and the features.

        The features are "views" [P, 12, F] and "nodes" [n, width].
        """
        views, losses, figures = self._features_of(decisions, clean)
        planner, valid = self.planner, decisions.valid
        out = planner(planner.read(decisions.tokens), planner.embed_views(views), decisions)
        distance = F.smooth_l1_loss(out["distance"], decisions.metres / _SCALE, reduction="none")
        planner_losses = {"distance": (distance * valid).sum() / valid.sum()}
        if decisions.goal is not None:
            planner_losses["grounding"] = presence_loss(out["grounding"], decisions.goal)
        features = {"views": views, "nodes": out["nodes"][valid]}
        figures |= stop_figures(out["logits"], decisions.target)
        losses = {**planner_losses, **losses}
        return Output(out["logits"], features, losses, figures)

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """Return the view features of one sensor's frames (``agents/agent.py``).

        The features of RGB frames include the probabilities of concepts.
        """
        if sensor == DEPTH:
            features, logits = self.encode_depth(frames)
        else:
            features, logits = self.encode_rgb(frames)
            features = torch.cat([features, logits.sigmoid()], -1)
        return label_output(features, logits, sensor, truth)

    @torch.no_grad()
    def _encode_arrays(self, rgb: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return view features and waypoint logits of panoramas, without gradients."""
        frames = (torch.from_numpy(array).to(self.device) for array in (rgb, depth))
        views, _, waypoints = self.perceive(*frames)
        return views.float().cpu().numpy(), waypoints.float().cpu().numpy()

    def _features_of(
        self, decisions: MapDecisions, clean: bool
    ) -> tuple[Tensor, dict[str, Tensor], dict[str, Tensor]]:
        """Return view features [P, 12, F], losses and metrics.

        Losses and metrics are empty unless perception is being trained.
        """
        if clean:
            if decisions.clean_views is not None:
                return decisions.clean_views, {}, {}
            # the objective keeps them if its constructor calls rollouts.keep_clean()
            if decisions.clean_rgb is None or decisions.clean_depth is None:
                raise ValueError(
                    "The batch contains no clean frames. Call rollouts.keep_clean() in the "
                    "constructor of the objective."
                )
            return self.perceive(decisions.clean_rgb, decisions.clean_depth)[0], {}, {}
        if decisions.views is not None:
            return decisions.views, {}, {}
        assert decisions.rgb is not None and decisions.depth is not None
        views, concepts, waypoints = self.perceive(decisions.rgb, decisions.depth)
        losses, figures = {}, {}
        if decisions.concepts is not None:
            losses["concepts"] = presence_loss(concepts, decisions.concepts)
            figures["f1"] = f1(concepts[..., THINGS], decisions.concepts[..., THINGS])
        if decisions.free is not None:
            losses["waypoints"] = free_loss(waypoints, decisions.free)
            figures["iou"] = agreement(waypoints, decisions.free)
        return views, losses, figures

    # closed loop ------------------------------------------------------------------------------

    @contextmanager
    def remembering(self) -> Iterator[None]:
        """Cache the features of recent frames, so that identical frames are encoded only once.

        Actions do not change, because equal frames have equal features. The weights must not
        change inside the context. In training mode, no features are cached.
        """
        before, self._memory = self._memory, Memory(FEATURES)
        try:
            yield
        finally:
            self._memory = before

    def reset(self, instruction: str) -> None:
        """Start an episode; warn if the agent knows no word of ``instruction``.

        Raises:
            TypeError: If ``instruction`` is not a string.
        """
        checked.instruction(instruction, self.vocabulary)
        self.map, self.controller = TopologicalMap(), Controller()
        self._started = True
        self.decisions = 0
        self._view_tokens: list[Tensor] = []
        self._stop_scores: list[tuple[float, int]] = []
        self._chosen: int | None = None  # the ghost node to which the agent moves
        self._final = False
        with torch.inference_mode():
            self._text = self.planner.read(self.tokens([instruction]))

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """Return one low-level action; read frames only when a decision is due.

        Raises:
            RuntimeError: If ``reset`` was not called.
            KeyError, TypeError, ValueError: If an entry of the observation is missing or has a
                wrong dtype, shape or unit.
        """
        check_started(self._started)
        self._decided: Decision | None = None  # the last decision in this call of act
        while (action := self.controller.action(checked.pose(observation))) is None:
            if self._final or not self._decide(observation):
                return STOP
        return action

    def entropy(self, observation: Mapping[str, np.ndarray]) -> Tensor | None:
        """Return the entropy of the last decision, with gradients (``KnowsEntropy``)."""
        if self._decided is None:
            return None
        rgb, depth = (torch.from_numpy(np.array(f))[None] for f in checked.frames(observation))
        views = self.perceive(rgb.to(self.device), depth.to(self.device))[0]
        # these are copies, because tensors created in inference mode have no gradients
        earlier = [view.clone() for view in self._view_tokens[:-1]]
        text = tuple(part.clone() for part in self._text)
        batch = collate([self._decided], [0], [0]).to(self.device)
        tokens = torch.cat([*earlier, self.planner.embed_views(views)])
        return entropy_of(self.planner(text, tokens, batch)["logits"][0])

    def taken(self, action: int, metres: float, radians: float) -> None:
        self.controller = Controller()  # without a route, the agent decides at its next step
        self._chosen = None
        self.decisions = 0  # the limit counts only decisions since the last intervention
        self._final = False

    @property
    def aim(self) -> np.ndarray | None:  # type: ignore[override]
        """The end [x, y] of the agent's route in metres, or None without a route."""
        return self.controller.route[-1] if self.controller.route else None

    @torch.inference_mode()
    def _decide(self, observation: Mapping[str, np.ndarray]) -> bool:
        """Make one decision: start a route and return True, or return False to stop."""
        views, waypoints = self._encode_panorama(*checked.frames(observation))
        self._view_tokens.append(self.planner.embed_views(views))
        pose = checked.pose(observation).astype(np.float64)
        if self._chosen is not None:
            self.map.arrive(self._chosen)
            self._chosen = None
        self.map.add(pose, waypoints)
        decision = self._decided = self.map.decision(pose)
        logits = self.planner(
            self._text, torch.cat(self._view_tokens), collate([decision], [0], [0]).to(self.device)
        )["logits"][0]
        self.decisions += 1
        self._stop_scores.append((float(logits.softmax(0)[0]), self.map.current))
        best = int(check_logits(logits, self).argmax())
        if best == 0 or not decision.ghosts:
            return False
        if self.decisions >= MAX_DECISIONS:
            # stop at the visited node with the best stop score, as ETPNav does
            self._final = True
            self.controller.follow(self.map.route_to_node(max(self._stop_scores)[1]))
            return True
        ghost = decision.ghosts[best - 1 - len(decision.nodes)]
        self.controller.follow(self.map.route(ghost))
        self._chosen = ghost
        return True

    def _encode_panorama(self, rgb: np.ndarray, depth: np.ndarray) -> tuple[Tensor, np.ndarray]:
        """Return view features [1, 12, ...] and waypoints [n, 2] of one panorama."""
        features, concepts = self._encode_once("rgb", rgb, self.encode_rgb)
        depth_features, waypoints = self._encode_once("depth", depth, self.encode_depth)
        views = torch.cat([features, concepts.sigmoid(), depth_features], -1)
        return views, select(waypoints[0].float().cpu().numpy())

    def _encode_once(
        self, sensor: str, frames: np.ndarray, encode: Callable[[Tensor], tuple]
    ) -> tuple:
        """Apply ``encode`` to frames [12, H, H, c]; use the cache of :meth:`remembering`."""
        frames = np.zeros_like(frames) if sensor in self.blind else frames

        def encoded() -> tuple:
            return encode(torch.from_numpy(frames)[None].to(self.device))

        if self._memory is None or self.training:
            return encoded()
        digest = blake2b(frames.data, digest_size=16).digest()
        return self._memory.recall((sensor, frames.shape, digest), encoded)
