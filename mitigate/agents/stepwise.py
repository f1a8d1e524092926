"""Define the base class of agents that choose each action from the current observation alone.

A subclass declares its inputs and defines ``forward``. The base class acts, collects decisions
with the expert's answers, and evaluates batches of decisions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from mitigate.agents.agent import Agent, Batch, Output, check_logits, entropy_of, sample
from mitigate.core.observation import RGB, STOP, Observation
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of


class Frames(dict[str, Tensor]):
    """The input tensors of ``forward`` by name."""

    def __missing__(self, name: str) -> Tensor:
        raise ValueError(
            f"The agent reads {name!r}, but its needs = {tuple(self)} do not name it. Add it to "
            "needs (docs/bring-your-own.md)."
        )


@dataclass
class StepDecisions(Batch):
    """A batch of B steps with the expert's answers."""

    frames: Frames  # inputs by name, [B, ...]
    clean: Frames  # the inputs before corruption, or an empty dict if they were not kept
    texts: list[str]  # the instruction of each step
    target: Tensor  # [B, actions], one-hot
    weight: Tensor  # [B]
    episode_ids: list[str]  # the episode of each step


class StepwiseAgent(Agent, nn.Module):
    """A trainable agent (``agents/agent.py``) without memory; a subclass defines ``forward``.

    The trainable parts of the agent are its child modules.

    Attributes:
        needs: entries of observations that ``forward`` reads.
        actions: number of actions; 0 is STOP.
        limit: maximum number of steps in a training rollout.
    """

    needs: tuple[str, ...] = (RGB,)
    actions = 4
    limit = 100

    plain_walks = False  # the steps contain numpy arrays

    def forward(self, frames: Frames, texts: Sequence[str]) -> tuple[Tensor, dict[str, Tensor]]:
        """Return logits [B, actions] and features by name.

        Args:
            frames: a batch of size B for each entry in ``needs``, in the format of the world's
                sensors.
            texts: the B instructions.
        """
        raise NotImplementedError(f"{type(self).__name__} defines no forward(frames, texts)")

    @property
    def sensors(self) -> tuple[str, ...]:  # type: ignore[override]
        """The entries of observations that the agent reads."""
        return self.needs

    def parts(self) -> dict[str, nn.Module]:
        """Return the child modules by name."""
        return dict(self.named_children())

    @property
    def device(self) -> torch.device:
        return next(self.parameters()).device

    def reset(self, instruction: str) -> None:
        """Start an episode."""
        self.instruction = instruction

    @torch.inference_mode()
    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        """Return the most likely action. Raises ValueError for invalid logits."""
        return int(check_logits(self._logits(observation, self.instruction), self).argmax())

    def entropy(self, observation: Mapping[str, np.ndarray]) -> Tensor:
        """Return the entropy of the action distribution for an observation, with gradients."""
        return entropy_of(self._logits(observation, self.instruction))

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
        """Run episodes and return one dict per step, with the expert's answer.

        The agent's STOP is never executed, so that the agent also learns from later steps.

        Raises:
            ValueError: If one of the worlds has no expert, or the logits are invalid.
        """
        observations = [world.reset(e) for world, e in zip(worlds, episodes, strict=True)]
        experts = [expert_of(world) for world in worlds]
        steps: list[dict[str, Any]] = []
        running = list(range(len(worlds)))
        for number in range(1, self.limit + 1):
            new = [self._step(observations[i], experts[i], episodes[i], clean) for i in running]
            steps += new
            for i, step in zip(running, new, strict=True):
                action = step["answer"]
                if rngs[i].random() >= expert_share:
                    sampled = self._sample(step, rngs[i], number)
                    action = action if sampled == STOP else sampled
                observations[i] = worlds[i].step(action)
            running = [i for i in running if not worlds[i].done]
            if not running:
                break
        return steps

    def join(self, pieces: Sequence[list[dict[str, Any]]]) -> StepDecisions:
        """Join the steps of several calls of :meth:`collect` into one batch."""
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
        """Return the logits and features of ``forward``."""
        logits, features = self(decisions.clean if clean else decisions.frames, decisions.texts)
        return Output(logits.float(), features=features)

    def _step(
        self, observation: Observation, expert: Any, episode: Episode, clean: bool
    ) -> dict[str, Any]:
        # these are copies, because a world may reuse its arrays
        return {
            "frames": {name: np.array(observation[name]) for name in self.needs},
            "clean": {name: np.array(observation.clean[name]) for name in self.needs if clean},
            "answer": int(expert.action()),
            "text": episode.instruction.text,
            "episode_id": episode.episode_id,
        }

    def _sample(self, step: dict[str, Any], rng: np.random.Generator, number: int) -> int:
        try:
            logits = check_logits(self._logits(step["frames"], step["text"]), self)
        except ValueError as error:
            raise ValueError(f"Episode {step['episode_id']}, step {number}: {error}") from None
        return sample(logits.double().softmax(-1).cpu().numpy(), rng)

    def _logits(self, observation: Mapping[str, np.ndarray], text: str) -> Tensor:
        """Return the logits [actions] of one step."""
        frames = {name: np.array(observation[name])[None] for name in self.needs}
        tensors = {name: torch.from_numpy(f).to(self.device) for name, f in frames.items()}
        answer = self(Frames(tensors), [text])
        if not isinstance(answer, tuple) or len(answer) != 2:
            raise ValueError(
                f"forward() of {type(self).__name__} must return two values, logits [B, actions] "
                f"and a dict of features, got {type(answer).__name__}."
            )
        return answer[0][0]


def _stacked(frames: Sequence[Mapping[str, np.ndarray]]) -> Frames:
    return Frames({n: torch.from_numpy(np.stack([f[n] for f in frames])) for n in frames[0]})
