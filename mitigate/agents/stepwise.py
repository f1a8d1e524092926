"""A base for agents that take every low-level action from what they see at that moment.

A subclass says what it reads and what it makes of a batch of observations; acting, collecting
decisions under an expert, and answering them again are done here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents.agent import Agent, Output, check_logits
from mitigate.core.observation import RGB, STOP, Observation
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of


class Frames(dict[str, Tensor]):
    """What ``forward`` reads, by name."""

    def __missing__(self, name: str) -> Tensor:
        raise ValueError(
            f"The agent reads {name!r}, which its needs = {tuple(self)} do not name: add it to "
            "them (docs/bring-your-own.md)."
        )


@dataclass
class StepDecisions:
    """B steps: frames by name [B, ...], the same before their corruption (if it was kept), what
    each heard, the expert's answers."""

    frames: Frames
    clean: Frames
    texts: list[str]
    target: Tensor
    weight: Tensor
    episode_ids: list[str]

    def to(self, device: Any) -> StepDecisions:
        """Return the steps on ``device``."""
        frames, clean = (
            Frames({n: t.to(device) for n, t in f.items()}) for f in (self.frames, self.clean)
        )
        target, weight = self.target.to(device), self.weight.to(device)
        return replace(self, frames=frames, clean=clean, target=target, weight=weight)


class StepwiseAgent(Agent, nn.Module):
    """Define ``forward``; set ``needs`` (entries of observations), ``actions`` (how many there are,
    0 is STOP) and ``limit`` (steps of a training rollout) where they are others.

    It is an agent and trainable (``agents/agent.py``); its parts are its child modules.
    """

    needs: tuple[str, ...] = (RGB,)
    actions = 4
    limit = 100

    plain_walks = False  # steps hold arrays

    def forward(self, frames: Frames, texts: Sequence[str]) -> tuple[Tensor, dict[str, Tensor]]:
        """Logits [B, actions] and features by name of B observations, which hold what ``needs``
        names as the world's sensors give it, and the instructions."""
        raise NotImplementedError(f"{type(self).__name__} defines no forward(frames, texts)")

    @property
    def sensors(self) -> tuple[str, ...]:  # type: ignore[override]
        """What it reads."""
        return self.needs

    def parts(self) -> dict[str, nn.Module]:
        """The child modules by name."""
        return dict(self.named_children())

    @property
    def device(self) -> torch.device:
        return next(self.parameters()).device

    def reset(self, instruction: str) -> None:
        """Start an episode."""
        self.instruction = instruction

    @torch.inference_mode()
    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """The likeliest action. Raises ValueError for logits that choose none."""
        seen = {name: np.asarray(observation[name])[None] for name in self.needs}
        logits = self(self._tensors(seen), [self.instruction])[0][0]
        return int(check_logits(logits, self).argmax())

    @torch.no_grad()
    def collect(
        self,
        worlds: Sequence[World],
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
        clean: bool = False,
    ) -> list[dict[str, Any]]:
        """One dict a step. The agent's own STOP is not taken, so that what follows a wrong one is
        learned, too. Raises ValueError for a world without an expert, and for logits that choose no
        action."""
        seen = [world.reset(episode) for world, episode in zip(worlds, episodes, strict=True)]
        experts = [expert_of(world) for world in worlds]
        steps: list[dict[str, Any]] = []
        running = list(range(len(worlds)))
        for number in range(1, self.limit + 1):
            fresh = [self._step(seen[i], experts[i], episodes[i], clean) for i in running]
            steps += fresh
            for i, step in zip(running, fresh, strict=True):
                action = step["answer"]
                if rngs[i].random() >= expert_share:
                    own = self._sample(step, rngs[i], number)
                    action = action if own == STOP else own
                seen[i] = worlds[i].step(action)
            running = [i for i in running if not worlds[i].done]
            if not running:
                break
        return steps

    def join(self, pieces: Sequence[list[dict[str, Any]]]) -> StepDecisions:
        """All steps of the pieces."""
        steps = [step for piece in pieces for step in piece]
        answers = torch.tensor([step["answer"] for step in steps])
        frames, clean = (_stacked([step[kind] for step in steps]) for kind in ("frames", "clean"))
        return StepDecisions(
            frames,
            clean,
            [step["text"] for step in steps],
            nn.functional.one_hot(answers, self.actions).float(),
            torch.ones(len(steps)),
            [step["episode_id"] for step in steps],
        )

    def decide(self, decisions: StepDecisions, *, clean: bool = False) -> Output:
        """Logits over the actions, and what ``forward`` calls features."""
        logits, features = self(decisions.clean if clean else decisions.frames, decisions.texts)
        return Output(logits.float(), features=features)

    def _step(
        self, seen: Observation, expert: Any, episode: Episode, clean: bool
    ) -> dict[str, Any]:
        return {
            "frames": {name: np.array(seen[name]) for name in self.needs},  # a world may reuse its
            "clean": {name: np.array(seen.clean[name]) for name in self.needs if clean},  # arrays
            "answer": int(expert.action()),
            "text": episode.instruction.text,
            "episode_id": episode.episode_id,
        }

    def _sample(self, step: dict[str, Any], rng: np.random.Generator, number: int) -> int:
        frames = {name: frame[None] for name, frame in step["frames"].items()}
        logits = self(self._tensors(frames), [step["text"]])[0][0]
        try:
            check_logits(logits, self)
        except ValueError as error:
            raise ValueError(f"Episode {step['episode_id']}, step {number}: {error}") from None
        total = np.cumsum(logits.double().softmax(-1).cpu().numpy())
        return int(min(np.searchsorted(total, rng.random() * total[-1]), len(total) - 1))

    def _tensors(self, frames: Mapping[str, np.ndarray]) -> Frames:
        return Frames({n: torch.from_numpy(np.array(f)).to(self.device) for n, f in frames.items()})


def _stacked(frames: Sequence[Mapping[str, np.ndarray]]) -> Frames:
    return Frames({n: torch.from_numpy(np.stack([f[n] for f in frames])) for n in frames[0]})
