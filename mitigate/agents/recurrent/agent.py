"""The recurrent agent: one forward camera, a memory, a low-level action at every step.

It stands where VLN-CE's recurrent agents do, with RGB alone where single-camera language models
do. ``reset(instruction)`` starts an episode; ``act(observation)`` returns one low-level action.
``begin`` and ``act_all`` do the same for several episodes side by side.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents import camera
from mitigate.agents import observation as checked
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.agent import Output, check_logits
from mitigate.agents.camera import CameraDepth, CameraRGB
from mitigate.agents.encoders import SIZE
from mitigate.agents.recurrent import learning
from mitigate.agents.recurrent.learning import Piece, WalkDecisions
from mitigate.agents.recurrent.odometer import Odometer
from mitigate.agents.recurrent.policy import ACTIONS, Policy, State, Text
from mitigate.agents.text import MAX_WORDS, PAD, Vocabulary, pad
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World


@dataclass
class Walk:
    """What it remembers of an episode: words and state of one row, and its steps."""

    text: Text
    state: State
    odometer: Odometer


class RecurrentAgent(nn.Module):
    """Args:
    sensors: "rgb", "depth" or both; frames are [H, W, c] of one camera that looks ahead.
    rgb_width, depth_width: of the features of a column of the view. policy: keyword arguments of
    ``Policy``. adapters: keyword arguments of ``insert_adapters``, for an agent with adapters.
    blind: of its sensors and "instruction", what is blanked before it enters (the ablations).
    size: pixels of a square view that it works on; frames of another size are resized.
    vocabulary: the words it knows; None: those of the shipped agents.
    Raises ValueError for an unknown name in ``sensors`` or ``blind``, and for no sensor.
    """

    fingerprint_kind = "mitigate.agents.recurrent.agent.RecurrentAgent"  # in published fingerprints

    views = 1
    actions = ACTIONS
    together = 8  # episodes side by side (ours): a step of one costs 2.5 times as much alone
    loss_weights = learning.LOSS_WEIGHTS

    def __init__(
        self,
        sensors: Sequence[str] = (RGB, DEPTH),
        rgb_width: int = 96,
        depth_width: int = 64,
        policy: dict[str, Any] | None = None,
        blind: Sequence[str] = (),
        adapters: dict[str, Any] | None = None,
        size: int = SIZE,
        vocabulary: list[str] | None = None,
    ) -> None:
        super().__init__()
        for name in sensors:
            if name not in (RGB, DEPTH):
                raise ValueError(unknown("sensor", name, (RGB, DEPTH)))
        for name in blind:
            if name not in (*sensors, "instruction"):
                raise ValueError(
                    unknown("sense to blank (agent.blind)", name, (*sensors, "instruction"))
                )
        if not sensors:
            raise ValueError("sensors=[] leaves the agent nothing to see: name rgb, depth or both.")
        given: dict[str, Any] = {
            "rgb_width": rgb_width,
            "depth_width": depth_width,
            "policy": policy,
        }
        given |= {"sensors": list(sensors), "blind": list(blind), "adapters": adapters}
        self._settings = copy.deepcopy({**given, "size": size})
        self.sensors, self.blind = tuple(sensors), tuple(blind)
        self.encoders = {name: camera.ENCODERS[name] for name in self.sensors}
        self.labels = {name: camera.LABELS[name] for name in self.sensors}
        self.vocabulary = Vocabulary(vocabulary)
        if RGB in sensors:
            self.rgb_encoder = CameraRGB(width=rgb_width, size=size)
        if DEPTH in sensors:
            self.depth_encoder = CameraDepth(width=depth_width, size=size)
        widths = (rgb_width if RGB in sensors else 0, depth_width if DEPTH in sensors else 0)
        self.policy = Policy(*widths, vocabulary=self.vocabulary, **(policy or {}))
        if adapters:
            insert_adapters(self, **{**adapters, "views": 1})

    def settings(self) -> dict[str, Any]:
        """All that makes it besides weights: what its config must say."""
        return {**self._settings, "vocabulary": list(self.vocabulary.words)}

    @property
    def device(self) -> torch.device:
        return self.policy.places.weight.device

    def tokens(self, instructions: list[str]) -> Tensor:
        """Instructions to padded token ids int64 [E, L]."""
        encode = self.vocabulary.encode
        rows = [[1] if "instruction" in self.blind else encode(text) for text in instructions]
        return pad(rows).to(self.device)

    # training (``learning.py``) -----------------------------------------------------------------

    def parts(self) -> dict[str, nn.Module]:
        """Its encoders and its policy by name."""
        return dict(self.named_children())

    def collect(self, worlds: Sequence[World], episodes: Sequence[Episode], **how: Any) -> Piece:
        """Walk episodes with the expert's answers; see :func:`learning.collect`."""
        return learning.collect(self, worlds, episodes, **how)

    def precompute(self, piece: Piece, *, clean: bool) -> Piece:
        """Features in place of frames; see :func:`learning.precompute`."""
        return learning.precompute(self, piece, clean=clean)

    def join(self, pieces: Sequence[Piece]) -> WalkDecisions:
        """Pieces of :meth:`collect` as one batch."""
        return learning.join(self, pieces)

    def decide(self, decisions: WalkDecisions, *, clean: bool = False) -> Output:
        """Logits over the actions; see :func:`learning.decide`."""
        return learning.decide(self, decisions, clean=clean)

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """View features of a sensor's frames; see :func:`camera.see`."""
        encoder = self.rgb_encoder if sensor == RGB else self.depth_encoder
        return camera.see(encoder, sensor, frames, truth)

    # closed loop ------------------------------------------------------------------------------

    @torch.inference_mode()
    def begin(self, instruction: str) -> Walk:
        """What it remembers of an episode. Raises TypeError if ``instruction`` is no string; warns
        if the agent knows none of its words."""
        checked.instruction(instruction, self.vocabulary)
        tokens = self.tokens([instruction])
        tokens = F.pad(tokens, (0, MAX_WORDS - tokens.shape[1]), value=PAD)  # all of one length
        text = self.policy.read(tokens)
        return Walk(text, State.start(text), Odometer())

    @torch.inference_mode()
    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Walk]
    ) -> list[int]:
        """The likeliest action of each of up to ``together`` episodes. Raises what
        ``agents/observation.py`` refuses."""
        count = len(memories)
        spare = self.together - count  # filled up: sums then round alike for any number of episodes
        observations = [*observations, *[observations[-1]] * spare]
        return self._answers(observations, [*memories, *[memories[-1]] * spare], count)

    def _answers(
        self, observations: Sequence[Mapping[str, np.ndarray]], walks: Sequence[Walk], count: int
    ) -> list[int]:
        """Actions of the first ``count``, whose memories change."""
        frames = {
            name: np.stack([checked.frame(seen, name, 1) for seen in observations])
            for name in self.sensors
        }
        columns = self.policy.look(learning.encode(self, frames))
        moves = torch.from_numpy(np.stack([walk.odometer.moves() for walk in walks]))
        text = Text(*map(torch.cat, zip(*(walk.text for walk in walks), strict=True)))
        state = State.join([walk.state for walk in walks])
        state = self.policy.step(text, columns, moves.to(self.device), state)
        logits = check_logits(self.policy.answer(state.hidden), self)
        actions = logits.argmax(-1).tolist()[:count]
        for row, (walk, action) in enumerate(zip(walks, actions, strict=False)):
            walk.state = state.rows(torch.tensor([row], device=self.device))
            walk.odometer.add(action)
        return actions

    def reset(self, instruction: str) -> None:
        """Start an episode; see :meth:`begin`."""
        self._walk = self.begin(instruction)

    @torch.inference_mode()
    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """The likeliest action. Raises RuntimeError before the first ``reset``, and what
        ``agents/observation.py`` refuses."""
        if not hasattr(self, "_walk"):
            raise RuntimeError("Start the episode first: agent.reset(instruction).")
        return self._answers([observation], [self._walk], 1)[0]

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Somebody else drives: count what was done in place of the last answer."""
        self._walk.odometer.correct(action, metres, radians)
