"""The recurrent agent has one forward camera and a memory, and chooses one action per step.

The agent corresponds to VLN-CE's recurrent agents. With RGB only, it has the same input as
vision-language models with one camera.
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

from mitigate.agents import observation as checked
from mitigate.agents import schema
from mitigate.agents.adapters import insert_adapters
from mitigate.agents.agent import (
    Output,
    SideBySide,
    check_logits,
    check_started,
    entropy_of,
    stop_figures,
)
from mitigate.agents.encoders import (
    LABEL_LOSSES,
    LABELS,
    SIZE,
    CameraDepth,
    CameraRGB,
    encode_camera,
    presence_loss,
    see_camera,
)
from mitigate.agents.recurrent.policy import ACTIONS, Odometer, Policy, State, Text
from mitigate.agents.recurrent.rollout import Piece, TrainingWalk, WalkDecisions, piece_of
from mitigate.agents.text import MAX_WORDS, PAD, Vocabulary
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

# maximum number of steps in a training rollout (heuristic): the expert takes 53 steps on average
LIMIT = 90
_SCALE = 5.0  # unit of the predicted distance, in metres

POLICY = {  # allowed values of the keyword arguments of ``Policy``
    "width": schema.whole(4, 1024),
    "heads": schema.whole(1, 64),
    "text_layers": schema.whole(0, 32),
    "dropout": schema.number(0, 1),
}


@dataclass
class Walk:
    """Memory of one episode."""

    text: Text
    state: State
    odometer: Odometer
    before: tuple[State, np.ndarray] | None = None  # state and motion before the last decision


class RecurrentAgent(SideBySide, nn.Module):
    """Choose a low-level action at every step from one forward camera and a recurrent memory.

    Args:
        sensors: "rgb", "depth" or both; frames have the shape [H, W, c].
        rgb_width: number of RGB features per column of the view.
        depth_width: number of depth features per column of the view.
        policy: keyword arguments of ``Policy``.
        blind: inputs that are blanked for ablations; names of sensors, or "instruction".
        adapters: keyword arguments of ``insert_adapters``, or None for no adapters.
        size: side in pixels to which frames are resized.
        vocabulary: the words that the agent knows, or None for the words of the shipped agents.

    Raises:
        ValueError: If ``sensors`` is empty, or a name in ``sensors`` or ``blind`` is unknown.
    """

    # this name is part of published fingerprints, so it must not change
    fingerprint_kind = "mitigate.agents.recurrent.agent.RecurrentAgent"

    run_state = ("_walk",)
    settings_schema = {
        **schema.ENCODERS,
        "sensors": schema.some_of((RGB, DEPTH)),
        "rgb_width": schema.whole(4, 1024),
        "depth_width": schema.whole(4, 1024),
        "policy": POLICY,
        "vocabulary": schema.VOCABULARY,
    }
    sensors: tuple[str, ...]
    views = 1
    actions = ACTIONS
    # number of episodes at once (heuristic): an episode that runs alone takes 2.5 times as long
    together = 8
    loss_weights = {"distance": 0.3, "grounding": 0.3}
    _walk: Walk | None = None

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
        schema.check_blind(blind, (*sensors, "instruction"))
        if not sensors:
            raise ValueError("sensors must name rgb, depth or both, got [].")
        self._settings: dict[str, Any] = copy.deepcopy(
            {
                "rgb_width": rgb_width,
                "depth_width": depth_width,
                "policy": policy,
                "sensors": list(sensors),
                "blind": list(blind),
                "adapters": adapters,
                "size": size,
            }
        )
        self.sensors, self.blind = tuple(sensors), tuple(blind)
        self.encoders = {name: (f"{name}_encoder",) for name in self.sensors}
        self.labels = {name: LABELS[name] for name in self.sensors}
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
        """Return the constructor's arguments."""
        return {**self._settings, "vocabulary": list(self.vocabulary.words)}

    @property
    def device(self) -> torch.device:
        return self.policy.places.weight.device

    def tokens(self, instructions: list[str]) -> Tensor:
        """Return padded token ids int64 [E, L] of instructions."""
        return self.vocabulary.batch(instructions, "instruction" in self.blind).to(self.device)

    # training ---------------------------------------------------------------------------------

    def parts(self) -> dict[str, nn.Module]:
        """Return the encoders and the policy by name."""
        return dict(self.named_children())

    @torch.no_grad()
    def collect(
        self,
        worlds: Sequence[World],
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
        clean: bool = False,
    ) -> Piece:
        """Run episodes and return the decisions with the expert's answers (``agents/agent.py``).

        A rollout ends when the expert's STOP is executed, or after ``LIMIT`` steps. A STOP of the
        agent is never executed, so that the agent also learns from the steps after a wrong STOP.
        The result is plain data. If the encoders are frozen, the result holds their features
        instead of frames.
        """
        walks = [TrainingWalk(w, e, self.sensors) for w, e in zip(worlds, episodes, strict=True)]
        text = self.policy.read(self.tokens([e.instruction.text for e in episodes]))
        state, running = State.start(text), list(range(len(walks)))
        weights = self.named_parameters()
        keep_frames = any(p.requires_grad for name, p in weights if not name.startswith("policy."))
        for _ in range(LIMIT):
            rows, here = torch.tensor(running, device=self.device), [walks[i] for i in running]
            looks = [walk.see(walk.observation) for walk in here]
            frames = {name: np.stack([look[name] for look in looks]) for name in self.sensors}
            views = self._encode(frames)
            moves = torch.from_numpy(np.stack([walk.odometer.moves() for walk in here]))
            fresh = self.policy.step(
                text.rows(rows),
                self.policy.embed_views(views),
                moves.to(self.device),
                state.rows(rows),
            )
            state.put(rows, fresh)
            logits = check_logits(self.policy.answer(fresh.hidden), self)
            chances = logits.double().softmax(-1).cpu().numpy()
            for row, i in enumerate(running):
                features = {} if keep_frames else {"views": views[row].float().cpu().numpy()}
                walks[i].record(features, clean, keep_frames)
                walks[i].go(chances[row], expert_share, rngs[i])
            running = [i for i in running if not worlds[i].done]
            if not running:
                break
        return piece_of(walks)

    def precompute(self, piece: Piece, *, clean: bool) -> Piece:
        """If ``clean`` is set, replace clean frames by their features."""
        sensors = {f"clean_{name}": name for name in self.sensors}
        if clean and all(entry in piece["seen"] for entry in sensors):
            frames = {name: piece["seen"].pop(entry).numpy() for entry, name in sensors.items()}
            piece["seen"]["clean_views"] = self._encode(frames).float().cpu()
        return piece

    def join(self, pieces: Sequence[Piece]) -> WalkDecisions:
        """Join the rollouts of several pieces into one batch."""
        lengths = [n for piece in pieces for n in piece["lengths"]]
        names = [name for piece in pieces for name in piece["ids"]]
        seen = {n: torch.cat([p["seen"][n] for p in pieces]) for n in pieces[0]["seen"]}
        answer = torch.cat([piece["answer"] for piece in pieces])
        return WalkDecisions(
            walk=torch.repeat_interleave(torch.arange(len(lengths)), torch.tensor(lengths)),
            time=torch.cat([torch.arange(n) for n in lengths]),
            **{n: torch.cat([p[n] for p in pieces]) for n in ("moves", "weight", "metres")},
            tokens=self.tokens([text for piece in pieces for text in piece["texts"]]),
            target=F.one_hot(answer, self.actions).float(),
            seen=seen,
            episode_ids=[name for name, n in zip(names, lengths, strict=True) for _ in range(n)],
        )

    def decide(self, decisions: WalkDecisions, *, clean: bool = False) -> Output:
        """Return logits over actions, and the features "views" [N, F] and "state" [N, width]."""
        seen, prefix = decisions.seen, "clean_" if clean else ""
        losses: dict[str, Tensor] = {}
        views = seen.get(f"{prefix}views")
        if views is None:
            frames = {name: seen[f"{prefix}{name}"] for name in self.sensors}
            views, losses = self._perceive(frames, {} if clean else seen)
        text = self.policy.read(decisions.tokens)
        padded = self.policy(text, decisions.padded(views), decisions.padded(decisions.moves))
        out = {name: value[decisions.walk, decisions.time] for name, value in padded.items()}
        known = torch.isfinite(decisions.metres)
        if known.any():
            target = decisions.metres[known] / _SCALE
            losses["distance"] = F.smooth_l1_loss(out["distance"][known], target)
        if "goal" in seen:
            losses["grounding"] = presence_loss(out["grounding"], seen["goal"])
        figures = stop_figures(out["logits"], decisions.target)
        features = {"views": views, "state": out["state"]}
        return Output(out["logits"], features, losses, figures)

    def see(self, sensor: str, frames: Tensor, truth: Tensor | None = None) -> Output:
        """Return view features of a sensor's frames (``agents/agent.py``)."""
        return see_camera(self.get_submodule(f"{sensor}_encoder"), sensor, frames, truth)

    @torch.no_grad()
    def _encode(self, frames: dict[str, np.ndarray]) -> Tensor:
        """Return features [N, F] of frames [N, H, W, c], without gradients."""
        on = {name: torch.from_numpy(f).to(self.device) for name, f in frames.items()}
        return self._perceive(on, {})[0]

    def _perceive(
        self, frames: dict[str, Tensor], truth: dict[str, Tensor]
    ) -> tuple[Tensor, dict[str, Tensor]]:
        """Return features [N, F] of frames, and the encoders' losses for labels in ``truth``."""
        views, losses = [], {}
        for sensor in (name for name in (RGB, DEPTH) if name in self.sensors):
            seen = torch.zeros_like(frames[sensor]) if sensor in self.blind else frames[sensor]
            features, logits = encode_camera(self.get_submodule(f"{sensor}_encoder"), sensor, seen)
            views.append(features)
            label = LABELS[sensor]
            if label in truth:
                losses[label] = LABEL_LOSSES[sensor](logits, truth[label])
        return torch.cat(views, -1), losses

    # closed loop ------------------------------------------------------------------------------

    @torch.inference_mode()
    def begin(self, instruction: str) -> Walk:
        """Return the memory of a new episode; warn if all words of ``instruction`` are unknown.

        Raises:
            TypeError: If ``instruction`` is not a string.
        """
        checked.instruction(instruction, self.vocabulary)
        tokens = self.tokens([instruction])
        # pad to one length, so that texts of several episodes can be joined
        tokens = F.pad(tokens, (0, MAX_WORDS - tokens.shape[1]), value=PAD)
        text = self.policy.read(tokens)
        return Walk(text, State.start(text), Odometer())

    @torch.inference_mode()
    def answers(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Walk], count: int
    ) -> list[int]:
        frames = {
            name: np.stack([checked.frame(seen, name, 1) for seen in observations])
            for name in self.sensors
        }
        columns = self.policy.embed_views(self._encode(frames))
        motions = [walk.odometer.moves() for walk in memories]
        moves = torch.from_numpy(np.stack(motions))
        text = Text(*map(torch.cat, zip(*(walk.text for walk in memories), strict=True)))
        state = State.join([walk.state for walk in memories])
        state = self.policy.step(text, columns, moves.to(self.device), state)
        logits = check_logits(self.policy.answer(state.hidden), self)
        actions = logits.argmax(-1).tolist()[:count]
        for row, (walk, action) in enumerate(zip(memories, actions, strict=False)):
            walk.before = walk.state, motions[row]
            walk.state = state.rows(torch.tensor([row], device=self.device))
            walk.odometer.add(action)
        return actions

    def reset(self, instruction: str) -> None:
        """Start an episode; see :meth:`begin`."""
        self._walk = self.begin(instruction)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        check_started(self._walk is not None)
        return self.answers([observation], [self._walk], 1)[0]  # type: ignore[list-item]

    def entropy(self, observation: Mapping[str, np.ndarray]) -> Tensor:
        """Return the entropy of the last decision, with gradients (``KnowsEntropy``)."""
        walk = self._walk
        assert walk is not None and walk.before is not None, "act first"
        frames = {name: np.array(checked.frame(observation, name, 1)) for name in self.sensors}
        on = {name: torch.from_numpy(f)[None].to(self.device) for name, f in frames.items()}
        columns = self.policy.embed_views(self._perceive(on, {})[0])
        before, motion = walk.before
        # copied, because tensors that were created in inference mode cannot be used with gradients
        text = Text(*(part.clone() for part in walk.text))
        state = State(*(part.clone() for part in before))
        moves = torch.from_numpy(motion)[None].to(self.device)
        return entropy_of(
            self.policy.answer(self.policy.step(text, columns, moves, state).hidden)[0]
        )

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Correct the odometry: the agent did not make the motion that it chose last."""
        assert self._walk is not None, "reset first"
        self._walk.odometer.correct(action, metres, radians)
