"""Define the conversation of a vision-language agent: its memory, frames and prompt.

For each decision, the model receives the instruction, up to ``history`` earlier frames and the
current view, and chooses one of the allowed answers. All agents of this package send the same
conversation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mitigate.agents import observation as checked
from mitigate.agents.agent import Agent, check_started
from mitigate.agents.vlm.answers import Answer, answers_of
from mitigate.core.observation import RGB

SYSTEM = "You are a robot that follows navigation instructions in a building."
TASK = (
    "Instruction: {instruction}\nThe last image is the current view of the robot; the images "
    "before it are earlier views, in order. What does the robot do next? Answer with exactly one "
    "of: {answers}."
)
MOST_FRAMES = 64  # maximum number of earlier frames in a prompt (heuristic)


@dataclass
class Memory:
    """The memory of one episode."""

    instruction: str
    system: str | None  # the system prompt at the start of the episode
    frames: list[np.ndarray] = field(default_factory=list)  # of all decisions, uint8 [H, W, 3]
    pending: list[int] = field(default_factory=list)  # actions of the last answer, not taken yet
    unreadable: int = 0  # number of answers that were not one of the allowed answers


def views_of(count: int, history: int) -> list[int]:
    """Return the indices of the frames that the model sees, from the earliest to the last.

    Args:
        count: number of frames so far.
        history: maximum number of earlier frames, which are spread evenly over the episode.
    """
    earlier = np.linspace(count - 2, 0, min(history, count - 1)).round().astype(int)
    return [*reversed(earlier.tolist()), count - 1]


def question(task: str, answers: Sequence[Answer], instruction: str) -> str:
    """Return the user message: ``task`` with the allowed answers and the instruction."""
    listed = ", ".join(f'"{answer.text}"' for answer in answers)
    return task.replace("{answers}", listed).replace("{instruction}", instruction)


class AnsweringAgent(Agent):
    """Base class of agents that ask a model for the next answer; a subclass defines ``ask``.

    Args:
        answers: a style in ``ANSWERS``: "actions" or "navid".
        history: maximum number of earlier frames that the model sees.
        task: the user message, in which "{instruction}" and "{answers}" are replaced. None means
            ``TASK``.
        system_prompt: the system message, or None to send no system message.

    Raises:
        ValueError: If ``answers`` is unknown, ``history`` is out of range, or ``task`` lacks
            "{instruction}".
    """

    views = 1
    sensors: tuple[str, ...] = (RGB,)
    _memory: Memory | None = None

    def prepare(
        self, answers: str, history: int, task: str | None, system_prompt: str | None
    ) -> None:
        """Set the arguments that the class's docstring describes; constructors call this."""
        self.answers = answers_of(answers)
        if not 0 <= history <= MOST_FRAMES:
            raise ValueError(f"agent.history must be from 0 to {MOST_FRAMES}, got {history}.")
        task = TASK if task is None else task
        if "{instruction}" not in task:
            raise ValueError(
                f"agent.task must contain {{instruction}}, got {task!r:.80}. Without it, the model "
                "would not see the instruction."
            )
        self.history, self.task, self.system_prompt = history, task, system_prompt
        self._settings: dict[str, Any] = {
            "answers": answers,
            "history": history,
            "task": task,
            "system_prompt": system_prompt,
        }

    def ask(self, memories: Sequence[Memory]) -> list[Answer]:
        """Return, for each episode, the model's answer to its last frame."""
        raise NotImplementedError(f"{type(self).__name__} defines no ask(memories)")

    def messages(self, instruction: str, system: str | None, images: Sequence[Any]) -> list[dict]:
        """Return the conversation, in which ``images`` (one entry per frame) precede the text."""
        text = question(self.task, self.answers, instruction)
        user = {"role": "user", "content": [*images, {"type": "text", "text": text}]}
        if system is None:
            return [user]
        return [{"role": "system", "content": [{"type": "text", "text": system}]}, user]

    def begin(self, instruction: str) -> Memory:
        """Return the memory of a new episode.

        Raises TypeError if the instruction is not a string.
        """
        if not isinstance(instruction, str):
            raise TypeError(f"instruction must be a string, got a {type(instruction).__name__}.")
        return Memory(instruction, self.system_prompt)

    def act_all(
        self, observations: Sequence[Mapping[str, np.ndarray]], memories: Sequence[Memory]
    ) -> list[int]:
        """Return one low-level action per episode.

        An episode's observation is ignored while actions from an earlier answer are still pending.
        """
        deciding = [i for i, memory in enumerate(memories) if not memory.pending]
        for i in deciding:
            memories[i].frames.append(checked.frame(observations[i], RGB, 1).copy())
        for i, answer in zip(deciding, self.ask([memories[i] for i in deciding]), strict=True):
            memories[i].pending = [answer.action] * answer.repeats
        return [memory.pending.pop() for memory in memories]

    def reset(self, instruction: str) -> None:
        """Start an episode; see :meth:`begin`."""
        self._memory = self.begin(instruction)

    def act(self, observation: Mapping[str, np.ndarray]) -> int:
        check_started(self._memory is not None)
        return self.act_all([observation], [self._memory])[0]  # type: ignore[list-item]

    def taken(self, action: int, metres: float, radians: float) -> None:
        """Discard pending actions, because the agent did not make the motion that it chose."""
        assert self._memory is not None, "reset first"
        self._memory.pending.clear()
