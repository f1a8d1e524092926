"""The recurrent agent: one forward camera, a memory, a low-level action at every step.

It stands where VLN-CE's recurrent agents do, with RGB alone where single-camera language models
do. ``reset(instruction)`` starts an episode; ``act(observation)`` returns one low-level action.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents import camera
from mitigate.agents import observation as checked
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.agent import Output
from mitigate.agents.camera import CameraDepth, CameraRGB
from mitigate.agents.encoders import SIZE
from mitigate.agents.recurrent import learning
from mitigate.agents.recurrent.learning import Piece, WalkDecisions
from mitigate.agents.recurrent.odometer import Odometer
from mitigate.agents.recurrent.policy import ACTIONS, Policy, State
from mitigate.agents.text import Vocabulary, pad
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World


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

    views = 1
    actions = ACTIONS
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
                raise ValueError(unknown("sensor in blind", name, (*sensors, "instruction")))
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
            insert_adapters(self, **adapters, views=1)

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
    def reset(self, instruction: str) -> None:
        """Start an episode. Raises TypeError if ``instruction`` is no string; warns if the agent
        knows none of its words."""
        checked.instruction(instruction, self.vocabulary)
        self._text = self.policy.read(self.tokens([instruction]))
        self._state, self._odometer = State.start(self._text), Odometer()

    @torch.inference_mode()
    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """The likeliest action. Raises RuntimeError before the first ``reset``, and what
        ``agents/observation.py`` refuses."""
        if not hasattr(self, "_odometer"):
            raise RuntimeError("Start the episode first: agent.reset(instruction).")
        frames = {name: checked.frame(observation, name, 1)[None] for name in self.sensors}
        columns = self.policy.look(learning.encode(self, frames))
        moves = torch.from_numpy(self._odometer.moves())[None].to(self.device)
        self._state = self.policy.step(self._text, columns, moves, self._state)
        action = int(self.policy.answer(self._state.hidden)[0].argmax())
        self._odometer.add(action)
        return action

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Somebody else drives: count what was done in place of the last answer."""
        self._odometer.correct(action, metres, radians)
