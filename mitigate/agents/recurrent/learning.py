"""How the recurrent agent is trained: it walks under an expert, and answers whole walks again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from mitigate.agents import observation as checked
from mitigate.agents.agent import Output, check_logits
from mitigate.agents.camera import free_metres
from mitigate.agents.losses import free_loss, presence_loss
from mitigate.agents.recurrent.odometer import Odometer
from mitigate.agents.recurrent.policy import State
from mitigate.core.observation import DEPTH, POSE, RGB, STOP, Observation
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of

if TYPE_CHECKING:
    from mitigate.agents.recurrent.agent import RecurrentAgent

LOSS_WEIGHTS = {"distance": 0.3, "grounding": 0.3}
INFLECTION = 3.2  # weight of a step at which the expert changes its action (VLN-CE)
LIMIT = 90  # steps of a training walk (ours): the expert takes 53 on average
_SCALE, _FARTHEST = 5.0, 25.0  # metres: the unit of the predicted distance; it learns no more
Piece = dict[str, Any]


@dataclass
class WalkDecisions:
    """All N steps of E walks: walk, time int64 [N] place each; moves [N, MOVES]; tokens [E, L];
    target [N, 4]; weight [N]; metres [N] to the goal, NaN where unknown.

    seen: what was seen, by name: features "views" and "clean_views" [N, F], or frames "rgb", ...,
    "clean_rgb", ... [N, H, W, c]; and the world's labels.
    """

    walk: Tensor
    time: Tensor
    moves: Tensor
    tokens: Tensor
    target: Tensor
    weight: Tensor
    metres: Tensor
    seen: dict[str, Tensor]
    episode_ids: list[str]

    def to(self, device: Any) -> WalkDecisions:
        """Return the steps on ``device``."""
        moved: dict[str, Any] = {
            n: v.to(device) for n, v in vars(self).items() if isinstance(v, Tensor)
        }
        return replace(self, **moved, seen={n: v.to(device) for n, v in self.seen.items()})

    def padded(self, flat: Tensor) -> Tensor:
        """[N, ...] to [E, T, ...], zeros behind the end of a walk."""
        size = (len(self.tokens), int(self.time.max()) + 1)
        return flat.new_zeros(*size, *flat.shape[1:]).index_put((self.walk, self.time), flat)


@torch.no_grad()
def collect(
    agent: RecurrentAgent,
    worlds: Sequence[World],
    episodes: Sequence[Episode],
    *,
    expert_share: float,
    rngs: Sequence[np.random.Generator],
    clean: bool = False,
) -> Piece:
    """As ``agents/agent.py`` says; a walk ends where the expert's STOP is taken, or after ``LIMIT``
    steps. The agent's own STOP is not taken, so that what follows a wrong one is learned, too.

    The piece is plain data, tensors and lists. Views of encoders that do not train are kept as
    features, in place of the frames.
    """
    walks = [Walk(w, e, agent.sensors) for w, e in zip(worlds, episodes, strict=True)]
    text = agent.policy.read(agent.tokens([e.instruction.text for e in episodes]))
    state, running = State.start(text), list(range(len(walks)))
    frames_kept = trains_encoders(agent)
    for _ in range(LIMIT):
        rows, here = torch.tensor(running, device=agent.device), [walks[i] for i in running]
        frames = {n: np.stack([walk.see()[n] for walk in here]) for n in agent.sensors}
        views = encode(agent, frames)
        moves = torch.from_numpy(np.stack([walk.odometer.moves() for walk in here]))
        fresh = agent.policy.step(
            text.rows(rows), agent.policy.look(views), moves.to(agent.device), state.rows(rows)
        )
        state.put(rows, fresh)
        logits = check_logits(agent.policy.answer(fresh.hidden), agent)
        chances = logits.double().softmax(-1).cpu().numpy()
        for row, i in enumerate(running):
            kept = {} if frames_kept else {"views": views[row].float().cpu().numpy()}
            walks[i].note(kept, clean, frames_kept)
            walks[i].go(chances[row], expert_share, rngs[i])
        running = [i for i in running if not worlds[i].done]
        if not running:
            break
    return _piece(walks)


class Walk:
    """One training walk: what was seen and done at each step, and the expert's answers."""

    def __init__(self, world: World, episode: Episode, sensors: Sequence[str]) -> None:
        self.world, self.episode, self.sensors = world, episode, sensors
        self.observation: Observation = world.reset(episode)
        self.expert, self.odometer = expert_of(world), Odometer()
        self.steps: list[dict[str, Any]] = []
        self.before = -1

    def see(self) -> dict[str, np.ndarray]:
        """The frames here, in arrays that the world may use again."""
        return self._frames(self.observation)

    def _frames(self, observation: Observation) -> dict[str, np.ndarray]:
        return {n: checked.frame(observation, n, 1) for n in self.sensors}

    def note(self, kept: dict[str, np.ndarray], clean: bool, frames: bool) -> None:
        """Write a step down, with the expert's answer to it."""
        action = int(self.expert.action())
        seen = {n: np.array(f) for n, f in self.see().items()} if frames else {}
        seen |= kept
        if clean:
            before = self._frames(self.observation.clean)
            seen |= {f"clean_{n}": np.array(f) for n, f in before.items()}
        truth: Mapping[str, np.ndarray] = getattr(self.world, "truth", dict)()
        labels = (*(agent_labels(self.sensors) if frames else ()), "goal")
        seen |= {name: np.array(truth[name]) for name in labels if name in truth}
        weight = INFLECTION if action != self.before else 1.0
        metres = self._metres()
        self.steps.append(
            {
                "seen": seen,
                "moves": self.odometer.moves(),
                "answer": action,
                "weight": weight,
                "metres": metres,
            }
        )
        self.before = action

    def _metres(self) -> float:
        if not hasattr(self.expert, "distance") or POSE not in self.observation:
            return float("nan")
        place = np.asarray(self.observation[POSE], np.float64)[:2]
        return min(float(self.expert.distance(place)), _FARTHEST)

    def go(self, chances: np.ndarray, expert_share: float, rng: np.random.Generator) -> None:
        """Take the expert's step, or one of the agent's own."""
        action = self.steps[-1]["answer"]
        if rng.random() >= expert_share:
            total = np.cumsum(chances)
            own = int(min(np.searchsorted(total, rng.random() * total[-1]), len(total) - 1))
            action = action if own == STOP else own
        self.observation = self.world.step(action)
        self.odometer.add(action)


def agent_labels(sensors: Sequence[str]) -> tuple[str, ...]:
    """Labels of the world's truth that encoders of the sensors are taught by."""
    return tuple(
        name for sensor, name in (("rgb", "concepts"), ("depth", "free")) if sensor in sensors
    )


def _piece(walks: Sequence[Walk]) -> Piece:
    steps = [step for walk in walks for step in walk.steps]

    def column(name: str) -> Tensor:
        return torch.from_numpy(np.array([step[name] for step in steps], np.float32))

    return {
        "texts": [walk.episode.instruction.text for walk in walks],
        "ids": [walk.episode.episode_id for walk in walks],
        "lengths": [len(walk.steps) for walk in walks],
        "answer": torch.tensor([step["answer"] for step in steps]),
        **{name: column(name) for name in ("moves", "weight", "metres")},
        "seen": {
            name: torch.from_numpy(np.stack([step["seen"][name] for step in steps]))
            for name in steps[0]["seen"]
        },
    }


def precompute(agent: RecurrentAgent, piece: Piece, *, clean: bool) -> Piece:
    """With ``clean``: features in place of the clean frames."""
    names = {f"clean_{name}": name for name in agent.sensors}
    if clean and all(name in piece["seen"] for name in names):
        frames = {own: piece["seen"].pop(name).numpy() for name, own in names.items()}
        piece["seen"]["clean_views"] = encode(agent, frames).float().cpu()
    return piece


def join(agent: RecurrentAgent, pieces: Sequence[Piece]) -> WalkDecisions:
    """One batch of all walks of the pieces."""
    lengths = [n for piece in pieces for n in piece["lengths"]]
    names = [name for piece in pieces for name in piece["ids"]]
    seen = {n: torch.cat([p["seen"][n] for p in pieces]) for n in pieces[0]["seen"]}
    answer = torch.cat([piece["answer"] for piece in pieces])
    return WalkDecisions(
        walk=torch.repeat_interleave(torch.arange(len(lengths)), torch.tensor(lengths)),
        time=torch.cat([torch.arange(n) for n in lengths]),
        **{n: torch.cat([p[n] for p in pieces]) for n in ("moves", "weight", "metres")},
        tokens=agent.tokens([text for piece in pieces for text in piece["texts"]]),
        target=F.one_hot(answer, agent.actions).float(),
        seen=seen,
        episode_ids=[name for name, n in zip(names, lengths, strict=True) for _ in range(n)],
    )


def decide(agent: RecurrentAgent, decisions: WalkDecisions, *, clean: bool = False) -> Output:
    """As ``agents/agent.py`` says; features "views" [N, F] and "state" [N, width]."""
    seen, prefix = decisions.seen, "clean_" if clean else ""
    losses: dict[str, Tensor] = {}
    views = seen.get(f"{prefix}views")
    if views is None:
        frames = {name: seen[f"{prefix}{name}"] for name in agent.sensors}
        views, losses = perceive(agent, frames, {} if clean else seen)
    text = agent.policy.read(decisions.tokens)
    made = agent.policy(text, decisions.padded(views), decisions.padded(decisions.moves))
    out = {name: value[decisions.walk, decisions.time] for name, value in made.items()}
    known = torch.isfinite(decisions.metres)
    if known.any():
        wanted = decisions.metres[known] / _SCALE
        losses["distance"] = F.smooth_l1_loss(out["distance"][known], wanted)
    if "goal" in seen:
        losses["grounding"] = presence_loss(out["grounding"], seen["goal"])
    stop = decisions.target[:, STOP] > 0
    chosen = out["logits"].argmax(-1) == STOP
    figures = {
        "stop_recall": (chosen & stop).sum() / stop.sum().clamp(min=1),
        "false_stop": (chosen & ~stop).sum() / (~stop).sum().clamp(min=1),
    }
    return Output(out["logits"], None, {"views": views, "state": out["state"]}, losses, figures)


@torch.no_grad()
def encode(agent: RecurrentAgent, frames: dict[str, np.ndarray]) -> Tensor:
    """Features [N, F] of frames [N, H, W, c], without gradients."""
    on = {name: torch.from_numpy(f).to(agent.device) for name, f in frames.items()}
    return perceive(agent, on, {})[0]


def perceive(
    agent: RecurrentAgent, frames: dict[str, Tensor], truth: dict[str, Tensor]
) -> tuple[Tensor, dict[str, Tensor]]:
    """Features [N, F] of frames: of RGB its columns' features and what shows there, of depth its
    columns' features and the metres that are free; with the truth the encoders' losses, too."""
    parts, losses = [], {}
    if RGB in agent.sensors:
        rgb = torch.zeros_like(frames[RGB]) if RGB in agent.blind else frames[RGB]
        features, logits = agent.rgb_encoder(rgb)
        parts += [features.flatten(-2), logits.sigmoid().flatten(-2)]
        if "concepts" in truth:
            losses["concepts"] = presence_loss(logits, truth["concepts"])
    if DEPTH in agent.sensors:
        depth = torch.zeros_like(frames[DEPTH]) if DEPTH in agent.blind else frames[DEPTH]
        features, logits = agent.depth_encoder(depth)
        parts += [features.flatten(-2), free_metres(logits)]
        if "free" in truth:
            losses["free"] = free_loss(logits, truth["free"])
    return torch.cat(parts, -1), losses


def trains_encoders(agent: RecurrentAgent) -> bool:
    """Whether any weight that makes view features is trained."""
    encoders = (m for name, m in agent.parts().items() if name != "policy")
    return any(p.requires_grad for encoder in encoders for p in encoder.parameters())
