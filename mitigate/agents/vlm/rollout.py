"""Run training episodes of a vision-language agent, and batch their decisions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from torch import Tensor

from mitigate.agents import observation as checked
from mitigate.agents.agent import sample
from mitigate.agents.vlm.answers import Answer, answer_for
from mitigate.agents.vlm.conversation import Memory, views_of
from mitigate.core.observation import RGB, STOP
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, expert_of

Piece = dict[str, Any]


@dataclass
class AnswerDecisions:
    """A batch of B decisions with the expert's answers."""

    frames: Tensor  # uint8 [F, H, W, 3], the frames of all episodes; they stay on the CPU
    clean: Tensor | None  # the frames before corruption, or None if they were not kept
    views: list[list[int]]  # the frames that each decision sees, as indices into ``frames``
    texts: list[str]  # the instruction of each decision
    target: Tensor  # [B, n], one-hot
    weight: Tensor  # [B]
    episode_ids: list[str]  # the episode of each decision

    def to(self, device: Any) -> AnswerDecisions:
        """Return a copy of the batch on ``device``."""
        return replace(self, target=self.target.to(device), weight=self.weight.to(device))


def run_episode(
    world: World,
    episode: Episode,
    memory: Memory,
    chances: Callable[[Memory], np.ndarray],
    answers: tuple[Answer, ...],
    expert_share: float,
    rng: np.random.Generator,
    clean: bool,
    limit: int,
) -> tuple[list[int], list[np.ndarray]]:
    """Run a training episode, and add its frames to ``memory``.

    If the expert decides, its action is executed until the expert would choose a different action,
    but at most as often as the longest answer allows. The training target of a decision is the
    longest answer whose actions all agreed with the expert. If the first action already disagreed,
    the target is the shortest answer with the expert's action. The agent's STOP is never executed,
    so that the agent also learns from later steps.

    Args:
        world: the world.
        episode: the episode.
        memory: the memory of the new episode.
        chances: function that returns the agent's probabilities [n] of ``answers``.
        answers: the allowed answers.
        expert_share: fraction of decisions that follow the expert.
        rng: the episode's random generator.
        clean: whether to return the frames before corruption.
        limit: maximum number of decisions.

    Returns:
        For each decision, the index of its target and its frame before corruption.
    """
    observation, expert = world.reset(episode), expert_of(world)
    targets: list[int] = []
    clean_frames: list[np.ndarray] = []
    longest = {answer.action: answer for answer in sorted(answers, key=lambda a: a.repeats)}
    while not world.done and len(targets) < limit:
        memory.frames.append(checked.frame(observation, RGB, 1).copy())
        if clean:
            clean_frames.append(checked.frame(observation.clean, RGB, 1).copy())
        target = int(expert.action())
        if target not in longest:
            raise ValueError(
                f"Episode {episode.episode_id}: the expert takes the action {target}, but a "
                f"vision-language agent can answer only with the actions {sorted(longest)}."
            )
        answer = longest[target]
        expert_decides = rng.random() < expert_share
        if not expert_decides:
            sampled = answers[sample(chances(memory), rng)]
            expert_decides = sampled.action == STOP
            answer = answer if expert_decides else sampled
        agreed = 0
        for count in range(answer.repeats):
            current = int(expert.action()) if count else target
            if expert_decides and current != target:
                break
            agreed += agreed == count and current == target == answer.action
            observation = world.step(answer.action)
            if world.done:
                break
        targets.append(answer_for(target, max(agreed, 1), answers))
    return targets, clean_frames


def piece_of(
    runs: Sequence[tuple[Episode, Memory, list[int], list[np.ndarray]]], history: int
) -> Piece:
    """Return finished episodes as plain data."""
    return {
        "texts": [episode.instruction.text for episode, *_ in runs],
        "ids": [episode.episode_id for episode, *_ in runs],
        "views": [[views_of(n + 1, history) for n in range(len(t))] for _, _, t, _ in runs],
        "targets": [index for *_, targets, _ in runs for index in targets],
        "frames": _stacked([frame for _, memory, *_ in runs for frame in memory.frames]),
        "clean": _stacked([frame for *_, frames in runs for frame in frames]),
    }


def join_pieces(pieces: Sequence[Piece], answers: int) -> AnswerDecisions:
    """Join the decisions of ``pieces`` in one batch; the agent has ``answers`` allowed answers."""
    views: list[list[int]] = []
    texts: list[str] = []
    names: list[str] = []
    first = 0
    for piece in pieces:
        for text, name, episode in zip(piece["texts"], piece["ids"], piece["views"], strict=True):
            views += [[first + index for index in seen] for seen in episode]
            texts += [text] * len(episode)
            names += [name] * len(episode)
            first += 1 + max(map(max, episode), default=-1)
    targets = torch.tensor([index for piece in pieces for index in piece["targets"]])
    has_clean = all(len(piece["clean"]) for piece in pieces)
    return AnswerDecisions(
        frames=torch.cat([piece["frames"] for piece in pieces]),
        clean=torch.cat([piece["clean"] for piece in pieces]) if has_clean else None,
        views=views,
        texts=texts,
        target=torch.nn.functional.one_hot(targets, answers).float(),
        weight=torch.ones(len(targets)),
        episode_ids=names,
    )


def _stacked(frames: list[np.ndarray]) -> Tensor:
    return torch.from_numpy(np.stack(frames)) if frames else torch.empty(0, dtype=torch.uint8)
