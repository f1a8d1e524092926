"""Write episodes of an expert as conversations with images, in the format of LLaVA and NaVid."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from mitigate.agents.vlm.answers import answers_of
from mitigate.agents.vlm.conversation import TASK, Memory, question, views_of
from mitigate.agents.vlm.rollout import run_episode
from mitigate.core.files import atomic_text, make_folder, write_bytes
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

CONVERSATIONS = "conversations.jsonl"
LIMIT = 500  # VLN-CE's step limit


def write_conversations(
    world: World,
    episodes: Iterable[Episode],
    folder: str | Path,
    *,
    answers: str = "navid",
    history: int = 4,
    task: str = TASK,
    limit: int = LIMIT,
) -> int:
    """Run the expert of ``world``, and write one JSON line per decision to ``conversations.jsonl``.

    A line holds "id", "episode_id", "images" and "conversations". "images" are paths below
    ``folder``; the last image is the current view. "conversations" holds the question ("human"), in
    which one "<image>" stands for each image, and the answer ("gpt"). For corrupted frames, wrap
    the world in ``mitigate.worlds.world.Corrupted``.

    Args:
        world: the world, which must have an expert and one camera.
        episodes: the episodes.
        folder: the output folder; the frames in it are PNG files ``frames/EPISODE/DECISION.png``.
        answers: style of the answers, see ``AnsweringAgent``.
        history: maximum number of earlier frames.
        task: text of the question.
        limit: maximum number of decisions per episode.

    Returns:
        The number of lines.

    Raises:
        ValueError: If the world has no expert, or ``answers`` is unknown.
    """
    allowed, count = answers_of(answers), 0
    with atomic_text(make_folder(folder) / CONVERSATIONS) as file:
        for number, episode in enumerate(episodes):
            memory = Memory(episode.instruction.text, None)
            rng = np.random.default_rng(0)  # never used, because the expert decides at every step
            expert_share = 1.0
            targets, _ = run_episode(
                world, episode, memory, _no_agent, allowed, expert_share, rng, False, limit
            )
            names = [f"frames/{number:06d}/{step:04d}.png" for step in range(len(targets))]
            for name, frame in zip(names, memory.frames, strict=True):
                _, data = cv2.imencode(".png", frame[..., ::-1])
                write_bytes(Path(folder) / name, data.tobytes())
            for step, target in enumerate(targets):
                views = views_of(step + 1, history)
                text = "<image>\n" * len(views) + question(task, allowed, memory.instruction)
                line = {
                    "id": f"{number:06d}-{step:04d}",
                    "episode_id": episode.episode_id,
                    "images": [names[view] for view in views],
                    "conversations": [
                        {"from": "human", "value": text},
                        {"from": "gpt", "value": allowed[target].text},
                    ],
                }
                file.write(json.dumps(line) + "\n")
            count += len(targets)
    return count


def _no_agent(memory: Memory) -> np.ndarray:
    raise AssertionError("the expert decides at every step")
